//! Saves projects on a thread of its own, so that neither a frame nor a match waits: those the user
//! saves, and the session itself after each step, in case the program ends without saving.
//!
//! Each run of the program keeps its session in one file of the user's data folder. A lock beside it
//! tells whether its program still runs; the system releases the lock however the program ended. Work that
//! was saved as a project has nothing to recover: its session ends until the next step.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::ErrorKind::NotFound;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::PipelineError;
use super::names::file_name;
use super::outputs::{Content, Target, overwritten_inputs};
use super::project::{EXTENSION, Project, ProjectError};

/// Runs whose sessions are kept.
const MAX_RUNS: usize = 5;
/// A program that was killed a moment ago may still hold its lock, so sessions that are held are
/// looked at so many times more …
const MORE_LOOKS: usize = 4;
/// … this long after each other.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// The session of another run, found in its autosave.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecoveredSession {
    /// File the work is kept in.
    pub path: PathBuf,
    /// When it was saved last, in seconds since 1970 (UTC).
    pub saved_at: u64,
    /// What it holds: the files and what was done.
    pub title: String,
    /// True if its program did not end properly.
    pub is_lost: bool,
}

/// What the thread is asked for. `S` is what the caller wants back with a project that was saved.
enum Request<S> {
    Save(PathBuf, Option<u64>, Box<Project>, S),
    Autosave(Box<Project>),
    List,
    DismissRecovery,
}

/// What the thread has done.
#[derive(Debug)]
pub enum AutosaveEvent<S> {
    /// A project was saved, at a time in seconds since 1970.
    Saved(PathBuf, u64, S),
    /// A project could not be saved.
    SaveFailed(String),
    /// A project was not saved over what another window has saved there.
    SavedElsewhere(String),
    /// The session could not be autosaved.
    AutosaveFailed(String),
    /// The sessions of other runs, newest first.
    Sessions(Vec<RecoveredSession>),
}

/// Why a project is not saved.
enum NotSaved {
    /// It cannot be.
    Failed(String),
    /// Another window has saved it meanwhile.
    Elsewhere(String),
}

/// The thread as the window sees it. Dropping it waits for what was requested and marks the session
/// of this run as ended.
pub struct Autosave<S> {
    sender: Option<Sender<Request<S>>>,
    receiver: Receiver<AutosaveEvent<S>>,
    thread: Option<JoinHandle<()>>,
}

impl<S: Send + 'static> Autosave<S> {
    /// Starts the thread; without a folder no session is kept. `wake` is called after each request.
    pub fn start(
        folder: Option<PathBuf>,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        Self::start_run(Session::new(folder), wake)
    }

    /// [`Autosave::start`] under a name of one's own for the file of the session; names sort by
    /// time.
    pub fn start_named(
        folder: PathBuf,
        name: &str,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let session = Session {
            name: name.to_owned(),
            ..Session::new(Some(folder))
        };
        Self::start_run(session, wake)
    }

    fn start_run(mut session: Session, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (sender, requests) = channel();
        let (events, receiver) = channel();
        let thread = std::thread::Builder::new().name("autosave".to_owned());
        let thread = thread.spawn(move || {
            let mut looks_left = MORE_LOOKS;
            while let Some(first) = session.next_request(&requests, &mut looks_left) {
                let mut requests: Vec<Request<S>> =
                    std::iter::once(first).chain(requests.try_iter()).collect();
                keep_last(&mut requests);
                for request in requests {
                    if let Some(event) = session.carry_out(request) {
                        // The window may have closed meanwhile.
                        let _ = events.send(event);
                        wake();
                    }
                }
            }
            session.end();
        })?;
        Ok(Self {
            sender: Some(sender),
            receiver,
            thread: Some(thread),
        })
    }

    /// Saves a project where the user wants it; `state` comes back with the news. With `replaces` only the
    /// project saved at that time, or by this run, is written over: several windows may have opened the same one.
    pub fn save(&self, path: PathBuf, replaces: Option<u64>, project: Box<Project>, state: S) {
        self.request(Request::Save(path, replaces, project, state));
    }

    /// Saves the session; of several that wait, only the last is written.
    pub fn autosave(&self, project: Box<Project>) {
        self.request(Request::Autosave(project));
    }

    /// Looks for sessions of other runs.
    pub fn list(&self) {
        self.request(Request::List);
    }

    /// Marks lost sessions as seen.
    pub fn dismiss_recovery(&self) {
        self.request(Request::DismissRecovery);
    }

    /// What was done since the last call.
    pub fn events(&self) -> impl Iterator<Item = AutosaveEvent<S>> + '_ {
        self.receiver.try_iter()
    }

    /// The next event; `None` if there is none for so long.
    pub fn wait_for_event(&self, timeout: Duration) -> Option<AutosaveEvent<S>> {
        self.receiver.recv_timeout(timeout).ok()
    }

    fn request(&self, request: Request<S>) {
        if let Some(sender) = &self.sender {
            // The thread lives as long as the sender.
            let _ = sender.send(request);
        }
    }
}

