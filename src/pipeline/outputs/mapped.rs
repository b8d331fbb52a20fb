//! What the window writes of a mapping: decks, report, table.

use std::path::Path;

use super::{Made, OutputInput};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::{
    DefaultThickness, MapFile, MapFiles, MapOutput, MapRun, OtherResult, PlacedPart, WriteKind,
    deck_comments, element_table, map_record, map_report, probe_records, write_mapping,
};
use crate::role::PerRole;
use crate::text::grouped;

/// The mapping with its parts.
fn mapped(input: &OutputInput) -> Result<(&MapRun, PerRole<&LoadedPart>), PipelineError> {
    let parts = input.both().ok_or(PipelineError::Lacks("both parts"))?;
    let run = input.mapping.as_deref();
    Ok((run.ok_or(PipelineError::Lacks("a mapping"))?, parts))
}

/// The stamped parts as the run was made from them.
fn placed<'a>(
    run: &MapRun,
    parts: PerRole<&'a LoadedPart>,
    input: &'a OutputInput,
) -> Vec<PlacedPart<'a>> {
    let further = input.further_stamped.iter().map(|part| &**part);
    let stamped = std::iter::once(parts.stamped).chain(further);
    stamped
        .zip(run.poses.iter().zip(&run.origins))
        .map(|(part, (pose, origin))| PlacedPart {
            part,
            crash_from_stamped: *pose,
            origin: *origin,
        })
        .collect()
}

/// The other result it was compared with.
fn other(input: &OutputInput) -> Option<&OtherResult> {
    input.other.as_deref()
}

/// The files of a deck of a kind, the first of which is to lie at `path`, byte for byte as the command line
/// writes them.
pub(super) fn deck_files(
    kind: WriteKind,
    input: &OutputInput,
    path: &Path,
    monitor: &Monitor,
) -> Result<MapFiles, PipelineError> {
    let (run, parts) = mapped(input)?;
    let output = MapOutput {
        kind,
        path: path.to_path_buf(),
        is_large: true,
        default_thickness: DefaultThickness::Section,
        has_copies: true,
    };
    let comments = deck_comments(parts.crash, &placed(run, parts, input));
    write_mapping(run, parts.crash, &output, &comments, monitor)
}

/// What was found when they were read back.
pub(super) fn note(files: &MapFiles) -> String {
    let counts = [
        (files.n_thickness, "thicknesses"),
        (files.n_stress, "stress cards"),
        (files.n_strain, "strain cards"),
    ];
    let counts = counts.iter().filter(|(n, _)| *n > 0);
    let counts: Vec<String> = counts
        .map(|(n, of)| format!("{} {of}", grouped(*n)))
        .collect();
    let counts = if counts.is_empty() {
        "no cards".to_owned()
    } else {
        counts.join(", ")
    };
    let error = files.read_back_error;
    let first = files.files.first();
    let replaced = first.and_then(MapFile::place_taken);
    let replaced = replaced.map_or_else(String::new, |replaced| format!("; {replaced}"));
    format!("{counts}, read back within {error:.1e}{replaced}")
}

/// What a file is that is written beside the first.
pub(super) fn note_beside(file: &MapFile) -> String {
    let path = file.path.display();
    match file.place_taken() {
        Some(replaced) => {
            format!("written beside: {path}, a copy without the old states; {replaced}")
        }
        None => format!(
            "written beside: {path}, with the elements that the crash deck is to have instead of its own"
        ),
    }
}

/// The first of these files.
pub(super) fn deck(
    kind: WriteKind,
    input: &OutputInput,
    monitor: &Monitor,
) -> Result<Made, PipelineError> {
    let files = deck_files(kind, input, Path::new("mapped.k"), monitor)?;
    let note = note(&files);
    let bytes = files.files.into_iter().next().map(|file| file.bytes);
    Ok(Made {
        bytes: bytes.ok_or(PipelineError::Lacks("a deck"))?,
        notes: vec![note],
    })
}

pub(super) fn report(input: &OutputInput, monitor: &Monitor) -> Result<String, PipelineError> {
    let (run, parts) = mapped(input)?;
    let other = other(input);
    let placed = placed(run, parts, input);
    let mut record = map_record(run, parts.crash, &placed, None, other, monitor)?;
    record.probes = probe_records(run, parts.crash, &placed, &input.pins);
    map_report(run, &record, parts.crash, other, monitor)
}

pub(super) fn table(input: &OutputInput, monitor: &Monitor) -> Result<String, PipelineError> {
    let (run, parts) = mapped(input)?;
    let placed = placed(run, parts, input);
    let other = other(input);
    Ok(element_table(run, parts.crash, &placed, other, monitor)?)
}
