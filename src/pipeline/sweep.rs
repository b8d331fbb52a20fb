//! The two tables of the paper, measured: reduction over levels, matching over levels.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::load::LoadedPart;
use super::match_parts::{MatchRecipe, ReducedPair, match_parts};
use super::reduce::Levels;
use super::{PipelineError, millis_since};
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::registration::MatchSettings;
use crate::role::PerRole;
use crate::simplify::SimplifySettings;

/// Table 1 of the paper: 34,808 triangles reduced to so many took so many milliseconds.
pub const PAPER_REDUCTION: [(usize, f64); 4] = [
    (20_000, 1359.0),
    (10_000, 1406.0),
    (1_000, 1406.0),
    (100, 1469.0),
];

/// Table 2 of the paper: nine starts matched at so many triangles took so many milliseconds.
pub const PAPER_MATCHING: [(usize, f64); 4] = [
    (10_000, 117_359.0),
    (5_000, 26_328.0),
    (1_000, 1_015.0),
    (500, 531.0),
];

/// What to sweep over.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepSettings {
    /// Maxima of the reduction, in the order of the table.
    pub reduction: Vec<usize>,
    /// Maxima at which is matched; the full meshes follow.
    pub matching: Vec<usize>,
    /// The settings of every match.
    pub settings: MatchSettings,
    /// Each time is the smallest of so many runs.
    pub n_repeats: usize,
}

impl Default for SweepSettings {
    fn default() -> Self {
        Self {
            reduction: PAPER_REDUCTION.map(|(n, _)| n).to_vec(),
            matching: PAPER_MATCHING.map(|(n, _)| n).to_vec(),
            settings: nine_starts(),
            n_repeats: 3,
        }
    }
}

/// The paper's starts, with both directions of the normal: never more than these, so that the
/// times of all levels compare.
fn nine_starts() -> MatchSettings {
    let mut settings = MatchSettings::default();
    settings.starts.wide_search = false;
    settings
}

/// One row of the reduction table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReductionRow {
    /// The maximum asked for.
    pub max_triangles: usize,
    /// Triangles that were left.
    pub triangles: usize,
    /// Time of a reduction from full to this level, in milliseconds.
    pub time_ms: f64,
    /// Measured deviation, both ways.
    pub rms: f64,
    /// Largest measured deviation, both ways.
    pub max: f64,
    /// Largest movement of a border.
    pub border_max: f64,
    /// Border loops kept.
    pub loops: usize,
    /// The paper's time in milliseconds, if its table has this level.
    pub paper_ms: Option<f64>,
}

/// One row of the matching table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MatchingRow {
    /// The maximum both parts were reduced to; `None` for the full meshes.
    pub max_triangles: Option<usize>,
    /// The pose that was found on the reduced meshes alone.
    pub crash_from_stamped: Similarity,
    /// Triangles of both meshes.
    #[serde(serialize_with = "PerRole::as_list")]
    pub triangles: PerRole<usize>,
    /// Time of the match on the reduced meshes alone, trees included, in milliseconds.
    pub time_ms: f64,
    /// How far the pose puts the stamped nodes from the reference, root mean square.
    pub node_rms: f64,
    /// The same for the worst node.
    pub node_max: f64,
    /// Time with the finish on the full meshes and the independent check, in milliseconds.
    pub finished_ms: f64,
    /// Root mean square node distance of the finished pose from the reference.
    pub finished_node_rms: f64,
    /// The paper's time in milliseconds, if its table has this level.
    pub paper_ms: Option<f64>,
}

/// A row that is ready, reported at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SweepRow {
    /// Of the reduction table.
    Reduction(ReductionRow),
    /// Of the matching table.
    Matching(MatchingRow),
}

/// Tables of the benchmark.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Sweep {
    /// Triangles of the stamped part before reduction.
    pub n_triangles: usize,
    /// Reduction of the stamped part.
    pub reduction: Vec<ReductionRow>,
    /// Matching of both parts.
    pub matching: Vec<MatchingRow>,
    /// True if node distances are from a known pose; false if from the result on the full meshes.
    pub has_truth: bool,
}

impl Sweep {
    /// Puts a row into its table.
    pub fn push(&mut self, row: SweepRow) {
        match row {
            SweepRow::Reduction(row) => self.reduction.push(row),
            SweepRow::Matching(row) => self.matching.push(row),
        }
    }
}

