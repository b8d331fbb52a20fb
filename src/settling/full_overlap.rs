//! The pose under which the parts meet as a whole. A large smooth panel that springback has bent lies closer where
//! only a half of it lies on the other part, so that the pairs that a match keeps may take it far away from a first
//! pose that was right.

use rayon::prelude::*;

use super::border_choice::MUCH_MORE;
use super::candidate::{Candidate, FewPlaces, judged};
use super::chosen_pose::ChosenPose;
use super::context::PairContext;
use crate::assess::contact::{ContactSearch, FEW_NODES};
use crate::assess::evidence::EvidenceSearch;
use crate::assess::fit::Fit;
use crate::assess::shape::OVERHANGS;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::{Extent, MatchOutcome, same_pose};

/// Nodes of the smaller part that first poses are compared and moved on, before the best are moved on more.
const N_NODES: usize = 500;
/// First poses under which the parts lie closest as a whole, and no farther apart than surfaces are compared, that
/// are moved until all that meets lies closest.
const MOST_MOVED: usize = 12;
/// Of those so many, under which the parts lie closest as a whole, are judged.
const MOST_JUDGED: usize = 3;
/// Steps that a first pose is moved in at most.
const STEPS: usize = 12;
/// The last step was made if it moves the part by less than this share of what may remain of the distances.
const STILL: f64 = 0.02;
/// Poses that lie no more than so many times as far apart as springback may bend a part have been chosen from by their
/// borders and holes.
const ASIDE: f64 = 2.0;

/// The pose under which much more of the smaller part meets the other than under that of `outcome`, or as much where
/// the shapes differ under that one, or all of it with its outlines all round, while nothing but springback within the
/// tolerance keeps them apart. `None` where there is none, and where the parts meet as a whole without a difference.
/// O(first poses · nodes · log triangles).
pub fn placed_as_a_whole(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    let found = &outcome.target_from_source;
    if !outcome.rivals_sought || found.is_mirrored() || found.scale != 1.0 {
        return Ok(None);
    }
    let has_nothing_open = |result: &Candidate| result.met >= OVERHANGS && !result.differs();
    if has_nothing_open(&Candidate::at(*found, &context.shape(found))) {
        return Ok(None);
    }
    let distances = context.distances(1.0);
    let mut poses = moved_as_a_whole(context, outcome)?;
    let far = ASIDE * distances.tolerance.springback;
    poses.retain(|pose| context.displacement(pose, found) > far);
    let few = FewPlaces::new(context, 1.0);
    let moved = judged(context, found, &poses, |pose, shape| {
        few.candidate(pose, shape)
    })?;
    if has_nothing_open(&moved.result) {
        return Ok(None);
    }
    let is_better = |other: &Candidate, result: &Candidate| {
        let explains_more = other.met > MUCH_MORE * result.met
            || result.differs() && other.meets_as_much_as(result);
        let is_explained = result.lies_much_closer_elsewhere_than(other, distances.noise);
        let is_better = explains_more && !is_explained || other.fits_all_round_beside(result);
        other.is_one_shape && is_better
    };
    let by_gap = |a: &Candidate, b: &Candidate| a.apart().total_cmp(&b.apart());
    let best = ChosenPose::best_of(moved, outcome, context.source, is_better, by_gap);
    Ok(best)
}

/// The first poses of the match of the hand that it found, each once.
fn first_poses(outcome: &MatchOutcome, part: &Extent) -> Vec<Similarity> {
    let is_mirrored = outcome.target_from_source.is_mirrored();
    let starts = outcome.starts.iter();
    let mut firsts: Vec<Similarity> = Vec::new();
    for start in starts.filter(|start| start.mirrored == is_mirrored) {
        let is_known = |known: &Similarity| same_pose(known, &start.first, part);
        if !firsts.iter().any(is_known) {
            firsts.push(start.first);
        }
    }
    firsts
}

