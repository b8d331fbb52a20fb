//! The edges that bound a mesh, and the loops that they form.

use std::collections::HashMap;

use super::{Topology, TriMesh};

/// An edge with one triangle, in the direction of that triangle, which lies to the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BorderEdge {
    /// The vertices, first and second.
    pub ends: [u32; 2],
    /// Its triangle.
    pub triangle: u32,
}

/// One chain of border edges, vertex by vertex. A closed loop does not repeat its first vertex.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BorderLoop {
    /// Vertex indices in walking order, the surface to the left when seen along the normal.
    pub vertices: Vec<u32>,
    /// False where a non-manifold vertex ended the walk early.
    pub closed: bool,
}

/// All border edges of a mesh. They are few beside its edges, so they are kept where a [`Topology`] is not.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BorderEdges(Vec<BorderEdge>);

impl BorderEdges {
    /// The border edges of a mesh in the order of its topology.
    pub fn of(mesh: &TriMesh, topology: &Topology) -> Self {
        let directed = |edge: usize| {
            let [u, v] = topology.edges[edge];
            let triangle = topology.triangles_of(edge)[0];
            let ends = if mesh.runs_along(triangle as usize, [u, v]) {
                [u, v]
            } else {
                [v, u]
            };
            BorderEdge { ends, triangle }
        };
        Self(topology.border_edges().map(directed).collect())
    }

    /// Edge by edge.
    pub fn iter(&self) -> impl Iterator<Item = &BorderEdge> {
        self.0.iter()
    }

    /// Those of the mesh with every triangle reversed ([`TriMesh::flipped`]).
    pub fn flipped(&self) -> Self {
        let flipped = |edge: &BorderEdge| {
            let [u, v] = edge.ends;
            BorderEdge {
                ends: [v, u],
                triangle: edge.triangle,
            }
        };
        Self(self.0.iter().map(flipped).collect())
    }

    /// Chained to loops, each starting at its smallest vertex, ordered by it.
    pub fn loops(&self) -> Vec<BorderLoop> {
        // Each border vertex has one successor unless two fans touch there.
        let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut starts = Vec::with_capacity(self.0.len());
        for &BorderEdge {
            ends: [from, to], ..
        } in self.iter()
        {
            next.entry(from).or_default().push(to);
            starts.push(from);
        }
        for targets in next.values_mut() {
            targets.sort_unstable_by(|a, b| b.cmp(a));
        }
        starts.sort_unstable();
        let mut loops = Vec::new();
        for start in starts {
            let mut vertices = vec![start];
            let mut at = start;
            let mut closed = false;
            while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
                if to == start {
                    closed = true;
                    break;
                }
                vertices.push(to);
                at = to;
            }
            if vertices.len() > 1 {
                loops.push(BorderLoop { vertices, closed });
            }
        }
        loops
    }
}

#[cfg(test)]
mod tests {
    use super::super::Point3;
    use super::*;

    #[test]
    fn loops_run_with_their_triangles_and_turn_round_with_them() {
        // A square ring of eight triangles around a hole.
        let ring = |half: f64| {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, y]| Point3::new(half * x, half * y, 0.0))
        };
        let triangles = (0..4_u32).flat_map(|i| {
            let j = (i + 1) % 4;
            [[i, j, 4 + j], [i, 4 + j, 4 + i]]
        });
        let mesh = TriMesh::new([ring(2.0), ring(1.0)].concat(), triangles.collect()).unwrap();
        let edges = BorderEdges::of(&mesh, &Topology::of(&mesh));
        let walks = |edges: &BorderEdges| -> Vec<Vec<u32>> {
            let loops = edges.loops();
            assert!(loops.iter().all(|l| l.closed));
            loops.into_iter().map(|l| l.vertices).collect()
        };
        assert_eq!(walks(&edges), [[0, 1, 2, 3], [4, 7, 6, 5]]);
        let flipped = mesh.flipped();
        assert_eq!(
            edges.flipped(),
            BorderEdges::of(&flipped, &Topology::of(&flipped))
        );
        assert_eq!(walks(&edges.flipped()), [[0, 3, 2, 1], [4, 5, 6, 7]]);
    }
}
