//! Indexed triangle meshes.

use super::groups::groups;
use super::{Aabb, Point3, Similarity, Vector3};

/// Why positions and triangles do not make a [`TriMesh`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {n_vertices} vertices")]
    IndexOutOfRange {
        /// The triangle's index.
        triangle: usize,
        /// The vertex index it names.
        vertex: u32,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// The vertex index.
        vertex: usize,
    },
    /// More vertices than a 32-bit index can name.
    #[error("{n_vertices} vertices are more than a 32-bit index can name")]
    TooLarge {
        /// How many vertices were given.
        n_vertices: usize,
    },
}

/// An indexed triangle mesh whose indices are in range and whose coordinates are finite.
///
/// Zero-area triangles and unused vertices are allowed; the functions below say what they do with
/// them. The normal of a triangle (a, b, c) points along (b − a) × (c − a).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    positions: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Checks and takes positions and triangles. O(vertices + triangles).
    pub fn new(positions: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        let n_vertices = positions.len();
        if n_vertices > u32::MAX as usize {
            return Err(MeshError::TooLarge { n_vertices });
        }
        if let Some(vertex) = positions
            .iter()
            .position(|p| !p.iter().all(|x| x.is_finite()))
        {
            return Err(MeshError::NotFinite { vertex });
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
                return Err(MeshError::IndexOutOfRange {
                    triangle,
                    vertex,
                    n_vertices,
                });
            }
        }
        Ok(Self {
            positions,
            triangles,
        })
    }

    /// Vertex positions.
    pub fn positions(&self) -> &[Point3] {
        &self.positions
    }

    /// Vertex indices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Gives up the arrays without copying.
    pub fn into_parts(self) -> (Vec<Point3>, Vec<[u32; 3]>) {
        (self.positions, self.triangles)
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// True if there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Corner positions of a triangle.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [Point3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// Half the cross product of two edges: normal direction times area.
    pub fn area_vector(&self, triangle: usize) -> Vector3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(&(c - a)) * 0.5
    }

    /// Unit normal; the zero vector for a triangle without area.
    pub fn normal(&self, triangle: usize) -> Vector3 {
        self.area_vector(triangle)
            .try_normalize(0.0)
            .unwrap_or_default()
    }

    /// Area of one triangle.
    pub fn triangle_area(&self, triangle: usize) -> f64 {
        self.area_vector(triangle).norm()
    }

    /// Centroid of one triangle.
    pub fn triangle_centroid(&self, triangle: usize) -> Point3 {
        let [a, b, c] = self.corners(triangle);
        Point3::from((a.coords + b.coords + c.coords) / 3.0)
    }

    /// Area of the whole mesh. O(triangles), summed in index order.
    pub fn area(&self) -> f64 {
        (0..self.n_triangles()).map(|t| self.triangle_area(t)).sum()
    }

    /// Component number of every triangle (connected over vertices), counted from 0 in order of each component's first
    /// triangle, and how many there are. Nearly O(triangles).
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut first_at = vec![u32::MAX; self.n_vertices()];
        let corners = (0_u32..).zip(self.triangles.as_flattened());
        let joined = corners.filter_map(|(corner, &vertex)| {
            let (triangle, first) = (corner / 3, &mut first_at[vertex as usize]);
            if *first == u32::MAX {
                *first = triangle;
            }
            (*first != triangle).then_some([*first, triangle])
        });
        groups(self.n_triangles(), joined)
    }

    /// Area-weighted centroid of the surface; mean of the vertices if there is no area.
    pub fn centroid(&self) -> Point3 {
        let mut sum = Vector3::zeros();
        let mut total = 0.0;
        // Sums about a corner of the box keep their digits far from the origin.
        let origin = self
            .positions
            .first()
            .copied()
            .unwrap_or_else(Point3::origin);
        for triangle in 0..self.n_triangles() {
            let [a, b, c] = self.corners(triangle);
            let area = self.triangle_area(triangle);
            sum += ((a - origin) + (b - origin) + (c - origin)) * (area / 3.0);
            total += area;
        }
        if total > 0.0 {
            return origin + sum / total;
        }
        let n = self.n_vertices().max(1) as f64;
        origin + self.positions.iter().map(|p| p - origin).sum::<Vector3>() / n
    }

    /// Area-weighted mean of the unit normals. Its length lies in 0 … 1: near 1 for a flat sheet,
    /// near 0 for a tube or a closed shape, where the direction means little.
    pub fn mean_normal(&self) -> Vector3 {
        let sum: Vector3 = (0..self.n_triangles()).map(|t| self.area_vector(t)).sum();
        let area = self.area();
        if area > 0.0 {
            sum / area
        } else {
            Vector3::zeros()
        }
    }

    /// Box around the vertices that triangles use; around all vertices if there are no triangles.
    pub fn aabb(&self) -> Aabb {
        if self.is_empty() {
            return Aabb::of_points(&self.positions);
        }
        Aabb::of_points(
            self.triangles
                .iter()
                .flatten()
                .map(|&v| &self.positions[v as usize]),
        )
    }

    /// Mean over all triangle edges, shared edges counted twice; 0 without triangles.
    pub fn mean_edge_length(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let perimeter = |t: usize| {
            let [a, b, c] = self.corners(t);
            (b - a).norm() + (c - b).norm() + (a - c).norm()
        };
        (0..self.n_triangles()).map(perimeter).sum::<f64>() / (3 * self.n_triangles()) as f64
    }

    /// Unit normal at each vertex, triangles weighted by their angle at the vertex (Thürmer and
    /// Wüthrich 1998), which does not depend on how flat areas are cut into triangles.
    /// Zero where a vertex has no triangle with area.
    pub fn vertex_normals(&self) -> Vec<Vector3> {
        let mut sums = vec![Vector3::zeros(); self.n_vertices()];
        for (t, corners) in self.triangles.iter().enumerate() {
            let normal = self.normal(t);
            let points = self.corners(t);
            for i in 0..3 {
                let u = points[(i + 1) % 3] - points[i];
                let v = points[(i + 2) % 3] - points[i];
                sums[corners[i] as usize] += normal * u.angle(&v);
            }
        }
        sums.into_iter()
            .map(|sum| sum.try_normalize(0.0).unwrap_or_default())
            .collect()
    }

    /// A third of the area of the triangles around each vertex.
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.n_vertices()];
        for (t, corners) in self.triangles.iter().enumerate() {
            let share = self.triangle_area(t) / 3.0;
            for &vertex in corners {
                areas[vertex as usize] += share;
            }
        }
        areas
    }

    /// The mesh moved by `target_from_source`. A mirroring motion also reverses every triangle, so
    /// that normals keep pointing to the same side of the sheet's material.
    pub fn transformed(&self, target_from_source: &Similarity) -> Self {
        let positions = self
            .positions
            .iter()
            .map(|p| target_from_source.apply(p))
            .collect();
        let moved = Self {
            positions,
            triangles: self.triangles.clone(),
        };
        if target_from_source.is_mirrored() {
            moved.flipped()
        } else {
            moved
        }
    }

    /// Whether triangle `t` runs along an edge from its first to its second end.
    pub(crate) fn runs_along(&self, t: usize, [u, v]: [u32; 2]) -> bool {
        let corners = self.triangles[t];
        (0..3).any(|i| corners[i] == u && corners[(i + 1) % 3] == v)
    }

    /// The same surface with every triangle, and so every normal, reversed.
    pub fn flipped(mut self) -> Self {
        for corners in &mut self.triangles {
            corners.swap(1, 2);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> TriMesh {
        let positions = vec![
            Point3::new(0.0, 0.0, 5.0),
            Point3::new(2.0, 0.0, 5.0),
            Point3::new(2.0, 2.0, 5.0),
            Point3::new(0.0, 2.0, 5.0),
        ];
        TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    #[test]
    fn measures_of_a_square() {
        let mesh = square();
        assert_eq!(mesh.area(), 4.0);
        assert_eq!(mesh.centroid(), Point3::new(1.0, 1.0, 5.0));
        assert_eq!(mesh.mean_normal(), Vector3::z());
        assert_eq!(mesh.vertex_normals(), vec![Vector3::z(); 4]);
        assert!((mesh.vertex_areas().iter().sum::<f64>() - 4.0).abs() < 1e-12);
        assert_eq!(mesh.flipped().mean_normal(), -Vector3::z());
    }

    #[test]
    fn refuses_bad_input() {
        let p = vec![Point3::origin()];
        assert!(matches!(
            TriMesh::new(p, vec![[0, 0, 1]]),
            Err(MeshError::IndexOutOfRange { vertex: 1, .. })
        ));
        let nan = vec![Point3::new(f64::NAN, 0.0, 0.0)];
        assert!(matches!(
            TriMesh::new(nan, vec![]),
            Err(MeshError::NotFinite { vertex: 0 })
        ));
    }

    #[test]
    fn a_mirror_keeps_the_sheet_side() {
        let mirror = Similarity::mirror_x();
        let moved = square().transformed(&mirror);
        assert_eq!(moved.mean_normal(), Vector3::z());
        assert_eq!(moved.centroid(), Point3::new(-1.0, 1.0, 5.0));
    }

    #[test]
    fn an_empty_mesh_has_plain_answers() {
        let mesh = TriMesh::default();
        assert_eq!(mesh.area(), 0.0);
        assert_eq!(mesh.mean_normal(), Vector3::zeros());
        assert_eq!(mesh.centroid(), Point3::origin());
        assert!(mesh.aabb().is_empty());
    }
}
