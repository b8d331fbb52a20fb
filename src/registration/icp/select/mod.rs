//! Which pairs are kept: all, the closest given share, or the share that explains most.

mod fractional;
mod trimmed;

use serde::{Deserialize, Serialize};

use super::correspondence::Correspondence;

/// The floor under the root of the fractional objective (σ0).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Floor {
    /// Estimated from the meshes: how far facets lie from the smooth surface they stand for.
    #[default]
    Auto,
    /// A length in target units, for example an expected springback.
    Length(f64),
    /// No floor, as published. On exact meshes the fraction then tends to collapse, because flat
    /// areas fit without any error.
    None,
}

/// Which of the pairs are kept in an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairSelection {
    /// All pairs (Besl and McKay 1992).
    All,
    /// The share `overlap` of the data area with the smallest distances (Chetverikov et al. 2005).
    Trimmed {
        /// Share to keep, 0 < overlap ≤ 1.
        overlap: f64,
    },
    /// As `Trimmed`, with the overlap ξ from 0.4 up that minimises √(MSE + floor²)·ξ^−1.5, searched anew in every
    /// iteration over all shares (Chetverikov et al. minimise MSE·ξ⁻³, by golden section over whole runs).
    TrimmedSearch,
    /// The share f that minimises f^−λ · √(MSE + floor²) (Phillips, Liu, Tomasi 2007, with a floor).
    Fractional {
        /// Price of leaving points out; larger keeps more.
        lambda: f64,
        /// Model error expected between perfectly placed meshes.
        floor: Floor,
    },
}

impl Default for PairSelection {
    fn default() -> Self {
        Self::Fractional {
            lambda: Self::USUAL_LAMBDA,
            floor: Floor::Auto,
        }
    }
}

impl PairSelection {
    /// λ of Fractional ICP unless another is asked for.
    pub const USUAL_LAMBDA: f64 = 1.5;
    /// Fraction that Trimmed ICP keeps unless another is asked for.
    pub const USUAL_OVERLAP: f64 = 0.8;
}

/// Bounds and floor for one selection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SelectRules {
    pub(crate) selection: PairSelection,
    /// σ0 in force, 0 for none.
    pub(crate) floor: f64,
    /// Largest share that geometry allows.
    pub(crate) max_fraction: f64,
}

/// The kept pairs and what they are worth.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Selected {
    /// Indices of kept pairs, closest first.
    pub(crate) kept: Vec<u32>,
    /// Kept weight over the weight of all data points.
    pub(crate) fraction: f64,
    /// Weighted mean square distance of the kept pairs.
    pub(crate) mse: f64,
    /// What the selection minimises, in length units.
    pub(crate) objective: f64,
}

/// Sorted prefix sums over the pairs that have a partner.
struct Ranking {
    order: Vec<u32>,
    /// Weight of all data points, with or without partner.
    total: f64,
}

impl Ranking {
    fn of(pairs: &[Correspondence]) -> Self {
        let mut order: Vec<u32> = (0..pairs.len() as u32)
            .filter(|&i| {
                pairs[i as usize].distance_sq.is_finite() && pairs[i as usize].weight > 0.0
            })
            .collect();
        order.sort_unstable_by(|&a, &b| {
            let (x, y) = (&pairs[a as usize], &pairs[b as usize]);
            x.distance_sq.total_cmp(&y.distance_sq).then(a.cmp(&b))
        });
        let total = pairs.iter().map(|pair| pair.weight).sum();
        Self { order, total }
    }
}

/// Keeps pairs by `rules`. `None` if no pair has a partner. O(n log n).
pub(crate) fn select(pairs: &[Correspondence], rules: &SelectRules) -> Option<Selected> {
    let ranking = Ranking::of(pairs);
    if ranking.order.is_empty() {
        return None;
    }
    let selected = match rules.selection {
        PairSelection::All => trimmed::keep_share(pairs, ranking, 1.0),
        PairSelection::Trimmed { overlap } => trimmed::keep_share(pairs, ranking, overlap),
        PairSelection::TrimmedSearch => {
            // ψ(ξ) = e·ξ^−(1+λ) with λ = 2 is the square of the fractional objective at 1.5.
            let bounds = [0.4, rules.max_fraction];
            fractional::best_share(pairs, ranking, 1.5, rules.floor, bounds)
        }
        PairSelection::Fractional { lambda, .. } => {
            let bounds = [0.05, rules.max_fraction];
            fractional::best_share(pairs, ranking, lambda, rules.floor, bounds)
        }
    };
    Some(selected)
}
