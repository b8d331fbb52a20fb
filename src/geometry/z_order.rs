//! Points in an order in which those that follow each other lie near each other: along a Z-order curve
//! (Morton 1966).

use rayon::prelude::*;

use super::chunks::map_chunks;
use super::{Aabb, Point3, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Cells along an edge of the box, less one.
const LAST_CELL: f64 = 1023.0;

/// Indices of the points in the order of a Z-order curve over their box. O(n log n).
pub fn z_order(points: &[Point3]) -> Vec<u32> {
    z_order_for(points, &Monitor::silent()).expect("nobody cancels a silent monitor")
}

/// [`z_order`] of many points, on all threads; ends when `monitor` is cancelled.
pub fn z_order_for(points: &[Point3], monitor: &Monitor) -> Result<Vec<u32>, Cancelled> {
    let aabb = Aabb::of_points(points);
    let extent = aabb.extents().max();
    let scale = if extent > 0.0 {
        LAST_CELL / extent
    } else {
        0.0
    };
    let mut keyed = map_chunks(points.len(), monitor, |i| {
        (z_code(&((points[i] - aabb.min) * scale)), i as u32)
    })?;
    monitor.check()?;
    // No two are equal, so the order does not depend on the threads.
    keyed.par_sort_unstable();
    map_chunks(keyed.len(), monitor, |i| keyed[i].1)
}

/// Place on the curve of a point in cells, 0 to [`LAST_CELL`] along each axis.
fn z_code(cell: &Vector3) -> u32 {
    (0..3).fold(0, |code, axis| {
        code | spread_bits(cell[axis] as u32) << axis
    })
}

/// Puts two zero bits between the ten bits of a number.
fn spread_bits(number: u32) -> u32 {
    let mut x = number & 0x3ff;
    x = (x | x << 16) & 0x0300_00ff;
    x = (x | x << 8) & 0x0300_f00f;
    x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_passes_a_block_before_it_leaves_it() {
        let points: Vec<Point3> = (0..64)
            .map(|i| Point3::new(f64::from(i % 8), f64::from(i / 8), 0.0))
            .collect();
        let order = z_order(&points);
        for block in order.chunks(16) {
            let of_block: Vec<Point3> = block.iter().map(|&i| points[i as usize]).collect();
            assert_eq!(Aabb::of_points(&of_block).extents().max(), 3.0);
        }
        let mut all = order;
        all.sort_unstable();
        assert!(all.into_iter().eq(0..64));
    }

    #[test]
    fn equal_points_keep_their_order() {
        assert_eq!(z_order(&[Point3::new(1.0, 2.0, 3.0); 4]), [0, 1, 2, 3]);
        assert!(z_order(&[]).is_empty());
    }
}
