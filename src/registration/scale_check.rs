//! Do the sizes of both meshes hint at different length units?

use serde::{Deserialize, Serialize};

use super::surface::Surface;
use crate::geometry::serial::any_float;

/// Factors between length units in use: mm, cm, m, inch, foot.
pub const UNIT_FACTORS: [(f64, &str); 8] = [
    (10.0, "cm and mm"),
    (25.4, "inch and mm"),
    (304.8, "foot and mm"),
    (1000.0, "m and mm"),
    (0.1, "mm and cm"),
    (1.0 / 25.4, "mm and inch"),
    (1.0 / 304.8, "mm and foot"),
    (0.001, "mm and m"),
];

/// What sizes and pairs say about the units of both meshes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScaleCheck {
    /// Target size over source size: root of the ratio of the surface areas.
    #[serde(with = "any_float")]
    pub size_ratio: f64,
    /// Scale that would fit the final pairs best; 1 for equal units.
    #[serde(with = "any_float")]
    pub pair_scale: f64,
    /// The unit factor that the source seems to need. A guess to be shown, never applied.
    pub unit: Option<UnitGuess>,
}

/// The name keeps serde from borrowing the words from its input.
type Words = &'static str;

/// A factor between length units; stored as the factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "f64", try_from = "f64")]
pub struct UnitGuess {
    /// Multiply the source by this.
    pub factor: f64,
    /// The units of source and target, in words.
    pub words: Words,
}

impl From<UnitGuess> for f64 {
    fn from(guess: UnitGuess) -> Self {
        guess.factor
    }
}

impl TryFrom<f64> for UnitGuess {
    type Error = String;

    fn try_from(factor: f64) -> Result<Self, String> {
        let known = UNIT_FACTORS.into_iter().find(|(known, _)| *known == factor);
        let guess = known.map(|(factor, words)| Self { factor, words });
        guess.ok_or_else(|| format!("{factor} is no factor between units"))
    }
}

impl ScaleCheck {
    pub(crate) fn new(source: &Surface, target: &Surface, pair_scale: f64) -> Self {
        let size_ratio = (target.measures().area / source.measures().area).sqrt();
        Self {
            size_ratio,
            pair_scale,
            unit: guess_unit(size_ratio),
        }
    }
}

/// The unit factor nearest to `size_ratio`, if it explains the ratio better than no factor does.
///
/// Parts that cover each other in part differ in size too, at the least overlap of 20 % by a factor
/// of about 2.2, so ratios below 4 are no hint.
pub fn guess_unit(size_ratio: f64) -> Option<UnitGuess> {
    let log = size_ratio.ln().abs();
    if !log.is_finite() || log < 4.0_f64.ln() {
        return None;
    }
    UNIT_FACTORS
        .into_iter()
        .map(|(factor, words)| (((size_ratio / factor).ln()).abs(), factor, words))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(off, ..)| *off < 3.0_f64.ln())
        .map(|(_, factor, words)| UnitGuess { factor, words })
}
