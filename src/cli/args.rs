//! What can be typed: subcommands, options, and their help.

use std::path::PathBuf;

use clap::builder::BoolishValueParser;
use clap::{Args, Parser, Subcommand};

use super::words::{
    card_forms, data_sides, floor, hands, methods, pair_targets, residuals, searches, selections,
    start_methods, units,
};
use crate::registration::{DataSide, Floor, Hand, Method, Metric, PairWith, Search, StartMethod};
use crate::report::CardForm;
use crate::units::Units;

/// Finds the pose that lays a stamped part on the same part of a crash model.
///
/// The result is the matrix of crash = c · R · stamped + t (column vectors), with a verdict, and the
/// LS-DYNA cards that use it. Without a subcommand the window opens.
#[derive(Debug, Parser)]
#[command(name = "shapematch", version, max_term_width = 100)]
pub struct Cli {
    /// What to do; the window opens if nothing is named.
    #[command(subcommand)]
    pub command: Option<Task>,

    /// Files to open in the window: the crash part, then the stamped part; or a project.
    #[arg(value_name = "FILE", num_args = 0..=2)]
    pub files: Vec<PathBuf>,

    /// Open the window with the bundled pair of parts.
    #[arg(long, conflicts_with = "files")]
    pub example: bool,

    /// Threads for the heavy work; 0 takes one per core.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub threads: usize,

    /// Say nothing but errors on standard error.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Task {
    /// Match a stamped part to a crash part and print the matrix.
    Match(Box<MatchArgs>),
    /// Reduce a mesh to a maximum number of triangles.
    Reduce(ReduceArgs),
    /// Tell what a file holds.
    Info(InfoArgs),
    /// Write a generated pair of parts with known pose.
    Sample(SampleArgs),
    /// Measure reduction and matching as in the tables of the paper.
    Bench(BenchArgs),
}

/// `shapematch match`.
#[derive(Debug, Args)]
#[command(after_help = MATCH_HELP)]
pub struct MatchArgs {
    /// The crash part or the whole crash model (fixed); or a project (.shapematch), whose match is
    /// run as it is stored. Beside a project only the options of the output count.
    pub crash: PathBuf,
    /// The stamped part, for example a dynain (moves).
    pub stamped: Option<PathBuf>,

