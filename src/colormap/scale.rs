//! From a value to a place on a colour map.

use super::{ColorMap, N_FILES, Rgb};

/// Colour of values inside the tolerance band: the middle of the diverging map.
pub const NEUTRAL: Rgb = [221, 221, 221];
/// Colour of places without a value; drawn with a hatch as the second carrier.
pub const UNMATCHED: Rgb = [138, 141, 146];

/// A colour map with the numbers at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorScale {
    /// Colour map the values are looked up in.
    pub map: ColorMap,
    /// Value at the lower end; smaller values take its colour.
    pub min: f64,
    /// Value at the upper end; larger values take its colour.
    pub max: f64,
    /// Values within ± this and between the ends are neutral; 0 for no band.
    pub tolerance: f64,
    /// Zero takes the middle of a map that has one, wherever the ends are.
    pub is_signed: bool,
    /// Cuts the map into this many plain colours (2 … 32); `None` for a smooth map.
    pub n_bands: Option<u8>,
    /// Turns the map round.
    pub reversed: bool,
    /// A pattern shows the sign of values beyond the tolerance, for those who do not see the hues.
    pub has_pattern: bool,
    /// What has a value beyond the ends is not drawn.
    pub hides_beyond: bool,
}

/// What is drawn over the colour of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pattern {
    /// The colour alone.
    #[default]
    Plain,
    /// Horizontal lines: a negative value.
    Lines,
    /// Dots: a positive value.
    Dots,
    /// Lines that rise to the right.
    Rising,
    /// Lines that fall to the right.
    Falling,
    /// Both.
    Crossed,
}

/// Number of statuses of a mapped element.
const N_STATUSES: f64 = 9.0;
/// Patterns of the statuses: those without values are told by their pattern alone too.
const STATUS_PATTERNS: [Pattern; 9] = [
    Pattern::Plain,
    Pattern::Dots,
    Pattern::Lines,
    Pattern::Dots,
    Pattern::Lines,
    Pattern::Rising,
    Pattern::Falling,
    Pattern::Crossed,
    Pattern::Lines,
];

impl ColorScale {
    /// A smooth map from `min` to `max`.
    pub fn new(map: ColorMap, min: f64, max: f64) -> Self {
        Self {
            map,
            min,
            max,
            tolerance: 0.0,
            is_signed: false,
            n_bands: None,
            reversed: false,
            has_pattern: false,
            hides_beyond: false,
        }
    }

    /// The statuses of mapped elements, counted from 0 from best to worst.
    pub fn statuses() -> Self {
        Self::new(ColorMap::Statuses, -0.5, N_STATUSES - 0.5)
    }

    /// The stamped files, counted from 0 as [`ColorScale::file_value`] says.
    pub fn files() -> Self {
        Self::new(ColorMap::Files, -0.5, f64::from(N_FILES) - 0.5)
    }

    /// The value of a stamped file on the scale of the files, by its number; looks return after the last.
    pub fn file_value(number: usize) -> f64 {
        (number % N_FILES as usize) as f64
    }

    /// The colour of a stamped file, and whether a pattern tells it from another file of that colour: a hatch on
    /// surfaces, dashes on lines.
    pub fn file_look(number: usize) -> (Rgb, bool) {
        let (scale, value) = (Self::files(), Self::file_value(number));
        (scale.color(value), scale.pattern(value) != Pattern::Plain)
    }

    /// The diverging map from `-limit` to `limit` with a neutral band of ± `tolerance`.
    pub fn symmetric(limit: f64, tolerance: f64) -> Self {
        Self {
            tolerance,
            is_signed: true,
            ..Self::new(ColorMap::CoolWarm, -limit, limit)
        }
    }

    /// Place of a value between the ends, 0 … 1 and clamped; 0.5 if the ends coincide or the value is
    /// not a number.
    pub fn position(&self, value: f64) -> f64 {
        let t = (value - self.min) / (self.max - self.min);
        if t.is_nan() || self.max == self.min {
            0.5
        } else {
            t.clamp(0.0, 1.0)
        }
    }

    /// True for a value beyond the ends whose place is not drawn.
    pub fn hides(&self, value: f64) -> bool {
        self.hides_beyond && (value < self.min || value > self.max)
    }

    /// The value at a place between the ends.
    pub fn value_at(&self, position: f64) -> f64 {
        self.min + (self.max - self.min) * position
    }

    /// Colour of a value; [`UNMATCHED`] for NaN.
    pub fn color(&self, value: f64) -> Rgb {
        if value.is_nan() {
            return UNMATCHED;
        }
        if self.is_tolerated(value) && self.is_between(value) {
            return NEUTRAL;
        }
        let t = if self.is_folded() {
            value.abs() / self.max.abs().max(self.min.abs())
        } else if self.is_signed && self.map == ColorMap::CoolWarm {
            self.position_about_zero(value)
        } else {
            self.position(value)
        };
        self.color_at(t)
    }

