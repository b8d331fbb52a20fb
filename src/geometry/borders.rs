//! The borders of a sheet: its trim and its holes.

use super::{BorderEdges, BorderLoop, Matrix3, Point3, TriMesh, Vector3, any_perpendicular};

/// The sheet lies around a hole: the way out of it points to the middle with at least this mean cosine.
const INWARD: f64 = 0.3;
/// A hole is round if its vertices lie within this share of the radius of one circle. Three always do.
const ROUND: f64 = 0.1;
const LEAST_ROUND: usize = 4;
/// Fewer vertices lie on a circle so closely by chance that they do not tell how round the hole is.
const LEAST_KNOWN: usize = 8;
/// Vertices lie around the centre of their circle if the middle of their edges is at most this share of the radius
/// away.
const AROUND: f64 = 0.6;

/// One border: a loop of border edges that passes no vertex twice, or a chain of them that ends where three triangles
/// meet at an edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Border {
    /// Its vertices in the direction of their triangles, which lie to the left.
    pub vertices: Vec<u32>,
    /// Whether the last vertex is joined to the first.
    pub closed: bool,
    /// Length of its edges.
    pub length: f64,
    /// Of a round hole the centre of the circle through its vertices, which does not depend on how they are spread over
    /// it; else the middle of the edges, by length.
    pub center: Point3,
    /// That circle.
    pub circle: Option<Circle>,
    /// Whether it is closed and the sheet lies around it. Other borders are outlines.
    pub is_hole: bool,
}

/// The circle through the vertices of a round hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// Its radius.
    pub radius: f64,
    /// How far the vertices lie off it at most; `None` where they are too few to tell.
    pub deviation: Option<f64>,
}

impl Circle {
    /// The same in a frame of another length unit.
    pub fn scaled(self, scale: f64) -> Self {
        Self {
            radius: self.radius * scale,
            deviation: self.deviation.map(|deviation| deviation * scale),
        }
    }
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
        let is_hole = closed && vertices.len() > 2 && inward > INWARD * whole;
        let circle = is_hole.then(|| circle(&vertices, mesh, &center)).flatten();
        Self {
            center: circle.map_or(center, |(center, _)| center),
            circle: circle.map(|(_, circle)| circle),
            is_hole,
            vertices,
            closed,
            length,
        }
    }
}

