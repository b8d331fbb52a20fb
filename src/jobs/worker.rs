//! The worker thread and its queue.

use std::any::Any;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::{JobError, JobEvent, JobId, JobKey, JobKind, JobStage, Live, LiveSlot, Runner, Stamp};
use crate::monitor::{Monitor, Observer};
use crate::registration::MatchMonitor;

/// Called from the worker when there is something new to look at. Must be quick.
pub type Waker = Arc<dyn Fn() + Send + Sync>;

struct Request {
    id: JobId,
    kind: JobKind,
    stamp: Stamp,
}

struct Running {
    key: JobKey,
    monitor: Monitor,
}

#[derive(Default)]
struct Queue {
    waiting: VecDeque<Request>,
    running: Option<Running>,
    n_submitted: u64,
    is_closing: bool,
}

struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
    live: Arc<LiveSlot>,
    waker: Waker,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Queue> {
        // The queue is only ever changed by whole steps that cannot panic.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The worker thread as the window sees it. Nothing here waits, except dropping it, which cancels
/// what runs and waits for that answer.
pub struct Worker {
    shared: Arc<Shared>,
    sender: Sender<JobEvent>,
    receiver: Receiver<JobEvent>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread. `runner` does the work, `waker` is called at every event and at most
    /// 30 times a second for progress. Fails if the system gives no thread.
    pub fn spawn(runner: impl Runner, waker: Waker) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            queue: Mutex::default(),
            changed: Condvar::new(),
            live: Arc::new(LiveSlot::new(Arc::clone(&waker))),
            waker,
        });
        let (sender, receiver) = channel();
        let (theirs, events) = (Arc::clone(&shared), sender.clone());
        let thread = std::thread::Builder::new()
            .name("shapematch worker".to_owned())
            .spawn(move || work(&theirs, &events, runner))?;
        Ok(Self {
            shared,
            sender,
            receiver,
            thread: Some(thread),
        })
    }

    /// Queues a job. A waiting job with the same key is replaced and reported as cancelled.
    pub fn submit(&self, kind: JobKind, stamp: Stamp) -> JobId {
        let key = kind.key();
        let mut queue = self.shared.lock();
        queue.n_submitted += 1;
        let id = JobId(queue.n_submitted);
        let replaced = take_waiting(&mut queue, |request| request.kind.key() == key);
        queue.waiting.push_back(Request { id, kind, stamp });
        drop(queue);
        self.tell_cancelled(replaced);
        self.shared.changed.notify_one();
        id
    }

    /// Asks the running job of this key to end early with its best result; a waiting one goes.
    pub fn stop(&self, key: JobKey) {
        self.end(|k| k == key, Monitor::request_stop);
    }

    /// Asks the job of this key to end without a result, running or waiting.
    pub fn cancel(&self, key: JobKey) {
        self.end(|k| k == key, Monitor::request_cancel);
    }

    /// Cancels the running job and drops the waiting ones.
    pub fn cancel_all(&self) {
        self.end(|_| true, Monitor::request_cancel);
    }

    /// The events since the last call, oldest first. Never waits.
    pub fn events(&self) -> impl Iterator<Item = JobEvent> + '_ {
        self.receiver.try_iter()
    }

    /// The next event, waiting for it at most `timeout`; for those that have nothing else to do.
    pub fn wait_event(&self, timeout: Duration) -> Option<JobEvent> {
        self.receiver.recv_timeout(timeout).ok()
    }

    /// The latest progress, pose, new iterations and starts of the running job, or of the last one if
    /// none runs. Read the events before it: then the news of a job that ended are all in it.
    pub fn live(&self) -> Live {
        self.shared.live.take()
    }

    /// The key of the running job, if any.
    pub fn running(&self) -> Option<JobKey> {
        self.shared.lock().running.as_ref().map(|r| r.key)
    }

    /// True if nothing runs and nothing waits.
    pub fn is_idle(&self) -> bool {
        let queue = self.shared.lock();
        queue.running.is_none() && queue.waiting.is_empty()
    }

    fn end(&self, is_meant: impl Fn(JobKey) -> bool, ask: impl Fn(&Monitor)) {
        let mut queue = self.shared.lock();
        if let Some(running) = queue.running.as_ref().filter(|r| is_meant(r.key)) {
            ask(&running.monitor);
        }
        let dropped = take_waiting(&mut queue, |request| is_meant(request.kind.key()));
        drop(queue);
        self.tell_cancelled(dropped);
    }

    fn tell_cancelled(&self, dropped: Vec<Request>) {
        let any = !dropped.is_empty();
        for request in dropped {
            // The receiver lives as long as `self`, so this cannot fail.
            let _ = self.sender.send(JobEvent {
                id: request.id,
                key: request.kind.key(),
                stamp: request.stamp,
                elapsed: Duration::ZERO,
                stage: JobStage::Cancelled,
            });
        }
        if any {
            (self.shared.waker)();
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.shared.lock().is_closing = true;
        self.cancel_all();
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // A panic of the runner was caught, so there is no other to pass on.
            let _ = thread.join();
        }
    }
}

