//! A project with its files, wherever they are now.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{PartEntry, Project, ProjectFile};
use crate::formats::source::tidy;
use crate::formats::{Disk, FileHash};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::{LoadedPart, PartSource};
use crate::pipeline::names::file_name;
use crate::role::{PerRole, Role};

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
    /// Path of the project file.
    pub path: PathBuf,
    /// Where its files are, as far as they are not where it says.
    pub located: BTreeMap<ProjectFile, Located>,
    /// True for an autosaved session: it has no file of its own.
    pub is_autosave: bool,
}

/// A project with its parts, or with the names of those that are missing.
#[derive(Debug, Clone)]
pub struct FoundProject {
    /// What was asked for.
    pub request: ProjectRequest,
    /// Content of the project file.
    pub project: Project,
    /// What was not understood, a sentence each.
    pub notes: Vec<String>,
    /// Its parts at full resolution.
    pub parts: PerRole<Option<FoundPart>>,
    /// The further stamped files; none for one that is done without.
    pub further: Vec<Option<FoundPart>>,
    /// Files that are neither where the project says nor beside it; nothing was loaded then.
    pub missing: Vec<(ProjectFile, PathBuf)>,
    /// Why the file that the user pointed at is not taken, a sentence.
    pub refused: Option<String>,
}

/// A part of a project.
#[derive(Debug, Clone)]
pub struct FoundPart {
    /// Where it came from.
    pub source: PartSource,
    /// The part as it was read.
    pub part: LoadedPart,
    /// True if the file is not the one the project was saved with.
    pub is_changed: bool,
}

/// Reads a project and its parts, both of the match at the same time.
pub fn open_project(
    mut request: ProjectRequest,
    monitor: &Monitor,
) -> Result<FoundProject, PipelineError> {
    let (mut project, mut notes) = Project::read(&request.path).map_err(Box::new)?;
    let refused = refuse_mistaken(&project, &mut request, monitor)?;
    follow_moved(&mut project, &mut request, &mut notes, monitor)?;
    let mut missing = Vec::new();
    let mut source_of = |file: ProjectFile, entry: &PartEntry| {
        let usual = Located::AsStored;
        let located = request.located.get(&file).unwrap_or(&usual);
        source(entry, located, &request.path).unwrap_or_else(|path| {
            missing.push((file, path));
            None
        })
    };
    let sources = PerRole::from_fn(|role| {
        let entry = project.parts.get(role).as_ref()?;
        source_of(ProjectFile::Part(role), entry)
    });
    let further = project.further_stamped.iter().enumerate();
    let further: Vec<Option<PartSource>> = further
        .map(|(n, entry)| source_of(ProjectFile::Further(n), &entry.part))
        .collect();
    let mut parts = PerRole::default();
    let mut further_parts = Vec::new();
    if missing.is_empty() {
        let load = |role| {
            let source = sources.get(role).clone();
            let entry = project.parts.get(role).as_ref();
            entry
                .zip(source)
                .map(|(entry, source)| load_part(role, entry, source, monitor))
                .transpose()
        };
        let (crash, stamped) = rayon::join(|| load(Role::Crash), || load(Role::Stamped));
        parts = PerRole::new(crash?, stamped?);
        for (entry, source) in project.further_stamped.iter().zip(further) {
            let load = |source| load_part(Role::Stamped, &entry.part, source, monitor);
            further_parts.push(source.map(load).transpose()?);
        }
    }
    Ok(FoundProject {
        request,
        project,
        notes,
        parts,
        further: further_parts,
        missing,
        refused,
    })
}

/// A file that the user pointed at is not taken where it is another file of the project: the crash part read as the
/// stamped part would be matched onto itself.
fn refuse_mistaken(
    project: &Project,
    request: &mut ProjectRequest,
    monitor: &Monitor,
) -> Result<Option<String>, PipelineError> {
    let mut refused = None;
    for (file, located) in request.located.clone() {
        let Located::At(path) = located else {
            continue;
        };
        let found = FileHash::of_file(&Disk, &path, monitor).ok();
        monitor.check()?;
        if let Some(other) = mistaken_for(project, request, file, (&path, found)) {
            refused = Some(format!(
                "{} is {} of the project, not {}.",
                file_name(&path),
                other.words(),
                file.words()
            ));
            request.located.remove(&file);
        }
    }
    Ok(refused)
}

