//! Poses from pieces of the parts: is there one under which a piece of each lies on the other and nothing differs?

use rayon::prelude::*;

use super::candidate::{Candidate, FewPlaces, ON_EACH_OTHER, judged, off_for_its_size};
use super::chosen_pose::ChosenPose;
use super::context::PairContext;
use super::holes::found_by;
use super::refine_with_borders::Refinement;
use crate::assess::contact::{FEW_NODES, Meeting};
use crate::assess::shape::OVERHANGS;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::{MatchOutcome, WideSearch};

/// Surfaces that lie on each other are the same ones if at least this share of the smaller part does.
const ENOUGH: f64 = 0.5;
/// A piece that is smaller than this share of the part is not looked at.
const LEAST_SHARE: f64 = 0.3;
/// A pose of the search comes closer to the surfaces once it is refined, which may be worth so many times the gap.
const REFINED: f64 = 0.7;
/// So many poses are refined at most.
const MOST_REFINED: usize = 4;

/// The pose under which a piece of each part lies on the other and nothing differs but what a bend explains, where the
/// parts differ, or do not meet as a whole, under the pose of `outcome`: the search lays as much of the smaller part
/// on the other as it can, which is elsewhere where each has a piece that the other lacks. `None` where rivals were not
/// to be looked for, and where there is no such pose.
/// O(poses · (border edges + nodes · log triangles)).
pub fn placed_by_pieces(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    let found = &outcome.target_from_source;
    let may_place = !found.is_mirrored() && found.scale == 1.0;
    if !outcome.rivals_sought || !may_place {
        return Ok(None);
    }
    let distances = context.distances(found.scale);
    let few = FewPlaces::new(context, found.scale);
    let own = few.meeting(found);
    if own.gap <= ON_EACH_OTHER * distances.noise && own.share >= ENOUGH {
        return Ok(None);
    }
    let is_open = |result: &Candidate| result.met < OVERHANGS || result.differs();
    if !is_open(&Candidate::at(*found, &context.shape(found))) {
        return Ok(None);
    }
    let poses = worth_refining(context, &few, own)?;
    let refinement = Refinement::new(context, found.scale, FEW_NODES);
    let refine = |pose: &Similarity| Ok(refinement.closest(pose)?.unwrap_or(*pose));
    let refined: Result<Vec<Similarity>, Cancelled> = poses.par_iter().map(refine).collect();
    let on_pieces = judged(context, found, &refined?, |pose, shape| {
        few.overhanging(pose, shape)
    })?;
    let is_better = |other: &Candidate, result: &Candidate| {
        other.fits_as_a_piece_beside(result, distances.noise)
            || other.beats(result) && other.meets_as_much_as(result)
    };
    let by_holes = |a: &Candidate, b: &Candidate| {
        let [off_a, off_b] = [a, b].map(|other| off_for_its_size(other.meeting()));
        a.n_alone.cmp(&b.n_alone).then(off_a.total_cmp(&off_b))
    };
    let best = ChosenPose::best_of(on_pieces, outcome, context.source, is_better, by_holes);
    Ok(best)
}

/// The distinct poses of pieces under which the parts, which meet as `own` under the result, may lie closer, the
/// closest for their size first.
fn worth_refining(
    context: &PairContext<'_>,
    few: &FewPlaces<'_>,
    own: Meeting,
) -> Result<Vec<Similarity>, Cancelled> {
    let apart = context.distances(1.0).reach;
    let poses = found_by(context, WideSearch::on_pieces)?.into_iter();
    let mut met: Vec<(Meeting, Similarity)> =
        poses.map(|pose| (few.meeting(&pose), pose)).collect();
    met.retain(|(piece, _)| piece.share >= LEAST_SHARE && REFINED * piece.gap <= own.gap);
    met.sort_by(|(a, _), (b, _)| off_for_its_size(*a).total_cmp(&off_for_its_size(*b)));
    let mut distinct: Vec<Similarity> = Vec::new();
    for (_, pose) in met {
        let mut known = distinct.iter();
        if known.all(|known| context.displacement(known, &pose) > apart) {
            distinct.push(pose);
        }
    }
    distinct.truncate(MOST_REFINED);
    Ok(distinct)
}
