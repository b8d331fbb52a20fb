//! What the log says about the results of the pipeline, in one line each.

use super::LogStep;
use super::NoticeLevel;
use crate::assess::{Ambiguity, Coverage, Reason, Verdict};
use crate::formats::{Diagnostic, Severity};
use crate::jobs::{MeasuredLevel, PartFacts};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::match_parts::MatchRun;
use crate::role::PerRole;
use crate::text::{Lengths, factor_note, percent};
pub(super) use crate::text::{counted, grouped};
use std::time::Duration;

/// "41,208 triangles, 3 parts".
pub(super) fn load_line(part: &LoadedPart, facts: &PartFacts) -> String {
    let report = &part.report;
    let mut line = format!(
        "{}: {}, {} of {}",
        part.file_name(),
        counted(report.n_triangles, "triangle"),
        grouped(facts.used.len()),
        counted(report.n_parts, "part"),
    );
    if report.n_turned > 0 {
        line += &format!(", {} turned", grouped(report.n_turned));
    }
    line += &factor_note(part.settings.length_factor);
    match part.units() {
        Some(known) => line + "; " + &known.words(),
        None => line + "; unit unknown",
    }
}

/// "12 diagnostics in bp.dynain; the most severe: bp.dynain:48: …", if the reader had any, and how loud it is.
pub(super) fn diagnostics_line(part: &LoadedPart) -> Option<(NoticeLevel, String)> {
    let n = part.report.n_diagnostics;
    if n == 0 {
        return None;
    }
    let counted = counted(usize::try_from(n).unwrap_or(usize::MAX), "diagnostic");
    let found = part
        .diagnostics()
        .into_iter()
        .filter_map(|diagnostics| diagnostics.most_severe());
    let most_severe = found.rev().max_by_key(|one| one.severity());
    let level = match most_severe.map(Diagnostic::severity) {
        Some(Severity::Error) => NoticeLevel::Warning,
        _ => NoticeLevel::Note,
    };
    let mut text = format!("{counted} in {}", part.file_name());
    if let Some(most_severe) = most_severe {
        text += &format!("; {most_severe}");
    }
    text += ". The rest was read; the tab Diagnostics lists them";
    Some((level, text))
}

/// "212,880 → 7,998 triangles of at most 8,000".
pub(super) fn reduce_line(measured: &MeasuredLevel) -> String {
    let report = &measured.level.report;
    let mut line = format!(
        "{} → {} of at most {}",
        grouped(report.triangles_before),
        counted(report.triangles_after, "triangle"),
        grouped(measured.max_triangles),
    );
    if report.triangles_after > measured.max_triangles {
        line += &format!("; {}", report.stop_reason);
    }
    line
}

/// "distance to the full mesh: RMS 0.0412, max 0.312, at borders max 0.100 mm".
pub(super) fn deviation_line(measured: &MeasuredLevel, lengths: Lengths) -> String {
    measured.deviation.get().map_or_else(String::new, |d| {
        format!(
            "distance to the full mesh: RMS {}, max {}, at borders max {}",
            lengths.number(d.rms),
            lengths.number(d.max),
            lengths.of(d.border_max)
        )
    })
}

/// Alternatives that fit nearly as well as the best; they come first in the list.
pub(super) fn n_alternatives(run: &MatchRun) -> usize {
    Ambiguity::near(&run.outcome.alternatives).len()
}

/// "GOOD: overlap stamped 87.0 %, crash 99.1 %, RMS 0.380, P95 0.900 mm; the reason".
pub(super) fn match_line(run: &MatchRun, lengths: Lengths) -> String {
    let assessment = &run.assessment;
    let found = (&assessment.coverage, assessment.reasons.first());
    let verdict = (assessment.verdict, run.crash_from_stamped.is_mirrored());
    line_of(verdict, found, lengths)
}

/// The same of a verdict, with whether the pose mirrors the part, its figures and its first reason.
pub(super) fn line_of(
    (verdict, is_mirrored): (Verdict, bool),
    (coverage, reason): (&Coverage, Option<&Reason>),
    lengths: Lengths,
) -> String {
    let mut line = format!(
        "{}{}: overlap stamped {}, crash {}, RMS {}, P95 {}",
        verdict.label(),
        if is_mirrored { ", mirrored" } else { "" },
        percent(coverage.source_on_target.overlap),
        percent(coverage.target_on_source.overlap),
        lengths.number(coverage.rmse()),
        lengths.of(coverage.p95()),
    );
    if let Some(reason) = reason {
        line += &format!("; {}", reason.words(lengths));
    }
    line
}

/// The level of a match's row in the log, whose sign is that of the verdict.
pub(super) fn match_level(run: &MatchRun) -> NoticeLevel {
    match run.assessment.verdict {
        Verdict::Good => NoticeLevel::Success,
        Verdict::Check => NoticeLevel::Warning,
        Verdict::Poor => NoticeLevel::Error,
    }
}

/// The phases of a match before its last one, for the log.
pub(super) fn match_steps(run: &MatchRun) -> Vec<(LogStep, String, Duration)> {
    let took = |ms: f64| Duration::try_from_secs_f64(ms / 1e3).unwrap_or_default();
    let PerRole { crash, stamped } = run.n_triangles.map(grouped);
    let times = &run.times;
    let n_starts = counted(run.outcome.starts.len(), "start");
    let iterations = run.outcome.starts.iter().map(|s| s.iterations.len()).sum();
    let iterations = counted(iterations, "iteration");
    let searched = format!("{iterations} on {crash} and {stamped} triangles");
    let mut steps = vec![
        (LogStep::Align, n_starts, took(times.align_ms)),
        (LogStep::Match, searched, took(times.match_ms)),
        (
            LogStep::Settle,
            "borders, holes and bends on the full meshes".to_owned(),
            took(times.settle_ms),
        ),
        (
            LogStep::Verify,
            "on the full meshes".to_owned(),
            took(times.verify_ms),
        ),
    ];
    if times.reduce_ms > 0.0 {
        let text = format!("{crash} and {stamped} triangles");
        steps.insert(0, (LogStep::Reduce, text, took(times.reduce_ms)));
    }
    steps
}

/// "overlap stamped 87.0 %, crash 96.0 % within 1.50 mm; RMS 0.380 mm".
pub(super) fn measure_line(coverage: &Coverage, lengths: Lengths) -> String {
    format!(
        "overlap stamped {}, crash {} within {}; RMS {}",
        percent(coverage.source_on_target.overlap),
        percent(coverage.target_on_source.overlap),
        lengths.of(coverage.limit),
        lengths.of(coverage.rmse()),
    )
}
