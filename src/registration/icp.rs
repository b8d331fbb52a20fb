use std::time::{Duration, Instant};

use super::correspondence::{Correspondence, MatchRules, Sample, correspond};
use super::metric::{StepRules, step};
use super::result::{IterationRecord, Side};
use super::select::{SelectRules, Selected, select};
use super::surface::Surface;
use super::termination::Termination;
use crate::geometry::{Aabb, Matrix3, Point3, Rotation, Similarity};
use crate::monitor::{Cancelled, Monitor};

/// The smallest damping of a step, relative to the stiffness.
const MIN_DAMPING: f64 = 1e-9;
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

/// Everything that distinguishes one ICP stage from another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StageRules {
    pub(crate) name: &'static str,
    pub(crate) matching: MatchRules,
    pub(crate) selection: SelectRules,
    pub(crate) step: StepRules,
    /// Stop when a step moves no corner by more than this.
    pub(crate) motion_tolerance: f64,
    pub(crate) max_iterations: usize,
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
    damping: f64,
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
            damping: MIN_DAMPING,
            pairs: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// Forgets what was measured in an earlier stage; pose and history stay.
    pub(crate) fn enter_stage(&mut self) {
        self.score = f64::INFINITY;
        self.termination = None;
        self.stage_iterations = 0;
        self.damping = MIN_DAMPING;
        self.pairs.clear();
        self.kept.clear();
    }

    /// Distance below which 95 % of the kept pairs lie, by weight, and the largest.
    pub(crate) fn spread(&self) -> (f64, f64) {
        let total: f64 = self.kept_pairs().map(|pair| pair.weight).sum();
        let mut weight = 0.0;
        let mut p95 = None;
        let mut largest = 0.0;
        for pair in self.kept_pairs() {
            weight += pair.weight;
            largest = pair.distance_sq.sqrt();
            if p95.is_none() && weight >= 0.95 * total {
                p95 = Some(largest);
            }
        }
        (p95.unwrap_or(largest), largest)
    }

    /// The kept pairs of the last iteration, closest first, under the pose before its step.
    pub(crate) fn kept_pairs(&self) -> impl Iterator<Item = &Correspondence> + Clone {
        self.kept.iter().map(|&i| &self.pairs[i as usize])
    }
}

/// Where poses of a run lie in the caller's frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frames {
    /// True if the data is the target mesh, so that poses are inverted for the outside.
    pub(crate) data_is_target: bool,
    /// What was done to the source before the match: a mirror, else the identity.
    pub(crate) mirror: Similarity,
}

impl Frames {
    /// Which mesh supplies the points.
    pub(crate) fn data_side(&self) -> Side {
        if self.data_is_target {
            Side::Target
        } else {
            Side::Source
        }
    }

    /// The pose as the outside sees it.
    pub(crate) fn target_from_source(&self, model_from_data: &Similarity) -> Similarity {
        if self.data_is_target {
            // The model is then the source, mirrored or not.
            model_from_data.inverse().after(&self.mirror)
        } else {
            model_from_data.after(&self.mirror)
        }
    }
}

/// Continues `run` for at most `n_iterations`, until its stage's rules end it.
///
/// Each iteration: match, reject, select, record, solve, move, settled? A stop request ends the
/// run with the pose it has.
pub(crate) fn advance(
    run: &mut Run,
    data: &Data,
    (model, rules): (&Surface, &StageRules),
    n_iterations: usize,
    frames: &Frames,
    monitor: &Monitor,
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
        iterate(run, data, model, rules, frames, monitor);
    }
    run.took += begin.elapsed();
    Ok(())
}

fn iterate(
    run: &mut Run,
    data: &Data,
    model: &Surface,
    rules: &StageRules,
    frames: &Frames,
    monitor: &Monitor,
) {
    let pairs = correspond(
        &data.samples,
        model,
        &run.model_from_data,
        &rules.matching,
        &run.pairs,
    );
    run.pairs = pairs;
    let Some(selected) = select(&run.pairs, &rules.selection) else {
        run.termination = Some(Termination::NoPairs);
        return;
    };
    adapt_damping(run, &selected);
    run.score = selected.objective;
    run.fraction = selected.fraction;
    run.rmse = selected.mse.sqrt();
    let record = IterationRecord {
        stage: rules.name,
        target_from_source: frames.target_from_source(&run.model_from_data),
        objective: run.score,
        rmse: run.rmse,
        fraction: run.fraction,
    };
    monitor.iteration(&record.report(run.start_idx, run.records.len()));
    run.records.push(record);
    run.stage_iterations += 1;
    let step_rules = StepRules {
        damping: run.damping,
        ..rules.step
    };
    let increment = step(&run.pairs, &selected.kept, &step_rules);
    run.kept = selected.kept;
    let Some(increment) = increment else {
        run.termination = Some(Termination::Degenerate);
        return;
    };
    let moved = orthonormal(&increment.after(&run.model_from_data));
    let motion = moved.max_displacement(&run.model_from_data, &data.corners);
    run.model_from_data = moved;
    if motion <= rules.motion_tolerance {
        run.termination = Some(Termination::Converged);
    } else if run.stage_iterations >= rules.max_iterations {
        run.termination = Some(Termination::MaxIterations);
    }
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
