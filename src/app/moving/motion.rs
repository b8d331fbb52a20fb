//! A move of the stamped part in words and numbers.

use serde::{Deserialize, Serialize};

use crate::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3};

/// One of the three axes of an [`AxisFrame`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// X axis of the frame.
    X,
    /// Y axis of the frame.
    Y,
    /// Z axis of the frame.
    Z,
}

impl Axis {
    /// The three axes in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The axis as a capital letter.
    pub fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
        }
    }

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Whose axes a move follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisFrame {
    /// Those of the crash model.
    #[default]
    Global,
    /// The stamped part's own, as it lies now.
    Part,
    /// Those of the screen: right, up, towards the viewer.
    View,
}

impl AxisFrame {
    /// All, in the order they are cycled through.
    pub const ALL: [Self; 3] = [Self::Global, Self::Part, Self::View];

    /// Its name in the window.
    pub fn label(self) -> &'static str {
        match self {
            Self::Global => "global",
            Self::Part => "part",
            Self::View => "view",
        }
    }
}

/// Pivot and the axes of all three frames at the moment a move begins. Columns are unit vectors in
/// the space the move happens in (that of the crash model).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveFrame {
    /// The point rotations leave where it is.
    pub pivot: Point3,
    /// The part's own axes.
    pub part: Matrix3,
    /// Right, up and towards the viewer.
    pub view: Matrix3,
    /// What follows a length in the name of a move: `" mm"`, or nothing where the unit is unknown.
    pub unit: &'static str,
}

impl MoveFrame {
    /// The frame of a part at its pose, seen with these view axes. A mirrored pose gives axes of
    /// the other hand, as the part shows them.
    pub fn new(pivot: Point3, crash_from_stamped: &Similarity, view: Matrix3) -> Self {
        Self {
            pivot,
            part: crash_from_stamped.rotation,
            view,
            unit: "",
        }
    }

    /// The same frame with lengths in this unit.
    pub fn with_unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Unit vector of an axis.
    pub fn axis(&self, axis: Axis, frame: AxisFrame) -> Vector3 {
        match frame {
            AxisFrame::Global => Matrix3::identity().column(axis.index()).into(),
            AxisFrame::Part => self.part.column(axis.index()).into(),
            AxisFrame::View => self.view.column(axis.index()).into(),
        }
    }
}

/// The motion by `distance` along a direction, which need not be a unit vector; zero gives none.
pub fn translation_along(direction: &Vector3, distance: f64) -> Similarity {
    let norm = direction.norm();
    if norm == 0.0 || !distance.is_finite() {
        return Similarity::identity();
    }
    Similarity::from_translation(direction * (distance / norm))
}

/// The rotation by `angle` radians about an axis through `pivot`, right-handed; a zero axis gives
/// no motion.
pub fn rotation_about(pivot: &Point3, axis: &Vector3, angle: f64) -> Similarity {
    let Some(axis) = nalgebra::Unit::try_new(*axis, 0.0).filter(|_| angle.is_finite()) else {
        return Similarity::identity();
    };
    let rotation = *Rotation::from_axis_angle(&axis, angle)
        .to_rotation_matrix()
        .matrix();
    Similarity::about(pivot, rotation)
}

/// Rotation as turns about x, then y, then z of the crash model, in degrees; `None` for a mirrored
/// pose, which no turns make.
pub fn turns_deg(pose: &Similarity) -> Option<[f64; 3]> {
    if pose.is_mirrored() {
        return None;
    }
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(pose.rotation);
    let (x, y, z) = rotation.euler_angles();
    Some([x, y, z].map(f64::to_degrees))
}

/// The pose with other turns; the image of `pivot`, a point of the stamped part, stays.
pub fn with_turns_deg(pose: &Similarity, turns: [f64; 3], pivot: &Point3) -> Similarity {
    let [x, y, z] = turns.map(f64::to_radians);
    let rotation = *nalgebra::Rotation3::from_euler_angles(x, y, z).matrix();
    Similarity { rotation, ..*pose }.taking(pivot, &pose.apply(pivot))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_rotation_leaves_its_pivot_and_follows_the_right_hand() {
        let pivot = Point3::new(1000.0, 2.0, -3.0);
        let turn = rotation_about(&pivot, &Vector3::new(0.0, 0.0, 5.0), FRAC_PI_2);
        assert!((turn.apply(&pivot) - pivot).norm() < 1e-12);
        let moved = turn.apply(&(pivot + Vector3::x()));
        assert!((moved - (pivot + Vector3::y())).norm() < 1e-12);
    }

    #[test]
    fn turns_are_read_back_and_keep_the_pivot() {
        let pivot = Point3::new(10.0, -20.0, 30.0);
        let begin = translation_along(&Vector3::new(1.0, 2.0, 3.0), 5.0);
        let turned = with_turns_deg(&begin, [10.0, -20.0, 170.0], &pivot);
        let turns = turns_deg(&turned).unwrap();
        for (found, given) in turns.iter().zip([10.0, -20.0, 170.0]) {
            assert!((found - given).abs() < 1e-9, "{turns:?}");
        }
        assert!((turned.apply(&pivot) - begin.apply(&pivot)).norm() < 1e-9);
        assert_eq!(turns_deg(&Similarity::mirror_x()), None);
    }

    #[test]
    fn degenerate_axes_move_nothing() {
        let zero = Vector3::zeros();
        assert_eq!(translation_along(&zero, 3.0), Similarity::identity());
        assert_eq!(
            rotation_about(&Point3::origin(), &zero, 1.0),
            Similarity::identity()
        );
    }
}
