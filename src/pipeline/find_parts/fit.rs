//! How well a stamped part fits a crash part, and whether the right one is there at all.

use crate::assess::Verdict;
use crate::pipeline::likeness::AS_ALIKE;
use crate::pipeline::load::SAME_GAUGE;

/// They do if their surfaces lie at most so many times as far apart, or farther by a distance that means nothing.
const AS_CLOSE: f64 = 1.25;
/// Where the best leaves something to look at, others are tried too, but for those that are less alike than this, if
/// the two cover each other by so much.
const MUCH_LESS_ALIKE: f64 = 0.8;
const WELL_COVERED: f64 = 0.8;
/// A part that is covered by so much more is another than the first.
const MORE_COVERED: f64 = 0.15;
/// Surfaces that differ by so many tolerances are hardly those of one part,
const HARDLY_ONE_SHAPE: f64 = 2.0;
/// and none is right if so many signs say so: parts of other shapes that lie at most so many times as far apart or
/// differ as little, and another gauge.
const SIGNS: usize = 2;
const NO_CLOSER: f64 = 1.5;

/// How well a stamped part fits.
#[derive(Debug, Clone, Copy)]
pub struct Fit {
    pub(super) verdict: Verdict,
    /// Whether what is left to look at is the pose and not the shape.
    pub(super) is_one_shape: bool,
    /// Share of the stamped part that lies on the crash part, times that of the crash part.
    pub(super) covered: f64,
    /// Holes of one part where the other is solid.
    pub(super) n_holes_apart: usize,
    /// RMS of the distances.
    pub(in crate::pipeline) rmse: f64,
    /// Distances up to this mean nothing.
    pub(super) unremarkable: f64,
    /// How far the shapes differ, bends counted and facets not.
    pub(super) apart: f64,
    /// How far they differ beside bends, in tolerances.
    pub(super) remainder: f64,
    /// The stamped part is taken for one of the other hand.
    pub(super) is_mirrored: bool,
}

impl Fit {
    /// Of two parts of the stamped part's shape the one that is covered more is right, however certain the poses
    /// are: a reinforcement has the shape of the part under it, and so has that part with its reinforcement.
    /// Holes tell parts of one surface from each other, which distances do not. Of two parts that fit about as well
    /// it is the one of its own hand: a car has both.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        let more = self.covered - other.covered;
        if self.is_one_shape && other.is_one_shape && more.abs() > MORE_COVERED {
            return more > 0.0;
        }
        let key = |fit: &Self| (fit.verdict != Verdict::Good, fit.n_holes_apart);
        let order = key(self).cmp(&key(other));
        if order.is_eq()
            && self.is_mirrored != other.is_mirrored
            && self.is_as_close_as(other)
            && other.is_as_close_as(self)
        {
            return other.is_mirrored;
        }
        order.then(self.rmse.total_cmp(&other.rmse)).is_lt()
    }

    /// True if the distances do not tell which of both is right, nor do the holes, and it is covered hardly less. A
    /// verdict does not either where the other part lies clearly closer: something to look at, such as a coarse hole,
    /// is no twin.
    pub(super) fn is_as_good_as(&self, best: &Self) -> bool {
        let is_judged_alike = self.verdict == best.verdict || AS_CLOSE * self.rmse <= best.rmse;
        // Distances are those of what overlaps.
        let is_covered = self.covered >= best.covered - MORE_COVERED;
        is_judged_alike
            && is_covered
            && self.n_holes_apart <= best.n_holes_apart
            && self.is_as_close_as(best)
    }

    /// Parts whose likeness is less than so many times that of this one need not be tried; `None` where any may be
    /// right.
    pub(super) fn least_alike(&self) -> Option<f64> {
        if self.is_one_shape {
            Some(AS_ALIKE)
        } else {
            (self.covered >= WELL_COVERED).then_some(MUCH_LESS_ALIKE)
        }
    }

    /// By distances, or by shapes: of a twin with larger elements the facets lie farther off.
    pub(in crate::pipeline) fn is_as_close_as(&self, other: &Self) -> bool {
        let is_close =
            |own: f64, other: f64| own <= (AS_CLOSE * other).max(other + self.unremarkable);
        is_close(self.rmse, other.rmse) || is_close(self.apart, other.apart)
    }
}

/// Whether the crash part that a stamped part belongs to is among those that were asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Presence {
    /// Nothing speaks against it.
    Likely,
    /// The surfaces of the best differ by so many tolerances.
    Doubtful(f64),
    /// So do those of the best, parts of other shapes lie about as close, and all in all none is right.
    Absent {
        /// Ids of these parts, the best first.
        parts: Vec<u64>,
        /// Mean thickness of the stamped part over that of the best, where that is another gauge.
        gauge: Option<f64>,
    },
}

