use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::{Point3, TriMesh};

/// A mesh whose coincident vertices were joined, with the way back.
#[derive(Debug, Clone, Default)]
pub struct Welded {
    /// The joined mesh. Triangles keep their order; those that lost their area by joining are gone.
    pub mesh: TriMesh,
    /// For every vertex of the input, its vertex in `mesh`.
    pub vertex_of: Vec<u32>,
    /// For every triangle of `mesh`, its index in the input.
    pub triangle_of: Vec<u32>,
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// Mixes the three numbers of a grid cell; the standard hasher's guard against chosen keys is
/// not needed here and costs more than all the rest. Nothing depends on the order of the table.
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_ne_bytes(word));
        }
    }

    fn write_u64(&mut self, word: u64) {
        let mixed = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ mixed >> 29;
    }

    fn write_i64(&mut self, word: i64) {
        self.write_u64(word as u64);
    }
}

/// Joins vertices closer than `tolerance` (0 joins only equal positions) and drops unused vertices
/// and triangles that name a vertex twice.
///
/// Grid hashing: a vertex joins the first of all kept vertices within `tolerance`, so the result does not
/// depend on anything but the order of the input. O(vertices + triangles).
pub fn weld(mesh: &TriMesh, tolerance: f64) -> Welded {
    let mut used = vec![false; mesh.n_vertices()];
    for &vertex in mesh.triangles().iter().flatten() {
        used[vertex as usize] = true;
    }
    let cell = if tolerance > 0.0 {
        2.0 * tolerance
    } else {
        1.0
    };
    let key = |p: &Point3, offset: [i64; 3]| -> [i64; 3] {
        if tolerance > 0.0 {
            std::array::from_fn(|i| (p[i] / cell).floor() as i64 + offset[i])
        } else {
            // Adding zero makes −0.0 and 0.0 the same key.
            std::array::from_fn(|i| (p[i] + 0.0).to_bits() as i64)
        }
    };
    // Each cell names its latest vertex, and each vertex the one before it in its cell.
    let mut latest: HashMap<[i64; 3], u32, BuildHasherDefault<CellHasher>> =
        HashMap::with_capacity_and_hasher(mesh.n_vertices(), BuildHasherDefault::default());
    let mut previous: Vec<u32> = Vec::with_capacity(mesh.n_vertices());
    let mut positions: Vec<Point3> = Vec::with_capacity(mesh.n_vertices());
    let mut vertex_of = vec![u32::MAX; mesh.n_vertices()];
    for (vertex, point) in mesh.positions().iter().enumerate() {
        if !used[vertex] {
            continue;
        }
        let mut first = NONE;
        for offset in neighbours(point, cell, tolerance) {
            let mut at = latest.get(&key(point, offset)).copied().unwrap_or(NONE);
            while at != NONE {
                if (positions[at as usize] - point).norm() <= tolerance {
                    first = first.min(at);
                }
                at = previous[at as usize];
            }
        }
        if first == NONE {
            first = positions.len() as u32;
            positions.push(*point);
            let before = latest.insert(key(point, [0; 3]), first);
            previous.push(before.unwrap_or(NONE));
        }
        vertex_of[vertex] = first;
    }
    let mut triangles = Vec::with_capacity(mesh.n_triangles());
    let mut triangle_of = Vec::with_capacity(mesh.n_triangles());
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = corners.map(|v| vertex_of[v as usize]);
        if a != b && b != c && c != a {
            triangles.push([a, b, c]);
            triangle_of.push(t as u32);
        }
    }
    let mesh = TriMesh::new(positions, triangles).expect("indices come from the table above");
    Welded {
        mesh,
        vertex_of,
        triangle_of,
    }
}

/// Offsets of the cells that can hold a point within `tolerance`: the own cell and, per axis, the
/// nearer neighbour if it is within reach. Cells are two tolerances wide, so one side suffices.
fn neighbours(point: &Point3, cell: f64, tolerance: f64) -> impl Iterator<Item = [i64; 3]> {
    let step: [i64; 3] = std::array::from_fn(|i| {
        if tolerance == 0.0 {
            return 0;
        }
        let inside = point[i] / cell - (point[i] / cell).floor();
        if inside < 0.5 { -1 } else { 1 }
    });
    let n = if tolerance == 0.0 { 1 } else { 8 };
    (0..n).map(move |i| std::array::from_fn(|axis| if i >> axis & 1 == 1 { step[axis] } else { 0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_within_tolerance_only_and_keeps_the_way_back() {
        let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
        let positions = vec![
            p(0.0, 0.0),
            p(1.0, 0.0),
            p(0.0, 1.0),
            p(1.0 + 1e-7, 0.0),
            p(1.0, 1.0),
            p(9.0, 9.0),
        ];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 2], [1, 3, 2]]).unwrap();
        let exact = weld(&mesh, 0.0);
        assert_eq!((exact.mesh.n_vertices(), exact.mesh.n_triangles()), (5, 3));
        let near = weld(&mesh, 1e-6);
        assert_eq!((near.mesh.n_vertices(), near.mesh.n_triangles()), (4, 2));
        assert_eq!(near.vertex_of, vec![0, 1, 2, 1, 3, u32::MAX]);
        assert_eq!(near.triangle_of, vec![0, 1]);
    }

    #[test]
    fn joins_across_cell_borders() {
        for shift in [0.0, 0.49, 0.5, 0.99, 1.0, -3.0] {
            let a = Point3::new(shift, shift, shift);
            let b = a + nalgebra::Vector3::new(0.3, -0.3, 0.3);
            let far = Point3::new(50.0, 0.0, 0.0);
            let far2 = Point3::new(50.0, 50.0, 0.0);
            let mesh = TriMesh::new(vec![a, b, far, far2], vec![[0, 2, 3], [1, 2, 3]]).unwrap();
            assert_eq!(weld(&mesh, 0.6).mesh.n_vertices(), 3, "shift {shift}");
        }
    }
}
