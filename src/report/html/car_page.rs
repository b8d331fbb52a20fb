//! The page about all stamped parts of a car.

use maud::html;

use super::page::{Column, cell, document, printable, section, table};

/// What the page about a car shows.
#[derive(Debug, Clone, PartialEq)]
pub struct CarReport {
    /// Which program made it.
    pub build: String,
    /// Name of the crash file.
    pub crash: String,
    /// The main figures, by name.
    pub facts: Vec<(&'static str, String)>,
    /// Heads of the columns.
    pub columns: [&'static str; 8],
    /// Cells of each stamped part, and the page about its mapping.
    pub rows: Vec<([String; 8], Option<String>)>,
}

impl CarReport {
    /// The whole page as HTML.
    pub fn write(&self) -> String {
        let crash = printable(&self.crash);
        let columns = self.columns.map(Column::text);
        let rows: Vec<_> = self
            .rows
            .iter()
            .map(|(cells, page)| {
                let mut row: Vec<_> = cells.iter().map(|text| cell(printable(text))).collect();
                if let Some(page) = page {
                    row[0] = html! { a href=(page) { (printable(&cells[0])) } };
                }
                row
            })
            .collect();
        let parts = table("Stamped parts", &columns, &rows);
        let body = html! {
            header {
                p.kicker { "Mapping of forming results" }
                h1 { span.crash { "■ " (crash) } }
                dl.figures {
                    @for (name, value) in &self.facts { div { dt { (name) } dd { (value) } } }
                }
            }
            main { (section("parts", "Stamped parts", &parts)) }
            footer { p { (self.build) } }
        };
        let title = html! { "Stamped parts mapped onto " (crash) };
        document(&title, &self.build, &body)
    }
}
