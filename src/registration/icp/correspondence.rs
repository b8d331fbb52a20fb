//! What each data point is paired with.

use serde::{Deserialize, Serialize};

use super::reject::RejectRules;
use crate::geometry::chunks::map_chunks;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::surface::Surface;
use crate::search::{ClosestPoint, FeatureGrid, NormalFilter};

/// What a data point is paired with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PairWith {
    /// The nearest node of the other mesh, as in the paper.
    Node,
    /// The nearest point on the other mesh's triangles.
    #[default]
    Triangle,
}

/// A point of the data mesh, in the data mesh's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) point: Point3,
    pub(crate) normal: Vector3,
    pub(crate) weight: f64,
}

/// A moved data point and the model point it is paired with, in the model's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correspondence {
    /// The data point after the current motion.
    pub moved: Point3,
    /// Its unit normal, turned along.
    pub moved_normal: Vector3,
    /// The point it is paired with.
    pub matched: Point3,
    /// Unit normal there.
    pub matched_normal: Vector3,
    /// Area that the data point stands for.
    pub weight: f64,
    /// Squared distance of both; infinite for a point that found no partner.
    pub distance_sq: f64,
    /// Triangle (or node) it was paired with; `u32::MAX` without partner.
    pub hint: u32,
}

/// How correspondences are made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MatchRules {
    pub(crate) pair_with: PairWith,
    pub(crate) reject: RejectRules,
    /// Pair with the smooth surface instead of its facets.
    pub(crate) curved: bool,
}

/// Up to so many pairs are made on the calling thread.
const FEW: usize = 2048;

/// Pairs every sample under `model_from_data`; the answer for a sample does not depend on the
/// others, so the thread count changes nothing. `hints` holds last time's partners, or is empty. `monitor` is asked
/// where there are many.
pub(crate) fn correspond(
    samples: &[Sample],
    model: &Surface,
    model_from_data: &Similarity,
    rules: &MatchRules,
    hints: &[Correspondence],
    monitor: &Monitor,
) -> Result<Vec<Correspondence>, Cancelled> {
    let pair = |i: usize| {
        let hint = hints.get(i).map(|c| c.hint).filter(|&h| h != u32::MAX);
        match_point(&samples[i], model, model_from_data, rules, hint)
    };
    if samples.len() <= FEW {
        return Ok((0..samples.len()).map(pair).collect());
    }
    map_chunks(samples.len(), monitor, pair)
}

/// Pairs every sample with the plane of a sample of the model near it, in constant time however far
/// away that is. Within a cell of the grid the plane is as good as the surface; beyond, the way within
/// the plane counts too.
pub(crate) fn correspond_on_grid(
    samples: &[Sample],
    grid: &FeatureGrid,
    model_from_data: &Similarity,
    min_cos: f64,
) -> Vec<Correspondence> {
    let slack = f64::from(grid.cell()) / grid.scale();
    let pair = |sample: &Sample| {
        let moved = model_from_data.apply(&sample.point);
        let moved_normal = model_from_data.rotate(&sample.normal);
        let local = grid.to_local(&moved);
        let hint = grid.nearest_index(local);
        let feature = &grid.features()[hint as usize];
        let off = grid.to_outer(std::array::from_fn(|k| local[k] - feature.point[k]));
        let normal = Vector3::from(feature.normal.to_array().map(f64::from));
        let height = off.dot(&normal);
        let along = off - normal * height;
        let beyond = along * (1.0 - (slack / along.norm().max(slack)).min(1.0));
        let matched = moved - normal * height - beyond;
        let agrees = normal.dot(&moved_normal) >= min_cos;
        Correspondence {
            moved,
            moved_normal,
            matched,
            matched_normal: normal,
            weight: sample.weight,
            distance_sq: if agrees {
                (matched - moved).norm_squared()
            } else {
                f64::INFINITY
            },
            hint,
        }
    };
    samples.iter().map(pair).collect()
}

fn match_point(
    sample: &Sample,
    model: &Surface,
    model_from_data: &Similarity,
    rules: &MatchRules,
    hint: Option<u32>,
) -> Correspondence {
    let moved = model_from_data.apply(&sample.point);
    let moved_normal = model_from_data.rotate(&sample.normal);
    let alone = Correspondence {
        moved,
        moved_normal,
        matched: moved,
        matched_normal: moved_normal,
        weight: sample.weight,
        distance_sq: f64::INFINITY,
        hint: u32::MAX,
    };
    match rules.pair_with {
        PairWith::Node => {
            let found = model.nearest_node(&moved, rules.reject.max_distance, hint);
            let Some((node, distance_sq)) = found else {
                return alone;
            };
            let matched_normal = model.vertex_normals()[node as usize];
            if matched_normal.dot(&moved_normal) < rules.reject.min_cos {
                return Correspondence {
                    hint: node,
                    ..alone
                };
            }
            Correspondence {
                matched: model.mesh().positions()[node as usize],
                matched_normal,
                distance_sq,
                hint: node,
                ..alone
            }
        }
        PairWith::Triangle => {
            let filter = (rules.reject.min_cos > -1.0 && sample.normal != Vector3::zeros())
                .then_some(NormalFilter {
                    direction: moved_normal,
                    min_cos: rules.reject.min_cos,
                });
            let found =
                model
                    .bvh()
                    .closest(&moved, rules.reject.max_distance, hint, filter.as_ref());
            let Some(hit) = found else {
                return alone;
            };
            if rules.reject.rejects(model, &hit, &moved) {
                return Correspondence {
                    hint: hit.triangle,
                    ..alone
                };
            }
            let matched = if rules.curved {
                model.curved_point(&hit)
            } else {
                hit.point
            };
            Correspondence {
                matched,
                matched_normal: model.normal_at(&hit),
                distance_sq: (matched - moved).norm_squared(),
                hint: hit.triangle,
                ..alone
            }
        }
    }
}
