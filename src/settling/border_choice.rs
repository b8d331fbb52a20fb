//! The choice between poses that surfaces do not distinguish: where a part can slide on the other, its borders and
//! holes determine where it belongs.

mod hand;
mod row;

use std::sync::Arc;

use rayon::prelude::*;

use super::chosen_pose::{ChosenPose, as_likely, at_least, distinct};
use super::context::PairContext;
use super::free_motion_search::poses_along;
use super::holes;
use super::refine_with_borders::{Least, Refinement};
use crate::assess::borders::{BorderComparison, Borders, HolePair, PairKind};
use crate::assess::contact::{FEW_NODES, MAX_NODES, Meeting};
use crate::assess::free_motion::{FreeMotion, FreeMotionKind, weak_motion, weakest_motion};
use crate::assess::shape::OVERHANGS;
use crate::assess::tolerance::{AS_CLOSE, Distances};
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::{Alternative, MatchOutcome, same_pose};

pub use hand::{OppositeHand, hand_by_borders};

/// Poses whose borders are compared at most.
const MOST_POSES: usize = 64;
/// Poses that the search along the free motion adds.
const MOST_SLID: usize = 8;
/// Nodes of the smaller part that hold a pose while it is moved to where its borders fit; the winner is moved on all
/// that are looked at.
const N_SETTLED: usize = 1000;
/// Of all these so many, with the best borders, are moved until they fit.
const MOST_SETTLED: usize = 8;
/// Where the borders of one pose lie together, those of others that lie apart by more than so many times as much,
/// and by more than this share of the distance within which borders are looked for, belong elsewhere: no step
/// brings them together.
const FAR_BEHIND: f64 = 10.0;
const NOT_BESIDE: f64 = 0.3;
/// Poses that lie nearer to each other than this share of it settle as one.
const ONE_SETTLED: f64 = 0.5;
/// Poses turned over or turned round, from which the search along the free motion begins as well.
const MOST_ROOTS: usize = 3;
/// Poses looked at for that.
const MOST_ROOTS_TRIED: usize = 8;
/// Alternatives that are reported, unless the match found more.
const MOST_ALTERNATIVES: usize = 5;
/// Turns between poses of one family: cosine of 10°.
const SAME_WAY: f64 = 0.985;
/// A border counts as lying where it belongs up to so many times what may remain and what facets make of it, the less
/// the farther it lies off.
const HELD_WITHIN: f64 = 2.0;
/// Another pose takes the place of the result if so much more of the borders lies where it belongs, as a
/// share of them.
const MORE_HELD: f64 = 0.005;
/// Where no holes hold a pose, up to this share of the borders lies where it belongs by chance.
const BY_CHANCE: f64 = 0.15;
/// So much less of the borders where they belong makes a pose count as twice as bad.
const TWICE_AS_BAD: f64 = 0.05;
/// Where less than this share of the result's own borders beside like ones lies where it belongs, the parts were
/// trimmed differently, …
const TRIMMED_ALIKE: f64 = 0.9;
/// … and a pose under which at least this share of all borders does is as likely by its outlines.
const HELD_BY_OTHERS: f64 = 0.4;
/// Distances of surfaces up to this share of the tolerance are negligible.
const NO_GAP: f64 = 0.1;
/// Borders of which so much lies where it belongs support a pose.
const SURELY_HELD: f64 = 0.9;
/// With less than this the borders contradict a pose.
const HARDLY_HELD: f64 = 0.5;
/// A hole so many times as far off is misplaced.
const MUCH_FARTHER: f64 = 2.0;
/// Poses that are not refined yet may lie so many times as far apart as springback explains.
const ROUGHLY: f64 = 2.0;
/// Its surfaces may lie apart by [`AS_CLOSE`] times as much and so many tolerances more.
const LITTLE_GAP: f64 = 0.25;
/// A pose that meets so many times as much of the part may lie as far apart as springback explains.
pub(super) const MUCH_MORE: f64 = 1.3;
/// It must meet this share of what the result meets.
const AS_MUCH: f64 = 0.9;
/// Shares of the part that meet the other are the same up to this much.
const SAME_MET: f64 = 0.005;
/// A pose with fewer holes and no more of anything else counts as at least so many times as bad.
const FEWER_HOLES: f64 = 1.5;

