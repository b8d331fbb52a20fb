//! The record of a match of two loaded parts.

use super::load::LoadedPart;
use super::match_parts::MatchRun;
use super::units::PairUnits;
use crate::report::{FileRecord, Files, MatchRecord, RecordContext, TimingsRecord};
use crate::units::KnownUnits;

/// Collects the record of a run.
pub fn match_record(run: &MatchRun, crash: &LoadedPart, stamped: &LoadedPart) -> MatchRecord {
    // Both files are read at the same time.
    let read = [crash, stamped].map(|part| part.report.read_ms + part.report.prepare_ms);
    let read = read[0].max(read[1]);
    let units = PairUnits::of(Some(crash), Some(stamped));
    let context = RecordContext {
        settings: run.recipe.settings.clone(),
        n_triangles: run.n_triangles,
        files: Files {
            crash: file(crash, units.crash),
            stamped: file(stamped, units.stamped),
        },
        length_unit: units.lengths,
        timings: TimingsRecord {
            read,
            reduce: run.times.reduce_ms,
            align: run.times.align_ms,
            matching: run.times.match_ms,
            verify: run.times.verify_ms,
            total: read + run.times.total_ms,
        },
        warnings: warnings(crash, stamped),
    };
    MatchRecord::new(&run.outcome, &run.assessment, context)
}

fn file(part: &LoadedPart, units: Option<KnownUnits>) -> FileRecord {
    FileRecord {
        path: part.path.display().to_string(),
        parts: part.chosen_part_ids(),
        triangles: part.mesh.n_triangles(),
        length_factor: part.settings.length_factor,
        units: units.map(|known| known.units.label()),
        units_from: units.map(|known| known.origin.words()),
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
