//! Were the parts trimmed differently? A stamped part before its last trim has the surface and the holes of
//! the crash part and an outline farther out, which is then no evidence of pose and shape.

use serde::{Deserialize, Serialize};

use super::borders::{BorderPair, Borders, HOLES_THAT_HOLD, PairKind, STATED};
use super::evidence::PoseEvidence;
use super::fit::Fit;
use super::least_squares::quantile;
use super::outline_shift::outline_aside_of_holes;
use super::stretch;
use super::tolerance::{ShapeTolerance, UNREMARKABLE};
use crate::geometry::Point3;
use crate::geometry::serial::xyz;

/// Outlines of which more than this share lies apart hold no pose.
const MOST_APART: f64 = 0.5;
/// Outlines lie apart if a small motion and a bend leave more than this share of their distance.
const LEFT: f64 = 0.5;

/// Surfaces are fitted no less if no more is left on this share of them, which holds beads.
pub(crate) const MOST_WITH_BEADS: f64 = 0.98;
/// Outlines that lie together may push holes aside all the same if one is left farther off than this share of what is
/// accepted, …
const PUSHED: f64 = 0.5;
/// … and do so if surfaces and holes alone leave no hole farther off than this share of that.
const AGREE: f64 = 0.3;

/// A stretch of border is reported if it is at least this share of the borders beside each other, …
const STRETCH: f64 = 0.03;
/// … and so many places.
const LEAST_PLACES: usize = 5;

/// A stretch of border that lies apart from its counterpart. In target units and the target's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BorderApart {
    /// Distance across the border that half of the stretch exceeds.
    pub by: f64,
    /// Its middle.
    #[serde(with = "xyz")]
    pub at: Point3,
}

/// What is left of the borders of parts that were trimmed differently.
pub(crate) struct OtherTrim {
    /// The borders that are evidence.
    pub(crate) left: Borders,
    /// How far the others lie apart, at 90 % of them.
    pub(super) apart: f64,
}

/// The borders without the outlines that lie apart because the parts were trimmed differently; `None` where they
/// lie together, where one part looks like a longer, wider or higher version of the other, or where they lie aside of
/// the holes as a whole.
pub(crate) fn other_trim(
    evidence: &PoseEvidence<'_>,
    tolerance: &ShapeTolerance,
) -> Option<OtherTrim> {
    let limit = evidence.borders.limit(tolerance);
    SplitOutlines::of(evidence, limit)?.other_trim(evidence, limit)
}

/// The fit of evidence whose outlines count unless the parts were trimmed differently, and how far these lie apart
/// then. Such outlines are taken out of the evidence. Where they are a difference of the shape, but push aside
/// what surfaces and holes agree on, they are only measured.
pub(super) fn fit_of_shape(
    evidence: &mut PoseEvidence<'_>,
    tolerance: &ShapeTolerance,
) -> (Fit, Option<f64>) {
    let limit = evidence.borders.limit(tolerance);
    let Some(outlines) = SplitOutlines::of(evidence, limit) else {
        return (Fit::of(evidence), None);
    };
    match outlines.other_trim(evidence, limit) {
        Some(trim) => {
            evidence.borders = trim.left;
            (Fit::of(evidence), Some(trim.apart))
        }
        None => (outlines.fit, None),
    }
}

/// The fit of the evidence. Borders that do not determine where the part belongs are taken out of it; `limit` is how
/// far they may lie apart. O(places).
pub(crate) fn trusted_fit(evidence: &mut PoseEvidence<'_>, limit: f64) -> Fit {
    match SplitOutlines::of(evidence, limit) {
        Some(outlines) if outlines.share_apart() > MOST_APART => {
            evidence.borders = outlines.trusted();
            Fit::of(evidence)
        }
        Some(outlines) => outlines.fit,
        None => Fit::of(evidence),
    }
}

/// The stretch of the borders that lies farthest apart, if by more than `limit`; `left` are the distances across
/// them without what springback and an error of the pose explain. O(places).
pub(super) fn farthest_apart(borders: &Borders, left: &[f64], limit: f64) -> Option<BorderApart> {
    let pairs = borders.pairs();
    let n = ((STRETCH * pairs.len() as f64) as usize).max(LEAST_PLACES);
    let stretches = pairs.windows(n).zip(left.windows(n));
    let apart = stretches.filter_map(|(pairs, left)| {
        let mut sizes: Vec<f64> = left.iter().map(|x| x.abs()).collect();
        let by = *sizes.select_nth_unstable_by(n / 2, f64::total_cmp).1;
        let middle = &pairs[n / 2];
        let are_alike = middle.kind != PairKind::Mixed;
        (are_alike && by > limit).then_some(BorderApart {
            by,
            at: middle.point,
        })
    });
    apart.max_by(|a, b| a.by.total_cmp(&b.by))
}

