//! The mesh while it shrinks: vertices, faces, edges, and the fan of faces around each vertex.

use std::hint::select_unpredictable;

use nalgebra::Vector3;

use super::legality::Ring;
use super::quadric::{Quadric, pull_of};
use crate::geometry::chunks::for_chunks;
use crate::monitor::{Cancelled, Monitor};

/// Stands for no vertex, no edge and no face.
const GONE: u32 = u32::MAX;

/// Where a vertex lies with respect to features: borders, seams between parts, and edges with
/// three or more triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) enum Kind {
    /// Inside the surface.
    #[default]
    Free,
    /// On exactly two feature edges: slides along them.
    Line,
    /// On another number of feature edges: stays where it is.
    Corner,
    /// Has triangles that are not here: must not change at all.
    Frozen,
}

impl Kind {
    /// The kind of a vertex on so many feature edges.
    pub(super) fn on(n_feature_edges: usize) -> Self {
        match n_feature_edges {
            0 => Self::Free,
            2 => Self::Line,
            _ => Self::Corner,
        }
    }
}

/// What is read together when an edge is priced, together in memory.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Vertex {
    pub(super) position: Vector3<f64>,
    pub(super) quadric: Quadric,
    pub(super) kind: Kind,
}

/// A triangle, in one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct Face {
    /// Its vertices; [`GONE`] three times once it is collapsed.
    pub(super) corners: [u32; 3],
    /// For each corner the edge opposite to it.
    pub(super) edges: [u32; 3],
    /// Its unit normal times the square root of its area, see [`pull_of`].
    pub(super) pull: Vector3<f64>,
}

impl Face {
    /// Which of the corners `vertex` is. One that is none of them counts as the first.
    pub(super) fn index_of(&self, vertex: u32) -> usize {
        usize::from(self.corners[1] == vertex) + 2 * usize::from(self.corners[2] == vertex)
    }

    /// The other two corners, in the face's direction of travel from `vertex`.
    pub(super) fn others(&self, vertex: u32) -> [u32; 2] {
        let [a, b, c] = self.corners;
        // Which corner it is cannot be foreseen: choices cost less than branches.
        let (is_second, is_third) = (b == vertex, c == vertex);
        let next = select_unpredictable(is_third, a, b);
        let last = select_unpredictable(is_third, b, c);
        [
            select_unpredictable(is_second, c, next),
            select_unpredictable(is_second, a, last),
        ]
    }
}

/// An edge. Edges that become one by a collapse keep one number; the other one is dead.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    /// Its vertices, or vertices that were merged into them. Twice the same if it is dead.
    pub(super) ends: [u32; 2],
    /// The price under which it waits in the queue.
    pub(super) key: u32,
    /// A border edge, a seam, or an edge with three or more triangles.
    pub(super) is_feature: bool,
}

/// A face at an edge, and whether it travels along it from the smaller end to the larger.
#[derive(Debug, Clone, Copy)]
struct Side {
    face: u32,
    is_forward: bool,
}

#[derive(Debug, Clone, Copy, Default)]
struct Fan {
    start: u32,
    len: u32,
    capacity: u32,
}

/// A triangle mesh, kept up to date under collapses.
///
/// Fans lie in one pool. A merged fan that outgrows its place moves to the end of the pool, which
/// in all adds a few entries per collapse; nothing is ever freed.
#[derive(Debug, Clone, Default)]
pub(super) struct CollapsingMesh {
    pub(super) vertices: Vec<Vertex>,
    pub(super) faces: Vec<Face>,
    pub(super) edges: Vec<Edge>,
    /// Part of each face; empty if there is only one.
    pub(super) part_of: Vec<u32>,
    /// Faces that are left.
    pub(super) n_triangles: usize,
    fans: Vec<Fan>,
    pool: Vec<u32>,
    merged_into: Vec<u32>,
    /// Edges that become one in the collapse at hand: the one to stay, the one to go, and the
    /// vertex they lead to.
    merging: Vec<(u32, u32, u32)>,
}

