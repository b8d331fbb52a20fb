//! Where files come from: the disk, or memory in tests and for bundled decks.
//! The only place below the export that touches the disk.
//!
//! Files are copied into memory by positional reads on all cores. A memory map would end the whole
//! process when another program shortens the file or a network drive fails (`SIGBUS`); here both
//! become an error.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use flate2::bufread::GzDecoder;
use rayon::prelude::*;

use super::FileBytes;
use crate::monitor::{Cancelled, Monitor};

/// Bytes per positional read.
const PIECE: usize = 1 << 20;
/// Bytes between two questions to the monitor.
const WAVE: usize = 16 << 20;
/// How gzip data begin.
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// More bytes than may be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "more than the limit of {} on what is read, unpacked and with all included files; \
     raise it with --read-limit or in the preferences",
    in_gib(*.max_bytes)
)]
pub struct TooLarge {
    /// The limit, [`ReadOptions::max_bytes`](super::ReadOptions::max_bytes).
    pub max_bytes: u64,
}

/// "4 GiB", "0.5 GiB"; with four digits, since a limit is a whole number of bytes and no more than near what was asked.
fn in_gib(n_bytes: u64) -> String {
    let gib = n_bytes as f64 / f64::from(1u32 << 30);
    let rounded: f64 = format!("{gib:.3e}").parse().unwrap_or(gib);
    format!("{rounded} GiB")
}

/// Opens files by path.
pub trait FileSource: Send + Sync {
    /// The bytes of a regular file as they are stored. [`TooLarge`] beyond `max_bytes`;
    /// [`io::ErrorKind::Interrupted`] after a cancel request.
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes>;

    /// A regular file from its start, without holding all of it.
    fn stream(&self, path: &Path) -> io::Result<Box<dyn Read + '_>>;

    /// The path under which a file exists, letter case of its name and its folders ignored if need be.
    fn find(&self, path: &Path) -> Option<PathBuf>;

    /// What stands at a path and is no file, in words.
    fn other_than_file(&self, _path: &Path) -> Option<&'static str> {
        None
    }

    /// What tells that a file was written to; `None` where that is not known.
    fn stamp(&self, _path: &Path) -> Option<FileStamp> {
        None
    }
}

/// Length and time of the last change of a file: the same as long as nothing is written to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileStamp {
    n_bytes: u64,
    changed: Option<SystemTime>,
}

impl From<std::fs::Metadata> for FileStamp {
    fn from(metadata: std::fs::Metadata) -> Self {
        Self {
            n_bytes: metadata.len(),
            changed: metadata.modified().ok(),
        }
    }
}

/// Another source, with the stamps of the files when they were first read.
pub struct CheckedSource<'a> {
    source: &'a dyn FileSource,
    stamps: Mutex<BTreeMap<PathBuf, Option<FileStamp>>>,
}

impl<'a> CheckedSource<'a> {
    /// Nothing is read yet.
    pub fn new(source: &'a dyn FileSource) -> Self {
        Self {
            source,
            stamps: Mutex::default(),
        }
    }

    /// An error if a file was written to since it was first read here.
    pub fn check(&self, path: &Path) -> io::Result<()> {
        let stamps = self.stamps.lock().unwrap_or_else(PoisonError::into_inner);
        match stamps.get(path) {
            Some(first) if *first != self.source.stamp(path) => Err(changed()),
            _ => Ok(()),
        }
    }

    fn note(&self, path: &Path) {
        let mut stamps = self.stamps.lock().unwrap_or_else(PoisonError::into_inner);
        let first = stamps.entry(path.to_path_buf());
        first.or_insert_with(|| self.source.stamp(path));
    }
}

impl FileSource for CheckedSource<'_> {
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
        self.note(path);
        self.source.open(path, max_bytes, monitor)
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn Read + '_>> {
        self.note(path);
        self.source.stream(path)
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        self.source.find(path)
    }

    fn other_than_file(&self, path: &Path) -> Option<&'static str> {
        self.source.other_than_file(path)
    }

    fn stamp(&self, path: &Path) -> Option<FileStamp> {
        self.source.stamp(path)
    }
}

/// The real disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl Disk {
    /// Opens a regular file. Anything else is refused before it is opened: a pipe would wait for
    /// its writer, a device has no end.
    fn open_regular(path: &Path) -> io::Result<(File, std::fs::Metadata)> {
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder"));
        }
        if !metadata.is_file() {
            return Err(io::Error::other(
                "it is a pipe or a device; save it as a file first",
            ));
        }
        let file = File::open(path)?;
        let metadata = file.metadata()?;
        Ok((file, metadata))
    }
}

