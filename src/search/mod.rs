//! Closest points on triangle meshes.

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
    /// The triangle it lies on; of several equally close ones, the one found first.
    pub triangle: u32,
    /// Weights of the triangle's corners; they sum to 1.
    pub barycentric: [f64; 3],
    /// Face, edge or corner.
    pub feature: Feature,
    /// Squared distance from the query.
    pub distance_sq: f64,
}

/// Lets only triangles count whose unit normal n has n · `direction` ≥ `min_cos`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalFilter {
    /// Unit direction the normals are compared with.
    pub direction: Vector3,
    /// Smallest allowed cosine.
    pub min_cos: f64,
}

/// Something that answers closest-point questions about a mesh.
pub trait ClosestPoint: Send + Sync {
    /// The mesh the answers refer to.
    fn mesh(&self) -> &TriMesh;

    /// The closest point within `max_distance` (may be infinite), or `None` if there is none.
    ///
    /// `hint` names a triangle that is probably close, such as the last answer for this query; it
    /// changes the speed, never the answer. With `filter`, only triangles it lets through count.
    fn closest(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
        filter: Option<&NormalFilter>,
    ) -> Option<SurfaceHit>;
}
