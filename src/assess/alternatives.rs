//! The choice between poses that score alike: what the shapes say under each of them. Facets and springback raise
//! all scores, so that half a turn of a part with waves costs a few percent; the hole, the bead or the border that
//! lies elsewhere then does not care about either.

use rayon::prelude::*;

use super::held::HeldPose;
use super::settle::{Least, Settling};
use super::shape::{ShapeReason, ShapeStatement};
use super::{AssessSettings, contact, statements};
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{Alternative, MatchOutcome, Surface, same_pose};

/// A pose with more differences of the shapes counts as at least so many times as bad as the result, and only
/// alternatives that score better than that are looked at.
const MORE_DIFFERENCES: f64 = 1.5;
/// Lengths of so many tolerances are differences whatever the facets are and however the part is bent.
const CLEARLY: f64 = 2.0;

/// The pose of `outcome` or one of its alternatives that scores nearly as well, whichever has the fewest differences
/// between the shapes. Alternatives with more of them than the pose chosen score worse. `None` where no other pose
/// scores nearly as well. O(alternatives · (border edges + nodes · log triangles)).
pub fn chosen_by_shape(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Option<HeldPose>, Cancelled> {
    let scores_alike = |other: &&Alternative| other.score_ratio < MORE_DIFFERENCES;
    let near: Vec<&Alternative> = outcome.alternatives.iter().filter(scores_alike).collect();
    if near.is_empty() {
        return Ok(None);
    }
    let found = &outcome.target_from_source;
    let settling = Settling::new([source, target], found.scale, settings, contact::MAX_NODES);
    let result = Candidate::at(*found, statements(source, target, found, settings).shape);
    let candidate = |other: &&Alternative| {
        monitor.check()?;
        let pose = other.target_from_source;
        let pose = settling.settled(&pose, Least::Facets).unwrap_or(pose);
        let shape = statements(source, target, &pose, settings).shape;
        Ok(Candidate::at(pose, shape))
    };
    let candidates: Result<Vec<Candidate>, Cancelled> = near.par_iter().map(candidate).collect();
    let candidates = candidates?;
    // Of candidates with as many differences the first one scores best.
    let better = candidates.iter().filter(|other| other.beats(&result));
    let better = better.min_by_key(|other| other.n_differences);
    let winner = better.unwrap_or(&result);
    let before = better.map(|_| Alternative {
        target_from_source: *found,
        score_ratio: 1.0,
        start: outcome.winner,
    });
    let part = source.measures().into();
    let with_shape = |(k, other): (usize, &Alternative)| {
        let is_beaten = candidates.get(k).is_some_and(|c| winner.beats(c));
        ranked(*other, is_beaten)
    };
    // The alternatives come sorted by score, so that those looked at are the first.
    let others = outcome.alternatives.iter().enumerate().map(with_shape);
    let mut alternatives: Vec<Alternative> = others
        .chain(before.map(|before| ranked(before, true)))
        .filter(|other| !same_pose(&other.target_from_source, &winner.pose, &part))
        .collect();
    alternatives.sort_by(|a, b| a.score_ratio.total_cmp(&b.score_ratio));
    Ok(Some(HeldPose {
        target_from_source: winner.pose,
        alternatives,
    }))
}

fn ranked(other: Alternative, is_beaten: bool) -> Alternative {
    let least = if is_beaten { MORE_DIFFERENCES } else { 0.0 };
    Alternative {
        score_ratio: other.score_ratio.max(least),
        ..other
    }
}

/// A pose and what speaks against one shape under it. A bend does so under every pose.
struct Candidate {
    pose: Similarity,
    n_differences: usize,
    /// Of these the ones that nothing but another place explains.
    n_clear: usize,
    /// Holes with a counterpart, and those where the other part is solid.
    n_holes: usize,
    n_alone: usize,
}

impl Candidate {
    fn at(pose: Similarity, shape: ShapeStatement) -> Self {
        let differences = shape.reasons.iter().filter_map(is_clear);
        let (n_differences, n_clear) =
            differences.fold((0, 0), |(n, clear), is| (n + 1, clear + usize::from(is)));
        Self {
            pose,
            n_differences,
            n_clear,
            n_holes: shape.rims.n_holes,
            n_alone: shape.rims.only_source + shape.rims.only_target,
        }
    }

    /// Whether the shapes surely differ less under this pose: there are fewer differences, or as many while holes
    /// that lie alone under the other pose have their counterpart.
    fn beats(&self, other: &Self) -> bool {
        let pairs_holes = self.n_holes > other.n_holes && self.n_alone < other.n_alone;
        self.n_differences < other.n_clear
            || pairs_holes && self.n_differences <= other.n_differences
    }
}

/// Whether a difference is beyond doubt; `None` for a bend.
fn is_clear(reason: &ShapeReason) -> Option<bool> {
    match reason {
        ShapeReason::Bent { .. } => None,
        ShapeReason::Surface { by, limit, .. }
        | ShapeReason::Local { by, limit, .. }
        | ShapeReason::Rims { by, limit, .. }
        | ShapeReason::Hole { by, limit, .. } => Some(*by > CLEARLY * limit),
        ShapeReason::Holes { .. } => Some(true),
        ShapeReason::HardlyMet { .. } | ShapeReason::Stretched { .. } => Some(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assess::ShapeTolerance;
    use crate::geometry::Point3;

    fn candidate(reasons: &[ShapeReason]) -> Candidate {
        let tolerance = ShapeTolerance {
            remainder: 1.0,
            springback: 5.0,
        };
        let shape = ShapeStatement {
            reasons: reasons.to_vec(),
            ..ShapeStatement::nothing_met(tolerance)
        };
        Candidate::at(Similarity::identity(), shape)
    }

    #[test]
    fn only_a_difference_beyond_doubt_speaks_against_a_pose() {
        let at = Point3::origin();
        let limit = 1.0;
        let bend = ShapeReason::Bent { by: 9.0, limit };
        let hole = |by| ShapeReason::Hole { by, limit, at };
        let bead = |by| ShapeReason::Local { by, limit, at };
        let holes = ShapeReason::Holes {
            only_source: 1,
            only_target: 1,
            at,
        };
        let hardly = ShapeReason::HardlyMet { share: 0.49 };
        for (fewer, more, beats) in [
            (vec![], vec![hole(2.1)], true),
            (vec![], vec![hole(1.9)], false),
            (vec![], vec![bead(3.0)], true),
            (vec![], vec![holes], true),
            (vec![], vec![bend], false),
            (vec![], vec![hardly], false),
            (vec![bend], vec![bend, holes], true),
            // Another version has its difference under either pose.
            (vec![hole(3.0)], vec![hole(8.0)], false),
            (vec![hole(1.1)], vec![hole(8.0), bead(3.0)], true),
            (vec![hole(1.1)], vec![hole(1.2), bead(3.0)], false),
        ] {
            let (fewer, more) = (candidate(&fewer), candidate(&more));
            assert_eq!(fewer.beats(&more), beats);
            assert!(!more.beats(&fewer));
        }
    }
}
