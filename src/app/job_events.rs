//! What the events of background jobs change.

use std::time::Duration;

use super::mapping::{FURTHER_WITHOUT_POSE, NewFurther, take_compared, take_mapped};
use super::parts::NewPart;
use super::reduce::take_level_measured;
use super::{AppState, Effect, LogStep, NoticeLevel};
use crate::jobs::{FoundCrash, JobEvent, JobKey, JobOutput, JobStage, Live, Stamp};
use crate::role::Role;
use crate::text::{capital, parts_by_id};

impl AppState {
    pub(super) fn take_job_event(&mut self, event: JobEvent) -> Vec<Effect> {
        let running = self.jobs.running().filter(|job| job.id == event.id);
        let was_cancelled = running.is_some_and(|job| job.is_cancelling);
        let was_stopped = running.is_some_and(|job| job.is_stopping);
        self.jobs.take_event(&event, self.log.now);
        match event.stage {
            JobStage::Started => Vec::new(),
            JobStage::Cancelled => {
                self.take_cancelled(event.key, event.elapsed);
                Vec::new()
            }
            JobStage::Failed(message) => {
                self.take_failed(event.key, event.stamp, message, event.elapsed);
                Vec::new()
            }
            // It ended before the worker heard the question; the answer to the user stands.
            JobStage::Finished(_) if was_cancelled => {
                self.take_cancelled(event.key, event.elapsed);
                Vec::new()
            }
            JobStage::Finished(_) if !self.is_wanted(event.key, event.stamp) => {
                self.discard(event.key, event.elapsed);
                Vec::new()
            }
            JobStage::Finished(JobOutput::PartsFound(None)) if was_stopped => {
                let (mut work, topics) = self.split();
                topics.matching.match_cancelled(&mut work);
                let text = "stopped before a crash part was found";
                let took = Some(event.elapsed);
                self.work().log_step(LogStep::Match, None, text, took);
                Vec::new()
            }
            JobStage::Finished(output) => {
                // What was said of its last try is solved.
                self.log.notices.withdraw_job(event.key);
                let took = (event.elapsed, was_stopped);
                self.take_output(output, event.stamp, took)
            }
        }
    }

    /// True if the inputs a job was asked for are still those of the document.
    fn is_wanted(&self, key: JobKey, stamp: Stamp) -> bool {
        let now = self.document.stamp();
        match key {
            JobKey::Load(_) | JobKey::OpenProject | JobKey::Export(_) => true,
            // They say themselves which file and which crash part they belong to.
            JobKey::LoadFurther(_) | JobKey::PlaceFurther => true,
            JobKey::Reselect(role) | JobKey::Reduce(role) => {
                now.parts.get(role) == stamp.parts.get(role)
            }
            // What was measured is written on the level itself, which may be shown again.
            JobKey::MeasureLevel(_) => true,
            // A number for a pose that has moved on is the one before the next.
            JobKey::Overlap => now.parts == stamp.parts,
            JobKey::Align | JobKey::Match | JobKey::Verdict | JobKey::Sweep | JobKey::Compare => {
                now.parts == stamp.parts
            }
            JobKey::Measure | JobKey::Map | JobKey::CompareMapping => now == stamp,
        }
    }

    /// A result of other inputs. Should these come back, it is asked for again.
    fn discard(&mut self, key: JobKey, elapsed: Duration) {
        let (step, role) = step_of(key);
        let text = "discarded: inputs changed";
        self.work().log_step(step, role, text, Some(elapsed));
        self.previews.live = None;
        match key {
            JobKey::Verdict | JobKey::Measure => self.matching.forget_asked(),
            JobKey::Overlap => self.moving.forget_asked(),
            JobKey::Reselect(_) => self.end_of(key),
            _ => {}
        }
    }

