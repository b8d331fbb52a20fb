use serde::{Deserialize, Serialize};
use std::time::Duration;

use super::starts::StartKind;
use super::termination::Termination;
use super::units::ScaleCheck;
use crate::geometry::Similarity;
use crate::geometry::serial::any_float;
pub use crate::monitor::Fate;
use crate::monitor::IterationReport;

/// Which of the two meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The moving (stamped) mesh.
    Source,
    /// The fixed (crash) mesh.
    Target,
}

/// A word that is known beforehand. The name keeps serde from borrowing it from its input.
type StageWord = &'static str;

/// One iteration of one start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct IterationRecord {
    /// Stage of the search in one word: `race`, `refine`, `finish`, `match`.
    #[serde(deserialize_with = "stage_word")]
    pub stage: StageWord,
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

/// The words for stages; any other that was stored is not told apart.
fn stage_word<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<StageWord, D::Error> {
    let stored = String::deserialize(deserializer)?;
    let known = ["race", "refine", "finish", "match"];
    let found = known.into_iter().find(|word| *word == stored);
    Ok(found.unwrap_or("match"))
}

impl IterationRecord {
    pub(crate) fn report(&self, start_idx: usize, iteration: usize) -> IterationReport {
        IterationReport {
            start_idx,
            iteration,
            target_from_source: self.target_from_source.to_rows(),
            objective: self.objective,
            rmse: self.rmse,
            fraction: self.fraction,
        }
    }
}

/// The story of one start.
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
    /// Last pose.
    pub last: Similarity,
    /// Every iteration, in order.
    pub iterations: Vec<IterationRecord>,
    /// Objective of the last iteration.
    #[serde(with = "any_float")]
    pub score: f64,
    /// Distance that 95 % of its last kept pairs stay below.
    #[serde(with = "any_float")]
    pub p95: f64,
    /// Time its iterations took. For the reader; nothing depends on it.
    pub took: Duration,
    /// Why its last stage ended, if it was not dropped.
    pub termination: Option<Termination>,
    /// What became of it.
    pub fate: Fate,
}

impl StartRecord {
    /// How it came to be, in words: "surface normal 40°, stamped, turned".
    pub fn name(&self) -> String {
        start_name(self.kind, self.data_side, self.flipped, self.mirrored)
    }
}

/// See [`StartRecord::name`].
pub(crate) fn start_name(kind: StartKind, side: Side, flipped: bool, mirrored: bool) -> String {
    let side = match side {
        Side::Source => "stamped",
        Side::Target => "crash",
    };
    let mut name = format!("{}, {side}", kind.label());
    if flipped {
        name += ", turned";
    }
    if mirrored {
        name += ", mirrored";
    }
    name
}

/// A distinct pose that came close.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// The pose.
    pub target_from_source: Similarity,
    /// How much worse than the result, 1 = equally good; the larger one of both directions.
    #[serde(with = "any_float")]
    pub score_ratio: f64,
    /// The start it came from.
    pub start: usize,
}

/// What the pairs say about the opposite hand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MirrorCheck {
    /// Root mean square distance of the final pairs under the best mirrored motion; compare with
    /// the outcome's `rmse`. Equal for a flat part, which has no hand.
    #[serde(with = "any_float")]
    pub mirrored_rmse: f64,
    /// Score of the opposite hand relative to the result's: below 1 it fits better. From the mirror
    /// images of the result, or from a search of its own where the result was not certain. `None`
    /// where both hands competed anyway, or the match was stopped.
    pub score_ratio: Option<f64>,
}

/// How long the phases took. For the reader; nothing depends on them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct MatchTimings {
    /// First poses.
    pub align: Duration,
    /// All starts on few points.
    pub race: Duration,
    /// The best distinct ones on more points.
    pub refine: Duration,
    /// The winner on the full meshes.
    pub finish: Duration,
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
    /// Root mean square distance of the kept pairs, in target length units.
    #[serde(with = "any_float")]
    pub rmse: f64,
    /// Distance that 95 % of the kept pairs stay below.
    #[serde(with = "any_float")]
    pub p95: f64,
    /// Largest distance of a kept pair.
    #[serde(with = "any_float")]
    pub max: f64,
    /// Kept share of the data mesh's area.
    #[serde(with = "any_float")]
    pub fraction: f64,
    /// Which mesh supplied the points.
    pub data_side: Side,
    /// True if the source's normals point to the other side of the sheet than the target's.
    pub normals_opposed: bool,
    /// Objective at the end, in length units.
    #[serde(with = "any_float")]
    pub objective: f64,
    /// The floor σ0 of the last stage.
    #[serde(with = "any_float")]
    pub floor: f64,
    /// Distinct poses that were compared in the end, best first, without the result itself.
    pub alternatives: Vec<Alternative>,
    /// Every start.
    pub starts: Vec<StartRecord>,
    /// Index of the start that won.
    pub winner: usize,
    /// Do the sizes hint at different length units?
    pub scale_check: ScaleCheck,
    /// Would the opposite hand fit?
    pub mirror_check: MirrorCheck,
    /// Durations.
    pub timings: MatchTimings,
}
