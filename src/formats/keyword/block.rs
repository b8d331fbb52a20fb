//! Cutting a file into keyword blocks, and a block into cards. Both are cheap: nothing is copied
//! but the keyword's name, and line numbers are worked out only when a diagnostic needs one.

use std::ops::Range;

use memchr::{memchr, memmem};
use rayon::prelude::*;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Position};
use super::card::{Card, Layout, Parameters};
use super::source_file::SourceFile;

const PGP_BEGIN: &[u8] = b"-----BEGIN PGP";
/// Bytes that are searched for encrypted text at a time.
const PIECE: usize = 1 << 20;
const PGP_END: &[u8] = b"-----END PGP";

/// A keyword line and the data lines below it.
#[derive(Clone)]
pub struct Block<'a> {
    /// The file it stands in.
    pub file: &'a SourceFile,
    /// Upper-case name with its options, without `*` and suffix: `ELEMENT_SHELL_THICKNESS`.
    pub name: String,
    /// What follows the name on the keyword line, for example `LONG=Y`.
    pub remark: &'a [u8],
    /// The suffix `%`, `+` or `-`, if there is one.
    pub suffix: Option<Layout>,
    /// How wide the fields are.
    pub layout: Layout,
    /// Byte offset of the `*`.
    pub offset: usize,
    /// Byte range of the data lines.
    pub body: Range<usize>,
    /// True if encrypted text stands among the data lines.
    pub has_encrypted: bool,
    /// Who knows the parameters at this place of the deck.
    pub parameters: Option<&'a dyn Parameters>,
}

impl<'a> Block<'a> {
    /// The data lines; comments and encrypted text are passed over.
    pub fn cards(&self) -> Cards<'a> {
        self.cards_in(self.body.clone())
    }

    /// The data lines of a part of the body that starts at a line's start.
    pub fn cards_in(&self, range: Range<usize>) -> Cards<'a> {
        Cards {
            lines: Lines {
                file: self.file,
                next: range.start,
                end: range.end,
            },
            layout: self.layout,
            parameters: self.parameters,
        }
    }

    /// The first data line, if it and the next ones are cards of another layout only: `is_good`
    /// tells whether a card can be read. One card tells where an element has several.
    pub(crate) fn shifted_columns(
        &self,
        n_cards: usize,
        is_certain: bool,
        is_good: impl Fn(&Card<'_>) -> bool,
    ) -> Option<(Card<'a>, Layout)> {
        let cards = self.cards().filter(|card| !card.is_blank()).take(n_cards);
        let cards: Vec<Card<'a>> = cards.collect();
        let is_shifted = |card: &Card<'a>| !card.is_free() && (is_certain || !is_good(card));
        if cards.is_empty() || !cards.iter().all(is_shifted) {
            return None;
        }
        let layouts = [Layout::Standard, Layout::I10, Layout::Long];
        let fits = |layout: &Layout| {
            let layout = *layout;
            layout != self.layout && cards.iter().all(|card| is_good(&card.with_layout(layout)))
        };
        let layout = layouts.into_iter().find(fits)?;
        Some((cards.into_iter().next()?, layout))
    }

    /// The first data line that would be a known keyword without the blanks before its `*`.
    pub(crate) fn misplaced_keyword(&self) -> Option<Card<'a>> {
        let bytes = self.file.bytes();
        let stars = memchr::memchr_iter(b'*', &bytes[self.body.clone()]);
        let starts = stars.filter_map(|star| {
            let before = &bytes[self.body.start..self.body.start + star];
            let is_blank = |byte: &&u8| byte.is_ascii_whitespace() && **byte != b'\n';
            let n_blanks = before.iter().rev().take_while(is_blank).count();
            let line = before.len() - n_blanks;
            let begins_line = before[..line].last().is_none_or(|&byte| byte == b'\n');
            (n_blanks > 0 && begins_line).then_some(self.body.start + line)
        });
        let mut cards = starts.filter_map(|start| self.cards_in(start..self.body.end).next());
        cards.find(Card::is_misplaced_keyword)
    }

    /// True if the name ends in the given option or holds it between underscores.
    pub fn has_option(&self, option: &str) -> bool {
        self.name.split('_').any(|word| word == option)
    }

    /// Where the keyword stands.
    pub fn position(&self) -> Position {
        self.file.position(self.offset)
    }

    /// A diagnostic about the block as a whole.
    pub fn diagnose(&self, kind: DiagnosticKind, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(kind, message).at(self.position())
    }
}

/// The data lines of a block.
#[derive(Clone)]
pub struct Cards<'a> {
    lines: Lines<'a>,
    layout: Layout,
    parameters: Option<&'a dyn Parameters>,
}

impl<'a> Cards<'a> {
    /// Byte offset of the line that comes next.
    pub fn offset(&self) -> usize {
        self.lines.next
    }

    /// The next line as it stands, with its offset.
    #[inline]
    pub fn next_line(&mut self) -> Option<(&'a [u8], usize)> {
        self.lines.next()
    }

