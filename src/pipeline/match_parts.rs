//! The match of two loaded parts, and whether it can be trusted.

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::load::LoadedPart;
use super::reduce::Levels;
use super::units::are_in_one_unit;
use super::{PipelineError, millis_since};
use crate::assess::{self, AlternativeStatements, AssessSettings, Assessment};
use crate::geometry::serial::shared;
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::registration::starts::{self, Start};
use crate::registration::{
    self, MatchInput, MatchMonitor, MatchOutcome, MatchSettings, Motion, StartMethod,
    StartSettings, Surface,
};
use crate::role::{PerRole, Role};
pub use crate::settings::MatchRecipe;
use crate::settling;
use crate::simplify::SimplifySettings;
use crate::units::LengthUnit;

/// Durations of the steps in milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct MatchTimes {
    /// Matches on other crash parts while the one was looked for that the stamped part belongs to; 0 where it was
    /// given.
    pub find_ms: f64,
    /// Reduction of both parts; 0 if nothing was reduced here.
    pub reduce_ms: f64,
    /// Trees and normals, and the first poses.
    pub align_ms: f64,
    /// All starts, and the finish of the winner.
    pub match_ms: f64,
    /// Borders, holes and bends on the full meshes.
    pub settle_ms: f64,
    /// The independent check.
    pub verify_ms: f64,
    /// Time of the whole run in milliseconds.
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
    /// Maximum number of triangles each mesh was reduced to for the starts; `None` for a full mesh.
    #[serde(serialize_with = "PerRole::as_list")]
    pub max_triangles: PerRole<Option<usize>>,
    /// Triangles of the meshes the starts ran on.
    #[serde(serialize_with = "PerRole::as_list")]
    pub n_triangles: PerRole<usize>,
    /// Time of each phase.
    pub times: MatchTimes,
    /// The alternative of the match that this is the run of, as [`with_alternative`] makes it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alternative: Option<usize>,
    /// Ids of crash parts that were tried too and that the stamped part fits about as well.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub alike_parts: Vec<u64>,
}

impl MatchRun {
    /// The same where the stamped part fits other crash parts, with these ids, about as well.
    #[must_use]
    pub fn beside_alike_parts(mut self, ids: &[u64]) -> Self {
        let assessment = Arc::unwrap_or_clone(self.assessment);
        self.assessment = Arc::new(assessment.beside_alike_parts(ids));
        self.alike_parts = ids.to_vec();
        self
    }

    /// Its best pose, or one of its alternatives.
    pub fn pose(&self, alternative: Option<usize>) -> Option<Similarity> {
        match alternative {
            None => Some(self.crash_from_stamped),
            Some(index) => {
                let found = self.outcome.alternatives.get(index);
                found.map(|alternative| alternative.target_from_source)
            }
        }
    }

    /// Where it is the run of an alternative: "pose 2 of the match, not the best (with that, error 3 % lower)".
    pub fn told_alternative(&self) -> Option<String> {
        let number = self.alternative? + 2;
        let best = self.outcome.alternatives.first()?;
        let which = if best.by_shape {
            "which is"
        } else {
            "with that,"
        };
        let fit = assess::fit_beside(best.score_ratio, best.by_shape);
        Some(format!(
            "pose {number} of the match, not the best ({which} {fit})"
        ))
    }
}

/// Meshes of both parts at a level of reduction that is at hand already.
#[derive(Debug, Clone)]
pub struct ReducedPair {
    /// Meshes the match ran on.
    pub meshes: PerRole<Arc<TriMesh>>,
    /// Maximum number of triangles each was reduced to; `None` for a full mesh.
    pub max_triangles: PerRole<Option<usize>>,
}

impl ReducedPair {
    /// Reduces both parts to their maximum number of triangles; a part without one stays as it is.
    pub fn new(
        parts: PerRole<&LoadedPart>,
        max_triangles: PerRole<Option<usize>>,
        monitor: &Monitor,
    ) -> Result<Self, PipelineError> {
        let level = |role| level(parts.get(role), *max_triangles.get(role), monitor);
        Ok(Self {
            meshes: PerRole::from_fn(level).transpose()?,
            max_triangles,
        })
    }
}

