//! The order of collapses, and the mesh at any point of it.

use super::decimator::Collapse;
use super::intake::{Frame, take_in};
use super::regions::decimate;
use super::settings::{Simplified, SimplifyError, SimplifyReport, SimplifySettings, StopReason};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// A recorded simplification. Every level between the full mesh and the coarsest can be taken out
/// in any order, each in O(vertices + triangles), and equals what [`super::simplify`] gives for
/// that number of triangles.
#[derive(Debug, Clone)]
pub struct CollapseSequence {
    frame: Frame,
    positions: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
    triangle_of: Vec<u32>,
    n_before: usize,
    collapses: Vec<Collapse>,
    stop_reason: StopReason,
}

impl CollapseSequence {
    /// Collapses `mesh` down to `settings.max_triangles`, or until nothing legal is left, and
    /// remembers every step. 48 bytes or so per vertex beside the mesh.
    pub fn record(
        mesh: &TriMesh,
        settings: &SimplifySettings,
        monitor: &Monitor,
    ) -> Result<Self, SimplifyError> {
        Self::record_parts(mesh, &[], settings, monitor)
    }

    /// Like [`CollapseSequence::record`] for a mesh of several parts: edges between triangles with
    /// different labels are seams, kept like borders. No labels at all mean a single part.
    pub fn record_parts(
        mesh: &TriMesh,
        part_of_triangle: &[u32],
        settings: &SimplifySettings,
        monitor: &Monitor,
    ) -> Result<Self, SimplifyError> {
        settings.validate()?;
        if !part_of_triangle.is_empty() && part_of_triangle.len() != mesh.n_triangles() {
            return Err(SimplifyError::LabelCount {
                n_labels: part_of_triangle.len(),
                n_triangles: mesh.n_triangles(),
            });
        }
        monitor.check()?;
        let intake = take_in(mesh, part_of_triangle, monitor)?;
        let triangles = intake.mesh.triangles.clone();
        let (collapses, stop_reason) = decimate(intake.mesh, settings, monitor)?;
        Ok(Self {
            frame: intake.frame,
            positions: mesh.positions().to_vec(),
            triangles,
            triangle_of: intake.triangle_of,
            n_before: mesh.n_triangles(),
            collapses,
            stop_reason,
        })
    }

    /// Triangles of the coarsest level.
    pub fn coarsest(&self) -> usize {
        self.collapses
            .last()
            .map_or(self.triangles.len(), |c| c.n_triangles as usize)
    }

    /// The finest mesh with at most `max_triangles` triangles; the coarsest if none is so small.
    pub fn level(&self, max_triangles: usize) -> TriMesh {
        let taken_out = self.simplified(max_triangles, &Monitor::silent());
        taken_out.expect("nobody cancels a silent monitor").mesh
    }

    /// [`CollapseSequence::level`] with the ties to the original and the report.
    pub fn simplified(
        &self,
        max_triangles: usize,
        monitor: &Monitor,
    ) -> Result<Simplified, Cancelled> {
        let n_made = self
            .collapses
            .partition_point(|c| c.n_triangles as usize > max_triangles);
        let n_made = if self.triangles.len() <= max_triangles {
            0
        } else {
            (n_made + 1).min(self.collapses.len())
        };
        let made = &self.collapses[..n_made];
        // From the last collapse to the first, what a vertex was merged into is already known.
        let mut root: Vec<u32> = (0..self.positions.len() as u32).collect();
        for_chunks(n_made, monitor, |range| {
            for collapse in made[n_made - range.end..n_made - range.start].iter().rev() {
                root[collapse.removed as usize] = root[collapse.kept as usize];
            }
        })?;
        let mut moved_by = vec![u32::MAX; self.positions.len()];
        for_chunks(n_made, monitor, |range| {
            for step in range {
                moved_by[made[step].kept as usize] = step as u32;
            }
        })?;
        let position = |v: u32| match moved_by[v as usize] {
            u32::MAX => self.positions[v as usize],
            step => self.frame.restore(&made[step as usize].position),
        };
        let mut number = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        let mut triangle_of = Vec::new();
        for_chunks(self.triangles.len(), monitor, |range| {
            for t in range {
                let [a, b, c] = self.triangles[t].map(|v| root[v as usize]);
                if a == b || b == c || c == a {
                    continue;
                }
                triangles.push([a, b, c].map(|v| {
                    if number[v as usize] == u32::MAX {
                        number[v as usize] = positions.len() as u32;
                        positions.push(position(v));
                    }
                    number[v as usize]
                }));
                triangle_of.push(self.triangle_of[t]);
            }
        })?;
        let vertex_of = root.iter().map(|&v| number[v as usize]).collect();
        let mesh = TriMesh::new(positions, triangles)
            .expect("indices are numbered above and collapses end at finite places");
        Ok(Simplified {
            report: self.report(max_triangles, mesh.n_triangles()),
            mesh,
            triangle_of,
            vertex_of,
        })
    }

    fn report(&self, max_triangles: usize, triangles_after: usize) -> SimplifyReport {
        let stop_reason = if triangles_after <= max_triangles {
            StopReason::Reached
        } else {
            self.stop_reason
        };
        SimplifyReport {
            triangles_before: self.n_before,
            triangles_after,
            stop_reason,
        }
    }
}
