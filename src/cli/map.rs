//! `shapematch map`: forming results onto the crash part.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::builder::BoolishValueParser;
use clap::{ArgAction, Args};

use super::args::ReadArgs;
use super::map_choices::{
    HandName, KindName, MirrorName, RuleName, default_thickness, law, quantities,
};
use super::map_files::{check_order, kept_files, warn_of_unread};
use super::map_text::summary;
use super::map_unused::{Beside, warn_of_unused};
use super::numbers::{layers, percent, points_in_plane};
use super::of_each::{LengthFactors, StressFactors, of_file, of_kept, one_or_each};
use super::placing::{Placed, place};
use super::recipe::selection;
use super::setting_args::MapSettingArgs;
use super::{
    UsageError, check_outputs, is_stdout, json_target, print, progress, warn_of_tools, write_json,
    write_output,
};
use crate::assess::Verdict;
use crate::mapping::{MapOptions, Quantities, RuleKind};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::load::{LoadSettings, LoadedPart, load};
use crate::pipeline::map::{
    DefaultThickness, MapFile, MapFiles, MapOutput, MapRecipe, MapRecord, MapRun, OtherResult,
    PlacedPart, PoseOrigin, check_shells, deck_comments, element_table, elements_path, map_parts,
    map_record, map_report, unmapped_sets, write_mapping,
};
use crate::pipeline::outputs::{Content, Target};
use crate::pipeline::write_file::write_files_unless_cancelled;
use crate::registration::Hand;
use crate::role::Role;
use crate::text::{compared_percents, counted};

/// Exit status where a gate such as `--require` is not met; the files are written all the same.
const EXIT_GATE: u8 = 1;

/// `shapematch map`.
#[derive(Debug, Args)]
#[command(after_help = HELP)]
pub struct MapArgs {
    /// The crash part or the whole crash model.
    pub crash: PathBuf,
    /// The stamped parts with their forming results, for example a dynain; several may lie on one crash
    /// part.
    pub stamped: Vec<PathBuf>,

    #[command(flatten)]
    choice: MapChoice,
    #[command(flatten)]
    values: MapValues,
    #[command(flatten)]
    output: MapOutputArgs,
}

/// Which elements, and where they lie.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is mapped")]
pub(super) struct MapChoice {
    /// Part of the crash model: an id, several ids (2001,2002), a title (also title:NAME), set:ID,
    /// shell-set:ID, node-set:ID, all, or sheet (without tools).
    /// Where the parts are matched first, it is found if not given.
    #[arg(long, value_name = "PART")]
    pub(super) crash_part: Option<String>,
    /// Part of the stamped files, written as for --crash-part, or all, or sheet. Give one for all files or
    /// one for each. Without it, the sheet: parts that are rigid, that have no forming results where others
    /// have them, or whose thickness is even where that of others varies, are tools and left out.
    #[arg(long, value_name = "PART")]
    pub(super) stamped_part: Vec<String>,
    #[command(flatten)]
    pub(super) lengths: LengthFactors,
    #[command(flatten)]
    pub(super) stresses: StressFactors,
    /// Material law of the stamped parts (24 or PIECEWISE_LINEAR_PLASTICITY), for files that hold none.
    /// History variables go to parts of the same law alone.
    #[arg(long, value_name = "LAW", value_parser = law)]
    stamped_material: Option<String>,
    #[command(flatten)]
    read: ReadArgs,
    /// Pose of a stamped part (crash from stamped): a text file, or the numbers themselves, 16 by rows.
    /// Give one for each stamped file. Without it the parts are matched first.
    #[arg(long, value_name = "FILE|NUMBERS", allow_hyphen_values = true)]
    pub(super) pose: Vec<String>,
    /// Take the poses from a .shapematch project, in the order of its stamped files.
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    pub(super) project: Option<PathBuf>,
    /// Take both parts where they are, without a match.
    #[arg(long, conflicts_with_all = ["pose", "project"])]
    pub(super) identity: bool,
    /// Where the parts are matched first: whether the stamped part is the crash part's own hand, the
    /// opposite one (left for right), or either. Tensors are mirrored with it.
    #[arg(long, value_enum, default_value = "same", conflicts_with_all = ["pose", "project", "identity"])]
    hand: HandName,
    /// Mirror the stamped part at the given pose in a coordinate plane of the crash model: the part of one
    /// side of the car for the other side. Where the parts are matched first, free finds the
    /// plane, as --hand opposite does. Tensors are mirrored with it.
    #[arg(long, value_enum, default_value = "none")]
    mirror: MirrorName,
}

