//! Cameras that show a box whole.

use super::{Camera, Projection};
use crate::geometry::{Aabb, Point3, Vector3};

/// Air around a fitted scene, on each side, as a share of the picture.
const MARGIN: f64 = 0.05;

impl Camera {
    /// Moves and zooms so that the box fills the picture with a margin of 5 %; the rotation stays.
    ///
    /// A box without size is centred and the zoom kept; for the empty box nothing changes.
    pub fn fit(&mut self, bounds: &Aabb, aspect: f64) {
        self.fit_points(&bounds.corners(), aspect, bounds.is_empty());
    }

    /// As [`Camera::fit`], tight around points: a turned sheet fills the picture better than the
    /// corners of its box would. O(points).
    pub fn fit_to_points(&mut self, points: &[Point3], aspect: f64) {
        self.fit_points(points, aspect, points.is_empty());
    }

    fn fit_points(&mut self, points: &[Point3], aspect: f64, nothing: bool) {
        if nothing {
            return;
        }
        let in_view = |p: &Point3| Point3::from(self.world_from_view.inverse() * (p - points[0]));
        let seen: Vec<Point3> = points.iter().map(in_view).collect();
        let extent = Aabb::of_points(&seen);
        let center = extent.center();
        let target = points[0] + self.world_from_view * center.coords;
        let height = fitted_height(&seen, &center.coords, self.projection, aspect.max(1e-6));
        let size = extent.diagonal();
        let far_digits = 1e-9 * points[0].coords.norm();
        if size > far_digits && height > 0.0 {
            self.height = height / (1.0 - 2.0 * MARGIN);
        }
        self.target = target;
    }
}

/// Height of the smallest picture about `center` that shows all points (view directions).
fn fitted_height(points: &[Point3], center: &Vector3, projection: Projection, aspect: f64) -> f64 {
    let half_height = |p: &Point3| {
        let d = p.coords - center;
        let wanted = d.y.abs().max(d.x.abs() / aspect);
        match projection {
            Projection::Orthographic => wanted,
            // The eye stands so far back that the ray to this point stays inside the cone.
            Projection::Perspective { fov_y } => wanted + d.z * (fov_y / 2.0).tan(),
        }
    };
    2.0 * points.iter().map(half_height).fold(0.0, f64::max)
}
