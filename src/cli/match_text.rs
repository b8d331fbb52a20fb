//! The short readable report of a match.

use std::fmt::Write as _;

use super::text::{count, millis, short};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::PairUnits;
use crate::report::{MatchRecord, StartEntry, number};

/// Verdict, matrix, fit, starts and times, about twenty lines.
pub fn report(record: &MatchRecord, crash: &LoadedPart, stamped: &LoadedPart) -> String {
    let mut text = format!("{}\n", record.verdict.to_uppercase());
    for reason in &record.reasons {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  - {reason}");
    }
    text.push('\n');
    side(&mut text, "Crash", crash);
    side(&mut text, "Stamped", stamped);
    let units = PairUnits::sentences(crash, stamped);
    let _ = writeln!(text, "Units    {}", units.join("\n         "));
    text.push('\n');
    matrix(&mut text, record);
    text.push('\n');
    fit(&mut text, record);
    starts(&mut text, &record.starts);
    times(&mut text, record);
    text
}

fn side(text: &mut String, role: &str, part: &LoadedPart) {
    let ids: Vec<String> = part.chosen_part_ids().iter().map(u64::to_string).collect();
    let parts = match ids.len() {
        0..=4 => ids.join(", "),
        n => format!("{} … ({n} parts)", ids[..3].join(", ")),
    };
    let triangles = count(part.mesh.n_triangles());
    let _ = writeln!(
        text,
        "{role:<8} {}, part {parts}, {triangles} triangles",
        part.path.display()
    );
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
    let _ = writeln!(
        text,
        "Fit      rms {}, 95 % below {}, largest {}",
        short(record.metrics.rmse),
        short(record.metrics.p95),
        short(record.metrics.max)
    );
    let overlap = &record.metrics.overlap;
    let _ = writeln!(
        text,
        "Overlap  {:.1} % of the stamped and {:.1} % of the crash part lie within {} of the other",
        100.0 * overlap.stamped,
        100.0 * overlap.crash,
        short(overlap.limit)
    );
    if let Some(other) = record.alternatives.first() {
        let _ = writeln!(
            text,
            "Next     the second-best pose fits {} times worse",
            short(other.score_ratio)
        );
    }
}

fn starts(text: &mut String, starts: &[StartEntry]) {
    let iterations: usize = starts.iter().map(|start| start.iterations).sum();
    if let Some(winner) = starts.iter().find(|start| start.fate == "won") {
        let side = if winner.flipped {
            ", normals opposed"
        } else {
            ""
        };
        let n = starts.len();
        let kind = &winner.kind;
        let _ = writeln!(
            text,
            "Starts   {n}, won by {kind}{side}; {} iterations in all",
            count(iterations)
        );
    }
}

fn times(text: &mut String, record: &MatchRecord) {
    let t = &record.timings;
    let steps = [
        ("read", t.read_ms),
        ("reduce", t.reduce_ms),
        ("align", t.align_ms),
        ("match", t.match_ms),
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
