//! Starts that ended in the same pose count as one: how many agree is the most convincing number.

use crate::geometry::{Point3, Similarity};
use crate::registration::{Fate, MatchOutcome, StartRecord};

/// Poses that differ by less than this angle, in degrees, and move the part's centre by less than
/// this share of its size are the same before the last refinement.
const SAME_ANGLE_DEG: f64 = 3.0;
const SAME_SHARE: f64 = 0.02;

/// Starts that ended in one pose.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StartGroup {
    /// The start that went farthest and best; it stands for all.
    pub best: usize,
    /// All of them, in the order they were tried.
    pub starts: Vec<usize>,
}

/// Groups the starts of a match by where they ended, the winner's group first, then those that went
/// farther and fit better. `center` and `diagonal` are those of the source. O(starts · groups).
pub fn start_groups(outcome: &MatchOutcome, center: &Point3, diagonal: f64) -> Vec<StartGroup> {
    let starts = &outcome.starts;
    let mut order: Vec<usize> = (0..starts.len()).collect();
    order.sort_by(|&a, &b| {
        rank(&starts[a]).cmp(&rank(&starts[b])).then_with(|| {
            let (a, b) = (&starts[a], &starts[b]);
            let farther = b.iterations.len().cmp(&a.iterations.len());
            let is_dropped = matches!(a.fate, Fate::Dropped { .. });
            let better = a.score.total_cmp(&b.score);
            if is_dropped {
                farther.then(better)
            } else {
                better
            }
        })
    });
    let is_same = |a: &Similarity, b: &Similarity| {
        a.is_mirrored() == b.is_mirrored()
            && a.angle_to(b) < SAME_ANGLE_DEG.to_radians()
            && (a.apply(center) - b.apply(center)).norm() < SAME_SHARE * diagonal * b.scale
    };
    let mut groups: Vec<StartGroup> = Vec::new();
    for start in order {
        let pose = &starts[start].last;
        let known = groups
            .iter_mut()
            .find(|group| is_same(&starts[group.best].last, pose));
        match known {
            Some(group) => group.starts.push(start),
            None => groups.push(StartGroup {
                best: start,
                starts: vec![start],
            }),
        }
    }
    for group in &mut groups {
        group.starts.sort_unstable();
    }
    groups
}

fn rank(start: &StartRecord) -> u8 {
    match start.fate {
        Fate::Won => 0,
        Fate::RunnerUp => 1,
        Fate::MergedInto { .. } => 2,
        Fate::Dropped { .. } => 3,
        Fate::Failed => 4,
    }
}
