//! `shapematch match`: two files in, a pose out.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::bail;

use super::args::{MatchArgs, OutputArgs};
use super::placing::warn_of_unit;
use super::recipe::{Asked, asked};
use super::{
    EXIT_POOR, EXIT_USAGE, UsageError, check_outputs, is_stdout, match_text, print, print_exactly,
    progress, project, warn_of_order, warn_of_tools,
};
use crate::assess::Verdict;
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::find_parts::{FoundParts, find_parts, is_part_open};
use crate::pipeline::load::{LoadedPart, load};
use crate::pipeline::match_parts::{MatchRun, ReducedPair, match_parts, with_alternative};
use crate::pipeline::outputs::cards::included_name;
use crate::pipeline::outputs::record::match_record;
use crate::pipeline::outputs::{MeshOutput, Output, OutputInput, Target};
use crate::pipeline::project::{EXTENSION, is_project};
use crate::registration::MatchMonitor;
use crate::report::MatrixForm;
use crate::report::cards::check_file_name;
use crate::role::PerRole;
use crate::text::counted;

/// Matches and writes what was asked for.
pub fn run(args: &MatchArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let shown = progress::shown(quiet);
    let monitor = &shown.monitor;
    let outputs = outputs(&args.output);
    check_outputs(targets(&outputs), &named_inputs(args))?;
    check_included_name(&outputs, args.stamped.as_deref())?;
    let (mut asked, mut parts, is_part_chosen) = match &args.stamped {
        Some(path) => {
            let asked = asked(args)?;
            asked.recipe.settings.check().map_err(PipelineError::from)?;
            let parts = load_both(PerRole::new(&args.crash, path), &asked, monitor)?;
            (asked, parts, args.input.crash_part.is_some())
        }
        None if is_project(&args.crash) => project::open(args, monitor)?,
        None => {
            log::error!(
                "the stamped part is missing; give two files, or one project (.{EXTENSION}): {}",
                args.crash.display()
            );
            return Ok(ExitCode::from(EXIT_USAGE));
        }
    };
    let found = if is_part_chosen {
        None
    } else {
        choose_part(&mut parts, &asked, monitor)?
    };
    if let Some(number) = args.output.pose_number {
        asked.pose_number = number;
    }
    let parts = parts.map(Arc::new);
    let input = OutputInput {
        parts: parts.clone().map(Some),
        ..OutputInput::default()
    };
    // Only now are the included files known.
    check_outputs(targets(&outputs), &input.files())?;
    let impossible = impossible(&outputs, parts.as_deref());
    let run = run_match(&asked, parts.as_deref(), found, shown.of_match())?;
    let run = Arc::new(run);
    let record = match_record(&run, parts.as_deref());
    drop(shown);
    let is_printing = !outputs.iter().any(|(_, path)| is_stdout(path));
    if !is_printing {
        for warning in &record.warnings {
            log::warn!("{warning}");
        }
    } else {
        print(&match_text::report(&record, &run.outcome, parts.as_deref()))?;
    }
    let input = OutputInput {
        crash_from_stamped: run.crash_from_stamped,
        run: Some(Arc::clone(&run)),
        ..input
    };
    let mut is_complete = impossible.is_empty();
    for (output, path) in outputs {
        if impossible.contains(&output) {
            continue;
        }
        if let Err(error) = write(output, path, &input, is_printing) {
            log::error!("{} is not written: {error:#}", option(output));
            is_complete = false;
        }
    }
    Ok(match run.assessment.verdict {
        _ if !is_complete => ExitCode::FAILURE,
        Verdict::Good | Verdict::Check => ExitCode::SUCCESS,
        Verdict::Poor => ExitCode::from(EXIT_POOR),
    })
}

/// What is to be written, in this order.
fn outputs(args: &OutputArgs) -> Vec<(Output, &Path)> {
    let all = [
        (Output::Record, &args.json),
        (Output::Matrix(MatrixForm::Rows), &args.matrix),
        (Output::Mesh(MeshOutput::Moved), &args.moved),
        (Output::Mesh(MeshOutput::Converted), &args.converted),
        (Output::Mesh(MeshOutput::Crash), &args.crash_mesh),
        (Output::Deviations, &args.deviations),
        (Output::Report, &args.report),
        (Output::Cards(args.card_form), &args.cards),
    ];
    let given = all.into_iter();
    given
        .filter_map(|(output, path)| Some((output, path.as_deref()?)))
        .collect()
}

fn option(output: Output) -> &'static str {
    output.option().unwrap_or(output.label())
}

fn targets(outputs: &[(Output, &Path)]) -> Vec<Target> {
    let target = |&(output, path): &(Output, &Path)| Target {
        name: option(output).to_owned(),
        path: path.to_path_buf(),
        content: output.content(),
    };
    outputs.iter().map(target).collect()
}

/// The files that the command line names to be read.
fn named_inputs(args: &MatchArgs) -> Vec<PathBuf> {
    let poses = args.settings.start_poses.iter().map(PathBuf::from);
    let parts = std::iter::once(&args.crash).chain(&args.stamped).cloned();
    parts.chain(poses).collect()
}

