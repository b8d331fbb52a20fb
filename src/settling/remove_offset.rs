//! The pose for the mid-surfaces: an offset between skin and mid-surface is taken out of it.

use super::context::PairContext;
use crate::assess::contact::MAX_NODES;
use crate::assess::evidence::EvidenceSearch;
use crate::assess::fit::Fit;
use crate::assess::shape::FACETING;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Steps that are made at most, and the motion, as a share of the offset, below which they end.
const STEPS: usize = 8;
const STILL: f64 = 1e-4;
/// An offset pushes a pose aside by so many times itself at most; a larger step is none of an offset.
const FARTHEST: f64 = 10.0;

/// The pose without what an offset of the sheets along their normals does to it: pose and offset are
/// solved together, the offset as the seventh unknown. `None` where there is none beside the facets, or
/// where it is not separable from a shift. O(steps · nodes · log triangles).
pub fn without_offset(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Option<Similarity>, Cancelled> {
    let distances = context.distances(pose.scale);
    let contacts = context.contacts(pose.scale, distances.reach, MAX_NODES);
    let borders = context.borders(pose.scale, distances.border_reach);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let mut offset = None;
    let moved = context.stepped(&mut search, pose, STEPS, |evidence| {
        let fit = Fit::of(evidence);
        offset = fit.separate_offset();
        Some((fit.corrected(evidence), STILL * offset?.abs()))
    })?;
    let far = context.displacement(&moved, pose);
    let is_of_an_offset = offset.is_some_and(|offset| {
        offset.abs() > FACETING * distances.noise && far <= FARTHEST * offset.abs()
    });
    Ok(is_of_an_offset.then_some(moved))
}
