//! Undo, redo, and jumps in the history.

use crate::app::{AppState, Effect, HistoryCommand, ModalInput, MoveCommand, PartRef, StampedPose};
use crate::role::Role;

impl AppState {
    pub(super) fn apply_history(&mut self, command: HistoryCommand) -> Vec<Effect> {
        if self.is_unlocked().is_err() {
            return Vec::new();
        }
        if self.view.move_tool.is_some() {
            self.apply_move(MoveCommand::Input(ModalInput::Reject));
        }
        match command {
            HistoryCommand::Undo => self.undo(),
            HistoryCommand::Redo => self.redo(),
            HistoryCommand::JumpTo(n_done) => self.jump_to(n_done),
            HistoryCommand::ResetAll => self.reset_all(),
        }
        Vec::new()
    }

    fn undo(&mut self) {
        if let Some((name, document)) = self.history.undo(self.document.clone()) {
            self.document = document;
            self.after_jump();
            self.log_step("undo", None, name, None);
        }
    }

    fn redo(&mut self) {
        if let Some((name, document)) = self.history.redo(self.document.clone()) {
            self.document = document;
            self.after_jump();
            self.log_step("redo", None, name, None);
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

    /// What the view points at may be gone.
    fn after_jump(&mut self) {
        self.drop_previews();
        let document = &self.document;
        let is_there = |part: &PartRef| document.part(part.role).is_some();
        self.view.selected.retain(is_there);
    }

    fn reset_all(&mut self) {
        let revision = self.next_revision();
        self.drop_previews();
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
            let as_loaded = StampedPose::default().crash_from_stamped;
            if document.pose.crash_from_stamped != as_loaded {
                document.pose = StampedPose {
                    crash_from_stamped: as_loaded,
                    revision,
                };
            }
        });
    }
}
