//! Do the sizes of both meshes hint at different length units?

use serde::{Deserialize, Serialize};

use super::surface::Surface;
use crate::geometry::serial::any_float;
use crate::units::LengthUnit;

/// What sizes and pairs show of the units of both meshes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScaleCheck {
    /// Target size over source size under the scale of the pose: root of the ratio of the surface areas.
    #[serde(with = "any_float")]
    pub size_ratio: f64,
    /// Scale that would fit the final pairs best; 1 for equal units.
    #[serde(with = "any_float")]
    pub pair_scale: f64,
    /// The unit factor that the source seems to need. A guess to be shown, never applied.
    pub unit: Option<UnitGuess>,
}

/// The length units that the files seem to be in; stored as the factor between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "f64", try_from = "f64")]
pub struct UnitGuess {
    /// Of the source.
    pub source: LengthUnit,
    /// Of the target.
    pub target: LengthUnit,
}

impl UnitGuess {
    /// Lengths of the source are multiplied by this to be lengths of the target.
    pub fn factor(self) -> f64 {
        self.source.factor_to(self.target)
    }

    /// Whether sizes differ by the factor between the units, and not only about by it.
    pub(crate) fn is_factor_of(self, size_ratio: f64) -> bool {
        (size_ratio / self.factor()).ln().abs() < SAME_FACTOR.ln()
    }

    /// How many times as large the larger part is: by the factor between the units where the sizes differ by it.
    pub fn times(self, size_ratio: f64) -> f64 {
        let times = if self.is_factor_of(size_ratio) {
            self.factor()
        } else {
            size_ratio
        };
        times.max(times.recip())
    }

    /// Every other unit against millimetres, in which sheet parts are modelled.
    fn all() -> impl Iterator<Item = Self> {
        let mm = LengthUnit::Millimeter;
        let others = LengthUnit::ALL.into_iter().filter(move |&unit| unit != mm);
        others.flat_map(move |unit| {
            let guess = |source, target| Self { source, target };
            [guess(unit, mm), guess(mm, unit)]
        })
    }
}

impl From<UnitGuess> for f64 {
    fn from(guess: UnitGuess) -> Self {
        guess.factor()
    }
}

impl TryFrom<f64> for UnitGuess {
    type Error = String;

    fn try_from(factor: f64) -> Result<Self, String> {
        let is_it = |guess: &Self| (guess.factor() / factor - 1.0).abs() < 1e-9;
        let known = Self::all().find(is_it);
        known.ok_or_else(|| format!("{factor} is no factor between units"))
    }
}

impl ScaleCheck {
    /// Under a pose of scale `scale`.
    pub(crate) fn new([source, target]: [&Surface; 2], scale: f64, pair_scale: f64) -> Self {
        let size_ratio = (target.measures().area / source.measures().area).sqrt() / scale;
        Self {
            size_ratio,
            pair_scale,
            unit: guess_unit(size_ratio),
        }
    }
}

/// Parts that cover each other in part differ in size too, at the least overlap of 20 % by a factor of about
/// 2.2: smaller ratios than this are no hint.
const LEAST_RATIO: f64 = 4.0;
/// The ratio of the sizes may differ from the factor between units in which parts are usually modelled by this factor.
const NEAR_FACTOR: f64 = 1.7;
/// It may differ by this one from a factor to or from a unit in which parts rarely are: any two parts come near one by
/// chance.
const NEAR_RARE_FACTOR: f64 = 1.1;

/// Sizes that differ by the factor between units, to within this one, are those of one part in two units.
const SAME_FACTOR: f64 = 1.05;

/// The unit factor nearest to `size_ratio`, if it comes near one.
pub fn guess_unit(size_ratio: f64) -> Option<UnitGuess> {
    let log = size_ratio.ln().abs();
    if !log.is_finite() || log < LEAST_RATIO.ln() {
        return None;
    }
    let near = |guess: &UnitGuess| {
        let is_usual = |unit| !matches!(unit, LengthUnit::Centimeter | LengthUnit::Foot);
        if is_usual(guess.source) && is_usual(guess.target) {
            NEAR_FACTOR.ln()
        } else {
            NEAR_RARE_FACTOR.ln()
        }
    };
    UnitGuess::all()
        .map(|guess| ((size_ratio / guess.factor()).ln().abs(), guess))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(off, guess)| *off < near(guess))
        .map(|(_, guess)| guess)
}
