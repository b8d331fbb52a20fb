//! The record of a match: everything that is needed to use, judge and repeat it.

use serde::Serialize;

use super::pose::PoseRecord;
use crate::assess::{Assessment, Clarity, Coverage, OneSided};
use crate::formats::FileHash;
use crate::geometry::Point3;
use crate::registration::{
    Fate, MatchOutcome, MatchSettings, Selection, Side, StartMethod, StartRecord,
};

/// Which way the matrix goes, in words.
pub const DIRECTION: &str = "crash = c · R · stamped + t (column vectors)";

/// How the numbers of a record are laid out, in words.
const CONVENTION: &str = "matrices row by row for column vectors; a mirrored part is mirrored at \
    x = 0 first, then turned by quaternion or axis and angle";

/// Name and version of this program, with the source revision where it is known.
pub fn build_id() -> String {
    let version = concat!("shapematch ", env!("CARGO_PKG_VERSION"));
    match env!("SHAPEMATCH_REVISION") {
        "" => version.to_owned(),
        revision => format!("{version} ({revision})"),
    }
}

/// The result of a match. The JSON form has exactly these keys.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MatchRecord {
    /// The format of this record.
    pub schema: &'static str,
    /// Which way the matrix goes.
    pub direction: &'static str,
    /// How its numbers are laid out.
    pub convention: &'static str,
    /// What the lengths of this record are counted in.
    pub units: UnitsRecord,
    /// The transformation in every form.
    #[serde(flatten)]
    pub pose: PoseRecord,
    /// `good`, `check` or `poor`.
    pub verdict: &'static str,
    /// Why, one sentence each, the gravest first.
    pub reasons: Vec<String>,
    /// True if a distinct pose fits equally well.
    pub ambiguous: bool,
    /// Distinct poses that came close, best first.
    pub alternatives: Vec<AlternativeRecord>,
    /// Distances and overlap.
    pub metrics: Metrics,
    /// Motions that change nothing, in words; absent if the shape fixes the pose.
    pub free_motion: Option<String>,
    /// The method by name.
    pub method: &'static str,
    /// All choices of the method.
    pub parameters: Parameters,
    /// Seed of random numbers. A match draws none, so there is none: same input, same bits.
    pub seed: Option<u64>,
    /// Every start.
    pub starts: Vec<StartEntry>,
    /// Durations.
    pub timings: TimingsRecord,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
    /// The two files.
    pub files: Files,
    /// The line that does the match again without the window.
    pub command_line: String,
    /// Program, version, revision.
    pub build: String,
    /// Where it ran.
    pub machine: Machine,
}

/// What the lengths of a record are counted in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnitsRecord {
    /// The unit of every length: `mm`, `cm`, `m`, `in` or `ft`; none if unknown.
    pub length: Option<&'static str>,
    /// The angle unit of everything that ends in `_deg`.
    pub angle: &'static str,
    /// Coordinates of the crash file were multiplied by this before anything else.
    pub crash_factor: f64,
    /// Coordinates of the stamped file were multiplied by this before the matrix.
    pub stamped_factor: f64,
}

/// Distances between the parts at the pose, in length units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metrics {
    /// Root mean square distance within the overlap limit, the larger of both directions.
    pub rmse: f64,
    /// Distance that 95 % of the overlapping area stays below, the larger of both directions.
    pub p95: f64,
    /// Largest distance within the overlap limit, of both directions.
    pub max: f64,
    /// How much of the parts lies on each other.
    pub overlap: OverlapRecord,
    /// Stamped nodes against the crash part.
    pub stamped_on_crash: OneWay,
    /// Crash nodes against the stamped part.
    pub crash_on_stamped: OneWay,
}

/// Distances of the nodes of one part from the triangles of the other, weighted by area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OneWay {
    /// Share of the area within the limit.
    pub overlap: f64,
    /// Root mean square distance within the limit.
    pub rmse: f64,
    /// Distance that 95 % of the overlapping area stays below.
    pub p95: f64,
    /// Largest distance within the limit.
    pub max: f64,
    /// Largest distance of any node.
    pub max_anywhere: f64,
}

impl From<&OneSided> for OneWay {
    fn from(one: &OneSided) -> Self {
        Self {
            overlap: one.overlap,
            rmse: one.rmse,
            p95: one.p95,
            max: one.max,
            max_anywhere: one.max_anywhere,
        }
    }
}

/// The computer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Operating system.
    pub os: &'static str,
    /// Processor architecture.
    pub arch: &'static str,
    /// Threads that worked.
    pub threads: usize,
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        Self {
            os: std::env::consts::OS,
            arch: std::env::consts::ARCH,
            threads: rayon::current_num_threads(),
        }
    }
}

/// A distinct pose that came close.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlternativeRecord {
    /// 4×4 as rows, crash from stamped.
    pub matrix: [[f64; 4]; 4],
    /// Its score over the result's: 1 is equally good, larger is worse.
    pub score_ratio: f64,
}

/// Shares of area whose nodes lie within `limit` of the other part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverlapRecord {
    /// Share of the stamped part's area that lies on the crash part.
    pub stamped: f64,
    /// Share of the crash part's area that lies on the stamped part.
    pub crash: f64,
    /// The distance that counts as lying on each other, in the crash model's unit.
    pub limit: f64,
}

