//! Work that no frame waits for: [`Background`] always makes what was asked for last, [`run_once`]
//! does one thing and ends. Jobs, which the user sees and can stop, run on [`crate::jobs::Worker`].

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};

use crate::jobs::{JobError, JobKind, JobOutput, Runner};
use crate::registration::MatchMonitor;
use crate::role::{PerRole, Role};

/// Does `work` once on a thread of that name; false if the system has no thread left.
pub(super) fn run_once(name: &str, work: impl FnOnce() + Send + 'static) -> bool {
    let thread = std::thread::Builder::new().name(name.to_owned());
    thread.spawn(work).is_ok()
}

/// How much further back than the window its work stands when processors are few (0 to 19): a thread of the
/// window gets about twice the time. With more, other programs would hold up the work.
#[cfg(target_os = "linux")]
const STEP: i32 = 3;

/// Puts the calling thread behind the window and the driver that draws it: work that takes all processors
/// must not make the window wait. Elsewhere than on Linux nothing happens.
pub fn step_back() {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{getpriority_process, setpriority_process};
        // Without the right to it, the thread stays where it is.
        let _ = getpriority_process(None).and_then(|now| setpriority_process(None, now + STEP));
    }
}

/// Does jobs behind the window.
pub(super) struct Behind<R> {
    runner: R,
    is_behind: bool,
}

impl<R> Behind<R> {
    pub fn new(runner: R) -> Self {
        Self {
            runner,
            is_behind: false,
        }
    }
}

impl<R: Runner> Runner for Behind<R> {
    fn run<'a>(
        &mut self,
        kind: JobKind,
        monitor: impl Into<MatchMonitor<'a>>,
    ) -> Result<JobOutput, JobError> {
        // The same thread runs all jobs.
        if !std::mem::replace(&mut self.is_behind, true) {
            step_back();
        }
        self.runner.run(kind, monitor)
    }
}

/// Something to be made.
pub(super) struct Task<K, T> {
    /// Its name; two tasks of one name make the same thing.
    pub key: K,
    /// Makes the value, on the thread.
    pub work: Box<dyn FnOnce() -> T + Send>,
}

/// A thread that makes things one after another and forgets what nobody wants any more.
pub(super) struct Background<K, T> {
    shared: Arc<Shared<K, T>>,
    has_thread: bool,
    name: &'static str,
}

/// What caller and thread share.
struct Shared<K, T> {
    queue: Mutex<Queue<K, T>>,
    changed: Condvar,
}

struct Queue<K, T> {
    wanted: PerRole<Vec<Task<K, T>>>,
    making: Option<K>,
    /// `None` for work that panicked.
    made: Vec<(K, Option<T>)>,
    is_closed: bool,
}

impl<K, T> Shared<K, T> {
    fn lock(&self) -> MutexGuard<'_, Queue<K, T>> {
        // Work runs outside the lock, so a panic cannot leave the queue half changed.
        self.queue
            .lock()
            .unwrap_or_else(|broken| broken.into_inner())
    }
}

impl<K: Clone + PartialEq + Send + 'static, T: Send + 'static> Background<K, T> {
    /// Nothing runs until something is asked for.
    pub fn new(name: &'static str) -> Self {
        let queue = Queue {
            wanted: PerRole {
                crash: Vec::new(),
                stamped: Vec::new(),
            },
            making: None,
            made: Vec::new(),
            is_closed: false,
        };
        Self {
            shared: Arc::new(Shared {
                queue: Mutex::new(queue),
                changed: Condvar::new(),
            }),
            has_thread: false,
            name,
        }
    }

    /// Takes what was made since the last call and replaces what a window wants. `None` stands for
    /// work that failed.
    pub fn exchange(
        &mut self,
        role: Role,
        wanted: Vec<Task<K, T>>,
        wake: &egui::Context,
    ) -> Vec<(K, Option<T>)> {
        let is_idle = wanted.is_empty();
        let made = {
            let mut queue = self.shared.lock();
            let made = std::mem::take(&mut queue.made);
            let is_under_way = |key: &K| {
                queue.making.as_ref() == Some(key) || made.iter().any(|(done, _)| done == key)
            };
            let wanted = wanted.into_iter();
            let wanted = wanted.filter(|task| !is_under_way(&task.key)).collect();
            *queue.wanted.get_mut(role) = wanted;
            made
        };
        if !is_idle {
            self.shared.changed.notify_one();
            self.start(wake);
        }
        made
    }

