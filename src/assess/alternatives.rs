//! The choice between poses by the shapes under each of them. Facets and springback raise all scores, so that a
//! part with waves, turned by half a turn, may score only a few percent worse; that a hole, a bead or a border
//! then lies elsewhere shows all the same.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::candidate::{
    AS_CLOSE, Candidate, FewPlaces, LEAST_SHARED, LITTLE_LESS, is_much_closer, judged,
};
use super::contact::MAX_NODES;
use super::held::{HeldPose, distinct, free_limit};
use super::holes;
use super::settle::{Least, Settling};
use super::shape::OVERHANGS;
use super::sliding::weak_motion;
use super::statements::statements;
use super::tolerance::{AssessSettings, Distances, is_source_smaller};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Alternative, Extent, MatchOutcome, Surface, is_piece, same_pose};

/// A pose with more differences of the shapes counts as at least so many times as bad as the result.
const MORE_DIFFERENCES: f64 = 1.5;
/// Alternatives that score up to so many times as bad are looked at where they settle: they are refined no further
/// than it takes to see that they are behind, and noise, offsets and springback may leave two poses that fit alike so
/// far apart.
const WORTH_SETTLING: f64 = 3.0;
/// Borders may hold a pose under which what remains of the distances besides a bend is [`AS_CLOSE`] times as much and so
/// many tolerances more.
const LITTLE_REMAINDER: f64 = 0.25;

