//! What saving of projects changes, and the questions before one is opened.

use std::path::PathBuf;

use super::{Kept, ProjectCommand, ProjectState};
use crate::app::follow_up::FollowUp;
use crate::app::work::Work;
use crate::app::{Action, Dialog, Document, Effect, LogStep, NoticeLevel};
use crate::jobs::{JobKind, Located, ProjectFile, ProjectRequest};
use crate::pipeline::project::{EXTENSION, with_ending};
use crate::role::Role;

impl ProjectState {
    /// `dialog` is what lies over the window.
    pub(in crate::app) fn apply(
        &mut self,
        work: &mut Work<'_>,
        command: ProjectCommand,
        dialog: &mut Option<Dialog>,
    ) -> Vec<Effect> {
        match command {
            ProjectCommand::AskOpen => vec![Effect::AskOpenProject],
            ProjectCommand::Open(request) => self.open(work, request, dialog),
            ProjectCommand::Restore(path) => {
                let request = ProjectRequest {
                    path,
                    is_autosave: true,
                    ..ProjectRequest::default()
                };
                self.open(work, request, dialog)
            }
            ProjectCommand::AskLocate(file) => vec![Effect::AskLocate(file)],
            ProjectCommand::Locate(file, located) => self.locate(work, file, located, dialog),
            ProjectCommand::GiveUp => {
                self.missing = None;
                *dialog = None;
                Vec::new()
            }
            ProjectCommand::Save => self.save(work),
            ProjectCommand::SaveAs => self.ask_save(work.document),
            // The dialog has asked about the file that is there.
            ProjectCommand::Write(path) => write(work, path, None),
            ProjectCommand::Written(path, saved_at, kept) => {
                self.written(work, (path, saved_at), *kept)
            }
            ProjectCommand::NotWritten => {
                self.quits_when_saved = false;
                Vec::new()
            }
            ProjectCommand::SaveFailed {
                reason,
                is_elsewhere,
            } => {
                self.quits_when_saved = false;
                tell_not_saved(work, &reason, is_elsewhere);
                Vec::new()
            }
            ProjectCommand::Autosave => {
                work.follow(FollowUp::Autosave);
                Vec::new()
            }
            ProjectCommand::NotifyRecovered(sessions) => {
                self.sessions = sessions;
                Vec::new()
            }
            ProjectCommand::DismissRecovery => self.dismiss_recovery(),
            ProjectCommand::SaveAndQuit => {
                *dialog = None;
                self.quits_when_saved = true;
                self.save(work)
            }
            ProjectCommand::QuitUnsaved => {
                *dialog = None;
                vec![Effect::SaveSettings, Effect::Quit]
            }
        }
    }

    pub(super) fn dismiss_recovery(&mut self) -> Vec<Effect> {
        for session in &mut self.sessions {
            session.is_lost = false;
        }
        vec![Effect::DismissRecovery]
    }

    fn save(&self, work: &mut Work<'_>) -> Vec<Effect> {
        match self.path_of(work.document).cloned() {
            Some(path) => write(work, path, self.opened_at),
            None => self.ask_save(work.document),
        }
    }

    fn ask_save(&self, document: &Document) -> Vec<Effect> {
        let known = self.path_of(document).cloned();
        let suggested = known.unwrap_or_else(|| suggested_path(document));
        vec![Effect::AskSaveProject(suggested)]
    }

    fn written(
        &mut self,
        work: &mut Work<'_>,
        (path, saved_at): (PathBuf, u64),
        kept: Kept,
    ) -> Vec<Effect> {
        let text = format!("project saved: {}", path.display());
        work.log_at(NoticeLevel::Success, LogStep::Project, None, text, None);
        work.log.notices.withdraw(Action::SaveProjectAs);
        let project = kept.document.project;
        self.saved = Some(kept);
        let now = work.unix_now();
        work.settings.remember_path(&path, now);
        self.file = Some((path, project));
        self.opened_at = Some(saved_at);
        if std::mem::take(&mut self.quits_when_saved) {
            work.follow(FollowUp::Quit);
        }
        vec![Effect::SaveSettings]
    }

    pub(in crate::app) fn open(
        &mut self,
        work: &mut Work<'_>,
        request: ProjectRequest,
        dialog: &mut Option<Dialog>,
    ) -> Vec<Effect> {
        if work.is_unlocked().is_err() {
            return Vec::new();
        }
        self.missing = None;
        self.refused = None;
        *dialog = None;
        vec![work.start(JobKind::OpenProject(request))]
    }

    /// A file that was not found is somewhere else, or done without. The others may have moved with the one that
    /// was found: opening looks for them and asks for what is missing then.
    fn locate(
        &mut self,
        work: &mut Work<'_>,
        file: ProjectFile,
        located: Located,
        dialog: &mut Option<Dialog>,
    ) -> Vec<Effect> {
        let Some((mut request, mut missing)) = self.missing.take() else {
            return Vec::new();
        };
        self.refused = None;
        let is_found = matches!(located, Located::At(_));
        request.located.insert(file, located);
        missing.retain(|(missing, _)| *missing != file);
        if !missing.is_empty() && !is_found {
            self.missing = Some((request, missing));
            return Vec::new();
        }
        self.open(work, request, dialog)
    }
}

/// Beside the stamped file, under its name.
fn suggested_path(document: &Document) -> PathBuf {
    let part = document.part(Role::Stamped);
    let part = part.or_else(|| document.part(Role::Crash));
    let path = part.map_or_else(|| PathBuf::from("match"), |part| part.loaded.path.clone());
    let name = path.file_name().map(|name| name.to_string_lossy());
    let stem = name.as_deref().and_then(|name| name.split('.').next());
    let stem = stem.filter(|stem| !stem.is_empty()).unwrap_or("match");
    path.with_file_name(format!("{stem}.{EXTENSION}"))
}

/// What can be done instead is one click away.
fn tell_not_saved(work: &mut Work<'_>, reason: &str, is_elsewhere: bool) {
    let text = format!("the project is not saved: {reason}");
    let mut offers = vec![Action::SaveProjectAs];
    if is_elsewhere {
        offers.push(Action::ReopenProject);
    }
    work.offer_at(NoticeLevel::Error, LogStep::Project, &text, &offers);
}

fn write(work: &mut Work<'_>, path: PathBuf, replaces: Option<u64>) -> Vec<Effect> {
    work.follow(FollowUp::WriteProject(with_ending(path), replaces));
    Vec::new()
}
