//! The choice between poses by the shapes under each of them. Facets and springback raise all scores, so that a
//! part with waves, turned by half a turn, may score only a few percent worse; that a hole, a bead or a border
//! then lies elsewhere shows all the same.

use rayon::prelude::*;

use super::borders::HOLES_THAT_HOLD;
use super::contact::{ContactSearch, FEW_NODES, MAX_NODES};
use super::held::{HeldPose, distinct, free_limit};
use super::settle::{Least, Settling};
use super::shape::{ELSEWHERE, OVERHANGS, ShapeReason, ShapeStatement};
use super::sliding::weak_motion;
use super::statements::statements;
use super::tolerance::{AssessSettings, Distances, UNREMARKABLE, is_source_smaller};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Alternative, MatchOutcome, Surface, WideSearch, is_piece, same_pose};

/// A pose with more differences of the shapes counts as at least so many times as bad as the result.
const MORE_DIFFERENCES: f64 = 1.5;
/// Alternatives that score up to so many times as bad are looked at where they settle: they are refined no further
/// than it takes to see that they are behind, and noise, offsets and springback may leave two poses that fit alike so
/// far apart.
const WORTH_SETTLING: f64 = 3.0;
/// Where so much less of the smaller part meets the other, a pose that fits as closely does not fit as well.
pub(super) const LITTLE_LESS: f64 = 0.02;
/// Borders may hold a pose under which what remains of the distances besides a bend is so many times as much, …
const AS_CLOSE: f64 = 1.5;
/// … and so many tolerances more.
const LITTLE_REMAINDER: f64 = 0.25;
/// Where each part has a piece that the other lacks, a pose under which at least this share of the smaller part meets
/// the other is as likely as one under which more does.
const LEAST_SHARED: f64 = 0.5;
/// Lengths of so many tolerances are differences whatever the facets are and however the part is bent.
const CLEARLY: f64 = 2.0;

/// The pose of `outcome` or one of its alternatives that scores nearly as well, whichever has the fewest differences
/// between the shapes. Alternatives with more of them than the pose chosen score worse; where each part has a piece
/// that the other lacks, those that fit as well with less overlap score as well. `None` where no other pose is looked
/// at. O(alternatives · (border edges + nodes · log triangles)).
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
    let few = ContactSearch::new(pair, found.scale, distances.reach, FEW_NODES);
    let met = few.clone().at(found).map_or(0.0, |contacts| contacts.share);
    let overhangs = met < OVERHANGS;
    let is_near = |other: &&Alternative| overhangs || other.score_ratio < WORTH_SETTLING;
    let near: Vec<&Alternative> = outcome.alternatives.iter().filter(is_near).collect();
    if near.is_empty() {
        return Ok(None);
    }
    let settling = Settling::new(pair, found.scale, settings, MAX_NODES);
    let at = |pose: Similarity| {
        let shape = statements(source, target, &pose, settings).shape;
        let elsewhere = overhangs.then(|| 1.0 - shape.met - few.overhang(&pose));
        Candidate::at(pose, &shape, elsewhere)
    };
    let result = at(*found);
    let candidate = |other: &&Alternative| {
        monitor.check()?;
        let pose = other.target_from_source;
        Ok(at(settling.closest(&pose).unwrap_or(pose)))
    };
    let candidates: Result<Vec<Candidate>, Cancelled> = near.par_iter().map(candidate).collect();
    let candidates = candidates?;
    // Of candidates with as many differences the first one scores best.
    let better = candidates.iter().filter(|other| other.beats(&result));
    let better = better.min_by_key(|other| other.n_differences);
    let winner = better.unwrap_or(&result);
    let before = better.map(|_| Alternative {
        target_from_source: *found,
        score_ratio: 1.0,
        start: outcome.winner,
    });
    let part = source.measures().into();
    // Where surfaces leave the pose free, borders and holes have compared all poses, unless outlines are no evidence.
    let limit = free_limit(source, target, found.scale, settings);
    let surfaces_hold = weak_motion(source, target, &winner.pose, limit).is_none();
    let with_shape = |(k, other): (usize, &Alternative)| {
        let Some(candidate) = candidates.get(k) else {
            return *other;
        };
        if winner.beats(candidate) {
            return ranked(*other, true);
        }
        let ratio = if candidate.fits_elsewhere_as_well_as(winner, &distances) {
            Some(1.0)
        } else {
            let ratio = candidate.ratio_to(winner, distances.noise);
            ratio.filter(|_| surfaces_hold || winner.outlines_are_no_evidence)
        };
        // One that settles at the winner's pose is no other.
        let is_other = !same_pose(&candidate.pose, &winner.pose, &part);
        match ratio.filter(|ratio| is_other && *ratio < other.score_ratio) {
            Some(score_ratio) => Alternative {
                target_from_source: candidate.pose,
                score_ratio,
                ..*other
            },
            None => *other,
        }
    };
    // The alternatives come sorted by score, so that those looked at are the first.
    let others = outcome.alternatives.iter().enumerate().map(with_shape);
    let mut alternatives: Vec<Alternative> = others
        .chain(before.map(|before| ranked(before, true)))
        .filter(|other| !same_pose(&other.target_from_source, &winner.pose, &part))
        .collect();
    alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    Ok(Some(HeldPose {
        target_from_source: winner.pose,
        alternatives: distinct(&alternatives, source),
    }))
}

