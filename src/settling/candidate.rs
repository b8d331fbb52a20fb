//! A pose with the evidence of the shapes for and against it.

use std::ops::Range;

use rayon::prelude::*;

use super::context::PairContext;
use crate::assess::borders::HOLES_THAT_HOLD;
use crate::assess::contact::{ContactSearch, FEW_NODES, Meeting};
use crate::assess::shape::{OVERHANGS, only_overhangs};
use crate::assess::tolerance::{Distances, UNREMARKABLE};
use crate::assess::{ShapeReason, ShapeStatement};
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Where so much less of the smaller part meets the other, a pose that fits as closely does not fit as well.
pub(super) const LITTLE_LESS: f64 = 0.02;
/// Where so much more of it meets, what meets besides is more than the elements of a border.
const MORE_MET: f64 = 0.01;
/// Where so much more of it meets, holes that have their counterpart besides are no accident.
const MUCH_MORE_MET: f64 = 0.1;
/// Where each part has a piece that the other lacks, a pose under which at least this share of the smaller part meets
/// the other is as likely as one under which more does, …
pub(super) const LEAST_SHARED: f64 = 0.5;
/// … and where even less does, this share of what meets under that one.
const NEARLY_SHARED: f64 = 0.8;
/// A piece of at least this share in which nothing differs is more likely than more of the part that differs.
const LEAST_PIECE: f64 = 0.35;
/// Lengths of so many tolerances are differences whatever the facets are and however the part is bent.
const CLEARLY: f64 = 2.0;
/// A piece of the smaller part lies much closer to the other part than the whole does under another pose if it lies
/// apart by at most this share of what a bend that moves the whole so far apart leaves in the piece. A bend grows with
/// the square of the length.
const MUCH_CLOSER: f64 = 0.5;
/// Outlines lie together all round where this share of the smaller part's borders does.
const ALL_ROUND: f64 = 0.9;
/// Surfaces that lie apart by at most so many times what facets leave lie on each other.
pub(super) const ON_EACH_OTHER: f64 = 2.0;

/// Where surfaces lie so many times as far apart as under a pose that nothing speaks against, facets included, it is
/// no matter of facets that something differs.
const MUCH_FARTHER: f64 = 2.0;

/// Whether a piece of the smaller part that meets the other lies much closer there than the part does that lies `other`
/// apart.
pub(super) fn is_much_closer(piece: Meeting, other: f64, noise: f64) -> bool {
    piece.gap + noise <= MUCH_CLOSER * piece.share * piece.share * other
}

/// How far a piece lies off for its size, as [`is_much_closer`] compares it.
pub(super) fn off_for_its_size(piece: Meeting) -> f64 {
    piece.gap / (piece.share * piece.share)
}

/// Two parts looked at in few places.
pub(super) struct FewPlaces<'a>(ContactSearch<'a>);

impl<'a> FewPlaces<'a> {
    pub(super) fn new(context: &PairContext<'a>, scale: f64) -> Self {
        let reach = context.distances(scale).reach;
        Self(context.contacts(scale, reach, FEW_NODES))
    }

    /// How the parts meet under a pose.
    pub(super) fn meeting(&self, pose: &Similarity) -> Meeting {
        let contacts = self.0.clone().at(pose);
        let nowhere = Meeting {
            share: 0.0,
            gap: f64::INFINITY,
        };
        contacts.map_or(nowhere, |contacts| contacts.meeting(0.0))
    }

    /// A pose with what speaks against it, and whether each part only overhangs the other where it does.
    pub(super) fn candidate(&self, pose: Similarity, shape: &ShapeStatement) -> Candidate {
        if shape.met < OVERHANGS {
            self.overhanging(pose, shape)
        } else {
            Candidate::at(pose, shape)
        }
    }

    /// The same where each part has a piece that the other lacks, or has one under a pose that this one is compared
    /// with.
    pub(super) fn overhanging(&self, pose: Similarity, shape: &ShapeStatement) -> Candidate {
        Candidate {
            only_overhangs: only_overhangs(shape.met, self.0.overhang(&pose)),
            ..Candidate::at(pose, shape)
        }
    }
}

