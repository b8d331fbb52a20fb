//! Work off the window's thread: one worker, a queue with one place per kind of work, events back.
//!
//! The window submits a [`JobKind`] and goes on drawing. [`Worker::events`] says without waiting
//! what has started and ended, and none of that is ever lost; [`Worker::live`] is a slot that
//! holds only the latest progress and pose, of which a slow window simply sees fewer.

mod event;
mod export;
mod facts;
mod job;
mod live;
mod project;
mod run;
mod sweep_rows;
mod worker;

pub use event::{JobEvent, JobStage};
pub use export::{Destination, ExportRequest, Exported};
pub use facts::PartFacts;
pub use job::{
    CompareInput, CompareMappingInput, FoundCrash, FurtherInput, JobId, JobKey, JobKind, JobOutput,
    MapInput, MatchInput, MeasureInput, MeasureLevelInput, MeasuredLevel, Measurement, PlaceInput,
    Recording, ReduceInput, Stamp, SweepInput, VerdictInput,
};
pub use live::{Live, LiveIteration, LiveSlot};
pub use project::{OpenedPart, OpenedProject};
pub use run::{JobError, PipelineRunner, Runner};
pub use sweep_rows::SweepRows;
pub use worker::{Waker, Worker};

pub use crate::pipeline::load::PartSource;
pub use crate::pipeline::project::{Located, ProjectFile, ProjectRequest};
