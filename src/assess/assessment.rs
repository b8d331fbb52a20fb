//! The result of an assessment: a verdict with its reasons, and all that was measured.

use serde::{Deserialize, Serialize};

use super::ambiguity::Ambiguity;
use super::coverage::Coverage;
use super::decide::decide_with;
use super::free_motion::{FreeMotion, Freedom};
use super::pose::PoseStatement;
use super::reason::Reason;
use super::shape::ShapeStatement;
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
    /// Faceting and allowance: distances of this size are negligible.
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
        statements(self.pose.as_ref(), self.shape.as_ref(), lengths)
    }

    /// The verdict on what was read, whatever could not be: errors in a file concern all its parts, so that they
    /// are no difference between them.
    pub fn verdict_as_read(&self) -> Verdict {
        let reasons = self.reasons.iter();
        let others = reasons.filter(|reason| !matches!(reason, Reason::ReadErrors { .. }));
        others.map(Reason::severity).max().unwrap_or(Verdict::Good)
    }

    /// The same where other parts of the target's model, with these ids, fit the source about as well.
    #[must_use]
    pub fn beside_alike_parts(mut self, ids: &[u64]) -> Self {
        if !ids.is_empty() {
            let ids = ids.to_vec();
            decide_with(&mut self, Reason::AlikeParts { ids });
        }
        self
    }

    /// How far the pose may be off, where that is known.
    pub fn uncertainty(&self) -> Option<&PoseUncertainty> {
        self.pose.as_ref()?.uncertainty.as_ref()
    }

    /// The motion that leaves the pose open: one that the surfaces do not resist, and neither holes nor borders do.
    pub fn open_motion(&self) -> Option<&FreeMotion> {
        self.reasons.iter().find_map(|reason| match reason {
            Reason::Sliding { motion, .. } => Some(motion),
            _ => None,
        })
    }

    /// The reasons in words, one each, without capital and full stop.
    pub fn sentences(&self, lengths: Lengths) -> Vec<String> {
        let words = self.reasons.iter().map(|reason| reason.words(lengths));
        words.collect()
    }
}

/// The statements about an alternative pose, beside its distances.
#[derive(Debug, Clone, PartialEq)]
pub struct AlternativeStatements {
    /// How far its pose may be off; another one fits nearly as well by its nature.
    pub pose: PoseStatement,
    /// Whether both parts have one shape under it.
    pub shape: ShapeStatement,
}

impl AlternativeStatements {
    /// One sentence each, as of the best pose.
    pub fn sentences(&self, lengths: Lengths) -> Vec<String> {
        statements(Some(&self.pose), Some(&self.shape), lengths)
    }
}

fn statements(
    pose: Option<&PoseStatement>,
    shape: Option<&ShapeStatement>,
    lengths: Lengths,
) -> Vec<String> {
    let pose = pose.map(|pose| format!("pose {}", pose.words(lengths)));
    let shape = shape.map(|shape| format!("shape: {}", shape.words(lengths)));
    pose.into_iter().chain(shape).collect()
}
