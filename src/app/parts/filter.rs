//! The filter of the part list: `2000012`, `2000000-2000100`, `pillar`, `t>1.4`.

use crate::formats::PartSummary;

/// One condition of the part filter.
#[derive(Debug, Clone, PartialEq)]
enum Term {
    /// The id begins with these digits, or the title holds them.
    Digits(String),
    /// The id lies in this range.
    Range(u64, u64),
    /// The thickness compares so.
    Thickness(std::cmp::Ordering, bool, f64),
    /// The title holds this word.
    Word(String),
}

impl Term {
    fn is_thickness(&self) -> bool {
        matches!(self, Self::Thickness(..))
    }
}

/// Conditions that must all hold; commas separate alternatives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartFilter {
    alternatives: Vec<Vec<Term>>,
}

impl PartFilter {
    /// Reads what was typed; anything that is no number is a word.
    pub fn parse(text: &str) -> Self {
        let alternatives = split(text);
        let alternatives = alternatives.iter().map(|t| t.trim());
        let alternatives = alternatives.filter(|t| !t.is_empty());
        let terms = |text: &str| text.split_whitespace().map(term).collect();
        Self {
            alternatives: alternatives.map(terms).collect(),
        }
    }

    /// True if a part is to be listed.
    pub fn accepts(&self, part: &PartSummary) -> bool {
        self.alternatives.is_empty()
            || self
                .alternatives
                .iter()
                .any(|terms| terms.iter().all(|term| fits(term, part)))
    }
}

/// The alternatives between commas; one between digits of a thickness is a decimal comma.
fn split(text: &str) -> Vec<String> {
    let mut parts: Vec<String> = Vec::new();
    for piece in text.split(',') {
        let goes_on = parts.last_mut().filter(|before| {
            let last = before.split_whitespace().next_back().unwrap_or_default();
            let is_open = !last.contains('.') && term(last).is_thickness();
            is_open && piece.starts_with(|c: char| c.is_ascii_digit())
        });
        match goes_on {
            Some(before) => before.extend([".", piece]),
            None => parts.push(piece.to_owned()),
        }
    }
    parts
}

fn term(text: &str) -> Term {
    if let Some(comparison) = text.strip_prefix(['t', 'T']).and_then(thickness) {
        return comparison;
    }
    if let Some((low, high)) = text.split_once(['-', '–'])
        && let (Ok(low), Ok(high)) = (low.parse(), high.parse())
    {
        return Term::Range(u64::min(low, high), u64::max(low, high));
    }
    if text.chars().all(|c| c.is_ascii_digit()) {
        return Term::Digits(text.to_owned());
    }
    Term::Word(text.to_lowercase())
}

fn thickness(rest: &str) -> Option<Term> {
    use std::cmp::Ordering;
    let mut signs = rest.chars();
    let ordering = match signs.next()? {
        '>' => Ordering::Greater,
        '<' => Ordering::Less,
        '=' => Ordering::Equal,
        _ => return None,
    };
    let rest = signs.as_str();
    let (or_equal, number) = match rest.strip_prefix('=') {
        Some(number) => (true, number),
        None => (ordering == Ordering::Equal, rest),
    };
    let number = number.parse().ok()?;
    Some(Term::Thickness(ordering, or_equal, number))
}

fn fits(term: &Term, part: &PartSummary) -> bool {
    match term {
        Term::Digits(digits) => {
            part.id.to_string().starts_with(digits) || part.title.contains(digits.as_str())
        }
        Term::Range(low, high) => (low..=high).contains(&&part.id),
        Term::Thickness(ordering, or_equal, limit) => part.thickness.is_some_and(|t| {
            let is_equal = (t - limit).abs() < 1e-9 * limit.abs().max(1.0);
            (*or_equal && is_equal) || (!is_equal && t.partial_cmp(limit) == Some(*ordering))
        }),
        Term::Word(word) => part.title.to_lowercase().contains(word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(id: u64, title: &str, thickness: f64) -> PartSummary {
        PartSummary {
            id,
            title: title.to_owned(),
            n_shells: 1,
            n_solids: 0,
            n_triangles: 2,
            thickness: Some(thickness),
        }
    }

    #[test]
    fn ids_ranges_words_and_thickness() {
        let inner = part(2_000_012, "B-pillar inner", 1.2);
        let outer = part(2_000_013, "B-pillar outer", 1.5);
        let listed = |text: &str| {
            let filter = PartFilter::parse(text);
            [filter.accepts(&inner), filter.accepts(&outer)]
        };
        assert_eq!(listed(""), [true, true]);
        assert_eq!(listed("2000012"), [true, false]);
        assert_eq!(listed("20000"), [true, true]);
        assert_eq!(listed("2000013-2000100"), [false, true]);
        assert_eq!(listed("PILLAR"), [true, true]);
        assert_eq!(listed("pillar outer"), [false, true]);
        assert_eq!(listed("t>1.4"), [false, true]);
        assert_eq!(listed("t<=1.2"), [true, false]);
        assert_eq!(listed("t=1.5"), [false, true]);
        assert_eq!(listed("inner, outer"), [true, true]);
        // A comma within a thickness is a decimal one.
        assert_eq!(listed("t>1,4"), [false, true]);
        assert_eq!(listed("t<=1,2"), [true, false]);
        assert_eq!(listed("t>1,4, inner"), [true, true]);
        assert_eq!(listed("roof,2000013"), [false, true]);
        assert_eq!(listed("roof"), [false, false]);
    }
}
