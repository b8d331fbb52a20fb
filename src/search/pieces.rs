//! Cuts the items of a tree into pieces of neighbours: each is built by itself, on any thread, and
//! a cancel request waits for no more than one of them.

use obvhs::aabb::Aabb as Box32;

use crate::geometry::chunks::map_chunks;
use crate::monitor::{Cancelled, Monitor};

/// Items per piece at most. Building a piece takes some ten milliseconds and stays in the cache; at
/// this size the whole build is twice as fast as over all items at once.
const MAX_PIECE: usize = 1 << 15;

/// Items `ids[..]` in one piece, or up to four parts that are cut further.
pub(super) enum Cut {
    /// Indices of the items.
    Piece(Vec<u32>),
    /// Two to four parts of nearly equal size.
    Parts(Vec<Cut>),
}

impl Cut {
    /// Adds all pieces, from first to last.
    pub(super) fn pieces<'a>(&'a self, found: &mut Vec<&'a [u32]>) {
        match self {
            Self::Piece(ids) => found.push(ids),
            Self::Parts(parts) => parts.iter().for_each(|part| part.pieces(found)),
        }
    }
}

/// An item by the middle of its box.
#[derive(Debug, Clone, Copy)]
struct Placed {
    middle: [f32; 3],
    id: u32,
}

/// Halves the items along the longer side of the box of their middles, again and again.
/// O(n · log(n / piece)), on all threads.
pub(super) fn cut_to_pieces(
    n: usize,
    box_of: &(impl Fn(u32) -> Box32 + Sync),
    monitor: &Monitor,
) -> Result<Cut, Cancelled> {
    if n <= MAX_PIECE {
        return Ok(Cut::Piece((0..n as u32).collect()));
    }
    let mut placed = map_chunks(n, monitor, |i| Placed {
        middle: box_of(i as u32).center().into(),
        id: i as u32,
    })?;
    cut(&mut placed, monitor)
}

/// Two cuts at once, because a node has four children.
fn cut(placed: &mut [Placed], monitor: &Monitor) -> Result<Cut, Cancelled> {
    if placed.len() <= MAX_PIECE {
        return Ok(Cut::Piece(placed.iter().map(|item| item.id).collect()));
    }
    monitor.check()?;
    let (low, high) = halve(placed);
    let (low, high) = rayon::join(|| cut_half(low, monitor), || cut_half(high, monitor));
    let (mut parts, high) = (low?, high?);
    parts.extend(high);
    Ok(Cut::Parts(parts))
}

/// The parts of one half: the half itself if it is small enough.
fn cut_half(half: &mut [Placed], monitor: &Monitor) -> Result<Vec<Cut>, Cancelled> {
    if half.len() <= MAX_PIECE {
        return Ok(vec![cut(half, monitor)?]);
    }
    monitor.check()?;
    let (low, high) = halve(half);
    let (low, high) = rayon::join(|| cut(low, monitor), || cut(high, monitor));
    Ok(vec![low?, high?])
}

/// Puts the items with the smaller middles along the longest side first. Which items these are does
/// not depend on their order before.
fn halve(placed: &mut [Placed]) -> (&mut [Placed], &mut [Placed]) {
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for item in placed.iter() {
        for axis in 0..3 {
            min[axis] = min[axis].min(item.middle[axis]);
            max[axis] = max[axis].max(item.middle[axis]);
        }
    }
    let side = |&axis: &usize| max[axis] - min[axis];
    let longest = (1..3).fold(0, |best, axis| {
        if side(&axis) > side(&best) {
            axis
        } else {
            best
        }
    });
    let half = placed.len() / 2;
    placed.select_nth_unstable_by(half, |a, b| {
        let order = a.middle[longest].total_cmp(&b.middle[longest]);
        order.then(a.id.cmp(&b.id))
    });
    placed.split_at_mut(half)
}

#[cfg(test)]
mod tests {
    use glam::Vec3A;

    use super::*;

    #[test]
    fn every_item_is_in_one_small_piece_with_its_neighbours() {
        let n = 5 * MAX_PIECE as u32 + 3;
        let box_of = |i: u32| {
            // Scattered along a line.
            let x = (i.wrapping_mul(2_654_435_761) % n) as f32;
            Box32::new(Vec3A::new(x, 0.0, 0.0), Vec3A::new(x, 1.0, 0.0))
        };
        let cut = cut_to_pieces(n as usize, &box_of, &Monitor::silent()).unwrap();
        let mut pieces = Vec::new();
        cut.pieces(&mut pieces);
        let mut end = f32::NEG_INFINITY;
        for piece in &pieces {
            assert!(piece.len() <= MAX_PIECE);
            let middles = piece.iter().map(|&i| box_of(i).min.x);
            assert!(middles.clone().fold(f32::INFINITY, f32::min) >= end);
            end = middles.fold(end, f32::max);
        }
        let mut all: Vec<u32> = pieces.concat();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..n));
    }

    #[test]
    fn a_cancel_request_ends_it() {
        let monitor = Monitor::silent();
        monitor.request_cancel();
        let boxes = |_: u32| Box32::new(Vec3A::ZERO, Vec3A::ONE);
        assert!(cut_to_pieces(MAX_PIECE + 1, &boxes, &monitor).is_err());
    }
}
