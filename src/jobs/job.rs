//! The kinds of jobs, what they are given and what they give.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use super::{ExportRequest, Exported, OpenedProject, PartFacts, PartSource, SweepRows};
use crate::assess::{AlternativeStatements, Coverage};
use crate::geometry::{Similarity, TriMesh};
use crate::pipeline::inspect::Comparison;
use crate::pipeline::load::{LoadSettings, LoadedPart};
use crate::pipeline::map::{
    ComparisonRecord, ElementLists, MapRecipe, MapRecord, MapRun, OtherResult, PoseOrigin,
};
use crate::pipeline::match_parts::{MatchRecipe, MatchRun, ReducedPair};
use crate::pipeline::project::ProjectRequest;
use crate::pipeline::reduce::{Deviation, Level, Levels};
use crate::pipeline::sweep::{Sweep, SweepSettings};
use crate::registration::MatchSettings;
use crate::registration::starts::Start;
use crate::role::{PerRole, Role};

/// Name of one submitted job, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JobId(pub u64);

/// A job's place in the queue: of each key at most one job waits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum JobKey {
    /// Reading a part.
    Load(Role),
    /// Taking other parts of a deck, or another unit, without reading it again.
    Reselect(Role),
    /// Reducing a part.
    Reduce(Role),
    /// Measuring how far a level lies from the full mesh.
    MeasureLevel(Role),
    /// First poses from the mean normals.
    Align,
    /// Match of the two parts.
    Match,
    /// The verdict of a match with another tolerance.
    Verdict,
    /// Distances and overlap at a pose.
    Measure,
    /// Deviation of every node.
    Compare,
    /// Reading a further stamped file, by the number it is to have.
    LoadFurther(u64),
    /// The pose of a further stamped file.
    PlaceFurther,
    /// Forming results onto the crash part.
    Map,
    /// Another mapper's result beside the mapping.
    CompareMapping,
    /// The overlap at a pose, from few points.
    Overlap,
    /// The paper's tables.
    Sweep,
    /// Reading a project with its parts.
    OpenProject,
    /// Writing of an output, by its number: none takes the place of another that waits.
    Export(u64),
}

impl JobKey {
    /// The same work on the other part, for work that both parts are asked for at once.
    pub fn of_other_part(self) -> Option<Self> {
        match self {
            Self::Load(role) => Some(Self::Load(role.other())),
            Self::Reduce(role) => Some(Self::Reduce(role.other())),
            Self::MeasureLevel(role) => Some(Self::MeasureLevel(role.other())),
            _ => None,
        }
    }

    /// True for the writing of an output.
    pub fn is_export(self) -> bool {
        matches!(self, Self::Export(_))
    }

    /// What the running job does, for the status line.
    pub fn label(self) -> &'static str {
        match self {
            Self::Load(Role::Crash) => "Loading the crash part",
            Self::Load(Role::Stamped) => "Loading the stamped part",
            Self::Reselect(_) => "Taking the chosen parts",
            Self::Reduce(Role::Crash) => "Reducing the crash part",
            Self::Reduce(Role::Stamped) => "Reducing the stamped part",
            Self::MeasureLevel(_) => "Measuring the reduction",
            Self::Align => "Aligning surface normals",
            Self::Match => "Matching",
            Self::Verdict => "Judging the match",
            Self::Measure => "Measuring distances",
            Self::Compare => "Measuring the deviation",
            Self::LoadFurther(_) => "Reading a stamped file",
            Self::PlaceFurther => "Matching a stamped file",
            Self::Map => "Mapping the forming results",
            Self::CompareMapping => "Comparing with the other result",
            Self::Overlap => "Measuring the overlap",
            Self::Sweep => "Running the sweep",
            Self::OpenProject => "Opening the project",
            Self::Export(_) => "Writing",
        }
    }
}

