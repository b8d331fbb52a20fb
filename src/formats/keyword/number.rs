//! Numbers as Fortran writes them: `1.5-3`, `1.d0`, `.5`, `5.`, `+3`, and `3.0` in an integer field.

/// Powers of ten that a double holds exactly.
pub(super) const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// A number taken apart: `± mantissa · 10^exponent`.
struct Decimal {
    negative: bool,
    mantissa: u64,
    exponent: i32,
    /// Not every digit fitted into the mantissa.
    truncated: bool,
}

/// Takes a trimmed field apart; `None` if it is no number.
#[inline]
fn decimal(text: &[u8]) -> Option<Decimal> {
    let mut i = 0;
    let negative = text.first() == Some(&b'-');
    if negative || text.first() == Some(&b'+') {
        i = 1;
    }
    let mut mantissa = 0u64;
    let mut n_digits = 0usize;
    let mut scale = 0i32;
    let mut truncated = false;
    let mut after_point = false;
    while i < text.len() {
        let byte = text[i];
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            n_digits += 1;
            if mantissa < 1_000_000_000_000_000_000 {
                mantissa = mantissa * 10 + u64::from(digit);
                scale -= i32::from(after_point);
            } else {
                truncated |= digit != 0;
                scale += i32::from(!after_point);
            }
        } else if byte == b'.' && !after_point {
            after_point = true;
        } else {
            break;
        }
        i += 1;
    }
    if n_digits == 0 {
        return None;
    }
    let exponent = scale.saturating_add(exponent_of(&text[i..])?);
    Some(Decimal {
        negative,
        mantissa,
        exponent,
        truncated,
    })
}

/// The exponent part: nothing, `E±n`, `D±n`, or a bare sign and digits.
#[inline]
fn exponent_of(text: &[u8]) -> Option<i32> {
    let Some((&first, rest)) = text.split_first() else {
        return Some(0);
    };
    let digits = match first {
        b'e' | b'E' | b'd' | b'D' => rest,
        b'+' | b'-' => text,
        _ => return None,
    };
    let (negative, digits) = match digits.split_first() {
        Some((b'-', digits)) => (true, digits),
        Some((b'+', digits)) => (false, digits),
        _ => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0i32;
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = (value * 10 + i32::from(digit)).min(99_999);
    }
    Some(if negative { -value } else { value })
}

/// A real number, correctly rounded; `None` if the trimmed text is not a number.
/// Numbers too large for a double come out infinite.
#[inline]
pub fn parse_real(text: &[u8]) -> Option<f64> {
    let number = decimal(text)?;
    // Mantissa and power are exact doubles, so one operation rounds correctly (Clinger 1990).
    let exact = !number.truncated && number.mantissa <= 1 << 53;
    let magnitude = if exact && (0..=22).contains(&number.exponent) {
        number.mantissa as f64 * EXACT_POWERS[number.exponent as usize]
    } else if exact && (-22..0).contains(&number.exponent) {
        number.mantissa as f64 / EXACT_POWERS[-number.exponent as usize]
    } else {
        return parse_slowly(text);
    };
    Some(if number.negative {
        -magnitude
    } else {
        magnitude
    })
}

/// Rewrites the Fortran exponent and leaves rounding to the library. For a checked number.
#[cold]
fn parse_slowly(text: &[u8]) -> Option<f64> {
    let mut plain = Vec::with_capacity(text.len() + 1);
    for (i, &byte) in text.iter().enumerate() {
        match byte {
            b'd' | b'D' => plain.push(b'e'),
            b'+' | b'-' if i > 0 && !matches!(text[i - 1], b'e' | b'E' | b'd' | b'D') => {
                plain.extend([b'e', byte]);
            }
            b'+' if i == 0 => {}
            _ => plain.push(byte),
        }
    }
    fast_float2::parse(&plain).ok()
}

