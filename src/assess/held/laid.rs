//! A pose that a start by holes gave lies only as exactly as the middles of a few holes; where surfaces leave it free, the
//! search along the free motion, which fits all borders, places the same pose better.

use super::{Pair, Settled};
use crate::registration::{MatchOutcome, StartKind, StartRecord, same_pose};

impl Pair<'_> {
    /// The rival beside a result that holes gave of whose borders the most lies where it belongs, if that is more than
    /// of the result's.
    pub(super) fn laid_better(
        &self,
        result: &Settled,
        rivals: &[Settled],
        outcome: &MatchOutcome,
    ) -> Option<Settled> {
        if !self.is_by_holes(outcome) {
            return None;
        }
        let corners = self.source.mesh().aabb().corners();
        let is_better = |other: &&Settled| {
            let away = other.pose.max_displacement(&result.pose, &corners);
            away < self.near && other.held > result.held && other.n_holes >= result.n_holes
        };
        let better = rivals.iter().filter(is_better);
        better.max_by(|a, b| a.held.total_cmp(&b.held)).copied()
    }

    /// Whether a start that holes gave ended at the result of the match.
    fn is_by_holes(&self, outcome: &MatchOutcome) -> bool {
        let part = self.source.measures().into();
        let by_holes = |start: &&StartRecord| matches!(start.kind, StartKind::Holes { .. });
        let mut starts = outcome.starts.iter().filter(by_holes);
        starts.any(|start| same_pose(&start.last, &outcome.target_from_source, &part))
    }
}
