//! A pose that takes the place of the result, and the others beside it.

use std::cmp::Ordering;

use super::candidate::{Candidate, Judged};
use crate::geometry::Similarity;
use crate::registration::{Alternative, MatchOutcome, Surface, same_pose};

/// A pose with more differences of the shapes counts as at least so many times as bad as the result.
const MORE_DIFFERENCES: f64 = 1.5;

/// A pose that a step chose, and what is left of the others.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenPose {
    /// The pose.
    pub target_from_source: Similarity,
    /// The other poses of the match. Where their borders fit worse than their surfaces, that is how much
    /// worse they are.
    pub alternatives: Vec<Alternative>,
}

impl ChosenPose {
    /// A pose with others beside it, from the best on and each once. Those that are the pose itself are left out.
    pub(super) fn new(
        pose: Similarity,
        others: impl Iterator<Item = Alternative>,
        source: &Surface,
    ) -> Self {
        let part = source.measures().into();
        let others = others.filter(|other| !same_pose(&other.target_from_source, &pose, &part));
        Self {
            target_from_source: pose,
            alternatives: distinct(others, source),
        }
    }

    /// It becomes the result, with the others beside it.
    pub(super) fn taken_by(self, outcome: &mut MatchOutcome) {
        outcome.target_from_source = self.target_from_source;
        outcome.alternatives = self.alternatives;
    }

    /// Of the poses that were judged beside the result of `outcome`, the first in `order` of those that `is_better`
    /// than it. `None` where none is.
    pub(super) fn best_of(
        Judged {
            result,
            mut candidates,
        }: Judged,
        outcome: &MatchOutcome,
        source: &Surface,
        is_better: impl Fn(&Candidate, &Candidate) -> bool,
        order: impl Fn(&Candidate, &Candidate) -> Ordering,
    ) -> Option<Self> {
        candidates.retain(|other| is_better(other, &result));
        candidates.sort_by(order);
        let (winner, others) = candidates.split_first()?;
        let before = (outcome, &result);
        Some(Self::in_place_of(before, winner, others, source))
    }

    /// A pose that takes the place of `result`, that of `outcome`. Beside it come those that were found with it, the
    /// result before, and its alternatives. Only one under which the shapes differ no more is as likely, or that
    /// nothing but surfaces distinguishes from the winner.
    fn in_place_of(
        (outcome, result): (&MatchOutcome, &Candidate),
        winner: &Candidate,
        found_too: &[Candidate],
        source: &Surface,
    ) -> Self {
        let found_too = found_too.iter().map(|other| {
            let is_worse = other.n_differences > winner.n_differences || winner.beats(other);
            let other = as_likely(other.pose, outcome);
            if is_worse { beaten(other) } else { other }
        });
        let before = as_likely(result.pose, outcome);
        let before = if result.is_distinguished_by_surfaces_only(winner) {
            before
        } else {
            beaten(before)
        };
        let known = outcome.alternatives.iter().map(|other| beaten(*other));
        let others = found_too.chain([before]).chain(known);
        Self::new(winner.pose, others, source)
    }
}

/// A pose that is as likely as the result of a match.
pub(super) fn as_likely(target_from_source: Similarity, outcome: &MatchOutcome) -> Alternative {
    Alternative {
        target_from_source,
        score_ratio: 1.0,
        by_shape: true,
        start: outcome.winner,
    }
}

/// An alternative, as bad as it counts where the shapes differ more under it.
pub(super) fn beaten(other: Alternative) -> Alternative {
    at_least(other, MORE_DIFFERENCES)
}

/// An alternative that the shapes rate at `ratio` or worse.
pub(super) fn at_least(other: Alternative, ratio: f64) -> Alternative {
    if other.score_ratio >= ratio {
        return other;
    }
    Alternative {
        score_ratio: ratio,
        by_shape: true,
        ..other
    }
}

/// Alternatives from the best on; of those that are the same pose the best.
pub(super) fn distinct(
    alternatives: impl Iterator<Item = Alternative>,
    source: &Surface,
) -> Vec<Alternative> {
    let part = source.measures().into();
    let mut sorted: Vec<Alternative> = alternatives.collect();
    sorted.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    let mut distinct: Vec<Alternative> = Vec::new();
    for other in sorted {
        let is_known =
            |a: &Alternative| same_pose(&a.target_from_source, &other.target_from_source, &part);
        if !distinct.iter().any(is_known) {
            distinct.push(other);
        }
    }
    distinct
}