/// The pose of `outcome` or another one that the match tried, whichever has its borders and holes where
/// they belong, if the surfaces leave the pose free to slide. `None` where they do not, or where the parts have no
/// borders beside each other.
/// O(poses · border edges + nodes · log triangles).
pub fn held_by_borders(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    let found = &outcome.target_from_source;
    let Some(free) = motion_to_search(context, found) else {
        return Ok(None);
    };
    context.check()?;
    let comparison = PoseComparison::new(context, found.scale);
    let Some(result) = comparison.refined(found, Least::Facets)? else {
        return Ok(None);
    };
    let others = tried_poses(outcome);
    let roots = comparison.roots(&result, &others, &free);
    let mut poses = Vec::new();
    for (root, free) in &roots {
        poses.extend(poses_along(context, root, free, MOST_SLID)?);
    }
    poses.extend(&others);
    // A hole may be smaller than the search along the motion can tell.
    if outcome.rivals_sought && holes::can_place(context, found) {
        let apart = comparison.springback();
        poses.extend(holes::poses_unlike(context, &poses, apart)?);
    }
    let by_borders = comparison.by_borders(&poses)?;
    let refine = |pose: &Similarity| {
        context.check()?;
        if comparison.lies_on(pose, &result) {
            comparison.refined(pose, Least::Any)
        } else {
            Ok(None)
        }
    };
    let refined: Result<Vec<Option<Refined>>, Cancelled> =
        by_borders.par_iter().map(refine).collect();
    let refined: Vec<Refined> = refined?.into_iter().flatten().collect();
    // A bent part may have been laid where it hardly fits: what fits best says how close is close.
    let closest = refined
        .iter()
        .filter(|other| other.met >= AS_MUCH * result.met && other.gap < result.gap)
        .min_by(|a, b| a.gap.total_cmp(&b.gap));
    let closest = closest.copied().unwrap_or(result);
    let is_close = |pose: &Refined| pose.is_as_close_as(&closest, &comparison.distances);
    let close = |pose: &Refined| {
        if is_close(pose) {
            return Ok(Some(*pose));
        }
        Ok(comparison.closer(pose)?.filter(is_close))
    };
    let rivals: Result<Vec<Option<Refined>>, Cancelled> = refined.par_iter().map(close).collect();
    let rivals: Vec<Refined> = rivals?.into_iter().flatten().collect();
    let choice = comparison.choice(&result, &closest, &rivals);
    let winner = choice.unwrap_or(result);
    let exactly = Refinement::new(context, found.scale, MAX_NODES);
    let before = choice.map(|_| as_likely(*found, outcome));
    let mut alternatives = comparison.alternatives(&winner, before, &rivals, (outcome, &free));
    let by_holes = refined.iter().filter(|other| !is_close(other));
    alternatives.extend(comparison.with_most_holes(&winner, by_holes, outcome.winner));
    alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    // What was found along the free motion has not been fitted to the surfaces.
    let least = if choice.is_some() {
        Least::Any
    } else {
        Least::Facets
    };
    let pose = exactly.refined(&winner.pose, least)?;
    Ok(Some(ChosenPose {
        target_from_source: pose.unwrap_or(winner.pose),
        alternatives,
    }))
}

/// Poses that the match tried, of the hand that it found: whoever settles a pose leaves the hand as it is.
pub(super) fn tried_poses(outcome: &MatchOutcome) -> Vec<Similarity> {
    let is_mirrored = outcome.target_from_source.is_mirrored();
    let starts = outcome.starts.iter();
    let tried = starts.flat_map(|start| [start.first, start.last]);
    let alternatives = outcome.alternatives.iter();
    alternatives
        .map(|other| other.target_from_source)
        .chain(tried)
        .filter(|pose| pose.is_mirrored() == is_mirrored)
        .take(MOST_POSES)
        .collect()
}

/// The motion along which borders and holes are looked for: what the surfaces leave free, or hardly resist where the
/// holes show that the part lies aside.
fn motion_to_search(context: &PairContext<'_>, pose: &Similarity) -> Option<FreeMotion> {
    let PairContext { source, target, .. } = *context;
    let limit = context.distances(pose.scale).free_limit;
    let weak = weak_motion(source, target, pose, limit);
    if weak.is_some_and(|motion| motion.kind.is_searched()) || !holes_lie_aside(context, pose) {
        return weak;
    }
    weakest_motion(source, target, pose, limit).or(weak)
}

