//! What can be typed: subcommands, options, and their help. The options of the match settings come from
//! the table of settings.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::UsageError;
use super::map::MapArgs;
use super::map_car::MapCarArgs;
use super::numbers::{at_least_one, count, positive};
use super::setting_args::SettingArgs;
use super::words::{card_forms, units};
use crate::formats::ReadOptions;
use crate::report::CardForm;
use crate::units::Units;

/// Finds the pose that aligns a stamped part with the same part of a crash model.
///
/// The result is the matrix of crash = c · R · stamped + t (column vectors), with a verdict, and the
/// LS-DYNA cards that use it. Without a subcommand the window opens.
#[derive(Debug, Parser)]
#[command(name = "shapematch", version, max_term_width = 100)]
pub struct Cli {
    /// What to do; without a subcommand the window opens.
    #[command(subcommand)]
    pub command: Option<Task>,

    /// Files to open in the window: the crash part, then the stamped part; or a project.
    #[arg(value_name = "FILE", num_args = 0..=2)]
    pub files: Vec<PathBuf>,

    /// Open the window with the bundled pair of parts.
    #[arg(long, conflicts_with = "files")]
    pub example: bool,

    /// Open the window with a pair that differs as real pairs do: springback, trim, skin, noise.
    #[arg(long, conflicts_with_all = ["files", "example"])]
    pub realistic: bool,

    /// Number of threads, at most 1024; 0 uses one per core, and never more than four per core are used.
    #[arg(
        long,
        global = true,
        value_name = "N",
        allow_negative_numbers = true,
        default_value_t = 0,
        value_parser = count(0..=1024)
    )]
    pub threads: usize,

    /// Print no progress and no warnings; results and errors are still printed.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// More of them only wait for each other.
const MOST_THREADS_PER_CORE: usize = 4;

impl Cli {
    /// The threads to be used on a machine with so many cores; 0 for one per core.
    pub fn n_threads(&self, n_cores: usize) -> usize {
        self.threads.min(MOST_THREADS_PER_CORE * n_cores.max(1))
    }
}

/// The subcommands of `shapematch`.
#[derive(Debug, Subcommand)]
pub enum Task {
    /// Match a stamped part to a crash part and print the matrix.
    Match(Box<MatchArgs>),
    /// Carry thickness, plastic strain, strain and stress of stamped parts onto a crash part.
    Map(Box<MapArgs>),
    /// Carry the results of many stamped parts onto a crash model, each onto the part it belongs to.
    MapCar(Box<MapCarArgs>),
    /// Reduce a mesh to a maximum number of triangles.
    Reduce(ReduceArgs),
    /// Show the contents of a file.
    Info(InfoArgs),
    /// Write a generated pair of parts with a known pose.
    Sample(SampleArgs),
    /// Measure reduction and matching as in the tables of the paper; or robustness, growth or mapping.
    Bench(BenchArgs),
}

impl Task {
    /// How it reads files, if it reads parts.
    pub(super) fn read(&self) -> Option<&ReadArgs> {
        match self {
            Self::Match(args) => Some(&args.input.read),
            Self::Map(args) => Some(args.read()),
            Self::MapCar(args) => Some(&args.read),
            Self::Reduce(args) => Some(&args.read),
            Self::Info(args) => Some(&args.read),
            Self::Sample(_) | Self::Bench(_) => None,
        }
    }
}

/// `shapematch match`.
#[derive(Debug, Args)]
#[command(after_help = MATCH_HELP)]
pub struct MatchArgs {
    /// The crash part or the whole crash model (fixed), or a project (.shapematch). A project is matched
    /// with the settings stored in it, or those given here in their place; its files, parts, units and method stay.
    pub crash: PathBuf,
    /// The stamped part, for example a dynain (moves).
    pub stamped: Option<PathBuf>,

    #[command(flatten)]
    pub input: InputArgs,
    #[command(flatten)]
    pub settings: SettingArgs,
    #[command(flatten)]
    pub shorthands: ShorthandArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Which elements of the files are matched, in which unit and on which meshes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub struct InputArgs {
    /// Part of the crash model: an id, several ids (2001,2002), a title (also title:NAME), set:ID,
    /// shell-set:ID, node-set:ID, all, or sheet (without tools).
    /// Without it, the part of a whole model that fits is found.
    #[arg(long, value_name = "PART")]
    pub crash_part: Option<String>,
    /// Part of the stamped file, as for --crash-part, or sheet. Without it, the sheet: parts that are rigid, that
    /// have no forming results where others have them, or whose thickness is even where that of others varies, are
    /// tools and left out.
    #[arg(long, value_name = "PART")]
    pub stamped_part: Option<String>,
    /// Units of the crash file, stated in the results; guessed if not given. They change no number.
    #[arg(long, value_name = "UNITS", value_parser = units())]
    pub crash_units: Option<Units>,
    /// Units of the stamped file, likewise.
    #[arg(long, value_name = "UNITS", value_parser = units())]
    pub stamped_units: Option<Units>,
    /// Multiply the stamped coordinates by this before matching, for files in different units (1000 if
    /// the stamped file is in m and the crash file in mm). Stated in the result, never part of the
    /// matrix.
    #[arg(
        long,
        value_name = "FACTOR",
        allow_negative_numbers = true,
        value_parser = positive,
        default_value_t = 1.0
    )]
    pub stamped_length_factor: f64,
    /// The same for the crash coordinates. All results are then in the multiplied unit.
    #[arg(
        long,
        value_name = "FACTOR",
        allow_negative_numbers = true,
        value_parser = positive,
        default_value_t = 1.0
    )]
    pub crash_length_factor: f64,
    /// Maximum triangles of the crash part for the search (overrides --triangles).
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = at_least_one)]
    pub crash_triangles: Option<usize>,
    /// Maximum triangles of the stamped part for the search (overrides --triangles).
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = at_least_one)]
    pub stamped_triangles: Option<usize>,
    #[command(flatten)]
    pub read: ReadArgs,
}

