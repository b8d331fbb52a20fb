//! Edges of a mesh with the triangles around them; components, common orientation.

use super::TriMesh;
use super::chunks::{for_chunks, map_chunks};
use super::cracks::without_cracks;
use super::groups::groups;
use crate::monitor::{Cancelled, Monitor};

/// Edge adjacency of a mesh. Edges are undirected; an edge with one triangle is a border edge unless it is a side
/// of a crack between elements of different size, one with three or more a non-manifold one.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Topology {
    /// Both ends of each edge, the smaller vertex first, sorted.
    pub edges: Vec<[u32; 2]>,
    /// For each edge, where its triangles start in `edge_triangles`; one entry more than edges.
    pub edge_start: Vec<u32>,
    /// Triangles around the edges, in index order within one edge.
    pub edge_triangles: Vec<u32>,
    /// The border edges, in rising order.
    borders: Vec<u32>,
}

impl Topology {
    /// [`Topology::build`] for meshes of a bounded size, which nobody needs to cancel.
    pub fn of(mesh: &TriMesh) -> Self {
        Self::build(mesh, &Monitor::silent()).expect("nobody cancels a silent monitor")
    }

    /// Lists the edges at their smaller vertices, then sorts each short list.
    /// O(vertices + triangles); the result depends on the mesh alone, not on the orientation of its
    /// triangles.
    pub fn build(mesh: &TriMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        let EdgeSides { start, mut listed } = EdgeSides::of(mesh, monitor)?;
        let mut edges = Vec::with_capacity(listed.len() / 2);
        let mut edge_start = Vec::with_capacity(listed.len() / 2 + 1);
        for_chunks(mesh.n_vertices(), monitor, |range| {
            for low in range {
                let begin = start[low];
                let list = &mut listed[begin as usize..start[low + 1] as usize];
                list.sort_unstable();
                for (i, &(high, _)) in list.iter().enumerate() {
                    if i == 0 || list[i - 1].0 != high {
                        edges.push([low as u32, high]);
                        edge_start.push(begin + i as u32);
                    }
                }
            }
        })?;
        edge_start.push(listed.len() as u32);
        let mut topology = Self {
            edges,
            edge_start,
            edge_triangles: map_chunks(listed.len(), monitor, |side| listed[side].1)?,
            borders: Vec::new(),
        };
        let n_edges = topology.edges.len() as u32;
        let single = (0..n_edges).filter(|&e| topology.triangles_of(e as usize).len() == 1);
        let single = single.collect();
        topology.borders = without_cracks(mesh, &topology, single, monitor)?;
        Ok(topology)
    }

    /// Triangles that share edge `edge`.
    pub fn triangles_of(&self, edge: usize) -> &[u32] {
        &self.edge_triangles[self.edge_start[edge] as usize..self.edge_start[edge + 1] as usize]
    }

    /// Indices of the border edges in rising order: those with exactly one triangle that are no side of a
    /// crack.
    pub fn border_edges(&self) -> impl Iterator<Item = usize> + '_ {
        self.borders.iter().map(|&edge| edge as usize)
    }

    /// Component number of every triangle (connected over edges), counted from 0 in order of each
    /// component's first triangle, and how many there are.
    pub fn components(&self, n_triangles: usize) -> (Vec<u32>, usize) {
        let around = (0..self.edges.len()).map(|edge| self.triangles_of(edge));
        let joined = around.flat_map(|around| around[1..].iter().map(|&other| [around[0], other]));
        groups(n_triangles, joined)
    }
}

/// The sides of all triangles, listed at their smaller vertices.
struct EdgeSides {
    /// For each vertex where its list starts; one entry more than vertices.
    start: Vec<u32>,
    /// The larger vertex of each side and the triangle that has it.
    listed: Vec<(u32, u32)>,
}

impl EdgeSides {
    fn of(mesh: &TriMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        let sides = |&[a, b, c]: &[u32; 3]| {
            [[a, b], [b, c], [c, a]]
                .into_iter()
                .filter(|[u, v]| u != v)
                .map(|[u, v]| (u.min(v), u.max(v)))
        };
        // Where the list of each vertex ends; filling it from behind turns that into its start.
        let mut start = vec![0_u32; mesh.n_vertices() + 1];
        for_chunks(mesh.n_triangles(), monitor, |range| {
            for (low, _) in mesh.triangles()[range].iter().flat_map(sides) {
                start[low as usize] += 1;
            }
        })?;
        let mut total = 0;
        for count in &mut start {
            total += *count;
            *count = total;
        }
        let mut listed = vec![(0_u32, 0_u32); total as usize];
        for_chunks(mesh.n_triangles(), monitor, |range| {
            for t in range {
                for (low, high) in sides(&mesh.triangles()[t]) {
                    let place = &mut start[low as usize];
                    *place -= 1;
                    listed[*place as usize] = (high, t as u32);
                }
            }
        })?;
        Ok(Self { start, listed })
    }
}

/// Turns triangles so that neighbours over manifold edges agree, component by component, each kept
/// on the side that most of its area already faces. Returns the mesh and how many were turned; a
/// mesh whose triangles agree is handed on as it is. `topology` is that of the mesh, before and after.
///
/// A Möbius strip cannot be oriented; there one seam stays. O(vertices + triangles).
pub fn orient_consistently(
    mesh: TriMesh,
    topology: &Topology,
    monitor: &Monitor,
) -> Result<(TriMesh, usize), Cancelled> {
    let disagree = map_chunks(topology.edges.len(), monitor, |edge| {
        match *topology.triangles_of(edge) {
            [s, t] if s != t => {
                let ends = topology.edges[edge];
                mesh.runs_along(s as usize, ends) == mesh.runs_along(t as usize, ends)
            }
            _ => false,
        }
    })?;
    if !disagree.contains(&true) {
        return Ok((mesh, 0));
    }
    let neighbours = neighbours(&mesh, topology, &disagree);
    let turned = turned_triangles(&mesh, &neighbours, monitor)?;
    let n_turned = turned.iter().filter(|&&t| t).count();
    let (positions, mut triangles) = mesh.into_parts();
    for (corners, turned) in triangles.iter_mut().zip(turned) {
        if turned {
            corners.swap(1, 2);
        }
    }
    let mesh = TriMesh::new(positions, triangles).expect("only corner order changed");
    Ok((mesh, n_turned))
}

