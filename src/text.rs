//! Small pieces of text for people: counts, percentages, lengths, sentences.
//!
//! Every surface (window, report, command line, log) writes its numbers with these, so that one number
//! reads the same everywhere. Negative numbers have a minus sign, not a hyphen, and no text shows a
//! negative zero. What programs read, as matrices, cards and tables, is written with plain formats instead.

mod typed;

use crate::units::LengthUnit;

pub use typed::{is_too_large, typed_count, typed_length, typed_number};

/// A count with commas between the thousands: 34808 → `34,808`.
pub fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: `1 triangle`, `12,345 triangles`. The noun takes an s in the plural.
pub fn counted(n: usize, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(n))
}

/// "part 7" or "parts 7, 8".
pub fn parts_by_id(ids: &[u64]) -> String {
    let noun = if ids.len() == 1 { "part" } else { "parts" };
    let ids: Vec<String> = ids.iter().map(u64::to_string).collect();
    format!("{noun} {}", ids.join(", "))
}

/// A fraction in percent with one decimal: `87.0 %`. Less than all never reads as all: `99.9 %`.
pub fn percent(fraction: f64) -> String {
    in_percent(fraction, 1)
}

/// A share of something that is there, however little it is: `< 0.1 %`, never `0.0 %`.
pub fn share(fraction: f64) -> String {
    match percent(fraction) {
        none if fraction > 0.0 && none == percent(0.0) => "< 0.1 %".to_owned(),
        shown => shown,
    }
}

/// A fraction in whole percent, for what changes while it is read: `87 %`.
pub fn whole_percent(fraction: f64) -> String {
    in_percent(fraction, 0)
}

/// What sums lose of all in rounding.
const ALMOST_ALL: f64 = 1.0 - 1e-9;

/// A fraction beside the limit it is held against, with as many decimals as it takes to tell them apart.
pub fn compared_percents(fractions: [f64; 2]) -> [String; 2] {
    (1..=MOST_DECIMALS)
        .map(|decimals| fractions.map(|fraction| in_percent(fraction, decimals)))
        .find(|words| words[0] != words[1])
        .unwrap_or_else(|| fractions.map(percent))
}

fn in_percent(fraction: f64, decimals: usize) -> String {
    let most = 100.0 - 0.1_f64.powi(decimals as i32);
    let shown = if fraction < ALMOST_ALL {
        (100.0 * fraction).min(most)
    } else {
        100.0 * fraction
    };
    format!("{} %", fixed(shown, decimals))
}

/// A number with so many decimals; what rounds to zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// A number on an axis or a scale, with the decimals of its step; zero has none.
pub fn tick_number(value: f64, decimals: usize) -> String {
    match fixed(value, decimals) {
        zero if zero.chars().all(|c| c == '0' || c == '.') => "0".to_owned(),
        text => text,
    }
}

/// A number with at most so many decimals and no zeros at its end: 0.5, 12, −3.25.
pub fn trimmed(value: f64, most_decimals: usize) -> String {
    let text = fixed(value, most_decimals);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Coordinates or components in parentheses, with so many decimals each: `(1.0, 0.0, −2.5)`.
pub fn vector(components: [f64; 3], decimals: usize) -> String {
    format!("({})", components.map(|x| fixed(x, decimals)).join(", "))
}

/// Lengths that differ in no decimal up to this one are stated as equal.
const MOST_DECIMALS: usize = 7;

/// Lengths below this are rounding.
pub const NOTHING: f64 = 5e-8;
/// What stands for a length that there is none of.
const NO_LENGTH: &str = "–";
/// In millimetres.
const MICROMETRE: f64 = 0.001;

/// A length with three significant digits: 0.0412, 1.35, 128.
pub fn length(value: f64) -> String {
    if !value.is_finite() {
        return NO_LENGTH.to_owned();
    }
    // What rounding leaves of nothing is nothing.
    let value = if value.abs() < NOTHING { 0.0 } else { value };
    let magnitude = value.abs();
    let from = [100.0, 10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4];
    let decimals = match from.iter().position(|from| magnitude >= *from) {
        Some(decimals) => decimals,
        None if value == 0.0 => 0,
        // Few thicknesses and distances in metres are smaller.
        None => MOST_DECIMALS,
    };
    fixed(value, decimals)
}

/// A length with its sign, as window and report write it: +0.412, −1.35, 0.
pub fn signed(value: f64) -> String {
    with_sign(value, &length(value))
}

/// A change in percent with its sign: `+0.12 %`, `−3.00 %`.
pub fn signed_percent(fraction: f64) -> String {
    with_sign(fraction, &fixed(100.0 * fraction, 2)) + " %"
}

/// The same with as many more decimals, up to four, as tell it from a limit.
pub fn signed_percent_beside(fraction: f64, limit: f64) -> String {
    let text = |of: f64, decimals| fixed(100.0 * of.abs(), decimals);
    let differs = |&decimals: &usize| text(fraction, decimals) != text(limit, decimals);
    let decimals = (2..4).find(differs).unwrap_or(4);
    with_sign(fraction, &fixed(100.0 * fraction, decimals)) + " %"
}

/// A number as written, with its sign; what reads as zero has none.
fn with_sign(value: f64, text: &str) -> String {
    if value > 0.0 && text.chars().any(|c| c.is_ascii_digit() && c != '0') {
        format!("+{text}")
    } else {
        text.to_owned()
    }
}

/// Milliseconds: one decimal below 10, none above.
pub fn millis(ms: f64) -> String {
    let decimals = usize::from(ms < 10.0);
    format!("{} ms", fixed(ms, decimals))
}

/// `yes` or `no`.
pub fn yes_no(value: bool) -> &'static str {
    if value { "yes" } else { "no" }
}

