//! What is minimised over the kept pairs, and the step that does it.

mod point_to_plane;
mod symmetric;

use serde::{Deserialize, Serialize};

use super::correspondence::Correspondence;
use super::solve::SolveRules;
use crate::geometry::Similarity;
use crate::registration::closed_form::{Motion, fit_pairs};

/// The residual of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Metric {
    /// |p − q|², solved in closed form (Besl and McKay 1992, Umeyama 1991).
    PointToPoint,
    /// ((p − q)·n)² with the model's normal (Chen and Medioni 1992).
    PointToPlane,
    /// ((p − q)·(nₚ + n_q))² with both normals (Rusinkiewicz 2019).
    #[default]
    Symmetric,
}

/// Limits of one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepRules {
    pub(crate) metric: Metric,
    pub(crate) motion: Motion,
    /// Longest translation of one step.
    pub(crate) max_translation: f64,
    /// How far a step is likely to move the data; infinite where steps are to be taken whole.
    pub(crate) likely_motion: f64,
}

impl StepRules {
    fn solve(&self, damping: f64) -> SolveRules {
        SolveRules {
            damping,
            likely_motion: self.likely_motion,
            with_scale: self.motion == Motion::Similarity,
        }
    }
}

/// Largest rotation of one step.
const MAX_ROTATION_DEG: f64 = 30.0;

/// The motion to put before the current pose, `None` where the pairs fix nothing. After a step that made things worse,
/// `damping` shortens the next one by 1 / (1 + damping), but for that of the closed form.
pub(crate) fn step(
    pairs: &[Correspondence],
    kept: &[u32],
    rules: &StepRules,
    damping: f64,
) -> Option<Similarity> {
    match rules.metric {
        Metric::PointToPoint => {
            let pairs = kept.iter().map(|&i| {
                let pair = &pairs[i as usize];
                (&pair.moved, &pair.matched, pair.weight)
            });
            let fit = fit_pairs(pairs, rules.motion).ok()?;
            Some(fit.target_from_source)
        }
        Metric::PointToPlane => point_to_plane::step(pairs, kept, rules, damping),
        Metric::Symmetric => symmetric::step(pairs, kept, rules, damping),
    }
}
