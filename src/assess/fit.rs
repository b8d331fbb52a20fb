//! What explains the gaps between two parts: a small motion, an offset of the sheets, and smooth bends.

mod bends;
mod left_open;
mod unknowns;

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;

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

/// Places whose equations are added by themselves, so that any number of threads adds them in one order.
const CHUNK: usize = 1024;
/// Times at most that places far off the fit are given less weight.
const ROUNDS: usize = 4;
/// It was the last time if no unknown changes by more than this share of what facets leave.
const STILL: f64 = 1e-3;
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

    /// The most that motion, bends and offset explain at any place.
    pub(super) fn most_explained(&self) -> f64 {
        let smooth = self.smooth.iter();
        smooth.fold(0.0, |most: f64, smooth| most.max(smooth.abs())) + self.offset.abs()
    }

    /// What nothing explains at a place that did not take part; `contacts` are those that did.
    pub(super) fn left_at(&self, place: &Contact, contacts: &Contacts) -> f64 {
        let row = explaining(contacts, &self.bends, &place.point, &place.normal, 1.0);
        beyond_facets(place.gap - row.dot(&self.found), place)
    }

    /// The same roughly, of a place that is known by its normal and its gap alone.
    pub(super) fn left_of(
        &self,
        (point, normal): (&Point3, &Vector3),
        gap: f64,
        contacts: &Contacts,
    ) -> f64 {
        gap - explaining(contacts, &self.bends, point, normal, 1.0).dot(&self.found)
    }

    /// How far each of the bends, of size 1 at the border, moves the source from where it belongs if the pose is found
    /// as if there were no bends; none where bends do not imitate that motion, which is told from them then. O(places).
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
        let rows = Rows {
            places: (contacts.list.par_iter())
                .map(|c| row(&c.point, &c.normal, 1.0))
                .collect(),
            gaps: contacts.list.iter().map(|c| c.gap).collect(),
            areas: contacts.list.iter().map(|c| c.weight).collect(),
            beside: (borders.pairs().iter())
                .map(|p| row(&p.point, &p.across, 0.0))
                .collect(),
            gaps_beside: borders.pairs().iter().map(|p| p.gap).collect(),
            border_weights,
            noise: evidence.noise,
        };
        let mut solution = rows.solved(true);
        if solution.found[Unknown::OFFSET].abs() > evidence.most_offset {
            // No offset of a sheet: one that bends undo.
            solution = rows.solved(false);
        }
        let Solution {
            found,
            mut left,
            equations,
            is_separable,
        } = solution;
        let offset = found[Unknown::OFFSET];
        let smooth = rows.places.iter().map(|row| row.dot(&found) - offset);
        for (left, contact) in left.iter_mut().zip(&contacts.list) {
            *left = beyond_facets(*left, contact);
        }
        let beside = remaining(&rows.beside, &rows.gaps_beside, &found);
        // What throws most borders apart explains none of them.
        let as_they_are = &rows.gaps_beside;
        let explains = borders.distance_of_most(&beside) <= borders.distance_of_most(as_they_are);
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
            borders: if explains { beside } else { rows.gaps_beside },
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

/// What is fitted: places of the surfaces, and pairs of borders.
struct Rows<'a> {
    places: Vec<Row>,
    gaps: Vec<f64>,
    areas: Vec<f64>,
    beside: Vec<Row>,
    gaps_beside: Vec<f64>,
    border_weights: &'a [f64],
    noise: f64,
}

/// The unknowns, and what they leave of the gaps.
struct Solution {
    found: Row,
    left: Vec<f64>,
    /// Those of the last round.
    equations: NormalEquations<N_SMOOTH>,
    is_separable: bool,
}

impl Rows<'_> {
    /// Robust least squares; without an offset, or where it is not separable, the shift of the rigid motion takes it.
    fn solved(&self, has_offset: bool) -> Solution {
        let mut solution = Solution {
            found: Row::zeros(),
            left: self.gaps.clone(),
            equations: NormalEquations::default(),
            is_separable: false,
        };
        for _ in 0..ROUNDS {
            let weights = robust_weights(&solution.left, &self.areas, self.noise);
            let mut equations = self.equations(&weights);
            solution.is_separable = equations.imitated(Unknown::OFFSET).own_share > LEAST_OWN;
            if !solution.is_separable || !has_offset {
                equations.leave_out(Unknown::OFFSET..Unknown::OFFSET + 1);
            }
            let found = equations.solved();
            let by = (found - solution.found).amax();
            solution.left = remaining(&self.places, &self.gaps, &found);
            (solution.found, solution.equations) = (found, equations);
            if by <= STILL * self.noise {
                break;
            }
        }
        solution
    }

    /// O(places).
    fn equations(&self, weights: &[f64]) -> NormalEquations<N_SMOOTH> {
        let of_places = (self.places.par_chunks(CHUNK))
            .zip(self.gaps.par_chunks(CHUNK))
            .zip(weights.par_chunks(CHUNK));
        let of_places: Vec<NormalEquations<N_SMOOTH>> = of_places
            .map(|((rows, gaps), weights)| NormalEquations::of(rows, gaps, weights))
            .collect();
        let mut all = NormalEquations::of(&self.beside, &self.gaps_beside, self.border_weights);
        for part in &of_places {
            all += part;
        }
        all
    }
}

/// What unknowns leave of distances.
fn remaining(rows: &[Row], distances: &[f64], unknowns: &Row) -> Vec<f64> {
    let pairs = rows.iter().zip(distances);
    pairs.map(|(row, gap)| gap - row.dot(unknowns)).collect()
}

/// What the facets of the other part leave of a distance.
fn beyond_facets(distance: f64, place: &Contact) -> f64 {
    distance.signum() * (distance.abs() - place.facet).max(0.0)
}
