//! Is one part a longer, wider or higher version of the other?
//!
//! Such parts lie on each other within the tolerance where the surface is smooth, and their borders look
//! like those of another trim. Stretched back, all of it fits much better, which no trim does.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use super::borders::{BorderPair, HolePair, LEAST_PAIRED, PairKind};
use super::contact::{Contact, ContactSearch, Contacts, MAX_NODES};
use super::evidence::PoseEvidence;
use super::fit::{Bends, N_SMOOTH, explaining};
use super::least_squares::{NormalEquations, quantile, robust_weights};
use super::scaled::Scaled;
use super::small_motion::{Six, motion_of};
use super::tolerance::{ShapeTolerance, UNREMARKABLE};
use crate::geometry::{Point3, Similarity, Vector3};

/// Unknowns of the fit: those of the statement about the shape, and the stretches.
const N: usize = N_SMOOTH + 3;
/// Unknowns of the fit of outlines: a rigid motion and the stretches.
const N_PLACED: usize = 9;
/// Outlines are compared at this share of their length.
const MOSTLY_OF_OUTLINES: f64 = 0.9;
/// Surfaces that lie so many times as far apart stretched back speak against a stretch.
const REFUTED: f64 = 1.5;
/// Outlines that would lie so many times as far apart speak against a stretch too.
const MUCH_FARTHER: f64 = 3.0;
/// Times that the part is stretched back and compared again.
const ROUNDS: usize = 3;
/// Times that places far off the fit of the gaps are given less weight.
const REWEIGHTINGS: usize = 2;
/// A part is longer by more than what may remain at both of its ends.
const ENDS: f64 = 2.0;
/// A first estimate below this share of that is not followed.
const WORTH_FOLLOWING: f64 = 0.5;
/// Places of the smaller part that are looked at; three numbers need no more.
const N_PLACES: usize = MAX_NODES / 4;
/// Gaps that shrink to this share of themselves come from the stretch: what bends a part, or is noise, does
/// not vanish so.
const EXPLAINED: f64 = 0.5;
/// The gaps are compared at this share of the area: trims and holes have their own.
const MOSTLY: f64 = 0.8;
/// Parts that differ by more than this are no versions of each other.
const MOST: f64 = 0.2;

/// Principal axis of the source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PartAxis {
    /// The longest.
    Length,
    /// The middle one.
    Width,
    /// The shortest.
    Height,
}

/// How much longer the source is than the target along one of its principal axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) axis: PartAxis,
    /// As a share of the length; negative where the source is shorter.
    pub(super) share: f64,
    /// In target units, never negative.
    pub(super) by: f64,
}

/// The stretch that explains at least half of the gaps between the parts, if it makes one of them longer than
/// the other by more than what may remain on both sides, and neither outlines nor holes speak against it.
/// O(nodes · log triangles).
pub(super) fn stretch(evidence: &PoseEvidence<'_>, tolerance: &ShapeTolerance) -> Option<Stretch> {
    let limit = ENDS * tolerance.remainder;
    let frame = Frame::of(evidence);
    let surfaces = [evidence.source, evidence.target];
    let scale = evidence.pose.scale;
    let mut search = ContactSearch::new(surfaces, scale, evidence.reach, N_PLACES);
    let gaps = Gaps::of(&search.at(&evidence.pose)?, &frame);
    let (_, before) = gaps.explained(N_SMOOTH, evidence.noise);
    if before <= evidence.noise {
        // What facets leave open determines nothing, least of all the length of an extruded part.
        return None;
    }
    let (found, mut after) = gaps.explained(N, evidence.noise);
    let mut shares = frame.shares(&found);
    if frame.longest(&shares).1 < WORTH_FOLLOWING * limit {
        return None;
    }
    for _ in 0..ROUNDS {
        let back = frame.scaled(shares.map(|share| 1.0 / (1.0 + share)));
        let gaps = Gaps::of(&search.at_scaled(&evidence.pose, Some(&back))?, &frame);
        let found;
        (found, after) = gaps.explained(N, evidence.noise);
        for (share, further) in shares.iter_mut().zip(frame.shares(&found)) {
            *share += (1.0 + *share) * further;
        }
        if !shares.iter().all(|share| share.abs() < MOST) {
            return None;
        }
    }
    let (axis, by) = frame.longest(&shares);
    let borders = evidence.borders.limit(tolerance);
    let is_longer = after < EXPLAINED * before && by > limit;
    (is_longer && !frame.misplaces_borders(evidence, &shares, borders)).then_some(Stretch {
        axis: [PartAxis::Length, PartAxis::Width, PartAxis::Height][axis],
        share: shares[axis],
        by,
    })
}