/// Whether the holes show that the part lies aside along itself: each part has some that the other lacks, or of those
/// that have a counterpart most do not lie on it.
fn holes_lie_aside(context: &PairContext<'_>, pose: &Similarity) -> bool {
    let distances = context.distances(pose.scale);
    let borders = context.borders(pose.scale, distances.first_border_reach);
    let borders = borders.at(pose);
    let limit = borders.limit(&distances.tolerance);
    let is_off = |pair: &&HolePair| pair.off.norm() > limit;
    let n_off = borders.holes.iter().filter(is_off).count();
    borders.missing.iter().all(|holes| !holes.is_empty())
        || n_off > 0 && 2 * n_off >= borders.holes.len()
}

/// A difference of shares beyond what is negligible: places along the borders differ, so that two poses of one
/// quality never hold quite the same share.
fn apart(difference: f64, negligible: f64) -> f64 {
    difference.signum() * (difference.abs() - negligible).max(0.0)
}

/// How much worse a pose is of whose borders so much less lies where it belongs.
fn ratio_by_borders(behind: f64) -> f64 {
    let behind = behind / TWICE_AS_BAD;
    if behind >= 0.0 {
        1.0 + behind
    } else {
        1.0 / (1.0 - behind)
    }
}

/// What poses of two parts are compared by.
struct PoseComparison<'c, 'a> {
    context: &'c PairContext<'a>,
    distances: Distances,
    /// Borders of both, looked for as far as under first poses.
    borders: Arc<BorderComparison<'a>>,
    /// The refinement of first poses, and of those that are nearly there.
    roughly: Refinement<'c, 'a>,
    finely: Refinement<'c, 'a>,
}

/// Shares of the smaller part's borders under a pose; [`Refined`] says of what.
struct BordersHeld {
    held: f64,
    alike: f64,
    grain: f64,
}

/// A pose that was refined, and how well it fits.
#[derive(Clone, Copy)]
struct Refined {
    pose: Similarity,
    /// Share of the smaller part's borders that lies where it belongs, less that of holes where the other
    /// part is solid.
    held: f64,
    /// Share of them that lies beside a border of the other part.
    paired: f64,
    /// Share of them that lies beside a like one: an outline beside an outline, a hole beside a hole.
    alike: f64,
    /// Share of the borders that one place of them stands for: `held` is no finer.
    grain: f64,
    /// Holes with a counterpart, and how far the one that lies farthest from it is off.
    n_holes: usize,
    worst_hole: f64,
    /// Holes where the other part is solid, as a share of the smaller part's borders.
    missing: f64,
    /// Share of the smaller part that meets the other.
    met: f64,
    /// How far the surfaces lie apart there, root mean square.
    gap: f64,
}

impl Refined {
    /// Share of the borders beside one of the other part that lies where it belongs.
    fn held_of_paired(&self) -> f64 {
        if self.paired > 0.0 {
            self.held / self.paired
        } else {
            0.0
        }
    }

    /// How much less of the borders lies where it belongs than under the winner. Where each part has a piece that the
    /// other lacks, borders beyond the other part are no evidence: shifting the parts by one hole of a row leaves more
    /// of them alone and is as likely.
    fn behind(&self, winner: &Self) -> f64 {
        if winner.met < OVERHANGS {
            winner.held_of_paired() - self.held_of_paired()
        } else {
            winner.held - self.held
        }
    }

    fn is_as_close_as(&self, other: &Self, distances: &Distances) -> bool {
        let springback = distances.tolerance.springback;
        let mut most = distances.as_close_as(LITTLE_GAP, other.gap);
        if self.met > MUCH_MORE * other.met {
            // A bent part lies closer where only a piece of it meets the other.
            most = most.max(springback);
        }
        if self.held >= SURELY_HELD && other.held < HARDLY_HELD {
            // A bent plate lies closer anywhere but where its holes belong.
            most = most.max(ROUGHLY * springback);
        }
        self.met >= AS_MUCH * other.met && self.gap <= most
    }

