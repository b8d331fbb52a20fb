//! A mesh as all later steps want it: joined at equal positions, its triangles facing one side.

use super::{Topology, TriMesh, Welded, orient_consistently, weld};
use crate::monitor::{Cancelled, Monitor};

/// A mesh joined at equal positions and oriented, with its edges and the way back.
#[derive(Debug, Clone, Default)]
pub struct CleanMesh {
    /// The mesh. Every vertex is used.
    pub mesh: TriMesh,
    /// Edges and borders of the cleaned mesh.
    pub topology: Topology,
    /// For every vertex of the input, its vertex in `mesh`; [`u32::MAX`] where no triangle uses it.
    pub vertex_of: Vec<u32>,
    /// For every triangle of `mesh`, its index in the input.
    pub triangle_of: Vec<u32>,
    /// How many triangles were turned to agree with their neighbours.
    pub n_turned: usize,
}

impl CleanMesh {
    /// Joins and orients. O(vertices + triangles); asks `monitor` every few milliseconds.
    pub fn of(mesh: TriMesh, monitor: &Monitor) -> Result<Self, Cancelled> {
        let Welded {
            mesh,
            vertex_of,
            triangle_of,
        } = weld(mesh, monitor)?;
        let topology = Topology::build(&mesh, monitor)?;
        let (mesh, n_turned) = orient_consistently(mesh, &topology, monitor)?;
        Ok(Self {
            mesh,
            topology,
            vertex_of,
            triangle_of,
            n_turned,
        })
    }
}
