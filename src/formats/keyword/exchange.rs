//! Copies a deck with the thickness of some shells exchanged and everything else byte for byte.

use super::block::{Block, Blocks};
use super::card::{Card, FIVE_BY_16, Layout, TEN_BY_8};
use super::include::layout_of_keyword;
use super::mesh::{ElementKeyword, ShellCards, element_keyword};
use super::source_file::SourceFile;
use super::state_cards::push_thickness;
use crate::monitor::{Cancelled, Monitor};

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

/// A deck with exchanged elements.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExchangedDeck {
    /// The new deck.
    pub bytes: Vec<u8>,
    /// Shells whose thickness was set.
    pub n_exchanged: usize,
    /// Shells that were to be exchanged but have plies of their own (`_COMPOSITE`), left as they are.
    pub n_composite: usize,
    /// Shell keywords whose cards are not known, left as they are.
    pub n_unknown: usize,
    /// Width of the deck's fields after its last keyword.
    pub layout: Layout,
    /// The cards of the exchanged and the listed shells alone, below their keywords.
    pub elements: Vec<u8>,
}

/// Sets the corner thicknesses of the shells for which `exchange_of` (by element id) has some, and
/// puts `states` before `*END` (or at the end). Elements change to the keyword with the option
/// `THICKNESS` where they stand; other options, comments and the order stay. Shells without a new
/// thickness and all other lines are copied byte for byte. O(bytes).
pub fn exchange_thickness(
    deck: &SourceFile,
    exchange_of: &dyn Fn(u64) -> Exchange,
    states: &dyn Fn(Layout) -> Result<Vec<u8>, Cancelled>,
    monitor: &Monitor,
) -> Result<ExchangedDeck, Cancelled> {
    let bytes = deck.bytes();
    let mut copy = Copy {
        bytes,
        done: 0,
        result: ExchangedDeck {
            bytes: Vec::with_capacity(bytes.len() + bytes.len() / 4),
            n_exchanged: 0,
            n_composite: 0,
            n_unknown: 0,
            layout: Layout::Standard,
            elements: Vec::new(),
        },
        exchange_of,
        line_end: line_end_of(bytes),
        listed_below: String::new(),
    };
    let mut blocks = Blocks::new(deck, Layout::Standard);
    let mut end = None;
    while let Some(block) = blocks.next() {
        monitor.check()?;
        if block.name == "KEYWORD"
            && let Some(layout) = layout_of_keyword(block.remark)
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
        }
    }
    copy.up_to(end.unwrap_or(bytes.len()));
    copy.new_line();
    let states = states(copy.result.layout)?;
    copy.result.bytes.extend_from_slice(&states);
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
    exchange_of: &'a dyn Fn(u64) -> Exchange,
    line_end: &'static [u8],
    /// Keyword line of the last element in `result.elements`.
    listed_below: String,
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
            let rest = lines.offset();
            if cards.thickness && is_quadratic {
                lines.next_line();
            }
            for _ in 0..cards.n_passed_over {
                lines.next_line();
            }
            let exchange = id.map_or(Exchange::Other, self.exchange_of);
            if cards.plies {
                // How many plies follow is known to the reader of the keyword alone.
                self.result.n_composite += usize::from(exchange != Exchange::Other);
                continue;
            }
            let element = Element {
                first: (first, at),
                thickness: thickness.map(|(line, at)| (lines.card(line, at), line, at)),
                rest: &self.bytes[rest..lines.offset()],
                is_quadratic,
                layout: block.layout,
            };
            let needs_thick = matches!(exchange, Exchange::Thickness(_)) || cards.thickness;
            if needs_thick != is_thick {
                self.up_to(at);
                self.line(keyword.line(needs_thick));
                is_thick = needs_thick;
            }
            match exchange {
                Exchange::Thickness(new) => {
                    let card = self.set_thickness(&element, &new);
                    self.list(&element, &keyword, Some(&card));
                }
                Exchange::Listed => self.list(&element, &keyword, None),
                Exchange::Other => {}
            }
        }
        Ok(())
    }

    /// Copies the element's first card, then its thickness card, new or replaced, which is returned.
    fn set_thickness(&mut self, element: &Element<'_>, new: &[f64; 4]) -> Vec<u8> {
        self.result.n_exchanged += 1;
        let card = match &element.thickness {
            Some((card, line, at)) => {
                self.up_to(*at);
                self.done = at + line.len();
                replaced_thickness(card, line, new, element.layout)
            }
            None => {
                let (first, at) = element.first;
                self.up_to(at + first.len());
                self.result.bytes.extend_from_slice(self.line_end);
                let mut card = Vec::new();
                push_thickness(&mut card, new, element.layout);
                if element.is_quadratic {
                    card.extend_from_slice(self.line_end);
                    push_thickness(&mut card, new, element.layout);
                }
                card
            }
        };
        self.result.bytes.extend_from_slice(&card);
        card
    }

    /// Adds an element to the list, with its new thickness card or as it stands.
    fn list(&mut self, element: &Element<'_>, keyword: &Keyword, new: Option<&[u8]>) {
        let old = element.thickness.as_ref().map(|(_, line, _)| *line);
        let line = keyword.line(new.or(old).is_some());
        let list = &mut self.result.elements;
        let mut push = |text: &[u8]| {
            list.extend_from_slice(text);
            list.extend_from_slice(self.line_end);
        };
        if self.listed_below.as_bytes() != line {
            push(line);
            self.listed_below = String::from_utf8_lossy(line).into_owned();
        }
        push(element.first.0);
        if let Some(card) = new.or(old) {
            push(card);
        }
        list.extend_from_slice(element.rest);
    }
}

