//! Fuzzy search for the command search: which letters of a label fit what was typed, and how well.

use nucleo_matcher::chars::normalize;
use nucleo_matcher::{Config, Matcher, Utf32Str};

/// Words that mean the same here: who types one also finds the others.
const SYNONYMS: &[&[&str]] = &[
    &["rotate", "turn", "spin"],
    &["flip", "turn over"],
    &["move", "translate", "shift"],
    &["isometric", "iso", "axonometric"],
    &["image", "picture", "screenshot"],
    &["reset", "as loaded", "original"],
    &["transparent", "see-through", "opacity"],
    &["centre", "center"],
    &["colour", "color"],
    &["cards", "include", "keyword"],
    &["preferences", "settings", "options"],
    &["reduce", "decimate", "simplify", "coarsen"],
    &["match", "fit", "register", "icp"],
    &["deviation", "distance", "error"],
    &["section", "cut", "clip"],
    &["quit", "exit", "close"],
    &["save", "write", "export"],
    &["180°", "180 deg"],
    &["grey", "greyscale", "grayscale", "black and white"],
    &["timings", "times", "duration"],
    &["history", "steps"],
    &["sweep", "tables"],
    &["diagnostics", "warnings"],
    &["map", "transfer"],
    &["show only", "isolate"],
];

/// Least points per letter of a find in a label; scattered letters have fewer.
const LEAST_PER_LETTER: f64 = 15.0;
/// Points per letter of a find in the help: where it begins a word, and elsewhere. A word of the label has
/// 26 and more.
const HELP_PER_LETTER: [f64; 2] = [24.0, 16.0];
/// What a synonym is worth beside the word itself.
const SYNONYM_SHARE: f64 = 0.7;

/// A match of the query in a text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Find {
    /// The more, the better.
    pub score: f64,
    /// The letters of the label that fit, by their number, in order.
    pub letters: Vec<usize>,
}

/// A search for what was typed, to be asked for one label after the other.
pub struct Search {
    words: Vec<Vec<char>>,
    synonyms: Vec<Vec<Vec<char>>>,
    matcher: Matcher,
}

impl Search {
    /// A search for all words of `typed`. Case, accents and signs such as × do not matter.
    pub fn new(typed: &str) -> Self {
        let words = typed.split_whitespace().map(folded);
        let words: Vec<Vec<char>> = words.collect();
        let synonyms = words.iter().map(|word| synonyms_of(word)).collect();
        Self {
            words,
            synonyms,
            matcher: Matcher::new(Config::DEFAULT),
        }
    }

    /// True if nothing was typed, so that everything fits.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// How well a label with its help fits; `None` if one of the words does not.
    pub fn find(&mut self, label: &str, help: &str) -> Option<Find> {
        let (label, help) = (folded(label), folded(help));
        let mut all = Find::default();
        for index in 0..self.words.len() {
            let word = self.words[index].clone();
            let mut best = self.of_word(&word, &label, &help);
            for other in self.synonyms[index].clone() {
                let found = self.of_word(&other, &label, &help).map(|found| Find {
                    score: SYNONYM_SHARE * found.score * word.len() as f64 / other.len() as f64,
                    ..found
                });
                best = better(best, found);
            }
            let best = best?;
            all.score += best.score;
            all.letters.extend(best.letters);
        }
        // Of two that fit alike, the shorter one was meant.
        all.score -= 0.2 * label.len() as f64;
        all.letters.sort_unstable();
        all.letters.dedup();
        Some(all)
    }

    fn of_word(&mut self, word: &[char], label: &[char], help: &[char]) -> Option<Find> {
        let mut letters = Vec::new();
        let (text, needle) = (Utf32Str::Unicode(label), Utf32Str::Unicode(word));
        let score = self.matcher.fuzzy_indices(text, needle, &mut letters);
        let in_label = score
            .map(f64::from)
            .filter(|score| *score >= LEAST_PER_LETTER * word.len() as f64)
            .map(|score| Find {
                score,
                letters: letters.into_iter().map(|letter| letter as usize).collect(),
            });
        let in_help = help_points(word, help).map(|per_letter| Find {
            score: per_letter * word.len() as f64,
            letters: Vec::new(),
        });
        better(in_label, in_help)
    }
}

fn better(a: Option<Find>, b: Option<Find>) -> Option<Find> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.score > a.score { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// The points per letter of a word that stands in the help.
fn help_points(word: &[char], help: &[char]) -> Option<f64> {
    let places = help.windows(word.len().max(1)).enumerate();
    let found = places.filter(|(_, part)| *part == word).map(|(at, _)| at);
    let begins = |at: usize| at == 0 || !help[at - 1].is_alphanumeric();
    let [at_beginning, elsewhere] = HELP_PER_LETTER;
    found
        .map(|at| if begins(at) { at_beginning } else { elsewhere })
        .reduce(f64::max)
}

/// The other words of the groups that hold this one, or a word that begins with it.
fn synonyms_of(word: &[char]) -> Vec<Vec<char>> {
    if word.len() < 3 {
        return Vec::new();
    }
    let begins = |known: &str| folded(known).starts_with(word);
    SYNONYMS
        .iter()
        .filter(|group| group.iter().any(|known| begins(known)))
        .flat_map(|group| group.iter())
        .filter(|known| !begins(known))
        .map(|known| folded(known))
        .collect()
}

/// Letters as they are compared: lower case, without accents, signs as one types them.
fn folded(text: &str) -> Vec<char> {
    text.chars().map(fold).collect()
}

fn fold(letter: char) -> char {
    match letter {
        '×' => 'x',
        '−' | '–' | '—' => '-',
        '≤' => '<',
        '≥' => '>',
        '→' => '>',
        other => normalize(other.to_lowercase().next().unwrap_or(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn letters(typed: &str, label: &str) -> Option<Vec<usize>> {
        Some(Search::new(typed).find(label, "")?.letters)
    }

    #[test]
    fn signs_accents_and_case_do_not_matter() {
        assert_eq!(letters("4x4", "Rows of 4×4"), Some(vec![8, 9, 10]));
        assert_eq!(letters("ruck", "RÜCKWÄRTS"), Some(vec![0, 1, 2, 3]));
        assert_eq!(letters("über", "Uber"), Some(vec![0, 1, 2, 3]));
        assert_eq!(letters("≤ 5", "x < 5"), Some(vec![2, 4]));
    }

    #[test]
    fn scattered_letters_are_no_find_and_every_word_counts() {
        assert_eq!(letters("ub", "Quiz of zebras"), None);
        assert!(letters("save part", "Save moved part…").is_some());
        assert!(letters("save whale", "Save moved part…").is_none());
        assert!(letters("dtot", "Redo the step that was not").is_none());
    }

    #[test]
    fn a_synonym_finds_less_than_the_word() {
        let score = |typed: &str, label: &str| {
            let found = Search::new(typed).find(label, "");
            found.map(|found| found.score)
        };
        assert!(score("turn", "Rotate").is_some());
        assert!(score("turn", "Rotate") < score("turn", "Turn"));
        assert!(score("scree", "Save image…").is_some());
        assert!(score("iso", "Isometric").is_some());
    }

    #[test]
    fn a_word_of_the_help_is_found() {
        let mut search = Search::new("theme");
        let found = search
            .find("Preferences…", "Theme, UI scale")
            .expect("found");
        assert!(found.letters.is_empty());
        let scattered = search.find("Open the example pair", "");
        assert!(scattered.is_none_or(|other| other.score < found.score));
    }
}
