//! How much of each surface lies on the other, and how far apart they are there.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::tolerance::{coarser_edge, faceting};
use crate::geometry::Similarity;
use crate::geometry::serial::any_float;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;
use crate::search::ClosestPoint;

/// Distances of the nodes of one mesh from the triangles of the other, weighted by area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OneSided {
    /// Fraction of this mesh's area that lies within the limit of the other mesh; the denominator is
    /// this mesh's own area.
    #[serde(with = "any_float")]
    pub overlap: f64,
    /// Root mean square distance within the overlap; infinite, as the next two, where nothing overlaps.
    #[serde(with = "any_float")]
    pub rmse: f64,
    /// Distance below which 95 % of the overlap's area lies.
    #[serde(with = "any_float")]
    pub p95: f64,
    /// Largest distance within the overlap.
    #[serde(with = "any_float")]
    pub max: f64,
    /// Largest distance of any node, overlap or not.
    #[serde(with = "any_float")]
    pub max_anywhere: f64,
}

/// Distances and overlap in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Source nodes against target triangles.
    pub source_on_target: OneSided,
    /// Target nodes against source triangles.
    pub target_on_source: OneSided,
    /// Distance up to which a place counts as covered, in target length units.
    pub limit: f64,
}

impl Coverage {
    /// Of the nodes of source and target.
    fn of(measured: [Vec<Measured>; 2], limit: f64) -> Self {
        let [source_on_target, target_on_source] = measured.map(|nodes| one_sided(nodes, limit));
        Self {
            source_on_target,
            target_on_source,
            limit,
        }
    }

    /// Overlap of the part that is covered better: 1 if one contains the other.
    pub fn better_overlap(&self) -> f64 {
        let (a, b) = (self.source_on_target.overlap, self.target_on_source.overlap);
        a.max(b)
    }

    /// The larger root mean square distance of both directions in which anything overlaps; infinite where nothing does.
    pub fn rmse(&self) -> f64 {
        self.largest(|one| one.rmse)
    }

    /// The same of the 95th percentiles.
    pub fn p95(&self) -> f64 {
        self.largest(|one| one.p95)
    }

    /// The same of the largest distances.
    pub fn max(&self) -> f64 {
        self.largest(|one| one.max)
    }

    fn largest(&self, of: impl Fn(&OneSided) -> f64) -> f64 {
        let both = [&self.source_on_target, &self.target_on_source].map(of);
        let finite = both.into_iter().filter(|distance| distance.is_finite());
        finite.reduce(f64::max).unwrap_or(f64::INFINITY)
    }
}

/// A place is covered within this share of the mean edge length of the coarser mesh: beyond it a carried value would
/// come from the wrong element, …
const LIMIT_EDGES: f64 = 0.5;
/// … and at least within so many times the faceting.
const LIMIT_FACETING: f64 = 3.0;

/// Distance up to which a place counts as covered: half the mean edge length of the coarser mesh, at least three times
/// the faceting. Target length units, for poses of this scale.
pub fn overlap_limit(source: &Surface, target: &Surface, scale: f64, allowance: f64) -> f64 {
    let pair = [source, target];
    let [edge, facets] = [coarser_edge(pair, scale), faceting(pair, scale)];
    (LIMIT_EDGES * edge).max(LIMIT_FACETING * facets) + allowance
}

/// Measures the nodes of both meshes under a pose: all of them up to 250,000, an even choice of a larger
/// mesh.
pub fn coverage(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
    monitor: &Monitor,
) -> Result<Coverage, Cancelled> {
    let measured = measured_both([source, target], target_from_source, monitor)?;
    Ok(Coverage::of(measured, limit))
}

/// A node with the place of the other part that is closest to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearNode {
    pub(super) node: u32,
    /// Of the other part.
    pub(super) triangle: u32,
    /// In target length units.
    pub(super) distance: f64,
}

/// Nodes of a part that lie near the other one.
#[derive(Debug, Clone, Default)]
pub(super) struct NearNodes {
    pub(super) nodes: Vec<NearNode>,
    /// How many nodes of the mesh each stands for.
    pub(super) per_node: usize,
}

/// [`coverage`] with the nodes of source and target that lie no farther apart than `reach`, in target length units.
pub(super) fn coverage_and_near(
    pair: [&Surface; 2],
    target_from_source: &Similarity,
    limit: f64,
    reach: f64,
    monitor: &Monitor,
) -> Result<(Coverage, [NearNodes; 2]), Cancelled> {
    let measured = measured_both(pair, target_from_source, monitor)?;
    let near = [0, 1].map(|side| NearNodes {
        nodes: near_of(&measured[side], reach),
        per_node: step_of(pair[side]),
    });
    Ok((Coverage::of(measured, limit), near))
}

