//! What follows from each command. Each group of commands has a file of its own.

mod export;
mod file;
mod history;
mod inspect;
mod jobs;
mod matching;
mod moving;
mod overlap;
mod pairs;
mod part;
mod project;
mod reduce;
mod units;
mod view;

use super::{AppState, Command, Effect, ModalInput, MoveCommand, NoticeCommand, Section, Settings};

impl AppState {
    /// Changes the state as the command says and returns what has to be done outside. A command
    /// that makes no sense now (its action is disabled) changes nothing.
    pub fn apply(&mut self, command: impl Into<Command>) -> Vec<Effect> {
        let command = command.into();
        if let Some(section) = Section::of_command(&command) {
            self.view.sections.touch(section);
        }
        let mut effects = self.apply_one(command);
        // Whatever changed, what the window shows of the distances follows.
        effects.extend(self.keep_comparing());
        effects.extend(self.keep_measuring_overlap());
        effects.extend(self.keep_measuring_alternative());
        effects
    }

    fn apply_one(&mut self, command: Command) -> Vec<Effect> {
        match command {
            Command::File(command) => self.apply_file(command),
            Command::Project(command) => self.apply_project(command),
            Command::Part(command) => self.apply_part(command),
            Command::Reduce(command) => self.apply_reduce(command),
            Command::Move(command) => self.apply_move(command),
            Command::Match(command) => self.apply_match(command),
            Command::Pair(command) => self.apply_pairs(command),
            Command::Export(command) => self.apply_export(command),
            Command::View(command) => self.apply_view(command),
            Command::Inspect(command) => self.apply_inspect(command),
            Command::History(command) => self.apply_history(command),
            Command::Notice(command) => self.apply_notice(command),
            Command::Settings(settings) => self.set_settings(*settings),
            Command::Job(event) => self.take_job_event(*event),
            Command::Live(live) => self.take_live(*live),
            Command::Escape => self.escape(),
            Command::Quit => self.quit(),
        }
    }

    fn apply_notice(&mut self, command: NoticeCommand) -> Vec<Effect> {
        match command {
            NoticeCommand::Dismiss(id) => self.notices.dismiss(id),
            NoticeCommand::MarkRead => self.notices.mark_read(),
            NoticeCommand::Tell(level, text) => self.log_at(level, "window", None, text, None),
        }
        Vec::new()
    }

    fn set_settings(&mut self, settings: Settings) -> Vec<Effect> {
        let settings = settings.sanitized();
        if settings == self.settings {
            return Vec::new();
        }
        self.settings = settings;
        vec![Effect::SaveSettings]
    }

    /// Ends what is on top: a dialog, a move by keys, a preview, then the running match.
    fn escape(&mut self) -> Vec<Effect> {
        if self.view.dialog.take().is_some() {
            Vec::new()
        } else if self.view.move_tool.is_some() {
            self.apply_move(MoveCommand::Input(ModalInput::Reject))
        } else if self.view.pair_tool.take().is_some() {
            Vec::new()
        } else if let Some(key) = self.locking_job() {
            self.cancel_job(key)
        } else if self.is_preview() {
            self.drop_previews();
            Vec::new()
        } else if self.jobs.is_busy() {
            let key = self.jobs.running().map(|job| job.key);
            key.map_or_else(Vec::new, |key| self.cancel_job(key))
        } else {
            self.view.selected.clear();
            self.view.is_graphics_only = false;
            Vec::new()
        }
    }
}
