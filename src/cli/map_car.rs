//! `shapematch map-car`: many stamped parts onto one crash model.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::builder::BoolishValueParser;
use clap::{ArgAction, Args};

use super::args::ReadArgs;
use super::map::MapValues;
use super::map_choices::{HandName, default_thickness};
use super::map_unused::{Beside, warn_of_unused};
use super::of_each::{LengthFactors, StressFactors, named_once, of_file};
use super::{
    UsageError, check_outputs, is_stdout, json_target, print, progress, takes_stdout, write_json,
};
use crate::pipeline::load::{LoadSettings, load, usual_selection};
use crate::pipeline::map::DefaultThickness;
use crate::pipeline::map_car::{
    CAR_COLUMNS, CarRecipe, CarRecord, CarRow, CarState, MASTER, StampedFile, car_files, map_car,
};
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::outputs::{Content, Target};
use crate::role::Role;

/// `shapematch map-car`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct MapCarArgs {
    /// The crash model.
    pub car: PathBuf,
    /// The stamped parts with their forming results. The crash parts that each belongs to are found.
    #[arg(required = true)]
    pub stamped: Vec<PathBuf>,

    /// Folder for the mapped states: a deck for each part, mapped.k that includes them all.
    #[arg(long, short, value_name = "FOLDER")]
    out: PathBuf,
    /// Write pages too: report.html about all parts, and one with pictures about each mapping.
    #[arg(long)]
    report: bool,
    /// The result as JSON, to a file or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    json: Option<PathBuf>,
    /// Whether stamped parts are the crash parts' own hand, the opposite one (left for right), or either.
    #[arg(long, value_enum, default_value = "same")]
    hand: HandName,
    #[command(flatten)]
    lengths: LengthFactors,
    #[command(flatten)]
    stresses: StressFactors,
    #[command(flatten)]
    pub(super) read: ReadArgs,
    /// 16 columns a number instead of 10.
    #[arg(
        long,
        value_name = "YES|NO",
        default_value = "yes",
        action = ArgAction::Set,
        hide_possible_values = true,
        value_parser = BoolishValueParser::new()
    )]
    large: bool,
    /// Thickness of elements without values: section for what the crash deck gives them, a length, or nearest
    /// for that of the nearest element that has one.
    #[arg(
        long,
        value_name = "section|LENGTH|nearest",
        allow_negative_numbers = true,
        default_value = "section",
        value_parser = default_thickness
    )]
    default_thickness: DefaultThickness,

    #[command(flatten)]
    values: MapValues,
}

const HELP: &str = "\
Examples:
  shapematch map-car car.k door.dynain sill.dynain --out mapped
  shapematch map-car car.k *.dynain --out mapped --quantities full --report

Exit status: 0 every stamped part is mapped, 1 failed or one of them is not, 2 wrong usage.";

/// Reads, finds, maps, writes, and prints the table. A folder that was made for this and stays empty goes again.
pub fn run(args: &MapCarArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    let was_there = args.out.exists();
    let done = map_all(args, quiet);
    if !was_there {
        // Fails for any other folder.
        let _ = std::fs::remove_dir(&args.out);
    }
    done
}

