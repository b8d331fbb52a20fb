//! Closest points for many queries.

use rayon::prelude::*;

use super::{ClosestPoint, NormalFilter, SurfaceHit};
use crate::geometry::{Point3, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Queries per piece of parallel work.
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
/// as long as `queries`. Queries that follow each other should lie near each other, which keeps the
/// cache warm. Asks `monitor` once per 1024 queries.
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
