//! What is shown and how: cameras, windows, panels.

mod apply;
mod command;
mod display;
mod free_window;
mod sections;
mod status;

pub use command::ViewCommand;
pub use display::{BottomTab, ColorBy, Dialog, Display, ShownGeometry};
pub use free_window::FreeWindow;
pub use sections::Sections;
pub use status::{Section, Stale};

pub(super) use self::apply::Scene;
use crate::geometry::camera::OrbitStyle;
use crate::geometry::{Camera, Point3};
use crate::role::{PerRole, Role};

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
    /// The tab of the bottom pane.
    pub tab: BottomTab,
    /// Only the 3D windows are shown.
    pub is_graphics_only: bool,
    /// Which of the three sections are unfolded.
    pub sections: Sections,
    /// What lies over the window.
    pub dialog: Option<Dialog>,
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
            tab: BottomTab::default(),
            is_graphics_only: false,
            sections: Sections::default(),
            dialog: None,
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
