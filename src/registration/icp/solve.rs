//! The normal equations of a linearised step and their damped solution.

use nalgebra::{SMatrix, SVector, SymmetricEigen};

use crate::geometry::{Point3, Vector3};

/// Directions stiffer than this share of the stiffest are solved for, the others are left alone:
/// there the surface slides on itself.
const RANK_TOLERANCE: f64 = 1e-9;
/// Independent places that the residuals stand for. What a part of another shape leaves of them is
/// the same over large areas, so thousands of points determine no more than a few places.
const N_PLACES: f64 = 16.0;

/// How much each unknown changes a residual.
pub(super) struct Row {
    pub(super) rotation: Vector3,
    pub(super) translation: Vector3,
    /// A relative change of scale.
    pub(super) scale: f64,
}

/// Sum of weighted rows aᵀx ≈ r with three rotations, three translations and one scale.
///
/// Lengths are divided by `length`, so that rotations and translations compare.
pub(super) struct StepEquations {
    length: f64,
    matrix: SMatrix<f64, 7, 7>,
    rhs: SVector<f64, 7>,
    residual_sq: f64,
}

/// How the normal equations are solved.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolveRules {
    /// Shortens a step, after one that made things worse: by 1 / (1 + damping).
    pub(super) damping: f64,
    /// How far a step is likely to move the data.
    pub(super) likely_motion: f64,
    /// True if the scale is solved for too.
    pub(super) with_scale: bool,
}

/// Solution in the caller's lengths.
pub(super) struct Solution {
    pub(super) rotation: Vector3,
    pub(super) translation: Vector3,
    /// Relative change of scale.
    pub(super) scale: f64,
}

impl StepEquations {
    /// Where the scale stands, behind rotation and translation.
    const SCALE: usize = 6;

    pub(super) fn new(length: f64) -> Self {
        Self {
            length,
            matrix: SMatrix::zeros(),
            rhs: SVector::zeros(),
            residual_sq: 0.0,
        }
    }

    /// Adds weight · (rotation·ω + translation·τ + scale·s − residual)².
    pub(super) fn add(&mut self, row: &Row, residual: f64, weight: f64) {
        let inverse = 1.0 / self.length;
        let Row {
            rotation,
            translation,
            scale,
        } = row;
        let row = [
            rotation.x * inverse,
            rotation.y * inverse,
            rotation.z * inverse,
            translation.x,
            translation.y,
            translation.z,
            scale * inverse,
        ];
        let residual = residual * inverse;
        self.residual_sq += weight * residual * residual;
        for i in 0..7 {
            let weighted = row[i] * weight;
            for (j, value) in row.iter().enumerate().skip(i) {
                self.matrix[(j, i)] += weighted * value;
            }
            self.rhs[i] += weighted * residual;
        }
    }

    /// The least-squares solution over the directions that the rows fix; the scale stays untouched
    /// unless asked for. `None` if nothing is fixed.
    ///
    /// A direction that hardly changes the residuals is followed no farther than what remains of them
    /// supports (ridge regression, Hoerl and Kennard 1970): a flat plate that sprang back would
    /// otherwise slide by hundreds of millimetres to better a millimetre.
    pub(super) fn solve(&self, rules: &SolveRules) -> Option<Solution> {
        let mut matrix = self.matrix;
        matrix.fill_upper_triangle_with_lower_triangle();
        let mut rhs = self.rhs;
        if !rules.with_scale {
            matrix.row_mut(Self::SCALE).fill(0.0);
            matrix.column_mut(Self::SCALE).fill(0.0);
            rhs[Self::SCALE] = 0.0;
        }
        if !matrix.iter().chain(rhs.iter()).all(|x| x.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::new(matrix);
        let largest = eigen.eigenvalues.max();
        if largest <= 0.0 {
            return None;
        }
        let fixed = || (0..7).filter(|&k| eigen.eigenvalues[k] > RANK_TOLERANCE * largest);
        let force = |k: usize| eigen.eigenvectors.column(k).dot(&rhs);
        let explained: f64 = fixed()
            .map(|k| force(k).powi(2) / eigen.eigenvalues[k])
            .sum();
        let remaining = (self.residual_sq - explained).max(0.0);
        let ridge = remaining / N_PLACES * (self.length / rules.likely_motion).powi(2);
        let mut solution = SVector::<f64, 7>::zeros();
        for k in fixed() {
            let stiffness = eigen.eigenvalues[k] * (1.0 + rules.damping) + ridge;
            solution += eigen.eigenvectors.column(k) * (force(k) / stiffness);
        }
        let translation: Vector3 = solution.fixed_rows::<3>(3).into();
        Some(Solution {
            rotation: solution.fixed_rows::<3>(0).into(),
            translation: translation * self.length,
            scale: solution[Self::SCALE],
        })
    }
}

/// Weighted centroid and mean distance to it of some points, in index order.
pub(super) fn center_and_radius<'a>(
    points: impl Iterator<Item = (&'a Point3, f64)> + Clone,
) -> Option<(Point3, f64)> {
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for (point, weight) in points.clone() {
        sum += point.coords * weight;
        total += weight;
    }
    if total <= 0.0 {
        return None;
    }
    let center = Point3::from(sum / total);
    let mean = points.map(|(p, w)| (p - center).norm() * w).sum::<f64>() / total;
    (mean > 0.0 && mean.is_finite()).then_some((center, mean))
}
