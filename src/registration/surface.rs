use std::sync::{Arc, OnceLock};

use nalgebra::SymmetricEigen;
use rayon::prelude::*;

use super::RegistrationError;
use crate::geometry::{Matrix3, Point3, Topology, TriMesh, Vector3, orient_consistently, weld};
use crate::search::{Bvh, Feature, PointTree, SurfaceHit};

/// Triangles that meet at more than this angle form a sharp edge, which stays flat-sided.
const SHARP_EDGE_DEG: f64 = 40.0;

/// A mesh made ready for matching: joined at equal positions, consistently oriented, with its tree,
/// its normals and its measures. Made once per mesh and shared by registration and assessment.
pub struct Surface {
    mesh: Arc<TriMesh>,
    bvh: Bvh,
    /// The tree for nearest nodes, made when first asked for.
    nodes: OnceLock<PointTree>,
    vertex_of: Vec<u32>,
    n_turned: usize,
    vertex_normals: Vec<Vector3>,
    vertex_areas: Vec<f64>,
    corner_normals: Vec<[Vector3; 3]>,
    border_edges: Vec<u8>,
    border_vertices: Vec<bool>,
    measures: Measures,
}

/// Size, place and direction of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Surface area.
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
    /// Prepares `mesh`; `side` (`source` or `target`) is for the message. An error if no triangle
    /// has an area. O(triangles · log triangles).
    pub fn new(mesh: &TriMesh, side: &'static str) -> Result<Self, RegistrationError> {
        let welded = weld(mesh, 0.0);
        let mut mesh = welded.mesh;
        if mesh.area() <= 0.0 || !mesh.area().is_finite() {
            return Err(RegistrationError::EmptyMesh { side });
        }
        let topology = Topology::of(&mesh);
        let mut n_turned = 0;
        if !is_consistent(&mesh, &topology) {
            (mesh, n_turned) = orient_consistently(&mesh);
        }
        let mesh = Arc::new(mesh);
        let (bvh, (corner_normals, measures)) = rayon::join(
            || Bvh::build(mesh.clone()),
            || (corner_normals(&mesh), measures(&mesh, &topology)),
        );
        let (border_edges, border_vertices) = borders(&mesh, &topology);
        Ok(Self {
            bvh,
            nodes: OnceLock::new(),
            vertex_of: welded.vertex_of,
            n_turned,
            vertex_normals: mesh.vertex_normals(),
            vertex_areas: mesh.vertex_areas(),
            corner_normals,
            border_edges,
            border_vertices,
            measures,
            mesh,
        })
    }

    /// The mesh after joining and orienting.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// The tree over [`Surface::mesh`].
    pub fn bvh(&self) -> &Bvh {
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

    /// The vertices of the mesh passed in that triangles use, in their order.
    pub fn nodes_as_given(&self) -> Vec<Point3> {
        let used = self.vertex_of.iter().filter(|&&v| v != u32::MAX);
        used.map(|&v| self.mesh.positions()[v as usize]).collect()
    }

    /// How many triangles were turned to agree with their neighbours.
    pub fn n_turned(&self) -> usize {
        self.n_turned
    }

    /// Unit normals of the vertices.
    pub fn vertex_normals(&self) -> &[Vector3] {
        &self.vertex_normals
    }

    /// A third of the area around each vertex.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// The unit normal at a hit, interpolated between the triangle's corners; across sharp edges
    /// the corners do not share their normals.
    pub fn normal_at(&self, hit: &SurfaceHit) -> Vector3 {
        let normals = &self.corner_normals[hit.triangle as usize];
        let sum: Vector3 = (0..3).map(|i| normals[i] * hit.barycentric[i]).sum();
        sum.try_normalize(0.0)
            .unwrap_or_else(|| self.mesh.normal(hit.triangle as usize))
    }

    /// A hit on the flat triangle moved half way to where the corner normals put the smooth
    /// surface: q − ½ Σ βᵢ ((q − vᵢ)·nᵢ) nᵢ, exact to second order on a circular arc (Phong
    /// tessellation, Boubekeur and Alexa 2008, with α = ½). Corners stay where they are.
    pub fn curved_point(&self, hit: &SurfaceHit) -> Point3 {
        let corners = self.mesh.corners(hit.triangle as usize);
        let normals = &self.corner_normals[hit.triangle as usize];
        let pull: Vector3 = (0..3)
            .map(|i| {
                let normal = normals[i];
                normal * (hit.barycentric[i] * (hit.point - corners[i]).dot(&normal))
            })
            .sum();
        hit.point - pull * 0.5
    }

    /// True if a hit lies on the rim of the surface.
    pub fn is_on_border(&self, hit: &SurfaceHit) -> bool {
        let triangle = hit.triangle as usize;
        match hit.feature {
            Feature::Face => false,
            Feature::Edge(edge) => self.border_edges[triangle] >> edge & 1 == 1,
            Feature::Vertex(corner) => {
                let vertex = self.mesh.triangles()[triangle][usize::from(corner)];
                self.border_vertices[vertex as usize]
            }
        }
    }

    /// The edges with one triangle, as their vertices in the direction of the triangle.
    pub(crate) fn border_edges(&self) -> Vec<[u32; 2]> {
        let triangles = self.border_edges.iter().zip(self.mesh.triangles());
        let of_triangle = |(&edges, corners): (&u8, &[u32; 3])| {
            let on_border = (0..3).filter(move |edge| edges >> edge & 1 == 1);
            let corners = *corners;
            on_border.map(move |edge| [corners[edge], corners[(edge + 1) % 3]])
        };
        triangles.flat_map(of_triangle).collect()
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

/// True if no two neighbours over a manifold edge run along it in the same direction.
fn is_consistent(mesh: &TriMesh, topology: &Topology) -> bool {
    let runs_forward = |triangle: u32, [u, v]: [u32; 2]| {
        let corners = mesh.triangles()[triangle as usize];
        (0..3).any(|i| corners[i] == u && corners[(i + 1) % 3] == v)
    };
    (0..topology.edges.len()).all(|edge| match topology.triangles_of(edge) {
        &[s, t] => {
            let ends = topology.edges[edge];
            runs_forward(s, ends) != runs_forward(t, ends)
        }
        _ => true,
    })
}

/// Per triangle a bit for each border edge, and which vertices lie on a border.
fn borders(mesh: &TriMesh, topology: &Topology) -> (Vec<u8>, Vec<bool>) {
    let mut edges = vec![0u8; mesh.n_triangles()];
    let mut vertices = vec![false; mesh.n_vertices()];
    for edge in topology.border_edges() {
        let [u, v] = topology.edges[edge];
        vertices[u as usize] = true;
        vertices[v as usize] = true;
        let triangle = topology.triangles_of(edge)[0] as usize;
        let corners = mesh.triangles()[triangle];
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a, b) == (u, v) || (a, b) == (v, u) {
                edges[triangle] |= 1 << i;
            }
        }
    }
    (edges, vertices)
}

