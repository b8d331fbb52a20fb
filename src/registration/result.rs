//! The result of a match, and what became of its starts.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::icp::{Stage, Termination};
use super::multi_start::starts::StartKind;
use super::scale_check::ScaleCheck;
use crate::geometry::Similarity;
use crate::geometry::serial::{any_float, any_float_or_none};

/// Which of the two meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The moving mesh.
    Source,
    /// The fixed mesh.
    Target,
}

impl Side {
    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Source => Self::Target,
            Self::Target => Self::Source,
        }
    }

    /// With this side as the data, a pose of target from source as one of model from data, or the other way round.
    pub(crate) fn oriented(self, pose: &Similarity) -> Similarity {
        match self {
            Self::Source => *pose,
            Self::Target => pose.inverse(),
        }
    }
}

/// One iteration of one start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IterationRecord {
    /// Stage of the match it belongs to.
    pub stage: Stage,
    /// The pose whose pairs were measured, before the step.
    pub target_from_source: Similarity,
    /// What the selection minimises, in length units; comparable within one stage only.
    #[serde(with = "any_float")]
    pub objective: f64,
    /// Root mean square distance of the kept pairs.
    #[serde(with = "any_float")]
    pub rmse: f64,
    /// Share of the data area whose pairs were kept.
    #[serde(with = "any_float")]
    pub fraction: f64,
}

/// What became of a start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StartOutcome {
    /// It gave the result, or the pose that was settled to the result.
    Won,
    /// It went to the last comparison and lost to a better pose.
    RunnerUp,
    /// It met another start's pose and was dropped for it.
    MergedInto {
        /// Number of the other start, from 0.
        start: usize,
    },
    /// Others were ahead after so many iterations.
    Dropped {
        /// Number of iterations made.
        after: usize,
    },
    /// It found no pairs or its pairs fixed no motion.
    Failed,
}

/// One start: how it came to be, its iterations and what became of it. While it runs, scores are
/// infinite until its first iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StartRecord {
    /// How it came to be.
    pub kind: StartKind,
    /// True if the source's normals counted reversed.
    pub flipped: bool,
    /// True if the source was mirrored.
    pub mirrored: bool,
    /// Which mesh supplied the points.
    pub data_side: Side,
    /// First pose, `target_from_source`.
    pub first: Similarity,
    /// Where it ended, or where it is now.
    pub last: Similarity,
    /// Every iteration, in order.
    pub iterations: Vec<IterationRecord>,
    /// Objective of that pose.
    #[serde(with = "any_float")]
    pub score: f64,
    /// Distance that 95 % of its last kept pairs stay below; infinite while it runs.
    #[serde(with = "any_float")]
    pub p95: f64,
    /// Time its iterations took. For the reader; nothing depends on it.
    pub took: Duration,
    /// Why its last stage ended, if it was not dropped.
    pub termination: Option<Termination>,
    /// What became of it; `None` while it runs, or where its match was cancelled.
    pub outcome: Option<StartOutcome>,
}

impl StartRecord {
    /// Adds an iteration. A start that still runs is where its latest iteration is.
    pub fn add(&mut self, iteration: IterationRecord) {
        if self.outcome.is_none() {
            self.last = iteration.target_from_source;
            self.score = iteration.objective;
        }
        self.iterations.push(iteration);
    }
}

/// A distinct pose that came close.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// The best pose.
    pub target_from_source: Similarity,
    /// How much worse than the result, 1 = equally good; the larger one of both directions.
    #[serde(with = "any_float")]
    pub score_ratio: f64,
    /// Whether the ratio is what surfaces, borders and holes say on the full meshes, and no measured error.
    #[serde(default)]
    pub by_shape: bool,
    /// The start it came from.
    pub start: usize,
}

/// How well the opposite hand fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MirrorCheck {
    /// Score of the opposite hand relative to the result's: below 1 it fits better. From the mirror
    /// images of the result, or from a search of its own where the result was not certain. `None`
    /// where both hands competed anyway, or the match was stopped.
    #[serde(default, with = "any_float_or_none")]
    pub score_ratio: Option<f64>,
    /// Whether the ratio is what borders and holes say, where surfaces fit both hands, and no measured error.
    #[serde(default)]
    pub by_borders: bool,
    /// The pose of the opposite hand that this is the score of; it mirrors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target_from_source: Option<Similarity>,
}

/// How long the phases took. For the reader; nothing depends on them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct MatchTimings {
    /// Time to make the first poses.
    pub align: Duration,
    /// All starts on few points.
    pub coarse: Duration,
    /// The best distinct ones on more points.
    pub refine: Duration,
    /// The winner on the full meshes.
    pub full: Duration,
    /// Everything, preparation of mirrored and reduced meshes included.
    pub total: Duration,
}

/// The product of a match.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MatchOutcome {
    /// `target = c · R · source + t`.
    pub target_from_source: Similarity,
    /// Why the last stage ended.
    pub termination: Termination,
    /// Which mesh supplied the points.
    pub data_side: Side,
    /// The floor σ0 of the last stage.
    #[serde(with = "any_float")]
    pub floor: f64,
    /// Distinct poses that were compared in the end, best first, without the result itself.
    pub alternatives: Vec<Alternative>,
    /// True if the wide search and places of the larger part that are shaped alike were compared with
    /// the result; else other poses may fit as well.
    pub rivals_sought: bool,
    /// Where the last stage left pairs out, the pose that keeping all of them leads to from the result. Whoever
    /// assesses the result chooses between both.
    #[serde(skip)]
    pub with_all_pairs: Option<Similarity>,
    /// Every start, in the order of their numbers.
    pub starts: Vec<StartRecord>,
    /// Index of the start that won.
    pub winner: usize,
    /// Do the sizes hint at different length units?
    pub scale_check: ScaleCheck,
    /// Would the opposite hand fit?
    pub mirror_check: MirrorCheck,
    /// Time of each phase.
    pub timings: MatchTimings,
}
