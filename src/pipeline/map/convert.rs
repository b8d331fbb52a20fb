//! From loaded decks to what the mapping takes.

use std::collections::{BTreeMap, HashMap};

use super::{Layers, MapRecipe, mesh_error, parts_in_use};
use crate::formats::Model;
use crate::geometry::Point3;
use crate::mapping::{
    LayerHistory, LayerRule, Layered, ShellMesh, SourceHistory, SourcePart, TargetPart,
};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;

/// Elements between two looks for a cancel request.
const CHUNK: usize = 1 << 14;

/// The shells of a loaded part as a mapping mesh, with their indices in the model.
pub(super) struct PartShells {
    pub mesh: ShellMesh,
    /// For each element its index in [`Model::shells`].
    pub shells: Vec<u32>,
}

/// The chosen shells in the crash model's length unit, in the order of the deck. Solids and thick
/// shells have no thickness to be mapped and are left out.
pub(super) fn part_shells(
    part: &LoadedPart,
    monitor: &Monitor,
) -> Result<PartShells, PipelineError> {
    let model = &part.model;
    let n_shells = model.shells.len() as u32;
    let triangles = 0..part.mesh.n_triangles() as u32;
    let mut shells: Vec<u32> = triangles.filter_map(|t| part.ids.element_of(t)).collect();
    shells.retain(|&element| element < n_shells);
    monitor.check()?;
    shells.sort_unstable();
    monitor.check()?;
    shells.dedup();
    let factor = part.settings.length_factor;
    // Only the nodes in use, so that a part of a whole car stays small.
    let mut place = HashMap::new();
    let mut positions: Vec<Point3> = Vec::new();
    let mut corners: Vec<[u32; 4]> = Vec::with_capacity(shells.len());
    for chunk in shells.chunks(CHUNK) {
        monitor.check()?;
        corners.extend(chunk.iter().map(|&shell| {
            model.shells[shell as usize].nodes.map(|node| {
                *place.entry(node).or_insert_with(|| {
                    positions.push(model.nodes.positions()[node as usize] * factor);
                    (positions.len() - 1) as u32
                })
            })
        }));
    }
    monitor.check()?;
    let parts = shells
        .iter()
        .map(|&shell| model.shells[shell as usize].part)
        .collect();
    Ok(PartShells {
        mesh: ShellMesh::new(positions, corners, parts).map_err(mesh_error)?,
        shells,
    })
}

/// The forming results of a stamped part. Thickness comes in the crash model's length unit, stress is
/// multiplied by its factor. History variables are taken where they are asked for.
pub(super) fn source_part(
    part: &LoadedPart,
    shells: &PartShells,
    recipe: &MapRecipe,
    stress_factor: f64,
    monitor: &Monitor,
) -> Result<SourcePart, Cancelled> {
    let model = &part.model;
    let factor = part.settings.length_factor;
    let thickness = shells.shells.iter().map(|&shell| {
        let corners = model.shell_thickness(shell).unwrap_or([f64::NAN; 4]);
        corners.map(|t| t * factor)
    });
    monitor.check()?;
    let thickness: Vec<[f64; 4]> = thickness.collect();
    monitor.check()?;
    let has_results = !model.forming.is_empty();
    let named = if has_results { &shells.shells[..] } else { &[] };
    let index = element_index(model, named, monitor)?;
    let parts = parts_in_use(shells).into_iter();
    let of_parts = parts.filter_map(|part| model.parts[part as usize].plies.as_ref());
    let of_parts = of_parts.map(|plies| plies.thickness.as_slice());
    let of_shells = shells.shells.iter();
    let of_shells = of_shells.filter_map(|&shell| model.shell_plies(shell));
    let of_shells: BTreeMap<u32, &[f64]> = of_shells.collect();
    let plies = of_parts
        .chain(of_shells.into_values())
        .map(LayerRule::of_plies);
    let mut states = Layered::with_rules(shells.shells.len(), plies.collect());
    let mut history = SourceHistory::new(shells.shells.len());
    for (number, stress) in model.forming.stresses().enumerate() {
        if number % CHUNK == 0 {
            monitor.check()?;
        }
        if let Some(&element) = index.get(&stress.element_id) {
            let points = stress.points.iter();
            states.set(element, points.map(|p| (p.t, p.state(stress_factor))));
            if recipe.options.quantities.history {
                let layers = (0..).zip(stress.points).map(|(i, point)| {
                    let kept = LayerHistory {
                        values: stress.history_of(i),
                        tensors: stress.tensors_of(i),
                    };
                    (point.t, kept)
                });
                history.set(element, layers);
            }
        }
    }
    let mut strains = Layered::new(shells.shells.len());
    for (number, strain) in model.forming.strains().enumerate() {
        if number % CHUNK == 0 {
            monitor.check()?;
        }
        if let Some(&element) = index.get(&strain.element_id) {
            strains.set(
                element,
                strain.points.iter().map(|point| (point.t, point.strain)),
            );
        }
    }
    Ok(SourcePart {
        thickness,
        states,
        strains,
        history,
        laws: laws(model, shells, recipe.stamped_law.as_deref()),
        mesh: shells.mesh.clone(),
    })
}

