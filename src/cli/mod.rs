//! The command line: runs the pipeline without a window. The only place that prints.
//!
//! Results go to standard output, messages to standard error. Exit status: 0 done, with a pose that is good
//! or to be checked where there is one; 3 done, but the pose is poor; 1 failed; 2 wrong usage.

mod args;
mod bench;
mod growth;
mod info;
mod map;
mod map_bench;
mod map_car;
mod map_choices;
mod map_files;
mod map_text;
mod map_unused;
mod match_text;
mod matching;
mod numbers;
mod of_each;
mod placing;
mod progress;
mod project;
mod recipe;
mod reduce;
mod robustness;
mod sample;
mod setting_args;
mod terminal;
mod unknown;
mod words;

pub use args::{Cli, Task};

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use serde::Serialize;

pub use self::terminal::printable;
pub use self::unknown::{refuse_unknown, refuse_window_options};
use crate::formats::model::other_order;
use crate::pipeline::PipelineError;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::outputs::{Content, Target, check_targets, json_text};
use crate::pipeline::write_file::write_file;

/// Exit status for a pose that was found but is poor.
pub const EXIT_POOR: u8 = 3;
/// Exit status for wrong usage, as clap gives it.
pub const EXIT_USAGE: u8 = 2;

/// Says which parts of a stamped file are left out as tools, and the option that takes them.
fn warn_of_tools(stamped: &LoadedPart) {
    if let Some(line) = stamped.tools_line() {
        log::warn!("{line}; --stamped-part all takes them too");
    }
}

/// Says that two files were probably named in the other order.
fn warn_of_order(crash: &LoadedPart, stamped: &LoadedPart) {
    if let Some(evidence) = other_order(&crash.model, &stamped.model) {
        log::warn!(
            "{} carries {} and is named first, as the crash part, while {} carries none; were the files named in the \
             other order?",
            crash.file_name(),
            evidence.words(),
            stamped.file_name()
        );
    }
}

/// Runs one subcommand.
pub fn run(task: &Task, quiet: bool) -> anyhow::Result<ExitCode> {
    if let Some(read) = task.read() {
        read.warn_of_folders();
    }
    match task {
        Task::Match(args) => matching::run(args, quiet),
        Task::Map(args) => map::run(args, quiet),
        Task::MapCar(args) => map_car::run(args, quiet),
        Task::Reduce(args) => reduce::run(args, quiet),
        Task::Info(args) => info::run(args, quiet),
        Task::Sample(args) => sample::run(args),
        Task::Bench(args) if args.growth => growth::run(args, quiet),
        Task::Bench(args) if args.robustness => robustness::run(args, quiet),
        Task::Bench(args) if args.mapping => map_bench::run(args, quiet),
        Task::Bench(args) => bench::run(args, quiet),
    }
}

/// What was asked for cannot be done, whatever the files hold.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct UsageError(String);

/// The exit status for an error.
pub fn exit_status(error: &anyhow::Error) -> ExitCode {
    let is_setting = match error.downcast_ref::<PipelineError>() {
        Some(PipelineError::BadUnitFactor(_)) => true,
        Some(PipelineError::Registration(error)) => error.is_setting(),
        _ => false,
    };
    if is_setting || error.is::<UsageError>() {
        ExitCode::from(EXIT_USAGE)
    } else {
        ExitCode::FAILURE
    }
}

/// Writes JSON to a file, or to standard output if the path is `-`.
fn write_json(path: &Path, value: &impl Serialize) -> anyhow::Result<()> {
    write_output(path, json_text(value)?.as_bytes())
}

/// Writes to a file, or to standard output if the path is `-`.
fn write_output(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if is_stdout(path) {
        return print_exactly(bytes);
    }
    Ok(write_file(path, bytes)?)
}

/// What `--json` writes, for the check before the work.
fn json_target(json: Option<&Path>) -> Option<Target> {
    text_target("--json", json)
}

/// What an option writes as text, for the check before the work.
fn text_target(option: &str, path: Option<&Path>) -> Option<Target> {
    Some(Target {
        name: option.to_owned(),
        path: path?.to_path_buf(),
        content: Content::Text,
    })
}

/// Refuses outputs that cannot be written, share a name or would overwrite one of the `inputs`. The name of a mesh
/// decides its format, so that none goes to standard output.
fn check_outputs(
    targets: impl IntoIterator<Item = Target>,
    inputs: &[PathBuf],
) -> anyhow::Result<()> {
    let (printed, files): (Vec<Target>, Vec<Target>) = targets
        .into_iter()
        .partition(|target| is_stdout(&target.path) && target.content != Content::Mesh);
    let mut reasons: Vec<String> = Vec::new();
    if let [first, .., last] = &printed[..] {
        let (first, last) = (&first.name, &last.name);
        reasons.push(format!("{first} and {last} both write to standard output"));
    }
    let refusals = check_targets(&files, inputs);
    reasons.extend(refusals.iter().map(ToString::to_string));
    if reasons.is_empty() {
        return Ok(());
    }
    Err(UsageError(reasons.join("; ")).into())
}

/// True for the path that stands for standard output.
fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Prints text for people to standard output; control characters that a file smuggled in are
/// shown, not sent to the terminal.
fn print(text: &str) -> anyhow::Result<()> {
    print_exactly(printable(text).as_bytes())
}

/// Prints to standard output. A reader that has gone away is no error.
fn print_exactly(bytes: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    // What stays in the buffer would be lost without a word.
    let written = out.write_all(bytes).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("standard output cannot be written"),
    }
}

/// True if this JSON target takes over standard output, so that no report may go there.
fn takes_stdout(json: Option<&Path>) -> bool {
    json.is_some_and(is_stdout)
}
