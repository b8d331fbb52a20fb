//! Synthetic results of a forming simulation: smooth fields of the right kind and size, made from
//! how steep and how bent the sheet is.

use rayon::prelude::*;

use super::mesher::FlatMesh;
use super::path::Flat;
use super::sheet::Sheet;
use crate::geometry::tensor::{Tensor, components, rotated, smallest_rotation};
use crate::geometry::{Matrix3, Similarity, Vector3};

/// An element is cut into cells of at most this size for its means, millimetres; the field bends
/// over four.
const CELL: f64 = 2.5;
/// Cells along an edge, at least and at most.
const N_CELLS: [f64; 2] = [2.0, 8.0];

/// State of one surface layer of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormingLayer {
    /// Residual stress, MPa whatever the unit of length.
    pub stress: Tensor,
    /// Effective plastic strain.
    pub plastic_strain: f64,
    /// Logarithmic strain.
    pub strain: Tensor,
}

/// Forming results of one element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellForming {
    /// Thickness at the corners, in the stamped side's unit; a triangle repeats its last one.
    pub thickness: [f64; 4],
    /// Inner layer (against the normal), then outer layer.
    pub layers: [FormingLayer; 2],
}

impl ShellForming {
    pub(super) fn transformed(mut self, target_from_source: &Similarity) -> Self {
        for thickness in &mut self.thickness {
            *thickness *= target_from_source.scale;
        }
        for layer in &mut self.layers {
            layer.stress = rotated(&layer.stress, &target_from_source.rotation);
            layer.strain = rotated(&layer.strain, &target_from_source.rotation);
        }
        self
    }
}

/// The sheet at a place: its normal and how bent it is.
struct Local {
    normal: Vector3,
    bend: f64,
}

impl Local {
    fn of(sheet: &Sheet, p: &Flat) -> Self {
        let normal = sheet.normal(p);
        Self {
            bend: bend(sheet, p, &normal),
            normal,
        }
    }
}

/// Thinning, 0.01 … 0.22: more on walls and in radii, with a slow drift over the part.
fn thinning(local: &Local, p: &Flat) -> f64 {
    let wall = 1.0 - local.normal.z.abs();
    let bent = local.bend.min(0.08) / 0.08;
    let drift = (p.x / 170.0 + 0.4).sin() * (p.y / 130.0).cos();
    0.03 + 0.11 * wall + 0.05 * bent + 0.02 * drift
}

/// Curvature of the sheet, per millimetre, from the turn of the normal over four millimetres.
fn bend(sheet: &Sheet, p: &Flat, here: &Vector3) -> f64 {
    let along = here.angle(&sheet.normal(&Flat::new(p.x + 4.0, p.y)));
    let across = here.angle(&sheet.normal(&Flat::new(p.x, p.y + 4.0)));
    along.max(across) / 4.0
}

/// Results for every element, in die axes and millimetres.
pub(super) fn form(sheet: &Sheet, mesh: &FlatMesh, thickness: f64) -> Vec<ShellForming> {
    let thinning: Vec<f64> = mesh
        .nodes
        .iter()
        .map(|p| thinning(&Local::of(sheet, p), p))
        .collect();
    let shell = |corners: &[u32; 4]| {
        let count = if corners[2] == corners[3] { 3 } else { 4 };
        let corner = |i: usize| corners[i] as usize;
        let middle = (0..count).map(|i| mesh.nodes[corner(i)].coords);
        let middle = Flat::from(middle.sum::<nalgebra::Vector2<f64>>() / count as f64);
        let mean = (0..count).map(|i| thinning[corner(i)]).sum::<f64>() / count as f64;
        ShellForming {
            thickness: corners.map(|c| thickness * (1.0 - thinning[c as usize])),
            layers: layers(
                sheet,
                (&middle, &Local::of(sheet, &middle)),
                mean,
                thickness,
            ),
        }
    };
    mesh.elements.iter().map(shell).collect()
}

/// Mean of every element over its area on the exact sheet: thickness the same at all corners, tensors
/// turned from the sheet's tangent plane into the element's. In die axes and millimetres.
pub(super) fn element_means(sheet: &Sheet, mesh: &FlatMesh, thickness: f64) -> Vec<ShellForming> {
    let mean = |corners: &[u32; 4]| {
        element_mean(sheet, &corners.map(|c| mesh.nodes[c as usize]), thickness)
    };
    mesh.elements.par_iter().map(mean).collect()
}

