//! The project that is worked on: its file, what of it is saved, and what is written into it.

mod apply;
mod command;
mod open;
mod window;

use std::path::{Path, PathBuf};

pub use command::ProjectCommand;
use serde_json::{Map, Value};

use self::window::WindowEntry;
use super::{
    AppState, Document, Effect, Further, Mapping, MatchResult, Part, Shared, age_text, clock_text,
};
use crate::formats::Selection;
use crate::jobs::{JobKey, PartSource, ProjectFile, ProjectRequest};
use crate::pipeline::autosave::RecoveredSession;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::project::{FurtherEntry, PartEntry, PlacingEntry, Project, ResultEntry};
use crate::pipeline::sweep::Sweep;
use crate::role::{PerRole, Role};

/// The project that is worked on.
#[derive(Debug, Clone, Default)]
pub struct ProjectState {
    /// The file opened or saved last, and the number of the project in it.
    file: Option<(PathBuf, u64)>,
    /// When the file was saved as it was opened or written here last, in seconds since 1970; `None` for a recovered
    /// session of a program that did not keep it.
    opened_at: Option<u64>,
    /// Sessions of the last runs, newest first.
    pub sessions: Vec<RecoveredSession>,
    /// Its files that were not found, and what was asked for.
    pub missing: Option<(ProjectRequest, Vec<(ProjectFile, PathBuf)>)>,
    /// Why the file that was pointed at last is not taken, a sentence.
    pub refused: Option<String>,
    /// The work as it was saved or opened.
    saved: Option<Kept>,
    /// The work as it was autosaved last.
    autosaved: Option<Kept>,
    /// Fields of a later program.
    others: Map<String, Value>,
    /// The window closes as soon as the project is written.
    quits_when_saved: bool,
}

/// The work that a project keeps, to tell whether something was done since.
#[derive(Debug, Clone)]
pub struct Kept {
    document: Document,
    sweep: Option<Shared<Sweep>>,
}

impl ProjectState {
    /// The file of a document's project, if it has one. The step back over the opening of a project leads to
    /// work that is not of its file, and two other parts are other work.
    fn path_of(&self, document: &Document) -> Option<&PathBuf> {
        let file = self.file.as_ref();
        let kept = self.saved.as_ref().map(|kept| &kept.document);
        let is_its = kept.is_none_or(|kept| document.shares_a_file_with(kept));
        file.filter(|(_, project)| *project == document.project && is_its)
            .map(|(path, _)| path)
    }

    /// The newest session that its program did not live to save.
    pub fn lost_session(&self) -> Option<&RecoveredSession> {
        self.sessions.iter().find(|session| session.is_lost)
    }
}

impl Document {
    /// False if both have parts, and none of one file.
    fn shares_a_file_with(&self, other: &Self) -> bool {
        let files = |document: &Self| {
            let parts = document.parts.iter().filter_map(|(_, part)| part.as_ref());
            parts
                .map(|part| part.loaded.path.clone())
                .collect::<Vec<_>>()
        };
        let [own, others] = [self, other].map(files);
        own.is_empty() || others.is_empty() || own.iter().any(|file| others.contains(file))
    }

    /// Its files: "stamped.dynain on crash.k"; `None` without any.
    pub fn title(&self) -> Option<String> {
        let name = |role| self.part(role).map(|part| part.loaded.file_name());
        match (name(Role::Crash), name(Role::Stamped)) {
            (Some(crash), Some(stamped)) => Some(format!("{stamped} on {crash}")),
            (one, None) | (None, one) => one,
        }
    }
}

impl AppState {
    /// The work as it is now.
    pub(in crate::app) fn kept(&self) -> Kept {
        Kept {
            document: self.document.clone(),
            sweep: self.matching.sweep(&self.document).cloned(),
        }
    }

    /// True if the work is as it was when it was kept; nothing is copied to tell.
    fn is_as(&self, kept: Option<&Kept>) -> bool {
        kept.is_some_and(|kept| {
            kept.document == self.document
                && kept.sweep.as_ref() == self.matching.sweep(&self.document)
        })
    }

