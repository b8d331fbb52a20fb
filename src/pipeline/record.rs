//! The record of a match of two loaded parts.

use super::load::LoadedPart;
use super::match_parts::MatchRun;
use super::units::PairUnits;
use crate::report::command_line::CommandLine;
use crate::report::{
    FileRecord, Files, IncludedFile, MatchRecord, RecordContext, TimingsRecord, UnitsRecord,
};
use crate::units::{KnownUnits, LengthUnit};

/// Collects the record of a run.
pub fn match_record(run: &MatchRun, crash: &LoadedPart, stamped: &LoadedPart) -> MatchRecord {
    // Both files are read at the same time.
    let read = [crash, stamped].map(|part| part.report.read_ms + part.report.prepare_ms);
    let read = read[0].max(read[1]);
    let units = PairUnits::of(Some(crash), Some(stamped));
    let context = RecordContext {
        settings: run.recipe.settings.clone(),
        max_triangles: run.max_triangles,
        n_triangles: run.n_triangles,
        units: UnitsRecord {
            length: units.lengths.map(LengthUnit::symbol),
            angle: "deg",
            crash_factor: crash.settings.length_factor,
            stamped_factor: stamped.settings.length_factor,
        },
        sample_node: stamped.sample_node(),
        center: stamped.mesh.aabb().center(),
        files: Files {
            crash: file(crash, units.crash),
            stamped: file(stamped, units.stamped),
        },
        timings: TimingsRecord {
            read_ms: read,
            reduce_ms: run.times.reduce_ms,
            align_ms: run.times.align_ms,
            match_ms: run.times.match_ms,
            verify_ms: run.times.verify_ms,
            total_ms: read + run.times.total_ms,
        },
        warnings: warnings(crash, stamped),
        command_line: command_line(run, crash, stamped).line(),
    };
    MatchRecord::new(&run.outcome, &run.assessment, context)
}

/// What the command line has to be told to do the run again.
fn command_line<'a>(
    run: &'a MatchRun,
    crash: &'a LoadedPart,
    stamped: &'a LoadedPart,
) -> CommandLine<'a> {
    CommandLine {
        crash: crash.command_side(),
        stamped: stamped.command_side(),
        include_folders: &crash.settings.read.include_folders,
        settings: &run.recipe.settings,
        max_triangles: run.max_triangles,
        current: &run.start_pose,
    }
}

fn file(part: &LoadedPart, units: Option<KnownUnits>) -> FileRecord {
    let included = part.model.files.iter().skip(1);
    FileRecord {
        path: part.path.display().to_string(),
        name: part.file_name(),
        hash: part.hash(),
        includes: included
            .map(|file| IncludedFile {
                path: file.path.display().to_string(),
                hash: file.hash,
            })
            .collect(),
        parts: part.chosen_part_ids(),
        nodes: part.report.n_nodes,
        triangles: part.mesh.n_triangles(),
        thickness: part.mean_thickness(),
        length_factor: part.settings.length_factor,
        units: units.map(|known| known.units.label()),
        units_from: units.map(|known| known.origin.words()),
        findings: part.report.n_findings,
    }
}

/// What the user should know about the files.
fn warnings(crash: &LoadedPart, stamped: &LoadedPart) -> Vec<String> {
    let mut warnings = Vec::new();
    for part in [crash, stamped] {
        let n = part.report.n_findings;
        if n > 0 {
            let name = part.file_name();
            let (noun, verb) = if n == 1 {
                ("finding", "is")
            } else {
                ("findings", "are")
            };
            warnings.push(format!(
                "{n} {noun} in {name} {verb} listed by `shapematch info`"
            ));
        }
        if part.settings.length_factor != 1.0 {
            let factor = part.settings.length_factor;
            let name = part.file_name();
            warnings.push(format!("{name} was scaled by {factor} before matching"));
        }
    }
    warnings.extend(PairUnits::stress_warning(crash, stamped));
    warnings
}