impl CollapsingMesh {
    /// Counting sort of the triangles by vertex, and the edges between them. The triangles must
    /// differ from each other and each have three vertices. O(vertices + triangles).
    pub(super) fn new(
        positions: &[Vector3<f64>],
        triangles: &[[u32; 3]],
        part_of: Vec<u32>,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut fans = vec![Fan::default(); positions.len()];
        for_chunks(triangles.len(), monitor, |range| {
            for &vertex in triangles[range].iter().flatten() {
                fans[vertex as usize].capacity += 1;
            }
        })?;
        let mut start = 0;
        for fan in &mut fans {
            fan.start = start;
            start += fan.capacity;
        }
        let mut pool = vec![0; start as usize];
        let mut faces = Vec::with_capacity(triangles.len());
        for_chunks(triangles.len(), monitor, |range| {
            for t in range {
                let corners = triangles[t];
                for vertex in corners {
                    let fan = &mut fans[vertex as usize];
                    pool[(fan.start + fan.len) as usize] = t as u32;
                    fan.len += 1;
                }
                faces.push(Face {
                    corners,
                    edges: [GONE; 3],
                    pull: pull_of(&twice_area(&corners.map(|v| positions[v as usize]))),
                });
            }
        })?;
        let mut vertices = Vec::with_capacity(positions.len());
        for_chunks(positions.len(), monitor, |range| {
            vertices.extend(positions[range].iter().map(|&position| Vertex {
                position,
                ..Vertex::default()
            }));
        })?;
        let mut surface = Self {
            vertices,
            faces,
            edges: Vec::with_capacity(3 * positions.len()),
            part_of,
            n_triangles: triangles.len(),
            fans,
            pool,
            merged_into: (0..positions.len() as u32).collect(),
            merging: Vec::new(),
        };
        surface.number_edges(monitor)?;
        Ok(surface)
    }

    /// Numbers the edges by their smaller end, then as the fan comes, and finds the features.
    fn number_edges(&mut self, monitor: &Monitor) -> Result<(), Cancelled> {
        // The latest edge to each vertex from a smaller one.
        let mut latest = vec![GONE; self.vertices.len()];
        // For each edge from the vertex at hand its sides: how many, and the first two.
        let mut sides: Vec<(u32, [Side; 2])> = Vec::new();
        for_chunks(self.vertices.len(), monitor, |range| {
            for near in range {
                self.number_edges_of(near as u32, &mut latest, &mut sides);
            }
        })
    }

    /// Numbers the edges from a vertex to those after it.
    fn number_edges_of(
        &mut self,
        near: u32,
        latest: &mut [u32],
        sides: &mut Vec<(u32, [Side; 2])>,
    ) {
        sides.clear();
        let n_before = self.edges.len() as u32;
        let fan = self.fans[near as usize];
        for slot in fan.start..fan.start + fan.len {
            let face = self.pool[slot as usize];
            let corners = &mut self.faces[face as usize];
            let i = corners.index_of(near);
            let [next, last] = corners.others(near);
            for (far, opposite, is_forward) in
                [(next, (i + 2) % 3, true), (last, (i + 1) % 3, false)]
            {
                if far < near {
                    continue;
                }
                let side = Side { face, is_forward };
                let known = latest[far as usize];
                if known >= n_before && known != GONE {
                    corners.edges[opposite] = known;
                    let (n, both) = &mut sides[(known - n_before) as usize];
                    both[1] = side;
                    *n += 1;
                } else {
                    let id = self.edges.len() as u32;
                    latest[far as usize] = id;
                    corners.edges[opposite] = id;
                    sides.push((1, [side; 2]));
                    self.edges.push(Edge {
                        ends: [near, far],
                        key: 0,
                        is_feature: true,
                    });
                }
            }
        }
        for (&(n, [s, t]), edge) in sides.iter().zip(n_before..) {
            let is_smooth =
                n == 2 && s.is_forward != t.is_forward && self.part(s.face) == self.part(t.face);
            self.edges[edge as usize].is_feature = !is_smooth;
        }
    }

    fn part(&self, triangle: u32) -> Option<u32> {
        self.part_of.get(triangle as usize).copied()
    }

    /// Where a vertex is.
    pub(super) fn position(&self, vertex: u32) -> Vector3<f64> {
        self.vertices[vertex as usize].position
    }

