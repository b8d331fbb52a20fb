//! The tables of the report.

use maud::{Markup, html};

use super::Report;
use super::page::{Column, cell, fact_table, image, printable, table};
use crate::formats::FileHash;
use crate::geometry::Point3;
use crate::report::distances::{COMPARED_P95, COMPARED_RMS};
use crate::report::matrix::number;
use crate::report::{FileRecord, outcome_words, start_name};
use crate::settings::{SETTINGS, Setting};
use crate::text::{Lengths, counted, fixed, grouped, length, millis, percent};

/// Groups of starts that are listed.
const N_GROUPS: usize = 8;
/// Largest deviations that are listed.
const N_SPOTS: usize = 8;
/// Ids of parts, and included files, that are listed.
const N_IDS: usize = 12;
const N_INCLUDES: usize = 20;

/// A length as a cell.
fn bare(value: f64) -> Markup {
    cell(length(value))
}

impl Report<'_> {
    /// Both directions, number by number.
    pub(super) fn distance_table(&self) -> Markup {
        let both = [
            (
                "▲ stamped → ■ crash",
                &self.deviation.source_on_target.stats,
            ),
            (
                "■ crash → ▲ stamped",
                &self.deviation.target_on_source.stats,
            ),
        ];
        let rows: Vec<Vec<Markup>> = both
            .iter()
            .map(|(name, stats)| {
                let mut row = vec![cell(name)];
                row.extend(stats.class_shares.map(|fraction| cell(percent(fraction))));
                let distances = [stats.mean, stats.rms, stats.p95, stats.min, stats.max];
                row.extend(distances.map(bare));
                row
            })
            .collect();
        let columns = [
            Column::text("Nodes of → to"),
            // The classes by their names, as titles.
            Column::number("Matched"),
            Column::number("Beyond the limit"),
            Column::number("On this part only"),
            Column::number("Mean"),
            Column::number(COMPARED_RMS.name),
            Column::number(COMPARED_P95.name),
            Column::number("Min"),
            Column::number("Max"),
        ];
        let caption = "Distances of nodes, weighted by area";
        table(&self.lengths().axis(caption), &columns, &rows)
    }

    /// The largest deviations, those with pictures first.
    pub(super) fn spot_table(&self) -> Markup {
        let spots = &self.deviation.source_on_target.spots;
        let decimals = self.lengths().decimals_as_of_mm(2);
        let rows: Vec<Vec<Markup>> = spots
            .iter()
            .take(N_SPOTS)
            .enumerate()
            .map(|(i, spot)| {
                let mut row = vec![cell((i + 1).to_string()), bare(spot.value)];
                let at = self.on_crash(&spot.position);
                row.extend(at.map(|x| cell(fixed(x, decimals))));
                row
            })
            .collect();
        let columns = [
            Column::text("Place"),
            Column::number("Distance"),
            Column::number("x"),
            Column::number("y"),
            Column::number("z"),
        ];
        let caption = "Largest deviations of the stamped part, in the crash part's frame";
        table(&self.lengths().axis(caption), &columns, &rows)
    }

    /// A point of the stamped part where the matrix puts it.
    fn on_crash(&self, point: &Point3) -> [f64; 3] {
        self.outcome.target_from_source.apply(point).into()
    }

    /// Starts by where they ended.
    pub(super) fn start_table(&self) -> Markup {
        let groups = 0..self.groups.len().min(N_GROUPS);
        let rows: Vec<Vec<Markup>> = groups.map(|group| self.start_row(group)).collect();
        let columns = [
            Column::text("Pose"),
            Column::picture("Picture"),
            Column::number("Starts"),
            Column::text("Found from"),
            Column::number("Residual"),
            Column::number("Kept"),
            Column::number("Iterations"),
            Column::number("Centre off by"),
            Column::number("Rotated by"),
            Column::text("Outcome"),
        ];
        let caption = "Poses that starts ended in; each row stands for all starts that ended there";
        let n_more = self.groups.len().saturating_sub(N_GROUPS);
        html! {
            (table(&self.lengths().axis(caption), &columns, &rows))
            @if n_more > 0 {
                p.soft { (counted(n_more, "more pose")) " dropped early." }
            }
        }
    }

    fn start_row(&self, group: usize) -> Vec<Markup> {
        let members = &self.groups[group];
        let best = &self.outcome.starts[members.best()];
        let last = best.iterations.last();
        let unknown = || cell("–");
        let (apart, angle) = self.group_distances[group];
        let picture = self.figures.starts.get(group);
        vec![
            cell((group + 1).to_string()),
            html! { @if let Some(p) = picture { (image(&p.png, p.size, &p.alt)) } },
            cell(format!(
                "{} of {}",
                members.members.len(),
                self.outcome.starts.len()
            )),
            cell(start_name(best)),
            last.map_or_else(unknown, |step| bare(step.rmse)),
            last.map_or_else(unknown, |step| cell(percent(step.fraction))),
            cell(best.iterations.len().to_string()),
            bare(apart),
            cell(format!("{}°", fixed(angle, 1))),
            outcome_words(best).map_or_else(unknown, cell),
        ]
    }

    /// Every setting, and what became of it.
    pub(super) fn settings_table(&self) -> Markup {
        let (p, lengths) = (&self.record.parameters, self.lengths());
        let shown = |row: &Setting| {
            let value = row.get(&p.settings.0)?;
            Some((row.label, cell(row.shown(&value, lengths))))
        };
        let mut rows: Vec<(&str, Markup)> = SETTINGS.iter().filter_map(shown).collect();
        let floor = p
            .floor
            .map(|floor| ("Floor as used", cell(lengths.of(floor))));
        let rotations = p.n_rotations.map(|n| ("Rotations", cell(n.to_string())));
        rows.extend(floor.into_iter().chain(rotations));
        rows.push(("Data points as used", cell(p.data_side.word())));
        let [crash, stamped] = [p.crash_triangles, p.stamped_triangles].map(grouped);
        let triangles = cell(format!("■ {crash}, ▲ {stamped}"));
        rows.push(("Triangles as used", triangles));
        fact_table("Settings", &rows)
    }

    /// Durations with bars.
    pub(super) fn times_table(&self) -> Markup {
        let t = &self.record.timings;
        let steps = [
            ("Read", t.read_ms),
            ("Find parts", t.find_ms),
            ("Reduce", t.reduce_ms),
            ("Align", t.align_ms),
            ("Match", t.match_ms),
            ("Settle", t.settle_ms),
            ("Verify", t.verify_ms),
            ("Total", t.total_ms),
        ];
        let longest = steps.iter().map(|(_, ms)| *ms).fold(1e-9, f64::max);
        let rows: Vec<Vec<Markup>> = steps
            .iter()
            .filter(|(_, ms)| *ms > 0.0)
            .map(|(name, ms)| {
                let width = (120.0 * ms / longest).round();
                let bar = html! { span.meter style={ "width:" (width) "px" } {} };
                vec![cell(name), cell(millis(*ms)), bar]
            })
            .collect();
        let columns = [
            Column::text("Step"),
            Column::number("Time"),
            Column::text("Share"),
        ];
        html! { div { (table("Times", &columns, &rows)) } }
    }

    /// Both files with what was taken from them.
    pub(super) fn files_section(&self) -> Markup {
        let (files, lengths) = (&self.record.files, self.lengths());
        html! {
            div.two {
                (file_table("■ Crash part, fixed", &files.crash, lengths))
                (file_table("▲ Stamped part, moved", &files.stamped, lengths))
            }
        }
    }
}

