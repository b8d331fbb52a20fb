//! The one way in which files are written: whole or not at all.

use std::fs::{self, File, Metadata};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use super::PipelineError;
use crate::monitor::{Cancelled, Monitor};

/// Bytes that are written and flushed between two questions for a cancel.
const PIECE: usize = 8 << 20;
/// Files that are being written and have no name of their own yet.
static UNFINISHED: Unfinished = Unfinished(Mutex::new(Vec::new()));
/// Links that are followed before a path counts as a loop.
const MAX_LINKS: usize = 40;

/// Temporary files, to be removed where the program is ended from outside.
struct Unfinished(Mutex<Vec<PathBuf>>);

impl Unfinished {
    /// Makes one, and forgets those that are gone or have got their name.
    fn add<F>(
        &self,
        make: impl FnOnce() -> io::Result<NamedTempFile<F>>,
    ) -> io::Result<NamedTempFile<F>> {
        // Under the lock, so that none is made without being listed.
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let file = make()?;
        paths.retain(|path| path.exists());
        paths.push(file.path().to_path_buf());
        Ok(file)
    }

    /// Removes all of them. None is made while `then` runs.
    #[cfg(any(unix, test))]
    fn remove_then(&self, then: impl FnOnce()) {
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        for path in paths.drain(..) {
            // One that has got its name is not there any more.
            let _ = fs::remove_file(path);
        }
        then();
    }
}

/// Removes what is half written when the program is ended by Ctrl+C or by another program, and then ends it as it
/// would have ended.
#[cfg(unix)]
pub fn clean_up_on_signals() -> io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            if let Some(signal) = signals.forever().next() {
                UNFINISHED.remove_then(|| {
                    let _ = signal_hook::low_level::emulate_default_handler(signal);
                });
            }
        })?;
    Ok(())
}

/// Writes a file so that its name stands for the old content or for all of the new one, whatever
/// happens meanwhile: the bytes go to a new file beside it, are flushed to the disk, and take its
/// place in one step. Permissions of the old file are kept, links are followed. Devices and pipes
/// are written directly.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    ReadyFile::new(path, |file| file.write_all(bytes))
        .and_then(ReadyFile::take_place)
        .map_err(failed(path))
}

/// [`write_file`] that ends soon after `monitor` is cancelled, the old content kept.
pub fn write_file_unless_cancelled(
    path: &Path,
    bytes: &[u8],
    monitor: &Monitor,
) -> Result<(), PipelineError> {
    write_files_unless_cancelled(&[(path, bytes)], monitor)
}

/// Files that belong together: all keep their old content where one cannot be written, or `monitor` is cancelled. None
/// takes the place of an old one before all of them are written and flushed, and what was replaced comes back where one
/// cannot take its place then, as of a file that another program holds open.
pub fn write_files_unless_cancelled(
    files: &[(&Path, &[u8])],
    monitor: &Monitor,
) -> Result<(), PipelineError> {
    let mut ready = Vec::new();
    for &(path, bytes) in files {
        ready.push((path, ready_unless_cancelled(path, bytes, monitor)?));
    }
    take_places(ready)
}

/// All files or none. The old ones are kept until the last has taken its place.
fn take_places(ready: Vec<(&Path, ReadyFile)>) -> Result<(), PipelineError> {
    let (n, mut replaced) = (ready.len(), Vec::new());
    for (i, (path, file)) in ready.into_iter().enumerate() {
        let replace = || {
            let is_last = i + 1 == n;
            let replaced = if is_last { None } else { file.replaced()? };
            file.take_place()?;
            Ok(replaced)
        };
        match replace() {
            Ok(file) => replaced.extend(file),
            Err(error) => {
                replaced.into_iter().for_each(Replaced::come_back);
                return Err(failed(path)(error));
            }
        }
    }
    Ok(())
}

fn ready_unless_cancelled(
    path: &Path,
    bytes: &[u8],
    monitor: &Monitor,
) -> Result<ReadyFile, PipelineError> {
    let write = |file: &mut File| {
        let is_flushed = bytes.len() > PIECE && file.metadata()?.is_file();
        for piece in bytes.chunks(PIECE) {
            monitor.check().map_err(io::Error::other)?;
            file.write_all(piece)?;
            // A flush cannot be ended, so none may have much to do.
            if is_flushed {
                file.sync_data()?;
            }
        }
        monitor.check().map_err(io::Error::other)
    };
    ReadyFile::new(path, write).map_err(|error| match error.downcast::<Cancelled>() {
        Ok(cancelled) => cancelled.into(),
        Err(error) => failed(path)(error),
    })
}

/// [`write_file`] for a file that must not be there yet; `false` if it is, which changes nothing.
pub fn write_new_file(path: &Path, bytes: &[u8]) -> Result<bool, PipelineError> {
    let write = || {
        if path.symlink_metadata().is_ok() {
            return Ok(false);
        }
        let beside = new_beside(path, None, |file| file.write_all(bytes))?;
        match beside.persist_noclobber(path) {
            Ok(_) => Ok(true),
            Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(error.error),
        }
    };
    write().map_err(failed(path))
}

