//! `shapematch bench --mapping`: errors and times of the mapping.

use std::fmt::Write as _;
use std::process::ExitCode;

use super::args::BenchArgs;
use super::{UsageError, check_outputs, json_target, print, progress, takes_stdout, write_json};
use crate::pipeline::bench::map::{MapBench, map_bench, table_names};
use crate::text::{counted, fixed, grouped};

/// Measures and prints the tables.
pub fn run(args: &BenchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    check_outputs(json_target(args.json.as_deref()), &[])?;
    if let Some(only) = &args.only
        && !table_names().iter().any(|name| name.contains(only))
    {
        let names = table_names().join(", ");
        let text = format!("no table has {only:?} in its name; the tables are: {names}");
        return Err(UsageError(text).into());
    }
    let monitor = progress::monitor(quiet);
    let bench = map_bench(args.only.as_deref(), &monitor)?;
    drop(monitor);
    if !takes_stdout(args.json.as_deref()) {
        print(&describe(&bench))?;
    }
    if let Some(path) = &args.json {
        write_json(path, &bench)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn describe(bench: &MapBench) -> String {
    let mut text = String::from(
        "Errors against the means of the known fields over each element: RMS in % of the range of the\n\
         truth; means and peak of the plastic strain against the truth in %, its peak against that of\n\
         the stamped elements, there and back 95 % of the range. exact: the truth itself\n\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{:<10}{:>12}{:>18}{:>9}{:>8}{:>10}{:>9}{:>9}{:>11}{:>10}{:>8}{:>8}{:>7}{:>8}",
        "part",
        "edges mm",
        "elements",
        "method",
        "area",
        "thickness",
        "plastic",
        "stress",
        "mean thick",
        "mean pl.",
        "peak",
        "stamped",
        "back",
        "ms"
    );
    let percent = |fraction: f64, decimals: usize| fixed(100.0 * fraction, decimals);
    for row in &bench.errors {
        let [stamped, crash] = row.sizes;
        let [from, to] = row.n_elements;
        let _ = writeln!(
            text,
            "{:<10}{:>12}{:>18}{:>9}{:>8}{:>10}{:>9}{:>9}{:>11}{:>10}{:>8}{:>8}{:>7}{:>8}",
            row.part,
            format!("{stamped} → {crash}"),
            format!("{} → {}", grouped(from), grouped(to)),
            row.method,
            percent(row.mapped_area, 1),
            percent(row.thickness_rms, 2),
            percent(row.plastic_rms, 2),
            percent(row.stress_rms, 2),
            percent(row.thickness_mean, 3),
            percent(row.plastic_mean, 3),
            percent(row.plastic_peak - 1.0, 1),
            percent(row.peak_of_stamped - 1.0, 1),
            percent(row.back_p95, 1),
            time(row.map_ms)
        );
    }
    let Some(speed) = &bench.speed else {
        return text;
    };
    let [from, to] = speed.n_elements;
    let megabytes = speed.n_bytes as f64 / 1e6;
    let more = [
        speed
            .cpu_ms
            .map(|ms| format!(" ({ms:.0} ms of processor time)")),
        speed.peak_bytes.map(|bytes| {
            format!(
                ", {:.0} MB more at the peak of the mapping",
                bytes as f64 / 1e6
            )
        }),
    ];
    let [cpu, peak] = more.map(Option::unwrap_or_default);
    let _ = writeln!(
        text,
        "\n{} → {} elements, {}, all quantities, {}: mapped in {:.0} ms{cpu}; {:.0} MB of states \
         written in {:.0} ms ({:.0} MB/s); results of both sides {:.0} MB{peak}",
        grouped(from),
        grouped(to),
        counted(speed.n_layers, "layer"),
        counted(speed.n_threads, "thread"),
        speed.map_ms,
        megabytes,
        speed.write_ms,
        megabytes / speed.write_ms * 1e3,
        speed.result_bytes as f64 / 1e6
    );
    text
}

/// Milliseconds, or a dash for the row of exact values, which no mapping took time for.
fn time(ms: f64) -> String {
    if ms.is_nan() {
        "–".to_owned()
    } else {
        fixed(ms, 0)
    }
}