impl<S> Drop for Autosave<S> {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            // A panic there was told on standard error; nothing else depends on it.
            let _ = thread.join();
        }
    }
}

/// Leaves only the last request to save the session.
fn keep_last<S>(requests: &mut Vec<Request<S>>) {
    let is_autosave = |request: &Request<S>| matches!(request, Request::Autosave(_));
    let n_autosaves = requests
        .iter()
        .filter(|request| is_autosave(request))
        .count();
    let mut n_seen = 0;
    requests.retain(|request| {
        n_seen += usize::from(is_autosave(request));
        !is_autosave(request) || n_seen == n_autosaves
    });
}

/// Saves a project, unless that would overwrite one of its parts' files.
fn save(path: &Path, project: &Project) -> Result<(), String> {
    let parts = project.parts.iter();
    let files: Vec<PathBuf> = parts
        .filter_map(|(_, part)| part.as_ref()?.file.clone())
        .collect();
    let target = Target {
        name: "the project".to_owned(),
        path: path.to_path_buf(),
        content: Content::Text,
    };
    match overwritten_inputs(&[target], &files).first() {
        Some(refusal) => Err(refusal.to_string()),
        None => project.write(path).map_err(|error| error.to_string()),
    }
}

/// The session of this run on disk.
struct Session {
    folder: Option<PathBuf>,
    name: String,
    /// Held while the program runs.
    lock: Option<File>,
    /// Some session was held by another program when they were listed last.
    has_seen_held: bool,
    /// The projects that this run saved, and when.
    saved: BTreeMap<PathBuf, u64>,
}

impl Session {
    fn new(folder: Option<PathBuf>) -> Self {
        // Names in the order of time.
        let name = format!("{:012}-{}", unix_now(), std::process::id());
        Self {
            folder,
            name,
            lock: None,
            has_seen_held: false,
            saved: BTreeMap::new(),
        }
    }

    /// Waits for a request; meanwhile looks again for sessions that other programs hold.
    fn next_request<S>(
        &self,
        requests: &Receiver<Request<S>>,
        looks_left: &mut usize,
    ) -> Option<Request<S>> {
        match requests.recv_timeout(LOOK_AGAIN) {
            Ok(request) => Some(request),
            Err(RecvTimeoutError::Disconnected) => None,
            Err(RecvTimeoutError::Timeout) => {
                if *looks_left > 0 && self.has_seen_held {
                    *looks_left -= 1;
                    return Some(Request::List);
                }
                requests.recv().ok()
            }
        }
    }

    fn carry_out<S>(&mut self, request: Request<S>) -> Option<AutosaveEvent<S>> {
        match request {
            Request::Save(path, replaces, mut project, state) => {
                project.saved_at = unix_now();
                let saved = self.may_replace(&path, replaces);
                let saved = saved.and_then(|()| save(&path, &project).map_err(NotSaved::Failed));
                Some(match saved {
                    Ok(()) => {
                        self.saved.insert(path.clone(), project.saved_at);
                        // Nothing is left to be recovered until the next step.
                        self.end();
                        AutosaveEvent::Saved(path, project.saved_at, state)
                    }
                    Err(NotSaved::Failed(reason)) => AutosaveEvent::SaveFailed(reason),
                    Err(NotSaved::Elsewhere(reason)) => AutosaveEvent::SavedElsewhere(reason),
                })
            }
            Request::Autosave(mut project) => {
                project.saved_at = unix_now();
                let saved = self.autosave(&project);
                saved
                    .err()
                    .map(|error| AutosaveEvent::AutosaveFailed(error.to_string()))
            }
            Request::List => {
                self.has_seen_held = self.runs().iter().any(|path| is_held(path));
                Some(AutosaveEvent::Sessions(self.sessions()))
            }
            Request::DismissRecovery => {
                for path in self.others().into_iter().filter(|path| is_running(path)) {
                    end(&path);
                }
                Some(AutosaveEvent::Sessions(self.sessions()))
            }
        }
    }

