//! What explains the gaps between two parts: a small motion, an offset of the sheets, and smooth bends.

mod bends;
mod left_open;
mod unknowns;

use nalgebra::{SMatrix, SVector};

use super::borders::PairKind;
use super::contact::{Contact, Contacts};
use super::evidence::PoseEvidence;
use super::least_squares::{NormalEquations, robust_weights};
use super::small_motion::{Six, Unknown, motion_of};
use crate::geometry::{Point3, Similarity, Vector3};

pub(super) use bends::Bends;
use bends::N_BENDS;
pub(super) use unknowns::{N_SMOOTH, Row};
use unknowns::{bends_of, joined};

/// Times that places far off the fit are given less weight.
const ROUNDS: usize = 4;
/// Share of an offset that nothing else can imitate; with less it is not separable.
pub(super) const LEAST_OWN: f64 = 0.02;

/// Bends imitate a motion if less than this share of it lies outside of what they do.
const IMITATED: f64 = 0.1;

/// The gaps taken apart.
pub(crate) struct Fit {
    /// Of each place, what rigid motion and bends explain.
    pub(crate) smooth: Vec<f64>,
    /// What nothing explains, not even the facets.
    pub(crate) left: Vec<f64>,
    /// The same for each pair of borders and of holes.
    pub(super) borders: Vec<f64>,
    pub(super) holes: Vec<HoleLeft>,
    /// How far the source lies from where it belongs, bends counted as part of its shape; turns in
    /// lengths at the contacts' radius.
    pub(super) rigid: Six,
    pub(super) offset: f64,
    pub(super) is_separable: bool,
    bends: Bends,
    equations: NormalEquations<N_SMOOTH>,
    found: Row,
}

/// What nothing explains of how two holes differ.
#[derive(Debug, Clone, Copy)]
pub(super) struct HoleLeft {
    /// From the middle of the target's to that of the source's, within the sheet.
    pub(super) off: Vector3,
    /// Difference of the radii.
    wider: f64,
}

impl HoleLeft {
    /// Distance of the farthest points of the two borders.
    pub(super) fn size(&self) -> f64 {
        self.off.norm() + self.wider
    }
}

/// How much each unknown moves a place along a direction; `offset` is what a unit of the offset does.
pub(super) fn explaining(
    contacts: &Contacts,
    bends: &Bends,
    point: &Point3,
    direction: &Vector3,
    offset: f64,
) -> Row {
    let motion = contacts.row(point, direction);
    joined(&motion, offset, &bends.row(point, direction))
}

impl Fit {
    /// The offset of the sheets, where it is separable from a shift.
    pub(crate) fn separate_offset(&self) -> Option<f64> {
        self.is_separable.then_some(self.offset)
    }

    /// How far the hole that lies farthest from its counterpart is off; 0 without holes.
    pub(super) fn worst_hole(&self) -> f64 {
        let off = self.holes.iter().map(|hole| hole.off.norm());
        off.fold(0.0, f64::max)
    }

    /// What nothing explains at a place that did not take part; `contacts` are those that did.
    pub(super) fn left_at(&self, place: &Contact, contacts: &Contacts) -> f64 {
        let row = explaining(contacts, &self.bends, &place.point, &place.normal, 1.0);
        beyond_facets(place.gap - row.dot(&self.found), place)
    }

    /// How far each of the bends, of size 1 at the border, moves the source from where it belongs if the pose is found as
    /// if there were no bends; none where bends do not imitate that motion, which is told from them then. O(places).
    pub(super) fn pulled_by(&self, contacts: &Contacts) -> [Six; N_BENDS] {
        const BENDS: usize = Unknown::OFFSET + 1;
        let matrix = &self.equations.matrix;
        let of_motion: SMatrix<f64, 6, 6> = matrix.fixed_view::<6, 6>(0, 0).into();
        let mixed = matrix.fixed_view::<6, N_BENDS>(0, BENDS);
        let own_share = |motion: &Six| {
            let whole = motion.dot(&(of_motion * motion));
            let right: SVector<f64, N_BENDS> = mixed.transpose() * motion;
            let bends = NormalEquations::<N_BENDS> {
                matrix: matrix.fixed_view::<N_BENDS, N_BENDS>(BENDS, BENDS).into(),
                right,
            };
            1.0 - right.dot(&bends.solved()) / whole.max(f64::MIN_POSITIVE)
        };
        let rigid_parts = self.bends.rigid_parts(contacts);
        std::array::from_fn(|k| {
            let without_bends = NormalEquations::<6> {
                matrix: of_motion,
                right: mixed.column(k).into(),
            };
            let found = without_bends.solved();
            if own_share(&found) < IMITATED {
                found - rigid_parts.column(k)
            } else {
                Six::zeros()
            }
        })
    }

    /// The pose of the evidence that this is the fit of, moved to where the source belongs.
    pub(crate) fn corrected(&self, evidence: &PoseEvidence<'_>) -> Similarity {
        let correction = evidence.contacts.undo(&self.rigid);
        correction.after(&evidence.pose)
    }

