//! The measure by which poses from different starts, data choices and hands are compared.

use std::sync::Arc;

use super::holes::Holes;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::icp::{
    Correspondence, Floor, MatchRules, PairWith, RejectRules, Sample, SelectRules, Selection,
    correspond, edge_length, natural_floor, select,
};
use crate::registration::subsample::subsample;
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// A point whose way to a surface has a part along it of more than so many cells lies beyond its border.
const BEYOND: f64 = 3.0;
/// Points of each mesh that poses are compared with.
const N_POINTS: usize = 2000;
/// Price of area beyond the other mesh's border, as an exponent of the covered fraction. Low, because
/// such area says nothing against a pose, while area that has a counterpart and misses it does.
const OVERHANG_PRICE: f64 = 0.5;
/// Where less than this fraction of the smaller part is covered, what is not covered says as much against
/// a pose as what misses: a few points always fit.
const SLIVER: f64 = 0.5;
/// Points farther beyond the border than this fraction of the edge length overhang.
const OVERHANG: f64 = 0.5;
/// Fraction of the faceting that is left between nodes and the smooth surface; 0.2 to 0.5 on the
/// sample parts.
const CURVED: f64 = 0.4;
/// λ of the comparison. A tenth of the area left out costs a factor of 1.37, so that a twin that
/// differs in a small emboss is distinguished; with 1.5 it would cost 1.17.
const LAMBDA: f64 = 3.0;
/// Price of holes none of which the other mesh has, as a factor on top of 1. Only poses that fit
/// equally well otherwise are distinguished by it: a hole may be punched after the stamping.
const HOLE_PRICE: f64 = 0.5;

/// Compares poses of one pair of surfaces by the same measure, whatever search they came from:
/// floored FRMSD of points of each mesh to the smooth surface of the other, where it has one.
pub(crate) struct PoseScorer<'a> {
    source: &'a Surface,
    target: &'a Surface,
    source_samples: Vec<Sample>,
    target_samples: Vec<Sample>,
    source_holes: Holes,
    target_holes: Holes,
    floor: f64,
    /// Points farther away than this find no partner.
    reach: f64,
    /// The larger part, which tells whether a point without partner lies beyond its border. Without it
    /// such points miss.
    far: Option<Arc<FeatureGrid>>,
    source_is_smaller: bool,
}

/// Scores of both directions, in length units; smaller is better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TwoSided {
    pub(crate) source_on_target: f64,
    pub(crate) target_on_source: f64,
}

impl TwoSided {
    /// The geometric mean, by which poses are ranked.
    pub(crate) fn score(&self) -> f64 {
        (self.source_on_target * self.target_on_source).sqrt()
    }

    /// How much worse `other` is, by the direction that discriminates more. At least 1 for a worse score.
    pub(crate) fn ratio_of(&self, other: &Self) -> f64 {
        let forward = other.source_on_target / self.source_on_target;
        let backward = other.target_on_source / self.target_on_source;
        forward.max(backward)
    }
}

impl<'a> PoseScorer<'a> {
    /// `reach` is infinite where far points are asked for too; else `far` is the larger part.
    pub(crate) fn new(
        [source, target]: [&'a Surface; 2],
        allowance: f64,
        (reach, far): (f64, Option<Arc<FeatureGrid>>),
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let edge = edge_length(source, target);
        Ok(Self {
            source,
            target,
            source_samples: subsample(source, N_POINTS, monitor)?,
            target_samples: subsample(target, N_POINTS, monitor)?,
            source_holes: Holes::new(source, edge),
            target_holes: Holes::new(target, edge),
            floor: CURVED * natural_floor(source, target) + allowance,
            reach,
            far,
            source_is_smaller: source.measures().area <= target.measures().area,
        })
    }

    /// Scores the pose of `source` on `target`; `flipped` reverses the source's normals.
    pub(crate) fn score(&self, target_from_source: &Similarity, flipped: bool) -> TwoSided {
        let inverse = target_from_source.inverse();
        let (forward, backward) = rayon::join(
            || {
                self.one_side(
                    &self.source_samples,
                    self.target,
                    target_from_source,
                    flipped,
                )
            },
            || self.one_side(&self.target_samples, self.source, &inverse, flipped),
        );
        let [source_price, target_price] = self.hole_prices(target_from_source, &inverse);
        TwoSided {
            source_on_target: forward * source_price,
            // Distances were measured in the source's unit.
            target_on_source: backward * target_from_source.scale * target_price,
        }
    }

    /// What holes without a counterpart add to the score of each mesh, at least 1. A mesh without
    /// holes says nothing: they may not be modelled.
    fn hole_prices(&self, target_from_source: &Similarity, back: &Similarity) -> [f64; 2] {
        let edge = edge_length(self.source, self.target);
        let (source, target) = (&self.source_holes, &self.target_holes);
        let shares = [
            source.share_on(target, target_from_source, edge),
            target.share_on(source, back, edge / target_from_source.scale),
        ];
        shares.map(|share| 1.0 + HOLE_PRICE * (1.0 - share.unwrap_or(1.0)))
    }

    fn one_side(
        &self,
        samples: &[Sample],
        model: &Surface,
        model_from_data: &Similarity,
        flipped: bool,
    ) -> f64 {
        let samples: Vec<Sample> = samples
            .iter()
            .map(|sample| Sample {
                normal: if flipped {
                    -sample.normal
                } else {
                    sample.normal
                },
                ..*sample
            })
            .collect();
        let rules = MatchRules {
            pair_with: PairWith::Triangle,
            reject: RejectRules {
                min_cos: 0.5,
                max_distance: self.reach,
                max_overhang: OVERHANG * edge_length(self.source, self.target),
            },
            curved: true,
        };
        let silent = Monitor::silent();
        let pairs = correspond(&samples, model, model_from_data, &rules, &[], &silent);
        let mut pairs = pairs.expect("nobody cancels a silent monitor");
        let area = |pairs: &[Correspondence]| pairs.iter().map(|pair| pair.weight).sum::<f64>();
        let whole = area(&pairs);
        let is_smaller = std::ptr::eq(model, self.target) == self.source_is_smaller;
        let is_far_beyond = |pair: &Correspondence| match &self.far {
            Some(grid) => !is_smaller || is_beyond(grid, &pair.moved),
            None => false,
        };
        // An overhanging point knows its triangle but has no partner.
        pairs.retain(|pair| {
            pair.distance_sq.is_finite() || pair.hint == u32::MAX && !is_far_beyond(pair)
        });
        let covered = area(&pairs) / whole;
        let sliver = if is_smaller {
            (covered / SLIVER).min(1.0).powf(-LAMBDA)
        } else {
            1.0
        };
        let floor = self.floor;
        let selection = SelectRules {
            selection: Selection::Fractional {
                lambda: LAMBDA,
                floor: Floor::Length(floor),
            },
            floor,
            max_fraction: 1.0,
        };
        select(&pairs, &selection).map_or(f64::INFINITY, |selected| {
            selected.objective * covered.powf(-OVERHANG_PRICE) * sliver
        })
    }
}

/// True if a point far from a surface lies beside it instead of above it.
fn is_beyond(grid: &FeatureGrid, point: &Point3) -> bool {
    let local = grid.to_local(point);
    let nearest = grid.nearest(local);
    let off = Vector3::from_fn(|k, _| f64::from(local[k] - nearest.point[k]));
    let normal = Vector3::from(nearest.normal.map(f64::from));
    let along = off - normal * off.dot(&normal);
    along.norm() > BEYOND * f64::from(grid.cell())
}
