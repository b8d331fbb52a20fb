//! Runs a job with the stages of the pipeline.

use std::sync::{Arc, OnceLock};

use super::export::export;
use super::project::open_project;
use super::{
    CompareInput, CompareMappingInput, FurtherInput, MapInput, MatchInput, MeasureInput,
    PlaceInput, SweepInput, VerdictInput,
};
use super::{
    FoundCrash, JobKind, JobOutput, MeasureLevelInput, MeasuredLevel, Measurement, PartFacts,
    Recording, ReduceInput,
};
use crate::assess::{coverage, overlap_limit, quick_overlap};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::PipelineError;
use crate::pipeline::find_parts::find_parts;
use crate::pipeline::inspect::compare_parts;
use crate::pipeline::load::{self, LoadedPart};
use crate::pipeline::map::{
    OtherResult, PlacedPart, compare_with, element_lists, map_parts, map_record, place,
};
use crate::pipeline::match_parts::{self, match_parts};
use crate::pipeline::reduce::Levels;
use crate::pipeline::sweep::sweep;
use crate::registration::MatchMonitor;
use crate::role::{PerRole, Role};
use crate::simplify::SimplifySettings;

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
    /// Runs one job to its end; asks `monitor` once per chunk. Only a match has starts to follow.
    fn run<'a>(
        &mut self,
        kind: JobKind,
        monitor: impl Into<MatchMonitor<'a>>,
    ) -> Result<JobOutput, JobError>;
}

impl<F> Runner for F
where
    F: FnMut(JobKind, &Monitor) -> Result<JobOutput, JobError> + Send + 'static,
{
    fn run<'a>(
        &mut self,
        kind: JobKind,
        monitor: impl Into<MatchMonitor<'a>>,
    ) -> Result<JobOutput, JobError> {
        self(kind, monitor.into().monitor)
    }
}

/// The real thing: hands every job to its stage of [`crate::pipeline`].
#[derive(Debug, Clone, Copy, Default)]
pub struct PipelineRunner;

/// Every recording goes at least so far down, so that the slider never has to record again.
const RECORD_DOWN_TO: usize = 200;

impl Runner for PipelineRunner {
    fn run<'a>(
        &mut self,
        kind: JobKind,
        monitor: impl Into<MatchMonitor<'a>>,
    ) -> Result<JobOutput, JobError> {
        let match_monitor = monitor.into();
        let monitor = match_monitor.monitor;
        monitor.check()?;
        match kind {
            JobKind::Load {
                role,
                source,
                settings,
            } => {
                let part = source.load(role, &settings, monitor)?;
                let facts = Arc::new(PartFacts::of(&part, monitor)?);
                let part = Arc::new(part);
                Ok(JobOutput::Loaded {
                    role,
                    source,
                    part,
                    facts,
                })
            }
            JobKind::Reselect {
                role,
                part,
                settings,
            } => {
                let model = Arc::clone(&part.model);
                let part = load::prepare(&part.path, model, &settings, monitor)?;
                let facts = Arc::new(PartFacts::of(&part, monitor)?);
                let part = Arc::new(part);
                Ok(JobOutput::Reselected { role, part, facts })
            }
            JobKind::Reduce(input) => reduce(input, monitor),
            JobKind::MeasureLevel(input) => measure_level(input, monitor),
            JobKind::Align(input) => align(&input, monitor),
            JobKind::Match(input) => run_match(&input, match_monitor),
            JobKind::FindParts(input) => run_find_parts(&input, monitor),
            JobKind::Verdict(input) => judge(&input, monitor),
            JobKind::Measure(input) => measure(&input, monitor),
            JobKind::Compare(input) => compare(&input, monitor),
            JobKind::LoadFurther(input) => load_further(&input, monitor),
            JobKind::PlaceFurther(input) => place_further(input, match_monitor),
            JobKind::Map(input) => map(&input, monitor),
            JobKind::CompareMapping(input) => compare_mapping(input, monitor),
            JobKind::Overlap(input) => overlap(&input),
            JobKind::Sweep(input) => run_sweep(&input, monitor),
            JobKind::OpenProject(request) => {
                let opened = open_project(request, monitor)?;
                Ok(JobOutput::ProjectOpened(Box::new(opened)))
            }
            JobKind::Export(request) => Ok(JobOutput::Exported(export(request, monitor)?)),
        }
    }
}

