//! How distances are coloured.

use serde::{Deserialize, Serialize};

use crate::app::Settings;
use crate::colormap::{ColorMap, ColorScale};
use crate::pipeline::inspect::Comparison;
use crate::role::PerRole;

/// Choices about the colours of distances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Coloring {
    /// Which parts carry the deviation.
    pub on: PerRole<bool>,
    /// The map of values with a sign.
    pub signed_map: ColorMap,
    /// The map of all other values.
    pub map: ColorMap,
    /// Maps are turned round.
    pub is_reversed: bool,
    /// So many plain colours instead of a smooth map.
    pub n_bands: Option<u8>,
    /// A pattern shows the sign too, for grey prints.
    pub has_pattern: bool,
    /// Values at the ends of the deviation's colours; `None` follows the values.
    pub limits: Option<[f64; 2]>,
    /// Half width of the neutral band; `None` follows the values.
    pub tolerance: Option<f64>,
    /// What lies beyond the limits of a map is not drawn, where they were set by hand: those that follow the values
    /// leave out the largest of them, which are looked for.
    pub hides_beyond: bool,
}

impl Default for Coloring {
    fn default() -> Self {
        Self {
            on: PerRole {
                crash: false,
                stamped: true,
            },
            signed_map: ColorMap::CoolWarm,
            map: ColorMap::Viridis,
            is_reversed: false,
            n_bands: None,
            has_pattern: false,
            limits: None,
            tolerance: None,
            hides_beyond: false,
        }
    }
}

impl Coloring {
    /// The same choices in the maps of the preferences.
    pub(in crate::app) fn with_maps_of(self, settings: &Settings) -> Self {
        Self {
            signed_map: settings.signed_map,
            map: settings.plain_map,
            ..self
        }
    }

    /// Puts the chosen map on a scale that is not that of the deviation.
    pub fn on_scale(&self, scale: ColorScale) -> ColorScale {
        ColorScale {
            map: self.map,
            n_bands: self.n_bands,
            reversed: self.is_reversed,
            ..scale
        }
    }

    /// The chosen colours of values with a sign that are no deviation, from −limit to limit.
    pub fn on_signed_scale(&self, limit: f64) -> ColorScale {
        ColorScale {
            map: self.signed_map,
            n_bands: self.n_bands,
            reversed: self.is_reversed,
            has_pattern: self.has_pattern,
            ..ColorScale::symmetric(limit, 0.0)
        }
    }

    /// The colours of a deviation; `limit` is the end of the automatic range.
    pub(super) fn deviation_scale(&self, is_signed: bool, limit: f64) -> ColorScale {
        let [min, max] = match self.limits {
            Some(limits) => limits,
            None if is_signed => [-limit, limit],
            None => [0.0, limit],
        };
        ColorScale {
            // Of the values, not of limits that were set by hand: a choice of colours changes no share.
            tolerance: self.tolerance.unwrap_or_else(|| round_quarter(limit)),
            is_signed,
            n_bands: self.n_bands,
            reversed: self.is_reversed,
            has_pattern: self.has_pattern,
            hides_beyond: self.hides_beyond && self.limits.is_some(),
            ..ColorScale::new(if is_signed { self.signed_map } else { self.map }, min, max)
        }
    }
}

/// The round end of the range that the values of a comparison ask for.
pub(super) fn own_limit(comparison: &Comparison) -> f64 {
    let deviation = &comparison.deviation;
    let ways = [&deviation.source_on_target, &deviation.target_on_source];
    let limits = ways.map(|way| way.stats.round_limit());
    limits[0].max(limits[1])
}

/// A quarter of a length, rounded down to 1, 2 or 5 times a power of ten.
fn round_quarter(length: f64) -> f64 {
    let quarter = length / 4.0;
    if !(quarter > 0.0 && quarter.is_finite()) {
        return 0.0;
    }
    let power = 10f64.powf(quarter.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|digit| digit * power);
    let fits = steps.into_iter().find(|&s| s <= quarter * (1.0 + 1e-9));
    fits.unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::round_quarter;

    #[test]
    fn tolerances_are_round() {
        let rounded = [2.0, 1.0, 0.5, 5.0, 10.0, 0.8, 0.0, f64::INFINITY].map(round_quarter);
        assert_eq!(rounded, [0.5, 0.2, 0.1, 1.0, 2.0, 0.2, 0.0, 0.0]);
    }
}
