//! Borders and holes of two parts under a pose: do they lie where they belong? A part that is three
//! percent longer than its counterpart fits its surface well and misses its borders.

mod holes;

pub(crate) use holes::{Hole, HolePair};

use super::border_curve::{BorderCurve, Place, along, curves_of, ragged};
use super::free_motion::FreeMotion;
use super::least_squares::{quantile, robust_weights};
use super::tolerance::{ShapeTolerance, coarser_edge, is_source_smaller};
use crate::geometry::{Point3, Similarity, Vector3};
use crate::registration::Surface;
use crate::search::PointTree;
use holes::{hole, overlaps, partners, smallest_radius, solid_at};

/// Holes in common that hold a part whose surface can slide.
pub(crate) const HOLES_THAT_HOLD: usize = 2;
/// Of the outlines across a free motion at least this share must lie on others to hold a part: one end of it can
/// always be brought onto another.
pub(crate) const LEAST_ACROSS: f64 = 2.0 / 3.0;
/// Borders are cut into straight edges; so much of their mean edge length is no deviation.
const BORDER_FACETS: f64 = 0.06;
/// So many times the median step aside is none either.
const RAGGED: f64 = 2.5;

/// Share of its weight that a pair of borders keeps at least.
const LEAST_WEIGHT: f64 = 1e-3;

/// Places along the borders of the smaller part that are compared.
const N_PLACES: usize = 600;
/// Borders that run in directions farther apart than this are not the same: cosine of 37°.
const PARALLEL: f64 = 0.8;
/// A place is not paired where its own part has a border nearer to the counterpart than this share of the distance
/// between the two.
const MUTUAL: f64 = 0.7;
/// Where fewer of the smaller part's borders lie beside borders of the other, the parts are trimmed differently
/// and borders are no evidence of the shape.
pub(crate) const LEAST_PAIRED: f64 = 0.4;
/// Distances of borders are stated at this share of their length.
pub(super) const STATED: f64 = 0.9;
/// Points of the other part's borders in the tree lie at least this share of the reach apart.
const SPACING: f64 = 0.1;
/// There are at most so many of them.
const N_DENSE: f64 = 40_000.0;

/// A place on a border of one part beside a border of the other, in the target's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BorderPair {
    pub(super) point: Point3,
    /// Unit direction out of the target's sheet, within it.
    pub(super) across: Vector3,
    /// How far the source's border lies outside the target's.
    pub(crate) gap: f64,
    /// Area that it stands for: length times an edge.
    pub(crate) weight: f64,
    /// Which borders they are.
    pub(crate) kind: PairKind,
}

/// Which borders lie beside each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PairKind {
    /// Two outlines.
    Outlines,
    /// Two borders of holes.
    Holes,
    /// An outline and the border of a hole: a cut may run along a hole of the other part by chance.
    Mixed,
}

/// How the borders of both parts lie.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Borders {
    pairs: Vec<BorderPair>,
    /// Holes of both.
    pub(crate) holes: Vec<HolePair>,
    /// Holes that overlap and are not the same: one was moved by more than its radius, or has another size.
    pub(super) overlapping: Vec<HolePair>,
    /// Holes of the source where the target is solid, and the other way round.
    pub(crate) missing: [Vec<Hole>; 2],
    /// Mean edge length of the coarser mesh.
    pub(super) edge: f64,
    /// How far the borders of the more ragged part step aside from one node to the next, as where elements
    /// were left out instead of cut.
    ragged: f64,
    /// Length of all borders of the smaller part.
    length: f64,
}

/// The borders of two parts, ready to be compared under one pose after another.
#[derive(Debug, Clone)]
pub(crate) struct BorderComparison<'a> {
    /// Source and target.
    surfaces: [&'a Surface; 2],
    borders: [Vec<BorderCurve>; 2],
    /// Whether the source is the smaller part, along whose borders places are compared.
    of_source: bool,
    /// Distance in target units beyond which borders have nothing to do with each other.
    near: f64,
    /// What is the same under every pose.
    still: Borders,
    /// `None` where a part has no borders.
    places: Option<BorderPlaces>,
}

/// Places along the borders of both parts, each in the frame of its part.
#[derive(Debug, Clone)]
struct BorderPlaces {
    /// Along the smaller part, and how far apart.
    own: Vec<Place>,
    step: f64,
    /// The same, as dense as those of the larger part.
    own_tree: PointTree,
    other: Vec<Place>,
    other_tree: PointTree,
    /// Distance of the dense places in target units.
    spacing: f64,
}