/// A field of blanks around decimal digits; `None` for anything else and for a blank field.
#[inline]
pub fn parse_digits(field: &[u8]) -> Option<u64> {
    let digits = field.trim_ascii();
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0u64;
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value * 10 + u64::from(digit);
    }
    Some(value)
}

/// An integer, also one written as a real (`3.0`, `1e3`); `None` if the trimmed text is none.
#[inline]
pub fn parse_int(text: &[u8]) -> Option<i64> {
    let (negative, digits) = match text.split_first() {
        Some((b'-', digits)) => (true, digits),
        Some((b'+', digits)) => (false, digits),
        _ => (false, text),
    };
    if digits.is_empty() || digits.len() > 18 {
        return parse_integral_real(text);
    }
    let mut value = 0i64;
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return parse_integral_real(text);
        }
        value = value * 10 + i64::from(digit);
    }
    Some(if negative { -value } else { value })
}

#[cold]
fn parse_integral_real(text: &[u8]) -> Option<i64> {
    let value = parse_real(text)?;
    // Beyond 2^53 a real no longer says which integer was meant.
    (value.fract() == 0.0 && value.abs() <= 9.0e15).then_some(value as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_way_of_writing_a_number_is_read() {
        let cases: &[(&str, Option<f64>)] = &[
            ("1.5-3", Some(1.5e-3)),
            ("1.5+3", Some(1.5e3)),
            ("1.d0", Some(1.0)),
            ("1.5D+3", Some(1500.0)),
            (".5", Some(0.5)),
            ("5.", Some(5.0)),
            ("1E5", Some(1e5)),
            ("+3", Some(3.0)),
            ("-4.484e-05", Some(-4.484e-5)),
            ("0", Some(0.0)),
            ("-0.", Some(-0.0)),
            ("1e999", Some(f64::INFINITY)),
            ("1e-999", Some(0.0)),
            (
                "123456789012345678901234567890",
                Some(123_456_789_012_345_678_901_234_567_890.0),
            ),
            (
                "0.1234567890123456789012345",
                Some(0.123_456_789_012_345_68),
            ),
            ("-1.7976931348623157+308", Some(f64::MIN)),
            ("", None),
            (".", None),
            ("-", None),
            ("e5", None),
            ("1e", None),
            ("1.2.3", None),
            ("1 2", None),
            ("nan", None),
            ("0x10", None),
            ("******", None),
        ];
        for (text, expected) in cases {
            assert_eq!(parse_real(text.as_bytes()), *expected, "{text}");
        }
    }

    #[test]
    fn an_integer_field_takes_an_integral_real() {
        assert_eq!(parse_int(b"3.0"), Some(3));
        assert_eq!(parse_int(b"-17"), Some(-17));
        assert_eq!(parse_int(b"+17"), Some(17));
        assert_eq!(parse_int(b"9999999999"), Some(9_999_999_999));
        assert_eq!(parse_int(b"1e3"), Some(1000));
        assert_eq!(parse_int(b"3.5"), None);
        assert_eq!(parse_int(b"abc"), None);
        assert_eq!(parse_int(b""), None);
        assert_eq!(parse_int(b"99999999999999999999"), None);
    }

    proptest! {
        #[test]
        fn reals_are_rounded_as_the_standard_library_rounds(
            text in "[+-]?([0-9]{1,22}\\.?[0-9]{0,22}|\\.[0-9]{1,22})([eE][+-]?[0-9]{1,3})?",
        ) {
            prop_assert_eq!(parse_real(text.as_bytes()), text.parse::<f64>().ok());
        }

        #[test]
        fn every_double_survives_writing_and_reading(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let text = format!("{value:e}");
            prop_assert_eq!(parse_real(text.as_bytes()), Some(value));
            let fortran = text.replace("e-", "-").replace('e', "D");
            prop_assert_eq!(parse_real(fortran.as_bytes()), Some(value));
        }

        #[test]
        fn any_bytes_are_read_without_panic(text in proptest::collection::vec(any::<u8>(), 0..40)) {
            let _ = (parse_real(&text), parse_int(&text));
        }
    }
}
