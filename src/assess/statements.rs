//! The two statements about a pair under a pose: how far the pose may be off, and whether the shapes are one.

use super::borders::BorderComparison;
use super::contact::{ContactSearch, MAX_NODES};
use super::decide::NEAR_MIRROR;
use super::evidence::EvidenceSearch;
use super::fit::Fit;
use super::shape::ShapeStatement;
use super::tolerance::{AssessSettings, Distances};
use super::uncertainty::PoseUncertainty;
use super::{skin, trims};
use crate::geometry::Similarity;
use crate::registration::{MatchOutcome, Surface};

/// How far the pose may be off, and whether the shapes are one.
pub(super) struct Statements {
    pub(super) uncertainty: Option<PoseUncertainty>,
    pub(super) shape: ShapeStatement,
}

/// Compares both parts under a pose. O(border edges + nodes · log triangles).
pub(super) fn statements(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> Statements {
    compare([source, target], pose, settings, true)
}

/// The same of the shape alone, as if the parts had holes and no outlines.
pub(super) fn shape_without_outlines(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> ShapeStatement {
    compare([source, target], pose, settings, false).shape
}

fn compare(
    pair: [&Surface; 2],
    pose: &Similarity,
    settings: &AssessSettings,
    has_outlines: bool,
) -> Statements {
    let [source, target] = pair;
    let distances = Distances::of(source, target, pose.scale, settings);
    let millimetre = settings.length_of_millimetre();
    let diagonal = target.measures().diagonal;
    let tolerance = distances.tolerance.for_bends(diagonal, millimetre);
    let contacts = ContactSearch::new(pair, pose.scale, distances.reach, MAX_NODES);
    let borders = BorderComparison::new(pair, pose.scale, distances.near);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let Some(mut evidence) = search.at(pose) else {
        return Statements {
            uncertainty: None,
            shape: ShapeStatement::nothing_met(tolerance),
        };
    };
    let mut other_trim = None;
    if !has_outlines {
        evidence.borders = evidence.borders.of_holes();
    } else if let Some(trim) = trims::other_trim(&evidence, &tolerance) {
        evidence.borders = trim.left;
        other_trim = Some(trim.apart);
    }
    let fit = Fit::of(&evidence);
    let uncertainty = PoseUncertainty::of(&evidence, &fit, settings.thickness);
    let mut shape = ShapeStatement::of(&evidence, &fit, tolerance);
    shape.borders.other_trim = other_trim;
    shape.is_offset_removed = settings.remove_offset && skin::is_removed(&fit, &shape);
    Statements { uncertainty, shape }
}

/// The statement about the shape at the pose of the opposite hand, if its score speaks for it.
pub(super) fn mirrored_statement(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
) -> Option<ShapeStatement> {
    let check = &outcome.mirror_check;
    let pose = check.target_from_source.as_ref()?;
    let speaks_for_it = check.score_ratio? < NEAR_MIRROR;
    speaks_for_it.then(|| statements(source, target, pose, settings).shape)
}
