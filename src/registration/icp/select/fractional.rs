//! The share of the pairs that minimises the fractional objective.

use super::{Ranking, Selected};
use crate::registration::icp::correspondence::Correspondence;

/// Keeps the share f in `bounds` that minimises f^−λ · √(MSE(f) + floor²), evaluated at every
/// prefix of the sorted pairs (Phillips, Liu, Tomasi 2007).
pub(super) fn best_share(
    pairs: &[Correspondence],
    ranking: Ranking,
    lambda: f64,
    floor: f64,
    bounds: [f64; 2],
) -> Selected {
    let Ranking { mut order, total } = ranking;
    let [min_share, max_share] = bounds;
    let (mut weight, mut sum) = (0.0, 0.0);
    let mut best = (f64::INFINITY, 0, 0.0, 0.0);
    for (rank, &i) in order.iter().enumerate() {
        let pair = &pairs[i as usize];
        weight += pair.weight;
        sum += pair.weight * pair.distance_sq;
        let fraction = weight / total;
        if fraction > max_share && best.1 > 0 {
            break;
        }
        let is_last = rank + 1 == order.len();
        if fraction < min_share && !is_last {
            continue;
        }
        let mse = sum / weight;
        let objective = fraction.powf(-lambda) * (mse + floor * floor).sqrt();
        // Of equal objectives the larger share wins: without a floor a perfect fit is 0 everywhere.
        if objective <= best.0 || best.1 == 0 {
            best = (objective, rank + 1, fraction, mse);
        }
    }
    let (objective, n_kept, fraction, mse) = best;
    order.truncate(n_kept);
    Selected {
        kept: order,
        fraction,
        mse,
        objective,
    }
}
