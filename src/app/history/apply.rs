//! Undo, redo, and jumps in the history.

use super::HistoryCommand;
use crate::app::follow_up::{FollowUp, Places};
use crate::app::work::Work;
use crate::app::{Document, Effect, LogStep, StampedPose};
use crate::jobs::JobKey;
use crate::role::Role;

impl Work<'_> {
    pub(in crate::app) fn apply_history(&mut self, command: HistoryCommand) -> Vec<Effect> {
        match command {
            HistoryCommand::Undo => self.undo(),
            HistoryCommand::Redo => self.redo(),
            HistoryCommand::JumpTo(n_done) => self.jump_to(n_done),
            HistoryCommand::ResetAll => return self.reset_all(),
        }
        Vec::new()
    }

    fn undo(&mut self) {
        let done_at = self.history.undo_at();
        if let Some((name, document)) = self.history.undo(self.document.clone()) {
            self.jump(document);
            if let Some(at) = done_at {
                self.log.notices.withdraw_from(at);
            }
            self.log_step(LogStep::Undo, None, name, None);
        }
    }

    fn redo(&mut self) {
        if let Some((name, document)) = self.history.redo(self.document.clone()) {
            self.jump(document);
            self.log_step(LogStep::Redo, None, name, None);
        }
    }

    fn jump_to(&mut self, n_done: usize) {
        while self.history.n_done() > n_done && self.history.undo_name().is_some() {
            self.undo();
        }
        while self.history.n_done() < n_done && self.history.redo_name().is_some() {
            self.redo();
        }
    }

    /// What is shown and selected may be gone.
    fn jump(&mut self, document: Document) {
        let before = Places::of(self.document);
        *self.document = document;
        self.previews.drop_all();
        self.follow(FollowUp::SteppedInHistory(before));
    }

    /// A reduction that is under way would reduce a part again.
    fn reset_all(&mut self) -> Vec<Effect> {
        let reductions = Role::ALL.into_iter().map(JobKey::Reduce);
        let effects = reductions.flat_map(|key| self.cancel(key)).collect();
        let revision = self.history.next_revision();
        self.previews.drop_all();
        self.commit("Reset to initial state", |document| {
            for role in Role::ALL {
                if let Some(part) = document.parts.get_mut(role) {
                    part.level = None;
                    part.wanted_level = None;
                    part.hidden.clear();
                    part.colors.clear();
                }
            }
            document.result = None;
            document.end_remedies();
            let as_loaded = StampedPose::default().crash_from_stamped;
            if document.pose.crash_from_stamped != as_loaded {
                document.pose = StampedPose {
                    crash_from_stamped: as_loaded,
                    revision,
                };
            }
        });
        effects
    }
}