/// Whether one part that is longer, wider or higher than the other explains how their outlines lie apart, and
/// neither surfaces nor holes speak against it. `limit` is how far borders may lie apart.
/// O(nodes · log triangles).
pub(super) fn explains_outlines(evidence: &PoseEvidence<'_>, limit: f64) -> bool {
    let frame = Frame::of(evidence);
    frame.of_outlines(evidence, limit).is_some_and(|found| {
        !frame.misplaces_holes(evidence, &found, limit) && frame.keeps_surfaces(evidence, &found)
    })
}

/// The directions in which a part can be longer: the axes of its bends.
struct Frame(Bends);

impl Frame {
    fn of(evidence: &PoseEvidence<'_>) -> Self {
        Self(Bends::of(
            evidence.source,
            &evidence.pose,
            &evidence.contacts,
        ))
    }

    /// The part with its lengths along the axes multiplied.
    fn scaled(&self, factors: [f64; 3]) -> Scaled {
        Scaled::new(self.0.center, &self.0.axes, factors)
    }

    /// What the unknowns do to a gap. Stretches are in lengths at the ends of the part.
    fn row(&self, contacts: &Contacts, contact: &Contact) -> Row {
        let (point, normal) = (&contact.point, &contact.normal);
        let smooth = explaining(contacts, &self.0, point, normal, 1.0);
        with_stretches(&smooth, self.stretching(point, normal))
    }

    /// What a rigid motion and the stretches do to a place along a direction.
    fn placed(&self, contacts: &Contacts, point: &Point3, direction: &Vector3) -> Placed {
        let motion = contacts.row(point, direction);
        with_stretches(&motion, self.stretching(point, direction))
    }

    /// How much each stretch moves a place along a direction.
    fn stretching(&self, point: &Point3, direction: &Vector3) -> [f64; 3] {
        let Self(bends) = self;
        let arm = bends.axes.transpose() * (point - bends.center);
        let direction = bends.axes.transpose() * direction;
        [0, 1, 2].map(|k| arm[k] / bends.half[k] * direction[k])
    }

    /// The motion and the stretches that lay the outlines on each other; `None` where none does.
    fn of_outlines(&self, evidence: &PoseEvidence<'_>, limit: f64) -> Option<Placed> {
        let OutlineFit {
            found,
            before,
            after,
        } = self.fit_outlines(evidence, None);
        (after <= limit.max(EXPLAINED * before)).then_some(found)
    }

    /// Lays the outlines on each other in robust least squares: by a motion and the stretches, or by a motion
    /// where the stretches are given.
    fn fit_outlines(&self, evidence: &PoseEvidence<'_>, stretches: Option<[f64; 3]>) -> OutlineFit {
        let PoseEvidence {
            contacts, borders, ..
        } = evidence;
        let outlines = borders.pairs().iter();
        let outlines: Vec<&BorderPair> =
            outlines.filter(|p| p.kind == PairKind::Outlines).collect();
        let row = |pair: &&BorderPair| self.placed(contacts, &pair.point, &pair.across);
        let rows: Vec<Placed> = outlines.iter().map(row).collect();
        let lengths: Vec<f64> = outlines.iter().map(|p| p.weight).collect();
        let at_most = |left: &[f64]| {
            let sizes = left.iter().map(|l| l.abs()).zip(lengths.iter().copied());
            quantile(&mut sizes.collect::<Vec<_>>(), MOSTLY_OF_OUTLINES)
        };
        let left_by = |found: &Placed| -> Vec<f64> {
            let pairs = outlines.iter().zip(&rows);
            pairs.map(|(pair, row)| pair.gap - row.dot(found)).collect()
        };
        let before = at_most(&left_by(&Placed::zeros()));
        let mut found = with_stretches(&Six::zeros(), stretches.unwrap_or_default());
        let floor = evidence.noise.max(borders.unremarkable());
        let mut left = left_by(&found);
        for _ in 0..ROUNDS {
            let weights = robust_weights(&left, &lengths, floor);
            let mut equations = NormalEquations::<N_PLACED>::default();
            for ((row, left), weight) in rows.iter().zip(&left).zip(weights) {
                equations.add(row, *left, weight);
            }
            if stretches.is_some() {
                equations.leave_out(N_PLACED - 3..N_PLACED);
            }
            found += equations.solved();
            left = left_by(&found);
        }
        OutlineFit {
            found,
            before,
            after: at_most(&left),
        }
    }

    /// Whether outlines that lie beside each other would lie farther off than they do, and much farther or farther
    /// than borders may, if one part were longer by these shares, or a hole farther off than it does and may.
    fn misplaces_borders(
        &self,
        evidence: &PoseEvidence<'_>,
        shares: &[f64; 3],
        limit: f64,
    ) -> bool {
        if evidence.borders.share() < LEAST_PAIRED {
            return false;
        }
        let stretches = [0, 1, 2].map(|k| shares[k] * self.0.half[k]);
        let fit = self.fit_outlines(evidence, Some(stretches));
        // Those that lie on each other as they are need not lie far off to refute it.
        let refuted = MUCH_FARTHER * fit.before.max(UNREMARKABLE * limit);
        fit.after > limit.max(fit.before).min(refuted)
            || self.misplaces_holes(evidence, &fit.found, limit)
    }

