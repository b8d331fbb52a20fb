//! One ICP run: correspondences, rejection, selection, a step of the metric, until the rules end it.

use std::time::{Duration, Instant};

use super::correspondence::{Correspondence, Sample, correspond, correspond_on_grid};
use super::metric::step;
use super::select::{Selected, select};
use super::stages::StageRules;
use super::termination::Termination;
use crate::geometry::{Aabb, Matrix3, Point3, Rotation, Similarity};
use crate::monitor::Cancelled;
use crate::registration::observer::MatchMonitor;
use crate::registration::result::{IterationRecord, Side};
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// The smallest damping of a step, relative to the stiffness.
const MIN_DAMPING: f64 = 1e-9;
/// Where the search is near the pose, points so many times as far away as the farthest that was kept are
/// not looked for: they would not be kept either, and far questions are the expensive ones.
const KEPT_REACH: f64 = 4.0;
/// Damping is never raised above this.
const MAX_DAMPING: f64 = 1.0;

/// The points that are moved, as one stage sees them.
#[derive(Debug, Clone)]
pub(crate) struct Data {
    pub(crate) samples: Vec<Sample>,
    /// Corners of the box around the samples; a motion is measured by how far it moves them.
    pub(crate) corners: [Point3; 8],
}

impl Data {
    pub(crate) fn new(samples: Vec<Sample>) -> Self {
        let aabb = Aabb::of_points(samples.iter().map(|sample| &sample.point));
        Self {
            samples,
            corners: aabb.corners(),
        }
    }

    /// The same points with all normals reversed.
    pub(crate) fn flipped(&self) -> Self {
        let mut flipped = self.clone();
        for sample in &mut flipped.samples {
            sample.normal = -sample.normal;
        }
        flipped
    }
}

/// A pose on the way and what it is worth.
#[derive(Debug, Clone, Copy)]
struct Standing {
    model_from_data: Similarity,
    score: f64,
    fraction: f64,
    rmse: f64,
}

/// One run from one start, to be continued at will.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// Its number over the whole match, for iteration reports.
    pub(crate) start_idx: usize,
    pub(crate) model_from_data: Similarity,
    pub(crate) records: Vec<IterationRecord>,
    /// Objective of the last iteration; infinite before the first.
    pub(crate) score: f64,
    pub(crate) fraction: f64,
    pub(crate) rmse: f64,
    pub(crate) termination: Option<Termination>,
    /// Time the iterations took.
    pub(crate) took: Duration,
    stage_iterations: usize,
    /// The pose of the stage with the lowest score.
    best: Option<Standing>,
    damping: f64,
    /// Points farther away than this found no partner worth keeping in the last iteration.
    reach: f64,
    pairs: Vec<Correspondence>,
    kept: Vec<u32>,
}

impl Run {
    pub(crate) fn new(start_idx: usize, model_from_data: Similarity) -> Self {
        Self {
            start_idx,
            model_from_data,
            records: Vec::new(),
            score: f64::INFINITY,
            fraction: 0.0,
            rmse: f64::INFINITY,
            termination: None,
            took: Duration::ZERO,
            stage_iterations: 0,
            best: None,
            damping: MIN_DAMPING,
            reach: f64::INFINITY,
            pairs: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// Forgets what was measured in an earlier stage; pose and history stay.
    pub(crate) fn enter_stage(&mut self) {
        self.score = f64::INFINITY;
        self.termination = None;
        self.stage_iterations = 0;
        self.best = None;
        self.damping = MIN_DAMPING;
        self.reach = f64::INFINITY;
        self.pairs.clear();
        self.kept.clear();
    }

    /// Ends the run at the pose of its stage with the lowest score.
    pub(crate) fn end_at_best(&mut self) {
        let Some(best) = self.best else {
            return;
        };
        self.model_from_data = best.model_from_data;
        self.score = best.score;
        self.fraction = best.fraction;
        self.rmse = best.rmse;
        self.termination = Some(Termination::NoGain);
    }

    /// By how much the score fell over the last `n` iterations, negative where it rose; `None` if the stage
    /// is younger.
    pub(crate) fn gain(&self, n: usize) -> Option<f64> {
        let before = (self.stage_iterations > n).then(|| self.records.len() - 1 - n)?;
        Some(self.records[before].objective - self.score)
    }

    /// Distance below which 95 % of the kept pairs lie, by weight. Infinite before the first iteration.
    pub(crate) fn p95(&self) -> f64 {
        let total: f64 = self.kept_pairs().map(|pair| pair.weight).sum();
        let (mut weight, mut distance) = (0.0, f64::INFINITY);
        for pair in self.kept_pairs() {
            weight += pair.weight;
            distance = pair.distance_sq.sqrt();
            if weight >= 0.95 * total {
                break;
            }
        }
        distance
    }

    /// Distance that a share of all points of the last iteration, by weight, does not exceed; infinite
    /// where fewer found a partner.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        let mut sizes: Vec<(f64, f64)> = self
            .pairs
            .iter()
            .map(|pair| (pair.distance_sq, pair.weight))
            .collect();
        sizes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let total: f64 = sizes.iter().map(|(_, weight)| weight).sum();
        let mut below = 0.0;
        let found = sizes.iter().find(|(_, weight)| {
            below += weight;
            below >= share * total
        });
        found.map_or(f64::INFINITY, |(distance_sq, _)| distance_sq.sqrt())
    }

    /// Largest distance of a kept pair of the last iteration.
    fn farthest_kept(&self) -> f64 {
        let last = self.kept.last();
        last.map_or(f64::INFINITY, |&i| {
            self.pairs[i as usize].distance_sq.sqrt()
        })
    }

    /// The kept pairs of the last iteration, closest first, under the pose before its step.
    pub(crate) fn kept_pairs(&self) -> impl Iterator<Item = &Correspondence> + Clone {
        self.kept.iter().map(|&i| &self.pairs[i as usize])
    }
}

/// Where poses of a run lie in the caller's frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frames {
    /// Which mesh supplies the points; of the target's, poses are inverted for the outside.
    pub(crate) data_side: Side,
    /// What was done to the source before the match: a mirror, else the identity.
    pub(crate) mirror: Similarity,
}

