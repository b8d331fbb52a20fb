//! Is there another pose that fits as well?

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::geometry::{Matrix3, Similarity, Vector3};
use crate::registration::{Alternative, Surface};

/// Below this ratio two poses are equivalent.
const AMBIGUOUS_BELOW: f64 = 1.1;
/// Below this ratio the second-best pose deserves a look.
const VERIFY_BELOW: f64 = 1.3;

/// How far the second-best distinct pose is behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clarity {
    /// No other pose comes near.
    Clear,
    /// Another pose is nearly as good: 1.1 to 1.3 times the score.
    Verify,
    /// Another pose is as good: less than 1.1 times the score.
    Ambiguous,
}

/// The comparison with the poses that came closest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ambiguity {
    /// The verdict of the comparison.
    pub clarity: Clarity,
    /// Score of the second-best distinct pose over the best, if one was near.
    pub ratio: Option<f64>,
    /// Whether the ratio is what surfaces, borders and holes say, and no measured error.
    #[serde(default)]
    pub by_shape: bool,
    /// Equivalent positions, the result included.
    pub n_equivalent: usize,
    /// How the second-best pose differs from the best, if it is nearly as good.
    #[serde(default)]
    pub twin: Option<Twin>,
}

/// Which of the part's own axes a rotation is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TwinAxis {
    /// The direction in which the part is longest.
    Long,
    /// Across it, within the sheet.
    Cross,
    /// Through the sheet.
    Through,
    /// None of them.
    Other,
}

/// The motion from the best pose to another, in the source's own terms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Twin {
    /// Rotation angle, 0 to π; of a mirrored pose the angle of what is rotated besides the mirror.
    pub angle: f64,
    /// Axis of the motion between the poses; of a mirrored pose the normal of the mirror's plane, where nothing is
    /// rotated besides.
    pub axis: TwinAxis,
    /// Displacement of the part's centroid, in target length units.
    pub shift: f64,
    /// True if the other pose is of the opposite hand: the motion is a reflection.
    #[serde(default)]
    pub is_mirrored: bool,
}

/// What is rotated besides a mirror counts from this angle on, about 15°.
const NO_TURN: f64 = 0.26;

/// An axis is one of the part's own within about 15°.
const SAME_AXIS: f64 = 0.966;

impl Twin {
    /// Compares two poses `target_from_source` of one source.
    pub fn of(source: &Surface, best: &Similarity, other: &Similarity) -> Self {
        let measures = source.measures();
        let turn = best.rotation.transpose() * other.rotation;
        let is_mirrored = best.is_mirrored() != other.is_mirrored();
        // A mirror at a plane is a half turn about its normal with every direction reversed.
        let turn = if is_mirrored { -turn } else { turn };
        let angle = if is_mirrored {
            PI - cosine_of(&turn).acos()
        } else {
            best.angle_to(other)
        };
        let center = &measures.centroid;
        let has_axis = !is_mirrored || angle < NO_TURN;
        let axis = axis_of(&turn).filter(|_| has_axis);
        let axis = axis.map_or(TwinAxis::Other, |axis| {
            let along = |k: usize| measures.principal_axes.column(k).dot(&axis).abs();
            let known = [TwinAxis::Long, TwinAxis::Cross, TwinAxis::Through];
            let found = (0..3).find(|&k| along(k) > SAME_AXIS);
            found.map_or(TwinAxis::Other, |k| known[k])
        });
        Self {
            angle,
            axis,
            shift: (other.apply(center) - best.apply(center)).norm(),
            is_mirrored,
        }
    }
}

/// Cosine of the angle of a rotation; rounding may take its trace beyond it.
fn cosine_of(turn: &Matrix3) -> f64 {
    ((turn.trace() - 1.0) / 2.0).clamp(-1.0, 1.0)
}

/// Direction of the axis of a rotation, of either sense; `None` where hardly anything is rotated. Half turns have no
/// skew part to read it from, and small ones hardly any other.
fn axis_of(turn: &Matrix3) -> Option<Vector3> {
    let cosine = cosine_of(turn);
    if cosine > 0.0 {
        let skew = turn - turn.transpose();
        return Vector3::new(skew.m32, skew.m13, skew.m21).try_normalize(1e-9);
    }
    // (1 − cosine) times the product of the axis with itself.
    let square = (turn + turn.transpose()) * 0.5 - Matrix3::identity() * cosine;
    let longest = square
        .column_iter()
        .max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
    longest.into_owned().try_normalize(1e-9)
}

