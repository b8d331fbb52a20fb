//! The two statements about a pair under a pose: how far the pose may be off, and whether the shapes are one.

use super::borders::BorderComparison;
use super::contact::{ContactSearch, MAX_NODES};
use super::decide::NEAR_MIRROR;
use super::evidence::{EvidenceSearch, PoseEvidence};
use super::fit::Fit;
use super::shape::ShapeStatement;
use super::tolerance::{AssessSettings, Distances, ShapeTolerance};
use super::trims;
use super::uncertainty::PoseUncertainty;
use crate::geometry::Similarity;
use crate::registration::{MatchOutcome, Surface};

/// An offset of the sheets is removed where the motion that is left to the pose is at most this share of it.
const LEFT: f64 = 0.1;

/// How far the pose may be off, and whether the shapes are one.
pub(super) struct Statements {
    pub(super) uncertainty: Option<PoseUncertainty>,
    pub(super) shape: ShapeStatement,
}

/// Whether outlines are evidence of the shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outlines {
    /// They are, unless the parts were trimmed differently.
    Compared,
    /// They are left out, as if the parts had holes and no outlines.
    LeftOut,
}

/// Both statements. O(border edges + nodes · log triangles).
pub(super) fn statements(
    pair: [&Surface; 2],
    pose: &Similarity,
    settings: &AssessSettings,
) -> Statements {
    let compared = Compared::under(pair, pose, settings, Outlines::Compared);
    let uncertainty = compared.met.as_ref();
    Statements {
        uncertainty: uncertainty
            .and_then(|met| PoseUncertainty::of(&met.evidence, &met.fit, settings.thickness)),
        shape: compared.shape(settings),
    }
}

/// The statement about the shape alone, which costs less. O(border edges + nodes · log triangles).
pub(crate) fn shape_statement(
    pair: [&Surface; 2],
    pose: &Similarity,
    settings: &AssessSettings,
    outlines: Outlines,
) -> ShapeStatement {
    Compared::under(pair, pose, settings, outlines).shape(settings)
}

/// The statement about the shape at the pose of the opposite hand, if its score speaks for it.
pub(super) fn mirrored_statement(
    pair: [&Surface; 2],
    outcome: &MatchOutcome,
    settings: &AssessSettings,
) -> Option<ShapeStatement> {
    let check = &outcome.mirror_check;
    let pose = check.target_from_source.as_ref()?;
    let speaks_for_it = check.score_ratio? < NEAR_MIRROR;
    speaks_for_it.then(|| shape_statement(pair, pose, settings, Outlines::Compared))
}

/// Both parts under a pose, and what their shapes are compared by.
struct Compared<'a> {
    tolerance: ShapeTolerance,
    /// `None` where their surfaces do not meet.
    met: Option<Met<'a>>,
}

/// What parts show that meet.
struct Met<'a> {
    evidence: PoseEvidence<'a>,
    fit: Fit,
    /// How far outlines lie apart that were trimmed differently.
    other_trim: Option<f64>,
}

impl<'a> Compared<'a> {
    fn under(
        pair: [&'a Surface; 2],
        pose: &Similarity,
        settings: &AssessSettings,
        outlines: Outlines,
    ) -> Self {
        let [source, target] = pair;
        let distances = Distances::of(source, target, pose.scale, settings);
        let millimetre = settings.length_of_millimetre();
        let diagonal = target.measures().diagonal;
        let tolerance = distances.tolerance.for_bends(diagonal, millimetre);
        let contacts = ContactSearch::new(pair, pose.scale, distances.reach, MAX_NODES);
        let borders = BorderComparison::new(pair, pose.scale, distances.border_reach);
        let mut search = EvidenceSearch::new(contacts, &borders, &distances);
        let met = search.at(pose);
        Self {
            met: met.map(|evidence| Met::of(evidence, &tolerance, outlines)),
            tolerance,
        }
    }

    fn shape(&self, settings: &AssessSettings) -> ShapeStatement {
        let Some(met) = &self.met else {
            return ShapeStatement::nothing_met(self.tolerance);
        };
        let mut shape = ShapeStatement::of(&met.evidence, &met.fit, self.tolerance);
        shape.borders.other_trim = met.other_trim;
        shape.is_offset_removed = settings.remove_offset && is_removed(&met.fit, &shape);
        shape
    }
}

impl<'a> Met<'a> {
    fn of(mut evidence: PoseEvidence<'a>, tolerance: &ShapeTolerance, outlines: Outlines) -> Self {
        let (fit, other_trim) = match outlines {
            Outlines::LeftOut => {
                evidence.borders = evidence.borders.of_holes();
                (Fit::of(&evidence), None)
            }
            Outlines::Compared => trims::fit_of_shape(&mut evidence, tolerance),
        };
        Self {
            evidence,
            fit,
            other_trim,
        }
    }
}

/// Whether an offset is all that is left of the gaps: it does not push the pose aside any more.
fn is_removed(fit: &Fit, shape: &ShapeStatement) -> bool {
    let offset = shape.offset.and(fit.separate_offset());
    offset.is_some_and(|offset| fit.rigid.norm() <= LEFT * offset.abs())
}
