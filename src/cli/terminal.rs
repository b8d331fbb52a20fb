//! Text on its way to a terminal.

use std::borrow::Cow;

/// Text without control characters that a terminal would obey; line breaks and tabs stay.
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_harmful = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| {
        if is_harmful(c) {
            c.escape_default().to_string()
        } else {
            c.to_string()
        }
    };
    Cow::Owned(text.chars().map(shown).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown() {
        assert_eq!(printable("a\tb\n"), "a\tb\n");
        let shown = "\\u{1b}[31mred\\u{7}\\u{9b}";
        assert_eq!(printable("\u{1b}[31mred\u{7}\u{9b}"), shown);
    }
}
