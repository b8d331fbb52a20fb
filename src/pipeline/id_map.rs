//! The way back from a prepared mesh to the deck it was made of.

use crate::geometry::chunks::{for_chunks, map_chunks};
use crate::monitor::{Cancelled, Monitor};

/// Which node, element and part of the deck the vertices and triangles of a mesh come from. Nodes,
/// elements and parts are meant by their place in the model.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct IdMap {
    /// Each chosen node with its vertex, in the order in which elements name the nodes first.
    vertices: Vec<NodeVertex>,
    first_node: Vec<u32>,
    element: Vec<u32>,
    part: Vec<u32>,
}

/// A node of the deck and the vertex that it became.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NodeVertex {
    /// The node's place in the model.
    pub node: u32,
    /// Vertex of the mesh.
    pub vertex: u32,
}

/// Where the vertices and triangles of a mesh come from, before it was joined.
pub(super) struct Origins {
    /// Node of each vertex.
    pub node: Vec<u32>,
    /// Element of each triangle.
    pub element: Vec<u32>,
    /// Part of each triangle.
    pub part: Vec<u32>,
}

impl IdMap {
    /// Follows joining: `vertex_of` gives the vertex that each earlier vertex became (`u32::MAX` for
    /// none), `triangle_of` the earlier triangle of each triangle. O(vertices + triangles).
    pub(super) fn new(
        origins: &Origins,
        vertex_of: &[u32],
        triangle_of: &[u32],
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut vertices = Vec::with_capacity(vertex_of.len());
        let mut first_node = Vec::new();
        for_chunks(vertex_of.len(), monitor, |range| {
            for (&node, &vertex) in origins.node[range.clone()].iter().zip(&vertex_of[range]) {
                if vertex == u32::MAX {
                    continue;
                }
                vertices.push(NodeVertex { node, vertex });
                // Vertices are numbered in the order of their first nodes.
                if vertex as usize == first_node.len() {
                    first_node.push(node);
                }
            }
        })?;
        let of_triangles = |origin: &[u32]| {
            let of = |triangle: usize| origin[triangle_of[triangle] as usize];
            map_chunks(triangle_of.len(), monitor, of)
        };
        Ok(Self {
            vertices,
            first_node,
            element: of_triangles(&origins.element)?,
            part: of_triangles(&origins.part)?,
        })
    }

    /// The first node that became a vertex.
    pub fn node_of(&self, vertex: u32) -> Option<u32> {
        self.first_node.get(vertex as usize).copied()
    }

    /// Element of a triangle: an index into the shells, or, from their number on, into the solids.
    pub fn element_of(&self, triangle: u32) -> Option<u32> {
        self.element.get(triangle as usize).copied()
    }

    /// Element of each triangle.
    pub fn elements(&self) -> &[u32] {
        &self.element
    }

    /// Part of a triangle.
    pub fn part_of(&self, triangle: u32) -> Option<u32> {
        self.part.get(triangle as usize).copied()
    }

    /// Part of each triangle.
    pub fn parts(&self) -> &[u32] {
        &self.part
    }

    /// Every chosen node with its vertex, in the order in which elements name the nodes first.
    pub fn nodes(&self) -> &[NodeVertex] {
        &self.vertices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_vertices_lead_to_their_first_node_and_lost_ones_nowhere() {
        let origins = Origins {
            node: vec![40, 41, 42, 43],
            element: vec![7, 7, 8],
            part: vec![0, 0, 1],
        };
        let map = IdMap::new(&origins, &[0, 1, 0, u32::MAX], &[0, 2], &Monitor::silent()).unwrap();
        assert_eq!(
            [0, 1, 2].map(|v| map.node_of(v)),
            [Some(40), Some(41), None]
        );
        assert_eq!(
            [0, 1, 2].map(|t| map.element_of(t)),
            [Some(7), Some(8), None]
        );
        assert_eq!(map.part_of(1), Some(1));
        let pairs: Vec<_> = map.nodes().iter().map(|n| (n.node, n.vertex)).collect();
        assert_eq!(pairs, [(40, 0), (41, 1), (42, 0)]);
    }
}