    /// Refuses to write over what another program saved since this one opened or saved the project, and over
    /// what cannot be read, which may be work all the same.
    fn may_replace(&self, path: &Path, replaces: Option<u64>) -> Result<(), NotSaved> {
        let Some(opened) = replaces else {
            return Ok(());
        };
        if std::fs::metadata(path)
            .map_or_else(|error| error.kind() == NotFound, |file| file.len() == 0)
        {
            return Ok(());
        }
        let name = file_name(path);
        let present = match Project::read(path) {
            Ok((present, _)) => present.saved_at,
            Err(ProjectError::Newer { .. }) => {
                return Err(NotSaved::Failed(format!(
                    "a newer version of shapematch has saved {name} since it was opened here"
                )));
            }
            Err(_) => {
                return Err(NotSaved::Failed(format!(
                    "{name} has changed since it was opened here and cannot be read as a project"
                )));
            }
        };
        let own = self.saved.get(path).copied();
        if present == opened || Some(present) == own {
            return Ok(());
        }
        Err(NotSaved::Elsewhere(format!(
            "another window has saved {name} since it was opened here"
        )))
    }

    fn path(&self) -> Option<PathBuf> {
        let name = format!("{}.run.{EXTENSION}", self.name);
        Some(self.folder.as_ref()?.join(name))
    }

    fn autosave(&mut self, project: &Project) -> Result<(), PipelineError> {
        let Some(path) = self.path() else {
            return Ok(());
        };
        let is_first = self.lock.is_none();
        if is_first {
            // Before the session is there: no other window is to take it for one that was lost.
            self.lock = Some(locked(lock_of(&path))?);
        }
        project.write_in_new_folder(&path)?;
        if is_first {
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
        let is_session = |path: &PathBuf| path.extension().is_some_and(|e| e == EXTENSION);
        let paths = entries.map(|entry| entry.path()).filter(is_session);
        let mut paths: Vec<PathBuf> = paths.collect();
        paths.sort();
        paths.reverse();
        // A session of this run may have ended too, where its work was saved.
        let own = format!("{}.", self.name);
        let name = |path: &PathBuf| {
            path.file_name()
                .map(|name| name.to_string_lossy().into_owned())
        };
        paths.retain(|path| !name(path).is_some_and(|name| name.starts_with(&own)));
        paths
    }

    fn sessions(&self) -> Vec<RecoveredSession> {
        let session = |path: PathBuf| {
            let (project, _) = Project::read(&path).ok()?;
            Some(RecoveredSession {
                is_lost: is_running(&path),
                saved_at: project.saved_at,
                title: project.title(),
                path,
            })
        };
        self.others().into_iter().filter_map(session).collect()
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

/// True for the session of a run that was not ended.
fn is_running(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy());
    name.is_some_and(|name| name.ends_with(&format!(".run.{EXTENSION}")))
}

fn lock_of(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

/// The lock of a session, held until the file is dropped. Others who look whether it is held do so for a moment.
fn locked(path: PathBuf) -> Result<File, PipelineError> {
    let file = (path.parent().map_or(Ok(()), std::fs::create_dir_all))
        .and_then(|()| File::create(&path))
        .map_err(|error| PipelineError::Write {
            path,
            reason: error.to_string(),
        })?;
    // Where a system has no locks, the session of a window that still runs may be offered.
    let _ = file.lock();
    Ok(file)
}

/// True if the program of this session still runs.
fn is_held(path: &Path) -> bool {
    let Ok(file) = File::open(lock_of(path)) else {
        return false;
    };
    matches!(
        file.try_lock_shared(),
        Err(std::fs::TryLockError::WouldBlock)
    )
}

/// Marks the session of a run as ended: it is no longer offered, but can be found.
fn end(path: &Path) {
    let name = path.file_name().map(|name| name.to_string_lossy());
    let ended = name.map(|name| name.replace(".run.", ".ended."));
    if let Some(ended) = ended {
        // If that fails, the session is offered once more, which harms no one.
        let _ = std::fs::rename(path, path.with_file_name(ended));
        let _ = std::fs::remove_file(lock_of(path));
    }
}

fn unix_now() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.map_or(0, |now| now.as_secs())
}
