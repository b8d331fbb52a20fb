//! What saving and opening of projects change.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crate::app::project::WindowEntry;
use crate::app::{
    AppState, Dialog, Document, Effect, MatchResult, NoticeLevel, Part, PointPairs, ProjectCommand,
    ShownGeometry, StampedPose,
};
use crate::jobs::{
    JobKind, Located, MeasureLevelInput, OpenedPart, OpenedProject, ProjectRequest, Stamp,
};
use crate::pipeline::project::{EXTENSION, PartEntry, Project, ResultEntry, is_project};
use crate::role::{PerRole, Role};

impl AppState {
    pub(super) fn apply_project(&mut self, command: ProjectCommand) -> Vec<Effect> {
        match command {
            ProjectCommand::AskOpen => vec![Effect::AskOpenProject],
            ProjectCommand::Open(request) => self.open_project(request),
            ProjectCommand::Restore(path) => self.open_project(ProjectRequest {
                path,
                is_autosave: true,
                ..ProjectRequest::default()
            }),
            ProjectCommand::AskLocate(role) => vec![Effect::AskLocate(role)],
            ProjectCommand::Locate(role, located) => self.locate(role, located),
            ProjectCommand::GiveUp => {
                self.project.missing = None;
                self.view.dialog = None;
                Vec::new()
            }
            ProjectCommand::Save => match self.project.path.clone() {
                Some(path) => self.write_project(path),
                None => self.ask_save(),
            },
            ProjectCommand::SaveAs => self.ask_save(),
            ProjectCommand::Write(path) => self.write_project(path),
            ProjectCommand::Written(path, document) => self.project_written(path, *document),
            ProjectCommand::NotWritten => {
                self.project.quits_when_saved = false;
                Vec::new()
            }
            ProjectCommand::Autosave => self.autosave(),
            ProjectCommand::NotifyRecovered(sessions) => {
                self.project.sessions = sessions;
                Vec::new()
            }
            ProjectCommand::DismissRecovery => {
                for session in &mut self.project.sessions {
                    session.is_lost = false;
                }
                vec![Effect::DismissRecovery]
            }
            ProjectCommand::SaveAndQuit => {
                self.view.dialog = None;
                self.project.quits_when_saved = true;
                self.apply_project(ProjectCommand::Save)
            }
            ProjectCommand::QuitUnsaved => {
                self.view.dialog = None;
                vec![Effect::SaveSettings, Effect::Quit]
            }
        }
    }

    /// Leaves at once, or asks first if something would be lost.
    pub(super) fn quit(&mut self) -> Vec<Effect> {
        if self.is_unsaved() {
            self.view.dialog = Some(Dialog::Unsaved);
            return Vec::new();
        }
        vec![Effect::SaveSettings, Effect::Quit]
    }

    fn ask_save(&mut self) -> Vec<Effect> {
        let suggested = match self.project.path.clone() {
            Some(path) => path,
            None => self.suggested_path(),
        };
        vec![Effect::AskSaveProject(suggested)]
    }

    /// Beside the stamped file, under its name.
    fn suggested_path(&self) -> PathBuf {
        let part = self.document.part(Role::Stamped);
        let part = part.or_else(|| self.document.part(Role::Crash));
        let path = part.map_or_else(|| PathBuf::from("match"), |part| part.loaded.path.clone());
        let name = path.file_name().map(|name| name.to_string_lossy());
        let stem = name.as_deref().and_then(|name| name.split('.').next());
        let stem = stem.filter(|stem| !stem.is_empty()).unwrap_or("match");
        path.with_file_name(format!("{stem}.{EXTENSION}"))
    }

    fn write_project(&mut self, mut path: PathBuf) -> Vec<Effect> {
        if !is_project(&path) {
            let mut name = path.file_name().unwrap_or_default().to_os_string();
            name.push(".");
            name.push(EXTENSION);
            path.set_file_name(name);
        }
        vec![Effect::WriteProject {
            path,
            project: Box::new(self.to_project(0)),
            document: Box::new(self.document.clone()),
        }]
    }

