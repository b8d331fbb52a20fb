//! The two statements about a pair under a pose: how far the pose may be off, and whether the shapes are one.

use super::borders::{BorderComparison, HOLES_THAT_HOLD};
use super::contact::{ContactSearch, MAX_NODES};
use super::coverage::NearNodes;
use super::decide::{LEAST_TOGETHER, NEAR_MIRROR};
use super::evidence::{EvidenceSearch, PoseEvidence};
use super::fit::Fit;
use super::free_motion::FreeMotion;
use super::shape::{OVERHANGS, ShapeStatement, TOGETHER};
use super::tolerance::{AssessSettings, Distances, ShapeTolerance};
use super::trims;
use super::uncertainty::PoseUncertainty;
use crate::geometry::Similarity;
use crate::registration::{MatchOutcome, Surface};

/// An offset of the sheets is removed where the motion that is left to the pose is at most this share of it.
const LEFT: f64 = 0.1;
/// Outlines lie together if this share of those beside others does.
const ALL_TOGETHER: f64 = 0.9;
/// Trims that may lie anywhere within the tolerance are off by this share of it, root mean square (1/√3). Where some
/// lie beyond it, the tolerance counts in full.
const TRIMS_OFF: f64 = 0.577;
/// Outlines of which no more runs across a motion do not resist it.
const HARDLY_ACROSS: f64 = 0.02;

/// How far the pose may be off, and whether the shapes are one.
pub(super) struct Statements {
    pub(super) uncertainty: Option<PoseUncertainty>,
    pub(super) shape: ShapeStatement,
    /// Share of the smaller part's outlines across the free motion that lies together; `None` without such a motion,
    /// and where none resist it.
    pub(super) held_across: Option<f64>,
}

/// Whether outlines are evidence of the shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outlines {
    /// They are, unless the parts were trimmed differently.
    Compared,
    /// They are left out, as if the parts had holes and no outlines.
    LeftOut,
}

/// What both statements are asked about besides the pose.
#[derive(Default)]
pub(super) struct Asked<'a> {
    /// The motion that the surfaces leave free.
    pub(super) motion: Option<&'a FreeMotion>,
    /// The nodes of both parts, where all of them were measured.
    pub(super) near: [NearNodes; 2],
}

/// Both statements. O(border edges + nodes · log triangles).
pub(super) fn statements(
    pair: [&Surface; 2],
    pose: &Similarity,
    asked: Asked<'_>,
    settings: &AssessSettings,
) -> Statements {
    let borders = borders_of(pair, pose.scale, settings);
    let mut compared = Compared::under(&borders, pose, settings, Outlines::Compared);
    if let Some(met) = &mut compared.met {
        met.evidence.near = asked.near;
    }
    let mut shape = compared.shape(settings);
    if let Some(met) = &compared.met
        && shape.met < OVERHANGS
    {
        shape
            .overhang
            .get_or_insert_with(|| met.evidence.overhang());
    }
    let held_across = asked
        .motion
        .and_then(|motion| compared.held_across(pose, motion));
    let (met, tolerance) = (compared.met, compared.tolerance);
    Statements {
        uncertainty: met.and_then(|met| met.uncertainty(settings, &tolerance)),
        shape,
        held_across,
    }
}

/// The statement about the shape alone, which costs less. O(border edges + nodes · log triangles).
pub(crate) fn shape_statement(
    borders: &BorderComparison<'_>,
    pose: &Similarity,
    settings: &AssessSettings,
    outlines: Outlines,
) -> ShapeStatement {
    Compared::under(borders, pose, settings, outlines).shape(settings)
}

/// The borders of two parts as the statements compare them, under poses of this scale.
fn borders_of<'a>(
    pair: [&'a Surface; 2],
    scale: f64,
    settings: &AssessSettings,
) -> BorderComparison<'a> {
    let [source, target] = pair;
    let reach = Distances::of(source, target, scale, settings).border_reach;
    BorderComparison::new(pair, scale, reach)
}

/// The statement about the shape at the pose of the opposite hand, if its score speaks for it.
pub(super) fn mirrored_statement(
    pair: [&Surface; 2],
    outcome: &MatchOutcome,
    settings: &AssessSettings,
) -> Option<ShapeStatement> {
    let check = &outcome.mirror_check;
    let pose = check.target_from_source.as_ref()?;
    let speaks_for_it = check.score_ratio? < NEAR_MIRROR;
    speaks_for_it.then(|| {
        let borders = borders_of(pair, pose.scale, settings);
        shape_statement(&borders, pose, settings, Outlines::Compared)
    })
}