/// The state of the inputs a job was asked for. Numbers are never given twice; undo brings back
/// the old number together with the old value, so a result that fits again is welcome again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Stamp {
    /// The loaded part of each role.
    pub parts: PerRole<u64>,
    /// The pose of the stamped part.
    pub pose: u64,
}

/// A recorded reduction and how far down it was to go.
pub struct Recording {
    /// Every level from full down.
    pub levels: Levels,
    /// The ceiling the recording aimed at.
    pub down_to: usize,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("down_to", &self.down_to)
            .finish_non_exhaustive()
    }
}

/// A level with what was measured about it.
#[derive(Debug, Clone)]
pub struct MeasuredLevel {
    /// The ceiling that was asked for.
    pub max_triangles: usize,
    /// Mesh and report of the reduction.
    pub level: Level,
    /// Measured distance to the full mesh; comes a moment later, because a slider does not wait.
    pub deviation: OnceLock<Deviation>,
}

/// Input of the measurement of a level.
#[derive(Debug, Clone)]
pub struct MeasureLevelInput {
    /// Which part it is.
    pub role: Role,
    /// Where the level was taken from.
    pub recording: Arc<Recording>,
    /// The reduced mesh with its measured distances.
    pub level: Arc<MeasuredLevel>,
}

/// Input of a reduction.
#[derive(Debug, Clone)]
pub struct ReduceInput {
    /// Which part it is.
    pub role: Role,
    /// The part the level belongs to.
    pub part: Arc<LoadedPart>,
    /// The recording made before, if there is one; makes any level cheap.
    pub recording: Option<Arc<Recording>>,
    /// Ceiling of the number of triangles.
    pub max_triangles: usize,
}

/// Input of an alignment or a match.
#[derive(Debug, Clone)]
pub struct MatchInput {
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// The levels the search runs on; `None` where nothing is reduced.
    pub reduced: Option<ReducedPair>,
    /// Settings of the match.
    pub recipe: MatchRecipe,
    /// The pose the stamped part has now.
    pub current: Similarity,
}

/// Input of a sweep.
#[derive(Debug, Clone)]
pub struct SweepInput {
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// Levels and settings.
    pub settings: SweepSettings,
    /// Where each row goes as soon as it is measured.
    pub rows: SweepRows,
}

/// Input of a new verdict.
#[derive(Debug, Clone)]
pub struct VerdictInput {
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// The match that is assessed.
    pub run: Arc<MatchRun>,
    /// The tolerance, in length units of the crash part; 0 for the automatic one.
    pub shape_tolerance: f64,
}

/// Input of a measurement.
#[derive(Debug, Clone)]
pub struct MeasureInput {
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// Where the source lies.
    pub crash_from_stamped: Similarity,
    /// Settings of the match that this pose is an alternative of, which is compared in its shape too.
    pub alternative_of: Option<Box<MatchSettings>>,
}

/// What was measured at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Distances and overlap.
    pub coverage: Coverage,
    /// What is said of an alternative, with the shape tolerance that was asked for (0 for the automatic one).
    pub alternative: Option<(f64, AlternativeStatements)>,
}

/// Input of a comparison.
#[derive(Debug, Clone)]
pub struct CompareInput {
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// The levels that are shown.
    pub levels: PerRole<Option<Arc<TriMesh>>>,
    /// Where the source lies.
    pub crash_from_stamped: Similarity,
}

/// A further stamped file to be read.
#[derive(Debug, Clone)]
pub struct FurtherInput {
    /// The number it is to have.
    pub revision: u64,
    /// The number of the file that it takes the place of, where one is read again.
    pub replaces: Option<u64>,
    /// Where it lies.
    pub file: PathBuf,
    /// Unit and chosen parts.
    pub settings: LoadSettings,
}

/// Input of the match of a further stamped file.
#[derive(Debug, Clone)]
pub struct PlaceInput {
    /// Number of the file.
    pub revision: u64,
    /// Number of the crash part.
    pub crash_revision: u64,
    /// The two parts.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// What its lengths are to be multiplied by.
    pub length_factor: f64,
    /// How it is matched; `None` if it lies as the first stamped part does.
    pub recipe: Option<MatchRecipe>,
}

