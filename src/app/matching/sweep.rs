//! The sweep over levels and settings, and the rows that come in.

use std::sync::Arc;
use std::time::Duration;

use super::MatchState;
use super::run::start_with_input;
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{AppState, Document, Effect, LogStep, NoticeLevel, OfParts};
use crate::jobs::{JobKey, JobKind, SweepInput, SweepRows};
use crate::pipeline::sweep::{Sweep, SweepSettings};
use crate::role::Role;

impl AppState {
    /// The tables of the running sweep as far as they are measured, or those of the last one.
    pub fn shown_sweep(&self) -> Option<&Sweep> {
        let so_far = self.matching.sweep_so_far.as_ref();
        let running = so_far.filter(|_| self.jobs.is_active(JobKey::Sweep));
        match running.and_then(|so_far| so_far.current(&self.document)) {
            Some((sweep, _)) => Some(sweep),
            None => self.matching.sweep(&self.document).map(|sweep| &**sweep),
        }
    }
}

impl MatchState {
    pub(super) fn run_sweep(
        &mut self,
        work: &mut Work<'_>,
        mut settings: SweepSettings,
    ) -> Vec<Effect> {
        let Some(recipe) = work.document.recipe_to_run() else {
            return Vec::new();
        };
        settings
            .settings
            .starts
            .poses
            .clone_from(&recipe.settings.starts.poses);
        let rows = SweepRows::default();
        let told = rows.clone();
        let effects = start_with_input(work, recipe, |input| {
            JobKind::Sweep(SweepInput {
                parts: input.parts,
                settings,
                rows,
            })
        });
        if !effects.is_empty() {
            let n_triangles = work
                .document
                .part(Role::Stamped)
                .map_or(0, |part| part.loaded.report.n_triangles);
            let begun = Sweep {
                n_triangles,
                ..Sweep::default()
            };
            self.sweep_so_far = Some(OfParts::new(work.document, (begun, told)));
            work.follow(FollowUp::SweepBegun);
        }
        effects
    }

    /// Takes over the rows that the running sweep has measured since the last look.
    pub(in crate::app) fn take_sweep_rows(&mut self, document: &Document) {
        let so_far = self.sweep_so_far.as_mut();
        if let Some((sweep, rows)) = so_far.and_then(|so_far| so_far.current_mut(document)) {
            for row in rows.take() {
                sweep.push(row);
            }
        }
    }

    pub(in crate::app) fn take_swept(
        &mut self,
        work: &mut Work<'_>,
        table: Arc<Sweep>,
        (took, was_stopped): (Duration, bool),
    ) {
        self.sweep = Some(OfParts::new(work.document, table.into()));
        self.sweep_so_far = None;
        work.follow(FollowUp::SweepEnded);
        let (level, text) = if was_stopped {
            (
                NoticeLevel::Info,
                "sweep stopped; the rows measured so far are kept",
            )
        } else {
            (NoticeLevel::Success, "sweep finished")
        };
        work.log_at(level, LogStep::Sweep, None, text, Some(took));
    }
}