/// Quantities and how they are transferred.
#[derive(Debug, Args)]
#[command(next_help_heading = "Values")]
pub(super) struct MapValues {
    /// Quantities, separated by commas: thickness, plastic, strain, stress, history; or usual (thickness,
    /// plastic), or full, for everything. Between two layers, stresses, strains and plastic strain are
    /// interpolated; history variables, some of which are flags, are those of the nearest layer.
    #[arg(long, value_name = "LIST", default_value = "usual", value_parser = quantities)]
    pub(super) quantities: Quantities,
    /// Layers of the crash elements, at most 100; from the section if not given.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = layers)]
    pub(super) layers: Option<usize>,
    /// Integration rule through the thickness of the crash elements; from the deck if not given. As in the solver,
    /// more than ten layers are equally spaced whatever the rule, and two Lobatto layers are Gauss points.
    #[arg(long, value_enum)]
    pub(super) rule: Option<RuleName>,
    /// Points in the plane of each layer; from the element formulation if not given.
    #[arg(long, value_name = "1|4", allow_negative_numbers = true, value_parser = points_in_plane)]
    pub(super) n_plane: Option<u8>,
    #[command(flatten)]
    pub(super) options: MapSettingArgs,
}

/// What is written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
struct MapOutputArgs {
    /// The mapped state as a deck.
    #[arg(long, short, value_name = "FILE|-")]
    out: Option<PathBuf>,
    /// include: states, and the elements with their thickness in a second file; part: all elements of
    /// the part and the states in one file; deck: a copy of the crash file with thickness and states
    /// put in.
    #[arg(long, value_enum, requires = "out", default_value = "include")]
    write: KindName,
    /// 16 columns a number instead of 10.
    #[arg(
        long,
        value_name = "YES|NO",
        requires = "out",
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
        requires = "out",
        allow_negative_numbers = true,
        default_value = "section",
        value_parser = default_thickness
    )]
    default_thickness: DefaultThickness,
    /// Smallest share of the area that must be mapped, with thickness and stress card where these were
    /// asked for, percent; below it the exit status is 1.
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = percent)]
    require: Option<f64>,
    /// Write no deck where less is mapped than --require asks for.
    #[arg(long, requires = "require")]
    strict: bool,
    /// Status, distances and values of every crash element as CSV.
    #[arg(long, value_name = "FILE|-")]
    csv: Option<PathBuf>,
    /// The elements that are not wholly mapped, one *SET_SHELL_LIST for each status; its title says whether they
    /// carry values.
    #[arg(long, value_name = "FILE|-")]
    unmapped: Option<PathBuf>,
    /// The result of another mapper, or the solver's own file of mapped states (INCOUT): differences
    /// element by element. May be given several times, for thickness and states in two files.
    #[arg(long, value_name = "FILE")]
    compare: Vec<PathBuf>,
    /// The mapping as one HTML file with pictures before and after.
    #[arg(long, value_name = "FILE|-")]
    report: Option<PathBuf>,
    /// The result as JSON, to a file or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    json: Option<PathBuf>,
}

const HELP: &str = "\
Examples:
  shapematch map crash.k stamped.dynain --out mapped.k
  shapematch map car.k stamped.dynain --crash-part 2000012 --out mapped.k --quantities full
  shapematch map crash.k left.dynain right.dynain --write deck --out crash_mapped.k
  shapematch map crash_mapped.k new.dynain --write deck --out crash_2.k --replace-states yes
  shapematch map crash.k stamped.dynain --identity --csv elements.csv --require 95
  shapematch map crash.k stamped.dynain --project work.shapematch --report map.html
  shapematch map crash.k stamped.dynain --compare dyna.inc --json differences.json

Exit status: 0 mapped, 1 failed or less mapped than --require asks for, 2 wrong usage, 3 mapped with a \
pose that the match calls poor.";

impl MapArgs {
    pub(super) fn read(&self) -> &ReadArgs {
        &self.choice.read
    }

    /// The options about values, and what their effect depends on.
    pub(super) fn values_beside(&self) -> (&MapValues, Beside) {
        let beside = Beside {
            n_stamped: self.stamped.len(),
            has_stress_factors: self.choice.stresses.is_given(),
            has_stamped_law: self.choice.stamped_material.is_some(),
            is_written: self.output.out.is_some(),
        };
        (&self.values, beside)
    }
}

impl MapChoice {
    pub(super) fn hand(&self) -> Hand {
        if self.mirror == MirrorName::Free {
            return Hand::Mirrored;
        }
        self.hand.hand()
    }
}