/// The text with its first letter in upper case, unless it begins with the name of a file.
pub fn capital(text: &str) -> String {
    let first = text.split([' ', ':']).next().unwrap_or_default();
    if first
        .trim_end_matches(['.', ',', ';'])
        .contains(['.', '/', '\\', '_'])
    {
        return text.to_owned();
    }
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// A label within a sentence: its first letter in lower case, the rest as it is ("von Mises stress").
pub fn inside(label: &str) -> String {
    let mut letters = label.chars();
    let first = letters.next().map(|c| c.to_lowercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// A message without the number that the system gives an error: "no such file (os error 2)".
pub fn without_error_number(text: &str) -> String {
    let mut words = String::new();
    let mut rest = text;
    while let Some(begin) = rest.find(" (os error ") {
        let Some(length) = rest[begin..].find(')') else {
            break;
        };
        words += &rest[..begin];
        rest = &rest[begin + length + 1..];
    }
    words + rest
}

/// The text as a sentence: its first letter in upper case, and a full stop unless it ends in a mark.
pub fn sentence(text: &str) -> String {
    let end = if text.ends_with(['.', '?', '!']) {
        ""
    } else {
        "."
    };
    capital(text) + end
}

/// A factor between units with six digits: 25.4, also where it was computed as 25.400000000000002.
pub fn tidy_factor(factor: f64) -> String {
    let rounded: f64 = format!("{factor:.5e}").parse().unwrap_or(factor);
    rounded.to_string()
}

/// What follows the name of a file whose lengths are multiplied: `", lengths × 1000"`; nothing for 1.
pub fn factor_note(length_factor: f64) -> String {
    if length_factor == 1.0 {
        return String::new();
    }
    format!(", lengths × {length_factor}")
}

/// How lengths are written: their unit, where it is known, and their decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lengths {
    /// The unit; `None` where nothing is known of it.
    pub unit: Option<LengthUnit>,
    /// Decimals of a millimetre; `None` for three significant digits.
    pub decimals: Option<u8>,
}

impl Lengths {
    /// Lengths in `unit`.
    pub fn new(unit: Option<LengthUnit>) -> Self {
        Self {
            unit,
            decimals: None,
        }
    }

    /// The same lengths with so many decimals of a millimetre; other units get as many as show no less.
    /// Where the unit is unknown, lengths keep three significant digits.
    pub fn with_decimals(self, decimals: Option<u8>) -> Self {
        Self { decimals, ..self }
    }

    /// The number alone: `0.381`. Of less than a micrometre only that is stated: nobody reads more zeros, and
    /// no sheet is known so well.
    pub fn number(self, value: f64) -> String {
        if !value.is_finite() {
            return NO_LENGTH.to_owned();
        }
        match (self.decimals, self.unit) {
            (None, Some(LengthUnit::Millimeter))
                if (NOTHING..MICROMETRE).contains(&value.abs()) =>
            {
                format!("< {MICROMETRE}")
            }
            (Some(decimals), Some(unit)) => {
                fixed(value, usize::from(decimals) + decimals_beyond_mm(unit))
            }
            _ => length(value),
        }
    }

    /// The coordinates of a place, to a tenth of a millimetre or finer: `(1.0, 0.0, −2.5)`.
    pub fn place(self, coordinates: [f64; 3]) -> String {
        vector(coordinates, self.decimals_as_of_mm(1))
    }

    /// The decimals that tell as much as so many of a millimetre.
    pub fn decimals_as_of_mm(self, decimals: usize) -> usize {
        decimals + self.unit.map_or(0, decimals_beyond_mm)
    }

    /// The number with its sign: `+0.381`, `−1.35`.
    pub fn signed(self, value: f64) -> String {
        let number = self.number(value);
        if number.starts_with('<') {
            return number;
        }
        with_sign(value, &number)
    }

    /// The number and the unit: `0.381 mm`.
    pub fn of(self, value: f64) -> String {
        let unit = if value.is_finite() { self.suffix() } else { "" };
        self.number(value) + unit
    }

    /// What lengths stay below, after "within": `0.381 mm`, of less than a micrometre `0.001 mm`.
    pub fn bound(self, value: f64) -> String {
        self.of(value).trim_start_matches("< ").to_owned()
    }

    /// Two lengths that are compared, with as many decimals as tell them apart: `15.04 mm` and `15.00 mm`.
    pub fn compared(self, lengths: [f64; 2]) -> [String; 2] {
        let usual = lengths.map(|value| self.of(value));
        if usual[0] != usual[1] {
            return usual;
        }
        (1..=MOST_DECIMALS)
            .map(|decimals| lengths.map(|value| fixed(value, decimals) + self.suffix()))
            .find(|words| words[0] != words[1])
            .unwrap_or(usual)
    }

    /// A length beside the limit it is held against: `0.71 of 3.89 mm`.
    pub fn within(self, value: f64, limit: f64) -> String {
        let [value, limit] = self.compared([value, limit]);
        let value = value.strip_suffix(self.suffix()).unwrap_or(&value);
        format!("{value} of {limit}")
    }

    /// The number with its sign and the unit: `+0.381 mm`.
    pub fn signed_of(self, value: f64) -> String {
        self.signed(value) + self.suffix()
    }

    /// What follows a number: `" mm"`, or nothing.
    pub fn suffix(self) -> &'static str {
        self.unit.map_or("", LengthUnit::suffix)
    }

    /// The title of an axis or of a table with the unit: `signed distance, mm`.
    pub fn axis(self, name: &str) -> String {
        self.unit
            .map_or_else(|| name.to_owned(), |unit| format!("{name}, {unit}"))
    }
}

/// How many decimals more than in millimetres show no less in `unit`.
fn decimals_beyond_mm(unit: LengthUnit) -> usize {
    let in_mm = unit.factor_to(LengthUnit::Millimeter);
    in_mm.log10().ceil().max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_free_of_rounding() {
        let told = [1000.0, 25.400000000000002, 1.0 / 25.4, 1e-9].map(tidy_factor);
        assert_eq!(told, ["1000", "25.4", "0.0393701", "0.000000001"]);
    }

    #[test]
    fn messages_lose_the_numbers_of_errors() {
        let error = std::io::Error::from_raw_os_error(2);
        let text = format!("/a/b.k: {error}; again: {error}.");
        let words = without_error_number(&text);
        assert!(!words.contains("os error"), "{words}");
        assert!(
            words.starts_with("/a/b.k: ") && words.ends_with('.'),
            "{words}"
        );
        assert_eq!(without_error_number("part (os error"), "part (os error");
    }

    #[test]
    fn places_in_metres_are_told_as_finely_as_in_millimetres() {
        let place = |unit| Lengths::new(unit).place([0.0128, -0.5, 0.0]);
        let in_meters = place(Some(LengthUnit::Meter));
        assert_eq!(in_meters, "(0.0128, −0.5000, 0.0000)");
        assert_eq!(place(Some(LengthUnit::Millimeter)), "(0.0, −0.5, 0.0)");
        assert_eq!(place(None), "(0.0, −0.5, 0.0)");
    }

    #[test]
    fn lengths_have_three_digits() {
        let read = [0.041_23, 1.349, -128.4, 0.0, 0.000_381].map(length);
        assert_eq!(read, ["0.0412", "1.35", "−128", "0", "0.000381"]);
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        assert_eq!(lengths.of(0.3806), "0.381 mm");
        assert_eq!(lengths.axis("distance"), "distance, mm");
        assert_eq!(Lengths::default().of(0.3806), "0.381");
        let tiny = [5.5e-6, -0.0009, 0.001, 1e-9].map(|value| lengths.of(value));
        assert_eq!(tiny, ["< 0.001 mm", "< 0.001 mm", "0.00100 mm", "0 mm"]);
        assert_eq!(lengths.signed_of(0.0003), "< 0.001 mm");
        let bounds = [0.0003, 0.3806].map(|value| lengths.bound(value));
        assert_eq!(bounds, ["0.001 mm", "0.381 mm"]);
    }

    #[test]
    fn a_length_stands_beside_its_limit() {
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        assert_eq!(lengths.within(0.71, 3.89), "0.710 of 3.89 mm");
        assert_eq!(lengths.within(0.0002, 0.2), "< 0.001 of 0.200 mm");
        assert_eq!(lengths.within(15.04, 15.0), "15.04 of 15.00 mm");
        assert_eq!(Lengths::default().within(0.71, 3.89), "0.710 of 3.89");
    }

    #[test]
    fn lengths_that_are_compared_are_told_apart() {
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        let read = [[1.42, 1.2], [15.04, 15.0], [0.041_23, 0.041_21]];
        assert_eq!(lengths.compared(read[0]), ["1.42 mm", "1.20 mm"]);
        assert_eq!(lengths.compared(read[1]), ["15.04 mm", "15.00 mm"]);
        assert_eq!(lengths.compared(read[2]), ["0.04123 mm", "0.04121 mm"]);
        assert_eq!(lengths.compared([5.0, 5.0]), ["5.00 mm", "5.00 mm"]);
    }

    #[test]
    fn decimals_are_those_of_a_millimetre_in_every_unit() {
        let written = |unit, decimals| {
            let lengths = Lengths::new(unit).with_decimals(Some(decimals));
            [0.380_64, -128.4, 0.0].map(|value| lengths.of(value))
        };
        let mm = Some(LengthUnit::Millimeter);
        assert_eq!(written(mm, 2), ["0.38 mm", "−128.40 mm", "0.00 mm"]);
        assert_eq!(written(mm, 4), ["0.3806 mm", "−128.4000 mm", "0.0000 mm"]);
        // A hundredth of a millimetre is the fifth decimal of a metre.
        assert_eq!(written(Some(LengthUnit::Meter), 2)[0], "0.38064 m");
        assert_eq!(written(Some(LengthUnit::Inch), 2)[0], "0.3806 in");
        assert_eq!(written(None, 2), ["0.381", "−128", "0"]);
        let lengths = Lengths::new(mm).with_decimals(Some(2));
        let read = [0.5, -0.5, 0.001, -0.001].map(|value| lengths.signed_of(value));
        assert_eq!(read, ["+0.50 mm", "−0.50 mm", "0.00 mm", "0.00 mm"]);
    }

    #[test]
    fn signs_are_written_and_zero_has_none() {
        let read = [0.5, -0.5, 0.0, 1e-14, -1e-14].map(signed);
        assert_eq!(read, ["+0.500", "−0.500", "0", "0", "0"]);
        let read = [-0.0, -0.000_4, -0.5, 0.4].map(|x| fixed(x, 0));
        assert_eq!(read, ["0", "0", "0", "0"]);
        assert_eq!(vector([-0.0004, -1.0, 2.0], 2), "(0.00, −1.00, 2.00)");
        assert_eq!(length(-0.0), "0");
        let read = [-0.000_01, 0.5, 120.0, -3.25].map(|x| trimmed(x, 4));
        assert_eq!(read, ["0", "0.5", "120", "−3.25"]);
        assert_eq!(percent(-1e-9), "0.0 %");
        assert_eq!([-2.5, -1e-9].map(|x| tick_number(x, 1)), ["−2.5", "0"]);
        let missed =
            [-0.005_002, 0.004_2, 0.005].map(|change| signed_percent_beside(change, 0.005));
        assert_eq!(missed, ["−0.5002 %", "+0.42 %", "+0.5000 %"]);
        let read = [0.001_2, -0.03, 1e-9].map(signed_percent);
        assert_eq!(read, ["+0.12 %", "−3.00 %", "0.00 %"]);
    }

    #[test]
    fn counts_are_grouped_and_take_their_noun() {
        let read = [0, 999, 1000, 34_808, 1_234_567].map(grouped);
        assert_eq!(read, ["0", "999", "1,000", "34,808", "1,234,567"]);
        assert_eq!(counted(1, "part"), "1 part");
        assert_eq!(counted(0, "part"), "0 parts");
        assert_eq!(counted(41_208, "triangle"), "41,208 triangles");
    }

    #[test]
    fn fractions_and_times_are_short() {
        assert_eq!(percent(0.8704), "87.0 %");
        assert_eq!(share(0.8704), "87.0 %");
        assert_eq!(share(0.0003), "< 0.1 %");
        assert_eq!(share(0.0), "0.0 %");
        assert_eq!(whole_percent(0.8704), "87 %");
        // Less than all is not all; what sums lose is nothing.
        let read = [0.999_49, 0.999_6, 1.0 - 1e-12, 1.0, 1.05].map(percent);
        assert_eq!(read, ["99.9 %", "99.9 %", "100.0 %", "100.0 %", "105.0 %"]);
        assert_eq!(whole_percent(0.997), "99 %");
        assert_eq!(millis(3.12), "3.1 ms");
        assert_eq!(millis(118.6), "119 ms");
    }

    #[test]
    fn sentences_begin_and_end_as_sentences() {
        assert_eq!(sentence("the shapes differ"), "The shapes differ.");
        assert_eq!(sentence("are they the same?"), "Are they the same?");
        assert_eq!(capital(""), "");
        let of_file = "err.k: 2 pieces could not be read";
        assert_eq!(capital(of_file), of_file);
        assert_eq!(capital("done. more"), "Done. more");
        assert_eq!(inside("Von Mises stress"), "von Mises stress");
    }
}
