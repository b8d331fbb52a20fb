//! The pose of parts that were trimmed differently: outlines that end a few millimetres apart do not pull it aside.

use super::context::PairContext;
use crate::assess::borders::{HOLES_THAT_HOLD, PairKind};
use crate::assess::contact::MAX_NODES;
use crate::assess::evidence::{EvidenceSearch, PoseEvidence};
use crate::assess::fit::Fit;
use crate::assess::trims;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;

/// Steps that are made at most, and the motion, as a share of what may remain, below which they end.
const STEPS: usize = 8;
const STILL: f64 = 0.01;
/// The hole that lies farthest from its counterpart must come closer at least by this factor …
const CLOSER: f64 = 0.5;
/// … while the surfaces lie no farther apart but for this share of what may remain, …
const LITTLE_GAP: f64 = 0.1;
/// … and the parts still meet but for this share of them, which a trim of a few millimetres is.
const LITTLE_LESS: f64 = 0.04;

/// The pose without what outlines that lie apart do to it: a part that hardly holds along itself is pulled along, until
/// the distances of its ends are alike. Surfaces, holes and the outlines that lie together determine where it belongs.
/// `None` where the parts are not trimmed differently under the pose and no more of the outlines lie together under the
/// other one, where they have not two holes in common, where these come no closer, and where the surfaces alone, with
/// their beads, contradict it: the holes of one version may all have been moved.
/// O(steps · (border edges + nodes · log triangles)).
pub fn without_trims(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Option<Similarity>, Cancelled> {
    context.check()?;
    let distances = context.distances(pose.scale);
    let tolerance = distances.tolerance;
    let contacts = context.contacts(pose.scale, distances.reach, MAX_NODES);
    let borders = context.borders(pose.scale, distances.border_reach);
    let mut search = EvidenceSearch::new(contacts, &borders, &distances);
    let Some(evidence) = search.at(pose) else {
        return Ok(None);
    };
    let before = Fitted::of(&evidence);
    let lies_on_holes = before.worst_hole <= evidence.borders.unremarkable();
    if before.n_holes < HOLES_THAT_HOLD || lies_on_holes {
        return Ok(None);
    }
    let limit = evidence.borders.limit(&tolerance);
    let together = outlines_together(&evidence, limit);
    let are_trimmed = trims::other_trim(&evidence, &tolerance).is_some();
    let little = LITTLE_GAP * tolerance.remainder;
    let fit_by_holes = |evidence: &mut PoseEvidence<'_>| {
        evidence.borders = match trims::other_trim(evidence, &tolerance) {
            Some(other) => other.left,
            None => evidence.borders.of_holes(),
        };
        Fit::of(evidence)
    };
    let still = STILL * tolerance.remainder;
    let moved = context.stepped(&mut search, pose, STEPS, |evidence| {
        Some((fit_by_holes(evidence).corrected(evidence), still))
    })?;
    let is_near = context.displacement(&moved, pose) <= distances.border_reach;
    let evidence = search.at(&moved).filter(|_| is_near);
    let is_closer = |met: &PoseEvidence<'_>| Fitted::of(met).is_closer_than(&before, little);
    // A side that is longer pulls the part aside until both ends lie apart; where it belongs only that side does.
    let has_one_longer_side = |met: &PoseEvidence<'_>| {
        let has_more_together = outlines_together(met, limit) > together;
        has_more_together && trims::other_trim(met, &tolerance).is_some()
    };
    let is_trimmed = |met: &PoseEvidence<'_>| are_trimmed || has_one_longer_side(met);
    let is_better = |met: &PoseEvidence<'_>| is_closer(met) && is_trimmed(met);
    let Some(mut evidence) = evidence.filter(is_better) else {
        return Ok(None);
    };
    let fit = fit_by_holes(&mut evidence);
    let left = left_with_beads(&evidence, &fit);
    let alone = context.stepped(&mut search, &moved, STEPS, |evidence| {
        Some((evidence.closer_surfaces(), still))
    })?;
    let contradict = search.at(&alone).is_some_and(|evidence| {
        left_with_beads(&evidence, &Fit::of_surfaces(&evidence)) + little < left
    });
    Ok((!contradict).then_some(moved))
}

/// Length of the outlines that lie beside others by no more than this, times an edge.
fn outlines_together(evidence: &PoseEvidence<'_>, limit: f64) -> f64 {
    let outlines = evidence.borders.pairs().iter();
    let outlines = outlines.filter(|pair| pair.kind == PairKind::Outlines);
    let together = outlines.filter(|pair| pair.gap.abs() <= limit);
    together.map(|pair| pair.weight).sum()
}

/// What a fit leaves of the distances of the surfaces on all but a small share of them.
fn left_with_beads(evidence: &PoseEvidence<'_>, fit: &Fit) -> f64 {
    evidence
        .contacts
        .at_share(&fit.left, trims::MOST_WITH_BEADS)
}

/// How surfaces and holes lie under a pose.
struct Fitted {
    /// Distance of the surfaces, root mean square, without an offset.
    gap: f64,
    /// Share of the smaller part that meets the other.
    met: f64,
    n_holes: usize,
    /// How far the hole that lies farthest from its counterpart is off.
    worst_hole: f64,
}

impl Fitted {
    fn of(evidence: &PoseEvidence<'_>) -> Self {
        Self {
            gap: evidence.contacts.typical_gap(f64::INFINITY),
            met: evidence.contacts.share,
            n_holes: evidence.borders.holes.len(),
            worst_hole: evidence.borders.worst_hole(),
        }
    }

    fn is_closer_than(&self, before: &Self, little: f64) -> bool {
        self.n_holes >= before.n_holes
            && self.worst_hole <= CLOSER * before.worst_hole
            && self.gap <= before.gap + little
            && self.met >= before.met - LITTLE_LESS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::AssessSettings;
    use crate::geometry::{Point3, TriMesh, Vector3};
    use crate::monitor::Monitor;
    use crate::registration::Surface;

    /// A flat sheet of 600 by 200 mm with three holes, its right end cut off by this much.
    fn sheet(cut_off: f64) -> Surface {
        let points = (0..61 * 21).map(|i| {
            let [x, y] = [i % 61, i / 61].map(|k| 10.0 * f64::from(k));
            Point3::new(if x < 600.0 { x } else { x - cut_off }, y, 0.0)
        });
        let is_hole = |x: u32, y: u32| {
            [(10, 4), (30, 12), (44, 4)]
                .iter()
                .any(|&(left, low)| (left..left + 4).contains(&x) && (low..low + 4).contains(&y))
        };
        let cells = (0..60 * 20).map(|i| (i % 60, i / 60));
        let triangles = cells.filter(|&(x, y)| !is_hole(x, y)).flat_map(|(x, y)| {
            let a = 61 * y + x;
            [[a, a + 1, a + 62], [a, a + 62, a + 61]]
        });
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn a_sheet_cut_off_at_one_end_lies_where_its_holes_are() {
        let target = sheet(0.0);
        let pulled = Similarity {
            translation: Vector3::new(3.0, 0.0, 0.0),
            ..Similarity::identity()
        };
        let settled = |source: &Surface| {
            let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
            let context = PairContext::new([source, &target], &settings, &monitor);
            without_trims(&context, &pulled).unwrap()
        };
        let pose = settled(&sheet(6.0)).unwrap();
        let middle = Point3::new(300.0, 100.0, 0.0);
        let off = pose.apply(&middle) - middle;
        assert!(off.norm() < 0.2, "{off}");
        // Where the outlines lie together too, borders and surfaces have settled the pose before.
        assert_eq!(settled(&target), None);
    }
}
