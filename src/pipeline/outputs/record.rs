//! The record of a match of two loaded parts.

use crate::pipeline::load::{LoadedPart, gauge_line, same_parts_line};
use crate::pipeline::match_parts::MatchRun;
use crate::pipeline::units::{PairUnits, doubts_of_set_units};
use crate::registration::{MatchSettings, StartMethod};
use crate::report::command_line::{CommandLine, CommandSide};
use crate::report::{
    DiagnosticInfo, FileRecord, IncludedFile, MatchRecord, RecordContext, TimingsRecord,
    UnitsRecord,
};
use crate::role::PerRole;
use crate::units::KnownUnits;

/// Problems of each file that are told with the result.
const N_PROBLEMS: usize = 3;

/// Collects the record of a run.
pub fn match_record(run: &MatchRun, parts: PerRole<&LoadedPart>) -> MatchRecord {
    // Both files are read at the same time.
    let read = parts.map(|part| part.report.read_ms + part.report.prepare_ms);
    let read = read.crash.max(read.stamped);
    let units = PairUnits::of(parts.map(Some));
    let context = RecordContext {
        recipe: run.recipe.clone(),
        max_triangles: run.max_triangles,
        n_triangles: run.n_triangles,
        units: UnitsRecord {
            length: units.lengths,
            angle: "deg",
            crash_factor: parts.crash.settings.length_factor,
            stamped_factor: parts.stamped.settings.length_factor,
        },
        sample_node: parts.stamped.sample_node(),
        center: parts.stamped.mesh.aabb().center(),
        files: PerRole::from_fn(|role| file_record(parts.get(role), *units.files.get(role))),
        timings: TimingsRecord {
            read_ms: read,
            find_ms: run.times.find_ms,
            reduce_ms: run.times.reduce_ms,
            align_ms: run.times.align_ms,
            match_ms: run.times.match_ms,
            settle_ms: run.times.settle_ms,
            verify_ms: run.times.verify_ms,
            total_ms: read + run.times.total_ms,
        },
        alternative: run.alternative,
        warnings: warnings(run, parts),
        command_line: command_line(run, parts).line(),
    };
    MatchRecord::new(&run.outcome, &run.assessment, context)
}

/// What the command line has to be told to do the run again.
pub fn command_line<'a>(run: &'a MatchRun, parts: PerRole<&'a LoadedPart>) -> CommandLine<'a> {
    CommandLine {
        sides: match_sides(parts, &run.recipe.settings),
        read: &parts.crash.settings.read,
        settings: &run.recipe.settings,
        max_triangles: run.max_triangles,
        current: &run.start_pose,
        alternative: run.alternative,
    }
}

/// Both files as a match has to be told. A crash part that the program chose among several that fit about as well is
/// not named: the match finds it again and says so. One that begins at a given place has to be told which part lies
/// there.
pub fn match_sides<'a>(
    parts: PerRole<&'a LoadedPart>,
    settings: &MatchSettings,
) -> PerRole<CommandSide<'a>> {
    let mut sides = parts.map(LoadedPart::command_side);
    let begins_there = settings.starts.method == StartMethod::CurrentPose;
    if !parts.crash.settings.alike_parts.is_empty() && !begins_there {
        sides.crash.selection = None;
    }
    sides
}

/// What is recorded of a file, with the units that it is taken to have.
pub(in crate::pipeline) fn file_record(part: &LoadedPart, units: Option<KnownUnits>) -> FileRecord {
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
        findings: part.report.n_diagnostics,
        diagnostics: part
            .problems()
            .into_iter()
            .map(DiagnosticInfo::of)
            .collect(),
    }
}

/// What the user should know about the files.
fn warnings(run: &MatchRun, parts: PerRole<&LoadedPart>) -> Vec<String> {
    let mut warnings = Vec::from_iter(run.told_alternative());
    warnings.extend(same_parts_line(parts));
    warnings.extend(gauge_line(parts));
    for (_, part) in parts.iter() {
        warnings.extend(problems(part));
        if part.settings.length_factor != 1.0 {
            let factor = part.settings.length_factor;
            let name = part.file_name();
            warnings.push(format!("{name} was scaled by {factor} before matching"));
        }
    }
    warnings.extend(doubts_of_set_units(parts));
    warnings.extend(PairUnits::stress_warning(parts));
    warnings
}

/// The first problems of the reader, and how many there are besides.
fn problems(part: &LoadedPart) -> Vec<String> {
    let problems = part.problems();
    let mut lines: Vec<String> = problems
        .iter()
        .take(N_PROBLEMS)
        .map(ToString::to_string)
        .collect();
    let more = (part.report.n_diagnostics as usize).saturating_sub(lines.len());
    if more > 0 {
        let name = part.file_name();
        let noun = if more == 1 { "problem" } else { "problems" };
        lines.push(format!(
            "{more} more {noun} in {name}; `shapematch info` lists them"
        ));
    }
    lines
}
