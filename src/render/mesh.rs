//! A mesh prepared for drawing.

use std::sync::Arc;

use rayon::prelude::*;

use super::coarse::{COARSE, coarse};
use super::mesh_build::{self, EdgeClasses};
use crate::geometry::{Aabb, Point3, Topology, TriMesh, VertexFans, corner_normals, face_normals};
use crate::monitor::Monitor;

/// Neighbours that turn by at most so much look like one curved sheet.
const CREASE_DEG: f64 = 35.0;
/// Why preparing a mesh for drawing always ends.
const NEVER: &str = "nobody cancels a silent monitor";

/// What a [`RenderMesh`] is made of.
#[derive(Debug, Clone, Copy)]
pub struct MeshInput<'a> {
    /// The triangles. A mesh without triangles is drawn as points.
    pub mesh: &'a TriMesh,
    /// Part index of each triangle; `None` for one part. Missing entries count as part 0.
    pub part_of_triangle: Option<&'a [u32]>,
    /// Element index of each triangle: edges inside one element are not drawn, so that a quadrilateral
    /// split in two looks like one. `None` if every triangle is an element.
    pub element_of_triangle: Option<&'a [u32]>,
    /// About so many triangles its coarse picture has, if it is large.
    pub n_coarse: usize,
}

impl<'a> MeshInput<'a> {
    /// One part whose elements are the triangles.
    pub fn plain(mesh: &'a TriMesh) -> Self {
        Self {
            mesh,
            part_of_triangle: None,
            element_of_triangle: None,
            n_coarse: COARSE,
        }
    }
}

/// A mesh prepared for drawing: corners with creased normals, edge lines, borders, nodes.
///
/// Plain CPU work without a device, meant to run in a job. Corners are not shared between triangles:
/// each carries its own normal and part, so that creases and looks of parts need no features that OpenGL
/// lacks. Coordinates are `f32` about the centre of the box, so they keep their digits far from the origin.
#[derive(Debug)]
pub struct RenderMesh {
    /// The point that `f32` coordinates are relative to.
    pub(super) origin: Point3,
    pub(super) corners: Vec<Corner>,
    /// Vertex of each corner in the mesh this was made of.
    pub(super) corner_vertices: Vec<u32>,
    /// Corner of that mesh that each corner stands for; empty where they are the same.
    pub(super) source_corners: Vec<u32>,
    /// What is drawn of a large mesh while the view moves.
    coarse: Option<Arc<RenderMesh>>,
    /// Pairs of corners.
    pub(super) edge_corners: Vec<[u32; 2]>,
    pub(super) wide_edges: Vec<WideEdge>,
    /// Where the values at the ends of each of them are found.
    pub(super) wide_ends: Vec<[ValuePlace; 2]>,
    pub(super) nodes: Vec<Node>,
    /// Where the value at each of them is found.
    pub(super) node_places: Vec<ValuePlace>,
    /// Mean length of the drawn element edges; 0 without edges.
    pub(super) mean_edge_length: f64,
    bounds: Aabb,
}

/// One corner of a triangle as the graphics card reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Corner {
    pub(super) position: [f32; 3],
    /// Octahedral unit vector.
    pub(super) normal: [i16; 2],
    pub(super) part: u32,
}

/// A border or crease edge as the graphics card reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct WideEdge {
    pub(super) from: [f32; 3],
    pub(super) to: [f32; 3],
    pub(super) part: u32,
}

/// The vertex and the corner of a mesh whose values a node or an end of an edge takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct ValuePlace {
    pub(super) vertex: u32,
    pub(super) corner: u32,
}

/// A mesh vertex as the graphics card reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Node {
    pub(super) position: [f32; 3],
    pub(super) part: u32,
}

/// Highest bit of [`WideEdge::part`]: set for borders, clear for creases.
pub(super) const BORDER_BIT: u32 = 1 << 31;

impl RenderMesh {
    /// Prepares a mesh, a large one with its coarse picture. O(triangles).
    pub fn new(input: MeshInput<'_>) -> Self {
        let mut whole = Self::whole(input);
        whole.coarse = coarse(&whole, input);
        whole
    }

