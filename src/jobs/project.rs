use super::run::{load_source, reduce_part};
use super::{JobError, MeasuredLevel, PartFacts, PartSource, PerRole, Recording, Role};
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::project::{PartEntry, Project};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a part of a project is looked for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Located {
    /// Where the project says, or beside it.
    #[default]
    AsStored,
    /// Where the user says.
    At(PathBuf),
    /// Nowhere: the project is opened without it.
    Without,
}

/// A project to be opened.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ProjectRequest {
    /// The project.
    pub path: PathBuf,
    /// Where its files are.
    pub located: PerRole<Located>,
    /// True for work that was kept in case of a crash: it has no file of its own.
    pub is_kept: bool,
}

/// A project with everything it needs.
#[derive(Debug, Clone)]
pub struct OpenedProject {
    /// What was asked for.
    pub request: ProjectRequest,
    /// The project.
    pub project: Project,
    /// What was not understood.
    pub notes: Vec<String>,
    /// Its parts at their levels.
    pub parts: PerRole<Option<OpenedPart>>,
    /// Files that are neither where the project says nor beside it; nothing was loaded then.
    pub missing: PerRole<Option<PathBuf>>,
}

/// A part of a project.
#[derive(Debug, Clone)]
pub struct OpenedPart {
    /// Where it came from.
    pub source: PartSource,
    /// The part.
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
    let (project, notes) =
        Project::read(&request.path).map_err(|error| JobError::Failed(error.to_string()))?;
    let mut opened = OpenedProject {
        request,
        project,
        notes,
        parts: PerRole::default(),
        missing: PerRole::default(),
    };
    let mut sources: PerRole<Option<PartSource>> = PerRole::default();
    for role in Role::ALL {
        let Some(entry) = part_entry(&opened.project, role) else {
            continue;
        };
        match source(
            entry,
            opened.request.located.get(role),
            &opened.request.path,
        ) {
            Ok(found) => *sources.get_mut(role) = found,
            Err(missing) => *opened.missing.get_mut(role) = Some(missing),
        }
    }
    if opened.missing.iter().any(|(_, missing)| missing.is_some()) {
        return Ok(opened);
    }
    for role in Role::ALL {
        let (Some(entry), Some(source)) = (part_entry(&opened.project, role), sources.get(role))
        else {
            continue;
        };
        let part = open_part(role, entry, source.clone(), monitor)?;
        *opened.parts.get_mut(role) = Some(part);
    }
    Ok(opened)
}

/// The entry of a role.
pub fn part_entry(project: &Project, role: Role) -> Option<&PartEntry> {
    match role {
        Role::Crash => project.crash.as_ref(),
        Role::Stamped => project.stamped.as_ref(),
    }
}

/// Where a part is to be read; the path that was looked for in vain is an error.
fn source(
    entry: &PartEntry,
    located: &Located,
    project: &Path,
) -> Result<Option<PartSource>, PathBuf> {
    match (located, &entry.file) {
        (Located::Without, _) => Ok(None),
        (Located::At(path), _) => Ok(Some(PartSource::File(path.clone()))),
        (Located::AsStored, None) => Ok(Some(PartSource::Example)),
        (Located::AsStored, Some(file)) => match entry.locate(project) {
            Some(path) => Ok(Some(PartSource::File(path))),
            None => Err(file.clone()),
        },
    }
}

fn open_part(
    role: Role,
    entry: &PartEntry,
    source: PartSource,
    monitor: &Monitor,
) -> Result<OpenedPart, JobError> {
    let part = Arc::new(load_source(role, &source, &entry.load_settings(), monitor)?);
    let facts = Arc::new(PartFacts::of(&part));
    let level = entry
        .max_triangles
        .map(|n| reduce_part(&part, None, n, monitor));
    Ok(OpenedPart {
        source,
        facts,
        level: level.transpose()?,
        is_changed: entry.has_changed(&part),
        part,
    })
}
