//! Is the pose right? Measured anew on the full meshes, without anything the search believed.

mod ambiguity;
mod coverage;
pub mod deviation;
mod sliding;
mod verdict;

pub use ambiguity::{Ambiguity, Clarity, Twin, TwinAxis};
pub use coverage::{Coverage, OneSided, coverage, overlap_limit, quick_overlap};
use serde::{Deserialize, Serialize};
pub use sliding::{FreeMotion, FreeMotionKind, Freedom, free_motions};
pub use verdict::Verdict;

use crate::monitor::{Cancelled, Monitor};
use crate::registration::{MatchOutcome, MirrorCheck, ScaleCheck, Surface};

/// What an assessment depends on besides the match.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessSettings {
    /// Distance up to which a place counts as covered, in target length units. By default
    /// [`overlap_limit`] of the meshes.
    pub limit: Option<f64>,
    /// Deviation of the real shapes that is to be expected besides faceting, such as springback.
    pub allowance: f64,
}

/// Everything that speaks for or against a pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assessment {
    /// GOOD, CHECK or POOR.
    pub verdict: Verdict,
    /// Why, one sentence each, the gravest first. For GOOD what was found to be in order.
    pub reasons: Vec<String>,
    /// Distances and overlap in both directions.
    pub coverage: Coverage,
    /// How clearly the pose beats the second-best.
    pub ambiguity: Ambiguity,
    /// Motions that slide the surface on itself.
    pub freedom: Freedom,
    /// Sizes and units.
    pub scale_check: ScaleCheck,
    /// The opposite hand.
    pub mirror_check: MirrorCheck,
    /// Faceting and allowance: distances of this size mean nothing.
    pub noise: f64,
}

/// Assesses the pose of `outcome` on the full meshes. O(vertices · log triangles).
pub fn assess(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Assessment, Cancelled> {
    let pose = &outcome.target_from_source;
    let limit = settings
        .limit
        .unwrap_or_else(|| overlap_limit(source, target, settings.allowance));
    monitor.progress("verify", 0, Some(2));
    let coverage = coverage(source, target, pose, limit, monitor)?;
    monitor.progress("verify", 1, Some(2));
    let freedom = free_motions(source, target, pose, limit);
    let mut ambiguity = Ambiguity::of(&outcome.alternatives);
    if ambiguity.clarity != Clarity::Clear {
        let other = outcome.alternatives.first();
        ambiguity.twin = other.map(|a| Twin::of(source, pose, &a.target_from_source));
    }
    let chordal = |surface: &Surface| surface.measures().chordal_error;
    let noise = chordal(source).max(chordal(target)) + settings.allowance;
    let mut assessment = Assessment {
        verdict: Verdict::Good,
        reasons: Vec::new(),
        coverage,
        ambiguity,
        freedom,
        scale_check: outcome.scale_check,
        mirror_check: outcome.mirror_check,
        noise,
    };
    (assessment.verdict, assessment.reasons) =
        verdict::decide(&assessment, outcome, source, target);
    monitor.progress("verify", 2, Some(2));
    Ok(assessment)
}
