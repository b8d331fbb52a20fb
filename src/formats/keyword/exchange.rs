//! Copies a deck with the thickness of some shells exchanged and everything else byte for byte.

mod element;

use super::super::model::IncludedAs;
use super::block::{Block, Blocks};
use super::card::{Layout, TEN_BY_8};
pub use super::forming::ResultCards;
use super::forming::{ResultUnits, result_cards};
use super::include::layout_of_keyword;
use super::mesh::{ElementKeyword, ShellCards, element_keyword};
use super::nodes::shifted;
use super::source_file::SourceFile;
use crate::monitor::{Cancelled, Monitor};
use element::{Element, Keyword};

/// Elements between two questions whether the copy is still wanted.
const CHUNK: usize = 4096;

/// What becomes of a shell of the deck.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exchange {
    /// It gets these corner thicknesses.
    Thickness([f64; 4]),
    /// It stays as it is, but is listed with the exchanged ones.
    Listed,
    /// It is none of the shells in question.
    Other,
}

/// What is exchanged in one file of a deck. Ids and thicknesses are those of the whole deck, whatever an
/// include adds to the file's own.
#[derive(Clone, Copy)]
pub struct ExchangeRules<'a> {
    /// How the deck reads the file.
    pub included_as: IncludedAs,
    /// Width of the fields of the file in which the list will stand; `None` for that of this file.
    pub list_layout: Option<Layout>,
    /// What becomes of a shell, by its id.
    pub exchange_of: &'a dyn Fn(u64) -> Exchange,
    /// Which results are left out; `None` if all stay.
    pub leaves_out: Option<&'a dyn Fn(&ResultCards) -> bool>,
    /// What is put at the end of the file, given what was found in it.
    pub states: &'a dyn Fn(&ExchangedDeck) -> Result<Vec<u8>, Cancelled>,
}

/// A deck with exchanged elements.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExchangedDeck {
    /// The new deck.
    pub bytes: Vec<u8>,
    /// Shells whose thickness was set.
    pub n_exchanged: usize,
    /// Shells that were to be exchanged or listed, with plies or not.
    pub n_found: usize,
    /// Shells that were to be exchanged but have plies of their own (`_COMPOSITE`), left as they are.
    pub n_composite: usize,
    /// Shell keywords whose cards are not known, left as they are.
    pub n_unknown: usize,
    /// Shells and sets whose stresses or strains were left out, each kind counted by itself.
    pub n_left_out: usize,
    /// Line of the first block of results that are out of step and left as they are.
    pub unread_results: Option<u64>,
    /// Width of the deck's fields after its last keyword.
    pub layout: Layout,
    /// The cards of the exchanged and the listed shells alone, below their keywords, with the ids and the
    /// thicknesses of the whole deck.
    pub elements: Vec<u8>,
    /// The deck's `*PARAMETER` blocks, which the cards may use.
    pub parameters: Vec<u8>,
    /// Shells that are missing there: what the include changes in their further cards is not known, or
    /// their ids have more than ten digits.
    pub n_unlisted: usize,
}

/// Sets the corner thicknesses of the shells for which there are some, leaves out the results that the rules
/// name, with the keyword of a block that has no others, and puts the states before `*END` (or at the end). Elements change to the keyword with the option `THICKNESS` where they stand; other options,
/// comments and the order stay. Shells without a new thickness and all other lines are copied byte for byte.
/// O(bytes).
pub fn exchange_thickness(
    deck: &SourceFile,
    rules: &ExchangeRules<'_>,
    monitor: &Monitor,
) -> Result<ExchangedDeck, Cancelled> {
    let bytes = deck.bytes();
    let mut copy = Copy {
        bytes,
        done: 0,
        result: ExchangedDeck {
            bytes: Vec::with_capacity(bytes.len() + bytes.len() / 4),
            n_exchanged: 0,
            n_found: 0,
            n_composite: 0,
            n_unknown: 0,
            n_left_out: 0,
            unread_results: None,
            layout: rules.included_as.layout,
            elements: Vec::new(),
            parameters: Vec::new(),
            n_unlisted: 0,
        },
        rules,
        line_end: line_end_of(bytes),
        listed_below: Vec::new(),
    };
    let mut blocks = Blocks::new(deck, rules.included_as.layout);
    let mut end = None;
    while let Some(block) = blocks.next() {
        monitor.check()?;
        if block.name == "KEYWORD"
            && let Some(layout) = layout_of_keyword(block.remark)
            && !rules.included_as.layout_is_fixed
        {
            copy.result.layout = layout;
            blocks.set_layout(layout);
        } else if block.name == "END" {
            end = Some(block.offset);
            break;
        } else if block.name.starts_with("ELEMENT_SHELL") {
            match element_keyword(&block) {
                ElementKeyword::Shell(cards) => copy.shells(&block, cards, monitor)?,
                _ => copy.result.n_unknown += 1,
            }
        } else if block.name.starts_with("PARAMETER") {
            let lines = &bytes[block.offset..block.body.end];
            copy.result.parameters.extend_from_slice(lines);
        } else if let Some(leaves_out) = rules.leaves_out {
            copy.results(&block, leaves_out);
        }
    }
    copy.up_to(end.unwrap_or(bytes.len()));
    let states = (rules.states)(&copy.result)?;
    if !states.is_empty() {
        copy.new_line();
        copy.lines(&states);
    }
    copy.up_to(bytes.len());
    Ok(copy.result)
}