/// A file with what was taken from it.
pub(super) fn file_table(title: &str, file: &FileRecord, lengths: Lengths) -> Markup {
    let ids: Vec<String> = file.parts.iter().take(N_IDS).map(u64::to_string).collect();
    let mut parts = ids.join(", ");
    if file.parts.len() > N_IDS {
        parts += &format!(" and {} more", file.parts.len() - N_IDS);
    }
    let units = match (file.units, file.units_from) {
        (Some(units), Some(from)) => format!("{units}, {from}"),
        _ => "unknown".to_owned(),
    };
    let mut rows = vec![
        ("File", cell(printable(&file.path))),
        ("SHA-256", hash(file.hash)),
        ("Units", cell(units)),
        ("Length factor", cell(number(file.length_factor))),
        ("Parts used", cell(parts)),
        ("Nodes in the file", cell(grouped(file.nodes))),
        ("Triangles used", cell(grouped(file.triangles))),
        ("Diagnostics", cell(file.findings.to_string())),
    ];
    if let Some(thickness) = file.thickness {
        rows.push(("Mean thickness", cell(lengths.of(thickness))));
    }
    for include in file.includes.iter().take(N_INCLUDES) {
        let value = html! { (printable(&include.path)) br; (hash(include.hash)) };
        rows.push(("Includes", value));
    }
    for problem in &file.diagnostics {
        let line = problem
            .line
            .map_or_else(String::new, |line| format!("line {line}: "));
        rows.push((
            problem.severity_title(),
            cell(format!("{line}{}", problem.message)),
        ));
    }
    fact_table(title, &rows)
}

fn hash(hash: Option<FileHash>) -> Markup {
    match hash {
        Some(hash) => html! { code { (hash.to_string()) } },
        None => cell("–"),
    }
}