    /// Whether a hole would lie farther off than it does, and farther than borders may.
    fn misplaces_holes(&self, evidence: &PoseEvidence<'_>, found: &Placed, limit: f64) -> bool {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        evidence.borders.holes.iter().any(|pair| {
            let HolePair { hole, off, .. } = pair;
            let row = |axis: Vector3| self.placed(&evidence.contacts, &hole.center, &axis);
            let moved = Vector3::from(axes.map(|axis| row(axis).dot(found)));
            let after = hole.within_sheet(&(off - moved)).norm();
            after > limit && after > hole.within_sheet(off).norm()
        })
    }

    /// Whether the surfaces still lie on each other with the source moved and stretched back.
    fn keeps_surfaces(&self, evidence: &PoseEvidence<'_>, found: &Placed) -> bool {
        let PoseEvidence { pose, noise, .. } = evidence;
        let surfaces = [evidence.source, evidence.target];
        let mut search = ContactSearch::new(surfaces, pose.scale, evidence.reach, N_PLACES);
        let mut left_at = |pose: &Similarity, scaled: Option<&Scaled>| {
            let gaps = Gaps::of(&search.at_scaled(pose, scaled)?, self);
            Some(gaps.explained(N_SMOOTH, *noise).1)
        };
        let factors = self.shares(found).map(|share| 1.0 / (1.0 + share));
        let moved = evidence.contacts.undo(&motion_of(found)).after(pose);
        let as_it_is = left_at(pose, None);
        let scaled = left_at(&moved, Some(&self.scaled(factors)));
        as_it_is
            .zip(scaled)
            .is_some_and(|(as_it_is, scaled)| scaled <= REFUTED * as_it_is.max(*noise))
    }

    /// Stretches of a solution as shares of the length.
    fn shares<const M: usize>(&self, found: &SVector<f64, M>) -> [f64; 3] {
        [0, 1, 2].map(|k| found[M - 3 + k] / self.0.half[k])
    }

    /// The axis along which the parts differ most, and by how much.
    fn longest(&self, shares: &[f64; 3]) -> (usize, f64) {
        let by = [0, 1, 2].map(|k| 2.0 * self.0.half[k] * shares[k].abs());
        let longer = |most: usize, k: usize| if by[k] > by[most] { k } else { most };
        let axis = (1..3).fold(0, longer);
        (axis, by[axis])
    }
}

/// Unknowns with the stretches behind the others.
fn with_stretches<const FEWER: usize, const ALL: usize>(
    others: &SVector<f64, FEWER>,
    stretches: [f64; 3],
) -> SVector<f64, ALL> {
    let mut all = SVector::<f64, ALL>::zeros();
    all.fixed_rows_mut::<FEWER>(0).copy_from(others);
    all.fixed_rows_mut::<3>(FEWER).copy_from_slice(&stretches);
    all
}

/// How well outlines align.
struct OutlineFit {
    found: Placed,
    /// Distance of the outlines at most of their length as they are.
    before: f64,
    /// What is left of it.
    after: f64,
}

/// What a rigid motion and the stretches do to a place.
type Placed = SVector<f64, N_PLACED>;

/// One row of the fit.
type Row = SVector<f64, N>;

/// The gaps between two parts and what could explain each.
struct Gaps {
    rows: Vec<Row>,
    sizes: Vec<f64>,
    areas: Vec<f64>,
}

impl Gaps {
    fn of(contacts: &Contacts, frame: &Frame) -> Self {
        let list = &contacts.list;
        Self {
            rows: list.iter().map(|c| frame.row(contacts, c)).collect(),
            sizes: list.iter().map(|c| c.gap).collect(),
            areas: list.iter().map(|c| c.weight).collect(),
        }
    }

    /// The first `n` unknowns in robust least squares, and what they leave at most of the area.
    fn explained(&self, n: usize, noise: f64) -> (Row, f64) {
        let mut left = self.sizes.clone();
        let mut found = Row::zeros();
        for _ in 0..REWEIGHTINGS {
            let weights = robust_weights(&left, &self.areas, noise);
            let mut equations = NormalEquations::<N>::default();
            for ((row, gap), weight) in self.rows.iter().zip(&self.sizes).zip(weights) {
                equations.add(row, *gap, weight);
            }
            equations.leave_out(n..N);
            found = equations.solved();
            for ((left, row), gap) in left.iter_mut().zip(&self.rows).zip(&self.sizes) {
                *left = gap - row.dot(&found);
            }
        }
        let sizes = left.iter().map(|l| l.abs()).zip(self.areas.iter().copied());
        (found, quantile(&mut sizes.collect::<Vec<_>>(), MOSTLY))
    }
}
