//! The two statements about a pair under a pose: how far the pose may be off, and whether the shapes are one.

use super::borders::Borders;
use super::contact::Contacts;
use super::decide::NEAR_MIRROR;
use super::fit::{Fit, ShapeEvidence};
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
    let borders = Borders::find(source, target, pose, near);
    let evidence = ShapeEvidence {
        source,
        target,
        pose,
        contacts: &contacts,
        borders: &borders,
        noise,
        reach,
    };
    let other_trim = trims::other_trim(&evidence, &tolerance);
    let borders = other_trim.as_ref().map_or(&borders, |trim| &trim.left);
    let evidence = ShapeEvidence {
        borders,
        ..evidence
    };
    let fit = Fit::of(&evidence);
    let lengths = (noise, settings.thickness);
    let uncertainty = PoseUncertainty::of(source, pose, &contacts, borders, &fit, lengths);
    let mut shape = ShapeStatement::of(&evidence, &fit, tolerance);
    shape.borders.other_trim = other_trim.as_ref().map(|trim| trim.apart);
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
