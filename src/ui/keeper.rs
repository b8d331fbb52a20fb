//! Writes projects on a thread of its own, so that neither a frame nor a match waits: those the user
//! saves, and the work itself after each step, in case the program does not live to save it.
//!
//! Each run keeps its work in one file of the user's data folder, written beside and renamed. A
//! lock beside it tells whether its program still runs; the system drops it however that ended.

use crate::app::{Document, KeptWork, project_title};
use crate::pipeline::project::{EXTENSION, Project};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Runs whose work is kept.
const MAX_RUNS: usize = 5;
/// A program that was killed a moment ago may still hold its lock, so work that is held is looked at
/// so many times more …
const MORE_LOOKS: usize = 4;
/// … this long after each other.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// What the thread is asked for.
enum Order {
    Write(PathBuf, Box<Project>, Box<Document>),
    Keep(Box<Project>),
    List,
    PutOff,
}

/// What the thread has to say.
#[derive(Debug)]
pub enum Kept {
    /// A project was written that holds this state.
    Written(PathBuf, Box<Document>),
    /// A project could not be written.
    Failed(String),
    /// The work could not be kept.
    NotKept(String),
    /// The work of other runs.
    Works(Vec<KeptWork>),
}

/// The thread as the shell sees it. Dropping it waits for what was ordered and marks the work of
/// this run as ended.
pub struct Keeper {
    sender: Option<Sender<Order>>,
    receiver: Receiver<Kept>,
    thread: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Starts the thread; without a folder nothing is kept. `wake` is called after each order.
    pub fn start(
        folder: Option<PathBuf>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let (sender, orders) = channel();
        let (tell, receiver) = channel();
        let thread = std::thread::Builder::new().name("keeper".to_owned());
        let thread = thread.spawn(move || {
            let mut run = Run::new(folder);
            let mut looks_left = MORE_LOOKS;
            while let Some(first) = run.next_order(&orders, &mut looks_left) {
                let mut orders: Vec<Order> =
                    std::iter::once(first).chain(orders.try_iter()).collect();
                keep_last(&mut orders);
                for order in orders {
                    if let Some(news) = run.carry_out(order) {
                        // The window may have closed meanwhile.
                        let _ = tell.send(news);
                        wake();
                    }
                }
            }
            run.end();
        })?;
        Ok(Self {
            sender: Some(sender),
            receiver,
            thread: Some(thread),
        })
    }

    /// The user's folder for kept work.
    pub fn folder_of_user() -> Option<PathBuf> {
        let folders = directories::ProjectDirs::from("", "", "shapematch")?;
        Some(folders.data_local_dir().join("kept"))
    }

    /// Writes a project to a place of the user's choice.
    pub fn write(&self, path: PathBuf, project: Box<Project>, document: Box<Document>) {
        self.order(Order::Write(path, project, document));
    }

    /// Keeps the work; of several that wait, only the last is written.
    pub fn keep(&self, project: Box<Project>) {
        self.order(Order::Keep(project));
    }

    /// Looks for work of other runs.
    pub fn list(&self) {
        self.order(Order::List);
    }

    /// Marks lost work as seen.
    pub fn put_off(&self) {
        self.order(Order::PutOff);
    }

    /// What was said since the last call.
    pub fn news(&self) -> impl Iterator<Item = Kept> + '_ {
        self.receiver.try_iter()
    }

    fn order(&self, order: Order) {
        if let Some(sender) = &self.sender {
            // The thread lives as long as the sender.
            let _ = sender.send(order);
        }
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            // A panic there was told on standard error; nothing else depends on it.
            let _ = thread.join();
        }
    }
}

/// Leaves only the last order to keep the work.
fn keep_last(orders: &mut Vec<Order>) {
    let is_keep = |order: &Order| matches!(order, Order::Keep(_));
    let n_keep = orders.iter().filter(|order| is_keep(order)).count();
    let mut n_seen = 0;
    orders.retain(|order| {
        n_seen += usize::from(is_keep(order));
        !is_keep(order) || n_seen == n_keep
    });
}

/// The work of this run on disk.
struct Run {
    folder: Option<PathBuf>,
    name: String,
    /// Held while the program runs.
    lock: Option<File>,
    /// Some work was held by another program when it was listed last.
    has_seen_held: bool,
}

