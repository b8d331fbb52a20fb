//! The choice between poses by the shapes under each of them. Facets and springback raise all scores, so that a
//! part with waves, turned by half a turn, may score only a few percent worse; that a hole, a bead or a border
//! then lies elsewhere shows all the same.

use rayon::prelude::*;

use super::candidate::{Candidate, FewPlaces, Judged, LEAST_SHARED, is_much_closer, judged};
use super::chosen_pose::{ChosenPose, as_likely, beaten};
use super::context::PairContext;
use super::refine_with_borders::Refinement;
use crate::assess::contact::FEW_NODES;
use crate::assess::free_motion::weak_motion;
use crate::assess::shape::OVERHANGS;
use crate::assess::tolerance::Distances;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::{Alternative, Extent, MatchOutcome, same_pose};

/// Alternatives that score up to so many times as bad are looked at where they settle: they are refined no further
/// than it takes to see that they are behind, and noise, offsets and springback may leave two poses that fit alike so
/// far apart.
const WORTH_SETTLING: f64 = 3.0;

/// The pose of `outcome` or one of its alternatives that scores nearly as well, whichever has the fewest differences
/// between the shapes, or one under which a piece of each part lies on the other while the result lies much farther
/// apart. Alternatives with more differences than the pose chosen score worse; where each part has a piece that the
/// other lacks, those that fit as well with less overlap score as well. `None` where no other pose is looked at.
/// O(alternatives · (border edges + nodes · log triangles)).
pub fn chosen_by_shape(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    let found = &outcome.target_from_source;
    let distances = context.distances(found.scale);
    let few = FewPlaces::new(context, found.scale);
    let own = few.meeting(found);
    let overhangs = own.share < OVERHANGS;
    let lies_closer = |other: &Alternative| {
        let piece = few.meeting(&other.target_from_source);
        piece.share >= LEAST_SHARED && is_much_closer(piece, own.gap, distances.noise)
    };
    let is_near = |other: &&Alternative| {
        let scores_near = overhangs || other.score_ratio < WORTH_SETTLING;
        scores_near || own.gap > distances.noise && lies_closer(other)
    };
    let alternatives = outcome.alternatives.iter();
    let (near, far): (Vec<&Alternative>, Vec<&Alternative>) = alternatives.partition(is_near);
    if near.is_empty() {
        return Ok(None);
    }
    let refinement = Refinement::new(context, found.scale, FEW_NODES);
    let refine = |other: &&Alternative| {
        let pose = other.target_from_source;
        Ok(refinement.closest(&pose)?.unwrap_or(pose))
    };
    let refined: Result<Vec<Similarity>, Cancelled> = near.par_iter().map(refine).collect();
    let Judged { result, candidates } = judged(context, found, &refined?, |pose, shape| {
        if overhangs {
            few.overhanging(pose, shape)
        } else {
            few.candidate(pose, shape)
        }
    })?;
    // Of candidates with as many differences the first one scores best.
    let better = candidates.iter().filter(|other| other.beats(&result));
    let better = better.min_by_key(|other| other.n_differences);
    let closer = || {
        candidates
            .iter()
            .find(|other| other.is_exact_partial_fit_beside(&result, distances.noise))
    };
    let winner = better.or_else(closer).unwrap_or(&result);
    // Where surfaces leave the pose free, borders and holes have compared all poses, unless outlines are no evidence.
    let PairContext { source, target, .. } = *context;
    let surfaces_hold = weak_motion(source, target, &winner.pose, distances.free_limit).is_none();
    let beside = Beside {
        winner,
        distances,
        part: source.measures().into(),
        overhangs,
        borders_chose: !surfaces_hold && !winner.outlines_are_no_evidence,
    };
    let before = as_likely(*found, outcome);
    let before = if winner.beats(&result) {
        beaten(before)
    } else {
        before
    };
    let near = near.into_iter().zip(&candidates);
    let others = near
        .filter_map(|(other, candidate)| beside.rated(*other, candidate))
        .chain(far.into_iter().copied())
        .chain([before]);
    Ok(Some(ChosenPose::new(winner.pose, others, source)))
}

/// What alternatives are rated by beside the pose that was chosen.
struct Beside<'a> {
    winner: &'a Candidate,
    distances: Distances,
    part: Extent,
    /// Whether each part has a piece that the other lacks under the result of the match.
    overhangs: bool,
    /// Whether borders and holes have compared all poses before.
    borders_chose: bool,
}

impl Beside<'_> {
    fn is_winner(&self, pose: &Similarity) -> bool {
        same_pose(pose, &self.winner.pose, &self.part)
    }

    /// An alternative, rated by the shapes where it settles. One that settles at the winner's pose is no other: `None`.
    fn rated(&self, other: Alternative, candidate: &Candidate) -> Option<Alternative> {
        if self.is_winner(&candidate.pose) {
            return None;
        }
        let (winner, noise) = (self.winner, self.distances.noise);
        if winner.beats(candidate)
            || winner.lies_much_closer_without_difference_than(candidate, noise)
        {
            return Some(beaten(other));
        }
        let fits_elsewhere = self.overhangs
            && candidate.is_equal_partial_fit_beside(winner, &self.distances)
            || candidate.lies_much_closer_elsewhere_than(winner, noise)
            || candidate.covers_more_than(winner, &self.distances);
        let ratio = if fits_elsewhere {
            Some(1.0)
        } else {
            let ratio = candidate.ratio_to(winner, noise);
            ratio.filter(|_| !self.borders_chose)
        };
        let better = ratio.filter(|ratio| *ratio < other.score_ratio);
        Some(match better {
            Some(score_ratio) => Alternative {
                target_from_source: candidate.pose,
                score_ratio,
                by_shape: true,
                ..other
            },
            None => other,
        })
    }
}