/// Input of a mapping.
#[derive(Debug, Clone)]
pub struct MapInput {
    /// The crash part, and the first of the stamped ones.
    pub parts: PerRole<Arc<LoadedPart>>,
    /// Quantities, method, limits.
    pub recipe: MapRecipe,
    /// Where the stamped part lies, and where this pose comes from.
    pub pose: (Similarity, PoseOrigin),
    /// Further stamped files with their poses.
    pub further: Vec<(Arc<LoadedPart>, (Similarity, PoseOrigin))>,
}

/// Input of a comparison of a mapping with another mapper's result.
#[derive(Debug, Clone)]
pub struct CompareMappingInput {
    /// The mapping.
    pub run: Arc<MapRun>,
    /// The part it was mapped onto.
    pub crash: Arc<LoadedPart>,
    /// The other result.
    pub file: PathBuf,
}

/// Everything the worker can do. A closed list, so that jobs can be listed, logged and tested.
#[derive(Debug, Clone)]
pub enum JobKind {
    /// Reads a part.
    Load {
        /// Which part it is meant to be.
        role: Role,
        /// Where it comes from.
        source: PartSource,
        /// Units and chosen parts.
        settings: LoadSettings,
    },
    /// Makes the surface of a part again from the model in memory.
    Reselect {
        /// Which part it is.
        role: Role,
        /// The part as it is.
        part: Arc<LoadedPart>,
        /// What is to be taken.
        settings: LoadSettings,
    },
    /// Reduces a part to a maximum number of triangles.
    Reduce(ReduceInput),
    /// Measures how far a level lies from the full mesh.
    MeasureLevel(MeasureLevelInput),
    /// First poses, surface normal on surface normal.
    Align(MatchInput),
    /// Matches the two parts.
    Match(MatchInput),
    /// Finds the parts of the crash model that the stamped part belongs to.
    FindParts(MatchInput),
    /// Judges a match with another tolerance.
    Verdict(VerdictInput),
    /// Distances and overlap at a pose.
    Measure(MeasureInput),
    /// Deviation of every node.
    Compare(CompareInput),
    /// Reads a further stamped file.
    LoadFurther(FurtherInput),
    /// Finds the pose of a further stamped file.
    PlaceFurther(PlaceInput),
    /// Forming results onto the crash part.
    Map(MapInput),
    /// Another mapper's result beside the mapping.
    CompareMapping(CompareMappingInput),
    /// The overlap at a pose, from few points.
    Overlap(MeasureInput),
    /// Levels × match.
    Sweep(SweepInput),
    /// Reads a project with its parts.
    OpenProject(ProjectRequest),
    /// Writes outputs.
    Export(ExportRequest),
}

impl JobKind {
    /// The place in the queue.
    pub fn key(&self) -> JobKey {
        match self {
            Self::Load { role, .. } => JobKey::Load(*role),
            Self::Reselect { role, .. } => JobKey::Reselect(*role),
            Self::Reduce(input) => JobKey::Reduce(input.role),
            Self::MeasureLevel(input) => JobKey::MeasureLevel(input.role),
            Self::Align(_) => JobKey::Align,
            Self::Match(_) | Self::FindParts(_) => JobKey::Match,
            Self::Verdict(_) => JobKey::Verdict,
            Self::Measure(_) => JobKey::Measure,
            Self::Compare(_) => JobKey::Compare,
            Self::LoadFurther(input) => JobKey::LoadFurther(input.revision),
            Self::PlaceFurther(_) => JobKey::PlaceFurther,
            Self::Map(_) => JobKey::Map,
            Self::CompareMapping(_) => JobKey::CompareMapping,
            Self::Overlap(_) => JobKey::Overlap,
            Self::Sweep(_) => JobKey::Sweep,
            Self::OpenProject(_) => JobKey::OpenProject,
            Self::Export(request) => JobKey::Export(request.number),
        }
    }
}