/// How the files of a command are read.
#[derive(Debug, Args)]
pub struct ReadArgs {
    /// Another folder to search for included files; may be given several times.
    #[arg(long, value_name = "FOLDER")]
    pub include_folder: Vec<PathBuf>,
    /// Limit on each file with its includes, unpacked, in GiB; the numbers of files and of ids in
    /// sets are limited in proportion.
    #[arg(long, value_name = "GIB", allow_negative_numbers = true, default_value_t = 4.0, value_parser = positive)]
    pub read_limit: f64,
}

impl ReadArgs {
    /// Tells folders that are not there: of an included file that is then not found, only the paths that were tried
    /// would be told.
    pub(super) fn warn_of_folders(&self) {
        for folder in self.include_folder.iter().filter(|path| !path.is_dir()) {
            let what = if folder.exists() {
                "this is a file"
            } else {
                "no such folder"
            };
            log::warn!("--include-folder {}: {what}", folder.display());
        }
    }

    /// Refuses what a project has its own of; `what` takes the options.
    pub(super) fn refuse_beside_project(&self, what: &str) -> Result<(), UsageError> {
        for (is_typed, option) in [
            (!self.include_folder.is_empty(), "include-folder"),
            (self.read_limit != ReadOptions::USUAL_LIMIT, "read-limit"),
        ] {
            if is_typed {
                let text = format!("--{option} is for {what}; a project has its own");
                return Err(UsageError(text));
            }
        }
        Ok(())
    }

    /// What the reader is told.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            include_folders: self.include_folder.clone(),
            ..ReadOptions::default().with_limit(self.read_limit)
        }
    }
}

/// Short forms of settings.
#[derive(Debug, Args)]
#[command(next_help_heading = "Correspondences")]
pub struct ShorthandArgs {
    /// Short for --motion similarity.
    #[arg(long, conflicts_with = "motion")]
    pub scale: bool,
    /// Short for --hand either.
    #[arg(long, conflicts_with = "hand")]
    pub mirror: bool,
}

/// The files to write.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Write the whole result as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Write the 4×4 matrix as text (rows, crash from stamped).
    #[arg(long, value_name = "FILE|-")]
    pub matrix: Option<PathBuf>,
    /// Write LS-DYNA cards that use the pose.
    #[arg(long, value_name = "FILE|-")]
    pub cards: Option<PathBuf>,
    /// The kind of cards.
    #[arg(long, value_name = "FORM", requires = "cards", default_value = "stamped", value_parser = card_forms())]
    pub card_form: CardForm,
    /// Write a report with pictures, tables and charts as one HTML file.
    #[arg(long, value_name = "FILE|-")]
    pub report: Option<PathBuf>,
    /// Write the distance of every node of both parts to the other part as CSV.
    #[arg(long, value_name = "FILE|-")]
    pub deviations: Option<PathBuf>,
    /// Write the stamped mesh at its matched pose, without parts that were left out; the file extension selects the
    /// format (.k, .dynain, .stl, .ply, .obj).
    #[arg(long, value_name = "FILE")]
    pub moved: Option<PathBuf>,
    /// Write the stamped mesh at its original pose, in the unit of the crash part; formats as for
    /// --moved.
    #[arg(long, value_name = "FILE")]
    pub converted: Option<PathBuf>,
    /// Write the mesh of the crash parts that were matched; formats as for --moved.
    #[arg(long, value_name = "FILE")]
    pub crash_mesh: Option<PathBuf>,
    /// Report and write this one of the poses that fit nearly as well: 1 is the best, 2 the next.
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = at_least_one)]
    pub pose_number: Option<usize>,
}

