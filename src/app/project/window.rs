//! How the window looked, as a project keeps it.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::app::{
    AppState, AxisFrame, Display, Document, FreeWindow, Label, PointPair, SectionView,
    ShownGeometry,
};
use crate::geometry::camera::OrbitStyle;
use crate::geometry::serial::xyz;
use crate::geometry::{Camera, Point3};
use crate::role::{PerRole, Role};

/// How the window looked, as a project keeps it. Fields that are absent stay as they are.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
pub(in crate::app) struct WindowEntry {
    /// Where the project itself is, for an autosaved session.
    pub project: Option<PathBuf>,
    /// When that file was saved as the session knows it, in seconds since 1970.
    pub project_saved_at: Option<u64>,
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
pub(in crate::app) struct LabelEntry {
    pub role: Role,
    pub vertex: u32,
    pub node: Option<u64>,
    #[serde(with = "xyz")]
    pub position: Point3,
    pub name: String,
}

impl LabelEntry {
    /// The label on the part of this revision.
    pub(in crate::app) fn label(self, id: u64, part: u64) -> Label {
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
    pub(super) fn of(state: &AppState) -> Self {
        let view = &state.view;
        Self {
            project: state.project_path().cloned(),
            project_saved_at: state.project.opened_at,
            cameras: view.cameras,
            are_linked: view.are_linked,
            orbit_style: view.orbit_style,
            is_moved_over: view.is_moved_over,
            is_as_loaded: state.previews.is_as_loaded,
            shown: view.shown,
            display: view.display.clone(),
            section: state.inspect.section,
            has_gizmo: state.moving.has_gizmo,
            move_axes: state.moving.axes,
            free_window: view.free_window,
            labels: labels(&state.document),
            pairs: state.document.current_pairs().to_vec(),
        }
    }

    /// Makes the window look so.
    pub(in crate::app) fn show(self, state: &mut AppState) {
        let view = &mut state.view;
        view.previous_cameras = self.cameras;
        view.cameras = self.cameras;
        view.are_linked = self.are_linked;
        view.orbit_style = self.orbit_style;
        view.pivot = PerRole::default();
        view.is_moved_over = self.is_moved_over;
        state.previews.is_as_loaded = self.is_as_loaded;
        view.shown = self.shown;
        view.display = self.display;
        state.inspect.section = self.section;
        view.free_window = self.free_window;
        state.moving.has_gizmo = self.has_gizmo;
        state.moving.axes = self.move_axes;
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