    /// Whether the outlines do not distinguish this pose from the winner: they lie apart in places under the winner
    /// too, where the parts were trimmed differently, enough of the borders hold this pose, and no hole lies much
    /// farther from its counterpart than under the winner.
    fn is_held_as_well(&self, winner: &Self, within: f64) -> bool {
        // Springback moves a hole, and not far.
        let moved = winner.worst_hole.min(MUCH_FARTHER * within);
        let farthest = within.max(winner.worst_hole).max(MUCH_FARTHER * moved);
        let has_its_holes = self.n_holes >= winner.n_holes
            && self.worst_hole <= farthest
            && self.missing <= winner.missing + self.grain;
        // Holes that were not pierced yet are no trim.
        let together = winner.held + winner.missing;
        let are_trimmed_alike = together >= TRIMMED_ALIKE * winner.alike;
        !are_trimmed_alike && self.held >= HELD_BY_OTHERS && has_its_holes
    }

    /// Whether a hole is misplaced that is not under the other pose, with no fewer of them: another trim moves
    /// outlines, and no hole.
    fn misplaces_holes_beside(&self, other: &Self, within: f64) -> bool {
        let lie_closer =
            other.worst_hole <= within || MUCH_FARTHER * other.worst_hole < self.worst_hole;
        other.n_holes >= self.n_holes && lie_closer && self.worst_hole > within
    }

    /// Whether more holes have their counterpart than under the other pose, at no cost: as much of the part
    /// meets the other, and no more holes lie where it is solid. Outlines do not count against that:
    /// pieces of them lie beside each other by chance, as a hole hardly ever does.
    fn has_more_holes_than(&self, other: &Self, within: f64) -> bool {
        self.n_holes > other.n_holes
            && self.worst_hole <= within
            && self.missing <= other.missing + self.grain
            && self.met >= other.met - SAME_MET
    }
}

impl<'c, 'a> PoseComparison<'c, 'a> {
    fn new(context: &'c PairContext<'a>, scale: f64) -> Self {
        let distances = context.distances(scale);
        Self {
            context,
            distances,
            borders: context.borders(scale, distances.first_border_reach),
            roughly: Refinement::of_first_poses(context, scale, N_SETTLED),
            finely: Refinement::new(context, scale, N_SETTLED),
        }
    }

    /// Distance within which borders are looked for.
    fn near(&self) -> f64 {
        self.distances.first_border_reach
    }

    /// Distance of surfaces that springback explains.
    fn springback(&self) -> f64 {
        self.distances.tolerance.springback
    }

    /// What may remain of the distance of borders.
    fn remainder(&self) -> f64 {
        self.distances.tolerance.remainder
    }

    /// A pose after its refinement, which moves it by at least so much.
    fn refined(&self, pose: &Similarity, least: Least) -> Result<Option<Refined>, Cancelled> {
        let pose = self.roughly.refined(pose, least)?.unwrap_or(*pose);
        let pose = self.finely.refined(&pose, least)?.unwrap_or(pose);
        Ok(self.measured(pose))
    }

    /// A pose whose surfaces lie apart, moved however little: ragged borders step aside by more than surfaces may
    /// lie apart.
    fn closer(&self, pose: &Refined) -> Result<Option<Refined>, Cancelled> {
        let closer = self.finely.refined(&pose.pose, Least::Any)?;
        Ok(closer.and_then(|pose| self.measured(pose)))
    }

