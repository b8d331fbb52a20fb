//! The overlap number that follows a move.

use super::MovingState;
use crate::app::work::Work;
use crate::app::{AppState, Effect};
use crate::geometry::Similarity;
use crate::jobs::{JobKey, JobKind, MeasureInput, Stamp};
use crate::role::Role;

/// How much of the better covered part lies on the other, measured after each move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseOverlap {
    /// The state it was measured at.
    pub stamp: Stamp,
    /// The part that is covered better.
    pub of: Role,
    /// Share of its area, 0 to 1.
    pub overlap: f64,
    /// Distance up to which a place counts as covered.
    pub limit: f64,
    /// Against the pose before, if it was the same part that was covered better.
    pub change: Option<f64>,
}

impl AppState {
    /// The overlap at the pose the part has now.
    pub fn current_overlap(&self) -> Option<&PoseOverlap> {
        let stamp = self.document.stamp();
        let known = self.moving.overlap.as_ref();
        known.filter(|known| known.stamp == stamp)
    }
}

impl MovingState {
    /// After each move the overlap is measured anew, so that one feels warmer or colder.
    pub(in crate::app) fn keep_measuring_overlap(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        let stamp = work.document.stamp();
        let is_at_rest = !self.is_moving();
        let is_as_loaded = *work.document.crash_from_stamped() == Similarity::identity();
        let is_known = self.overlap_asked == Some(stamp);
        let is_moved = !is_known && (!is_as_loaded || self.overlap.is_some());
        let is_free = work.is_unlocked().is_ok() && !work.jobs.is_active(JobKey::Overlap);
        if !(is_at_rest && is_moved && is_free) {
            return Vec::new();
        }
        let Some(both) = work.document.both() else {
            return Vec::new();
        };
        let input = MeasureInput {
            parts: both.map(|part| part.loaded.to_arc()),
            crash_from_stamped: *work.document.crash_from_stamped(),
            alternative_of: None,
        };
        self.overlap_asked = Some(stamp);
        vec![work.start(JobKind::Overlap(input))]
    }

    /// A number was discarded: what is shown may need it again.
    pub(in crate::app) fn forget_asked(&mut self) {
        self.overlap_asked = None;
    }

    pub(in crate::app) fn take_overlap(
        &mut self,
        of: Role,
        overlap: f64,
        limit: f64,
        stamp: Stamp,
    ) {
        let before = self
            .overlap
            .filter(|known| known.stamp.parts == stamp.parts);
        // Of parts that do not meet neither is covered better: it goes on to be told of the same one.
        let of = before
            .filter(|_| overlap == 0.0)
            .map_or(of, |before| before.of);
        let before = before.filter(|before| before.of == of || before.overlap == 0.0);
        self.overlap = Some(PoseOverlap {
            stamp,
            of,
            overlap,
            limit,
            change: before.map(|before| overlap - before.overlap),
        });
    }
}
