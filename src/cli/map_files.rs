//! What is told of the files of a mapping besides their contents.

use super::UsageError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::unread_line;

/// Refuses files whose forming results all lie on the side of the crash part: they were named in the other order.
pub(super) fn check_order(crash: &LoadedPart, stamped: &[LoadedPart]) -> anyhow::Result<()> {
    // A crash deck may have thicknesses of its own.
    let has_states = !crash.model.forming.is_empty();
    if !has_states || stamped.iter().any(|part| part.model.has_results()) {
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

/// Tells what of the files could not be read.
pub(super) fn warn_of_unread<'a>(parts: impl Iterator<Item = &'a LoadedPart>) {
    for line in parts.filter_map(unread_line) {
        log::warn!("{line}");
    }
}
