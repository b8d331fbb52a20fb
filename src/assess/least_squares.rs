//! Weighted least squares over a few unknowns, and the weights and quantiles that keep single places from deciding.

use std::ops::{AddAssign, Range, Sub};

use nalgebra::{DMatrix, SMatrix, SVector, SymmetricEigen};

/// Directions that meet less than this share of the resistance of the stiffest one are left alone.
const RANK: f64 = 1e-7;
/// Values beyond so many standard deviations have no weight (Tukey's biweight, 95 % efficient on normal errors).
const BIWEIGHT: f64 = 4.7;
/// Standard deviation over median distance, of normal errors.
const MEDIAN_TO_SIGMA: f64 = 1.48;

/// The normal equations of Σ weight · (row · unknowns − value)² over `N` unknowns.
#[derive(Debug, Clone)]
pub(crate) struct NormalEquations<const N: usize> {
    pub(super) matrix: SMatrix<f64, N, N>,
    pub(super) right: SVector<f64, N>,
}

impl<const N: usize> Default for NormalEquations<N> {
    fn default() -> Self {
        Self {
            matrix: SMatrix::zeros(),
            right: SVector::zeros(),
        }
    }
}

impl<const N: usize> NormalEquations<N> {
    /// Those of many rows, each with a value and a weight. O(rows · N²).
    pub(super) fn of(rows: &[SVector<f64, N>], values: &[f64], weights: &[f64]) -> Self {
        let mut sum = Self::default();
        for ((row, value), weight) in rows.iter().zip(values).zip(weights) {
            sum.add(row, *value, *weight);
        }
        sum
    }

    /// Adds one equation.
    pub(super) fn add(&mut self, row: &SVector<f64, N>, value: f64, weight: f64) {
        self.matrix.ger(weight, row, row, 1.0);
        self.right += row * (weight * value);
    }

    /// The same, rounded so that the matrix stays symmetric to the last bit.
    pub(crate) fn add_symmetric(&mut self, row: &SVector<f64, N>, value: f64, weight: f64) {
        self.matrix += row * row.transpose() * weight;
        self.right += row * (weight * value);
    }

    /// Keeps these unknowns at zero.
    pub(super) fn leave_out(&mut self, unknowns: Range<usize>) {
        let (first, n) = (unknowns.start, unknowns.len());
        self.matrix.rows_mut(first, n).fill(0.0);
        self.matrix.columns_mut(first, n).fill(0.0);
        self.right.rows_mut(first, n).fill(0.0);
    }

    /// The unknowns; those that the equations do not determine are zero.
    pub(crate) fn solved(&self) -> SVector<f64, N> {
        solve(&self.matrix, &self.right)
    }

    /// What of an unknown the others can imitate.
    pub(super) fn imitated(&self, unknown: usize) -> Imitated<N> {
        let whole = self.matrix[(unknown, unknown)];
        let mut mixed: SVector<f64, N> = self.matrix.column(unknown).into();
        mixed[unknown] = 0.0;
        let mut others = self.clone();
        others.leave_out(unknown..unknown + 1);
        let by = solve(&others.matrix, &mixed);
        let own = whole - mixed.dot(&by);
        Imitated {
            by,
            own_share: own / whole.max(f64::MIN_POSITIVE),
        }
    }
}

/// How well the other unknowns imitate one of them.
pub(super) struct Imitated<const N: usize> {
    /// The others that come closest to one unit of it.
    pub(super) by: SVector<f64, N>,
    /// Share of its column that lies outside the span of theirs: with 0 it cannot be separated from them.
    pub(super) own_share: f64,
}

impl<const N: usize> AddAssign<&Self> for NormalEquations<N> {
    fn add_assign(&mut self, part: &Self) {
        self.matrix += part.matrix;
        self.right += part.right;
    }
}

impl<const N: usize> Sub for &NormalEquations<N> {
    type Output = NormalEquations<N>;

    fn sub(self, part: Self) -> NormalEquations<N> {
        NormalEquations {
            matrix: self.matrix - part.matrix,
            right: self.right - part.right,
        }
    }
}

/// The solution of normal equations; directions that they do not determine stay zero.
fn solve<const N: usize>(matrix: &SMatrix<f64, N, N>, right: &SVector<f64, N>) -> SVector<f64, N> {
    let mut solution = SVector::<f64, N>::zeros();
    if !matrix.iter().chain(right.iter()).all(|x| x.is_finite()) {
        return solution;
    }
    // The decomposition of a fixed size has bounds that a const parameter cannot meet.
    let eigen = SymmetricEigen::new(DMatrix::from_iterator(N, N, matrix.iter().copied()));
    let stiffest = eigen.eigenvalues.max();
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > RANK * stiffest {
            let along: f64 = vector.iter().zip(right.iter()).map(|(a, b)| a * b).sum();
            for (x, v) in solution.iter_mut().zip(vector.iter()) {
                *x += v * along / value;
            }
        }
    }
    solution
}

/// A weight for each value: its area, less the farther the value lies from zero (Tukey's biweight with the median
/// distance as its scale). Distances up to `floor` are negligible.
pub(super) fn robust_weights(values: &[f64], areas: &[f64], floor: f64) -> Vec<f64> {
    let sizes = values.iter().map(|v| v.abs()).zip(areas.iter().copied());
    let median = quantile(&mut sizes.collect::<Vec<_>>(), 0.5);
    let cut = BIWEIGHT * (MEDIAN_TO_SIGMA * median).max(floor).max(f64::MIN_POSITIVE);
    let weight = |(value, area): (&f64, &f64)| {
        let ratio = value / cut;
        if ratio.abs() < 1.0 {
            area * (1.0 - ratio * ratio).powi(2)
        } else {
            0.0
        }
    };
    values.iter().zip(areas).map(weight).collect()
}

/// Weighted quantile; reorders. 0 without values. O(values).
pub(crate) fn quantile(values: &mut [(f64, f64)], share: f64) -> f64 {
    let weight_of = |values: &[(f64, f64)]| values.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut wanted = share * weight_of(values);
    let mut rest = values;
    while !rest.is_empty() {
        let by_value =
            |a: &(f64, f64), b: &(f64, f64)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
        let (below, &mut (value, weight), above) =
            rest.select_nth_unstable_by(rest.len() / 2, by_value);
        let weight_below = weight_of(below);
        if weight_below >= wanted && !below.is_empty() {
            rest = below;
        } else if weight_below + weight >= wanted || above.is_empty() {
            return value;
        } else {
            wanted -= weight_below + weight;
            rest = above;
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weighted_quantile_is_that_of_the_sorted_values() {
        for n in 1..40 {
            // Whole weights, so that sums do not depend on their order; some values and weights repeat.
            let values: Vec<(f64, f64)> = (0..n)
                .map(|i| (f64::from(i * 17 % 11), f64::from(i * 7 % 5)))
                .collect();
            let mut sorted = values.clone();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let total: f64 = values.iter().map(|(_, weight)| weight).sum();
            for share in [0.0, 0.25, 0.5, 0.75, 0.9, 1.0] {
                let mut below = 0.0;
                let expected = sorted.iter().find(|(_, weight)| {
                    below += weight;
                    below >= share * total
                });
                let found = quantile(&mut values.clone(), share);
                assert_eq!(found, expected.unwrap().0, "{share} of {n}");
            }
        }
        assert_eq!(quantile(&mut [], 0.5), 0.0);
    }
}