    /// The work as it is now is what its file says.
    pub(in crate::app) fn keep_as_saved(&mut self) {
        self.project.saved = Some(self.kept());
    }

    /// The file of the project, if it has one.
    pub fn project_path(&self) -> Option<&PathBuf> {
        self.project.path_of(&self.document)
    }

    /// The name of the project's file without its ending.
    pub fn project_name(&self) -> Option<String> {
        let stem = self.project_path()?.file_stem()?;
        Some(stem.to_string_lossy().into_owned())
    }

    /// The work as a project; `saved_at` is in seconds since 1970.
    pub fn to_project(&self, saved_at: u64) -> Project {
        let document = &self.document;
        let entry = |role| {
            let part = document.part(role)?;
            Some(PartEntry {
                is_hidden: role == Role::Stamped && self.is_file_hidden(&part.loaded.path),
                are_all_meant: role == Role::Crash && document.are_all_meant(),
                ..part_entry(part)
            })
        };
        Project {
            program: String::new(),
            saved_at,
            parts: PerRole::from_fn(entry),
            pose: *document.crash_from_stamped(),
            recipe: document.recipe.clone(),
            recipe_before_remedy: document.recipe_before_remedy.clone(),
            mapping: document.mapping.recipe.clone(),
            further_stamped: self.further_entries(),
            mapping_compared_with: document.mapping.compare_with.as_deref().map(absolute),
            mapping_pins: document.mapping.pins.clone(),
            is_mapped: document.current_mapping().is_some() || self.is_mapping_restored(),
            result: document.result.as_ref().map(|result| ResultEntry {
                is_current: document.current_result().is_some(),
                exchanged: PerRole::from_fn(|role| {
                    result.stamp.parts.get(role) != document.stamp().parts.get(role)
                }),
                alternative: result.alternative,
                run: result.run.clone_inner(),
            }),
            sweep: self
                .matching
                .sweep(&self.document)
                .map(|sweep| sweep.clone_inner()),
            // A window that cannot be told leaves the work itself whole.
            window: serde_json::to_value(WindowEntry::of(self)).ok(),
            others: self.project.others.clone(),
        }
    }

    /// True if something was done that opening the files again would not bring back.
    pub fn has_work(&self) -> bool {
        let document = &self.document;
        let is_touched = |part: &Part| {
            let settings = &part.loaded.settings;
            part.wanted_level.is_some()
                || !part.hidden.is_empty()
                || !part.colors.is_empty()
                || settings.units.is_some()
                || settings.length_factor != 1.0
                || !matches!(settings.selection, Selection::All | Selection::Sheet)
        };
        let parts = [&document.parts.crash, &document.parts.stamped];
        let has_parts = parts.iter().any(|part| part.is_some());
        has_parts
            && (parts.into_iter().flatten().any(is_touched)
                || document.pose.crash_from_stamped != crate::geometry::Similarity::identity()
                || document.result.is_some()
                || !document.labels.is_empty()
                || !document.pairs.pairs.is_empty()
                || document.recipe != MatchRecipe::default()
                || document.mapping != Mapping::default()
                || self.matching.sweep(&self.document).is_some())
    }

    /// True if closing the window now would lose something.
    pub fn is_unsaved(&self) -> bool {
        self.has_work() && !self.is_as(self.project.saved.as_ref())
    }

    /// True if closing the window now would lose something done or running: it is asked first.
    pub fn would_lose_work(&self) -> bool {
        self.is_unsaved() || self.unfinished_work().is_some()
    }

