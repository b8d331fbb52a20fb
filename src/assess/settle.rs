//! The last step of a pose: where surfaces alone leave it free to slide, borders and holes hold it, and an
//! offset of the sheets does not push it aside.

use super::contact::{Contacts, quantile};
use super::rims::Rims;
use super::shape::{Fit, ShapeEvidence};
use super::{AssessSettings, REACH, tolerance_of};
use crate::geometry::Similarity;
use crate::registration::Surface;

/// Steps that are made at most.
const STEPS: usize = 6;
/// Rims are looked for within this share of the diagonal: a door slides so far.
const RIM_SHARE: f64 = 0.015;
/// Rims must lie beside each other along this share of the smaller part's.
const LEAST_PAIRED: f64 = 0.3;
/// The misfit of the rims must shrink at least to this share.
const BETTER: f64 = 0.7;
/// The surfaces may come to lie apart by so many times as much …
const AS_CLOSE: f64 = 1.5;
/// … and this share of what may remain.
const LITTLE_GAP: f64 = 0.5;

/// The pose moved so that surfaces, borders and holes fit together; `None` where that would move it by
/// no more than the rims are cut into facets, where the rims do not say where the part belongs (parts
/// that are trimmed differently), or where they fit no better. O(steps · nodes · log triangles).
pub fn settled(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> Option<Similarity> {
    let near = RIM_SHARE * target.measures().diagonal;
    settled_within(source, target, pose, settings, near)
}

/// [`settled`], with rims looked for within at least `near`.
pub(super) fn settled_within(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
    near: f64,
) -> Option<Similarity> {
    let tolerance = tolerance_of(target, settings);
    let diagonal = target.measures().diagonal;
    let reach = (REACH * diagonal).max(3.0 * tolerance.springback);
    let near = near.max(3.0 * tolerance.remainder);
    let chordal = |surface: &Surface| surface.measures().chordal_error;
    let noise = chordal(source).max(chordal(target)) + settings.allowance;
    let mut moved = *pose;
    let (mut first_misfit, mut first_gap) = (None, None);
    for step in 0..=STEPS {
        let contacts = Contacts::find(source, target, &moved, reach)?;
        let rims = Rims::find(source, target, &moved, near);
        if rims.share() < LEAST_PAIRED {
            return None;
        }
        let facets = rims.unremarkable();
        let misfit = misfit(&rims);
        let first = *first_misfit.get_or_insert(misfit);
        let gap = contacts.typical_gap();
        let most =
            AS_CLOSE * *first_gap.get_or_insert(gap) + noise + LITTLE_GAP * tolerance.remainder;
        if step == STEPS {
            let fits = misfit < tolerance.remainder + facets && gap < most;
            return (fits && misfit < BETTER * first).then_some(moved);
        }
        let evidence = ShapeEvidence {
            source,
            pose: &moved,
            contacts: &contacts,
            rims: &rims,
            noise,
        };
        moved = contacts.undo(&Fit::of(&evidence).rigid).after(&moved);
        if step == 0 && largest_motion(source, pose, &moved) <= facets {
            return None;
        }
    }
    None
}

/// Distance across the rims that most of their length does not exceed.
fn misfit(rims: &Rims) -> f64 {
    let pairs = rims.pairs().iter();
    quantile(
        &mut pairs.map(|p| (p.gap.abs(), p.weight)).collect::<Vec<_>>(),
        0.75,
    )
}

/// How far the farthest node moves between two poses.
fn largest_motion(source: &Surface, before: &Similarity, after: &Similarity) -> f64 {
    let nodes = source.mesh().positions().iter();
    nodes
        .map(|p| (after.apply(p) - before.apply(p)).norm())
        .fold(0.0, f64::max)
}
