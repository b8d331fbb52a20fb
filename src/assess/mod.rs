//! Is the pose right? Measured anew on the full meshes, without anything the search believed.

mod alternatives;
mod ambiguity;
mod contact;
mod coverage;
pub mod deviation;
mod held;
mod pose;
mod reason;
mod rim;
mod rims;
mod settle;
mod shape;
mod skin;
mod slide;
mod sliding;
mod stretch;
mod trims;
mod uncertainty;
mod verdict;
mod words;

pub use alternatives::{chosen_by_shape, is_pulled_aside};
pub use ambiguity::{Ambiguity, Clarity, Twin, TwinAxis};
pub use coverage::{Coverage, OneSided, coverage, overlap_limit, quick_overlap};
pub use held::{HeldPose, hand_by_rims, held_by_rims};
pub use pose::{PoseKind, PoseStatement};
pub use reason::Reason;
pub use settle::settled;
pub use shape::{BorderApart, RimFit, ShapeKind, ShapeReason, ShapeStatement, ShapeTolerance};
pub use skin::without_offset;
pub use sliding::{FreeMotion, FreeMotionKind, Freedom, free_motions};
pub use stretch::PartAxis;
pub use uncertainty::{PartDirection, PoseUncertainty};
pub use verdict::Verdict;
pub use words::error_beside;

use serde::{Deserialize, Serialize};

use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{MatchOutcome, MirrorCheck, ScaleCheck, Surface};
use crate::text::Lengths;
use contact::Contacts;
use rims::Rims;
use shape::ShapeEvidence;

/// What an assessment depends on besides the match.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AssessSettings {
    /// Distance up to which a place counts as covered, in target length units. By default
    /// [`overlap_limit`] of the meshes.
    pub limit: Option<f64>,
    /// Deviation of the real shapes that is to be expected besides faceting, such as springback.
    pub allowance: f64,
    /// Thickness of the sheet in target length units, if known.
    pub thickness: Option<f64>,
    /// How far shapes may differ besides springback; by default the larger of a millimetre and the
    /// thickness.
    pub shape_tolerance: Option<f64>,
    /// The pose is that of the mid-surfaces: a separable offset was taken out of it.
    pub remove_offset: bool,
    /// A millimetre in target length units; 1 if not known.
    pub millimetre: Option<f64>,
}

impl AssessSettings {
    fn length_of_millimetre(&self) -> f64 {
        self.millimetre.unwrap_or(1.0)
    }
}

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
    /// Motions that slide the surface on itself.
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

/// Distance within which the parts are compared, as a share of the target's diagonal and in tolerances of
/// springback, and rims, in tolerances.
const REACH: f64 = 0.03;
const SPRINGBACK_REACH: f64 = 3.0;
const RIM_REACH: f64 = 8.0;

/// Surfaces that lie farther apart than before by so many times what they lay apart and what facets leave open
/// lie elsewhere.
const OFF: f64 = 3.0;
/// The facets of a flat part are known no better than this share of what may remain.
const NOTHING: f64 = 0.01;

/// Sources up to so many times the area of the target count as the smaller part.
const AS_LARGE: f64 = 1.02;

/// What a pair is compared by under poses of one scale, in target length units.
#[derive(Debug, Clone, Copy)]
struct Distances {
    tolerance: ShapeTolerance,
    /// Surfaces within it are compared,
    reach: f64,
    /// and rims within this.
    near: f64,
    /// Faceting of both meshes and the allowance: distances of this size mean nothing.
    noise: f64,
}

impl Distances {
    fn of(source: &Surface, target: &Surface, scale: f64, settings: &AssessSettings) -> Self {
        let tolerance = tolerance_of(target, settings);
        let diagonal = target.measures().diagonal;
        let reach = (REACH * diagonal).max(SPRINGBACK_REACH * tolerance.springback);
        let chordal = |surface: &Surface| surface.measures().chordal_error;
        let facets = (scale * chordal(source)).max(chordal(target));
        Self {
            tolerance,
            reach,
            near: (RIM_REACH * tolerance.remainder).min(reach),
            noise: facets.max(NOTHING * tolerance.remainder) + settings.allowance,
        }
    }
}

impl Distances {
    /// How much farther apart than `gap` surfaces may lie and still lie as close: a share of what may remain,
    /// but little where they lie as close as their facets allow, since what lies off is elsewhere then.
    fn little_more(&self, share: f64, gap: f64) -> f64 {
        let remainder = self.tolerance.remainder;
        (share * remainder).min(OFF * (gap + self.noise))
    }
}

