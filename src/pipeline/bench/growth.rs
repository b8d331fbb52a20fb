//! How the time of a match grows with the triangles: one part meshed finer and finer, prepared and matched.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use crate::assess::Verdict;
use crate::formats::Model;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadSettings, LoadedPart, prepare};
use crate::pipeline::match_parts::{MatchRecipe, match_parts};
use crate::pipeline::{PipelineError, millis_since};
use crate::role::PerRole;
use crate::samples::{SamplePart, SampleSettings, generate};

/// Triangles of both meshes together that are aimed at.
const SIZES: [f64; 8] = [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6, 2e6];
/// Triangles of the floor times the square of the edge length that was asked for, of each mesh.
const FLOOR_CRASH: f64 = 2.8e6;
const FLOOR_STAMPED: f64 = 2.5e7;
/// Times that small pairs are measured; the shortest time counts.
const REPEATS: usize = 3;
/// Pairs of more triangles are measured once.
const LARGE: usize = 400_000;

/// One pair of meshes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GrowthRow {
    /// Triangles of both meshes together.
    pub triangles: usize,
    /// Weld, topology, normals and trees of both meshes, both at the same time as when files are loaded.
    pub prepare_ms: f64,
    /// The match itself: search, finish on the full meshes, assessment.
    pub match_ms: f64,
    /// What the assessment said.
    pub verdict: Verdict,
    /// How far the worst stamped node lies from the known pose, in millimetres.
    pub node_error: f64,
}

/// The times of all sizes, and how they grow.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GrowthTable {
    /// What the record is.
    pub schema: &'static str,
    /// Threads that were used.
    pub threads: usize,
    /// One row for each size, the smallest first.
    pub rows: Vec<GrowthRow>,
    /// p of time ∝ trianglesᵖ, fitted to the times of the match; `None` for fewer than two sizes.
    pub match_exponent: Option<f64>,
    /// The same of preparing.
    pub prepare_exponent: Option<f64>,
}

/// Prepares and matches the generated floor at all sizes up to `largest` triangles of both meshes
/// together. `told` hears of every row.
pub fn growth(
    largest: usize,
    monitor: &Monitor,
    mut told: impl FnMut(&GrowthRow),
) -> Result<GrowthTable, PipelineError> {
    let mut rows = Vec::new();
    for size in SIZES {
        let Some(row) = row(size, largest, monitor)? else {
            break;
        };
        told(&row);
        rows.push(row);
    }
    Ok(GrowthTable {
        schema: "shapematch.growth/1",
        threads: rayon::current_num_threads(),
        match_exponent: exponent(rows.iter().map(|row| (row.triangles, row.match_ms))),
        prepare_exponent: exponent(rows.iter().map(|row| (row.triangles, row.prepare_ms))),
        rows,
    })
}

/// `None` for a pair of more than `largest` triangles.
fn row(size: f64, largest: usize, monitor: &Monitor) -> Result<Option<GrowthRow>, PipelineError> {
    let half = 0.5 * size;
    let pair = generate(&SampleSettings {
        part: SamplePart::Floor,
        seed: 1,
        crash_size: Some((FLOOR_CRASH / half).sqrt()),
        stamped_size: Some((FLOOR_STAMPED / half).sqrt()),
        ..SampleSettings::default()
    });
    let meshes = PerRole::new(&pair.crash, &pair.stamped).map(|mesh| mesh.to_trimesh());
    if meshes.crash.n_triangles() + meshes.stamped.n_triangles() > largest {
        return Ok(None);
    }
    let models = meshes.map(|mesh| Arc::new(Model::from_mesh(&mesh, "floor")));
    let mut best: Option<GrowthRow> = None;
    for _ in 0..REPEATS {
        let begin = Instant::now();
        let parts = prepared(&models, monitor)?;
        let prepare_ms = millis_since(begin);
        let recipe = MatchRecipe::default();
        let still = Similarity::identity();
        let run = match_parts(parts.as_ref(), None, &recipe, &still, monitor)?;
        let nodes = parts.stamped.mesh.positions();
        let truth = &pair.crash_from_stamped;
        let new = GrowthRow {
            triangles: parts.crash.mesh.n_triangles() + parts.stamped.mesh.n_triangles(),
            prepare_ms: best
                .as_ref()
                .map_or(prepare_ms, |row| prepare_ms.min(row.prepare_ms)),
            match_ms: best.as_ref().map_or(run.times.total_ms, |row| {
                run.times.total_ms.min(row.match_ms)
            }),
            verdict: run.assessment.verdict,
            node_error: run.crash_from_stamped.max_displacement(truth, nodes),
        };
        let is_large = new.triangles > LARGE;
        best = Some(new);
        if is_large {
            break;
        }
    }
    Ok(best)
}

fn prepared(
    models: &PerRole<Arc<Model>>,
    monitor: &Monitor,
) -> Result<PerRole<LoadedPart>, PipelineError> {
    let settings = LoadSettings::default();
    let one = |name: &str, model: &Arc<Model>| {
        prepare(Path::new(name), Arc::clone(model), &settings, monitor)
    };
    let (crash, stamped) = rayon::join(
        || one("crash", &models.crash),
        || one("stamped", &models.stamped),
    );
    Ok(PerRole::new(crash?, stamped?))
}

/// The slope of ln y over ln x, in least squares.
pub fn exponent(points: impl Iterator<Item = (usize, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points.map(|(n, ms)| ((n as f64).ln(), ms.ln())).collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let above: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let below: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    (below > 0.0).then(|| above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_powers() {
        let of = |power: f64| {
            let points = [1000, 4000, 50_000].map(|n| (n, 0.3 * (n as f64).powf(power)));
            exponent(points.into_iter()).unwrap()
        };
        for power in [0.0, 0.5, 1.0] {
            assert!((of(power) - power).abs() < 1e-12);
        }
        assert_eq!(exponent([(10, 1.0)].into_iter()), None);
    }
}