/// One shell of the deck.
struct Element<'a> {
    /// Its first card and where it stands.
    first: (&'a [u8], usize),
    thickness: Option<(Card<'a>, &'a [u8], usize)>,
    /// Its further cards, with their line ends.
    rest: &'a [u8],
    is_quadratic: bool,
    layout: Layout,
}

/// The new corner thicknesses with what stands behind them on the card, such as a material angle.
fn replaced_thickness(card: &Card<'_>, line: &[u8], new: &[f64; 4], layout: Layout) -> Vec<u8> {
    let mut text = Vec::new();
    push_thickness(&mut text, new, layout);
    let width = layout.width(FIVE_BY_16[0]);
    if card.is_free() {
        let mut fields = line.splitn(5, |&byte| byte == b',');
        if let Some(rest) = fields.nth(4) {
            let plain = new.iter().map(|t| format!("{t:.8E}")).collect::<Vec<_>>();
            text = plain.join(",").into_bytes();
            text.push(b',');
            text.extend_from_slice(rest);
        }
    } else if line.len() > 4 * width {
        text.extend_from_slice(&line[4 * width..]);
    }
    text
}

/// The keyword line of a block and the one with the option `THICKNESS`.
struct Keyword {
    plain: String,
    thick: String,
}

impl Keyword {
    fn of(block: &Block<'_>, cards: ShellCards, bytes: &[u8]) -> Self {
        let rest = &bytes[block.offset..block.body.start];
        let plain = String::from_utf8_lossy(rest).trim_end().to_owned();
        let thick = if cards.thickness {
            plain.clone()
        } else {
            // Behind `*ELEMENT_SHELL`, because the thickness card follows the element's first.
            let stem = "*ELEMENT_SHELL".len().min(plain.len());
            format!("{}_THICKNESS{}", &plain[..stem], &plain[stem..])
        };
        Self { plain, thick }
    }

    fn line(&self, is_thick: bool) -> &[u8] {
        if is_thick {
            self.thick.as_bytes()
        } else {
            self.plain.as_bytes()
        }
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
        let states = |_| Ok(b"*INITIAL_STRESS_SHELL\n".to_vec());
        exchange_thickness(&file, &exchange, &states, &Monitor::silent()).unwrap()
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
        assert_eq!(found, deck.replace("*END", "*INITIAL_STRESS_SHELL\n*END"));
    }

    #[test]
    fn composites_are_left_and_counted() {
        let deck = "*ELEMENT_SHELL_COMPOSITE\n       1       1       1       2       3       4\n";
        let found = exchange(deck, &[1]);
        assert_eq!((found.n_exchanged, found.n_composite), (0, 1));
    }
}
