//! The borders of a sheet: its trim and its holes.

use super::{BorderEdges, BorderLoop, Point3, TriMesh, Vector3};

/// The sheet lies around a hole: the way out of it points to the middle with at least this mean cosine.
const INWARD: f64 = 0.3;

/// One border: a loop of border edges, or a chain of them that ends where two sheets touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// Its vertices in the direction of their triangles, which lie to the left.
    pub vertices: Vec<u32>,
    /// Whether the last vertex is joined to the first.
    pub closed: bool,
    /// Length of its edges.
    pub length: f64,
    /// Middle of its edges, by length.
    pub center: Point3,
    /// Whether it is closed and the sheet lies around it. Other borders are outlines.
    pub is_hole: bool,
}

impl Border {
    /// The borders of a mesh that is joined at equal positions, each starting at its smallest vertex and
    /// ordered by it. `normals` are those of the vertices. O(edges).
    pub fn all(mesh: &TriMesh, edges: &BorderEdges, normals: &[Vector3]) -> Vec<Self> {
        let loops = edges.loops().into_iter();
        loops.map(|chain| Self::of(chain, mesh, normals)).collect()
    }

    /// Its edges as pairs of points.
    pub fn segments<'a>(&'a self, mesh: &'a TriMesh) -> impl Iterator<Item = [Point3; 2]> + 'a {
        segments(&self.vertices, self.closed, mesh)
    }

    fn of(chain: BorderLoop, mesh: &TriMesh, normals: &[Vector3]) -> Self {
        let BorderLoop { vertices, closed } = chain;
        let (mut length, mut sum) = (0.0, Vector3::zeros());
        for [a, b] in segments(&vertices, closed, mesh) {
            let side = (b - a).norm();
            length += side;
            sum += nalgebra::center(&a, &b).coords * side;
        }
        // Points of no extent have no middle by length.
        let center = if length > 0.0 {
            Point3::from(sum / length)
        } else {
            mesh.positions()[vertices[0] as usize]
        };
        let (mut inward, mut whole) = (0.0, 0.0);
        for (&vertex, [a, b]) in vertices.iter().zip(segments(&vertices, closed, mesh)) {
            let outwards = (b - a).cross(&normals[vertex as usize]);
            let arm = a - center;
            inward -= arm.dot(&outwards);
            whole += arm.norm() * outwards.norm();
        }
        Self {
            is_hole: closed && vertices.len() > 2 && inward > INWARD * whole,
            vertices,
            closed,
            length,
            center,
        }
    }
}

fn segments<'a>(
    vertices: &'a [u32],
    closed: bool,
    mesh: &'a TriMesh,
) -> impl Iterator<Item = [Point3; 2]> + 'a {
    let count = if closed {
        vertices.len()
    } else {
        vertices.len().saturating_sub(1)
    };
    let at = move |i: usize| mesh.positions()[vertices[i % vertices.len()] as usize];
    (0..count).map(move |i| [at(i), at(i + 1)])
}

#[cfg(test)]
mod tests {
    use super::super::Topology;
    use super::*;

    /// A flat sheet of 10 × 10 unit squares without the one in column and row 2.
    fn sheet() -> TriMesh {
        let points = (0..121).map(|i| Point3::new((i % 11) as f64, (i / 11) as f64, 0.0));
        let cells = (0..100).map(|i| (i % 10, i / 10));
        let triangles = cells.filter(|&cell| cell != (2, 2)).flat_map(|(x, y)| {
            let a = (y * 11 + x) as u32;
            [[a, a + 1, a + 12], [a, a + 12, a + 11]]
        });
        TriMesh::new(points.collect(), triangles.collect()).unwrap()
    }

    #[test]
    fn a_sheet_has_a_trim_and_its_hole() {
        let mesh = sheet();
        for normal in [Vector3::z(), -Vector3::z()] {
            // Turned over, triangles and normals change together.
            let triangles =
                mesh.triangles().iter().map(
                    |&[a, b, c]| {
                        if normal.z > 0.0 { [a, b, c] } else { [a, c, b] }
                    },
                );
            let mesh = TriMesh::new(mesh.positions().to_vec(), triangles.collect()).unwrap();
            let normals = vec![normal; mesh.n_vertices()];
            let edges = BorderEdges::of(&mesh, &Topology::of(&mesh));
            let borders = Border::all(&mesh, &edges, &normals);
            let [trim, hole] = &borders[..] else {
                panic!("{} borders", borders.len());
            };
            assert!(trim.closed && !trim.is_hole && hole.closed && hole.is_hole);
            assert!((trim.length - 40.0).abs() < 1e-12 && (hole.length - 4.0).abs() < 1e-12);
            assert!((hole.center - Point3::new(2.5, 2.5, 0.0)).norm() < 1e-12);
            let around: f64 = hole.segments(&mesh).map(|[a, b]| (b - a).norm()).sum();
            assert!((around - hole.length).abs() < 1e-12);
        }
    }
}
