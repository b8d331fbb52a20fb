//! Why a project cannot be opened.

use std::path::{Path, PathBuf};

use super::file::{EXTENSION, VERSION};
use crate::report::build_id;

/// What a text is that is no JSON.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotJson {
    /// Nothing.
    Empty,
    /// A keyword deck.
    Deck,
    /// JSON that breaks off or was changed.
    Damaged,
    /// Anything else.
    Other,
}

impl NotJson {
    fn of(text: &str) -> Self {
        match text.trim_start().chars().next() {
            None => Self::Empty,
            Some('*' | '$') => Self::Deck,
            Some('{') => Self::Damaged,
            Some(_) => Self::Other,
        }
    }

    fn words(self, line: usize, reason: &str) -> String {
        match self {
            Self::Empty => "empty".to_owned(),
            Self::Deck => "an LS-DYNA keyword deck".to_owned(),
            Self::Damaged => format!("text that is damaged (line {line}: {reason})"),
            Self::Other => "another kind of file".to_owned(),
        }
    }
}

/// Why a project cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// It cannot be read from disk.
    #[error("cannot read the project ({reason}): {path:?}")]
    Read {
        /// Path of the project file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// It is no JSON text.
    #[error(
        "{path:?} is no project but {}; a project (.{EXTENSION}) is the work of the window, which saves it as text \
         (Ctrl+S)",
        .what.words(*.line, .reason)
    )]
    NoText {
        /// Path of the project file.
        path: PathBuf,
        /// What it seems to be.
        what: NotJson,
        /// Where reading ended.
        line: usize,
        /// What was wrong there.
        reason: String,
    },
    /// It is some other JSON text.
    #[error("{0:?} is no project of shapematch; its field \"schema\" would say so")]
    NoProject(PathBuf),
    /// A later program wrote it.
    #[error(
        "{path:?} is a project of version {version}, written by {program}; this is {}, which reads \
         up to version {VERSION}. Open it with the program that wrote it",
        build_id()
    )]
    Newer {
        /// Path of the project file.
        path: PathBuf,
        /// Version of the program that wrote it.
        version: String,
        /// The program that wrote it, as it calls itself.
        program: String,
    },
    /// A field that everything else depends on is not understood.
    #[error("the field {field:?} of the project {path:?} is not understood: {reason}")]
    Field {
        /// Path of the project file.
        path: PathBuf,
        /// Name of the field.
        field: &'static str,
        /// What is wrong.
        reason: String,
    },
}

impl ProjectError {
    /// The error for a text at `path` that is no JSON.
    pub(super) fn no_text(path: &Path, text: &str, error: &serde_json::Error) -> Self {
        Self::NoText {
            path: path.to_path_buf(),
            what: NotJson::of(text),
            line: error.line(),
            reason: error.to_string(),
        }
    }
}