/// What ends the lines of a deck.
fn line_end_of(bytes: &[u8]) -> &'static [u8] {
    match memchr::memchr(b'\n', bytes) {
        Some(at) if at > 0 && bytes[at - 1] == b'\r' => b"\r\n",
        _ => b"\n",
    }
}

struct Copy<'a> {
    bytes: &'a [u8],
    /// What lies before was copied or replaced.
    done: usize,
    result: ExchangedDeck,
    rules: &'a ExchangeRules<'a>,
    line_end: &'static [u8],
    /// Keyword line of the last element in `result.elements`.
    listed_below: Vec<u8>,
}

impl Copy<'_> {
    /// Copies up to an offset.
    fn up_to(&mut self, offset: usize) {
        self.result
            .bytes
            .extend_from_slice(&self.bytes[self.done..offset]);
        self.done = offset;
    }

    /// Begins a new line unless the copy stands at the begin of one.
    fn new_line(&mut self) {
        if !self.result.bytes.is_empty() && self.result.bytes.last() != Some(&b'\n') {
            self.result.bytes.extend_from_slice(self.line_end);
        }
    }

    fn line(&mut self, text: &[u8]) {
        self.result.bytes.extend_from_slice(text);
        self.result.bytes.extend_from_slice(self.line_end);
    }

    /// Adds lines that end with `\n` with the line ends of the deck.
    fn lines(&mut self, text: &[u8]) {
        if self.line_end == b"\n" {
            self.result.bytes.extend_from_slice(text);
            return;
        }
        for line in text.split_inclusive(|&byte| byte == b'\n') {
            let line = line.strip_suffix(b"\n").unwrap_or(line);
            self.line(line);
        }
    }

    /// One block of results, or of anything else that stays.
    fn results(&mut self, block: &Block<'_>, leaves_out: &dyn Fn(&ResultCards) -> bool) {
        let place = &self.rules.included_as;
        let units = ResultUnits {
            element: place.element_offset,
            set: place.set_offset,
            stress: place.stress_factor,
        };
        let cards = match result_cards(block, units) {
            Ok(cards) => cards,
            Err(at) => {
                let line = block.file.position(at).line;
                self.result.unread_results.get_or_insert(line);
                return;
            }
        };
        let left_out: Vec<&ResultCards> = cards.iter().filter(|cards| leaves_out(cards)).collect();
        if left_out.is_empty() {
            return;
        }
        self.result.n_left_out += left_out.len();
        if left_out.len() == cards.len() {
            self.up_to(block.offset);
            self.done = block.body.start;
        }
        for cards in left_out {
            self.up_to(cards.range.start);
            self.done = cards.range.end;
        }
    }

    /// One block of shells.
    fn shells(
        &mut self,
        block: &Block<'_>,
        cards: ShellCards,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let keyword = Keyword::of(block, cards, self.bytes);
        // The keyword in force at the end of the copy: as in the deck, or with the thickness.
        let mut is_thick = cards.thickness;
        let mut lines = block.cards();
        let mut row = 0_usize;
        while let Some((first, at)) = lines.next_line() {
            row += 1;
            if row.is_multiple_of(CHUNK) {
                monitor.check()?;
            }
            let card = lines.card(first, at);
            if card.is_blank() {
                continue;
            }
            let id = card.required_id(TEN_BY_8, 0).ok();
            let is_quadratic = card.id(TEN_BY_8, 6).is_ok_and(|node| node != 0);
            let thickness = cards.thickness.then(|| lines.next_line()).flatten();
            let second = (thickness.is_some() && is_quadratic)
                .then(|| lines.next_line())
                .flatten();
            let rest = lines.offset();
            for _ in 0..cards.n_passed_over {
                lines.next_line();
            }
            let offset = self.rules.included_as.element_offset;
            let id = id.map(|id| shifted(id, offset));
            let exchange = id.map_or(Exchange::Other, self.rules.exchange_of);
            self.result.n_found += usize::from(exchange != Exchange::Other);
            if cards.plies {
                // How many plies follow is known to the reader of the keyword alone.
                self.result.n_composite += usize::from(exchange != Exchange::Other);
                continue;
            }
            let element = Element {
                first: (first, at),
                thickness: thickness.map(|(line, at)| (lines.card(line, at), line, at)),
                second_thickness: second.map(|(line, at)| (lines.card(line, at), line, at)),
                rest: &self.bytes[rest..lines.offset()],
                is_quadratic,
                card,
                cards,
            };
            let needs_thick = matches!(exchange, Exchange::Thickness(_)) || cards.thickness;
            if needs_thick != is_thick {
                self.up_to(at);
                self.line(keyword.line(needs_thick));
                is_thick = needs_thick;
            }
            match exchange {
                Exchange::Thickness(new) => {
                    let factor = self.rules.included_as.length_factor;
                    let card = self.set_thickness(&element, &new.map(|t| t / factor));
                    self.list(&element, &keyword, Some((&new, &card)));
                }
                Exchange::Listed => self.list(&element, &keyword, None),
                Exchange::Other => {}
            }
        }
        Ok(())
    }

    /// Copies the element's first card, then its thickness cards, new or replaced, which are returned.
    fn set_thickness(&mut self, element: &Element<'_>, new: &[f64; 4]) -> Vec<u8> {
        self.result.n_exchanged += 1;
        let cards = element.thickness_cards(new, element.card.layout());
        let (first, at) = element.first;
        let mut before = at + first.len();
        let old = [&element.thickness, &element.second_thickness];
        for (card, old) in cards.iter().zip(old) {
            match old {
                Some((_, line, at)) => {
                    self.up_to(*at);
                    before = at + line.len();
                    self.done = before;
                }
                None => {
                    self.up_to(before);
                    self.result.bytes.extend_from_slice(self.line_end);
                }
            }
            self.result.bytes.extend_from_slice(card);
        }
        cards.join(self.line_end)
    }

    /// Adds an element to the list, with its new thicknesses, whose cards in the file are given too, or as it
    /// stands.
    fn list(&mut self, element: &Element<'_>, keyword: &Keyword, new: Option<(&[f64; 4], &[u8])>) {
        let place = &self.rules.included_as;
        let is_thick = new.is_some() || element.thickness.is_some();
        let (layout, first, thickness) = if place.keeps_numbers() {
            let cards = new.map(|(_, cards)| cards.to_vec());
            let cards = cards.or_else(|| element.old_thickness_cards(self.line_end));
            (element.card.layout(), element.first.0.to_vec(), cards)
        } else {
            let Some(cards) =
                element.in_whole_deck(place, keyword, new.map(|(new, _)| new), self.line_end)
            else {
                self.result.n_unlisted += 1;
                return;
            };
            cards
        };
        let list_layout = self.rules.list_layout.unwrap_or(self.result.layout);
        let line = keyword.listed(is_thick, [element.card.layout(), layout, list_layout]);
        let list = &mut self.result.elements;
        let mut push = |text: &[u8]| {
            list.extend_from_slice(text);
            list.extend_from_slice(self.line_end);
        };
        if self.listed_below != line {
            push(&line);
            self.listed_below = line;
        }
        push(&first);
        if let Some(card) = thickness {
            push(&card);
        }
        list.extend_from_slice(element.rest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchange(deck: &str, ids: &[u64]) -> ExchangedDeck {
        let file = SourceFile::new("a.k", deck);
        let exchange = |id: u64| match id {
            id if ids.contains(&id) => Exchange::Thickness([1.0, 1.25, 1.5, 1.75]),
            4 => Exchange::Listed,
            _ => Exchange::Other,
        };
        exchanged(&file, IncludedAs::default(), &exchange)
    }

    fn exchanged(
        file: &SourceFile,
        included_as: IncludedAs,
        exchange_of: &dyn Fn(u64) -> Exchange,
    ) -> ExchangedDeck {
        let rules = ExchangeRules {
            included_as,
            list_layout: Some(Layout::Standard),
            exchange_of,
            leaves_out: None,
            states: &|_| Ok(b"*INITIAL_STRESS_SHELL\n".to_vec()),
        };
        exchange_thickness(file, &rules, &Monitor::silent()).unwrap()
    }

    fn text(deck: &ExchangedDeck) -> String {
        String::from_utf8(deck.bytes.clone()).unwrap()
    }

    const CARD: &str = "  1.00000000E+00  1.25000000E+00  1.50000000E+00  1.75000000E+00";

    #[test]
    fn runs_change_their_keyword_and_all_else_stays() {
        let deck = "*KEYWORD\n$ a comment\n*ELEMENT_SHELL\n\
$#   eid     pid      n1      n2      n3      n4\n\
\x20      1       1       1       2       3       4\n\
\x20      2       7       1       2       3       4\n\
$ between\n\
\x20      3       7       1       2       3       3\n\
\x20      4       1       1       2       3       4\n\
*NODE\n       1             0.0             0.0             0.0\n*END\nafter the end\n";
        let found = exchange(deck, &[2, 3]);
        let expected = format!(
            "*KEYWORD\n$ a comment\n*ELEMENT_SHELL\n\
$#   eid     pid      n1      n2      n3      n4\n\
\x20      1       1       1       2       3       4\n\
*ELEMENT_SHELL_THICKNESS\n\
\x20      2       7       1       2       3       4\n{CARD}\n\
$ between\n\
\x20      3       7       1       2       3       3\n{CARD}\n\
*ELEMENT_SHELL\n\
\x20      4       1       1       2       3       4\n\
*NODE\n       1             0.0             0.0             0.0\n\
*INITIAL_STRESS_SHELL\n*END\nafter the end\n"
        );
        assert_eq!(text(&found), expected);
        assert_eq!(
            (found.n_exchanged, found.n_composite, found.n_unknown),
            (2, 0, 0)
        );
        let elements = String::from_utf8(found.elements).unwrap();
        assert!(elements.starts_with("*ELEMENT_SHELL_THICKNESS\n       2"));
        assert!(
            elements
                .ends_with("*ELEMENT_SHELL\n       4       1       1       2       3       4\n")
        );
        assert_eq!(elements.lines().count(), 7);
    }

    #[test]
    fn other_options_and_material_angles_survive() {
        let deck = "*ELEMENT_SHELL_BETA\n\
\x20      1       1       1       2       3       4\n\
\x20            0.9             0.9             0.9             0.9            45.0\n\
*ELEMENT_SHELL_OFFSET\n\
\x20      2       1       1       2       3       4\n\
\x20            0.3\n";
        let found = text(&exchange(deck, &[1, 2]));
        let expected = format!(
            "*ELEMENT_SHELL_BETA\n\
\x20      1       1       1       2       3       4\n\
{CARD}            45.0\n\
*ELEMENT_SHELL_OFFSET\n\
*ELEMENT_SHELL_THICKNESS_OFFSET\n\
\x20      2       1       1       2       3       4\n{CARD}\n\
\x20            0.3\n\
*INITIAL_STRESS_SHELL\n"
        );
        assert_eq!(found, expected);
    }

    #[test]
    fn nothing_exchanged_is_a_copy_with_the_states_before_the_end() {
        let deck = "*KEYWORD\r\n*ELEMENT_SHELL\r\n1,1,1,2,3,4\r\n*END";
        let found = text(&exchange(deck, &[9]));
        assert_eq!(found, deck.replace("*END", "*INITIAL_STRESS_SHELL\r\n*END"));
    }

    #[test]
    fn what_is_put_at_the_end_is_chosen_by_what_was_found() {
        let deck = "*KEYWORD I10=Y\n*ELEMENT_SHELL\n1,1,1,2,3,4\n*END\n";
        let seen = |id: u64| {
            let file = SourceFile::new("a.k", deck);
            let seen = std::cell::Cell::new(None);
            let rules = ExchangeRules {
                included_as: IncludedAs::default(),
                list_layout: None,
                exchange_of: &|found| match found == id {
                    true => Exchange::Listed,
                    false => Exchange::Other,
                },
                leaves_out: None,
                states: &|found| {
                    seen.set(Some((found.layout, found.n_found)));
                    Ok(Vec::new())
                },
            };
            exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
            seen.get()
        };
        assert_eq!(seen(1), Some((Layout::I10, 1)));
        assert_eq!(seen(9), Some((Layout::I10, 0)));
    }

    #[test]
    fn composites_are_left_and_counted() {
        let deck = "*ELEMENT_SHELL_COMPOSITE\n       1       1       1       2       3       4\n";
        let found = exchange(deck, &[1]);
        assert_eq!((found.n_exchanged, found.n_composite), (0, 1));
    }

    #[test]
    fn results_that_are_left_out_take_their_keyword_along_and_nothing_else() {
        let head = "*KEYWORD\r\n*INITIAL_STRESS_SHELL\r\n$ of two shells\r\n";
        let first = "         1         1         2\r\n-.577\r\n$ between\r\n0.577\r\n";
        let second = "         2         1         1\r\n  0.0\r\n";
        let free = "*INITIAL_STRAIN_SHELL\r\n1,1,1,1\r\n1.,2.,3.,4.,5.\r\n6.,0.\r\n$ last\r\n";
        let set = "*INITIAL_STRESS_SHELL_SET\r\n         1\r\n  0.0\r\n";
        let deck = [head, first, "$ next\r\n", second, free, set, "*END\r\n"].concat();
        let file = SourceFile::new("a.k", &deck[..]);
        let left_out = |leaves_out: &dyn Fn(&ResultCards) -> bool| {
            let rules = ExchangeRules {
                included_as: IncludedAs {
                    element_offset: 10,
                    ..IncludedAs::default()
                },
                list_layout: None,
                exchange_of: &|_| Exchange::Other,
                leaves_out: Some(leaves_out),
                states: &|_| Ok(Vec::new()),
            };
            let found = exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
            assert_eq!(found.unread_results, None);
            (text(&found), found.n_left_out)
        };
        assert_eq!(left_out(&|_| false), (deck.clone(), 0));
        let of_shell = |cards: &ResultCards| cards.id == 11 && !cards.is_of_set;
        let rest = [head, "$ next\r\n", second, "$ last\r\n", set, "*END\r\n"].concat();
        assert_eq!(left_out(&of_shell), (rest, 2));
        let strains = |cards: &ResultCards| !cards.is_stress;
        assert_eq!(
            left_out(&strains).0,
            deck.replace(&free[..free.len() - 8], "")
        );
        let of_set = |cards: &ResultCards| cards.is_of_set && cards.id == 1;
        assert_eq!(left_out(&of_set).0, deck.replace(set, ""));
    }

    #[test]
    fn results_that_are_out_of_step_stay_and_are_told() {
        let deck = "*KEYWORD\n*INITIAL_STRESS_SHELL\n         1         1         2\n  0.0\n*END\n";
        let file = SourceFile::new("a.k", deck);
        let rules = ExchangeRules {
            included_as: IncludedAs::default(),
            list_layout: None,
            exchange_of: &|_| Exchange::Other,
            leaves_out: Some(&|_| true),
            states: &|_| Ok(Vec::new()),
        };
        let found = exchange_thickness(&file, &rules, &Monitor::silent()).unwrap();
        assert_eq!(
            (text(&found), found.unread_results),
            (deck.to_owned(), Some(3))
        );
    }

    #[test]
    fn the_list_has_the_numbers_of_the_whole_deck() {
        let deck = "*ELEMENT_SHELL_THICKNESS\n\
\x20      1       2       3       4       5       6\n\
\x20            0.5             0.5             0.5            0.75               9\n\
*ELEMENT_SHELL_OFFSET\n\
\x20      2       2       3       4       5       5\n\
\x20            0.3\n";
        let file = SourceFile::new("a.k", deck);
        let included_as = IncludedAs {
            element_offset: 1_000,
            part_offset: 20,
            node_offset: 300_000_000,
            system_offset: 40,
            ..IncludedAs::default()
        };
        let of = |id: u64| match id {
            1_001 => Exchange::Listed,
            1_002 => Exchange::Thickness([1.0, 1.25, 1.5, 1.75]),
            _ => Exchange::Other,
        };
        let found = exchanged(&file, included_as, &of);
        assert_eq!(
            (found.n_exchanged, found.n_found, found.n_unlisted),
            (1, 2, 0)
        );
        // Nine digits do not fit into eight columns.
        let expected = format!(
            "*ELEMENT_SHELL_THICKNESS%\n\
\x20     1001        22 300000003 300000004 300000005 300000006\n\
\x20 5.00000000E-01  5.00000000E-01  5.00000000E-01  7.50000000E-01              49\n\
*ELEMENT_SHELL_THICKNESS_OFFSET%\n\
\x20     1002        22 300000003 300000004 300000005 300000005\n{CARD}\n\
\x20            0.3\n"
        );
        assert_eq!(String::from_utf8(found.elements).unwrap(), expected);
        // The copy of the file keeps its own numbers.
        let copy = String::from_utf8(found.bytes).unwrap();
        let own = "*ELEMENT_SHELL_OFFSET\n*ELEMENT_SHELL_THICKNESS_OFFSET\n       2       2";
        assert!(copy.contains(own), "{copy}");
    }

    #[test]
    fn a_unit_of_the_include_counts_in_the_copy_and_not_in_the_list() {
        let deck = "*ELEMENT_SHELL+\n                   1                   2                   3                   4                   5                   6\n";
        let file = SourceFile::new("a.k", deck);
        let included_as = IncludedAs {
            length_factor: 1000.0,
            ..IncludedAs::default()
        };
        let of = |_| Exchange::Thickness([1.0, 1.25, 1.5, 1.75]);
        let found = exchanged(&file, included_as, &of);
        let copy = String::from_utf8(found.bytes).unwrap();
        assert!(
            copy.contains("      1.00000000E-03      1.25000000E-03"),
            "{copy}"
        );
        let list = String::from_utf8(found.elements).unwrap();
        assert!(list.starts_with("*ELEMENT_SHELL_THICKNESS+\n"), "{list}");
        assert!(
            list.contains("      1.00000000E+00      1.25000000E+00"),
            "{list}"
        );
        let with_offset = SourceFile::new("b.k", &deck.replace("SHELL+", "SHELL_OFFSET+")[..]);
        assert_eq!(exchanged(&with_offset, included_as, &of).n_unlisted, 1);
    }

    /// The card of the mid-side nodes has the means of the corners beside them, whether there was one or not.
    #[test]
    fn shells_with_mid_side_nodes_get_both_cards() {
        let row = |id: u64| {
            format!(
                "{id:>8}       1       1       2       3       4       5       6       7       8\n"
            )
        };
        let old = format!(
            "{}\n$ middles\n{}    tail\n",
            "             0.9".repeat(4),
            "             0.8".repeat(4)
        );
        let middles = "  1.12500000E+00  1.37500000E+00  1.62500000E+00  1.37500000E+00";
        let thick = format!("*ELEMENT_SHELL_THICKNESS\n{}{old}{}{old}", row(2), row(4));
        let found = exchange(&thick, &[2]);
        let written = format!("{}{CARD}\n$ middles\n{middles}    tail\n", row(2));
        let kept = format!("{}{old}", row(4));
        let states = "*INITIAL_STRESS_SHELL\n";
        assert_eq!(
            text(&found),
            format!("*ELEMENT_SHELL_THICKNESS\n{written}{kept}{states}")
        );
        let listed = String::from_utf8(found.elements).unwrap();
        let without_comment = |text: &str| text.replace("$ middles\n", "");
        assert_eq!(
            listed,
            without_comment(&format!("*ELEMENT_SHELL_THICKNESS\n{written}{kept}"))
        );
        let plain = format!("*ELEMENT_SHELL\n{}", row(2));
        assert_eq!(
            text(&exchange(&plain, &[2])),
            format!(
                "*ELEMENT_SHELL\n*ELEMENT_SHELL_THICKNESS\n{}{CARD}\n{middles}\n{states}",
                row(2)
            )
        );
    }
}
