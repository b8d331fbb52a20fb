//! The match of two loaded parts, and whether it can be trusted.

use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

use super::load::LoadedPart;
use super::reduce::Levels;
use super::{PipelineError, millis_since};
use crate::assess::{self, AssessSettings, Assessment};
use crate::geometry::serial::shared;
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::registration::starts::{self, Start};
use crate::registration::{
    self, MatchInput, MatchOutcome, MatchSettings, StartMethod, StartSettings, Surface,
};
use crate::simplify::SimplifySettings;

/// Everything a match depends on besides the two parts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MatchRecipe {
    /// Method and parameters.
    pub settings: MatchSettings,
    /// Reduce both parts to so many triangles for the search, as the paper does.
    pub max_triangles: Option<usize>,
}

/// Durations of the steps in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct MatchTimes {
    /// Reduction of both parts; 0 if nothing was reduced here.
    pub reduce_ms: f64,
    /// Trees and normals, and the first poses.
    pub align_ms: f64,
    /// All starts, and the finish of the winner.
    pub match_ms: f64,
    /// The independent check.
    pub verify_ms: f64,
    /// Everything together.
    pub total_ms: f64,
}

/// The result of a match.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MatchRun {
    /// `crash = c · R · stamped + t`.
    pub crash_from_stamped: Similarity,
    /// The recipe that gave it.
    pub recipe: MatchRecipe,
    /// Starts, iterations, alternatives.
    #[serde(with = "shared")]
    pub outcome: Arc<MatchOutcome>,
    /// Distances, overlap, ambiguity, verdict.
    #[serde(with = "shared")]
    pub assessment: Arc<Assessment>,
    /// The pose the stamped part had before.
    pub start_pose: Similarity,
    /// Ceilings that the crash and the stamped mesh were reduced to for the starts.
    pub max_triangles: [Option<usize>; 2],
    /// Triangles of the crash and the stamped mesh the starts ran on.
    pub n_triangles: [usize; 2],
    /// Durations.
    pub times: MatchTimes,
}

/// Meshes of both parts at a level of reduction that is at hand already.
#[derive(Debug, Clone)]
pub struct ReducedPair {
    /// The crash part.
    pub crash: Arc<TriMesh>,
    /// The stamped part.
    pub stamped: Arc<TriMesh>,
    /// Ceilings that the crash and the stamped mesh were reduced to; `None` for a full mesh.
    pub max_triangles: [Option<usize>; 2],
}

impl ReducedPair {
    /// Reduces both parts to their ceilings; a part without one stays as it is.
    pub fn new(
        crash: &LoadedPart,
        stamped: &LoadedPart,
        max_triangles: [Option<usize>; 2],
        monitor: &Monitor,
    ) -> Result<Self, PipelineError> {
        let [of_crash, of_stamped] = max_triangles;
        Ok(Self {
            crash: level(crash, of_crash, monitor)?,
            stamped: level(stamped, of_stamped, monitor)?,
            max_triangles,
        })
    }
}

/// Finds the pose of `stamped` on `crash`, and checks it on the full meshes.
///
/// `current` is the pose of the stamped part now; a recipe that starts from the current pose starts
/// there. `reduced` are the levels shown in the window; without them the recipe says whether to
/// reduce. A stop request keeps the best pose so far and still checks it.
pub fn match_parts(
    crash: &LoadedPart,
    stamped: &LoadedPart,
    reduced: Option<&ReducedPair>,
    recipe: &MatchRecipe,
    current: &Similarity,
    monitor: &Monitor,
) -> Result<MatchRun, PipelineError> {
    let begin = Instant::now();
    let mut times = MatchTimes::default();
    let made;
    let reduced = match (reduced, recipe.max_triangles) {
        (Some(pair), _) => Some(pair),
        (None, Some(n)) => {
            made = ReducedPair::new(crash, stamped, [Some(n); 2], monitor)?;
            times.reduce_ms = millis_since(begin);
            Some(&made)
        }
        (None, None) => None,
    };
    let prepare = Instant::now();
    monitor.progress("align", 0, None);
    let (target, source) =
        rayon::join(|| crash.surface_for_match(), || stamped.surface_for_match());
    let (target, source) = (target?, source?);
    let small = reduced.map(small_surfaces).transpose()?;
    monitor.check()?;
    let prepare_ms = millis_since(prepare);
    let input = MatchInput {
        source: &source,
        target: &target,
        reduced: small.as_ref().map(|[crash, stamped]| (stamped, crash)),
    };
    let settings = with_current_pose(&recipe.settings, current);
    monitor.progress("match", 0, None);
    let outcome = registration::match_surfaces(&input, &settings, monitor)?;
    times.align_ms = prepare_ms + outcome.timings.align.as_secs_f64() * 1e3;
    times.match_ms = (outcome.timings.total - outcome.timings.align).as_secs_f64() * 1e3;
    let check = AssessSettings {
        allowance: settings.allowance,
        ..AssessSettings::default()
    };
    let verify = Instant::now();
    monitor.progress("verify", 0, None);
    let assessment = assess::assess(&source, &target, &outcome, &check, monitor)?;
    times.verify_ms = millis_since(verify);
    times.total_ms = millis_since(begin);
    Ok(MatchRun {
        crash_from_stamped: outcome.target_from_source,
        recipe: recipe.clone(),
        start_pose: *current,
        max_triangles: reduced.map_or([None; 2], |pair| pair.max_triangles),
        n_triangles: input.reduced.map_or_else(
            || [crash.mesh.n_triangles(), stamped.mesh.n_triangles()],
            |(source, target)| [target.mesh().n_triangles(), source.mesh().n_triangles()],
        ),
        outcome: Arc::new(outcome),
        assessment: Arc::new(assessment),
        times,
    })
}

