//! The short readable report of a match.

use std::fmt::Write as _;

use crate::assess::fit_beside;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::PairUnits;
use crate::registration::{MatchOutcome, StartOutcome, StartRecord};
use crate::report::{MatchRecord, number, start_name};
use crate::role::{PerRole, Role};
use crate::text::{Lengths, capital, counted, grouped, millis, parts_by_id, percent};

/// Verdict, matrix, fit, starts and times, about twenty lines.
pub fn report(record: &MatchRecord, outcome: &MatchOutcome, parts: PerRole<&LoadedPart>) -> String {
    let mut text = format!("{}\n", record.verdict.label());
    for reason in &record.reasons {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  - {reason}");
    }
    for statement in &record.statements {
        let _ = writeln!(text, "  {}", capital(statement));
    }
    for warning in &record.warnings {
        let _ = writeln!(text, "  ! {warning}");
    }
    text.push('\n');
    for (role, part) in parts.iter() {
        side(&mut text, role, part);
    }
    let units = PairUnits::sentences(parts);
    let _ = writeln!(text, "Units    {}", units.join("\n         "));
    text.push('\n');
    matrix(&mut text, record);
    text.push('\n');
    fit(&mut text, record);
    starts(&mut text, outcome);
    times(&mut text, record);
    text
}

fn side(text: &mut String, role: Role, part: &LoadedPart) {
    let ids: Vec<String> = part.chosen_part_ids().iter().map(u64::to_string).collect();
    let parts = match ids.len() {
        0..=4 => parts_by_id(&part.chosen_part_ids()),
        n => format!("parts {} … ({n})", ids[..3].join(", ")),
    };
    let triangles = counted(part.mesh.n_triangles(), "triangle");
    let (role, path) = (capital(role.word()), part.path.display());
    let _ = writeln!(text, "{role:<8} {path}, {parts}, {triangles}");
}

fn matrix(text: &mut String, record: &MatchRecord) {
    let _ = writeln!(text, "{}", record.direction);
    let cells: Vec<Vec<String>> = record
        .pose
        .matrix
        .iter()
        .map(|row| row.iter().map(|&x| number(x)).collect())
        .collect();
    let width = |col: usize| cells.iter().map(|row| row[col].len()).max().unwrap_or(0);
    for row in &cells {
        let padded: Vec<String> = row
            .iter()
            .enumerate()
            .map(|(col, cell)| format!("{cell:>w$}", w = width(col)))
            .collect();
        let _ = writeln!(text, "  {}", padded.join("  "));
    }
    if record.pose.scale != 1.0 {
        let _ = writeln!(text, "  with the scale c = {}", number(record.pose.scale));
    }
}

fn fit(text: &mut String, record: &MatchRecord) {
    let (metrics, lengths) = (&record.metrics, Lengths::new(record.units.length));
    let _ = writeln!(
        text,
        "Fit      RMS {}, P95 {}, max {}",
        lengths.of(metrics.rmse),
        lengths.of(metrics.p95),
        lengths.of(metrics.max)
    );
    let overlap = &metrics.overlap;
    let _ = writeln!(
        text,
        "Overlap  {} of the stamped part and {} of the crash part within {}",
        percent(overlap.stamped),
        percent(overlap.crash),
        lengths.of(overlap.limit)
    );
    if let Some(other) = record.alternatives.first() {
        let ratio = other.score_ratio;
        let which = if other.number == 1 {
            "best"
        } else {
            "second-best"
        };
        let fit = fit_beside(ratio, other.by_shape);
        let _ = writeln!(text, "Next     the {which} pose: {fit}");
    }
}

fn starts(text: &mut String, outcome: &MatchOutcome) {
    let starts = &outcome.starts;
    let iterations: usize = starts.iter().map(|start| start.iterations.len()).sum();
    let is_best = |start: &&StartRecord| start.outcome == Some(StartOutcome::Won);
    if let Some(best) = starts.iter().find(is_best) {
        let _ = writeln!(
            text,
            "Starts   {}, best: {}; {} in all",
            grouped(starts.len()),
            start_name(best),
            counted(iterations, "iteration")
        );
    }
}

fn times(text: &mut String, record: &MatchRecord) {
    let t = &record.timings;
    let steps = [
        ("read", t.read_ms),
        ("find parts", t.find_ms),
        ("reduce", t.reduce_ms),
        ("align", t.align_ms),
        ("match", t.match_ms),
        ("settle", t.settle_ms),
        ("verify", t.verify_ms),
        ("total", t.total_ms),
    ];
    let shown: Vec<String> = steps
        .iter()
        .filter(|(_, ms)| *ms > 0.0)
        .map(|(name, ms)| format!("{name} {}", millis(*ms)))
        .collect();
    let _ = writeln!(text, "Time     {}", shown.join(" · "));
}
