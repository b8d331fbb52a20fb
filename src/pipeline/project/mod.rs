//! Projects: everything about a piece of work but the geometry, as a text file.

mod error;
mod file;
mod open;
mod text;

pub use error::{NotJson, ProjectError};
pub use file::{
    EXTENSION, FurtherEntry, PartEntry, PlacingEntry, Project, ProjectFile, ResultEntry,
    is_project, with_ending,
};
pub use open::{FoundPart, FoundProject, Located, ProjectRequest, open_project};