    fn take_output(
        &mut self,
        output: JobOutput,
        stamp: Stamp,
        (took, was_stopped): (Duration, bool),
    ) -> Vec<Effect> {
        let (mut work, topics) = self.split();
        let work = &mut work;
        match output {
            JobOutput::ProjectOpened(opened) => return self.take_project(*opened, took),
            JobOutput::Reselected { role, part, facts } => {
                let new = NewPart {
                    role,
                    part,
                    facts,
                    took,
                };
                topics.parts.take_chosen(work, new);
            }
            JobOutput::Loaded {
                role,
                source,
                part,
                facts,
            } => {
                let new = NewPart {
                    role,
                    part,
                    facts,
                    took,
                };
                return topics.parts.take_loaded(work, source, new);
            }
            JobOutput::Reduced {
                role,
                recording,
                level,
            } => {
                return topics
                    .reduce
                    .take_reduced(work, role, recording, level, took);
            }
            JobOutput::LevelMeasured { role, level } => {
                take_level_measured(work, role, &level, took);
            }
            JobOutput::Matched(run) => return topics.matching.take_matched(work, run, took),
            JobOutput::PartsFound(found) => return self.take_found_parts(found, took),
            JobOutput::Aligned(poses) => topics.matching.take_aligned(work, poses, took),
            JobOutput::Judged(run) => topics.matching.take_judged(work, &run, took),
            JobOutput::Measured(measurement) => {
                let matching = topics.matching;
                matching.take_measured(work, measurement, stamp, took);
            }
            further @ (JobOutput::FurtherLoaded { .. } | JobOutput::FurtherPlaced { .. }) => {
                self.take_further(further, took);
            }
            JobOutput::Mapped {
                run,
                record,
                lists,
                further,
            } => {
                return self.taking_mapping(|work, state| {
                    take_mapped(work, state, (run, record, lists), further, took)
                });
            }
            JobOutput::MappingCompared { run, other, record } => {
                return self.taking_mapping(|work, state| {
                    take_compared(work, state, &run, (other, *record), took);
                    Vec::new()
                });
            }
            JobOutput::Compared(comparison) => {
                topics.inspect.take_compared(work.document, comparison);
            }
            JobOutput::Overlapped { of, overlap, limit } => {
                topics.moving.take_overlap(of, overlap, limit, stamp);
            }
            JobOutput::Swept(table) => {
                topics.matching.take_swept(work, table, (took, was_stopped));
            }
            JobOutput::Exported(exported) => return work.take_exported(exported, took),
        }
        Vec::new()
    }

    /// A further stamped file was read, or has its pose.
    fn take_further(&mut self, output: JobOutput, took: Duration) {
        let (mut work, topics) = self.split();
        match output {
            JobOutput::FurtherLoaded {
                revision,
                replaces,
                part,
            } => {
                topics.parts.was_read_again(&mut work, &part.files());
                let new = NewFurther {
                    revision,
                    replaces,
                    part,
                    took,
                };
                topics.mapping.take_loaded(&mut work, new);
            }
            JobOutput::FurtherPlaced {
                revision,
                crash_revision,
                part,
                run,
            } => {
                let task = (revision, crash_revision);
                topics.mapping.take_placed(&mut work, task, part, run, took);
            }
            _ => {}
        }
    }

    /// The crash parts that the stamped part belongs to with the match that found them; where there are none,
    /// the match of all follows.
    fn take_found_parts(&mut self, found: Option<FoundCrash>, took: Duration) -> Vec<Effect> {
        let (mut work, topics) = self.split();
        let (level, text) = match &found {
            Some(found) => {
                let used: Vec<u64> = found.facts.used.iter().copied().collect();
                let fits = format!("the stamped part fits {}", parts_by_id(&used));
                if found.rivals.is_empty() {
                    (NoticeLevel::Info, fits)
                } else {
                    let others = parts_by_id(&found.rivals);
                    (
                        NoticeLevel::Warning,
                        format!("{fits}, and {others} about as well"),
                    )
                }
            }
            None => (
                NoticeLevel::Info,
                "the stamped part fits no crash part alone, so all are matched together".to_owned(),
            ),
        };
        // The rows of selection and match have the time; told twice, it would be counted twice.
        let own = found.is_none().then_some(took);
        work.log_at(level, LogStep::Match, None, text, own);
        let Some(FoundCrash {
            part, facts, run, ..
        }) = found
        else {
            return topics.matching.run_match(&mut work);
        };
        let find_time = Duration::try_from_secs_f64(run.times.find_ms / 1e3);
        let new = NewPart {
            role: Role::Crash,
            part,
            facts,
            took: find_time.unwrap_or_default(),
        };
        topics.parts.take_reselected(&mut work, new, false);
        topics.matching.take_matched(&mut work, run, took)
    }

