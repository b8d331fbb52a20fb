//! `shapematch bench --growth`: how the time of a match grows with the triangles.

use std::fmt::Write as _;
use std::process::ExitCode;

use super::args::BenchArgs;
use super::bench::{check_table, write_table};
use super::{UsageError, progress};
use crate::pipeline::bench::growth::{GrowthTable, growth};
use crate::pipeline::bench::growth_page::{GROWTH_COLUMNS, growth_page};

/// Measures all sizes and prints the table.
pub fn run(args: &BenchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    check_table(args)?;
    let monitor = progress::monitor(quiet);
    let table = growth(args.largest, &monitor, |_| {})?;
    drop(monitor);
    if table.rows.is_empty() {
        let text = format!("--largest {}: no pair is that small", args.largest);
        return Err(UsageError(text).into());
    }
    write_table(args, &describe(&table), &table, &growth_page(&table))
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
