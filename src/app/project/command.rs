//! What can happen to projects.

use std::path::PathBuf;

use crate::app::Kept;
use crate::jobs::{Located, ProjectFile, ProjectRequest};
use crate::pipeline::autosave::RecoveredSession;

/// Projects: files that hold the work.
#[derive(Debug, Clone)]
pub enum ProjectCommand {
    /// Ask for a project with a dialog.
    AskOpen,
    /// Open a project.
    Open(ProjectRequest),
    /// Open an autosaved session.
    Restore(PathBuf),
    /// Ask where a file of the project is that was not found.
    AskLocate(ProjectFile),
    /// A file of the project is there, or is done without.
    Locate(ProjectFile, Located),
    /// Do not open the project whose files are missing.
    GiveUp,
    /// Write the project to its file, or ask where to.
    Save,
    /// Ask where to write the project.
    SaveAs,
    /// Write the project there.
    Write(PathBuf),
    /// The shell wrote this work, at a time in seconds since 1970.
    Written(PathBuf, u64, Box<Kept>),
    /// The user closed the dialog.
    NotWritten,
    /// The shell could not write.
    SaveFailed {
        /// Why not.
        reason: String,
        /// Another window has saved the project since it was opened here.
        is_elsewhere: bool,
    },
    /// Save the session in case of a crash, if there is something new.
    Autosave,
    /// The shell found sessions of the last runs.
    NotifyRecovered(Vec<RecoveredSession>),
    /// Leave lost sessions where they are; the menu still offers them.
    DismissRecovery,
    /// Save, and leave the program when that is done.
    SaveAndQuit,
    /// Leave the program without saving.
    QuitUnsaved,
}