fn map_all(args: &MapCarArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    args.lengths.check(args.stamped.len())?;
    let stress_factors = args.stresses.checked(args.stamped.len())?;
    let beside = Beside {
        n_stamped: args.stamped.len(),
        has_stress_factors: args.stresses.is_given(),
        has_stamped_law: false,
        is_written: true,
    };
    warn_of_unused(&args.values, &beside);
    let monitor = progress::monitor(quiet);
    let read = args.read.options();
    let settings = |role, length_factor| LoadSettings {
        selection: usual_selection(role),
        length_factor,
        read: read.clone(),
        ..LoadSettings::default()
    };
    let paths = args.stamped.iter();
    let kept = named_once(paths.map(|path| (path.as_path(), String::new())));
    let stamped: Vec<StampedFile> = kept
        .into_iter()
        .map(|file| StampedFile {
            path: args.stamped[file].clone(),
            settings: settings(Role::Stamped, args.lengths.of(file)),
            stress_factor: of_file(stress_factors, file).copied(),
        })
        .collect();
    let mut inputs = vec![args.car.clone()];
    inputs.extend(args.stamped.iter().cloned());
    if let Some(pattern) = inputs.iter().find(|path| is_pattern(path)) {
        return Err(UsageError(format!("no file matches {pattern:?}")).into());
    }
    make_folder(&args.out)?;
    check_outputs(targets(args, &stamped), &inputs)?;
    let crash = load(&args.car, &settings(Role::Crash, 1.0), &monitor)?;
    inputs.extend(crash.files());
    check_outputs(targets(args, &stamped), &inputs)?;
    let mut recipe = CarRecipe {
        matching: MatchRecipe::default(),
        map: args.values.recipe(),
        is_large: args.large,
        default_thickness: args.default_thickness,
        folder: args.out.clone(),
        has_pages: args.report,
    };
    recipe.matching.settings.hand = args.hand.hand();
    let record = map_car(&crash, &stamped, &recipe, &monitor)?;
    drop(monitor);
    for line in record.rows.iter().filter_map(CarRow::tools_line) {
        log::warn!("{line}");
    }
    let mut is_written = true;
    if let Some(path) = &args.json
        && let Err(error) = write_json(path, &record)
    {
        log::error!("{} is not written: {error:#}", path.display());
        is_written = false;
    }
    if !takes_stdout(args.json.as_deref()) {
        print(&table(&record))?;
    }
    let is_mapped = |row: &CarRow| row.state != CarState::None;
    if !record.rows.iter().any(is_mapped) {
        log::error!(
            "nothing is mapped; no deck is written{}",
            left_behind(&args.out)
        );
    }
    Ok(if is_written && record.rows.iter().all(is_mapped) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// Whether a path is a pattern that the shell found no file for.
fn is_pattern(path: &Path) -> bool {
    path.to_string_lossy().contains(['*', '?']) && !path.exists()
}

/// Says that the decks in a folder are not of this run, if there are any.
fn left_behind(folder: &Path) -> String {
    if folder.join(MASTER).exists() {
        format!("; {MASTER} in {} is of an earlier run", folder.display())
    } else {
        String::new()
    }
}

/// Makes the folder if the one above it is there.
fn make_folder(folder: &Path) -> anyhow::Result<()> {
    if is_stdout(folder) {
        return Err(UsageError("--out takes a folder, and - is none".to_owned()).into());
    }
    if folder.is_dir() {
        return Ok(());
    }
    if folder.exists() {
        return Err(UsageError(format!("--out {folder:?} is a file, not a folder")).into());
    }
    std::fs::create_dir(folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))
}

/// Everything that will be written, for the check before the work.
fn targets(args: &MapCarArgs, stamped: &[StampedFile]) -> Vec<Target> {
    let files = car_files(stamped, &args.out, args.report);
    let of_folder = files.into_iter().map(|path| Target {
        name: "--out".to_owned(),
        content: if path.extension().is_some_and(|e| e == "k") {
            Content::Deck
        } else {
            Content::Text
        },
        path,
    });
    of_folder.chain(json_target(args.json.as_deref())).collect()
}

/// One line for each stamped part, its reasons beneath.
fn table(record: &CarRecord) -> String {
    let mut rows = vec![CAR_COLUMNS.map(str::to_owned)];
    rows.extend(record.rows.iter().map(CarRow::cells));
    let all = || rows.iter();
    let width = |column: usize| all().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..7).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    let reasons = record.rows.iter().map(|row| &row.reasons[..]);
    for (row, reasons) in rows.iter().zip(std::iter::once(&[][..]).chain(reasons)) {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        text.push_str(cells.join("  ").trim_end());
        text.push('\n');
        for reason in reasons {
            text.push_str(&format!("    {}\n", reason.text()));
        }
    }
    for copy in &record.copies {
        text.push_str(&format!("{}\n", copy.text()));
    }
    text
}