/// Centre of the circle, and the circle, through the vertices of a hole about `middle`, by least squares of the squared
/// distances (Kåsa 1976); `None` unless it is round. Across the sheet it lies where the middle does.
fn circle(vertices: &[u32], mesh: &TriMesh, middle: &Point3) -> Option<(Point3, Circle)> {
    if vertices.len() < LEAST_ROUND {
        return None;
    }
    let area: Vector3 = segments(vertices, true, mesh)
        .map(|[a, b]| (a - middle).cross(&(b - middle)))
        .sum();
    let normal = area.try_normalize(0.0)?;
    let first = any_perpendicular(&normal);
    let second = normal.cross(&first);
    let arms = vertices.iter().map(|&v| {
        let arm = mesh.positions()[v as usize] - middle;
        [arm.dot(&first), arm.dot(&second)]
    });
    let (mut left, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for [x, y] in arms.clone() {
        let row = Vector3::new(2.0 * x, 2.0 * y, 1.0);
        left += row * row.transpose();
        right += row * (x * x + y * y);
    }
    let [x, y, rest] = left.lu().solve(&right)?.into();
    let radius = (rest + x * x + y * y).sqrt();
    let off = arms.map(|[a, b]| ((a - x).hypot(b - y) - radius).abs());
    let deviation = off.fold(0.0, f64::max);
    let is_around = x.hypot(y) <= AROUND * radius;
    let is_circle = is_around && deviation <= ROUND * radius;
    let circle = Circle {
        radius,
        deviation: (vertices.len() >= LEAST_KNOWN).then(|| {
            // The three unknowns of the circle take up some of it.
            let n = vertices.len() as f64;
            deviation * n / (n - 3.0)
        }),
    };
    is_circle.then(|| (middle + first * x + second * y, circle))
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

    /// A flat sheet of 10 × 10 unit squares without those in these columns and rows.
    fn sheet(left_out: &[(usize, usize)]) -> TriMesh {
        let points = (0..121).map(|i| Point3::new((i % 11) as f64, (i / 11) as f64, 0.0));
        let cells = (0..100).map(|i| (i % 10, i / 10));
        let cells = cells.filter(|cell| !left_out.contains(cell));
        let triangles = cells.flat_map(|(x, y)| {
            let a = (y * 11 + x) as u32;
            [[a, a + 1, a + 12], [a, a + 12, a + 11]]
        });
        TriMesh::new(points.collect(), triangles.collect()).unwrap()
    }

    /// Whether each border is a hole, with its length and its middle in thousandths, sorted.
    fn borders(mesh: &TriMesh) -> Vec<(bool, [i64; 4])> {
        let found = Border::all(mesh, &edges_of(mesh), &mesh.vertex_normals());
        let rounded = |length: f64| (1000.0 * length).round() as i64;
        let figures = found.iter().map(|border| {
            assert!(border.closed);
            let [x, y, z] = border.center.into();
            (border.is_hole, [border.length, x, y, z].map(rounded))
        });
        let mut figures: Vec<_> = figures.collect();
        figures.sort_unstable();
        figures
    }

    /// The mesh with its vertices numbered from the last to the first.
    fn renumbered(mesh: &TriMesh) -> TriMesh {
        let last = mesh.n_vertices() as u32 - 1;
        let points = mesh.positions().iter().rev().copied();
        let triangles = mesh
            .triangles()
            .iter()
            .map(|corners| corners.map(|v| last - v));
        TriMesh::new(points.collect(), triangles.collect()).unwrap()
    }

    /// Six triangles around a vertex of which every other one is left out, within a ring of squares and triangles.
    fn three_holes_at_one_vertex() -> TriMesh {
        let corner = |i: u32, radius: f64| {
            let angle = f64::from(i) * std::f64::consts::FRAC_PI_3;
            Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let ring = |radius: f64| (0..6).map(move |i| corner(i, radius));
        let points = [Point3::origin()]
            .into_iter()
            .chain(ring(1.0))
            .chain(ring(2.0));
        let around = (0..6_u32).flat_map(|i| {
            let (a, b) = (1 + i, 1 + (i + 1) % 6);
            [[a, a + 6, b + 6], [a, b + 6, b]]
        });
        let inner = (0..6_u32).step_by(2).map(|i| [0, 1 + i, 2 + i]);
        TriMesh::new(points.collect(), around.chain(inner).collect()).unwrap()
    }

    #[test]
    fn borders_that_touch_at_a_vertex_are_several_however_the_vertices_are_numbered() {
        let outline = (false, [40_000, 5000, 5000, 0]);
        let hole = |x: i64, y: i64| (true, [4000, 1000 * x + 500, 1000 * y + 500, 0]);
        // A hole that shares a corner with a square cut out of the edge.
        let notched = sheet(&[(0, 4), (1, 5)]);
        let notch = borders(&sheet(&[(0, 4)]))[0];
        let three = [0.0_f64, 1.0, 2.0].map(|third| {
            let angle = std::f64::consts::FRAC_PI_2 * (1.0 + 4.0 * third / 3.0);
            let middle = [angle.cos(), angle.sin()].map(|x| (1000.0 * x / 3.0_f64.sqrt()).round());
            (true, [3000, middle[0] as i64, middle[1] as i64, 0])
        });
        let ring = [(false, [12_000, 0, 0, 0])].into_iter().chain(three);
        for (mesh, expected) in [
            (
                sheet(&[(4, 4), (5, 5)]),
                vec![outline, hole(4, 4), hole(5, 5)],
            ),
            (
                sheet(&[(3, 3), (4, 4), (5, 3), (4, 2)]),
                vec![
                    outline,
                    (false, [4000, 4500, 3500, 0]),
                    (true, [12_000, 4500, 3500, 0]),
                ],
            ),
            (notched, vec![notch, hole(1, 5)]),
            (three_holes_at_one_vertex(), ring.collect()),
        ] {
            let mut expected = expected;
            expected.sort_unstable();
            for mesh in [renumbered(&mesh), mesh] {
                assert_eq!(borders(&mesh), expected);
                assert_eq!(borders(&mesh.flipped()), expected);
            }
        }
    }

    #[test]
    fn no_border_passes_a_vertex_twice() {
        let mesh = sheet(&[(2, 2), (3, 3), (4, 2), (4, 4), (6, 6), (9, 9), (8, 8)]);
        let edges = edges_of(&mesh);
        for edges in [edges.flipped(), edges] {
            let loops = edges.loops();
            assert_eq!(
                loops.iter().map(|l| l.vertices.len()).sum::<usize>(),
                edges.iter().count()
            );
            for BorderLoop { vertices, .. } in &loops {
                let mut distinct = vertices.clone();
                distinct.sort_unstable();
                distinct.dedup();
                assert_eq!(distinct.len(), vertices.len());
                assert_eq!(distinct[0], vertices[0]);
            }
            assert!(loops.is_sorted_by_key(|l| l.vertices[0]));
        }
        assert_eq!(edges_of(&mesh.clone().flipped()), edges_of(&mesh).flipped());
    }

    fn edges_of(mesh: &TriMesh) -> BorderEdges {
        BorderEdges::of(mesh, &Topology::of(mesh))
    }

    #[test]
    fn the_center_of_a_round_hole_is_that_of_its_circle() {
        let at =
            |angle: f64, radius: f64| Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        // The centre of a hole with these vertices on a circle of radius 5, and how far the middle of its edges is off.
        let center = |angles: &[f64]| {
            let n = angles.len() as u32;
            let positions: Vec<Point3> = [5.0, 20.0]
                .into_iter()
                .flat_map(|radius| angles.iter().map(move |&angle| at(angle, radius)))
                .collect();
            let cell = |k: u32| {
                let next = (k + 1) % n;
                [[k, n + k, n + next], [k, n + next, next]]
            };
            let mesh = TriMesh::new(positions, (0..n).flat_map(cell).collect()).unwrap();
            let normals = vec![Vector3::z(); mesh.n_vertices()];
            let borders = Border::all(&mesh, &edges_of(&mesh), &normals);
            let hole = borders.into_iter().find(|border| border.is_hole).unwrap();
            let middle: Vector3 = hole
                .segments(&mesh)
                .map(|[a, b]| nalgebra::center(&a, &b).coords * (b - a).norm() / hole.length)
                .sum();
            (hole.center.coords.norm(), middle.norm())
        };
        for angles in [
            [0.0, 0.8, 1.9, 4.0].as_slice(),
            &[0.0, 0.5, 1.0, 1.5, 2.0, 4.4],
        ] {
            let (off, off_by_length) = center(angles);
            assert!(off < 1e-9 && off_by_length > 0.5, "{off} {off_by_length}");
        }
        // Three vertices lie on a circle whatever the hole is.
        let (off, off_by_length) = center(&[0.0, 1.5, 3.5]);
        assert!((off - off_by_length).abs() < 1e-9);
    }

    #[test]
    fn a_sheet_has_a_trim_and_its_hole() {
        let mesh = sheet(&[(2, 2)]);
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