/// The material laws of the parts in use, as far as they are known; `given` counts for all.
fn laws(model: &Model, shells: &PartShells, given: Option<&str>) -> BTreeMap<u32, String> {
    let parts = parts_in_use(shells).into_iter();
    let law_of = |part: u32| match given {
        Some(law) => Some(law.to_owned()),
        None => Some(model.material(part)?.law.clone()),
    };
    parts
        .filter_map(|part| Some((part, law_of(part)?)))
        .collect()
}

/// Where each element id stands in the list.
pub(super) fn element_index(
    model: &Model,
    shells: &[u32],
    monitor: &Monitor,
) -> Result<HashMap<u64, usize>, Cancelled> {
    let mut index = HashMap::with_capacity(shells.len());
    for (number, chunk) in shells.chunks(CHUNK).enumerate() {
        monitor.check()?;
        let ids = chunk.iter().map(|&shell| model.shells[shell as usize].id);
        index.extend(ids.zip(number * CHUNK..));
    }
    Ok(index)
}

/// What the layers of the crash elements are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TargetLayers {
    /// Their places and weights.
    pub rule: LayerRule,
    /// Points in the plane: 1 or 4.
    pub n_plane: u8,
}

/// The crash part with the layers of its elements.
pub(super) fn target_part(
    part: &LoadedPart,
    shells: &PartShells,
    layers: &Layers<'_>,
    monitor: &Monitor,
) -> Result<TargetPart, PipelineError> {
    let model = &part.model;
    let factor = part.settings.length_factor;
    let mut rules: Vec<LayerRule> = Vec::new();
    // By part and stack of plies.
    let mut known: BTreeMap<(u32, Option<u32>), (u16, u8)> = BTreeMap::new();
    let mut rule_of = Vec::with_capacity(shells.shells.len());
    let mut n_plane = Vec::with_capacity(shells.shells.len());
    for (element, (&shell, &of_part)) in shells.shells.iter().zip(shells.mesh.parts()).enumerate() {
        if element % CHUNK == 0 {
            monitor.check()?;
        }
        let plies = model.shell_plies(shell);
        let key = (of_part, plies.map(|(stack, _)| stack));
        let (rule, points) = match known.get(&key) {
            Some(&known) => known,
            None => {
                let own = layers.of(of_part, plies.map(|(_, plies)| plies))?;
                let same = rules.iter().position(|rule| *rule == own.rule);
                let rule = same.unwrap_or_else(|| {
                    rules.push(own.rule);
                    rules.len() - 1
                });
                let rule = u16::try_from(rule).map_err(|_| PipelineError::TooManyRules)?;
                known.insert(key, (rule, own.n_plane));
                (rule, own.n_plane)
            }
        };
        rule_of.push(rule);
        n_plane.push(points);
    }
    let nominal = shells.shells.iter().map(|&shell| {
        let mean = model.mean_shell_thickness(shell);
        mean.map_or(f64::NAN, |mean| mean * factor)
    });
    Ok(TargetPart {
        rules,
        rule_of,
        n_plane,
        nominal_thickness: nominal.collect(),
        laws: laws(model, shells, None),
        mesh: shells.mesh.clone(),
    })
}
