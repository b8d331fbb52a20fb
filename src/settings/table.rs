//! The settings of a match, one row each. To add one, add its row; everything else walks them.

use std::ops::RangeInclusive;

use super::value::{Field as _, at};
use super::{Access, Choice as _, Domain, Group, MatchRecipe, Setting, Unit};
use crate::registration::{
    DataSide, Hand, Method, Metric, Motion, PairSelection, PairWith, Search, StartMethod, limits,
};

/// Access to a parameter of one kind of pair selection.
macro_rules! of_selection {
    ($kind:ident, $field:ident) => {
        Access {
            get: |recipe| match &recipe.settings.selection {
                PairSelection::$kind { $field, .. } => Some($field.value()),
                _ => None,
            },
            set: |recipe, value| match &mut recipe.settings.selection {
                PairSelection::$kind { $field, .. } => $field.put(value),
                _ => false,
            },
            unused: |_| None,
        }
    };
}

/// Every setting, in the order of help, form, record and report. A setting that decides which others
/// there are comes before those.
pub static SETTINGS: [Setting; 26] = [
    Setting {
        field: "settings.method",
        option: "method",
        key: "method",
        label: "Method",
        help: "Registration method; the options below change single choices of it",
        group: Group::Method,
        domain: Domain::Choice(Method::all_words),
        access: at!(settings.method),
    },
    Setting {
        field: "settings.starts.method",
        option: "start",
        key: "start_method",
        label: "Start",
        help: "Where the match starts from; the default is current if one --start-pose is given",
        group: Group::Method,
        domain: Domain::Choice(StartMethod::all_words),
        access: at!(settings.starts.method, not_searched),
    },
    Setting {
        field: "settings.starts.angle_segment_deg",
        option: "angle-segment",
        key: "angle_segment_deg",
        label: "Rotation step",
        help: "Angle between neighbouring rotations about the mean normal; 40° gives nine, as in the paper",
        group: Group::Starts,
        domain: number(Unit::Degrees, limits::ANGLE_SEGMENT_DEG, 0.5),
        access: at!(settings.starts.angle_segment_deg, not_rotated),
    },
    Setting {
        field: "settings.starts.both_signs",
        option: "both-directions",
        key: "both_directions",
        label: "Both normal directions",
        help: "Try both directions of the mean normal",
        group: Group::Starts,
        domain: Domain::Switch,
        access: at!(settings.starts.both_signs, not_searched),
    },
    Setting {
        field: "settings.starts.wide_search",
        option: "wide-search",
        key: "wide_search",
        label: "Wide search",
        help: "Also search all rotations, both normal directions and all places, with the surface normals of patches \
            aligned; the best are further starts",
        group: Group::Starts,
        domain: Domain::Switch,
        access: at!(settings.starts.wide_search, not_wide),
    },
    Setting {
        field: "settings.starts.poses",
        option: "start-pose",
        key: "start_poses",
        label: "Given poses",
        help: "A start pose (crash from stamped): a text file, or its numbers, 16 by rows. Several poses are all \
            tried. A rigid match keeps the scale of its start",
        group: Group::Starts,
        domain: Domain::Poses,
        access: at!(settings.starts.poses),
    },
    Setting {
        field: "settings.data_side",
        option: "data",
        key: "points_of",
        label: "Data points",
        help: "The part whose nodes are paired with the other part's surface",
        group: Group::Correspondences,
        domain: Domain::Choice(DataSide::all_words),
        access: at!(settings.data_side, not_searched),
    },
    Setting {
        field: "settings.pair_with",
        option: "correspondence",
        key: "pairs",
        label: "Correspondence",
        help: "What a data point is paired with",
        group: Group::Correspondences,
        domain: Domain::Choice(PairWith::all_words),
        access: at!(settings.pair_with, not_searched),
    },
    Setting {
        field: "settings.selection",
        option: "pair-selection",
        key: "selection",
        label: "Pair selection",
        help: "Which pairs are kept",
        group: Group::Correspondences,
        domain: Domain::Choice(PairSelection::all_words),
        access: at!(settings.selection, not_searched),
    },
    Setting {
        field: "settings.selection.lambda",
        option: "lambda",
        key: "lambda",
        label: "λ",
        help: "Exponent λ of Fractional ICP; a larger one keeps more pairs",
        group: Group::Correspondences,
        domain: number(Unit::One, limits::LAMBDA, 0.01),
        access: of_selection!(Fractional, lambda),
    },
    Setting {
        field: "settings.selection.floor",
        option: "floor",
        key: "floor_setting",
        label: "Floor σ₀",
        help: "Floor σ₀ of Fractional ICP: a length, none, or auto (estimated from the meshes)",
        group: Group::Correspondences,
        domain: Domain::Floor,
        access: of_selection!(Fractional, floor),
    },
    Setting {
        field: "settings.selection.overlap",
        option: "overlap",
        key: "trimmed_overlap",
        label: "Overlap",
        help: "Fraction of the pairs that Trimmed ICP keeps; estimated if not given",
        group: Group::Correspondences,
        domain: number(Unit::One, limits::OVERLAP, 0.01),
        access: of_selection!(Trimmed, overlap),
    },
    Setting {
        field: "settings.metric",
        option: "residual",
        key: "residual",
        label: "Residual",
        help: "The residual that is minimised",
        group: Group::Correspondences,
        domain: Domain::Choice(Metric::all_words),
        access: at!(settings.metric, not_searched),
    },
    Setting {
        field: "settings.motion",
        option: "motion",
        key: "motion",
        label: "Motion",
        help: "What may change: the pose, or also the scale",
        group: Group::Correspondences,
        domain: Domain::Choice(Motion::all_words),
        access: at!(settings.motion),
    },
    Setting {
        field: "settings.hand",
        option: "hand",
        key: "hand",
        label: "Hand",
        help: "Try the part as is, mirrored, or both",
        group: Group::Correspondences,
        domain: Domain::Choice(Hand::all_words),
        access: at!(settings.hand),
    },
    Setting {
        field: "settings.max_normal_angle_deg",
        option: "normal-angle",
        key: "max_normal_angle_deg",
        label: "Normal angle",
        help: "Maximum angle between the normals of a pair; 180° accepts all pairs",
        group: Group::Correspondences,
        domain: number(Unit::Degrees, limits::NORMAL_ANGLE_DEG, 0.5),
        access: at!(settings.max_normal_angle_deg, not_searched),
    },
    Setting {
        field: "settings.allowance",
        option: "allowance",
        key: "allowance",
        label: "Offset tolerance",
        help: "Expected deviation besides faceting, such as springback",
        group: Group::Correspondences,
        domain: number(Unit::Length, limits::LENGTH, 0.01),
        access: at!(settings.allowance),
    },
    Setting {
        field: "settings.shape_tolerance",
        option: "shape-tolerance",
        key: "shape_tolerance",
        label: "Shape tolerance",
        help: "How far the shapes may differ besides springback; 0 takes the larger of 1 mm and the thickness",
        group: Group::Correspondences,
        domain: number(Unit::LengthOrAuto, limits::LENGTH, 0.05),
        access: at!(settings.shape_tolerance),
    },
    Setting {
        field: "settings.remove_offset",
        option: "remove-offset",
        key: "remove_offset",
        label: "Remove offset",
        help: "Take an offset of the sheets along their normals, as between skin and mid-surface, out of the pose \
            where it can be distinguished from a shift",
        group: Group::Correspondences,
        domain: Domain::Switch,
        access: at!(settings.remove_offset, not_searched),
    },
    Setting {
        field: "settings.search",
        option: "search",
        key: "search",
        label: "Search",
        help: "How the starts are searched",
        group: Group::Search,
        domain: Domain::Choice(Search::all_words),
        access: at!(settings.search, not_searched),
    },
    Setting {
        field: "settings.n_coarse_points",
        option: "coarse-points",
        key: "race_points",
        label: "Coarse points",
        help: "Data points of the first stage",
        group: Group::Search,
        domain: Domain::Count(limits::COUNT),
        access: at!(settings.n_coarse_points, not_searched),
    },
    Setting {
        field: "settings.n_refine_points",
        option: "refine-points",
        key: "refine_points",
        label: "Refine points",
        help: "Data points of the second stage",
        group: Group::Search,
        domain: Domain::Count(limits::COUNT),
        access: at!(settings.n_refine_points, not_searched),
    },
    Setting {
        field: "settings.max_iterations",
        option: "iterations",
        key: "max_iterations",
        label: "Max. iterations",
        help: "Maximum iterations per run",
        group: Group::Search,
        domain: Domain::Count(limits::COUNT),
        access: at!(settings.max_iterations, not_searched),
    },
    Setting {
        field: "settings.motion_tolerance",
        option: "tolerance",
        key: "motion_tolerance",
        label: "Tolerance",
        help: "Converged when no bounding-box corner moves by more than this fraction of an edge length",
        group: Group::Search,
        domain: number(Unit::EdgeLengths, limits::MOTION_TOLERANCE, 1e-4),
        access: at!(settings.motion_tolerance, not_searched),
    },
    Setting {
        field: "max_triangles",
        option: "triangles",
        key: "search_triangles",
        label: "Search triangles",
        help: "Run the starts on meshes reduced to this many triangles, as in the paper",
        group: Group::Search,
        domain: Domain::Limit(1..=usize::MAX),
        access: at!(max_triangles),
    },
    Setting {
        field: "settings.refine_on_full",
        option: "refine-on-full",
        key: "finish_on_full",
        label: "Refine on full meshes",
        help: "Refine the best pose on the full meshes",
        group: Group::Search,
        domain: Domain::Switch,
        access: at!(settings.refine_on_full, not_searched),
    },
];

/// The setting of an option; `None` if there is none of that name.
pub fn setting(option: &str) -> Option<&'static Setting> {
    SETTINGS.iter().find(|setting| setting.option == option)
}

const fn number(unit: Unit, range: RangeInclusive<f64>, step: f64) -> Domain {
    Domain::Number { unit, range, step }
}

fn not_searched(recipe: &MatchRecipe) -> Option<&'static str> {
    let is_searched = recipe.settings.method != Method::Umeyama;
    (!is_searched).then_some("Applies only to methods that search the pose")
}

fn not_wide(recipe: &MatchRecipe) -> Option<&'static str> {
    let is_coarse = recipe.settings.search == Search::CoarseToFine;
    let of_search = (!is_coarse).then_some("Applies only to the search from coarse to fine");
    not_searched(recipe).or(of_search)
}

fn not_rotated(recipe: &MatchRecipe) -> Option<&'static str> {
    let method = recipe.settings.starts.method;
    let is_rotated = matches!(method, StartMethod::SurfaceNormals | StartMethod::All);
    let of_starts = (!is_rotated).then_some("Applies only to starts from surface normals");
    not_searched(recipe).or(of_starts)
}
