//! Places of a sheet that two meshes of it share: centres of holes and corners of the borders. Nodes differ
//! from mesh to mesh, these do not.

use super::{Border, Point3, TriMesh};

/// A hole is round if its points differ so little in their distance from the middle. That is looser than what
/// [`Border::circle`] takes: a hole that is a little oval has a middle to point at, and only such with a circle are
/// compared by it.
const ROUND: f64 = 0.25;
/// A border turns by at least so much at a corner, in degrees.
const CORNER_DEG: f64 = 45.0;
/// Holes with fewer vertices are slits.
const LEAST: usize = 6;

/// A hole that is about round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundHole {
    /// Middle of its border, see [`Border::center`].
    pub center: Point3,
    /// Mean distance of the border from the middle.
    pub radius: f64,
}

/// What can be pointed at besides nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Landmarks {
    /// Round holes.
    pub holes: Vec<RoundHole>,
    /// Corners of the trim and of holes that are not round.
    pub corners: Vec<Point3>,
}

impl Landmarks {
    /// Walks along borders of a mesh. O(their edges).
    pub fn of<'a>(mesh: &TriMesh, borders: impl IntoIterator<Item = &'a Border>) -> Self {
        let mut found = Self::default();
        for border in borders {
            match round_hole(mesh, border) {
                Some(hole) => found.holes.push(hole),
                None => found.corners.extend(corners(mesh, border)),
            }
        }
        found
    }
}

fn point(mesh: &TriMesh, vertex: u32) -> Point3 {
    mesh.positions()[vertex as usize]
}

fn round_hole(mesh: &TriMesh, border: &Border) -> Option<RoundHole> {
    if !border.is_hole || border.vertices.len() < LEAST {
        return None;
    }
    let center = border.center;
    let (mut least, mut most, mut total) = (f64::INFINITY, 0.0_f64, 0.0);
    for &vertex in &border.vertices {
        let radius = (point(mesh, vertex) - center).norm();
        least = least.min(radius);
        most = most.max(radius);
        total += radius;
    }
    let radius = total / border.vertices.len() as f64;
    (most - least < ROUND * radius).then_some(RoundHole { center, radius })
}

fn corners(mesh: &TriMesh, border: &Border) -> Vec<Point3> {
    let n = border.vertices.len();
    if n < 3 {
        return Vec::new();
    }
    let at = |i: usize| point(mesh, border.vertices[i % n]);
    let range = if border.closed { 0..n } else { 1..n - 1 };
    let least = CORNER_DEG.to_radians();
    let turns = |&i: &usize| {
        let (before, after) = (at(i) - at(i + n - 1), at(i + 1) - at(i));
        before.angle(&after) > least
    };
    range.filter(turns).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{BorderEdges, Topology, Vector3};
    use super::*;

    /// A plate of 40 × 20 with a hole of radius 4 in the middle: a ring of quads between both borders.
    fn plate() -> TriMesh {
        let n = 48_u32;
        let mut positions = Vec::new();
        for k in 0..n {
            let angle = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
            let (sin, cos) = angle.sin_cos();
            positions.push(Point3::new(4.0 * cos, 4.0 * sin, 0.0));
            let reach = (20.0 / cos.abs()).min(10.0 / sin.abs());
            positions.push(Point3::new(reach * cos, reach * sin, 0.0));
        }
        // The rays miss the corners of the plate; the nearest ones are moved there.
        for (x, y) in [(20.0, 10.0), (-20.0, 10.0), (-20.0, -10.0), (20.0, -10.0)] {
            let corner = Point3::new(x, y, 0.0);
            let far = |i: &usize| (positions[*i] - corner).norm();
            let border = (0..positions.len()).filter(|i| i % 2 == 1);
            let nearest = border.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
            positions[nearest] = corner;
        }
        let cell = |k: u32| {
            let next = (k + 1) % n;
            let (a, b, c, d) = (2 * k, 2 * k + 1, 2 * next + 1, 2 * next);
            [[a, b, c], [a, c, d]]
        };
        TriMesh::new(positions, (0..n).flat_map(cell).collect()).unwrap()
    }

    #[test]
    fn holes_and_corners_are_found() {
        let plate = plate();
        let normals = vec![Vector3::z(); plate.n_vertices()];
        let edges = BorderEdges::of(&plate, &Topology::of(&plate));
        let borders = Border::all(&plate, &edges, &normals);
        let found = Landmarks::of(&plate, borders.iter());
        assert_eq!(found.holes.len(), 1);
        assert!(found.holes[0].center.coords.norm() < 1e-9);
        assert!((found.holes[0].radius - 4.0).abs() < 1e-9);
        assert_eq!(found.corners.len(), 4);
        let is_corner =
            |p: &Point3| (p.x.abs() - 20.0).abs() < 1e-9 && (p.y.abs() - 10.0).abs() < 1e-9;
        assert!(found.corners.iter().all(is_corner));
    }
}
