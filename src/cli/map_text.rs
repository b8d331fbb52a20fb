//! What `shapematch map` prints.

use std::path::PathBuf;

use crate::mapping::BackDifference;
use crate::pipeline::map::{
    CheckRecord, ComparedRow, ComparisonRecord, DifferenceRecord, MapFiles, MapRecord,
};
use crate::text::{counted, grouped, length, millis, parts_by_id, share};

/// The result in a few lines. Files that could not be written are not among those that were.
pub(super) fn summary(record: &MapRecord, files: Option<&MapFiles>, failed: &[PathBuf]) -> String {
    let mut text = String::new();
    let mut line = |head: &str, rest: String| text.push_str(&format!("{head:<9}{rest}\n"));
    line("Onto", parts_by_id(&record.crash_parts));
    line(
        "Mapped",
        format!(
            "{} of the area of {} in {}",
            share(record.mapped_area),
            counted(record.n_elements, "element"),
            millis(record.map_ms)
        ),
    );
    for row in &record.statuses {
        line(
            "",
            format!("{:>9} {}", grouped(row.n_elements), row.status.label()),
        );
    }
    let pairs = [
        ("Thickness", &record.thickness),
        ("Plastic", &record.plastic_strain),
    ];
    for (head, pair) in pairs {
        if let Some(pair) = pair {
            let (a, b) = (&pair.stamped, &pair.crash);
            line(
                head,
                format!(
                    " mean {} ({}), {} to {}",
                    length(b.mean),
                    pair.stamped_value(&length(a.mean)),
                    length(b.min),
                    length(b.max)
                ),
            );
        }
    }
    if let Some(back) = &record.map_back {
        let of_range = |back: &BackDifference| share(back.share_of_range().unwrap_or(0.0));
        let thickness = record.thickness.as_ref();
        let thickness =
            thickness.map(|_| format!("{} of the thickness range", of_range(&back.thickness)));
        let plastic = record.plastic_strain.as_ref();
        let plastic =
            plastic.map(|_| format!("{} of the range of plastic strain", of_range(&back.plastic)));
        let all: Vec<String> = thickness.into_iter().chain(plastic).collect();
        if !all.is_empty() {
            line("Map back", format!("95 % within {}", all.join(", ")));
        }
    }
    for (head, rest) in checked(record) {
        line(head, rest);
    }
    for (head, rest) in record.comparison.iter().flat_map(compared) {
        line(head, rest);
    }
    for (head, rest) in files.into_iter().flat_map(|files| wrote(files, failed)) {
        line(head, rest);
    }
    text
}

/// The files with what they hold.
fn wrote(files: &MapFiles, failed: &[PathBuf]) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    let written = files
        .files
        .iter()
        .filter(|file| !failed.contains(&file.path));
    for file in written {
        let size = size_text(file.bytes.len());
        let text = format!("{} ({size})", file.path.display());
        lines.push(("Wrote", text));
        if let Some(replaced) = file.place_taken() {
            lines.push(("", replaced));
        }
    }
    // The counts are those of all files together.
    if files.files.iter().any(|file| failed.contains(&file.path)) {
        return lines;
    }
    let counts = format!(
        "{} thicknesses, {} stress and {} strain cards, read back within {:.1e}",
        grouped(files.n_thickness),
        grouped(files.n_stress),
        grouped(files.n_strain),
        files.read_back_error
    );
    lines.push(("", counts));
    if files.n_default > 0 {
        let verb = if files.n_default == 1 { "is" } else { "are" };
        let n = grouped(files.n_default);
        lines.push(("", format!("{n} of the thicknesses {verb} the default one")));
    }
    lines
}

/// The size of a file: "12.3 kB", "4.5 MB".
fn size_text(n_bytes: usize) -> String {
    let n_bytes = n_bytes as f64;
    if n_bytes < 1e5 {
        format!("{:.1} kB", n_bytes / 1e3)
    } else {
        format!("{:.1} MB", n_bytes / 1e6)
    }
}

/// How many checks are met, those that are not, and why one is not judged, or as it is.
fn checked(record: &MapRecord) -> Vec<(&'static str, String)> {
    let (n_met, n_judged) = record.n_met();
    let mut lines = vec![("Checks", format!("{n_met} of {n_judged} met"))];
    let told = |check: &&CheckRecord| check.is_met == Some(false) || check.reason.is_some();
    for check in record.checks.iter().filter(told) {
        let met = match check.is_met {
            Some(true) => "met",
            Some(false) => "not met",
            None => "not judged",
        };
        let (name, found, limit) = (&check.name, &check.found, &check.limit);
        let text = format!("{name}: {found}, asked for {limit}, {met}");
        lines.push(("", text));
        let reason = check
            .reason
            .iter()
            .flat_map(|reason| wrapped(reason.label()));
        lines.extend(reason.map(|line| ("", format!("  {line}"))));
    }
    lines
}

/// A sentence in lines that fit a terminal behind the heads.
fn wrapped(text: &str) -> Vec<String> {
    const WIDTH: usize = 84;
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + word.chars().count() < WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The lines about another result.
fn compared(other: &ComparisonRecord) -> Vec<(&'static str, String)> {
    let counts = format!(
        "with {}: {} in both, {} here alone, {} there alone",
        other.files.join(", "),
        counted(other.n_both, "element"),
        grouped(other.n_only_here),
        grouped(other.n_only_other)
    );
    let mut lines = vec![("Compared", counts)];
    let row = |row: ComparedRow<'_>| ("", format!("{}: {}", row.name, differing(row.difference)));
    lines.extend(other.rows().map(row));
    lines
}

fn differing(found: &DifferenceRecord) -> String {
    if found.max == 0.0 {
        return format!("equal, mean {}", length(found.here.mean));
    }
    format!(
        "mean {} (there {}), RMS difference {}, 95 % within {}, at most {} at element {}",
        length(found.here.mean),
        length(found.other.mean),
        length(found.rms),
        length(found.p95),
        length(found.max),
        found.element
    )
}