/// Both parts under a pose, and what their shapes are compared by.
struct Compared<'a> {
    tolerance: ShapeTolerance,
    borders: &'a BorderComparison<'a>,
    outlines: Outlines,
    /// `None` where their surfaces do not meet.
    met: Option<Met<'a>>,
}

/// What parts show that meet.
struct Met<'a> {
    evidence: PoseEvidence<'a>,
    fit: Fit,
    /// How far outlines lie apart that were trimmed differently.
    other_trim: Option<f64>,
}

impl<'a> Compared<'a> {
    fn under(
        borders: &'a BorderComparison<'a>,
        pose: &Similarity,
        settings: &AssessSettings,
        outlines: Outlines,
    ) -> Self {
        let pair = borders.surfaces();
        let [source, target] = pair;
        let distances = Distances::of(source, target, pose.scale, settings);
        let millimetre = settings.length_of_millimetre();
        let diagonal = target.measures().diagonal;
        let tolerance = distances.tolerance.for_bends(diagonal, millimetre);
        let contacts = ContactSearch::new(pair, pose.scale, distances.reach, MAX_NODES);
        let mut search = EvidenceSearch::new(contacts, borders, &distances);
        let met = search.at(pose);
        Self {
            met: met.map(|evidence| Met::of(evidence, &tolerance, outlines)),
            tolerance,
            borders,
            outlines,
        }
    }

    fn held_across(&self, pose: &Similarity, motion: &FreeMotion) -> Option<f64> {
        let all = self.borders.across(pose, motion);
        let held = |met: &Met<'_>| {
            let borders = &met.evidence.borders;
            let limit = TOGETHER * borders.limit(&self.tolerance);
            borders.across_within(&met.fit.borders, limit, motion)
        };
        (all > HARDLY_ACROSS).then(|| self.met.as_ref().map_or(0.0, held) / all)
    }

    fn shape(&self, settings: &AssessSettings) -> ShapeStatement {
        let Some(met) = &self.met else {
            return ShapeStatement::nothing_met(self.tolerance);
        };
        let mut shape = ShapeStatement::of(&met.evidence, &met.fit, self.tolerance);
        shape.borders.other_trim = met.other_trim;
        if self.outlines == Outlines::Compared {
            shape.compare_outlines(&met.evidence, self.borders.curves());
        }
        shape.is_offset_removed = settings.remove_offset && is_removed(&met.fit, &shape);
        shape
    }
}

impl<'a> Met<'a> {
    fn uncertainty(
        mut self,
        settings: &AssessSettings,
        tolerance: &ShapeTolerance,
    ) -> Option<PoseUncertainty> {
        if self.hardly_lie_together(tolerance) {
            self.evidence.borders = self.evidence.borders.of_holes();
            self.fit = Fit::of(&self.evidence);
        }
        let other_trims = match self.other_trim {
            _ if !self.is_held_by_trims(tolerance) => 0.0,
            Some(_) => tolerance.remainder,
            None => TRIMS_OFF * tolerance.remainder,
        };
        PoseUncertainty::of(&self.evidence, &self.fit, settings.thickness, other_trims)
    }

    /// Share of the smaller part's borders that lies together.
    fn share_together(&self, tolerance: &ShapeTolerance) -> f64 {
        let borders = &self.evidence.borders;
        borders.share_within(&self.fit.borders, TOGETHER * borders.limit(tolerance))
    }

    /// Whether so few of the borders lie together that the outlines among them may do so by chance, as one end does on
    /// a part with an addendum all round, and no holes hold the part.
    fn hardly_lie_together(&self, tolerance: &ShapeTolerance) -> bool {
        let borders = &self.evidence.borders;
        let together = self.share_together(tolerance);
        borders.holes.len() < HOLES_THAT_HOLD && together < LEAST_TOGETHER
    }

    /// Whether outlines and no holes hold the part while some of them lie apart: the others may have been trimmed
    /// elsewhere too.
    fn is_held_by_trims(&self, tolerance: &ShapeTolerance) -> bool {
        let borders = &self.evidence.borders;
        let together = self.share_together(tolerance);
        let lie_apart = self.other_trim.is_some() || together < ALL_TOGETHER * borders.share();
        borders.holes.len() < HOLES_THAT_HOLD && lie_apart
    }

