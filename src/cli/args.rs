//! What can be typed: subcommands, options, and their help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

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

    /// Files to open in the window: the crash part, then the stamped part.
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
    /// The crash part or the whole crash model (fixed).
    pub crash: PathBuf,
    /// The stamped part, for example a dynain (moves).
    pub stamped: PathBuf,

    #[command(flatten)]
    pub choice: ChoiceArgs,
    #[command(flatten)]
    pub method: MethodArgs,
    #[command(flatten)]
    pub starts: StartArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Which elements of the files are matched, and in which unit.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is matched")]
pub struct ChoiceArgs {
    /// Part of the crash model: an id, several ids (2001,2002), a title, or set:ID, shell-set:ID,
    /// node-set:ID.
    #[arg(long, value_name = "PART")]
    pub crash_part: Option<String>,
    /// Part of the stamped file, written as for --crash-part.
    #[arg(long, value_name = "PART")]
    pub stamped_part: Option<String>,
    /// Multiply the stamped coordinates by this before matching, for a file in another unit
    /// (1000 for metres against millimetres). Stated in the result, never inside the matrix.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub stamped_unit: f64,
}

/// The method by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Fractional ICP: finds by itself how much of the parts overlaps.
    Fractional,
    /// Trimmed ICP: keeps a given share, or searches it.
    Trimmed,
    /// Plain ICP: all pairs count.
    Icp,
    /// Closed form for the same mesh with the same node numbers.
    Umeyama,
    /// The setting of the paper: Fractional ICP from node to node, point to point.
    Paper,
}

/// What a data point is paired with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PairName {
    /// The closest point of any triangle.
    Triangle,
    /// The closest node.
    Node,
}

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ResidualName {
    /// Distance between the points (Besl and McKay 1992).
    PointToPoint,
    /// Distance to the tangent plane (Chen and Medioni 1992).
    PointToPlane,
    /// Distance along both normals (Rusinkiewicz 2019).
    Symmetric,
}

/// How the pose is computed.
#[derive(Debug, Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    /// The method; the options below change single choices of it.
    #[arg(long, value_enum, default_value_t = MethodName::Fractional)]
    pub method: MethodName,
    /// Pair points with triangles or with nodes.
    #[arg(long, value_enum, value_name = "TARGET")]
    pub pairs: Option<PairName>,
    /// The residual that is minimised.
    #[arg(long, value_enum)]
    pub residual: Option<ResidualName>,
    /// λ of Fractional ICP: larger keeps more of the part.
    #[arg(long, value_name = "LAMBDA")]
    pub lambda: Option<f64>,
    /// Floor σ₀ of Fractional ICP, in length units; taken from the meshes if not given.
    #[arg(long, value_name = "LENGTH")]
    pub floor: Option<f64>,
    /// Overlap of Trimmed ICP, 0 to 1; searched if not given.
    #[arg(long, value_name = "SHARE")]
    pub overlap: Option<f64>,
    /// Also find a scale c. Off by default: a free scale shrinks parts that only partly overlap.
    #[arg(long)]
    pub scale: bool,
    /// Also try the mirrored stamped part (left-hand against right-hand part).
    #[arg(long)]
    pub mirror: bool,
    /// Run the starts on meshes reduced to so many triangles, as the paper does.
    #[arg(long, value_name = "N")]
    pub triangles: Option<usize>,
    /// Stop with the result on the reduced meshes; do not finish on the full ones.
    #[arg(long, requires = "triangles")]
    pub no_finish: bool,
}

/// Where the first poses come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StartName {
    /// Centroids and mean normals laid on each other, turned in steps about the normal.
    SurfaceNormal,
    /// The pose of --initial-pose, or the files as they lie.
    Current,
    /// Surface normals, principal axes and a covering of all rotations.
    All,
}

/// First poses.
#[derive(Debug, Args)]
#[command(next_help_heading = "First poses")]
pub struct StartArgs {
    /// Where the match starts from.
    #[arg(long, value_enum, default_value_t = StartName::SurfaceNormal)]
    pub start: StartName,
    /// Step of the rotations about the mean normal, at most 60 degrees.
    #[arg(long, value_name = "DEG", default_value_t = 40.0)]
    pub angle_segment: f64,
    /// A text file with a 4×4 matrix (crash from stamped) to start from; implies --start current.
    #[arg(long, value_name = "FILE")]
    pub initial_pose: Option<PathBuf>,
}

/// The cards by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CardName {
    /// *INCLUDE_STAMPED_PART_MATRIX: the solver maps the forming results.
    Stamped,
    /// *INCLUDE_STAMPED_PART_MATRIX_INVERSE: the same from the matrix of the way back.
    StampedInverse,
    /// *DEFINE_TRANSFORMATION and *INCLUDE_TRANSFORM: the stamped mesh joins the crash model.
    Transform,
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
    #[arg(long, value_enum, value_name = "FORM", default_value_t = CardName::Stamped)]
    pub card_form: CardName,
    /// Write the stamped mesh moved onto the crash part; the ending chooses the format
    /// (.k, .dynain, .stl, .ply, .obj).
    #[arg(long, value_name = "FILE")]
    pub moved: Option<PathBuf>,
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
  shapematch match car.k stamped.dynain --crash-part 2000012 --cards include.k --json result.json
  shapematch match crash.k stamped.dynain --method paper --triangles 2000

Exit status: 0 pose found (good or check), 3 pose found but poor, 1 failed, 2 wrong usage.";
