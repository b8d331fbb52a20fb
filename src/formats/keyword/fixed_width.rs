//! The best spelling of a number in a given number of columns.

/// Writes `value` in at most `width` columns with the smallest possible error: plain or with an
/// exponent, without a leading zero, and always with a point. Text that reads back to the same
/// bits is taken whenever it fits. Not padded. `None` if the value is not finite or not even its
/// size fits (four columns are enough for magnitudes from 1e-9 to 999, seven for every double).
pub fn fixed_width(value: f64, width: usize) -> Option<String> {
    if !value.is_finite() {
        return None;
    }
    let exact = [
        with_point(&format!("{value}")),
        with_point(&format!("{value:E}")),
    ];
    let shortest = exact.into_iter().min_by_key(String::len)?;
    if shortest.len() <= width {
        return Some(shortest);
    }
    let candidates = [plain(value, width), scientific(value, width)];
    let error = |text: &String| (text.parse().unwrap_or(f64::INFINITY) - value).abs();
    candidates
        .into_iter()
        .flatten()
        .min_by(|a, b| error(a).total_cmp(&error(b)))
}

/// As many decimals as fit.
fn plain(value: f64, width: usize) -> Option<String> {
    // Digits before the point need `magnitude` columns; rounding may add one.
    let magnitude = (value.abs().max(1.0).log10() as usize).saturating_sub(1);
    let most = width.checked_sub(magnitude)?;
    (0..=most)
        .rev()
        .map(|decimals| with_point(&format!("{value:.decimals$}")))
        .find(|text| text.len() <= width)
}

/// As many digits before the exponent as fit.
fn scientific(value: f64, width: usize) -> Option<String> {
    (0..width.min(18))
        .rev()
        .map(|decimals| with_point(&format!("{value:.decimals$E}")))
        .find(|text| text.len() <= width)
}

/// Drops the zero before the point and zeros at the end of the decimals; adds a missing point.
fn with_point(text: &str) -> String {
    let (number, exponent) = match text.find('E') {
        Some(at) => text.split_at(at),
        None => (text, ""),
    };
    let (sign, digits) = match number.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", number),
    };
    let (whole, decimals) = digits.split_once('.').unwrap_or((digits, ""));
    let decimals = decimals.trim_end_matches('0');
    let whole = if whole == "0" && !decimals.is_empty() {
        ""
    } else {
        whole
    };
    let exponent = if exponent == "E0" { "" } else { exponent };
    format!("{sign}{whole}.{decimals}{exponent}")
}

#[cfg(test)]
mod tests {
    use super::super::number::parse_real;
    use super::*;
    use proptest::prelude::*;

    #[track_caller]
    fn spelled(value: f64, width: usize, expected: &str) {
        assert_eq!(
            fixed_width(value, width).as_deref(),
            Some(expected),
            "{value}"
        );
    }

    #[test]
    fn the_most_of_every_column() {
        spelled(-0.123_456_789_012, 10, "-.12345679");
        spelled(0.123_456_789_012, 10, ".123456789");
        spelled(-1_234.567_890_12, 10, "-1234.5679");
        spelled(0.5, 10, ".5");
        spelled(0.0, 10, "0.");
        spelled(-0.0, 10, "-0.");
        spelled(1.0, 10, "1.");
        spelled(1e20, 10, "1.E20");
        spelled(1.234_567_890_1e-7, 10, "1.23457E-7");
        spelled(-1.234_567_890_1e-7, 10, "-1.2346E-7");
        spelled(0.000_123_456_789, 10, ".000123457");
        spelled(0.012_345_678_912_3, 10, ".012345679");
        spelled(9.999_999_999_9, 10, "10.");
        spelled(123_456_789_012.0, 10, "1.23457E11");
        spelled(25.4, 10, "25.4");
        assert_eq!(fixed_width(f64::NAN, 10), None);
        assert_eq!(fixed_width(1e300, 4), None);
        assert!(fixed_width(-1e-300, 7).is_some());
    }

    proptest! {
        #[test]
        fn always_fits_and_reads_back_as_near_as_the_columns_allow(
            value in prop_oneof![-5000.0..5000.0f64, -1.0..1.0f64, -1e-3..1e-3f64],
        ) {
            let text = fixed_width(value, 10).unwrap();
            prop_assert!(text.len() <= 10, "{}", text);
            let back = parse_real(text.as_bytes()).unwrap();
            // No choice of decimals in plain notation comes nearer.
            for decimals in 0..10 {
                let rival = format!("{value:.decimals$}");
                let rival = rival.replace("-0.", "-.");
                let rival = rival.strip_prefix("0").filter(|r| r.starts_with('.')).unwrap_or(&rival);
                if rival.len() <= 10 {
                    let rival: f64 = rival.parse().unwrap();
                    prop_assert!((back - value).abs() <= (rival - value).abs(), "{} {}", text, rival);
                }
            }
        }

        #[test]
        fn twenty_five_columns_hold_every_double(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let text = fixed_width(value, 25).unwrap();
            prop_assert!(text.len() <= 25);
            prop_assert_eq!(parse_real(text.as_bytes()).map(f64::to_bits), Some(bits));
            prop_assert!(fixed_width(value, 8).is_some());
        }
    }
}
