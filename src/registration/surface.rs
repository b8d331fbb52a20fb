//! A mesh prepared once for everything that searches it.

use std::sync::{Arc, OnceLock};

use nalgebra::SymmetricEigen;

use super::RegistrationError;
use super::subsample::{EvenChoices, WeightedNode};
use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::geometry::{
    Border, BorderEdges, CleanMesh, CornerNormals, Matrix3, Point3, Similarity, Topology, TriMesh,
    Vector3, VertexFans, corner_normals,
};
use crate::monitor::{Cancelled, Monitor};
use crate::search::{Bvh, Feature, PointTree, SurfaceHit};

/// Triangles that meet at more than this angle form a sharp edge, which stays flat-sided.
const SHARP_EDGE_DEG: f64 = 40.0;

/// A mesh joined at equal positions and consistently oriented, with its border, its tree, its normals
/// and its measures. Made once per mesh; registration, assessment, report and the views share it.
pub struct Surface {
    mesh: Arc<TriMesh>,
    border_edges: BorderEdges,
    bvh: Arc<Bvh>,
    /// The tree for nearest nodes, made when first asked for.
    nodes: OnceLock<PointTree>,
    vertex_of: Vec<u32>,
    /// For every node before joining that triangles use, in their order, its vertex.
    given: Vec<u32>,
    normals: CornerNormals,
    vertex_areas: Vec<f64>,
    even_choices: EvenChoices,
    /// For each triangle a bit for each side that is a border edge.
    border_sides: Vec<u8>,
    border_vertices: Vec<bool>,
    /// Outlines and holes, found when first asked for.
    borders: OnceLock<Vec<Border>>,
    measures: Measures,
}

/// Size, place and direction of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Area of the surface.
    pub area: f64,
    /// Area-weighted centroid.
    pub centroid: Point3,
    /// Area-weighted mean of the unit normals, length 0 … 1.
    pub mean_normal: Vector3,
    /// Principal directions of the surface as columns, longest first, right-handed.
    pub principal_axes: Matrix3,
    /// Standard deviation of the surface along the principal directions.
    pub principal_spread: Vector3,
    /// Diagonal of the bounding box.
    pub diagonal: f64,
    /// Mean length of the triangle edges.
    pub mean_edge_length: f64,
    /// Estimated root mean square distance between the facets and the smooth surface they stand for.
    pub chordal_error: f64,
}

impl Surface {
    /// Joins, orients and prepares a bare mesh; `side` (`source` or `target`) is for the message. An
    /// error if no triangle has an area. O(triangles · log triangles).
    pub fn new(mesh: &TriMesh, side: &'static str) -> Result<Self, RegistrationError> {
        Self::build(mesh, side, &Monitor::silent())
    }

    /// [`Surface::new`] that ends when `monitor` is cancelled.
    pub fn build(
        mesh: &TriMesh,
        side: &'static str,
        monitor: &Monitor,
    ) -> Result<Self, RegistrationError> {
        let clean = CleanMesh::of(mesh.clone(), monitor)?;
        let vertex_of = clean.vertex_of.clone();
        let mut surface = Self::prepare(clean, side, monitor)?;
        surface.vertex_of = vertex_of;
        Ok(surface)
    }

    /// Prepares a mesh that is joined and oriented; the vertices passed in are those of the surface.
    /// Asks `monitor` every few ten milliseconds. O(triangles · log triangles), on all threads.
    pub fn prepare(
        clean: CleanMesh,
        side: &'static str,
        monitor: &Monitor,
    ) -> Result<Self, RegistrationError> {
        let CleanMesh {
            mesh,
            topology,
            vertex_of,
            triangle_of,
            ..
        } = clean;
        drop(triangle_of);
        let given = vertex_of.into_iter().filter(|&v| v != u32::MAX).collect();
        Self::assemble((mesh, given), side, monitor, |mesh, vectors| {
            let chordal_error = chordal_error(mesh, &topology, vectors, monitor)?;
            let border_edges = BorderEdges::of(mesh, &topology);
            // Inner edges take as much as the mesh, and only a deviation asks for them later, which lists them anew.
            drop(topology);
            Ok((border_edges, chordal_error))
        })
    }

