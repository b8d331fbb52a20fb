//! The overlap number that follows a move.

use crate::app::{AppState, Effect, PoseOverlap};
use crate::geometry::Similarity;
use crate::jobs::{JobKey, JobKind, MeasureInput, Stamp};
use crate::role::PerRole;

impl AppState {
    /// After each move the overlap is measured anew, so that one feels warmer or colder.
    pub(super) fn keep_measuring_overlap(&mut self) -> Vec<Effect> {
        let stamp = self.document.stamp();
        let is_at_rest = self.grab.is_none() && self.view.move_tool.is_none();
        let is_as_loaded = *self.document.crash_from_stamped() == Similarity::identity();
        let is_known = self.overlap_asked == Some(stamp);
        let is_moved = !is_known && (!is_as_loaded || self.overlap.is_some());
        let is_free = self.is_unlocked().is_ok() && !self.jobs.is_active(JobKey::Overlap);
        if !(is_at_rest && is_moved && is_free) {
            return Vec::new();
        }
        let Some((crash, stamped)) = self.document.both() else {
            return Vec::new();
        };
        let input = MeasureInput {
            parts: PerRole::new(crash, stamped).map(|part| part.loaded.to_arc()),
            crash_from_stamped: *self.document.crash_from_stamped(),
        };
        self.overlap_asked = Some(stamp);
        vec![self.start(JobKind::Overlap(input))]
    }

    pub(super) fn take_overlap(&mut self, overlap: f64, limit: f64, stamp: Stamp) {
        let before = self
            .overlap
            .filter(|known| known.stamp.parts == stamp.parts);
        self.overlap = Some(PoseOverlap {
            stamp,
            overlap,
            limit,
            change: before.map(|before| overlap - before.overlap),
        });
    }
}
