//! Notices, on a thread of its own, that a file on disk no longer has the content that was read from it.
//!
//! Length and time of each file are looked at every few seconds. Where they are new and have come to rest,
//! the content is named again and compared, so that a file that was only touched is no news.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use crate::formats::model::ReadFile;
use crate::formats::{Disk, FileHash};
use crate::monitor::Monitor;

/// Time between two looks at the files.
pub const PAUSE: Duration = Duration::from_secs(2);
/// A file that was written so shortly before the first look at it may have changed since it was read.
const FRESH: Duration = Duration::from_secs(60);

/// The thread as the window sees it. Dropping it ends the thread.
pub struct FileWatch {
    sender: Option<Sender<Vec<ReadFile>>>,
    receiver: Receiver<BTreeSet<PathBuf>>,
    thread: Option<JoinHandle<()>>,
    monitor: Monitor,
}

impl FileWatch {
    /// Starts the thread, which looks at the files again after each pause; `wake` is called when it has news.
    pub fn start(pause: Duration, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (sender, requests) = channel();
        let (news, receiver) = channel();
        let monitor = Monitor::silent();
        let thread = std::thread::Builder::new().name("file watch".to_owned());
        let mut looks = Looks::new(monitor.clone());
        let thread = thread.spawn(move || {
            while looks.wait(&requests, pause) {
                if let Some(changed) = looks.look() {
                    // The window may have closed meanwhile.
                    let _ = news.send(changed);
                    wake();
                }
            }
        })?;
        Ok(Self {
            sender: Some(sender),
            receiver,
            thread: Some(thread),
            monitor,
        })
    }

    /// The files to look at from now on, with the content that was read. Those without a name of their content
    /// are passed over.
    pub fn watch(&self, files: Vec<ReadFile>) {
        if let Some(sender) = &self.sender {
            // The thread lives as long as the sender.
            let _ = sender.send(files);
        }
    }

    /// The files that have another content now, all of them, if that is other than at the last call.
    pub fn news(&self) -> Option<BTreeSet<PathBuf>> {
        self.receiver.try_iter().last()
    }

    /// The next news; `None` if there is none for so long.
    pub fn wait_for_news(&self, timeout: Duration) -> Option<BTreeSet<PathBuf>> {
        self.receiver.recv_timeout(timeout).ok()
    }
}

impl Drop for FileWatch {
    fn drop(&mut self) {
        self.sender = None;
        self.monitor.request_cancel();
        if let Some(thread) = self.thread.take() {
            // A panic there was told on standard error; nothing else depends on it.
            let _ = thread.join();
        }
    }
}

/// Length and time of a file.
type State = (u64, Option<SystemTime>);

/// What the thread knows.
struct Looks {
    files: Vec<ReadFile>,
    /// The content of each file in the state in which it was last at rest.
    known: BTreeMap<PathBuf, (State, FileHash)>,
    /// States that are new; a file that has the same one at the next look is at rest.
    new: BTreeMap<PathBuf, State>,
    /// What was told last.
    told: BTreeSet<PathBuf>,
    monitor: Monitor,
}

impl Looks {
    fn new(monitor: Monitor) -> Self {
        Self {
            files: Vec::new(),
            known: BTreeMap::new(),
            new: BTreeMap::new(),
            told: BTreeSet::new(),
            monitor,
        }
    }

    /// Waits for the next look; false if there is none any more.
    fn wait(&mut self, requests: &Receiver<Vec<ReadFile>>, pause: Duration) -> bool {
        let request = if self.files.is_empty() {
            requests.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            requests.recv_timeout(pause)
        };
        match request {
            Ok(files) => self.take(requests.try_iter().last().unwrap_or(files)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        true
    }

    /// Other files, or the same ones as they were read anew: of these nothing is known.
    fn take(&mut self, files: Vec<ReadFile>) {
        let before: BTreeMap<&Path, _> = self
            .files
            .iter()
            .map(|file| (file.path.as_path(), &file.hash))
            .collect();
        for file in &files {
            let path = file.path.as_path();
            if before.get(path).is_some_and(|hash| **hash != file.hash) {
                self.known.remove(path);
                self.new.remove(path);
            }
        }
        self.files = files;
    }

    /// Looks at each file once; the changed ones, if they are others than those told last.
    fn look(&mut self) -> Option<BTreeSet<PathBuf>> {
        let files = std::mem::take(&mut self.files);
        let mut changed = BTreeSet::new();
        for file in &files {
            if self.has_changed(file) {
                changed.insert(file.path.clone());
            }
        }
        self.files = files;
        if changed == self.told {
            return None;
        }
        self.told.clone_from(&changed);
        Some(changed)
    }

    /// A file that is being written, or that is gone for a moment while it is replaced, is as it was.
    fn has_changed(&mut self, file: &ReadFile) -> bool {
        let Some(read) = file.hash else {
            return false;
        };
        let path = &file.path;
        if let Some(state) = state_of(path) {
            match self.known.get(path) {
                Some((known, _)) if *known == state => {}
                None if !is_fresh(state) => {
                    self.known.insert(path.clone(), (state, read));
                }
                _ if self.new.get(path) == Some(&state) => self.name_again(path, state),
                _ => {
                    self.new.insert(path.clone(), state);
                }
            }
        }
        self.known.get(path).is_some_and(|(_, hash)| *hash != read)
    }

    fn name_again(&mut self, path: &Path, state: State) {
        // What cannot be read now is looked at again.
        if let Ok(hash) = FileHash::of_file(&Disk, path, &self.monitor) {
            self.known.insert(path.to_owned(), (state, hash));
            self.new.remove(path);
        }
    }
}

fn state_of(path: &Path) -> Option<State> {
    let about = std::fs::metadata(path)
        .ok()
        .filter(|about| about.is_file())?;
    Some((about.len(), about.modified().ok()))
}

fn is_fresh((_, modified): State) -> bool {
    let age = modified.and_then(|at| SystemTime::now().duration_since(at).ok());
    age.is_none_or(|age| age < FRESH)
}