    #[command(flatten)]
    pub choice: ChoiceArgs,
    #[command(flatten)]
    pub method: MethodArgs,
    #[command(flatten)]
    pub search: SearchArgs,
    #[command(flatten)]
    pub starts: StartArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Which elements of the files are matched, and in which unit.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is matched")]
pub struct ChoiceArgs {
    /// Part of the crash model: an id, several ids (2001,2002), a title (also title:NAME), or set:ID,
    /// shell-set:ID, node-set:ID.
    #[arg(long, value_name = "PART")]
    pub crash_part: Option<String>,
    /// Part of the stamped file, written as for --crash-part.
    #[arg(long, value_name = "PART")]
    pub stamped_part: Option<String>,
    /// Multiply the stamped coordinates by this before matching, for a file in another unit
    /// (1000 for metres against millimetres). Stated in the result, never inside the matrix.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub stamped_unit: f64,
    /// The same for the crash coordinates. All results are then in the multiplied unit.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub crash_unit: f64,
    /// The units of the crash file, to be stated in the results; guessed if not given. They change
    /// no number.
    #[arg(long, value_name = "UNITS", value_parser = units())]
    pub crash_units: Option<Units>,
    /// The units of the stamped file, likewise.
    #[arg(long, value_name = "UNITS", value_parser = units())]
    pub stamped_units: Option<Units>,
    /// A further folder for included files; may be given several times.
    #[arg(long, value_name = "FOLDER")]
    pub include_folder: Vec<PathBuf>,
}

/// How the pose is computed.
#[derive(Debug, Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    /// The method; the options below change single choices of it.
    #[arg(long, default_value = "fractional", value_parser = methods())]
    pub method: Method,
    /// Which pairs count.
    #[arg(long, value_name = "PAIRS", value_parser = selections())]
    pub keep: Option<String>,
    /// λ of Fractional ICP: larger keeps more of the part.
    #[arg(long, value_name = "LAMBDA")]
    pub lambda: Option<f64>,
    /// Floor σ₀ of Fractional ICP: a length, none, or auto to take it from the meshes.
    #[arg(long, value_name = "LENGTH", value_parser = floor)]
    pub floor: Option<Floor>,
    /// Overlap of Trimmed ICP, 0 to 1; searched if not given.
    #[arg(long, value_name = "SHARE")]
    pub overlap: Option<f64>,
    /// Pair points with triangles or with nodes.
    #[arg(long, value_name = "TARGET", value_parser = pair_targets())]
    pub pairs: Option<PairWith>,
    /// The residual that is minimised.
    #[arg(long, value_parser = residuals())]
    pub residual: Option<Metric>,
    /// Whose nodes are laid on the other part's triangles.
    #[arg(long, value_name = "PART", value_parser = data_sides())]
    pub points_of: Option<DataSide>,
    /// Also find a scale c. Off by default: a free scale shrinks parts that only partly overlap.
    #[arg(long)]
    pub scale: bool,
    /// Which hand of the stamped part is tried.
    #[arg(long, value_parser = hands())]
    pub hand: Option<Hand>,
    /// Try both hands (left-hand against right-hand part); short for --hand either.
    #[arg(long, conflicts_with = "hand")]
    pub mirror: bool,
    /// Deviation to be expected besides faceting, such as springback, in length units.
    #[arg(long, value_name = "LENGTH")]
    pub allowance: Option<f64>,
    /// Largest angle between the normals of a pair, 1 to 180 degrees.
    #[arg(long, value_name = "DEG")]
    pub normal_angle: Option<f64>,
    /// Iterations a run may take.
    #[arg(long, value_name = "N")]
    pub iterations: Option<usize>,
    /// A run has settled when a step moves no corner by more than this share of an edge length.
    #[arg(long, value_name = "SHARE")]
    pub tolerance: Option<f64>,
}

/// Which meshes and points the search runs on.
#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub struct SearchArgs {
    /// How the starts are searched.
    #[arg(long, value_parser = searches())]
    pub search: Option<Search>,
    /// Points of the first stage of the race.
    #[arg(long, value_name = "N")]
    pub race_points: Option<usize>,
    /// Points of its second stage.
    #[arg(long, value_name = "N")]
    pub refine_points: Option<usize>,
    /// Run the starts on meshes reduced to so many triangles, as the paper does.
    #[arg(long, value_name = "N")]
    pub triangles: Option<usize>,
    /// Another number for the crash part, or for it alone.
    #[arg(long, value_name = "N")]
    pub crash_triangles: Option<usize>,
    /// Another number for the stamped part, or for it alone.
    #[arg(long, value_name = "N")]
    pub stamped_triangles: Option<usize>,
    /// Finish the winner on the full meshes.
    #[arg(long, value_name = "YES|NO", value_parser = BoolishValueParser::new())]
    pub finish: Option<bool>,
}

/// First poses.
#[derive(Debug, Args)]
#[command(next_help_heading = "First poses")]
pub struct StartArgs {
    /// Where the match starts from; surface-normal unless a --start-pose is given.
    #[arg(long, value_parser = start_methods())]
    pub start: Option<StartMethod>,
    /// Step of the rotations about the mean normal, at most 60 degrees; 40 gives nine.
    #[arg(long, value_name = "DEG")]
    pub angle_segment: Option<f64>,
    /// A pose (crash from stamped) to start from: a text file, or the numbers themselves, 16 by rows.
    /// Several poses are all tried.
    #[arg(
        long,
        visible_alias = "initial-pose",
        value_name = "FILE|NUMBERS",
        allow_hyphen_values = true
    )]
    pub start_pose: Vec<String>,
    /// Try both directions of the mean normal.
    #[arg(long, value_name = "YES|NO", value_parser = BoolishValueParser::new())]
    pub both_directions: Option<bool>,
    /// Add more starts where none convinces.
    #[arg(long, value_name = "YES|NO", value_parser = BoolishValueParser::new())]
    pub widen: Option<bool>,
}

