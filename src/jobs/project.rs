//! Opening a project for the window: its parts at the levels they were reduced to.

use std::path::PathBuf;
use std::sync::Arc;

use super::run::reduce_part;
use super::{JobError, MeasuredLevel, PartFacts, PartSource, Recording};
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::project::{
    self, FoundPart, FoundProject, PartEntry, Project, ProjectFile, ProjectRequest,
};
use crate::role::{PerRole, Role};

/// A project with everything it needs.
#[derive(Debug, Clone)]
pub struct OpenedProject {
    /// What was asked for.
    pub request: ProjectRequest,
    /// Content of the project file.
    pub project: Project,
    /// What was not understood.
    pub notes: Vec<String>,
    /// Its parts at their levels.
    pub parts: PerRole<Option<OpenedPart>>,
    /// The further stamped files; none for one that is done without.
    pub further: Vec<Option<FoundPart>>,
    /// Files that are neither where the project says nor beside it; nothing was loaded then.
    pub missing: Vec<(ProjectFile, PathBuf)>,
    /// Why the file that the user pointed at is not taken, a sentence.
    pub refused: Option<String>,
}

/// A part of a project.
#[derive(Debug, Clone)]
pub struct OpenedPart {
    /// Where it came from.
    pub source: PartSource,
    /// The part as it was read.
    pub part: Arc<LoadedPart>,
    /// What was counted about it.
    pub facts: Arc<PartFacts>,
    /// Its recorded reduction and its level, if it was reduced.
    pub level: Option<(Arc<Recording>, Arc<MeasuredLevel>)>,
    /// True if the file is not the one the project was saved with.
    pub is_changed: bool,
}

/// Reads a project and loads and reduces its parts.
pub(super) fn open_project(
    request: ProjectRequest,
    monitor: &Monitor,
) -> Result<OpenedProject, JobError> {
    let FoundProject {
        request,
        project,
        notes,
        mut parts,
        further,
        missing,
        refused,
    } = project::open_project(request, monitor)?;
    let mut opened = PerRole::default();
    for role in Role::ALL {
        let entry = project.parts.get(role).as_ref();
        if let Some((entry, found)) = entry.zip(parts.get_mut(role).take()) {
            *opened.get_mut(role) = Some(at_its_level(entry, found, monitor)?);
        }
    }
    Ok(OpenedProject {
        request,
        project,
        notes,
        parts: opened,
        further,
        missing,
        refused,
    })
}

fn at_its_level(
    entry: &PartEntry,
    found: FoundPart,
    monitor: &Monitor,
) -> Result<OpenedPart, JobError> {
    let part = Arc::new(found.part);
    let facts = Arc::new(PartFacts::of(&part, monitor)?);
    let level = entry
        .max_triangles
        .map(|n| reduce_part(&part, None, n, monitor));
    Ok(OpenedPart {
        source: found.source,
        facts,
        level: level.transpose()?,
        is_changed: found.is_changed,
        part,
    })
}
