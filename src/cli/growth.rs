//! `shapematch bench --growth`: how the time of a match grows with the triangles.

use std::fmt::Write as _;
use std::process::ExitCode;

use super::args::BenchArgs;
use super::{print, progress, takes_stdout, write_json, write_output};
use crate::pipeline::bench::growth::{GrowthTable, growth};
use crate::pipeline::bench::growth_page::{GROWTH_COLUMNS, growth_page};

/// Measures all sizes and prints the table.
pub fn run(args: &BenchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let monitor = progress::monitor(quiet);
    let table = growth(args.largest, &monitor, |_| {})?;
    drop(monitor);
    let texts = [&args.json, &args.html];
    if !texts.iter().any(|text| takes_stdout(text.as_deref())) {
        print(&describe(&table))?;
    }
    if let Some(path) = &args.json {
        write_json(path, &table)?;
    }
    if let Some(path) = &args.html {
        write_output(path, growth_page(&table).as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn describe(table: &GrowthTable) -> String {
    let mut text = String::new();
    let rows = table.rows.iter().map(|row| row.cells());
    for cells in std::iter::once(GROWTH_COLUMNS.map(str::to_owned)).chain(rows) {
        let [triangles, prepare, matching, verdict, node] = cells;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{triangles:>12}{prepare:>14}{matching:>12}{verdict:>10}{node:>16}"
        );
    }
    let _ = writeln!(text, "\n{}", table.notes());
    text
}
