//! Opening of a project, which replaces what every topic knows.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use serde_json::Value;

use super::window::WindowEntry;
use crate::app::{
    Action, AppState, Dialog, Document, Effect, Further, LogStep, Mapping, MatchResult,
    NoticeLevel, Part, Placing, PointPairs, ShownGeometry, StampedPose,
};
use crate::jobs::{
    JobKind, Located, MeasureLevelInput, OpenedPart, OpenedProject, ProjectFile, ProjectRequest,
    Stamp,
};
use crate::pipeline::names::file_name;
use crate::pipeline::project::{
    FoundPart, FurtherEntry, PartEntry, PlacingEntry, Project, ResultEntry,
};
use crate::role::{PerRole, Role};

impl AppState {
    pub(in crate::app) fn take_project(
        &mut self,
        opened: OpenedProject,
        took: Duration,
    ) -> Vec<Effect> {
        if !opened.missing.is_empty() {
            self.project.missing = Some((opened.request, opened.missing));
            self.project.refused = opened.refused;
            self.view.dialog = Some(Dialog::MissingFiles);
            return Vec::new();
        }
        let OpenedProject {
            request,
            project,
            notes,
            parts,
            further,
            ..
        } = opened;
        let name = if request.is_autosave {
            "the recovered session".to_owned()
        } else {
            file_name(&request.path)
        };
        for note in notes {
            let text = format!("{name}: {note}");
            self.work()
                .log_at(NoticeLevel::Note, LogStep::Project, None, text, None);
        }
        self.tell_changed_files(&request, &parts, &further);
        self.previews.drop_all();
        let window = self.read_window(&project);
        let parts = (&parts, &further[..]);
        let was_unsaved = self.is_unsaved();
        let (mut work, topics) = self.split();
        let mut effects = topics.mapping.clear_list(&mut work);
        effects.extend(self.place_project(&name, &project, parts, window.as_ref()));
        self.show_project(&project, window);
        self.view.hidden_files = hidden_files(&project, parts);
        let is_as_mapped = project.is_mapped && is_all_same(&project, parts);
        let filed = self.file_project(request, &project);
        let text = format!("opened {name}: {}", self.work_title());
        self.work()
            .log_step(LogStep::Project, None, text, Some(took));
        if was_unsaved {
            self.tell_unsaved_before();
        }
        let mut all = vec![Effect::SaveSettings];
        all.extend(filed);
        all.extend(effects);
        if is_as_mapped {
            all.extend(self.restore_mapping());
        }
        all
    }

    /// The project is saved, so that nothing is asked when the program ends.
    fn tell_unsaved_before(&mut self) {
        let text = "The unsaved work before it is one undo step away";
        let offers = &[Action::Undo];
        self.work()
            .offer_at(NoticeLevel::Note, LogStep::Project, text, offers);
    }

    fn tell_changed_files(
        &mut self,
        request: &ProjectRequest,
        parts: &PerRole<Option<OpenedPart>>,
        further: &[Option<FoundPart>],
    ) {
        let changed = |(role, part): (Role, &Option<OpenedPart>)| {
            let part = part.as_ref().filter(|part| part.is_changed)?;
            let file = ProjectFile::Part(role);
            Some((file, part.part.file_name(), "poses are kept"))
        };
        let further = further.iter().enumerate().filter_map(|(n, found)| {
            let found = found.as_ref().filter(|part| part.is_changed)?;
            let file = ProjectFile::Further(n);
            Some((file, found.part.file_name(), "it is matched anew"))
        });
        let changed: Vec<_> = parts.iter().filter_map(changed).chain(further).collect();
        for (file, name, what) in changed {
            // Whether the file that was pointed at is another one or a later state of the same is not known.
            let how = match request.located.get(&file) {
                Some(Located::At(_)) => "is not the file that the project was saved with",
                Some(Located::AsStored | Located::Without) | None => {
                    "has changed since the project was saved"
                }
            };
            let text = format!("{name} {how}; {what}, results are out of date");
            let role = Some(file.role());
            self.work()
                .log_at(NoticeLevel::Warning, LogStep::Project, role, text, None);
        }
    }