    /// Colour at a place of the map, 0 … 1.
    fn color_at(&self, t: f64) -> Rgb {
        let t = match self.n_bands {
            Some(n) => {
                let n = f64::from(n.clamp(2, 32));
                (t * n).floor().min(n - 1.0) / (n - 1.0)
            }
            None => t,
        };
        self.map.sample(if self.reversed { 1.0 - t } else { t })
    }

    fn is_between(&self, value: f64) -> bool {
        (self.min.min(self.max)..=self.min.max(self.max)).contains(&value)
    }

    fn is_tolerated(&self, value: f64) -> bool {
        self.tolerance > 0.0 && value.abs() <= self.tolerance
    }

    /// [`Self::position`] with zero in the middle: each side reaches to its own end.
    fn position_about_zero(&self, value: f64) -> f64 {
        if value > self.max {
            return 1.0;
        }
        if value < self.min {
            return 0.0;
        }
        let end = if value < 0.0 { self.min } else { self.max };
        let share = if end == 0.0 { 0.0 } else { (value / end).abs() };
        0.5 + 0.5 * share.min(1.0).copysign(value)
    }

    /// True where the map cannot tell the sign of values: it says how large they are, and the pattern
    /// on which side.
    fn is_folded(&self) -> bool {
        self.map == ColorMap::Grey && self.min < 0.0 && self.max > 0.0
    }

    /// The pattern of a value.
    pub fn pattern(&self, value: f64) -> Pattern {
        if self.map == ColorMap::Statuses {
            let status = (self.position(value) * N_STATUSES) as usize;
            return STATUS_PATTERNS[status.min(STATUS_PATTERNS.len() - 1)];
        }
        if self.map == ColorMap::Files {
            let is_plain = self.position(value) < 0.5 || value.is_nan();
            return if is_plain {
                Pattern::Plain
            } else {
                Pattern::Rising
            };
        }
        if self.map == ColorMap::Classes {
            return if self.position(value) < 0.5 || value.is_nan() {
                Pattern::Plain
            } else {
                Pattern::Dots
            };
        }
        if !(self.has_pattern || self.is_folded())
            || value.is_nan()
            || value.abs() <= self.tolerance && self.is_between(value)
        {
            Pattern::Plain
        } else if value < 0.0 {
            Pattern::Lines
        } else {
            Pattern::Dots
        }
    }

    /// The colours of `n` equal steps from end to end, sampled in their middles: the texture of the
    /// graphics card and the picture of the legend. Of values with a sign the end steps have the colours of
    /// what lies beyond them.
    pub fn table(&self, n: usize) -> Vec<Rgb> {
        let middle = |i: usize| self.color(self.value_at((i as f64 + 0.5) / n as f64));
        let mut colors: Vec<Rgb> = (0..n).map(middle).collect();
        if let [first, .., last] = &mut colors[..]
            && self.is_signed
        {
            let at_end = |end: f64, place: f64| match self.is_tolerated(end) {
                true => self.color_at(place),
                false => self.color(end),
            };
            *first = at_end(self.min, 0.0);
            *last = at_end(self.max, 1.0);
        }
        colors
    }

    /// Round values for the legend: at most `max_ticks` (at least 2), 1, 2 or 5 times a power of ten
    /// apart, inside the range. Empty if the range is empty or not finite.
    pub fn ticks(&self, max_ticks: usize) -> Vec<f64> {
        let (low, high) = (self.min.min(self.max), self.min.max(self.max));
        let span = high - low;
        if !(span.is_finite() && span > 0.0) {
            return Vec::new();
        }
        let step = round_step(span / (max_ticks.max(2) - 1) as f64);
        let first = (low / step - 1e-9).ceil();
        let last = (high / step + 1e-9).floor();
        let n = (last - first) as usize + 1;
        (0..n).map(|i| (first + i as f64) * step).collect()
    }
}