/// What is written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Write the whole result as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Write the 4×4 matrix as text (rows, crash from stamped).
    #[arg(long, value_name = "FILE")]
    pub matrix: Option<PathBuf>,
    /// Write LS-DYNA cards that use the pose.
    #[arg(long, value_name = "FILE")]
    pub cards: Option<PathBuf>,
    /// Which cards.
    #[arg(long, value_name = "FORM", default_value = "stamped", value_parser = card_forms())]
    pub card_form: CardForm,
    /// Write a report with pictures, tables and charts as one HTML file.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Write how far every node of both parts lies from the other part, as CSV.
    #[arg(long, value_name = "FILE")]
    pub deviations: Option<PathBuf>,
    /// Write the stamped mesh moved onto the crash part; the ending chooses the format
    /// (.k, .dynain, .stl, .ply, .obj).
    #[arg(long, value_name = "FILE")]
    pub moved: Option<PathBuf>,
    /// Write the stamped mesh where it lies, in the unit of the crash part; endings as for --moved.
    #[arg(long, value_name = "FILE")]
    pub converted: Option<PathBuf>,
    /// Write the crash part, for example as STL; endings as for --moved.
    #[arg(long, value_name = "FILE")]
    pub crash_mesh: Option<PathBuf>,
}

/// `shapematch reduce`.
#[derive(Debug, Args)]
pub struct ReduceArgs {
    /// The file to read.
    pub input: PathBuf,
    /// Maximum number of triangles.
    #[arg(long, short = 'n', value_name = "N")]
    pub triangles: usize,
    /// Where the reduced mesh goes; the ending chooses the format (.k, .stl, .ply, .obj).
    #[arg(long, short, value_name = "FILE")]
    pub out: PathBuf,
    /// Which part, written as for match --crash-part.
    #[arg(long, value_name = "PART")]
    pub part: Option<String>,
    /// The faster setting, with a larger error.
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
    /// Write what was found as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
}

/// `shapematch sample`.
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Folder to write to; made if it does not exist.
    #[arg(required_unless_present = "list")]
    pub folder: Option<PathBuf>,
    /// The part: floor, rail, pillar, fender or bracket.
    #[arg(long, value_name = "NAME", default_value = "floor")]
    pub part: String,
    /// A variant of it; `shapematch sample --list` names them.
    #[arg(long, value_name = "NAME", default_value = "plain")]
    pub variant: String,
    /// Seed of the meshes and of the stamped part's place.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Write the bundled pair instead.
    #[arg(long, conflicts_with_all = ["part", "variant", "seed"])]
    pub bundled: bool,
    /// Only list parts and variants.
    #[arg(long)]
    pub list: bool,
}

/// `shapematch bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// The crash part; the generated car floor if no files are named.
    #[arg(requires = "stamped")]
    pub crash: Option<PathBuf>,
    /// The stamped part.
    pub stamped: Option<PathBuf>,
    /// Write the tables as JSON to a file, or to standard output with "-".
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
}

const MATCH_HELP: &str = "\
Examples:
  shapematch match crash.k stamped.dynain
  shapematch match floor.shapematch --cards include.k
  shapematch match car.k stamped.dynain --crash-part 2000012 --cards include.k --json result.json
  shapematch match crash.k stamped.dynain --method paper --triangles 2000

Exit status: 0 pose found (good or check), 3 pose found but poor, 1 failed, 2 wrong usage.";
