//! The last step of a pose: where surfaces alone leave it free to slide, borders and holes hold it, and an
//! offset of the sheets does not push it aside.

use std::sync::Arc;

use super::context::PairContext;
use crate::assess::borders::{BorderComparison, Borders, HOLES_THAT_HOLD};
use crate::assess::contact::MAX_NODES;
use crate::assess::evidence::EvidenceSearch;
use crate::assess::least_squares::quantile;
use crate::assess::tolerance::{AS_CLOSE, Distances};
use crate::assess::trims;
use crate::geometry::Similarity;
use crate::monitor::Cancelled;
use crate::registration::Surface;

/// Steps that are made at most.
const STEPS: usize = 6;
/// The last step was made if it moves the part by less than this share of the facets of the borders.
const STILL: f64 = 0.02;
/// Borders are looked for at least this many times as far away as they may lie apart in the end.
const LEAST_REACH: f64 = 3.0;
/// Borders must lie beside each other along this share of the smaller part's, unless holes hold it: the outline of a
/// part that is not trimmed yet lies beside no other.
const LEAST_PAIRED: f64 = 0.3;
/// The misfit of the borders must shrink at least to this share, or the distance of the surfaces while no fewer
/// borders lie beside each other: those of a bent part fit nowhere.
const BETTER: f64 = 0.7;
/// The misfit is what this share of the length of the borders does not exceed.
const MOSTLY: f64 = 0.75;
/// The surfaces may come to lie apart by [`AS_CLOSE`] times as much and this share of what may remain.
const LITTLE_GAP: f64 = 0.5;

/// The pose moved so that surfaces, borders and holes fit together; `None` where that would move it by
/// no more than the borders are cut into facets, where the borders do not determine where the part belongs (parts
/// that are trimmed differently), or where neither they nor the surfaces fit better. O(steps · nodes · log triangles).
pub fn refined_with_borders(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Option<Similarity>, Cancelled> {
    Refinement::new(context, pose.scale, MAX_NODES).refined(pose, Least::Facets)
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
pub(super) struct Refinement<'c, 'a> {
    context: &'c PairContext<'a>,
    borders: Arc<BorderComparison<'a>>,
    distances: Distances,
    max_nodes: usize,
}

impl<'c, 'a> Refinement<'c, 'a> {
    /// For poses of this scale; about `max_nodes` nodes of the smaller part are looked at.
    pub(super) fn new(context: &'c PairContext<'a>, scale: f64, max_nodes: usize) -> Self {
        let reach = context.distances(scale).refined_border_reach;
        Self::within(context, scale, max_nodes, reach)
    }

    /// [`Refinement::new`] for first poses, whose borders lie farther apart.
    pub(super) fn of_first_poses(
        context: &'c PairContext<'a>,
        scale: f64,
        max_nodes: usize,
    ) -> Self {
        let reach = context.distances(scale).first_border_reach;
        Self::within(context, scale, max_nodes, reach)
    }

    /// With borders looked for within at least `reach`.
    fn within(context: &'c PairContext<'a>, scale: f64, max_nodes: usize, reach: f64) -> Self {
        let distances = context.distances(scale);
        let reach = reach.max(LEAST_REACH * distances.tolerance.remainder);
        Self {
            context,
            borders: context.borders(scale, reach),
            distances,
            max_nodes,
        }
    }

    /// [`refined_with_borders`], from this first step on.
    pub(super) fn refined(
        &self,
        pose: &Similarity,
        least: Least,
    ) -> Result<Option<Similarity>, Cancelled> {
        self.refined_if(pose, least, BETTER)
    }

    /// [`refined_with_borders`], also where the surfaces come only a little closer: how close they may come under
    /// this pose.
    pub(super) fn closest(&self, pose: &Similarity) -> Result<Option<Similarity>, Cancelled> {
        self.refined_if(pose, Least::Facets, 1.0)
    }

    /// [`Refinement::refined`] if the distance of the surfaces shrinks to a share of this, or the misfit of the
    /// borders.
    fn refined_if(
        &self,
        pose: &Similarity,
        least: Least,
        closer: f64,
    ) -> Result<Option<Similarity>, Cancelled> {
        let Distances {
            tolerance,
            reach,
            noise,
            ..
        } = self.distances;
        let contacts = self.context.contacts(pose.scale, reach, self.max_nodes);
        let mut search = EvidenceSearch::new(contacts, &self.borders, &self.distances);
        let mut moved = *pose;
        let mut first = None;
        let mut is_still = false;
        for step in 0..=STEPS {
            self.context.check()?;
            let Some(mut evidence) = search.at(&moved) else {
                break;
            };
            let share = evidence.borders.share();
            let n_holes = evidence.borders.holes.len();
            if share < LEAST_PAIRED && n_holes < HOLES_THAT_HOLD {
                break;
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
                let is_better = fits && misfit < BETTER * first_misfit || is_closer;
                return Ok(is_better.then_some(moved));
            }
            let limit = evidence.borders.limit(&tolerance);
            let next = trims::trusted_fit(&mut evidence, limit).corrected(&evidence);
            let source = self.context.source;
            if step == 0 && least == Least::Facets && largest_motion(source, pose, &next) <= facets
            {
                break;
            }
            is_still = self.context.displacement(&next, &moved) < STILL * facets;
            moved = next;
        }
        Ok(None)
    }
}

/// Distance across the borders that most of their length does not exceed.
fn misfit(borders: &Borders) -> f64 {
    let pairs = borders.pairs().iter();
    quantile(
        &mut pairs.map(|p| (p.gap.abs(), p.weight)).collect::<Vec<_>>(),
        MOSTLY,
    )
}

/// How far the farthest node moves between two poses.
fn largest_motion(source: &Surface, before: &Similarity, after: &Similarity) -> f64 {
    let nodes = source.mesh().positions().iter();
    nodes
        .map(|p| (after.apply(p) - before.apply(p)).norm())
        .fold(0.0, f64::max)
}