impl Run {
    fn new(folder: Option<PathBuf>) -> Self {
        // Names in the order of time.
        let name = format!("{:012}-{}", unix_now(), std::process::id());
        Self {
            folder,
            name,
            lock: None,
            has_seen_held: false,
        }
    }

    /// Waits for an order; meanwhile looks again for work that other programs hold.
    fn next_order(&self, orders: &Receiver<Order>, looks_left: &mut usize) -> Option<Order> {
        match orders.recv_timeout(LOOK_AGAIN) {
            Ok(order) => Some(order),
            Err(RecvTimeoutError::Disconnected) => None,
            Err(RecvTimeoutError::Timeout) => {
                if *looks_left > 0 && self.has_seen_held {
                    *looks_left -= 1;
                    return Some(Order::List);
                }
                orders.recv().ok()
            }
        }
    }

    fn carry_out(&mut self, order: Order) -> Option<Kept> {
        match order {
            Order::Write(path, mut project, document) => {
                project.saved_at = unix_now();
                Some(match project.write(&path) {
                    Ok(()) => Kept::Written(path, document),
                    Err(error) => Kept::Failed(error.to_string()),
                })
            }
            Order::Keep(mut project) => {
                project.saved_at = unix_now();
                self.keep(&project).err().map(Kept::NotKept)
            }
            Order::List => {
                self.has_seen_held = self.runs().iter().any(|path| is_held(path));
                Some(Kept::Works(self.works()))
            }
            Order::PutOff => {
                for path in self.others().into_iter().filter(|path| is_running(path)) {
                    end(&path);
                }
                Some(Kept::Works(self.works()))
            }
        }
    }

    fn path(&self) -> Option<PathBuf> {
        let name = format!("{}.run.{EXTENSION}", self.name);
        Some(self.folder.as_ref()?.join(name))
    }

    fn keep(&mut self, project: &Project) -> Result<(), String> {
        let Some(path) = self.path() else {
            return Ok(());
        };
        project.write(&path).map_err(|error| error.to_string())?;
        if self.lock.is_none() {
            let file = File::create(lock_of(&path)).map_err(|error| error.to_string())?;
            // Where a system has no locks, work of a window that still runs may be offered.
            let _ = file.try_lock();
            self.lock = Some(file);
            self.prune();
        }
        Ok(())
    }

    /// The files of other runs whose programs no longer run, newest first.
    fn others(&self) -> Vec<PathBuf> {
        let mut paths = self.runs();
        paths.retain(|path| !is_held(path));
        paths
    }

    /// The files of all other runs, newest first.
    fn runs(&self) -> Vec<PathBuf> {
        let Some(folder) = &self.folder else {
            return Vec::new();
        };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let is_work = |path: &PathBuf| path.extension().is_some_and(|ending| ending == EXTENSION);
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_work).collect();
        paths.sort();
        paths.reverse();
        let own = self.path();
        paths.retain(|path| Some(path) != own.as_ref());
        paths
    }

    fn works(&self) -> Vec<KeptWork> {
        let work = |path: PathBuf| {
            let (project, _) = Project::read(&path).ok()?;
            Some(KeptWork {
                is_lost: is_running(&path),
                saved_at: project.saved_at,
                title: project_title(&project),
                path,
            })
        };
        self.others().into_iter().filter_map(work).collect()
    }

    /// Forgets the oldest runs.
    fn prune(&self) {
        for path in self.others().into_iter().skip(MAX_RUNS - 1) {
            // What cannot be removed now is tried again by the next run.
            let _ = std::fs::remove_file(lock_of(&path));
            let _ = std::fs::remove_file(path);
        }
    }

    fn end(&mut self) {
        if self.lock.take().is_some()
            && let Some(path) = self.path()
        {
            end(&path);
        }
    }
}

/// True for the work of a run that was not ended.
fn is_running(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    name.is_some_and(|name| name.ends_with(&format!(".run.{EXTENSION}")))
}

fn lock_of(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

/// True if the program of this work still runs.
fn is_held(path: &Path) -> bool {
    let Ok(file) = File::open(lock_of(path)) else {
        return false;
    };
    matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock))
}

