//! Joins vertices at equal positions.

use rayon::prelude::*;

use super::chunks::{for_chunks, map_chunks};
use super::{Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// A mesh whose coincident vertices were joined, with the way back.
#[derive(Debug, Clone, Default)]
pub struct Welded {
    /// The joined mesh: every vertex is used. Triangles keep their order; those that lost their area
    /// by joining are gone.
    pub mesh: TriMesh,
    /// For every vertex of the input, its vertex in `mesh`; [`u32::MAX`] where no triangle of `mesh`
    /// uses it.
    pub vertex_of: Vec<u32>,
    /// For every triangle of `mesh`, its index in the input.
    pub triangle_of: Vec<u32>,
}

/// Number that stands for no vertex.
const NONE: u32 = u32::MAX;
/// Pieces that the search for equal positions is cut into, by the last bits of the hash, so that
/// the table of each stays in the processor's cache and threads can share the work.
const SHARDS: u64 = 16;
/// Below so many vertices one piece is quicker.
const ONE_SHARD: usize = 50_000;

/// Joins vertices at equal positions and drops unused vertices and triangles that name a vertex
/// twice. A vertex joins the first one at its place, so vertices and triangles keep their order.
/// O(vertices + triangles); a mesh with nothing to join is handed on without a copy.
pub fn weld(mesh: TriMesh, monitor: &Monitor) -> Result<Welded, Cancelled> {
    let first = first_at_place(mesh.positions(), mesh.triangles(), monitor)?;
    let mut is_used = vec![false; mesh.n_vertices()];
    let mut triangle_of = Vec::with_capacity(mesh.n_triangles());
    for_chunks(mesh.n_triangles(), monitor, |range| {
        for t in range {
            let [a, b, c] = mesh.triangles()[t].map(|v| first[v as usize]);
            if a != b && b != c && c != a {
                triangle_of.push(t as u32);
                for vertex in [a, b, c] {
                    is_used[vertex as usize] = true;
                }
            }
        }
    })?;
    if triangle_of.len() == mesh.n_triangles() && !is_used.contains(&false) {
        // Every vertex is the first at its place.
        return Ok(Welded {
            mesh,
            vertex_of: first,
            triangle_of,
        });
    }
    let mut number = vec![NONE; mesh.n_vertices()];
    let mut positions = Vec::new();
    let mut vertex_of = first;
    for_chunks(vertex_of.len(), monitor, |range| {
        for vertex in range {
            let first = vertex_of[vertex];
            if first as usize == vertex && is_used[vertex] {
                number[vertex] = positions.len() as u32;
                positions.push(mesh.positions()[vertex]);
            }
            // The first at a place comes first, so it has its number by now.
            vertex_of[vertex] = number.get(first as usize).copied().unwrap_or(NONE);
        }
    })?;
    let kept = triangle_of.iter().map(|&t| mesh.triangles()[t as usize]);
    let triangles = kept.map(|corners| corners.map(|v| vertex_of[v as usize]));
    let mesh = TriMesh::new(positions, triangles.collect()).expect("all indices were given above");
    Ok(Welded {
        mesh,
        vertex_of,
        triangle_of,
    })
}

/// For every vertex the first one that a cell (a triangle, say) names and that lies at the same place;
/// [`u32::MAX`] for vertices that no cell names. O(vertices + cells).
pub fn first_at_place<const N: usize>(
    positions: &[Point3],
    cells: &[[u32; N]],
    monitor: &Monitor,
) -> Result<Vec<u32>, Cancelled> {
    let mut first = vec![NONE; positions.len()];
    for_chunks(cells.len(), monitor, |range| {
        for &vertex in cells[range].iter().flatten() {
            first[vertex as usize] = vertex;
        }
    })?;
    let hashes = map_chunks(positions.len(), monitor, |v| place_hash(&positions[v]))?;
    let n_shards = if positions.len() < ONE_SHARD {
        1
    } else {
        SHARDS
    };
    let joined: Vec<Vec<[u32; 2]>> = (0..n_shards)
        .into_par_iter()
        .map(|shard| {
            monitor.check()?;
            let named = (0..positions.len()).filter(|&v| first[v] != NONE);
            let of_shard = named.filter(|&v| hashes[v] % n_shards == shard);
            Ok(repeated_places(positions, &hashes, of_shard))
        })
        .collect::<Result<_, Cancelled>>()?;
    for [vertex, earlier] in joined.into_iter().flatten() {
        first[vertex as usize] = earlier;
    }
    Ok(first)
}

/// Of ascending vertices those at the place of an earlier one, each with the first of these.
fn repeated_places(
    positions: &[Point3],
    hashes: &[u64],
    vertices: impl Iterator<Item = usize> + Clone,
) -> Vec<[u32; 2]> {
    let n_slots = (2 * vertices.clone().count()).next_power_of_two();
    let mut table = vec![NONE; n_slots];
    let mut repeated = Vec::new();
    for vertex in vertices {
        // The table is half empty, so the walk ends.
        let mut slot = (hashes[vertex] >> 32) as usize & (n_slots - 1);
        loop {
            let known = table[slot];
            if known == NONE {
                table[slot] = vertex as u32;
                break;
            }
            if positions[known as usize] == positions[vertex] {
                repeated.push([vertex as u32, known]);
                break;
            }
            slot = (slot + 1) & (n_slots - 1);
        }
    }
    repeated
}

/// Mixes the three numbers of a position; 0.0 and −0.0 are one place.
fn place_hash(position: &Point3) -> u64 {
    position.iter().fold(0, |hash: u64, x| {
        let mixed =
            (hash.rotate_left(23) ^ (x + 0.0).to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point3 {
        Point3::new(x, y, 0.0)
    }

    fn welded(positions: Vec<Point3>, triangles: Vec<[u32; 3]>) -> Welded {
        weld(
            TriMesh::new(positions, triangles).unwrap(),
            &Monitor::silent(),
        )
        .unwrap()
    }

    #[test]
    fn joins_equal_positions_only_and_keeps_the_way_back() {
        let positions = vec![
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(1.0, -0.0),
            p(1.0, 1.0),
            p(9.0, 9.0),
            p(1.0 + 1e-12, 0.0),
        ];
        let triangles = vec![[0, 1, 2], [3, 4, 2], [1, 3, 2], [6, 4, 2]];
        let found = welded(positions, triangles);
        assert_eq!((found.mesh.n_vertices(), found.mesh.n_triangles()), (5, 3));
        assert_eq!(found.vertex_of, vec![0, 1, 2, 1, 3, NONE, 4]);
        assert_eq!(found.triangle_of, vec![0, 1, 3]);
    }

    #[test]
    fn vertices_of_lost_triangles_go_with_them() {
        let positions = vec![
            p(5.0, 5.0),
            p(5.0, 5.0),
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
        ];
        let found = welded(positions, vec![[0, 1, 2], [2, 3, 4]]);
        assert_eq!(
            found.mesh.positions(),
            [p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)]
        );
        assert_eq!(found.mesh.triangles(), [[0, 1, 2]]);
        assert_eq!(found.vertex_of, [NONE, NONE, 0, 1, 2]);
    }

    #[test]
    fn nothing_to_join_changes_nothing() {
        let (positions, triangles) = (vec![p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)], vec![[2, 0, 1]]);
        let found = welded(positions.clone(), triangles.clone());
        assert_eq!(found.mesh, TriMesh::new(positions, triangles).unwrap());
        assert_eq!(
            (found.vertex_of, found.triangle_of),
            (vec![0, 1, 2], vec![0])
        );
    }

    /// A grid in which each triangle has its own three vertices, as STL files have them, against a
    /// plain map; large enough for several shards.
    #[test]
    fn a_triangle_soup_joins_as_a_plain_map_does() {
        let n = 100;
        let cell = |i: usize| (f64::from((i % n) as u32), f64::from((i / n) as u32));
        let positions: Vec<Point3> = (0..n * n)
            .flat_map(|i| {
                let (x, y) = cell(i);
                let (a, b, c, d) = (p(x, y), p(x + 1.0, y), p(x + 1.0, y + 1.0), p(x, y + 1.0));
                [a, b, c, a, c, d]
            })
            .collect();
        let corners = 0..positions.len() as u32 / 3;
        let triangles = corners.map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        assert!(positions.len() > ONE_SHARD);
        let mut seen = std::collections::HashMap::new();
        let mut expected = Vec::new();
        for position in &positions {
            let next = seen.len() as u32;
            let key = position.coords.map(f64::to_bits);
            expected.push(*seen.entry(key).or_insert(next));
        }
        let found = welded(positions, triangles);
        assert_eq!(found.vertex_of, expected);
        assert_eq!(found.mesh.n_vertices(), (n + 1) * (n + 1));
    }

    #[test]
    fn a_cancel_request_ends_it() {
        let monitor = Monitor::silent();
        monitor.request_cancel();
        let mesh = TriMesh::new(vec![p(0.0, 0.0); 3], vec![[0, 1, 2]]).unwrap();
        assert!(weld(mesh, &monitor).is_err());
    }
}
