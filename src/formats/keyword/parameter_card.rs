//! Cutting the cards of `*PARAMETER…` into names and values.

use super::parameter_error::{ParameterError, ParameterProblem, ParameterProblemAt};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Integer,
    Real,
    Text,
}

/// Takes `R name` apart; blanks do not count.
pub(super) fn typed_name(text: &str) -> Result<(Kind, String), ParameterProblem> {
    let bad = || ParameterProblem::BadName(text.trim().to_owned());
    let mut chars = text.chars().filter(|c| !c.is_ascii_whitespace());
    let kind = match chars.next().map(|c| c.to_ascii_uppercase()) {
        Some('I') => Kind::Integer,
        Some('R') => Kind::Real,
        Some('C') => Kind::Text,
        _ => return Err(bad()),
    };
    let name: String = chars.collect();
    if !is_name(&name) || name.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(bad());
    }
    let name = name.to_ascii_lowercase();
    if name == "time" {
        return Err(ParameterProblem::Reserved(name));
    }
    Ok((kind, name))
}

pub(super) fn is_name_char(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(is_name_char)
}

/// A trimmed piece of a line and its column, from 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece<'a> {
    pub(super) text: &'a str,
    pub(super) column: usize,
}

impl<'a> Piece<'a> {
    fn new(line: &'a str, start: usize, end: usize) -> Self {
        // A field boundary inside a wide character (a stray title) must not split it.
        let floor = |mut at: usize| {
            at = at.min(line.len());
            while !line.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let raw = &line[floor(start)..floor(end)];
        let blanks = raw.len() - raw.trim_start().len();
        Self {
            text: raw.trim(),
            column: floor(start) + blanks + 1,
        }
    }
}

/// Name and value fields of a card: by commas, by columns, or else by blanks.
pub(super) fn pairs(line: &str, width: usize) -> Vec<(Piece<'_>, Piece<'_>)> {
    let fields = if line.contains(',') {
        split_where(line, |c| c == ',')
    } else {
        let columns: Vec<Piece<'_>> = (0..line.len().div_ceil(width))
            .map(|i| Piece::new(line, i * width, (i + 1) * width))
            .collect();
        // Decks written by hand sometimes ignore the columns; then no column reads as a name.
        let fits = |pair: &[Piece<'_>]| {
            pair[0].text.is_empty() || (pair.len() == 2 && typed_name(pair[0].text).is_ok())
        };
        if columns.chunks(2).all(fits) {
            columns
        } else {
            by_blanks(line)
        }
    };
    let filled = |pair: &&[Piece<'_>]| pair.iter().any(|piece| !piece.text.is_empty());
    fields
        .chunks(2)
        .filter(filled)
        .map(|pair| {
            let missing = Piece::new(line, line.len(), line.len());
            (pair[0], pair.get(1).copied().unwrap_or(missing))
        })
        .collect()
}

fn split_where(line: &str, is_separator: fn(char) -> bool) -> Vec<Piece<'_>> {
    let mut start = 0;
    line.split(is_separator)
        .map(|text| {
            let piece = Piece::new(line, start, start + text.len());
            start += text.len() + 1;
            piece
        })
        .collect()
}

/// Words of a line, a type letter on its own joined with the name after it.
fn by_blanks(line: &str) -> Vec<Piece<'_>> {
    let words = split_where(line, |c| c.is_ascii_whitespace());
    let mut joined: Vec<Piece<'_>> = Vec::new();
    for word in words.into_iter().filter(|word| !word.text.is_empty()) {
        let n = joined.len();
        match joined.last_mut() {
            Some(last) if n % 2 == 1 && last.text.len() == 1 => {
                let end = word.column - 1 + word.text.len();
                *last = Piece::new(line, last.column - 1, end);
            }
            _ => joined.push(word),
        }
    }
    joined
}

/// One `*PARAMETER_EXPRESSION` card with its continuation lines.
pub(super) struct ExpressionCard<'a> {
    pub(super) name: &'a str,
    name_column: usize,
    /// Index of the line, text, and column from 1 of its first byte.
    lines: Vec<(usize, &'a str, usize)>,
}

impl ExpressionCard<'_> {
    pub(super) fn text(&self) -> String {
        self.lines.iter().map(|(_, text, _)| *text).collect()
    }

    /// Places a problem on the line it belongs to.
    pub(super) fn diagnostic(&self, problem: ParameterProblem) -> ParameterProblemAt {
        let (mut line_idx, mut column) = (self.lines[0].0, self.name_column);
        if let ParameterProblem::Field(ParameterError::Expression(error)) = &problem {
            let mut rest = error.column - 1;
            for &(idx, text, start) in &self.lines {
                (line_idx, column) = (idx, start + rest.min(text.len()));
                if rest < text.len() {
                    break;
                }
                rest -= text.len();
            }
        }
        ParameterProblemAt {
            line_idx,
            column,
            problem,
        }
    }
}

pub(super) fn expression_cards<'a>(lines: &[&'a str], width: usize) -> Vec<ExpressionCard<'a>> {
    let mut cards: Vec<ExpressionCard<'a>> = Vec::new();
    for (line_idx, line) in lines.iter().enumerate() {
        // The expression itself may hold commas; only one right behind the name separates.
        let head_end = line
            .char_indices()
            .nth(width + 1)
            .map_or(line.len(), |(at, _)| at);
        let (name_end, text_start) = match line[..head_end].find(',') {
            Some(comma) if typed_name(&line[..comma]).is_ok() => (comma, comma + 1),
            _ => (width, width),
        };
        let name = Piece::new(line, 0, name_end);
        let mut start = text_start.min(line.len());
        while !line.is_char_boundary(start) {
            start -= 1;
        }
        let part = (line_idx, &line[start..], start + 1);
        match cards.last_mut() {
            Some(card) if name.text.is_empty() => card.lines.push(part),
            _ if line.trim().is_empty() => {}
            _ => cards.push(ExpressionCard {
                name: name.text,
                name_column: name.column,
                lines: vec![part],
            }),
        }
    }
    cards
}
