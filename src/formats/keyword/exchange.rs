//! Copies a deck with the thickness of some shells replaced and everything else byte for byte.

mod element;

use super::super::model::IncludedAs;
use super::block::{Block, Blocks, end_of_file_mark};
use super::card::{Layout, TEN_BY_8};
pub use super::forming::ResultCards;
use super::forming::{ResultUnits, result_cards};
use super::include::layout_of_keyword;
use super::mesh::{ElementKeyword, ShellCards, element_keyword};
use super::nodes::shifted;
use super::plies::is_ply;
use super::shells::thickness_line;
use super::source_file::SourceFile;
use super::state_cards::Pieces;
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
    pub states: &'a dyn Fn(&ExchangedDeck) -> Result<Pieces, Cancelled>,
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
/// name, with the keyword of a block that has no others, and puts the states before `*END` (or at the end).
/// Elements change to the keyword with the option `THICKNESS` where they stand; other options, comments and the
/// order stay. Shells without a new thickness and all other lines are copied byte for byte.
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
    // What a copy adds stands before the mark that ends files of DOS.
    let mut end = end_of_file_mark(bytes);
    while let Some(block) = blocks.next() {
        monitor.check()?;
        if let Some(layout) = layout_of_keyword(&block)
            && !rules.included_as.layout_is_fixed
        {
            copy.result.layout = layout;
            blocks.set_layout(layout);
        } else if block.name == "END" {
            end = block.offset;
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
    copy.up_to(end);
    let states = (rules.states)(&copy.result)?;
    if !states.is_empty() {
        copy.new_line();
        for piece in states {
            monitor.check()?;
            copy.lines(&piece);
        }
    }
    copy.up_to(bytes.len());
    Ok(copy.result)
}

/// What ends the lines of a deck.
pub(super) fn line_end_of(bytes: &[u8]) -> &'static [u8] {
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
            if card.is_blank() || cards.plies && is_ply(&card) {
                continue;
            }
            let id = card.required_id(TEN_BY_8, 0).ok();
            let is_quadratic = card.id(TEN_BY_8, 6).is_ok_and(|node| node != 0);
            let thickness = cards
                .thickness
                .then(|| thickness_line(&mut lines))
                .flatten();
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
                    let place = &self.rules.included_as;
                    let of_file = element.on_card(place, new);
                    let card =
                        self.set_thickness(&element, &of_file.map(|t| t / place.length_factor));
                    let listed = element.corners_as_in(place, of_file);
                    self.list(&element, &keyword, Some((&listed, &card)));
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
mod tests;
