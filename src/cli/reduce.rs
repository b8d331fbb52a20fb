//! `shapematch reduce`: a mesh with fewer triangles, and how far it is from the original.

use std::process::ExitCode;

use serde::Serialize;

use super::args::ReduceArgs;
use super::{check_outputs, json_target, print, progress, takes_stdout, write_json, write_output};
use crate::formats::Format;
use crate::geometry::Similarity;
use crate::pipeline::load::{LoadSettings, load, parse_selection};
use crate::pipeline::outputs::deck::{format_of, reduced_bytes, reduced_lacks};
use crate::pipeline::outputs::{Content, Target};
use crate::pipeline::reduce::{Deviation, Level, Levels};
use crate::simplify::{SimplifySettings, Speed, StopReason};
use crate::text::{counted, grouped, length, millis};

/// The figures of a reduction.
#[derive(Debug, Serialize)]
struct ReduceRecord {
    schema: &'static str,
    triangles_before: usize,
    triangles_after: usize,
    max_triangles: usize,
    reached: bool,
    stopped_by: String,
    time_ms: f64,
    rms: f64,
    max: f64,
    border_rms: f64,
    border_max: f64,
    border_loops_before: usize,
    border_loops_after: usize,
    build: String,
}

/// Reduces the file's part and writes it.
pub fn run(args: &ReduceArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let monitor = progress::monitor(quiet);
    check_outputs(targets(args), std::slice::from_ref(&args.input))?;
    let selection = args
        .part
        .as_deref()
        .map(parse_selection)
        .unwrap_or_default();
    let part = load(
        &args.input,
        &LoadSettings {
            selection,
            read: args.read.options(),
            ..LoadSettings::default()
        },
        &monitor,
    )?;
    check_outputs(targets(args), &part.files())?;
    let settings = settings(args);
    let levels = Levels::record(&part, &settings, &monitor)?;
    let level = levels.level(args.triangles, &monitor)?;
    let deviation = levels.measure(&level.mesh, &monitor)?;
    let record = record(args, &levels, &level, &deviation);
    if !takes_stdout(args.json.as_deref()) {
        print(&describe(&record))?;
    }
    let format = format_of(&args.out)?;
    let bytes = reduced_bytes(
        format,
        &part,
        &level.mesh,
        &Similarity::identity(),
        &monitor,
    )?;
    if format == Format::Keyword
        && let Some(lacks) = reduced_lacks(&part)
    {
        log::warn!("{}: {lacks}", args.out.display());
    }
    let mut is_complete = true;
    let mut note = |option: &str, written: anyhow::Result<()>| {
        if let Err(error) = written {
            log::error!("{option} is not written: {error:#}");
            is_complete = false;
        }
    };
    note("--out", write_output(&args.out, &bytes));
    if let Some(path) = &args.json {
        note("--json", write_json(path, &record));
    }
    Ok(if is_complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn targets(args: &ReduceArgs) -> Vec<Target> {
    let out = Target {
        name: "--out".to_owned(),
        path: args.out.clone(),
        content: Content::Mesh,
    };
    let json = json_target(args.json.as_deref());
    std::iter::once(out).chain(json).collect()
}

fn settings(args: &ReduceArgs) -> SimplifySettings {
    let speed = if args.fast { Speed::Fast } else { Speed::Exact };
    SimplifySettings {
        speed,
        ..SimplifySettings::to_triangles(args.triangles)
    }
}

fn record(
    args: &ReduceArgs,
    levels: &Levels,
    level: &Level,
    deviation: &Deviation,
) -> ReduceRecord {
    ReduceRecord {
        schema: "shapematch.reduce/1",
        triangles_before: level.report.triangles_before,
        triangles_after: level.report.triangles_after,
        max_triangles: args.triangles,
        reached: level.report.stop_reason == StopReason::Reached,
        stopped_by: level.report.stop_reason.to_string(),
        time_ms: levels.record_ms,
        rms: deviation.rms,
        max: deviation.max,
        border_rms: deviation.border_rms,
        border_max: deviation.border_max,
        border_loops_before: deviation.loops_before,
        border_loops_after: deviation.loops_after,
        build: crate::report::build_id(),
    }
}

fn describe(record: &ReduceRecord) -> String {
    let mut text = format!(
        "{} of {} (maximum {}) in {}\n",
        grouped(record.triangles_after),
        counted(record.triangles_before, "triangle"),
        grouped(record.max_triangles),
        millis(record.time_ms),
    );
    if !record.reached {
        text.push_str(&format!("Above the maximum: {}\n", record.stopped_by));
    }
    text.push_str(&format!(
        "Deviation, both ways: RMS {}, max {}\n",
        length(record.rms),
        length(record.max)
    ));
    if record.border_loops_before > 0 {
        text.push_str(&format!(
            "Borders moved: RMS {}, max {}; {} of {} loops kept\n",
            length(record.border_rms),
            length(record.border_max),
            record.border_loops_after,
            record.border_loops_before
        ));
    }
    text
}
