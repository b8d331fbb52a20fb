//! How often the match is right and the verdict honest, over pairs that nothing was tuned to: random
//! shapes of every sample part under every disturbance.

use std::time::Instant;

use crate::assess::{self, AssessSettings, Assessment, PoseKind, ShapeKind, Verdict};
use crate::geometry::Similarity;
use crate::monitor::Monitor;
use crate::pipeline::{PipelineError, millis_since};
use crate::registration::{self, MatchInput, MatchSettings, Surface};
use crate::samples::SamplePart;
use crate::samples::scenario::{Scenario, ScenarioPair};
use crate::search::ClosestPoint as _;
use crate::settling::settle;
use crate::text::Lengths;

/// What is run.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustnessSettings {
    /// Chooses shapes, placements and disturbances.
    pub seed: u64,
    /// Runs of every scenario on every part.
    pub n_runs: usize,
    /// Sample parts to take.
    pub parts: Vec<SamplePart>,
    /// Disturbances to apply.
    pub scenarios: Vec<Scenario>,
    /// The settings of every match.
    pub settings: MatchSettings,
}

impl Default for RobustnessSettings {
    fn default() -> Self {
        Self {
            seed: 1,
            n_runs: 1,
            parts: SamplePart::ALL.to_vec(),
            scenarios: Scenario::ALL.to_vec(),
            settings: MatchSettings::default(),
        }
    }
}

/// Where a match ended, seen from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// At the true pose.
    Right,
    /// At another pose under which the smaller part lies as well as under the true one.
    Twin,
    /// At a wrong pose.
    Wrong,
    /// No pose is true: the shapes differ.
    NoTruth,
}

impl Ending {
    /// The word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Twin => "twin",
            Self::Wrong => "wrong",
            Self::NoTruth => "no truth",
        }
    }
}

/// One match with its known answer.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustnessRun {
    /// What was changed.
    pub scenario: Scenario,
    /// Sample part it was made from.
    pub part: SamplePart,
    /// Seed of the pair.
    pub seed: u64,
    /// Where it ended.
    pub ending: Ending,
    /// Verdict of the match.
    pub verdict: Verdict,
    /// The first reason of the verdict.
    pub reason: String,
    /// The statement about the pose.
    pub pose: Option<PoseKind>,
    /// The statement about the shape.
    pub shape: Option<ShapeKind>,
    /// How far the worst stamped node lies from its true place; `None` without truth.
    pub node_error: Option<f64>,
    /// The stated uncertainty of the pose.
    pub uncertainty: Option<f64>,
    /// An offset of the sheets that cannot be told from a shift; 0 where it can.
    pub hidden_offset: f64,
    /// Starts that were run.
    pub n_starts: usize,
    /// Time of surfaces, match and assessment in milliseconds.
    pub time_ms: f64,
}

/// The stated uncertainty holds if the error is within so many times it.
pub const COVERAGE: f64 = 3.0;

impl RobustnessRun {
    /// Whether the error lies within three times the statement plus an offset that cannot be told from
    /// a shift; `None` where the pose is not right or nothing was stated.
    pub fn is_covered(&self) -> Option<bool> {
        if self.ending != Ending::Right {
            return None;
        }
        Some(self.node_error? <= COVERAGE * self.uncertainty? + self.hidden_offset)
    }
}

/// Makes all pairs and matches them one after the other, so that their times compare. `each` is told
/// every run as it ends. Cancelling ends with an error, stopping with the runs so far.
pub fn robustness(
    settings: &RobustnessSettings,
    monitor: &Monitor,
    mut each: impl FnMut(&RobustnessRun),
) -> Result<Vec<RobustnessRun>, PipelineError> {
    let n_cases = settings.scenarios.len() * settings.parts.len() * settings.n_runs;
    let mut runs = Vec::with_capacity(n_cases);
    for &scenario in &settings.scenarios {
        for &part in &settings.parts {
            for k in 0..settings.n_runs as u64 {
                monitor.check()?;
                if monitor.stop_requested() {
                    return Ok(runs);
                }
                monitor.progress("robustness", runs.len() as u64, Some(n_cases as u64));
                let seed = settings.seed.wrapping_mul(1000).wrapping_add(k);
                let pair = scenario.pair(part, seed);
                let run = run_one(scenario, part, seed, &pair, &settings.settings)?;
                each(&run);
                runs.push(run);
            }
        }
    }
    Ok(runs)
}

