//! The choice between the pose of the closest pairs and that of all of them. Where springback bends a part, its
//! middle fits best when the part is turned or slid on the other, up to fifty times as far as it is bent. Pairs that
//! are left out then lie where nothing belongs, and so do holes and borders.

use std::cmp::Ordering;

use super::candidate::LITTLE_LESS;
use super::context::PairContext;
use crate::assess::borders::{Borders, HolePair};
use crate::assess::contact::{MAX_NODES, STATED_SHARE};
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Poses closer than this share of what may remain of the distances are one.
const SAME: f64 = 0.2;
/// Holes and borders support the pose under which they lie apart by less than this share of what they do under the
/// other. An addendum keeps borders apart under both.
const CLOSER_HOLES: f64 = 0.9;
const CLOSER_BORDERS: f64 = 0.95;
/// What they gain at least, as a share of what may remain of the distances.
const LEAST_GAIN: f64 = 0.3;
/// Where holes do not decide, the surfaces lie apart by at most this share too, over 95 % of the area: a flange of
/// another version turns a part that otherwise fits, and hardly comes closer.
const CLOSER_SURFACES: f64 = 0.75;
/// Distances that differ by a smaller factor are the same.
const SAME_DISTANCE: f64 = 1.02;

/// Whether the second pose, which keeps all pairs, is better than the first, which keeps the closest ones: as much of
/// the parts meets, they lie as close, and their holes lie closer together, or where those do not decide their borders
/// and clearly their surfaces. What only one part has pulls at all pairs, and holes and borders apart.
/// O(border edges + nodes · log triangles).
pub fn is_better_with_all_pairs(
    context: &PairContext<'_>,
    [closest, all]: [&Similarity; 2],
) -> Result<bool, Cancelled> {
    context.check()?;
    let distances = context.distances(closest.scale);
    let (near, remainder) = (distances.first_border_reach, distances.tolerance.remainder);
    if context.displacement(closest, all) <= SAME * remainder {
        return Ok(false);
    }
    let comparison = context.borders(closest.scale, near);
    let [before, after] = [closest, all].map(|pose| comparison.at(pose));
    let is_less = |a: f64, b: f64, share: f64| a < (share * b).min(b - LEAST_GAIN * remainder);
    let borders_gain = is_less(after.apart(near), before.apart(near), CLOSER_BORDERS);
    let most_of_surfaces = match by_holes(&before, &after, is_less) {
        Ordering::Greater => f64::INFINITY,
        Ordering::Equal if borders_gain => CLOSER_SURFACES,
        _ => return Ok(false),
    };
    context.check()?;
    let mut contacts = context.contacts(closest.scale, near, MAX_NODES);
    let mut met = |pose: &Similarity| {
        let contacts = contacts.at(pose)?;
        Some(Met {
            share: contacts.share,
            typical: contacts.typical_gap(remainder),
            far: contacts.at_share(&contacts.without_offset(remainder), STATED_SHARE),
        })
    };
    let (Some(before), Some(after)) = (met(closest), met(all)) else {
        return Ok(false);
    };
    Ok(after.share >= before.share - LITTLE_LESS
        && after.typical <= SAME_DISTANCE * before.typical
        && after.far <= most_of_surfaces * before.far)
}

/// How the surfaces meet under a pose.
struct Met {
    /// Share of the smaller part.
    share: f64,
    /// Distance of the surfaces there, root mean square and at 95 % of the area.
    typical: f64,
    far: f64,
}

/// Whether the holes support the second pose (`Greater`) or the first (`Less`): more of them have their
/// counterpart there and no more lie where the other part is solid, or as many and they lie closer together, as
/// `is_less` decides.
fn by_holes(
    before: &Borders,
    after: &Borders,
    is_less: impl Fn(f64, f64, f64) -> bool,
) -> Ordering {
    let n_missing = |borders: &Borders| borders.missing.iter().map(Vec::len).sum::<usize>();
    let has_more =
        |a: &Borders, b: &Borders| a.holes.len() > b.holes.len() && n_missing(a) <= n_missing(b);
    let off = |borders: &Borders| {
        // Across its sheet the middle of a hole moves with the surface, which is compared already.
        let within = |pair: &HolePair| pair.off.cross(&pair.hole.normal).norm_squared();
        let sum: f64 = borders.holes.iter().map(within).sum();
        (sum / borders.holes.len().max(1) as f64).sqrt()
    };
    let is_closer = |a: &Borders, b: &Borders| {
        a.holes.len() == b.holes.len() && is_less(off(a), off(b), CLOSER_HOLES)
    };
    if has_more(after, before) || is_closer(after, before) {
        Ordering::Greater
    } else if has_more(before, after) || is_closer(before, after) {
        Ordering::Less
    } else {
        Ordering::Equal
    }
}
