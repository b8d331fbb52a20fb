//! The rounds of the search: all poses make steps, the better and distinct ones go on.

use rayon::prelude::*;

use super::BLOCK;
use super::cloud::{Cloud, Motion32};
use super::step::{Reach, loss, step};
use crate::monitor::{Cancelled, Monitor};
use crate::search::FeatureGrid;

/// A stretch of the search at whose end the better poses go on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round {
    /// Distance beyond which a pair does not count, as a share of the reach of the first round.
    pub(super) cut: f32,
    pub(super) n_points: usize,
    pub(super) n_steps: usize,
    /// Share of the poses that goes on …
    pub(super) keep: f32,
    /// … at least so many …
    pub(super) least: usize,
    /// … and at most so many.
    pub(super) most: usize,
}

/// A first pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct First {
    /// True if the data's normals count reversed.
    pub(super) flipped: bool,
    pub(super) motion: Motion32,
}

/// A pose on its way through the rounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriedPose {
    pub(super) seed: u32,
    pub(super) flipped: bool,
    pub(super) motion: Motion32,
    pub(super) loss: f32,
}

/// Poses nearer than this in turn (3° as its cosine) and way of the centroid, as a share of the
/// data's diagonal, are one.
const SAME_COS: f32 = 0.998_6;
const SAME_SHIFT: f32 = 0.02;
/// Poses moved by one thread at a time at most.
const CHUNK: usize = 16;
/// Few poses are shared out in about so many chunks, so that no thread is left without one.
const LEAST_CHUNKS: usize = 16;

/// The surfaces of a search.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a> {
    pub(super) cloud: &'a Cloud,
    pub(super) grid: &'a FeatureGrid,
    /// Largest distance of a pair in the first round, in grid units.
    pub(super) reach: f32,
}

/// Runs all first poses through `rounds`; the distinct survivors come out best first. After a stop request
/// what has been reached is returned.
pub(super) fn run(
    ground: Ground<'_>,
    first: impl Iterator<Item = First>,
    rounds: &[Round],
    monitor: &Monitor,
) -> Result<Vec<TriedPose>, Cancelled> {
    let mut field: Vec<TriedPose> = first
        .zip(0..)
        .map(|(first, index)| TriedPose {
            seed: index,
            flipped: first.flipped,
            motion: first.motion,
            loss: 1.0,
        })
        .collect();
    for (index, round) in rounds.iter().enumerate() {
        monitor.progress("wide search", index as u64, Some(rounds.len() as u64));
        let chunk = (field.len() / LEAST_CHUNKS).clamp(1, CHUNK);
        field.par_chunks_mut(chunk).try_for_each(|candidates| {
            monitor.check()?;
            for candidate in candidates {
                if !monitor.stop_requested() {
                    advance(candidate, ground, round);
                }
            }
            Ok(())
        })?;
        field.sort_unstable_by(|a, b| a.loss.total_cmp(&b.loss).then(a.seed.cmp(&b.seed)));
        let keep = (field.len() as f32 * round.keep).ceil() as usize;
        let keep = keep.clamp(round.least, round.most);
        field = distinct(field, keep, SAME_SHIFT * ground.cloud.diagonal);
    }
    Ok(field)
}

fn advance(candidate: &mut TriedPose, ground: Ground<'_>, round: &Round) {
    let Ground { cloud, grid, reach } = ground;
    let n_blocks = round.n_points.div_ceil(BLOCK).min(cloud.blocks.len());
    let sign = if candidate.flipped { -1.0 } else { 1.0 };
    let reach = Reach {
        cut: round.cut * reach,
        slack: grid.cell(),
    };
    for _ in 0..round.n_steps {
        let moved = step(cloud, n_blocks, grid, (&candidate.motion, sign), reach);
        let Some(moved) = moved else {
            break;
        };
        candidate.motion = moved;
    }
    candidate.loss = loss(cloud, n_blocks, grid, (&candidate.motion, sign), reach);
}

/// The first `keep` of `sorted` that do not lie near a better one.
fn distinct(sorted: Vec<TriedPose>, keep: usize, max_shift: f32) -> Vec<TriedPose> {
    let mut kept: Vec<TriedPose> = Vec::with_capacity(keep);
    for candidate in sorted {
        if kept.len() == keep {
            break;
        }
        let is_known = kept.iter().any(|better| {
            candidate
                .motion
                .is_near(&better.motion, SAME_COS, max_shift)
        });
        if !is_known {
            kept.push(candidate);
        }
    }
    kept
}