fn run_one(
    scenario: Scenario,
    part: SamplePart,
    seed: u64,
    pair: &ScenarioPair,
    settings: &MatchSettings,
) -> Result<RobustnessRun, PipelineError> {
    let silent = Monitor::silent();
    let begin = Instant::now();
    let (target, source) = rayon::join(
        || Surface::new(&pair.crash, "target"),
        || Surface::new(&pair.stamped, "source"),
    );
    let (target, source) = (target?, source?);
    let input = MatchInput {
        source: &source,
        target: &target,
        reduced: None,
    };
    let mut outcome = registration::match_surfaces(&input, settings, &silent)?;
    let check = AssessSettings {
        allowance: settings.allowance,
        thickness: Some(pair.thickness),
        ..AssessSettings::default()
    };
    settle(&mut outcome, [&source, &target], settings, &check, &silent)?;
    let assessment = assess::assess(&source, &target, &outcome, &check, &silent)?;
    let time_ms = millis_since(begin);
    let truth = pair.crash_from_stamped.as_ref();
    let found = &outcome.target_from_source;
    let node_error = truth.map(|truth| node_error(&source, found, truth));
    let ending = match (truth, node_error) {
        (Some(truth), Some(error)) => ending(pair, [&source, &target], [found, truth], error),
        _ => Ending::NoTruth,
    };
    Ok(RobustnessRun {
        scenario,
        part,
        seed,
        ending,
        verdict: assessment.verdict,
        reason: assessment
            .sentences(Lengths::default())
            .into_iter()
            .next()
            .unwrap_or_default(),
        shape: assessment.shape.as_ref().map(|shape| shape.kind),
        node_error,
        uncertainty: assessment.uncertainty().map(|u| u.largest),
        pose: assessment.pose.as_ref().map(|pose| pose.kind),
        hidden_offset: hidden_offset(&assessment, pair),
        n_starts: outcome.starts.len(),
        time_ms,
    })
}

fn hidden_offset(assessment: &Assessment, pair: &ScenarioPair) -> f64 {
    let separable = assessment
        .shape
        .as_ref()
        .is_some_and(|s| s.is_offset_separable);
    if separable {
        0.0
    } else {
        0.5 * pair.offset.abs()
    }
}

/// Largest distance of a source node from its true place.
fn node_error(source: &Surface, found: &Similarity, truth: &Similarity) -> f64 {
    let nodes = source.mesh().positions().iter();
    nodes
        .map(|p| (found.apply(p) - truth.apply(p)).norm())
        .fold(0.0, f64::max)
}

/// A pose is the true one within this many millimetres, this share of the diagonal, and what the
/// disturbance may move it by.
const RIGHT_MM: f64 = 1.0;
const RIGHT_SHARE: f64 = 0.004;
const RIGHT_DISTURBANCE: f64 = 1.5;

fn ending(
    pair: &ScenarioPair,
    [source, target]: [&Surface; 2],
    [found, truth]: [&Similarity; 2],
    error: f64,
) -> Ending {
    let diagonal = source.measures().diagonal;
    let limit = RIGHT_MM.max(RIGHT_SHARE * diagonal) + RIGHT_DISTURBANCE * pair.disturbance;
    if error <= limit {
        return Ending::Right;
    }
    let [here, there] = [found, truth].map(|pose| smaller_part_distance(source, target, pose));
    if here <= 1.2 * there + 0.1 {
        Ending::Twin
    } else {
        Ending::Wrong
    }
}

/// Distance that 99 % of the smaller part's nodes do not exceed. Its border counts too: where it leaves the
/// larger part, distances grow.
fn smaller_part_distance(source: &Surface, target: &Surface, pose: &Similarity) -> f64 {
    let of_source = source.measures().area <= target.measures().area;
    let back = pose.inverse();
    let (data, model, pose) = if of_source {
        (source, target, pose)
    } else {
        (target, source, &back)
    };
    let positions = data.mesh().positions();
    let step = positions.len().div_ceil(4000).max(1);
    let distance = |p| {
        model
            .bvh()
            .closest(&pose.apply(p), f64::INFINITY, None, None)
    };
    let mut distances: Vec<f64> = positions
        .iter()
        .step_by(step)
        .filter_map(|p| Some(distance(p)?.distance_sq.sqrt()))
        .collect();
    distances.sort_unstable_by(f64::total_cmp);
    let at = (0.99 * distances.len() as f64) as usize;
    distances.get(at).copied().unwrap_or(f64::INFINITY)
}