    fn of(mut evidence: PoseEvidence<'a>, tolerance: &ShapeTolerance, outlines: Outlines) -> Self {
        let (fit, other_trim) = match outlines {
            Outlines::LeftOut => {
                evidence.borders = evidence.borders.of_holes();
                (Fit::of(&evidence), None)
            }
            Outlines::Compared => trims::fit_of_shape(&mut evidence, tolerance),
        };
        Self {
            evidence,
            fit,
            other_trim,
        }
    }
}

/// Whether an offset is all that is left of the gaps: it does not push the pose aside any more.
fn is_removed(fit: &Fit, shape: &ShapeStatement) -> bool {
    let offset = shape.offset.and(fit.separate_offset());
    offset.is_some_and(|offset| fit.rigid.norm() <= LEFT * offset.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::free_motion::FreeMotionKind;
    use crate::geometry::{Point3, TriMesh, Vector3};

    /// A plate of 300 by 120 whose far edges lie so far out of there.
    fn plate(out: [f64; 2]) -> Surface {
        let (n, m) = (150_u32, 60_u32);
        let point = |i: u32, j: u32| {
            let [x, y] = [(i, n, out[0]), (j, m, out[1])]
                .map(|(i, last, out)| 2.0 * f64::from(i) + if i == last { out } else { 0.0 });
            Point3::new(x, y, 0.0)
        };
        let points = (0..=n).flat_map(|i| (0..=m).map(move |j| point(i, j)));
        let cells = (0..n).flat_map(|i| (0..m).map(move |j| i * (m + 1) + j));
        let up = m + 1;
        let triangles = cells.flat_map(|a| [[a, a + up, a + up + 1], [a, a + up + 1, a + 1]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn one_end_that_lies_together_holds_half_of_what_resists_a_slide() {
        let (whole, settings) = (plate([0.0; 2]), AssessSettings::default());
        let pose = Similarity::identity();
        let held = |out, direction| {
            let along = FreeMotion {
                kind: FreeMotionKind::Extruded,
                direction,
                point: Point3::origin(),
            };
            let longer = plate(out);
            let asked = Asked {
                motion: Some(&along),
                ..Asked::default()
            };
            statements([&longer, &whole], &pose, asked, &settings).held_across
        };
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        assert!(held([0.0; 2], x).unwrap() > 0.98);
        let by_one_end = held([60.0, 0.0], x).unwrap();
        assert!((0.4..0.6).contains(&by_one_end), "{by_one_end}");
        assert!(held([60.0, 0.0], y).unwrap() > 0.9);
        assert_eq!(held([0.0; 2], z), None);
    }

    #[test]
    fn outlines_are_known_no_better_than_trims_where_some_lie_apart() {
        let (whole, settings) = (plate([0.0; 2]), AssessSettings::default());
        for (out, is_held_by_trims) in [([0.0; 2], false), ([-1.5, 1.5], true)] {
            let pair = [&plate(out), &whole];
            let pose = Similarity::identity();
            let borders = borders_of(pair, pose.scale, &settings);
            let compared = Compared::under(&borders, &pose, &settings, Outlines::Compared);
            let met = compared.met.unwrap();
            assert_eq!(met.is_held_by_trims(&compared.tolerance), is_held_by_trims);
            let largest = |other_trims| {
                let found = PoseUncertainty::of(&met.evidence, &met.fit, None, other_trims);
                found.unwrap().largest
            };
            let (without, with) = (largest(0.0), largest(1.0));
            let by_trims = (with * with - without * without).sqrt();
            assert!((0.5..3.0).contains(&by_trims), "{without} {with}");
        }
    }

    #[test]
    fn trims_within_the_tolerance_leave_their_root_mean_square_open() {
        let pair = [&plate([0.8, 0.0]), &plate([0.0; 2])];
        let settings = AssessSettings::default();
        let pose = Similarity::identity();
        let found = statements(pair, &pose, Asked::default(), &settings);
        let largest = found.uncertainty.unwrap().largest;
        let share = largest / found.shape.tolerance.remainder;
        assert!((0.5..1.0).contains(&share), "{share}");
    }
}
