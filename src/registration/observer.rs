//! Who watches a match: stop, cancel and phases, and its starts and iterations as they come.

use super::result::{IterationRecord, StartRecord};
use crate::monitor::{Cancelled, Monitor};

/// Receives the starts and iterations of a match. Called from worker threads, so it must be quick.
pub trait Observer: Send + Sync {
    /// A start begins, or has ended if it has an outcome: twice for each start but a runner-up,
    /// never during an iteration of its own. Starts are numbered from 0 over the whole match and
    /// begin in that order. The record holds no iterations, they come one by one.
    fn start(&self, _start: usize, _record: &StartRecord) {}
    /// A start made an iteration, numbered from 0 within the start.
    fn iteration(&self, _start: usize, _number: usize, _record: &IterationRecord) {}
}

/// What watches a match. Made from a [`Monitor`] where nobody follows the starts.
#[derive(Clone, Copy)]
pub struct MatchMonitor<'a> {
    /// Phases, stop and cancel.
    pub monitor: &'a Monitor,
    /// Starts and iterations.
    pub observer: Option<&'a dyn Observer>,
}

impl<'a> From<&'a Monitor> for MatchMonitor<'a> {
    fn from(monitor: &'a Monitor) -> Self {
        Self {
            monitor,
            observer: None,
        }
    }
}

impl<'a> MatchMonitor<'a> {
    /// `monitor` with `observer` following the starts.
    pub fn observed(monitor: &'a Monitor, observer: &'a dyn Observer) -> Self {
        Self {
            monitor,
            observer: Some(observer),
        }
    }

    pub(super) fn check(&self) -> Result<(), Cancelled> {
        self.monitor.check()
    }

    pub(super) fn stop_requested(&self) -> bool {
        self.monitor.stop_requested()
    }

    pub(super) fn phase(&self, phase: &'static str) {
        self.monitor.progress(phase, 0, None);
    }

    /// Reports that a start began or ended; `record` is only made if somebody follows.
    pub(super) fn start(&self, start: usize, record: impl FnOnce() -> StartRecord) {
        if let Some(observer) = self.observer {
            observer.start(start, &record());
        }
    }

    pub(super) fn iteration(&self, start: usize, number: usize, record: &IterationRecord) {
        if let Some(observer) = self.observer {
            observer.iteration(start, number, record);
        }
    }
}