impl<'a> BorderComparison<'a> {
    /// Prepares for poses of this scale. O(border edges).
    pub(crate) fn new(surfaces: [&'a Surface; 2], scale: f64, near: f64) -> Self {
        let [source, target] = surfaces;
        let borders = surfaces.map(curves_of);
        let of_source = is_source_smaller(source, target, scale);
        let [own, other] = if of_source { [0, 1] } else { [1, 0] };
        let units = [scale, 1.0];
        let still = Borders {
            edge: coarser_edge(surfaces, scale),
            ragged: ragged(&borders[0], scale).max(ragged(&borders[1], 1.0)),
            length: units[own] * borders[own].iter().map(|border| border.length).sum::<f64>(),
            ..Borders::default()
        };
        Self {
            places: BorderPlaces::new(
                (&borders[own], units[own]),
                (&borders[other], units[other]),
                near,
            ),
            surfaces,
            borders,
            of_source,
            near,
            still,
        }
    }

    /// Source and target.
    pub(super) fn surfaces(&self) -> [&'a Surface; 2] {
        self.surfaces
    }

    /// The borders of source and target, each in the frame of its part.
    pub(super) fn curves(&self) -> [&[BorderCurve]; 2] {
        self.borders.each_ref().map(Vec::as_slice)
    }

    /// Compares the borders that lie near each other under a pose. O(border edges + near triangles).
    pub(crate) fn at(&self, pose: &Similarity) -> Borders {
        let still = Similarity::identity();
        let places = self.places.iter();
        let mut pairs: Vec<BorderPair> = if self.of_source {
            places
                .flat_map(|p| p.pairs(pose, &still, self.near))
                .collect()
        } else {
            places
                .flat_map(|p| p.pairs(&still, pose, self.near))
                .collect()
        };
        for pair in &mut pairs {
            pair.weight *= self.still.edge;
            if !self.of_source {
                pair.gap = -pair.gap;
            }
        }
        let mut found = Borders {
            pairs,
            ..self.still.clone()
        };
        found.compare_holes(self.surfaces, self.curves(), pose, self.near);
        found
    }

    /// Length of the smaller part's outlines across a motion, as a share of all its borders: where they run along it,
    /// they do not resist it.
    pub(crate) fn across(&self, pose: &Similarity, motion: &FreeMotion) -> f64 {
        let still = Similarity::identity();
        let target_from_own = if self.of_source { pose } else { &still };
        let across = |places: &BorderPlaces| {
            let outlines = places.own.iter().filter(|place| !place.is_hole);
            let across = outlines.map(|place| {
                let place = place.moved(target_from_own);
                across(motion, &place.point, &place.tangent.cross(&place.normal))
            });
            across.sum::<f64>() / places.own.len().max(1) as f64
        };
        self.places.as_ref().map_or(0.0, across)
    }
}

/// How much of a motion goes across a border at a point: from 0, along it, to 1.
fn across(motion: &FreeMotion, point: &Point3, across: &Vector3) -> f64 {
    let way = motion.way_at(point);
    way.map_or(0.0, |way| way.dot(across).abs())
}

impl BorderPlaces {
    /// Of borders of the smaller and of the other part, each with its unit in target units.
    fn new(
        (own, unit): (&[BorderCurve], f64),
        (other, other_unit): (&[BorderCurve], f64),
        near: f64,
    ) -> Option<Self> {
        let length =
            |borders: &[BorderCurve]| borders.iter().map(|border| border.length).sum::<f64>();
        let (own_length, other_length) = (length(own), length(other));
        if own_length <= 0.0 || other_length <= 0.0 {
            return None;
        }
        let spacing = (SPACING * near / other_unit).max(other_length / N_DENSE);
        let dense = along(other, spacing);
        let spacing = spacing * other_unit;
        let step = own_length / N_PLACES as f64;
        let own_spacing = (spacing / unit).min(step).max(own_length / N_DENSE);
        let tree = |places: &[Place]| {
            PointTree::build(places.iter().map(|place| place.point).collect::<Vec<_>>())
        };
        let (own_tree, other_tree) =
            rayon::join(|| tree(&along(own, own_spacing)), || tree(&dense));
        Some(Self {
            own: along(own, step),
            step,
            own_tree,
            other_tree,
            other: dense,
            spacing,
        })
    }

