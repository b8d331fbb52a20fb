//! The growth of the times as one HTML page with its plot.

use std::fmt::Write as _;

use super::growth::{GrowthRow, GrowthTable};
use super::robustness_page::{Axis, STYLE};
use crate::text::{counted, fixed, grouped, length};

/// The heads of the columns.
pub const GROWTH_COLUMNS: [&str; 5] = [
    "triangles",
    "prepare ms",
    "match ms",
    "verdict",
    "worst node mm",
];

impl GrowthRow {
    /// The row as the cells of a table.
    pub fn cells(&self) -> [String; 5] {
        [
            grouped(self.triangles),
            fixed(self.prepare_ms, 1),
            fixed(self.match_ms, 1),
            self.verdict.label().to_owned(),
            length(self.node_error),
        ]
    }
}

impl GrowthTable {
    /// What the numbers are, and how the times grow.
    pub fn notes(&self) -> String {
        let power = |exponent: Option<f64>| {
            exponent.map_or_else(
                || "not fitted".to_owned(),
                |p| format!("n to the power of {}", fixed(p, 2)),
            )
        };
        format!(
            "The generated floor, both meshes finer and finer, {}. Prepare: weld, topology, normals \
             and trees of both meshes. Match: search, finish on the full meshes and assessment, without \
             reading and preparing. The match grows like {}, preparing like {} (least squares over the \
             logarithms of all sizes).",
            counted(self.threads, "thread"),
            power(self.match_exponent),
            power(self.prepare_exponent)
        )
    }
}

/// The table with its plot as one HTML page.
pub fn growth_page(table: &GrowthTable) -> String {
    let title = "Growth of the time of a match";
    let head: String = GROWTH_COLUMNS
        .iter()
        .map(|c| format!("<th scope=\"col\">{c}</th>"))
        .collect();
    let body: String = table.rows.iter().map(html_row).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title}</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n<p class=\"soft\">{}</p>\n\
         <p class=\"soft\"><span class=\"key r\">●</span> match \u{2003} <span class=\"key c\">■</span> prepare \
         \u{2003} ┄ growth of the match like the square root, from the smallest pair</p>\n\
         <div class=\"scroll\">{}</div>\n\
         <div class=\"scroll\"><table><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table></div>\n\
         </body></html>\n",
        table.notes(),
        plot(table)
    )
}

fn html_row(row: &GrowthRow) -> String {
    let cells = row.cells();
    let cells: String = cells.iter().map(|c| format!("<td>{c}</td>")).collect();
    format!("<tr>{cells}</tr>\n")
}

/// What a time grows by that grows like the square root of the triangles.
fn growth(first: &GrowthRow, last: &GrowthRow) -> f64 {
    (last.triangles as f64 / first.triangles as f64).sqrt()
}

/// Ends of the axis of the triangles; the numbers of the times stand left of it.
const LEFT: f64 = 88.0;
const RIGHT: f64 = 880.0;

fn plot(table: &GrowthTable) -> String {
    let sizes = table.rows.iter().map(|row| row.triangles as f64);
    let x = Axis {
        low: 500.0,
        high: (1.5 * sizes.fold(0.0, f64::max)).max(2e4),
        from: LEFT,
        to: RIGHT,
    };
    let times = table
        .rows
        .iter()
        .map(|row| row.match_ms.max(row.prepare_ms));
    let dashed = table.rows.first().zip(table.rows.last());
    let dashed = dashed.map_or(0.0, |(first, last)| first.match_ms * growth(first, last));
    let slowest = times.fold(dashed, f64::max).max(100.0);
    let y = Axis {
        low: 1.0,
        high: 10_f64.powf(slowest.log10().ceil()),
        from: 400.0,
        to: 14.0,
    };
    let mut svg = String::from(
        "<svg viewBox=\"0 0 900 440\" role=\"img\" aria-label=\"Times over triangles, both logarithmic\">",
    );
    for tick in x.ticks() {
        let (at, text) = (x.at(tick), grouped(tick as usize));
        // Writing to a string cannot fail.
        let _ = write!(
            svg,
            "<line x1=\"{at:.1}\" y1=\"14\" x2=\"{at:.1}\" y2=\"400\"/>\
             <text x=\"{at:.1}\" y=\"416\" text-anchor=\"middle\">{text}</text>"
        );
    }
    for tick in y.ticks() {
        let (at, text) = (y.at(tick), grouped(tick as usize));
        let _ = write!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{RIGHT}\" y2=\"{at:.1}\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{text} ms</text>",
            LEFT - 8.0,
            at + 4.0
        );
    }
    svg += "<text x=\"475\" y=\"436\" text-anchor=\"middle\">triangles of both meshes</text>";
    if let (Some(first), Some(last)) = (table.rows.first(), table.rows.last()) {
        let grown = growth(first, last);
        let _ = write!(
            svg,
            "<line class=\"limit\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>",
            x.at(first.triangles as f64),
            y.at(first.match_ms),
            x.at(last.triangles as f64),
            y.at(first.match_ms * grown)
        );
    }
    for (class, of) in [
        ("c", (|row| row.prepare_ms) as fn(&GrowthRow) -> f64),
        ("r", |row| row.match_ms),
    ] {
        for row in &table.rows {
            let (at, up) = (x.at(row.triangles as f64), y.at(of(row)));
            // Told apart without colours too.
            let _ = if class == "r" {
                write!(
                    svg,
                    "<circle class=\"{class}\" cx=\"{at:.1}\" cy=\"{up:.1}\" r=\"5\"/>"
                )
            } else {
                let (left, top) = (at - 4.5, up - 4.5);
                write!(
                    svg,
                    "<rect class=\"{class}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"9\" height=\"9\"/>"
                )
            };
        }
    }
    svg + "</svg>"
}
