//! Projects: everything about a piece of work but the geometry, as a text file.

mod file;
mod open;
mod text;

pub use file::{
    EXTENSION, FurtherEntry, PartEntry, PlacingEntry, Project, ProjectError, ProjectFile,
    ResultEntry, is_project,
};
pub use open::{FoundPart, FoundProject, Located, ProjectRequest, open_project};
