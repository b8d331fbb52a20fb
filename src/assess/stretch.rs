//! Is one part a longer, wider or higher version of the other?
//!
//! Such parts lie on each other within the tolerance where the surface is smooth, and their borders look
//! like those of another trim. Stretched back, all of it fits much better, which no trim does.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::contact::{
    Contact, ContactSearch, Contacts, MAX_NODES, quantile, robust_weights, solve,
};
use super::shape::{Bends, N as N_SMOOTH, ShapeEvidence, ShapeTolerance, explaining};
use crate::geometry::{Matrix3, Point3};

/// Unknowns of the fit: those of the statement about the shape, and the stretches.
const N: usize = N_SMOOTH + 3;
/// Times that the part is stretched back and compared again.
const ROUNDS: usize = 3;
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
/// the other by more than what may remain on both sides. O(nodes · log triangles).
pub(super) fn stretch(evidence: &ShapeEvidence<'_>, tolerance: &ShapeTolerance) -> Option<Stretch> {
    let limit = 2.0 * tolerance.remainder;
    let frame = Frame(Bends::of(evidence));
    let surfaces = [evidence.source, evidence.target];
    let scale = evidence.pose.scale;
    let mut search = ContactSearch::new(surfaces, scale, evidence.reach, N_PLACES);
    let gaps = Gaps::of(&search.at(evidence.pose)?, &frame);
    let (_, before) = gaps.explained(N_SMOOTH, evidence.noise);
    if before <= evidence.noise {
        // What facets leave open says nothing, least of all about the length of an extruded part.
        return None;
    }
    let (found, mut after) = gaps.explained(N, evidence.noise);
    let mut shares = frame.shares(&found);
    if frame.longest(&shares).1 < 0.5 * limit {
        return None;
    }
    for _ in 0..ROUNDS {
        let back = Scaled::new(&frame, shares.map(|share| 1.0 / (1.0 + share)));
        let gaps = Gaps::of(&search.at_scaled(evidence.pose, Some(&back))?, &frame);
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
    (after < EXPLAINED * before && by > limit).then_some(Stretch {
        axis: [PartAxis::Length, PartAxis::Width, PartAxis::Height][axis],
        share: shares[axis],
        by,
    })
}

/// The directions in which a part can be longer: the axes of its bends.
struct Frame(Bends);

impl Frame {
    /// What the unknowns do to a gap. Stretches are in lengths at the ends of the part.
    fn row(&self, contacts: &Contacts, contact: &Contact) -> Row {
        let Self(bends) = self;
        let (point, normal) = (&contact.point, &contact.normal);
        let mut row = Row::zeros();
        let smooth = explaining(contacts, bends, point, normal, 1.0);
        row.fixed_rows_mut::<N_SMOOTH>(0).copy_from(&smooth);
        let arm = bends.axes.transpose() * (point - bends.center);
        let normal = bends.axes.transpose() * normal;
        for k in 0..3 {
            row[N_SMOOTH + k] = arm[k] / bends.half[k] * normal[k];
        }
        row
    }

    /// Stretches of a solution as shares of the length.
    fn shares(&self, found: &Row) -> [f64; 3] {
        [0, 1, 2].map(|k| found[N_SMOOTH + k] / self.0.half[k])
    }

    /// The axis along which the parts differ most, and by how much.
    fn longest(&self, shares: &[f64; 3]) -> (usize, f64) {
        let by = [0, 1, 2].map(|k| 2.0 * self.0.half[k] * shares[k].abs());
        let longer = |most: usize, k: usize| if by[k] > by[most] { k } else { most };
        let axis = (1..3).fold(0, longer);
        (axis, by[axis])
    }
}

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
        for _ in 0..2 {
            let weights = robust_weights(&left, &self.areas, noise);
            let mut matrix = SMatrix::<f64, N, N>::zeros();
            let mut right = Row::zeros();
            for ((row, gap), weight) in self.rows.iter().zip(&self.sizes).zip(weights) {
                matrix.ger(weight, row, row, 1.0);
                right += row * (weight * gap);
            }
            matrix.rows_mut(n, N - n).fill(0.0);
            matrix.columns_mut(n, N - n).fill(0.0);
            right.rows_mut(n, N - n).fill(0.0);
            found = solve(&matrix, &right);
            for ((left, row), gap) in left.iter_mut().zip(&self.rows).zip(&self.sizes) {
                *left = gap - row.dot(&found);
            }
        }
        let sizes = left.iter().map(|l| l.abs()).zip(self.areas.iter().copied());
        (found, quantile(&mut sizes.collect::<Vec<_>>(), MOSTLY))
    }
}

/// Lengths along three axes through a point multiplied by factors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scaled {
    center: Point3,
    matrix: Matrix3,
    inverse: Matrix3,
}

impl Scaled {
    fn new(frame: &Frame, factors: [f64; 3]) -> Self {
        let Frame(Bends { center, axes, .. }) = frame;
        let along =
            |factors: [f64; 3]| axes * Matrix3::from_diagonal(&factors.into()) * axes.transpose();
        Self {
            center: *center,
            matrix: along(factors),
            inverse: along(factors.map(f64::recip)),
        }
    }

    /// The place of a point of the source.
    pub(super) fn apply(&self, point: &Point3) -> Point3 {
        self.center + self.matrix * (point - self.center)
    }

    /// The place that comes to lie on this point.
    pub(super) fn undo(&self, point: &Point3) -> Point3 {
        self.center + self.inverse * (point - self.center)
    }
}
