//! First poses that align the principal axes of both parts.

use super::{StartKind, rotation_about};
use crate::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3};
use crate::registration::surface::Surface;

/// Principal axes on principal axes, in the four ways that keep the hand.
pub(super) fn poses(source: &Surface, target: &Surface) -> Vec<(StartKind, Similarity)> {
    let [from, to] = [source, target].map(|surface| {
        let measures = surface.measures();
        (measures.centroid, measures.principal_axes)
    });
    let poses = axes_on_axes(from, to).into_iter().enumerate();
    poses
        .map(|(signs, pose)| (StartKind::PrincipalFrame { signs }, pose))
        .collect()
}

/// The four motions that keep the hand and bring a centroid and the principal directions, as columns, to others.
pub(crate) fn axes_on_axes(from: (Point3, Matrix3), to: (Point3, Matrix3)) -> [Similarity; 4] {
    let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    signs.map(|[a, b]| {
        let sign = Matrix3::from_diagonal(&Vector3::new(a, b, a * b));
        let matrix = to.1 * sign * from.1.transpose();
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(matrix);
        let rotation = Rotation::from_rotation_matrix(&rotation);
        rotation_about(rotation, &from.0, &to.0)
    })
}
