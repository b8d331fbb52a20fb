//! What distinguishes the stages of a match: the rules of each, derived from settings and meshes.

use serde::{Deserialize, Serialize};

use super::correspondence::{MatchRules, PairWith};
use super::metric::{Metric, StepRules};
use super::reject::RejectRules;
use super::select::{Floor, PairSelection, SelectRules};
use crate::registration::closed_form::Motion;
use crate::registration::settings::MatchSettings;
use crate::registration::surface::Surface;

/// The stages of a match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// All starts, few points: a wide basin matters, exactness does not.
    Coarse,
    /// The best distinct ones, more points.
    Refine,
    /// The winner, all points of the full meshes.
    Full,
    /// A start run to its end: first with a wide basin …
    WideBasin,
    /// … then with the settings as given.
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
    /// Partners are looked for at least this far away, and farther only as far as the kept ones ask for;
    /// `None` where all are looked for.
    pub(crate) least_reach: Option<f64>,
    /// Stop when a step moves no corner by more than this …
    pub(crate) motion_tolerance: f64,
    /// … or by more than this share of the distance that the kept pairs lie apart.
    pub(crate) tolerance_of_rmse: f64,
    pub(crate) max_iterations: usize,
}

/// A value for residuals solved in closed form and for those with normals, whose steps converge
/// quadratically (Pottmann et al. 2006).
#[derive(Debug, Clone, Copy)]
struct ByOrder<T> {
    point_to_point: T,
    with_normals: T,
}

impl<T: Copy> ByOrder<T> {
    const fn both(value: T) -> Self {
        Self {
            point_to_point: value,
            with_normals: value,
        }
    }

    fn of(&self, metric: Metric) -> T {
        match metric {
            Metric::PointToPoint => self.point_to_point,
            Metric::PointToPlane | Metric::Symmetric => self.with_normals,
        }
    }
}

/// What one stage does differently from the settings.
#[derive(Debug, Clone, Copy)]
struct StageRow {
    stage: Stage,
    /// Normals may differ by up to 90°, facets stay flat, the floor is at least [`WIDE_FLOOR`].
    wide_pairs: bool,
    /// λ is at least [`WIDE_LAMBDA`].
    wide_selection: ByOrder<bool>,
    /// Pairs that lie so far beyond a border do not count, in mean edge lengths. Such points pull
    /// towards the border, which is right far away and wrong near the pose.
    max_overhang: f64,
    /// Iterations at most; `None` as the settings say.
    max_iterations: ByOrder<Option<usize>>,
    /// Converged when a step moves no corner by more than so many `motion_tolerance`s.
    tolerance: ByOrder<f64>,
    /// … or by no more than this share of what the kept pairs leave.
    of_rmse: ByOrder<f64>,
    /// The pose is near: points far beyond those that are kept need no partner.
    is_near: bool,
    /// Far from the pose a free scale shrinks the data until it lies anywhere on the model.
    keeps_scale: bool,
}

/// The stages, one row each. What a row does not name is as the settings say.
const STAGES: [StageRow; 5] = [
    StageRow {
        stage: Stage::Coarse,
        wide_pairs: true,
        wide_selection: ByOrder::both(true),
        max_overhang: f64::INFINITY,
        max_iterations: ByOrder::both(Some(20)),
        tolerance: ByOrder::both(20.0),
        of_rmse: ByOrder::both(0.0),
        is_near: false,
        keeps_scale: true,
    },
    StageRow {
        stage: Stage::Refine,
        wide_pairs: false,
        // Point to point is still far from converged when the coarse stage ends.
        wide_selection: ByOrder {
            point_to_point: true,
            with_normals: false,
        },
        max_overhang: 1.0,
        max_iterations: ByOrder {
            point_to_point: None,
            with_normals: Some(60),
        },
        tolerance: ByOrder::both(1.0),
        of_rmse: ByOrder::both(0.0),
        is_near: true,
        keeps_scale: false,
    },
    StageRow {
        stage: Stage::Full,
        wide_pairs: false,
        wide_selection: ByOrder::both(false),
        max_overhang: 0.1,
        max_iterations: ByOrder {
            point_to_point: None,
            with_normals: Some(10),
        },
        // On meshes that agree exactly the error after a step is about the square of the step, so
        // this ends at round-off; on others it is far below what the facets leave.
        tolerance: ByOrder {
            point_to_point: 1.0,
            with_normals: 0.01,
        },
        of_rmse: ByOrder {
            point_to_point: 0.0,
            with_normals: SETTLED,
        },
        is_near: true,
        keeps_scale: false,
    },
    StageRow {
        stage: Stage::WideBasin,
        wide_pairs: true,
        wide_selection: ByOrder::both(true),
        max_overhang: f64::INFINITY,
        max_iterations: ByOrder::both(None),
        tolerance: ByOrder::both(1.0),
        of_rmse: ByOrder::both(0.0),
        is_near: false,
        keeps_scale: false,
    },
    StageRow {
        stage: Stage::Converge,
        wide_pairs: false,
        wide_selection: ByOrder::both(false),
        max_overhang: f64::INFINITY,
        max_iterations: ByOrder::both(None),
        tolerance: ByOrder::both(1.0),
        of_rmse: ByOrder::both(0.0),
        is_near: false,
        keeps_scale: false,
    },
];