    /// The surface mirrored at x = 0; what does not change is not made again.
    pub(super) fn mirrored(&self, monitor: &Monitor) -> Result<Self, RegistrationError> {
        let mesh = self.mesh.transformed(&Similarity::mirror_x());
        Self::assemble((mesh, self.given.clone()), "source", monitor, |_, _| {
            Ok((self.border_edges.flipped(), self.measures.chordal_error))
        })
    }

    /// A mesh with the vertices of the nodes as they were given. `of_edges` finds what depends on the edges of the
    /// mesh, given the area vectors of its triangles: its border and its chordal error.
    fn assemble<F>(
        (mesh, given): (TriMesh, Vec<u32>),
        side: &'static str,
        monitor: &Monitor,
        of_edges: F,
    ) -> Result<Self, RegistrationError>
    where
        F: FnOnce(&TriMesh, &[Vector3]) -> Result<(BorderEdges, f64), Cancelled> + Send,
    {
        let vectors = map_chunks(mesh.n_triangles(), monitor, |t| mesh.area_vector(t))?;
        let area: f64 = vectors.iter().map(Vector3::norm).sum();
        if area <= 0.0 || !area.is_finite() {
            return Err(RegistrationError::EmptyMesh { side });
        }
        let mesh = Arc::new(mesh);
        // The tree last, so that one thread has given up `vectors` before it makes the tree.
        let (prepared, bvh) = rayon::join(
            || {
                let vectors = vectors;
                let (normals, (of_edges, frame)) = rayon::join(
                    || normals_and_areas(&mesh, &vectors, monitor),
                    || {
                        rayon::join(
                            || of_edges(&mesh, &vectors),
                            || principal_frame(&mesh, &vectors, area, monitor),
                        )
                    },
                );
                let (border_edges, chordal_error) = of_edges?;
                let (centroid, principal_axes, principal_spread) = frame?;
                monitor.check()?;
                let measures = Measures {
                    area,
                    centroid,
                    mean_normal: vectors.iter().sum::<Vector3>() / area,
                    principal_axes,
                    principal_spread,
                    diagonal: mesh.aabb().diagonal(),
                    mean_edge_length: mesh.mean_edge_length(),
                    chordal_error,
                };
                Ok::<_, Cancelled>((normals?, border_edges, measures))
            },
            || Bvh::build_for(mesh.clone(), monitor),
        );
        let ((normals, vertex_areas), border_edges, measures) = prepared?;
        monitor.check()?;
        let (border_sides, border_vertices) = border_marks(&mesh, &border_edges);
        Ok(Self {
            bvh: Arc::new(bvh?),
            nodes: OnceLock::new(),
            vertex_of: (0..mesh.n_vertices() as u32).collect(),
            given,
            normals,
            vertex_areas,
            even_choices: EvenChoices::default(),
            border_edges,
            border_sides,
            border_vertices,
            borders: OnceLock::new(),
            measures,
            mesh,
        })
    }

    /// The mesh after joining and orienting.
    pub fn mesh(&self) -> &Arc<TriMesh> {
        &self.mesh
    }

    /// The border edges of [`Surface::mesh`].
    pub fn border_edges(&self) -> &BorderEdges {
        &self.border_edges
    }

    /// The tree over [`Surface::mesh`].
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The same, to be kept by whoever needs it longer than the surface.
    pub fn shared_bvh(&self) -> &Arc<Bvh> {
        &self.bvh
    }

    /// Area, centroid, mean normal, axes, sizes.
    pub fn measures(&self) -> &Measures {
        &self.measures
    }

    /// For every vertex of the mesh passed in, its vertex in [`Surface::mesh`]; `u32::MAX` for
    /// vertices no triangle uses.
    pub fn vertex_of(&self) -> &[u32] {
        &self.vertex_of
    }