/// The pose under which holes of a piece lie on like ones of the other part, where the shapes differ under the pose of
/// `outcome` and do not, or surely less, under that one: a piece may slide along a strip with hardly any gain or loss of
/// its surfaces. `None` where rivals were not to be looked for, where the shapes do not differ, or where they differ as
/// much under every such pose. O(poses · (border edges + nodes · log triangles)).
pub fn placed_by_holes(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<HeldPose>, Cancelled> {
    let found = &outcome.target_from_source;
    let is_source_smaller = is_source_smaller(source, target, 1.0);
    let [data, model] = if is_source_smaller {
        [source, target]
    } else {
        [target, source]
    };
    let has_holes = |part: &Surface| part.borders().iter().any(|border| border.is_hole);
    let is_rigid = !found.is_mirrored() && found.scale == 1.0;
    let is_asked = outcome.rivals_sought && is_rigid && is_piece(data, model);
    if !(is_asked && has_holes(data) && has_holes(model)) {
        return Ok(None);
    }
    let shape = |pose: &Similarity| statements(source, target, pose, settings).shape;
    let result = Candidate::at(*found, &shape(found), None);
    let search = (result.n_differences > 0).then(|| WideSearch::new(data, model));
    let Some(search) = search.flatten() else {
        return Ok(None);
    };
    let settling = Settling::new([source, target], 1.0, settings, MAX_NODES);
    let candidate = |model_from_data: &Similarity| {
        monitor.check()?;
        let pose = if is_source_smaller {
            *model_from_data
        } else {
            model_from_data.inverse()
        };
        let pose = settling.settled(&pose, Least::Any).unwrap_or(pose);
        Ok(Candidate::at(pose, &shape(&pose), None))
    };
    let poses = search.on_holes(monitor)?;
    let candidates: Result<Vec<Candidate>, Cancelled> = poses.par_iter().map(candidate).collect();
    let mut better = candidates?;
    better.retain(|other| {
        let differs_less = other.n_differences == 0 || other.beats(&result);
        differs_less && other.met >= result.met - LITTLE_LESS
    });
    better.sort_by_key(|other| other.n_differences);
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
        let is_beaten = other.n_differences > winner.n_differences;
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

/// Whether a pose that borders and holes speak for is worse than the one that the surfaces found: that one has surely
/// fewer differences, or, where `surfaces_hold` says that they leave nothing free, what remains besides a bend has
/// clearly grown. Springback keeps surfaces farther apart than either pose, so that their distance alone does not tell:
/// an addendum all round that ends anywhere may pull a hood aside by 30 mm. Poses that lie within the
/// tolerance of each other are as good. O(border edges + nodes · log triangles).
pub fn is_pulled_aside(
    source: &Surface,
    target: &Surface,
    [by_surfaces, by_borders]: [&Similarity; 2],
    surfaces_hold: bool,
    settings: &AssessSettings,
) -> bool {
    let tolerance = Distances::of(source, target, by_surfaces.scale, settings).tolerance;
    let corners = source.mesh().aabb().corners();
    if by_surfaces.max_displacement(by_borders, &corners) <= tolerance.remainder {
        return false;
    }
    let shape = |pose: &Similarity| statements(source, target, pose, settings).shape;
    let (before, after) = rayon::join(|| shape(by_surfaces), || shape(by_borders));
    let little = LITTLE_REMAINDER * tolerance.remainder;
    let has_grown = surfaces_hold && after.remainder > AS_CLOSE * before.remainder + little;
    let before = Candidate::at(*by_surfaces, &before, None);
    let after = Candidate::at(*by_borders, &after, None);
    before.beats(&after) || has_grown && before.n_differences <= after.n_differences
}

fn ranked(other: Alternative, is_beaten: bool) -> Alternative {
    let least = if is_beaten { MORE_DIFFERENCES } else { 0.0 };
    Alternative {
        score_ratio: other.score_ratio.max(least),
        ..other
    }
}

/// A pose and what speaks against one shape under it. A bend does so under every pose.
pub(super) struct Candidate {
    pub(super) pose: Similarity,
    pub(super) n_differences: usize,
    /// Of these the ones that nothing but another place explains.
    n_clear: usize,
    /// Holes with a counterpart, and those where the other part is solid.
    n_holes: usize,
    n_alone: usize,
    /// Whether outlines say nothing of the pose: one part is trimmed farther out, or few of them lie beside others.
    outlines_are_no_evidence: bool,
    /// Share of the smaller part that meets the other, and, where each has a piece that the other lacks, the share that
    /// lies neither on the other part nor beyond its borders.
    pub(super) met: f64,
    elsewhere: Option<f64>,
    /// How far the surfaces lie apart by a bend and besides it.
    apart: [f64; 2],
    /// How far outlines and holes lie apart, where there are enough of both, …
    off: Option<[f64; 2]>,
    /// … and what is accepted of them.
    limit: f64,
}

impl Candidate {
    pub(super) fn at(pose: Similarity, shape: &ShapeStatement, elsewhere: Option<f64>) -> Self {
        let differences = shape.reasons.iter().filter_map(is_clear);
        let (n_differences, n_clear) =
            differences.fold((0, 0), |(n, clear), is| (n + 1, clear + usize::from(is)));
        let borders = &shape.borders;
        Self {
            pose,
            n_differences,
            n_clear,
            n_holes: borders.n_holes,
            n_alone: borders.only_source + borders.only_target,
            outlines_are_no_evidence: borders.other_trim.is_some() || borders.offset.is_none(),
            met: shape.met,
            elsewhere,
            apart: [shape.springback, shape.remainder],
            off: (borders.offset)
                .filter(|_| borders.n_holes >= HOLES_THAT_HOLD)
                .map(|offset| [offset, borders.worst_hole]),
            limit: shape.tolerance.remainder,
        }
    }

    /// Whether the parts, each of which has a piece that the other lacks, share enough under this pose too, and what
    /// they share is as much alike. That more overlaps under one of two such poses says nothing: a row of like features
    /// may be shifted by one of them.
    fn fits_elsewhere_as_well_as(&self, other: &Self, distances: &Distances) -> bool {
        let is_trimmed_off = self.elsewhere.is_some_and(|share| share < ELSEWHERE);
        let mut pairs = self.apart.iter().zip(&other.apart);
        let most = |apart: f64| AS_CLOSE * apart + distances.little_more(UNREMARKABLE, apart);
        is_trimmed_off
            && self.met >= LEAST_SHARED
            && self.n_differences <= other.n_differences
            && self.n_alone <= other.n_alone
            && pairs.all(|(own, other)| *own <= most(*other))
    }

    /// How far the surfaces lie apart under this pose over how far they do under another, at least 1; `None` where
    /// less meets or more differs. `noise` is what facets leave.
    fn ratio_to(&self, other: &Self, noise: f64) -> Option<f64> {
        let fits_as_much = self.met >= other.met - LITTLE_LESS
            && self.n_differences <= other.n_differences
            && self.n_alone <= other.n_alone
            && self.n_holes >= other.n_holes;
        let apart = |of: &Self| of.apart() + noise;
        fits_as_much.then(|| (apart(self) / apart(other)).max(1.0))
    }

    /// How far the surfaces lie apart in all.
    pub(super) fn apart(&self) -> f64 {
        self.apart[0].hypot(self.apart[1])
    }

    /// Whether the shapes surely differ less under this pose: there are fewer differences, or as many while holes
    /// that lie alone under the other pose have their counterpart, or none while both outlines and holes lie closer.
    fn beats(&self, other: &Self) -> bool {
        let pairs_holes = self.n_holes > other.n_holes && self.n_alone < other.n_alone;
        self.n_differences < other.n_clear
            || pairs_holes && self.n_differences <= other.n_differences
            || self.n_differences == 0 && other.n_differences > 0 && self.lies_closer_than(other)
    }

    /// Whether both outlines and holes lie closer under this pose by more than is accepted, and no fewer holes have
    /// their counterpart. Either alone may be the mark of another version.
    fn lies_closer_than(&self, other: &Self) -> bool {
        let (Some(own), Some(others)) = (self.off, other.off) else {
            return false;
        };
        let mut pairs = own.iter().zip(&others);
        self.n_holes >= other.n_holes && pairs.all(|(own, other)| other - own > self.limit)
    }
}

/// Whether a difference is beyond doubt; `None` for a bend.
fn is_clear(reason: &ShapeReason) -> Option<bool> {
    match reason {
        ShapeReason::Bent { .. } => None,
        ShapeReason::Surface { by, limit, .. }
        | ShapeReason::Local { by, limit, .. }
        | ShapeReason::Borders { by, limit, .. }
        | ShapeReason::Hole { by, limit, .. } => Some(*by > CLEARLY * limit),
        ShapeReason::Holes { .. } => Some(true),
        ShapeReason::HardlyMet { .. } | ShapeReason::Stretched { .. } => Some(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::ShapeTolerance;
    use crate::geometry::{Point3, TriMesh, Vector3};

    fn candidate(reasons: &[ShapeReason]) -> Candidate {
        let tolerance = ShapeTolerance {
            remainder: 1.0,
            springback: 5.0,
        };
        let shape = ShapeStatement {
            reasons: reasons.to_vec(),
            ..ShapeStatement::nothing_met(tolerance)
        };
        Candidate::at(Similarity::identity(), &shape, None)
    }

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
            let found = is_pulled_aside(&bowl, &bowl, poses, true, &settings);
            assert_eq!(found, is_worse, "{by_surfaces} {by_borders}");
        }
    }

    #[test]
    fn only_a_difference_beyond_doubt_speaks_against_a_pose() {
        let at = Point3::origin();
        let limit = 1.0;
        let bend = ShapeReason::Bent { by: 9.0, limit };
        let [is_end, is_mean] = [false; 2];
        let hole = |by| ShapeReason::Hole {
            by,
            limit,
            at,
            is_mean,
        };
        let bead = |by| ShapeReason::Local {
            by,
            limit,
            at,
            is_end,
        };
        let holes = ShapeReason::Holes {
            only_source: 1,
            only_target: 1,
            at,
        };
        let hardly = ShapeReason::HardlyMet { share: 0.49 };
        for (fewer, more, beats) in [
            (vec![], vec![hole(2.1)], true),
            (vec![], vec![hole(1.9)], false),
            (vec![], vec![bead(3.0)], true),
            (vec![], vec![holes], true),
            (vec![], vec![bend], false),
            (vec![], vec![hardly], false),
            (vec![bend], vec![bend, holes], true),
            // Another version has its difference under either pose.
            (vec![hole(3.0)], vec![hole(8.0)], false),
            (vec![hole(1.1)], vec![hole(8.0), bead(3.0)], true),
            (vec![hole(1.1)], vec![hole(1.2), bead(3.0)], false),
        ] {
            let (fewer, more) = (candidate(&fewer), candidate(&more));
            assert_eq!(fewer.beats(&more), beats);
            assert!(!more.beats(&fewer));
        }
    }

    #[test]
    fn a_pose_under_which_both_outlines_and_holes_lie_aside_is_beaten() {
        let hole = ShapeReason::Hole {
            by: 1.8,
            limit: 1.0,
            at: Point3::origin(),
            is_mean: true,
        };
        let at = |off, reasons: &[ShapeReason]| Candidate {
            n_holes: 24,
            off: Some(off),
            ..candidate(reasons)
        };
        let right = at([0.6, 0.4], &[]);
        assert!(right.beats(&at([3.2, 2.4], &[hole])));
        // The outlines alone, or the holes alone, or what nobody remarks.
        assert!(!right.beats(&at([3.2, 1.2], &[hole])));
        assert!(!right.beats(&at([0.9, 2.4], &[hole])));
        assert!(!right.beats(&at([3.2, 2.4], &[])));
        assert!(!at([0.6, 0.4], &[hole]).beats(&at([3.2, 2.4], &[hole])));
    }

    #[test]
    fn a_pose_that_settles_as_close_is_as_likely_whatever_it_scored_on_the_way() {
        let at = |springback, remainder, met| Candidate {
            met,
            apart: [springback, remainder],
            ..candidate(&[])
        };
        let best = at(0.1, 0.3, 0.97);
        let near = |other: &Candidate| other.ratio_to(&best, 0.02);
        assert!(near(&at(0.0, 0.32, 0.97)).unwrap() < 1.05);
        assert_eq!(near(&at(0.0, 0.1, 0.97)), Some(1.0));
        assert!(near(&at(0.1, 0.6, 0.97)).unwrap() > 1.5);
        // What meets less does not fit as well, nor what misses a hole.
        assert_eq!(near(&at(0.1, 0.3, 0.9)), None);
        let alone = Candidate {
            n_alone: 1,
            ..at(0.1, 0.3, 0.97)
        };
        assert_eq!(near(&alone), None);
    }
}