/// The pose of `outcome` or one of its alternatives that scores nearly as well, whichever has the fewest differences
/// between the shapes, or one under which a piece of each part lies on the other while the result lies much farther
/// apart. Alternatives with more differences than the pose chosen score worse; where each part has a piece that the
/// other lacks, those that fit as well with less overlap score as well. `None` where no other pose is looked at.
/// O(alternatives · (border edges + nodes · log triangles)).
pub fn chosen_by_shape(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<HeldPose>, Cancelled> {
    let found = &outcome.target_from_source;
    let pair = [source, target];
    let distances = Distances::of(source, target, found.scale, settings);
    let few = FewPlaces::new(pair, found.scale, &distances);
    let (met, apart) = few.met_and_apart(found);
    let overhangs = met < OVERHANGS;
    let lies_closer = |other: &Alternative| {
        let (met, own) = few.met_and_apart(&other.target_from_source);
        met >= LEAST_SHARED && is_much_closer(met, own, apart, distances.noise)
    };
    let is_near = |other: &&Alternative| {
        let scores_near = overhangs || other.score_ratio < WORTH_SETTLING;
        scores_near || apart > distances.noise && lies_closer(other)
    };
    let alternatives = outcome.alternatives.iter();
    let (near, far): (Vec<&Alternative>, Vec<&Alternative>) = alternatives.partition(is_near);
    if near.is_empty() {
        return Ok(None);
    }
    let settling = Settling::new(pair, found.scale, settings, MAX_NODES);
    let settle = |other: &&Alternative| {
        monitor.check()?;
        let pose = other.target_from_source;
        Ok(settling.closest(&pose).unwrap_or(pose))
    };
    let settled: Result<Vec<Similarity>, Cancelled> = near.par_iter().map(settle).collect();
    let poses: Vec<Similarity> = [*found].into_iter().chain(settled?).collect();
    let mut candidates = judged(pair, &poses, settings, |pose, shape| {
        few.candidate(pose, shape, overhangs)
    });
    monitor.check()?;
    let result = candidates.remove(0);
    // Of candidates with as many differences the first one scores best.
    let better = candidates.iter().filter(|other| other.beats(&result));
    let better = better.min_by_key(|other| other.n_differences);
    let closer = || {
        candidates
            .iter()
            .find(|other| other.lies_exactly_elsewhere_unlike(&result, distances.noise))
    };
    let winner = better.or_else(closer).unwrap_or(&result);
    // Where surfaces leave the pose free, borders and holes have compared all poses, unless outlines are no evidence.
    let limit = free_limit(source, target, found.scale, settings);
    let surfaces_hold = weak_motion(source, target, &winner.pose, limit).is_none();
    let beside = Beside {
        winner,
        distances,
        part: source.measures().into(),
        overhangs,
        borders_chose: !surfaces_hold && !winner.outlines_are_no_evidence,
    };
    let before = Alternative {
        target_from_source: *found,
        score_ratio: 1.0,
        start: outcome.winner,
    };
    let near = near.into_iter().zip(&candidates);
    let mut alternatives: Vec<Alternative> = near
        .map(|(other, candidate)| beside.rated(*other, candidate))
        .chain(far.into_iter().copied())
        .chain([ranked(before, winner.beats(&result))])
        .filter(|other| !beside.is_winner(&other.target_from_source))
        .collect();
    alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    Ok(Some(HeldPose {
        target_from_source: winner.pose,
        alternatives: distinct(&alternatives, source),
    }))
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

    /// An alternative with what the shapes say of it where it settles.
    fn rated(&self, other: Alternative, candidate: &Candidate) -> Alternative {
        let (winner, noise) = (self.winner, self.distances.noise);
        if winner.beats(candidate) {
            return ranked(other, true);
        }
        let fits_elsewhere = self.overhangs
            && candidate.fits_elsewhere_as_well_as(winner, &self.distances)
            || candidate.lies_much_closer_elsewhere_than(winner, noise);
        let ratio = if fits_elsewhere {
            Some(1.0)
        } else {
            let ratio = candidate.ratio_to(winner, noise);
            ratio.filter(|_| !self.borders_chose)
        };
        // One that settles at the winner's pose is no other.
        let is_other = !self.is_winner(&candidate.pose);
        match ratio.filter(|ratio| is_other && *ratio < other.score_ratio) {
            Some(score_ratio) => Alternative {
                target_from_source: candidate.pose,
                score_ratio,
                ..other
            },
            None => other,
        }
    }
}

/// The pose under which holes lie on like ones of the other part, where those of the pose of `outcome` do not: of a piece
/// where the shapes differ and do not, or surely less, under that one, since a piece may slide along a strip with hardly
/// any gain or loss of its surfaces; of any part where a hole has no counterpart and more have one under that pose, since
/// a regular pattern may be shifted. `None` where rivals were not to be looked for, and where there is no such pose.
/// O(poses · (border edges + nodes · log triangles)).
pub fn placed_by_holes(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<HeldPose>, Cancelled> {
    let found = &outcome.target_from_source;
    if !outcome.rivals_sought || !holes::can_place(source, target, found) {
        return Ok(None);
    }
    let is_piece = if is_source_smaller(source, target, 1.0) {
        is_piece(source, target)
    } else {
        is_piece(target, source)
    };
    let is_open = |result: &Candidate| is_piece && result.differs() || result.n_alone > 0;
    let shape = statements(source, target, found, settings).shape;
    if !is_open(&Candidate::at(*found, &shape, None)) {
        return Ok(None);
    }
    let settling = Settling::new([source, target], 1.0, settings, MAX_NODES);
    let settle = |pose: &Similarity| {
        monitor.check()?;
        Ok(settling.settled(pose, Least::Any).unwrap_or(*pose))
    };
    let on_holes = holes::poses(source, target, monitor)?;
    let settled: Result<Vec<Similarity>, Cancelled> = on_holes.par_iter().map(settle).collect();
    let poses: Vec<Similarity> = [*found].into_iter().chain(settled?).collect();
    let mut better = judged([source, target], &poses, settings, |pose, shape| {
        Candidate::at(pose, shape, None)
    });
    monitor.check()?;
    let result = better.remove(0);
    better.retain(|other| {
        let differs_less = is_piece && result.differs() && !other.differs();
        (differs_less || other.beats(&result)) && other.met >= result.met - LITTLE_LESS
    });
    better.sort_by_key(|other| (other.n_differences, Reverse(other.n_holes)));
    Ok(better.split_first().map(|(winner, others)| HeldPose {
        target_from_source: winner.pose,
        alternatives: behind(winner, others, outcome, source),
    }))
}

/// The other poses beside one that took the place of the result: those that were found with it, the result before, and its
/// alternatives. Only one under which the shapes differ no more is as likely.
pub(super) fn behind(
    winner: &Candidate,
    found_too: &[Candidate],
    outcome: &MatchOutcome,
    source: &Surface,
) -> Vec<Alternative> {
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
    distinct(&all, source)
}

/// What speaks against a pose that borders and holes speak for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulledAside {
    /// It is worse than the one that the surfaces found.
    Worse,
    /// It is as likely: more of the parts meets, and their surfaces lie much farther apart.
    Rival,
}

/// What speaks against a pose that borders and holes speak for, beside the one that the surfaces found: that one has
/// surely fewer differences, or, where `surfaces_hold` says that they leave nothing free, what remains besides a bend has
/// clearly grown, or a piece of the parts lies on each other where all of them lies apart. Springback keeps surfaces farther
/// apart than either pose, so that their distance alone does not tell: an addendum all round that ends anywhere may pull a
/// hood aside by 30 mm. `None` where nothing does; poses that lie within the tolerance of each other are as good.
/// O(border edges + nodes · log triangles).
pub fn pulled_aside(
    source: &Surface,
    target: &Surface,
    [by_surfaces, by_borders]: [&Similarity; 2],
    surfaces_hold: bool,
    settings: &AssessSettings,
) -> Option<PulledAside> {
    let distances = Distances::of(source, target, by_surfaces.scale, settings);
    let tolerance = distances.tolerance;
    let corners = source.mesh().aabb().corners();
    if by_surfaces.max_displacement(by_borders, &corners) <= tolerance.remainder {
        return None;
    }
    let pair = [source, target];
    let few = FewPlaces::new(pair, by_surfaces.scale, &distances);
    let poses = [*by_surfaces, *by_borders];
    let both = judged(pair, &poses, settings, |pose, shape| {
        few.candidate(pose, shape, false)
    });
    let [before, after] = &both[..] else {
        return None;
    };
    let little = LITTLE_REMAINDER * tolerance.remainder;
    let [before_left, after_left] = [before, after].map(|candidate| candidate.apart[1]);
    let has_grown = surfaces_hold && after_left > AS_CLOSE * before_left + little;
    if before.beats(after) || has_grown && before.n_differences <= after.n_differences {
        return Some(PulledAside::Worse);
    }
    let lies_closer = before.lies_much_closer_elsewhere_than(after, distances.noise);
    lies_closer.then_some(PulledAside::Rival)
}

fn ranked(other: Alternative, is_beaten: bool) -> Alternative {
    let least = if is_beaten { MORE_DIFFERENCES } else { 0.0 };
    Alternative {
        score_ratio: other.score_ratio.max(least),
        ..other
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh, Vector3};

    #[test]
    fn a_pose_under_which_the_shapes_fit_less_well_is_not_taken_for_its_borders() {
        // A shallow bowl of 300 mm: neither springback nor a small motion explains a shift of it by 30 mm, and half
        // a millimetre does not matter.
        let n = 31;
        let points = (0..n * n).map(|i| {
            let [x, y] = [i % n, i / n].map(|k| 10.0 * f64::from(k) - 150.0);
            let waves = 6.0 * (x / 30.0).sin() * (y / 35.0).cos();
            Point3::new(x, y, (x * x + 0.5 * y * y) / 600.0 + waves)
        });
        let cells = (0..n * (n - 1)).filter(|i| i % n + 1 < n);
        let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        let bowl = Surface::new(&mesh, "source").unwrap();
        let shifted = |x: f64| Similarity {
            translation: Vector3::new(x, 0.0, 0.0),
            ..Similarity::identity()
        };
        let settings = AssessSettings::default();
        for (by_surfaces, by_borders, is_worse) in
            [(0.0, 30.0, true), (30.0, 0.0, false), (0.0, 0.5, false)]
        {
            let poses = [&shifted(by_surfaces), &shifted(by_borders)];
            let found = pulled_aside(&bowl, &bowl, poses, true, &settings);
            let expected = is_worse.then_some(PulledAside::Worse);
            assert_eq!(found, expected, "{by_surfaces} {by_borders}");
        }
    }
}