/// Refuses cards for a stamped file whose name no deck can include.
fn check_included_name(outputs: &[(Output, &Path)], stamped: Option<&Path>) -> anyhow::Result<()> {
    let is_cards = |(output, _): &(Output, &Path)| matches!(output, Output::Cards(_));
    let name = stamped
        .and_then(Path::file_name)
        .map(|name| name.to_string_lossy());
    match name {
        Some(name) if outputs.iter().any(is_cards) => {
            let checked = check_file_name(included_name(&name));
            checked.map_err(|error| UsageError(format!("--cards: {error}")).into())
        }
        _ => Ok(()),
    }
}

/// Outputs that cannot hold what these parts need, said before the match and left out.
fn impossible(outputs: &[(Output, &Path)], parts: PerRole<&LoadedPart>) -> Vec<Output> {
    let checked = outputs
        .iter()
        .map(|(output, _)| (*output, output.check(parts)));
    let failed = checked.filter_map(|(output, check)| Some((output, check.err()?)));
    failed
        .map(|(output, error)| {
            log::error!("{} cannot be written: {error}", option(output));
            output
        })
        .collect()
}

/// Writes one output and says what was found out about cards.
fn write(
    output: Output,
    path: &Path,
    input: &OutputInput,
    is_printing: bool,
) -> anyhow::Result<()> {
    let silent = Monitor::silent();
    let notes = if is_stdout(path) {
        // As if it stood in the folder where it is asked for.
        let made = output.make_in(input, None, Some(Path::new(".")), &silent)?;
        print_exactly(&made.bytes)?;
        made.notes
    } else {
        output.write(input, path, &silent)?
    };
    for note in notes {
        match output {
            Output::Cards(_) if is_printing => {
                print(&format!("Cards    {}; {note}\n", path.display()))?;
            }
            Output::Cards(_) | Output::Mesh(_) => log::warn!("{}: {note}", path.display()),
            _ => {}
        }
    }
    Ok(())
}

/// Reduces first where another level was asked for one of the parts. A match that found the crash part is not made
/// again.
fn run_match(
    asked: &Asked,
    parts: PerRole<&LoadedPart>,
    found: Option<FoundParts>,
    monitor: MatchMonitor<'_>,
) -> anyhow::Result<MatchRun> {
    let is_as_found = asked.max_triangles == PerRole::both(asked.recipe.max_triangles);
    let reduced = if is_as_found {
        None
    } else {
        let max_triangles = asked.max_triangles;
        Some(ReducedPair::new(parts, max_triangles, monitor.monitor)?)
    };
    let run = match found {
        Some(of_parts) if is_as_found => of_parts.run(),
        _ => {
            let (recipe, current) = (&asked.recipe, &asked.current);
            let run = match_parts(parts, reduced.as_ref(), recipe, current, monitor)?;
            let mut run = run.beside_alike_parts(&parts.crash.settings.alike_parts);
            if let Some(of_parts) = found {
                run.times.find_ms = of_parts.took_ms;
                run.times.total_ms += of_parts.took_ms;
            }
            run
        }
    };
    let (number, n_poses) = (asked.pose_number, 1 + run.outcome.alternatives.len());
    match number {
        1 => Ok(run),
        _ if number > n_poses => bail!(
            "--pose-number {number}: the match found {}",
            counted(n_poses, "pose")
        ),
        _ => Ok(with_alternative(&run, number - 2, parts, monitor.monitor)?),
    }
}

/// Takes of a whole crash model the parts that the stamped part belongs to; all are matched together where none is
/// found.
fn choose_part(
    parts: &mut PerRole<LoadedPart>,
    asked: &Asked,
    monitor: &Monitor,
) -> anyhow::Result<Option<FoundParts>> {
    let both = parts.as_ref();
    if !is_part_open(both) {
        if both.crash.chosen_part_ids().len() > 1 {
            warn_of_unit(both, monitor)?;
        }
        return Ok(None);
    }
    let found = find_parts(both, &asked.recipe, &asked.current, monitor)?;
    match &found {
        Some(found) => parts.crash = found.found.part.clone(),
        None => log::warn!(
            "{} fits no part of the crash model alone, so all are matched together; --crash-part names the right one",
            both.stamped.path.display()
        ),
    }
    Ok(found)
}

fn load_both(
    paths: PerRole<&PathBuf>,
    asked: &Asked,
    monitor: &Monitor,
) -> anyhow::Result<PerRole<LoadedPart>> {
    let (crash, stamped) = rayon::join(
        || load(paths.crash, &asked.crash, monitor),
        || load(paths.stamped, &asked.stamped, monitor),
    );
    let parts = PerRole::new(crash?, stamped?);
    warn_of_tools(&parts.stamped);
    let PerRole { crash, stamped } = parts.as_ref();
    warn_of_order(crash, stamped);
    Ok(parts)
}
