//! A given share of the pairs.

use super::{Ranking, Selected};
use crate::registration::icp::correspondence::Correspondence;

/// Keeps the closest pairs up to `share` of the data weight, at least one.
pub(super) fn keep_share(pairs: &[Correspondence], ranking: Ranking, share: f64) -> Selected {
    let Ranking { mut order, total } = ranking;
    let (mut weight, mut sum) = (0.0, 0.0);
    let mut n_kept = 0;
    for &i in &order {
        let pair = &pairs[i as usize];
        // The last digits of a sum of weights must not decide whether the last point counts.
        if n_kept > 0 && weight + pair.weight > share * total * (1.0 + 1e-9) {
            break;
        }
        weight += pair.weight;
        sum += pair.weight * pair.distance_sq;
        n_kept += 1;
    }
    order.truncate(n_kept);
    let mse = sum / weight;
    Selected {
        kept: order,
        fraction: weight / total,
        mse,
        objective: mse.sqrt(),
    }
}
