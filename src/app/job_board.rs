//! Which jobs wait and run.

use std::sync::Arc;
use std::time::Duration;

use crate::jobs::{JobEvent, JobId, JobKey, JobKind, JobStage, Live, LiveIteration, PartSource};
use crate::monitor::Progress;
use crate::pipeline::names::file_name;
use crate::text::capital;

/// The running job as the window shows it.
#[derive(Debug, Clone)]
pub struct RunningJob {
    /// Number that its events carry.
    pub id: JobId,
    /// What it is.
    pub key: JobKey,
    /// The file it reads, if it reads one.
    pub file: Option<String>,
    /// When it began, since the program began.
    pub since: Duration,
    /// Phase and count.
    pub progress: Option<Progress>,
    /// Places spread over the part that it prepares.
    pub shape: Option<Arc<[[f64; 3]]>>,
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
    waiting: Vec<WaitingJob>,
}

#[derive(Debug, Clone)]
struct WaitingJob {
    key: JobKey,
    /// The file it reads, if it reads one.
    file: Option<String>,
    /// It was asked to end before it begins.
    is_cancelling: bool,
}

impl WaitingJob {
    fn is_active(&self, key: JobKey) -> bool {
        self.key == key && !self.is_cancelling
    }
}

impl RunningJob {
    /// What it does now, in words: "Reading floor.k · 12.5 MB".
    pub fn words(&self) -> String {
        let Some(progress) = self.progress else {
            return match &self.file {
                Some(file) => format!("Reading {file}"),
                None => "Starting".to_owned(),
            };
        };
        let file = self
            .file
            .as_ref()
            .map_or_else(String::new, |file| format!(" {file}"));
        let megabytes = progress.done as f64 / 1e6;
        let mut words = match progress.phase {
            "read deck" if megabytes >= 0.1 => format!("Reading{file} · {megabytes:.1} MB"),
            "read deck" => format!("Reading{file}"),
            "prepare" => format!("Preparing{file}"),
            phase => capital(phase),
        };
        if let Some(total) = progress.total.filter(|total| *total > 0) {
            words += &format!(" · {:.0} %", 100.0 * progress.done as f64 / total as f64);
        }
        words
    }
}

impl JobBoard {
    /// The running job.
    pub fn running(&self) -> Option<&RunningJob> {
        self.running.as_ref()
    }

    /// True if a job of this key runs or waits, and was not told to go.
    pub fn is_active(&self, key: JobKey) -> bool {
        let runs = |job: &RunningJob| job.key == key && !job.is_cancelling;
        self.running.as_ref().is_some_and(runs) || self.waiting.iter().any(|job| job.is_active(key))
    }

    /// True if an output is being written or waits for it, and was not told to go.
    pub fn is_exporting(&self) -> bool {
        let runs = |job: &RunningJob| job.key.is_export() && !job.is_cancelling;
        self.running.as_ref().is_some_and(runs)
            || self
                .waiting
                .iter()
                .any(|job| job.key.is_export() && !job.is_cancelling)
    }

    /// True if any job runs or waits.
    pub fn is_busy(&self) -> bool {
        self.running.is_some() || !self.waiting.is_empty()
    }

    pub(super) fn submitted(&mut self, kind: &JobKind) {
        let file = match kind {
            JobKind::Load {
                source: PartSource::File(path),
                ..
            } => Some(path),
            JobKind::LoadFurther(input) => Some(&input.file),
            _ => None,
        };
        let file = file.map(|path| file_name(path));
        self.waiting.push(WaitingJob {
            key: kind.key(),
            file,
            is_cancelling: false,
        });
    }

    pub(super) fn ending(&mut self, key: JobKey, is_cancelled: bool) {
        if let Some(job) = self.running.as_mut().filter(|job| job.key == key) {
            job.is_stopping |= !is_cancelled;
            job.is_cancelling |= is_cancelled;
        }
        for job in self.waiting.iter_mut().filter(|job| job.key == key) {
            job.is_cancelling |= is_cancelled;
        }
    }

    pub(super) fn take_event(&mut self, event: &JobEvent, now: Duration) {
        if matches!(event.stage, JobStage::Started) {
            self.running = Some(RunningJob {
                id: event.id,
                key: event.key,
                file: self.remove_waiting(event.key),
                since: now,
                progress: None,
                shape: None,
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
            job.shape.clone_from(&live.shape);
            job.latest = live.latest;
        }
    }

    /// Takes a waiting job out; the file it reads.
    fn remove_waiting(&mut self, key: JobKey) -> Option<String> {
        let index = self.waiting.iter().position(|job| job.key == key)?;
        self.waiting.remove(index).file
    }
}