    /// Where a vertex lies with respect to features.
    pub(super) fn kind(&self, vertex: u32) -> Kind {
        self.vertices[vertex as usize].kind
    }

    /// Triangles around a vertex, in no particular but a reproducible order.
    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        let fan = self.fans[vertex as usize];
        &self.pool[fan.start as usize..(fan.start + fan.len) as usize]
    }

    /// Faces around a vertex, with their numbers.
    pub(super) fn faces_around(&self, vertex: u32) -> impl Iterator<Item = (u32, &Face)> + '_ {
        let around = self.around(vertex).iter();
        around.map(|&t| (t, &self.faces[t as usize]))
    }

    /// The faces that are left, each with its corners.
    pub(super) fn left(&self) -> impl Iterator<Item = (usize, [u32; 3])> + '_ {
        let corners = self.faces.iter().map(|face| face.corners).enumerate();
        corners.filter(|(_, corners)| corners[0] != GONE)
    }

    /// The faces that share the edge, each with the vertex opposite to it.
    pub(super) fn sides(&self, a: u32, b: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.faces_around(a).filter_map(move |(t, face)| {
            let [next, last] = face.others(a);
            (next == b || last == b).then_some((t, next ^ last ^ b))
        })
    }

    /// The two edges of each face around a vertex that meet there, with their far ends.
    pub(super) fn spokes(&self, vertex: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.faces_around(vertex).flat_map(move |(_, face)| {
            let i = face.index_of(vertex);
            let [next, last] = face.others(vertex);
            [
                (face.edges[(i + 2) % 3], next),
                (face.edges[(i + 1) % 3], last),
            ]
        })
    }

    /// The vertex that `vertex` was merged into, itself if none.
    pub(super) fn root(&mut self, mut vertex: u32) -> u32 {
        while self.merged_into[vertex as usize] != vertex {
            let above = self.merged_into[self.merged_into[vertex as usize] as usize];
            self.merged_into[vertex as usize] = above;
            vertex = above;
        }
        vertex
    }

    /// The ends of an edge as they are now, the smaller first; the same twice if it is dead.
    pub(super) fn ends_now(&mut self, edge: u32) -> [u32; 2] {
        let [a, b] = self.edges[edge as usize].ends;
        let (a, b) = (self.root(a), self.root(b));
        [a.min(b), a.max(b)]
    }

    /// Merges `removed` into `kept`, which moves to `position`. Faces with both are gone. `ring` is
    /// that of the edge from `kept` to `removed`, as the link condition fills it.
    /// The pulls of the faces that stay are for the caller to renew.
    pub(super) fn collapse(
        &mut self,
        ring: &Ring,
        [kept, removed]: [u32; 2],
        position: Vector3<f64>,
    ) {
        self.vertices[kept as usize].position = position;
        self.merged_into[removed as usize] = kept;
        self.fans[removed as usize] = Fan::default();
        self.merging.clear();
        for &(t, third) in ring.gone() {
            let face = &mut self.faces[t as usize];
            let stays = face.edges[face.index_of(removed)];
            let goes = face.edges[face.index_of(kept)];
            face.corners = [GONE; 3];
            self.merging.push((stays, goes, third));
            self.forget(third, t);
        }
        self.n_triangles -= ring.gone().len();
        for staying in ring.stay_at_second() {
            let face = &mut self.faces[staying.face as usize];
            let i = face.index_of(removed);
            face.corners[i] = kept;
            for &(stays, goes, _) in &self.merging {
                for edge in &mut face.edges {
                    *edge = select_unpredictable(*edge == goes, stays, *edge);
                }
            }
        }
        self.make_room(kept, ring.stay().len() as u32);
        let fan = &self.fans[kept as usize];
        let slots = &mut self.pool[fan.start as usize..(fan.start + fan.len) as usize];
        for (slot, staying) in slots.iter_mut().zip(ring.stay()) {
            *slot = staying.face;
        }
        for i in 0..self.merging.len() {
            let (stays, goes, third) = self.merging[i];
            self.end_merge(stays, goes, [kept, third]);
        }
    }

    /// Gives one number to two edges that now have the same ends.
    pub(super) fn merge_edges(&mut self, stays: u32, goes: u32, ends: [u32; 2]) {
        for slot in 0..self.around(ends[0]).len() {
            let t = self.around(ends[0])[slot];
            for edge in &mut self.faces[t as usize].edges {
                if *edge == goes {
                    *edge = stays;
                }
            }
        }
        self.end_merge(stays, goes, ends);
    }

    fn end_merge(&mut self, stays: u32, goes: u32, ends: [u32; 2]) {
        let both = self.edges[stays as usize].is_feature && self.edges[goes as usize].is_feature;
        self.edges[stays as usize].is_feature |= self.edges[goes as usize].is_feature;
        self.edges[goes as usize].ends = [0; 2];
        if both {
            // The only case in which the features of the two may have cancelled.
            self.edges[stays as usize].is_feature = self.is_feature_by_sides(ends);
            if self.sides(ends[0], ends[1]).next().is_none() {
                self.edges[stays as usize].ends = [0; 2];
            }
        }
    }

    fn is_feature_by_sides(&self, [a, b]: [u32; 2]) -> bool {
        let mut sides = self.sides(a, b);
        let (Some((s, _)), Some((t, _)), None) = (sides.next(), sides.next(), sides.next()) else {
            return true;
        };
        let forward = |t: u32| self.faces[t as usize].others(a)[0] == b;
        self.part(s) != self.part(t) || forward(s) == forward(t)
    }

    /// Gives a vertex a fan of so many faces, whose numbers are for the caller to set.
    fn make_room(&mut self, vertex: u32, len: u32) {
        let fan = &mut self.fans[vertex as usize];
        fan.len = len;
        if len > fan.capacity {
            fan.start = self.pool.len() as u32;
            fan.capacity = len;
            self.pool.resize((fan.start + len) as usize, GONE);
        }
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

/// The normal of a triangle, as long as twice its area.
fn twice_area([a, b, c]: &[Vector3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::super::legality::link_condition;
    use super::*;

    fn hexagon() -> CollapsingMesh {
        let positions = vec![Vector3::zeros(); 7];
        let triangles: Vec<_> = (1..7).map(|i| [0, i, i % 6 + 1]).collect();
        CollapsingMesh::new(&positions, &triangles, Vec::new(), &Monitor::silent()).unwrap()
    }

    fn collapse(surface: &mut CollapsingMesh, kept: u32, removed: u32) {
        let mut ring = Ring::new(surface.vertices.len());
        assert!(link_condition(surface, &mut ring, kept, removed, false));
        surface.collapse(&ring, [kept, removed], Vector3::x());
    }

    #[test]
    fn a_collapse_keeps_fans_and_triangles_in_step() {
        let mut surface = hexagon();
        collapse(&mut surface, 0, 1);
        assert_eq!(surface.n_triangles, 4);
        assert_eq!(surface.around(0).len(), 4);
        assert_eq!(surface.around(1).len(), 0);
        for v in 0..7 {
            for (_, face) in surface.faces_around(v) {
                assert!(face.corners.contains(&v));
            }
        }
        assert_eq!((surface.around(2).len(), surface.around(6).len()), (1, 1));
        assert_eq!(surface.sides(0, 3).count(), 2);
        assert_eq!(surface.root(1), 0);
    }

    #[test]
    fn edges_that_become_one_share_a_number_and_stay_features() {
        let mut surface = hexagon();
        assert_eq!(surface.edges.len(), 12);
        assert_eq!(surface.edges.iter().filter(|e| e.is_feature).count(), 6);
        collapse(&mut surface, 0, 1);
        for t in 0..6 {
            let face = surface.faces[t];
            for i in 0..if face.corners[0] == GONE { 0 } else { 3 } {
                let mut ends = [face.corners[(i + 1) % 3], face.corners[(i + 2) % 3]];
                ends.sort_unstable();
                assert_eq!(surface.ends_now(face.edges[i]), ends);
                let is_border = surface.sides(ends[0], ends[1]).count() == 1;
                assert_eq!(surface.edges[face.edges[i] as usize].is_feature, is_border);
            }
        }
        let alive = (0..12).filter(|&e| {
            let [a, b] = surface.ends_now(e);
            a != b
        });
        assert_eq!(alive.count(), 9);
    }
}
