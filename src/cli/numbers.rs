//! Numbers as they are typed, each with the range outside of which it is wrong usage.

use std::ops::RangeInclusive;

use crate::mapping::limits;
use crate::text::{trimmed, typed_count};

/// Ranges that end here or higher only keep out numbers without a meaning.
pub(super) const WIDE: f64 = 1e9;

/// Takes numbers in a range; `sign` follows its ends where it is told.
pub(super) fn number(
    range: RangeInclusive<f64>,
    sign: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |word| {
        let number = word
            .trim()
            .parse()
            .map_err(|_| "it is not a number".to_owned())?;
        within(number, &range, sign)
    }
}

/// A number if it lies in the range, else what it must be.
pub(super) fn within(number: f64, range: &RangeInclusive<f64>, sign: &str) -> Result<f64, String> {
    if number.is_finite() && range.contains(&number) {
        return Ok(number);
    }
    let (low, high) = (*range.start(), *range.end());
    Err(if high < WIDE {
        let [low, high] = [low, high].map(|end| trimmed(end, 6));
        format!("it must be from {low}{sign} to {high}{sign}")
    } else if low == f64::MIN_POSITIVE {
        format!("it must be above 0 and at most {high:e}{sign}")
    } else {
        let low = trimmed(low, 6);
        format!("it must be at least {low}{sign} and at most {high:e}{sign}")
    })
}

/// A factor above zero.
pub(super) fn positive(word: &str) -> Result<f64, String> {
    number(limits::POSITIVE, "")(word)
}

/// A share in percent.
pub(super) fn percent(word: &str) -> Result<f64, String> {
    number(0.0..=100.0, "")(word)
}

/// Points in the plane of a layer.
pub(super) fn points_in_plane(word: &str) -> Result<u8, String> {
    match word.trim() {
        "1" => Ok(1),
        "4" => Ok(4),
        _ => Err("it must be 1 or 4".to_owned()),
    }
}

/// Takes whole numbers in a range, as people type them: `2000`, `2,000`, `2k`.
pub(super) fn count(
    range: RangeInclusive<usize>,
) -> impl Fn(&str) -> Result<usize, String> + Clone + Send + Sync + 'static {
    move |word| {
        let number = typed_count(word);
        number.filter(|n| range.contains(n)).ok_or_else(|| {
            let (low, high) = (range.start(), range.end());
            match *high {
                usize::MAX => format!("it must be a whole number from {low}"),
                high => format!("it must be a whole number from {low} to {high}"),
            }
        })
    }
}

/// A number of things.
pub(super) fn at_least_one(word: &str) -> Result<usize, String> {
    count(1..=usize::MAX)(word)
}

/// Layers of a shell.
pub(super) fn layers(word: &str) -> Result<usize, String> {
    count(limits::LAYERS)(word)
}