/// The result of a match, and other poses beside it, each with what speaks against it.
pub(super) struct Judged {
    pub(super) result: Candidate,
    pub(super) candidates: Vec<Candidate>,
}

/// The result and each of the other poses with what speaks against it; `candidate` makes that of the comparison of the
/// shapes. Where the outlines lie together under no pose and are no evidence under
/// one of them, they are none under the others either: that they lie beside others by chance speaks against none of
/// them.
pub(super) fn judged(
    context: &PairContext<'_>,
    result: &Similarity,
    others: &[Similarity],
    candidate: impl Fn(Similarity, &ShapeStatement) -> Candidate + Sync,
) -> Result<Judged, Cancelled> {
    let of = |pose: &Similarity| {
        context.check()?;
        Ok(candidate(*pose, &context.shape(pose)))
    };
    let of_others = || others.par_iter().map(of).collect();
    let (result, others): (Result<_, _>, Result<Vec<_>, _>) = rayon::join(|| of(result), of_others);
    let mut all = others?;
    all.insert(0, result?);
    let lie_together = all.iter().any(Candidate::has_outlines_together);
    let are_evidence = |candidate: &Candidate| !candidate.outlines_are_no_evidence;
    if !lie_together && !all.iter().all(are_evidence) {
        let others = all.par_iter_mut().filter(|other| are_evidence(other));
        others.try_for_each(|other| {
            context.check()?;
            let shape = context.shape_without_outlines(&other.pose);
            *other = Candidate {
                outlines_are_no_evidence: true,
                off: None,
                ..candidate(other.pose, &shape)
            };
            Ok(())
        })?;
    }
    context.check()?;
    Ok(Judged {
        result: all.remove(0),
        candidates: all,
    })
}

/// A pose and what speaks against one shape under it. A bend does so under every pose.
pub(super) struct Candidate {
    pub(super) pose: Similarity,
    pub(super) n_differences: usize,
    /// Of these the ones that nothing but another place explains.
    n_clear: usize,
    /// Holes with a counterpart, and those where the other part is solid.
    pub(super) n_holes: usize,
    pub(super) n_alone: usize,
    /// Whether outlines are no evidence of the pose: one part is trimmed farther out, or few of them lie beside others.
    pub(super) outlines_are_no_evidence: bool,
    /// Whether outlines lie apart by more than is accepted.
    outlines_lie_apart: bool,
    /// Share of the smaller part's borders that lies on a border of the other.
    together: f64,
    /// Whether surfaces do, all over or at one place.
    surfaces_differ: bool,
    /// Whether nothing at all speaks against one shape, a bend neither.
    pub(super) is_one_shape: bool,
    /// Share of the smaller part that meets the other.
    pub(super) met: f64,
    /// Whether each part has a piece that the other lacks, and hardly any of the smaller one lies neither on the other
    /// part nor beyond its borders.
    only_overhangs: bool,
    /// Whether too little of it meets the other for one part.
    hardly_meets: bool,
    /// How far the surfaces lie apart by a bend.
    bend: f64,
    /// How far they lie apart besides it.
    pub(super) remainder: f64,
    /// A constant distance of the sheets besides.
    offset: f64,
    /// How far outlines and holes lie apart, where there are enough of both.
    off: Option<BordersOff>,
    /// How far they may lie apart.
    limit: f64,
}

/// How far borders lie apart.
#[derive(Debug, Clone, Copy)]
struct BordersOff {
    outlines: f64,
    holes: f64,
}

