//! Shows and takes over first poses and the starts of a match.

use std::sync::Arc;
use std::time::Duration;

use super::MatchState;
use super::result::show_alternative;
use crate::app::work::Work;
use crate::app::{LogStep, OfParts, facts};
use crate::registration::starts::Start;

impl MatchState {
    pub(super) fn show_start(&mut self, work: &mut Work<'_>, index: Option<usize>) {
        work.previews.hovered = None;
        work.previews.pinned = None;
        if work.is_unlocked().is_err() {
            return;
        }
        let n_starts = self.starts_of(work.document).map_or(0, |s| s.len());
        work.previews.start = index.filter(|i| *i < n_starts);
    }

    pub(super) fn step_start(&mut self, work: &mut Work<'_>, direction: i32) {
        let Some(starts) = self.starts_of(work.document).filter(|s| !s.is_empty()) else {
            return;
        };
        let n_starts = starts.len();
        let next = match work.previews.start {
            None if direction > 0 => 0,
            None => n_starts - 1,
            Some(shown) if direction > 0 => (shown + 1) % n_starts,
            Some(shown) => (shown + n_starts - 1) % n_starts,
        };
        self.show_start(work, Some(next));
    }

    pub(super) fn use_start(&mut self, work: &mut Work<'_>, index: usize) {
        let start = self.starts_of(work.document).and_then(|s| s.get(index));
        let Some(pose) = start.map(|s| s.target_from_source) else {
            return;
        };
        if work.can_move().is_ok() {
            work.commit_pose(format!("Start pose {}", index + 1), None, pose);
            work.previews.drop_all();
        }
    }

    /// A start that gave the result or one of its alternatives shows that, so that the result stays
    /// current; any other start moves the part.
    pub(super) fn use_match_start(&mut self, work: &mut Work<'_>, index: usize) {
        let Some(pose) = self.start(work.document, index).map(|start| start.last) else {
            return;
        };
        if work.can_move().is_err() {
            return;
        }
        let outcome = work
            .document
            .result
            .as_ref()
            .filter(|_| !self.has_live_starts(work.document));
        let known = outcome.and_then(|result| {
            let outcome = &result.run.outcome;
            let alternative = outcome.alternatives.iter().position(|a| a.start == index);
            let is_winner = outcome.winner == index;
            is_winner.then_some(None).or(alternative.map(Some))
        });
        match known {
            Some(alternative) => show_alternative(work, alternative),
            None => {
                work.commit_pose(format!("Pose of start {}", index + 1), None, pose);
            }
        }
        work.previews.drop_all();
    }

    pub(in crate::app) fn take_aligned(
        &mut self,
        work: &mut Work<'_>,
        poses: Arc<Vec<Start>>,
        took: Duration,
    ) {
        let n_poses = poses.len();
        let text = facts::counted(n_poses, "start pose");
        work.log_step(LogStep::Align, None, text, Some(took));
        let made_with = work.document.recipe.settings.starts.clone();
        self.starts = Some(OfParts::new(work.document, (made_with, poses.into())));
        work.previews.start = (n_poses > 0).then_some(0);
    }
}
