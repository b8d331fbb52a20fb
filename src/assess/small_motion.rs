//! A small rigid motion as the unknowns of linear equations.

use nalgebra::SVector;

use crate::geometry::Vector3;

/// A small motion: a turn about a centre, in lengths at a radius, and a shift. Centre and radius are the same for all
/// of one set of equations.
pub(super) type Six = SVector<f64, 6>;

/// Where unknowns stand that are solved for with a motion, whose six numbers come first.
pub(super) struct Unknown;

impl Unknown {
    /// An offset of the sheets along their normals.
    pub(super) const OFFSET: usize = 6;
}

/// How much each number of a motion moves a place along a direction; `arm` leads from the centre to the place, in
/// radii.
pub(super) fn row(arm: &Vector3, direction: &Vector3) -> Six {
    let lever = arm.cross(direction);
    Six::from([
        lever.x,
        lever.y,
        lever.z,
        direction.x,
        direction.y,
        direction.z,
    ])
}

/// The motion among the unknowns.
pub(super) fn motion_of<const N: usize>(unknowns: &SVector<f64, N>) -> Six {
    unknowns.fixed_rows::<6>(0).into()
}

/// The turn and the shift of a motion.
pub(super) fn turn_and_shift(motion: &Six) -> [Vector3; 2] {
    [0, 3].map(|first| motion.fixed_rows::<3>(first).into())
}
