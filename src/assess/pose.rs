//! The statement about the pose: how far it may be off, and whether another one fits as well.

use serde::{Deserialize, Serialize};

use super::PoseUncertainty;
use crate::geometry::serial::any_float;

/// The statement about the pose in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PoseKind {
    /// No other pose fits nearly as well, and the uncertainty is below the tolerance.
    Certain,
    /// The pose may be off by more than the tolerance.
    Uncertain,
    /// Another pose fits as well, or nearly.
    Ambiguous,
    /// The parts do not lie on each other.
    NotFound,
}

/// What can be said about the pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PoseStatement {
    /// In one word.
    pub kind: PoseKind,
    /// How far the pose may be off; `None` where the parts do not meet.
    pub uncertainty: Option<PoseUncertainty>,
    /// Uncertainty up to which the pose is certain, in target length units.
    #[serde(with = "any_float")]
    pub tolerance: f64,
}

impl PoseStatement {
    /// Whether the uncertainty is below the tolerance.
    pub(super) fn is_firm(&self) -> bool {
        let stated = self.uncertainty.as_ref();
        stated.is_some_and(|stated| stated.largest <= self.tolerance)
    }
}
