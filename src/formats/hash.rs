//! Hashes of files, so that a result can state what it was made from.

use std::fmt;
use std::io::{self, Read as _};
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::source::{FileSource, interrupted};
use crate::monitor::Monitor;

/// Bytes between two questions to the monitor.
const CHUNK: usize = 1 << 20;

/// SHA-256 of a file as it is stored, packed or not: what `sha256sum` prints for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct FileHash([u8; 32]);

/// The text is not 64 hexadecimal digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a SHA-256 has 64 hexadecimal digits")]
pub struct HashError;

impl FileHash {
    /// The hash of some bytes. About 1 s for a gigabyte on a processor with instructions for it.
    pub fn of(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }

    /// The hash of a regular file. A cancel request ends it with [`io::ErrorKind::Interrupted`].
    pub fn of_file(source: &dyn FileSource, path: &Path, monitor: &Monitor) -> io::Result<Self> {
        let found = source.find(path).ok_or(io::ErrorKind::NotFound)?;
        let mut stream = source.stream(&found)?;
        let mut hasher = Sha256::new();
        let mut chunk = Vec::with_capacity(CHUNK);
        loop {
            monitor.check().map_err(interrupted)?;
            chunk.clear();
            let n = stream.by_ref().take(CHUNK as u64).read_to_end(&mut chunk)?;
            if n == 0 {
                return Ok(Self(hasher.finalize().into()));
            }
            hasher.update(&chunk);
        }
    }

    /// The first eight digits, enough to tell versions of a file apart at a glance.
    pub fn short(&self) -> String {
        self.to_string()[..8].to_owned()
    }
}

impl fmt::Display for FileHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for FileHash {
    type Err = HashError;

    fn from_str(text: &str) -> Result<Self, HashError> {
        let text = text.trim();
        let is_hex = text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit());
        if !is_hex {
            return Err(HashError);
        }
        let mut bytes = [0; 32];
        for (byte, at) in bytes.iter_mut().zip((0..64).step_by(2)) {
            *byte = u8::from_str_radix(&text[at..at + 2], 16).map_err(|_| HashError)?;
        }
        Ok(Self(bytes))
    }
}

impl From<FileHash> for String {
    fn from(hash: FileHash) -> Self {
        hash.to_string()
    }
}

impl TryFrom<String> for FileHash {
    type Error = HashError;

    fn try_from(text: String) -> Result<Self, HashError> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::Memory;
    use super::*;

    #[test]
    fn it_is_what_sha256sum_prints() {
        let hash = FileHash::of(b"abc");
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(hash.to_string(), known);
        assert_eq!(hash.short(), "ba7816bf");
        assert_eq!(known.parse(), Ok(hash));
        assert_eq!("ba78".parse::<FileHash>(), Err(HashError));
        assert_eq!("é".repeat(32).parse::<FileHash>(), Err(HashError));
        let json = serde_json::to_string(&hash).unwrap();
        assert_eq!(json, format!("\"{known}\""));
        assert_eq!(serde_json::from_str::<FileHash>(&json).unwrap(), hash);
    }

    #[test]
    fn files_are_hashed_in_pieces_and_can_be_cancelled() {
        let bytes = vec![7; CHUNK + 100];
        let source = Memory::new().with("deck.k", bytes.clone());
        let path = Path::new("deck.k");
        let monitor = Monitor::silent();
        let hash = FileHash::of_file(&source, path, &monitor).unwrap();
        assert_eq!(hash, FileHash::of(&bytes));
        monitor.request_cancel();
        let ended = FileHash::of_file(&source, path, &monitor).unwrap_err();
        assert_eq!(ended.kind(), io::ErrorKind::Interrupted);
        assert!(FileHash::of_file(&source, Path::new("none.k"), &Monitor::silent()).is_err());
    }
}