/// Finds the pose of the stamped part on the crash part, and checks it on the full meshes.
///
/// `current` is the pose of the stamped part now; a recipe that starts from the current pose starts
/// there. `reduced` are the levels shown in the window; without them the recipe says whether to
/// reduce. A stop request keeps the best pose so far and still checks it.
pub fn match_parts<'a>(
    parts: PerRole<&LoadedPart>,
    reduced: Option<&ReducedPair>,
    recipe: &MatchRecipe,
    current: &Similarity,
    monitor: impl Into<MatchMonitor<'a>>,
) -> Result<MatchRun, PipelineError> {
    let match_monitor = monitor.into();
    let monitor = match_monitor.monitor;
    let begin = Instant::now();
    let mut times = MatchTimes::default();
    let made;
    let reduced = match (reduced, recipe.max_triangles) {
        (Some(pair), _) => Some(pair),
        (None, Some(n)) => {
            made = ReducedPair::new(parts, PerRole::both(Some(n)), monitor)?;
            times.reduce_ms = millis_since(begin);
            Some(&made)
        }
        (None, None) => None,
    };
    let prepare = Instant::now();
    monitor.progress("align", 0, None);
    let (target, source) = (&parts.crash.surface, &parts.stamped.surface);
    let small = reduced
        .map(|pair| small_surfaces(parts, pair, monitor))
        .transpose()?;
    monitor.check()?;
    let prepare_ms = millis_since(prepare);
    let input = MatchInput {
        source,
        target,
        reduced: small.as_ref().map(|small| (&*small.stamped, &*small.crash)),
    };
    let settings = with_current_pose(&recipe.settings, current);
    monitor.progress("match", 0, None);
    let mut outcome = registration::match_surfaces(&input, &settings, match_monitor)?;
    let check = assess_settings(parts, &settings);
    // The tolerance of the verdict moves no pose: one that is judged anew is that of a new match.
    let placing = AssessSettings {
        shape_tolerance: None,
        ..check
    };
    monitor.check()?;
    let begin_settle = Instant::now();
    settling::settle(&mut outcome, [source, target], &settings, &placing, monitor)?;
    times.settle_ms = millis_since(begin_settle);
    monitor.check()?;
    times.align_ms = prepare_ms + outcome.timings.align.as_secs_f64() * 1e3;
    times.match_ms = (outcome.timings.total - outcome.timings.align).as_secs_f64() * 1e3;
    let verify = Instant::now();
    monitor.progress("verify", 0, None);
    let assessment = assess::assess(source, target, &outcome, &check, monitor)?;
    times.verify_ms = millis_since(verify);
    times.total_ms = millis_since(begin);
    Ok(MatchRun {
        crash_from_stamped: outcome.target_from_source,
        recipe: recipe.clone(),
        start_pose: *current,
        max_triangles: reduced.map_or(PerRole::both(None), |pair| pair.max_triangles),
        n_triangles: input.reduced.map_or_else(
            || parts.map(|part| part.mesh.n_triangles()),
            |(source, target)| {
                PerRole::new(target, source).map(|surface| surface.mesh().n_triangles())
            },
        ),
        outcome: Arc::new(outcome),
        assessment: Arc::new(assessment),
        times,
        alternative: None,
        alike_parts: Vec::new(),
    })
}

/// The run with another of its poses as the result, measured anew on the full meshes.
pub fn with_alternative(
    run: &MatchRun,
    alternative: usize,
    parts: PerRole<&LoadedPart>,
    monitor: &Monitor,
) -> Result<MatchRun, PipelineError> {
    let mut outcome = MatchOutcome::clone(&run.outcome);
    let Some(other) = outcome.alternatives.get_mut(alternative) else {
        return Ok(run.clone());
    };
    let (ratio, by_shape) = (other.score_ratio, other.by_shape);
    let best = outcome.target_from_source;
    outcome.target_from_source = std::mem::replace(&mut other.target_from_source, best);
    other.score_ratio = 1.0;
    // The best pose comes first, also before others that fit as well.
    outcome.alternatives[..=alternative].rotate_right(1);
    for other in &mut outcome.alternatives {
        other.score_ratio /= ratio;
        other.by_shape |= by_shape;
    }
    outcome
        .alternatives
        .sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    let hand = &mut outcome.mirror_check;
    if !hand.by_borders {
        hand.score_ratio = hand.score_ratio.map(|of_hand| of_hand / ratio);
    }
    let (target, source) = (&parts.crash.surface, &parts.stamped.surface);
    let check = assess_settings(parts, &run.recipe.settings);
    let assessment = assess::assess(source, target, &outcome, &check, monitor)?;
    Ok(MatchRun {
        crash_from_stamped: outcome.target_from_source,
        outcome: Arc::new(outcome),
        assessment: Arc::new(assessment.beside_alike_parts(&run.alike_parts)),
        alternative: Some(alternative),
        ..run.clone()
    })
}

