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

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn thousands_are_grouped() {
        let read = [0, 999, 1000, 34_808, 1_234_567].map(grouped);
        assert_eq!(read, ["0", "999", "1,000", "34,808", "1,234,567"]);
    }
}