    /// A card of this block from one of its lines.
    pub fn card(&self, line: &'a [u8], offset: usize) -> Card<'a> {
        Card::new(line, offset, self.layout, self.lines.file, self.parameters)
    }
}

impl<'a> Iterator for Cards<'a> {
    type Item = Card<'a>;

    fn next(&mut self) -> Option<Card<'a>> {
        let (line, offset) = self.lines.next()?;
        Some(self.card(line, offset))
    }
}

/// Lines that are neither comments nor encrypted nor the mark that ends files of DOS, with their offsets.
#[derive(Clone)]
struct Lines<'a> {
    file: &'a SourceFile,
    next: usize,
    end: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (&'a [u8], usize);

    #[inline]
    fn next(&mut self) -> Option<(&'a [u8], usize)> {
        loop {
            let (line, offset, next) = next_line(self.file.bytes(), self.next, self.end)?;
            self.next = next;
            match line.first() {
                Some(b'$') => {}
                Some(&END_OF_FILE) if line.iter().all(|&byte| is_end_of_file(byte)) => {}
                Some(b'-') if line.starts_with(PGP_BEGIN) => {
                    let rest = &self.file.bytes()[offset..self.end];
                    self.next = offset + end_of_encrypted(rest);
                }
                _ => return Some((line, offset)),
            }
        }
    }
}

/// Ctrl-Z, with which DOS programs end a text.
const END_OF_FILE: u8 = 0x1a;

fn is_end_of_file(byte: u8) -> bool {
    byte == END_OF_FILE || byte.is_ascii_whitespace()
}

/// Where the mark begins that ends files of DOS, with the blanks around it; the end of the text without one.
pub(crate) fn end_of_file_mark(text: &[u8]) -> usize {
    let n_after = text.iter().rev().take_while(|&&byte| is_end_of_file(byte));
    let after = text.len() - n_after.count();
    memchr(END_OF_FILE, &text[after..]).map_or(text.len(), |at| after + at)
}

/// The line at `start`, its offset, and the offset of the line after it. Without CR and LF.
#[inline]
pub(crate) fn next_line(bytes: &[u8], start: usize, end: usize) -> Option<(&[u8], usize, usize)> {
    if start >= end {
        return None;
    }
    let (stop, next) = match memchr(b'\n', &bytes[start..end]) {
        Some(length) => (start + length, start + length + 1),
        None => (start + end_of_file_mark(&bytes[start..end]), end),
    };
    let line = &bytes[start..stop];
    // Line ends that were converted twice have two of them.
    let n_returns = line.iter().rev().take_while(|&&byte| byte == b'\r').count();
    Some((&line[..line.len() - n_returns], start, next))
}

/// Length of the text up to and with the line that ends an encrypted part.
fn end_of_encrypted(text: &[u8]) -> usize {
    match memmem::find(text, PGP_END) {
        Some(at) => memchr(b'\n', &text[at..]).map_or(text.len(), |i| at + i + 1),
        None => text.len(),
    }
}

/// Cuts a file into blocks. What stands before the first `*` is no block, unless the file has no
/// keyword line at all.
pub struct Blocks<'a> {
    file: &'a SourceFile,
    layout: Layout,
    next: Option<usize>,
    encrypted: Vec<Range<usize>>,
}

impl<'a> Blocks<'a> {
    /// The blocks of a file whose cards are `layout` where the keyword has no suffix.
    pub fn new(file: &'a SourceFile, layout: Layout) -> Self {
        let encrypted = encrypted_ranges(file.bytes());
        let mut blocks = Self {
            file,
            layout,
            next: None,
            encrypted,
        };
        blocks.next = blocks.find_star(0);
        blocks
    }

    /// Changes the width of fields for the blocks to come.
    pub fn set_layout(&mut self, layout: Layout) {
        self.layout = layout;
    }

    /// How many encrypted parts the file has.
    pub fn n_encrypted(&self) -> usize {
        self.encrypted.len()
    }

    /// Where the first encrypted part begins.
    pub fn first_encrypted(&self) -> Option<usize> {
        self.encrypted.first().map(|range| range.start)
    }

    /// Where an encrypted part begins that no line ends: the rest of the file is passed over as encrypted.
    pub fn unended_encrypted(&self) -> Option<usize> {
        let last = self.encrypted.last()?;
        let text = &self.file.bytes()[last.clone()];
        memmem::find(text, PGP_END).is_none().then_some(last.start)
    }

    fn has_encrypted(&self, body: &Range<usize>) -> bool {
        let after = self
            .encrypted
            .partition_point(|range| range.end <= body.start);
        let next = self.encrypted.get(after);
        next.is_some_and(|range| range.start < body.end)
    }

