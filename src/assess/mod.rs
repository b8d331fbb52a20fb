//! Is the pose right? Distances, uncertainty and shape are measured anew on the full meshes; scores of alternatives
//! and of the opposite hand are those of the search.
//!
//! From the bottom up: `tolerance` limits how far parts may differ; `least_squares` has the normal equations of all
//! that is fitted; `contact` and `borders` find where two parts meet under a pose, `evidence` joins what they found,
//! `fit` splits the gaps into a motion, an offset and bends; `trims`, `outline_shift`, `stretch` and `shape` measure
//! how the parts differ, `free_motion` how far the surfaces hold the part, `uncertainty` how far the pose may be off.
//! `statements` makes the statements about a pose from them, and `decide` makes the verdict of an [`Assessment`]. The
//! layer above, `settling`, chooses the pose by the same measures before it is assessed.

mod ambiguity;
mod assessment;
pub(crate) mod border_curve;
pub(crate) mod borders;
pub(crate) mod contact;
mod coverage;
mod decide;
pub mod deviation;
pub(crate) mod evidence;
pub(crate) mod fit;
pub(crate) mod free_motion;
mod jackknife;
pub(crate) mod least_squares;
mod outline_pieces;
mod outline_shift;
mod pose;
mod reason;
mod scaled;
pub(crate) mod shape;
mod small_motion;
pub(crate) mod statements;
mod stretch;
pub(crate) mod tolerance;
pub(crate) mod trims;
mod uncertainty;
mod verdict;
mod words;

pub use ambiguity::{Ambiguity, Clarity, Twin, TwinAxis};
pub use assessment::{AlternativeStatements, Assessment};
use coverage::coverage_and_near;
pub use coverage::{Coverage, OneSided, coverage, overlap_limit, quick_overlap};
pub use free_motion::{FreeMotion, FreeMotionKind, Freedom, free_motions};
pub use outline_pieces::OutlinePieces;
pub use pose::{PoseKind, PoseStatement};
pub use reason::Reason;
pub use shape::{BentEnd, BorderFit, ShapeKind, ShapeReason, ShapeStatement};
pub use stretch::PartAxis;
pub use tolerance::{AssessSettings, ShapeTolerance};
pub use trims::BorderApart;
pub use uncertainty::{PartDirection, PoseUncertainty};
pub use verdict::Verdict;
pub use words::{alternative_words, as_well, beside, fit_beside, fit_of_hand, likely_beside};

use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{MatchOutcome, Surface};
use decide::{Grounds, decide};
use statements::{Asked, Statements, mirrored_statement, statements};
use tolerance::Distances;

/// Assesses the pose of `outcome` on the full meshes. O(vertices · log triangles).
pub fn assess(
    source: &Surface,
    target: &Surface,
    outcome: &MatchOutcome,
    settings: &AssessSettings,
    monitor: &Monitor,
) -> Result<Assessment, Cancelled> {
    let pose = &outcome.target_from_source;
    let limit = settings
        .limit
        .unwrap_or_else(|| overlap_limit(source, target, pose.scale, settings.allowance));
    monitor.progress("verify", 0, Some(2));
    let pair = [source, target];
    let Distances {
        noise,
        tolerance,
        reach,
        free_limit,
        ..
    } = Distances::of(source, target, pose.scale, settings);
    let (coverage, near) = coverage_and_near(pair, pose, limit, reach, monitor)?;
    monitor.progress("verify", 1, Some(2));
    let freedom = free_motions(source, target, pose, free_limit);
    monitor.check()?;
    let mut ambiguity = Ambiguity::of(&outcome.alternatives);
    if ambiguity.clarity != Clarity::Clear {
        let other = outcome.alternatives.first();
        ambiguity.twin = other.map(|a| Twin::of(source, pose, &a.target_from_source));
    }
    let asked = Asked {
        motion: freedom.motion.as_ref(),
        near,
    };
    let Statements {
        uncertainty,
        shape,
        held_across,
    } = statements(pair, pose, asked, settings);
    monitor.check()?;
    let mut assessment = Assessment {
        verdict: Verdict::Good,
        reasons: Vec::new(),
        coverage,
        ambiguity,
        freedom,
        scale_check: outcome.scale_check,
        mirror_check: outcome.mirror_check,
        noise,
        pose: Some(PoseStatement {
            kind: PoseKind::Certain,
            uncertainty,
            tolerance: tolerance.of_pose(shape.springback, settings.length_of_millimetre()),
        }),
        shape: None,
    };
    // The ends of the part lie half a diagonal from its middle.
    let most_bent = tolerance.springback / (0.5 * target.measures().diagonal);
    let most_scaled = most_bent + scale_of_offset(target, shape.offset.unwrap_or(0.0));
    let mirrored = mirrored_statement(pair, outcome, settings);
    monitor.check()?;
    let grounds = Grounds {
        outcome,
        shape: &shape,
        held_across,
        mirrored: mirrored.as_ref(),
        most_scaled,
        settings,
    };
    decide(&mut assessment, &grounds);
    let is_comparable = !assessment.reasons.iter().any(Reason::is_of_units);
    let is_told = |&difference| assessment.reasons.contains(&Reason::Shape { difference });
    let is_one = is_comparable && !shape.reasons.iter().all(is_told);
    let shape = if is_one {
        shape.of_one_part(noise)
    } else {
        shape
    };
    assessment.shape = is_comparable.then_some(shape);
    monitor.progress("verify", 2, Some(2));
    Ok(assessment)
}

