//! The latest progress and pose of the running job.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{JobId, Waker};
use crate::monitor::{Observer, Progress};
use crate::registration::{self, IterationRecord, StartRecord};

/// Shortest time between two wake-ups for progress: 30 a second.
const WAKE_INTERVAL: Duration = Duration::from_millis(33);
/// Iterations kept while nobody looks; the live curve alone lacks those that come after.
const MAX_ITERATIONS: usize = 20_000;

/// One iteration of a running match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LiveIteration {
    /// Number of its start, from 0 over the whole match.
    pub start: usize,
    /// Its number within the start, from 0.
    pub number: usize,
    /// What it found.
    pub record: IterationRecord,
}

/// What is going on right now: overwritten, not queued.
#[derive(Debug, Clone, Default)]
pub struct Live {
    /// The running job.
    pub job: Option<JobId>,
    /// The latest phase and count.
    pub progress: Option<Progress>,
    /// Places spread over the part that is being prepared, in the crash model's unit.
    pub shape: Option<Arc<[[f64; 3]]>>,
    /// The best iteration of the current phase so far, for the preview of its pose.
    pub best: Option<IterationRecord>,
    /// The latest iteration, for the status line.
    pub latest: Option<LiveIteration>,
    /// Iterations since the last look, in the order they came, for the convergence curve.
    pub iterations: Vec<LiveIteration>,
    /// Starts that began or ended since the last look, with their numbers, in the order they did.
    /// Their records hold no iterations.
    pub starts: Vec<(usize, StartRecord)>,
}

/// The slot between the worker's threads, which write, and the window, which reads when it draws.
pub struct LiveSlot {
    inner: Mutex<(Live, Option<Instant>)>,
    waker: Waker,
}

impl LiveSlot {
    /// An empty slot that calls `waker` at most 30 times a second.
    pub fn new(waker: Waker) -> Self {
        Self {
            inner: Mutex::default(),
            waker,
        }
    }

    /// Empties the slot for the next job. What the last one reported stays until then, so that a window
    /// that reads the events first and the slot after them misses nothing of a job that ended.
    pub fn begin(&self, job: JobId) {
        let (live, _) = &mut *self.lock();
        *live = Live {
            job: Some(job),
            ..Live::default()
        };
    }

    /// The present state; takes iterations and starts out, leaves the rest.
    pub fn take(&self) -> Live {
        let (live, _) = &mut *self.lock();
        let iterations = std::mem::take(&mut live.iterations);
        let starts = std::mem::take(&mut live.starts);
        Live {
            iterations,
            starts,
            ..live.clone()
        }
    }

    /// Changes the state under the lock, then wakes the window if the last time is long enough
    /// ago. A new phase always wakes, so that a long quiet phase does not hide behind the old one.
    fn update(&self, change: impl FnOnce(&mut Live) -> bool) {
        let wake = {
            let (live, last_wake) = &mut *self.lock();
            let at_once = change(live);
            let now = Instant::now();
            let due = last_wake.is_none_or(|last| now.duration_since(last) >= WAKE_INTERVAL);
            if at_once || due {
                *last_wake = Some(now);
            }
            at_once || due
        };
        if wake {
            (self.waker)();
        }
    }

    fn lock(&self) -> MutexGuard<'_, (Live, Option<Instant>)> {
        // Every write leaves a whole state, so a poisoned lock still guards a usable one.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Observer for LiveSlot {
    fn progress(&self, progress: Progress) {
        self.update(|live| {
            let new_phase = live.progress.is_none_or(|old| old.phase != progress.phase);
            if new_phase {
                // Objectives of a coarse and a fine phase do not compare.
                live.best = None;
            }
            live.progress = Some(progress);
            new_phase
        });
    }

    fn shape(&self, points: Vec<[f64; 3]>) {
        self.update(|live| {
            live.shape = Some(points.into());
            true
        });
    }
}

impl registration::Observer for LiveSlot {
    fn start(&self, start: usize, record: &StartRecord) {
        self.update(|live| {
            live.starts.push((start, record.clone()));
            false
        });
    }

    fn iteration(&self, start: usize, number: usize, record: &IterationRecord) {
        self.update(|live| {
            let better = live
                .best
                .is_none_or(|best| record.objective <= best.objective);
            if better {
                live.best = Some(*record);
            }
            let iteration = LiveIteration {
                start,
                number,
                record: *record,
            };
            live.latest = Some(iteration);
            if live.iterations.len() < MAX_ITERATIONS {
                live.iterations.push(iteration);
            }
            false
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Similarity;
    use crate::registration::{Observer as _, Stage};
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn iterate(slot: &LiveSlot, number: usize, objective: f64) {
        let record = IterationRecord {
            stage: Stage::Coarse,
            target_from_source: Similarity::identity(),
            objective,
            rmse: objective,
            fraction: 1.0,
        };
        slot.iteration(0, number, &record);
    }

    #[test]
    fn the_best_pose_is_shown_and_no_iteration_comes_twice() {
        let n_wakes = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&n_wakes);
        let slot = LiveSlot::new(Arc::new(move || {
            counter.fetch_add(1, Ordering::Relaxed);
        }));
        for (number, objective) in [3.0, 1.0, 2.0].into_iter().enumerate() {
            iterate(&slot, number, objective);
        }
        let live = slot.take();
        assert_eq!(live.best.unwrap().objective, 1.0);
        let latest = live.latest.unwrap();
        assert_eq!((latest.number, latest.record.objective), (2, 2.0));
        assert_eq!(live.iterations.len(), 3);
        assert!(slot.take().iterations.is_empty());
        assert_eq!(slot.take().best.unwrap().objective, 1.0);
        assert!(n_wakes.load(Ordering::Relaxed) >= 1);
    }

    #[test]
    fn a_new_phase_starts_a_new_best() {
        let slot = LiveSlot::new(Arc::new(|| {}));
        iterate(&slot, 0, 1.0);
        slot.progress(Progress {
            phase: "refine",
            done: 0,
            total: None,
        });
        iterate(&slot, 1, 5.0);
        assert_eq!(slot.take().best.unwrap().objective, 5.0);
    }
}