    /// What runs and would be lost if the window closed now.
    pub fn unfinished_work(&self) -> Option<&'static str> {
        let runs = |key| self.jobs.is_active(key);
        let is_mapping = runs(JobKey::Map) && !self.is_mapping_restored();
        let work = [
            (runs(JobKey::Match), "A match is running."),
            (runs(JobKey::Sweep), "A sweep is running."),
            (is_mapping, "A mapping is running."),
            (self.jobs.is_exporting(), "A file is being written."),
        ];
        work.into_iter()
            .find_map(|(runs, words)| runs.then_some(words))
    }

    /// True if the mapping of a project that was opened is being made again.
    fn is_mapping_restored(&self) -> bool {
        self.jobs.is_active(JobKey::Map) && self.mapping.is_restoring(&self.document)
    }

    /// True if there is something new to be kept in case of a crash, and no drag is under way.
    pub fn needs_autosave(&self) -> bool {
        let is_moving = self.moving.is_moving();
        let is_wanted = self.settings.keeps_work && !is_moving && self.has_work();
        is_wanted && !self.is_as(self.project.autosaved.as_ref())
    }

    /// Keeps the session in case of a crash, if there is something new.
    pub(super) fn autosave(&mut self) -> Vec<Effect> {
        if !self.needs_autosave() {
            return Vec::new();
        }
        self.project.autosaved = Some(self.kept());
        vec![Effect::Autosave(Box::new(self.to_project(0)))]
    }

    /// A time of the past, in seconds since 1970, as people say it: "14:02", "14:02, 3 days ago".
    pub fn when_text(&self, unix: u64) -> String {
        const DAY: i64 = 86_400;
        let ago = self.log.clock.unix_at(self.log.now).saturating_sub(unix);
        // Past midnight the time of day goes on counting.
        let day_time = self.log.clock.day_time_at(self.log.now).as_secs();
        let local = day_time.cast_signed() % DAY - ago.cast_signed();
        let time = std::time::Duration::from_secs(local.rem_euclid(DAY).cast_unsigned());
        let minutes = &clock_text(time)[..5];
        if (0..DAY).contains(&local) {
            minutes.to_owned()
        } else {
            format!("{minutes}, {}", age_text(ago.max(DAY.cast_unsigned())))
        }
    }

    /// What the work is, in a line: "stamped.dynain on crash.k · GOOD".
    pub fn work_title(&self) -> String {
        let mut title = self.document.title().unwrap_or_default();
        if let Some(result) = self.document.current_result() {
            title += " · ";
            title += result.verdict().label();
        }
        title
    }

    fn further_entries(&self) -> Vec<FurtherEntry> {
        let document = &self.document;
        let crash = document.part(Role::Crash).map(|crash| crash.revision);
        let entry = |further: &Further| FurtherEntry {
            part: PartEntry {
                is_hidden: self.is_file_hidden(&further.loaded.path),
                ..PartEntry::of(&further.loaded, Some(absolute(&further.loaded.path)))
            },
            pose: further.pose,
            placing: further.placing.as_ref().map(|placing| PlacingEntry {
                is_current: Some(placing.crash_revision) == crash,
                crash_from_stamped: placing.crash_from_stamped,
                verdict: placing.verdict,
                coverage: placing.coverage,
                reason: placing.reason.clone(),
            }),
        };
        document.mapping.further.iter().map(entry).collect()
    }
}

pub(in crate::app) fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

fn part_entry(part: &Part) -> PartEntry {
    let file = match &part.source {
        PartSource::File(path) => Some(absolute(path)),
        PartSource::Example | PartSource::RealisticExample => None,
    };
    PartEntry {
        is_realistic_example: part.source == PartSource::RealisticExample,
        max_triangles: part.wanted_level,
        hidden: part.hidden.clone(),
        colors: part.colors.clone(),
        ..PartEntry::of(&part.loaded, file)
    }
}

impl MatchResult {
    /// A stored result, in force for these inputs.
    fn restored(
        entry: ResultEntry,
        stamp: crate::jobs::Stamp,
        length_factors: PerRole<Option<f64>>,
    ) -> Self {
        Self {
            run: std::sync::Arc::new(entry.run).into(),
            alternative: entry.alternative,
            stamp,
            length_factors,
        }
    }
}
