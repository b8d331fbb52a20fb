//! The report of a mapping: what became of the elements, both sides of each quantity with pictures, and
//! another result beside it.

use maud::{Markup, html};

use super::page::{Column, block, cell, document, fact_table, printable, section, table};
use super::sections::pictures;
use super::tables::file_table;
use super::{Figure, charts};
use crate::colormap::ColorScale;
use crate::report::FileRecord;
use crate::role::PerRole;
use crate::text::Lengths;

/// A row of numbers: mean, smallest, 5, 50, 95, 99 %, largest.
pub type NumberRow = [String; 7];

/// One quantity on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityReport {
    /// What it is called, with its unit.
    pub name: String,
    /// Rows by what they are about.
    pub rows: Vec<(String, NumberRow)>,
    /// Shares of the area in equal bins, of the stamped part and of the crash part.
    pub shares: [Vec<f64>; 2],
    /// What the bins span.
    pub range: [f64; 2],
    /// How far both histograms are apart, 0 to 1.
    pub histogram_distance: f64,
    /// Before, after and the difference.
    pub figures: Vec<Figure>,
    /// Colours of the first two pictures, and of the difference.
    pub scales: [ColorScale; 2],
    /// What the two histograms are of.
    pub sides: [String; 2],
    /// What the difference is.
    pub difference: &'static str,
}

/// A check: what is checked, found and asked for, whether it is met, and why it is judged so.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckReport {
    /// Name, finding, limit.
    pub cells: [String; 3],
    /// Whether it is met; `None` for what is stated and not judged.
    pub is_met: Option<bool>,
    /// Why it is judged against something else than the stamped values as they are.
    pub reason: Option<&'static str>,
}

/// Which of several stamped files gave the elements their values.
#[derive(Debug, Clone, PartialEq)]
pub struct FilesReport {
    /// The elements in the colours of the files.
    pub figure: Figure,
    /// The CSS background of each file, and its name, elements, share of the area; what has no values last.
    pub rows: Vec<(String, [String; 3])>,
}

/// Everything the report of a mapping shows.
#[derive(Debug, Clone, PartialEq)]
pub struct MapReport {
    /// Which program made it.
    pub build: String,
    /// Names of the crash file and of the stamped files.
    pub names: [String; 2],
    /// The main figures: name, value, what the value is.
    pub facts: Vec<[String; 3]>,
    /// What to look at.
    pub warnings: Vec<String>,
    /// The checks, in their order.
    pub checks: Vec<CheckReport>,
    /// Elements by status: words, count, share of the area.
    pub statuses: Vec<[String; 3]>,
    /// The elements in the colours of their status, with the colour of each.
    pub status_figures: Vec<Figure>,
    /// Colours of the statuses that occur.
    pub status_colors: Vec<(String, String)>,
    /// Where the values come from, if from several stamped files.
    pub files: Option<FilesReport>,
    /// Thickness, plastic strain …
    pub quantities: Vec<QuantityReport>,
    /// Pinned elements, a row for each quantity: crash and stamped element, status, distance, angle,
    /// confidence, quantity, stamped and mapped value, difference.
    pub probes: Vec<[String; 10]>,
    /// Another result: what each row is about, and elements, mean, RMS, 95 %, largest difference, element.
    pub comparison: Vec<(String, [String; 6])>,
    /// Both results of each quantity that was compared.
    pub compared: Vec<QuantityReport>,
    /// The files of the other result.
    pub compared_with: String,
    /// The matrix of each stamped part by rows.
    pub poses: Vec<(String, String)>,
    /// What it was mapped with: name, value.
    pub settings: Vec<(&'static str, String)>,
    /// The files as they were read.
    pub read: PerRole<Vec<FileRecord>>,
    /// How lengths are written.
    pub lengths: Lengths,
    /// The line that maps the same again; empty if there is none.
    pub command_line: String,
}

impl MapReport {
    /// The whole page as HTML.
    pub fn write(&self) -> String {
        let [crash, stamped] = self.names.each_ref().map(|name| printable(name));
        let body = html! {
            header {
                p.kicker { "Mapping of forming results" }
                h1 {
                    span.stamped { "▲ " (stamped) } span.joint { " onto " }
                    span.crash { "■ " (crash) }
                }
                (self.checks_met())
                (self.facts())
            }
            main { (self.main()) }
            footer { p { (self.build) } }
        };
        document(
            &html! { (stamped) " mapped onto " (crash) },
            &self.build,
            &body,
        )
    }