/// Whether the source is the smaller part, by area, under a pose of this scale: the smaller part's nodes and
/// rims are the ones that are followed.
fn is_source_smaller(source: &Surface, target: &Surface, scale: f64) -> bool {
    source.measures().area * scale * scale <= AS_LARGE * target.measures().area
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
        .unwrap_or_else(|| overlap_limit(source, target, pose.scale, settings.allowance));
    monitor.progress("verify", 0, Some(2));
    let coverage = coverage(source, target, pose, limit, monitor)?;
    monitor.progress("verify", 1, Some(2));
    let freedom = free_motions(source, target, pose, limit);
    let mut ambiguity = Ambiguity::of(&outcome.alternatives);
    if ambiguity.clarity != Clarity::Clear {
        let other = outcome.alternatives.first();
        ambiguity.twin = other.map(|a| Twin::of(source, pose, &a.target_from_source));
    }
    let Distances {
        noise, tolerance, ..
    } = Distances::of(source, target, pose.scale, settings);
    let Statements { uncertainty, shape } = statements(source, target, pose, settings);
    let mut assessment = Assessment {
        verdict: Verdict::Good,
        reasons: Vec::new(),
        coverage,
        ambiguity,
        freedom,
        scale_check: outcome.scale_check,
        mirror_check: outcome.mirror_check,
        noise,
        pose: Some(PoseStatement {
            kind: PoseKind::Certain,
            uncertainty,
            tolerance: tolerance.of_pose(shape.springback, settings.length_of_millimetre()),
        }),
        shape: None,
    };
    let most_scaled = tolerance.springback / (0.5 * target.measures().diagonal);
    let mirrored = mirrored_statement(source, target, outcome, settings);
    verdict::decide(
        &mut assessment,
        &shape,
        mirrored.as_ref(),
        outcome,
        most_scaled,
    );
    let is_comparable = assessment.scale_check.unit.is_none();
    assessment.shape = is_comparable.then_some(shape);
    monitor.check()?;
    monitor.progress("verify", 2, Some(2));
    Ok(assessment)
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

    /// The reasons in words, one each, without capital and full stop.
    pub fn sentences(&self, lengths: Lengths) -> Vec<String> {
        let words = self.reasons.iter().map(|reason| reason.words(lengths));
        words.collect()
    }
}

/// How far the pose may be off, and whether the shapes are one.
struct Statements {
    uncertainty: Option<PoseUncertainty>,
    shape: ShapeStatement,
}

fn statements(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> Statements {
    let Distances {
        tolerance,
        reach,
        near,
        noise,
    } = Distances::of(source, target, pose.scale, settings);
    let millimetre = settings.length_of_millimetre();
    let tolerance = tolerance.for_bends(target.measures().diagonal, millimetre);
    let Some(contacts) = Contacts::find(source, target, pose, reach) else {
        return Statements {
            uncertainty: None,
            shape: ShapeStatement::nothing_met(tolerance),
        };
    };
    let rims = Rims::find(source, target, pose, near);
    let evidence = ShapeEvidence {
        source,
        target,
        pose,
        contacts: &contacts,
        rims: &rims,
        noise,
        reach,
    };
    let other_trim = trims::other_trim(&evidence, &tolerance);
    let rims = other_trim.as_ref().map_or(&rims, |trim| &trim.left);
    let evidence = ShapeEvidence { rims, ..evidence };
    let uncertainty =
        PoseUncertainty::of(source, pose, &contacts, rims, (noise, settings.thickness));
    let mut shape = ShapeStatement::of(&evidence, tolerance);
    shape.rims.other_trim = other_trim.as_ref().map(|trim| trim.apart);
    shape.is_offset_removed = settings.remove_offset && skin::is_removed(&evidence, &shape);
    let uncertainty = uncertainty.map(|pose| pose.of_bent(shape.springback));
    Statements { uncertainty, shape }
}

/// The statement about the shape at the pose of the opposite hand, if its score speaks for it.
fn mirrored_statement(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
) -> Option<ShapeStatement> {
    let check = &outcome.mirror_check;
    let pose = check.target_from_source.as_ref()?;
    let speaks_for_it = check.score_ratio? < verdict::NEAR_MIRROR;
    speaks_for_it.then(|| statements(source, target, pose, settings).shape)
}

fn tolerance_of(target: &Surface, settings: &AssessSettings) -> ShapeTolerance {
    let usual = ShapeTolerance::new(
        settings.shape_tolerance,
        settings.thickness,
        target.measures().diagonal,
        settings.length_of_millimetre(),
    );
    usual.at_least(settings.allowance)
}
