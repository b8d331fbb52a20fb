//! What leaves the window of a mapping: decks, report, table.

use super::{Made, OutputInput};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::{
    MapOutput, MapRun, PlacedPart, WriteKind, element_table, map_record, map_report, write_mapping,
};
use crate::role::PerRole;
use crate::text::grouped;

/// The mapping with its parts.
fn mapped(input: &OutputInput) -> Result<(&MapRun, PerRole<&LoadedPart>), PipelineError> {
    let parts = input.both().ok_or(PipelineError::Lacks("both parts"))?;
    let run = input.mapping.as_deref();
    Ok((run.ok_or(PipelineError::Lacks("a mapping"))?, parts))
}

fn placed<'a>(run: &MapRun, parts: PerRole<&'a LoadedPart>) -> PlacedPart<'a> {
    PlacedPart {
        part: parts.stamped,
        crash_from_stamped: run.poses[0],
    }
}

/// The deck of a kind that is one file.
pub(super) fn deck(
    kind: WriteKind,
    input: &OutputInput,
    monitor: &Monitor,
) -> Result<Made, PipelineError> {
    let (run, parts) = mapped(input)?;
    let output = MapOutput {
        kind,
        path: "mapped.k".into(),
        is_large: true,
    };
    let comments = [format!(
        "forming results of {} mapped onto {}",
        parts.stamped.file_name(),
        parts.crash.file_name()
    )];
    let files = write_mapping(run, parts.crash, &output, &comments, monitor)?;
    let note = format!(
        "{} thicknesses, {} stress and {} strain cards, read back within {:.1e}",
        grouped(files.n_thickness),
        grouped(files.n_stress),
        grouped(files.n_strain),
        files.read_back_error
    );
    let bytes = files.files.into_iter().next().map(|(_, bytes)| bytes);
    Ok(Made {
        bytes: bytes.ok_or(PipelineError::Lacks("a deck"))?,
        notes: vec![note],
    })
}

pub(super) fn report(input: &OutputInput, monitor: &Monitor) -> Result<String, PipelineError> {
    let (run, parts) = mapped(input)?;
    let record = map_record(run, parts.crash, &[placed(run, parts)], None, None);
    map_report(run, &record, parts.crash, monitor)
}

pub(super) fn table(input: &OutputInput) -> Result<String, PipelineError> {
    let (run, parts) = mapped(input)?;
    Ok(element_table(run, parts.crash, &[placed(run, parts)], None))
}
