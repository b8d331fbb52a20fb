//! The pose for the mid-surfaces: an offset between skin and mid-surface is taken out of it.

use super::borders::BorderComparison;
use super::contact::{ContactSearch, MAX_NODES};
use super::evidence::EvidenceSearch;
use super::fit::Fit;
use super::shape::{FACETING, ShapeStatement};
use super::tolerance::{AssessSettings, Distances};
use crate::geometry::Similarity;
use crate::registration::Surface;

/// Steps that are made at most, and the motion, as a share of the offset, below which they end.
const STEPS: usize = 8;
const STILL: f64 = 1e-4;
/// What may be left of the motion, likewise.
const LEFT: f64 = 0.1;
/// An offset pushes a pose aside by so many times itself at most; a larger step is none of an offset.
const FARTHEST: f64 = 10.0;

/// The pose without what an offset of the sheets along their normals does to it: pose and offset are
/// solved together, the offset as the seventh unknown. `None` where there is none beside the facets, or
/// where it cannot be told from a shift. O(steps · nodes · log triangles).
pub fn without_offset(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> Option<Similarity> {
    let distances = Distances::of(source, target, pose.scale, settings);
    let corners = source.mesh().aabb().corners();
    let pair = [source, target];
    let contacts = ContactSearch::new(pair, pose.scale, distances.reach, MAX_NODES);
    let borders = BorderComparison::new(pair, pose.scale, distances.near);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let mut moved = *pose;
    let mut offset = 0.0;
    for _ in 0..STEPS {
        let evidence = search.at(&moved)?;
        let fit = Fit::of(&evidence);
        offset = fit.separate_offset()?;
        let next = fit.corrected(&evidence);
        let step = next.max_displacement(&moved, &corners);
        moved = next;
        if step <= STILL * offset.abs() {
            break;
        }
    }
    let far = moved.max_displacement(pose, &corners);
    (offset.abs() > FACETING * distances.noise && far <= FARTHEST * offset.abs()).then_some(moved)
}

/// Whether an offset is all that is left of the gaps: it does not push the pose aside any more.
pub(super) fn is_removed(fit: &Fit, shape: &ShapeStatement) -> bool {
    let offset = shape.offset.and(fit.separate_offset());
    offset.is_some_and(|offset| fit.rigid.norm() <= LEFT * offset.abs())
}