impl Stage {
    /// The row of this stage; rows stand in the order of the variants.
    fn row(self) -> &'static StageRow {
        let row = &STAGES[self as usize];
        debug_assert_eq!(row.stage, self);
        row
    }
}

/// A step below this share of the residuals moves the pose by less than they leave it open: residuals of
/// springback are alike over patches, so that the mean of all is not exact to more than an eighth of one.
const SETTLED: f64 = 0.05;
/// λ with a wide basin (Phillips, Liu, Tomasi 2007: a first run with 3 widens the basin).
const WIDE_LAMBDA: f64 = 3.0;
/// Floor with a wide basin, as a fraction of the mean edge length.
const WIDE_FLOOR: f64 = 0.1;
/// Least floor, as a fraction of the mean edge length: facets of a developable box have no chordal
/// error, but a floor of zero lets the fraction collapse.
const LEAST_FLOOR: f64 = 0.005;
/// Largest kept fraction, as a multiple of what the area of the model can cover.
const MAX_FRACTION: f64 = 1.05;
/// Longest step, as a fraction of the larger diagonal.
const MAX_STEP: f64 = 0.3;
/// Likely length of a step, as a fraction of the smaller diagonal.
const LIKELY_STEP: f64 = 0.02;

/// σ0 that the settings ask for between these surfaces.
pub(crate) fn floor(settings: &MatchSettings, a: &Surface, b: &Surface) -> f64 {
    let chosen = match settings.selection {
        PairSelection::Fractional { floor, .. } => floor,
        PairSelection::TrimmedSearch => Floor::Auto,
        PairSelection::All | PairSelection::Trimmed { .. } => Floor::None,
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
    let row = stage.row();
    let edge = edge_length(data, model);
    let floor = floor(settings, data, model);
    let on_triangles = settings.pair_with == PairWith::Triangle;
    let min_cos = settings.max_normal_angle_deg.to_radians().cos();
    StageRules {
        stage,
        matching: MatchRules {
            pair_with: settings.pair_with,
            reject: RejectRules {
                min_cos: if row.wide_pairs {
                    min_cos.min(0.0)
                } else {
                    min_cos
                },
                max_distance: f64::INFINITY,
                // Nodes have no place beyond a border: the nearest one is always on it.
                max_overhang: if on_triangles {
                    row.max_overhang * edge
                } else {
                    f64::INFINITY
                },
            },
            curved: on_triangles && !row.wide_pairs,
        },
        selection: SelectRules {
            selection: if row.wide_selection.of(settings.metric) {
                widened(settings.selection)
            } else {
                settings.selection
            },
            floor: if row.wide_pairs && floor > 0.0 {
                floor.max(WIDE_FLOOR * edge)
            } else {
                floor
            },
            max_fraction: (MAX_FRACTION * model.measures().area / data.measures().area).min(1.0),
        },
        step: StepRules {
            metric: settings.metric,
            motion: if row.keeps_scale {
                Motion::Rigid
            } else {
                settings.motion
            },
            max_translation: MAX_STEP * data.measures().diagonal.max(model.measures().diagonal),
            likely_motion: match settings.selection {
                // What remains of the residuals is that of points without counterpart.
                PairSelection::All | PairSelection::Trimmed { .. } => f64::INFINITY,
                _ => LIKELY_STEP * data.measures().diagonal.min(model.measures().diagonal),
            },
        },
        least_reach: (row.is_near && on_triangles).then_some(edge),
        motion_tolerance: settings.motion_tolerance * row.tolerance.of(settings.metric) * edge,
        tolerance_of_rmse: row.of_rmse.of(settings.metric),
        max_iterations: row
            .max_iterations
            .of(settings.metric)
            .unwrap_or(settings.max_iterations),
    }
}

/// The selection with a wide basin.
fn widened(selection: PairSelection) -> PairSelection {
    match selection {
        PairSelection::Fractional { lambda, floor } => PairSelection::Fractional {
            lambda: lambda.max(WIDE_LAMBDA),
            floor,
        },
        PairSelection::TrimmedSearch => PairSelection::Fractional {
            lambda: WIDE_LAMBDA,
            floor: Floor::Auto,
        },
        PairSelection::All | PairSelection::Trimmed { .. } => selection,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_the_stages() {
        for (index, row) in STAGES.iter().enumerate() {
            assert_eq!(row.stage as usize, index);
        }
    }
}