/// The first poses of the match, each moved until what meets of the smaller part lies closest; those under which the
/// parts lie closest as a whole come first.
fn moved_as_a_whole(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Vec<Similarity>, Cancelled> {
    let distances = context.distances(1.0);
    let near = distances.first_border_reach;
    let search = context.contacts(1.0, near, N_NODES);
    let part: Extent = context.source.measures().into();
    let firsts = first_poses(outcome, &part);
    let at_first = firsts.par_iter().map(|pose| {
        context.check()?;
        Ok((apart(&search, pose), *pose))
    });
    let mut at_first = at_first.collect::<Result<Vec<(f64, Similarity)>, Cancelled>>()?;
    at_first.retain(|(apart, _)| *apart <= distances.reach);
    let borders = context.borders(1.0, near);
    // Those that lie closest come first.
    let moved = |poses: &[Similarity], n_nodes: usize| -> Result<Vec<_>, Cancelled> {
        let contacts = context.contacts(1.0, distances.reach, n_nodes);
        let moved = poses.par_iter().map(|first| {
            context.check()?;
            let search = EvidenceSearch::new(contacts.clone(), &borders, &distances);
            let pose = held_by_holes(context, search, first, near)?;
            Ok((apart(&contacts, &pose), pose))
        });
        let mut moved = moved.collect::<Result<Vec<(f64, Similarity)>, Cancelled>>()?;
        moved.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(moved)
    };
    at_first.sort_by(|a, b| a.0.total_cmp(&b.0));
    at_first.truncate(MOST_MOVED);
    let firsts: Vec<Similarity> = at_first.into_iter().map(|(_, pose)| pose).collect();
    let mut distinct: Vec<Similarity> = Vec::new();
    for (apart, pose) in moved(&firsts, N_NODES)? {
        let is_known = distinct.iter().any(|known| same_pose(known, &pose, &part));
        if apart <= distances.tolerance.springback && !is_known {
            distinct.push(pose);
        }
    }
    distinct.truncate(MOST_JUDGED);
    let judged = moved(&distinct, FEW_NODES)?.into_iter();
    Ok(judged.map(|(_, pose)| pose).collect())
}

/// How far the parts lie apart as a whole: what does not meet counts as lying as far apart as is looked.
fn apart(search: &ContactSearch<'_>, pose: &Similarity) -> f64 {
    let reach = search.reach();
    let Some(contacts) = search.clone().at(pose) else {
        return reach;
    };
    let met = contacts.share.min(1.0);
    (met * contacts.typical_gap(reach).powi(2) + (1.0 - met) * reach * reach).sqrt()
}

/// The pose moved until the places that meet and the holes beside each other lie closest, but for bends and an offset.
/// It ends where a step would take the part farther than holes are looked for.
fn held_by_holes(
    context: &PairContext<'_>,
    mut search: EvidenceSearch<'_, '_>,
    first: &Similarity,
    farthest: f64,
) -> Result<Similarity, Cancelled> {
    let still = STILL * context.distances(1.0).tolerance.remainder;
    context.stepped(&mut search, first, STEPS, |evidence| {
        evidence.borders = evidence.borders.of_holes();
        let next = Fit::of(evidence).corrected(evidence);
        let is_near = context.displacement(&next, &evidence.pose) <= farthest;
        is_near.then_some((next, still))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh, Vector3};
    use crate::monitor::Monitor;
    use crate::registration::{
        MatchInput, MatchSettings, Method, StartRecord, Surface, match_surfaces,
    };
    use crate::settling::border_choice::tried_poses;
    use crate::settling::chosen_pose::as_likely;

    #[test]
    fn poses_of_the_other_hand_are_not_tried() {
        let points = [
            [0.0, 0.0, 0.0],
            [9.0, 0.0, 0.0],
            [0.0, 7.0, 1.0],
            [9.0, 8.0, 3.0],
        ];
        let mesh = TriMesh::new(
            points.map(Point3::from).to_vec(),
            vec![[0, 1, 3], [0, 3, 2]],
        );
        let part = Surface::new(&mesh.unwrap(), "source").unwrap();
        let settings = MatchSettings::of(Method::Umeyama);
        let input = MatchInput {
            source: &part,
            target: &part,
            reduced: None,
        };
        let mut outcome = match_surfaces(&input, &settings, &Monitor::silent()).unwrap();
        let moved = Similarity {
            translation: Vector3::new(50.0, 0.0, 0.0),
            ..Similarity::identity()
        };
        let own = outcome.starts[0].clone();
        for (pose, mirrored) in [(moved, false), (Similarity::mirror_x(), true)] {
            outcome.starts.push(StartRecord {
                first: pose,
                last: pose,
                mirrored,
                ..own.clone()
            });
            outcome.alternatives.push(as_likely(pose, &outcome));
        }
        let extent = part.measures().into();
        let firsts = first_poses(&outcome, &extent);
        assert_eq!(firsts.len(), 2);
        let tried = tried_poses(&outcome);
        assert_eq!(tried.len(), 5);
        assert!(!firsts.iter().chain(&tried).any(Similarity::is_mirrored));
        outcome.target_from_source = Similarity::mirror_x();
        assert_eq!(first_poses(&outcome, &extent), [Similarity::mirror_x()]);
        assert_eq!(tried_poses(&outcome), [Similarity::mirror_x(); 3]);
    }
}
