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
    let sorted: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .map(|corners| {
            let mut sorted = *corners;
            sorted.sort_unstable();
            sorted
        })
        .collect();
    // Triangles with the same smallest vertex, chained from the latest to the earliest.
    let mut last_of = vec![u32::MAX; mesh.n_vertices()];
    let mut earlier = vec![u32::MAX; sorted.len()];
    let mut kept = Vec::with_capacity(sorted.len());
    for (t, corners) in sorted.iter().enumerate() {
        let head = &mut last_of[corners[0] as usize];
        let mut other = *head;
        while other != u32::MAX && sorted[other as usize] != *corners {
            other = earlier[other as usize];
        }
        if other == u32::MAX && corners[0] != corners[1] && corners[1] != corners[2] {
            kept.push(t as u32);
            earlier[t] = *head;
            *head = t as u32;
        }
    }
    kept
}

fn add_face_quadrics(intake: &mut Intake, settings: &SimplifySettings) {
    for t in 0..intake.fans.triangles.len() {
        let quadric = Quadric::triangle(&intake.fans.corners(t as u32), settings.stiffness);
        for v in intake.fans.triangles[t] {
            intake.quadrics[v as usize].add(&quadric);
        }
    }
}

/// Finds edges and features, gives feature vertices their kind and their constraint.
fn add_features(intake: &mut Intake, settings: &SimplifySettings) {
    let fans = &intake.fans;
    let mut degree = vec![0_u32; intake.kinds.len()];
    for_each_edge(fans, |[u, v], around| {
        intake.edges.push([u, v]);
        let smooth = match around {
            [x, y] => {
                let part = |side: &Side| intake.part_of.get(side.triangle as usize);
                x.forward != y.forward && part(x) == part(y)
            }
            _ => false,
        };
        if smooth {
            return;
        }
        degree[u as usize] += 1;
        degree[v as usize] += 1;
        let along = fans.positions[v as usize] - fans.positions[u as usize];
        let quadric = Quadric::line(&along, settings.boundary_weight);
        intake.quadrics[u as usize].add(&quadric);
        intake.quadrics[v as usize].add(&quadric);
    });
    for (kind, degree) in intake.kinds.iter_mut().zip(degree) {
        *kind = match degree {
            0 => Kind::Free,
            2 => Kind::Line,
            _ => Kind::Corner,
        };
    }
}

/// One triangle at an edge, as seen from the edge's smaller vertex.
#[derive(Debug, Clone, Copy)]
struct Side {
    other: u32,
    triangle: u32,
    /// The triangle runs from the smaller to the larger vertex.
    forward: bool,
}

/// Calls `visit` with the ends and sides of every edge, in the order of the ends.
fn for_each_edge(fans: &Fans, mut visit: impl FnMut([u32; 2], &[Side])) {
    let mut sides: Vec<Side> = Vec::new();
    for u in 0..fans.positions.len() as u32 {
        sides.clear();
        for &triangle in fans.around(u) {
            let [a, b, c] = fans.triangles[triangle as usize];
            let (next, last) = if a == u {
                (b, c)
            } else if b == u {
                (c, a)
            } else {
                (a, b)
            };
            for (other, forward) in [(next, true), (last, false)] {
                if other > u {
                    sides.push(Side {
                        other,
                        triangle,
                        forward,
                    });
                }
            }
        }
        sides.sort_unstable_by_key(|side| (side.other, side.triangle));
        for around in sides.chunk_by(|x, y| x.other == y.other) {
            visit([u, around[0].other], around);
        }
    }
}
