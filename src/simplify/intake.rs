//! From a mesh as it comes to the state a collapse starts from.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::quadric::Quadric;
use super::settings::SimplifySettings;
use super::surface::{CollapsingMesh, Kind};
use crate::geometry::chunks::{CHUNK, for_chunks, map_chunks};
use crate::geometry::{Aabb, Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// Centre and size of a mesh. All work is done with coordinates less the centre, divided by the
/// diagonal, so that neither the unit nor the place of the part matters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    center: Point3,
    diagonal: f64,
}

impl Frame {
    fn of(mesh: &TriMesh) -> Self {
        let pieces = mesh.triangles().par_chunks(CHUNK / 4);
        let boxes = pieces.map(|piece| {
            let corners = piece.iter().flatten();
            Aabb::of_points(corners.map(|&v| &mesh.positions()[v as usize]))
        });
        let aabb = boxes.reduce(Aabb::empty, |a, b| a.union(&b));
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
}

/// What is left of a mesh, in unit coordinates. Vertices keep their numbers.
#[derive(Debug, Clone)]
pub(super) struct UnitMesh {
    pub(super) positions: Vec<Vector3<f64>>,
    /// Triangles that differ from each other, each with three vertices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Part of each triangle; empty if there is only one.
    pub(super) part_of: Vec<u32>,
}

/// Everything a decimation starts from.
#[derive(Debug, Clone)]
pub(super) struct Intake {
    pub(super) frame: Frame,
    pub(super) mesh: UnitMesh,
    /// For each triangle of `mesh`, its triangle in the mesh that came in.
    pub(super) triangle_of: Vec<u32>,
}

/// Takes a mesh in. O(vertices + triangles).
pub(super) fn take_in(
    mesh: &TriMesh,
    parts: &[u32],
    monitor: &Monitor,
) -> Result<Intake, Cancelled> {
    let frame = Frame::of(mesh);
    let positions = map_chunks(mesh.n_vertices(), monitor, |v| {
        frame.to_unit(&mesh.positions()[v])
    })?;
    let triangle_of = distinct_triangles(mesh, monitor)?;
    let n = triangle_of.len();
    let triangles = map_chunks(n, monitor, |i| mesh.triangles()[triangle_of[i] as usize])?;
    let part_of = if parts.is_empty() {
        Vec::new()
    } else {
        map_chunks(n, monitor, |i| parts[triangle_of[i] as usize])?
    };
    Ok(Intake {
        frame,
        mesh: UnitMesh {
            positions,
            triangles,
            part_of,
        },
        triangle_of,
    })
}

/// Indices of the triangles with three different vertices that no earlier triangle has as well.
fn distinct_triangles(mesh: &TriMesh, monitor: &Monitor) -> Result<Vec<u32>, Cancelled> {
    let sorted = map_chunks(mesh.n_triangles(), monitor, |t| {
        let mut sorted = mesh.triangles()[t];
        sorted.sort_unstable();
        sorted
    })?;
    // Triangles whose vertices have the same hash, chained from the latest to the earliest: those with one vertex in
    // common may be all of the mesh.
    let n_chains = sorted.len().max(1);
    let mut last_of = vec![u32::MAX; n_chains];
    let mut earlier = vec![u32::MAX; sorted.len()];
    let mut kept = Vec::with_capacity(sorted.len());
    for_chunks(sorted.len(), monitor, |range| {
        for t in range {
            let corners = &sorted[t];
            let head = &mut last_of[chain_of(corners, n_chains)];
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
    })?;
    Ok(kept)
}

/// The chain of a triangle, given its vertices in rising order.
fn chain_of(corners: &[u32; 3], n_chains: usize) -> usize {
    // Fibonacci hashing: the upper half of the word is well mixed.
    let mix = |hash: u64, v: &u32| {
        (hash.rotate_left(32) ^ u64::from(*v)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    };
    (corners.iter().fold(0, mix) >> 32) as usize % n_chains
}

/// Gives every vertex its quadric and its kind.
pub(super) fn add_quadrics(
    surface: &mut CollapsingMesh,
    settings: &SimplifySettings,
    monitor: &Monitor,
) -> Result<(), Cancelled> {
    let CollapsingMesh {
        vertices,
        faces,
        edges,
        ..
    } = surface;
    for_chunks(faces.len(), monitor, |range| {
        for face in &faces[range] {
            let quadric = Quadric::triangle(&face.pull, settings.stiffness);
            for v in face.corners {
                vertices[v as usize].quadric.add(&quadric);
            }
        }
    })?;
    let mut n_features = vec![0; vertices.len()];
    for_chunks(edges.len(), monitor, |range| {
        for edge in edges[range].iter().filter(|edge| edge.is_feature) {
            let [u, v] = edge.ends.map(|v| v as usize);
            let along = vertices[v].position - vertices[u].position;
            let quadric = Quadric::line(&along, settings.boundary_weight);
            for end in [u, v] {
                vertices[end].quadric.add(&quadric);
                n_features[end] += 1;
            }
        }
    })?;
    for (vertex, n) in vertices.iter_mut().zip(n_features) {
        vertex.kind = Kind::on(n);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The longest chain of some triangles.
    fn longest(triangles: impl Iterator<Item = [u32; 3]>) -> usize {
        let mut triangles: Vec<[u32; 3]> = triangles.collect();
        triangles
            .iter_mut()
            .for_each(|corners| corners.sort_unstable());
        let mut n_in = vec![0; triangles.len()];
        for corners in &triangles {
            n_in[chain_of(corners, triangles.len())] += 1;
        }
        n_in.into_iter().max().unwrap()
    }

    #[test]
    fn chains_stay_short_about_one_vertex_and_on_a_grid() {
        let n = 100_000;
        // About the first vertex, about the last one, and two triangles for each square of a grid.
        let low = longest((0..n).map(|i| [0, i + 1, i + 2]));
        let high = longest((0..n).map(|i| [i, i + 1, n + 1]));
        let grid = longest((0..n).flat_map(|i| [[i, i + 1, i + 301], [i, i + 301, i + 300]]));
        assert!(low.max(high).max(grid) <= 30, "{low} {high} {grid}");
    }

    #[test]
    fn of_equal_triangles_the_first_is_kept() {
        let position = |i: u32| Point3::new(f64::from(i), f64::from(i * i), 0.0);
        let positions = (0..5).map(position).collect();
        let triangles = vec![
            [0, 1, 2],
            [2, 1, 3],
            [1, 2, 0],
            [3, 3, 4],
            [3, 2, 1],
            [2, 3, 4],
            [4, 2, 2],
        ];
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let kept = distinct_triangles(&mesh, &Monitor::silent()).unwrap();
        assert_eq!(kept, [0, 1, 5]);
    }
}
