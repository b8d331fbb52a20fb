//! The choice between poses that surfaces hold and do not tell apart: of a part with like sectors, holes say which
//! sector is which.

use rayon::prelude::*;

use super::AssessSettings;
use super::contact::MAX_NODES;
use super::held::{FEWER_HOLES, HeldPose, Pair, Settled};
use super::settle::{Least, Settling};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Alternative, MatchOutcome, Surface, same_pose};

/// Shares of the part that meet the other are the same up to this much: nodes beside the borders meet it in one
/// pose and miss it in the next.
const SAME_MET: f64 = 0.02;

/// The pose of `outcome` or one of its alternatives that scores nearly as well, whichever has more holes where they
/// belong. `None` where no other pose fits, or a part has no holes.
/// O(alternatives · border edges + nodes · log triangles).
pub(super) fn held_by_holes(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<HeldPose>, Cancelled> {
    let has_holes = |surface: &Surface| surface.borders().iter().any(|border| border.is_hole);
    let others = outcome.alternatives.iter();
    let others: Vec<&Alternative> = others
        .filter(|other| other.score_ratio < FEWER_HOLES)
        .collect();
    if others.is_empty() || !has_holes(source) || !has_holes(target) {
        return Ok(None);
    }
    let found = &outcome.target_from_source;
    let pair = Pair::new(source, target, found.scale, settings);
    let Some(result) = pair.settle(found, Least::Facets) else {
        return Ok(None);
    };
    let settle = |other: &&Alternative| {
        monitor.check()?;
        Ok(pair.settle(&other.target_from_source, Least::Facets))
    };
    let settled: Result<Vec<Option<Settled>>, Cancelled> = others.par_iter().map(settle).collect();
    let has_more = |a: &Settled, b: &Settled| a.has_more_holes_than(b, pair.remainder, SAME_MET);
    let better = settled?.into_iter().flatten();
    let better: Vec<Settled> = better
        .filter(|other| other.is_as_close_as(&result, &pair) && has_more(other, &result))
        .collect();
    let unbeaten = better
        .iter()
        .find(|pose| !better.iter().any(|other| has_more(other, pose)));
    let pose = unbeaten.map_or(*found, |other| other.pose);
    let winner = unbeaten.unwrap_or(&result);
    let before = unbeaten.is_some().then_some(Alternative {
        target_from_source: *found,
        score_ratio: 1.0,
        start: outcome.winner,
    });
    let has_fewer = |pose: &Similarity| {
        let other = pair.measured(*pose);
        other.is_some_and(|other| has_more(winner, &other))
    };
    let part = source.measures().into();
    let others = outcome.alternatives.iter().copied().chain(before);
    let mut alternatives: Vec<Alternative> = others
        .filter(|other| !same_pose(&other.target_from_source, &winner.pose, &part))
        .map(|other| Alternative {
            score_ratio: if has_fewer(&other.target_from_source) {
                other.score_ratio.max(FEWER_HOLES)
            } else {
                other.score_ratio
            },
            ..other
        })
        .collect();
    alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    let exactly = Settling::new([source, target], found.scale, settings, MAX_NODES);
    Ok(Some(HeldPose {
        target_from_source: exactly.settled(&pose, Least::Facets).unwrap_or(pose),
        alternatives,
    }))
}
