//! First poses that align the mean normals of both parts and rotate in steps about them.

use super::{Start, StartKind, rotation_about};
use crate::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3, frame_about};
use crate::registration::surface::{Measures, Surface};

/// Lays the source's area centroid on the target's and its mean normal on the target's (reversed
/// if `flipped`), turned by `angle` radians about it: the paper's "align surface normal".
///
/// At angle zero the longest directions of both parts across the normal point the same way, so the
/// result does not depend on how the parts lay before. Where a mean normal vanishes (a closed
/// surface) the direction of least extent stands in for it.
pub fn align_surface_normals(
    source: &Surface,
    target: &Surface,
    flipped: bool,
    angle: f64,
) -> Similarity {
    let from = Place::of(source.measures());
    let to = Place::of(target.measures());
    align(&from, &to, flipped, angle)
}

/// A centre with a right-handed frame whose third axis is the mean normal.
struct Place {
    center: Point3,
    normal: Vector3,
    /// The longest direction; need not be perpendicular to the normal.
    longest: Vector3,
}

impl Place {
    fn of(measures: &Measures) -> Self {
        let axes = &measures.principal_axes;
        let normal = measures.mean_normal.try_normalize(1e-6);
        let normal = normal.unwrap_or_else(|| axes.column(2).into());
        // The principal direction that is longest as seen along the normal.
        let across = |k: usize| {
            let axis: Vector3 = axes.column(k).into();
            let spread = measures.principal_spread[k];
            ((axis - normal * axis.dot(&normal)) * spread).norm()
        };
        let k = if across(0) >= across(1) { 0 } else { 1 };
        Self {
            center: measures.centroid,
            normal,
            longest: axes.column(k).into(),
        }
    }

    fn frame(&self, flipped: bool) -> Matrix3 {
        frame_about(
            &if flipped { -self.normal } else { self.normal },
            &self.longest,
        )
    }
}

fn align(from: &Place, to: &Place, flipped: bool, angle: f64) -> Similarity {
    let turn = Rotation::from_axis_angle(&Vector3::z_axis(), angle);
    let turn = *turn.to_rotation_matrix().matrix();
    let matrix = to.frame(false) * turn * from.frame(flipped).transpose();
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(matrix);
    rotation_about(
        Rotation::from_rotation_matrix(&rotation),
        &from.center,
        &to.center,
    )
}

pub(super) fn starts(
    source: &Surface,
    target: &Surface,
    n_rotations: usize,
    signs: &[bool],
) -> Vec<Start> {
    let mut found = Vec::new();
    for &flipped in signs {
        for k in 0..n_rotations {
            let angle_deg = 360.0 * k as f64 / n_rotations as f64;
            found.push(Start {
                kind: StartKind::SurfaceNormal { angle_deg },
                flipped,
                target_from_source: align_surface_normals(
                    source,
                    target,
                    flipped,
                    angle_deg.to_radians(),
                ),
            });
        }
    }
    found
}
