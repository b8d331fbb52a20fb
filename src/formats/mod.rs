//! Reading meshes from files: LS-DYNA keyword decks, STL, OBJ, PLY.
//!
//! [`read`] finds out the format and gives a [`Model`]; [`Model::surface`] gives the triangles.
//! What cannot be understood becomes a [`Diagnostic`] and the rest is read.

pub mod diagnostic;
mod hash;
pub mod keyword;
pub mod model;
pub mod moved;
pub mod obj;
pub mod ply;
mod polygon;
pub mod source;
pub mod stl;

use std::path::{Path, PathBuf};

pub use diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position, Severity};
pub use hash::{FileHash, HashError};
pub use model::{Model, PartSummary, Selection, SelectionError, Surface};
pub use source::{Disk, FileSource, Memory};

use crate::monitor::{Cancelled, Monitor};

/// Why a file gives no model at all.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// The file cannot be opened or unpacked.
    #[error("cannot read the file ({reason}): {path:?}")]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// Neither name nor content belong to a known format.
    #[error("the file is neither an LS-DYNA deck nor STL, OBJ or PLY: {path:?}")]
    Unknown {
        /// The file.
        path: PathBuf,
    },
    /// A format that is recognised but cannot be read.
    #[error("{what} cannot be read: {path:?}")]
    Unsupported {
        /// What the file is.
        what: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// A mesh file that is broken beyond use.
    #[error("the file cannot be understood ({reason}): {path:?}")]
    Broken {
        /// What is wrong.
        reason: String,
        /// The file.
        path: PathBuf,
    },
    /// The reading was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl FormatError {
    /// An error of the file system.
    pub fn open(path: &Path, error: &std::io::Error) -> Self {
        Self::Open {
            path: path.to_path_buf(),
            reason: error.to_string(),
        }
    }
}

/// Choices for reading.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReadOptions {
    /// Folders in which included files are looked for after those the deck itself names.
    pub include_folders: Vec<PathBuf>,
}

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// LS-DYNA keyword deck, also a dynain.
    Keyword,
    /// STL, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY, binary or ASCII.
    Ply,
}

impl Format {
    /// Every format.
    pub const ALL: &[Self] = &[Self::Keyword, Self::Stl, Self::Obj, Self::Ply];

    /// Its name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Keyword => "LS-DYNA keyword",
            Self::Stl => "STL",
            Self::Obj => "Wavefront OBJ",
            Self::Ply => "PLY",
        }
    }

    /// Usual file extensions in lower case, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Keyword => &["k", "key", "dyn", "dynain", "inc", "asc", "gz"],
            Self::Stl => &["stl"],
            Self::Obj => &["obj"],
            Self::Ply => &["ply"],
        }
    }

    /// Finds the format by name and content. `.gz` does not count as an extension.
    pub fn of(path: &Path, bytes: &[u8]) -> Self {
        let head = &bytes[..bytes.len().min(256)];
        if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
            return Self::Ply;
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        let has_extension = |format: &&Self| {
            let known = name.rsplit_once('.').map(|(_, extension)| extension);
            known.is_some_and(|extension| format.extensions().contains(&extension))
        };
        if let Some(&format) = Self::ALL.iter().find(has_extension) {
            return format;
        }
        // A dynain often has no extension at all, so what is nothing else is a deck.
        let is_solid = head.trim_ascii_start().starts_with(b"solid ");
        if is_solid { Self::Stl } else { Self::Keyword }
    }
}

/// Reads a file from disk, whatever its format.
pub fn read(path: &Path, options: &ReadOptions, monitor: &Monitor) -> Result<Model, FormatError> {
    read_from(&Disk, path, options, monitor)
}

/// Reads a file from any source, whatever its format.
pub fn read_from(
    source: &dyn FileSource,
    path: &Path,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    let bytes = source::open_unpacked(source, path).map_err(|e| FormatError::open(path, &e))?;
    match Format::of(path, &bytes) {
        Format::Keyword => keyword::deck::read_opened(source, path, bytes, options, monitor),
        Format::Stl => stl::read(&bytes, path),
        Format::Obj => obj::read(&bytes, path),
        Format::Ply => ply::read(&bytes, path),
    }
}