/// Marks the work of a run as ended: it is no longer offered, but can be found.
fn end(path: &Path) {
    let name = path.file_name().map(|name| name.to_string_lossy());
    let ended = name.map(|name| name.replace(".run.", ".ended."));
    if let Some(ended) = ended {
        // If that fails, the work is offered once more, which harms no one.
        let _ = std::fs::rename(path, path.with_file_name(ended));
        let _ = std::fs::remove_file(lock_of(path));
    }
}

fn unix_now() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.map_or(0, |now| now.as_secs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(name: &str) -> Box<Project> {
        let file = Some(PathBuf::from(name));
        Box::new(Project {
            crash: Some(crate::pipeline::project::PartEntry {
                file,
                ..Default::default()
            }),
            ..Project::default()
        })
    }

    #[test]
    fn work_of_a_run_that_did_not_end_is_offered_until_it_is_put_off() {
        let folder = tempfile::tempdir().unwrap();
        let of = |name: &str| Run {
            name: name.to_owned(),
            ..Run::new(Some(folder.path().join("deep")))
        };
        let mut lost = of("000000000001-1");
        assert!(lost.carry_out(Order::Keep(project("/a/lost.k"))).is_none());
        let mut next = of("000000000002-1");
        assert_eq!(next.works(), [], "its program still runs");
        // As if it had been killed: the lock goes, the name stays.
        lost.lock = None;
        let works = next.works();
        assert_eq!(works.len(), 1);
        assert!(works[0].is_lost && works[0].saved_at > 0);
        assert_eq!(works[0].title, "lost.k");
        let Some(Kept::Works(works)) = next.carry_out(Order::PutOff) else {
            panic!("the new places are told");
        };
        assert_eq!(works, next.works());
        assert_eq!((works.len(), works[0].is_lost), (1, false));

        next.carry_out(Order::Keep(project("/a/ended.k")));
        next.end();
        let works = of("000000000003-1").works();
        assert_eq!(works.iter().filter(|work| work.is_lost).count(), 0);
        assert_eq!(works[0].title, "ended.k");
    }

    #[test]
    fn work_that_is_held_at_first_is_looked_at_again() {
        let folder = tempfile::tempdir().unwrap();
        let mut dying = Run {
            name: "000000000001-1".to_owned(),
            ..Run::new(Some(folder.path().to_owned()))
        };
        assert!(dying.carry_out(Order::Keep(project("/a/lost.k"))).is_none());
        let keeper = Keeper::start(Some(folder.path().to_owned()), || {}).unwrap();
        keeper.list();
        let works = || match keeper.receiver.recv_timeout(Duration::from_secs(60)) {
            Ok(Kept::Works(works)) => works,
            other => panic!("{other:?}"),
        };
        assert_eq!(works(), []);
        dying.lock = None;
        assert!(works()[0].is_lost);
    }

    #[test]
    fn only_the_last_five_runs_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        for n in 0..9 {
            let mut run = Run {
                name: format!("{n:012}-1"),
                ..Run::new(Some(folder.path().to_owned()))
            };
            run.carry_out(Order::Keep(project(&format!("/{n}.k"))));
            run.end();
        }
        let last = Run::new(Some(folder.path().to_owned()));
        let titles: Vec<String> = last.works().into_iter().map(|work| work.title).collect();
        assert_eq!(titles, ["8.k", "7.k", "6.k", "5.k", "4.k"]);
    }

    #[test]
    fn of_many_orders_to_keep_the_last_counts() {
        let folder = tempfile::tempdir().unwrap();
        let mut orders = vec![
            Order::Keep(project("/1.k")),
            Order::List,
            Order::Keep(project("/2.k")),
        ];
        keep_last(&mut orders);
        assert_eq!(orders.len(), 2);
        let keeper = Keeper::start(Some(folder.path().to_owned()), || {}).unwrap();
        for n in 0..20 {
            keeper.keep(project(&format!("/{n}.k")));
        }
        drop(keeper);
        let works = Run::new(Some(folder.path().to_owned())).works();
        assert_eq!(works.len(), 1);
        assert_eq!((works[0].title.as_str(), works[0].is_lost), ("19.k", false));
    }
}