    /// Places along the smaller part's borders beside those of the other.
    fn pairs(
        &self,
        target_from_own: &Similarity,
        target_from_other: &Similarity,
        near: f64,
    ) -> Vec<BorderPair> {
        let other_from_own = target_from_other.inverse().after(target_from_own);
        let own_from_other = other_from_own.inverse();
        let (unit, other_unit) = (target_from_own.scale, target_from_other.scale);
        let pair = |place: &Place| {
            let query = other_from_own.apply(&place.point);
            let found = self.other_tree.nearest(&query, near / other_unit, None)?;
            let beside = &self.other[found.index as usize];
            let away = found.distance_sq.sqrt() * other_unit;
            let back = own_from_other.apply(&beside.point);
            // A cut beside a border is not that border, which has a counterpart of its own.
            let nearer = (MUTUAL * away - self.spacing) / unit;
            let has_nearer = self.own_tree.nearest(&back, nearer, None).is_some();
            let [place, beside] = [
                place.moved(target_from_own),
                beside.moved(target_from_other),
            ];
            if beside.tangent.dot(&place.tangent).abs() < PARALLEL || has_nearer {
                return None;
            }
            let across = beside.tangent.cross(&beside.normal);
            Some(BorderPair {
                gap: (place.point - beside.point).dot(&across),
                point: beside.point,
                across,
                weight: self.step * unit,
                kind: match (place.is_hole, beside.is_hole) {
                    (true, true) => PairKind::Holes,
                    (false, false) => PairKind::Outlines,
                    _ => PairKind::Mixed,
                },
            })
        };
        self.own.iter().filter_map(pair).collect()
    }
}

impl Borders {
    /// Pairs of holes that are the same but for a little, then those that overlap.
    pub(super) fn all_holes(&self) -> impl Iterator<Item = &HolePair> {
        self.holes.iter().chain(&self.overlapping)
    }

    /// How far the hole that lies farthest from its counterpart is off; 0 without holes.
    pub(crate) fn worst_hole(&self) -> f64 {
        let off = self.holes.iter().map(|pair| pair.off.norm());
        off.fold(0.0, f64::max)
    }

    /// What 90 % of the pairs of like borders do not exceed of these distances across them, one for each pair.
    pub(super) fn distance_of_most(&self, left: &[f64]) -> f64 {
        let pairs = self.pairs.iter().zip(left);
        let alike = pairs.filter(|(pair, _)| pair.kind != PairKind::Mixed);
        let sizes = alike.map(|(pair, left)| (left.abs(), pair.weight));
        quantile(&mut sizes.collect::<Vec<_>>(), STATED)
    }

    pub(crate) fn pairs(&self) -> &[BorderPair] {
        &self.pairs
    }

    /// The borders without those pairs that are not wanted; each is given with its number.
    pub(super) fn filtered(&self, is_wanted: impl Fn(usize, &BorderPair) -> bool) -> Self {
        let pairs = self.pairs.iter().enumerate();
        let wanted = pairs.filter(|(i, pair)| is_wanted(*i, pair));
        Self {
            pairs: wanted.map(|(_, pair)| *pair).collect(),
            ..self.clone()
        }
    }

    /// The borders without outlines, which lie beside each other by chance where the parts are trimmed differently.
    pub(crate) fn of_holes(&self) -> Self {
        self.filtered(|_, pair| pair.kind == PairKind::Holes)
    }

    /// Distance between borders that is no evidence of a difference.
    pub(crate) fn unremarkable(&self) -> f64 {
        BORDER_FACETS * self.edge + RAGGED * self.ragged
    }

    /// How far apart borders may lie: what facets and ragged trims do to them is no difference of the parts.
    pub(crate) fn limit(&self, tolerance: &ShapeTolerance) -> f64 {
        tolerance.remainder.hypot(self.unremarkable())
    }

    /// Share of the smaller part's borders that lie beside borders of the other.
    pub(crate) fn share(&self) -> f64 {
        self.share_of(self.pairs.iter())
    }

    /// Share of the smaller part's borders that lies beside like borders of the other at no more than this distance,
    /// where so much is left of the distance of each pair.
    pub(super) fn share_within(&self, left: &[f64], distance: f64) -> f64 {
        let within = self
            .pairs
            .iter()
            .zip(left)
            .filter(|(pair, left)| pair.kind != PairKind::Mixed && left.abs() <= distance);
        self.share_of(within.map(|(pair, _)| pair))
    }

    /// The same of what outlines go across a motion, as [`BorderComparison::across`].
    pub(crate) fn across_within(&self, left: &[f64], distance: f64, motion: &FreeMotion) -> f64 {
        let across = self.pairs.iter().zip(left).filter_map(|(pair, left)| {
            let is_held = pair.kind == PairKind::Outlines && left.abs() <= distance;
            is_held.then(|| BorderPair {
                weight: pair.weight * across(motion, &pair.point, &pair.across),
                ..*pair
            })
        });
        self.share_of(across.collect::<Vec<_>>().iter())
    }

