//! Edge lines of a [`RenderMesh`](super::RenderMesh).

use crate::geometry::{Topology, TriMesh, Vector3};

/// Edges that turn by more are drawn as creases: cos 25°.
const FEATURE_COS: f64 = 0.906_307_787_036_650;
/// Creases sharper than this are certain: cos 34°.
const CERTAIN_COS: f64 = 0.829_037_572_555_041_7;
/// Creases sharper than this are drawn however short they are: cos 50°.
const SHARP_COS: f64 = 0.642_787_609_686_539_4;
/// Softer creases are drawn where at least so many edges hang together: a fold that runs at an angle to the
/// mesh jumps from row to row, and its pieces would look like stitches.
const MIN_CHAIN: u32 = 20;
/// And where at least one in so many is certain. Radii meshed with three or four elements bend by about
/// 25° per row, and only some of their edges lie above the limit.
const CERTAIN_ONE_IN: u32 = 3;

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
    /// Edges at which the sheet ends.
    pub(super) borders: Vec<usize>,
}

impl EdgeClasses {
    pub(super) fn of(topology: &Topology, faces: &[Vector3], elements: Option<&[u32]>) -> Self {
        let mut classes = Self::default();
        let mut creases = Vec::new();
        for edge in 0..topology.edges.len() {
            let around = topology.triangles_of(edge);
            if is_inside_element(around, elements) {
                continue;
            }
            classes.elements.push(edge);
            match around {
                // Sides of a crack are edges between elements like any other.
                [_] => {}
                [a, b] => {
                    let (a, b) = (faces[*a as usize], faces[*b as usize]);
                    // Neighbours of opposite winding are as flat as those of equal winding.
                    let cos = a.dot(&b).abs();
                    let degenerate = a == Vector3::zeros() || b == Vector3::zeros();
                    if cos < FEATURE_COS && !degenerate {
                        creases.push(Crease { edge, cos });
                    }
                }
                _ => creases.push(Crease { edge, cos: 0.0 }),
            }
        }
        classes.features = clear_creases(topology, &creases);
        classes.borders = topology.border_edges().collect();
        classes
    }
}

fn is_inside_element(around: &[u32], elements: Option<&[u32]>) -> bool {
    let (Some(elements), [a, b]) = (elements, around) else {
        return false;
    };
    let element = |t: &u32| elements.get(*t as usize);
    element(a).is_some() && element(a) == element(b)
}

/// An edge that may be drawn as a crease, and the cosine of its bend.
#[derive(Debug, Clone, Copy)]
struct Crease {
    edge: usize,
    cos: f64,
}

/// The creases that are sharp, and the softer ones that hang together with many others of which enough
/// are certain (thresholding with hysteresis, Canny 1986). Keeps the order.
fn clear_creases(topology: &Topology, creases: &[Crease]) -> Vec<usize> {
    let mut ends: Vec<u32> = creases
        .iter()
        .flat_map(|c| topology.edges[c.edge])
        .collect();
    ends.sort_unstable();
    ends.dedup();
    // Union–find over the ends of the candidates.
    let mut parent: Vec<usize> = (0..ends.len()).collect();
    let place = |vertex: u32| ends.partition_point(|&v| v < vertex);
    for crease in creases {
        let [a, b] = topology.edges[crease.edge].map(|v| root(&mut parent, place(v)));
        parent[a.max(b)] = a.min(b);
    }
    let mut chain_of = |edge: usize| root(&mut parent, place(topology.edges[edge][0]));
    // All edges of a chain, and those that are certain.
    let mut counts = vec![[0_u32; 2]; ends.len()];
    for crease in creases {
        let [all, certain] = &mut counts[chain_of(crease.edge)];
        *all += 1;
        *certain += u32::from(crease.cos < CERTAIN_COS);
    }
    let mut is_clear = |crease: &&Crease| {
        let [all, certain] = counts[chain_of(crease.edge)];
        crease.cos < SHARP_COS || (all >= MIN_CHAIN && certain * CERTAIN_ONE_IN >= all)
    };
    let clear = creases.iter().filter(|crease| is_clear(crease));
    clear.map(|crease| crease.edge).collect()
}

fn root(parent: &mut [usize], mut node: usize) -> usize {
    while parent[node] != node {
        parent[node] = parent[parent[node]];
        node = parent[node];
    }
    node
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

    fn face_normals(mesh: &TriMesh) -> Vec<Vector3> {
        (0..mesh.n_triangles()).map(|t| mesh.normal(t)).collect()
    }

    /// A sheet of `n` elements along a bend of `angle`.
    fn long_bend(n: u32, angle: f64) -> TriMesh {
        let (sin, cos) = angle.sin_cos();
        let rows = [(-1.0, 0.0), (0.0, 0.0), (cos, sin)];
        let positions = (0..=n)
            .flat_map(|i| rows.map(|(y, z)| Point3::new(f64::from(i), y, z)))
            .collect();
        let quad = |a: u32, b: u32| [[a, b, b + 1], [a, b + 1, a + 1]];
        let triangles = (0..n)
            .flat_map(|i| [quad(3 * i, 3 * i + 3), quad(3 * i + 1, 3 * i + 4)].concat())
            .collect();
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn soft_creases_need_company() {
        let n_features = |n, angle| {
            let mesh = long_bend(n, angle);
            let classes = EdgeClasses::of(&Topology::of(&mesh), &face_normals(&mesh), None);
            classes.features.len()
        };
        assert_eq!(n_features(3, 0.6), 0, "three soft edges are noise");
        assert_eq!(n_features(24, 0.6), 24);
        assert_eq!(n_features(24, 0.5), 0, "none of them is certain");
        assert_eq!(n_features(3, 1.2), 3, "sharp ones always count");
        assert_eq!(n_features(24, 0.3), 0);
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
    fn edges_fall_into_their_classes() {
        let mesh = bent(1.0);
        let topology = Topology::of(&mesh);
        let faces = face_normals(&mesh);
        let plain = EdgeClasses::of(&topology, &faces, None);
        assert_eq!((plain.elements.len(), plain.borders.len()), (9, 6));
        assert_eq!(plain.features.len(), 1);
        let quads = EdgeClasses::of(&topology, &faces, Some(&[0, 0, 1, 1]));
        assert_eq!(quads.elements.len(), 7);
        let flat = bent(0.1);
        let classes = EdgeClasses::of(&Topology::of(&flat), &face_normals(&flat), None);
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