    fn take_cancelled(&mut self, key: JobKey, elapsed: Duration) {
        self.end_of(key);
        match key {
            // A newer one is not given up with it.
            JobKey::Match if !self.jobs.is_active(key) => {
                let (mut work, topics) = self.split();
                topics.matching.match_cancelled(&mut work);
            }
            JobKey::LoadFurther(revision) => self.mapping.load_cancelled(revision),
            // The old verdict or measurement is none of what is shown; the next command asks again.
            JobKey::Verdict | JobKey::Measure => self.matching.forget_asked(),
            _ => {}
        }
        // A job that was replaced before it began is no news.
        if elapsed > Duration::ZERO {
            let (step, role) = step_of(key);
            self.work().log_step(step, role, "cancelled", Some(elapsed));
        }
    }

    fn take_failed(&mut self, key: JobKey, stamp: Stamp, message: String, elapsed: Duration) {
        self.end_of(key);
        let (step, role) = step_of(key);
        let what_now = match key {
            JobKey::Load(_) | JobKey::LoadFurther(_) => {
                "It was not loaded; choose another file or fix this one"
            }
            JobKey::PlaceFurther => FURTHER_WITHOUT_POSE,
            JobKey::Export(_) => "Nothing was written or copied",
            _ => "Parts and pose are as they were",
        };
        let text = format!("{}. {what_now}", capital(&message));
        self.work()
            .log_at(NoticeLevel::Error, step, role, text, Some(elapsed));
        self.log.notices.last_is_of(key);
        let (work, topics) = self.split();
        match key {
            JobKey::Match => topics.matching.match_failed(&work, message),
            JobKey::LoadFurther(revision) => topics.mapping.load_failed(revision, message),
            JobKey::PlaceFurther => topics.mapping.place_failed(message),
            // Parts and pose may be others by now, of which nothing is known.
            JobKey::Compare => topics.inspect.give_up_comparing(stamp),
            _ => {}
        }
    }

    fn end_of(&mut self, key: JobKey) {
        match key {
            // One that a newer one took the place of is none of those that are waited for.
            JobKey::Match if !self.jobs.is_active(key) => {
                let (mut work, topics) = self.split();
                topics.matching.match_ended(&mut work);
            }
            JobKey::Load(_) if !self.jobs.is_active(key) => self.parts.load_ended(),
            JobKey::Reselect(_) if !self.jobs.is_active(key) => self.parts.choice_ended(),
            _ => {}
        }
    }

    pub(super) fn take_live(&mut self, live: Live) {
        self.jobs.take_live(&live);
        self.matching.take_sweep_rows(&self.document);
        let is_match = self
            .jobs
            .running()
            .is_some_and(|job| job.key == JobKey::Match && live.job == Some(job.id));
        if is_match && self.jobs.is_active(JobKey::Match) {
            let (mut work, topics) = self.split();
            topics.matching.take_live(&mut work, live);
        }
    }
}

/// The word and the part of a job in the log.
fn step_of(key: JobKey) -> (LogStep, Option<Role>) {
    match key {
        JobKey::Load(role) => (LogStep::Load, Some(role)),
        JobKey::Reselect(role) => (LogStep::Select, Some(role)),
        JobKey::Reduce(role) => (LogStep::Reduce, Some(role)),
        JobKey::MeasureLevel(role) => (LogStep::Measure, Some(role)),
        JobKey::Align => (LogStep::Align, None),
        JobKey::Match => (LogStep::Match, None),
        JobKey::Verdict => (LogStep::Verdict, None),
        JobKey::Measure | JobKey::Overlap => (LogStep::Measure, None),
        JobKey::Compare => (LogStep::Compare, None),
        JobKey::LoadFurther(_) => (LogStep::Load, Some(Role::Stamped)),
        JobKey::PlaceFurther => (LogStep::Match, None),
        JobKey::Map | JobKey::CompareMapping => (LogStep::Map, None),
        JobKey::Sweep => (LogStep::Sweep, None),
        JobKey::OpenProject => (LogStep::Project, None),
        JobKey::Export(_) => (LogStep::Export, None),
    }
}
