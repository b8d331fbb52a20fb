//! Colour maps and the scales that put numbers on them. The legend, the texture on the graphics card
//! and the report all sample the functions here; there is no second copy in a shader.

mod cool_warm;
mod scale;
mod tables;

use serde::{Deserialize, Serialize};

pub use scale::{ColorScale, NEUTRAL, Pattern, UNMATCHED};

/// An sRGB colour, a byte per channel.
pub type Rgb = [u8; 3];

/// A map from 0 … 1 to colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// Dark blue to yellow, even in lightness; for one-sided values.
    #[default]
    Viridis,
    /// As viridis, made to look alike with and without a colour-vision deficiency.
    Cividis,
    /// Blue over light grey to red, both ends equally dark; for signed values.
    CoolWarm,
    /// The old fringe colours. Their lightness goes up and down, so only for comparison with old pictures.
    Rainbow,
    /// Light to dark grey; for prints and copies without colours. Values with a sign are the darker the
    /// farther they are from zero, and a pattern shows their side.
    Grey,
    /// Two colours, for two classes: a calm one below the middle, a loud one above.
    Classes,
    /// One colour for each status of a mapped element, in equal steps.
    Statuses,
    /// One colour for each stamped file, in equal steps.
    Files,
}

impl ColorMap {
    /// All maps to choose from, in menu order.
    pub const ALL: [Self; 5] = [
        Self::Viridis,
        Self::Cividis,
        Self::CoolWarm,
        Self::Grey,
        Self::Rainbow,
    ];

    /// Name in menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Viridis => "Viridis",
            Self::Cividis => "Cividis",
            Self::CoolWarm => "Cool–warm",
            Self::Grey => "Grey, for printing",
            Self::Rainbow => "Rainbow, like LS-PrePost",
            Self::Classes => "Two classes",
            Self::Statuses => "Statuses",
            Self::Files => "Files",
        }
    }

    /// Colour at `t`, clamped to 0 … 1; NaN counts as 0.
    pub fn sample(self, t: f64) -> Rgb {
        let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
        match self {
            Self::Viridis => between_stops(tables::VIRIDIS, t),
            Self::Cividis => between_stops(tables::CIVIDIS, t),
            Self::CoolWarm => cool_warm::sample(t),
            Self::Rainbow => between_stops(tables::RAINBOW, t),
            Self::Grey => [(235.0 - 185.0 * t).round() as u8; 3],
            Self::Classes if t < 0.5 => [0x9E, 0xC9, 0xE2],
            Self::Classes => [0xC9, 0x3B, 0x7F],
            Self::Statuses => {
                let n = tables::STATUSES.len();
                tables::STATUSES[((t * n as f64) as usize).min(n - 1)]
            }
            Self::Files => {
                let place = (t * f64::from(N_FILES)) as usize;
                tables::FILES[place.min(N_FILES as usize - 1) % tables::FILES.len()]
            }
        }
    }
}

/// Looks of stamped files: each colour plain, then each with lines over it.
const N_FILES: u32 = 2 * tables::FILES.len() as u32;

fn between_stops(stops: &[Rgb], t: f64) -> Rgb {
    let place = t * (stops.len() - 1) as f64;
    let below = (place as usize).min(stops.len() - 2);
    let share = place - below as f64;
    std::array::from_fn(|channel| {
        let from = f64::from(stops[below][channel]);
        let to = f64::from(stops[below + 1][channel]);
        (from + (to - from) * share).round() as u8
    })
}

/// The linear value of an sRGB value (IEC 61966-2-1), both 0 to 1.
pub(crate) fn linear_of_srgb(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness L* of an sRGB colour.
    fn lightness(color: Rgb) -> f64 {
        let linear = |byte: u8| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        let [r, g, b] = color.map(linear);
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 0.008856 {
            116.0 * y.cbrt() - 16.0
        } else {
            903.3 * y
        }
    }

    fn close(a: Rgb, b: Rgb, tolerance: u8) -> bool {
        (0..3).all(|i| a[i].abs_diff(b[i]) <= tolerance)
    }

    #[test]
    fn maps_pass_through_published_colours() {
        assert_eq!(ColorMap::Viridis.sample(0.0), [68, 1, 84]);
        assert_eq!(ColorMap::Viridis.sample(1.0), [253, 231, 37]);
        assert!(close(
            ColorMap::Viridis.sample(63.0 / 255.0),
            [59, 81, 139],
            2
        ));
        assert!(close(
            ColorMap::Cividis.sample(63.0 / 255.0),
            [66, 78, 108],
            2
        ));
        assert!(close(
            ColorMap::Cividis.sample(191.0 / 255.0),
            [187, 173, 109],
            2
        ));
        // Moreland 2009, table of the cool-warm map.
        assert!(close(ColorMap::CoolWarm.sample(0.0), [59, 76, 192], 1));
        assert!(close(ColorMap::CoolWarm.sample(0.5), [221, 221, 221], 1));
        assert!(close(ColorMap::CoolWarm.sample(1.0), [180, 4, 38], 1));
        assert!(close(ColorMap::CoolWarm.sample(0.25), [141, 176, 254], 2));
        assert!(close(ColorMap::CoolWarm.sample(0.75), [244, 154, 123], 2));
    }

    #[test]
    fn one_sided_maps_only_get_lighter() {
        for map in [ColorMap::Viridis, ColorMap::Cividis] {
            let steps: Vec<f64> = (0..=50)
                .map(|i| lightness(map.sample(f64::from(i) / 50.0)))
                .collect();
            assert!(steps.windows(2).all(|w| w[1] > w[0] - 0.3), "{map:?}");
        }
    }

    #[test]
    fn the_diverging_map_is_even_on_both_sides() {
        for i in 0..=10 {
            let t = f64::from(i) / 20.0;
            let (cold, warm) = (
                ColorMap::CoolWarm.sample(t),
                ColorMap::CoolWarm.sample(1.0 - t),
            );
            assert!((lightness(cold) - lightness(warm)).abs() < 3.0, "{t}");
        }
    }

    #[test]
    fn any_number_has_a_colour() {
        for map in ColorMap::ALL {
            assert_eq!(map.sample(f64::NAN), map.sample(0.0));
            assert_eq!(map.sample(f64::INFINITY), map.sample(1.0));
            assert_eq!(map.sample(-3.0), map.sample(0.0));
        }
    }
}
