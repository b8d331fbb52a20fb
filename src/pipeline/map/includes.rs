//! Copies of a deck's files: which of them may be written, and what they include, other copies under their new
//! names and files that are not found from another folder.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::PipelineError;
use super::output::{MapFile, MapWriter};
use crate::formats::Disk;
use crate::formats::keyword::include::SearchPath;
use crate::formats::keyword::rename::{includes_of, rename_includes};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::model::ReadFile;
use crate::monitor::Monitor;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::names::file_name;
use crate::pipeline::read_again::ReadAgain;

impl MapWriter<'_> {
    /// What an include does to a file must not be done to the states in its copy, nor to another part.
    pub(super) fn check_copy(&self, file: &ReadFile, n_old: usize) -> Result<(), PipelineError> {
        if n_old > 0 && !self.replaces_states() {
            return Err(PipelineError::MapOutput(format!(
                "{n_old} of the elements have initial stresses or strains in the crash deck already, which \
                 would count beside the mapped ones; leave them out of the copy (--replace-states yes), or map \
                 the thickness alone (--quantities thickness)"
            )));
        }
        let refused = |why: String| {
            let name = file.path.display();
            let message = format!(
                "{name} {why}; write an include of the whole deck instead (--write include)"
            );
            Err(PipelineError::MapOutput(message))
        };
        let same = |other: &&ReadFile| other.path == file.path;
        let n_times = self.model.files.iter().filter(same).count();
        if n_times > 1 {
            return refused(format!(
                "is included {n_times} times, and its copy would change all of them"
            ));
        }
        // Cards of plastic strains alone have stresses of zero.
        let wanted = self.run.recipe.options.quantities;
        let has_stress = self.run.mapped.states.is_some() && (wanted.stress || wanted.history);
        if has_stress && file.included_as.stress_factor != 1.0 {
            return refused("has a unit of stress of its own (*INCLUDE_TRANSFORM)".to_owned());
        }
        let has_tensors = has_stress || self.run.mapped.strains.is_some();
        if has_tensors && file.included_as.is_turned() {
            let why = "is turned or mirrored by the deck (*INCLUDE_TRANSFORM), which would turn the stresses \
                       and strains in its copy too";
            return refused(why.to_owned());
        }
        Ok(())
    }
}

/// Lets copies include the copies of other files in their place, where their lines can be changed, and marks
/// those that nothing includes.
pub(super) fn include_copies(files: &mut [MapFile], crash: &LoadedPart) {
    let copied = |file: &MapFile| Some((file.replaces.clone()?, file.path.clone()));
    let copies: Vec<(PathBuf, PathBuf)> = files.iter().filter_map(copied).collect();
    let mut included: Vec<(PathBuf, PathBuf)> = Vec::new();
    for file in files.iter_mut() {
        let Some(read) = original(file, crash) else {
            continue;
        };
        let copy_of = |name: &str| {
            let (old, new) = copies.iter().find(|(old, _)| is_named(old, name, crash))?;
            (old != &read.path).then_some(new)
        };
        let new_name = |name: &str| Some(copy_of(name)?.file_name()?.to_str()?.to_owned());
        let rename = |source: &SourceFile| rename_includes(source, &read.included_as, new_name);
        let (changed, renamed) = with_source(file, rename);
        let new = renamed.iter().filter_map(|name| copy_of(name));
        included.extend(new.map(|new| (new.clone(), file.path.clone())));
        if let Some(changed) = changed {
            file.bytes = changed;
        }
    }
    for file in files {
        let by = included.iter().find(|(path, _)| *path == file.path);
        file.included_by = by.map(|(_, by)| by.clone());
        let is_included = |old: &PathBuf| *old != crash.path;
        file.is_left_out = by.is_none() && file.replaces.as_ref().is_some_and(is_included);
    }
}

/// Looks through a written deck, whose bytes are lent and not copied.
fn with_source<T>(file: &mut MapFile, look: impl FnOnce(&SourceFile) -> T) -> T {
    let source = SourceFile::new(&file.path, std::mem::take(&mut file.bytes));
    let found = look(&source);
    file.bytes = source.into_bytes().into_vec();
    found
}

