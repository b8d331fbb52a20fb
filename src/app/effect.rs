use super::ExportKind;
use crate::jobs::{JobKey, JobKind, Role, Stamp};

/// What the shell has to do after a command.
#[derive(Debug, Clone)]
pub enum Effect {
    /// Give the worker a job.
    StartJob(Box<JobKind>, Stamp),
    /// Ask a job to end early with its best result.
    StopJob(JobKey),
    /// Ask a job to end without a result.
    CancelJob(JobKey),
    /// Ask for a file; answer with `FileCommand::Open`.
    AskOpen(Role),
    /// Ask where to write; answer with `ExportCommand::Write`.
    AskSave(ExportKind),
    /// Put a text on the clipboard.
    CopyText(String),
    /// Write the preferences.
    SaveSettings,
    /// Write a picture of the 3D windows.
    TakePicture {
        /// Without background.
        is_transparent: bool,
    },
    /// Tell the desktop if the window is in the background.
    NotifyDesktop(String),
    /// Close the window.
    Quit,
}
