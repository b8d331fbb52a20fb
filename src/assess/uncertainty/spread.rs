//! Small motions whose squares sum up, and how far they move places.

use serde::{Deserialize, Serialize};

use crate::assess::contact::Contacts;
use crate::assess::small_motion::{Six, turn_and_shift};
use crate::geometry::serial::xyz;
use crate::geometry::{Matrix3, Vector3};

/// A turn about the centre and a shift, in the target's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct SmallMotion {
    #[serde(with = "xyz")]
    pub(super) turn: Vector3,
    #[serde(with = "xyz")]
    pub(super) shift: Vector3,
}

impl SmallMotion {
    /// Of a motion given as in [`Contacts::row`].
    pub(super) fn of(six: &Six, contacts: &Contacts) -> Self {
        let [turn, shift] = turn_and_shift(six);
        Self {
            turn: turn / contacts.radius,
            shift,
        }
    }

    /// How it moves a place so far from the centre.
    pub(super) fn at(&self, arm: &Vector3) -> Vector3 {
        self.shift + self.turn.cross(arm)
    }
}

/// How far motions whose squares sum up move places: Σ |s + t × a|² over turns t and shifts s, as a function of the arm
/// a of a place, its vector from the centre.
pub(super) struct Spread {
    /// Σ s².
    constant: f64,
    /// Σ s × t.
    linear: Vector3,
    /// Σ t² 1 − t tᵀ.
    quadratic: Matrix3,
}

impl Spread {
    pub(super) fn of(motions: &[SmallMotion]) -> Self {
        let mut spread = Self {
            constant: 0.0,
            linear: Vector3::zeros(),
            quadratic: Matrix3::zeros(),
        };
        for SmallMotion { turn, shift } in motions {
            spread.constant += shift.norm_squared();
            spread.linear += shift.cross(turn);
            spread.quadratic += Matrix3::from_diagonal_element(turn.norm_squared());
            spread.quadratic -= turn * turn.transpose();
        }
        spread
    }

    pub(super) fn at(&self, arm: &Vector3) -> f64 {
        let square = self.constant + 2.0 * self.linear.dot(arm) + arm.dot(&(self.quadratic * arm));
        square.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_move_a_place_by_the_sum_of_the_squares_of_each() {
        let motions = [
            ([0.02, -0.01, 0.003], [1.0, 0.5, -2.0]),
            ([0.0, 0.0, 0.0], [0.0, 3.0, 0.1]),
            ([-0.05, 0.004, 0.02], [0.2, 0.0, 0.0]),
        ]
        .map(|(turn, shift)| SmallMotion {
            turn: Vector3::from(turn),
            shift: Vector3::from(shift),
        });
        for arm in [
            Vector3::zeros(),
            Vector3::new(300.0, -20.0, 7.0),
            Vector3::new(-1.0, 900.0, 40.0),
        ] {
            let squares = motions.iter().map(|by| by.at(&arm).norm_squared());
            let expected = squares.sum::<f64>().sqrt();
            let found = Spread::of(&motions).at(&arm);
            assert!((found - expected).abs() < 1e-12 * expected.max(1.0));
        }
        // A turn about the place itself, from a centre far away.
        let about = SmallMotion {
            turn: Vector3::z() * 0.01,
            shift: Vector3::y() * -10.0,
        };
        let still = Spread::of(&[about]).at(&Vector3::new(1000.0, 0.0, 0.0));
        assert!(still < 1e-6, "{still}");
    }
}