/// For each corner of each triangle the angle-weighted mean normal of the triangles around the
/// vertex that do not turn away by more than [`SHARP_EDGE_DEG`].
fn corner_normals(mesh: &TriMesh) -> Vec<[Vector3; 3]> {
    let n_vertices = mesh.n_vertices();
    let mut start = vec![0u32; n_vertices + 1];
    for &vertex in mesh.triangles().iter().flatten() {
        start[vertex as usize + 1] += 1;
    }
    for v in 0..n_vertices {
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut around = vec![(0u32, 0u8); 3 * mesh.n_triangles()];
    for (t, corners) in mesh.triangles().iter().enumerate() {
        for (i, &vertex) in corners.iter().enumerate() {
            around[fill[vertex as usize] as usize] = (t as u32, i as u8);
            fill[vertex as usize] += 1;
        }
    }
    let flat: Vec<(Vector3, [f64; 3])> = (0..mesh.n_triangles())
        .into_par_iter()
        .with_min_len(512)
        .map(|t| (mesh.normal(t), corner_angles(&mesh.corners(t))))
        .collect();
    let min_cos = SHARP_EDGE_DEG.to_radians().cos();
    (0..mesh.n_triangles())
        .into_par_iter()
        .with_min_len(512)
        .map(|t| {
            let own = flat[t].0;
            mesh.triangles()[t].map(|vertex| {
                let fan = start[vertex as usize] as usize..start[vertex as usize + 1] as usize;
                let sum: Vector3 = around[fan]
                    .iter()
                    .map(|&(other, corner)| {
                        let (normal, angles) = &flat[other as usize];
                        if normal.dot(&own) >= min_cos {
                            normal * angles[usize::from(corner)]
                        } else {
                            Vector3::zeros()
                        }
                    })
                    .sum();
                sum.try_normalize(0.0).unwrap_or(own)
            })
        })
        .collect()
}

fn corner_angles(points: &[Point3; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let u = points[(i + 1) % 3] - points[i];
        let v = points[(i + 2) % 3] - points[i];
        u.cross(&v).norm().atan2(u.dot(&v))
    })
}

