//! What the worker reports: begun, ended, failed.

use std::time::Duration;

use super::{JobId, JobKey, JobOutput, Stamp};

/// What became of a job. Every submitted job gives exactly one of the last three.
#[derive(Debug, Clone)]
pub enum JobStage {
    /// The worker took it up.
    Started,
    /// It ended with a result; a stopped match ends here with the best pose it had.
    Finished(JobOutput),
    /// It could not be done, in one sentence. A panic ends here too.
    Failed(String),
    /// It was cancelled or replaced before it began; nothing changes. Not an error.
    Cancelled,
}

/// One line from the worker.
#[derive(Debug, Clone)]
pub struct JobEvent {
    /// Number of the job.
    pub id: JobId,
    /// Its place in the queue.
    pub key: JobKey,
    /// The state of the document it was asked for.
    pub stamp: Stamp,
    /// How long it has run; zero when it had not begun.
    pub elapsed: Duration,
    /// Started, progressed or ended.
    pub stage: JobStage,
}