/// The choices of a match.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameters {
    /// What points are paired with.
    pub pairs: &'static str,
    /// Which pairs are kept.
    pub selection: &'static str,
    /// λ of Fractional ICP.
    pub lambda: Option<f64>,
    /// The floor of the last stage, as it was used.
    pub floor: Option<f64>,
    /// Overlap of Trimmed ICP, if it was given.
    pub trimmed_overlap: Option<f64>,
    /// The residual.
    pub residual: &'static str,
    /// What may move.
    pub motion: &'static str,
    /// Which hand was tried.
    pub hand: &'static str,
    /// Where first poses came from.
    pub start_method: &'static str,
    /// Step of the rotations about the mean normal.
    pub angle_segment_deg: f64,
    /// Number of those rotations, for one direction of the normal.
    pub n_rotations: Option<usize>,
    /// True if both directions of the mean normal were tried.
    pub both_directions: bool,
    /// True if more starts were to be added where none convinced.
    pub widen: bool,
    /// How the starts were searched.
    pub search: &'static str,
    /// Points of the first stage of the race.
    pub race_points: usize,
    /// Points of its second stage.
    pub refine_points: usize,
    /// Iterations a run might take.
    pub max_iterations: usize,
    /// A run has settled when a step moves no corner by more than this share of an edge length.
    pub motion_tolerance: f64,
    /// Largest angle between the normals of a pair.
    pub max_normal_angle_deg: f64,
    /// Deviation to be expected besides faceting.
    pub allowance: f64,
    /// True if the winner was finished on the full meshes.
    pub finish_on_full: bool,
    /// Whose nodes were to be laid on the other part's triangles.
    pub points_of: &'static str,
    /// Whose nodes were laid on the other part's triangles in the end.
    pub data_side: &'static str,
    /// Ceilings of the crash and the stamped mesh the starts ran on; none for a full mesh.
    pub max_triangles: [Option<usize>; 2],
    /// Triangles of the crash mesh the starts ran on.
    pub crash_triangles: usize,
    /// Triangles of the stamped mesh the starts ran on.
    pub stamped_triangles: usize,
}

/// The story of one start.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StartEntry {
    /// How it came to be.
    pub kind: String,
    /// True if the stamped normals counted reversed.
    pub flipped: bool,
    /// True if the stamped part was mirrored.
    pub mirrored: bool,
    /// Which part supplied the points.
    pub data_side: &'static str,
    /// Iterations made.
    pub iterations: usize,
    /// Objective in the end; comparable between starts that went equally far.
    pub score: f64,
    /// What became of it.
    pub fate: String,
    /// Why its last stage ended.
    pub termination: Option<&'static str>,
    /// First pose, 4×4 as rows, crash from stamped.
    pub first: [[f64; 4]; 4],
    /// Last pose, 4×4 as rows, crash from stamped.
    pub last: [[f64; 4]; 4],
}

/// Durations in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct TimingsRecord {
    /// Reading both files and making meshes of them.
    pub read_ms: f64,
    /// Reducing both meshes; 0 if nothing was reduced.
    pub reduce_ms: f64,
    /// Trees, normals and first poses.
    pub align_ms: f64,
    /// All starts and the finish.
    pub match_ms: f64,
    /// The independent check.
    pub verify_ms: f64,
    /// Everything together.
    pub total_ms: f64,
}

/// The two sides of a match.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Files {
    /// The fixed side.
    pub crash: FileRecord,
    /// The moving side.
    pub stamped: FileRecord,
}

/// One side of a match.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileRecord {
    /// Path of the file.
    pub path: String,
    /// The file's name.
    pub name: String,
    /// SHA-256 of the file as it is stored.
    #[serde(rename = "sha256")]
    pub hash: Option<FileHash>,
    /// The files it includes.
    pub includes: Vec<IncludedFile>,
    /// Ids of the parts that were matched.
    pub parts: Vec<u64>,
    /// Nodes of the file and its includes.
    pub nodes: usize,
    /// Triangles of the matched surface.
    pub triangles: usize,
    /// Mean thickness of the matched shells, if known.
    pub thickness: Option<f64>,
    /// Factor its coordinates were multiplied with when it was read.
    pub length_factor: f64,
    /// Its own units, before that factor: a length, or a system such as `ton-mm-s`.
    pub units: Option<&'static str>,
    /// How its units became known, in words.
    pub units_from: Option<&'static str>,
    /// Warnings and errors of the reader.
    pub findings: u64,
}

/// A file that another one includes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IncludedFile {
    /// Its path.
    pub path: String,
    /// SHA-256 of the file as it is stored.
    #[serde(rename = "sha256")]
    pub hash: Option<FileHash>,
}

