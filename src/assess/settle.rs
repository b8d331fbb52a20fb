//! The last step of a pose: where surfaces alone leave it free to slide, borders and holes hold it, and an
//! offset of the sheets does not push it aside.

use super::borders::{BorderComparison, Borders, HOLES_THAT_HOLD};
use super::contact::{ContactSearch, MAX_NODES, quantile};
use super::evidence::EvidenceSearch;
use super::tolerance::{AssessSettings, Distances};
use super::trims;
use crate::geometry::Similarity;
use crate::registration::Surface;

/// Steps that are made at most.
const STEPS: usize = 6;
/// The last step was made if it moves the part by less than this share of the facets of the borders.
const STILL: f64 = 0.02;
/// Borders are looked for within this share of the diagonal: a door slides so far.
const BORDER_SHARE: f64 = 0.015;
/// Borders must lie beside each other along this share of the smaller part's, unless holes hold it: the outline of a part
/// that is not trimmed yet lies beside no other.
const LEAST_PAIRED: f64 = 0.3;
/// The misfit of the borders must shrink at least to this share, or the distance of the surfaces while no fewer
/// borders lie beside each other: those of a bent part fit nowhere.
const BETTER: f64 = 0.7;
/// The surfaces may come to lie apart by so many times as much …
const AS_CLOSE: f64 = 1.5;
/// … and this share of what may remain.
const LITTLE_GAP: f64 = 0.5;

/// The pose moved so that surfaces, borders and holes fit together; `None` where that would move it by
/// no more than the borders are cut into facets, where the borders do not say where the part belongs (parts
/// that are trimmed differently), or where neither they nor the surfaces fit better. O(steps · nodes · log triangles).
pub fn settled(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> Option<Similarity> {
    let settling = Settling::new([source, target], pose.scale, settings, MAX_NODES);
    settling.settled(pose, Least::Facets)
}

/// The smallest first step with which a pose is moved at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Least {
    /// Any.
    Any,
    /// What the borders are cut into.
    Facets,
}

/// What moving poses of a pair needs: both borders are prepared once for all of them.
pub(super) struct Settling<'a> {
    surfaces: [&'a Surface; 2],
    borders: BorderComparison<'a>,
    distances: Distances,
    max_nodes: usize,
}

impl<'a> Settling<'a> {
    /// For poses of this scale; about `max_nodes` nodes of the smaller part are looked at.
    pub(super) fn new(
        surfaces: [&'a Surface; 2],
        scale: f64,
        settings: &AssessSettings,
        max_nodes: usize,
    ) -> Self {
        let near = BORDER_SHARE * surfaces[1].measures().diagonal;
        Self::within(surfaces, scale, settings, max_nodes, near)
    }

    /// [`Settling::new`] with borders looked for within at least `near`.
    pub(super) fn within(
        surfaces: [&'a Surface; 2],
        scale: f64,
        settings: &AssessSettings,
        max_nodes: usize,
        near: f64,
    ) -> Self {
        let [source, target] = surfaces;
        let distances = Distances::of(source, target, scale, settings);
        let near = near.max(3.0 * distances.tolerance.remainder);
        Self {
            surfaces,
            borders: BorderComparison::new(surfaces, scale, near),
            distances,
            max_nodes,
        }
    }

    /// [`settled`], from this first step on.
    pub(super) fn settled(&self, pose: &Similarity, least: Least) -> Option<Similarity> {
        self.settled_if(pose, least, BETTER)
    }

    /// [`settled`], also where the surfaces come only a little closer: how close they may come under this pose.
    pub(super) fn closest(&self, pose: &Similarity) -> Option<Similarity> {
        self.settled_if(pose, Least::Facets, 1.0)
    }

    /// [`Settling::settled`] if the distance of the surfaces shrinks to a share of this, or the misfit of the borders.
    fn settled_if(&self, pose: &Similarity, least: Least, closer: f64) -> Option<Similarity> {
        let Distances {
            tolerance,
            reach,
            noise,
            ..
        } = self.distances;
        let source = self.surfaces[0];
        let corners = source.mesh().aabb().corners();
        let contacts = ContactSearch::new(self.surfaces, pose.scale, reach, self.max_nodes);
        let mut search = EvidenceSearch::new(contacts, &self.borders, &self.distances);
        let mut moved = *pose;
        let mut first = None;
        let mut is_still = false;
        for step in 0..=STEPS {
            let mut evidence = search.at(&moved)?;
            let share = evidence.borders.share();
            let n_holes = evidence.borders.holes.len();
            if share < LEAST_PAIRED && n_holes < HOLES_THAT_HOLD {
                return None;
            }
            let facets = evidence.borders.unremarkable();
            let misfit = misfit(&evidence.borders);
            let gap = evidence.contacts.typical_gap(tolerance.remainder);
            let (first_misfit, first_gap, first_share) = *first.get_or_insert((misfit, gap, share));
            if step == STEPS || is_still {
                let little = self.distances.little_more(LITTLE_GAP, first_gap);
                let most = AS_CLOSE * first_gap + noise + little;
                let fits = misfit < tolerance.remainder + facets && gap < most;
                let is_closer = gap < closer * first_gap && share >= first_share;
                return (fits && misfit < BETTER * first_misfit || is_closer).then_some(moved);
            }
            let limit = evidence.borders.limit(&tolerance);
            let next = trims::trusted_fit(&mut evidence, limit).corrected(&evidence);
            if step == 0 && least == Least::Facets && largest_motion(source, pose, &next) <= facets
            {
                return None;
            }
            is_still = next.max_displacement(&moved, &corners) < STILL * facets;
            moved = next;
        }
        None
    }
}

/// Distance across the borders that most of their length does not exceed.
fn misfit(borders: &Borders) -> f64 {
    let pairs = borders.pairs().iter();
    quantile(
        &mut pairs.map(|p| (p.gap.abs(), p.weight)).collect::<Vec<_>>(),
        0.75,
    )
}

/// How far the farthest node moves between two poses.
fn largest_motion(source: &Surface, before: &Similarity, after: &Similarity) -> f64 {
    let nodes = source.mesh().positions().iter();
    nodes
        .map(|p| (after.apply(p) - before.apply(p)).norm())
        .fold(0.0, f64::max)
}