impl Candidate {
    pub(super) fn at(pose: Similarity, shape: &ShapeStatement) -> Self {
        let n_that_say = |what: Evidence| {
            let reasons = shape.reasons.iter();
            reasons
                .filter(|reason| Evidence::of(reason) == what)
                .count()
        };
        let has = |is_meant: fn(&ShapeReason) -> bool| shape.reasons.iter().any(is_meant);
        let n_clear = n_that_say(Evidence::ClearDifference);
        let borders = &shape.borders;
        Self {
            pose,
            n_differences: n_clear + n_that_say(Evidence::Difference),
            n_clear,
            n_holes: borders.n_holes,
            n_alone: borders.n_alone(),
            outlines_are_no_evidence: borders.other_trim.is_some() || borders.offset.is_none(),
            is_one_shape: shape.reasons.is_empty(),
            offset: shape.offset.unwrap_or(0.0),
            outlines_lie_apart: has(|reason| matches!(reason, ShapeReason::Borders { .. })),
            surfaces_differ: has(|reason| {
                use ShapeReason::{Local, Surface};
                matches!(reason, Surface { .. } | Local { .. })
            }),
            together: borders.together,
            met: shape.met,
            only_overhangs: false,
            hardly_meets: has(|reason| matches!(reason, ShapeReason::HardlyMet { .. })),
            bend: shape.springback,
            remainder: shape.remainder,
            off: (borders.offset)
                .filter(|_| borders.n_holes >= HOLES_THAT_HOLD)
                .map(|outlines| BordersOff {
                    outlines,
                    holes: borders.worst_hole,
                }),
            limit: shape.tolerance.remainder,
        }
    }

    /// Whether the parts, each of which has a piece that the other lacks, share enough under this pose too, and what
    /// they share is as much alike. That more overlaps under one of two such poses is no evidence: a row of like
    /// features may be shifted by one of them.
    pub(super) fn is_equal_partial_fit_beside(&self, other: &Self, distances: &Distances) -> bool {
        let is_as_close = |own: f64, other: f64| own <= distances.as_close_as(UNREMARKABLE, other);
        // A piece of a piece is no other part for being small, and the more of a part that was not pierced yet meets
        // the other, the more holes of that lie alone.
        let n_differences = self.n_differences - usize::from(self.hardly_meets);
        let is_unpierced = self.n_holes.max(other.n_holes) == 0;
        self.only_overhangs
            && self.met >= LEAST_SHARED.min(NEARLY_SHARED * other.met)
            && n_differences <= other.n_differences
            && (self.n_alone <= other.n_alone || is_unpierced)
            && is_as_close(self.bend, other.bend)
            && is_as_close(self.remainder, other.remainder)
    }

    /// Whether more of the smaller part meets the other than under another pose, such as a lug that hangs in the air
    /// there, while as many holes have their counterpart, no more differs, and the surfaces lie as close. Holes that
    /// lie alone here were not pierced yet.
    pub(super) fn covers_more_than(&self, other: &Self, distances: &Distances) -> bool {
        let is_as_close = |own: f64, other: f64| own <= distances.as_close_as(UNREMARKABLE, other);
        self.met >= other.met + MORE_MET
            && self.n_holes >= other.n_holes
            && self.n_differences <= other.n_differences
            && is_as_close(self.bend, other.bend)
            && is_as_close(self.remainder, other.remainder)
    }

    /// How far the surfaces lie apart under this pose over how far they do under another, at least 1; `None` where
    /// less meets or more differs. `noise` is what facets leave.
    pub(super) fn ratio_to(&self, other: &Self, noise: f64) -> Option<f64> {
        let fits_as_much = self.meets_as_much_as(other)
            && self.differs_no_more_than(other)
            && self.n_holes >= other.n_holes;
        let apart = |of: &Self| of.apart() + noise;
        fits_as_much.then(|| (apart(self) / apart(other)).max(1.0))
    }

    /// Whether the outlines are evidence, and lie together.
    fn has_outlines_together(&self) -> bool {
        !self.outlines_are_no_evidence && !self.outlines_lie_apart
    }