impl MapValues {
    /// The recipe with these values, without a factor on stresses and a stamped law.
    pub(super) fn recipe(&self) -> MapRecipe {
        MapRecipe {
            options: MapOptions {
                quantities: self.quantities,
                ..self.options.options()
            },
            n_layers: self.layers,
            rule: self.rule.map(|rule| match rule {
                RuleName::Gauss => RuleKind::Gauss,
                RuleName::Lobatto => RuleKind::Lobatto,
                RuleName::Equal => RuleKind::Equal,
            }),
            n_plane: self.n_plane,
            ..MapRecipe::default()
        }
    }
}

/// Reads, matches where no pose is given, maps, writes, and prints the summary.
pub fn run(args: &MapArgs, quiet: bool) -> anyhow::Result<ExitCode> {
    check_usage(args)?;
    let (values, beside) = args.values_beside();
    warn_of_unused(values, &beside);
    let monitor = progress::monitor(quiet);
    let mut inputs = vec![args.crash.clone()];
    let others = args.stamped.iter().chain(&args.output.compare);
    inputs.extend(others.chain(&args.choice.project).cloned());
    inputs.extend(args.choice.pose.iter().map(PathBuf::from));
    check_outputs(targets(&args.output), &inputs)?;
    let kept = kept_files(&args.choice, &args.stamped);
    let (crash, stamped) = load_all(args, &kept, &monitor)?;
    let whole = crash.clone();
    inputs.extend(crash.files());
    inputs.extend(stamped.iter().flat_map(LoadedPart::files));
    check_outputs(targets(&args.output), &inputs)?;
    check_order(&crash, &stamped)?;
    check_shells(&crash, stamped.iter())?;
    // Where the work ends in an error, what the reader found may be the reason.
    let tell = |_: &anyhow::Error| warn_of_unread(std::iter::once(&whole).chain(&stamped));
    let poses = of_kept(&args.choice.pose, &kept);
    let placed = place(&args.choice, &poses, (crash, &stamped), &monitor).inspect_err(tell)?;
    let Placed { crash, mut poses } = placed;
    if let Some(mirror) = args.choice.mirror.motion() {
        for (pose, _) in &mut poses {
            *pose = mirror.after(pose);
        }
    }
    let placed: Vec<PlacedPart<'_>> = stamped
        .iter()
        .zip(poses)
        .map(|(part, (crash_from_stamped, origin))| PlacedPart {
            part,
            crash_from_stamped,
            origin,
        })
        .collect();
    let recipe = MapRecipe {
        stress_factors: of_kept(args.choice.stresses.checked(args.stamped.len())?, &kept),
        stamped_law: args.choice.stamped_material.clone(),
        least_area: args.output.require.map(|percent| percent / 100.0),
        ..args.values.recipe()
    };
    let run = map_parts(&crash, &placed, &recipe, &monitor);
    let run = run.map_err(anyhow::Error::from).inspect_err(tell)?;
    let output = args.output.out.as_ref().map(|path| MapOutput {
        kind: args.output.write.kind(),
        path: path.clone(),
        is_large: args.output.large,
        default_thickness: args.output.default_thickness,
        has_copies: true,
    });
    let comments = deck_comments(&crash, &placed);
    let write = |output: &MapOutput| write_mapping(&run, &crash, output, &comments, &monitor);
    // A deck without anything mapped would pass for a result.
    let output = output.filter(|_| !run.is_empty());
    let files = output.as_ref().map(write).transpose()?;
    if let Some(files) = &files {
        check_outputs(all_targets(&args.output, files), &inputs)?;
    }
    let compare = &args.output.compare;
    let other = (!compare.is_empty())
        .then(|| OtherResult::read(compare, &run, &crash, &monitor))
        .transpose()?;
    let record = map_record(
        &run,
        &crash,
        &placed,
        files.as_ref(),
        other.as_ref(),
        &monitor,
    )?;
    let is_withheld = args.output.strict && is_short(&args.output, &record);
    let files = files.filter(|_| !is_withheld);
    let outputs = &args.output;
    let about = (&run, &record, &placed[..], other.as_ref());
    let tables = tables(outputs, &crash, about, &monitor)?;
    drop(monitor);
    finish(outputs, &record, files.as_ref(), &tables)
}

