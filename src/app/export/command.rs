//! What can be exported.

use std::path::PathBuf;

use super::{CopyForm, PictureChoice};
use crate::pipeline::outputs::Output;

/// What leaves the program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExportCommand {
    /// The matrix, or cards, on the clipboard.
    Copy(CopyForm),
    /// Ask where to write something.
    AskSave(Output),
    /// Writes an output to a file.
    Write {
        /// What is written.
        kind: Output,
        /// File it is written to.
        path: PathBuf,
    },
    /// The line that does the match without the window.
    CopyCommandLine,
    /// The line that does the mapping without the window.
    CopyMapCommandLine,
    /// The log as text.
    CopyLog,
    /// A text that a panel shows.
    CopyText {
        /// Text for the clipboard.
        text: String,
        /// What it is, for the toast.
        what: String,
    },
    /// A picture as the last one was taken, at once where a folder is known; perhaps without background.
    TakePicture {
        /// Without background, whatever the last one had.
        is_transparent: bool,
    },
    /// Ask where to put a picture that is taken so.
    AskPicture(PictureChoice),
    /// A picture into a file.
    WritePicture {
        /// Size, background and overlays.
        choice: PictureChoice,
        /// PNG file it is written to.
        path: PathBuf,
    },
}