    fn project_written(&mut self, path: PathBuf, document: Document) -> Vec<Effect> {
        let text = format!("project saved: {}", path.display());
        self.log_at(NoticeLevel::Success, "project", None, text, None);
        self.project.saved = Some(document);
        let now = self.clock.unix_at(self.now);
        self.settings.remember_path(&path, now);
        self.project.path = Some(path);
        let mut effects = vec![Effect::SaveSettings];
        if std::mem::take(&mut self.project.quits_when_saved) {
            effects.extend(self.quit());
        }
        effects
    }

    fn autosave(&mut self) -> Vec<Effect> {
        if !self.needs_autosave() {
            return Vec::new();
        }
        self.project.autosaved = Some((self.document.clone(), self.sweep.is_some()));
        vec![Effect::Autosave(Box::new(self.to_project(0)))]
    }

    pub(super) fn open_project(&mut self, request: ProjectRequest) -> Vec<Effect> {
        if self.is_unlocked().is_err() {
            return Vec::new();
        }
        self.project.missing = None;
        self.view.dialog = None;
        vec![self.start(JobKind::OpenProject(request))]
    }

    /// A file that was not found is somewhere else, or done without; when none is left to be asked
    /// for, the project is opened.
    fn locate(&mut self, role: Role, located: Located) -> Vec<Effect> {
        let Some((mut request, mut missing)) = self.project.missing.take() else {
            return Vec::new();
        };
        *request.located.get_mut(role) = located;
        *missing.get_mut(role) = None;
        if missing.iter().any(|(_, missing)| missing.is_some()) {
            self.project.missing = Some((request, missing));
            return Vec::new();
        }
        self.open_project(request)
    }

    pub(super) fn take_project(&mut self, opened: OpenedProject, took: Duration) -> Vec<Effect> {
        if opened.missing.iter().any(|(_, missing)| missing.is_some()) {
            self.project.missing = Some((opened.request, opened.missing));
            self.view.dialog = Some(Dialog::MissingFiles);
            return Vec::new();
        }
        let OpenedProject {
            request,
            project,
            notes,
            parts,
            ..
        } = opened;
        let name = if request.is_autosave {
            "the recovered session".to_owned()
        } else {
            file_name(&request.path)
        };
        for note in notes {
            let text = format!("{name}: {note}");
            self.log_at(NoticeLevel::Note, "project", None, text, None);
        }
        self.tell_changed_files(&parts);
        self.drop_previews();
        let window = self.read_window(&project);
        let effects = self.place_project(&name, &project, &parts, window.as_ref());
        self.show_project(&project, window);
        let filed = self.file_project(request, &project);
        let text = format!("opened {name}: {}", self.work_title());
        self.log_step("project", None, text, Some(took));
        let mut all = vec![Effect::SaveSettings];
        all.extend(filed);
        all.extend(effects);
        all
    }

    fn tell_changed_files(&mut self, parts: &PerRole<Option<OpenedPart>>) {
        for (role, part) in parts.iter() {
            if let Some(part) = part.as_ref().filter(|part| part.is_changed) {
                let text = format!(
                    "{} has changed since the project was saved; poses are kept, results are out \
                     of date",
                    part.part.file_name()
                );
                self.log_at(NoticeLevel::Warning, "project", Some(role), text, None);
            }
        }
    }

