//! The robustness table as one HTML page with plots that needs nothing else.

use std::fmt::Write as _;

use super::robustness::{COVERAGE, Ending, RobustnessRun};
use super::robustness_table::{COLUMNS, RobustnessRow, RobustnessTable, notes};
use crate::assess::Verdict;

/// Text safe between tags.
fn escaped(text: &str) -> String {
    maud::html! { (text) }.into_string()
}

/// How such pages look.
pub(super) const STYLE: &str = "\
:root{--text:#1c2127;--soft:#55606c;--line:#d9dee4;--page:#fff;--good:#1a7f37;--check:#b26b00;--poor:#c11f2b;\
--right:#0072b2;color-scheme:light dark}\
@media(prefers-color-scheme:dark){:root{--text:#e7eaee;--soft:#a4adb8;--line:#353b43;--page:#15181c;\
--good:#56c271;--check:#e0b040;--poor:#ff7d77;--right:#56b4e9}}\
body{margin:2em auto;max-width:1080px;padding:0 28px;background:var(--page);color:var(--text);\
font:15px/1.5 system-ui,sans-serif;font-variant-numeric:tabular-nums}\
table{border-collapse:collapse;font-size:13.5px;width:100%}td,th{text-align:right;padding:4px 8px;\
border-bottom:1px solid var(--line);white-space:nowrap}td:first-child,th:first-child{text-align:left}\
thead th,.soft{color:var(--soft);font-weight:500}.scroll{overflow-x:auto}pre{color:var(--soft);font:inherit;\
white-space:pre-line}svg{width:100%;height:auto;font:12px system-ui,sans-serif}svg text{fill:var(--soft)}\
svg line{stroke:var(--line)}.g{fill:var(--good)}.c{fill:var(--check)}.p{fill:var(--poor)}.r{fill:var(--right)}\
svg .limit{stroke:var(--soft);stroke-dasharray:5 4}svg{min-width:640px}\
.key.r{color:var(--right)}.key.c{color:var(--check)}";

/// The table with its plots as one HTML page.
pub fn page(table: &RobustnessTable, runs: &[RobustnessRun]) -> String {
    let title = format!("Robustness of shapematch, seed {}", table.seed);
    let rows = table.rows.iter().chain(std::iter::once(&table.total));
    let body: String = rows.map(html_row).collect();
    let head: String = COLUMNS
        .iter()
        .map(|c| format!("<th scope=\"col\">{c}</th>"))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n<pre>{}</pre>\n\
         <div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table></div>\n\
         <h2>Verdicts</h2>\n<p class=\"soft\">Green GOOD, amber CHECK, red POOR. Upper bar: right poses. \
         Lower bar: everything else.</p>\n{}\n\
         <h2>Error against stated uncertainty</h2>\n<p class=\"soft\">Right poses, one dot each, millimetres. Above the \
         dashed line the error is more than {COVERAGE} times the statement.</p>\n{}\n\
         <h2>Time</h2>\n<p class=\"soft\">Every match, milliseconds.</p>\n{}\n</body></html>\n",
        escaped(&notes()),
        verdict_bars(&table.rows),
        error_plot(runs),
        time_plot(&table.rows, runs)
    )
}

fn html_row(row: &RobustnessRow) -> String {
    let cells: String = row
        .cells()
        .iter()
        .map(|c| format!("<td>{}</td>", escaped(c)))
        .collect();
    format!("<tr>{cells}</tr>\n")
}

const LINE: f64 = 22.0;
const LEFT: f64 = 150.0;
const WIDTH: f64 = 900.0;

fn named_rows(rows: &[RobustnessRow]) -> String {
    let names = rows.iter().enumerate().map(|(i, row)| {
        let y = (i as f64 + 0.65) * LINE;
        let name = escaped(&row.scenario);
        format!(
            "<text x=\"{}\" y=\"{y:.1}\" text-anchor=\"end\">{name}</text>",
            LEFT - 8.0
        )
    });
    names.collect()
}

