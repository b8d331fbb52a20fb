//! What must happen outside the state: jobs, dialogs, clipboard, files.

use std::path::PathBuf;

use super::{Kept, PictureChoice, PicturePlace};
use crate::jobs::{JobKey, JobKind, ProjectFile, Stamp};
use crate::pipeline::outputs::Output;
use crate::pipeline::project::Project;
use crate::role::Role;

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
    /// Ask for a project; answer with `ProjectCommand::Open`.
    AskOpenProject,
    /// Ask for a file of a project; answer with `ProjectCommand::Locate`.
    AskLocate(ProjectFile),
    /// Ask for a further stamped file; answer with `MapCommand::AddFurther`.
    AskFurther,
    /// Ask for another mapper's result; answer with `MapCommand::CompareWith`.
    AskOtherMapping,
    /// Ask where to write the project, beginning there; answer with `ProjectCommand::Write`.
    AskSaveProject(PathBuf),
    /// Write a project; answer with `ProjectCommand::Written` and what was kept.
    WriteProject {
        /// File the project is written to.
        path: PathBuf,
        /// When the only project was saved that may be written over; `None` for any.
        replaces: Option<u64>,
        /// Content of the project file.
        project: Box<Project>,
        /// The work that it holds.
        kept: Box<Kept>,
    },
    /// Save the session in the user's folder in case of a crash.
    Autosave(Box<Project>),
    /// Lost sessions are no longer to be offered at the start.
    DismissRecovery,
    /// Ask where to write; answer with `ExportCommand::Write`.
    AskSave {
        /// What is written; decides the file extension.
        kind: Output,
        /// A path to start from.
        path: PathBuf,
        /// The files that are read, which nothing may overwrite.
        inputs: Vec<PathBuf>,
    },
    /// Put a text on the clipboard.
    CopyText(String),
    /// Write the preferences.
    SaveSettings,
    /// Ask where to put a picture; answer with `ExportCommand::WritePicture`.
    AskPicture {
        /// How it is taken.
        choice: PictureChoice,
        /// A path to start from.
        path: PathBuf,
    },
    /// Write a picture of the 3D windows.
    TakePicture {
        /// Size, background and overlays.
        choice: PictureChoice,
        /// File or folder the picture goes to.
        place: PicturePlace,
        /// What the file says about itself: keyword and text.
        texts: Vec<(&'static str, String)>,
    },
    /// Ask the desktop to point to the window if it is in the background.
    NotifyDesktop,
    /// Close the window.
    Quit,
}
