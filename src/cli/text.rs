//! Small pieces of readable text.

/// A count with a thin grouping of thousands: 34808 → `34,808`.
pub fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut grouped = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// A count with its noun: `1 shell`, `2 shells`.
pub fn counted(n: usize, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(n))
}

/// A length or another number with about four digits that matter.
pub fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".into()
    } else if !(1e-4..1e7).contains(&size) {
        format!("{x:.2e}")
    } else {
        let decimals = (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{x:.decimals$}")
    }
}

/// Milliseconds: two digits below 10, none above.
pub fn millis(ms: f64) -> String {
    if ms < 10.0 {
        format!("{ms:.1} ms")
    } else {
        format!("{ms:.0} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(count(7), "7");
        assert_eq!(count(34808), "34,808");
        assert_eq!(count(1_234_567), "1,234,567");
        assert_eq!(counted(1, "part"), "1 part");
        assert_eq!(counted(0, "part"), "0 parts");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(1632.44), "1632");
        assert_eq!(short(0.012_345_6), "0.01235");
        assert_eq!(short(-2.5), "-2.500");
        assert_eq!(short(1.5e-9), "1.50e-9");
        assert_eq!(millis(3.12), "3.1 ms");
        assert_eq!(millis(118.6), "119 ms");
    }
}
