//! What is told of the files of a mapping besides their contents.

use std::path::PathBuf;

use super::map::MapChoice;
use super::of_each::{named_once, of_file};
use super::{UsageError, warn_of_order};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::unread_line;

/// Refuses files whose forming results all lie on the side of the crash part: they were named in the other order. Warns
/// where only a thickness for each element does, which a crash deck may have of its own.
pub(super) fn check_order(crash: &LoadedPart, stamped: &[LoadedPart]) -> anyhow::Result<()> {
    if stamped.iter().any(|part| part.model.has_results()) {
        return Ok(());
    }
    if crash.model.forming.is_empty() {
        if let Some(first) = stamped.first() {
            warn_of_order(crash, first);
        }
        return Ok(());
    }
    let names: Vec<String> = stamped.iter().map(LoadedPart::file_name).collect();
    let text = format!(
        "the forming results are in {}, named first as the crash model, and there are none in {}; name the crash \
         model first: shapematch map CRASH STAMPED",
        crash.file_name(),
        names.join(", ")
    );
    Err(UsageError(text).into())
}

/// The places of the stamped files that are mapped: a file that is named again with the same choices is mapped once.
/// Of a project each file has a pose.
pub(super) fn kept_files(choice: &MapChoice, stamped: &[PathBuf]) -> Vec<usize> {
    let choices = |file: usize| {
        if choice.project.is_some() {
            return file.to_string();
        }
        let part = of_file(&choice.stamped_part, file);
        let length_factor = choice.lengths.of(file);
        let stress_factor = of_file(choice.stresses.given(), file);
        let pose = choice.pose.get(file);
        format!("{part:?} {length_factor} {stress_factor:?} {pose:?}")
    };
    let files = stamped.iter().enumerate();
    named_once(files.map(|(file, path)| (path.as_path(), choices(file))))
}

/// Tells what of the files could not be read.
pub(super) fn warn_of_unread<'a>(parts: impl Iterator<Item = &'a LoadedPart>) {
    for line in parts.filter_map(unread_line) {
        log::warn!("{line}");
    }
}
