//! Distances of many points from a surface.

use rayon::prelude::*;

use super::{ClosestPoint, NormalFilter, SurfaceHit};
use crate::geometry::{Point3, SurfaceSample, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Queries per piece of parallel work. Fixed, so that sums do not depend on the thread count.
const CHUNK: usize = 1024;

/// What holds for all queries of one call of [`closest_many`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchLimits {
    /// Largest distance that counts; may be infinite.
    pub max_distance: f64,
    /// Cosine for a [`NormalFilter`] along each query's own direction; `None` to let all normals
    /// count.
    pub min_cos: Option<f64>,
}

/// Closest points for many queries, on all threads. The answers are those of single calls.
///
/// `directions` gives the unit normals at the queries and is used with `min_cos` only; `hints`
/// gives probable triangles, such as those of the last iteration. Either may be empty, or must be
/// as long as `queries`. Queries that follow each other should lie near each other, as those of
/// [`crate::geometry::sample_surface`] do. Asks `monitor` once per 1024 queries.
pub fn closest_many(
    target: &(impl ClosestPoint + ?Sized),
    queries: &[Point3],
    directions: &[Vector3],
    hints: &[Option<u32>],
    limits: SearchLimits,
    monitor: &Monitor,
) -> Result<Vec<Option<SurfaceHit>>, Cancelled> {
    let answer = |i: usize| {
        let filter = limits
            .min_cos
            .zip(directions.get(i))
            .map(|(min_cos, &direction)| NormalFilter { direction, min_cos });
        let hint = hints.get(i).copied().flatten();
        target.closest(&queries[i], limits.max_distance, hint, filter.as_ref())
    };
    let mut answers = vec![None; queries.len()];
    answers
        .par_chunks_mut(CHUNK)
        .enumerate()
        .try_for_each(|(chunk, answers)| {
            monitor.check()?;
            for (i, slot) in answers.iter_mut().enumerate() {
                *slot = answer(chunk * CHUNK + i);
            }
            Ok(())
        })?;
    Ok(answers)
}

/// How far samples of one surface lie from another, each counting with its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceStats {
    /// Root mean square distance.
    pub rms: f64,
    /// Mean distance over the area.
    pub mean: f64,
    /// The distance that 95 % of the area does not exceed.
    pub p95: f64,
    /// Largest distance, which samples can only find from below.
    pub max: f64,
    /// Number of samples.
    pub n: usize,
}

/// Distances of samples from a surface (one side of a Hausdorff-like comparison, as in Metro,
/// Cignoni et al. 1998), on all threads. `None` if there are no samples or no surface.
///
/// For both sides, call it with the surfaces exchanged.
pub fn surface_distance(
    samples: &[SurfaceSample],
    target: &(impl ClosestPoint + ?Sized),
    monitor: &Monitor,
) -> Result<Option<DistanceStats>, Cancelled> {
    let points: Vec<Point3> = samples.iter().map(|sample| sample.point).collect();
    let limits = SearchLimits {
        max_distance: f64::INFINITY,
        min_cos: None,
    };
    let hits = closest_many(target, &points, &[], &[], limits, monitor)?;
    let mut distances: Vec<(f64, f64)> = samples
        .iter()
        .zip(hits)
        .filter_map(|(sample, hit)| Some((hit?.distance_sq.sqrt(), sample.area)))
        .collect();
    distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(max, _)) = distances.last() else {
        return Ok(None);
    };
    let total: f64 = distances.iter().map(|(_, area)| area).sum();
    let weighted =
        |of: fn(f64) -> f64| distances.iter().map(|&(d, area)| of(d) * area).sum::<f64>() / total;
    let mut below = 0.0;
    let p95 = distances.iter().find(|(_, area)| {
        below += area;
        below >= 0.95 * total
    });
    Ok(Some(DistanceStats {
        rms: weighted(|d| d * d).sqrt(),
        mean: weighted(|d| d),
        p95: p95.map_or(max, |&(d, _)| d),
        max,
        n: distances.len(),
    }))
}
