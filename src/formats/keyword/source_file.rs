//! A deck's file: its bytes, and the line of every byte.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use memchr::memchr_iter;

use super::super::FileBytes;
use super::super::diagnostic::Position;

/// Newlines are counted once per this many bytes when a first position is asked for.
const LINE_INDEX_STEP: usize = 1 << 16;

/// A file with its bytes, able to tell the line of a byte offset.
#[derive(Debug)]
pub struct SourceFile {
    path: Arc<Path>,
    bytes: FileBytes,
    /// Newlines before each multiple of [`LINE_INDEX_STEP`].
    line_index: OnceLock<Vec<u64>>,
}

impl SourceFile {
    /// A file of the given path with the given bytes.
    pub fn new(path: impl Into<PathBuf>, bytes: impl Into<FileBytes>) -> Self {
        Self {
            path: Arc::from(path.into()),
            bytes: bytes.into(),
            line_index: OnceLock::new(),
        }
    }

    /// The path it was opened under.
    pub fn path(&self) -> &Arc<Path> {
        &self.path
    }

    /// The bytes of the file, decompressed.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes, taken back.
    pub fn into_bytes(self) -> FileBytes {
        self.bytes
    }

    /// Line and column of a byte offset. The first call counts the newlines of the whole file.
    pub fn position(&self, offset: usize) -> Position {
        let offset = offset.min(self.bytes.len());
        let index = self.line_index.get_or_init(|| {
            let mut total = 0;
            let mut before = Vec::with_capacity(self.bytes.len() / LINE_INDEX_STEP + 1);
            for chunk in self.bytes.chunks(LINE_INDEX_STEP) {
                before.push(total);
                total += memchr_iter(b'\n', chunk).count() as u64;
            }
            before.push(total);
            before
        });
        let step = (offset / LINE_INDEX_STEP).min(index.len() - 1);
        let tail = &self.bytes[step * LINE_INDEX_STEP..offset];
        let line_start = memchr::memrchr(b'\n', &self.bytes[..offset]).map_or(0, |i| i + 1);
        Position {
            file: self.path.clone(),
            line: index[step] + memchr_iter(b'\n', tail).count() as u64 + 1,
            column: u32::try_from(offset - line_start + 1).unwrap_or(u32::MAX),
        }
    }
}

/// A byte of a file, from which its line is worked out when a diagnostic needs it.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    file: Arc<SourceFile>,
    offset: usize,
}

impl Place {
    pub(crate) fn new(file: &Arc<SourceFile>, offset: usize) -> Self {
        Self {
            file: file.clone(),
            offset,
        }
    }

    pub(crate) fn position(&self) -> Position {
        self.file.position(self.offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_found_across_index_steps() {
        let text: String = (0..20_000).map(|i| format!("line {i}\n")).collect();
        let file = SourceFile::new("t.k", text.clone());
        for line in [0usize, 1, 6_000, 12_345, 19_999] {
            let offset = text.find(&format!("line {line}\n")).unwrap() + 3;
            let position = file.position(offset);
            assert_eq!((position.line, position.column), (line as u64 + 1, 4));
        }
        assert_eq!(file.position(usize::MAX).line, 20_001);
    }
}
