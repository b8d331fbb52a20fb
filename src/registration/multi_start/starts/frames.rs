//! First poses that align the principal axes of both parts.

use super::{StartKind, rotation_about};
use crate::geometry::{Matrix3, Rotation, Similarity, Vector3};
use crate::registration::surface::Surface;

/// Principal axes on principal axes, in the four ways that keep the hand.
pub(super) fn poses(source: &Surface, target: &Surface) -> Vec<(StartKind, Similarity)> {
    let (from, to) = (source.measures(), target.measures());
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    signs
        .iter()
        .enumerate()
        .map(|(k, [a, b])| {
            let sign = Matrix3::from_diagonal(&Vector3::new(*a, *b, a * b));
            let matrix = to.principal_axes * sign * from.principal_axes.transpose();
            let rotation = nalgebra::Rotation3::from_matrix_unchecked(matrix);
            let rotation = Rotation::from_rotation_matrix(&rotation);
            let pose = rotation_about(rotation, &from.centroid, &to.centroid);
            (StartKind::PrincipalFrame { signs: k }, pose)
        })
        .collect()
}
