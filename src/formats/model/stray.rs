//! Nodes that lie absurdly far from all others, as a slip in a number puts them there.

use std::path::Path;
use std::sync::Arc;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Position};
use super::Model;
use crate::geometry::Point3;
use crate::geometry::chunks::for_chunks;
use crate::monitor::{Cancelled, Monitor};

/// A node that lies so many times as far from the middle of all as the others reach is out of place: no two parts of a
/// car, in whatever units, are so far apart.
const FAR: f64 = 1000.0;
/// Nodes that tell how far all reach, spread over the file.
const N_SAMPLE: usize = 4096;
/// Fewer nodes tell nothing.
const LEAST: usize = 8;
/// At most this share of the nodes may be out of place; of few nodes this many.
const SHARE: f64 = 0.01;
const FEW: usize = 3;
/// Nodes that are named.
const N_NAMED: usize = 6;

impl Model {
    /// Finds the nodes of elements that lie absurdly far from all others and names them in an error. Their elements
    /// make no surface ([`Model::is_stray`]). O(nodes), and O(elements) where there is such a node.
    pub(in crate::formats) fn find_stray_nodes(
        &mut self,
        path: &Path,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let positions = self.nodes.positions();
        let Some((middle, reach)) = usual_reach(positions) else {
            return Ok(());
        };
        let mut far: Vec<u32> = Vec::new();
        for_chunks(positions.len(), monitor, |range| {
            let is_far = |&node: &usize| (positions[node] - middle).norm() > FAR * reach;
            far.extend(range.filter(is_far).map(|node| node as u32));
        })?;
        if far.is_empty() || far.len() > n_out_of_place(positions.len()) {
            return Ok(());
        }
        let mut is_used = vec![false; far.len()];
        let mut n_elements = 0;
        let mut take = |nodes: &[u32]| {
            let mut is_one = false;
            for node in nodes {
                if let Ok(at) = far.binary_search(node) {
                    (is_used[at], is_one) = (true, true);
                }
            }
            n_elements += usize::from(is_one);
        };
        for_chunks(self.shells.len(), monitor, |range| {
            self.shells[range]
                .iter()
                .for_each(|shell| take(&shell.nodes));
        })?;
        for_chunks(self.solids.len(), monitor, |range| {
            self.solids[range]
                .iter()
                .for_each(|solid| take(&solid.nodes));
        })?;
        let used = far.iter().zip(is_used).filter(|(_, is_used)| *is_used);
        self.stray_nodes = used.map(|(&node, _)| node).collect();
        if !self.stray_nodes.is_empty() {
            let diagnostic = self.stray_nodes_told(n_elements);
            let place = Position::file(&Arc::from(path));
            self.diagnostics.push(diagnostic.at(place));
        }
        Ok(())
    }

    /// Whether an element has a node that lies absurdly far from all others.
    pub(super) fn is_stray(&self, nodes: &[u32]) -> bool {
        let is_one = |node: &u32| self.stray_nodes.binary_search(node).is_ok();
        !self.stray_nodes.is_empty() && nodes.iter().any(is_one)
    }

    fn stray_nodes_told(&self, n_elements: usize) -> Diagnostic {
        let all = &self.stray_nodes;
        let ids = all.iter().take(N_NAMED);
        let ids: Vec<String> =
            (ids.map(|&node| self.nodes.ids()[node as usize].to_string())).collect();
        let (noun, verb) = match all.len() {
            1 => ("node", "lies"),
            _ => ("nodes", "lie"),
        };
        let more = match all.len() - ids.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let elements = match n_elements {
            1 => "its one element is".to_owned(),
            n => format!("the {n} elements there are"),
        };
        let message = format!(
            "{noun} {}{more} {verb} more than {FAR} times as far away as all other nodes reach; {elements} left out",
            ids.join(", ")
        );
        let p = self.nodes.positions()[all[0] as usize];
        Diagnostic::new(DiagnosticKind::StrayNode, message)
            .found(format!("({:.4e}, {:.4e}, {:.4e})", p.x, p.y, p.z))
            .expected("coordinates beside those of the other nodes")
    }
}