fn verdict_bars(rows: &[RobustnessRow]) -> String {
    let height = LINE * rows.len() as f64;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"Verdicts by scenario\">"
    );
    svg += &named_rows(rows);
    for (i, row) in rows.iter().enumerate() {
        let others: [usize; 3] =
            std::array::from_fn(|k| row.twins[k] + row.wrong[k] + row.no_truth[k]);
        let scale = (WIDTH - LEFT) / row.runs.max(1) as f64;
        for (counts, lower) in [(row.right, 0.0), (others, 8.0)] {
            let mut x = LEFT;
            for (count, class) in counts.iter().zip(["g", "c", "p"]) {
                let width = *count as f64 * scale;
                let y = i as f64 * LINE + 3.0 + lower;
                let _ = write!(
                    svg,
                    "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"7\"/>"
                );
                x += width;
            }
        }
    }
    svg + "</svg>"
}

/// A logarithmic axis.
pub(super) struct Axis {
    pub low: f64,
    pub high: f64,
    pub from: f64,
    pub to: f64,
}

impl Axis {
    pub fn at(&self, value: f64) -> f64 {
        let share = (value.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        self.from + share.min(1.0) * (self.to - self.from)
    }

    /// Powers of ten within the axis.
    pub fn ticks(&self) -> impl Iterator<Item = f64> {
        let first = self.low.log10().ceil() as i32;
        let last = self.high.log10().floor() as i32;
        (first..=last).map(|power| 10f64.powi(power))
    }
}

fn error_plot(runs: &[RobustnessRun]) -> String {
    let x = Axis {
        low: 1e-3,
        high: 100.0,
        from: 60.0,
        to: 560.0,
    };
    let y = Axis {
        low: 1e-3,
        high: 100.0,
        from: 400.0,
        to: 10.0,
    };
    let mut svg = String::from(
        "<svg viewBox=\"0 0 580 440\" role=\"img\" aria-label=\"Error over stated uncertainty\">",
    );
    for tick in x.ticks() {
        let (h, v) = (x.at(tick), y.at(tick));
        let _ = write!(
            svg,
            "<line x1=\"{h:.1}\" y1=\"10\" x2=\"{h:.1}\" y2=\"400\"/><text x=\"{h:.1}\" y=\"416\" text-anchor=\"middle\">{tick}</text>\
             <line x1=\"60\" y1=\"{v:.1}\" x2=\"560\" y2=\"{v:.1}\"/><text x=\"54\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>",
            v + 4.0
        );
    }
    let (low, high) = (1e-3, 100.0 / COVERAGE);
    let _ = write!(
        svg,
        "<line class=\"limit\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>\
         <text x=\"310\" y=\"436\" text-anchor=\"middle\">stated uncertainty</text>",
        x.at(low),
        y.at(low * COVERAGE),
        x.at(high),
        y.at(high * COVERAGE)
    );
    for run in runs.iter().filter(|run| run.ending == Ending::Right) {
        let (Some(error), Some(stated)) = (run.node_error, run.uncertainty) else {
            continue;
        };
        let class = class_of(run.verdict);
        let _ = write!(
            svg,
            "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" opacity=\"0.7\"/>",
            x.at(stated),
            y.at(error)
        );
    }
    svg + "</svg>"
}

fn class_of(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Good => "g",
        Verdict::Check => "c",
        Verdict::Poor => "p",
    }
}

fn time_plot(rows: &[RobustnessRow], runs: &[RobustnessRun]) -> String {
    let height = LINE * rows.len() as f64;
    let x = Axis {
        low: 10.0,
        high: 200_000.0,
        from: LEFT,
        to: WIDTH - 10.0,
    };
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {}\" role=\"img\" aria-label=\"Time by scenario\">",
        height + 20.0
    );
    for tick in x.ticks() {
        let h = x.at(tick);
        let _ = write!(
            svg,
            "<line x1=\"{h:.1}\" y1=\"0\" x2=\"{h:.1}\" y2=\"{height}\"/><text x=\"{h:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick}</text>",
            height + 15.0
        );
    }
    svg += &named_rows(rows);
    for (i, row) in rows.iter().enumerate() {
        let of_row = runs
            .iter()
            .filter(|run| run.scenario.name() == row.scenario);
        for run in of_row {
            let y = (i as f64 + 0.5) * LINE;
            let _ = write!(
                svg,
                "<circle class=\"r\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"3\" opacity=\"0.5\"/>",
                x.at(run.time_ms)
            );
        }
    }
    svg + "</svg>"
}
