//! The record of a match: everything that is needed to use, judge and repeat it.

use serde::{Serialize, Serializer};

use super::DiagnosticInfo;
use super::pose::{PoseRecord, rows};
use super::starts;
use crate::assess::{
    Assessment, Clarity, Coverage, OneSided, PoseKind, PoseUncertainty, Reason, ShapeStatement,
    Verdict,
};
use crate::formats::FileHash;
use crate::geometry::Point3;
use crate::registration::{MatchOutcome, Method, PairSelection, Side, StartMethod, StartRecord};
use crate::role::{PerRole, Role};
use crate::settings::{MatchRecipe, SETTINGS};
use crate::text::Lengths;
use crate::units::LengthUnit;

/// Which way the matrix goes, in words.
pub const DIRECTION: &str = "crash = c · R · stamped + t (column vectors)";

/// How the numbers of a record are laid out, in words.
const CONVENTION: &str = "matrices row by row for column vectors; a mirrored part is mirrored at \
    x = 0 first, then rotated by quaternion or axis and angle";

/// Name and version of this program, with the source revision where it is known, or that it is a debug build.
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
    /// Whether the pose can be used.
    pub verdict: Verdict,
    /// Why, one sentence each, the most severe first.
    pub reasons: Vec<String>,
    /// The same reasons by name, with their numbers.
    pub reason_details: Vec<Reason>,
    /// What can be said about the pose, with its uncertainty.
    pub pose_statement: Option<PoseKind>,
    /// How far the pose may be off: the largest uncertainty of a stamped node, its direction and place.
    pub pose_uncertainty: Option<PoseUncertainty>,
    /// Uncertainty up to which the pose is certain.
    pub pose_tolerance: Option<f64>,
    /// Whether both parts have one shape, with its numbers and reasons.
    pub shape: Option<ShapeStatement>,
    /// Both statements in words.
    pub statements: Vec<String>,
    /// True if a distinct pose fits equally well.
    pub ambiguous: bool,
    /// Distinct poses that came close, best first.
    pub alternatives: Vec<AlternativeRecord>,
    /// Distances and overlap.
    pub metrics: Metrics,
    /// Motions that the surfaces do not resist, in words; holes and borders may hold the pose all the same.
    pub free_motion: Option<String>,
    /// Method by its name.
    pub method: Method,
    /// All choices of the method.
    pub parameters: Parameters,
    /// Seed of random numbers. A match draws none, so there is none: same input, same bits.
    pub seed: Option<u64>,
    /// Every start, in the order of their numbers.
    #[serde(serialize_with = "starts::entries")]
    pub starts: Vec<StartRecord>,
    /// Time of each phase.
    pub timings: TimingsRecord,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
    /// The two files.
    pub files: PerRole<FileRecord>,
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
    /// The unit of every length, as its symbol; none if unknown.
    #[serde(serialize_with = "symbol")]
    pub length: Option<LengthUnit>,
    /// The angle unit of everything that ends in `_deg`.
    pub angle: &'static str,
    /// Coordinates of the crash file were multiplied by this before anything else.
    pub crash_factor: f64,
    /// Coordinates of the stamped file were multiplied by this before the matrix.
    pub stamped_factor: f64,
}

/// `mm`, `cm`, `m`, `in` or `ft`.
fn symbol<S: Serializer>(unit: &Option<LengthUnit>, serializer: S) -> Result<S::Ok, S::Error> {
    unit.map(LengthUnit::symbol).serialize(serializer)
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
    /// How much of the parts overlaps.
    pub overlap: OverlapRecord,
    /// Stamped nodes against the crash part.
    pub stamped_on_crash: OneWay,
    /// Crash nodes against the stamped part.
    pub crash_on_stamped: OneWay,
}

/// Distances of the nodes of one part from the triangles of the other, weighted by area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OneWay {
    /// Fraction of the area within the limit.
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

/// Computer the times were taken on.
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
    /// The computer the program runs on.
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
    /// Number of the pose among those of the match, of which 1 is the best.
    pub number: usize,
    /// 4×4 as rows, crash from stamped.
    pub matrix: [[f64; 4]; 4],
    /// Its score over the result's: 1 is equally good, larger is worse.
    pub score_ratio: f64,
    /// Whether the ratio is what surfaces, borders and holes say, and no measured error.
    pub by_shape: bool,
}

/// Fractions of area whose nodes lie within `limit` of the other part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverlapRecord {
    /// Fraction of the stamped part's area that overlaps the crash part.
    pub stamped: f64,
    /// Fraction of the crash part's area that overlaps the stamped part.
    pub crash: f64,
    /// Distance up to which a place overlaps, in the crash model's unit.
    pub limit: f64,
}

/// The settings of a match, and what became of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameters {
    /// The settings, each under its key.
    #[serde(flatten)]
    pub settings: SettingsRecord,
    /// The floor of the last stage, as it was used; none without Fractional ICP.
    pub floor: Option<f64>,
    /// Number of rotations about the mean normal, for one direction of it.
    pub n_rotations: Option<usize>,
    /// The part whose nodes were paired with the other part's surface in the end.
    #[serde(serialize_with = "role_word")]
    pub data_side: Role,
    /// Maximum triangles of the meshes the starts ran on, crash first; none for a full mesh.
    #[serde(serialize_with = "PerRole::as_list")]
    pub max_triangles: PerRole<Option<usize>>,
    /// Triangles of the crash mesh the starts ran on.
    pub crash_triangles: usize,
    /// Triangles of the stamped mesh the starts ran on.
    pub stamped_triangles: usize,
}

/// Settings that are written by walking the table of settings.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingsRecord(pub MatchRecipe);

