//! Normals and edge lines of a [`RenderMesh`](super::RenderMesh).

use rayon::prelude::*;

use crate::geometry::{Topology, TriMesh, Vector3};

/// Neighbours that turn by less look like one curved sheet: cos 35°.
const SMOOTH_COS: f64 = 0.819_152_044_288_991_8;
/// Edges that turn by more are drawn as creases: cos 25°.
const FEATURE_COS: f64 = 0.906_307_787_036_650;

/// Normal at each corner of each triangle: the mean of the triangles around the vertex that turn by
/// less than 35° against this one, weighted by their angle at the vertex (Thürmer and Wüthrich 1998).
/// Flat areas do not depend on how they are cut, and bends of pressed sheets stay crisp.
pub(super) fn creased_normals(mesh: &TriMesh) -> Vec<Vector3> {
    let n_triangles = mesh.n_triangles();
    let faces: Vec<Vector3> = (0..n_triangles)
        .into_par_iter()
        .map(|t| mesh.normal(t))
        .collect();
    let weights: Vec<[f64; 3]> = (0..n_triangles)
        .into_par_iter()
        .map(|t| corner_angles(mesh, t))
        .collect();
    let (starts, around) = corners_around_vertices(mesh);
    (0..3 * n_triangles)
        .into_par_iter()
        .map(|corner| {
            let own = faces[corner / 3];
            let vertex = mesh.triangles()[corner / 3][corner % 3] as usize;
            let mut sum = Vector3::zeros();
            for &other in &around[starts[vertex] as usize..starts[vertex + 1] as usize] {
                let (triangle, place) = (other as usize / 3, other as usize % 3);
                if faces[triangle].dot(&own) >= SMOOTH_COS {
                    sum += faces[triangle] * weights[triangle][place];
                }
            }
            sum.try_normalize(1e-12).unwrap_or(own)
        })
        .collect()
}

/// Inner angles of a triangle; zero where a side has no length.
fn corner_angles(mesh: &TriMesh, triangle: usize) -> [f64; 3] {
    let points = mesh.corners(triangle);
    std::array::from_fn(|i| {
        let u = points[(i + 1) % 3] - points[i];
        let v = points[(i + 2) % 3] - points[i];
        u.cross(&v).norm().atan2(u.dot(&v))
    })
}

