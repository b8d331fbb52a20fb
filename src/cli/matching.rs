//! `shapematch match`: from two files to the matrix.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::args::MatchArgs;
use super::recipe::{Asked, asked};
use super::text::short;
use super::{
    EXIT_POOR, EXIT_USAGE, match_text, print, progress, project, takes_stdout, write_json,
    write_output,
};
use crate::assess::Verdict;
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::load::{LoadedPart, load};
use crate::pipeline::match_parts::{MatchRun, ReducedPair, match_parts};
use crate::pipeline::units::PairUnits;
use crate::pipeline::{cards as pipeline_cards, export, node_table, record, report};
use crate::report::{MatchRecord, MatrixForm};

/// Reads, matches, writes what was asked for, and prints the report.
pub fn run(args: &MatchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let monitor = progress::monitor(quiet);
    let (asked, crash, stamped) = match &args.stamped {
        Some(path) => {
            let asked = asked(args)?;
            let (crash, stamped) = load_both([&args.crash, path], &asked, &monitor)?;
            (asked, crash, stamped)
        }
        None if project::is_project(&args.crash) => project::open(&args.crash, &monitor)?,
        None => {
            log::error!(
                "name the stamped part too, or a project alone (.{}): {}",
                project::EXTENSION,
                args.crash.display()
            );
            return Ok(ExitCode::from(EXIT_USAGE));
        }
    };
    let run = run_match(&asked, &crash, &stamped, &monitor)?;
    let record = record::match_record(&run, &crash, &stamped);
    drop(monitor);
    for warning in &record.warnings {
        log::warn!("{warning}");
    }
    if !takes_stdout(args.output.json.as_deref()) {
        print(&match_text::report(&record, &crash, &stamped))?;
    }
    write_files(args, &crash, &stamped, &run, &record)?;
    Ok(match run.assessment.verdict {
        Verdict::Good | Verdict::Check => ExitCode::SUCCESS,
        Verdict::Poor => ExitCode::from(EXIT_POOR),
    })
}

/// Reduces first where another level was asked for one of the parts.
fn run_match(
    asked: &Asked,
    crash: &LoadedPart,
    stamped: &LoadedPart,
    monitor: &Monitor,
) -> anyhow::Result<MatchRun> {
    let reduced = if asked.max_triangles == [asked.recipe.max_triangles; 2] {
        None
    } else {
        Some(ReducedPair::new(
            crash,
            stamped,
            asked.max_triangles,
            monitor,
        )?)
    };
    let (recipe, current) = (&asked.recipe, &asked.current);
    let run = match_parts(crash, stamped, reduced.as_ref(), recipe, current, monitor)?;
    Ok(run)
}

fn load_both(
    [crash, stamped]: [&Path; 2],
    asked: &Asked,
    monitor: &Monitor,
) -> anyhow::Result<(LoadedPart, LoadedPart)> {
    let (crash, stamped) = rayon::join(
        || load(crash, &asked.crash, monitor),
        || load(stamped, &asked.stamped, monitor),
    );
    Ok((crash?, stamped?))
}

fn write_files(
    args: &MatchArgs,
    crash: &LoadedPart,
    stamped: &LoadedPart,
    run: &MatchRun,
    record: &MatchRecord,
) -> anyhow::Result<()> {
    let output = &args.output;
    if let Some(path) = &output.json {
        write_json(path, record)?;
    }
    if let Some(path) = &output.matrix {
        let units = PairUnits::sentences(crash, stamped);
        let text = MatrixForm::Rows.write_with(&run.crash_from_stamped, &units);
        write_output(path, text.as_bytes())?;
    }
    let (pose, silent) = (&run.crash_from_stamped, Monitor::silent());
    let write_part = |path: Option<&PathBuf>, part, other, pose: &Similarity| match path {
        Some(path) => {
            let lines = export::head_lines(part, Some(other));
            export::write_moved(path, part, pose, &lines, &silent)
        }
        None => Ok(()),
    };
    let still = Similarity::identity();
    write_part(output.moved.as_ref(), stamped, crash, pose)?;
    write_part(output.converted.as_ref(), stamped, crash, &still)?;
    write_part(output.crash_mesh.as_ref(), crash, stamped, &still)?;
    if let Some(path) = &output.deviations {
        let table = node_table::node_table(crash, stamped, pose, &silent)?;
        write_output(path, table.as_bytes())?;
    }
    if let Some(path) = &output.report {
        let page = report::report(run, crash, stamped, &silent)?;
        write_output(path, page.as_bytes())?;
    }
    if let Some(path) = &output.cards {
        let cards = pipeline_cards::cards(output.card_form, run, crash, stamped)?;
        write_output(path, cards.text.as_bytes())?;
        let error = cards.largest_node_error(stamped.surface.mesh.positions());
        if !takes_stdout(output.json.as_deref()) && path != Path::new("-") {
            let error = short(error);
            print(&format!(
                "Cards    {}; rounding moves no node by more than {error}\n",
                path.display()
            ))?;
        }
    }
    Ok(())
}
