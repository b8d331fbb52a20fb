use super::{
    JobKind, JobOutput, MeasureLevelInput, MeasuredLevel, PartFacts, PartSource, Recording,
    ReduceInput, Role,
};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::PipelineError;
use crate::pipeline::load::{self, LoadedPart};
use crate::pipeline::reduce::Levels;
use crate::simplify::SimplifySettings;
use std::sync::{Arc, OnceLock};

/// How a job ended without a result.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JobError {
    /// It was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It could not be done; the message is for the user.
    #[error("{0}")]
    Failed(String),
}

impl From<PipelineError> for JobError {
    fn from(error: PipelineError) -> Self {
        if error.is_cancelled() {
            Self::Cancelled(Cancelled)
        } else {
            Self::Failed(error.to_string())
        }
    }
}

/// Does the work of a job. The window uses [`PipelineRunner`]; tests bring their own.
pub trait Runner: Send + 'static {
    /// Runs one job to its end; asks `monitor` once per chunk.
    fn run(&mut self, kind: JobKind, monitor: &Monitor) -> Result<JobOutput, JobError>;
}

impl<F> Runner for F
where
    F: FnMut(JobKind, &Monitor) -> Result<JobOutput, JobError> + Send + 'static,
{
    fn run(&mut self, kind: JobKind, monitor: &Monitor) -> Result<JobOutput, JobError> {
        self(kind, monitor)
    }
}

/// The real thing: hands every job to its stage of [`crate::pipeline`].
#[derive(Debug, Clone, Copy, Default)]
pub struct PipelineRunner;

/// Every recording goes at least so far down, so that the slider never has to record again.
const RECORD_DOWN_TO: usize = 200;

impl Runner for PipelineRunner {
    fn run(&mut self, kind: JobKind, monitor: &Monitor) -> Result<JobOutput, JobError> {
        match kind {
            JobKind::Load {
                role,
                source: PartSource::File(path),
                settings,
            } => {
                let part = load::load(&path, &settings, monitor)?;
                Ok(loaded(role, PartSource::File(path), part))
            }
            JobKind::Reselect {
                role,
                part,
                settings,
            } => {
                let model = Arc::clone(&part.model);
                let again = load::prepare(&part.path, model, &settings, monitor)?;
                Ok(loaded(role, PartSource::File(part.path.clone()), again))
            }
            JobKind::Reduce(input) => reduce(input, monitor),
            JobKind::MeasureLevel(input) => measure_level(input, monitor),
            other => {
                let what = other.key().label();
                Err(JobError::Failed(format!("{what} is not possible yet")))
            }
        }
    }
}

fn loaded(role: Role, source: PartSource, part: LoadedPart) -> JobOutput {
    let facts = Arc::new(PartFacts::of(&part));
    JobOutput::Loaded {
        role,
        source,
        part: Arc::new(part),
        facts,
    }
}

fn reduce(input: ReduceInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let max_triangles = input.max_triangles;
    let recorded = input.recording.filter(|r| r.down_to <= max_triangles);
    let recording = match recorded {
        Some(recording) => recording,
        None => {
            let down_to = max_triangles.min(RECORD_DOWN_TO);
            let settings = SimplifySettings::to_triangles(down_to);
            let levels = Levels::record(&input.part, &settings, monitor)?;
            // A stopped recording ends where it is, and asking for less records again.
            let down_to = if monitor.stop_requested() {
                levels.coarsest()
            } else {
                down_to
            };
            Arc::new(Recording { levels, down_to })
        }
    };
    let level = recording.levels.level(max_triangles);
    Ok(JobOutput::Reduced {
        role: input.role,
        recording,
        level: Arc::new(MeasuredLevel {
            max_triangles,
            level,
            deviation: OnceLock::new(),
        }),
    })
}

fn measure_level(input: MeasureLevelInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    monitor.progress("measure", 0, None);
    let MeasureLevelInput {
        role,
        recording,
        level,
    } = input;
    let deviation = recording.levels.measure(&level.level.mesh, monitor)?;
    // A second measurement of the same level finds the same numbers.
    let _ = level.deviation.set(deviation);
    Ok(JobOutput::LevelMeasured { role, level })
}