fn element_mean(sheet: &Sheet, corners: &[Flat; 4], thickness: f64) -> ShellForming {
    let lifted = corners.map(|corner| sheet.point(&corner));
    let normal = (lifted[2] - lifted[0])
        .cross(&(lifted[3] - lifted[1]))
        .normalize();
    let longest = (0..4).map(|i| (corners[(i + 1) % 4] - corners[i]).norm());
    let n_cells = (longest.fold(0.0, f64::max) / CELL).ceil();
    let n_cells = n_cells.clamp(N_CELLS[0], N_CELLS[1]) as usize;
    let (mut area_sum, mut thickness_sum) = (0.0, 0.0);
    let mut sums = [[0.0; 13]; 2];
    // Two Gauss points along each edge of a cell.
    let place = |k: usize| {
        let side = if k.is_multiple_of(2) { -1.0 } else { 1.0 };
        ((k / 2) as f64 + 0.5 + side * 0.5 / 3.0_f64.sqrt()) / n_cells as f64
    };
    for (i, j) in (0..2 * n_cells).flat_map(|i| (0..2 * n_cells).map(move |j| (i, j))) {
        let (a, b) = (place(i), place(j));
        let [p, q, r, s] = corners.map(|corner| corner.coords);
        let at = Flat::from((p * (1.0 - a) + q * a) * (1.0 - b) + (s * (1.0 - a) + r * a) * b);
        let along = (q - p) * (1.0 - b) + (r - s) * b;
        let across = (s - p) * (1.0 - a) + (r - q) * a;
        let area = along.perp(&across).abs() * sheet.stretch(&at);
        let local = Local::of(sheet, &at);
        let thin = thinning(&local, &at);
        let turn = smallest_rotation(&local.normal, &normal).unwrap_or_else(Matrix3::identity);
        area_sum += area;
        thickness_sum += area * thickness * (1.0 - thin);
        for (sum, layer) in sums
            .iter_mut()
            .zip(layers(sheet, (&at, &local), thin, thickness))
        {
            let (stress, strain) = (rotated(&layer.stress, &turn), rotated(&layer.strain, &turn));
            let values = stress.iter().chain(&strain).chain([&layer.plastic_strain]);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += area * value;
            }
        }
    }
    ShellForming {
        thickness: [thickness_sum / area_sum; 4],
        layers: sums.map(|sum| FormingLayer {
            stress: std::array::from_fn(|i| sum[i] / area_sum),
            strain: std::array::from_fn(|i| sum[6 + i] / area_sum),
            plastic_strain: sum[12] / area_sum,
        }),
    }
}

/// Strains that keep the volume, and the stresses that would drive them (Swift's hardening, plane
/// stress, von Mises) relaxed as after springback: pressure inside, tension outside.
fn layers(
    sheet: &Sheet,
    (p, local): (&Flat, &Local),
    thinning: f64,
    thickness: f64,
) -> [FormingLayer; 2] {
    let normal = local.normal;
    let ahead = sheet.point(&Flat::new(p.x + 0.1, p.y)) - sheet.point(p);
    let first = (ahead - normal * ahead.dot(&normal)).normalize();
    let second = normal.cross(&first);
    let bending = 0.5 * thickness * local.bend;
    [-1.0, 1.0].map(|side| {
        let through = (1.0 - thinning).ln();
        let minor = -0.35 * through;
        let major = -through - minor + side * bending;
        let third = -(major + minor);
        let plastic = (4.0 / 3.0 * (major * major + major * minor + minor * minor)).sqrt();
        let yield_stress = 550.0 * (0.012 + plastic).powf(0.21);
        let ratio: f64 = 0.65;
        let stress = yield_stress / (1.0 - ratio + ratio * ratio).sqrt();
        let relaxed = stress * (0.08 + side * 0.3);
        FormingLayer {
            stress: tensor(&[first, second, normal], [relaxed, ratio * relaxed, 0.0]),
            plastic_strain: plastic,
            strain: tensor(&[first, second, normal], [major, minor, third]),
        }
    })
}

fn tensor(axes: &[Vector3; 3], values: [f64; 3]) -> Tensor {
    let mut sum = Matrix3::zeros();
    for (axis, value) in axes.iter().zip(values) {
        sum += axis * axis.transpose() * value;
    }
    components(&sum)
}

#[cfg(test)]
mod tests {
    use super::super::SamplePart;
    use super::super::{SampleSettings, SampleVariant, generate};

    fn settings(variant: SampleVariant) -> SampleSettings {
        SampleSettings {
            part: SamplePart::Bracket,
            variant,
            ..SampleSettings::default()
        }
    }

    #[test]
    fn fields_are_of_the_right_size_and_keep_the_volume() {
        let stamped = generate(&settings(SampleVariant::Plain)).stamped;
        assert_eq!(stamped.forming.len(), stamped.elements.len());
        for shell in &stamped.forming {
            for t in shell.thickness {
                assert!(t > 0.75 * stamped.thickness && t < stamped.thickness);
            }
            for layer in shell.layers {
                let trace: f64 = layer.strain[..3].iter().sum();
                assert!(trace.abs() < 1e-12);
                assert!(layer.plastic_strain > 0.0 && layer.plastic_strain < 0.6);
                let [xx, yy, zz, xy, yz, zx] = layer.stress;
                let mises_sq = 0.5 * ((xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2))
                    + 3.0 * (xy * xy + yz * yz + zx * zx);
                let limit = 550.0 * (0.012 + layer.plastic_strain).powf(0.21);
                assert!(mises_sq.sqrt() < limit);
            }
        }
    }

    #[test]
    fn the_opposite_hand_mirrors_its_tensors() {
        let plain = generate(&settings(SampleVariant::Plain)).stamped;
        let other = generate(&settings(SampleVariant::OppositeHand)).stamped;
        for (a, b) in plain.forming.iter().zip(&other.forming) {
            let [xx, yy, zz, xy, yz, zx] = a.layers[1].strain;
            assert_eq!(b.layers[1].strain, [xx, yy, zz, -xy, yz, -zx]);
        }
    }
}