    /// How many of the checks that ask for something are met, and which are not.
    fn checks_met(&self) -> Markup {
        let asked = || self.checks.iter().filter(|check| check.is_met.is_some());
        let missed: Vec<&CheckReport> = asked().filter(|c| c.is_met == Some(false)).collect();
        let n_asked = asked().count();
        let (class, sign) = if missed.is_empty() {
            ("verdict good", "✔")
        } else {
            ("verdict check", "!")
        };
        html! {
            @if n_asked > 0 {
                div class=(class) {
                    strong { (sign) " " (n_asked - missed.len()) " of " (n_asked) " checks met" }
                    ul {
                        @for check in missed {
                            li { (check.cells[0]) ": " (check.cells[1]) ", asked for " (check.cells[2]) }
                        }
                    }
                }
            }
        }
    }

    fn facts(&self) -> Markup {
        html! {
            dl.figures {
                @for [name, value, note] in &self.facts {
                    div { dt { (name) } dd { (value) @if !note.is_empty() { small { (note) } } } }
                }
            }
            @if !self.warnings.is_empty() {
                div class="verdict check" {
                    strong { "Look at" }
                    ul { @for warning in &self.warnings { li { (printable(warning)) } } }
                }
            }
        }
    }

    fn main(&self) -> Markup {
        html! {
            (section("checks", "Checks", &self.check_table()))
            (section("elements", "Elements", &self.elements()))
            @if let Some(files) = &self.files {
                (section("files", "From file", &files.content()))
            }
            @for (i, quantity) in self.quantities.iter().enumerate() {
                (section(&format!("quantity-{i}"), &quantity.name, &quantity.content()))
            }
            @if !self.probes.is_empty() {
                (section("probes", "Probes", &self.probe_table()))
            }
            @if !self.comparison.is_empty() {
                (section("comparison", "Beside another result", &self.other()))
            }
            (section("poses", "Poses", &self.pose_blocks()))
            (section("settings", "Settings", &self.settings_table()))
            (section("read", "Files", &self.file_tables()))
            @if !self.command_line.is_empty() {
                (section("repeat", "Repeat", &self.repeat()))
            }
        }
    }

    fn settings_table(&self) -> Markup {
        let rows = self.settings.iter();
        let rows: Vec<(&str, Markup)> = rows.map(|(name, value)| (*name, cell(value))).collect();
        fact_table("Settings", &rows)
    }

    fn file_tables(&self) -> Markup {
        // Thicknesses stand among the quantities, with the factor they were mapped with.
        let bare = |file: &FileRecord| FileRecord {
            thickness: None,
            ..file.clone()
        };
        let of = |title, files: &[FileRecord]| {
            html! { @for file in files { (file_table(title, &bare(file), self.lengths)) } }
        };
        html! {
            (of("■ Crash file", &self.read.crash))
            (of("▲ Stamped file", &self.read.stamped))
        }
    }

    fn repeat(&self) -> Markup {
        html! {
            p { "This line maps the same again:" }
            (block("the command line", &self.command_line, true))
        }
    }

    fn check_table(&self) -> Markup {
        let row = |check: &CheckReport| {
            let met = match check.is_met {
                Some(true) => "✔ met",
                Some(false) => "✖ not met",
                None => "told, not judged",
            };
            let mut row: Vec<Markup> = check.cells.iter().map(cell).collect();
            row.push(cell(met));
            row
        };
        let rows: Vec<Vec<Markup>> = self.checks.iter().map(row).collect();
        let columns = [
            Column::text("Check"),
            Column::number("Found"),
            Column::text("Asked for"),
            Column::text("Result"),
        ];
        let reasons = self.checks.iter();
        let reasons = reasons.filter_map(|check| Some((&check.cells[0], check.reason?)));
        html! {
            (table("What was found beside what is asked for", &columns, &rows))
            @for (name, reason) in reasons { p { b { (name) ": " } (reason) } }
        }
    }

    fn elements(&self) -> Markup {
        let rows: Vec<Vec<Markup>> = self
            .statuses
            .iter()
            .map(|row| row.iter().map(cell).collect())
            .collect();
        let columns = [
            Column::text("Status"),
            Column::number("Elements"),
            Column::number("Area"),
        ];
        html! {
            (table("What became of the elements of the crash part", &columns, &rows))
            (pictures(&self.status_figures))
            (color_legend(self.status_colors.iter().map(|(name, color)| (&**name, &**color))))
        }
    }

