//! Poses that count as one, and the starts that agree in one.

use super::result::{StartOutcome, StartRecord};
use super::surface::Measures;
use crate::geometry::{Aabb, Point3, Similarity};

/// Poses that differ by less than this angle …
const SAME_ANGLE_DEG: f64 = 3.0;
/// … and move the centre of the part by less than this fraction of its size are one pose: a further
/// refinement would bring them together.
const SAME_SHIFT: f64 = 0.02;

/// Where a part lies in its own frame, and how large it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extent {
    /// Centre of the part in its own frame.
    pub center: Point3,
    /// Diagonal of its box.
    pub diagonal: f64,
}

impl From<&Aabb> for Extent {
    fn from(bounds: &Aabb) -> Self {
        Self {
            center: bounds.center(),
            diagonal: bounds.diagonal(),
        }
    }
}

impl From<&Measures> for Extent {
    fn from(measures: &Measures) -> Self {
        Self {
            center: measures.centroid,
            diagonal: measures.diagonal,
        }
    }
}

/// True if both poses of a part of this extent have the same hand and lie within 3° and 2 % of its
/// size of each other.
pub fn same_pose(a: &Similarity, b: &Similarity, part: &Extent) -> bool {
    a.is_mirrored() == b.is_mirrored()
        && a.angle_to(b) < SAME_ANGLE_DEG.to_radians()
        && a.max_displacement(b, [&part.center]) < SAME_SHIFT * part.diagonal * b.scale
}

/// Starts that agree in one pose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StartGroup {
    /// Their numbers, the best first. Never empty.
    pub members: Vec<usize>,
}

impl StartGroup {
    /// The start that stands for all.
    pub fn best(&self) -> usize {
        self.members[0]
    }
}

/// Groups starts by the pose they ended in, the winner's group first, then those that went farther
/// and fit better. How many agree is the most convincing figure of a match.
///
/// A start that met another belongs to that one's group. Any other that ended with a pose belongs
/// to the first group of that pose; one that still runs or failed stays alone. `part` is the extent
/// of the source. O(starts · groups).
pub fn group_starts(starts: &[StartRecord], part: &Extent) -> Vec<StartGroup> {
    let mut order: Vec<usize> = (0..starts.len()).collect();
    order.sort_by(|&a, &b| {
        let (x, y) = (rank(a, &starts[a]), rank(b, &starts[b]));
        x.class
            .cmp(&y.class)
            .then(y.n_iterations.cmp(&x.n_iterations))
            .then(x.score.total_cmp(&y.score))
            .then(a.cmp(&b))
    });
    let has_met = |&start: &usize| met(&starts[start]).is_some();
    let (have_met, leading): (Vec<usize>, Vec<usize>) = order.into_iter().partition(has_met);
    let mut groups: Vec<StartGroup> = Vec::new();
    // Those that met another come last, so that the group they belong to is there already.
    for start in leading.into_iter().chain(have_met) {
        let home = last_met(starts, start).unwrap_or(start);
        let group = groups.iter_mut().find(|group| {
            let leader = &starts[group.best()];
            group.members.contains(&home)
                || home == start
                    && has_pose(&starts[start])
                    && has_pose(leader)
                    && same_pose(&starts[start].last, &leader.last, part)
        });
        match group {
            Some(group) => group.members.push(start),
            None => groups.push(StartGroup {
                members: vec![start],
            }),
        }
    }
    groups
}

/// What starts are sorted by: class and score ascending, iterations descending.
struct Rank {
    class: u8,
    n_iterations: usize,
    score: f64,
}

fn rank(number: usize, start: &StartRecord) -> Rank {
    let (class, n_iterations, score) = match start.outcome {
        Some(StartOutcome::Won) => (0, 0, start.score),
        // Running starts keep their order, so that a table of them does not jump.
        None => (1, 0, number as f64),
        Some(StartOutcome::RunnerUp) => (2, 0, start.score),
        Some(StartOutcome::MergedInto { .. }) => (3, 0, start.score),
        Some(StartOutcome::Dropped { after }) => (4, after, start.score),
        Some(StartOutcome::Failed) => (5, 0, start.score),
    };
    Rank {
        class,
        n_iterations,
        score,
    }
}

fn has_pose(start: &StartRecord) -> bool {
    !matches!(start.outcome, None | Some(StartOutcome::Failed))
}

/// The start it was merged into.
fn met(start: &StartRecord) -> Option<usize> {
    match start.outcome {
        Some(StartOutcome::MergedInto { start }) => Some(start),
        _ => None,
    }
}

/// The end of the chain of starts that met: one that was met may itself have met another.
fn last_met(starts: &[StartRecord], start: usize) -> Option<usize> {
    let mut at = None;
    // A chain is shorter than the list; a damaged file must not make it endless.
    for _ in 0..starts.len() {
        let next = met(starts.get(at.unwrap_or(start))?);
        let Some(next) = next else { break };
        at = Some(next);
    }
    at
}
