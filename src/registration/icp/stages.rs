//! What distinguishes the stages of a match: the rules of each, derived from settings and meshes.

use serde::{Deserialize, Serialize};

use super::correspondence::{MatchRules, PairWith};
use super::metric::{Metric, StepRules};
use super::reject::RejectRules;
use super::select::{Floor, SelectRules, Selection};
use crate::registration::closed_form::Motion;
use crate::registration::settings::MatchSettings;
use crate::registration::surface::Surface;

/// The stages of a match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// All starts, few points: a wide basin matters, exactness does not.
    #[serde(alias = "race")]
    Coarse,
    /// The best distinct ones, more points.
    Refine,
    /// The winner, all points of the full meshes.
    #[serde(alias = "finish")]
    Full,
    /// A start run to its end: first with a wide basin …
    #[serde(alias = "catch")]
    WideBasin,
    /// … then with the settings as given.
    #[serde(alias = "settle", alias = "match")]
    Converge,
}

impl Stage {
    /// The stage in one or two words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarse => "coarse",
            Self::Refine => "refine",
            Self::Full => "refine on full meshes",
            Self::WideBasin => "wide basin",
            Self::Converge => "converge",
        }
    }
}

/// Everything that distinguishes one ICP stage from another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StageRules {
    pub(crate) stage: Stage,
    pub(crate) matching: MatchRules,
    pub(crate) selection: SelectRules,
    pub(crate) step: StepRules,
    /// Stop when a step moves no corner by more than this.
    pub(crate) motion_tolerance: f64,
    pub(crate) max_iterations: usize,
}

/// λ with a wide basin (Phillips, Liu, Tomasi 2007: a first run with 3 widens the basin).
const WIDE_LAMBDA: f64 = 3.0;
/// Floor with a wide basin, as a fraction of the mean edge length.
const WIDE_FLOOR: f64 = 0.1;
/// Least floor, as a fraction of the mean edge length: facets of a developable box have no chordal
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
    let wide = matches!(stage, Stage::Coarse | Stage::WideBasin);
    let second_order = settings.metric != Metric::PointToPoint;
    let on_triangles = settings.pair_with == PairWith::Triangle;
    let min_cos = settings.max_normal_angle_deg.to_radians().cos();
    let min_cos = if wide { min_cos.min(0.0) } else { min_cos };
    // Points beyond the border pull towards it, which is right far away and wrong near the pose.
    let max_overhang = match stage {
        Stage::Full if on_triangles => 0.1 * edge,
        Stage::Refine if on_triangles => edge,
        _ => f64::INFINITY,
    };
    let cap = match stage {
        Stage::Coarse => 20,
        Stage::Refine if second_order => 60,
        Stage::Full if second_order => 10,
        _ => settings.max_iterations,
    };
    let tolerance = match stage {
        Stage::Coarse => 20.0,
        // On meshes that agree exactly the error after a step is about the square of the step, so
        // this ends at round-off; on others it is far below what the facets leave.
        Stage::Full if second_order => 1e-2,
        Stage::Full | Stage::Refine | Stage::WideBasin | Stage::Converge => 1.0,
    };
    StageRules {
        stage,
        matching: MatchRules {
            pair_with: settings.pair_with,
            reject: RejectRules {
                min_cos,
                max_distance: f64::INFINITY,
                max_overhang,
            },
            curved: on_triangles && !wide,
        },
        selection: SelectRules {
            // Point to point is still far from converged when the coarse stage ends.
            selection: widened(
                settings.selection,
                wide || (stage == Stage::Refine && !second_order),
            ),
            floor: if wide && floor > 0.0 {
                floor.max(WIDE_FLOOR * edge)
            } else {
                floor
            },
            max_fraction: (1.05 * model.measures().area / data.measures().area).min(1.0),
        },
        step: StepRules {
            metric: settings.metric,
            // Far from the pose a free scale shrinks the data until it lies anywhere on the model.
            motion: if stage == Stage::Coarse {
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

fn widened(selection: Selection, wide: bool) -> Selection {
    match selection {
        Selection::Fractional { lambda, floor } if wide => Selection::Fractional {
            lambda: lambda.max(WIDE_LAMBDA),
            floor,
        },
        Selection::TrimmedSearch if wide => Selection::Fractional {
            lambda: WIDE_LAMBDA,
            floor: Floor::Auto,
        },
        other => other,
    }
}
