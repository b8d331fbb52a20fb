//! Numbers in fixed columns, fast: integers, and reals with exponent as Fortran's `1PE16.8` has them.

use super::number::EXACT_POWERS;

/// Appends an integer at the right of `width` columns; a longer one takes the columns it needs.
pub(super) fn push_int(text: &mut Vec<u8>, mut value: u64, width: usize) {
    let mut digits = [b' '; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    let n = digits.len() - at;
    text.extend(std::iter::repeat_n(b' ', width.saturating_sub(n)));
    text.extend_from_slice(&digits[at..]);
}

/// Appends `value` with one digit before the point, `decimals` (at most 8) behind it and a signed
/// exponent of at least two digits, at the right of `width` columns. Zero has no sign; a value that is
/// not finite is written as zero, because a deck cannot hold it. About 30 ns.
pub(super) fn push_exponential(text: &mut Vec<u8>, value: f64, width: usize, decimals: usize) {
    let Some((digits, exponent)) = digits_of(value.abs(), decimals) else {
        return push_slowly(text, value, width, decimals);
    };
    let mut field = [b' '; 24];
    let mut at = field.len();
    let mut push = |byte: u8| {
        at -= 1;
        field[at] = byte;
    };
    let mut rest = exponent.unsigned_abs();
    for _ in 0..2 {
        push(b'0' + (rest % 10) as u8);
        rest /= 10;
    }
    push(if exponent < 0 { b'-' } else { b'+' });
    push(b'E');
    let mut rest = digits;
    for _ in 0..decimals {
        push(b'0' + (rest % 10) as u8);
        rest /= 10;
    }
    push(b'.');
    push(b'0' + rest as u8);
    if value < 0.0 {
        push(b'-');
    }
    let n = field.len() - at;
    text.extend(std::iter::repeat_n(b' ', width.saturating_sub(n)));
    text.extend_from_slice(&field[at..]);
}

/// The leading `decimals` + 1 digits as an integer, and the decimal exponent; `None` where a power of
/// ten beyond the exact ones would be needed.
fn digits_of(value: f64, decimals: usize) -> Option<(u64, i32)> {
    if value == 0.0 {
        return Some((0, 0));
    }
    if !(1e-13..1e22).contains(&value) {
        return None;
    }
    let mut exponent = value.log10().floor() as i32;
    let limit = 10_u64.pow(decimals as u32 + 1);
    for _ in 0..2 {
        let shift = decimals as i32 - exponent;
        let scaled = if shift >= 0 {
            value * EXACT_POWERS.get(shift as usize)?
        } else {
            value / EXACT_POWERS.get(-shift as usize)?
        };
        let digits = scaled.round() as u64;
        if digits >= limit {
            // The logarithm was rounded down, or 9.99… rounds up to 10.
            exponent += 1;
        } else if digits < limit / 10 {
            exponent -= 1;
        } else {
            return Some((digits, exponent));
        }
    }
    None
}

fn push_slowly(text: &mut Vec<u8>, value: f64, width: usize, decimals: usize) {
    let value = if value.is_finite() { value } else { 0.0 };
    let plain = format!("{value:.decimals$E}");
    let (digits, exponent) = plain.split_once('E').unwrap_or((&plain, "0"));
    let (sign, exponent) = match exponent.strip_prefix('-') {
        Some(exponent) => ('-', exponent),
        None => ('+', exponent),
    };
    let field = format!("{digits}E{sign}{exponent:0>2}");
    text.extend(std::iter::repeat_n(b' ', width.saturating_sub(field.len())));
    text.extend_from_slice(field.as_bytes());
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn fast(value: f64, decimals: usize) -> String {
        let mut text = Vec::new();
        push_exponential(&mut text, value, 16, decimals);
        String::from_utf8(text).unwrap()
    }

    fn slow(value: f64, decimals: usize) -> String {
        let mut text = Vec::new();
        push_slowly(&mut text, value, 16, decimals);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn spelling() {
        assert_eq!(fast(112.5, 8), "  1.12500000E+02");
        assert_eq!(fast(-0.0, 8), "  0.00000000E+00");
        assert_eq!(fast(9.999_999_999_9, 8), "  1.00000000E+01");
        assert_eq!(fast(-1.5e-120, 8), "-1.50000000E-120");
        assert_eq!(fast(f64::NAN, 3), "       0.000E+00");
        let mut text = Vec::new();
        push_int(&mut text, 1234, 8);
        push_int(&mut text, 0, 3);
        assert_eq!(text, b"    1234  0");
    }

    proptest! {
        #[test]
        fn reads_back_within_half_a_digit(mantissa in -10.0..10.0_f64, exponent in -30..30_i32) {
            let value = mantissa * 10_f64.powi(exponent);
            for decimals in [3, 8] {
                let text = fast(value, decimals);
                prop_assert_eq!(text.len(), 16);
                let read: f64 = text.trim().parse().unwrap();
                let half = 0.500_000_1 * 10_f64.powi(-(decimals as i32));
                prop_assert!((read - value).abs() <= half * value.abs());
                // The general formatter rounds exactly; they may differ in the last digit at a tie.
                let general: f64 = slow(value, decimals).trim().parse().unwrap();
                prop_assert!((read - general).abs() <= 2.1 * half * value.abs());
            }
        }
    }
}
