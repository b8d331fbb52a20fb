//! First poses that align the smaller part with patches of the larger.

use nalgebra::SymmetricEigen;

use super::surface_normals::{Place, align};
use super::{Start, StartKind};
use crate::geometry::{Matrix3, Point3, Vector3};
use crate::registration::subsample::subsample;
use crate::registration::surface::Surface;

/// Patches of the larger part that are tried.
const N_PATCHES: usize = 8;

/// Lays the smaller part on patches of its own size spread over the larger one. For a part that
/// covers little of the other, whose centroids and mean normals have nothing to do with each other.
pub(super) fn starts(source: &Surface, target: &Surface, n_rotations: usize) -> Vec<Start> {
    let source_is_smaller = source.measures().area <= target.measures().area;
    let (small, large) = if source_is_smaller {
        (source, target)
    } else {
        (target, source)
    };
    let radius = 1.5 * small.measures().principal_spread.norm();
    let whole = place_around(small, &small.measures().centroid, f64::INFINITY);
    let places = spread_points(large, N_PATCHES)
        .into_iter()
        .map(|center| place_around(large, &center, radius));
    let mut found = Vec::new();
    for (patch, place) in places.enumerate() {
        for flipped in [false, true] {
            for k in 0..n_rotations {
                let angle_deg = 360.0 * k as f64 / n_rotations as f64;
                let large_from_small = align(&whole, &place, flipped, angle_deg.to_radians());
                let target_from_source = if source_is_smaller {
                    large_from_small
                } else {
                    large_from_small.inverse()
                };
                found.push(Start {
                    kind: StartKind::Patch { patch, angle_deg },
                    flipped,
                    target_from_source,
                });
            }
        }
    }
    found
}

/// Points far from each other on the surface, the one nearest to the centroid first.
fn spread_points(surface: &Surface, n: usize) -> Vec<Point3> {
    let points: Vec<Point3> = subsample(surface, 400)
        .into_iter()
        .map(|s| s.point)
        .collect();
    let centroid = surface.measures().centroid;
    let mut clearance: Vec<f64> = points.iter().map(|p| -(p - centroid).norm()).collect();
    let mut chosen = Vec::new();
    while chosen.len() < n.min(points.len()) {
        let mut best = 0;
        for (i, value) in clearance.iter().enumerate() {
            if *value > clearance[best] {
                best = i;
            }
        }
        let point = points[best];
        let is_first = chosen.is_empty();
        chosen.push(point);
        for (i, value) in clearance.iter_mut().enumerate() {
            let distance = (points[i] - point).norm();
            *value = if is_first {
                distance
            } else {
                value.min(distance)
            };
        }
    }
    chosen
}

/// Centroid, mean normal and longest direction of what lies within `radius` of `center`.
fn place_around(surface: &Surface, center: &Point3, radius: f64) -> Place {
    let samples = subsample(surface, 1000);
    let near = samples
        .iter()
        .filter(|s| (s.point - center).norm() <= radius);
    let (mut sum, mut normal, mut total) = (Vector3::zeros(), Vector3::zeros(), 0.0);
    for sample in near.clone() {
        sum += (sample.point - center) * sample.weight;
        normal += sample.normal * sample.weight;
        total += sample.weight;
    }
    if total <= 0.0 {
        total = 1.0;
    }
    let centroid = center + sum / total;
    let mut covariance = Matrix3::zeros();
    for sample in near {
        let arm = sample.point - centroid;
        covariance += arm * arm.transpose() * sample.weight;
    }
    let eigen = SymmetricEigen::new(covariance);
    let longest = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
    let least = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    Place {
        center: centroid,
        normal: (normal / total).try_normalize(1e-6).unwrap_or(least),
        longest,
    }
}