impl Frames {
    /// The pose as the outside sees it.
    pub(crate) fn target_from_source(&self, model_from_data: &Similarity) -> Similarity {
        self.data_side.oriented(model_from_data).after(&self.mirror)
    }
}

/// What a run is advanced on: the data, model and rules of one stage.
#[derive(Clone, Copy)]
pub(crate) struct StageInput<'a> {
    pub(crate) data: &'a Data,
    pub(crate) model: &'a Surface,
    pub(crate) rules: &'a StageRules,
    pub(crate) frames: &'a Frames,
    /// The model as a grid, where that is exact enough.
    pub(crate) grid: Option<&'a FeatureGrid>,
}

/// Continues `run` for at most `n_iterations`, until the rules of its stage end it. A stop request
/// ends it with the pose it has.
pub(crate) fn advance(
    run: &mut Run,
    input: &StageInput<'_>,
    n_iterations: usize,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    let begin = Instant::now();
    for _ in 0..n_iterations {
        if run.termination.is_some() {
            break;
        }
        monitor.check()?;
        if monitor.stop_requested() && run.score.is_finite() {
            run.termination = Some(Termination::Stopped);
            break;
        }
        iterate(run, input, monitor)?;
    }
    run.took += begin.elapsed();
    Ok(())
}

/// One iteration: pair and reject, select, record, solve, move, converged?
fn iterate(
    run: &mut Run,
    input: &StageInput<'_>,
    monitor: &MatchMonitor<'_>,
) -> Result<(), Cancelled> {
    let StageInput {
        data, model, rules, ..
    } = *input;
    let pose = run.model_from_data;
    run.pairs = match input.grid {
        Some(grid) => correspond_on_grid(&data.samples, grid, &pose, rules.matching.reject.min_cos),
        // The pairs of the last iteration are hints: most points stay with their triangle.
        None => {
            let mut matching = rules.matching;
            matching.reject.max_distance = matching.reject.max_distance.min(run.reach);
            let samples = &data.samples;
            correspond(
                samples,
                model,
                &pose,
                &matching,
                &run.pairs,
                monitor.monitor,
            )?
        }
    };
    let Some(selected) = select(&run.pairs, &rules.selection) else {
        run.termination = Some(Termination::NoPairs);
        return Ok(());
    };
    record(run, &selected, input, monitor);
    let increment = step(&run.pairs, &selected.kept, &rules.step, run.damping);
    run.kept = selected.kept;
    if let Some(least) = rules.least_reach {
        run.reach = (KEPT_REACH * run.farthest_kept()).max(least);
    }
    let Some(increment) = increment else {
        run.termination = Some(Termination::Degenerate);
        return Ok(());
    };
    run.model_from_data = orthonormal(&increment.after(&pose));
    let motion = run.model_from_data.max_displacement(&pose, &data.corners);
    let tolerance = rules
        .motion_tolerance
        .max(rules.tolerance_of_rmse * run.rmse);
    if motion <= tolerance {
        run.termination = Some(Termination::Converged);
    } else if run.stage_iterations >= rules.max_iterations {
        run.termination = Some(Termination::MaxIterations);
    }
    Ok(())
}

/// Notes what the present pose is worth, and reports it. The score before decides how far the next
/// step is damped.
fn record(run: &mut Run, selected: &Selected, input: &StageInput<'_>, monitor: &MatchMonitor<'_>) {
    adapt_damping(run, selected);
    run.score = selected.objective;
    run.fraction = selected.fraction;
    run.rmse = selected.mse.sqrt();
    if run.best.is_none_or(|best| run.score < best.score) {
        run.best = Some(Standing {
            model_from_data: run.model_from_data,
            score: run.score,
            fraction: run.fraction,
            rmse: run.rmse,
        });
    }
    let record = IterationRecord {
        stage: input.rules.stage,
        target_from_source: input.frames.target_from_source(&run.model_from_data),
        objective: run.score,
        rmse: run.rmse,
        fraction: run.fraction,
    };
    monitor.iteration(run.start_idx, run.records.len(), &record);
    run.records.push(record);
    run.stage_iterations += 1;
}

/// Levenberg–Marquardt: a step that made things worse was too bold.
fn adapt_damping(run: &mut Run, selected: &Selected) {
    run.damping = if selected.objective > run.score * (1.0 + 1e-6) {
        (run.damping.max(1e-4) * 10.0).min(MAX_DAMPING)
    } else {
        (run.damping / 10.0).max(MIN_DAMPING)
    };
}

/// The same motion with its rotation made orthonormal again, so that rounding does not pile up.
pub(crate) fn orthonormal(motion: &Similarity) -> Similarity {
    let sign = motion.rotation.determinant().signum();
    let proper: Matrix3 = motion.rotation * sign;
    let unchecked = nalgebra::Rotation3::from_matrix_unchecked(proper);
    let rotation = Rotation::from_rotation_matrix(&unchecked);
    let rotation = Rotation::new_normalize(rotation.into_inner());
    Similarity {
        rotation: *rotation.to_rotation_matrix().matrix() * sign,
        ..*motion
    }
}