impl FileSource for Disk {
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
        let (file, before) = Self::open_regular(path)?;
        // Files of a system's own making (`/proc`) have content and no length.
        if before.len() == 0 {
            return read_stream(file, max_bytes, monitor);
        }
        let bytes = read_whole(&file, before.len(), max_bytes, monitor)?;
        if FileStamp::from(file.metadata()?) != FileStamp::from(before) {
            return Err(changed());
        }
        Ok(bytes)
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn Read + '_>> {
        Ok(Box::new(Self::open_regular(path)?.0))
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        of_any_case(path, Path::is_file)
    }

    fn other_than_file(&self, path: &Path) -> Option<&'static str> {
        match std::fs::metadata(path) {
            Ok(found) if found.is_dir() => Some("a folder"),
            Ok(found) if !found.is_file() => Some("a pipe or a device"),
            Ok(_) => None,
            Err(_) => path
                .symlink_metadata()
                .is_ok()
                .then_some("a link that leads nowhere"),
        }
    }

    fn stamp(&self, path: &Path) -> Option<FileStamp> {
        // Files of a system's own making have a new time whenever they are asked for it.
        let metadata = std::fs::metadata(path).ok().filter(|m| m.len() > 0);
        metadata.map(FileStamp::from)
    }
}

/// The file or folder of a path, or one whose name and folders differ in case alone; the path itself first.
fn of_any_case(path: &Path, is_one: fn(&Path) -> bool) -> Option<PathBuf> {
    if is_one(path) {
        return Some(path.to_path_buf());
    }
    let wanted = path.file_name()?.to_str()?.to_lowercase();
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => of_any_case(parent, Path::is_dir)?,
        _ => PathBuf::from("."),
    };
    let mut matches: Vec<PathBuf> = std::fs::read_dir(folder)
        .ok()?
        .flatten()
        .filter(|entry| {
            let name = entry.file_name();
            name.to_str().is_some_and(|n| n.to_lowercase() == wanted)
        })
        .map(|entry| entry.path())
        .collect();
    matches.sort();
    matches.into_iter().find(|found| is_one(found))
}

fn changed() -> io::Error {
    io::Error::other("it changed while it was read; try again when it is complete")
}

pub(super) fn interrupted(cancelled: Cancelled) -> io::Error {
    io::Error::new(io::ErrorKind::Interrupted, cancelled)
}

/// The first `n_bytes` of a file, in pieces on all cores.
fn read_whole(
    file: &File,
    n_bytes: u64,
    max_bytes: u64,
    monitor: &Monitor,
) -> io::Result<FileBytes> {
    let n = usize::try_from(n_bytes).ok();
    let n = n.filter(|_| n_bytes <= max_bytes);
    let n = n.ok_or_else(|| io::Error::other(TooLarge { max_bytes }))?;
    let mut bytes = FileBytes::zeroed(n)?;
    for (wave, part) in bytes.chunks_mut(WAVE).enumerate() {
        monitor.check().map_err(interrupted)?;
        let pieces = part.par_chunks_mut(PIECE).enumerate();
        pieces.try_for_each(|(piece, buffer)| {
            let offset = wave * WAVE + piece * PIECE;
            read_exact_at(file, buffer, offset as u64)
        })?;
    }
    Ok(bytes)
}

fn read_exact_at(file: &File, mut buffer: &mut [u8], mut offset: u64) -> io::Result<()> {
    while !buffer.is_empty() {
        match read_at(file, buffer, offset) {
            Ok(0) => return Err(changed()),
            Ok(n) => {
                buffer = &mut buffer[n..];
                offset += n as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

/// A copy of what memory holds, in pieces on all cores.
fn copied(from: &[u8], max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
    if from.len() as u64 > max_bytes {
        return Err(io::Error::other(TooLarge { max_bytes }));
    }
    let mut bytes = FileBytes::zeroed(from.len())?;
    for (to, from) in bytes.chunks_mut(WAVE).zip(from.chunks(WAVE)) {
        monitor.check().map_err(interrupted)?;
        let pieces = to.par_chunks_mut(PIECE).zip(from.par_chunks(PIECE));
        pieces.for_each(|(to, from)| to.copy_from_slice(from));
    }
    Ok(bytes)
}

/// All of a stream whose length is not known beforehand.
fn read_stream(stream: impl Read, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
    let mut bytes = Vec::new();
    let mut limited = stream.take(max_bytes.saturating_add(1));
    loop {
        monitor.check().map_err(interrupted)?;
        if limited.by_ref().take(WAVE as u64).read_to_end(&mut bytes)? == 0 {
            break;
        }
    }
    if bytes.len() as u64 > max_bytes {
        return Err(io::Error::other(TooLarge { max_bytes }));
    }
    Ok(bytes.into())
}

/// Opens a file and unpacks it if it is gzip by content. The second value counts the bytes behind the packed data,
/// which are passed over.
pub fn open_unpacked(
    source: &dyn FileSource,
    path: &Path,
    max_bytes: u64,
    monitor: &Monitor,
) -> io::Result<(FileBytes, u64)> {
    let mut start = Vec::new();
    source.stream(path)?.take(2).read_to_end(&mut start)?;
    if start != GZIP {
        return Ok((source.open(path, max_bytes, monitor)?, 0));
    }
    let packed = io::BufReader::new(source.stream(path)?);
    let mut members = GzipMembers {
        member: Some(GzDecoder::new(packed)),
        n_after: 0,
    };
    let unpacked = read_stream(&mut members, max_bytes, monitor);
    let bytes = unpacked.map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => io::Error::new(
            io::ErrorKind::UnexpectedEof,
            "its gzip data are cut off; copy or download it again",
        ),
        io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => io::Error::new(
            error.kind(),
            "its gzip data are damaged; copy or download it again",
        ),
        _ => error,
    })?;
    Ok((bytes, members.n_after))
}

/// The members of a gzip file one after the other. Other bytes may follow them, as zeros do on a tape; the program
/// gzip passes over them too.
struct GzipMembers<R> {
    /// `None` behind the last one.
    member: Option<GzDecoder<R>>,
    /// Bytes behind the last one, unless all of them are zero.
    n_after: u64,
}

impl<R: BufRead> Read for GzipMembers<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(mut member) = self.member.take() {
            let read = member.read(buffer);
            if buffer.is_empty() || !matches!(read, Ok(0)) {
                self.member = Some(member);
                return read;
            }
            let mut rest = member.into_inner();
            if rest.fill_buf()?.first() == Some(&GZIP[0]) {
                self.member = Some(GzDecoder::new(rest));
            } else {
                self.n_after = n_until_end(rest)?;
            }
        }
        Ok(0)
    }
}

