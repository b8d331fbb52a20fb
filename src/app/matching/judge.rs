//! The verdict follows the shape tolerance: the match is assessed again, its pose stays.

use std::sync::Arc;
use std::time::Duration;

use super::MatchState;
use crate::app::work::Work;
use crate::app::{Effect, LogStep, facts};
use crate::jobs::{JobKey, JobKind, VerdictInput};
use crate::pipeline::match_parts::MatchRun;

impl MatchState {
    /// Asks for the verdict of the present result with the present tolerance, where it was judged with
    /// another one. Undo and projects need nothing more.
    pub(in crate::app) fn keep_judging(&mut self, work: &mut Work<'_>) -> Vec<Effect> {
        let shape_tolerance = work.document.recipe.settings.shape_tolerance;
        let Some(result) = work.document.current_result() else {
            return Vec::new();
        };
        if result.run.recipe.settings.shape_tolerance == shape_tolerance {
            self.judging_asked = None;
            return Vec::new();
        }
        let asked = Some((result.stamp, shape_tolerance));
        let is_free = work.is_unlocked().is_ok() && !work.jobs.is_active(JobKey::Verdict);
        let Some(both) = work.document.both().filter(|_| is_free) else {
            return Vec::new();
        };
        if self.judging_asked == asked {
            return Vec::new();
        }
        let input = VerdictInput {
            parts: both.map(|part| part.loaded.to_arc()),
            run: result.run.to_arc(),
            shape_tolerance,
        };
        self.judging_asked = asked;
        vec![work.start(JobKind::Verdict(input))]
    }

    /// A verdict or a measurement was discarded: what is shown may need it again.
    pub(in crate::app) fn forget_asked(&mut self) {
        self.judging_asked = None;
        self.alternative_asked = None;
    }

    /// The new verdict belongs to the step that changed the tolerance. One of a match or a tolerance that
    /// is no longer there is dropped.
    pub(in crate::app) fn take_judged(
        &mut self,
        work: &mut Work<'_>,
        run: &Arc<MatchRun>,
        took: Duration,
    ) {
        self.judging_asked = None;
        let wanted = work.document.recipe.settings.shape_tolerance;
        let Some(result) = &mut work.document.result else {
            return;
        };
        let is_it = Arc::ptr_eq(&result.run.outcome, &run.outcome);
        if !is_it || run.recipe.settings.shape_tolerance != wanted {
            return;
        }
        let before = result.run.assessment.verdict;
        result.run = Arc::clone(run).into();
        // A drag gives many verdicts; those that say the same need no row.
        if run.assessment.verdict != before {
            let line = facts::match_line(run, work.lengths());
            work.log_step(LogStep::Verdict, None, line, Some(took));
        }
    }
}
