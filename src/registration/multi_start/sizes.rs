//! How the sizes of two surfaces decide how to search.

use super::candidate::Pairing;
use crate::registration::result::Side;
use crate::registration::settings::MatchSettings;
use crate::registration::surface::Surface;

/// Below this ratio of areas the units differ, and no start finds a pose worth the time.
const INCOMPATIBLE_RATIO: f64 = 0.01;
/// Points that are enough there.
const INCOMPATIBLE_POINTS: usize = 50;

/// True if the sizes differ so much that the parts must be in different units or different parts. Points of the larger
/// one would ask far away from the smaller one, which is slow and decides nothing.
pub(super) fn sizes_incompatible(source: &Surface, target: &Surface) -> bool {
    let (a, b) = (source.measures().area, target.measures().area);
    a.min(b) <= INCOMPATIBLE_RATIO * a.max(b)
}

/// No pose will be worth much, so a rough one is enough: in the hollow of a part a hundred times as
/// large every query takes long, because all its triangles are about equally far.
pub(super) fn incompatible_settings(settings: &MatchSettings) -> MatchSettings {
    MatchSettings {
        n_coarse_points: settings.n_coarse_points.min(INCOMPATIBLE_POINTS),
        n_refine_points: settings.n_refine_points.min(INCOMPATIBLE_POINTS),
        refine_on_full: false,
        ..settings.clone()
    }
}

/// The smaller mesh is the data, because it is the one that is contained; of meshes that differ by
/// less than a tenth the coarser one, because facets of the finer one are more exact.
pub(super) fn natural_data_side(source: &Surface, target: &Surface) -> Side {
    let (a, b) = (source.measures(), target.measures());
    let source_is_data = if (a.area - b.area).abs() > 0.1 * a.area.max(b.area) {
        a.area < b.area
    } else {
        source.mesh().n_vertices() <= target.mesh().n_vertices()
    };
    if source_is_data {
        Side::Source
    } else {
        Side::Target
    }
}

/// True if the last stage is more exact with the roles exchanged: facets of the finer mesh lie
/// closer to the smooth surface, so the coarser mesh should be the data, as long as half of it is
/// covered.
pub(super) fn last_stage_swaps(pairing: Pairing<'_>) -> bool {
    let (data, model) = (pairing.data.measures(), pairing.model.measures());
    let model_is_coarser = model.mean_edge_length > 1.2 * data.mean_edge_length;
    model_is_coarser && data.area > 0.5 * model.area
}
