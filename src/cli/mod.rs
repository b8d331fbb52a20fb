//! The command line: runs the pipeline without a window. The only place that prints.
//!
//! Results go to standard output, messages to standard error. Exit status: 0 pose found (good or
//! check), 3 pose found but poor, 1 failed, 2 wrong usage.

mod args;
mod bench;
mod info;
mod match_text;
mod matching;
mod progress;
mod project;
mod recipe;
mod reduce;
mod sample;
mod text;
mod words;

pub use args::{Cli, Task};

use std::fs;
use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context as _;
use serde::Serialize;

/// Exit status for a pose that was found but is poor.
pub const EXIT_POOR: u8 = 3;
/// Exit status for wrong usage, as clap gives it.
pub const EXIT_USAGE: u8 = 2;

/// Runs one subcommand.
pub fn run(task: &Task, quiet: bool) -> anyhow::Result<ExitCode> {
    match task {
        Task::Match(args) => matching::run(args, quiet),
        Task::Reduce(args) => reduce::run(args, quiet),
        Task::Info(args) => info::run(args, quiet),
        Task::Sample(args) => sample::run(args),
        Task::Bench(args) => bench::run(args, quiet),
    }
}

/// Writes JSON to a file, or to standard output if the path is `-`.
fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    write_output(path, text.as_bytes())
}

/// Writes to a file, or to standard output if the path is `-`.
fn write_output(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if path == Path::new("-") {
        return print(std::str::from_utf8(bytes).context("the output is not text")?);
    }
    fs::write(path, bytes).with_context(|| format!("cannot write {}", path.display()))
}

/// Prints to standard output. A reader that has gone away is no error.
fn print(text: &str) -> anyhow::Result<()> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}

/// True if this JSON target takes over standard output, so that no report may go there.
fn takes_stdout(json: Option<&Path>) -> bool {
    json == Some(Path::new("-"))
}
