//! Poses from holes, whatever the match found: do more holes lie on like ones under one of them?

use rayon::prelude::*;

use super::candidate::{Candidate, FewPlaces, judged};
use super::chosen_pose::ChosenPose;
use super::context::PairContext;
use super::refine_with_borders::{Least, Refinement};
use crate::assess::contact::FEW_NODES;
use crate::assess::evidence::EvidenceSearch;
use crate::assess::tolerance::is_source_smaller;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{MatchOutcome, Surface, WideSearch, is_piece};

/// Steps to the surfaces at most, and the motion, as a share of what may remain, below which they end.
const STEPS: usize = 12;
const STILL: f64 = 0.002;

/// The pose under which holes lie on like ones of the other part, where those of the pose of `outcome` do not: of a
/// piece where the shapes differ and do not, or surely less, under that one, since a piece may slide along a strip
/// with hardly any gain or loss of its surfaces; of any part where a hole has no counterpart and more have one under
/// that pose, since a regular pattern may be shifted. `None` where rivals were not to be looked for, and where there
/// is no such pose.
/// O(poses · (border edges + nodes · log triangles)).
pub fn placed_by_holes(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    let PairContext { source, target, .. } = *context;
    let found = &outcome.target_from_source;
    if !outcome.rivals_sought || !can_place(context, found) {
        return Ok(None);
    }
    let is_piece = if is_source_smaller(source, target, 1.0) {
        is_piece(source, target)
    } else {
        is_piece(target, source)
    };
    let is_open = |result: &Candidate| is_piece && result.differs() || result.n_alone > 0;
    if !is_open(&Candidate::at(*found, &context.shape(found))) {
        return Ok(None);
    }
    let refinement = Refinement::new(context, 1.0, FEW_NODES);
    let refine = |pose: &Similarity| Ok(refinement.refined(pose, Least::Any)?.unwrap_or(*pose));
    let found_on_holes = poses(context)?.par_iter();
    let refined: Result<Vec<Similarity>, Cancelled> = found_on_holes.map(refine).collect();
    let few = FewPlaces::new(context, 1.0);
    let mut on_holes = judged(context, found, &refined?, |pose, shape| {
        few.candidate(pose, shape)
    })?;
    let noise = context.distances(1.0).noise;
    let fits_as_a_piece = |other: &Candidate, result: &Candidate| {
        other.fits_by_holes_as_a_piece_beside(result, noise)
    };
    // A few holes and borders leave a bend open, which surfaces tell.
    for at in 0..on_holes.candidates.len() {
        let candidate = &on_holes.candidates[at];
        if fits_as_a_piece(candidate, &on_holes.result) {
            let closer = closer_to_surfaces(context, &candidate.pose)?;
            let closer = few.candidate(closer, &context.shape(&closer));
            on_holes.candidates.push(closer);
        }
    }
    let is_better = |other: &Candidate, result: &Candidate| {
        let differs_less = is_piece && result.differs() && !other.differs();
        (differs_less || other.beats(result)) && other.meets_as_much_as(result)
            || fits_as_a_piece(other, result)
    };
    let by_differences = |a: &Candidate, b: &Candidate| {
        let by_holes = b.n_holes.cmp(&a.n_holes);
        let by_surfaces = a.apart().total_cmp(&b.apart());
        let order = a.n_differences.cmp(&b.n_differences);
        order.then(by_holes).then(by_surfaces)
    };
    let best = ChosenPose::best_of(on_holes, outcome, context.source, is_better, by_differences);
    Ok(best)
}

/// A pose moved to where the surfaces lie closest. O(steps · nodes · log triangles).
fn closer_to_surfaces(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Similarity, Cancelled> {
    let distances = context.distances(pose.scale);
    let contacts = context.contacts(pose.scale, distances.reach, FEW_NODES);
    let borders = context.borders(pose.scale, distances.border_reach);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let still = STILL * distances.tolerance.remainder;
    context.stepped(&mut search, pose, STEPS, |evidence| {
        Some((evidence.closer_surfaces(), still))
    })
}

/// Whether both parts have holes, and a pose like this one is looked for by them.
pub(super) fn can_place(context: &PairContext<'_>, pose: &Similarity) -> bool {
    let has_holes = |part: &Surface| part.borders().iter().any(|border| border.is_hole);
    let may_place = !pose.is_mirrored() && pose.scale == 1.0;
    may_place && context.surfaces().into_iter().all(has_holes)
}

/// The poses under which the most holes of the smaller part lie on like ones of the other; they are as exact as the
/// middles of a few holes. Looked for once. O(holes² of both parts), bounded.
fn poses<'a>(context: &'a PairContext<'_>) -> Result<&'a [Similarity], Cancelled> {
    if let Some(known) = context.on_holes.get() {
        return Ok(known);
    }
    let found = found_by(context, WideSearch::on_holes)?;
    Ok(context.on_holes.get_or_init(|| found))
}

/// The same for the opposite hand.
pub(super) fn mirrored_poses(context: &PairContext<'_>) -> Result<Vec<Similarity>, Cancelled> {
    found_by(context, WideSearch::on_holes_mirrored)
}

/// What a search finds for the smaller part on the other, as poses of the source.
pub(super) fn found_by<'a>(
    context: &PairContext<'a>,
    search: impl Fn(&WideSearch<'a>, &Monitor) -> Result<Vec<Similarity>, Cancelled>,
) -> Result<Vec<Similarity>, Cancelled> {
    let PairContext { source, target, .. } = *context;
    let is_source_smaller = is_source_smaller(source, target, 1.0);
    let [data, model] = if is_source_smaller {
        [source, target]
    } else {
        [target, source]
    };
    let Some(of_smaller) = WideSearch::new(data, model) else {
        return Ok(Vec::new());
    };
    let mut found = search(&of_smaller, context.monitor)?;
    if !is_source_smaller {
        for pose in &mut found {
            *pose = pose.inverse();
        }
    }
    Ok(found)
}

/// Of these the poses that lie farther than `apart` from all known ones, which are more exact.
pub(super) fn poses_unlike(
    context: &PairContext<'_>,
    known: &[Similarity],
    apart: f64,
) -> Result<Vec<Similarity>, Cancelled> {
    let is_unlike = |pose: &&Similarity| {
        let mut known = known.iter();
        known.all(|known| context.displacement(pose, known) > apart)
    };
    Ok(poses(context)?.iter().filter(is_unlike).copied().collect())
}