/// How far an offset of the sheets takes the scale of the pairs from 1: a tube is wider at its outer skin.
/// O(triangles).
fn scale_of_offset(surface: &Surface, offset: f64) -> f64 {
    let (mesh, measures) = (surface.mesh(), surface.measures());
    // All points of a triangle's plane lie equally far out.
    let outward = (0..mesh.n_triangles()).map(|triangle| {
        let [corner, ..] = mesh.corners(triangle);
        mesh.area_vector(triangle)
            .dot(&(corner - measures.centroid))
    });
    let size_sq = measures.area * measures.principal_spread.norm_squared();
    if size_sq > 0.0 {
        (offset * outward.sum::<f64>() / size_sq).abs()
    } else {
        0.0
    }
}

/// The two statements about an alternative, on the full meshes. O(border edges + nodes · log triangles).
pub fn assess_alternative(
    source: &Surface,
    target: &Surface,
    pose: &Similarity,
    settings: &AssessSettings,
) -> AlternativeStatements {
    let tolerance = Distances::of(source, target, pose.scale, settings).tolerance;
    let Statements {
        uncertainty, shape, ..
    } = statements([source, target], pose, Asked::default(), settings);
    AlternativeStatements {
        pose: PoseStatement {
            kind: PoseKind::Ambiguous,
            uncertainty,
            tolerance: tolerance.of_pose(shape.springback, settings.length_of_millimetre()),
        },
        shape,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, TriMesh};

    /// A piece of a tube of radius 10 and length 40, of so many sides of 3°.
    fn tube(n_sides: u32) -> Surface {
        let n_along = 20;
        let points = (0..=n_sides).flat_map(|i| {
            let angle = f64::from(3 * i).to_radians();
            (0..=n_along).map(move |j| {
                let along = 40.0 * f64::from(j) / f64::from(n_along);
                Point3::new(10.0 * angle.cos(), 10.0 * angle.sin(), along)
            })
        });
        let up = n_along + 1;
        let cells = (0..n_sides * n_along).map(|k| k / n_along * up + k % n_along);
        let triangles = cells.flat_map(|a| [[a, a + up, a + 1], [a + 1, a + up, a + up + 1]]);
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "tube").unwrap()
    }

    #[test]
    fn an_offset_scales_a_tube_and_no_plate() {
        // Radius over the mean square distance from the middle: 10² + 40² / 12.
        let expected = 10.0 / (100.0 + 1600.0 / 12.0);
        for offset in [1.0, -0.5] {
            let of_tube = scale_of_offset(&tube(119), offset);
            assert!((of_tube / offset.abs() - expected).abs() < 0.02 * expected);
        }
        let nearly_flat = scale_of_offset(&tube(3), 1.0);
        assert!(nearly_flat < 1e-3, "{nearly_flat}");
        assert_eq!(scale_of_offset(&tube(119), 0.0), 0.0);
    }
}
