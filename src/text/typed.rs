//! Numbers as people type them: with a decimal comma, grouped digits, a unit, or `k` for thousand.

use super::Lengths;
use crate::units::LengthUnit;

/// Largest size of a typed number; what is larger is a slip, and would overflow where it is added.
const LARGEST: f64 = 1e12;

/// The number of a text, of which `unit` may stand behind it; `None` where it is none, or not finite.
///
/// One comma or point is the decimal sign; several of one kind, or the first of two kinds, group digits.
pub fn typed_number(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim();
    let number = text.strip_suffix(unit.trim()).unwrap_or(text);
    let number: f64 = plain(number)?.parse().ok()?;
    (number.abs() <= LARGEST).then_some(number)
}

/// Whether a text is a number that is larger than any that is taken.
pub fn is_too_large(text: &str) -> bool {
    let number = plain(text).and_then(|number| number.parse().ok());
    number.is_some_and(|number: f64| number.abs() > LARGEST)
}

/// A length in the window's unit; typed in another one, `0.5 in`, it is converted.
pub fn typed_length(text: &str, lengths: Lengths) -> Option<f64> {
    let text = text.trim();
    let symbol = text.trim_start_matches(|c: char| !c.is_alphabetic() || c == 'e' || c == 'E');
    let typed = LengthUnit::from_symbol(symbol);
    let factor = match (typed, lengths.unit) {
        (Some(typed), Some(own)) => typed.factor_to(own),
        _ if symbol.is_empty() => 1.0,
        _ => return None,
    };
    let number = &text[..text.len() - symbol.len()];
    typed_number(number, "")
        .map(|number| number * factor)
        .filter(|length| length.abs() <= LARGEST)
}

/// A whole number: `2,000`, `2.000`, `2 000`, `2k`, `1,5k`, `1e3`. `None` where it is none.
pub fn typed_count(text: &str) -> Option<usize> {
    let text = text.trim().to_lowercase();
    let (number, factor) = match text.strip_suffix('k') {
        Some(number) => (number, 1e3),
        None => text.strip_suffix('m').map_or((&*text, 1.0), |n| (n, 1e6)),
    };
    let groups: Vec<&str> = number.trim().split([',', '.']).collect();
    let is_grouped = factor == 1.0
        && groups.len() > 1
        && groups[0].len() <= 3
        && groups[1..].iter().all(|group| group.len() == 3);
    let number = if is_grouped {
        groups.concat()
    } else {
        number.to_owned()
    };
    let count = (typed_number(&number, "")? * factor).round_ties_even();
    let is_whole = (count - typed_number(&number, "")? * factor).abs() < 1e-6;
    (is_whole && count >= 0.0).then_some(count as usize)
}

/// The text of a number in the form that Rust reads: a point, no groups, an ASCII minus.
fn plain(text: &str) -> Option<String> {
    let is_space = |c: char| c.is_whitespace() || c == '\'' || c == '’';
    let text: String = text.chars().filter(|c| !is_space(*c)).collect();
    let text = text.replace('−', "-");
    let is_known = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '-' | '+' | 'e' | 'E');
    if !text.chars().all(is_known) {
        return None;
    }
    let last = text.rfind([',', '.']);
    let signs: Vec<char> = text.chars().filter(|c| matches!(c, ',' | '.')).collect();
    let is_decimal = match signs.as_slice() {
        [] => false,
        [_] => true,
        [.., before, sign] => before != sign && !signs[..signs.len() - 1].contains(sign),
    };
    let whole = &text[..last.filter(|_| is_decimal).unwrap_or(text.len())];
    let mut groups = whole.split([',', '.']).skip(1);
    if groups.any(|group| group.len() != 3) {
        return None;
    }
    let mut plain = String::with_capacity(text.len());
    for (at, c) in text.char_indices() {
        match c {
            ',' | '.' if is_decimal && Some(at) == last => plain.push('.'),
            ',' | '.' => {}
            c => plain.push(c),
        }
    }
    Some(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_type_them() {
        for (text, number) in [
            ("12,5", 12.5),
            ("12.5", 12.5),
            ("12,", 12.0),
            (" −3 ", -3.0),
            ("1 234,5", 1234.5),
            ("1.234,5", 1234.5),
            ("1,234,567.8", 1_234_567.8),
            ("1'234.5 mm", 1234.5),
            ("1e-3", 1e-3),
            ("12,5 mm", 12.5),
        ] {
            assert_eq!(typed_number(text, " mm"), Some(number), "{text}");
        }
        for text in [
            "", "nan", "inf", "-inf", "1e999", "1e300", "abc", "1.2.3", "5 kg", "90 °",
        ] {
            assert_eq!(typed_number(text, " mm"), None, "{text}");
        }
    }

    #[test]
    fn lengths_are_converted_from_the_unit_they_are_typed_in() {
        let mm = Lengths::new(Some(LengthUnit::Millimeter));
        for (text, length) in [
            ("0,5 in", 12.7),
            ("2 m", 2000.0),
            ("2m", 2000.0),
            ("1e2 mm", 100.0),
            ("7", 7.0),
        ] {
            assert_eq!(typed_length(text, mm), Some(length), "{text}");
        }
        assert_eq!(typed_length("7 kg", mm), None);
        assert_eq!(typed_length("nan", mm), None);
        assert_eq!(typed_length("7", Lengths::default()), Some(7.0));
        assert_eq!(typed_length("7 mm", Lengths::default()), None);
    }

    #[test]
    fn counts_know_groups_and_thousands() {
        for (text, count) in [
            ("2,000", 2000),
            ("2.000", 2000),
            ("2 000", 2000),
            ("2k", 2000),
            ("1,5 k", 1500),
            ("1e3", 1000),
            ("0.5M", 500_000),
            ("50", 50),
        ] {
            assert_eq!(typed_count(text), Some(count), "{text}");
        }
        for text in ["", "-3", "abc", "1,5", "k", "1e3000"] {
            assert_eq!(typed_count(text), None, "{text}");
        }
    }
}
