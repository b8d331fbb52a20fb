//! The measure by which poses from different starts, data choices and hands are compared.

use std::sync::Arc;

use super::holes::HoleBorders;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::icp::{
    Correspondence, Floor, MatchRules, PairSelection, PairWith, RejectRules, Sample, SelectRules,
    correspond, edge_length, natural_floor, select,
};
use crate::registration::result::Side;
use crate::registration::subsample::subsample;
use crate::registration::surface::Surface;
use crate::search::{ClosestPoint, FeatureGrid};

/// A point whose way to a surface has a part along it of more than so many cells lies beyond its border.
const BEYOND: f64 = 3.0;
/// Points of each mesh that poses are compared with.
const N_POINTS: usize = 2000;
/// Price of area beyond the other mesh's border, as an exponent of the covered fraction. Low, because
/// such area is no evidence against a pose, while area that has a counterpart and misses it does.
const OVERHANG_PRICE: f64 = 0.5;
/// Where less than this fraction of the smaller part is covered, what is not covered counts as much against
/// a pose as what misses: a few points always fit.
const SLIVER: f64 = 0.5;
/// The pair of a point of the larger part does not count if the place of the smaller part that it was paired with lies
/// at less than this share of the distance from another place of the larger part. The point then belongs to another
/// sheet, such as a tool beside the blank.
const NEARER: f64 = 0.5;
/// Pairs that lie apart by at most this many floors count in any case.
const APART: f64 = 4.0;
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
    source_holes: HoleBorders,
    target_holes: HoleBorders,
    floor: f64,
    /// Points farther away than this find no partner.
    reach: f64,
    /// The larger part, which shows whether a point without partner lies beyond its border. Without it
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

    /// How much worse `other` is, whose score is no better, by the direction that discriminates more; at least 1.
    /// `None` where that is no finite number.
    pub(crate) fn ratio_of(&self, other: &Self) -> Option<f64> {
        let forward = other.source_on_target / self.source_on_target;
        let backward = other.target_on_source / self.target_on_source;
        // Where both find no pairs in one direction, the other one counts.
        let ratio = forward.max(backward);
        ratio.is_finite().then_some(ratio.max(1.0))
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
            source_holes: HoleBorders::new(source, edge),
            target_holes: HoleBorders::new(target, edge),
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
            || self.one_side(Side::Source, target_from_source, flipped),
            || self.one_side(Side::Target, &inverse, flipped),
        );
        let [source_price, target_price] = self.hole_prices(target_from_source, &inverse);
        TwoSided {
            source_on_target: forward * source_price,
            // Distances were measured in the source's unit.
            target_on_source: backward * target_from_source.scale * target_price,
        }
    }

    /// What holes without a counterpart add to the score of each mesh, at least 1. A mesh without
    /// holes is no evidence: they may not be modelled.
    fn hole_prices(&self, target_from_source: &Similarity, back: &Similarity) -> [f64; 2] {
        let edge = edge_length(self.source, self.target);
        let (source, target) = (&self.source_holes, &self.target_holes);
        let shares = [
            source.share_on(target, target_from_source, edge),
            target.share_on(source, back, edge / target_from_source.scale),
        ];
        shares.map(|share| 1.0 + HOLE_PRICE * (1.0 - share.unwrap_or(1.0)))
    }

    /// Scores the points of one side, the data, on the other.
    fn one_side(&self, data_side: Side, model_from_data: &Similarity, flipped: bool) -> f64 {
        let (data, samples, model) = match data_side {
            Side::Source => (self.source, &self.source_samples, self.target),
            Side::Target => (self.target, &self.target_samples, self.source),
        };
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
        let is_smaller = (data_side == Side::Source) == self.source_is_smaller;
        let is_far_beyond = |pair: &Correspondence| match &self.far {
            Some(grid) => !is_smaller || is_beyond(grid, &pair.moved),
            None => false,
        };
        let data_from_model = model_from_data.inverse();
        // In the model's unit of length; an overhanging point knows its triangle but has no partner.
        let has_counterpart = |pair: &Correspondence| {
            let distance = pair.distance_sq.sqrt();
            let nearer = || {
                let place = data_from_model.apply(&pair.matched);
                let reach = NEARER * distance * data_from_model.scale;
                data.bvh().closest(&place, reach, None, None).is_some()
            };
            is_smaller || distance <= APART * self.floor || !nearer()
        };
        pairs.retain(|pair| {
            if pair.distance_sq.is_finite() {
                has_counterpart(pair)
            } else {
                pair.hint == u32::MAX && !is_far_beyond(pair)
            }
        });
        let covered = area(&pairs) / whole;
        let sliver = if is_smaller {
            (covered / SLIVER).min(1.0).powf(-LAMBDA)
        } else {
            1.0
        };
        let floor = self.floor;
        let selection = SelectRules {
            selection: PairSelection::Fractional {
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
    let normal = Vector3::from(nearest.normal.to_array().map(f64::from));
    let along = off - normal * off.dot(&normal);
    along.norm() > BEYOND * f64::from(grid.cell())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    /// Waved sheets of 100 × 60 at these heights above each other.
    fn sheets(n: u32, heights: &[f64]) -> Surface {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for height in heights {
            let first = points.len() as u32;
            for i in 0..=n {
                for j in 0..=n {
                    let [x, y] =
                        [(i, 100.0), (j, 60.0)].map(|(k, size)| size * f64::from(k) / f64::from(n));
                    let wave = 4.0 * (x / 15.0).sin() * (y / 11.0).cos();
                    points.push(Point3::new(x, y, wave + height));
                }
            }
            let cells = (0..n * n).map(|cell| first + cell / n * (n + 1) + cell % n);
            triangles
                .extend(cells.flat_map(|a| [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]));
        }
        Surface::new(&TriMesh::new(points, triangles).unwrap(), "source").unwrap()
    }

    #[test]
    fn a_direction_without_pairs_makes_no_ratio() {
        let score = |source_on_target, target_on_source| TwoSided {
            source_on_target,
            target_on_source,
        };
        let (nowhere, without) = (
            score(f64::INFINITY, f64::INFINITY),
            score(f64::INFINITY, 10.0),
        );
        assert_eq!(nowhere.ratio_of(&nowhere), None);
        assert_eq!(score(1.0, 10.0).ratio_of(&without), None);
        // Both are infinitely bad.
        assert_eq!(without.ratio_of(&score(f64::INFINITY, 9.0)), Some(1.0));
        assert_eq!(score(1.0, 2.0).ratio_of(&score(3.0, 1.0)), Some(3.0));
    }

    #[test]
    fn a_tool_beside_the_blank_does_not_speak_against_it() {
        let part = sheets(23, &[0.0]);
        let score = |stamped: &Surface| {
            let silent = Monitor::silent();
            let scorer = PoseScorer::new([stamped, &part], 0.0, (12.0, None), &silent).unwrap();
            scorer.score(&Similarity::identity(), false).score()
        };
        let [alone, among_tools, lower] =
            [&[0.0][..], &[0.0, 9.0, -8.0], &[2.0]].map(|heights| score(&sheets(30, heights)));
        // Two thirds of the area lie beyond the part, which costs little.
        assert!(among_tools < 1.4 * alone, "{among_tools} {alone}");
        assert!(lower > 3.0 * alone, "{lower} {alone}");
    }
}