/// The smallest of 1, 2, 5, 10 … that is at least `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|&step| step >= rough * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_find_their_colours() {
        let scale = ColorScale::symmetric(2.0, 0.1);
        assert_eq!(scale.color(0.05), NEUTRAL);
        assert_eq!(scale.color(-0.1), NEUTRAL);
        assert_eq!(scale.color(9.0), ColorMap::CoolWarm.sample(1.0));
        assert_eq!(scale.color(-2.0), ColorMap::CoolWarm.sample(0.0));
        assert_eq!(scale.color(f64::NAN), UNMATCHED);
        let turned = ColorScale {
            reversed: true,
            ..scale
        };
        assert_eq!(turned.color(2.0), scale.color(-2.0));
    }

    /// A print without colours: equally far from zero equally dark, and the sign by the pattern.
    #[test]
    fn grey_tells_the_size_by_lightness_and_the_sign_by_pattern() {
        let scale = ColorScale {
            map: ColorMap::Grey,
            ..ColorScale::symmetric(2.0, 0.1)
        };
        let darkness = |value: f64| 255 - scale.color(value)[0];
        for value in [-2.0, -1.1, -0.3, 0.0, 0.05, 0.3, 1.1, 2.0] {
            let [r, g, b] = scale.color(value);
            assert!(r == g && g == b);
            assert_eq!(darkness(value), darkness(-value));
        }
        assert!(darkness(0.3) < darkness(1.1) && darkness(1.1) < darkness(2.0));
        let patterns = [-0.3, 0.05, 0.3].map(|value| scale.pattern(value));
        assert_eq!(patterns, [Pattern::Lines, Pattern::Plain, Pattern::Dots]);
        // One-sided values need no pattern.
        let plain = ColorScale::new(ColorMap::Grey, 0.0, 2.0);
        assert_eq!(plain.pattern(1.0), Pattern::Plain);
        assert!(plain.color(0.1)[0] > plain.color(1.9)[0]);
    }

    #[test]
    fn zero_is_neutral_whatever_the_ends() {
        let warm = |color: Rgb| color[0] > color[2] && color != NEUTRAL;
        let cold = |color: Rgb| color[2] > color[0] && color != NEUTRAL;
        for (min, max) in [
            (-2.0, 0.0),
            (-2.0, 0.2),
            (-2.0, 5000.0),
            (0.0, 2.0),
            (-2.0, 2.0),
        ] {
            let scale = ColorScale {
                tolerance: 0.5,
                is_signed: true,
                ..ColorScale::new(ColorMap::CoolWarm, min, max)
            };
            assert_eq!(scale.color(0.0), NEUTRAL);
            assert!(cold(scale.color(-0.6)) || min == 0.0 && cold(scale.color(-2.5)));
            let far = 2.0 * max.max(2.0);
            assert!(warm(scale.color(far)), "{far} of {min} … {max}");
            assert!(cold(scale.color(-far)), "-{far} of {min} … {max}");
            let table = scale.table(1024);
            assert!(cold(table[0]) && warm(table[1023]), "{min} … {max}");
        }
    }

    #[test]
    fn bands_have_plain_colours_and_full_ends() {
        let scale = ColorScale {
            n_bands: Some(5),
            ..ColorScale::new(ColorMap::Viridis, 0.0, 10.0)
        };
        let mut colors = scale.table(1000);
        assert_eq!(colors[0], ColorMap::Viridis.sample(0.0));
        assert_eq!(colors[999], ColorMap::Viridis.sample(1.0));
        colors.dedup();
        assert_eq!(colors.len(), 5);
    }

    #[test]
    fn values_beyond_the_ends_are_hidden_on_request() {
        let scale = ColorScale::new(ColorMap::Viridis, 0.7, 0.9);
        let hiding = ColorScale {
            hides_beyond: true,
            ..scale
        };
        let hidden = [0.6, 0.7, 0.8, 0.9, 1.0, f64::NAN].map(|value| hiding.hides(value));
        assert_eq!(hidden, [true, false, false, false, true, false]);
        assert!(!scale.hides(0.6));
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let scale = ColorScale::symmetric(1.7, 0.0);
        assert_eq!(scale.ticks(6), [-1.0, 0.0, 1.0]);
        assert_eq!(
            ColorScale::new(ColorMap::Viridis, 0.0, 100.0).ticks(6),
            [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]
        );
        assert!(
            ColorScale::new(ColorMap::Viridis, 3.0, 3.0)
                .ticks(6)
                .is_empty()
        );
        assert!(
            ColorScale::new(ColorMap::Viridis, 0.0, f64::INFINITY)
                .ticks(6)
                .is_empty()
        );
        for max_ticks in 2..12 {
            assert!(ColorScale::symmetric(0.37, 0.0).ticks(max_ticks).len() <= max_ticks);
        }
    }

    #[test]
    fn each_status_has_a_colour_and_a_pattern_of_its_own() {
        let scale = ColorScale::statuses();
        let looks: Vec<_> = (0..9)
            .map(|i| (scale.color(f64::from(i)), scale.pattern(f64::from(i))))
            .collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{i}");
        }
        // Without colours the four reasons for an element without values still differ.
        let reasons: Vec<Pattern> = looks[5..].iter().map(|look| look.1).collect();
        assert!((0..4).all(|i| !reasons[..i].contains(&reasons[i])));
        assert_eq!(looks[0].1, Pattern::Plain);
    }

    #[test]
    fn each_stamped_file_has_a_look_of_its_own_until_looks_return() {
        let scale = ColorScale::files();
        let look = |number| {
            let value = ColorScale::file_value(number);
            (scale.color(value), scale.pattern(value))
        };
        let looks: Vec<_> = (0..N_FILES as usize).map(look).collect();
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{i}");
        }
        assert_eq!(look(0).1, Pattern::Plain);
        let is_same = |number| {
            let (color, pattern) = look(number);
            ColorScale::file_look(number) == (color, pattern != Pattern::Plain)
        };
        assert!((0..20).all(is_same));
        assert_eq!(look(N_FILES as usize), look(0));
        assert_eq!(scale.color(f64::NAN), UNMATCHED);
    }

    #[test]
    fn an_empty_range_still_has_a_colour() {
        let scale = ColorScale::new(ColorMap::Viridis, 1.0, 1.0);
        assert_eq!(scale.color(1.0), ColorMap::Viridis.sample(0.5));
        assert_eq!(scale.position(f64::NAN), 0.5);
    }
}
