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
pub struct BorderEdges {
    edges: Vec<BorderEdge>,
    /// Where more than two of them meet at a vertex, the one that ends there and the one that begins there on either
    /// side of one fan of triangles, as indices of `edges`; sorted.
    fans: Vec<[u32; 2]>,
}

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
        let edges: Vec<BorderEdge> = topology.border_edges().map(directed).collect();
        let fans = fans(mesh, topology, &edges);
        Self { edges, fans }
    }

    /// Edge by edge.
    pub fn iter(&self) -> impl Iterator<Item = &BorderEdge> {
        self.edges.iter()
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
        let mut fans: Vec<[u32; 2]> = self.fans.iter().map(|&[a, b]| [b, a]).collect();
        fans.sort_unstable();
        Self {
            edges: self.iter().map(flipped).collect(),
            fans,
        }
    }

    /// Chained to loops that pass no vertex twice, each starting at its smallest vertex, ordered by it. Where borders
    /// touch at a vertex, each is a loop of its own. O(edges · log edges).
    pub fn loops(&self) -> Vec<BorderLoop> {
        let mut walk = BorderWalk::new(self);
        let mut loops = Vec::new();
        for i in 0..walk.order.len() {
            walk.run(walk.order[i], &mut loops);
        }
        for BorderLoop { vertices, closed } in &mut loops {
            let smallest = (0..vertices.len()).min_by_key(|&i| vertices[i]);
            if *closed {
                vertices.rotate_left(smallest.unwrap_or(0));
            }
        }
        loops.sort_unstable_by(|a, b| a.vertices.cmp(&b.vertices));
        loops
    }
}

/// A walk along border edges, each of which is taken once.
struct BorderWalk<'a> {
    borders: &'a BorderEdges,
    /// The edges by their first vertex, then by their second one.
    order: Vec<u32>,
    is_used: Vec<bool>,
    /// Whether a fan leads to it from another edge.
    is_led_to: Vec<bool>,
}

impl<'a> BorderWalk<'a> {
    fn new(borders: &'a BorderEdges) -> Self {
        let n_edges = borders.edges.len();
        let mut order: Vec<u32> = (0..n_edges as u32).collect();
        order.sort_unstable_by_key(|&edge| borders.edges[edge as usize].ends);
        let mut is_led_to = vec![false; n_edges];
        for &[_, to] in &borders.fans {
            is_led_to[to as usize] = true;
        }
        Self {
            borders,
            order,
            is_used: vec![false; n_edges],
            is_led_to,
        }
    }

    /// Walks from an edge as far as edges lead, and cuts off a loop where a vertex is met again.
    fn run(&mut self, first: u32, loops: &mut Vec<BorderLoop>) {
        let edges = &self.borders.edges;
        let start = edges[first as usize].ends[0];
        let mut path = vec![start];
        let mut place_of = HashMap::from([(start, 0)]);
        let mut next = Some(first).filter(|&edge| !self.is_used[edge as usize]);
        while let Some(edge) = next {
            self.is_used[edge as usize] = true;
            let to = edges[edge as usize].ends[1];
            if let Some(&place) = place_of.get(&to) {
                let vertices = path.split_off(place);
                for vertex in &vertices[1..] {
                    place_of.remove(vertex);
                }
                loops.push(BorderLoop {
                    vertices,
                    closed: true,
                });
            } else {
                place_of.insert(to, path.len());
            }
            path.push(to);
            next = self.after(edge);
        }
        if path.len() > 1 {
            loops.push(BorderLoop {
                vertices: path,
                closed: false,
            });
        }
    }

    /// The edge to go on with: the one on the other side of the fan, where there is a choice and the fan is whole, else
    /// the first one that is left.
    fn after(&self, edge: u32) -> Option<u32> {
        let BorderEdges { edges, fans } = self.borders;
        let is_free = |edge: &u32| !self.is_used[*edge as usize];
        if let Ok(fan) = fans.binary_search_by_key(&edge, |fan| fan[0]) {
            return Some(fans[fan][1]).filter(is_free);
        }
        let at = edges[edge as usize].ends[1];
        let begin = |edge: u32| edges[edge as usize].ends[0];
        let first = self.order.partition_point(|&edge| begin(edge) < at);
        let around = self.order[first..].iter().copied();
        around
            .take_while(|&edge| begin(edge) == at)
            .find(|edge| is_free(edge) && !self.is_led_to[*edge as usize])
    }
}

/// Of the edges at vertices where more than two of them meet, those on either side of one fan of triangles.
fn fans(mesh: &TriMesh, topology: &Topology, edges: &[BorderEdge]) -> Vec<[u32; 2]> {
    let mut ends: Vec<u32> = edges.iter().flat_map(|edge| edge.ends).collect();
    ends.sort_unstable();
    let touched = ends.chunk_by(|a, b| a == b).filter(|same| same.len() > 2);
    let touched: Vec<u32> = touched.map(|same| same[0]).collect();
    if touched.is_empty() {
        return Vec::new();
    }
    let is_touched = &|vertex: u32| touched.binary_search(&vertex).is_ok();
    let numbered_at = |end: usize| {
        let numbered = edges.iter().zip(0_u32..);
        numbered.filter(move |(edge, _)| is_touched(edge.ends[end]))
    };
    let beginning: HashMap<[u32; 2], u32> =
        numbered_at(0).map(|(edge, i)| (edge.ends, i)).collect();
    let ending = numbered_at(1);
    let fans = ending.filter_map(|(edge, i)| {
        let last = last_side_of_fan(mesh, topology, edge)?;
        Some([i, *beginning.get(&last)?])
    });
    fans.collect()
}

/// The side with which the fan of triangles ends that begins with an edge, at the second vertex of that edge. `None`
/// where three triangles meet at a side of the fan, or two that are not oriented alike.
fn last_side_of_fan(mesh: &TriMesh, topology: &Topology, edge: &BorderEdge) -> Option<[u32; 2]> {
    let at = edge.ends[1];
    let mut triangle = edge.triangle;
    for _ in 0..mesh.n_triangles() {
        let corners = mesh.triangles()[triangle as usize];
        let corner = corners.iter().position(|&vertex| vertex == at)?;
        let to = corners[(corner + 1) % 3];
        let side = topology.edges.binary_search(&[at.min(to), at.max(to)]);
        triangle = match *topology.triangles_of(side.ok()?) {
            [_] => return Some([at, to]),
            [s, t] if s == triangle => t,
            [s, _] => s,
            _ => return None,
        };
        if mesh.runs_along(triangle as usize, [at, to]) {
            return None;
        }
    }
    None
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
