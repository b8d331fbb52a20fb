//! Messages to the user: the rows of the log, toasts and bell; and the time.

mod command;
mod notice;
mod rows;
mod step;

use std::path::PathBuf;
use std::time::Duration;

pub use command::NoticeCommand;
pub use notice::{Notice, NoticeId, NoticeLevel, Notices, Showing};
pub use rows::{Clock, Log, LogRow, age_text, clock_text, duration_text};
pub use step::LogStep;

use crate::role::Role;

/// The rows of the log pane, toasts and bell, and the time they are stamped with.
#[derive(Debug, Clone, Default)]
pub struct LogState {
    log: Log,
    /// Toasts and bell.
    pub notices: Notices,
    /// Time since the program began, as the shell last reported.
    pub now: Duration,
    /// When the program began, as the shell reported.
    pub clock: Clock,
}

impl LogState {
    /// How many rows were left out before the first that is kept.
    pub fn n_dropped(&self) -> usize {
        self.log.n_dropped()
    }

    /// The rows, oldest first.
    pub fn rows(&self) -> &[LogRow] {
        self.log.rows()
    }

    /// The last row of a step.
    pub fn latest(&self, step: LogStep) -> Option<&LogRow> {
        self.log.latest(step)
    }

    /// All durations together.
    pub fn total(&self) -> Duration {
        self.log.total()
    }

    /// The rows as text.
    pub fn to_text(&self) -> String {
        self.log.to_text()
    }

    /// Tells how long the program runs; ends toasts whose time is over.
    pub(super) fn tick(&mut self, now: Duration) {
        self.now = now;
        self.notices.expire(now);
    }

    /// Adds a row.
    pub(super) fn push(
        &mut self,
        level: NoticeLevel,
        step: LogStep,
        role: Option<Role>,
        text: String,
        took: Option<Duration>,
    ) {
        self.log.push(LogRow {
            at: self.clock.day_time_at(self.now),
            step,
            role,
            text,
            file: None,
            took,
            level,
            count: 1,
        });
    }

    /// Adds the row of a file that was written.
    pub(super) fn push_written(&mut self, path: PathBuf, took: Duration) {
        self.log.push(LogRow {
            at: self.clock.day_time_at(self.now),
            step: LogStep::Export,
            role: None,
            text: format!("saved: {}", path.display()),
            file: Some(path),
            took: Some(took),
            level: NoticeLevel::Success,
            count: 1,
        });
    }
}
