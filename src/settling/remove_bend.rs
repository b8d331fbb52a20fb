//! The pose of a bent part: its bends are counted as its shape and do not push the pose aside.

use super::context::PairContext;
use crate::assess::borders::LEAST_PAIRED;
use crate::assess::contact::{MAX_NODES, STATED_SHARE};
use crate::assess::evidence::EvidenceSearch;
use crate::assess::fit::Fit;
use crate::assess::shape::FACETING;
use crate::assess::tolerance::UNREMARKABLE;
use crate::assess::trims;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Steps that are made at most, and the motion, as a share of the bend, below which they end.
const STEPS: usize = 8;
const STILL: f64 = 0.02;
/// Surfaces whose root mean square distance, but for an offset, is this share of a bend that counts are not bent so.
const CLOSE: f64 = 0.4;
/// A bend pushes a pose aside by so many times itself at most; a larger step is none of a bend.
const FARTHEST: f64 = 12.0;
/// The parts still meet but for this share of them.
const LITTLE_LESS: f64 = 0.01;

/// The pose without what a bend does to it: a motion of surfaces that leaves the smallest distances makes up for a
/// part of the bend, and a smoothly curved part slides along itself by many times that. Motion, bends and an offset are
/// solved together, with the borders where they hold. `None` where the part is hardly bent, or where the pose would go
/// farther than a bend takes it. O(steps · (border edges + nodes · log triangles)).
pub fn without_bend(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Option<Similarity>, Cancelled> {
    context.check()?;
    let distances = context.distances(pose.scale);
    let tolerance = distances.tolerance;
    let mut contacts = context.contacts(pose.scale, distances.reach, MAX_NODES);
    let hardly = (UNREMARKABLE * tolerance.remainder).max(FACETING * distances.noise);
    let met = contacts.at(pose);
    if met.is_none_or(|met| met.typical_gap(f64::INFINITY) <= CLOSE * hardly) {
        return Ok(None);
    }
    let borders = context.borders(pose.scale, distances.border_reach);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let mut moved = *pose;
    let mut first = None;
    for step in 0..=STEPS {
        context.check()?;
        let Some(mut evidence) = search.at(&moved) else {
            break;
        };
        let fit = if evidence.borders.share() < LEAST_PAIRED {
            evidence.borders = evidence.borders.of_holes();
            Fit::of(&evidence)
        } else {
            let limit = evidence.borders.limit(&tolerance);
            trims::trusted_fit(&mut evidence, limit)
        };
        let contacts = &evidence.contacts;
        let [bend, left] =
            [&fit.smooth, &fit.left].map(|values| contacts.at_share(values, STATED_SHARE));
        let (first_bend, first_left, first_share) =
            *first.get_or_insert((bend, left, contacts.share));
        if first_bend <= hardly {
            break;
        }
        let next = fit.corrected(&evidence);
        let is_still = context.displacement(&next, &moved) <= STILL * first_bend;
        if is_still || step == STEPS {
            let far = context.displacement(&moved, pose);
            let is_of_a_bend = far <= FARTHEST * bend
                && bend <= first_bend.max(tolerance.springback)
                && left <= first_left + UNREMARKABLE * tolerance.remainder
                && contacts.share >= first_share - LITTLE_LESS;
            return Ok((step > 0 && is_of_a_bend).then_some(moved));
        }
        moved = next;
    }
    Ok(None)
}
