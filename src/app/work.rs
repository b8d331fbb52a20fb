//! What every topic may read and change beside its own state.

use std::time::Duration;

use super::follow_up::FollowUp;
use super::{
    Action, Document, Effect, GestureId, History, JobBoard, LogState, LogStep, NoticeLevel,
    Previews, Reason, Settings, Showing, StampedPose,
};
use crate::geometry::Similarity;
use crate::jobs::{JobKey, JobKind};
use crate::role::Role;
use crate::text::{Lengths, without_error_number};

/// The work itself: the document with its history, jobs, preferences and messages, and what is to
/// happen in other topics afterwards. A topic gets this and its own state, and no other topic's.
pub(super) struct Work<'a> {
    pub document: &'a mut Document,
    pub history: &'a mut History,
    pub jobs: &'a mut JobBoard,
    pub settings: &'a mut Settings,
    pub log: &'a mut LogState,
    pub previews: &'a mut Previews,
    /// Carried out in this order as soon as the topic is done.
    pub follow_ups: &'a mut Vec<FollowUp>,
}

impl Work<'_> {
    /// Other topics are to follow.
    pub fn follow(&mut self, follow_up: FollowUp) {
        self.follow_ups.push(follow_up);
    }

    /// Changes the document as one undo step; says whether anything changed.
    pub fn commit(&mut self, name: impl Into<String>, change: impl FnOnce(&mut Document)) -> bool {
        self.commit_in(name, None, change)
    }

    /// [`Work::commit`] within a gesture.
    pub fn commit_in(
        &mut self,
        name: impl Into<String>,
        gesture: Option<GestureId>,
        change: impl FnOnce(&mut Document),
    ) -> bool {
        let before = self.document.clone();
        change(self.document);
        let has_changed = *self.document != before;
        if has_changed {
            self.history
                .push(name.into(), before, gesture, self.log.now);
            // Undo would take this step back, not the one that it was offered for.
            self.log.notices.withdraw(Action::Undo);
        }
        has_changed
    }

    /// Moves the stamped part as one undo step (or a part of one).
    pub fn commit_pose(
        &mut self,
        name: impl Into<String>,
        gesture: Option<GestureId>,
        crash_from_stamped: Similarity,
    ) -> bool {
        if crash_from_stamped == self.document.pose.crash_from_stamped {
            return false;
        }
        let revision = self.history.next_revision();
        self.previews.drop_all();
        self.commit_in(name, gesture, |document| {
            document.pose = StampedPose {
                crash_from_stamped,
                revision,
            };
        })
    }

    /// Adds a row to the log.
    pub fn log_step(
        &mut self,
        step: LogStep,
        role: Option<Role>,
        text: impl Into<String>,
        took: Option<Duration>,
    ) {
        self.log_at(NoticeLevel::Info, step, role, text, took);
    }

    /// Adds a row to the log with a level, and a toast if the level has one.
    pub fn log_at(
        &mut self,
        level: NoticeLevel,
        step: LogStep,
        role: Option<Role>,
        text: impl Into<String>,
        took: Option<Duration>,
    ) {
        let text = without_error_number(&text.into());
        let showing = self.showing_of(level, Some(step));
        self.log.notices.push(level, text.clone(), showing);
        self.log.push(level, step, role, text, took);
    }

    /// [`Work::log_at`] with a button for each of these actions.
    pub fn offer_at(&mut self, level: NoticeLevel, step: LogStep, text: &str, offers: &[Action]) {
        let text = without_error_number(text);
        let showing = self.showing_of(level, Some(step));
        self.log.notices.offer(level, text.clone(), showing, offers);
        self.log.push(level, step, None, text, None);
    }

    /// Shows a toast, unless the user muted its level; the bell has it in any case.
    pub fn notify(&mut self, level: NoticeLevel, text: impl Into<String>) {
        let showing = self.showing(level);
        self.log.notices.push(level, text.into(), showing);
    }

    /// A message of now, muted if the user muted its level.
    pub fn showing(&self, level: NoticeLevel) -> Showing {
        self.showing_of(level, None)
    }

    fn showing_of(&self, level: NoticeLevel, about: Option<LogStep>) -> Showing {
        Showing {
            now: self.log.now,
            is_muted: self.settings.muted.contains(&level),
            about,
        }
    }

    /// A job for the worker, stamped with the present state.
    pub fn start(&mut self, kind: JobKind) -> Effect {
        self.jobs.submitted(&kind);
        Effect::StartJob(Box::new(kind), self.document.stamp())
    }

    /// Asks a job to go. The window shows the old state at once; the worker follows.
    pub fn cancel(&mut self, key: JobKey) -> Vec<Effect> {
        if !self.jobs.is_active(key) {
            return Vec::new();
        }
        self.jobs.ending(key, true);
        match key {
            JobKey::Match => self.previews.live = None,
            JobKey::Compare => self.follow(FollowUp::ComparisonEnded),
            _ => {}
        }
        vec![Effect::CancelJob(key)]
    }

    /// Asks the job that holds the inputs to go, else the one that runs.
    pub fn cancel_present(&mut self) -> Vec<Effect> {
        if let Some(key) = self.jobs.locking_job() {
            return self.cancel(key);
        }
        let key = self.jobs.running().map(|job| job.key);
        // What was asked for both parts at once is one work.
        let both = key
            .into_iter()
            .flat_map(|key| [Some(key), key.of_other_part()]);
        both.flatten().flat_map(|key| self.cancel(key)).collect()
    }

    /// Takes new preferences over.
    pub fn set_settings(&mut self, settings: Settings) -> Vec<Effect> {
        let settings = settings.sanitized();
        if settings == *self.settings {
            return Vec::new();
        }
        *self.settings = settings;
        vec![Effect::SaveSettings]
    }

    /// How the window writes every length that it shows.
    pub fn lengths(&self) -> Lengths {
        self.document.lengths(self.settings.decimals)
    }

    /// `Ok` unless a match or sweep holds the inputs.
    pub fn is_unlocked(&self) -> Result<(), Reason> {
        self.jobs.is_unlocked()
    }

    /// `Ok` if the stamped part may be moved now.
    pub fn can_move(&self) -> Result<(), Reason> {
        self.document.can_move(self.jobs)
    }

    /// Seconds since 1970.
    pub fn unix_now(&self) -> u64 {
        self.log.clock.unix_at(self.log.now)
    }
}