    /// Whether each part has a piece here that the other lacks, and no more differs than under another pose, under
    /// which more of the parts meets while the surfaces lie much farther apart: a piece lies on another by chance
    /// hardly ever, while a bend and an offset explain much.
    pub(super) fn lies_much_closer_elsewhere_than(&self, other: &Self, noise: f64) -> bool {
        self.only_overhangs
            && (LEAST_SHARED..other.met).contains(&self.met)
            && self.differs_no_more_than(other)
            && is_much_closer(self.meeting(), other.apart_in_all(), noise)
    }

    /// The same where the piece even lies on the other part but for what facets leave.
    pub(super) fn is_exact_partial_fit_beside(&self, other: &Self, noise: f64) -> bool {
        self.apart_in_all() <= ON_EACH_OTHER * noise
            && self.lies_much_closer_elsewhere_than(other, noise)
    }

    /// Whether a piece of each part lies on the other here and nothing differs but what a bend explains, while each has
    /// a piece that the other lacks, and more of the parts meets under another pose, under which their shapes differ or
    /// their surfaces lie much farther apart.
    pub(super) fn fits_as_a_piece_beside(&self, other: &Self, noise: f64) -> bool {
        self.is_piece_without_difference(LEAST_PIECE..other.met)
            && self.n_alone <= other.n_alone
            && self.has_no_remainder(noise)
            && self.apart_in_all() < MUCH_CLOSER * other.apart_in_all()
            && (other.differs() || is_much_closer(self.meeting(), other.apart_in_all(), noise))
    }

    /// The same where holes hold the pieces, however far a bend moves them: holes lie on each other by chance hardly
    /// ever, while under the other pose something differs beyond doubt.
    pub(super) fn fits_by_holes_as_a_piece_beside(&self, other: &Self, noise: f64) -> bool {
        let remains_much_less = self.remainder < MUCH_CLOSER * other.remainder;
        self.is_piece_without_difference(LEAST_SHARED..other.met)
            && other.n_clear > 0
            && self.n_holes >= HOLES_THAT_HOLD
            && self.n_alone < other.n_alone
            && (self.has_no_remainder(noise) || remains_much_less)
            && self.apart_in_all() <= other.apart_in_all() + noise
    }

    /// Whether each part has a piece here that the other lacks, so much of the smaller one meets the other, and nothing
    /// differs but what a bend explains.
    fn is_piece_without_difference(&self, met: Range<f64>) -> bool {
        let n_differences = self.n_differences - usize::from(self.hardly_meets);
        self.only_overhangs && met.contains(&self.met) && n_differences == 0
    }

    /// Whether nothing remains besides bends but what facets leave, or what is negligible.
    fn has_no_remainder(&self, noise: f64) -> bool {
        self.remainder <= (ON_EACH_OTHER * noise).max(UNREMARKABLE * self.limit)
    }

    /// Whether the parts meet as a whole, with their outlines together all round, while under another pose each has a
    /// piece that the other lacks and fewer of the outlines lie together. The ends of a profile lie together at both
    /// sides by chance hardly ever, while a bent part lies closer where it is slid along itself.
    pub(super) fn fits_all_round_beside(&self, other: &Self) -> bool {
        self.met >= OVERHANGS
            && other.met < OVERHANGS
            && self.has_outlines_together()
            && self.together >= ALL_ROUND
            && other.together < ALL_ROUND
    }

    /// Whether nothing differs here while the surfaces, which lie no closer, differ somewhere under another pose: an
    /// end that overhangs here may be drawn onto a border there.
    pub(super) fn fits_where_surfaces_differ_under(&self, other: &Self) -> bool {
        !self.differs()
            && other.surfaces_differ
            && self.met >= LEAST_SHARED
            && self.apart_in_all() <= other.apart_in_all()
    }

    /// Whether nothing but surfaces distinguishes this pose from another one that as much meets under: a flange that
    /// has opened differs under the right pose too.
    pub(super) fn is_distinguished_by_surfaces_only(&self, other: &Self) -> bool {
        let by_surfaces_only = |pose: &Self| pose.outlines_are_no_evidence && pose.n_holes == 0;
        [self, other].into_iter().all(by_surfaces_only) && self.meets_as_much_as(other)
    }

