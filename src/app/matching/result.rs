//! Taking a match over, and choosing among its poses.

use std::sync::Arc;
use std::time::Duration;

use super::MatchState;
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{Effect, GestureId, LogStep, MatchResult, NoticeLevel, OfParts, facts};
use crate::geometry::Similarity;
use crate::jobs::Stamp;
use crate::pipeline::match_parts::MatchRun;
use crate::role::Role;

/// A run that took longer is worth a word to the desktop.
const LONG_RUN: Duration = Duration::from_secs(10);

impl MatchState {
    pub(in crate::app) fn take_matched(
        &mut self,
        work: &mut Work<'_>,
        run: Arc<MatchRun>,
        took: Duration,
    ) -> Vec<Effect> {
        let (line, level) = (
            facts::match_line(&run, work.lengths()),
            facts::match_level(&run),
        );
        for (step, text, took) in facts::match_steps(&run) {
            work.log_step(step, None, text, Some(took));
        }
        work.previews.live = None;
        self.live_starts = OfParts::default();
        let pose = run.crash_from_stamped;
        let before = work.document.stamped_center();
        let gesture = self.remedy_gesture.take();
        let step = ("Match".to_owned(), gesture);
        let length_factors = work.document.length_factors();
        take_pose_as_result(work, step, pose, |stamp| MatchResult {
            run: run.into(),
            alternative: None,
            stamp,
            length_factors,
        });
        // Its phases have their own rows; counting the whole again would double the total.
        work.log
            .push(level, LogStep::Result, None, line.clone(), None);
        work.follow(FollowUp::Matched {
            before,
            // What was found is no failure: its message goes with the result.
            level: level.min(NoticeLevel::Warning),
            line,
        });
        if took >= LONG_RUN {
            vec![Effect::NotifyDesktop]
        } else {
            Vec::new()
        }
    }
}

pub(super) fn show_alternative(work: &mut Work<'_>, alternative: Option<usize>) {
    let Some(result) = work.document.result.clone() else {
        return;
    };
    let is_same_pair = result.stamp.parts == work.document.stamp().parts;
    let pose = result.run.pose(alternative);
    let Some(crash_from_stamped) = pose.filter(|_| is_same_pair) else {
        return;
    };
    if work.can_move().is_err() {
        return;
    }
    let name = match alternative {
        None => "Best pose".to_owned(),
        Some(index) => format!("Alternative {}", index + 2),
    };
    work.log_step(LogStep::Match, Some(Role::Stamped), name.clone(), None);
    take_pose_as_result(work, (name, None), crash_from_stamped, |stamp| {
        MatchResult {
            alternative,
            stamp,
            ..result
        }
    });
}

pub(super) fn next_alternative(work: &mut Work<'_>) {
    let Some(result) = &work.document.result else {
        return;
    };
    let n_alternatives = facts::n_alternatives(&result.run);
    let next = result.alternative.map_or(0, |index| index + 1);
    let next = (next < n_alternatives).then_some(next);
    show_alternative(work, next);
}

/// Pose and result as one undo step, or as part of the one that is still open.
fn take_pose_as_result(
    work: &mut Work<'_>,
    (name, gesture): (String, Option<GestureId>),
    crash_from_stamped: Similarity,
    result: impl FnOnce(Stamp) -> MatchResult,
) {
    let revision = work.history.next_revision();
    work.previews.drop_all();
    work.commit_in(name, gesture, |document| {
        // What was made at the very same pose, such as a mapping, still holds.
        if document.pose.crash_from_stamped != crash_from_stamped {
            document.pose.crash_from_stamped = crash_from_stamped;
            document.pose.revision = revision;
        }
        document.result = Some(result(document.stamp()));
    });
}
