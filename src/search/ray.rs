//! Rays through the tree, for picking.

use glam::Vec4;

use super::Bvh;
use super::ClosestPoint;
use super::traverse::OUT_OF_SIGHT;
use super::wide::{Link, Node};
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
        if local.amax() > FARTHEST {
            return self.hit_from_afar(origin, &direction, max_distance);
        }
        let slabs = Slabs::new(&local, &direction);
        // A hair beyond, because entries are rounded too.
        let reach = |distance: f64| (distance * self.frame.scale * (1.0 + 1e-6) + 1e-9) as f32;
        let mut limit = reach(max_distance);
        let mut best: Option<RayHit> = None;
        // The distance's bits above the link's, so that entries sort as numbers.
        let mut waiting: Vec<u64> = Vec::with_capacity(self.tree.stack_size);
        waiting.extend(self.tree.root.map(|root| u64::from(root.0)));
        while let Some(next) = waiting.pop() {
            if f32::from_bits((next >> 32) as u32) > limit {
                continue;
            }
            match Link(next as u32).leaf() {
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
                    slabs.enter(&self.tree.nodes[node], limit, &mut waiting);
                    waiting[first..].sort_unstable_by(|a, b| b.cmp(a));
                }
            }
        }
        best
    }

    /// [`Bvh::first_hit_within`] along the unit vector `direction` and the other way, each at a distance of at least
    /// that of `beyond`; with one walk through the tree, which is half the work where both are short.
    pub fn first_hits_both_ways(
        &self,
        origin: &Point3,
        direction: &Vector3,
        beyond: [f64; 2],
        max_distance: f64,
    ) -> [Option<RayHit>; 2] {
        let start = origin - direction * max_distance;
        let local = self.frame.to_local(&start);
        let length = (2.0 * max_distance * self.frame.scale * (1.0 + 1e-6) + 1e-9) as f32;
        // NaN counts as far away too.
        if !(local.amax() <= OUT_OF_SIGHT && length.is_finite()) {
            return [(direction, beyond[0]), (&-direction, beyond[1])].map(
                |(direction, beyond)| {
                    let start = origin + direction * beyond;
                    let hit = self.first_hit_within(&start, direction, max_distance - beyond)?;
                    Some(RayHit {
                        distance: beyond + hit.distance,
                        ..hit
                    })
                },
            );
        }
        let slabs = Slabs::new(&local, direction);
        let mut found = [None; 2];
        let mut waiting: Vec<u64> = Vec::with_capacity(self.tree.stack_size);
        waiting.extend(self.tree.root.map(|root| u64::from(root.0)));
        while let Some(next) = waiting.pop() {
            match Link(next as u32).leaf() {
                Ok(leaf) => {
                    for id in self.tree.packs[leaf].real_ids() {
                        let Some(hit) = self.cross(origin, direction, id) else {
                            continue;
                        };
                        let way = usize::from(hit.distance < 0.0);
                        let distance = hit.distance.abs();
                        if distance >= beyond[way] && distance <= max_distance {
                            found[way] = nearer(found[way], Some(RayHit { distance, ..hit }));
                        }
                    }
                }
                Err(node) => slabs.enter(&self.tree.nodes[node], length, &mut waiting),
            }
        }
        found
    }

    /// The hit of a ray whose origin `f32` cannot hold: it begins beside the mesh instead, at a place that is
    /// counted from the mesh, because nothing of it would be left as a difference of the origin.
    fn hit_from_afar(
        &self,
        origin: &Point3,
        direction: &Vector3,
        max_distance: f64,
    ) -> Option<RayHit> {
        let to_middle = self.frame.center - origin;
        let along = to_middle.dot(direction);
        let aside = to_middle - direction * along;
        let before = BESIDE / self.frame.scale;
        let skipped = along - before;
        // In local units no corner of the mesh is farther than 1 from its middle on any axis.
        let passes_by = aside.amax() * self.frame.scale > BESIDE;
        if passes_by || skipped < 0.0 || skipped > max_distance {
            return None;
        }
        let beside = self.frame.center - aside - direction * before;
        let hit = self.first_hit_within(&beside, direction, max_distance - skipped)?;
        Some(RayHit {
            distance: skipped + hit.distance,
            ..hit
        })
    }

    /// Where the ray meets one triangle.
    fn meet(&self, origin: &Point3, direction: &Vector3, triangle: u32) -> Option<RayHit> {
        let hit = self.cross(origin, direction, triangle);
        hit.filter(|hit| hit.distance >= 0.0)
    }

    /// Where the line crosses one triangle (Möller and Trumbore 1997), at a negative distance behind the origin.
    fn cross(&self, origin: &Point3, direction: &Vector3, triangle: u32) -> Option<RayHit> {
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
        if !(v >= edge && w >= edge && v + w <= 1.0 - edge) {
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

/// Origins farther from the mesh than so many of its sizes are moved: near the largest `f32` the entries into
/// its boxes would be infinite.
const FARTHEST: f64 = 1e30;
/// Where such a ray begins instead, in mesh sizes from the middle: outside of the box in every direction.
const BESIDE: f64 = 4.0;

fn nearer(best: Option<RayHit>, hit: Option<RayHit>) -> Option<RayHit> {
    match (best, hit) {
        (Some(a), Some(b)) => {
            let b_first = (b.distance, b.triangle) < (a.distance, a.triangle);
            Some(if b_first { b } else { a })
        }
        (a, b) => a.or(b),
    }
}

/// A ray against four boxes at once (slab test, Kay and Kajiya 1986). It may enter a box that it passes
/// closely by, and never passes one that it enters: boxes grow by all that rounding can take.
struct Slabs {
    /// For each axis the origin and one over the direction.
    axes: [(Vec4, Vec4); 3],
    grown: Vec4,
}

/// More than the rounding of a distance along a ray.
const ROUNDING: f32 = 1e-6;

impl Slabs {
    fn new(origin: &Vector3, direction: &Vector3) -> Self {
        let axis = |i: usize| {
            // Along a slab the ray is in it everywhere or nowhere, and so it is with a large number.
            let inverse = (1.0 / direction[i]).clamp(-1e30, 1e30) as f32;
            (Vec4::splat(origin[i] as f32), Vec4::splat(inverse))
        };
        Self {
            axes: [0, 1, 2].map(axis),
            grown: Vec4::splat(4.0 * f32::EPSILON * (2.0 + origin.amax() as f32)),
        }
    }

    /// Appends the children whose boxes the ray enters before `limit`, with the distance at which it
    /// does.
    #[inline]
    fn enter(&self, node: &Node, limit: f32, entered: &mut Vec<u64>) {
        let (mut from, mut to) = (Vec4::ZERO, Vec4::splat(limit));
        for (axis, (origin, inverse)) in self.axes.iter().enumerate() {
            let [min, max] = node.slabs(axis);
            let s = (min - self.grown - *origin) * *inverse;
            let t = (max + self.grown - *origin) * *inverse;
            from = from.max(s.min(t));
            to = to.min(s.max(t));
        }
        let from = from * (1.0 - ROUNDING);
        let mut within = from.cmple(to * (1.0 + ROUNDING)).bitmask() & node.used();
        let from = from.to_array();
        while within != 0 {
            let slot = within.trailing_zeros() as usize;
            within &= within - 1;
            entered.push(u64::from(from[slot].to_bits()) << 32 | u64::from(node.child[slot].0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    #[test]
    fn both_ways_at_once_meet_what_two_rays_meet() {
        // Sheets one above the other, each of two triangles.
        let heights = [-3.0, -1.0, 0.0, 0.5, 2.0];
        let corners = heights.map(|z| {
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point3::new(x, y, z))
        });
        let halves =
            (0..5).flat_map(|i| [[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]]);
        let mesh = TriMesh::new(corners.as_flattened().to_vec(), halves.collect()).unwrap();
        let tree = Bvh::build(mesh);
        for (x, height, beyond, reach) in [
            (0.3, 0.1, [0.0, 0.0], 10.0),
            (0.3, 0.1, [0.5, 0.2], 10.0),
            (0.7, 0.1, [0.0, 0.0], 0.3),
            (0.7, -2.0, [1.5, 1.5], 2.5),
            (1.5, 0.0, [0.0, 0.0], 10.0),
            // Too far away for the tree's own numbers.
            (0.3, 1e9, [0.0, 0.0], 2e9),
            (0.3, -1e9, [0.0, 0.0], 2e9),
        ] {
            let origin = Point3::new(x, 0.4, height);
            let up = Vector3::z();
            let found = tree.first_hits_both_ways(&origin, &up, beyond, reach);
            let expected = [(up, beyond[0]), (-up, beyond[1])].map(|(direction, beyond)| {
                let start = origin + direction * beyond;
                let hit = tree.first_hit_within(&start, &direction, reach - beyond);
                hit.map(|hit| (hit.triangle, (beyond + hit.distance) as f32))
            });
            let found = found.map(|hit| hit.map(|hit| (hit.triangle, hit.distance as f32)));
            assert_eq!(found, expected, "{x} {height}");
        }
    }

    #[test]
    fn a_ray_from_beyond_the_largest_f32_meets_the_nearer_sheet() {
        let corner = |y: f64, z: f64| [2.0, 3.0].map(|x| Point3::new(x, y, z));
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)];
        let positions = corners.as_flattened().to_vec();
        let mesh = TriMesh::new(positions, vec![[0, 2, 4], [1, 3, 5]]).unwrap();
        let tree = Bvh::build(mesh);
        for far in [1e31, 1e35, 1e40, 1e200] {
            let from = |x: f64| Point3::new(x, 0.0, 0.0);
            let hit = |x: f64, direction: Vector3| tree.first_hit(&from(x), &direction);
            let left = hit(-far, Vector3::x()).unwrap();
            let right = hit(far, -Vector3::x()).unwrap();
            assert_eq!((left.triangle, right.triangle), (0, 1), "{far}");
            assert_eq!((left.distance, right.distance), (far, far));
            assert_eq!(hit(far, Vector3::x()), None);
            assert_eq!(
                tree.first_hit(&Point3::new(far, far, 0.0), &-Vector3::x()),
                None
            );
            let within = tree.first_hit_within(&from(far), &-Vector3::x(), far / 2.0);
            assert_eq!(within, None);
        }
    }
}