/// [`write_file`] into a folder that is made if need be.
pub fn write_file_in_new_folder(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(|error| {
        if folder.is_file() {
            failed(folder)(io::Error::other("it is a file, not a folder"))
        } else {
            failed(path)(error)
        }
    })?;
    write_file(path, bytes)
}

fn failed(path: &Path) -> impl Fn(io::Error) -> PipelineError {
    |error| PipelineError::Write {
        path: path.to_path_buf(),
        reason: error.to_string(),
    }
}

/// A file that is written and flushed.
enum ReadyFile {
    /// A device or a pipe, which has the bytes already.
    Direct,
    /// A new file beside the path that it is for.
    Beside(NamedTempFile, PathBuf),
}

impl ReadyFile {
    fn new(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<Self> {
        // A device or a pipe, which may have no name behind its links.
        if fs::metadata(path).is_ok_and(|old| !old.is_file() && !old.is_dir()) {
            write(&mut File::options().write(true).open(path)?)?;
            return Ok(Self::Direct);
        }
        let path = followed(path)?;
        let old = match fs::metadata(&path) {
            Ok(old) if old.is_dir() => return Err(io::Error::other("it is a folder")),
            Ok(old) => Some(old),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let beside = new_beside(&path, old.as_ref(), write)?;
        Ok(Self::Beside(beside, path))
    }

    /// What is there now, kept.
    fn replaced(&self) -> io::Result<Option<Replaced>> {
        let Self::Beside(_, path) = self else {
            return Ok(None);
        };
        let keep = |name: &Path| {
            // Not every file system has links.
            fs::hard_link(path, name).or_else(|_| fs::copy(path, name).map(drop))
        };
        let kept = || file_names().make_in(folder_of(path), keep);
        let old = path.try_exists()?.then(|| UNFINISHED.add(kept));
        Ok(Some(Replaced {
            path: path.clone(),
            old: old.transpose()?,
        }))
    }

    fn take_place(self) -> io::Result<()> {
        if let Self::Beside(file, path) = self {
            file.persist(&path).map_err(|error| error.error)?;
            sync_folder(folder_of(&path));
        }
        Ok(())
    }
}

/// A file whose place another one takes, by a further name; it goes when it is dropped.
struct Replaced {
    path: PathBuf,
    /// `None` where there was no file.
    old: Option<NamedTempFile<()>>,
}

impl Replaced {
    fn come_back(self) {
        // Where even that fails, the new file stays, which is whole.
        let _ = match self.old {
            Some(old) => old.persist(&self.path).map(drop).map_err(|e| e.error),
            None => fs::remove_file(&self.path),
        };
    }
}

/// A complete file in the folder of `path`, flushed to the disk; it goes when it is dropped.
fn new_beside(
    path: &Path,
    old: Option<&Metadata>,
    write: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    let mut beside = new_file_in(folder_of(path))?;
    write(beside.as_file_mut())?;
    if let Some(old) = old {
        keep_owner(beside.as_file(), old);
        beside.as_file().set_permissions(old.permissions())?;
    }
    beside.as_file().sync_all()?;
    Ok(beside)
}

/// Names of files that are made for a moment.
fn file_names<'a>() -> tempfile::Builder<'a, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".shapematch-");
    builder
}

/// A new file in a folder, with the permissions that the user's other new files have.
pub(super) fn new_file_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = file_names();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // The error would name the file, which nobody asked for.
    let unnamed = |error: io::Error| io::Error::from(error.kind());
    UNFINISHED.add(|| builder.tempfile_in(folder).map_err(unnamed))
}

/// Gives the new file the owner of the old one, where the system lets us.
#[cfg(unix)]
fn keep_owner(file: &File, old: &Metadata) {
    use std::os::unix::fs::{MetadataExt as _, fchown};
    // Only an administrator may; a file of one's own is as good.
    let _ = fchown(file, Some(old.uid()), Some(old.gid()));
}

#[cfg(not(unix))]
fn keep_owner(_file: &File, _old: &Metadata) {}

/// Makes the new name last through a loss of power, where folders can be flushed.
fn sync_folder(folder: &Path) {
    if cfg!(unix)
        && let Ok(folder) = File::open(folder)
    {
        // The file is whole in either case.
        let _ = folder.sync_all();
    }
}

/// The path that a path leads to through links; its last piece need not exist.
pub(super) fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(to) => path = folder_of(&path).join(to),
            // No link, or nothing there.
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("its links lead in a circle"))
}

