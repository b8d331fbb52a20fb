//! The left part distinguished from the right one by borders and holes.

use rayon::prelude::*;

use super::{MOST_SLID, PoseComparison, Refined, SURELY_HELD, apart, ratio_by_borders};
use crate::assess::free_motion::weak_motion;
use crate::assess::tolerance::AS_CLOSE;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::MatchOutcome;
use crate::settling::context::PairContext;
use crate::settling::free_motion_search::poses_along;
use crate::settling::holes;
use crate::settling::refine_with_borders::Least;

/// Shares of the borders that differ by less than this do not distinguish hands.
const SAME_SHARE: f64 = 0.02;
/// Where less of the borders lies where it belongs than what surely distinguishes hands, the score of the opposite hand
/// counts as at least this many times the result's.
const HINT: f64 = 0.9;
/// Scores of the opposite hand above this many times the result's need no other opinion.
const OPPOSITE_IS_CLEAR: f64 = 1.3;

/// The opposite hand as borders and holes rate it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OppositeHand {
    /// Its score over that of the result.
    pub score_ratio: f64,
    /// The pose that this is the score of; it mirrors.
    pub target_from_source: Similarity,
}

/// The opposite hand where the surfaces fit both: a hole on one side distinguishes the left part from the right one.
/// Where holes of the result have no counterpart, poses under which holes of the opposite hand lie on like ones are
/// looked at too, since surfaces may fit several of them. `None` where the surfaces decide, or the opposite hand found
/// no pose. O(poses · (border edges + nodes · log triangles)).
pub fn hand_by_borders(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<OppositeHand>, Cancelled> {
    context.check()?;
    let check = &outcome.mirror_check;
    let is_near = check
        .score_ratio
        .is_some_and(|ratio| ratio < OPPOSITE_IS_CLEAR);
    let Some(mirrored) = check.target_from_source.as_ref().filter(|_| is_near) else {
        return Ok(None);
    };
    let PairContext { source, target, .. } = *context;
    let found = &outcome.target_from_source;
    let comparison = PoseComparison::new(context, found.scale);
    let distances = &comparison.distances;
    let Some(result) = comparison.measured(*found) else {
        return Ok(None);
    };
    let mut poses: Vec<Similarity> = Vec::new();
    if let Some(free) = weak_motion(source, target, found, distances.free_limit) {
        poses = poses_along(context, mirrored, &free, MOST_SLID)?;
    }
    poses.push(*mirrored);
    if result.missing > 0.0 && holes::can_place(context, found) {
        poses.extend(holes::mirrored_poses(context)?);
    }
    let by_borders = comparison.by_borders(&poses)?;
    let refine = |pose: &Similarity| comparison.refined(pose, Least::Any);
    let refined: Result<Vec<Option<Refined>>, Cancelled> =
        by_borders.par_iter().map(refine).collect();
    let close = refined?
        .into_iter()
        .flatten()
        .filter(|other| other.is_as_close_as(&result, distances));
    let Some(opposite) = close.max_by(|a, b| a.held.total_cmp(&b.held)) else {
        return Ok(None);
    };
    let fits_as_well = result.gap <= AS_CLOSE * opposite.gap;
    let behind = result.held - opposite.held;
    let ratio = ratio_by_borders(apart(behind, SAME_SHARE));
    // Borders that fit neither hand well decide nothing by themselves.
    let least = if opposite.held < SURELY_HELD {
        HINT
    } else {
        0.0
    };
    Ok(fits_as_well.then(|| OppositeHand {
        score_ratio: ratio.max(least),
        target_from_source: opposite.pose,
    }))
}
