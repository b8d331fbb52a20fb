//! Stamped parts that lie in one place: which give way to others, and what each of the rest gives.

use super::Claim;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::load::LoadedPart;
use crate::pipeline::map::{MapRun, ThicknessSums};
use crate::search::ClosestPoint as _;

/// Where so much of the crash triangles that a part lies on is under another one too, it lies in the place of that.
const IN_ITS_PLACE: f64 = 0.5;
/// Triangles of the crash parts that are asked.
const N_PLACES: usize = 400;
/// Elements between two questions for a cancel.
const CHUNK: usize = 1 << 14;

/// Of each stamped part, whether it gives way to one that fits clearly better and lies on what it lies on of the crash
/// parts: else it would put its values over the right ones wherever it happens to be nearer. A match that is not good
/// gives way to any good one there.
pub(super) fn that_give_way(crash: &LoadedPart, members: &[(&LoadedPart, &Claim)]) -> Vec<bool> {
    let covers: Vec<Vec<bool>> = members
        .iter()
        .map(|(part, claim)| covers(crash, part, &claim.pose))
        .collect();
    let is_in_place = |own: &[bool], other: &[bool]| {
        let n_own = own.iter().filter(|lies| **lies).count();
        let both = own
            .iter()
            .zip(other)
            .filter(|(own, other)| **own && **other);
        both.count() as f64 > IN_ITS_PLACE * n_own as f64
    };
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by(|a, b| {
        let [a, b] = [a, b].map(|at| members[*at].1);
        b.is_good
            .cmp(&a.is_good)
            .then(a.fit.rmse.total_cmp(&b.fit.rmse))
    });
    let mut gives_way = vec![false; members.len()];
    for (place, &at) in order.iter().enumerate() {
        gives_way[at] = order[..place].iter().any(|&better| {
            let [own, other] = [at, better].map(|at| members[at].1);
            let is_clear = other.is_good && !own.is_good || !own.fit.is_as_close_as(&other.fit);
            !gives_way[better] && is_clear && is_in_place(&covers[at], &covers[better])
        });
    }
    gives_way
}

/// Whether a stamped part in its pose lies on each of the triangles of the crash parts that are asked.
fn covers(crash: &LoadedPart, part: &LoadedPart, pose: &Similarity) -> Vec<bool> {
    let [own, other] = [part, crash].map(|of| of.surface.measures().mean_edge_length);
    let near = (own * pose.scale).max(other);
    let (mesh, part_from_crash) = (crash.surface.mesh(), pose.inverse());
    let step = mesh.n_triangles().div_ceil(N_PLACES).max(1);
    let asked = (0..mesh.n_triangles()).step_by(step);
    let lies_there = |triangle: usize| {
        let centre = part_from_crash.apply(&mesh.triangle_centroid(triangle));
        let tree = part.surface.bvh();
        let hit = tree.closest(&centre, near / pose.scale, None, None);
        hit.is_some()
    };
    asked.map(lies_there).collect()
}

/// What a stamped part gives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    /// Share of the area that takes its values from it.
    pub area: f64,
    /// Mean thickness there; NaN where none was mapped.
    pub thickness: f64,
    /// That over the thickness of the section, where it is unusual.
    pub thickness_ratio: Option<f64>,
}

/// What each of the parts that were mapped together gives.
pub(super) fn given(run: &MapRun, monitor: &Monitor) -> Result<Vec<Given>, Cancelled> {
    if run.sources.len() == 1 {
        // With what was filled from its values.
        let sums = run.thickness_sums();
        return Ok(vec![Given {
            area: run.mapped.mapped_area(&run.target.mesh),
            thickness: sums.mean(),
            thickness_ratio: sums.unusual_ratio(),
        }]);
    }
    let areas = run.target.mesh.areas();
    let whole: f64 = areas.iter().sum();
    let mut sums = vec![ThicknessSums::default(); run.sources.len()];
    for (element, &area) in areas.iter().enumerate() {
        if element.is_multiple_of(CHUNK) {
            monitor.check()?;
        }
        if let Some(part) = run.values_from(element) {
            let section = run.target.nominal_thickness[element];
            sums[part].add(area, run.thickness(element), section);
        }
    }
    let given = sums.into_iter().map(|sums| Given {
        area: sums.area / whole,
        thickness: sums.mean(),
        thickness_ratio: sums.unusual_ratio(),
    });
    Ok(given.collect())
}
