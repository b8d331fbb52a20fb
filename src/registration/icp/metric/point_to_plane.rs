//! The residual along the normal of the model.

use super::{MAX_ROTATION_DEG, StepRules};
use crate::geometry::{Rotation, Similarity, Vector3};
use crate::registration::icp::correspondence::Correspondence;
use crate::registration::icp::solve::{Row, StepEquations, center_and_radius};

/// Gauss–Newton step of Σ w ((p − q)·n)² about the centroid of the moved points (Chen and Medioni
/// 1992), with the exact exponential of the rotation vector.
pub(super) fn step(
    pairs: &[Correspondence],
    kept: &[u32],
    rules: &StepRules,
    damping: f64,
) -> Option<Similarity> {
    let kept = kept.iter().map(|&i| &pairs[i as usize]);
    let (center, radius) = center_and_radius(kept.clone().map(|c| (&c.moved, c.weight)))?;
    let mut equations = StepEquations::new(radius);
    for pair in kept {
        let arm = pair.moved - center;
        let normal = pair.matched_normal;
        let residual = (pair.matched - pair.moved).dot(&normal);
        let row = Row {
            rotation: arm.cross(&normal),
            translation: normal,
            scale: arm.dot(&normal),
        };
        equations.add(&row, residual, pair.weight);
    }
    let solution = equations.solve(&rules.solve(damping))?;
    let (turn, shift) = limited(solution.rotation, solution.translation, rules);
    let rotation = *Rotation::new(turn).to_rotation_matrix().matrix();
    let scale = solution.scale.clamp(-0.2, 0.2).exp();
    Some(Similarity {
        rotation,
        translation: center.coords + shift - rotation * center.coords * scale,
        scale,
    })
}

/// Shortens a step that is too long for its linear model.
fn limited(turn: Vector3, shift: Vector3, rules: &StepRules) -> (Vector3, Vector3) {
    let by_turn = MAX_ROTATION_DEG.to_radians() / turn.norm();
    let by_shift = rules.max_translation / shift.norm();
    let factor = by_turn.min(by_shift).min(1.0);
    (turn * factor, shift * factor)
}