/// Parts of the crash model that the stamped part belongs to.
#[derive(Debug, Clone)]
pub struct FoundCrash {
    /// The crash part with these chosen.
    pub part: Arc<LoadedPart>,
    /// What is reported of it.
    pub facts: Arc<PartFacts>,
    /// Ids of others that fit about as well.
    pub rivals: Vec<u64>,
    /// The match that found them.
    pub run: Arc<MatchRun>,
}

/// What a finished job brings.
#[derive(Debug, Clone)]
pub enum JobOutput {
    /// A project was read, with its parts or with the names of those that are missing.
    ProjectOpened(Box<OpenedProject>),
    /// A part was read.
    Loaded {
        /// Which part it was meant to be.
        role: Role,
        /// Where it came from.
        source: PartSource,
        /// The part as it was read.
        part: Arc<LoadedPart>,
        /// What the window shows about it.
        facts: Arc<PartFacts>,
    },
    /// Other elements were taken from a file that was read before.
    Reselected {
        /// Which part it is.
        role: Role,
        /// The part of these elements.
        part: Arc<LoadedPart>,
        /// What the window shows about it.
        facts: Arc<PartFacts>,
    },
    /// A part was reduced.
    Reduced {
        /// Side that was reduced.
        role: Role,
        /// For the next level.
        recording: Arc<Recording>,
        /// The reduced mesh with its measured distances.
        level: Arc<MeasuredLevel>,
    },
    /// The deviation of a level is now known.
    LevelMeasured {
        /// Side that was recorded.
        role: Role,
        /// The level that was measured.
        level: Arc<MeasuredLevel>,
    },
    /// First poses, in the order they are tried.
    Aligned(Arc<Vec<Start>>),
    /// The match ended, by itself or stopped.
    Matched(Arc<MatchRun>),
    /// The parts of the crash model that the stamped part belongs to; none if no match says so.
    PartsFound(Option<FoundCrash>),
    /// The match with its new verdict.
    Judged(Arc<MatchRun>),
    /// Distances and overlap.
    Measured(Arc<Measurement>),
    /// Deviation of every node.
    Compared(Arc<Comparison>),
    /// A further stamped file was read.
    FurtherLoaded {
        /// The number it is to have.
        revision: u64,
        /// The number of the file that it takes the place of.
        replaces: Option<u64>,
        /// The part as it was read.
        part: Arc<LoadedPart>,
    },
    /// The pose of a further stamped file.
    FurtherPlaced {
        /// Number of the file.
        revision: u64,
        /// Number of the crash part.
        crash_revision: u64,
        /// The part in the unit it was asked for.
        part: Arc<LoadedPart>,
        /// The match, if one was asked for.
        run: Option<Arc<MatchRun>>,
    },
    /// Forming results onto the crash part.
    Mapped {
        /// Values, statuses, checks.
        run: Arc<MapRun>,
        /// The same in figures.
        record: Arc<MapRecord>,
        /// Elements to look at.
        lists: Arc<ElementLists>,
        /// The stamped parts that it was made from beside the first one.
        further: Vec<Arc<LoadedPart>>,
    },
    /// Another mapper's result was read.
    MappingCompared {
        /// The mapping it was compared with.
        run: Arc<MapRun>,
        /// Its values.
        other: Arc<OtherResult>,
        /// The differences in figures.
        record: Box<ComparisonRecord>,
    },
    /// The overlap from few points.
    Overlapped {
        /// The part that is covered better.
        of: Role,
        /// Share of its area.
        overlap: f64,
        /// Distance up to which a place counts as covered.
        limit: f64,
    },
    /// The tables of the benchmark.
    Swept(Arc<Sweep>),
    /// Something was written, or is ready for the clipboard.
    Exported(Exported),
}