/// The middle of the nodes, and how far from it they reach without those that may be out of place; `None` where this
/// tells nothing.
fn usual_reach(positions: &[Point3]) -> Option<(Point3, f64)> {
    let every = positions.len().div_ceil(N_SAMPLE).max(1);
    let sample: Vec<&Point3> = positions.iter().step_by(every).collect();
    let n = sample.len();
    if n < LEAST {
        return None;
    }
    let median = |axis: usize| {
        let mut values: Vec<f64> = sample.iter().map(|p| p[axis]).collect();
        *values.select_nth_unstable_by(n / 2, f64::total_cmp).1
    };
    let middle = Point3::new(median(0), median(1), median(2));
    let mut distances: Vec<f64> = sample.iter().map(|p| (*p - middle).norm()).collect();
    let at = n - 1 - n_out_of_place(n);
    let reach = *distances.select_nth_unstable_by(at, f64::total_cmp).1;
    (reach > 0.0 && reach.is_finite()).then_some((middle, reach))
}

/// How many of `n` nodes may be out of place.
fn n_out_of_place(n: usize) -> usize {
    ((n as f64 * SHARE) as usize).max(FEW.min(n / LEAST))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{Memory, ReadOptions, Selection, read_from};

    /// A sheet of ten by ten quads, of which the nodes with these ids lie elsewhere.
    fn sheet(moved: impl Fn(u32) -> bool, elsewhere: f64) -> Model {
        let mut deck = "*KEYWORD\n*NODE\n".to_owned();
        let mut shells = "*ELEMENT_SHELL\n".to_owned();
        for id in 1..=121 {
            let (column, row) = ((id - 1) % 11, (id - 1) / 11);
            let x = if moved(id) {
                elsewhere
            } else {
                5.0 * f64::from(column)
            };
            deck += &format!("{id},{x},{}.,0.\n", 5 * row);
            if column < 10 && row < 10 {
                shells += &format!("{id},1,{id},{},{},{}\n", id + 1, id + 12, id + 11);
            }
        }
        // A node that no element has, such as one for an axis, may lie anywhere.
        deck += "900,1.e9,0.,0.\n";
        let deck = deck + &shells + "*END\n";
        let source = Memory::new().with("deck.k", deck.into_bytes());
        let options = ReadOptions::default();
        read_from(&source, Path::new("deck.k"), &options, &Monitor::silent()).unwrap()
    }

    fn told(model: &Model) -> Vec<String> {
        let all = model.diagnostics.iter();
        let strays = all.filter(|one| one.kind == DiagnosticKind::StrayNode);
        strays.map(|one| one.message.clone()).collect()
    }

    fn n_triangles(model: &Model) -> usize {
        model.surface(&Selection::All).unwrap().mesh.n_triangles()
    }

    #[test]
    fn nodes_far_from_all_others_are_named_and_their_elements_left_out() {
        let model = sheet(|id| id == 1 || id == 60, 1e9);
        let expected = "nodes 1, 60 lie more than 1000 times as far away as all other nodes reach; the 5 elements there \
                        are left out";
        assert_eq!(told(&model), [expected]);
        assert_eq!(model.diagnostics.n_geometry_errors(), 1);
        assert_eq!(n_triangles(&model), 2 * (100 - 5));
        let one = sheet(|id| id == 1, -1e9);
        assert!(told(&one)[0].ends_with("; its one element is left out"));
    }

    #[test]
    fn nodes_that_only_lie_apart_stay() {
        for model in [
            sheet(|_| false, 0.0),
            sheet(|id| id == 60, 2e4),
            sheet(|id| id % 11 == 0, 1e9),
        ] {
            assert_eq!(told(&model), [""; 0]);
            assert_eq!(n_triangles(&model), 200);
        }
    }
}
