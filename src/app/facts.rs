//! What the log says about the results of the pipeline, in one line each.

use crate::geometry::Similarity;
use crate::jobs::{MatchRun, MeasuredLevel, Measurement, PartFacts};
use crate::pipeline::load::LoadedPart;

/// "41,208 triangles, 3 parts".
pub(super) fn load_line(part: &LoadedPart, facts: &PartFacts) -> String {
    let report = &part.report;
    let mut line = format!(
        "{}: {}, {} of {}",
        part.file_name(),
        counted(report.n_triangles, "triangle"),
        facts.used.len(),
        counted(report.n_parts, "part"),
    );
    if report.n_turned > 0 {
        line += &format!(", {} turned", grouped(report.n_turned));
    }
    if part.settings.length_factor != 1.0 {
        line += &format!(", lengths × {}", part.settings.length_factor);
    }
    line
}

/// "12 findings in bp.dynain", if the reader had any.
pub(super) fn diagnostics_line(part: &LoadedPart) -> Option<String> {
    let n = part.report.n_findings;
    let counted = counted(usize::try_from(n).unwrap_or(usize::MAX), "finding");
    (n > 0).then(|| format!("{counted} in {}, see the tab Diagnostics", part.file_name()))
}

/// "212,880 → 7,998 triangles of at most 8,000".
pub(super) fn reduce_line(measured: &MeasuredLevel) -> String {
    let report = &measured.level.report;
    let mut line = format!(
        "{} → {} triangles of at most {}",
        grouped(report.triangles_before),
        grouped(report.triangles_after),
        grouped(measured.max_triangles),
    );
    if report.triangles_after > measured.max_triangles {
        line += &format!("; {}", report.stop_reason);
    }
    line
}

/// "rms 0.0412, max 0.312, border max 0.1".
pub(super) fn deviation_line(measured: &MeasuredLevel) -> String {
    measured.deviation.get().map_or_else(String::new, |d| {
        format!(
            "distance to the full mesh: rms {:.4}, max {:.4}, at borders max {:.4}",
            d.rms, d.max, d.border_max
        )
    })
}

/// The pose a match found: its best or one of its alternatives.
pub(super) fn match_pose(run: &MatchRun, alternative: Option<usize>) -> Option<Similarity> {
    match alternative {
        None => Some(run.crash_from_stamped),
        Some(index) => run.alternatives.get(index).copied(),
    }
}

pub(super) fn n_alternatives(run: &MatchRun) -> usize {
    run.alternatives.len()
}

pub(super) fn match_line(run: &MatchRun) -> String {
    run.verdict.clone()
}

pub(super) fn measure_line(measurement: &Measurement) -> String {
    format!("overlap {:.1} %", 100.0 * measurement.overlap)
}

/// "1 triangle", "12,345 triangles".
pub(super) fn counted(n: usize, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(n))
}

/// A count with commas between the thousands.
pub(super) fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
