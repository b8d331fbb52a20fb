//! Cameras on their way from one view to another.

use super::Camera;
use crate::geometry::Rotation;

/// A camera on its way from one view to another. Time is the caller's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraFlight {
    /// Where it starts.
    pub from: Camera,
    /// Where it ends; its projection is used from the first frame.
    pub to: Camera,
}

impl CameraFlight {
    /// Seconds a change of view takes.
    pub const SECS: f64 = 0.2;

    /// The camera at `progress` 0 … 1 (clamped): rotation along the shortest arc, zoom in equal
    /// ratios, both eased in and out. Exactly `to` at the end.
    pub fn at(&self, progress: f64) -> Camera {
        if progress.is_nan() || progress >= 1.0 {
            return self.to;
        }
        let t = progress.max(0.0);
        let t = t * t * (3.0 - 2.0 * t);
        // Through the axis and angle, because the usual slerp has no answer for half turns.
        let turn = self.from.world_from_view.inverse() * self.to.world_from_view;
        let (from, to) = (&self.from, &self.to);
        Camera {
            target: from.target + (to.target - from.target) * t,
            world_from_view: from.world_from_view * Rotation::new(turn.scaled_axis() * t),
            height: from.height * (to.height / from.height).powf(t),
            projection: to.projection,
        }
    }
}
