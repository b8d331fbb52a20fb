//! Progress, stop and cancel for everything that takes long.
//!
//! A [`Monitor`] is handed down into every loop whose length grows with the mesh, and asked once per chunk of work;
//! in settling it is asked between the steps. Chunks are meant to be small enough for an answer within 100 ms.
//! *Stop* means "end early and keep the best result so far"; *cancel* means "end and forget".

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The work was cancelled; whatever it had found is dropped. Not an error to be shown as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// How far a phase of the work has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// The phase in the field's words, for example `"read nodes"` or `"refine"`.
    pub phase: &'static str,
    /// Units finished: bytes, triangles or starts, as the phase has them.
    pub done: u64,
    /// Units in all, or `None` where the end cannot be known (an ICP run has no true percentage).
    pub total: Option<u64>,
}

/// Receives progress. Called from worker threads, so it must be quick and `Sync`.
pub trait Observer: Send + Sync {
    /// A phase began or moved on.
    fn progress(&self, _progress: Progress) {}

    /// Places spread over the shape that is being prepared, for a first picture.
    fn shape(&self, _points: Vec<[f64; 3]>) {}

    /// The work looks whether it is to end.
    fn asked(&self) {}
}

#[derive(Debug, Default)]
struct Flags {
    stop: AtomicBool,
    cancel: AtomicBool,
}

/// Shared handle on a piece of running work: asks for stop or cancel, reports progress.
///
/// Clones share the same flags, so one clone can stay with the window and one go to the worker.
#[derive(Clone, Default)]
pub struct Monitor {
    flags: Arc<Flags>,
    observer: Option<Arc<dyn Observer>>,
}

impl Monitor {
    /// A monitor that nobody watches and nobody stops.
    pub fn silent() -> Self {
        Self::default()
    }

    /// A monitor that reports progress to `observer`.
    pub fn with_observer(observer: Arc<dyn Observer>) -> Self {
        Self {
            flags: Arc::default(),
            observer: Some(observer),
        }
    }

    /// The same flags without anybody watching, for side work that nobody follows.
    pub fn without_observer(&self) -> Self {
        Self {
            flags: self.flags.clone(),
            observer: None,
        }
    }

    /// Asks the work to end early and to keep its best result.
    pub fn request_stop(&self) {
        self.flags.stop.store(true, Ordering::Relaxed);
    }

    /// Asks the work to end at once and to drop what it has.
    pub fn request_cancel(&self) {
        self.flags.cancel.store(true, Ordering::Relaxed);
    }

    /// True once [`Monitor::request_stop`] was called.
    pub fn stop_requested(&self) -> bool {
        self.flags.stop.load(Ordering::Relaxed)
    }

    /// `Err(Cancelled)` once [`Monitor::request_cancel`] was called; to be asked once per chunk.
    pub fn check(&self) -> Result<(), Cancelled> {
        if let Some(observer) = &self.observer {
            observer.asked();
        }
        if self.flags.cancel.load(Ordering::Relaxed) {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }

    /// Reports how far a phase has come.
    pub fn progress(&self, phase: &'static str, done: u64, total: Option<u64>) {
        if let Some(observer) = &self.observer {
            observer.progress(Progress { phase, done, total });
        }
    }

    /// Shows places spread over the shape that is being prepared, worked out only if anybody looks.
    pub fn shape(&self, points: impl FnOnce() -> Vec<[f64; 3]>) {
        if let Some(observer) = &self.observer {
            observer.shape(points());
        }
    }
}

impl std::fmt::Debug for Monitor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Monitor")
            .field("flags", &self.flags)
            .field("observed", &self.observer.is_some())
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_share_stop_and_cancel() {
        let ours = Monitor::silent();
        let theirs = ours.clone();
        assert!(!ours.stop_requested());
        assert_eq!(ours.check(), Ok(()));
        theirs.request_stop();
        theirs.request_cancel();
        assert!(ours.stop_requested());
        assert_eq!(ours.check(), Err(Cancelled));
    }
}