/// Overlap of both directions, source first, from at most `n_points` nodes of each mesh: for a number that
/// follows the hand. About a millisecond for each thousand points.
pub fn quick_overlap(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
    n_points: usize,
) -> [f64; 2] {
    let back = target_from_source.inverse();
    let own_limit = limit / target_from_source.scale;
    let share = |data: &Surface, model: &Surface, pose: &Similarity, limit: f64| {
        let positions = data.mesh().positions();
        let (mut covered, mut total) = (0.0, 0.0);
        for node in data.even_nodes(n_points.max(1)).iter() {
            let moved = pose.apply(&positions[node.vertex as usize]);
            let hit = model.bvh().closest(&moved, limit, None, None);
            covered += hit.map_or(0.0, |_| node.area);
            total += node.area;
        }
        if total > 0.0 { covered / total } else { 0.0 }
    };
    [
        share(source, target, target_from_source, limit),
        share(target, source, &back, own_limit),
    ]
}

/// Nodes per question to the monitor.
const CHUNK: usize = 8192;
/// Neighbouring nodes that are asked one after the other, each near the answer of the one before.
const RUN: usize = 256;
/// Nodes of one mesh that are measured; more change no share by a thousandth.
const MOST_NODES: usize = 250_000;

/// A node that was measured.
#[derive(Debug, Clone, Copy)]
struct Measured {
    node: u32,
    /// The closest of the other part, if there is one.
    triangle: u32,
    /// From the other part, in target lengths.
    distance: f64,
    area: f64,
}

/// The nodes of source and target, each measured against the other part.
fn measured_both(
    [source, target]: [&Surface; 2],
    target_from_source: &Similarity,
    monitor: &Monitor,
) -> Result<[Vec<Measured>; 2], Cancelled> {
    let (back, scale) = (target_from_source.inverse(), target_from_source.scale);
    Ok([
        measured([source, target], (target_from_source, 1.0), monitor)?,
        measured([target, source], (&back, scale), monitor)?,
    ])
}

/// Of so many nodes of a mesh one is measured.
fn step_of(surface: &Surface) -> usize {
    let n_nodes = surface.mesh().positions().len();
    n_nodes.div_ceil(MOST_NODES).max(1)
}

/// `unit` turns distances measured in the model's frame into target lengths.
fn measured(
    [data, model]: [&Surface; 2],
    (model_from_data, unit): (&Similarity, f64),
    monitor: &Monitor,
) -> Result<Vec<Measured>, Cancelled> {
    let positions = data.mesh().positions();
    let nodes: Vec<usize> = (0..positions.len()).step_by(step_of(data)).collect();
    let distances = |run: &[usize]| {
        let mut near = None;
        let distance = |&node: &usize| {
            let moved = model_from_data.apply(&positions[node]);
            let hit = model.bvh().closest(&moved, f64::INFINITY, near, None);
            near = hit.map(|hit| hit.triangle);
            Measured {
                node: node as u32,
                triangle: near.unwrap_or(0),
                distance: hit.map_or(f64::INFINITY, |hit| hit.distance_sq.sqrt() * unit),
                area: data.vertex_areas()[node],
            }
        };
        run.iter().map(distance).collect::<Vec<_>>()
    };
    let mut measured: Vec<Measured> = Vec::with_capacity(nodes.len());
    for chunk in nodes.chunks(CHUNK) {
        monitor.check()?;
        let found: Vec<_> = chunk.par_chunks(RUN).map(distances).collect();
        measured.extend(found.into_iter().flatten());
    }
    Ok(measured)
}

fn near_of(measured: &[Measured], reach: f64) -> Vec<NearNode> {
    let near = measured.iter().filter(|m| m.distance <= reach);
    let nodes = near.map(|m| NearNode {
        node: m.node,
        triangle: m.triangle,
        distance: m.distance,
    });
    nodes.collect()
}

fn one_sided(mut measured: Vec<Measured>, limit: f64) -> OneSided {
    measured.par_sort_unstable_by(|a, b| {
        let by_distance = a.distance.total_cmp(&b.distance);
        by_distance.then(a.area.total_cmp(&b.area))
    });
    let total: f64 = measured.iter().map(|m| m.area).sum();
    let n_within = measured.partition_point(|m| m.distance <= limit);
    let within = &measured[..n_within];
    let covered: f64 = within.iter().map(|m| m.area).sum();
    let sum_sq: f64 = within
        .iter()
        .map(|m| m.distance * m.distance * m.area)
        .sum();
    let mut running = 0.0;
    let p95 = within.iter().find(|m| {
        running += m.area;
        running >= 0.95 * covered
    });
    OneSided {
        overlap: if total > 0.0 { covered / total } else { 0.0 },
        rmse: if covered > 0.0 {
            (sum_sq / covered).sqrt()
        } else {
            f64::INFINITY
        },
        p95: p95.map_or(f64::INFINITY, |m| m.distance),
        max: within.last().map_or(f64::INFINITY, |m| m.distance),
        max_anywhere: measured.last().map_or(0.0, |m| m.distance),
    }
}
