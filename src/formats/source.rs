//! Where files come from: the disk, or memory in tests and for bundled decks.
//! The only place below the export that touches the disk.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::ops::Deref;
use std::path::{Component, Path, PathBuf};

/// The bytes of one file, mapped or owned.
#[derive(Debug)]
pub enum Bytes {
    /// A read-only map of a file on disk.
    Mapped(memmap2::Mmap),
    /// Bytes in memory, for example an unpacked `.gz`.
    Owned(Vec<u8>),
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Mapped(map) => map,
            Self::Owned(bytes) => bytes,
        }
    }
}

/// Opens files by path.
pub trait FileSource: Send + Sync {
    /// The bytes of a file as they are stored.
    fn open(&self, path: &Path) -> io::Result<Bytes>;

    /// The path under which a file exists, letter case of its name ignored if need be.
    fn find(&self, path: &Path) -> Option<PathBuf>;
}

/// The real disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl FileSource for Disk {
    fn open(&self, path: &Path) -> io::Result<Bytes> {
        let file = std::fs::File::open(path)?;
        let metadata = file.metadata()?;
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder"));
        }
        // An empty file cannot be mapped, and a pipe has no length.
        if metadata.len() == 0 {
            let mut bytes = Vec::new();
            (&file).read_to_end(&mut bytes)?;
            return Ok(Bytes::Owned(bytes));
        }
        map(&file).map(Bytes::Mapped)
    }

    fn find(&self, path: &Path) -> Option<PathBuf> {
        if path.is_file() {
            return Some(path.to_path_buf());
        }
        let wanted = path.file_name()?.to_str()?.to_lowercase();
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
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
        matches.into_iter().find(|found| found.is_file())
    }
}

#[expect(
    unsafe_code,
    reason = "mapping is unsafe because another process may truncate the file meanwhile; \
              a copy of every large deck would double the memory"
)]
fn map(file: &std::fs::File) -> io::Result<memmap2::Mmap> {
    // SAFETY: the map is read-only and private to this process; decks are not changed while read.
    unsafe { memmap2::Mmap::map(file) }
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
}

impl FileSource for Memory {
    fn open(&self, path: &Path) -> io::Result<Bytes> {
        match self.files.get(&tidy(path)) {
            Some(bytes) => Ok(Bytes::Owned(bytes.clone())),
            None => Err(io::ErrorKind::NotFound.into()),
        }
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

/// Opens a file and unpacks it if it is gzip by content.
pub fn open_unpacked(source: &dyn FileSource, path: &Path) -> io::Result<Bytes> {
    let bytes = source.open(path)?;
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut unpacked = Vec::new();
    flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut unpacked)?;
    Ok(Bytes::Owned(unpacked))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    #[test]
    fn gzip_is_unpacked_by_content() {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packer.write_all(b"*KEYWORD\n*END\n").unwrap();
        let source = Memory::new().with("deck.k", packer.finish().unwrap());
        let bytes = open_unpacked(&source, Path::new("deck.k")).unwrap();
        assert_eq!(&bytes[..], b"*KEYWORD\n*END\n");
    }

    #[test]
    fn names_are_found_whatever_their_case() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Mesh.K");
        std::fs::write(&path, b"*END").unwrap();
        assert_eq!(Disk.find(&folder.path().join("mesh.k")), Some(path.clone()));
        assert_eq!(Disk.find(&folder.path().join("other.k")), None);
        assert_eq!(&Disk.open(&path).unwrap()[..], b"*END");
        let memory = Memory::new().with("a/./B.k", b"x".to_vec());
        assert_eq!(memory.find(Path::new("a/c/../b.K")), Some("a/B.k".into()));
    }

    #[test]
    fn an_empty_file_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("empty.k");
        std::fs::write(&path, b"").unwrap();
        assert!(Disk.open(&path).unwrap().is_empty());
        assert!(Disk.open(folder.path()).is_err());
    }
}