/// `shapematch reduce`.
#[derive(Debug, Args)]
pub struct ReduceArgs {
    /// The file to read.
    pub input: PathBuf,
    /// Maximum number of triangles.
    #[arg(long, short = 'n', value_name = "N", allow_negative_numbers = true, value_parser = at_least_one)]
    pub triangles: usize,
    /// File to write; its extension selects the format (.k, .dynain, .stl, .ply, .obj). It holds one part, whatever
    /// parts the triangles come from.
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub read: ReadArgs,
    /// Part to reduce, as for match --crash-part.
    #[arg(long, value_name = "PART")]
    pub part: Option<String>,
    /// Reduce faster, with a larger error.
    #[arg(long)]
    pub fast: bool,
    /// Write the figures as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
}

/// `shapematch info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The file to read.
    pub input: PathBuf,
    #[command(flatten)]
    pub read: ReadArgs,
    /// Write the contents as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
}

/// `shapematch sample`.
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Folder to write to; created if it does not exist.
    #[arg(required_unless_present = "list")]
    pub folder: Option<PathBuf>,
    /// The part; `shapematch sample --list` names them.
    #[arg(long, value_name = "NAME", default_value = "floor")]
    pub part: String,
    /// Its variant; `shapematch sample --list` lists them.
    #[arg(long, value_name = "NAME", default_value = "plain")]
    pub variant: String,
    /// Random seed of the meshes and of the pose.
    #[arg(long, allow_negative_numbers = true, default_value_t = 1)]
    pub seed: u64,
    /// Write the bundled pair instead.
    #[arg(long, conflicts_with_all = ["part", "variant", "seed"])]
    pub bundled: bool,
    /// Write the realistic pair instead: springback, trim, skin against mid-surface, noise.
    #[arg(long, conflicts_with_all = ["part", "variant", "seed", "bundled"])]
    pub realistic: bool,
    /// List parts and variants.
    #[arg(long, conflicts_with_all = ["folder", "part", "variant", "seed", "bundled", "realistic"])]
    pub list: bool,
}

/// `shapematch bench`.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("table").args(["robustness", "mapping"]))]
#[command(group = clap::ArgGroup::new("page").args(["robustness", "growth"]))]
pub struct BenchArgs {
    /// The crash part; the generated car floor if no files are given.
    #[arg(requires = "stamped")]
    pub crash: Option<PathBuf>,
    /// The stamped part.
    pub stamped: Option<PathBuf>,
    /// Write the tables as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Match random shapes of all sample parts under every disturbance instead, and count right poses
    /// and honest verdicts.
    #[arg(long, conflicts_with = "crash")]
    pub robustness: bool,
    /// Map generated parts with known fields instead: errors of all methods over pairs of meshes, times
    /// and sizes.
    #[arg(long, conflicts_with_all = ["crash", "robustness"])]
    pub mapping: bool,
    /// Measure instead how the times of preparing and matching grow, from 1,500 to 1.2 million triangles.
    #[arg(long, conflicts_with_all = ["crash", "robustness", "mapping"])]
    pub growth: bool,
    /// With --growth: pairs of at most so many triangles of both meshes together.
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        default_value_t = 2_000_000,
        requires = "growth"
    )]
    pub largest: usize,
    /// Seed of shapes, placements and disturbances.
    #[arg(
        long,
        allow_negative_numbers = true,
        default_value_t = 1,
        requires = "robustness",
        conflicts_with_all = ["growth", "mapping"]
    )]
    pub seed: u64,
    /// Runs of every scenario on every part.
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        default_value_t = 1,
        value_parser = at_least_one,
        requires = "robustness",
        conflicts_with_all = ["growth", "mapping"]
    )]
    pub runs: usize,
    /// Only these parts and scenarios, by the beginnings of their names, separated by commas; of the
    /// mapping one part, or "speed" for the times alone.
    #[arg(
        long,
        value_name = "NAMES",
        requires = "table",
        conflicts_with = "growth"
    )]
    pub only: Option<String>,
    /// Write the table with plots as a page.
    #[arg(
        long,
        value_name = "FILE|-",
        requires = "page",
        conflicts_with = "mapping"
    )]
    pub html: Option<PathBuf>,
}

const MATCH_HELP: &str = "\
Examples:
  shapematch match crash.k stamped.dynain
  shapematch match floor.shapematch --cards include.k
  shapematch match car.k stamped.dynain --crash-part 2000012 --cards include.k --json result.json
  shapematch match crash.k stamped.dynain --method paper --triangles 2000

Exit status: 0 pose found (good or check), 3 pose found but poor, 1 failed, 2 wrong usage.";

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[test]
    fn there_are_at_most_four_threads_per_core() {
        let threads = |given: &str, n_cores: usize| {
            let cli = Cli::parse_from(["shapematch", "--threads", given]);
            cli.n_threads(n_cores)
        };
        assert_eq!(threads("1024", 2), 8);
        assert_eq!(threads("3", 2), 3);
        assert_eq!(threads("3", 0), 3);
        assert_eq!(threads("0", 64), 0);
    }
}