/// The other file of the project that this one is, by its path or its content. A file that stands twice in the
/// project is none.
fn mistaken_for(
    project: &Project,
    request: &ProjectRequest,
    file: ProjectFile,
    (path, content): (&Path, Option<FileHash>),
) -> Option<ProjectFile> {
    let own = project.entry(file)?;
    if content.is_some() && content == own.hash {
        return None;
    }
    let is_it = |other: &ProjectFile| {
        let Some(entry) = project.entry(*other).filter(|_| *other != file) else {
            return false;
        };
        let place = match request.located.get(other) {
            Some(Located::At(place)) => Some(place.clone()),
            Some(Located::AsStored | Located::Without) | None => entry.locate(&request.path),
        };
        let is_there = place.is_some_and(|place| tidy(&place) == tidy(path));
        let is_same = content.is_some() && content == entry.hash;
        entry.file != own.file && (is_there || is_same)
    };
    project.files().into_iter().find(is_it)
}

/// Files often move together: what is missing is looked for where it would lie beside a file that the user
/// pointed at, as it lay beside that one before, and in its folder. Only the same content is taken.
fn follow_moved(
    project: &mut Project,
    request: &mut ProjectRequest,
    notes: &mut Vec<String>,
    monitor: &Monitor,
) -> Result<(), PipelineError> {
    let pointed_at = |(file, located): (&ProjectFile, &Located)| match located {
        Located::At(now) => Some((project.entry(*file)?.file.clone()?, now.clone())),
        Located::AsStored | Located::Without => None,
    };
    let moves: Vec<(PathBuf, PathBuf)> = request.located.iter().filter_map(pointed_at).collect();
    if moves.is_empty() {
        return Ok(());
    }
    for file in project.files() {
        let is_told =
            request.located.get(&file).unwrap_or(&Located::AsStored) != &Located::AsStored;
        let Some(entry) = project.entry(file).filter(|_| !is_told) else {
            continue;
        };
        let (Some(stored), Some(hash)) = (&entry.file, entry.hash) else {
            continue;
        };
        if entry.locate(&request.path).is_some() {
            continue;
        }
        for place in moves.iter().flat_map(|moved| moved_with(stored, moved)) {
            let found = FileHash::of_file(&Disk, &place, monitor).ok();
            monitor.check()?;
            if found == Some(hash) {
                notes.push(format!("found again: {}", place.display()));
                request.located.insert(file, Located::At(place));
                break;
            }
        }
    }
    if let Some(other) = &mut project.mapping_compared_with
        && !other.is_file()
    {
        let mut places = moves.iter().flat_map(|moved| moved_with(other, moved));
        if let Some(place) = places.find(|place| place.is_file()) {
            *other = place;
        }
    }
    Ok(())
}

/// Where a file may lie now that another one moved from `before` to `now`.
fn moved_with(file: &Path, (before, now): &(PathBuf, PathBuf)) -> Vec<PathBuf> {
    let (Some(before), Some(now)) = (before.parent(), now.parent()) else {
        return Vec::new();
    };
    // From the lowest folder that held both before.
    let as_before = before.ancestors().zip(now.ancestors());
    let as_before =
        as_before.filter_map(|(before, now)| Some(now.join(file.strip_prefix(before).ok()?)));
    let beside = file.file_name().map(|name| now.join(name));
    as_before.take(1).chain(beside).collect()
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
        (Located::AsStored, None) => Ok(Some(if entry.is_realistic_example {
            PartSource::RealisticExample
        } else {
            PartSource::Example
        })),
        (Located::AsStored, Some(file)) => match entry.locate(project) {
            Some(path) => Ok(Some(PartSource::File(path))),
            None => Err(file.clone()),
        },
    }
}

fn load_part(
    role: Role,
    entry: &PartEntry,
    source: PartSource,
    monitor: &Monitor,
) -> Result<FoundPart, PipelineError> {
    let part = source.load(role, &entry.load_settings(), monitor)?;
    Ok(FoundPart {
        is_changed: entry.has_changed(&part),
        source,
        part,
    })
}
