//! What is asked for, and which answers are accepted.

use std::path::{Path, PathBuf};

use crate::app::PictureChoice;
use crate::jobs::ProjectFile;
use crate::pipeline::outputs::{Content, Output, Target, overwritten_inputs};
use crate::pipeline::project::with_ending;
use crate::role::Role;

/// What is asked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Question {
    Open(Role),
    OpenProject,
    /// A file of a project.
    Locate(ProjectFile),
    /// One more stamped file to map from.
    Further,
    /// Another mapper's result.
    OtherMapping,
    /// Where to write the project, beginning there.
    SaveProject(PathBuf),
    Save {
        kind: Output,
        path: PathBuf,
        /// The files that are read.
        inputs: Vec<PathBuf>,
    },
    Picture {
        choice: PictureChoice,
        path: PathBuf,
    },
}

impl Question {
    /// True if a file is to be read.
    pub(super) fn is_open(&self) -> bool {
        !matches!(
            self,
            Self::SaveProject(_) | Self::Save { .. } | Self::Picture { .. }
        )
    }

    /// The file that is written beside the one at a path.
    pub(super) fn file_beside(&self, path: &Path) -> Option<PathBuf> {
        match self {
            Self::Save { kind, .. } => kind.file_beside(path),
            _ => None,
        }
    }

    /// A path to start from.
    pub(super) fn suggestion(&self) -> Option<&Path> {
        match self {
            Self::SaveProject(path) | Self::Save { path, .. } | Self::Picture { path, .. } => {
                Some(path)
            }
            _ => None,
        }
    }

    /// True if a file is one of those that are read, whatever leads to it.
    pub(super) fn reads(&self, file: &Path) -> bool {
        let Self::Save { inputs, .. } = self else {
            return false;
        };
        let target = Target {
            name: String::new(),
            path: file.to_owned(),
            content: Content::Text,
        };
        !overwritten_inputs(&[target], inputs).is_empty()
    }

    /// The path that is written: a name without an ending gets the usual one.
    pub(super) fn with_ending(&self, path: PathBuf) -> PathBuf {
        let ending = match self {
            Self::Save { kind, .. } => return kind.with_extension(path),
            Self::SaveProject(_) => return with_ending(path),
            Self::Picture { .. } => "png",
            _ => return path,
        };
        if path.extension().is_some() {
            path
        } else {
            path.with_extension(ending)
        }
    }
}

/// The title of a question and the word on its button.
pub(super) fn titles(question: &Question) -> (String, &'static str) {
    let (title, verb) = match question {
        Question::Save { kind, .. } => {
            let what = kind.label().trim_end_matches('…');
            return (format!("Save: {what}"), "Save");
        }
        Question::OpenProject => ("Open a project", "Open"),
        Question::Locate(file) => match file {
            ProjectFile::Part(Role::Crash) => ("Locate the crash model of the project", "Use"),
            ProjectFile::Part(Role::Stamped) => ("Locate the stamped part of the project", "Use"),
            ProjectFile::Further(_) => ("Locate the further stamped file of the project", "Use"),
        },
        Question::Further => ("Add a stamped file", "Add"),
        Question::SaveProject(_) => ("Save the project", "Save"),
        Question::Open(Role::Crash) => ("Open the crash model", "Open"),
        Question::Open(Role::Stamped) => ("Open the stamped part", "Open"),
        Question::OtherMapping => ("Compare the mapping with another result", "Compare"),
        Question::Picture { .. } => ("Save an image", "Save"),
    };
    (title.to_owned(), verb)
}
