//! The left part told from the right one by borders and holes.

use rayon::prelude::*;

use super::{AS_CLOSE, MOST_SLID, Pair, SURELY_HELD, Settled, apart, free_limit, ratio_by_borders};
use crate::assess::settle::Least;
use crate::assess::slide::slid;
use crate::assess::sliding::weak_motion;
use crate::assess::tolerance::AssessSettings;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{MatchOutcome, Surface};

/// Shares of the borders that differ by less than this do not tell hands apart.
const SAME_SHARE: f64 = 0.02;
/// Where less of the borders lies where it belongs than what surely tells hands apart, the score of the opposite hand
/// counts as at least this many times the result's.
const HINT: f64 = 0.9;
/// Scores of the opposite hand above this many times the result's need no other opinion.
const OPPOSITE_IS_CLEAR: f64 = 1.3;

/// Score of the opposite hand over that of the result, where the surfaces fit both: a hole on one side
/// tells the left part from the right one. `None` where the surfaces decide, or the opposite hand found
/// no pose.
pub fn hand_by_borders(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<f64>, Cancelled> {
    let check = &outcome.mirror_check;
    let is_near = check
        .score_ratio
        .is_some_and(|ratio| ratio < OPPOSITE_IS_CLEAR);
    let Some(mirrored) = check.target_from_source.as_ref().filter(|_| is_near) else {
        return Ok(None);
    };
    let scale = outcome.target_from_source.scale;
    let pair = Pair::new(source, target, scale, settings);
    let Some(result) = pair.measured(outcome.target_from_source) else {
        return Ok(None);
    };
    let limit = free_limit(source, target, scale, settings);
    let free = weak_motion(source, target, &outcome.target_from_source, limit);
    let slid = free.map_or_else(Vec::new, |free| {
        slid(source, target, mirrored, &free, MOST_SLID)
    });
    let poses: Vec<Similarity> = slid.into_iter().chain([*mirrored]).collect();
    let by_borders = pair.by_borders(&poses, monitor)?;
    let settle = |pose: &Similarity| {
        monitor.check()?;
        Ok(pair.settle(pose, Least::Any))
    };
    let settled: Result<Vec<Option<Settled>>, Cancelled> =
        by_borders.par_iter().map(settle).collect();
    let close = settled?
        .into_iter()
        .flatten()
        .filter(|other| other.is_as_close_as(&result, &pair));
    let Some(opposite) = close.max_by(|a, b| a.held.total_cmp(&b.held)) else {
        return Ok(None);
    };
    let fits_as_well = result.gap <= AS_CLOSE * opposite.gap;
    let behind = result.held - opposite.held;
    let ratio = ratio_by_borders(apart(behind, SAME_SHARE));
    // Borders that fit neither hand are a hint and no more.
    let least = if opposite.held < SURELY_HELD {
        HINT
    } else {
        0.0
    };
    Ok(fits_as_well.then(|| ratio.max(least)))
}
