//! The left part distinguished from the right one by borders and holes.

use rayon::prelude::*;

use super::{
    HARDLY_HELD, MOST_SLID, PoseComparison, Refined, SURELY_HELD, apart, ratio_by_borders,
};
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
/// Where not all borders lie together with the opposite hand, or those beside others lie no closer, so much more may do
/// by chance.
const SHARE_BY_CHANCE: f64 = 0.05;
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
    let mut by_borders = comparison.by_borders(&poses)?;
    // Poses that lie apart take the longest to move, and come no closer than those that lie on the part.
    let near = by_borders.par_iter().copied();
    let near: Vec<Similarity> = near
        .filter(|pose| comparison.lies_on(pose, &result))
        .collect();
    if !near.is_empty() {
        by_borders = near;
    }
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
    Ok(fits_as_well.then(|| OppositeHand {
        score_ratio: ratio_of_hands(&result, &opposite, comparison.remainder()),
        target_from_source: opposite.pose,
    }))
}

/// The score of the opposite hand over that of the result by their borders. Holes are off by more than `within`.
fn ratio_of_hands(result: &Refined, opposite: &Refined, within: f64) -> f64 {
    let is_supported = opposite.held >= SURELY_HELD;
    let has_more_holes = opposite.has_more_holes_than(result, within);
    // Of borders beside no other more may lie so by chance.
    let lies_closer = opposite.held_of_paired() > result.held_of_paired();
    let negligible = if has_more_holes || is_supported && lies_closer {
        SAME_SHARE
    } else {
        SHARE_BY_CHANCE
    };
    let ratio = ratio_by_borders(apart(result.held - opposite.held, negligible));
    if is_supported {
        return ratio;
    }
    // Borders that fit neither hand well decide nothing by themselves. Of outlines that were trimmed differently, some
    // lie together by chance: they are not even a hint.
    let is_chance = opposite.held < HARDLY_HELD || result.is_held_as_well(opposite, within);
    let is_hint = has_more_holes || !is_chance;
    ratio.max(if is_hint { HINT } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settling::border_choice::tests::refined;

    #[test]
    fn outlines_that_lie_together_by_chance_are_no_hint_of_the_opposite_hand() {
        let ratio = |result, opposite| ratio_of_hands(&result, &opposite, 1.0);
        // A hole that only the opposite hand has its counterpart of, and outlines that all lie together.
        assert!(ratio(refined(0.9, 1.0, 1), refined(0.95, 1.0, 2)) < HINT);
        assert!(ratio(refined(0.5, 0.6, 1), refined(0.55, 0.6, 2)) < 1.0);
        // Trims of both parts, under which hardly any outlines lie together with either hand.
        assert!(ratio(refined(0.04, 0.97, 3), refined(0.19, 0.98, 3)) >= 1.0);
        assert!(ratio(refined(0.55, 0.74, 3), refined(0.57, 0.58, 3)) >= 1.0);
        // One more hole is no accident.
        assert!(ratio(refined(0.04, 0.97, 2), refined(0.19, 0.98, 3)) < 1.0);
        // All that has a counterpart lies on it with both hands.
        assert!(ratio(refined(0.896, 0.903, 51), refined(0.919, 0.927, 51)) >= 1.0);
    }
}