    /// The whole project is one undo step.
    fn place_project(
        &mut self,
        name: &str,
        project: &Project,
        (parts, further): (&PerRole<Option<OpenedPart>>, &[Option<FoundPart>]),
        window: Option<&WindowEntry>,
    ) -> Vec<Effect> {
        let mut effects = Vec::new();
        let mut document = Document {
            recipe: project.recipe.clone(),
            recipe_before_remedy: project.recipe_before_remedy.clone(),
            mapping: Mapping {
                recipe: project.mapping.clone(),
                further: Vec::new(),
                compare_with: project.mapping_compared_with.clone(),
                result: None,
                pins: project.mapping_pins.clone(),
            },
            pose: StampedPose {
                crash_from_stamped: project.pose,
                revision: self.history.next_revision(),
            },
            project: self.history.next_revision(),
            ..Document::default()
        };
        for role in Role::ALL {
            let entry = project.parts.get(role).as_ref();
            let (Some(opened), Some(entry)) = (parts.get(role), entry) else {
                self.reduce.keep_recording(role, None);
                continue;
            };
            let revision = self.history.next_revision();
            *document.parts.get_mut(role) = Some(part_of(opened, entry, revision));
            let level = opened.level.clone();
            let recording = level.clone().map(|(recording, _)| (revision, recording));
            self.reduce.keep_recording(role, recording);
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
        let is_same = PerRole {
            crash: is_complete(&parts.crash, crash),
            stamped: is_complete(&parts.stamped, stamped),
        };
        document.mapping.further = self.further_of(project, further, |placing| {
            let crash = document.part(Role::Crash).map(|part| part.revision);
            // Poses of further files stand for the crash part as it was.
            let is_current = placing.is_current && is_same.crash;
            crash.filter(|_| is_current).unwrap_or_default()
        });
        document.result = project.result.clone().map(|entry| {
            let stamp = result_stamp(&entry, document.stamp(), is_same);
            MatchResult::restored(entry, stamp, document.length_factors())
        });
        if let Some(window) = window {
            for label in window.labels.iter().cloned() {
                let part = document.part(label.role).map(|part| part.revision);
                let id = self.history.next_revision();
                document
                    .labels
                    .extend(part.map(|part| label.label(id, part)));
            }
            document.pairs = PointPairs {
                parts: document.stamp().parts,
                pairs: window.pairs.clone(),
            };
        }
        self.work()
            .commit(format!("Open {name}"), |old| *old = document);
        let mut work = self.work();
        effects.into_iter().map(|kind| work.start(kind)).collect()
    }

    /// The further stamped files, each with a number of its own; `crash_of` says with which crash part it was
    /// matched.
    fn further_of(
        &mut self,
        project: &Project,
        further: &[Option<FoundPart>],
        crash_of: impl Fn(&PlacingEntry) -> u64,
    ) -> Vec<Further> {
        let entries = project.further_stamped.iter().zip(further);
        let known = entries.filter_map(|(entry, found)| Some((entry, found.as_ref()?)));
        let of = |(entry, found): (&FurtherEntry, &FoundPart)| Further {
            loaded: Arc::new(found.part.clone()).into(),
            revision: self.history.next_revision(),
            pose: entry.pose,
            placing: entry.placing.as_ref().map(|placing| Placing {
                crash_from_stamped: placing.crash_from_stamped,
                verdict: placing.verdict,
                coverage: placing.coverage,
                reason: placing.reason.clone(),
                crash_revision: if found.is_changed {
                    0
                } else {
                    crash_of(placing)
                },
            }),
        };
        known.map(of).collect()
    }

    /// The window looks as it did; what is missing in the project stays.
    fn show_project(&mut self, project: &Project, window: Option<WindowEntry>) {
        let sweep = project.sweep.clone().map(|sweep| Arc::new(sweep).into());
        self.matching.reopen(&self.document, sweep);
        self.parts.selected.clear();
        let crash = project.parts.crash.as_ref();
        if crash.is_some_and(|crash| crash.are_all_meant) {
            self.document.mean_all();
        }
        self.parts.refresh_likeness(&self.document);
        self.view.n_restored += 1;
        match window {
            Some(window) => window.show(self),
            None => self.fit_project(),
        }
        if self.document.result.is_some() {
            self.show_verdict();
        }
    }

    /// How the window looked, if the project says it in words that are known.
    fn read_window(&mut self, project: &Project) -> Option<WindowEntry> {
        match serde_json::from_value(project.window.clone()?) {
            Ok(window) => Some(window),
            Err(error) => {
                let text = format!("how the window looked is not understood: {error}");
                self.work()
                    .log_at(NoticeLevel::Note, LogStep::Project, None, text, None);
                None
            }
        }
    }

    fn fit_project(&mut self) {
        self.view.shown = ShownGeometry::Reduced;
        for role in Role::ALL {
            self.with_scene(|view, scene| view.fit_after_load(role, scene));
        }
    }

    /// Where the project lies and what of it is saved.
    fn file_project(&mut self, request: ProjectRequest, project: &Project) -> Vec<Effect> {
        self.project.others = project.others.clone();
        if request.is_autosave {
            let kept = |name| project.window.as_ref()?.get(name);
            let path = kept("project").and_then(|path| Some(PathBuf::from(path.as_str()?)));
            self.project.file = path.map(|path| (path, self.document.project));
            self.project.opened_at = kept("project_saved_at").and_then(Value::as_u64);
            self.project.saved = None;
            // From here on this run keeps it.
            return self.project.dismiss_recovery();
        } else {
            let now = self.work().unix_now();
            self.settings.remember_path(&request.path, now);
            self.project.file = Some((request.path, self.document.project));
            self.project.opened_at = Some(project.saved_at);
            self.keep_as_saved();
        }
        Vec::new()
    }
}

/// True if every file is there and is the one the project was saved with.
fn is_all_same(
    project: &Project,
    (parts, further): (&PerRole<Option<OpenedPart>>, &[Option<FoundPart>]),
) -> bool {
    let parts = [&parts.crash, &parts.stamped].map(|part| part.as_ref().map(|p| p.is_changed));
    let further = further
        .iter()
        .map(|found| found.as_ref().map(|f| f.is_changed));
    let n_found = further.len();
    let mut all = parts.into_iter().chain(further);
    n_found == project.further_stamped.len() && all.all(|is_changed| is_changed == Some(false))
}

/// The stamped files that were not drawn, where they lie now.
fn hidden_files(
    project: &Project,
    (parts, further): (&PerRole<Option<OpenedPart>>, &[Option<FoundPart>]),
) -> BTreeSet<PathBuf> {
    let first = project.parts.stamped.as_ref().zip(parts.stamped.as_ref());
    let first = first.map(|(entry, opened)| (entry, &opened.part.path));
    let entries = project.further_stamped.iter().zip(further);
    let further =
        entries.filter_map(|(entry, found)| Some((&entry.part, &found.as_ref()?.part.path)));
    let hidden = first.into_iter().chain(further);
    let hidden = hidden.filter(|(entry, _)| entry.is_hidden);
    hidden.map(|(_, path)| path.clone()).collect()
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

/// The inputs a stored result stands for: the present ones where nothing differs from those that were matched.
fn result_stamp(entry: &ResultEntry, now: Stamp, is_same: PerRole<bool>) -> Stamp {
    let part = |role| {
        if *is_same.get(role) && !entry.exchanged.get(role) {
            *now.parts.get(role)
        } else {
            0
        }
    };
    let is_current = entry.is_current && is_same.crash && is_same.stamped;
    Stamp {
        parts: PerRole {
            crash: part(Role::Crash),
            stamped: part(Role::Stamped),
        },
        pose: if is_current { now.pose } else { 0 },
    }
}
