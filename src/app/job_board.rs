//! Which jobs wait and run.

use std::time::Duration;

use crate::jobs::{JobEvent, JobId, JobKey, JobStage, Live, LiveIteration};
use crate::monitor::Progress;

/// The running job as the window shows it.
#[derive(Debug, Clone)]
pub struct RunningJob {
    /// Number that its events carry.
    pub id: JobId,
    /// What it is.
    pub key: JobKey,
    /// When it began, since the program began.
    pub since: Duration,
    /// Phase and count.
    pub progress: Option<Progress>,
    /// The latest iteration.
    pub latest: Option<LiveIteration>,
    /// It was asked to end early.
    pub is_stopping: bool,
    /// It was asked to end without a result.
    pub is_cancelling: bool,
}

/// What runs and what waits.
#[derive(Debug, Clone, Default)]
pub struct JobBoard {
    running: Option<RunningJob>,
    waiting: Vec<JobKey>,
}

impl JobBoard {
    /// The running job.
    pub fn running(&self) -> Option<&RunningJob> {
        self.running.as_ref()
    }

    /// True if a job of this key runs or waits, and was not told to go.
    pub fn is_active(&self, key: JobKey) -> bool {
        let runs = |job: &RunningJob| job.key == key && !job.is_cancelling;
        self.running.as_ref().is_some_and(runs) || self.waiting.contains(&key)
    }

    /// True if any job runs or waits.
    pub fn is_busy(&self) -> bool {
        self.running.is_some() || !self.waiting.is_empty()
    }

    pub(super) fn submitted(&mut self, key: JobKey) {
        self.waiting.push(key);
    }

    pub(super) fn ending(&mut self, key: JobKey, is_cancelled: bool) {
        if let Some(job) = self.running.as_mut().filter(|job| job.key == key) {
            job.is_stopping |= !is_cancelled;
            job.is_cancelling |= is_cancelled;
        }
    }

    pub(super) fn take_event(&mut self, event: &JobEvent, now: Duration) {
        if matches!(event.stage, JobStage::Started) {
            self.remove_waiting(event.key);
            self.running = Some(RunningJob {
                id: event.id,
                key: event.key,
                since: now,
                progress: None,
                latest: None,
                is_stopping: false,
                is_cancelling: false,
            });
        } else if self.running.as_ref().is_some_and(|job| job.id == event.id) {
            self.running = None;
        } else {
            self.remove_waiting(event.key);
        }
    }

    pub(super) fn take_live(&mut self, live: &Live) {
        let is_ours = |job: &&mut RunningJob| live.job == Some(job.id);
        if let Some(job) = self.running.as_mut().filter(is_ours) {
            job.progress = live.progress;
            job.latest = live.latest;
        }
    }

    fn remove_waiting(&mut self, key: JobKey) {
        if let Some(index) = self.waiting.iter().position(|k| *k == key) {
            self.waiting.remove(index);
        }
    }
}
