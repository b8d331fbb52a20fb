//! What is shown and how: cameras, windows, panels.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{
    AxisFrame, Coloring, FreeWindow, GestureId, ModalMove, MoveFrame, PairTool, Preview,
    SectionView, Sections,
};
use crate::geometry::camera::OrbitStyle;
use crate::geometry::{Camera, Point3};
use crate::role::{PerRole, Role};

/// A part of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartRef {
    /// In which of the two models.
    pub role: Role,
    /// The deck's number.
    pub id: u64,
}

/// Which geometry the windows show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownGeometry {
    /// The chosen level.
    #[default]
    Reduced,
    /// The full mesh.
    Detailed,
}

/// What the colours say.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorBy {
    /// Which of the two parts.
    #[default]
    Role,
    /// Which part of the deck.
    Part,
    /// Sheet thickness.
    Thickness,
    /// Distance of the reduced to the full mesh.
    ReductionError,
    /// Signed distance between the parts.
    Deviation,
    /// Where the other part is, is off, or is missing.
    Overlap,
}

impl ColorBy {
    /// All, in the order of the menu.
    pub const ALL: [Self; 6] = [
        Self::Role,
        Self::Part,
        Self::Thickness,
        Self::ReductionError,
        Self::Deviation,
        Self::Overlap,
    ];

    /// Name in the menu.
    pub fn label(self) -> &'static str {
        match self {
            Self::Role => "Crash / stamped",
            Self::Part => "Part",
            Self::Thickness => "Thickness",
            Self::ReductionError => "Reduction error",
            Self::Deviation => "Deviation",
            Self::Overlap => "Overlap",
        }
    }
}

/// The tabs of the bottom pane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BottomTab {
    /// What was done and how long it took.
    #[default]
    Log,
    /// Times of the steps as bars.
    Timings,
    /// The starts of the last match.
    Starts,
    /// Residual and overlap over the iterations.
    Convergence,
    /// The paper's tables.
    Sweep,
    /// Distances between the parts.
    Deviation,
    /// Undo steps.
    History,
    /// What the reader found in the files.
    Diagnostics,
}

impl BottomTab {
    /// All, from left to right.
    pub const ALL: [Self; 8] = [
        Self::Log,
        Self::Timings,
        Self::Starts,
        Self::Convergence,
        Self::Sweep,
        Self::Deviation,
        Self::History,
        Self::Diagnostics,
    ];

    /// Its title.
    pub fn label(self) -> &'static str {
        match self {
            Self::Log => "Log",
            Self::Timings => "Timings",
            Self::Starts => "Starts",
            Self::Convergence => "Convergence",
            Self::Sweep => "Sweep",
            Self::Deviation => "Deviation",
            Self::History => "History",
            Self::Diagnostics => "Diagnostics",
        }
    }
}

/// What lies over the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialog {
    /// All keys.
    Help,
    /// Search commands.
    Palette,
    /// Preferences.
    Preferences,
    /// The list of messages.
    Messages,
    /// The choices of a picture.
    Picture,
    /// Name, version, licences.
    About,
    /// Unsaved work, asked about before the program ends.
    Unsaved,
    /// Files of a project that were not found.
    MissingFiles,
}

/// Plain choices about the picture, changed as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Display {
    /// Opacity of each part, 0 to 1.
    pub opacity: PerRole<f32>,
    /// The crash part is drawn so that one sees through it.
    pub is_see_through: bool,
    /// The stamped part is drawn so far from where it is, along the mean normal; display only.
    pub separation: f64,
    /// Where the wipe line lies, 0 left to 1 right; `None` without a wipe.
    pub wipe: Option<f32>,
    /// A line splits each window: reduced left, full right. Where it lies, 0 to 1.
    pub split: Option<f32>,
    /// Edges of the mesh.
    pub has_edges: bool,
    /// Sharp edges and borders.
    pub has_feature_edges: bool,
    /// Nodes.
    pub has_points: bool,
    /// What the colours say.
    pub color_by: ColorBy,
    /// Maps, limits, tolerance.
    pub coloring: Coloring,
    /// The small axes in the corner.
    pub has_axes: bool,
    /// The scale bar.
    pub has_scale_bar: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            opacity: PerRole {
                crash: 1.0,
                stamped: 1.0,
            },
            is_see_through: false,
            separation: 0.0,
            wipe: None,
            split: None,
            has_edges: false,
            has_feature_edges: true,
            has_points: false,
            color_by: ColorBy::default(),
            coloring: Coloring::default(),
            has_axes: true,
            has_scale_bar: true,
        }
    }
}