    /// Share of the smaller part's borders that these pairs stand for.
    fn share_of<'a>(&self, pairs: impl Iterator<Item = &'a BorderPair>) -> f64 {
        let length = pairs.map(|pair| pair.weight).sum::<f64>() / self.edge;
        if self.length > 0.0 {
            length / self.length
        } else {
            0.0
        }
    }

    /// Length of the borders of holes where the other part is solid, as a share of all borders of the smaller
    /// part.
    pub(crate) fn missing_share(&self) -> f64 {
        let missing = self.missing.iter().flatten();
        let length: f64 = missing.map(|hole| hole.length).sum();
        if self.length > 0.0 {
            length / self.length
        } else {
            0.0
        }
    }

    /// Root mean square distance of the smaller part's borders from those of the other, which were looked for within
    /// `near`; a border or a hole without counterpart lies that far away too.
    pub(crate) fn apart(&self, near: f64) -> f64 {
        let share = self.share().min(1.0);
        let paired: f64 = self.pairs.iter().map(|p| p.weight).sum();
        let gaps = self.pairs.iter().map(|p| p.weight * p.gap * p.gap);
        let mean_sq = if paired > 0.0 {
            gaps.sum::<f64>() / paired
        } else {
            0.0
        };
        let alone = (1.0 - share) + self.missing_share();
        (share * mean_sq + alone * near * near).sqrt()
    }

    /// The pairs' weights, less for those that lie far apart beside the others, and none for the edge of a cut beside
    /// a hole.
    pub(super) fn weights(&self, noise: f64) -> Vec<f64> {
        let gaps: Vec<f64> = self.pairs.iter().map(|p| p.gap).collect();
        // Ragged borders know a place only as well as their steps are small, and all to one side.
        let known = (BORDER_FACETS * self.edge / self.unremarkable()).powi(2);
        let areas: Vec<f64> = self.pairs.iter().map(|p| known * p.weight).collect();
        let mut weights = robust_weights(&gaps, &areas, noise.max(self.unremarkable()));
        for ((weight, area), pair) in weights.iter_mut().zip(&areas).zip(&self.pairs) {
            // Where no surface holds the part, borders do, however far apart.
            *weight = match pair.kind {
                PairKind::Mixed => 0.0,
                PairKind::Outlines | PairKind::Holes => weight.max(LEAST_WEIGHT * area),
            };
        }
        weights
    }

    fn compare_holes(
        &mut self,
        surfaces: [&Surface; 2],
        borders: [&[BorderCurve]; 2],
        pose: &Similarity,
        near: f64,
    ) {
        let still = Similarity::identity();
        let [of_source, of_target] =
            [(borders[0], pose), (borders[1], &still)].map(|(borders, pose)| {
                let holes = borders.iter().filter(|border| border.is_hole);
                holes.map(|border| hole(border, pose)).collect::<Vec<_>>()
            });
        let [in_source, in_target] = [&of_source, &of_target].map(|holes| smallest_radius(holes));
        let partners = partners(&of_source, &of_target, near);
        let mut is_used = vec![false; of_target.len()];
        let mut alone = Vec::new();
        for (hole, partner) in of_source.into_iter().zip(partners) {
            match partner {
                Some(i) => {
                    is_used[i] = true;
                    self.holes.push(HolePair::of(&hole, &of_target[i]));
                }
                None => alone.push(hole),
            }
        }
        let back = pose.inverse();
        let left = of_target.iter().zip(&is_used).filter(|(_, used)| !**used);
        let left: Vec<Hole> = left.map(|(hole, _)| *hole).collect();
        let (source, target) = ((surfaces[0], &back), (surfaces[1], &still));
        let [(of_source, mut open_in_target), (of_target, open_in_source)] = [
            solid_at(alone, source, target, near, in_target),
            solid_at(left, target, source, near, in_source),
        ];
        self.missing = [of_source, of_target];
        // Where neither part is solid at the middle of the other's hole, the holes lie in each other.
        for other in open_in_source {
            if let Some(i) = open_in_target
                .iter()
                .position(|hole| overlaps(hole, &other))
            {
                let hole = open_in_target.swap_remove(i);
                self.overlapping.push(HolePair::of(&hole, &other));
            }
        }
    }
}

#[cfg(test)]
mod tests;
