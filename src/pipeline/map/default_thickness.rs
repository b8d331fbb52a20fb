//! What is written as the thickness of elements that carry no values.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::MapRun;
use crate::geometry::chunks::{CHUNK, for_chunks};
use crate::monitor::{Cancelled, Monitor};

/// Thickness of the elements without values in the files that are written.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DefaultThickness {
    /// They keep what the crash deck gives them, on their own card or by their section: nothing is written for them.
    #[default]
    Section,
    /// This one, in the crash model's unit of lengths.
    Fixed(f64),
    /// That of the nearest element with a thickness, along the mesh. Elements that hang together with none keep
    /// theirs.
    Nearest,
}

impl DefaultThickness {
    /// The thickness of every element without values, by its place in the run. O(elements).
    pub(super) fn of(
        self,
        run: &MapRun,
        monitor: &Monitor,
    ) -> Result<Vec<(usize, f64)>, Cancelled> {
        let without = |element: &usize| !run.mapped.elements[*element].status.has_values();
        let elements = (0..run.shells.len()).filter(without);
        Ok(match self {
            Self::Section => Vec::new(),
            Self::Fixed(thickness) => elements.map(|element| (element, thickness)).collect(),
            Self::Nearest => {
                let nearest = spread(run, monitor)?;
                let known = elements.map(|element| (element, nearest[element]));
                known
                    .filter(|(_, thickness)| thickness.is_finite())
                    .collect()
            }
        })
    }
}

/// The mapped thickness carried from element to neighbour until all that can be reached have that of the nearest,
/// by the way from centre to centre; of several as near that of the first in the deck. O(elements · log of those
/// without).
fn spread(run: &MapRun, monitor: &Monitor) -> Result<Vec<f64>, Cancelled> {
    let mesh = &run.target.mesh;
    let links = mesh.links(monitor)?;
    let neighbours = &links.neighbours;
    let known: Vec<f64> = (0..mesh.len())
        .map(|element| run.thickness(element))
        .collect();
    let mut thickness = known.clone();
    // The way so far, the element that it comes from and the one that it leads to. Bits of numbers that are not
    // negative rise with them.
    let mut ways = BinaryHeap::new();
    let go_on = |ways: &mut BinaryHeap<_>, way: f64, from: usize, element: usize| {
        let centre = mesh.centroids()[element];
        for &next in neighbours.of(element) {
            if !known[next as usize].is_finite() {
                let way = way + (mesh.centroids()[next as usize] - centre).norm();
                ways.push(Reverse((way.to_bits(), from, next as usize)));
            }
        }
    };
    for_chunks(mesh.len(), monitor, |range| {
        for element in range.filter(|&element| known[element].is_finite()) {
            go_on(&mut ways, 0.0, element, element);
        }
    })?;
    let mut n_done = 0;
    while let Some(Reverse((way, from, element))) = ways.pop() {
        if n_done % CHUNK == 0 {
            monitor.check()?;
        }
        n_done += 1;
        if !thickness[element].is_finite() {
            thickness[element] = known[from];
            go_on(&mut ways, f64::from_bits(way), from, element);
        }
    }
    Ok(thickness)
}