    /// The rival that the borders support; `None` where they support the result, which may win only if its surfaces
    /// lie as close as under the closest pose.
    fn choice(&self, result: &Refined, closest: &Refined, rivals: &[Refined]) -> Option<Refined> {
        let is_close = result.is_as_close_as(closest, &self.distances);
        let beats = |a: &Refined, b: &Refined| a.has_more_holes_than(b, self.remainder());
        let is_better = |other: &Refined| {
            let misplaces_holes = other.misplaces_holes_beside(result, self.remainder());
            let more = result.held + result.grain.max(MORE_HELD);
            let is_chance = other.n_holes == 0 && other.held <= BY_CHANCE;
            // A piece can always be slid along a profile until one of its ends lies on an outline. Where it then covers
            // holes, and where it was none, the two contradict each other.
            let covers_holes = other.n_holes <= result.n_holes
                && other.missing > result.missing + result.grain
                && other.held < SURELY_HELD;
            let is_no_evidence = is_chance || covers_holes || misplaces_holes;
            let holds_more = other.held > more && !is_no_evidence && !beats(result, other);
            !is_close || holds_more || beats(other, result)
        };
        let better: Vec<&Refined> = rivals.iter().filter(|other| is_better(other)).collect();
        let is_beaten = |pose: &Refined, other: &Refined| {
            let places_holes = other.worst_hole <= self.remainder()
                && pose.misplaces_holes_beside(other, self.remainder())
                && other.missing <= pose.missing + pose.grain
                && other.met >= pose.met - SAME_MET
                && other.gap <= pose.gap + NO_GAP * self.remainder();
            beats(other, pose) || places_holes
        };
        let unbeaten = better
            .iter()
            .filter(|pose| !better.iter().any(|other| is_beaten(pose, other)));
        let best = unbeaten.max_by(|a, b| a.held.total_cmp(&b.held));
        best.map(|best| **best)
    }

    /// The poses whose borders lie beside each other, best first: of those that would settle as one the first.
    fn by_borders(&self, poses: &[Similarity]) -> Result<Vec<Similarity>, Cancelled> {
        let near = self.near();
        let apart = |pose: &Similarity| {
            self.context.check()?;
            Ok((self.borders.at(pose).apart(near), *pose))
        };
        let sorted: Result<Vec<(f64, Similarity)>, Cancelled> =
            poses.par_iter().map(apart).collect();
        let mut sorted = sorted?;
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let closest = sorted.first().map_or(0.0, |(apart, _)| *apart);
        let farthest = (FAR_BEHIND * closest).max(NOT_BESIDE * near);
        let mut kept: Vec<Similarity> = Vec::new();
        for (apart, pose) in sorted {
            let is_near =
                |other: &Similarity| self.context.displacement(&pose, other) < ONE_SETTLED * near;
            if kept.len() < MOST_SETTLED && apart <= farthest && !kept.iter().any(is_near) {
                kept.push(pose);
            }
        }
        Ok(kept)
    }

    /// How well a pose fits.
    fn measured(&self, pose: Similarity) -> Option<Refined> {
        let meeting = self.meeting(&pose)?;
        let borders = self.borders.at(&pose);
        let BordersHeld { held, alike, grain } = self.borders_held(&borders);
        Some(Refined {
            pose,
            held,
            paired: borders.share().min(1.0),
            alike,
            grain,
            n_holes: borders.holes.len(),
            worst_hole: borders.worst_hole(),
            missing: borders.missing_share(),
            met: meeting.share,
            gap: meeting.gap,
        })
    }

    /// Whether the surfaces of a pose that is not refined yet lie about as close as those of the result.
    fn lies_on(&self, pose: &Similarity, result: &Refined) -> bool {
        let Some(Meeting { share, gap }) = self.meeting(pose) else {
            return false;
        };
        // Springback and what is left to refine may hold them apart.
        let most = (AS_CLOSE * result.gap).max(ROUGHLY * self.springback());
        share >= AS_MUCH * result.met && gap <= most
    }

    /// How the parts meet under a pose; `None` where they do not.
    fn meeting(&self, pose: &Similarity) -> Option<Meeting> {
        let mut contacts = self.context.contacts(pose.scale, self.near(), FEW_NODES);
        Some(contacts.at(pose)?.meeting(self.remainder()))
    }

    /// The result and poses of other families whose surfaces lie as close: turned over, turned round, or on another
    /// copy of the part; each with the motion that is free from there.
    fn roots(
        &self,
        result: &Refined,
        others: &[Similarity],
        free: &FreeMotion,
    ) -> Vec<(Similarity, FreeMotion)> {
        let mut roots = vec![(result.pose, *free)];
        let mut n_tried = 0;
        let centroid = self.context.source.measures().centroid;
        for other in others {
            let is_known = |(root, free): &(Similarity, FreeMotion)| {
                let turn = other.rotation * root.rotation.transpose();
                match free.kind {
                    FreeMotionKind::Extruded => {
                        let way = other.apply(&centroid) - root.apply(&centroid);
                        let across = way.cross(&free.direction).norm();
                        0.5 * (turn.trace() - 1.0) > SAME_WAY && across < self.near()
                    }
                    _ => free.direction.dot(&(turn * free.direction)) > SAME_WAY,
                }
            };
            if roots.len() > MOST_ROOTS || n_tried == MOST_ROOTS_TRIED || roots.iter().any(is_known)
            {
                continue;
            }
            n_tried += 1;
            if self.lies_on(other, result) {
                // Axes and planes of the target stay where they are.
                roots.push((*other, *free));
            }
        }
        roots
    }