    /// Offset of the next `*` that begins a line at or after the line start `from`.
    fn find_star(&self, from: usize) -> Option<usize> {
        let bytes = self.file.bytes();
        let mut at = from;
        let mut is_star = bytes.get(at) == Some(&b'*');
        loop {
            if !is_star {
                at += memmem::find(bytes.get(at..)?, b"\n*")? + 1;
            }
            let after = self.encrypted.partition_point(|range| range.end <= at);
            match self.encrypted.get(after) {
                Some(range) if range.contains(&at) => {
                    at = range.end;
                    is_star = bytes.get(at) == Some(&b'*');
                }
                // More than one is a number that was too large for its columns.
                _ if bytes.get(at + 1) == Some(&b'*') => is_star = false,
                _ => return Some(at),
            }
        }
    }
}

/// The parts between the lines that begin and end an encrypted message.
fn encrypted_ranges(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut from = 0;
    let finder = memmem::Finder::new(PGP_BEGIN);
    // Nearly every file has none, which all cores find out faster.
    let is_in = |start: usize| {
        let end = (start + PIECE + PGP_BEGIN.len()).min(bytes.len());
        finder.find(&bytes[start..end]).is_some()
    };
    let starts = (0..bytes.len()).into_par_iter().step_by(PIECE);
    if !starts.any(is_in) {
        return ranges;
    }
    while let Some(at) = finder.find(&bytes[from..]).map(|i| from + i) {
        let starts_line = at == 0 || bytes[at - 1] == b'\n';
        if starts_line {
            from = at + end_of_encrypted(&bytes[at..]);
            ranges.push(at..from);
        } else {
            from = at + PGP_BEGIN.len();
        }
    }
    ranges
}

impl<'a> Iterator for Blocks<'a> {
    type Item = Block<'a>;

    fn next(&mut self) -> Option<Block<'a>> {
        let offset = self.next?;
        let bytes = self.file.bytes();
        let (line, _, body_start) = next_line(bytes, offset, bytes.len())?;
        self.next = self.find_star(body_start);
        let (name, suffix, remark) = keyword_line(&line[1..]);
        let body = body_start..self.next.unwrap_or(bytes.len());
        Some(Block {
            file: self.file,
            name,
            remark,
            suffix,
            layout: suffix.unwrap_or(self.layout),
            offset,
            has_encrypted: self.has_encrypted(&body),
            body,
            parameters: None,
        })
    }
}

/// Name, suffix and remark of a keyword line without its `*`.
fn keyword_line(line: &[u8]) -> (String, Option<Layout>, &[u8]) {
    let line = line.trim_ascii_start();
    let end = line
        .iter()
        .position(|b| b" \t,$".contains(b))
        .unwrap_or(line.len());
    let (mut name, remark) = (&line[..end], line[end..].trim_ascii());
    let mut suffix = None;
    if let Some((&last, shorter)) = name.split_last() {
        suffix = Layout::of_suffix(last);
        if suffix.is_some() {
            name = shorter;
        }
    }
    if suffix.is_none() {
        let first_word = remark.split(u8::is_ascii_whitespace).next();
        if let Some(&[mark]) = first_word {
            suffix = Layout::of_suffix(mark);
        }
    }
    let name = String::from_utf8_lossy(name).to_ascii_uppercase();
    (name, suffix, remark)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<(String, Layout, usize)> {
        let file = SourceFile::new("t.k", text);
        let blocks = Blocks::new(&file, Layout::Standard);
        blocks
            .map(|b| (b.name.clone(), b.layout, b.cards().count()))
            .collect()
    }

    #[test]
    fn keyword_lines_in_all_their_forms() {
        let deck =
            "$ head\n*KEYWORD LONG=Y\n*node+\n1\n$ c\n2\r\n*NODE %\n3\n*Node - trailing\n*END";
        let expected = [
            ("KEYWORD", Layout::Standard, 0),
            ("NODE", Layout::Long, 2),
            ("NODE", Layout::I10, 1),
            ("NODE", Layout::Standard, 0),
            ("END", Layout::Standard, 0),
        ];
        let expected: Vec<_> = expected
            .iter()
            .map(|&(n, l, c)| (n.to_owned(), l, c))
            .collect();
        assert_eq!(names(deck), expected);
    }

    #[test]
    fn a_number_written_as_stars_begins_no_keyword() {
        let deck = "*NODE\n1\n********** 0.5\n2\n*END\n";
        let expected = [("NODE", 3), ("END", 0)];
        let names = names(deck);
        let found: Vec<(&str, usize)> = names.iter().map(|(n, _, c)| (&n[..], *c)).collect();
        assert_eq!(found, expected);
        assert!(super::tests::names("**\n").is_empty());
    }

    #[test]
    fn encrypted_text_neither_begins_a_keyword_nor_is_a_card() {
        let deck = "*NODE\n1\n-----BEGIN PGP MESSAGE-----\n\nabc\n*NODE\n-----END PGP MESSAGE-----\n2\n*END\n";
        let got = names(deck);
        assert_eq!(got[0], ("NODE".to_owned(), Layout::Standard, 2));
        assert_eq!(got.len(), 2);
        assert_eq!(
            names("*NODE\n-----BEGIN PGP MESSAGE-----\nabc\n*X").len(),
            1
        );
    }
}
