//! The record of a match: everything that is needed to use, judge and repeat it.

use serde::Serialize;

use crate::assess::{Assessment, Clarity};
use crate::geometry::Similarity;
use crate::registration::{
    Fate, MatchOutcome, MatchSettings, Selection, Side, StartMethod, StartRecord,
};
use crate::units::LengthUnit;

/// Which way the matrix goes, in words.
pub const DIRECTION: &str = "crash = c · R · stamped + t (column vectors)";

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
    /// 4×4 as rows, crash from stamped, scale included.
    pub matrix: [[f64; 4]; 4],
    /// R as rows; its determinant is −1 for a mirrored part.
    pub rotation: [[f64; 3]; 3],
    /// t in the crash model's length unit.
    pub translation: [f64; 3],
    /// The unit of every length here: `mm`, `cm`, `m`, `in` or `ft`; absent if unknown.
    pub length_unit: Option<&'static str>,
    /// c.
    pub scale: f64,
    /// `good`, `check` or `poor`.
    pub verdict: &'static str,
    /// Why, one sentence each, the gravest first.
    pub reasons: Vec<String>,
    /// True if a distinct pose fits equally well.
    pub ambiguous: bool,
    /// Distinct poses that came close, best first.
    pub alternatives: Vec<AlternativeRecord>,
    /// Root mean square distance within the overlap limit, the larger of both directions.
    pub rmse: f64,
    /// Distance that 95 % of the overlapping area stays below, the larger of both directions.
    pub p95: f64,
    /// Largest distance within the overlap limit, of both directions.
    pub max: f64,
    /// How much of the parts lies on each other.
    pub overlap: OverlapRecord,
    /// Motions that change nothing, in words; absent if the shape fixes the pose.
    pub free_motion: Option<String>,
    /// The method by name.
    pub method: &'static str,
    /// All choices of the method.
    pub parameters: Parameters,
    /// Every start.
    pub starts: Vec<StartEntry>,
    /// Durations in milliseconds.
    pub timings_ms: TimingsRecord,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
    /// The two files.
    pub files: Files,
    /// Program, version, revision.
    pub build: String,
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
    /// How the starts were searched.
    pub search: &'static str,
    /// True if the winner was finished on the full meshes.
    pub finish_on_full: bool,
    /// Which part's nodes were laid on the other part's triangles in the end.
    pub data_side: &'static str,
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
    pub read: f64,
    /// Reducing both meshes; 0 if nothing was reduced.
    pub reduce: f64,
    /// Trees, normals and first poses.
    pub align: f64,
    /// All starts and the finish.
    #[serde(rename = "match")]
    pub matching: f64,
    /// The independent check.
    pub verify: f64,
    /// Everything together.
    pub total: f64,
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
    /// Ids of the parts that were matched.
    pub parts: Vec<u64>,
    /// Triangles of the matched surface.
    pub triangles: usize,
    /// Factor its coordinates were multiplied with when it was read.
    pub length_factor: f64,
    /// Its own units, before that factor: a length, or a system such as `ton-mm-s`.
    pub units: Option<&'static str>,
    /// How its units became known, in words.
    pub units_from: Option<&'static str>,
}

/// What a record is made of besides outcome and assessment.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordContext {
    /// The settings of the match.
    pub settings: MatchSettings,
    /// Triangles of the crash and the stamped mesh the starts ran on.
    pub n_triangles: [usize; 2],
    /// The two sides.
    pub files: Files,
    /// The unit of every length, if it is known.
    pub length_unit: Option<LengthUnit>,
    /// Durations.
    pub timings: TimingsRecord,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
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
            matrix: pose.to_rows(),
            rotation: rotation_rows(pose),
            translation: pose.translation.into(),
            length_unit: context.length_unit.map(LengthUnit::symbol),
            scale: pose.scale,
            verdict: assessment.verdict.name(),
            reasons: assessment.reasons.clone(),
            ambiguous: assessment.ambiguity.clarity == Clarity::Ambiguous,
            alternatives: alternatives.collect(),
            rmse: coverage.rmse(),
            p95: coverage.p95(),
            max: coverage
                .source_on_target
                .max
                .max(coverage.target_on_source.max),
            overlap: OverlapRecord {
                stamped: coverage.source_on_target.overlap,
                crash: coverage.target_on_source.overlap,
                limit: coverage.limit,
            },
            free_motion: assessment.freedom.motion.map(|motion| motion.words()),
            method: context.settings.method.name(),
            parameters: Parameters::of(outcome, &context),
            starts: outcome.starts.iter().map(StartEntry::of).collect(),
            timings_ms: context.timings,
            warnings: context.warnings,
            files: context.files,
            build: build_id(),
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
            search: settings.search.label(),
            finish_on_full: settings.finish,
            data_side: side_word(outcome.data_side),
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

fn rotation_rows(pose: &Similarity) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|col| pose.rotation[(row, col)]))
}