    /// What of the smaller part's borders lies within the tolerance of a like border of the other part, less for what
    /// lies farther from it; holes where the other part is solid count against the pose.
    fn borders_held(&self, borders: &Borders) -> BordersHeld {
        let within = HELD_WITHIN * (self.remainder() + borders.unremarkable());
        let (mut held, mut alike, mut paired, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
        for pair in borders.pairs() {
            largest = largest.max(pair.weight);
            let ratio = pair.gap / within;
            if pair.kind != PairKind::Mixed {
                held += pair.weight * (1.0 - ratio * ratio).max(0.0);
                alike += pair.weight;
            }
            paired += pair.weight;
        }
        let of_all = if paired > 0.0 {
            borders.share().min(1.0) / paired
        } else {
            0.0
        };
        BordersHeld {
            held: of_all * held - borders.missing_share(),
            alike: of_all * alike,
            grain: of_all * largest,
        }
    }

    /// Of poses whose surfaces lie farther apart than those of the winner the one under which the most holes have their
    /// counterpart, if more of them do: springback may lay a bent profile closer a piece along itself, and the shapes
    /// decide which pose is right.
    fn with_most_holes<'s>(
        &self,
        winner: &Refined,
        poses: impl Iterator<Item = &'s Refined>,
        start: usize,
    ) -> Option<Alternative> {
        let has_more = |pose: &&Refined| {
            pose.n_holes > winner.n_holes
                && pose.missing < winner.missing
                && pose.gap <= ROUGHLY * self.springback()
        };
        let most = poses.filter(has_more).max_by(|a, b| {
            let more = a.n_holes.cmp(&b.n_holes);
            more.then(a.held.total_cmp(&b.held))
        });
        most.map(|pose| Alternative {
            target_from_source: pose.pose,
            score_ratio: FEWER_HOLES,
            by_shape: true,
            start,
        })
    }

    /// The other poses, rated by their borders; `before` is the result where a rival takes its place.
    fn alternatives(
        &self,
        winner: &Refined,
        before: Option<Alternative>,
        rivals: &[Refined],
        (outcome, free): (&MatchOutcome, &FreeMotion),
    ) -> Vec<Alternative> {
        let is_held_across = self.is_held_across(winner, free);
        let part = self.context.source.measures().into();
        let is_other =
            |other: &Alternative| !same_pose(&other.target_from_source, &winner.pose, &part);
        let with_borders = |other: &Alternative| {
            let Some(pose) = self.measured(other.target_from_source) else {
                return *other;
            };
            let grain = pose.grain.max(winner.grain);
            let is_next_in_row = !is_held_across && self.holds_as_many_holes(&pose, winner);
            let by_borders = if is_next_in_row || pose.is_held_as_well(winner, self.remainder()) {
                1.0
            } else {
                ratio_by_borders(apart(pose.behind(winner), grain))
            };
            let by_holes = if winner.has_more_holes_than(&pose, self.remainder()) {
                FEWER_HOLES
            } else {
                0.0
            };
            at_least(*other, f64::max(by_borders, by_holes))
        };
        let little = NO_GAP * self.remainder();
        let slid = rivals.iter().map(|rival| Alternative {
            score_ratio: ((rival.gap + little) / (winner.gap + little)).max(1.0),
            ..as_likely(rival.pose, outcome)
        });
        let known = outcome.alternatives.iter().copied();
        let others = known.chain(before).chain(slid).filter(is_other);
        let others = others.map(|other| with_borders(&other));
        let mut distinct = distinct(others, self.context.source);
        distinct.truncate(MOST_ALTERNATIVES.max(outcome.alternatives.len()));
        distinct
    }
}

#[cfg(test)]
mod tests;
