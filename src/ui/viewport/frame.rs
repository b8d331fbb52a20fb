//! What one window is and shows in one frame, as everything that draws or reads it needs it.

use egui::{Pos2, Rect, Response};

use super::navigation::{pixel_of, screen_of};
use super::picture::Picture;
use super::visible_parts::free_window;
use crate::app::{AppState, FreeWindow};
use crate::geometry::camera::ScreenSize;
use crate::geometry::{Camera, Point3, Similarity};
use crate::role::Role;
use crate::ui::theme::Look;

/// What a window's picture depends on beside the state.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewFrame {
    /// Which of the two windows.
    pub window: Role,
    /// Its camera as it is shown, on its way or not.
    pub camera: Camera,
    /// Width over height.
    pub aspect: f64,
    /// The pose of the stamped part as it is shown, gliding or not.
    pub pose: Similarity,
    /// How far the stamped part has flown from the right window (0) to the left one (1).
    pub over: f64,
    /// Only creases and borders are drawn, while the camera is dragged so.
    pub is_bare: bool,
}

/// A window in one frame: where it is, what it shows, and the state of the program.
#[derive(Clone, Copy)]
pub(super) struct FrameContext<'a> {
    /// The window's place and what the pointer does there.
    pub response: &'a Response,
    pub state: &'a AppState,
    pub view: &'a ViewFrame,
    /// What is drawn.
    pub picture: &'a Picture,
    pub look: &'a Look,
}

impl FrameContext<'_> {
    /// The window's place.
    pub fn rect(&self) -> Rect {
        self.response.rect
    }

    /// Size in points and pixels.
    pub fn screen(&self) -> ScreenSize {
        screen_of(self.rect())
    }

    /// A place relative to its top left corner.
    pub fn pixel(&self, pos: Pos2) -> [f64; 2] {
        pixel_of(self.rect(), pos)
    }

    /// The pivot that was picked for its camera.
    pub fn pivot(&self) -> Option<Point3> {
        *self.state.view.pivot.get(self.camera_role())
    }

    /// True where the stamped part is shown at another pose than in the left window.
    pub fn shows_other_pose(&self) -> bool {
        free_window(self.state, self.view) == Some(FreeWindow::Alternative)
    }

    /// Whose camera it shows.
    pub fn camera_role(&self) -> Role {
        self.state.view.camera_of(self.view.window)
    }
}
