//! Rays through the tree, for picking.

use super::Bvh;
use super::ClosestPoint;
use super::wide::{Link, Node, WIDTH};
use crate::geometry::{Point3, Vector3};

/// Where a ray first meets the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The point on the surface.
    pub point: Point3,
    /// The triangle it lies on; of several met at the same place, the one with the lowest index.
    pub triangle: u32,
    /// Weights of the triangle's corners; they sum to 1.
    pub barycentric: [f64; 3],
    /// Distance from the ray's origin, in the mesh's length unit.
    pub distance: f64,
}

impl Bvh {
    /// The first point where the ray from `origin` along `direction` (any length) meets a triangle
    /// from either side, or `None`. Triangles without area and triangles seen edge-on are not met.
    ///
    /// For picking: `f64` throughout, a few microseconds per ray.
    pub fn first_hit(&self, origin: &Point3, direction: &Vector3) -> Option<RayHit> {
        self.first_hit_within(origin, direction, f64::INFINITY)
    }

    /// [`Bvh::first_hit`] at a distance of at most `max_distance`; quicker the shorter that is.
    pub fn first_hit_within(
        &self,
        origin: &Point3,
        direction: &Vector3,
        max_distance: f64,
    ) -> Option<RayHit> {
        let direction = direction.try_normalize(0.0)?;
        let finite = |v: &Vector3| v.iter().all(|x| x.is_finite());
        if !finite(&origin.coords) || !finite(&direction) {
            return None;
        }
        // Boxes are in local units; a uniform scale leaves the direction as it is.
        let local = self.frame.to_local(origin);
        let inverse = direction.map(|x| 1.0 / x);
        // A hair beyond, because entries are rounded too.
        let reach = |distance: f64| distance * self.frame.scale * (1.0 + 1e-9) + 1e-9;
        let mut limit = reach(max_distance);
        let mut best: Option<RayHit> = None;
        let mut waiting: Vec<(f64, Link)> = self.tree.root.map(|r| (0.0, r)).into_iter().collect();
        while let Some((entry, link)) = waiting.pop() {
            if entry > limit {
                continue;
            }
            match link.leaf() {
                Ok(leaf) => {
                    for id in self.tree.packs[leaf].real_ids() {
                        let hit = self.meet(origin, &direction, id);
                        let hit = hit.filter(|hit| hit.distance <= max_distance);
                        best = nearer(best, hit);
                    }
                    limit = best.map_or(limit, |hit| reach(hit.distance));
                }
                Err(node) => {
                    let first = waiting.len();
                    enter(
                        &self.tree.nodes[node],
                        &local,
                        &inverse,
                        limit,
                        &mut waiting,
                    );
                    waiting[first..].sort_by(|a, b| b.0.total_cmp(&a.0));
                }
            }
        }
        best
    }

    /// Where the ray meets one triangle (Möller and Trumbore 1997).
    fn meet(&self, origin: &Point3, direction: &Vector3, triangle: u32) -> Option<RayHit> {
        let [a, b, c] = self.mesh().corners(triangle as usize);
        let (ab, ac) = (b - a, c - a);
        let across = direction.cross(&ac);
        let determinant = ab.dot(&across);
        let from_a = origin - a;
        let turned = from_a.cross(&ab);
        let v = from_a.dot(&across) / determinant;
        let w = direction.dot(&turned) / determinant;
        let distance = ac.dot(&turned) / determinant;
        // A hair of overlap closes the seam between neighbours; NaN fails every comparison.
        let edge = -1e-12;
        if !(v >= edge && w >= edge && v + w <= 1.0 - edge && distance >= 0.0) {
            return None;
        }
        let point = a + ab * v + ac * w;
        point.iter().all(|x| x.is_finite()).then_some(RayHit {
            point,
            triangle,
            barycentric: [1.0 - v - w, v, w],
            distance,
        })
    }
}

fn nearer(best: Option<RayHit>, hit: Option<RayHit>) -> Option<RayHit> {
    match (best, hit) {
        (Some(a), Some(b)) => {
            let b_first = (b.distance, b.triangle) < (a.distance, a.triangle);
            Some(if b_first { b } else { a })
        }
        (a, b) => a.or(b),
    }
}

/// Appends the children whose boxes the ray enters before `limit`, with the distance at which it does
/// (slab test, Kay and Kajiya 1986). Boxes are a little larger than what they hold, which covers the
/// rounding here.
fn enter(
    node: &Node,
    origin: &Vector3,
    inverse: &Vector3,
    limit: f64,
    entered: &mut Vec<(f64, Link)>,
) {
    for slot in 0..WIDTH {
        let Some([min, max]) = node.bounds(slot) else {
            continue;
        };
        let (mut from, mut to) = (0.0_f64, limit);
        for axis in 0..3 {
            let to_min = f64::from(min[axis]) - origin[axis];
            let to_max = f64::from(max[axis]) - origin[axis];
            if inverse[axis].is_finite() {
                let (s, t) = (to_min * inverse[axis], to_max * inverse[axis]);
                from = from.max(s.min(t));
                to = to.min(s.max(t));
            } else if to_min > 0.0 || to_max < 0.0 {
                // Parallel to the slab and outside it.
                to = f64::NEG_INFINITY;
            }
        }
        if from <= to {
            entered.push((from, node.child[slot]));
        }
    }
}
