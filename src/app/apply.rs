//! Carries out each command: its topic is given its own state and the work, and what other topics must do
//! about it comes after.

use super::{
    AppState, Command, Dialog, Effect, FreeWindow, LogStep, MatchCommand, NoticeCommand,
    NoticeLevel, Reason, Section, Settings, ViewCommand,
};
use crate::role::Role;

impl AppState {
    /// Changes the state as the command says and returns what has to be done outside. A command
    /// that makes no sense now (its action is disabled) changes nothing.
    #[must_use]
    pub fn apply(&mut self, command: impl Into<Command>) -> Vec<Effect> {
        let command = command.into();
        if let Some(section) = Section::of_command(&command) {
            self.view.sections.touch(section);
        }
        if Section::is_held_at(&command) {
            self.view.sections.hold();
        }
        if matches!(
            command,
            Command::Match(MatchCommand::Run | MatchCommand::Refine)
        ) {
            self.view.sections.arrange();
        }
        let was_start_shown = self.shown_start().is_some();
        let were_compared = self.are_windows_compared();
        let was_locked = self.jobs.is_unlocked().err();
        let mut effects = self.apply_one(command);
        while !self.follow_ups.is_empty() {
            let follow_up = self.follow_ups.remove(0);
            effects.extend(self.follow(follow_up));
        }
        // That it stood in the way was said while it did.
        if let Some(Reason(why)) = was_locked.filter(|_| self.jobs.is_unlocked().is_ok()) {
            self.log.notices.withdraw_text(why);
        }
        let are_compared = self.are_windows_compared();
        if self.shown_start().is_some() != was_start_shown || are_compared && !were_compared {
            self.with_scene(|view, scene| view.keep_whole(Role::Crash, scene));
        }
        effects.extend(self.keep_measuring());
        effects
    }

    fn apply_one(&mut self, command: Command) -> Vec<Effect> {
        let shown = self.shown_pose();
        let frame = match &command {
            Command::Move(_) => self.move_frame(),
            _ => None,
        };
        let is_run = matches!(command, Command::Match(MatchCommand::Run));
        let is_part_open = is_run && self.is_part_open();
        let (mut work, topics) = self.split();
        let work = &mut work;
        if command.ends_move() {
            topics.moving.reject_tool(work);
        }
        match command {
            Command::File(command) => return topics.parts.apply_file(work, command),
            Command::Project(command) => {
                let dialog = &mut topics.view.dialog;
                return topics.project.apply(work, command, dialog);
            }
            Command::Part(command) => return topics.parts.apply_part(work, command),
            Command::Reduce(command) => return topics.reduce.apply(work, command),
            Command::Move(command) => topics.moving.apply(work, command, frame),
            Command::Match(_) if is_part_open => return topics.matching.find_parts(work),
            Command::Match(command) => return topics.matching.apply(work, command),
            Command::Map(command) => return topics.mapping.apply(work, command),
            Command::Preview(command) => {
                let is_unlocked = work.is_unlocked().is_ok();
                work.previews.apply(command, is_unlocked);
            }
            Command::Pair(command) => topics.pairs.apply(work, command),
            Command::Export(command) => return work.apply_export(command),
            Command::View(command) => self.apply_view(command),
            Command::Inspect(command) => return topics.inspect.apply(work, command, &shown),
            Command::History(command) => {
                if work.is_unlocked().is_ok() {
                    return work.apply_history(command);
                }
            }
            Command::Notice(command) => match command {
                NoticeCommand::Dismiss(id) => work.log.notices.dismiss(id),
                NoticeCommand::MarkRead => work.log.notices.mark_read(),
                NoticeCommand::Explain(text) => {
                    work.log_at(NoticeLevel::Note, LogStep::Window, None, text, None);
                    work.log.notices.last_is_answer();
                }
                NoticeCommand::Tell(level, text) => {
                    work.log_at(level, LogStep::Window, None, text, None);
                }
            },
            Command::Settings(settings) => return self.apply_settings(*settings),
            Command::Job(event) => return self.take_job_event(*event),
            Command::Live(live) => self.take_live(*live),
            Command::CancelPresent => return self.work().cancel_present(),
            Command::Escape => return self.escape(),
            Command::Quit => return self.quit(),
        }
        Vec::new()
    }

