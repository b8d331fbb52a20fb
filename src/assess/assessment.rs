//! Everything that is said about a pose.

use serde::{Deserialize, Serialize};

use super::ambiguity::Ambiguity;
use super::coverage::Coverage;
use super::pose::PoseStatement;
use super::reason::Reason;
use super::shape::ShapeStatement;
use super::sliding::{FreeMotion, Freedom};
use super::uncertainty::PoseUncertainty;
use super::verdict::Verdict;
use crate::registration::{MirrorCheck, ScaleCheck};
use crate::text::Lengths;

/// Everything that speaks for or against a pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assessment {
    /// Whether the pose can be used.
    pub verdict: Verdict,
    /// Why, the most severe first. For GOOD what was found to be in order.
    pub reasons: Vec<Reason>,
    /// Distances and overlap in both directions.
    pub coverage: Coverage,
    /// How clearly the pose beats the second-best.
    pub ambiguity: Ambiguity,
    /// Motions that slide the surface on itself, whatever else holds it.
    pub freedom: Freedom,
    /// Sizes and units.
    pub scale_check: ScaleCheck,
    /// The opposite hand.
    pub mirror_check: MirrorCheck,
    /// Faceting and allowance: distances of this size mean nothing.
    pub noise: f64,
    /// How far the pose may be off; `None` in results of earlier versions.
    #[serde(default)]
    pub pose: Option<PoseStatement>,
    /// Whether both parts have one shape; `None` where their units differ, and in results of earlier versions.
    #[serde(default)]
    pub shape: Option<ShapeStatement>,
}

impl Assessment {
    /// The statements about pose and shape, one sentence each.
    pub fn statements(&self, lengths: Lengths) -> Vec<String> {
        let pose = self.pose.as_ref().map(|pose| pose.words(lengths));
        let shape = self.shape.as_ref().map(|shape| shape.words(lengths));
        let pose = pose.map(|words| format!("pose {words}"));
        let shape = shape.map(|words| format!("shape: {words}"));
        pose.into_iter().chain(shape).collect()
    }

    /// How far the pose may be off, where that is known.
    pub fn uncertainty(&self) -> Option<&PoseUncertainty> {
        self.pose.as_ref()?.uncertainty.as_ref()
    }

    /// The motion that leaves the pose open: one that the surfaces do not resist, and neither holes nor borders do.
    pub fn open_motion(&self) -> Option<&FreeMotion> {
        self.reasons.iter().find_map(|reason| match reason {
            Reason::Sliding { motion } => Some(motion),
            _ => None,
        })
    }

    /// The reasons in words, one each, without capital and full stop.
    pub fn sentences(&self, lengths: Lengths) -> Vec<String> {
        let words = self.reasons.iter().map(|reason| reason.words(lengths));
        words.collect()
    }
}
