//! Quadric error simplification (Garland and Heckbert 1997) to a maximum number of triangles.
//!
//! Edges are collapsed cheapest first. The price of a collapse is the area-weighted squared
//! distance to the planes of the triangles around the edge as they are now: quadrics without
//! memory (Lindstrom and Turk 1998; Hoppe 1999), which at 1,000 of 35,000 triangles halve the
//! error that summed quadrics leave. Borders, seams between parts and edges
//! with three or more triangles pull on their vertices as well and are only collapsed along
//! themselves. No collapse may turn a triangle over, pinch the surface or join separate sheets.
//!
//! Where the time goes decides the layout: an edge waits in a bucket queue under the price it had
//! when it was last priced, and is priced anew when it comes up (`decimator`); position and quadric
//! of a vertex lie together, and a face keeps the vector whose outer product is its quadric
//! (`surface`). A large mesh is collapsed in regions side by side (`regions`).
//!
//! The result does not depend on the unit of length, on the place of the part or on the number of
//! threads, and nearly equal prices are decided by the order of the edges, so the same mesh always
//! gives the same result.

mod decimator;
mod intake;
mod legality;
mod quadric;
mod queue;
mod regions;
mod sequence;
mod settings;
mod surface;

pub use sequence::CollapseSequence;
pub use settings::{
    Placement, Simplified, SimplifyError, SimplifyReport, SimplifySettings, Speed, StopReason,
};

use crate::geometry::TriMesh;
use crate::monitor::Monitor;

/// Reduces `mesh` to at most `settings.max_triangles` triangles.
///
/// Vertices at the same place count as joined only if they are one vertex: weld first. Zero-area,
/// repeated and non-manifold triangles and unused vertices are taken as they come. The result has
/// more triangles than the maximum only if nothing legal is left to collapse, which
/// [`SimplifyReport::stop_reason`] then says. O(n log n) in the triangles.
pub fn simplify(
    mesh: &TriMesh,
    settings: &SimplifySettings,
    monitor: &Monitor,
) -> Result<Simplified, SimplifyError> {
    let sequence = CollapseSequence::record(mesh, settings, monitor)?;
    Ok(sequence.simplified(settings.max_triangles, monitor)?)
}
