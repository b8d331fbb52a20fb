//! The mesh while it shrinks: triangles, and for each vertex the triangles around it.

use nalgebra::Vector3;

/// Marks a triangle that was collapsed away.
pub(super) const GONE: u32 = u32::MAX;

#[derive(Debug, Clone, Copy, Default)]
struct Fan {
    start: u32,
    len: u32,
    capacity: u32,
}

/// Triangles with the fan of triangles around every vertex, kept up to date under collapses.
///
/// Fans lie in one pool. A merged fan that outgrows its place moves to the end of the pool, which
/// in all adds a few entries per collapse; nothing is ever freed.
#[derive(Debug, Clone, Default)]
pub(super) struct Fans {
    /// Vertex positions.
    pub(super) positions: Vec<Vector3<f64>>,
    /// Vertices of each triangle; [`GONE`] three times once it is collapsed.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangles that are left.
    pub(super) n_triangles: usize,
    fans: Vec<Fan>,
    pool: Vec<u32>,
}

impl Fans {
    /// Counting sort of the triangles by vertex. O(vertices + triangles).
    pub(super) fn new(positions: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Self {
        let mut fans = vec![Fan::default(); positions.len()];
        for &vertex in triangles.iter().flatten() {
            fans[vertex as usize].capacity += 1;
        }
        let mut start = 0;
        for fan in &mut fans {
            fan.start = start;
            start += fan.capacity;
        }
        let mut pool = vec![0; start as usize];
        for (t, corners) in triangles.iter().enumerate() {
            for &vertex in corners {
                let fan = &mut fans[vertex as usize];
                pool[(fan.start + fan.len) as usize] = t as u32;
                fan.len += 1;
            }
        }
        Self {
            n_triangles: triangles.len(),
            positions,
            triangles,
            fans,
            pool,
        }
    }

    /// Triangles around a vertex, in no particular but a reproducible order.
    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        let fan = self.fans[vertex as usize];
        &self.pool[fan.start as usize..(fan.start + fan.len) as usize]
    }

    /// Corners of a triangle as positions.
    pub(super) fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// The triangles that share the edge, each with the vertex opposite to it.
    pub(super) fn sides(&self, a: u32, b: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.around(a).iter().filter_map(move |&t| {
            let corners = self.triangles[t as usize];
            corners
                .contains(&b)
                .then(|| (t, corners[0] ^ corners[1] ^ corners[2] ^ a ^ b))
        })
    }

    /// Merges `removed` into `kept`, which moves to `position`. Triangles with both are gone.
    pub(super) fn collapse(&mut self, kept: u32, removed: u32, position: Vector3<f64>) {
        self.positions[kept as usize] = position;
        let from = std::mem::take(&mut self.fans[removed as usize]);
        let reserved = self.fans[kept as usize].len + from.len;
        self.make_room(kept, reserved);
        for slot in from.start..from.start + from.len {
            let t = self.pool[slot as usize];
            let corners = self.triangles[t as usize];
            if corners.contains(&kept) {
                self.forget(kept, t);
                self.forget(corners[0] ^ corners[1] ^ corners[2] ^ kept ^ removed, t);
                self.triangles[t as usize] = [GONE; 3];
                self.n_triangles -= 1;
            } else {
                self.triangles[t as usize] = corners.map(|v| if v == removed { kept } else { v });
                let fan = &mut self.fans[kept as usize];
                self.pool[(fan.start + fan.len) as usize] = t;
                fan.len += 1;
            }
        }
    }

    fn make_room(&mut self, vertex: u32, capacity: u32) {
        let fan = &mut self.fans[vertex as usize];
        if capacity <= fan.capacity {
            return;
        }
        let old = fan.start as usize..(fan.start + fan.len) as usize;
        fan.start = self.pool.len() as u32;
        fan.capacity = capacity;
        self.pool.extend_from_within(old);
        self.pool.resize((fan.start + capacity) as usize, GONE);
    }

    fn forget(&mut self, vertex: u32, triangle: u32) {
        let fan = &mut self.fans[vertex as usize];
        let slots = &mut self.pool[fan.start as usize..(fan.start + fan.len) as usize];
        if let Some(at) = slots.iter().position(|&t| t == triangle) {
            slots.swap(at, slots.len() - 1);
            fan.len -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_collapse_keeps_fans_and_triangles_in_step() {
        // A hexagon around vertex 0.
        let positions = vec![Vector3::zeros(); 7];
        let triangles = (1..7).map(|i| [0, i, i % 6 + 1]).collect();
        let mut fans = Fans::new(positions, triangles);
        fans.collapse(0, 1, Vector3::x());
        assert_eq!(fans.n_triangles, 4);
        assert_eq!(fans.around(0).len(), 4);
        assert_eq!(fans.around(1).len(), 0);
        for (v, fan) in (0..7).map(|v| (v, fans.around(v))) {
            for &t in fan {
                assert!(fans.triangles[t as usize].contains(&v));
            }
        }
        assert_eq!((fans.around(2).len(), fans.around(6).len()), (1, 1));
        assert_eq!(fans.sides(0, 3).count(), 2);
    }
}
