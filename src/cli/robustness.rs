//! `shapematch bench --robustness`: how often the match is right and the verdict honest.

use std::fmt::Write as _;
use std::process::ExitCode;

use super::args::BenchArgs;
use super::bench::{check_table, write_table};
use super::{UsageError, progress};
use crate::pipeline::bench::robustness::{RobustnessSettings, robustness};
use crate::pipeline::bench::robustness_page::page;
use crate::pipeline::bench::robustness_table::{COLUMNS, RobustnessTable, notes};
use crate::samples::SamplePart;
use crate::samples::scenario::Scenario;

/// Runs the pairs and prints the table.
pub fn run(args: &BenchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    check_table(args)?;
    let settings = settings(args)?;
    let monitor = progress::monitor(quiet);
    let runs = robustness(&settings, &monitor, |_| {})?;
    drop(monitor);
    let table = RobustnessTable::new(settings.seed, &runs);
    write_table(args, &describe(&table), &table, &page(&table, &runs))
}

fn settings(args: &BenchArgs) -> anyhow::Result<RobustnessSettings> {
    let mut settings = RobustnessSettings {
        seed: args.seed,
        n_runs: args.runs,
        ..RobustnessSettings::default()
    };
    let Some(only) = &args.only else {
        return Ok(settings);
    };
    // Each word narrows either the parts or the scenarios.
    let words: Vec<&str> = only.split(',').map(str::trim).collect();
    let parts = SamplePart::ALL.map(|part| part.name().to_owned());
    let scenarios = Scenario::ALL.map(Scenario::name);
    // A name may hold a comma too: "coarse, 16-20 mm".
    let names = |word: &str, name: &str| name.split(", ").any(|piece| piece.starts_with(word));
    let begins = |word: &&str, all: &[String]| all.iter().any(|name| names(word, name));
    let is_unknown = |word: &&&str| !begins(word, &parts) && !begins(word, &scenarios);
    if let Some(word) = words.iter().find(is_unknown) {
        let (parts, scenarios) = (parts.join("; "), scenarios.join("; "));
        let text = format!("no part ({parts}) and no scenario ({scenarios}) begins like {word:?}");
        return Err(UsageError(text).into());
    }
    let is_meant = |name: &str| words.iter().any(|word| names(word, name));
    let all = SamplePart::ALL.into_iter();
    let parts: Vec<SamplePart> = all.filter(|part| is_meant(part.name())).collect();
    let all = Scenario::ALL.into_iter();
    let scenarios: Vec<Scenario> = all.filter(|scenario| is_meant(&scenario.name())).collect();
    if !parts.is_empty() {
        settings.parts = parts;
    }
    if !scenarios.is_empty() {
        settings.scenarios = scenarios;
    }
    Ok(settings)
}

fn describe(table: &RobustnessTable) -> String {
    let mut lines: Vec<Vec<String>> = vec![COLUMNS.map(str::to_owned).to_vec()];
    lines.extend(table.rows.iter().map(|row| row.cells()));
    lines.push(table.total.cells());
    let width = |col: usize| {
        let widths = lines.iter().map(|line| line[col].chars().count());
        widths.max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..COLUMNS.len()).map(width).collect();
    let mut text = String::new();
    for line in &lines {
        for (col, (cell, width)) in line.iter().zip(&widths).enumerate() {
            // Writing to a string cannot fail.
            let _ = if col == 0 {
                write!(text, "{cell:<width$}")
            } else {
                write!(text, "  {cell:>width$}")
            };
        }
        text.push('\n');
    }
    let _ = writeln!(text, "\n{}", notes());
    text
}
