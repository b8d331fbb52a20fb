//! What the events of background jobs change.

use std::time::Duration;

use crate::app::{AppState, Effect, NoticeLevel};
use crate::jobs::{JobEvent, JobKey, JobOutput, JobStage, Live, Stamp};
use crate::role::Role;

impl AppState {
    pub(super) fn take_job_event(&mut self, event: JobEvent) -> Vec<Effect> {
        let was_cancelled = self
            .jobs
            .running()
            .is_some_and(|job| job.id == event.id && job.is_cancelling);
        self.jobs.take_event(&event, self.now);
        match event.stage {
            JobStage::Started => Vec::new(),
            JobStage::Cancelled => {
                self.take_cancelled(event.key, event.elapsed);
                Vec::new()
            }
            JobStage::Failed(message) => {
                self.take_failed(event.key, message, event.elapsed);
                Vec::new()
            }
            // It ended before the worker heard the question; the answer to the user stands.
            JobStage::Finished(_) if was_cancelled => {
                self.take_cancelled(event.key, event.elapsed);
                Vec::new()
            }
            JobStage::Finished(_) if !self.is_wanted(event.key, event.stamp) => {
                let (step, role) = step_of(event.key);
                let text = "discarded: inputs changed";
                self.log_step(step, role, text, Some(event.elapsed));
                self.live_pose = None;
                Vec::new()
            }
            JobStage::Finished(output) => {
                self.take_output(output, &event.key, event.stamp, event.elapsed)
            }
        }
    }

    /// True if the inputs a job was asked for are still those of the document.
    fn is_wanted(&self, key: JobKey, stamp: Stamp) -> bool {
        let now = self.document.stamp();
        match key {
            JobKey::Load(_) | JobKey::OpenProject | JobKey::Export => true,
            JobKey::Reselect(role) | JobKey::Reduce(role) => {
                now.parts.get(role) == stamp.parts.get(role)
            }
            // What was measured is written on the level itself, which may be shown again.
            JobKey::MeasureLevel(_) => true,
            // A number for a pose that has moved on is the one before the next.
            JobKey::Overlap => now.parts == stamp.parts,
            JobKey::Align | JobKey::Match | JobKey::Sweep | JobKey::Compare => {
                now.parts == stamp.parts
            }
            JobKey::Measure => now == stamp,
        }
    }

    fn take_output(
        &mut self,
        output: JobOutput,
        key: &JobKey,
        stamp: Stamp,
        took: Duration,
    ) -> Vec<Effect> {
        match output {
            JobOutput::ProjectOpened(opened) => return self.take_project(*opened, took),
            JobOutput::Loaded {
                role, part, facts, ..
            } if matches!(key, JobKey::Reselect(_)) => {
                return self.take_reselected(role, part, facts, took);
            }
            JobOutput::Loaded {
                role,
                source,
                part,
                facts,
            } => return self.take_loaded(role, source, part, facts, took),
            JobOutput::Reduced {
                role,
                recording,
                level,
            } => return self.take_reduced(role, recording, level, took),
            JobOutput::LevelMeasured { role, level } => {
                return self.take_level_measured(role, &level, took);
            }
            JobOutput::Matched(run) => return self.take_matched(run, took),
            JobOutput::Aligned(poses) => self.take_aligned(poses, took),
            JobOutput::Measured(measurement) => self.take_measured(measurement, stamp, took),
            JobOutput::Compared(comparison) => self.take_compared(comparison, stamp),
            JobOutput::Overlapped { overlap, limit } => self.take_overlap(overlap, limit, stamp),
            JobOutput::Swept(table) => self.take_swept(table, took),
            JobOutput::Exported(exported) => return self.take_exported(exported, took),
        }
        Vec::new()
    }

    fn take_cancelled(&mut self, key: JobKey, elapsed: Duration) {
        self.end_of(key);
        // A job that was replaced before it began is no news.
        if elapsed > Duration::ZERO {
            let (step, role) = step_of(key);
            self.log_step(step, role, "cancelled", Some(elapsed));
        }
    }

    fn take_failed(&mut self, key: JobKey, message: String, elapsed: Duration) {
        self.end_of(key);
        let (step, role) = step_of(key);
        let what_now = match key {
            JobKey::Load(_) => "Nothing was loaded; choose another file or fix this one",
            JobKey::Export => "Nothing was written; choose another place",
            _ => "Parts and pose are as they were",
        };
        let mut letters = message.chars();
        let first: String = letters
            .next()
            .into_iter()
            .flat_map(char::to_uppercase)
            .collect();
        let text = format!("{first}{}. {what_now}", letters.as_str());
        self.log_at(NoticeLevel::Error, step, role, text, Some(elapsed));
        if key == JobKey::Match {
            self.failed_match = Some((self.document.stamp().parts, message));
        }
    }

    fn end_of(&mut self, key: JobKey) {
        match key {
            JobKey::Match => {
                self.live_pose = None;
                // The starts of a run without a result are worth seeing only where nothing better is.
                if self.document.result.is_some() {
                    self.live_starts.clear();
                }
            }
            JobKey::Load(_) => self.guess.n_pending = self.guess.n_pending.saturating_sub(1),
            JobKey::Compare => self.give_up_comparing(self.document.stamp()),
            _ => {}
        }
    }

    pub(super) fn take_live(&mut self, live: Live) -> Vec<Effect> {
        self.jobs.take_live(&live);
        self.take_sweep_rows();
        let is_match = self
            .jobs
            .running()
            .is_some_and(|job| job.key == JobKey::Match && live.job == Some(job.id));
        if is_match && self.jobs.is_active(JobKey::Match) {
            if let Some(best) = &live.best {
                self.live_pose = Some(best.target_from_source);
            }
            self.live_starts.add(live.starts, live.iterations);
        }
        Vec::new()
    }
}

/// The word and the part of a job in the log.
fn step_of(key: JobKey) -> (&'static str, Option<Role>) {
    match key {
        JobKey::Load(role) => ("load", Some(role)),
        JobKey::Reselect(role) => ("select", Some(role)),
        JobKey::Reduce(role) => ("reduce", Some(role)),
        JobKey::MeasureLevel(role) => ("measure", Some(role)),
        JobKey::Align => ("align", None),
        JobKey::Match => ("match", None),
        JobKey::Measure | JobKey::Overlap => ("measure", None),
        JobKey::Compare => ("compare", None),
        JobKey::Sweep => ("sweep", None),
        JobKey::OpenProject => ("project", None),
        JobKey::Export => ("export", None),
    }
}
