//! What the written copies of a deck's files include: other copies under their new names, and files that are
//! not found from another folder.

use std::path::{Path, PathBuf};

use super::output::MapFile;
use crate::formats::keyword::rename::{included_names, rename_includes};
use crate::formats::keyword::source_file::SourceFile;
use crate::formats::model::ReadFile;
use crate::formats::source::{Disk, FileSource};
use crate::pipeline::load::LoadedPart;

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
        let source = SourceFile::new(&file.path, file.bytes.clone());
        let new_name = |name: &str| Some(copy_of(name)?.file_name()?.to_str()?.to_owned());
        let (bytes, renamed) = rename_includes(&source, &read.included_as, new_name);
        let new = renamed.iter().filter_map(|name| copy_of(name));
        included.extend(new.map(|new| (new.clone(), file.path.clone())));
        file.bytes = bytes;
    }
    for file in files {
        let by = included.iter().find(|(path, _)| *path == file.path);
        file.included_by = by.map(|(_, by)| by.clone());
        let is_included = |old: &PathBuf| *old != crash.path;
        file.is_left_out = by.is_none() && file.replaces.as_ref().is_some_and(is_included);
    }
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
    let is_called = |path: &Path| {
        let own = path.file_name().unwrap_or_default().to_string_lossy();
        own.to_lowercase() == last.to_lowercase()
    };
    let files = &crash.model.files;
    let mut called = files.iter().filter(|read| is_called(&read.path));
    called.all(|read| read.path == path) && is_called(path)
}

/// Says which files a copy includes that are not found from where it is written; `None` if all are.
pub(super) fn lost_includes(files: &[MapFile], crash: &LoadedPart) -> Option<String> {
    files.iter().find_map(|file| {
        let read = original(file, crash)?;
        let source = SourceFile::new(&file.path, file.bytes.clone());
        let is_in = |path: &Path, name: &str| {
            let folder = path.parent().unwrap_or(Path::new(""));
            Disk.find(&folder.join(name)).is_some()
        };
        let is_written = |name: &str| {
            let there = file.path.with_file_name(name);
            files.iter().any(|other| other.path == there)
        };
        let names = included_names(&source, &read.included_as).into_iter();
        let lost = names.filter(|name| {
            let is_lost = is_in(&read.path, name) && !is_in(&file.path, name);
            Path::new(name).is_relative() && is_lost && !is_written(name)
        });
        let lost: Vec<String> = lost.collect();
        let first = lost.first()?;
        let what = match lost.len() {
            1 => first.clone(),
            n => format!("{first} and {} more", n - 1),
        };
        Some(format!(
            "{} includes {what}, not found from its folder; move it to the folder of {}, or write it there",
            file.path.display(),
            read.path.display()
        ))
    })
}