/// The outlines, split into those that lie together and those that lie apart whatever small motion or bend is tried.
struct SplitOutlines<'a> {
    borders: &'a Borders,
    /// Of each pair of borders, whether it is of outlines that lie apart.
    is_apart: Vec<bool>,
    /// The fit with all borders.
    fit: Fit,
}

impl<'a> SplitOutlines<'a> {
    /// `None` where hardly any lies apart. O(places), less where they lie together at once.
    fn of(evidence: &'a PoseEvidence<'_>, limit: f64) -> Option<Self> {
        let borders = &evidence.borders;
        let is_apart = |(pair, left): (&BorderPair, f64)| {
            pair.kind == PairKind::Outlines && left.abs() > limit.max(LEFT * pair.gap.abs())
        };
        let pairs = borders.pairs().iter();
        let as_they_are: Vec<bool> = pairs.map(|pair| is_apart((pair, pair.gap))).collect();
        if share_apart(borders, &as_they_are) <= 1.0 - STATED {
            return None;
        }
        let under = |fit: Fit| {
            let pairs = borders.pairs().iter().zip(fit.borders.iter().copied());
            Self {
                borders,
                is_apart: pairs.map(is_apart).collect(),
                fit,
            }
        };
        let outlines = under(Fit::of(evidence));
        let may_push = outlines.lie_apart(limit) || outlines.fit.worst_hole() > PUSHED * limit;
        let by_holes = may_push.then(|| Fit::without_outlines(evidence));
        match by_holes.filter(|fit| outlines.bend_aside(evidence, fit, limit)) {
            Some(fit) => Some(under(fit)),
            None => Some(outlines),
        }
    }

    /// Whether the fit leaves outlines or a hole farther apart than is accepted.
    fn lie_apart(&self, limit: f64) -> bool {
        self.share_apart() > 1.0 - STATED || self.fit.worst_hole() > limit
    }

    /// Whether the outlines push holes aside that lie on each other where surfaces and holes alone are fitted, which
    /// fits the surfaces no less. Outlines of parts that were trimmed differently along a few sides look like a bend.
    fn bend_aside(&self, evidence: &PoseEvidence<'_>, by_holes: &Fit, limit: f64) -> bool {
        let remains = |fit: &Fit| evidence.contacts.at_share(&fit.left, MOST_WITH_BEADS);
        let pushed = self.fit.worst_hole();
        // Within what is accepted a hole may be off itself, unless all agree much better without the outlines.
        let accepted = if self.lie_apart(limit) {
            limit.min(pushed)
        } else {
            AGREE * pushed
        };
        by_holes.holes.len() >= HOLES_THAT_HOLD
            && by_holes.worst_hole() <= accepted
            && remains(by_holes) <= remains(&self.fit) + UNREMARKABLE * limit
    }

    /// The borders without these outlines, where they lie apart because of a trim.
    fn other_trim(&self, evidence: &PoseEvidence<'_>, limit: f64) -> Option<OtherTrim> {
        if self.share_apart() <= 1.0 - STATED
            || stretch::explains_outlines(evidence, limit)
            || outline_aside_of_holes(evidence, &self.fit, limit).is_some()
        {
            return None;
        }
        Some(OtherTrim {
            apart: self.distance(),
            left: self.trusted(),
        })
    }

    /// Share of the outlines that lies apart.
    fn share_apart(&self) -> f64 {
        share_apart(self.borders, &self.is_apart)
    }

    /// How far those lie apart, at 90 % of them.
    fn distance(&self) -> f64 {
        let pairs = self.borders.pairs().iter().zip(&self.is_apart);
        let apart = pairs.filter(|(_, is_apart)| **is_apart);
        let sizes = apart.map(|(pair, _)| (pair.gap.abs(), pair.weight));
        quantile(&mut sizes.collect::<Vec<_>>(), STATED)
    }

    /// The borders without those that lie apart; without all outlines where most do, since some lie beside each
    /// other by chance then.
    fn trusted(&self) -> Borders {
        let none = self.share_apart() > MOST_APART;
        self.borders
            .filtered(|i, pair| !self.is_apart[i] && (!none || pair.kind == PairKind::Holes))
    }
}

/// Share of the outlines that lies apart, given which pairs of borders do.
fn share_apart(borders: &Borders, is_apart: &[bool]) -> f64 {
    let (mut apart, mut whole) = (0.0, 0.0);
    for (pair, &is_apart) in borders.pairs().iter().zip(is_apart) {
        if pair.kind == PairKind::Outlines {
            whole += pair.weight;
            apart += if is_apart { pair.weight } else { 0.0 };
        }
    }
    if whole > 0.0 { apart / whole } else { 0.0 }
}
