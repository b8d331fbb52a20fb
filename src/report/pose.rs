//! The transformation of a match in every form, for records and reports.

use serde::Serialize;

use super::matrix::proper_rotation;
use crate::geometry::{Point3, Similarity};

/// `crash = c · R · stamped + t` in every form. All lengths are in the crash model's unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PoseRecord {
    /// 4×4 as rows, crash from stamped, scale included.
    pub matrix: [[f64; 4]; 4],
    /// 4×4 as rows of the way back, stamped from crash.
    pub inverse: [[f64; 4]; 4],
    /// R as rows.
    pub rotation: [[f64; 3]; 3],
    /// The rotation as one angle about one axis.
    pub rotation_axis_angle: AxisAngle,
    /// The rotation as a unit quaternion w, x, y, z.
    pub quaternion: [f64; 4],
    /// Translation t.
    pub translation: [f64; 3],
    /// Scale factor c.
    pub scale: f64,
    /// Determinant of R: 1, or −1 for a mirrored part.
    pub determinant: f64,
    /// Displacement of the centre of the stamped part: what people expect of a translation.
    pub center_move: [f64; 3],
    /// One node before and after, to try a reader of the matrix with.
    pub sample_node: Option<SampleNode>,
}

/// The rotation as axis and angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AxisAngle {
    /// Unit vector in the crash model's axes; x for no rotation.
    pub axis: [f64; 3],
    /// 0 to 180.
    pub angle_deg: f64,
}

/// A node of the stamped part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SampleNode {
    /// Its id in the stamped file.
    pub id: u64,
    /// Where the stamped file has it.
    pub stamped: [f64; 3],
    /// Where the matrix puts it.
    pub crash: [f64; 3],
}

impl PoseRecord {
    /// What is done to the part before it is rotated, to follow the angle and its axis; empty unless it is mirrored.
    pub fn mirror_words(&self) -> &'static str {
        if self.determinant < 0.0 {
            ", after it is mirrored: x → −x"
        } else {
            ""
        }
    }

    /// Every form of `crash_from_stamped`, for a node and the centre of the stamped part.
    pub fn new(
        crash_from_stamped: &Similarity,
        sample_node: Option<(u64, Point3)>,
        center: &Point3,
    ) -> Self {
        let pose = crash_from_stamped;
        let q = proper_rotation(pose);
        let (axis, angle) = q
            .axis_angle()
            .map_or(([1.0, 0.0, 0.0], 0.0), |(axis, angle)| {
                (axis.into_inner().into(), angle)
            });
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| pose.rotation[(i, j)]));
        Self {
            matrix: rows(pose),
            inverse: rows(&pose.inverse()),
            rotation: rotation.map(unsigned_zeros),
            rotation_axis_angle: AxisAngle {
                axis: unsigned_zeros(axis),
                angle_deg: angle.to_degrees(),
            },
            quaternion: unsigned_zeros([q.w, q.i, q.j, q.k]),
            translation: unsigned_zeros(pose.translation.into()),
            scale: pose.scale,
            determinant: pose.rotation.determinant(),
            center_move: unsigned_zeros((pose.apply(center) - center).into()),
            sample_node: sample_node.map(|(id, point)| SampleNode {
                id,
                stamped: unsigned_zeros(point.into()),
                crash: unsigned_zeros(pose.apply(&point).into()),
            }),
        }
    }
}

/// 4×4 as rows, for people and other programs: no zero has a sign.
pub(super) fn rows(pose: &Similarity) -> [[f64; 4]; 4] {
    pose.to_rows().map(unsigned_zeros)
}

/// A sum with zero is the number itself, but for a negative zero.
fn unsigned_zeros<const N: usize>(numbers: [f64; N]) -> [f64; N] {
    numbers.map(|x| x + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Vector3};

    #[test]
    fn all_forms_are_the_same_motion() {
        let turn = Vector3::new(0.0, 0.0, 0.5);
        let rigid: Similarity = Pose::new(Vector3::new(1.0, 2.0, 3.0), turn).into();
        let point = Point3::new(10.0, 0.0, 0.0);
        for pose in [rigid, rigid.after(&Similarity::mirror_x())] {
            let record = PoseRecord::new(&pose, Some((7, point)), &point);
            let AxisAngle { axis, angle_deg } = record.rotation_axis_angle;
            assert!((axis[2] - 1.0).abs() < 1e-12);
            assert!((angle_deg - 0.5_f64.to_degrees()).abs() < 1e-12);
            assert!((record.quaternion[0] - 0.25_f64.cos()).abs() < 1e-12);
            assert_eq!(record.determinant > 0.0, !pose.is_mirrored());
            assert_eq!(record.mirror_words().is_empty(), !pose.is_mirrored());
            let node = record.sample_node.unwrap();
            assert_eq!(Point3::from(node.crash), pose.apply(&point));
            assert_eq!(
                <[f64; 3]>::from(pose.apply(&point) - point),
                record.center_move
            );
        }
        let json = |pose| serde_json::to_string(&PoseRecord::new(pose, None, &point)).unwrap();
        let zeros = Similarity {
            translation: Vector3::new(-0.0, 0.0, -0.0),
            ..Similarity::mirror_x()
        };
        assert!(!json(&zeros).contains("-0.0"), "{}", json(&zeros));
        let still = PoseRecord::new(&Similarity::identity(), None, &point);
        assert_eq!(still.rotation_axis_angle.axis, [1.0, 0.0, 0.0]);
        assert_eq!(still.rotation_axis_angle.angle_deg, 0.0);
    }
}
