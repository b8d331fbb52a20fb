use std::sync::Arc;
use std::time::Duration;

use glam::Vec3A;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{BvhBuildParams, aabb::Aabb as Box32};

use super::{ClosestPoint, NormalFilter, SurfaceHit, closest_point_on_triangle};
use crate::geometry::{Point3, TriMesh, Vector3};

/// A tree of boxes over the triangles of a mesh.
///
/// Boxes are `f32` about the mesh's centre and rounded outwards; they only rule triangles out.
/// Distances are decided in `f64`, so the answers are those of [`super::BruteForce`].
#[derive(Clone)]
pub struct Bvh {
    mesh: Arc<TriMesh>,
    center: Point3,
    tree: Bvh2,
}

impl Bvh {
    /// Builds the tree. O(triangles · log triangles).
    pub fn build(mesh: impl Into<Arc<TriMesh>>) -> Self {
        let mesh: Arc<TriMesh> = mesh.into();
        let center = mesh.aabb().center();
        let boxes: Vec<Box32> = (0..mesh.n_triangles())
            .map(|t| box_around(mesh.corners(t).map(|p| p - center)))
            .collect();
        let params = BvhBuildParams {
            max_prims_per_leaf: 4,
            ..BvhBuildParams::medium_build()
        };
        let tree = if boxes.is_empty() {
            Bvh2::default()
        } else {
            build_bvh2(&boxes, params, &mut Duration::default())
        };
        Self { mesh, center, tree }
    }

    fn box_distance_sq(&self, node: usize, local: &Vector3) -> f64 {
        let aabb = self.tree.nodes[node].aabb();
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        (0..3)
            .map(|i| (min[i] - local[i]).max(local[i] - max[i]).max(0.0).powi(2))
            .sum()
    }
}

/// The box in `f32`, widened to the next number where rounding would have cut something off.
fn box_around(corners: [Vector3; 3]) -> Box32 {
    let min = corners[0].inf(&corners[1]).inf(&corners[2]);
    let max = corners[0].sup(&corners[1]).sup(&corners[2]);
    let below = |x: f64| (x as f32).next_down();
    let above = |x: f64| (x as f32).next_up();
    Box32::new(
        Vec3A::new(below(min.x), below(min.y), below(min.z)),
        Vec3A::new(above(max.x), above(max.y), above(max.z)),
    )
}

impl ClosestPoint for Bvh {
    fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    fn closest(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
        filter: Option<&NormalFilter>,
    ) -> Option<SurfaceHit> {
        if self.tree.nodes.is_empty() || !query.iter().all(|x| x.is_finite()) {
            return None;
        }
        let local = query - self.center;
        let mut best: Option<SurfaceHit> = None;
        let consider = |triangle: u32, best: &mut Option<SurfaceHit>| {
            if filter.is_some_and(|f| !f.accepts(&self.mesh, triangle as usize)) {
                return;
            }
            let found = closest_point_on_triangle(query, &self.mesh.corners(triangle as usize));
            let hit = SurfaceHit::on_triangle(triangle, found);
            if hit.distance_sq.sqrt() <= max_distance && hit.beats(best.as_ref()) {
                *best = Some(hit);
            }
        };
        if let Some(hint) = hint.filter(|&t| (t as usize) < self.mesh.n_triangles()) {
            consider(hint, &mut best);
        }
        let mut stack = vec![(self.box_distance_sq(0, &local), 0usize)];
        while let Some((near_sq, node)) = stack.pop() {
            let limit = best.map_or(max_distance * max_distance, |hit| hit.distance_sq);
            // The box may be as far as the triangle in it, give or take the last digits.
            if near_sq > limit * (1.0 + 1e-12) {
                continue;
            }
            let node = &self.tree.nodes[node];
            let first = node.first_index as usize;
            if node.is_leaf() {
                for i in first..first + node.prim_count as usize {
                    consider(self.tree.primitive_indices[i], &mut best);
                }
                continue;
            }
            let mut children = [first, first + 1].map(|c| (self.box_distance_sq(c, &local), c));
            if children[0].0 < children[1].0 {
                children.swap(0, 1);
            }
            stack.extend(children);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::super::BruteForce;
    use super::*;

    fn wave(n: u32) -> TriMesh {
        let mut positions = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                let (x, y) = (f64::from(i), f64::from(j));
                positions.push(Point3::new(x, y, (0.7 * x).sin() * (0.5 * y).cos()));
            }
        }
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..n {
                let a = j * (n + 1) + i;
                triangles.push([a, a + 1, a + n + 2]);
                triangles.push([a, a + n + 2, a + n + 1]);
            }
        }
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn agrees_with_brute_force() {
        let mesh = Arc::new(wave(12));
        let (tree, brute) = (Bvh::build(mesh.clone()), BruteForce::new(mesh));
        for i in 0..500 {
            let s = f64::from(i);
            let query = Point3::new(
                6.0 + 8.0 * (1.3 * s).sin(),
                0.026 * s,
                2.0 * (0.9 * s).cos(),
            );
            for limit in [f64::INFINITY, 0.5] {
                let expected = brute.closest(&query, limit, None, None);
                assert_eq!(tree.closest(&query, limit, None, None), expected);
                assert_eq!(tree.closest(&query, limit, Some(i % 288), None), expected);
            }
        }
        let nan = Point3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(tree.closest(&nan, f64::INFINITY, None, None), None);
        let empty = Bvh::build(TriMesh::default());
        assert_eq!(
            empty.closest(&Point3::origin(), f64::INFINITY, None, None),
            None
        );
    }
}
