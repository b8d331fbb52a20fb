//! Synthetic results of a forming simulation: smooth fields of the right kind and size, made from
//! how steep and how bent the sheet is.

use super::mesher::FlatMesh;
use super::path::Flat;
use super::sheet::Sheet;
use crate::geometry::tensor::{Tensor, components, rotated};
use crate::geometry::{Matrix3, Similarity, Vector3};

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

/// Thinning, 0.01 … 0.22: more on walls and in radii, with a slow drift over the part.
fn thinning(sheet: &Sheet, p: &Flat) -> f64 {
    let wall = 1.0 - sheet.normal(p).z.abs();
    let bent = bend(sheet, p).min(0.08) / 0.08;
    let drift = (p.x / 170.0 + 0.4).sin() * (p.y / 130.0).cos();
    0.03 + 0.11 * wall + 0.05 * bent + 0.02 * drift
}

/// Curvature of the sheet, per millimetre, from the turn of the normal over four millimetres.
fn bend(sheet: &Sheet, p: &Flat) -> f64 {
    let here = sheet.normal(p);
    let along = here.angle(&sheet.normal(&Flat::new(p.x + 4.0, p.y)));
    let across = here.angle(&sheet.normal(&Flat::new(p.x, p.y + 4.0)));
    along.max(across) / 4.0
}

/// Results for every element, in die axes and millimetres.
pub(super) fn form(sheet: &Sheet, mesh: &FlatMesh, thickness: f64) -> Vec<ShellForming> {
    let thinning: Vec<f64> = mesh.nodes.iter().map(|p| thinning(sheet, p)).collect();
    let shell = |corners: &[u32; 4]| {
        let count = if corners[2] == corners[3] { 3 } else { 4 };
        let corner = |i: usize| corners[i] as usize;
        let middle = (0..count).map(|i| mesh.nodes[corner(i)].coords);
        let middle = Flat::from(middle.sum::<nalgebra::Vector2<f64>>() / count as f64);
        let mean = (0..count).map(|i| thinning[corner(i)]).sum::<f64>() / count as f64;
        ShellForming {
            thickness: corners.map(|c| thickness * (1.0 - thinning[c as usize])),
            layers: layers(sheet, &middle, mean, thickness),
        }
    };
    mesh.elements.iter().map(shell).collect()
}

/// Strains that keep the volume, and the stresses that would drive them (Swift's hardening, plane
/// stress, von Mises) relaxed as after springback: pressure inside, tension outside.
fn layers(sheet: &Sheet, p: &Flat, thinning: f64, thickness: f64) -> [FormingLayer; 2] {
    let normal = sheet.normal(p);
    let ahead = sheet.point(&Flat::new(p.x + 0.1, p.y)) - sheet.point(p);
    let first = (ahead - normal * ahead.dot(&normal)).normalize();
    let second = normal.cross(&first);
    let bending = 0.5 * thickness * bend(sheet, p);
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
