//! `shapematch bench`: the paper's tables with its column beside ours.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde::Serialize;

use super::args::BenchArgs;
use super::{
    check_outputs, json_target, print, progress, takes_stdout, text_target, write_json,
    write_output,
};
use crate::formats::{Disk, FileSource, Memory};
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadSettings, LoadedPart, load_from};
use crate::pipeline::sweep::{Sweep, SweepSettings, sweep};
use crate::role::PerRole;
use crate::samples::{self, SampleSettings};
use crate::text::{grouped, length};

/// Measures and prints both tables.
pub fn run(args: &BenchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let monitor = progress::monitor(quiet);
    let named = args.crash.iter().chain(&args.stamped).cloned();
    let named: Vec<PathBuf> = named.collect();
    check_outputs(json_target(args.json.as_deref()), &named)?;
    let (parts, truth) = parts(args, &monitor)?;
    let settings = SweepSettings::default();
    let tables = sweep(parts.as_ref(), truth.as_ref(), &settings, &monitor, |_| {})?;
    drop(monitor);
    if !takes_stdout(args.json.as_deref()) {
        print(&describe(&tables, parts.as_ref()))?;
    }
    if let Some(path) = &args.json {
        write_json(path, &tables.to_record())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Refuses files for a table and its page that cannot be written.
pub(super) fn check_table(args: &BenchArgs) -> anyhow::Result<()> {
    let json = json_target(args.json.as_deref());
    let html = text_target("--html", args.html.as_deref());
    check_outputs(json.into_iter().chain(html), &[])
}

/// Writes a table where it was asked for, and prints it as `text` unless one of these is standard output.
pub(super) fn write_table(
    args: &BenchArgs,
    text: &str,
    table: &impl Serialize,
    page: &str,
) -> anyhow::Result<ExitCode> {
    let files = [&args.json, &args.html];
    if !files.iter().any(|file| takes_stdout(file.as_deref())) {
        print(text)?;
    }
    if let Some(path) = &args.json {
        write_json(path, table)?;
    }
    if let Some(path) = &args.html {
        write_output(path, page.as_bytes())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The files named, or the generated car floor with its known pose.
fn parts(
    args: &BenchArgs,
    monitor: &Monitor,
) -> anyhow::Result<(PerRole<LoadedPart>, Option<Similarity>)> {
    let load = |source: &dyn FileSource, path: &Path| {
        load_from(source, path, &LoadSettings::default(), monitor)
    };
    if let (Some(crash), Some(stamped)) = (&args.crash, &args.stamped) {
        let parts = PerRole::new(load(&Disk, crash)?, load(&Disk, stamped)?);
        return Ok((parts, None));
    }
    let pair = samples::generate(&SampleSettings {
        seed: 1,
        ..SampleSettings::default()
    });
    let mut source = Memory::new();
    for file in samples::files(&pair) {
        source = source.with(file.name, file.bytes);
    }
    let crash = load(&source, Path::new("crash.k"))?;
    let stamped = load(&source, Path::new("stamped.dynain"))?;
    Ok((PerRole::new(crash, stamped), Some(pair.crash_from_stamped)))
}

fn describe(tables: &Sweep, parts: PerRole<&LoadedPart>) -> String {
    let mut text = format!(
        "Crash    {}, {} triangles\nStamped  {}, {} triangles\nThreads  {}\n\n",
        parts.crash.file_name(),
        grouped(parts.crash.mesh.n_triangles()),
        parts.stamped.file_name(),
        grouped(parts.stamped.mesh.n_triangles()),
        rayon::current_num_threads()
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "Reduction of {} triangles\n{:>10}{:>12}{:>10}{:>10}{:>10}{:>10}{:>12}{:>8}",
        grouped(tables.n_triangles),
        "maximum",
        "paper ms",
        "here ms",
        "faster",
        "RMS",
        "max",
        "border max",
        "loops"
    );
    for row in &tables.reduction {
        let _ = writeln!(
            text,
            "{:>10}{:>12}{:>10.1}{:>10}{:>10}{:>10}{:>12}{:>8}",
            grouped(row.max_triangles),
            paper(row.paper_ms),
            row.time_ms,
            faster(row.paper_ms, row.time_ms),
            length(row.rms),
            length(row.max),
            length(row.border_max),
            row.loops
        );
    }
    let reference = if tables.has_truth {
        "the known pose"
    } else {
        "the match of the full meshes"
    };
    let _ = writeln!(
        text,
        "\nMatching, node errors against {reference}\n{:>10}{:>12}{:>10}{:>10}{:>11}{:>11}{:>14}{:>15}",
        "triangles",
        "paper ms",
        "here ms",
        "faster",
        "node RMS",
        "node max",
        "finished ms",
        "finished RMS"
    );
    for row in &tables.matching {
        let _ = writeln!(
            text,
            "{:>10}{:>12}{:>10.1}{:>10}{:>11}{:>11}{:>14.1}{:>15}",
            row.max_triangles.map_or_else(|| "full".into(), grouped),
            paper(row.paper_ms),
            row.time_ms,
            faster(row.paper_ms, row.time_ms),
            length(row.node_rms),
            length(row.node_max),
            row.finished_ms,
            length(row.finished_node_rms)
        );
    }
    text
}

fn paper(ms: Option<f64>) -> String {
    ms.map_or_else(|| "-".into(), |ms| grouped(ms as usize))
}

fn faster(paper_ms: Option<f64>, ms: f64) -> String {
    paper_ms.map_or_else(|| "-".into(), |paper| format!("{:.0} x", paper / ms))
}
