//! How much the evidence of a pose leaves open: the solutions without one patch of the part after the other, and what
//! noise alone does to them (delete-group jackknife, Shao and Tu 1995).

use std::ops::AddAssign;

use nalgebra::{DMatrix, SVector, SymmetricEigen};

use super::evidence::PoseEvidence;
use super::least_squares::NormalEquations;
use crate::geometry::{Point3, Vector3};
use crate::search::PointTree;

/// Halvings of the part: 2⁴ patches are left out one after the other.
const LEVELS: u32 = 4;

/// Residuals that count as independent of each other in all.
const INDEPENDENT: f64 = 64.0;

/// The patches of the part.
pub(super) struct Patches {
    /// That of each place where the parts meet.
    of_places: Vec<usize>,
    /// That of each pair of borders.
    of_borders: Vec<usize>,
    len: usize,
}

impl Patches {
    /// O(places · log places).
    pub(super) fn of(evidence: &PoseEvidence<'_>) -> Self {
        let contacts = &evidence.contacts;
        let of_places = contacts.patches(LEVELS);
        let points: Vec<Point3> = contacts.list.iter().map(|c| c.point).collect();
        let tree = PointTree::build(points);
        // A border belongs to the patch of the place nearest to it, which is near in every sense.
        let patch_at = |point: &Point3| {
            let nearest = tree.nearest(point, f64::INFINITY, None)?;
            Some(of_places[nearest.index as usize])
        };
        let pairs = evidence.borders.pairs().iter();
        let of_borders = pairs.map_while(|pair| patch_at(&pair.point)).collect();
        let len = of_places.iter().max().map_or(0, |last| last + 1);
        Self {
            of_places,
            of_borders,
            len,
        }
    }

    /// The equations of each patch for the unknowns that close the gaps. `weights` are those of the places; `row` says
    /// how much each unknown moves a point along a direction, and how much an offset of one does.
    pub(super) fn equations<const N: usize>(
        &self,
        evidence: &PoseEvidence<'_>,
        weights: &[f64],
        row: impl Fn(&Point3, &Vector3, f64) -> SVector<f64, N>,
    ) -> Vec<NormalEquations<N>> {
        let mut parts = vec![NormalEquations::default(); self.len];
        let places = evidence.contacts.list.iter().zip(weights);
        for ((contact, &weight), &patch) in places.zip(&self.of_places) {
            let row = row(&contact.point, &contact.normal, 1.0);
            parts[patch].add_symmetric(&row, -contact.gap, weight);
        }
        let pairs = evidence.borders.pairs().iter();
        let pairs = pairs.zip(evidence.borders.weights(evidence.noise));
        for ((pair, weight), &patch) in pairs.zip(&self.of_borders) {
            let row = row(&pair.point, &pair.across, 0.0);
            parts[patch].add_symmetric(&row, -pair.gap, weight);
        }
        parts
    }
}

/// All the equations together.
pub(super) fn sum<const N: usize>(parts: &[NormalEquations<N>]) -> NormalEquations<N> {
    let mut all = NormalEquations::default();
    for part in parts {
        all.add_assign(part);
    }
    all
}

/// How far the solutions without one of the parts lie from that of all, scaled so that their squares sum to the square
/// of its uncertainty.
pub(super) fn replicates<const N: usize>(
    parts: &[NormalEquations<N>],
    all: &NormalEquations<N>,
) -> impl Iterator<Item = SVector<f64, N>> {
    let n = parts.len() as f64;
    let (scale, whole) = (((n - 1.0) / n).sqrt(), all.solved());
    parts
        .iter()
        .map(move |part| ((all - part).solved() - whole) * scale)
}

/// What noise alone leaves open: the residuals of the places counted as so many independent ones. It is small beside
/// the replicates except for motions that hardly anything resists, such as the turn of a cup, which a missing patch
/// does not show. Nothing is open by more than the radius of the places.
pub(super) fn left_open<const N: usize>(
    equations: &NormalEquations<N>,
    evidence: &PoseEvidence<'_>,
    weights: &[f64],
    residuals: &[f64],
) -> impl Iterator<Item = SVector<f64, N>> + use<N> {
    let (noise, most) = (evidence.noise, evidence.contacts.radius);
    let total = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let squares = residuals.iter().zip(weights);
    let squares: f64 = squares.map(|(left, weight)| weight * left * left).sum();
    let variance = (squares / total).max(noise * noise);
    let matrix = DMatrix::from_iterator(N, N, equations.matrix.iter().copied());
    let eigen = SymmetricEigen::new(matrix);
    (0..N).map(move |k| {
        let stiffness = eigen.eigenvalues[k].max(0.0) / total;
        let open = variance / (INDEPENDENT * stiffness).max(f64::MIN_POSITIVE);
        let direction = eigen.eigenvectors.column(k);
        SVector::from_iterator(direction.iter().copied()) * open.sqrt().min(most)
    })
}