fn reduce(input: ReduceInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let ReduceInput {
        role,
        part,
        recording,
        max_triangles,
    } = input;
    let (recording, level) = reduce_part(&part, recording, max_triangles, monitor)?;
    Ok(JobOutput::Reduced {
        role,
        recording,
        level,
    })
}

/// A level of a part, from the recording at hand or a new one.
pub(super) fn reduce_part(
    part: &LoadedPart,
    recording: Option<Arc<Recording>>,
    max_triangles: usize,
    monitor: &Monitor,
) -> Result<(Arc<Recording>, Arc<MeasuredLevel>), JobError> {
    let recorded = recording.filter(|r| r.down_to <= max_triangles);
    let recording = match recorded {
        Some(recording) => recording,
        None => {
            let down_to = max_triangles.min(RECORD_DOWN_TO);
            let settings = SimplifySettings::to_triangles(down_to);
            let levels = Levels::record(part, &settings, monitor)?;
            // A stopped recording ends where it is, and asking for less records again.
            let down_to = if monitor.stop_requested() {
                levels.coarsest()
            } else {
                down_to
            };
            Arc::new(Recording { levels, down_to })
        }
    };
    let level = recording.levels.level(max_triangles, monitor)?;
    let measured = MeasuredLevel {
        max_triangles,
        level,
        deviation: OnceLock::new(),
    };
    Ok((recording, Arc::new(measured)))
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

fn align(input: &MatchInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    monitor.progress("align", 0, None);
    let settings = &input.recipe.settings.starts;
    let starts = match_parts::align(input.parts.as_deref(), settings)?;
    Ok(JobOutput::Aligned(Arc::new(starts)))
}

fn run_match(input: &MatchInput, monitor: MatchMonitor<'_>) -> Result<JobOutput, JobError> {
    let run = match_parts(
        input.parts.as_deref(),
        input.reduced.as_ref(),
        &input.recipe,
        &input.current,
        monitor,
    )?;
    let run = run.beside_alike_parts(&input.parts.crash.settings.alike_parts);
    Ok(JobOutput::Matched(Arc::new(run)))
}

fn run_find_parts(input: &MatchInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let parts = input.parts.as_deref();
    let found = find_parts(parts, &input.recipe, &input.current, monitor)?;
    let Some(found) = found else {
        return Ok(JobOutput::PartsFound(None));
    };
    let run = Arc::new(found.run());
    let part = found.found.part;
    Ok(JobOutput::PartsFound(Some(FoundCrash {
        facts: Arc::new(PartFacts::of(&part, monitor)?),
        part: Arc::new(part),
        rivals: found.rivals,
        run,
    })))
}

fn judge(input: &VerdictInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let parts = input.parts.as_deref();
    let run = match_parts::judged_anew(&input.run, input.shape_tolerance, parts, monitor)?;
    // A verdict that no one waits for any more is none.
    monitor.check()?;
    Ok(JobOutput::Judged(Arc::new(run)))
}

fn measure(input: &MeasureInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    monitor.progress("measure", 0, None);
    let (target, source) = (&input.parts.crash.surface, &input.parts.stamped.surface);
    let pose = &input.crash_from_stamped;
    let limit = overlap_limit(source, target, pose.scale, 0.0);
    let coverage = coverage(source, target, pose, limit, monitor)?;
    let parts = input.parts.as_deref();
    let alternative = input.alternative_of.as_ref().map(|settings| {
        let said = match_parts::alternative_statements(parts, settings, pose);
        (settings.shape_tolerance, said)
    });
    monitor.check()?;
    let measurement = Measurement {
        coverage,
        alternative,
    };
    Ok(JobOutput::Measured(Arc::new(measurement)))
}

fn compare(input: &CompareInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    monitor.progress("compare", 0, None);
    let levels = input.levels.as_ref().map(Option::as_ref);
    let pose = &input.crash_from_stamped;
    let comparison = compare_parts(input.parts.as_deref(), levels, pose, monitor)?;
    Ok(JobOutput::Compared(Arc::new(comparison)))
}

fn load_further(input: &FurtherInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let part = load::load(&input.file, &input.settings, monitor)?;
    Ok(JobOutput::FurtherLoaded {
        revision: input.revision,
        replaces: input.replaces,
        part: Arc::new(part),
    })
}

fn place_further(input: PlaceInput, monitor: MatchMonitor<'_>) -> Result<JobOutput, JobError> {
    let PerRole { crash, mut stamped } = input.parts;
    if stamped.settings.length_factor != input.length_factor {
        let mut settings = stamped.settings.clone();
        settings.length_factor = input.length_factor;
        let model = Arc::clone(&stamped.model);
        let again = load::prepare(&stamped.path, model, &settings, monitor.monitor)?;
        stamped = Arc::new(again);
    }
    let matched = |recipe| place(PerRole::new(&crash, &stamped), recipe, monitor);
    let run = input.recipe.as_ref().map(matched).transpose()?;
    Ok(JobOutput::FurtherPlaced {
        revision: input.revision,
        crash_revision: input.crash_revision,
        part: stamped,
        run: run.map(Arc::new),
    })
}

fn map(input: &MapInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let first = (&*input.parts.stamped, input.pose);
    let further = input.further.iter().map(|(part, pose)| (&**part, *pose));
    let stamped: Vec<PlacedPart<'_>> = std::iter::once(first)
        .chain(further)
        .map(|(part, (crash_from_stamped, origin))| PlacedPart {
            part,
            crash_from_stamped,
            origin,
        })
        .collect();
    let run = map_parts(&input.parts.crash, &stamped, &input.recipe, monitor)?;
    monitor.check()?;
    let record = map_record(&run, &input.parts.crash, &stamped, None, None, monitor)?;
    monitor.check()?;
    let lists = element_lists(&run, &input.parts.crash, monitor)?;
    Ok(JobOutput::Mapped {
        run: Arc::new(run),
        record: Arc::new(record),
        lists: Arc::new(lists),
        further: input
            .further
            .iter()
            .map(|(part, _)| Arc::clone(part))
            .collect(),
    })
}

fn compare_mapping(input: CompareMappingInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let CompareMappingInput { run, crash, file } = input;
    monitor.progress("read", 0, None);
    let other = OtherResult::read(&[file], &run, &crash, monitor)?;
    monitor.check()?;
    let record = compare_with(&run, &crash, &other, monitor)?;
    Ok(JobOutput::MappingCompared {
        run,
        other: Arc::new(other),
        record: Box::new(record),
    })
}

/// Nodes of each mesh that tell how warm a pose is.
const OVERLAP_POINTS: usize = 2000;

fn overlap(input: &MeasureInput) -> Result<JobOutput, JobError> {
    let (target, source) = (&input.parts.crash.surface, &input.parts.stamped.surface);
    let pose = &input.crash_from_stamped;
    let limit = overlap_limit(source, target, pose.scale, 0.0);
    let [stamped, crash] = quick_overlap(source, target, pose, limit, OVERLAP_POINTS);
    let (of, overlap) = if stamped > crash {
        (Role::Stamped, stamped)
    } else {
        (Role::Crash, crash)
    };
    Ok(JobOutput::Overlapped { of, overlap, limit })
}

fn run_sweep(input: &SweepInput, monitor: &Monitor) -> Result<JobOutput, JobError> {
    let settings = &input.settings;
    let n_rows = (settings.reduction.len() + settings.matching.len() + 1) as u64;
    let mut n_done = 0;
    monitor.progress("sweep", n_done, Some(n_rows));
    let table = sweep(input.parts.as_deref(), None, settings, monitor, |row| {
        input.rows.push(row);
        n_done += 1;
        monitor.progress("sweep", n_done, Some(n_rows));
    })?;
    Ok(JobOutput::Swept(Arc::new(table)))
}