/// A move or rotation by keys that is under way.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveTool {
    /// What was typed and dragged so far.
    pub modal: ModalMove,
    /// Pivot and axes as they were at its beginning.
    pub frame: MoveFrame,
    /// Its one undo step.
    pub gesture: GestureId,
}

/// What is shown and how. Not undone, not part of any result.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewState {
    /// The camera of each window.
    pub cameras: PerRole<Camera>,
    /// The camera before the last big change, for the key "previous view".
    pub previous_cameras: PerRole<Camera>,
    /// How often a project brought its cameras. The windows then show them at once, as they are.
    pub n_restored: u64,
    /// Width over height of each window.
    pub aspects: PerRole<f64>,
    /// Rotation and zoom of one window follow the other.
    pub are_linked: bool,
    /// Turntable or free.
    pub orbit_style: OrbitStyle,
    /// Picked pivot of the camera, in the space of its window.
    pub pivot: PerRole<Option<Point3>>,
    /// The window keys and menus act on.
    pub focus: Role,
    /// The stamped part is shown in the left window, at its pose.
    pub is_moved_over: bool,
    /// What the right window is used for meanwhile, if the user chose.
    pub free_window: Option<FreeWindow>,
    /// Reduced or detailed.
    pub shown: ShownGeometry,
    /// The key that shows the full mesh is held (or hides the moved part, when moved over).
    pub is_blinking: bool,
    /// Plain choices about the picture.
    pub display: Display,
    /// The section plane.
    pub section: SectionView,
    /// The selected parts of the decks.
    pub selected: BTreeSet<PartRef>,
    /// The part of a deck under the pointer, in the tree or in a window.
    pub hovered: Option<PartRef>,
    /// The tab of the bottom pane.
    pub tab: BottomTab,
    /// Only the 3D windows are shown.
    pub is_graphics_only: bool,
    /// Which of the three sections are unfolded.
    pub sections: Sections,
    /// What lies over the window.
    pub dialog: Option<Dialog>,
    /// The gizmo is shown.
    pub has_gizmo: bool,
    /// Whose axes gizmo and keys use.
    pub move_axes: AxisFrame,
    /// The move by keys that is under way.
    pub move_tool: Option<MoveTool>,
    /// The tool that picks pairs of points.
    pub pair_tool: Option<PairTool>,
    /// The pose of a start or an iteration that is shown while the pointer is on it.
    pub hovered_preview: Option<Preview>,
    /// The pose of a start or an iteration that is shown until it is let go.
    pub pinned_preview: Option<Preview>,
    /// The start whose curve was chosen; by default that of the winner.
    pub chosen_start: Option<usize>,
    /// The stamped part is shown where its file has it, until it is moved.
    pub is_as_loaded: bool,
}

impl Default for ViewState {
    fn default() -> Self {
        Self {
            cameras: PerRole::default(),
            previous_cameras: PerRole::default(),
            n_restored: 0,
            aspects: PerRole {
                crash: 1.0,
                stamped: 1.0,
            },
            are_linked: false,
            orbit_style: OrbitStyle::Turntable,
            pivot: PerRole::default(),
            focus: Role::Crash,
            is_moved_over: false,
            free_window: None,
            shown: ShownGeometry::default(),
            is_blinking: false,
            display: Display::default(),
            section: SectionView::default(),
            selected: BTreeSet::new(),
            hovered: None,
            tab: BottomTab::default(),
            is_graphics_only: false,
            sections: Sections::default(),
            dialog: None,
            has_gizmo: false,
            move_axes: AxisFrame::Global,
            move_tool: None,
            pair_tool: None,
            hovered_preview: None,
            pinned_preview: None,
            chosen_start: None,
            is_as_loaded: false,
        }
    }
}

impl ViewState {
    /// Sets a camera and lets the other window follow if they are linked.
    pub fn set_camera(&mut self, role: Role, camera: Camera) {
        *self.cameras.get_mut(role) = camera;
        if self.are_linked {
            self.cameras.get_mut(role.other()).link_to(&camera);
        }
    }

    /// Remembers the present camera before a jump.
    pub fn remember_camera(&mut self, role: Role) {
        *self.previous_cameras.get_mut(role) = *self.cameras.get(role);
    }

    /// Fits a window's camera to points; without any it stays.
    pub fn fit(&mut self, role: Role, points: &[Point3], aspect: f64) {
        if !points.is_empty() {
            self.remember_camera(role);
            let mut camera = *self.cameras.get(role);
            camera.fit_to_points(points, aspect);
            self.set_camera(role, camera);
        }
    }
}