/// For each triangle its neighbours over manifold edges, of which it has at most three, and whether
/// they disagree with it. What stays at its own index is none.
fn neighbours(mesh: &TriMesh, topology: &Topology, disagree: &[bool]) -> Vec<[(u32, bool); 3]> {
    let n = mesh.n_triangles() as u32;
    let mut neighbours: Vec<[(u32, bool); 3]> = (0..n).map(|t| [(t, false); 3]).collect();
    let mut join = |from: u32, to: u32, disagree: bool| {
        let free = neighbours[from as usize].iter_mut().find(|n| n.0 == from);
        if let Some(place) = free {
            *place = (to, disagree);
        }
    };
    for (edge, &disagree) in disagree.iter().enumerate() {
        if let &[s, t] = topology.triangles_of(edge)
            && s != t
        {
            join(s, t, disagree);
            join(t, s, disagree);
        }
    }
    neighbours
}

/// Walks each component from its first triangle and says which triangles must be turned.
fn turned_triangles(
    mesh: &TriMesh,
    neighbours: &[[(u32, bool); 3]],
    monitor: &Monitor,
) -> Result<Vec<bool>, Cancelled> {
    let n = mesh.n_triangles();
    let mut turn: Vec<Option<bool>> = vec![None; n];
    let mut turned = vec![false; n];
    for_chunks(n, monitor, |range| {
        for seed in range {
            if turn[seed].is_some() {
                continue;
            }
            turn[seed] = Some(false);
            let mut component = vec![seed];
            let mut at = 0;
            let mut kept_area = 0.0;
            while at < component.len() {
                let t = component[at];
                at += 1;
                let flip = turn[t] == Some(true);
                let area = mesh.triangle_area(t);
                kept_area += if flip { -area } else { area };
                for &(other, disagree) in &neighbours[t] {
                    if turn[other as usize].is_none() {
                        turn[other as usize] = Some(flip != disagree);
                        component.push(other as usize);
                    }
                }
            }
            let flip_all = kept_area < 0.0;
            for t in component {
                turned[t] = (turn[t] == Some(true)) != flip_all;
            }
        }
    })?;
    Ok(turned)
}

#[cfg(test)]
mod tests {
    use super::super::{BorderEdges, Point3};
    use super::*;

    /// An n × n grid of quads with the middle quad left out.
    fn plate_with_hole(n: u32) -> TriMesh {
        let mut positions = Vec::new();
        for j in 0..=n {
            for i in 0..=n {
                positions.push(Point3::new(f64::from(i), f64::from(j), 0.0));
            }
        }
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..n {
                if (i, j) != (n / 2, n / 2) {
                    let a = j * (n + 1) + i;
                    triangles.push([a, a + 1, a + n + 2]);
                    triangles.push([a, a + n + 2, a + n + 1]);
                }
            }
        }
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn edges_are_those_of_a_plain_sort() {
        let (positions, mut triangles) = plate_with_hole(6).into_parts();
        triangles.reverse();
        triangles.extend([[3, 3, 9], [0, 1, 8], [8, 1, 0]]);
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let mut sides = Vec::new();
        for (t, &[a, b, c]) in mesh.triangles().iter().enumerate() {
            for [u, v] in [[a, b], [b, c], [c, a]] {
                if u != v {
                    sides.push(([u.min(v), u.max(v)], t as u32));
                }
            }
        }
        sides.sort_unstable();
        let topology = Topology::of(&mesh);
        let listed: Vec<([u32; 2], u32)> = (0..topology.edges.len())
            .flat_map(|e| topology.triangles_of(e).iter().map(move |&t| (e, t)))
            .map(|(e, t)| (topology.edges[e], t))
            .collect();
        assert_eq!(listed, sides);
        assert!(topology.edges.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn finds_border_and_hole() {
        let mesh = plate_with_hole(5);
        let topology = Topology::of(&mesh);
        let loops = BorderEdges::of(&mesh, &topology).loops();
        let mut lengths: Vec<_> = loops.iter().map(|l| (l.vertices.len(), l.closed)).collect();
        lengths.sort_unstable();
        assert_eq!(lengths, vec![(4, true), (20, true)]);
        assert_eq!(topology.components(mesh.n_triangles()).1, 1);
    }

    #[test]
    fn orientation_follows_the_majority() {
        let mesh = plate_with_hole(5);
        let (positions, mut triangles) = mesh.clone().into_parts();
        for t in [0, 7, 8, 21] {
            triangles[t].swap(0, 1);
        }
        let mixed = TriMesh::new(positions, triangles).unwrap();
        let topology = Topology::of(&mixed);
        let monitor = Monitor::silent();
        let (repaired, n_turned) = orient_consistently(mixed, &topology, &monitor).unwrap();
        assert_eq!(n_turned, 4);
        assert_eq!(Topology::of(&repaired), topology);
        assert!((repaired.mean_normal() - mesh.mean_normal()).norm() < 1e-12);
    }
}