fn take_waiting(queue: &mut Queue, is_meant: impl Fn(&Request) -> bool) -> Vec<Request> {
    let (dropped, kept) = queue.waiting.drain(..).partition(is_meant);
    queue.waiting = kept;
    dropped.into()
}

/// The thread: waits for a request, runs it, reports how it ended.
fn work(shared: &Shared, events: &Sender<JobEvent>, mut runner: impl Runner) {
    while let Some((request, monitor)) = next(shared) {
        let (id, key, stamp) = (request.id, request.kind.key(), request.stamp);
        let tell = |stage, elapsed| {
            // A closed window no longer listens; the work then ends by itself.
            let _ = events.send(JobEvent {
                id,
                key,
                stamp,
                elapsed,
                stage,
            });
            (shared.waker)();
        };
        tell(JobStage::Started, Duration::ZERO);
        let begin = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| {
            runner.run(
                request.kind,
                MatchMonitor::observed(&monitor, &*shared.live),
            )
        }));
        let elapsed = begin.elapsed();
        shared.lock().running = None;
        tell(outcome(result, &monitor), elapsed);
    }
}

fn next(shared: &Shared) -> Option<(Request, Monitor)> {
    let mut queue = shared.lock();
    loop {
        if queue.is_closing {
            return None;
        }
        if let Some(request) = queue.waiting.pop_front() {
            let observer: Arc<dyn Observer> = Arc::clone(&shared.live) as Arc<dyn Observer>;
            let monitor = Monitor::with_observer(observer);
            shared.live.begin(request.id);
            queue.running = Some(Running {
                key: request.kind.key(),
                monitor: monitor.clone(),
            });
            return Some((request, monitor));
        }
        queue = shared
            .changed
            .wait(queue)
            .unwrap_or_else(PoisonError::into_inner);
    }
}

type Caught = Result<Result<super::JobOutput, JobError>, Box<dyn Any + Send>>;

fn outcome(result: Caught, monitor: &Monitor) -> JobStage {
    match result {
        Err(panic) => JobStage::Failed(format!("internal error: {}", panic_text(&*panic))),
        // Cancel wins over a result that came at the same moment: the user was told it is gone.
        Ok(_) if monitor.check().is_err() => JobStage::Cancelled,
        Ok(Err(JobError::Cancelled(_))) => JobStage::Cancelled,
        Ok(Err(JobError::Failed(message))) => JobStage::Failed(message),
        Ok(Ok(output)) => JobStage::Finished(output),
    }
}

fn panic_text(panic: &(dyn Any + Send)) -> &str {
    if let Some(text) = panic.downcast_ref::<&'static str>() {
        text
    } else if let Some(text) = panic.downcast_ref::<String>() {
        text
    } else {
        "unknown panic"
    }
}
