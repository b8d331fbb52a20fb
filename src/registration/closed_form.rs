//! Paired points aligned in closed form (Umeyama 1991, Horn 1987).

use nalgebra::{Matrix4, Quaternion, SymmetricEigen, Vector4};
use serde::{Deserialize, Serialize};

use super::RegistrationError;
use crate::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3};

/// What a closed-form fit may use to lay one point set on the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Motion {
    /// Rotation and translation.
    #[default]
    Rigid,
    /// Rotation, translation and one scale factor.
    Similarity,
}

/// The best motion for given pairs, with what the pairs show of its certainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairFit {
    /// `target_from_source`, proper (determinant +1).
    pub target_from_source: Similarity,
    /// Root mean square distance of the pairs after the motion, in target length units.
    pub rmse: f64,
    /// The scale that fits best, whether or not it was asked for; a unit check.
    pub scale: f64,
    /// The best mirrored fit (determinant −1) of the same pairs, with the same scale rule.
    pub mirrored: Similarity,
    /// Root mean square distance of the mirrored fit. Below `rmse` the pairs speak for the
    /// opposite hand; equal for flat points, which have no hand.
    pub mirrored_rmse: f64,
    /// The scale that fits best mirrored, as `scale`.
    pub mirrored_scale: f64,
}

/// Centred second moments of weighted pairs.
struct Moments {
    source_mean: Vector3,
    target_mean: Vector3,
    source_var: f64,
    target_var: f64,
    /// Σ w (x − μx)(y − μy)ᵀ / W, rows source, columns target.
    cross: Matrix3,
}

/// Lays paired points on each other in closed form: minimises Σ w |y − (c R x + t)|² (Umeyama
/// 1991), by Horn's quaternion matrix (Horn 1987), which gives a rotation for flat point sets too
/// and the best mirrored fit at no cost.
///
/// All pairs count the same; those with a coordinate that is not finite are left out. Fewer than
/// three pairs, coinciding and collinear points are errors, because there the rotation is not
/// unique. O(n), two passes in index order.
pub fn umeyama(
    source: &[Point3],
    target: &[Point3],
    motion: Motion,
) -> Result<PairFit, RegistrationError> {
    if source.len() != target.len() {
        return Err(RegistrationError::UnequalCounts {
            n_source: source.len(),
            n_target: target.len(),
        });
    }
    let pairs = source.iter().zip(target);
    let is_finite = |(x, y): &(&Point3, &Point3)| x.iter().chain(y.iter()).all(|v| v.is_finite());
    let pairs = pairs.filter(is_finite).map(|(x, y)| (x, y, 1.0));
    fit_pairs(pairs, motion)
}

/// [`umeyama`] over an iterator of (source, target, weight) that can be walked twice.
pub(crate) fn fit_pairs<'a>(
    pairs: impl Iterator<Item = (&'a Point3, &'a Point3, f64)> + Clone,
    motion: Motion,
) -> Result<PairFit, RegistrationError> {
    let moments = moments(pairs)?;
    let eigen = SymmetricEigen::new(horn_matrix(&moments.cross));
    let mut order = [0, 1, 2, 3];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let [l0, l1, l2, l3] = order.map(|i| eigen.eigenvalues[i]);
    // The eigenvalues are d1+d2+s·d3, d1−d2−s·d3, −d1+d2−s·d3 and −d1−d2+s·d3.
    let (d1, d2, signed_d3) = ((l0 + l1) / 2.0, (l0 + l2) / 2.0, (l0 + l3) / 2.0);
    // Rounding of the centred products is about 1e-16 of the variances.
    let scale_of_products = (moments.source_var * moments.target_var).sqrt();
    if d1 <= 1e-12 * scale_of_products || scale_of_products == 0.0 {
        return Err(RegistrationError::CoincidentPoints);
    }
    if (d2 + signed_d3) < 1e-9 * d1 {
        return Err(RegistrationError::CollinearPoints);
    }
    let rotation_of = |k: usize| {
        let q: Vector4<f64> = eigen.eigenvectors.column(order[k]).into();
        let quaternion = Rotation::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]));
        *quaternion.to_rotation_matrix().matrix()
    };
    let trace = l0;
    let mirrored_trace = -l3;
    let fit = |rotation: Matrix3, trace: f64| {
        let best_scale = trace / moments.source_var;
        let (scale, mse) = match motion {
            Motion::Rigid => (1.0, moments.source_var + moments.target_var - 2.0 * trace),
            Motion::Similarity => (best_scale, moments.target_var - trace * best_scale),
        };
        let motion = Similarity {
            rotation,
            translation: moments.target_mean - rotation * moments.source_mean * scale,
            scale,
        };
        (motion, mse.max(0.0).sqrt(), best_scale)
    };
    let (target_from_source, rmse, scale) = fit(rotation_of(0), trace);
    let (mirrored, mirrored_rmse, mirrored_scale) = fit(-rotation_of(3), mirrored_trace);
    Ok(PairFit {
        target_from_source,
        rmse,
        scale,
        mirrored,
        mirrored_rmse,
        mirrored_scale,
    })
}

fn moments<'a>(
    pairs: impl Iterator<Item = (&'a Point3, &'a Point3, f64)> + Clone,
) -> Result<Moments, RegistrationError> {
    let mut n_pairs = 0;
    let mut total = 0.0;
    let (mut source_sum, mut target_sum) = (Vector3::zeros(), Vector3::zeros());
    for (x, y, weight) in pairs.clone() {
        n_pairs += 1;
        total += weight;
        source_sum += x.coords * weight;
        target_sum += y.coords * weight;
    }
    if n_pairs < 3 {
        return Err(RegistrationError::TooFewPairs { n_pairs });
    }
    let (source_mean, target_mean) = (source_sum / total, target_sum / total);
    let (mut source_var, mut target_var, mut cross) = (0.0, 0.0, Matrix3::zeros());
    // Products about the means keep their digits far from the origin.
    for (x, y, weight) in pairs {
        let (x, y) = (x.coords - source_mean, y.coords - target_mean);
        source_var += weight * x.norm_squared();
        target_var += weight * y.norm_squared();
        cross += x * y.transpose() * weight;
    }
    Ok(Moments {
        source_mean,
        target_mean,
        source_var: source_var / total,
        target_var: target_var / total,
        cross: cross / total,
    })
}

/// Horn's symmetric matrix whose largest eigenvector is the best rotation as (w, x, y, z).
fn horn_matrix(h: &Matrix3) -> Matrix4<f64> {
    let (yz, zx, xy) = (
        h[(1, 2)] - h[(2, 1)],
        h[(2, 0)] - h[(0, 2)],
        h[(0, 1)] - h[(1, 0)],
    );
    let (sxy, szx, syz) = (
        h[(0, 1)] + h[(1, 0)],
        h[(2, 0)] + h[(0, 2)],
        h[(1, 2)] + h[(2, 1)],
    );
    let (xx, yy, zz) = (h[(0, 0)], h[(1, 1)], h[(2, 2)]);
    #[rustfmt::skip]
    let matrix = Matrix4::new(
        xx + yy + zz, yz,           zx,           xy,
        yz,           xx - yy - zz, sxy,          szx,
        zx,           sxy,          yy - xx - zz, syz,
        xy,           szx,          syz,          zz - xx - yy,
    );
    matrix
}
