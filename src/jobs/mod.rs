//! Work off the window's thread: one worker, a queue with one place per kind of work, events back.
//!
//! The window submits a [`JobKind`] and goes on drawing. [`Worker::events`] tells without waiting
//! what has started and ended, and none of that is ever lost; [`Worker::live`] is a slot that
//! holds only the latest progress and pose, for which a slow window simply sees fewer pictures.

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
pub use export::{Destination, ExportContent, ExportRequest, Exported, MatchedPair};
pub use facts::PartFacts;
pub use job::{
    CompareInput, JobId, JobKey, JobKind, JobOutput, MatchInput, MeasureInput, MeasureLevelInput,
    MeasuredLevel, PartSource, PerRole, Recording, ReduceInput, Role, Stamp, SweepInput,
};
pub use live::{Live, LiveSlot};
pub use project::{Located, OpenedPart, OpenedProject, ProjectRequest, part_entry};
pub use run::{JobError, PipelineRunner, Runner};
pub use sweep_rows::SweepRows;
pub use worker::{Waker, Worker};
