//! The residual along the sum of both normals.

use super::{MAX_ROTATION_DEG, StepRules};
use crate::geometry::{Point3, Rotation, Similarity, Vector3};
use crate::registration::icp::correspondence::Correspondence;
use crate::registration::icp::solve::{Row, StepEquations, center_and_radius};

/// Step of Σ w ((p − q)·(nₚ + n_q))² where both sides turn by half of the rotation (Rusinkiewicz
/// 2019, equation 10).
pub(super) fn step(
    pairs: &[Correspondence],
    kept: &[u32],
    rules: &StepRules,
    damping: f64,
) -> Option<Similarity> {
    let kept = kept.iter().map(|&i| &pairs[i as usize]);
    let (moved_center, radius) = center_and_radius(kept.clone().map(|c| (&c.moved, c.weight)))?;
    let total: f64 = kept.clone().map(|c| c.weight).sum();
    let offset = kept
        .clone()
        .map(|c| (c.matched - moved_center) * c.weight)
        .sum::<Vector3>()
        / total;
    let matched_center: Point3 = moved_center + offset;
    let mut equations = StepEquations::new(radius);
    for pair in kept {
        let p = pair.moved - moved_center;
        let q = pair.matched - matched_center;
        let normal = pair.moved_normal + pair.matched_normal;
        let residual = (q - p).dot(&normal);
        let row = Row {
            rotation: (p + q).cross(&normal),
            translation: normal,
            scale: p.dot(&normal),
        };
        equations.add(&row, residual, pair.weight);
    }
    let solution = equations.solve(&rules.solve(damping))?;
    let tangent = solution.rotation.norm();
    let half_angle = tangent.atan();
    let half_limit = MAX_ROTATION_DEG.to_radians() / 2.0;
    let shift = solution.translation * half_angle.cos();
    // The step lays the centroids on each other too; a shortened step shortens that share.
    let factor = (half_limit / half_angle)
        .min(rules.max_translation / (offset + shift).norm())
        .min(1.0);
    let half = Rotation::new(solution.rotation * (half_angle * factor / tangent.max(1e-300)));
    let half = *half.to_rotation_matrix().matrix();
    let scale = solution.scale.clamp(-0.2, 0.2).exp();
    let rotation = half * half;
    let translation = moved_center.coords + (offset + half * shift) * factor
        - rotation * moved_center.coords * scale;
    Some(Similarity {
        rotation,
        translation,
        scale,
    })
}
