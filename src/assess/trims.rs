//! Were the parts trimmed differently? A stamped part before its last trim has the surface and the holes of
//! the crash part and an outline farther out, which then says nothing about pose and shape.

use serde::{Deserialize, Serialize};

use super::borders::{Borders, PairKind};
use super::contact::quantile;
use super::fit::{Fit, ShapeEvidence};
use super::stretch;
use super::tolerance::ShapeTolerance;
use crate::geometry::Point3;
use crate::geometry::serial::xyz;

/// Outlines of which more than this share lies apart hold no pose.
const MOST_APART: f64 = 0.5;
/// Outlines lie apart if a small motion and a bend leave more than this share of their distance.
const LEFT: f64 = 0.5;
/// Share of the outlines that the statement about borders is made at.
const STATED: f64 = 0.9;

/// A stretch of border is told if it is at least this share of the borders beside each other.
const STRETCH: f64 = 0.03;

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
pub(super) struct OtherTborder {
    /// The borders that say something about the parts.
    pub(super) left: Borders,
    /// How far the others lie apart, at 90 % of them.
    pub(super) apart: f64,
}

/// The borders without the outlines that lie apart because the parts were trimmed differently; `None` where they
/// lie together, or where one part looks like a longer, wider or higher version of the other.
pub(super) fn other_trim(
    evidence: &ShapeEvidence<'_>,
    tolerance: &ShapeTolerance,
) -> Option<OtherTborder> {
    let limit = evidence.borders.limit(tolerance);
    let outlines = Outlines::of(evidence, limit)?;
    if outlines.share_apart() <= 1.0 - STATED || stretch::explains_outlines(evidence, limit) {
        return None;
    }
    Some(OtherTborder {
        apart: outlines.distance(),
        left: outlines.trusted(),
    })
}

/// The borders that say where the part belongs; `None` where all do. `limit` is how far borders may lie apart.
pub(super) fn trusted(evidence: &ShapeEvidence<'_>, limit: f64) -> Option<Borders> {
    let outlines = Outlines::of(evidence, limit)?;
    (outlines.share_apart() > MOST_APART).then(|| outlines.trusted())
}

/// The stretch of the borders that lies farthest apart, if by more than `limit`; `left` are the distances across
/// them without what springback and an error of the pose explain. O(places).
pub(super) fn farthest_apart(borders: &Borders, left: &[f64], limit: f64) -> Option<BorderApart> {
    let pairs = borders.pairs();
    let n = ((STRETCH * pairs.len() as f64) as usize).max(5);
    let stretches = pairs.windows(n).zip(left.windows(n));
    let apart = stretches.filter_map(|(pairs, left)| {
        let mut sizes: Vec<f64> = left.iter().map(|x| x.abs()).collect();
        let by = *sizes.select_nth_unstable_by(n / 2, f64::total_cmp).1;
        (by > limit).then_some(BorderApart {
            by,
            at: pairs[n / 2].point,
        })
    });
    apart.max_by(|a, b| a.by.total_cmp(&b.by))
}

/// The outlines of which some lie apart whatever small motion or bend is tried.
struct Outlines<'a> {
    borders: &'a Borders,
    /// Of each pair of borders, whether it is of outlines that lie apart.
    is_apart: Vec<bool>,
}

impl<'a> Outlines<'a> {
    /// `None` where hardly any lies apart. O(places), less where they lie together at once.
    fn of(evidence: &ShapeEvidence<'a>, limit: f64) -> Option<Self> {
        let borders = evidence.borders;
        let apart = |left: &dyn Fn(usize) -> f64| {
            let pairs = borders.pairs().iter().enumerate();
            pairs
                .map(|(i, pair)| {
                    pair.kind == PairKind::Outlines
                        && left(i).abs() > limit.max(LEFT * pair.gap.abs())
                })
                .collect()
        };
        let as_they_are = Self {
            borders,
            is_apart: apart(&|i| borders.pairs()[i].gap),
        };
        if as_they_are.share_apart() <= 1.0 - STATED {
            return None;
        }
        let fit = Fit::of(evidence);
        Some(Self {
            borders,
            is_apart: apart(&|i| fit.borders[i]),
        })
    }

    /// Share of the outlines that lies apart.
    fn share_apart(&self) -> f64 {
        let (mut apart, mut whole) = (0.0, 0.0);
        for (pair, &is_apart) in self.borders.pairs().iter().zip(&self.is_apart) {
            if pair.kind == PairKind::Outlines {
                whole += pair.weight;
                apart += if is_apart { pair.weight } else { 0.0 };
            }
        }
        if whole > 0.0 { apart / whole } else { 0.0 }
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
