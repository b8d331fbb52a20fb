//! What is written as the thickness of elements that carry no values.

use std::collections::VecDeque;

use super::MapRun;

/// Thickness of the elements without values in the files that are written.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DefaultThickness {
    /// They keep that of their section: nothing is written for them.
    #[default]
    Section,
    /// This one, in the crash model's unit of lengths.
    Fixed(f64),
    /// That of the nearest element with a thickness, counted in elements along the mesh. Elements that
    /// hang together with none keep that of their section.
    Nearest,
}

impl DefaultThickness {
    /// The thickness of every element without values, by its place in the run. O(elements).
    pub(super) fn of(self, run: &MapRun) -> Vec<(usize, f64)> {
        let without = |element: &usize| !run.mapped.elements[*element].status.has_values();
        let elements = (0..run.shells.len()).filter(without);
        match self {
            Self::Section => Vec::new(),
            Self::Fixed(thickness) => elements.map(|element| (element, thickness)).collect(),
            Self::Nearest => {
                let nearest = spread(run);
                let known = elements.map(|element| (element, nearest[element]));
                known
                    .filter(|(_, thickness)| thickness.is_finite())
                    .collect()
            }
        }
    }
}

/// The mapped thickness carried from element to neighbour until all that can be reached have one.
fn spread(run: &MapRun) -> Vec<f64> {
    let n = run.shells.len();
    let mut thickness: Vec<f64> = (0..n).map(|element| run.thickness(element)).collect();
    let neighbours = run.target.mesh.neighbours();
    let mut front: VecDeque<usize> = (0..n).filter(|&e| thickness[e].is_finite()).collect();
    while let Some(element) = front.pop_front() {
        for &next in neighbours.of(element) {
            let next = next as usize;
            if !thickness[next].is_finite() {
                thickness[next] = thickness[element];
                front.push_back(next);
            }
        }
    }
    thickness
}