/// The file of the deck that a written file is a copy of.
fn original<'a>(file: &MapFile, crash: &'a LoadedPart) -> Option<&'a ReadFile> {
    let replaced = file.replaces.as_ref()?;
    let mut files = crash.model.files.iter();
    files.find(|read| read.path == *replaced)
}

/// True if an include line with this name means the file: no other file of the deck is called so.
fn is_named(path: &Path, name: &str, crash: &LoadedPart) -> bool {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let is_called = |path: &Path| file_name(path).to_lowercase() == last.to_lowercase();
    let files = &crash.model.files;
    let mut called = files.iter().filter(|read| is_called(&read.path));
    called.all(|read| read.path == path) && is_called(path)
}

/// Says which included files are not found any more from where the copies are written; `None` if all are. Folders
/// of `*INCLUDE_PATH_RELATIVE` are relative to that of the whole deck, so a copy of the deck itself in another
/// folder may lose what files include that lie where they were.
pub(super) fn lost_includes(
    files: &mut [MapFile],
    crash: &LoadedPart,
    monitor: &Monitor,
) -> Result<Option<String>, PipelineError> {
    let is_moved =
        |file: &MapFile| file.path.parent() != file.replaces.as_deref().and_then(Path::parent);
    if !files.iter().any(is_moved) {
        return Ok(None);
    }
    let mut of_copies = HashMap::new();
    for file in files.iter_mut() {
        if let Some(read) = original(file, crash) {
            let includes = with_source(file, |source| includes_of(source, &read.included_as));
            of_copies.insert(read.path.clone(), includes);
        }
    }
    let files = &*files;
    let copy_of = |path: &Path| {
        let mut copies = files.iter();
        copies.find(|file| file.replaces.as_deref() == Some(path))
    };
    let mut decks = Vec::with_capacity(crash.model.files.len());
    let again = ReadAgain::new(crash);
    for read in &crash.model.files {
        let path = copy_of(&read.path).map_or(&read.path, |copy| &copy.path);
        let includes = match of_copies.get(&read.path) {
            Some(includes) => includes.clone(),
            None => {
                let bytes = again.text(read, monitor)?;
                includes_of(&SourceFile::new(&read.path, bytes), &read.included_as)
            }
        };
        decks.push((&read.path, path, includes));
    }
    let search = |deck: &Path| {
        let mut search = SearchPath {
            master: folder_of(deck),
            ..SearchPath::default()
        };
        for (.., deck) in &decks {
            let folders = deck.folders.iter().map(Path::new);
            folders.for_each(|folder| search.add_folder(folder));
        }
        for (.., deck) in &decks {
            let folders = deck.relative_folders.iter().map(Path::new);
            folders.for_each(|folder| search.add_relative_folder(folder));
        }
        let of_options = crash.settings.read.include_folders.iter().cloned();
        search.folders.extend(of_options);
        search
    };
    let whole = copy_of(&crash.path).map_or(&crash.path, |copy| &copy.path);
    let [before, after] = [&crash.path, whole].map(|path| search(path));
    for (old, new, includes) in &decks {
        let is_copy = old != new;
        let is_written = |name: &str| {
            let there = new.with_file_name(name);
            files.iter().any(|other| other.path == there)
        };
        let lost = includes.names.iter().filter(|name| {
            let was_found = before.find(&Disk, &folder_of(old), name).is_some();
            was_found && after.find(&Disk, &folder_of(new), name).is_none() && !is_written(name)
        });
        let lost: Vec<&String> = lost.collect();
        let Some(first) = lost.first() else { continue };
        let what = match lost.len() {
            1 => (*first).clone(),
            n => format!("{first} and {} more", n - 1),
        };
        let [from, new, old, whole] = [&crash.path, *new, *old, whole].map(|path| path.display());
        return Ok(Some(if is_copy {
            format!(
                "{new} includes {what}, not found from its folder; move it to the folder of {old}, or write it there"
            )
        } else {
            // It loses what the folder of the whole deck led to.
            format!(
                "{old} includes {what}, not found from the folder of {whole}; move that to the folder of {from}, or \
                 write it there"
            )
        }));
    }
    Ok(None)
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}