/// The run with another of its poses as the result, measured anew on the full meshes.
pub fn with_alternative(
    run: &MatchRun,
    alternative: usize,
    crash: &LoadedPart,
    stamped: &LoadedPart,
    monitor: &Monitor,
) -> Result<MatchRun, PipelineError> {
    let mut outcome = MatchOutcome::clone(&run.outcome);
    let Some(other) = outcome.alternatives.get_mut(alternative) else {
        return Ok(run.clone());
    };
    let ratio = other.score_ratio;
    let best = outcome.target_from_source;
    outcome.target_from_source = std::mem::replace(&mut other.target_from_source, best);
    other.score_ratio = 1.0;
    for other in &mut outcome.alternatives {
        other.score_ratio /= ratio;
    }
    outcome
        .alternatives
        .sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    let (target, source) = (crash.surface_for_match()?, stamped.surface_for_match()?);
    let check = AssessSettings {
        allowance: run.recipe.settings.allowance,
        ..AssessSettings::default()
    };
    let assessment = assess::assess(&source, &target, &outcome, &check, monitor)?;
    Ok(MatchRun {
        crash_from_stamped: outcome.target_from_source,
        outcome: Arc::new(outcome),
        assessment: Arc::new(assessment),
        ..run.clone()
    })
}

/// The first poses of "Align surface normal": centroids and mean normals laid on each other, both
/// signs, turned in steps. Each is `crash_from_stamped`.
pub fn align(
    crash: &LoadedPart,
    stamped: &LoadedPart,
    settings: &StartSettings,
) -> Result<Vec<Start>, PipelineError> {
    let target = crash.surface_for_match()?;
    let source = stamped.surface_for_match()?;
    let settings = StartSettings {
        method: StartMethod::SurfaceNormals,
        ..settings.clone()
    };
    Ok(starts::starts(&source, &target, &settings)?)
}

fn level(
    part: &LoadedPart,
    max_triangles: Option<usize>,
    monitor: &Monitor,
) -> Result<Arc<TriMesh>, PipelineError> {
    let Some(n) = max_triangles else {
        return Ok(Arc::clone(&part.mesh));
    };
    let levels = Levels::record(part, &SimplifySettings::to_triangles(n), monitor)?;
    Ok(levels.level(n).mesh)
}

/// Prepared surfaces of crash and stamped part.
fn small_surfaces(pair: &ReducedPair) -> Result<[Surface; 2], PipelineError> {
    let (crash, stamped) = rayon::join(
        || Surface::new(&pair.crash, "target"),
        || Surface::new(&pair.stamped, "source"),
    );
    Ok([crash?, stamped?])
}

/// The registration knows no current pose of a window, only poses that it is given.
fn with_current_pose(settings: &MatchSettings, current: &Similarity) -> MatchSettings {
    let mut settings = settings.clone();
    if settings.starts.method == StartMethod::CurrentPose {
        settings.starts.method = StartMethod::GivenPoses;
        settings.starts.poses = vec![*current];
    }
    settings
}
