//! From a mesh as it comes to the state a collapse starts from.

use nalgebra::Vector3;

use super::fans::Fans;
use super::legality::Kind;
use super::quadric::Quadric;
use super::settings::SimplifySettings;
use crate::geometry::{Point3, TriMesh};

/// Centre and size of a mesh. All work is done with coordinates less the centre, divided by the
/// diagonal, so that neither the unit nor the place of the part matters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    center: Point3,
    diagonal: f64,
}

impl Frame {
    fn of(mesh: &TriMesh) -> Self {
        let aabb = mesh.aabb();
        let diagonal = aabb.diagonal();
        Self {
            center: aabb.center(),
            diagonal: if diagonal > 0.0 { diagonal } else { 1.0 },
        }
    }

    pub(super) fn to_unit(self, point: &Point3) -> Vector3<f64> {
        (point - self.center) / self.diagonal
    }

    pub(super) fn restore(self, position: &Vector3<f64>) -> Point3 {
        self.center + position * self.diagonal
    }

    /// Diagonal of the mesh, the unit of length inside.
    pub(super) fn diagonal(self) -> f64 {
        self.diagonal
    }
}

/// Everything a decimation starts from.
#[derive(Debug, Clone)]
pub(super) struct Intake {
    pub(super) frame: Frame,
    pub(super) fans: Fans,
    /// For each triangle in `fans`, its index in the mesh that came in.
    pub(super) triangle_of: Vec<u32>,
    /// Part of each triangle; empty if there is only one.
    pub(super) part_of: Vec<u32>,
    pub(super) kinds: Vec<Kind>,
    pub(super) quadrics: Vec<Quadric>,
    /// Edges, smaller vertex first, sorted.
    pub(super) edges: Vec<[u32; 2]>,
}

/// Takes a mesh in. O(triangles · log triangles).
pub(super) fn take_in(mesh: &TriMesh, parts: &[u32], settings: &SimplifySettings) -> Intake {
    let frame = Frame::of(mesh);
    let positions: Vec<_> = mesh.positions().iter().map(|p| frame.to_unit(p)).collect();
    let triangle_of = distinct_triangles(mesh);
    let triangles: Vec<_> = triangle_of
        .iter()
        .map(|&t| mesh.triangles()[t as usize])
        .collect();
    let part_of: Vec<u32> = if parts.is_empty() {
        Vec::new()
    } else {
        triangle_of.iter().map(|&t| parts[t as usize]).collect()
    };
    let mut intake = Intake {
        frame,
        kinds: vec![Kind::Free; positions.len()],
        quadrics: vec![Quadric::default(); positions.len()],
        fans: Fans::new(positions, triangles),
        triangle_of,
        part_of,
        edges: Vec::new(),
    };
    add_face_quadrics(&mut intake, settings);
    add_features(&mut intake, settings);
    intake
}

/// Indices of the triangles with three different vertices that no earlier triangle has as well.
fn distinct_triangles(mesh: &TriMesh) -> Vec<u32> {
    let mut keys: Vec<([u32; 3], u32)> = mesh
        .triangles()
        .iter()
        .zip(0..)
        .filter(|([a, b, c], _)| a != b && b != c && c != a)
        .map(|(corners, t)| {
            let mut sorted = *corners;
            sorted.sort_unstable();
            (sorted, t)
        })
        .collect();
    keys.sort_unstable();
    keys.dedup_by_key(|(corners, _)| *corners);
    let mut kept: Vec<u32> = keys.into_iter().map(|(_, t)| t).collect();
    kept.sort_unstable();
    kept
}

fn add_face_quadrics(intake: &mut Intake, settings: &SimplifySettings) {
    for t in 0..intake.fans.triangles.len() {
        let [a, b, c] = intake.fans.corners(t as u32);
        let twice_area = (b - a).cross(&(c - a));
        let area = 0.5 * twice_area.norm();
        if let Some(normal) = twice_area.try_normalize(0.0) {
            let mut quadric = Quadric::plane(&normal, area);
            quadric.add(&Quadric::point(area * settings.stiffness));
            for v in intake.fans.triangles[t] {
                intake.quadrics[v as usize].add(&quadric);
            }
        }
    }
}

/// Finds edges and features, gives feature vertices their kind and their constraint.
fn add_features(intake: &mut Intake, settings: &SimplifySettings) {
    let fans = &intake.fans;
    let mut sides: Vec<(u64, u32)> = Vec::with_capacity(3 * fans.triangles.len());
    for (t, &[a, b, c]) in fans.triangles.iter().enumerate() {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            let forward = u32::from(u < v);
            let key = u64::from(u.min(v)) << 32 | u64::from(u.max(v));
            sides.push((key, (t as u32) << 1 | forward));
        }
    }
    sides.sort_unstable();
    let mut degree = vec![0_u32; intake.kinds.len()];
    for around in sides.chunk_by(|x, y| x.0 == y.0) {
        let [u, v] = [(around[0].0 >> 32) as u32, around[0].0 as u32];
        intake.edges.push([u, v]);
        let smooth = match around {
            [x, y] => {
                let same_part = intake.part_of.is_empty()
                    || intake.part_of[(x.1 >> 1) as usize] == intake.part_of[(y.1 >> 1) as usize];
                same_part && (x.1 & 1) != (y.1 & 1)
            }
            _ => false,
        };
        if smooth {
            continue;
        }
        degree[u as usize] += 1;
        degree[v as usize] += 1;
        let along = fans.positions[v as usize] - fans.positions[u as usize];
        let weight = settings.boundary_weight * along.norm_squared();
        if let Some(direction) = along.try_normalize(0.0) {
            let quadric = Quadric::line(&direction, weight);
            intake.quadrics[u as usize].add(&quadric);
            intake.quadrics[v as usize].add(&quadric);
        }
    }
    for (kind, degree) in intake.kinds.iter_mut().zip(degree) {
        *kind = match degree {
            0 => Kind::Free,
            2 => Kind::Line,
            _ => Kind::Corner,
        };
    }
}
