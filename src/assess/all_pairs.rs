//! The choice between the pose of the closest pairs and that of all of them. Where springback bends a part, its
//! middle fits best when the part is turned or slid on the other, up to fifty times as far as it is bent. Pairs that
//! are left out then lie where nothing belongs, and so do holes and borders.

use std::cmp::Ordering;

use super::borders::{BorderComparison, Borders};
use super::contact::{ContactSearch, MAX_NODES};
use super::held::near;
use super::tolerance::{AssessSettings, Distances};
use crate::geometry::Similarity;
use crate::registration::Surface;

/// Poses closer than this share of what may remain of the distances are one.
const SAME: f64 = 0.2;
/// Holes and borders speak for the pose under which they lie apart by less than this share of what they do under the
/// other. An addendum keeps borders apart under both.
const CLOSER_HOLES: f64 = 0.9;
const CLOSER_BORDERS: f64 = 0.95;
/// The parts still meet but for this share of them.
const AS_MUCH: f64 = 0.02;
/// Distances that differ by less are the same.
const AS_CLOSE: f64 = 1.02;

/// Whether the second pose, which keeps all pairs, is better than the first, which keeps the closest ones: as much of
/// the parts meets, they lie as close, and their holes, or where those say nothing their borders, lie closer together.
/// What only one part has pulls at all pairs, and holes and borders apart. O(border edges + nodes · log triangles).
pub fn is_better_with_all_pairs(
    source: &Surface,
    target: &Surface,
    [closest, all]: [&Similarity; 2],
    settings: &AssessSettings,
) -> bool {
    let remainder = Distances::of(source, target, closest.scale, settings)
        .tolerance
        .remainder;
    let corners = source.mesh().aabb().corners();
    if closest.max_displacement(all, &corners) <= SAME * remainder {
        return false;
    }
    let near = near(target);
    let pair = [source, target];
    let comparison = BorderComparison::new(pair, closest.scale, near);
    let [before, after] = [closest, all].map(|pose| comparison.at(pose));
    let are_closer = match by_holes(&before, &after) {
        Ordering::Greater => true,
        Ordering::Less => false,
        Ordering::Equal => after.apart(near) < CLOSER_BORDERS * before.apart(near),
    };
    if !are_closer {
        return false;
    }
    let mut contacts = ContactSearch::new(pair, closest.scale, near, MAX_NODES);
    let mut met = |pose: &Similarity| {
        let contacts = contacts.at(pose)?;
        Some((contacts.share, contacts.typical_gap(remainder)))
    };
    let (Some(before), Some(after)) = (met(closest), met(all)) else {
        return false;
    };
    after.0 >= before.0 - AS_MUCH && after.1 <= AS_CLOSE * before.1
}

/// Whether the holes speak for the borders under the second pose or under the first: more of them have their
/// counterpart there and no more lie where the other part is solid, or as many and they lie closer together.
fn by_holes(before: &Borders, after: &Borders) -> Ordering {
    let n_missing = |borders: &Borders| borders.missing.iter().map(Vec::len).sum::<usize>();
    let has_more =
        |a: &Borders, b: &Borders| a.holes.len() > b.holes.len() && n_missing(a) <= n_missing(b);
    let off = |borders: &Borders| {
        let offs = borders.holes.iter().map(|pair| pair.off.norm_squared());
        offs.sum::<f64>().sqrt()
    };
    let is_closer =
        |a: &Borders, b: &Borders| a.holes.len() == b.holes.len() && off(a) < CLOSER_HOLES * off(b);
    if has_more(after, before) || is_closer(after, before) {
        Ordering::Greater
    } else if has_more(before, after) || is_closer(before, after) {
        Ordering::Less
    } else {
        Ordering::Equal
    }
}
