//! First poses that cover all rotations.

use nalgebra::Quaternion;

use super::{StartKind, rotation_about};
use crate::geometry::{Rotation, Similarity};
use crate::registration::surface::Surface;

/// `n` rotations spread evenly over all rotations: super-Fibonacci spirals (Alexa 2022).
pub fn super_fibonacci(n: usize) -> Vec<Rotation> {
    let phi = std::f64::consts::SQRT_2;
    // The root of ψ⁴ = ψ + 4, from the paper.
    let psi = 1.533_751_168_755_204_3;
    (0..n)
        .map(|i| {
            let s = i as f64 + 0.5;
            let t = s / n as f64;
            let (inner, outer) = (t.sqrt(), (1.0 - t).sqrt());
            let (alpha, beta) = (
                std::f64::consts::TAU * s / phi,
                std::f64::consts::TAU * s / psi,
            );
            let quaternion = Quaternion::new(
                outer * beta.cos(),
                inner * alpha.sin(),
                inner * alpha.cos(),
                outer * beta.sin(),
            );
            Rotation::from_quaternion(quaternion)
        })
        .collect()
}

/// The rotations of the covering with the principal frames as their origin, so that they do not
/// depend on how the parts lay.
pub(super) fn poses(source: &Surface, target: &Surface, n: usize) -> Vec<(StartKind, Similarity)> {
    let (from, to) = (source.measures(), target.measures());
    let frame = |axes: nalgebra::Matrix3<f64>| {
        Rotation::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(axes))
    };
    let (source_axes, target_axes) = (frame(from.principal_axes), frame(to.principal_axes));
    super_fibonacci(n)
        .into_iter()
        .enumerate()
        .map(|(index, rotation)| {
            let rotation = target_axes * rotation * source_axes.inverse();
            let pose = rotation_about(rotation, &from.centroid, &to.centroid);
            (StartKind::Covering { index }, pose)
        })
        .collect()
}
