//! Closest points and rays on triangle meshes.
//!
//! [`Bvh`] is the tree for work, [`BruteForce`] the plain loop that the tests hold it against. Both
//! decide with the same `f64` function, [`closest_point_on_triangle`], so their answers agree to
//! the last bit: the smallest squared distance, and of equal ones the lowest triangle index.
//! [`PointTree`] is the same tree over points. [`Bvh::first_hit`] follows a ray. [`FeatureGrid`]
//! answers roughly, but in constant time, for searches over many poses.

mod brute;
mod bvh;
mod cones;
mod distance;
mod feature_grid;
pub(crate) mod lanes;
mod nearby;
mod pack;
mod pieces;
mod points;
mod ray;
mod traverse;
mod tree_items;
mod triangle;
mod wide;

pub use brute::BruteForce;
pub use bvh::Bvh;
pub use distance::closest_many;
pub use feature_grid::{FeatureGrid, GridFeature, GridSettings};
pub use nearby::Nearby;
pub use points::{NearestPoint, PointTree};
pub use ray::RayHit;
pub use triangle::{TrianglePoint, closest_point_on_triangle};

use crate::geometry::{Point3, TriMesh, Vector3};

/// Which part of a triangle a closest point lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Inside the triangle.
    Face,
    /// On the edge from corner `i` to corner `(i + 1) % 3`.
    Edge(u8),
    /// At corner `i`.
    Vertex(u8),
}

/// The point of a surface that is closest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceHit {
    /// The closest point, in the mesh's frame.
    pub point: Point3,
    /// The triangle it lies on; of several equally close ones, the one with the lowest index.
    pub triangle: u32,
    /// Weights of the triangle's corners; they sum to 1.
    pub barycentric: [f64; 3],
    /// Face, edge or corner.
    pub feature: Feature,
    /// Squared distance from the query.
    pub distance_sq: f64,
}

impl SurfaceHit {
    fn on_triangle(triangle: u32, found: TrianglePoint) -> Self {
        Self {
            point: found.point,
            triangle,
            barycentric: found.barycentric,
            feature: found.feature,
            distance_sq: found.distance_sq,
        }
    }

    /// True if this hit wins over `other`: closer, or as close on a triangle of lower index.
    fn beats(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| {
            (self.distance_sq, self.triangle) < (other.distance_sq, other.triangle)
        })
    }
}

/// Lets only triangles count whose unit normal n has n · `direction` ≥ `min_cos`. A triangle without
/// area has no normal and never counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalFilter {
    /// Unit direction the normals are compared with.
    pub direction: Vector3,
    /// Smallest allowed cosine.
    pub min_cos: f64,
}

impl NormalFilter {
    /// True if the triangle counts.
    pub fn accepts(&self, mesh: &TriMesh, triangle: usize) -> bool {
        let normal = mesh.normal(triangle);
        normal != Vector3::zeros() && normal.dot(&self.direction) >= self.min_cos
    }
}

/// Something that answers closest-point questions about a mesh.
pub trait ClosestPoint: Send + Sync {
    /// The mesh the answers refer to.
    fn mesh(&self) -> &TriMesh;

    /// The closest point within `max_distance` (may be infinite), or `None` if there is none: no
    /// triangle, none that near, none that `filter` lets through, or a query that is not finite.
    ///
    /// `hint` names a triangle that is probably close, such as the last answer for this query; it
    /// changes the speed, never the answer. With `filter`, only triangles it lets through count:
    /// the answer is the closest of those, not the closest of all if it happens to pass.
    /// Triangles without area count as the segments or points that they are.
    fn closest(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
        filter: Option<&NormalFilter>,
    ) -> Option<SurfaceHit>;
}
