use super::correspondence::{MatchRules, PairWith};
use super::icp::StageRules;
use super::metric::{Metric, StepRules};
use super::reject::RejectRules;
use super::select::{Floor, SelectRules, Selection};
use super::settings::MatchSettings;
use super::surface::Surface;
use super::umeyama::Motion;

/// The stages of a match.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// All starts, few points: a wide basin matters, exactness does not.
    Race,
    /// The best distinct ones.
    Refine,
    /// The winner, all points.
    Finish,
    /// A start run to its end: first the wide basin …
    Catch,
    /// … then the settings as given.
    Settle,
}

/// λ while catching (Phillips, Liu, Tomasi 2007: a first run with 3 widens the basin).
const CATCHING_LAMBDA: f64 = 3.0;
/// Floor while catching, as a share of the mean edge length.
const CATCHING_FLOOR: f64 = 0.1;
/// Least floor, as a share of the mean edge length: facets of a developable box have no chordal
/// error, but a floor of zero lets the fraction collapse.
const LEAST_FLOOR: f64 = 0.005;

/// σ0 that the settings ask for between these surfaces.
pub(crate) fn floor(settings: &MatchSettings, a: &Surface, b: &Surface) -> f64 {
    let chosen = match settings.selection {
        Selection::Fractional { floor, .. } => floor,
        Selection::TrimmedSearch => Floor::Auto,
        Selection::All | Selection::Trimmed { .. } => Floor::None,
    };
    match chosen {
        Floor::Auto => natural_floor(a, b) + settings.allowance,
        Floor::Length(length) => length + settings.allowance,
        Floor::None => 0.0,
    }
}

/// How far perfectly placed meshes lie apart because of their facets.
pub(crate) fn natural_floor(a: &Surface, b: &Surface) -> f64 {
    let chordal = a.measures().chordal_error.max(b.measures().chordal_error);
    chordal.max(LEAST_FLOOR * edge_length(a, b))
}

/// Mean edge length of the coarser of both.
pub(crate) fn edge_length(a: &Surface, b: &Surface) -> f64 {
    let (a, b) = (a.measures(), b.measures());
    a.mean_edge_length.max(b.mean_edge_length)
}

/// The rules of `stage` for these surfaces.
pub(crate) fn stage_rules(
    stage: Stage,
    settings: &MatchSettings,
    data: &Surface,
    model: &Surface,
) -> StageRules {
    let edge = edge_length(data, model);
    let floor = floor(settings, data, model);
    let catching = matches!(stage, Stage::Race | Stage::Catch);
    let second_order = settings.metric != Metric::PointToPoint;
    let on_triangles = settings.pair_with == PairWith::Triangle;
    let min_cos = settings.max_normal_angle_deg.to_radians().cos();
    let min_cos = if catching { min_cos.min(0.0) } else { min_cos };
    // Points beyond the rim pull towards it, which is right far away and wrong near the pose.
    let max_overhang = match stage {
        Stage::Finish if on_triangles => 0.1 * edge,
        Stage::Refine if on_triangles => edge,
        _ => f64::INFINITY,
    };
    let cap = match stage {
        Stage::Race => 20,
        Stage::Refine if second_order => 60,
        Stage::Finish if second_order => 10,
        _ => settings.max_iterations,
    };
    let tolerance = match stage {
        Stage::Race => 20.0,
        // On meshes that agree exactly the error after a step is about the square of the step, so
        // this ends at round-off; on others it is far below what the facets leave.
        Stage::Finish if second_order => 1e-2,
        Stage::Finish | Stage::Refine | Stage::Catch | Stage::Settle => 1.0,
    };
    StageRules {
        name: match stage {
            Stage::Race => "race",
            Stage::Refine => "refine",
            Stage::Finish => "finish",
            Stage::Catch => "catch",
            Stage::Settle => "settle",
        },
        matching: MatchRules {
            pair_with: settings.pair_with,
            reject: RejectRules {
                min_cos,
                max_distance: f64::INFINITY,
                max_overhang,
            },
            curved: on_triangles && !catching,
        },
        selection: SelectRules {
            // Point to point is still far from settled when the race ends.
            selection: catching_selection(
                settings.selection,
                catching || (stage == Stage::Refine && !second_order),
            ),
            floor: if catching && floor > 0.0 {
                floor.max(CATCHING_FLOOR * edge)
            } else {
                floor
            },
            max_fraction: (1.05 * model.measures().area / data.measures().area).min(1.0),
        },
        step: StepRules {
            metric: settings.metric,
            // Far from the pose a free scale shrinks the data until it lies anywhere on the model.
            motion: if stage == Stage::Race {
                Motion::Rigid
            } else {
                settings.motion
            },
            damping: 0.0,
            max_translation: 0.3 * data.measures().diagonal.max(model.measures().diagonal),
        },
        motion_tolerance: settings.motion_tolerance * tolerance * edge,
        max_iterations: cap,
    }
}

fn catching_selection(selection: Selection, catching: bool) -> Selection {
    match selection {
        Selection::Fractional { lambda, floor } if catching => Selection::Fractional {
            lambda: lambda.max(CATCHING_LAMBDA),
            floor,
        },
        Selection::TrimmedSearch if catching => Selection::Fractional {
            lambda: CATCHING_LAMBDA,
            floor: Floor::Auto,
        },
        other => other,
    }
}
