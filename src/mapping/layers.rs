//! From the layers of one rule to those of another, linear in the layer values.

use super::rule::{LayerRule, RuleKind};

/// How values pass from the layers of the source to those of the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LayerBalance {
    /// Linear between neighbouring layers, extrapolated beyond the outermost. Nearest to the profile.
    #[default]
    Linear,
    /// Linear, corrected so that the integrals of σ and of σ·T over the thickness stay: membrane
    /// force and bending moment are kept at the price of some accuracy at the single layer. The target's
    /// are those that the solver sums up with the weights of its rule.
    ForceAndMoment,
}

/// Target layer values as weighted sums of source layer values.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerMatrix {
    n_source: usize,
    /// Row by row, one row for each target layer.
    weights: Vec<f64>,
    is_identity: bool,
}

impl LayerMatrix {
    /// The matrix from `source` to `target`. Rules with the same places give the identity, so that
    /// values pass bit for bit. An empty source gives no rows.
    pub fn new(source: &LayerRule, target: &LayerRule, balance: LayerBalance) -> Self {
        let n_source = source.len();
        if n_source == 0 {
            return Self {
                n_source,
                weights: Vec::new(),
                is_identity: false,
            };
        }
        if source.has_places(target.places()) {
            let entry = |i: usize| {
                if i.is_multiple_of(n_source + 1) {
                    1.0
                } else {
                    0.0
                }
            };
            return Self {
                n_source,
                weights: (0..n_source * n_source).map(entry).collect(),
                is_identity: true,
            };
        }
        let rows = target
            .places()
            .iter()
            .map(|&t| linear_row(source.places(), t));
        let mut weights: Vec<f64> = rows.flatten().collect();
        if balance == LayerBalance::ForceAndMoment {
            keep_force_and_moment(&mut weights, source, target);
        }
        Self {
            n_source,
            weights,
            is_identity: false,
        }
    }

    /// True if target layers are the source layers.
    pub fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// Weights of the source layers, one row for each target layer.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.weights.chunks_exact(self.n_source.max(1))
    }
}

/// Weights that interpolate linearly at `t`, or extrapolate from the two outermost layers.
fn linear_row(places: &[f64], t: f64) -> Vec<f64> {
    let mut row = vec![0.0; places.len()];
    if places.len() == 1 {
        row[0] = 1.0;
        return row;
    }
    let above = places.partition_point(|&place| place <= t);
    let upper = above.clamp(1, places.len() - 1);
    let (low, high) = (places[upper - 1], places[upper]);
    let share = if high > low {
        (t - low) / (high - low)
    } else {
        0.0
    };
    row[upper - 1] = 1.0 - share;
    row[upper] += share;
    row
}

/// The integrals of σ and of σ·T over the thickness that each source layer adds with σ = 1.
///
/// A quadrature has its weights. Other places come from writers of many kinds, and what their solver summed up
/// is not known; there the profile is the one that values are taken from, linear between the layers and
/// beyond. So a linear profile has the same force and moment whatever the places are.
fn forces_and_moments(source: &LayerRule) -> Vec<[f64; 2]> {
    if source.is_quadrature() {
        return moment_weights(source).map(|(w, t)| [w, w * t]).collect();
    }
    let inner = source.places().iter().copied();
    let inner = inner.filter(|place| (-1.0..1.0).contains(place) && *place > -1.0);
    let ends: Vec<f64> = [-1.0].into_iter().chain(inner).chain([1.0]).collect();
    let mut sums = vec![[0.0; 2]; source.len()];
    for pair in ends.windows(2) {
        let (middle, half) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
        // Two Gauss points are exact for the squares that a linear value times T makes.
        for (weight, place) in moment_weights(&LayerRule::new(RuleKind::Gauss, 2)) {
            let t = middle + half * place;
            for (sum, share) in sums.iter_mut().zip(linear_row(source.places(), t)) {
                sum[0] += half * weight * share;
                sum[1] += half * weight * share * t;
            }
        }
    }
    sums
}

/// Adds a constant and a linear part to every column, so that for any source values the sums
/// Σ w σ and Σ w T σ over the target layers are the force and the moment of the source.
fn keep_force_and_moment(weights: &mut [f64], source: &LayerRule, target: &LayerRule) {
    let n = source.len();
    let of_source = forces_and_moments(source);
    let second_moment: f64 = moment_weights(target).map(|(w, t)| w * t * t).sum();
    for column in 0..n {
        let mapped = |power: i32| -> f64 {
            moment_weights(target)
                .enumerate()
                .map(|(row, (w, t))| w * t.powi(power) * weights[row * n + column])
                .sum()
        };
        let [force, moment] = of_source[column];
        let constant = (force - mapped(0)) / 2.0;
        let slope = if second_moment > 0.0 {
            (moment - mapped(1)) / second_moment
        } else {
            0.0
        };
        for (row, &place) in target.places().iter().enumerate() {
            weights[row * n + column] += constant + slope * place;
        }
    }
}