/// Measures both tables. Node distances are taken from `truth`, or, where no pose is known, from the
/// match on the full meshes. A stop request ends after the row at work.
pub fn sweep(
    parts: PerRole<&LoadedPart>,
    truth: Option<&Similarity>,
    settings: &SweepSettings,
    monitor: &Monitor,
    mut tell: impl FnMut(SweepRow),
) -> Result<Sweep, PipelineError> {
    let mut tables = Sweep {
        n_triangles: parts.stamped.mesh.n_triangles(),
        has_truth: truth.is_some(),
        ..Sweep::default()
    };
    for &max_triangles in &settings.reduction {
        if monitor.stop_requested() {
            return Ok(tables);
        }
        let row = reduction_row(parts.stamped, max_triangles, settings.n_repeats, monitor)?;
        monitor.check()?;
        tell(SweepRow::Reduction(row));
        tables.reduction.push(row);
    }
    let reference = match truth {
        Some(truth) => *truth,
        None => full_pose(parts, settings, monitor)?,
    };
    let sizes = settings.matching.iter().map(|&n| Some(n)).chain([None]);
    for max_triangles in sizes {
        if monitor.stop_requested() {
            return Ok(tables);
        }
        let row = matching_row(parts, max_triangles, &reference, settings, monitor)?;
        monitor.check()?;
        tell(SweepRow::Matching(row));
        tables.matching.push(row);
    }
    Ok(tables)
}

fn reduction_row(
    stamped: &LoadedPart,
    max_triangles: usize,
    n_repeats: usize,
    monitor: &Monitor,
) -> Result<ReductionRow, PipelineError> {
    let settings = SimplifySettings::to_triangles(max_triangles);
    let mut levels = Levels::record(stamped, &settings, monitor)?;
    let mut time_ms = levels.record_ms;
    for _ in 1..n_repeats {
        levels = Levels::record(stamped, &settings, monitor)?;
        time_ms = time_ms.min(levels.record_ms);
    }
    let mesh = levels.level(max_triangles, monitor)?.mesh;
    let deviation = levels.measure(&mesh, monitor)?;
    Ok(ReductionRow {
        max_triangles,
        triangles: mesh.n_triangles(),
        time_ms,
        rms: deviation.rms,
        max: deviation.max,
        border_max: deviation.border_max,
        loops: deviation.loops_after,
        paper_ms: paper_time(&PAPER_REDUCTION, max_triangles),
    })
}

fn full_pose(
    parts: PerRole<&LoadedPart>,
    settings: &SweepSettings,
    monitor: &Monitor,
) -> Result<Similarity, PipelineError> {
    let recipe = MatchRecipe {
        settings: settings.settings.clone(),
        max_triangles: None,
    };
    let run = match_parts(parts, None, &recipe, &Similarity::identity(), monitor)?;
    Ok(run.crash_from_stamped)
}

fn matching_row(
    parts: PerRole<&LoadedPart>,
    max_triangles: Option<usize>,
    reference: &Similarity,
    settings: &SweepSettings,
    monitor: &Monitor,
) -> Result<MatchingRow, PipelineError> {
    let pair = max_triangles
        .map(|n| ReducedPair::new(parts, PerRole::both(Some(n)), monitor))
        .transpose()?;
    let run = |finish: bool| {
        let mut settings = settings.settings.clone();
        settings.refine_on_full = finish || max_triangles.is_none();
        let recipe = MatchRecipe {
            settings,
            max_triangles: None,
        };
        let start = Instant::now();
        let identity = Similarity::identity();
        let run = match_parts(parts, pair.as_ref(), &recipe, &identity, monitor)?;
        let total_ms = millis_since(start);
        Ok::<_, PipelineError>((run, total_ms))
    };
    let (mut searched, mut finished) = (run(false)?, run(true)?);
    let without_check =
        |run: &super::match_parts::MatchRun| run.times.align_ms + run.times.match_ms;
    let mut time_ms = without_check(&searched.0);
    for _ in 1..settings.n_repeats {
        searched = run(false)?;
        time_ms = time_ms.min(without_check(&searched.0));
        let again = run(true)?;
        if again.1 < finished.1 {
            finished = again;
        }
    }
    let (node_rms, node_max) = node_distance(
        &parts.stamped.mesh,
        &searched.0.crash_from_stamped,
        reference,
    );
    let (finished_node_rms, _) = node_distance(
        &parts.stamped.mesh,
        &finished.0.crash_from_stamped,
        reference,
    );
    Ok(MatchingRow {
        max_triangles,
        crash_from_stamped: searched.0.crash_from_stamped,
        triangles: searched.0.n_triangles,
        time_ms,
        node_rms,
        node_max,
        finished_ms: finished.1,
        finished_node_rms,
        paper_ms: max_triangles.and_then(|n| paper_time(&PAPER_MATCHING, n)),
    })
}

/// Root mean square and largest distance between the images of the vertices under both motions.
pub fn node_distance(mesh: &TriMesh, a: &Similarity, b: &Similarity) -> (f64, f64) {
    let (mut sum_sq, mut max) = (0.0, 0.0_f64);
    for point in mesh.positions() {
        let distance = (a.apply(point) - b.apply(point)).norm();
        sum_sq += distance * distance;
        max = max.max(distance);
    }
    ((sum_sq / mesh.n_vertices().max(1) as f64).sqrt(), max)
}

fn paper_time(table: &[(usize, f64)], n: usize) -> Option<f64> {
    table
        .iter()
        .find(|(triangles, _)| *triangles == n)
        .map(|(_, ms)| *ms)
}
