//! Reproducible random poses.

use nalgebra::{Quaternion, UnitQuaternion};

use super::random::Random;
use crate::geometry::{Pose, Vector3};

/// A pose from a seed: rotation uniform over all rotations (Shoemake 1992), translation uniform
/// within ±5000 mm on each axis.
pub fn random_placement(seed: u64) -> Pose {
    let mut random = Random::new(seed);
    let (u, v, w) = (
        random.unit(),
        random.unit() * std::f64::consts::TAU,
        random.unit() * std::f64::consts::TAU,
    );
    let (low, high) = ((1.0 - u).sqrt(), u.sqrt());
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(
        high * w.cos(),
        low * v.sin(),
        low * v.cos(),
        high * w.sin(),
    ));
    let translation = Vector3::from_fn(|_, _| 10_000.0 * random.unit() - 5_000.0);
    Pose::from_parts(translation.into(), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placements_differ_repeat_and_spread() {
        assert_eq!(random_placement(7), random_placement(7));
        assert_ne!(random_placement(7), random_placement(8));
        let mean: Vector3 = (0..400)
            .map(|seed| random_placement(seed) * Vector3::z())
            .sum::<Vector3>()
            / 400.0;
        assert!(mean.norm() < 0.15, "{mean}");
    }
}
