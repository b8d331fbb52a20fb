//! Poses from a few pairs of points that a person picked, with what is suspicious about them.

use super::RegistrationError;
use super::closed_form::{Motion, PairFit, umeyama};
use crate::geometry::Point3;

/// A pair is suspicious if the others put it so many times farther off than they lie themselves.
const FAR: f64 = 4.0;
/// Exchanging two partners is worth a word if it makes the fit so many times better.
const EXCHANGED: f64 = 4.0;
/// Distances below this share of the points' spread are negligible.
const NEGLIGIBLE: f64 = 1e-6;

/// What is probably wrong with picked pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairDoubt {
    /// One pair lies far from where all others put it.
    Far {
        /// Number of the pair, from 0.
        pair: usize,
        /// How far, in target length units.
        distance: f64,
    },
    /// Two pairs fit much better when they exchange their target points.
    Exchanged {
        /// Which two, the lower number first.
        pairs: [usize; 2],
        /// Root mean square distance of all pairs after the exchange.
        rmse: f64,
    },
    /// The pairs speak for the opposite hand.
    Mirrored {
        /// Root mean square distance of the mirrored fit.
        rmse: f64,
    },
}

/// The best motion for picked pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct PointPairFit {
    /// The fit of all pairs.
    pub fit: PairFit,
    /// Distance of each pair after the motion, in target length units.
    pub residuals: Vec<f64>,
    /// The most severe doubt, if there is one.
    pub doubt: Option<PairDoubt>,
}

impl PointPairFit {
    /// The pair with the largest residual, if it is one to speak of.
    pub fn worst(&self) -> Option<usize> {
        let pairs = self.residuals.iter().enumerate();
        let (pair, residual) = pairs.max_by(|a, b| a.1.total_cmp(b.1))?;
        (*residual > self.fit.rmse && *residual > 0.0).then_some(pair)
    }
}

/// Lays `source` on `target` rigidly, point by point ([`umeyama`]), and asks which pair does not go with
/// the others: from four pairs on each is left out once and measured by the fit of the rest, and the
/// partners of any two are exchanged for trial. O(n³), for a handful of points.
///
/// Fewer than three pairs, coinciding and collinear points are errors.
pub fn fit_point_pairs(
    source: &[Point3],
    target: &[Point3],
) -> Result<PointPairFit, RegistrationError> {
    let fit = umeyama(source, target, Motion::Rigid)?;
    let distance = |(x, y): (&Point3, &Point3)| (fit.target_from_source.apply(x) - y).norm();
    let residuals = source.iter().zip(target).map(distance).collect();
    let noise = NEGLIGIBLE * spread(target);
    // Of two explanations the one that leaves less counts; one point fewer explains too much.
    let whole = [
        mirrored(&fit, noise),
        exchanged(source, target, fit.rmse, noise),
    ];
    let doubt = whole
        .into_iter()
        .flatten()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, doubt)| doubt)
        .or_else(|| far(source, target, noise));
    Ok(PointPairFit {
        fit,
        residuals,
        doubt,
    })
}

/// Largest distance from the first point.
fn spread(points: &[Point3]) -> f64 {
    let far = points.iter().map(|p| (p - points[0]).norm());
    far.fold(0.0, f64::max)
}

/// What two exchanged partners would leave, with the doubt.
fn exchanged(
    source: &[Point3],
    target: &[Point3],
    rmse: f64,
    noise: f64,
) -> Option<(f64, PairDoubt)> {
    let mut best: Option<([usize; 2], f64)> = None;
    for a in 0..target.len() {
        for b in a + 1..target.len() {
            let mut trial = target.to_vec();
            trial.swap(a, b);
            let Ok(fit) = umeyama(source, &trial, Motion::Rigid) else {
                continue;
            };
            if best.is_none_or(|(_, rmse)| fit.rmse < rmse) {
                best = Some(([a, b], fit.rmse));
            }
        }
    }
    let (pairs, after) = best?;
    let is_better = rmse > noise && EXCHANGED * after.max(noise) < rmse;
    is_better.then_some((after, PairDoubt::Exchanged { pairs, rmse: after }))
}

