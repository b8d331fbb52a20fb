//! The choice between poses that surfaces do not tell apart: where a part can slide on the other, its
//! borders and holes say where it belongs.

use rayon::prelude::*;

use super::contact::Contacts;
use super::rims::Rims;
use super::settle::{settled, settled_within};
use super::{AssessSettings, free_motions, overlap_limit, tolerance_of};
use crate::geometry::Similarity;
use crate::registration::{Alternative, MatchOutcome, Surface, same_pose};

/// Rims are looked for within this share of the diagonal: first poses are that good.
const NEAR_SHARE: f64 = 0.03;
/// Poses whose rims are compared at most.
const MOST_POSES: usize = 64;
/// Of these so many, with the best rims, are moved until they fit.
const MOST_SETTLED: usize = 6;
/// Another pose takes the place of the result if its rims lie apart by less than this share.
const BETTER: f64 = 0.7;
/// Its surfaces may lie apart by so many times as much.
const AS_CLOSE: f64 = 1.5;
/// It must meet this share of what the result meets.
const AS_MUCH: f64 = 0.9;

/// A pose that borders and holes hold, and what is left of the others.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPose {
    /// The pose.
    pub target_from_source: Similarity,
    /// The other poses of the match. Where their rims fit worse than their surfaces, that is how much
    /// worse they are.
    pub alternatives: Vec<Alternative>,
}

/// The pose of `outcome` or another one that the match tried, whichever has its borders and holes where
/// they belong, if the surfaces leave the pose free to slide; `None` where they do not, or where the
/// parts have no rims beside each other. O(poses · border edges + nodes · log triangles).
pub fn held_by_rims(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
) -> Option<HeldPose> {
    let limit = overlap_limit(source, target, settings.allowance);
    let found = &outcome.target_from_source;
    free_motions(source, target, found, limit).motion?;
    let pair = Pair::new(source, target, settings);
    let result = pair.settle(found)?;
    let tried = outcome
        .starts
        .iter()
        .flat_map(|start| [start.first, start.last]);
    let others: Vec<Similarity> = outcome
        .alternatives
        .iter()
        .map(|other| other.target_from_source)
        .chain(tried)
        .take(MOST_POSES)
        .collect();
    let mut by_rims: Vec<(f64, Similarity)> = others
        .par_iter()
        .map(|pose| (pair.rims_apart(pose), *pose))
        .collect();
    by_rims.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = by_rims
        .iter()
        .take(MOST_SETTLED)
        .filter_map(|(_, pose)| pair.settle(pose))
        .filter(|other| other.apart < BETTER * result.apart && other.is_as_close_as(&result, &pair))
        .min_by(|a, b| a.apart.total_cmp(&b.apart));
    let winner = best.unwrap_or(result);
    Some(HeldPose {
        target_from_source: winner.pose,
        alternatives: pair.alternatives(&winner, &result, outcome),
    })
}

/// What poses of two parts are compared by.
struct Pair<'a> {
    source: &'a Surface,
    target: &'a Surface,
    settings: &'a AssessSettings,
    near: f64,
    /// Distance of surfaces that springback explains.
    springback: f64,
}

/// A pose after its last step.
#[derive(Clone, Copy)]
struct Settled {
    pose: Similarity,
    /// How far rims lie apart.
    apart: f64,
    /// Share of the smaller part that meets the other.
    met: f64,
    /// How far the surfaces lie apart there, root mean square.
    gap: f64,
}

impl Settled {
    fn is_as_close_as(&self, other: &Self, pair: &Pair<'_>) -> bool {
        self.met >= AS_MUCH * other.met && self.gap <= (AS_CLOSE * other.gap).max(pair.springback)
    }
}

impl<'a> Pair<'a> {
    fn new(source: &'a Surface, target: &'a Surface, settings: &'a AssessSettings) -> Self {
        Self {
            source,
            target,
            settings,
            near: NEAR_SHARE * target.measures().diagonal,
            springback: tolerance_of(target, settings).springback,
        }
    }

    fn settle(&self, pose: &Similarity) -> Option<Settled> {
        let (source, target) = (self.source, self.target);
        let roughly = settled_within(source, target, pose, self.settings, self.near);
        let pose = roughly.unwrap_or(*pose);
        let pose = settled(source, target, &pose, self.settings).unwrap_or(pose);
        let contacts = Contacts::find(self.source, self.target, &pose, self.near)?;
        let weight: f64 = contacts.list.iter().map(|c| c.weight).sum();
        let gaps = contacts.list.iter().map(|c| c.weight * c.gap * c.gap);
        Some(Settled {
            pose,
            apart: self.rims_apart(&pose),
            met: contacts.share,
            gap: (gaps.sum::<f64>() / weight).sqrt(),
        })
    }

    /// Root mean square distance of the smaller part's rims from those of the other, at most `near`;
    /// a hole without counterpart lies that far away too.
    fn rims_apart(&self, pose: &Similarity) -> f64 {
        let rims = Rims::find(self.source, self.target, pose, self.near);
        let share = rims.share().min(1.0);
        let paired: f64 = rims.pairs().iter().map(|p| p.weight).sum();
        let gaps = rims.pairs().iter().map(|p| p.weight * p.gap * p.gap);
        let mean_sq = if paired > 0.0 {
            gaps.sum::<f64>() / paired
        } else {
            0.0
        };
        let alone = (1.0 - share) + rims.missing_share();
        (share * mean_sq + alone * self.near * self.near).sqrt()
    }

    /// The other poses with what their rims say of them.
    fn alternatives(
        &self,
        winner: &Settled,
        result: &Settled,
        outcome: &MatchOutcome,
    ) -> Vec<Alternative> {
        let part = self.source.measures().into();
        let facets = Rims::find(self.source, self.target, &winner.pose, self.near).unremarkable();
        let before = Alternative {
            target_from_source: outcome.target_from_source,
            score_ratio: 1.0,
            start: outcome.winner,
        };
        let is_other =
            |other: &Alternative| !same_pose(&other.target_from_source, &winner.pose, &part);
        let is_replaced = winner.apart < result.apart;
        let with_rims = |other: &Alternative| {
            let apart = self.rims_apart(&other.target_from_source);
            Alternative {
                score_ratio: other
                    .score_ratio
                    .max((apart + facets) / (winner.apart + facets)),
                ..*other
            }
        };
        let others = outcome.alternatives.iter();
        let mut alternatives: Vec<Alternative> = others
            .chain(is_replaced.then_some(&before))
            .filter(|other| is_other(other))
            .map(with_rims)
            .collect();
        alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
        alternatives
    }
}