    /// Robust least squares over a rigid motion, an offset and the bends of a plate that keep lengths
    /// (second and third order). Borders take part, so that a slide of the pose along the part is no
    /// difference of the shape. O(places).
    pub(crate) fn of(evidence: &PoseEvidence<'_>) -> Self {
        Self::with(evidence, &evidence.borders.weights(evidence.noise))
    }

    /// The same with surfaces and holes alone, outlines only measured.
    pub(crate) fn without_outlines(evidence: &PoseEvidence<'_>) -> Self {
        let borders = &evidence.borders;
        let weights = borders.weights(evidence.noise);
        let pairs = borders.pairs().iter().zip(weights);
        let of_holes = pairs.map(|(pair, weight)| match pair.kind {
            PairKind::Holes => weight,
            PairKind::Outlines | PairKind::Mixed => 0.0,
        });
        Self::with(evidence, &of_holes.collect::<Vec<f64>>())
    }

    /// The same with surfaces alone.
    pub(crate) fn of_surfaces(evidence: &PoseEvidence<'_>) -> Self {
        Self::with(evidence, &vec![0.0; evidence.borders.pairs().len()])
    }

    /// With these weights of the pairs of borders.
    fn with(evidence: &PoseEvidence<'_>, border_weights: &[f64]) -> Self {
        let (contacts, borders) = (&evidence.contacts, &evidence.borders);
        let bends = Bends::of(evidence.source, &evidence.pose, contacts);
        let row = |point: &Point3, direction: &Vector3, offset: f64| {
            explaining(contacts, &bends, point, direction, offset)
        };
        let places = contacts.list.iter();
        let places: Vec<Row> = places.map(|c| row(&c.point, &c.normal, 1.0)).collect();
        let beside = borders.pairs().iter();
        let beside: Vec<Row> = beside.map(|p| row(&p.point, &p.across, 0.0)).collect();
        let areas: Vec<f64> = contacts.list.iter().map(|c| c.weight).collect();
        let mut left: Vec<f64> = contacts.list.iter().map(|c| c.gap).collect();
        let mut found = Row::zeros();
        let mut is_separable = false;
        let mut equations = NormalEquations::<N_SMOOTH>::default();
        for round in 0..2 * ROUNDS {
            let has_offset = round < ROUNDS;
            if round == ROUNDS {
                if found[Unknown::OFFSET].abs() <= evidence.most_offset {
                    break;
                }
                // No offset of a sheet: one that bends undo.
                left = contacts.list.iter().map(|c| c.gap).collect();
            }
            let weights = robust_weights(&left, &areas, evidence.noise);
            equations = NormalEquations::default();
            for ((row, contact), weight) in places.iter().zip(&contacts.list).zip(weights) {
                equations.add(row, contact.gap, weight);
            }
            for ((row, pair), weight) in beside.iter().zip(borders.pairs()).zip(border_weights) {
                equations.add(row, pair.gap, *weight);
            }
            is_separable = equations.imitated(Unknown::OFFSET).own_share > LEAST_OWN;
            if !is_separable || !has_offset {
                // The shift of the rigid motion takes it.
                equations.leave_out(Unknown::OFFSET..Unknown::OFFSET + 1);
            }
            found = equations.solved();
            for ((left, row), contact) in left.iter_mut().zip(&places).zip(&contacts.list) {
                *left = contact.gap - row.dot(&found);
            }
        }
        let offset = found[Unknown::OFFSET];
        let smooth = places.iter().map(|row| row.dot(&found) - offset);
        for (left, contact) in left.iter_mut().zip(&contacts.list) {
            *left = beyond_facets(*left, contact);
        }
        let beside = beside.iter().zip(borders.pairs());
        let beside: Vec<f64> = beside.map(|(row, p)| p.gap - row.dot(&found)).collect();
        let as_they_are: Vec<f64> = borders.pairs().iter().map(|p| p.gap).collect();
        // What throws most borders apart explains none of them.
        let explains = borders.distance_of_most(&beside) <= borders.distance_of_most(&as_they_are);
        let holes = borders.all_holes().map(|pair| {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let explained = axes.map(|axis| row(&pair.hole.center, &axis, 0.0).dot(&found));
            let left = pair.off - Vector3::from(explained);
            HoleLeft {
                off: pair.hole.within_sheet(&left),
                wider: pair.wider,
            }
        });
        Self {
            smooth: smooth.collect(),
            borders: if explains { beside } else { as_they_are },
            holes: holes.collect(),
            rigid: motion_of(&found) + bends.rigid_parts(contacts) * bends_of(&found),
            left,
            offset,
            is_separable,
            bends,
            equations,
            found,
        }
    }
}

/// What the facets of the other part leave of a distance.
fn beyond_facets(distance: f64, place: &Contact) -> f64 {
    distance.signum() * (distance.abs() - place.facet).max(0.0)
}