    /// The whole project is one undo step.
    fn place_project(
        &mut self,
        name: &str,
        project: &Project,
        parts: &PerRole<Option<OpenedPart>>,
        window: Option<&WindowEntry>,
    ) -> Vec<Effect> {
        let mut effects = Vec::new();
        let mut document = Document {
            recipe: project.recipe.clone(),
            pose: StampedPose {
                crash_from_stamped: project.pose,
                revision: self.next_revision(),
            },
            ..Document::default()
        };
        for role in Role::ALL {
            let entry = project.parts.get(role).as_ref();
            let (Some(opened), Some(entry)) = (parts.get(role), entry) else {
                *self.recordings.get_mut(role) = None;
                continue;
            };
            let revision = self.next_revision();
            *document.parts.get_mut(role) = Some(part_of(opened, entry, revision));
            let level = opened.level.clone();
            *self.recordings.get_mut(role) =
                level.clone().map(|(recording, _)| (revision, recording));
            effects.extend(level.map(|(recording, level)| {
                JobKind::MeasureLevel(MeasureLevelInput {
                    role,
                    recording,
                    level,
                })
            }));
        }
        let is_complete = |opened: &Option<OpenedPart>, entry: Option<&PartEntry>| {
            opened.is_some() == entry.is_some() && opened.as_ref().is_none_or(|p| !p.is_changed)
        };
        let PerRole { crash, stamped } = project.parts.as_ref().map(Option::as_ref);
        let is_same = is_complete(&parts.crash, crash) && is_complete(&parts.stamped, stamped);
        document.result = project.result.clone().map(|entry| {
            let stamp = result_stamp(&entry, document.stamp(), is_same);
            MatchResult::restored(entry, stamp)
        });
        if let Some(window) = window {
            for label in window.labels.iter().cloned() {
                let part = document.part(label.role).map(|part| part.revision);
                let id = self.next_revision();
                document
                    .labels
                    .extend(part.map(|part| label.label(id, part)));
            }
            document.pairs = PointPairs {
                parts: document.stamp().parts,
                pairs: window.pairs.clone(),
            };
        }
        self.commit(format!("Open {name}"), |old| *old = document);
        effects.into_iter().map(|kind| self.start(kind)).collect()
    }

    /// The window looks as it did; what is missing in the project stays.
    fn show_project(&mut self, project: &Project, window: Option<WindowEntry>) {
        self.sweep = project.sweep.clone().map(|sweep| Arc::new(sweep).into());
        self.starts = None;
        self.measurement = None;
        self.view.selected.clear();
        self.view.n_restored += 1;
        self.live_starts.clear();
        match window {
            Some(window) => window.show(self),
            None => self.fit_project(),
        }
    }

    /// How the window looked, if the project says it in words that are known.
    fn read_window(&mut self, project: &Project) -> Option<WindowEntry> {
        match serde_json::from_value(project.window.clone()?) {
            Ok(window) => Some(window),
            Err(error) => {
                let text = format!("how the window looked is not understood: {error}");
                self.log_at(NoticeLevel::Note, "project", None, text, None);
                None
            }
        }
    }

    fn fit_project(&mut self) {
        self.view.shown = ShownGeometry::Reduced;
        for role in Role::ALL {
            self.fit_after_load(role);
        }
    }

    /// Where the project lies and what of it is saved.
    fn file_project(&mut self, request: ProjectRequest, project: &Project) -> Vec<Effect> {
        self.project.others = project.others.clone();
        if request.is_autosave {
            let path = project.window.as_ref().and_then(|window| {
                let path = window.get("project")?.as_str()?;
                Some(PathBuf::from(path))
            });
            self.project.path = path;
            self.project.saved = None;
            // From here on this run keeps it.
            return self.apply_project(ProjectCommand::DismissRecovery);
        } else {
            let now = self.clock.unix_at(self.now);
            self.settings.remember_path(&request.path, now);
            self.project.path = Some(request.path);
            self.project.saved = Some(self.document.clone());
        }
        Vec::new()
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

fn part_of(opened: &OpenedPart, entry: &PartEntry, revision: u64) -> Part {
    let (part, facts) = (Arc::clone(&opened.part), Arc::clone(&opened.facts));
    let mut part = Part::new(part, facts, opened.source.clone(), revision);
    part.hidden = entry.hidden.clone();
    part.colors = entry.colors.clone();
    part.wanted_level = entry.max_triangles;
    part.level = opened.level.clone().map(|(_, level)| level.into());
    part
}

/// The inputs a stored result stands for: the present ones only if nothing differs.
fn result_stamp(entry: &ResultEntry, now: Stamp, is_same: bool) -> Stamp {
    match (is_same, entry.is_current) {
        (true, true) => now,
        (true, false) => Stamp { pose: 0, ..now },
        (false, _) => Stamp::default(),
    }
}
