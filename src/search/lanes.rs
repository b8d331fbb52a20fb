//! Four vectors at once, coordinate by coordinate.

use glam::{Mat4, Vec3A, Vec4};

/// Four vectors: their x, their y and their z coordinates.
pub(crate) type FourVectors = [Vec4; 3];

/// Each turned by a matrix, given row by row.
#[inline(always)]
pub(crate) fn rotated(rows: &[[f32; 3]; 3], v: &FourVectors) -> FourVectors {
    let along = |row: &[f32; 3]| v[0] * row[0] + v[1] * row[1] + v[2] * row[2];
    [along(&rows[0]), along(&rows[1]), along(&rows[2])]
}

/// Each less its counterpart.
#[inline(always)]
pub(crate) fn difference(a: &FourVectors, b: &FourVectors) -> FourVectors {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Scalar products.
#[inline(always)]
pub(crate) fn dot(a: &FourVectors, b: &FourVectors) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector products.
#[inline(always)]
pub(crate) fn cross(a: &FourVectors, b: &FourVectors) -> FourVectors {
    let along = |j: usize, k: usize| a[j] * b[k] - a[k] * b[j];
    [along(1, 2), along(2, 0), along(0, 1)]
}

/// Four vectors put together.
#[inline(always)]
pub(crate) fn by_coordinate([a, b, c, d]: [Vec3A; 4]) -> FourVectors {
    let columns = Mat4::from_cols(a.extend(0.0), b.extend(0.0), c.extend(0.0), d.extend(0.0));
    let turned = columns.transpose();
    [turned.x_axis, turned.y_axis, turned.z_axis]
}