    /// True while something is made, waits to be made, or waits to be taken.
    pub fn is_waiting(&self) -> bool {
        let queue = self.shared.lock();
        let has_wanted = queue.wanted.iter().any(|(_, tasks)| !tasks.is_empty());
        has_wanted || queue.making.is_some() || !queue.made.is_empty()
    }

    fn start(&mut self, wake: &egui::Context) {
        if self.has_thread {
            return;
        }
        let (shared, wake) = (Arc::clone(&self.shared), wake.clone());
        let thread = std::thread::Builder::new().name(self.name.to_owned());
        self.has_thread = thread.spawn(move || serve(&shared, &wake)).is_ok();
    }
}

impl<K, T> Drop for Background<K, T> {
    fn drop(&mut self) {
        self.shared.lock().is_closed = true;
        self.shared.changed.notify_all();
    }
}

fn serve<K: Clone + PartialEq, T: Send>(shared: &Shared<K, T>, wake: &egui::Context) {
    let pool = own_threads();
    while let Some(task) = next(shared) {
        let work = || match &pool {
            Some(pool) => pool.install(task.work),
            None => (task.work)(),
        };
        // What half-made data the work leaves behind is dropped with it.
        let made = catch_unwind(AssertUnwindSafe(work)).ok();
        let mut queue = shared.lock();
        queue.making = None;
        queue.made.push((task.key, made));
        drop(queue);
        wake.request_repaint();
    }
}

/// Threads that no job keeps busy, behind the window as jobs are: the picture of one file does not wait until the
/// next one is read. `None` if the system has no threads left.
fn own_threads() -> Option<rayon::ThreadPool> {
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let builder = rayon::ThreadPoolBuilder::new().num_threads(n_cores.div_ceil(2).min(8));
    builder.start_handler(|_| step_back()).build().ok()
}

/// Waits for a task; `None` when the window is gone.
fn next<K: Clone + PartialEq, T>(shared: &Shared<K, T>) -> Option<Task<K, T>> {
    let mut queue = shared.lock();
    loop {
        if queue.is_closed {
            return None;
        }
        let wanted = &mut queue.wanted;
        let lists = [&mut wanted.crash, &mut wanted.stamped];
        let task = lists
            .into_iter()
            .find_map(|list| (!list.is_empty()).then(|| list.remove(0)));
        if let Some(task) = task {
            queue.making = Some(task.key.clone());
            return Some(task);
        }
        queue = shared
            .changed
            .wait(queue)
            .unwrap_or_else(|broken| broken.into_inner());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn task(key: u32) -> Task<u32, u32> {
        Task {
            key,
            work: Box::new(move || {
                assert_ne!(key, 13, "bad luck");
                key * 10
            }),
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn only_the_thread_that_asks_steps_back() {
        let own = || rustix::process::getpriority_process(None).unwrap();
        let before = own();
        let thread = std::thread::Builder::new().name("behind".to_owned());
        let behind = thread.spawn(move || {
            step_back();
            own()
        });
        assert_eq!(behind.unwrap().join().unwrap(), (before + STEP).min(19));
        assert_eq!(own(), before);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_the_window_asks_for_is_made_behind_it() {
        let own = || rustix::process::getpriority_process(None).unwrap();
        let before = own();
        let made = own_threads().unwrap().install(own);
        assert_eq!(made, (before + STEP).min(19));
    }

    #[test]
    fn things_are_made_and_failures_are_told() {
        let mut background = Background::new("test");
        let context = egui::Context::default();
        let mut made = background.exchange(Role::Crash, vec![task(1), task(13)], &context);
        while made.len() < 2 {
            std::thread::sleep(Duration::from_millis(1));
            let wanted = [1, 13]
                .into_iter()
                .filter(|k| !made.iter().any(|(m, _)| m == k));
            let wanted = wanted.map(task).collect();
            made.extend(background.exchange(Role::Crash, wanted, &context));
        }
        assert_eq!(made, [(1, Some(10)), (13, None)]);
    }
}
