//! Tabs in data lines: between numbers that they separate, and in place of blanks.

/// The line with commas in place of its tabs, where it holds numbers with exactly one tab between any two of them, as
/// a spreadsheet or a script writes them; `None` for any other line. Columns of eight would give the
/// same fields only where each number fills all but the last of its columns.
pub(super) fn between_numbers(line: &[u8]) -> Option<Vec<u8>> {
    let line = line.trim_ascii_end();
    let values: Vec<&[u8]> = line
        .split(|&b| b == b'\t')
        .map(<[u8]>::trim_ascii)
        .collect();
    let is_separated = values.len() > 1 && values.iter().all(|value| is_number(value));
    is_separated.then(|| values.join(&b','))
}

/// Whether a text is one number, or a parameter that stands for one. Numbers of fixed columns may touch each other,
/// as in `-1.5-2.5`: these are two.
fn is_number(text: &[u8]) -> bool {
    let digits = text.strip_prefix(b"-").or(text.strip_prefix(b"+"));
    let digits = digits.unwrap_or(text);
    let (Some(first), Some((_, rest))) = (digits.first(), digits.split_first()) else {
        return false;
    };
    if *first == b'&' {
        return rest.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_');
    }
    let is_exponent = |b: u8| b"eEdD".contains(&b);
    let mut before = *first;
    let goes_on = |&b: &u8| {
        let is_sign = (b == b'-' || b == b'+') && is_exponent(before);
        before = b;
        b.is_ascii_digit() || b == b'.' || is_exponent(b) || is_sign
    };
    (first.is_ascii_digit() || *first == b'.') && rest.iter().all(goes_on)
}

/// The line with tabs expanded to columns of eight.
pub(super) fn expanded(line: &[u8]) -> Vec<u8> {
    let mut expanded = Vec::with_capacity(line.len() + 16);
    for &byte in line {
        if byte == b'\t' {
            let to_stop = 8 - expanded.len() % 8;
            expanded.extend(std::iter::repeat_n(b' ', to_stop));
        } else {
            expanded.push(byte);
        }
    }
    expanded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn separated(line: &str, expected: Option<&str>) {
        let found = between_numbers(line.as_bytes());
        assert_eq!(found.as_deref(), expected.map(str::as_bytes), "{line:?}");
    }

    #[test]
    fn one_tab_between_numbers_is_a_comma() {
        separated("7\t-1.5\t2\t3.E-1", Some("7,-1.5,2,3.E-1"));
        separated(
            "  7 \t 12345678\t&size\t-&size\t  ",
            Some("7,12345678,&size,-&size"),
        );
    }

    #[test]
    fn other_tabs_are_columns() {
        for line in [
            "       1       1       1       2\t3",
            "1\t\t2",
            "\t1\t2",
            "7\t-1.5-2.5\t3",
            "door\tleft",
            "1\t2\tnan",
            "1,2\t3",
            "12",
            "",
        ] {
            separated(line, None);
        }
        assert_eq!(expanded(b"1\t12345678\t2"), b"1       12345678        2");
    }
}