    /// New preferences hold at once; maps that are not touched stay as the legend chose them.
    fn apply_settings(&mut self, settings: Settings) -> Vec<Effect> {
        let maps = |settings: &Settings| (settings.signed_map, settings.plain_map);
        let before = maps(&self.settings);
        let effects = self.work().set_settings(settings);
        if maps(&self.settings) != before {
            let coloring = &mut self.view.display.coloring;
            *coloring = coloring.with_maps_of(&self.settings);
        }
        effects
    }

    fn apply_view(&mut self, command: ViewCommand) {
        let is_section = matches!(command, ViewCommand::SetFreeWindow(FreeWindow::Section));
        if is_section && !self.inspect.section.is_on {
            self.inspect.section = self.toggled_section();
        }
        if matches!(
            command,
            ViewCommand::SetTab(_) | ViewCommand::ToggleGraphicsOnly
        ) {
            // The list the pointer was on may be gone.
            self.previews.hovered = None;
        }
        self.with_scene(|view, scene| view.apply(command, scene));
    }

    /// Whatever changed, what the window shows of the distances follows.
    fn keep_measuring(&mut self) -> Vec<Effect> {
        let mut effects = Vec::new();
        self.inspect.keep_distance(&self.document);
        let is_moving = self.moving.is_grabbed() || self.is_preview();
        let (shown, is_wanted) = (self.shown_pose(), self.wants_comparison());
        let is_part_open = self.is_part_open();
        let (mut work, topics) = self.split();
        if is_wanted {
            let inspect = topics.inspect;
            effects.extend(inspect.keep_comparing(&mut work, &shown, is_moving));
        }
        effects.extend(topics.moving.keep_measuring_overlap(&mut work));
        effects.extend(topics.matching.keep_measuring_alternative(&mut work));
        effects.extend(topics.matching.keep_judging(&mut work));
        effects.extend(topics.mapping.keep_placing(&mut work, is_part_open));
        effects
    }

    /// Closes what is open, the topmost first: a dialog, a tool, a preview, the messages, a marked place, the
    /// windows without panels. Only when nothing is open it ends the run, and at last the selection.
    fn escape(&mut self) -> Vec<Effect> {
        let is_preview = self.is_chosen_preview();
        let (mut work, topics) = self.split();
        let work = &mut work;
        if topics.view.dialog.take().is_some() {
            return Vec::new();
        }
        if topics.moving.tool.is_some() {
            topics.moving.reject_tool(work);
            return Vec::new();
        }
        if topics.pairs.tool.take().is_some() || topics.inspect.distance.take().is_some() {
            return Vec::new();
        }
        if is_preview {
            work.previews.drop_all();
            return Vec::new();
        }
        let is_closed = work.log.notices.close_toasts()
            || topics.inspect.forget_place()
            || std::mem::take(&mut topics.view.is_graphics_only);
        if is_closed {
            return Vec::new();
        }
        if work.jobs.is_busy() {
            return work.cancel_present();
        }
        topics.parts.selected.clear();
        Vec::new()
    }

    /// Leaves at once, or asks first if something would be lost.
    fn quit(&mut self) -> Vec<Effect> {
        if self.would_lose_work() {
            self.view.dialog = Some(Dialog::Unsaved);
            return Vec::new();
        }
        self.leave()
    }

    /// [`AppState::quit`], whatever runs.
    pub(super) fn leave(&mut self) -> Vec<Effect> {
        if self.is_unsaved() {
            self.view.dialog = Some(Dialog::Unsaved);
            return Vec::new();
        }
        vec![Effect::SaveSettings, Effect::Quit]
    }
}