    /// The nodes that triangles use, in their order, each of those at one place counted.
    pub fn nodes_as_given(&self) -> Vec<Point3> {
        let positions = self.mesh.positions();
        self.given.iter().map(|&v| positions[v as usize]).collect()
    }

    /// Unit normals of the vertices.
    pub fn vertex_normals(&self) -> &[Vector3] {
        self.normals.of_vertices()
    }

    /// A third of the area around each vertex.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// About `n` vertices that stand for equal areas, evenly spread however the mesh is graded, in an order in which
    /// neighbours lie near each other. All vertices in their order, each with its own area, if there are no more. Made
    /// once for each `n`. O(vertices · log vertices) the first time.
    pub(crate) fn even_nodes(&self, n: usize) -> Arc<[WeightedNode]> {
        let nodes = self.even_nodes_for(n, &Monitor::silent());
        nodes.expect("nobody cancels a silent monitor")
    }

    /// [`Surface::even_nodes`] that ends when `monitor` is cancelled.
    pub(crate) fn even_nodes_for(
        &self,
        n: usize,
        monitor: &Monitor,
    ) -> Result<Arc<[WeightedNode]>, Cancelled> {
        self.even_choices.of(self, n, monitor)
    }

    /// The unit normal at a hit, interpolated between the triangle's corners; across sharp edges
    /// the corners do not share their normals.
    pub fn normal_at(&self, hit: &SurfaceHit) -> Vector3 {
        let normals = self.normals.of_triangle(&self.mesh, hit.triangle as usize);
        let sum: Vector3 = (0..3).map(|i| normals[i] * hit.barycentric[i]).sum();
        sum.try_normalize(0.0)
            .unwrap_or_else(|| self.mesh.normal(hit.triangle as usize))
    }

    /// A hit on the flat triangle moved half way to where the corner normals put the smooth
    /// surface: q − ½ Σ βᵢ ((q − vᵢ)·nᵢ) nᵢ, exact to second order on a circular arc (Phong
    /// tessellation, Boubekeur and Alexa 2008, with α = ½). Corners stay where they are.
    pub fn curved_point(&self, hit: &SurfaceHit) -> Point3 {
        let corners = self.mesh.corners(hit.triangle as usize);
        let normals = self.normals.of_triangle(&self.mesh, hit.triangle as usize);
        let pull: Vector3 = (0..3)
            .map(|i| {
                let normal = normals[i];
                normal * (hit.barycentric[i] * (hit.point - corners[i]).dot(&normal))
            })
            .sum();
        hit.point - pull * 0.5
    }

    /// True if a hit lies on a border of the surface.
    pub fn is_on_border(&self, hit: &SurfaceHit) -> bool {
        let triangle = hit.triangle as usize;
        match hit.feature {
            Feature::Face => false,
            Feature::Edge(edge) => self.border_sides[triangle] >> edge & 1 == 1,
            Feature::Vertex(corner) => {
                let vertex = self.mesh.triangles()[triangle][usize::from(corner)];
                self.border_vertices[vertex as usize]
            }
        }
    }

    /// Outlines and holes.
    pub fn borders(&self) -> &[Border] {
        self.borders
            .get_or_init(|| Border::all(&self.mesh, &self.border_edges, self.vertex_normals()))
    }

    /// The vertex closest to `query` within `max_distance`, as (vertex, squared distance).
    pub fn nearest_node(
        &self,
        query: &Point3,
        max_distance: f64,
        hint: Option<u32>,
    ) -> Option<(u32, f64)> {
        let tree = self
            .nodes
            .get_or_init(|| PointTree::build(self.mesh.positions().to_vec()));
        let found = tree.nearest(query, max_distance, hint)?;
        Some((found.index, found.distance_sq))
    }
}

impl std::fmt::Debug for Surface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Surface")
            .field("n_triangles", &self.mesh.n_triangles())
            .field("measures", &self.measures)
            .finish_non_exhaustive()
    }
}