/// How many bytes are left, 0 if all of them are zero.
fn n_until_end(mut rest: impl BufRead) -> io::Result<u64> {
    let (mut n, mut is_padding) = (0, true);
    loop {
        let bytes = rest.fill_buf()?;
        if bytes.is_empty() {
            return Ok(if is_padding { 0 } else { n });
        }
        is_padding &= bytes.iter().all(|&byte| byte == 0);
        let n_bytes = bytes.len();
        n += n_bytes as u64;
        rest.consume(n_bytes);
    }
}

/// Files held in memory, by path.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl Memory {
    /// No files yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    #[must_use]
    pub fn with(mut self, path: impl AsRef<Path>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(tidy(path.as_ref()), bytes.into());
        self
    }

    fn bytes(&self, path: &Path) -> io::Result<&[u8]> {
        let bytes = self.files.get(&tidy(path));
        Ok(bytes.ok_or(io::ErrorKind::NotFound)?)
    }
}

impl FileSource for Memory {
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
        copied(self.bytes(path)?, max_bytes, monitor)
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn Read + '_>> {
        Ok(Box::new(self.bytes(path)?))
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        let path = tidy(path);
        if self.files.contains_key(&path) {
            return Some(path);
        }
        let wanted = path.to_str()?.to_lowercase();
        let same = |name: &&PathBuf| name.to_str().is_some_and(|n| n.to_lowercase() == wanted);
        self.files.keys().find(same).cloned()
    }
}

/// The files of another source, some of them with other content.
#[derive(Clone, Copy)]
pub struct Replaced<'a> {
    /// Where the other files are.
    pub others: &'a dyn FileSource,
    /// Paths under which files are asked for, each with what it holds instead.
    pub files: &'a [(&'a Path, &'a [u8])],
}

impl<'a> Replaced<'a> {
    fn of(&self, path: &Path) -> Option<&'a [u8]> {
        let path = tidy(path);
        let found = self.files.iter().find(|(own, _)| tidy(own) == path);
        found.map(|(_, bytes)| *bytes)
    }
}

impl FileSource for Replaced<'_> {
    fn open(&self, path: &Path, max_bytes: u64, monitor: &Monitor) -> io::Result<FileBytes> {
        let Some(bytes) = self.of(path) else {
            return self.others.open(path, max_bytes, monitor);
        };
        copied(bytes, max_bytes, monitor)
    }

    fn stream(&self, path: &Path) -> io::Result<Box<dyn Read + '_>> {
        match self.of(path) {
            Some(bytes) => Ok(Box::new(bytes)),
            None => self.others.stream(path),
        }
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        match self.of(path) {
            Some(_) => Some(path.to_path_buf()),
            None => self.others.find(path),
        }
    }

    fn other_than_file(&self, path: &Path) -> Option<&'static str> {
        self.others.other_than_file(path)
    }

    fn stamp(&self, path: &Path) -> Option<FileStamp> {
        match self.of(path) {
            Some(_) => None,
            None => self.others.stamp(path),
        }
    }
}

/// The path without `.` and with `..` worked out as far as the text allows.
pub(crate) fn tidy(path: &Path) -> PathBuf {
    let mut tidied = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                let last = tidied.components().next_back();
                if matches!(last, Some(Component::Normal(_))) {
                    tidied.pop();
                } else {
                    tidied.push("..");
                }
            }
            other => tidied.push(other),
        }
    }
    tidied
}

#[cfg(test)]
mod tests;