    /// Whether as much of the smaller part meets the other as under another pose.
    pub(super) fn meets_as_much_as(&self, other: &Self) -> bool {
        self.met >= other.met - LITTLE_LESS
    }

    /// Whether there are no more differences of the shapes than under another pose, and no more holes without a
    /// counterpart.
    fn differs_no_more_than(&self, other: &Self) -> bool {
        self.n_differences <= other.n_differences && self.n_alone <= other.n_alone
    }

    /// Whether something other than a bend speaks against one shape.
    pub(super) fn differs(&self) -> bool {
        self.n_differences > 0
    }

    /// How far the surfaces lie apart by bends and besides them.
    pub(super) fn apart(&self) -> f64 {
        self.bend.hypot(self.remainder)
    }

    /// The same with a constant distance of the sheets.
    fn apart_in_all(&self) -> f64 {
        self.apart().hypot(self.offset)
    }

    /// How the parts meet, bends, remainder and offset taken together.
    pub(super) fn meeting(&self) -> Meeting {
        Meeting {
            share: self.met,
            gap: self.apart_in_all(),
        }
    }

    /// Whether the shapes surely differ less under this pose: there are fewer differences, or as many while holes
    /// that lie alone under the other pose have their counterpart or while much more meets and more holes do, or none
    /// while both outlines and holes lie closer.
    pub(super) fn beats(&self, other: &Self) -> bool {
        let pairs_holes = self.n_holes > other.n_holes && self.n_alone < other.n_alone
            || self.n_holes >= other.n_holes + HOLES_THAT_HOLD
                && self.met >= other.met + MUCH_MORE_MET;
        self.n_differences < other.n_clear
            || pairs_holes && self.n_differences <= other.n_differences
            || self.n_differences == 0 && other.n_differences > 0 && self.lies_closer_than(other)
    }

    /// Whether nothing differs under this pose while something does under another one, under which no more meets and
    /// the surfaces lie much farther apart. `noise` is what facets leave.
    pub(super) fn lies_much_closer_without_difference_than(
        &self,
        other: &Self,
        noise: f64,
    ) -> bool {
        !self.differs()
            && other.differs()
            && self.meets_as_much_as(other)
            && other.apart() + noise >= MUCH_FARTHER * (self.apart() + noise)
    }

    /// Whether both outlines and holes lie closer under this pose by more than is accepted, and no fewer holes have
    /// their counterpart. Either alone may be the mark of another version.
    fn lies_closer_than(&self, other: &Self) -> bool {
        let (Some(own), Some(others)) = (self.off, other.off) else {
            return false;
        };
        self.n_holes >= other.n_holes
            && others.outlines - own.outlines > self.limit
            && others.holes - own.holes > self.limit
    }
}

/// How a reason against one shape counts against a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Evidence {
    /// Nothing: a bend is there under every pose.
    Nothing,
    /// The shapes differ, which facets or a bend may explain.
    Difference,
    /// They differ beyond doubt.
    ClearDifference,
}

impl Evidence {
    fn of(reason: &ShapeReason) -> Self {
        match reason {
            ShapeReason::Bent { .. } => Self::Nothing,
            ShapeReason::Holes { .. } | ShapeReason::Outlines { .. } => Self::ClearDifference,
            ShapeReason::Surface { by, limit, .. }
            | ShapeReason::Local { by, limit, .. }
            | ShapeReason::Borders { by, limit, .. }
            | ShapeReason::Hole { by, limit, .. }
                if *by > CLEARLY * limit =>
            {
                Self::ClearDifference
            }
            ShapeReason::Surface { .. }
            | ShapeReason::Local { .. }
            | ShapeReason::Borders { .. }
            | ShapeReason::Hole { .. }
            | ShapeReason::HardlyMet { .. }
            | ShapeReason::Stretched { .. } => Self::Difference,
        }
    }
}

#[cfg(test)]
mod tests;
