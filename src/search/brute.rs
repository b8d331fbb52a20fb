//! Closest points by asking every triangle: what the tree is compared with.

use std::sync::Arc;

use super::{ClosestPoint, NormalFilter, SurfaceHit, closest_point_on_triangle};
use crate::geometry::{Point3, TriMesh};

/// Asks every triangle. The measure that tests compare the tree with; nothing else uses it. O(triangles) per
/// query.
#[derive(Debug, Clone)]
pub struct BruteForce {
    mesh: Arc<TriMesh>,
}

impl BruteForce {
    /// Takes the mesh, shared or not.
    pub fn new(mesh: impl Into<Arc<TriMesh>>) -> Self {
        Self { mesh: mesh.into() }
    }
}

impl ClosestPoint for BruteForce {
    fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    fn closest(
        &self,
        query: &Point3,
        max_distance: f64,
        _hint: Option<u32>,
        filter: Option<&NormalFilter>,
    ) -> Option<SurfaceHit> {
        closest(&self.mesh, query, max_distance, filter)
    }
}

/// The closest point by asking every triangle.
pub(super) fn closest(
    mesh: &TriMesh,
    query: &Point3,
    max_distance: f64,
    filter: Option<&NormalFilter>,
) -> Option<SurfaceHit> {
    if !query.iter().all(|x| x.is_finite()) {
        return None;
    }
    let mut best: Option<SurfaceHit> = None;
    for triangle in 0..mesh.n_triangles() {
        let found = closest_point_on_triangle(query, &mesh.corners(triangle));
        let hit = SurfaceHit::on_triangle(triangle as u32, found);
        // The normal comes last: it costs more than the comparison.
        if hit.distance_sq.sqrt() <= max_distance
            && hit.beats(best.as_ref())
            && filter.is_none_or(|f| f.accepts(mesh, triangle))
        {
            best = Some(hit);
        }
    }
    best
}
