//! A part made longer, wider or higher.

use crate::geometry::{Matrix3, Point3};

/// Lengths along three axes through a point multiplied by factors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scaled {
    center: Point3,
    matrix: Matrix3,
    inverse: Matrix3,
}

impl Scaled {
    /// `axes` are orthonormal columns.
    pub(super) fn new(center: Point3, axes: &Matrix3, factors: [f64; 3]) -> Self {
        let along =
            |factors: [f64; 3]| axes * Matrix3::from_diagonal(&factors.into()) * axes.transpose();
        Self {
            center,
            matrix: along(factors),
            inverse: along(factors.map(f64::recip)),
        }
    }

    /// The place of a point of the source.
    pub(super) fn apply(&self, point: &Point3) -> Point3 {
        self.center + self.matrix * (point - self.center)
    }

    /// The place that comes to lie on this point.
    pub(super) fn undo(&self, point: &Point3) -> Point3 {
        self.center + self.inverse * (point - self.center)
    }
}