    /// Without a coarse picture.
    pub(super) fn whole(input: MeshInput<'_>) -> Self {
        let mesh = input.mesh;
        let bounds = mesh.aabb();
        let origin = bounds.center();
        let near = |p: &Point3| -> [f32; 3] { (p - origin).map(|x| x as f32).into() };
        let part = |t: usize| {
            let part = input.part_of_triangle.and_then(|parts| parts.get(t));
            part.copied().unwrap_or(0) & !BORDER_BIT
        };
        let monitor = Monitor::silent();
        let faces = face_normals(mesh, &monitor).expect(NEVER);
        let (normals, (topology, classes)) = rayon::join(
            || {
                let fans = VertexFans::of(mesh, &monitor).expect(NEVER);
                let crease = CREASE_DEG.to_radians();
                corner_normals(mesh, &faces, &fans, crease, &monitor).expect(NEVER)
            },
            || {
                let topology = Topology::of(mesh);
                let classes = EdgeClasses::of(&topology, &faces, input.element_of_triangle);
                (topology, classes)
            },
        );
        let corner_vertices: Vec<u32> = mesh.triangles().iter().flatten().copied().collect();
        let corners = corner_vertices
            .par_iter()
            .enumerate()
            .map(|(corner, &vertex)| Corner {
                position: near(&mesh.positions()[vertex as usize]),
                normal: mesh_build::octahedral(&normals.of_triangle(mesh, corner / 3)[corner % 3]),
                part: part(corner / 3),
            })
            .collect();
        let mut wide_edges = Vec::new();
        let mut wide_ends = Vec::new();
        let place = |corner: u32| ValuePlace {
            vertex: corner_vertices[corner as usize],
            corner,
        };
        for (edges, bit) in [(&classes.features, 0), (&classes.borders, BORDER_BIT)] {
            wide_edges.extend(edges.iter().map(|&edge| {
                let [from, to] = topology.edges[edge].map(|v| near(&mesh.positions()[v as usize]));
                let part = part(topology.triangles_of(edge)[0] as usize) | bit;
                WideEdge { from, to, part }
            }));
            let ends = mesh_build::corner_pairs(mesh, &topology, edges);
            wide_ends.extend(ends.into_iter().map(|ends| ends.map(place)));
        }
        let (nodes, node_places) = nodes_of(mesh, near, part);
        Self {
            origin,
            corners,
            edge_corners: mesh_build::corner_pairs(mesh, &topology, &classes.elements),
            wide_edges,
            wide_ends,
            nodes,
            node_places,
            mean_edge_length: mesh_build::mean_length(mesh, &topology, &classes.elements),
            corner_vertices,
            source_corners: Vec::new(),
            coarse: None,
            bounds,
        }
    }

    /// What stands for the mesh while the view moves; `None` for a mesh that is drawn at once.
    pub fn coarse(&self) -> Option<&Arc<Self>> {
        self.coarse.as_ref()
    }

    /// Takes the origin and the box of another mesh, so that its lines fit.
    pub(super) fn place_about(&mut self, other: &Self) {
        let shift = (self.origin - other.origin).map(|x| x as f32);
        for corner in &mut self.corners {
            corner.position = std::array::from_fn(|i| corner.position[i] + shift[i]);
        }
        for node in &mut self.nodes {
            node.position = std::array::from_fn(|i| node.position[i] + shift[i]);
        }
        (self.origin, self.bounds) = (other.origin, other.bounds);
    }

    /// Box around the mesh in its own coordinates.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.corners.len() / 3
    }

    /// Number of border edges.
    pub fn n_border_edges(&self) -> usize {
        let is_border = |edge: &&WideEdge| edge.part & BORDER_BIT != 0;
        self.wide_edges.iter().filter(is_border).count()
    }

    /// Number of crease edges.
    pub fn n_feature_edges(&self) -> usize {
        self.wide_edges.len() - self.n_border_edges()
    }
}

/// Vertices that triangles use, each with the part and the corner of its first triangle; all vertices of a mesh
/// without triangles.
fn nodes_of(
    mesh: &TriMesh,
    near: impl Fn(&Point3) -> [f32; 3],
    part: impl Fn(usize) -> u32,
) -> (Vec<Node>, Vec<ValuePlace>) {
    const NONE: u32 = u32::MAX;
    let mut corners = vec![NONE; mesh.n_vertices()];
    for (corner, &vertex) in mesh.triangles().iter().flatten().enumerate() {
        let known = &mut corners[vertex as usize];
        if *known == NONE {
            *known = corner as u32;
        }
    }
    let nodes = (0..).zip(mesh.positions()).zip(corners);
    nodes
        .filter(|&(_, corner)| corner != NONE || mesh.is_empty())
        .map(|((vertex, p), corner)| {
            let part = if corner == NONE {
                0
            } else {
                part(corner as usize / 3)
            };
            let position = near(p);
            (Node { position, part }, ValuePlace { vertex, corner })
        })
        .unzip()
}