impl Serialize for SettingsRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rows = SETTINGS.iter().map(|row| (row.key, row.get(&self.0)));
        serializer.collect_map(rows)
    }
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde calls it with a reference"
)]
fn role_word<S: Serializer>(role: &Role, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(role.word())
}

/// Durations in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct TimingsRecord {
    /// Reading both files and making meshes of them.
    pub read_ms: f64,
    /// Matches on other crash parts, to find the one that the stamped part belongs to; 0 if it was given.
    pub find_ms: f64,
    /// Reducing both meshes; 0 if nothing was reduced.
    pub reduce_ms: f64,
    /// Trees, normals and start poses.
    pub align_ms: f64,
    /// All starts and the refinement of the best.
    pub match_ms: f64,
    /// Borders, holes and bends on the full meshes.
    pub settle_ms: f64,
    /// The independent check.
    pub verify_ms: f64,
    /// Time of the whole run in milliseconds.
    pub total_ms: f64,
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
    /// How many warnings and errors the reader has.
    pub findings: u64,
    /// The first of them, errors before warnings.
    pub diagnostics: Vec<DiagnosticInfo>,
}

/// A file that another one includes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IncludedFile {
    /// Path of the file.
    pub path: String,
    /// SHA-256 of the file as it is stored.
    #[serde(rename = "sha256")]
    pub hash: Option<FileHash>,
}

/// What a record is made of besides outcome and assessment.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordContext {
    /// The settings of the match.
    pub recipe: MatchRecipe,
    /// Ceilings of the crash and the stamped mesh the starts ran on.
    pub max_triangles: PerRole<Option<usize>>,
    /// Triangles of the crash and the stamped mesh the starts ran on.
    pub n_triangles: PerRole<usize>,
    /// What lengths are counted in.
    pub units: UnitsRecord,
    /// A node of the stamped part: its id and place in the crash model's unit.
    pub sample_node: Option<(u64, Point3)>,
    /// Centre of the stamped part's box, in the crash model's unit.
    pub center: Point3,
    /// The two sides.
    pub files: PerRole<FileRecord>,
    /// Time of each phase.
    pub timings: TimingsRecord,
    /// The alternative of the match that the pose is; `None` for its best pose.
    pub alternative: Option<usize>,
    /// What the user should know besides the verdict.
    pub warnings: Vec<String>,
    /// The line that does the match again.
    pub command_line: String,
}

/// Number of the pose at `index` of the others among those of a match, of which 1 is the best; `shown` is the
/// alternative that has become the result, in whose place the best pose comes first.
fn number_of_other(shown: Option<usize>, index: usize) -> usize {
    match shown {
        None => index + 2,
        Some(_) if index == 0 => 1,
        Some(shown) if index <= shown => index + 1,
        Some(_) => index + 2,
    }
}

impl MatchRecord {
    /// Collects the record.
    pub fn new(outcome: &MatchOutcome, assessment: &Assessment, context: RecordContext) -> Self {
        let pose = &outcome.target_from_source;
        let coverage = &assessment.coverage;
        let alternatives = (0..).zip(&outcome.alternatives);
        let alternatives = alternatives.map(|(index, other)| AlternativeRecord {
            number: number_of_other(context.alternative, index),
            matrix: rows(&other.target_from_source),
            score_ratio: other.score_ratio,
            by_shape: other.by_shape,
        });
        Self {
            schema: "shapematch.match/3",
            direction: DIRECTION,
            convention: CONVENTION,
            pose: PoseRecord::new(pose, context.sample_node, &context.center),
            units: context.units.clone(),
            verdict: assessment.verdict,
            reasons: assessment.sentences(Lengths::new(context.units.length)),
            reason_details: assessment.reasons.clone(),
            pose_statement: assessment.pose.as_ref().map(|pose| pose.kind),
            pose_uncertainty: assessment.uncertainty().cloned(),
            pose_tolerance: assessment.pose.as_ref().map(|pose| pose.tolerance),
            shape: assessment.shape.clone(),
            statements: assessment.statements(Lengths::new(context.units.length)),
            ambiguous: assessment.ambiguity.clarity == Clarity::Ambiguous,
            alternatives: alternatives.collect(),
            metrics: Metrics::of(coverage),
            free_motion: assessment.freedom.motion.map(|motion| motion.words()),
            method: context.recipe.settings.method,
            parameters: Parameters::of(outcome, &context),
            seed: None,
            starts: outcome.starts.clone(),
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
            max: coverage.max(),
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
        let settings = &context.recipe.settings;
        let by_normals = matches!(
            settings.starts.method,
            StartMethod::SurfaceNormals | StartMethod::All
        );
        let has_floor = matches!(
            settings.selection,
            PairSelection::Fractional { .. } | PairSelection::TrimmedSearch
        );
        Self {
            settings: SettingsRecord(context.recipe.clone()),
            floor: has_floor.then_some(outcome.floor),
            n_rotations: settings.starts.n_rotations().ok().filter(|_| by_normals),
            data_side: role_of(outcome.data_side),
            max_triangles: context.max_triangles,
            crash_triangles: context.n_triangles.crash,
            stamped_triangles: context.n_triangles.stamped,
        }
    }
}

/// The part that was the source or the target of a match.
pub fn role_of(side: Side) -> Role {
    match side {
        Side::Source => Role::Stamped,
        Side::Target => Role::Crash,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_other_poses_keep_their_numbers_whichever_is_shown() {
        let numbers = |shown| {
            (0..4)
                .map(|index| number_of_other(shown, index))
                .collect::<Vec<_>>()
        };
        assert_eq!(numbers(None), [2, 3, 4, 5]);
        assert_eq!(numbers(Some(0)), [1, 3, 4, 5]);
        assert_eq!(numbers(Some(2)), [1, 2, 3, 5]);
        assert_eq!(numbers(Some(3)), [1, 2, 3, 4]);
    }
}