/// Tables and pages about a mapping, with where they go.
fn tables(
    outputs: &MapOutputArgs,
    crash: &LoadedPart,
    (run, record, placed, other): (&MapRun, &MapRecord, &[PlacedPart<'_>], Option<&OtherResult>),
    monitor: &Monitor,
) -> anyhow::Result<Vec<(PathBuf, Vec<u8>)>> {
    let mut tables = Vec::new();
    if let Some(path) = &outputs.csv {
        let table = element_table(run, crash, placed, other, monitor)?;
        tables.push((path.clone(), table.into_bytes()));
    }
    if let Some(path) = &outputs.unmapped {
        let sets = unmapped_sets(run, &crash.model, monitor)?;
        tables.push((path.clone(), sets.into_bytes()));
    }
    if let Some(path) = &outputs.report {
        let page = map_report(run, record, crash, other, monitor)?;
        tables.push((path.clone(), page.into_bytes()));
    }
    Ok(tables)
}

/// True if less of the area carries what was asked for than was required.
fn is_short(outputs: &MapOutputArgs, record: &MapRecord) -> bool {
    outputs
        .require
        .is_some_and(|required| record.full_area() < required / 100.0)
}

/// Files of a mapping, which belong together.
fn write_together(files: &[MapFile]) -> anyhow::Result<()> {
    if let [file] = files {
        return write_output(&file.path, &file.bytes);
    }
    let files: Vec<(&Path, &[u8])> = (files.iter())
        .map(|file| (&*file.path, &*file.bytes))
        .collect();
    Ok(write_files_unless_cancelled(&files, &Monitor::silent())?)
}

/// Writes the files, prints the summary, and says how it went.
fn finish(
    outputs: &MapOutputArgs,
    record: &MapRecord,
    files: Option<&MapFiles>,
    tables: &[(PathBuf, Vec<u8>)],
) -> anyhow::Result<ExitCode> {
    let mut failed: Vec<PathBuf> = Vec::new();
    if let Some(files) = files.map(|files| &files.files)
        && let Err(error) = write_together(files)
    {
        log::error!("{} is not written: {error:#}", files[0].path.display());
        failed.extend(files.iter().map(|file| file.path.clone()));
    }
    let mut note = |path: &Path, written: anyhow::Result<()>| {
        if let Err(error) = written {
            log::error!("{} is not written: {error:#}", path.display());
            failed.push(path.to_path_buf());
        }
    };
    for (path, bytes) in tables {
        note(path, write_output(path, bytes));
    }
    if let Some(path) = &outputs.json {
        note(path, write_json(path, record));
    }
    let printed = [&outputs.json, &outputs.out]
        .into_iter()
        .flatten()
        .chain(texts(outputs).map(|(_, path)| path));
    if !printed.into_iter().any(|path| is_stdout(path)) {
        print(&summary(record, files, &failed))?;
    }
    for warning in &record.warnings {
        log::warn!("{warning}");
    }
    if let Some(required) = outputs.require.filter(|_| is_short(outputs, record)) {
        let withheld = if outputs.strict {
            "; no deck is written"
        } else {
            ""
        };
        let [mapped, _] = compared_percents([record.full_area(), required / 100.0]);
        let what = if record.bare_area > 0.0 {
            "has all that was asked for"
        } else {
            "is mapped"
        };
        log::error!("{mapped} of the area {what}, {required} % are required{withheld}");
        return Ok(ExitCode::from(EXIT_GATE));
    }
    if record.mapped_area <= 0.0 {
        let withheld = if outputs.out.is_some() {
            "; no deck is written"
        } else {
            ""
        };
        let error = PipelineError::NothingMapped;
        log::error!("{error}{withheld}");
        return Ok(ExitCode::FAILURE);
    }
    if !failed.is_empty() {
        return Ok(ExitCode::FAILURE);
    }
    let poor = PoseOrigin::Match {
        verdict: Verdict::Poor,
    };
    let is_poor = record.stamped.iter().any(|stamped| stamped.pose == poor);
    Ok(if is_poor {
        ExitCode::from(super::EXIT_POOR)
    } else {
        ExitCode::SUCCESS
    })
}

/// Refuses options that do not go together.
fn check_usage(args: &MapArgs) -> anyhow::Result<()> {
    let refuse = |text: String| Err(UsageError(text).into());
    let (n_poses, n_files) = (args.choice.pose.len(), args.stamped.len());
    if n_files == 0 {
        return refuse("name the stamped part too: shapematch map CRASH STAMPED".to_owned());
    }
    if n_poses > 0 && n_poses != n_files {
        return refuse(format!(
            "{} for {}; give one for each",
            counted(n_poses, "pose"),
            counted(n_files, "stamped file")
        ));
    }
    let output = &args.output;
    let options = args.values.recipe().options;
    let is_one_include = !options.quantities.need_two_files();
    let is_one_file =
        (output.write != KindName::Include || is_one_include) && !options.replace_states;
    if !is_one_file && output.out.as_deref().is_some_and(is_stdout) {
        let what = "--out - has room for one file";
        return refuse(format!(
            "{what}; write it with --write part or deck and without --replace-states, or name a file"
        ));
    }
    let is_device = |path: &&PathBuf| path.exists() && !path.is_file() && !path.is_dir();
    if let Some(device) = output.out.as_ref().filter(is_device)
        && !is_one_file
    {
        return refuse(format!(
            "--out {} is no file and has room for one alone; write it with --write part or deck and without \
             --replace-states, or name a file",
            device.display()
        ));
    }
    let n_parts = args.choice.stamped_part.len();
    one_or_each(n_parts, "stamped part", n_files)?;
    args.choice.lengths.check(n_files)?;
    args.choice.stresses.checked(n_files)?;
    let has_pose = args.choice.identity || args.choice.project.is_some() || n_poses > 0;
    if args.choice.mirror == MirrorName::Free && has_pose {
        return refuse(
            "--mirror free is found by a match; a given pose is mirrored at yz, zx or xy"
                .to_owned(),
        );
    }
    if args.choice.mirror == MirrorName::Free && args.choice.hand == HandName::Either {
        return refuse("--mirror free takes the opposite hand; omit --hand either".to_owned());
    }
    if args.choice.mirror.motion().is_some() && !has_pose {
        let what = "--mirror mirrors a given pose (--pose, --project, --identity)";
        return refuse(format!(
            "{what}; where the parts are matched first, --hand opposite or --mirror free finds it"
        ));
    }
    Ok(())
}

/// Everything that will be written, for the check before the work.
fn targets(output: &MapOutputArgs) -> Vec<Target> {
    let target = |name: &str, path: &Path, content| Target {
        name: name.to_owned(),
        path: path.to_path_buf(),
        content,
    };
    let mut targets: Vec<Target> = json_target(output.json.as_deref()).into_iter().collect();
    if let Some(path) = &output.out {
        targets.push(target("--out", path, Content::Deck));
        if output.write == KindName::Include {
            targets.push(target(
                "--out (elements)",
                &elements_path(path),
                Content::Deck,
            ));
        }
    }
    targets.extend(texts(output).map(|(name, path)| target(name, path, Content::Text)));
    targets
}

/// Tables and pages beside the decks and the record, by their options.
fn texts(output: &MapOutputArgs) -> impl Iterator<Item = (&'static str, &PathBuf)> {
    let all = [
        ("--csv", &output.csv),
        ("--unmapped", &output.unmapped),
        ("--report", &output.report),
    ];
    all.into_iter()
        .filter_map(|(name, path)| Some((name, path.as_ref()?)))
}

/// The same with the copies of crash files, which are known late.
fn all_targets(output: &MapOutputArgs, files: &MapFiles) -> Vec<Target> {
    let mut targets = targets(output);
    let copies = files.files.iter().filter(|file| file.replaces.is_some());
    let copies = copies.filter(|file| Some(&file.path) != output.out.as_ref());
    targets.extend(copies.map(|file| Target {
        name: "--out (copy without old states)".to_owned(),
        path: file.path.clone(),
        content: Content::Deck,
    }));
    targets
}

/// The crash part and the `kept` stamped files.
fn load_all(
    args: &MapArgs,
    kept: &[usize],
    monitor: &Monitor,
) -> anyhow::Result<(LoadedPart, Vec<LoadedPart>)> {
    let choice = &args.choice;
    let settings = |role, part: Option<&str>, length_factor: f64| LoadSettings {
        selection: selection(role, part),
        length_factor,
        read: choice.read.options(),
        ..LoadSettings::default()
    };
    let crash = load(
        &args.crash,
        &settings(Role::Crash, choice.crash_part.as_deref(), 1.0),
        monitor,
    )?;
    let part_of = |file: usize| {
        let part = of_file(&choice.stamped_part, file);
        part.map(String::as_str)
    };
    let stamped = kept.iter().map(|&file| {
        let factor = choice.lengths.of(file);
        load(
            &args.stamped[file],
            &settings(Role::Stamped, part_of(file), factor),
            monitor,
        )
    });
    let stamped: Vec<LoadedPart> = stamped.collect::<Result<_, _>>()?;
    for part in &stamped {
        warn_of_tools(part);
    }
    Ok((crash, stamped))
}
