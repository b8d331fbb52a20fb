//! How far the membrane forces of the mapped and of the stamped stresses hold each other.

use super::MapRun;
use crate::geometry::tensor::Tensor;
use crate::mapping::{ForceBalance, LayerRule};
use crate::monitor::{Cancelled, Monitor};

/// What is left of the forces at the nodes, over the forces, on the crash part and on the stamped parts; `None`
/// without stresses or thickness. O(elements).
pub(super) fn force_balance(
    run: &MapRun,
    monitor: &Monitor,
) -> Result<Option<[f64; 2]>, Cancelled> {
    let Some(states) = run.mapped.states.as_ref() else {
        return Ok(None);
    };
    if !run.recipe.options.quantities.stress {
        return Ok(None);
    }
    let target = &run.target;
    let of_crash = |element: usize| {
        let mapped = run.thickness(element);
        let thickness = if mapped.is_nan() {
            target.nominal_thickness[element]
        } else {
            mapped
        };
        let rule = &target.rules[target.rule_of[element] as usize];
        membrane(rule, states.of(element), thickness)
    };
    let crash = ForceBalance::of(&target.mesh, of_crash, monitor)?;
    let mut stamped = ForceBalance::default();
    for part in &run.sources {
        let of_stamped = |element: usize| {
            let (rule, layers) = part.states.of(element)?;
            membrane(rule, layers, part.mean_thickness(element))
        };
        stamped = stamped.and(ForceBalance::of(&part.mesh, of_stamped, monitor)?);
    }
    Ok(crash
        .share()
        .zip(stamped.share())
        .map(|(crash, stamped)| [crash, stamped]))
}

/// Thickness times the mean stress over the layers, whose points in the plane follow each other; `None` without.
fn membrane(rule: &LayerRule, states: &[[f64; 7]], thickness: f64) -> Option<Tensor> {
    let n_plane = states.len() / rule.len();
    if n_plane == 0 || !thickness.is_finite() {
        return None;
    }
    let mut force = [0.0; 6];
    for (weight, layer) in rule.weights().iter().zip(states.chunks_exact(n_plane)) {
        for state in layer {
            for (sum, value) in force.iter_mut().zip(state) {
                *sum += thickness * weight * value / (2.0 * n_plane as f64);
            }
        }
    }
    Some(force)
}