/// The run assessed again with another shape tolerance (crash length units, 0 for the automatic one) on the
/// full meshes. Nothing is searched: a match with that tolerance finds the same pose.
pub fn judged_anew(
    run: &MatchRun,
    shape_tolerance: f64,
    parts: PerRole<&LoadedPart>,
    monitor: &Monitor,
) -> Result<MatchRun, PipelineError> {
    let mut recipe = run.recipe.clone();
    recipe.settings.shape_tolerance = shape_tolerance;
    let (target, source) = (&parts.crash.surface, &parts.stamped.surface);
    let check = assess_settings(parts, &recipe.settings);
    let assessment = assess::assess(source, target, &run.outcome, &check, monitor)?;
    Ok(MatchRun {
        recipe,
        assessment: Arc::new(assessment.beside_alike_parts(&run.alike_parts)),
        ..run.clone()
    })
}

/// What is said of an alternative of a match with these settings.
pub fn alternative_statements(
    parts: PerRole<&LoadedPart>,
    settings: &MatchSettings,
    crash_from_stamped: &Similarity,
) -> AlternativeStatements {
    let (target, source) = (&parts.crash.surface, &parts.stamped.surface);
    let check = assess_settings(parts, settings);
    assess::assess_alternative(source, target, crash_from_stamped, &check)
}

/// What the assessment of a match of these parts depends on.
fn assess_settings(parts: PerRole<&LoadedPart>, settings: &MatchSettings) -> AssessSettings {
    let crash = parts.crash;
    let unit = crash.units().and_then(|known| {
        // The crash part's lengths were multiplied by its factor when it was read.
        known.units.length.times(1.0 / crash.settings.length_factor)
    });
    let known = crash.units().map(|known| known.units.length);
    let millimetre = unit
        .or(known)
        .map(|unit| LengthUnit::Millimeter.factor_to(unit));
    let thickness = crash.mean_thickness().or(parts.stamped.mean_thickness());
    AssessSettings {
        allowance: settings.allowance,
        thickness,
        shape_tolerance: Some(settings.shape_tolerance).filter(|t| *t > 0.0),
        millimetre,
        remove_offset: settings.remove_offset,
        is_one_unit: are_in_one_unit(parts),
        is_scale_free: settings.motion == Motion::Similarity,
        n_target_parts: crash.chosen_part_ids().len(),
        n_source_errors: parts.stamped.model.diagnostics.n_geometry_errors(),
        n_target_errors: crash.model.diagnostics.n_geometry_errors(),
        ..AssessSettings::default()
    }
}

/// The first poses of "Align surface normals": centroids and mean normals aligned, both signs,
/// rotated in steps. Each is `crash_from_stamped`.
pub fn align(
    parts: PerRole<&LoadedPart>,
    settings: &StartSettings,
) -> Result<Vec<Start>, PipelineError> {
    let settings = StartSettings {
        method: StartMethod::SurfaceNormals,
        ..settings.clone()
    };
    Ok(starts::starts(
        &parts.stamped.surface,
        &parts.crash.surface,
        &settings,
    )?)
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
    Ok(levels.level(n, monitor)?.mesh)
}

/// Prepared surfaces of the reduced meshes; a part that is not reduced has its own already.
fn small_surfaces(
    parts: PerRole<&LoadedPart>,
    pair: &ReducedPair,
    monitor: &Monitor,
) -> Result<PerRole<Arc<Surface>>, PipelineError> {
    let surface = |role, side| -> Result<Arc<Surface>, PipelineError> {
        match pair.max_triangles.get(role) {
            None => Ok(Arc::clone(&parts.get(role).surface)),
            Some(_) => {
                let mesh = pair.meshes.get(role);
                Ok(Arc::new(Surface::build(mesh, side, monitor)?))
            }
        }
    };
    let (crash, stamped) = rayon::join(
        || surface(Role::Crash, "target"),
        || surface(Role::Stamped, "source"),
    );
    Ok(PerRole::new(crash?, stamped?))
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
