//! Orbit, pan, zoom and roll.

use serde::{Deserialize, Serialize};

use super::{Camera, Projection, ScreenSize};
use crate::geometry::{Aabb, Point3, Rotation, Vector3};

/// How dragging turns the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrbitStyle {
    /// Sideways about the world's z axis, upwards about the screen's horizontal: the horizon stays level.
    #[default]
    Turntable,
    /// About the screen's axes: every orientation can be reached in one drag.
    Free,
}

/// Smallest picture height over the scene's diagonal.
const CLOSEST: f64 = 1e-3;
/// Largest picture height over the scene's diagonal.
const FARTHEST: f64 = 20.0;

impl Camera {
    /// Turns the camera about `pivot`, which stays where it is on the screen.
    ///
    /// `right` and `up` are the angles in radians by which the scene seems to turn, as the mouse
    /// moves. The turntable passes over the pole without a stop; below it, sideways motion keeps
    /// following the mouse. Merging several small motions into one changes nothing for the turntable.
    pub fn orbit(&mut self, style: OrbitStyle, pivot: &Point3, right: f64, up: f64) {
        let turned = match style {
            OrbitStyle::Turntable => {
                let sideways = if self.up().z < 0.0 { -right } else { right };
                Rotation::from_axis_angle(&Vector3::z_axis(), -sideways)
                    * self.world_from_view
                    * Rotation::from_axis_angle(&Vector3::x_axis(), up)
            }
            OrbitStyle::Free => self.world_from_view * Rotation::new(Vector3::new(up, -right, 0.0)),
        };
        self.turn_about(pivot, turned);
    }

    /// Rolls the picture about the pixel of `pivot`; positive turns the scene counter-clockwise.
    pub fn roll(&mut self, pivot: &Point3, angle: f64) {
        let turned = self.world_from_view * Rotation::from_axis_angle(&Vector3::z_axis(), -angle);
        self.turn_about(pivot, turned);
    }

    /// Takes the new rotation and moves the target so that `pivot` keeps its view coordinates.
    fn turn_about(&mut self, pivot: &Point3, world_from_view: Rotation) {
        let pivot_in_view = self.view_point(pivot);
        // Thousands of small products would drift from unit length.
        self.world_from_view = Rotation::new_normalize(world_from_view.into_inner());
        self.target = pivot - self.world_from_view * pivot_in_view;
    }

    /// Shifts the picture so that the point at the depth of `anchor` under the pixel `from` comes to
    /// lie under the pixel `to`.
    pub fn pan(&mut self, from: [f64; 2], to: [f64; 2], screen: ScreenSize, anchor: &Point3) {
        let before = self.unproject(from, screen, anchor);
        let after = self.unproject(to, screen, anchor);
        self.target += before - after;
    }

    /// Scales the picture by `1 / factor` about `anchor`, which keeps its pixel; a factor below 1
    /// comes closer. `bounds` limits the zoom to between 1/1000 and 20 times its diagonal; an empty
    /// or point-like scene does not limit it.
    pub fn zoom(&mut self, factor: f64, anchor: &Point3, bounds: &Aabb) {
        if !(factor.is_finite() && factor > 0.0) {
            return;
        }
        let mut height = self.height * factor;
        let diagonal = bounds.diagonal();
        if diagonal > 0.0 {
            // A camera beyond a limit may come back but go no further.
            let low = (CLOSEST * diagonal).min(self.height);
            let high = (FARTHEST * diagonal).max(self.height);
            height = height.clamp(low, high);
        }
        let factor = height / self.height;
        self.height = height;
        self.target = anchor + (self.target - anchor) * factor;
    }

    /// Copies rotation, zoom and projection but not the position: parts in different coordinate
    /// systems stay comparable.
    pub fn link_to(&mut self, other: &Self) {
        self.world_from_view = other.world_from_view;
        self.height = other.height;
        self.projection = other.projection;
    }

    /// Changes between orthographic and the usual perspective.
    pub fn toggle_projection(&mut self) {
        self.projection = match self.projection {
            Projection::Orthographic => Projection::perspective(),
            Projection::Perspective { .. } => Projection::Orthographic,
        };
    }
}