fn far(source: &[Point3], target: &[Point3], noise: f64) -> Option<PairDoubt> {
    if source.len() < 4 {
        return None;
    }
    let without = |pair: usize| {
        let keep = |points: &[Point3]| {
            let mut rest = points.to_vec();
            rest.remove(pair);
            rest
        };
        let fit = umeyama(&keep(source), &keep(target), Motion::Rigid).ok()?;
        let off = (fit.target_from_source.apply(&source[pair]) - target[pair]).norm();
        Some((pair, off, fit.rmse))
    };
    let found = (0..source.len()).filter_map(without);
    let (pair, distance, rmse) = found.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance > FAR * rmse.max(noise)).then_some(PairDoubt::Far { pair, distance })
}

/// What the mirrored fit leaves, with the doubt.
fn mirrored(fit: &PairFit, noise: f64) -> Option<(f64, PairDoubt)> {
    let rmse = fit.mirrored_rmse;
    let is_better = fit.rmse > noise && EXCHANGED * rmse.max(noise) < fit.rmse;
    is_better.then_some((rmse, PairDoubt::Mirrored { rmse }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation, Similarity, Vector3};

    fn pairs() -> (Vec<Point3>, Vec<Point3>, Similarity) {
        let turn = Rotation::new(Vector3::new(0.4, -1.1, 0.7));
        let pose = Similarity {
            rotation: *turn.to_rotation_matrix().matrix(),
            translation: Vector3::new(900.0, -40.0, 310.0),
            scale: 1.0,
        };
        let source: Vec<Point3> = [
            [0.0, 0.0, 0.0],
            [310.0, 12.0, 5.0],
            [20.0, 180.0, -9.0],
            [290.0, 210.0, 44.0],
            [150.0, 90.0, 60.0],
        ]
        .into_iter()
        .map(Point3::from)
        .collect();
        let target = source.iter().map(|point| pose.apply(point)).collect();
        (source, target, pose)
    }

    #[test]
    fn exact_pairs_give_the_pose_without_doubt() {
        let (source, target, pose) = pairs();
        for n in 3..=5 {
            let found = fit_point_pairs(&source[..n], &target[..n]).unwrap();
            let off = pose.max_displacement(&found.fit.target_from_source, &source);
            assert!(off < 1e-9, "{n} pairs: {off}");
            assert_eq!(found.doubt, None, "{n} pairs");
        }
    }

    #[test]
    fn a_pair_that_is_off_is_named_with_its_distance() {
        let (source, mut target, _) = pairs();
        target[2] += Vector3::new(0.0, 3.0, 3.0);
        let found = fit_point_pairs(&source, &target).unwrap();
        assert_eq!(found.worst(), Some(2));
        let Some(PairDoubt::Far { pair: 2, distance }) = found.doubt else {
            panic!("{:?}", found.doubt);
        };
        assert!((distance - 18.0_f64.sqrt()).abs() < 1e-6, "{distance}");
    }

    #[test]
    fn partners_that_were_exchanged_are_named() {
        let (source, mut target, _) = pairs();
        target.swap(1, 3);
        let found = fit_point_pairs(&source, &target).unwrap();
        let Some(PairDoubt::Exchanged { pairs, rmse }) = found.doubt else {
            panic!("{:?}", found.doubt);
        };
        assert_eq!(pairs, [1, 3]);
        assert!(rmse < 1e-9);
    }

    #[test]
    fn the_opposite_hand_is_told() {
        let (mut source, target, _) = pairs();
        for point in &mut source {
            point.x = -point.x;
        }
        let found = fit_point_pairs(&source, &target).unwrap();
        assert!(matches!(found.doubt, Some(PairDoubt::Mirrored { rmse }) if rmse < 1e-6));
    }

    #[test]
    fn points_that_fix_no_pose_are_refused() {
        let (source, target, _) = pairs();
        let few = fit_point_pairs(&source[..2], &target[..2]);
        assert_eq!(few, Err(RegistrationError::TooFewPairs { n_pairs: 2 }));
        let line: Vec<Point3> = (0..4)
            .map(|i| Point3::new(f64::from(i), 0.0, 0.0))
            .collect();
        let on_line = fit_point_pairs(&line, &target[..4]);
        assert_eq!(on_line, Err(RegistrationError::CollinearPoints));
    }
}
