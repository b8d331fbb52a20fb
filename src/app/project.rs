//! The project that is worked on: its file, what of it is saved, and what is written into it.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{
    AppState, AxisFrame, Display, Document, FreeWindow, Label, MatchResult, Part, PointPair,
    SectionView, ShownGeometry, age_text, clock_text,
};
use crate::geometry::camera::OrbitStyle;
use crate::geometry::serial::xyz;
use crate::geometry::{Camera, Point3};
use crate::jobs::{PartSource, ProjectRequest};
use crate::pipeline::autosave::RecoveredSession;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::project::{PartEntry, Project, ResultEntry};
use crate::role::{PerRole, Role};

/// The project that is worked on.
#[derive(Debug, Clone, Default)]
pub struct ProjectState {
    /// Its file, if it has one.
    pub path: Option<PathBuf>,
    /// Sessions of the last runs, newest first.
    pub sessions: Vec<RecoveredSession>,
    /// Its files that were not found, and what was asked for.
    pub missing: Option<(ProjectRequest, PerRole<Option<PathBuf>>)>,
    /// The document as it was saved or opened.
    pub(super) saved: Option<Document>,
    /// The document and whether there was a sweep when the session was autosaved last.
    pub(super) autosaved: Option<(Document, bool)>,
    /// Fields of a later program.
    pub(super) others: Map<String, Value>,
    /// The window closes as soon as the project is written.
    pub(super) quits_when_saved: bool,
}

impl ProjectState {
    /// The name of the project's file without its ending.
    pub fn name(&self) -> Option<String> {
        let stem = self.path.as_ref()?.file_stem()?;
        Some(stem.to_string_lossy().into_owned())
    }

    /// The newest session that its program did not live to save.
    pub fn lost_session(&self) -> Option<&RecoveredSession> {
        self.sessions.iter().find(|session| session.is_lost)
    }
}

/// How the window looked, as a project keeps it. Fields that are absent stay as they are.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct WindowEntry {
    /// Where the project itself is, for an autosaved session.
    pub project: Option<PathBuf>,
    pub cameras: PerRole<Camera>,
    pub are_linked: bool,
    pub orbit_style: OrbitStyle,
    pub is_moved_over: bool,
    pub is_as_loaded: bool,
    pub shown: ShownGeometry,
    pub display: Display,
    pub section: SectionView,
    pub has_gizmo: bool,
    pub move_axes: AxisFrame,
    pub free_window: Option<FreeWindow>,
    pub labels: Vec<LabelEntry>,
    pub pairs: Vec<PointPair>,
}

/// A value pinned to a node, as a project keeps it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LabelEntry {
    pub role: Role,
    pub vertex: u32,
    pub node: Option<u64>,
    #[serde(with = "xyz")]
    pub position: Point3,
    pub name: String,
}

impl LabelEntry {
    /// The label on the part of this revision.
    pub(super) fn label(self, id: u64, part: u64) -> Label {
        Label {
            id,
            part,
            vertex: self.vertex,
            node: self.node,
            position: self.position,
            name: self.name,
        }
    }
}

impl Default for WindowEntry {
    fn default() -> Self {
        Self::of(&AppState::default())
    }
}

impl WindowEntry {
    fn of(state: &AppState) -> Self {
        let view = &state.view;
        Self {
            project: state.project.path.clone(),
            cameras: view.cameras,
            are_linked: view.are_linked,
            orbit_style: view.orbit_style,
            is_moved_over: view.is_moved_over,
            is_as_loaded: view.is_as_loaded,
            shown: view.shown,
            display: view.display.clone(),
            section: view.section,
            has_gizmo: view.has_gizmo,
            move_axes: view.move_axes,
            free_window: view.free_window,
            labels: labels(&state.document),
            pairs: state.pairs().to_vec(),
        }
    }

    /// Makes the window look so.
    pub(super) fn show(self, state: &mut AppState) {
        let view = &mut state.view;
        view.previous_cameras = self.cameras;
        view.cameras = self.cameras;
        view.are_linked = self.are_linked;
        view.orbit_style = self.orbit_style;
        view.pivot = PerRole::default();
        view.is_moved_over = self.is_moved_over;
        view.is_as_loaded = self.is_as_loaded;
        view.shown = self.shown;
        view.display = self.display;
        view.section = self.section;
        view.free_window = self.free_window;
        view.has_gizmo = self.has_gizmo;
        view.move_axes = self.move_axes;
    }
}

impl AppState {
    /// The work as a project; `saved_at` is in seconds since 1970.
    pub fn to_project(&self, saved_at: u64) -> Project {
        let document = &self.document;
        let entry = |role| document.part(role).map(part_entry);
        Project {
            program: String::new(),
            saved_at,
            parts: PerRole::from_fn(entry),
            pose: *document.crash_from_stamped(),
            recipe: document.recipe.clone(),
            result: document.result.as_ref().map(|result| ResultEntry {
                is_current: document.current_result().is_some(),
                alternative: result.alternative,
                run: result.run.clone_inner(),
            }),
            sweep: self.sweep.as_ref().map(|sweep| sweep.clone_inner()),
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
                || settings.selection != crate::formats::Selection::All
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
                || self.sweep.is_some())
    }

    /// True if closing the window now would lose something.
    pub fn is_unsaved(&self) -> bool {
        self.has_work() && self.project.saved.as_ref() != Some(&self.document)
    }

    /// True if there is something new to be kept in case of a crash, and no drag is under way.
    pub fn needs_autosave(&self) -> bool {
        let is_moving = self.grab.is_some() || self.view.move_tool.is_some();
        let is_known = |(kept, has_sweep): &(Document, bool)| {
            *kept == self.document && *has_sweep == self.sweep.is_some()
        };
        !is_moving && self.has_work() && !self.project.autosaved.as_ref().is_some_and(is_known)
    }

    /// A time of the past, in seconds since 1970, as people say it: "14:02", "14:02, 3 days ago".
    pub fn when_text(&self, unix: u64) -> String {
        const DAY: i64 = 86_400;
        let ago = self.clock.unix_at(self.now).saturating_sub(unix);
        let local = self.clock.day_time_at(self.now).as_secs().cast_signed() - ago.cast_signed();
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
        let name = |role| self.document.part(role).map(|part| part.loaded.file_name());
        let mut title = match (name(Role::Crash), name(Role::Stamped)) {
            (Some(crash), Some(stamped)) => format!("{stamped} on {crash}"),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => String::new(),
        };
        if let Some(result) = self.document.current_result() {
            title += " · ";
            title += result.run.assessment.verdict.label();
        }
        title
    }
}

fn labels(document: &Document) -> Vec<LabelEntry> {
    let entry = |(role, label): (Role, &Label)| LabelEntry {
        role,
        vertex: label.vertex,
        node: label.node,
        position: label.position,
        name: label.name.clone(),
    };
    document.shown_labels().map(entry).collect()
}

fn part_entry(part: &Part) -> PartEntry {
    let file = match &part.source {
        PartSource::File(path) => Some(std::path::absolute(path).unwrap_or_else(|_| path.clone())),
        PartSource::Example => None,
    };
    PartEntry {
        max_triangles: part.wanted_level,
        hidden: part.hidden.clone(),
        colors: part.colors.clone(),
        ..PartEntry::of(&part.loaded, file)
    }
}

impl MatchResult {
    /// A stored result, in force for these inputs.
    pub(super) fn restored(entry: ResultEntry, stamp: crate::jobs::Stamp) -> Self {
        Self {
            run: std::sync::Arc::new(entry.run).into(),
            alternative: entry.alternative,
            stamp,
        }
    }
}