    fn probe_table(&self) -> Markup {
        let row = |row: &[String; 10]| row.iter().map(cell).collect::<Vec<Markup>>();
        let rows: Vec<Vec<Markup>> = self.probes.iter().map(row).collect();
        let columns = [
            Column::number("■ element"),
            Column::number("▲ element"),
            Column::text("Status"),
            Column::number("Distance"),
            Column::number("Angle, °"),
            Column::number("Confidence"),
            Column::text("Quantity"),
            Column::number("▲ stamped"),
            Column::number("■ mapped"),
            Column::number("Difference"),
        ];
        table("Pinned elements with both values", &columns, &rows)
    }

    fn other(&self) -> Markup {
        let rows = named_rows(&self.comparison);
        let columns = [
            Column::text("Quantity"),
            Column::number("Elements in both"),
            Column::number("Mean difference"),
            Column::number("RMS"),
            Column::number("P95"),
            Column::number("Largest"),
            Column::number("at element"),
        ];
        html! {
            p { "This mapping less " (printable(&self.compared_with)) ", element by element." }
            (table("Differences, weighted by area", &columns, &rows))
            @for quantity in &self.compared {
                h3 { (quantity.name) }
                (quantity.content())
            }
        }
    }

    fn pose_blocks(&self) -> Markup {
        html! {
            @for (name, rows) in &self.poses {
                p { "crash = c · R · stamped + t for " (printable(name)) ", by rows:" }
                (block("the matrix by rows", rows, false))
            }
        }
    }
}

/// What the colours of a picture mean: names with their CSS backgrounds.
fn color_legend<'a>(rows: impl Iterator<Item = (&'a str, &'a str)>) -> Markup {
    html! {
        ul.legend {
            @for (name, background) in rows {
                li { i style={ "background:" (background) } {} (printable(name)) }
            }
        }
    }
}

impl FilesReport {
    fn content(&self) -> Markup {
        let row = |(_, row): &(String, [String; 3])| row.iter().map(cell).collect();
        let rows: Vec<Vec<Markup>> = self.rows.iter().map(row).collect();
        let columns = [
            Column::text("Stamped file"),
            Column::number("Elements"),
            Column::number("Area"),
        ];
        html! {
            (table("Which stamped file gave the elements their values", &columns, &rows))
            (pictures(std::slice::from_ref(&self.figure)))
            (color_legend(self.rows.iter().map(|(color, [name, ..])| (&**name, &**color))))
        }
    }
}

/// Rows of cells that begin with their names.
fn named_rows<const N: usize>(rows: &[(String, [String; N])]) -> Vec<Vec<Markup>> {
    let row = |(name, row): &(String, [String; N])| {
        let cells = row.iter().map(cell);
        std::iter::once(cell(name)).chain(cells).collect()
    };
    rows.iter().map(row).collect()
}

impl QuantityReport {
    fn content(&self) -> Markup {
        let rows = named_rows(&self.rows);
        let columns = [
            Column::text("Side"),
            Column::number("Mean"),
            Column::number("Min"),
            Column::number("5 %"),
            Column::number("Median"),
            Column::number("95 %"),
            Column::number("99 %"),
            Column::number("Max"),
        ];
        let facts = [(
            "Distance of the histograms (0 equal, 1 disjoint)",
            cell(format!("{:.4}", self.histogram_distance)),
        )];
        html! {
            div class="pictures three" {
                @for one in &self.figures { (super::sections::figure(one)) }
            }
            div.scale { (charts::plain_legend(&self.scales[0], &self.name)) }
            div.scale { (charts::plain_legend(&self.scales[1], self.difference)) }
            (table("Distribution, weighted by area", &columns, &rows))
            // Values that are all one have no axis to stand on.
            @if self.range[0] < self.range[1] {
                (charts::two_histograms(&self.shares, self.range, &self.name))
                ul.legend {
                    li { i style="background:var(--stamped);opacity:.45" {} (self.sides[0]) }
                    li { i.line style="border-color:var(--crash)" {} (self.sides[1]) }
                }
            }
            (fact_table("Both histograms", &facts))
        }
    }
}

/// A picture of a mapping with its words.
pub fn map_figure(png: Vec<u8>, size: [usize; 2], title: &str, caption: &str) -> Figure {
    Figure {
        png,
        size,
        alt: format!("{title} {caption}"),
        title: title.to_owned(),
        caption: caption.to_owned(),
        is_marked: false,
    }
}