fn moment_weights(rule: &LayerRule) -> impl Iterator<Item = (f64, f64)> {
    rule.weights()
        .iter()
        .copied()
        .zip(rule.places().iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(
        source: (RuleKind, usize),
        target: (RuleKind, usize),
        b: LayerBalance,
    ) -> LayerMatrix {
        let rule = |(kind, n)| LayerRule::new(kind, n);
        LayerMatrix::new(&rule(source), &rule(target), b)
    }

    fn close(row: &[f64], expected: &[f64]) {
        assert_eq!(row.len(), expected.len());
        for (a, b) in row.iter().zip(expected) {
            assert!((a - b).abs() < 1e-6, "{row:?} against {expected:?}");
        }
    }

    #[test]
    fn rows_worked_out_by_hand() {
        use RuleKind::Gauss;
        let corrected = matrix((Gauss, 5), (Gauss, 3), LayerBalance::ForceAndMoment);
        let rows: Vec<&[f64]> = corrected.rows().collect();
        close(
            rows[0],
            &[0.510_622, 0.618_287, -0.16, 0.019_384, 0.011_708],
        );
        close(
            rows[1],
            &[-0.059_913, 0.139_913, 0.84, 0.139_913, -0.059_913],
        );
        let linear = matrix((Gauss, 5), (Gauss, 3), LayerBalance::Linear);
        close(
            linear.rows().next().unwrap(),
            &[0.642_156, 0.357_844, 0.0, 0.0, 0.0],
        );
        let beyond = matrix((Gauss, 3), (Gauss, 5), LayerBalance::Linear);
        close(beyond.rows().next().unwrap(), &[1.169_873, -0.169_873, 0.0]);
    }

    /// Pairs of a source and a target: rules of all kinds, and for the source places that are no rule.
    fn pairs() -> Vec<(LayerRule, LayerRule)> {
        let kinds = [RuleKind::Gauss, RuleKind::Lobatto, RuleKind::Equal];
        let targets = (1..13).flat_map(|n| kinds.map(|kind| LayerRule::new(kind, n)));
        let targets: Vec<LayerRule> = targets.collect();
        let others = [
            vec![-0.5, 0.5],
            vec![-0.906, -0.538, 0.0, 0.538, 0.906],
            vec![-0.8, -0.4, 0.0, 0.4, 0.8],
            vec![-1.0, -0.3, 0.9],
            vec![0.4],
        ];
        let others = others.into_iter().map(LayerRule::from_places);
        let sources = targets.iter().cloned().chain(others);
        sources
            .flat_map(|source| {
                targets
                    .iter()
                    .map(move |target| (source.clone(), target.clone()))
            })
            .collect()
    }

    fn mapped(matrix: &LayerMatrix, values: &[f64]) -> Vec<f64> {
        let rows = matrix.rows();
        rows.map(|row| row.iter().zip(values).map(|(w, v)| w * v).sum())
            .collect()
    }

    #[test]
    fn every_pair_of_rules_keeps_constants_force_and_moment() {
        for (source, target) in &pairs() {
            let matrix = LayerMatrix::new(source, target, LayerBalance::ForceAndMoment);
            for row in matrix.rows() {
                assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            }
            if matrix.is_identity() {
                continue;
            }
            let values: Vec<f64> = (0..source.len()).map(|i| (i as f64 * 1.7).sin()).collect();
            let of_source = forces_and_moments(source).into_iter().zip(&values);
            let [force, moment] = of_source.fold([0.0; 2], |sum, (share, value)| {
                [sum[0] + share[0] * value, sum[1] + share[1] * value]
            });
            let terms = moment_weights(target).zip(mapped(&matrix, &values));
            let (force_mapped, moment_mapped) =
                terms.fold((0.0, 0.0), |(f, m), ((w, t), v)| (f + w * v, m + w * t * v));
            assert!((force - force_mapped).abs() < 1e-12);
            if target.len() > 1 {
                assert!((moment - moment_mapped).abs() < 1e-12);
            }
        }
    }

    /// The trapezoidal rule gives a linear profile too large a moment, so targets of that rule have less
    /// of it at their layers.
    #[test]
    fn a_linear_profile_stays_whatever_the_places_are() {
        for (source, target) in &pairs() {
            let profile: Vec<f64> = source.places().iter().map(|t| 30.0 + 100.0 * t).collect();
            let squares: f64 = moment_weights(target).map(|(w, t)| w * t * t).sum();
            let slope = 100.0
                * if target.len() > 1 {
                    2.0 / 3.0 / squares
                } else {
                    1.0
                };
            for balance in [LayerBalance::Linear, LayerBalance::ForceAndMoment] {
                let matrix = LayerMatrix::new(source, target, balance);
                let is_scaled = balance == LayerBalance::ForceAndMoment && !matrix.is_identity();
                let slope = if is_scaled { slope } else { 100.0 };
                for (value, t) in mapped(&matrix, &profile).iter().zip(target.places()) {
                    let expected = match source.len() {
                        1 => profile[0],
                        _ => 30.0 + slope * t,
                    };
                    assert!((value - expected).abs() < 1e-10, "{source:?} to {target:?}");
                }
                if target.is_quadrature() && target.len() > 1 {
                    assert!((slope - 100.0).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn equal_rules_pass_values_as_they_are() {
        let same = matrix(
            (RuleKind::Gauss, 5),
            (RuleKind::Gauss, 5),
            LayerBalance::Linear,
        );
        assert!(same.is_identity());
        assert_eq!(same.rows().nth(2).unwrap(), [0.0, 0.0, 1.0, 0.0, 0.0]);
    }
}