/// What a record is made of besides outcome and assessment.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordContext {
    /// The settings of the match.
    pub settings: MatchSettings,
    /// Ceilings of the crash and the stamped mesh the starts ran on.
    pub max_triangles: [Option<usize>; 2],
    /// Triangles of the crash and the stamped mesh the starts ran on.
    pub n_triangles: [usize; 2],
    /// What lengths are counted in.
    pub units: UnitsRecord,
    /// A node of the stamped part: its id and place in the crash model's unit.
    pub sample_node: Option<(u64, Point3)>,
    /// Centre of the stamped part's box, in the crash model's unit.
    pub center: Point3,
    /// The two sides.
    pub files: Files,
    /// Durations.
    pub timings: TimingsRecord,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
    /// The line that does the match again.
    pub command_line: String,
}

impl MatchRecord {
    /// Collects the record.
    pub fn new(outcome: &MatchOutcome, assessment: &Assessment, context: RecordContext) -> Self {
        let pose = &outcome.target_from_source;
        let coverage = &assessment.coverage;
        let alternatives = outcome.alternatives.iter().map(|other| AlternativeRecord {
            matrix: other.target_from_source.to_rows(),
            score_ratio: other.score_ratio,
        });
        Self {
            schema: "shapematch.match/1",
            direction: DIRECTION,
            convention: CONVENTION,
            pose: PoseRecord::new(pose, context.sample_node, &context.center),
            units: context.units.clone(),
            verdict: assessment.verdict.name(),
            reasons: assessment.reasons.clone(),
            ambiguous: assessment.ambiguity.clarity == Clarity::Ambiguous,
            alternatives: alternatives.collect(),
            metrics: Metrics::of(coverage),
            free_motion: assessment.freedom.motion.map(|motion| motion.words()),
            method: context.settings.method.name(),
            parameters: Parameters::of(outcome, &context),
            seed: None,
            starts: outcome.starts.iter().map(StartEntry::of).collect(),
            timings: context.timings,
            warnings: context.warnings,
            files: context.files,
            command_line: context.command_line,
            build: build_id(),
            machine: Machine::here(),
        }
    }
}

impl Metrics {
    /// Collects the figures of both directions.
    pub fn of(coverage: &Coverage) -> Self {
        let (there, back) = (&coverage.source_on_target, &coverage.target_on_source);
        Self {
            rmse: coverage.rmse(),
            p95: coverage.p95(),
            max: there.max.max(back.max),
            overlap: OverlapRecord {
                stamped: there.overlap,
                crash: back.overlap,
                limit: coverage.limit,
            },
            stamped_on_crash: there.into(),
            crash_on_stamped: back.into(),
        }
    }
}

impl Parameters {
    fn of(outcome: &MatchOutcome, context: &RecordContext) -> Self {
        let settings = &context.settings;
        let (lambda, overlap) = match settings.selection {
            Selection::Fractional { lambda, .. } => (Some(lambda), None),
            Selection::Trimmed { overlap } => (None, Some(overlap)),
            Selection::All | Selection::TrimmedSearch => (None, None),
        };
        let by_normals = matches!(
            settings.starts.method,
            StartMethod::SurfaceNormals | StartMethod::All
        );
        Self {
            pairs: settings.pair_with.label(),
            selection: settings.selection.label(),
            lambda,
            floor: lambda.map(|_| outcome.floor),
            trimmed_overlap: overlap,
            residual: settings.metric.label(),
            motion: settings.motion.label(),
            hand: settings.hand.label(),
            start_method: settings.starts.method.label(),
            angle_segment_deg: settings.starts.angle_segment_deg,
            n_rotations: settings.starts.n_rotations().ok().filter(|_| by_normals),
            both_directions: settings.starts.both_signs,
            widen: settings.starts.widen,
            search: settings.search.label(),
            race_points: settings.n_race_points,
            refine_points: settings.n_refine_points,
            max_iterations: settings.max_iterations,
            motion_tolerance: settings.motion_tolerance,
            max_normal_angle_deg: settings.max_normal_angle_deg,
            allowance: settings.allowance,
            finish_on_full: settings.finish,
            points_of: settings.data_side.label(),
            data_side: side_word(outcome.data_side),
            max_triangles: context.max_triangles,
            crash_triangles: context.n_triangles[0],
            stamped_triangles: context.n_triangles[1],
        }
    }
}

impl StartEntry {
    fn of(start: &StartRecord) -> Self {
        Self {
            kind: start.kind.label(),
            flipped: start.flipped,
            mirrored: start.mirrored,
            data_side: side_word(start.data_side),
            iterations: start.iterations.len(),
            score: start.score,
            fate: fate_words(start.fate),
            termination: start.termination.map(|reason| reason.label()),
            first: start.first.to_rows(),
            last: start.last.to_rows(),
        }
    }
}

/// `stamped` for the source, `crash` for the target.
pub fn side_word(side: Side) -> &'static str {
    match side {
        Side::Source => "stamped",
        Side::Target => "crash",
    }
}

/// What became of a start, in words.
pub fn fate_words(fate: Fate) -> String {
    match fate {
        Fate::Won => "won".into(),
        Fate::RunnerUp => "runner-up".into(),
        Fate::MergedInto { start } => format!("met start {}", start + 1),
        Fate::Dropped { after } => format!("dropped after {after} iterations"),
        Fate::Failed => "found no fit".into(),
    }
}