/// For each vertex, where its corners start, and the corners in ascending order.
fn corners_around_vertices(mesh: &TriMesh) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; mesh.n_vertices() + 1];
    for &vertex in mesh.triangles().iter().flatten() {
        starts[vertex as usize + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut around = vec![0u32; 3 * mesh.n_triangles()];
    for (corner, &vertex) in mesh.triangles().iter().flatten().enumerate() {
        let place = &mut next[vertex as usize];
        around[*place as usize] = corner as u32;
        *place += 1;
    }
    (starts, around)
}

/// Octahedral form of a unit vector (Cigolle et al. 2014) in 16 bits per coordinate; z for zero.
pub(super) fn octahedral(normal: &Vector3) -> [i16; 2] {
    let sum = normal.abs().sum();
    if sum == 0.0 {
        return [0, 0];
    }
    let (x, y) = (normal.x / sum, normal.y / sum);
    let folded = if normal.z >= 0.0 {
        [x, y]
    } else {
        [(1.0 - y.abs()) * x.signum(), (1.0 - x.abs()) * y.signum()]
    };
    folded.map(|c| (c * 32767.0).round() as i16)
}

/// Edges of a mesh by what they are, as indices into [`Topology::edges`].
#[derive(Debug, Default)]
pub(super) struct EdgeClasses {
    /// Edges between elements, borders included.
    pub(super) elements: Vec<usize>,
    /// Edges where the surface turns by more than 25°, or more than two triangles meet.
    pub(super) features: Vec<usize>,
    /// Edges of one triangle only.
    pub(super) borders: Vec<usize>,
}

impl EdgeClasses {
    pub(super) fn of(mesh: &TriMesh, topology: &Topology, elements: Option<&[u32]>) -> Self {
        let mut classes = Self::default();
        for edge in 0..topology.edges.len() {
            let around = topology.triangles_of(edge);
            let inside = elements.is_some_and(|elements| {
                let element = |t: u32| elements.get(t as usize);
                around.len() == 2
                    && element(around[0]).is_some()
                    && element(around[0]) == element(around[1])
            });
            if inside {
                continue;
            }
            classes.elements.push(edge);
            match around {
                [_] => classes.borders.push(edge),
                [a, b] => {
                    let (a, b) = (mesh.normal(*a as usize), mesh.normal(*b as usize));
                    // Neighbours of opposite winding are as flat as those of equal winding.
                    let flat = a.dot(&b).abs() >= FEATURE_COS;
                    if !flat && a != Vector3::zeros() && b != Vector3::zeros() {
                        classes.features.push(edge);
                    }
                }
                _ => classes.features.push(edge),
            }
        }
        classes
    }
}

/// The corners at both ends of each edge, taken from its first triangle.
pub(super) fn corner_pairs(mesh: &TriMesh, topology: &Topology, edges: &[usize]) -> Vec<[u32; 2]> {
    let pair = |&edge: &usize| {
        let triangle = topology.triangles_of(edge)[0];
        let corners = mesh.triangles()[triangle as usize];
        topology.edges[edge].map(|vertex| {
            let place = corners.iter().position(|&v| v == vertex);
            3 * triangle + place.expect("an edge's triangle holds both its ends") as u32
        })
    };
    edges.iter().map(pair).collect()
}

/// Mean length of edges; 0 for none.
pub(super) fn mean_length(mesh: &TriMesh, topology: &Topology, edges: &[usize]) -> f64 {
    let length = |&edge: &usize| {
        let [a, b] = topology.edges[edge].map(|v| mesh.positions()[v as usize]);
        (b - a).norm()
    };
    edges.iter().map(length).sum::<f64>() / edges.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn decode([x, y]: [i16; 2]) -> Vector3 {
        let (x, y) = (f64::from(x) / 32767.0, f64::from(y) / 32767.0);
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        Vector3::new(x - fold * x.signum(), y - fold * y.signum(), z).normalize()
    }

    /// A strip bent along y = 0 by `angle`: two squares of two triangles each.
    fn bent(angle: f64) -> TriMesh {
        let (sin, cos) = angle.sin_cos();
        let positions = vec![
            Point3::new(0.0, -1.0, 0.0),
            Point3::new(1.0, -1.0, 0.0),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(1.0, cos, sin),
            Point3::new(0.0, cos, sin),
        ];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]];
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn packed_normals_keep_their_direction() {
        for i in 0..200 {
            let a = f64::from(i) * 0.7;
            let n = Vector3::new(a.sin(), (1.3 * a).cos(), (0.4 * a).sin()).normalize();
            assert!(decode(octahedral(&n)).angle(&n) < 1e-4, "{n}");
        }
        assert_eq!(octahedral(&Vector3::zeros()), [0, 0]);
    }

    #[test]
    fn gentle_bends_are_smooth_and_sharp_ones_creased() {
        let smooth = creased_normals(&bent(0.3));
        // Corner 2 of triangle 0 and corner 1 of triangle 2 are the same vertex.
        assert!((smooth[2] - smooth[7]).norm() < 1e-12);
        assert!(smooth[2].angle(&Vector3::z()) > 0.05);
        let sharp = creased_normals(&bent(1.0));
        assert!((sharp[2] - Vector3::z()).norm() < 1e-12);
        assert!(sharp[7].angle(&Vector3::z()) > 0.9);
    }

    #[test]
    fn edges_fall_into_their_classes() {
        let mesh = bent(1.0);
        let topology = Topology::of(&mesh);
        let plain = EdgeClasses::of(&mesh, &topology, None);
        assert_eq!((plain.elements.len(), plain.borders.len()), (9, 6));
        assert_eq!(plain.features.len(), 1);
        let quads = EdgeClasses::of(&mesh, &topology, Some(&[0, 0, 1, 1]));
        assert_eq!(quads.elements.len(), 7);
        let flat = bent(0.1);
        let classes = EdgeClasses::of(&flat, &Topology::of(&flat), None);
        assert!(classes.features.is_empty());
    }

    #[test]
    fn edge_lines_join_the_right_corners() {
        let mesh = bent(0.5);
        let topology = Topology::of(&mesh);
        let all: Vec<usize> = (0..topology.edges.len()).collect();
        for (pair, edge) in corner_pairs(&mesh, &topology, &all)
            .iter()
            .zip(&topology.edges)
        {
            let vertices = pair.map(|c| mesh.triangles()[c as usize / 3][c as usize % 3]);
            assert_eq!(&vertices, edge);
        }
        assert_eq!(mean_length(&mesh, &topology, &[]), 0.0);
    }
}