impl Ambiguity {
    /// The alternatives, sorted by their error over that of the best pose, that fit nearly as well.
    pub fn near(alternatives: &[Alternative]) -> &[Alternative] {
        let n = alternatives.partition_point(|other| other.score_ratio < VERIFY_BELOW);
        &alternatives[..n]
    }

    /// Assesses alternatives sorted by their error over that of the best pose.
    pub fn of(alternatives: &[Alternative]) -> Self {
        let second = alternatives.first();
        let ratio = second.map(|other| other.score_ratio);
        let clarity = match ratio {
            Some(ratio) if ratio < AMBIGUOUS_BELOW => Clarity::Ambiguous,
            Some(ratio) if ratio < VERIFY_BELOW => Clarity::Verify,
            _ => Clarity::Clear,
        };
        let equivalent = alternatives
            .iter()
            .filter(|a| a.score_ratio < AMBIGUOUS_BELOW);
        Self {
            clarity,
            ratio,
            by_shape: second.is_some_and(|other| other.by_shape),
            n_equivalent: 1 + equivalent.count(),
            twin: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation, TriMesh, Vector3};

    #[test]
    fn a_pose_of_the_other_hand_is_mirrored_and_not_rotated() {
        // Twice as long in x as in y, flat in z.
        let points = [
            [-2.0, -1.0, 0.0],
            [2.0, -1.0, 0.0],
            [2.0, 1.0, 0.0],
            [-2.0, 1.0, 0.0],
        ];
        let points = points.map(crate::geometry::Point3::from).to_vec();
        let mesh = TriMesh::new(points, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let source = Surface::new(&mesh, "source").unwrap();
        let lengths = crate::text::Lengths::new(None);
        let still = Similarity::identity();
        for (axis, words) in [
            (0, "mirrored along its long axis"),
            (1, "mirrored along its short axis"),
            (2, "mirrored at its own plane"),
        ] {
            let mirror = Similarity::mirror(axis);
            for [best, other] in [[&still, &mirror], [&mirror, &still]] {
                let twin = Twin::of(&source, best, other);
                assert!(twin.is_mirrored && twin.angle < 1e-6, "{twin:?}");
                assert_eq!(twin.words(lengths), words);
            }
        }
        let rotation = Rotation::new(Vector3::new(0.0, 0.0, 1.0)).to_rotation_matrix();
        let turned = Similarity {
            rotation: *rotation.matrix(),
            ..still
        };
        let mirrored = turned.after(&Similarity::mirror(0));
        let twin = Twin::of(&source, &still, &mirrored);
        assert_eq!(twin.words(lengths), "mirrored");
        assert!(!Twin::of(&source, &still, &turned).is_mirrored);
    }

    #[test]
    fn half_turns_have_an_angle_whatever_rounding_does() {
        let corners = [
            [0.0, 0.0, 0.0],
            [3.0, 0.0, 0.0],
            [0.0, 2.0, 0.0],
            [0.0, 0.0, 1.0],
        ];
        let points = corners.map(crate::geometry::Point3::from).to_vec();
        let mesh = TriMesh::new(points, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]]).unwrap();
        let source = Surface::new(&mesh, "source").unwrap();
        for k in 1..200 {
            let k = f64::from(k);
            let axis = Vector3::new(k.sin(), (2.0 * k).cos(), 0.3).normalize();
            let turned = |angle: f64| {
                let rotation = *Rotation::new(axis * angle).to_rotation_matrix().matrix();
                // Rounded as a matrix read from a file is.
                let rotation = rotation.map(|x| (x * 1e7).round() / 1e7);
                Similarity {
                    rotation,
                    ..Similarity::identity()
                }
            };
            let twin = Twin::of(&source, &turned(0.4), &turned(0.4 + std::f64::consts::PI));
            assert!((twin.angle - std::f64::consts::PI).abs() < 1e-3, "{twin:?}");
        }
    }
}
