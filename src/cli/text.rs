//! Small pieces of readable text.

pub use crate::report::grouped as count;

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
