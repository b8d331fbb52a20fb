//! Unmapped elements beside mapped ones: thickness and plastic strain from their neighbours.

use super::layered::PLASTIC_STRAIN;
use super::options::{MapOptions, Status};
use super::target::{Mapped, MappedLayers, TargetPart};
use crate::geometry::chunks::{CHUNK, for_chunks, map_chunks};
use crate::monitor::{Cancelled, Monitor};

/// Fills as many rings as the options ask for. A filled element gets the area-weighted means of its
/// mapped neighbours of the same part and the same layers, and the status [`Status::Filled`]; a neighbour whose normal
/// points to the other side of the sheet gives its layers from the other end. Where
/// plastic strains are asked for, these come with zero stress; there is no strain and no history. Elements
/// beside which neither thickness nor plastic strain is known stay as they are.
pub(super) fn fill(
    mapped: &mut Mapped,
    target: &TargetPart,
    options: &MapOptions,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let fills_thickness = !mapped.thickness.is_empty();
    let fills_states = options.quantities.plastic_strain && mapped.states.is_some();
    if options.fill_rings == 0 || !(fills_thickness || fills_states) {
        return Ok(());
    }
    let links = target.mesh.links(monitor)?;
    let neighbours = &links.neighbours;
    let own = mapped.states.as_ref().filter(|_| fills_states);
    let own = own.map(|states| {
        map_chunks(target.mesh.len(), monitor, |element| {
            states.of(element).to_vec()
        })
    });
    let mut states: Option<Vec<Vec<[f64; 7]>>> = own.transpose()?;
    for _ in 0..options.fill_rings {
        let has_values: Vec<bool> = mapped
            .elements
            .iter()
            .map(|report| report.status.has_values())
            .collect();
        let gives = |n: usize| {
            let has_thickness = fills_thickness && mapped.thickness[n].is_finite();
            let has_state = states.as_ref().is_some_and(|states| !states[n].is_empty());
            has_values[n] && target.mesh.areas()[n] > 0.0 && (has_thickness || has_state)
        };
        let mut filled = Vec::new();
        for_chunks(target.mesh.len(), monitor, |range| {
            for element in range.filter(|&element| !has_values[element]) {
                let around = neighbours
                    .of(element)
                    .iter()
                    .map(|&n| n as usize)
                    .filter(|&n| {
                        let rule = &target.rules[usize::from(target.rule_of[n])];
                        gives(n)
                            && target.mesh.parts()[n] == target.mesh.parts()[element]
                            && target.rule_of[n] == target.rule_of[element]
                            && target.planes(n) == target.planes(element)
                            && (!neighbours.are_opposed(n, element) || rule.is_symmetric())
                    });
                let around: Vec<usize> = around.collect();
                if !around.is_empty() {
                    filled.push((element, around));
                }
            }
        })?;
        if filled.is_empty() {
            break;
        }
        for (number, (element, around)) in filled.into_iter().enumerate() {
            if number % CHUNK == 0 {
                monitor.check()?;
            }
            let area = |n: &usize| target.mesh.areas()[*n];
            if fills_thickness {
                let known: Vec<usize> = around
                    .iter()
                    .copied()
                    .filter(|&n| mapped.thickness[n].is_finite())
                    .collect();
                let sum: f64 = known.iter().map(|n| area(n) * mapped.thickness[*n]).sum();
                mapped.thickness[element] = sum / known.iter().map(area).sum::<f64>();
            }
            if let Some(states) = &mut states {
                let is_opposed = |n| neighbours.are_opposed(n, element);
                states[element] = mean_plastic_strain(states, &around, is_opposed, target);
            }
            mapped.elements[element].status = Status::Filled;
        }
    }
    if let Some(states) = states {
        let values = states.iter().map(Vec::as_slice);
        mapped.states = Some(MappedLayers::of_elements(values));
    }
    Ok(())
}

/// Zero stress and the area mean of the plastic strain, point by point.
fn mean_plastic_strain(
    states: &[Vec<[f64; 7]>],
    around: &[usize],
    is_opposed: impl Fn(usize) -> bool,
    target: &TargetPart,
) -> Vec<[f64; 7]> {
    let n_points = around.iter().map(|&n| states[n].len()).max().unwrap_or(0);
    let usable: Vec<usize> = around
        .iter()
        .copied()
        .filter(|&n| states[n].len() == n_points)
        .collect();
    let all: f64 = usable.iter().map(|&n| target.mesh.areas()[n]).sum();
    // Layer by layer, in each of them one or more points in the plane.
    let n_plane = around.first().map_or(1, |&n| target.planes(n));
    let mean = |point: usize| -> f64 {
        let from_other_end = n_points - n_plane - point / n_plane * n_plane + point % n_plane;
        let terms = usable.iter().map(|&n| {
            let point = if is_opposed(n) { from_other_end } else { point };
            target.mesh.areas()[n] * states[n][point][PLASTIC_STRAIN]
        });
        terms.sum::<f64>() / all
    };
    (0..n_points)
        .map(|point| [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, mean(point)])
        .collect()
}
