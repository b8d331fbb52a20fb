//! The match of two meshes with the same nodes in the same order: closed form, without a search.

use std::time::Instant;

use super::RegistrationError;
use super::closed_form::umeyama;
use super::icp::Termination;
use super::input::MatchInput;
use super::multi_start::starts::StartKind;
use super::result::{MatchOutcome, MatchTimings, MirrorCheck, Side, StartOutcome, StartRecord};
use super::scale_check::ScaleCheck;
use super::settings::{Hand, MatchSettings};
use crate::geometry::Similarity;

/// Umeyama's solution over all nodes.
pub(super) fn match_same_nodes(
    input: &MatchInput<'_>,
    settings: &MatchSettings,
) -> Result<MatchOutcome, RegistrationError> {
    let begin = Instant::now();
    let source = input.source.nodes_as_given();
    let target = input.target.nodes_as_given();
    let fit = umeyama(&source, &target, settings.motion)?;
    let mirrored = match settings.hand {
        Hand::Same => false,
        Hand::Mirrored => true,
        Hand::Either => fit.mirrored_rmse < fit.rmse,
    };
    let (target_from_source, rmse, scale) = if mirrored {
        (fit.mirrored, fit.mirrored_rmse, fit.mirrored_scale)
    } else {
        (fit.target_from_source, fit.rmse, fit.scale)
    };
    let mut distances: Vec<f64> = source
        .iter()
        .zip(&target)
        .map(|(x, y)| (target_from_source.apply(x) - y).norm())
        .collect();
    distances.sort_by(f64::total_cmp);
    let p95 = distances
        .get(distances.len() * 95 / 100)
        .copied()
        .unwrap_or(0.0);
    Ok(MatchOutcome {
        target_from_source,
        termination: Termination::ClosedForm,
        data_side: Side::Source,
        floor: 0.0,
        alternatives: Vec::new(),
        with_all_pairs: None,
        rivals_sought: false,
        winner: 0,
        starts: vec![StartRecord {
            kind: StartKind::CurrentPose,
            flipped: false,
            mirrored,
            data_side: Side::Source,
            first: Similarity::identity(),
            last: target_from_source,
            iterations: Vec::new(),
            score: rmse,
            p95,
            took: begin.elapsed(),
            termination: Some(Termination::ClosedForm),
            outcome: Some(StartOutcome::Won),
        }],
        scale_check: ScaleCheck::new(
            [input.source, input.target],
            target_from_source.scale,
            scale,
        ),
        mirror_check: MirrorCheck {
            score_ratio: None,
            by_borders: false,
            target_from_source: None,
        },
        timings: MatchTimings {
            total: begin.elapsed(),
            ..MatchTimings::default()
        },
    })
}
