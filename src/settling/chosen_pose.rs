//! A pose that takes the place of the result, and the others beside it.

use super::candidate::Candidate;
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
    /// It becomes the result, with the others beside it.
    pub(super) fn taken_by(self, outcome: &mut MatchOutcome) {
        outcome.target_from_source = self.target_from_source;
        outcome.alternatives = self.alternatives;
    }

    /// A pose that takes the place of the result of `outcome`. Beside it come those that were found with it, the
    /// result before, and its alternatives. Only one under which the shapes differ no more is as likely.
    pub(super) fn in_place_of(
        outcome: &MatchOutcome,
        winner: &Candidate,
        found_too: &[Candidate],
        source: &Surface,
    ) -> Self {
        let as_likely = |target_from_source| Alternative {
            target_from_source,
            score_ratio: 1.0,
            start: outcome.winner,
        };
        let part = source.measures().into();
        let found_too = found_too.iter().map(|other| {
            let is_beaten = other.n_differences > winner.n_differences || winner.beats(other);
            ranked(as_likely(other.pose), is_beaten)
        });
        let before = ranked(as_likely(outcome.target_from_source), true);
        let others = outcome.alternatives.iter();
        let others = others.map(|other| ranked(*other, true));
        let mut all: Vec<Alternative> = found_too
            .chain([before])
            .chain(others)
            .filter(|other| !same_pose(&other.target_from_source, &winner.pose, &part))
            .collect();
        all.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
        Self {
            target_from_source: winner.pose,
            alternatives: distinct(&all, source),
        }
    }
}

/// An alternative, as bad as it counts where the shapes differ more under it.
pub(super) fn ranked(other: Alternative, is_beaten: bool) -> Alternative {
    let least = if is_beaten { MORE_DIFFERENCES } else { 0.0 };
    Alternative {
        score_ratio: other.score_ratio.max(least),
        ..other
    }
}

/// Of alternatives that are the same pose the first.
pub(super) fn distinct(alternatives: &[Alternative], source: &Surface) -> Vec<Alternative> {
    let part = source.measures().into();
    let mut distinct: Vec<Alternative> = Vec::new();
    for other in alternatives {
        let is_known =
            |a: &Alternative| same_pose(&a.target_from_source, &other.target_from_source, &part);
        if !distinct.iter().any(is_known) {
            distinct.push(*other);
        }
    }
    distinct
}