fn measures(mesh: &TriMesh, topology: &Topology) -> Measures {
    let area = mesh.area();
    let centroid = mesh.centroid();
    let (principal_axes, principal_spread) = principal_frame(mesh, &centroid, area);
    Measures {
        area,
        centroid,
        mean_normal: mesh.mean_normal(),
        principal_axes,
        principal_spread,
        diagonal: mesh.aabb().diagonal(),
        mean_edge_length: mesh.mean_edge_length(),
        chordal_error: chordal_error(mesh, topology),
    }
}

/// Eigenvectors and square roots of the eigenvalues of the surface's covariance, exact over each
/// triangle.
fn principal_frame(mesh: &TriMesh, centroid: &Point3, area: f64) -> (Matrix3, Vector3) {
    let mut covariance = Matrix3::zeros();
    for t in 0..mesh.n_triangles() {
        let [a, b, c] = mesh.corners(t).map(|p| p - centroid);
        let sum = a + b + c;
        let moment =
            a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
        covariance += moment * (mesh.triangle_area(t) / 12.0);
    }
    let eigen = SymmetricEigen::new(covariance / area);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let first: Vector3 = eigen.eigenvectors.column(order[0]).into();
    let second: Vector3 = eigen.eigenvectors.column(order[1]).into();
    let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
    let spread = Vector3::from(order.map(|i| eigen.eigenvalues[i].max(0.0).sqrt()));
    (axes, spread)
}

/// Over every smooth interior edge the sagitta h·φ/8 of an arc of span h (mean height of both
/// triangles) that turns by the dihedral angle φ; half its square, averaged over the area.
fn chordal_error(mesh: &TriMesh, topology: &Topology) -> f64 {
    let (mut sum, mut share_sum) = (0.0, 0.0);
    for (edge, &[u, v]) in topology.edges.iter().enumerate() {
        let &[s, t] = topology.triangles_of(edge) else {
            continue;
        };
        let length = (mesh.positions()[v as usize] - mesh.positions()[u as usize]).norm();
        let (a, b) = (mesh.area_vector(s as usize), mesh.area_vector(t as usize));
        let share = a.norm() + b.norm();
        let angle = a.cross(&b).norm().atan2(a.dot(&b));
        if length > 0.0 && angle < SHARP_EDGE_DEG.to_radians() {
            let sagitta = share / length * angle / 8.0;
            sum += share * sagitta * sagitta / 2.0;
        }
        share_sum += share;
    }
    if share_sum > 0.0 {
        (sum / share_sum).sqrt()
    } else {
        0.0
    }
}
