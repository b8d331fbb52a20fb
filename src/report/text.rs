//! Numbers as people read them.

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

/// A length with three digits that count: 0.0412, 1.35, 128.
pub fn length(value: f64) -> String {
    // What rounding leaves of nothing is nothing.
    let value = if value.abs() < 5e-8 { 0.0 } else { value };
    let magnitude = value.abs();
    let decimals = if magnitude >= 100.0 || value == 0.0 {
        0
    } else if magnitude >= 10.0 {
        1
    } else if magnitude >= 1.0 {
        2
    } else if magnitude >= 0.1 {
        3
    } else if magnitude >= 1e-3 {
        4
    } else {
        // A thickness or a distance in metres.
        7
    };
    format!("{value:.decimals$}")
}

/// A length with its sign, as the window writes it: +0.412, −1.35, 0.
pub fn signed(value: f64) -> String {
    let text = length(value);
    if value > 0.0 && text != "0" {
        format!("+{text}")
    } else {
        text.replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::{grouped, length, signed};

    #[test]
    fn lengths_have_three_digits() {
        let read = [0.041_23, 1.349, -128.4, 0.0, 0.000_381].map(length);
        assert_eq!(read, ["0.0412", "1.35", "-128", "0", "0.0003810"]);
    }

    #[test]
    fn signs_are_written_and_nothing_has_none() {
        let read = [0.5, -0.5, 0.0, 1e-14, -1e-14].map(signed);
        assert_eq!(read, ["+0.500", "−0.500", "0", "0", "0"]);
    }

    #[test]
    fn thousands_are_grouped() {
        let read = [0, 999, 1000, 34_808, 1_234_567].map(grouped);
        assert_eq!(read, ["0", "999", "1,000", "34,808", "1,234,567"]);
    }
}
