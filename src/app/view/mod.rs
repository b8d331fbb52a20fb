//! What is shown and how: cameras, windows, panels.

mod apply;
mod command;
mod display;
mod free_window;
mod sections;
mod status;

use std::collections::BTreeSet;
use std::path::PathBuf;

pub use command::ViewCommand;
pub use display::{BottomTab, ColorBy, ColumnRoom, Dialog, Display, ShownGeometry};
pub use free_window::FreeWindow;
pub use sections::Sections;
pub use status::{OpenQuestion, Section, Stale};

pub(super) use self::apply::Scene;
use crate::geometry::camera::{Covered, OrbitStyle};
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
    /// Shape of each window and what lies over it.
    pub rooms: PerRole<ViewRoom>,
    /// How the cameras were fitted last: one that is still there is fitted again when its window changes.
    fitted: PerRole<Option<Fitted>>,
    /// The stamped part was moved by hand since: what lies on the screen stays there, so that the hand finds it.
    is_moved_by_hand: bool,
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
    /// What the colours said before a map of the match, which its key brings back.
    pub(super) colors_before_map: ColorBy,
    /// Stamped files that are not drawn.
    pub hidden_files: BTreeSet<PathBuf>,
    /// The tab of the bottom pane.
    pub tab: BottomTab,
    /// Only the 3D windows are shown.
    pub is_graphics_only: bool,
    /// What room the window has for the left column.
    pub column_room: ColumnRoom,
    /// What the user said about the column since the window got this room.
    column: Option<bool>,
    /// Which of the four sections are unfolded.
    pub sections: Sections,
    /// How often it was asked to unfold what moves the part by hand.
    pub n_asked_by_hand: u64,
    /// What lies over the window.
    pub dialog: Option<Dialog>,
}

impl Default for ViewState {
    fn default() -> Self {
        Self {
            cameras: PerRole::default(),
            previous_cameras: PerRole::default(),
            n_restored: 0,
            rooms: PerRole::default(),
            fitted: PerRole::default(),
            is_moved_by_hand: false,
            are_linked: false,
            orbit_style: OrbitStyle::Turntable,
            pivot: PerRole::default(),
            focus: Role::Crash,
            is_moved_over: false,
            free_window: None,
            shown: ShownGeometry::default(),
            is_blinking: false,
            display: Display::default(),
            colors_before_map: ColorBy::default(),
            hidden_files: BTreeSet::new(),
            tab: BottomTab::default(),
            is_graphics_only: false,
            column_room: ColumnRoom::Enough,
            column: None,
            sections: Sections::default(),
            n_asked_by_hand: 0,
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

    /// The window whose camera a window has: while the right one is free, both have the left one's.
    pub fn camera_of(&self, window: Role) -> Role {
        if self.is_moved_over {
            Role::Crash
        } else {
            window
        }
    }

    /// Remembers the present camera before a jump.
    pub fn remember_camera(&mut self, role: Role) {
        *self.previous_cameras.get_mut(role) = *self.cameras.get(role);
    }

    /// Fits a window's camera to points, beside what lies over the window; without any it stays.
    pub fn fit(&mut self, role: Role, points: &[Point3], room: &ViewRoom) {
        if !points.is_empty() {
            let mut camera = *self.cameras.get(role);
            camera.fit_to_points_within(points, room.aspect, &room.covered);
            self.set_camera(role, camera);
        }
    }

    /// True while the left column is a rail: in a narrow window, or because the user folded it.
    pub fn is_column_folded(&self) -> bool {
        self.column
            .unwrap_or(self.column_room != ColumnRoom::Enough)
    }

    /// True while a window shows what it was fitted to: the user has not moved its camera since.
    pub fn is_fitted(&self, role: Role) -> bool {
        let fitted = self.fitted.get(role).as_ref();
        fitted.is_some_and(|fitted| fitted.camera == *self.cameras.get(role))
    }
}

/// A camera that was fitted, and the room that it was fitted into.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fitted {
    camera: Camera,
    /// The room it was fitted into at first, before other legends came.
    first_room: ViewRoom,
}

/// The room that a window is fitted into, and the one whose legend it goes back to.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FitRooms {
    now: ViewRoom,
    first: ViewRoom,
}

impl FitRooms {
    fn new(room: ViewRoom) -> Self {
        Self {
            now: room,
            first: room,
        }
    }
}

/// The shape of a 3D window and what lies over its picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewRoom {
    /// Width over height.
    pub aspect: f64,
    /// What names, legend and buttons cover.
    pub covered: Covered,
}

impl Default for ViewRoom {
    fn default() -> Self {
        Self {
            aspect: 1.0,
            covered: Covered::default(),
        }
    }
}

impl ViewRoom {
    /// True if a picture fitted to one of both would look wrong in the other: by more than a hundredth
    /// of a side.
    pub fn differs(&self, other: &Self) -> bool {
        let sides = |room: &Self| {
            let Covered {
                left,
                right,
                top,
                bottom,
                corner: [width, height],
                beside: [from_left, from_right],
                above,
            } = room.covered;
            let edges = [left, right, top, bottom, width, height];
            let legend = [from_left, from_right, above];
            edges.into_iter().chain(legend).chain([room.aspect.ln()])
        };
        let mut pairs = sides(self).zip(sides(other));
        pairs.any(|(a, b)| (a - b).abs() > 0.01)
    }

    /// This room with all that the legend covered when the window was fitted `first`: a map with a smaller legend must
    /// not move the picture. One with a larger legend does, until the legend is as it was. A window of another shape,
    /// one whose legend came to an edge that was free, and one that has no legend any more, is fitted anew.
    fn keeping_legend_of(&self, first: &Self) -> FitRooms {
        let has_legend = self.covered.beside != [0.0; 2];
        if !self.has_shape_of(first) || !has_legend || self.has_legend_where_free(first) {
            return FitRooms::new(*self);
        }
        let with_legend = |legend: Covered| Self {
            covered: Covered {
                beside: legend.beside,
                above: legend.above,
                ..self.covered
            },
            ..*self
        };
        FitRooms {
            now: with_legend(self.covered.union(&first.covered)),
            first: with_legend(first.covered),
        }
    }

    /// True if the window is as wide for its height as another.
    fn has_shape_of(&self, other: &Self) -> bool {
        (self.aspect / other.aspect).ln().abs() <= 0.01
    }

    /// True if the legend is at an edge that was free `before`: it came up, or was moved there.
    fn has_legend_where_free(&self, before: &Self) -> bool {
        let mut sides = self.covered.beside.iter().zip(&before.covered.beside);
        sides.any(|(now, then)| *now > 0.0 && *then == 0.0)
    }

    /// The room that is free in both of two windows that show one camera's picture.
    fn shared(&self, other: &Self) -> Self {
        Self {
            aspect: self.aspect.min(other.aspect),
            covered: self.covered.union(&other.covered),
        }
    }
}