impl Presence {
    /// What the fit of the `best` part says beside those of parts that have `other_shapes`, one for each shape. `gauge`
    /// is the thickness of the stamped part over that of the best.
    pub(super) fn of(
        (best, fit): (u64, &Fit),
        other_shapes: &[(u64, Fit)],
        gauge: Option<f64>,
    ) -> Self {
        if fit.remainder <= HARDLY_ONE_SHAPE {
            return Self::Likely;
        }
        let is_close = |other: &Fit| other.rmse <= NO_CLOSER * fit.rmse;
        let close = other_shapes
            .iter()
            .filter(|(_, other)| is_close(other) || other.is_as_close_as(fit));
        let mut parts = vec![best];
        parts.extend(close.map(|(id, _)| *id));
        let gauge = gauge.filter(|gauge| !SAME_GAUGE.contains(gauge));
        // Another version of the part has its gauge and lies closer than any other part.
        if parts.len() > 1 && parts.len() - 1 + usize::from(gauge.is_some()) >= SIGNS {
            Self::Absent { parts, gauge }
        } else {
            Self::Doubtful(fit.remainder)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(verdict: Verdict, n_holes_apart: usize, rmse: f64) -> Fit {
        Fit {
            verdict,
            is_one_shape: verdict == Verdict::Good,
            covered: 1.0,
            n_holes_apart,
            rmse,
            unremarkable: 0.1,
            apart: rmse,
            remainder: 0.0,
            is_mirrored: false,
        }
    }

    #[test]
    fn holes_choose_between_parts_of_one_surface() {
        let own = fit(Verdict::Good, 0, 0.45);
        let without_holes = fit(Verdict::Good, 3, 0.44);
        assert!(own.is_better_than(&without_holes) && !without_holes.is_better_than(&own));
        assert!(!without_holes.is_as_good_as(&own));
        let copy = fit(Verdict::Good, 0, 0.46);
        assert!(own.is_better_than(&copy) && copy.is_as_good_as(&own));
        let in_part = Fit {
            covered: 0.6,
            ..copy
        };
        assert!(!in_part.is_as_good_as(&own));
        let other_hand = Fit {
            is_mirrored: true,
            ..fit(Verdict::Good, 0, 0.44)
        };
        assert!(own.is_better_than(&other_hand) && !other_hand.is_better_than(&own));
        assert!(other_hand.is_as_good_as(&own));
        let [far, coarse] = [fit(Verdict::Good, 0, 0.6), fit(Verdict::Good, 0, 0.1)];
        assert!(coarse.is_as_good_as(&fit(Verdict::Good, 0, 0.01)));
        assert!(!far.is_as_good_as(&own));
        // Its facets explain how far it lies.
        let coarse_copy = Fit { apart: 0.45, ..far };
        assert!(coarse_copy.is_as_good_as(&own));
        let bent = fit(Verdict::Check, 0, 0.4);
        assert!(without_holes.is_better_than(&bent) && !bent.is_as_good_as(&own));
        // The twin of the own part may be judged better, and is told then.
        let [closer, twin] = [fit(Verdict::Check, 0, 0.35), fit(Verdict::Good, 0, 1.28)];
        assert!(twin.is_better_than(&closer) && closer.is_as_good_as(&twin));
    }

    #[test]
    fn the_part_under_a_reinforcement_is_better_than_the_reinforcement() {
        let with = |verdict, covered, is_one_shape| Fit {
            covered,
            is_one_shape,
            ..fit(verdict, 0, 0.1)
        };
        let ambiguous = with(Verdict::Check, 1.0, true);
        let reinforcement = with(Verdict::Good, 0.61, true);
        assert!(ambiguous.is_better_than(&reinforcement));
        assert!(!reinforcement.is_better_than(&ambiguous));
        // A part of another shape is none, however much lies on it.
        let other = with(Verdict::Check, 1.0, false);
        assert!(reinforcement.is_better_than(&other));
        // Of parts covered alike the verdict decides.
        let alike = with(Verdict::Good, 0.95, true);
        assert!(alike.is_better_than(&ambiguous));
    }

    #[test]
    fn parts_much_less_alike_than_one_that_is_covered_are_not_tried() {
        let good = fit(Verdict::Good, 0, 0.1);
        let covered = fit(Verdict::Check, 0, 0.1);
        let in_part = Fit {
            covered: 0.5,
            ..covered
        };
        let least = [good, covered, in_part].map(|fit| fit.least_alike());
        assert_eq!(least, [Some(AS_ALIKE), Some(MUCH_LESS_ALIKE), None]);
    }

    #[test]
    fn several_shapes_that_fit_as_badly_say_that_the_part_is_not_there() {
        let with = |rmse, remainder| Fit {
            remainder,
            ..fit(Verdict::Check, 0, rmse)
        };
        let best = with(2.1, 5.5);
        let others = [
            (2, with(2.6, 4.2)),
            (3, with(2.7, 5.2)),
            (4, with(3.4, 3.4)),
        ];
        let presence = |n: usize, gauge| Presence::of((1, &best), &others[..n], gauge);
        let absent = |parts: &[u64], gauge| Presence::Absent {
            parts: parts.to_vec(),
            gauge,
        };
        assert_eq!(presence(3, Some(0.95)), absent(&[1, 2, 3], None));
        assert_eq!(presence(1, Some(0.65)), absent(&[1, 2], Some(0.65)));
        // Another version of the part, or one of another gauge, is looked at.
        assert_eq!(presence(1, Some(0.95)), Presence::Doubtful(5.5));
        assert_eq!(presence(0, Some(0.65)), Presence::Doubtful(5.5));
        let sure = with(0.8, 0.3);
        assert_eq!(Presence::of((1, &sure), &others, None), Presence::Likely);
    }
}