/// Normals of vertices and corners, and a third of the area around each vertex.
fn normals_and_areas(
    mesh: &TriMesh,
    vectors: &[Vector3],
    monitor: &Monitor,
) -> Result<(CornerNormals, Vec<f64>), Cancelled> {
    let faces = map_chunks(vectors.len(), monitor, |t| {
        vectors[t].try_normalize(0.0).unwrap_or_default()
    })?;
    let fans = VertexFans::of(mesh, monitor)?;
    let sharp = SHARP_EDGE_DEG.to_radians();
    let normals = corner_normals(mesh, &faces, &fans, sharp, monitor)?;
    let areas = map_chunks(mesh.n_vertices(), monitor, |vertex| {
        let around = fans.around(vertex).iter();
        around.map(|&c| vectors[c as usize / 3].norm() / 3.0).sum()
    })?;
    Ok((normals, areas))
}

/// For each triangle a bit for each side on the border, and which vertices lie on it.
fn border_marks(mesh: &TriMesh, border_edges: &BorderEdges) -> (Vec<u8>, Vec<bool>) {
    let mut sides = vec![0u8; mesh.n_triangles()];
    let mut vertices = vec![false; mesh.n_vertices()];
    for edge in border_edges.iter() {
        let [u, v] = edge.ends;
        vertices[u as usize] = true;
        vertices[v as usize] = true;
        let triangle = edge.triangle as usize;
        let corners = mesh.triangles()[triangle];
        for i in 0..3 {
            if [corners[i], corners[(i + 1) % 3]] == [u, v] {
                sides[triangle] |= 1 << i;
            }
        }
    }
    (sides, vertices)
}

/// The centroid with eigenvectors and square roots of the eigenvalues of the surface's covariance, exact over
/// each triangle.
pub(crate) fn principal_frame(
    mesh: &TriMesh,
    vectors: &[Vector3],
    area: f64,
    monitor: &Monitor,
) -> Result<(Point3, Matrix3, Vector3), Cancelled> {
    let centroid = mesh.centroid();
    monitor.check()?;
    let mut covariance = Matrix3::zeros();
    for_chunks(vectors.len(), monitor, |range| {
        for t in range {
            let [a, b, c] = mesh.corners(t).map(|p| p - centroid);
            let sum = a + b + c;
            let moment =
                a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
            covariance += moment * (vectors[t].norm() / 12.0);
        }
    })?;
    let eigen = SymmetricEigen::new(covariance / area);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let first: Vector3 = eigen.eigenvectors.column(order[0]).into();
    let second: Vector3 = eigen.eigenvectors.column(order[1]).into();
    let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
    let spread = Vector3::from(order.map(|i| eigen.eigenvalues[i].max(0.0).sqrt()));
    Ok((centroid, axes, spread))
}

/// Over every smooth interior edge the sagitta h·φ/8 of an arc of span h (mean height of both
/// triangles) that turns by the dihedral angle φ; half its square, averaged over the area.
fn chordal_error(
    mesh: &TriMesh,
    topology: &Topology,
    vectors: &[Vector3],
    monitor: &Monitor,
) -> Result<f64, Cancelled> {
    let (mut sum, mut share_sum) = (0.0, 0.0);
    for_chunks(topology.edges.len(), monitor, |range| {
        for edge in range {
            let &[s, t] = topology.triangles_of(edge) else {
                continue;
            };
            let [u, v] = topology.edges[edge].map(|v| mesh.positions()[v as usize]);
            let length = (v - u).norm();
            let (a, b) = (vectors[s as usize], vectors[t as usize]);
            let share = a.norm() + b.norm();
            let angle = a.cross(&b).norm().atan2(a.dot(&b));
            if length > 0.0 && angle < SHARP_EDGE_DEG.to_radians() {
                let sagitta = share / length * angle / 8.0;
                sum += share * sagitta * sagitta / 2.0;
            }
            share_sum += share;
        }
    })?;
    Ok(if share_sum > 0.0 {
        (sum / share_sum).sqrt()
    } else {
        0.0
    })
}