/// The folder a file lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_old_file_survives_a_write_that_fails() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.k");
        write_file(&path, b"old").unwrap();
        let full_disk = |file: &mut File| {
            file.write_all(b"half of the n")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        };
        assert!(ReadyFile::new(&path, full_disk).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        let fresh = folder.path().join("b.k");
        assert!(ReadyFile::new(&fresh, full_disk).is_err());
        assert_eq!(names(folder.path()), ["a.k"], "nothing is left behind");
    }

    #[test]
    fn of_files_that_belong_together_none_is_replaced_where_one_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let [deck, table] = ["deck.k", "table.k"].map(|name| folder.path().join(name));
        let monitor = Monitor::silent();
        let write = |bytes: &[u8]| {
            let files: [(&Path, &[u8]); 2] = [(&deck, bytes), (&table, bytes)];
            write_files_unless_cancelled(&files, &monitor)
        };
        write(b"old").unwrap();
        assert_eq!(names(folder.path()), ["deck.k", "table.k"]);
        fs::remove_file(&table).unwrap();
        fs::create_dir(&table).unwrap();
        assert!(matches!(write(b"new"), Err(PipelineError::Write { path, .. }) if path == table));
        assert_eq!(fs::read(&deck).unwrap(), b"old");
        fs::remove_dir(&table).unwrap();
        write(b"new").unwrap();
        assert_eq!(fs::read(&deck).unwrap(), b"new");
        assert_eq!(
            names(folder.path()),
            ["deck.k", "table.k"],
            "nothing is left behind"
        );
    }

    #[test]
    fn what_was_replaced_comes_back_where_a_later_file_cannot_take_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let [old, fresh, late] = ["a.k", "b.k", "c.k"].map(|name| folder.path().join(name));
        write_file(&old, b"old").unwrap();
        let ready = || {
            let ready = |path: &PathBuf| ReadyFile::new(path, |file| file.write_all(b"new"));
            let files = [&old, &fresh, &late].map(|path| (path.as_path(), ready(path).unwrap()));
            Vec::from(files)
        };
        let files = ready();
        fs::create_dir(&late).unwrap();
        let error = take_places(files).unwrap_err();
        assert!(matches!(error, PipelineError::Write { path, .. } if path == late));
        assert_eq!(fs::read(&old).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.k", "c.k"]);
        fs::remove_dir(&late).unwrap();
        take_places(ready()).unwrap();
        for path in [&old, &fresh, &late] {
            assert_eq!(fs::read(path).unwrap(), b"new");
        }
        assert_eq!(names(folder.path()), ["a.k", "b.k", "c.k"]);
    }

    #[test]
    fn files_that_are_being_written_go_where_the_program_ends() {
        let folder = tempfile::tempdir().unwrap();
        let unfinished = Unfinished(Mutex::new(Vec::new()));
        let make = || tempfile::Builder::new().tempfile_in(folder.path());
        let first = unfinished.add(make).unwrap();
        first.persist(folder.path().join("whole")).unwrap();
        let _second = unfinished.add(make).unwrap();
        assert_eq!(names(folder.path()).len(), 2);
        unfinished.remove_then(|| assert_eq!(names(folder.path()), ["whole"]));
    }

    #[test]
    fn a_cancelled_write_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.k");
        let new: Vec<u8> = (0..2 * PIECE + 5).map(|i| i as u8).collect();
        let monitor = Monitor::silent();
        write_file_unless_cancelled(&path, &new, &monitor).unwrap();
        assert!(fs::read(&path).unwrap() == new);
        monitor.request_cancel();
        let cancelled = write_file_unless_cancelled(&path, b"newer", &monitor).unwrap_err();
        assert!(matches!(cancelled, PipelineError::Cancelled(_)));
        assert!(fs::read(&path).unwrap() == new);
        assert_eq!(names(folder.path()), ["a.k"], "nothing is left behind");
    }

    #[test]
    fn a_file_that_is_there_is_replaced_or_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.k");
        assert!(write_new_file(&path, b"first").unwrap());
        assert!(!write_new_file(&path, b"second").unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"first");
        write_file(&path, b"third").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"third");
        assert!(write_file(folder.path(), b"x").is_err());
        assert_eq!(names(folder.path()), ["a.k"]);
    }

    #[test]
    #[cfg(unix)]
    fn permissions_are_kept_and_links_followed() {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        fs::write(at("plain"), b"").unwrap();
        write_file(&at("new"), b"new").unwrap();
        assert_eq!(mode(&at("new")), mode(&at("plain")), "as any new file");
        fs::set_permissions(at("new"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("new", at("link")).unwrap();
        write_file(&at("link"), b"newer").unwrap();
        assert_eq!(fs::read_link(at("link")).unwrap(), Path::new("new"));
        assert_eq!(fs::read(at("new")).unwrap(), b"newer");
        assert_eq!(mode(&at("new")), 0o640);
        symlink("later", at("dangling")).unwrap();
        write_file(&at("dangling"), b"x").unwrap();
        assert_eq!(fs::read(at("later")).unwrap(), b"x");
        symlink("b", at("a")).unwrap();
        symlink("a", at("b")).unwrap();
        assert!(write_file(&at("a"), b"x").is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn devices_are_written_directly() {
        write_file(Path::new("/dev/null"), b"x").unwrap();
        let (many, monitor) = (vec![b'x'; PIECE + 1], Monitor::silent());
        write_file_unless_cancelled(Path::new("/dev/null"), &many, &monitor).unwrap();
        let full = write_file(Path::new("/dev/full"), b"x").unwrap_err();
        assert!(full.to_string().contains("/dev/full"), "{full}");
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
