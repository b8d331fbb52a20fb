//! Reading meshes from files: LS-DYNA keyword decks, STL, OBJ, PLY.
//!
//! [`read`] finds out the format and gives a [`Model`]; [`Model::surface`] gives the triangles.
//! What cannot be understood becomes a [`Diagnostic`] and the rest is read. What is no mesh at all
//! is named for what it is ([`Foreign`]).

pub mod diagnostic;
mod file_bytes;
mod foreign;
mod hash;
pub mod keyword;
pub mod model;
pub mod moved;
pub mod obj;
pub mod ply;
mod polygon;
mod recognise;
pub mod source;
pub mod stl;
mod text;
mod triangulate;

use std::path::{Path, PathBuf};

pub use diagnostic::{Diagnostic, DiagnosticKind, Diagnostics, Position, Severity};
pub use file_bytes::FileBytes;
pub use foreign::Foreign;
pub use hash::{FileHash, HashError};
pub use model::{ChosenMesh, Model, PartSummary, Selection, SelectionError};
pub use source::{CheckedSource, Disk, FileSource, FileStamp, Memory, Replaced};

use crate::monitor::{Cancelled, Monitor};

/// Coordinates and thicknesses beyond this are no lengths in any unit, and their squares no longer
/// fit the 32-bit numbers of the search tree and the graphics card.
pub const MAX_LENGTH: f64 = 1e15;

/// Why a file gives no model at all.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// The file cannot be opened or unpacked.
    #[error("{path:?} cannot be read ({reason})")]
    Open {
        /// File that cannot be read.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file is something else than a mesh that can be read.
    #[error("{path:?} is {kind}; {}", .kind.advice())]
    Foreign {
        /// What it is.
        kind: Foreign,
        /// File that cannot be read.
        path: PathBuf,
    },
    /// A mesh file that is broken beyond use.
    #[error("{path:?} cannot be understood ({reason})")]
    Broken {
        /// What is wrong.
        reason: String,
        /// File that cannot be read.
        path: PathBuf,
    },
    /// The reading was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl FormatError {
    /// An error of the file system, or the cancel request that ended the reading.
    pub fn open(path: &Path, error: &std::io::Error) -> Self {
        if error.get_ref().is_some_and(|inner| inner.is::<Cancelled>()) {
            return Self::Cancelled(Cancelled);
        }
        let is_standard_input =
            path == Path::new("-") && error.kind() == std::io::ErrorKind::NotFound;
        Self::Open {
            path: path.to_path_buf(),
            reason: if is_standard_input {
                "standard input is not read; name a file".to_owned()
            } else {
                error.to_string()
            },
        }
    }
}

/// Choices for reading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadOptions {
    /// Folders in which included files are looked for after those the deck itself names.
    pub include_folders: Vec<PathBuf>,
    /// Bytes that are read at most, unpacked and with all included files. A packed file of a few
    /// megabytes may unpack to terabytes.
    pub max_bytes: u64,
    /// Files that are read at most.
    pub max_files: usize,
    /// Ids that all sets may list together. A line of a deck may name every node of the model.
    pub max_set_ids: u64,
}

impl ReadOptions {
    /// The limit in GiB where nothing else is said.
    pub const USUAL_LIMIT: f64 = 4.0;

    /// The limit on bytes, in GiB.
    pub fn limit(&self) -> f64 {
        self.max_bytes as f64 / f64::from(1 << 30)
    }

    /// All limits in proportion, for `gib` times 2^30 bytes.
    #[must_use]
    pub fn with_limit(self, gib: f64) -> Self {
        let usual = Self::default();
        let factor = gib / Self::USUAL_LIMIT;
        Self {
            max_bytes: (usual.max_bytes as f64 * factor).round() as u64,
            max_files: (usual.max_files as f64 * factor).round() as usize,
            max_set_ids: (usual.max_set_ids as f64 * factor).round() as u64,
            ..self
        }
    }
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            include_folders: Vec::new(),
            max_bytes: 4 << 30,
            max_files: 5_000,
            max_set_ids: 200_000_000,
        }
    }
}

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Format {
    /// LS-DYNA keyword deck, also a dynain.
    #[default]
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

    /// The format that the file's name speaks for. `.gz` does not count as an extension.
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        let (_, extension) = name.rsplit_once('.')?;
        let mut all = Self::ALL.iter().copied();
        all.find(|format| format.extensions().contains(&extension))
    }

    /// What a file is by its content; the name decides only where the content says nothing.
    pub fn of(path: &Path, bytes: &[u8]) -> Result<Self, Foreign> {
        recognise::recognise(path, bytes)
    }
}

/// Reads a file from disk, whatever its format.
pub fn read(path: &Path, options: &ReadOptions, monitor: &Monitor) -> Result<Model, FormatError> {
    read_from(&Disk, path, options, monitor)
}

/// The text of a file as [`read_from`] takes it: unpacked, in UTF-8, with line feeds.
pub fn read_text(
    source: &dyn FileSource,
    path: &Path,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<FileBytes, FormatError> {
    Ok(unpacked_text(source, path, options, monitor)?.0)
}

/// The same and the number of bytes behind packed data.
fn unpacked_text(
    source: &dyn FileSource,
    path: &Path,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<(FileBytes, u64), FormatError> {
    let opened = source::open_unpacked(source, path, options.max_bytes, monitor);
    let (bytes, n_after) = opened.map_err(|error| FormatError::open(path, &error))?;
    Ok((text::normalised(bytes), n_after))
}

/// Reads a file from any source, whatever its format.
pub fn read_from(
    source: &dyn FileSource,
    path: &Path,
    options: &ReadOptions,
    monitor: &Monitor,
) -> Result<Model, FormatError> {
    let (bytes, n_after) = unpacked_text(source, path, options, monitor)?;
    let format = Format::of(path, &bytes).map_err(|kind| FormatError::Foreign {
        kind,
        path: path.to_path_buf(),
    })?;
    let mut model = match format {
        Format::Keyword => keyword::deck::read_opened(source, path, bytes, options, monitor)?,
        Format::Stl => stl::read(&bytes, path, monitor)?,
        Format::Obj => obj::read(&bytes, path, monitor)?,
        Format::Ply => ply::read(&bytes, path, monitor)?,
    };
    model.format = format;
    model.find_stray_nodes(path, monitor)?;
    if n_after > 0 {
        let message = format!(
            "{n_after} bytes behind the gzip data are passed over; the file may be damaged"
        );
        let diagnostic = Diagnostic::new(DiagnosticKind::AfterGzip, message);
        let file = std::sync::Arc::from(path);
        model.diagnostics.push(diagnostic.at(Position::file(&file)));
    }
    if let Some(by_name) = Format::of_name(path).filter(|&by_name| by_name != format) {
        let (named, is) = (by_name.label(), format.label());
        let message = format!("the file is named like {named} but is {is}, and is read as that");
        let kind = DiagnosticKind::MisleadingName;
        let diagnostic = Diagnostic::new(kind, message);
        let file = std::sync::Arc::from(path);
        model.diagnostics.push(diagnostic.at(Position::file(&file)));
    }
    Ok(model)
}
