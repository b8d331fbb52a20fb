//! Closest points for many queries.

use rayon::prelude::*;

use super::{ClosestPoint, SurfaceHit};
use crate::geometry::Point3;
use crate::monitor::{Cancelled, Monitor};

/// Queries per piece of parallel work.
const CHUNK: usize = 1024;

/// Closest points for many queries, on all threads. The answers are those of single calls.
///
/// Queries that follow each other should lie near each other, which keeps the cache warm. Asks `monitor` once per 1024
/// queries.
pub fn closest_many(
    target: &(impl ClosestPoint + ?Sized),
    queries: &[Point3],
    max_distance: f64,
    monitor: &Monitor,
) -> Result<Vec<Option<SurfaceHit>>, Cancelled> {
    let mut answers = vec![None; queries.len()];
    answers
        .par_chunks_mut(CHUNK)
        .zip(queries.par_chunks(CHUNK))
        .try_for_each(|(answers, queries)| {
            monitor.check()?;
            for (slot, query) in answers.iter_mut().zip(queries) {
                *slot = target.closest(query, max_distance, None, None);
            }
            Ok(())
        })?;
    Ok(answers)
}
