//! `*ELEMENT_SHELL` with all its options.

use std::collections::HashMap;
use std::ops::Range;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Shell, ShellExtra};
use super::super::text;
use super::block::{Block, Cards};
use super::card::{Card, EIGHT_BY_10, FIVE_BY_16, FieldError, Misread, TEN_BY_8, columns};
use super::chunks::{Cut, Irregular};
use super::mesh::{FifthField, ShellCards};
use super::nodes::shifted;
use super::number::parse_digits;
use super::plies::is_ply;

/// Bytes of a shell's card in a compact deck; estimates of how many there are count on no less.
const MIN_LINE: usize = 16;

/// What stands in place of a thickness card that is missing.
const FOUR_THICKNESSES: &str =
    "four thicknesses on a card of their own, or the keyword without _THICKNESS";

/// What an include adds to the ids of its elements and the lengths on their cards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ElementOffsets {
    pub element: i64,
    pub part: i64,
    pub node: i64,
    /// Factor on lengths.
    pub length: f64,
}

/// Node ids in 32 bits: small ids as they are, others as places in a table. A shell then takes the
/// same memory before and after its ids have become indices.
#[derive(Debug, Clone, Default)]
pub(crate) struct PackedIds {
    wide: Vec<u64>,
}

impl PackedIds {
    const WIDE: u32 = 1 << 31;

    #[inline]
    pub(crate) fn pack(&mut self, id: u64) -> u32 {
        if id < u64::from(Self::WIDE) {
            return id as u32;
        }
        self.wide.push(id);
        Self::WIDE | (self.wide.len() - 1) as u32
    }

    #[inline]
    pub(crate) fn unpack(&self, packed: u32) -> u64 {
        if packed < Self::WIDE {
            packed.into()
        } else {
            self.wide[(packed & !Self::WIDE) as usize]
        }
    }

    /// Takes over the table of a later piece; the result moves its packed ids.
    pub(crate) fn append(&mut self, later: Self) -> impl Fn(u32) -> u32 + use<> {
        let shift = self.wide.len() as u32;
        self.wide.extend(later.wide);
        move |packed| {
            if packed < Self::WIDE {
                packed
            } else {
                packed + shift
            }
        }
    }
}

/// Part ids in the order they were met, found fast while neighbours share their part.
#[derive(Debug, Clone, Default)]
pub(crate) struct PartIds {
    pub ids: Vec<u64>,
    index_of: HashMap<u64, u32>,
    last: u32,
}

impl PartIds {
    #[inline]
    pub(crate) fn index(&mut self, id: u64) -> u32 {
        if self.ids.get(self.last as usize) != Some(&id) {
            let ids = &mut self.ids;
            self.last = *self.index_of.entry(id).or_insert_with(|| {
                ids.push(id);
                (ids.len() - 1) as u32
            });
        }
        self.last
    }
}

/// Shells of one piece of a block. Their `part` is an index into `parts`, their nodes are packed.
#[derive(Debug, Default)]
pub(crate) struct ShellChunk {
    pub shells: Vec<Shell>,
    pub parts: PartIds,
    pub packed: PackedIds,
    pub mid_side: Vec<(u32, [u64; 4])>,
    /// Their plies are an index into `stacks`.
    pub extras: Vec<ShellExtra>,
    /// Plies of the composite shells, of each by itself.
    pub stacks: Vec<Vec<f64>>,
    pub offsets: ShellOffsets,
    pub diagnostics: Diagnostics,
    pub had_tabs: bool,
}

/// Shells whose nodes lie off their mid-surface by a card of their own.
#[derive(Debug, Clone, Default)]
pub(crate) struct ShellOffsets {
    /// Their indices.
    pub shells: Vec<u32>,
    /// The largest distance, without its sign.
    pub largest: f64,
}

impl ShellOffsets {
    /// Adds those of shells that are counted from `first`.
    pub(crate) fn add(&mut self, first: u32, other: Self) {
        self.shells
            .extend(other.shells.into_iter().map(|shell| first + shell));
        self.largest = self.largest.max(other.largest);
    }
}

/// A shell's first card, ids as in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ShellCard {
    id: u64,
    part: u64,
    corners: [u64; 4],
    mid_side: [u64; 4],
}

impl ShellCards {
    /// Where a block of such shells may be cut.
    pub(crate) fn cut(self) -> Cut {
        if self.plies {
            Cut::Nowhere
        } else {
            Cut::Every(1 + usize::from(self.thickness) + self.n_passed_over)
        }
    }
}

/// Reads the shells in a byte range of a block.
pub(crate) fn read_shells(
    block: &Block<'_>,
    range: Range<usize>,
    cards: ShellCards,
    offsets: &ElementOffsets,
    must_be_regular: bool,
) -> Result<ShellChunk, Irregular> {
    let mut reader = Reader {
        columns: columns(TEN_BY_8, block.layout),
        options: cards,
        offsets,
        must_be_regular,
        chunk: ShellChunk::default(),
    };
    let mut cards = block.cards_in(range.clone());
    let line_length = 1 + cards.clone().next_line().map_or(0, |(line, _)| line.len());
    let n_cards = 1 + usize::from(reader.options.thickness) + reader.options.n_passed_over;
    // A blank first line says nothing about the others.
    let n_expected = range.len() / (line_length.max(MIN_LINE) * n_cards);
    reader.chunk.shells.reserve(n_expected);
    if reader.options.thickness {
        reader.chunk.extras.reserve(n_expected);
    }
    while let Some((line, at)) = cards.next_line() {
        reader.element(line, at, &mut cards)?;
    }
    Ok(reader.chunk)
}

struct Reader<'a> {
    columns: [usize; 11],
    options: ShellCards,
    offsets: &'a ElementOffsets,
    must_be_regular: bool,
    chunk: ShellChunk,
}

impl Reader<'_> {
    /// Reads the cards of one element, the first of which is `line`.
    fn element<'a>(
        &mut self,
        line: &'a [u8],
        at: usize,
        cards: &mut Cards<'a>,
    ) -> Result<(), Irregular> {
        let shell = match fixed_shell(line, &self.columns) {
            Some(shell) => Some(shell),
            None => {
                let card = cards.card(line, at);
                self.chunk.had_tabs |= card.had_tabs();
                if card.is_blank() {
                    return Ok(());
                }
                match shell_card(&card) {
                    Ok(shell) => Some(shell),
                    Err(error) => {
                        let misread = card.misread(is_whole_shell);
                        let kind = Misread::kind(misread, &error);
                        let what = || shell_name(&card);
                        let describe = || card.diagnose_misread(&error, misread, &what());
                        self.chunk.diagnostics.push_with(kind, describe);
                        None
                    }
                }
            }
        };
        let kept = shell.and_then(|shell| self.keep(&shell, || cards.card(line, at)));
        if self.options.thickness {
            let has_mid_side = shell.is_some_and(|shell| shell.mid_side[0] != 0);
            self.thickness(cards, kept, has_mid_side)?;
        }
        for index in 0..self.options.n_passed_over {
            let Some((line, at)) = cards.next_line() else {
                break;
            };
            if index == 0 && self.options.offset && kept.is_some() {
                self.offset(&cards.card(line, at));
            }
        }
        if self.options.plies {
            self.plies(cards, kept.is_some());
        }
        Ok(())
    }

    /// Adds a shell and says which corners of its card it has; `None` if fewer than three of them differ.
    fn keep<'a>(&mut self, shell: &ShellCard, card: impl Fn() -> Card<'a>) -> Option<[usize; 4]> {
        let corners = shell.corners.map(|id| shifted(id, self.offsets.node));
        let id = shifted(shell.id, self.offsets.element);
        let Some(places) = distinct_corners(corners) else {
            self.chunk
                .diagnostics
                .push_with(DiagnosticKind::DegenerateElement, || {
                    let kind = DiagnosticKind::DegenerateElement;
                    let message = format!("shell {id} has fewer than three different nodes");
                    Diagnostic::new(kind, message).at(card().position(0))
                });
            return None;
        };
        if shell.mid_side != [0; 4] {
            let nodes = shell.mid_side.map(|id| shifted(id, self.offsets.node));
            let index = self.chunk.shells.len() as u32;
            self.chunk.mid_side.push((index, nodes));
        }
        let part = shifted(shell.part, self.offsets.part);
        let nodes = places.map(|place| self.chunk.packed.pack(corners[place]));
        self.chunk.shells.push(Shell {
            id,
            nodes,
            part: self.chunk.parts.index(part),
        });
        Some(places)
    }

    /// Reads the thickness card of the shell that was read last, and the second one that mid-side
    /// nodes bring.
    fn thickness(
        &mut self,
        cards: &mut Cards<'_>,
        kept: Option<[usize; 4]>,
        has_mid_side: bool,
    ) -> Result<(), Irregular> {
        if has_mid_side && self.must_be_regular {
            return Err(Irregular);
        }
        let before = cards.clone();
        let Some((line, at)) = cards.next_line() else {
            let message = self.no_thickness("the last shell", kept.is_some());
            let at = before.card(b"", before.offset()).position(0);
            let missing = Diagnostic::new(DiagnosticKind::MissingCard, message).at(at);
            let missing = missing.expected(FOUR_THICKNESSES);
            let found = &mut self.chunk.diagnostics;
            found.beside_geometry(|found| found.push(missing));
            return Ok(());
        };
        let card = cards.card(line, at);
        match (thickness_card(&card), kept) {
            (Ok((thickness, angle)), Some(places)) => {
                // The fourth of a triangle counts nowhere and stays as it is.
                let of_corners = match places {
                    [_, 1, ..] => thickness,
                    places => places.map(|place| thickness[place]),
                };
                self.chunk.extras.push(ShellExtra {
                    shell: self.chunk.shells.len() as u32 - 1,
                    thickness: of_corners.map(|t| t * self.offsets.length),
                    beta: match self.options.fifth {
                        FifthField::Angle => angle,
                        FifthField::CoordinateSystem => 0.0,
                    },
                    plies: None,
                });
            }
            (Ok(_), None) => {}
            // A shell's card in its place: the thickness card is missing.
            (Err(_), _) if is_whole_shell(&card) => {
                if self.must_be_regular {
                    return Err(Irregular);
                }
                *cards = before;
                let kind = DiagnosticKind::MissingCard;
                let message = self.no_thickness("a shell", kept.is_some());
                let describe = || {
                    let diagnostic = Diagnostic::new(kind, message).at(card.position(0));
                    diagnostic
                        .found(card.line_text())
                        .expected(FOUR_THICKNESSES)
                };
                let found = &mut self.chunk.diagnostics;
                found.beside_geometry(|found| found.push_with(kind, describe));
                return Ok(());
            }
            (Err(error), _) => {
                let describe = || card.diagnose(&error, "the shell's thickness");
                let found = &mut self.chunk.diagnostics;
                found.beside_geometry(|found| found.push_with(error.kind, describe));
            }
        }
        if has_mid_side {
            cards.next_line();
        }
        Ok(())
    }

    /// Remembers that the shell read last has an offset, which is not carried out.
    fn offset(&mut self, card: &Card<'_>) {
        let by = card.length_or_zero(FIVE_BY_16, 0).unwrap_or(0.0);
        if by != 0.0 {
            let offsets = &mut self.chunk.offsets;
            offsets.shells.push(self.chunk.shells.len() as u32 - 1);
            offsets.largest = offsets.largest.max(by.abs() * self.offsets.length);
        }
    }

    /// What is said of the shell that was read last, if it was kept.
    fn no_thickness(&self, otherwise: &str, is_kept: bool) -> String {
        let last = self.chunk.shells.last().filter(|_| is_kept);
        let shell = last.map_or_else(
            || otherwise.to_owned(),
            |shell| format!("shell {}", shell.id),
        );
        format!("{shell} has no thickness card")
    }

    /// Reads the plies of a composite shell, whose thickness is their sum unless it has its own.
    fn plies(&mut self, cards: &mut Cards<'_>, is_kept: bool) {
        let mut plies = Vec::new();
        loop {
            let before = cards.clone();
            let Some(card) = cards.next() else { break };
            if !is_ply(&card) {
                *cards = before;
                break;
            }
            let thickness = |index| card.length_or_zero(EIGHT_BY_10, index).unwrap_or(0.0);
            plies.push(thickness(1) * self.offsets.length);
            // `_LONG` has a ply id in place of the second ply, without a thickness.
            if ![4, 5]
                .into_iter()
                .any(|index| card.is_empty_field(EIGHT_BY_10, index))
            {
                plies.push(thickness(5) * self.offsets.length);
            }
        }
        let sum: f64 = plies.iter().sum();
        let has_layers = plies.iter().all(|ply| *ply >= 0.0) && sum > 0.0;
        if !is_kept || !has_layers {
            return;
        }
        let shell = self.chunk.shells.len() as u32 - 1;
        let stack = self.chunk.stacks.len() as u32;
        self.chunk.stacks.push(plies);
        let own = self.chunk.extras.last_mut();
        match own.filter(|extra| extra.shell == shell) {
            Some(extra) => {
                extra.plies = Some(stack);
                for own in extra.thickness.iter_mut().filter(|own| **own == 0.0) {
                    *own = sum;
                }
            }
            None => self.chunk.extras.push(ShellExtra {
                shell,
                thickness: [sum; 4],
                beta: 0.0,
                plies: Some(stack),
            }),
        }
    }
}

/// The thickness card of a shell whose first card was the last line; `None`, and no line is taken, if the card of
/// another shell stands in its place.
pub(crate) fn thickness_line<'a>(cards: &mut Cards<'a>) -> Option<(&'a [u8], usize)> {
    let before = cards.clone();
    let (line, at) = cards.next_line()?;
    let card = cards.card(line, at);
    if thickness_card(&card).is_err() && is_whole_shell(&card) {
        *cards = before;
        return None;
    }
    Some((line, at))
}

/// Which corners of a card a shell has: without repeated neighbours, a triangle's third one twice. `None` for less
/// than that.
pub(crate) fn distinct_corners([a, b, c, d]: [u64; 4]) -> Option<[usize; 4]> {
    if [a, b, c].contains(&0) {
        return None;
    }
    let differ = |a, b, c| a != b && b != c && c != a;
    if d == 0 || c == d || d == a {
        return differ(a, b, c).then_some([0, 1, 2, 2]);
    }
    if a == b || b == c {
        return differ(a, c, d).then_some([0, 2, 3, 3]);
    }
    // A quad folded onto its diagonal has no area but four edges; it is left to the area check.
    Some([0, 1, 2, 3])
}

fn shell_name(card: &Card<'_>) -> String {
    match card.id(TEN_BY_8, 0) {
        Ok(id) if id != 0 => format!("shell {id}"),
        _ => "the shell".to_owned(),
    }
}

/// A shell's first card in any form. Exactly what [`fixed_shell`] does for plain fixed lines.
fn shell_card(card: &Card<'_>) -> Result<ShellCard, FieldError> {
    let mut ids = [0; 10];
    ids[0] = card.required_id(TEN_BY_8, 0)?;
    for (i, id) in ids.iter_mut().enumerate().skip(1) {
        *id = card.id(TEN_BY_8, i)?;
    }
    Ok(ShellCard::from_ids(&ids))
}

/// True if a card is a shell with part and three corners.
pub(crate) fn is_whole_shell(card: &Card<'_>) -> bool {
    shell_card(card).is_ok_and(|shell| shell.part != 0 && !shell.corners[..3].contains(&0))
}

impl ShellCard {
    fn from_ids(ids: &[u64; 10]) -> Self {
        Self {
            id: ids[0],
            part: ids[1],
            corners: [ids[2], ids[3], ids[4], ids[5]],
            mid_side: [ids[6], ids[7], ids[8], ids[9]],
        }
    }
}

/// A shell from a line of blanks and digits in fixed columns; `None` leaves it to the general way.
#[inline]
fn fixed_shell(line: &[u8], columns: &[usize; 11]) -> Option<ShellCard> {
    // A comma or tab anywhere changes the meaning of the whole line; a tab beside a number would
    // otherwise pass for a blank.
    if line.len() <= columns[4] || memchr::memchr2(b',', b'\t', line).is_some() {
        return None;
    }
    let mut ids = [0; 10];
    for (i, id) in ids.iter_mut().enumerate() {
        let (from, to) = (columns[i], columns[i + 1].min(line.len()));
        if from >= to {
            break;
        }
        *id = match parse_digits(&line[from..to]) {
            Some(id) => id,
            None if line[from..to].iter().all(|&b| b == b' ') => 0,
            None => return None,
        };
    }
    (ids[0] != 0).then(|| ShellCard::from_ids(&ids))
}

/// A thickness; `None` for a blank field.
pub(crate) fn not_negative(
    card: &Card<'_>,
    widths: &[u8],
    index: usize,
) -> Result<Option<f64>, FieldError> {
    let value = card.length(widths, index)?;
    if value.is_some_and(|value| value < 0.0) {
        let field = card.field(widths, index);
        return Err(FieldError {
            kind: DiagnosticKind::BadField,
            column: field.column,
            found: text::decoded(field.text).into_owned(),
            expected: "a thickness that is not negative",
        });
    }
    Ok(value)
}

fn thickness_card(card: &Card<'_>) -> Result<([f64; 4], f64), FieldError> {
    let mut thickness = [0.0; 4];
    for (i, value) in thickness.iter_mut().enumerate() {
        *value = not_negative(card, FIVE_BY_16, i)?.unwrap_or(0.0);
    }
    // A fifth field that is not a number costs the angle only.
    let angle = card.real_or_zero(FIVE_BY_16, 4).unwrap_or(0.0);
    Ok((thickness, angle))
}

/// The last card in a range that begins the element `id` of part `part`, and its offset.
pub(crate) fn find_element(
    block: &Block<'_>,
    range: Range<usize>,
    id: u64,
    part: u64,
    offsets: &ElementOffsets,
) -> Option<usize> {
    let same = |card: &Card<'_>| {
        card.id(TEN_BY_8, 0)
            .is_ok_and(|i| shifted(i, offsets.element) == id)
            && card
                .id(TEN_BY_8, 1)
                .is_ok_and(|p| shifted(p, offsets.part) == part)
    };
    block
        .cards_in(range)
        .filter(same)
        .last()
        .map(|card| card.offset())
}

#[cfg(test)]
mod tests {
    use super::super::card::Layout;
    use super::super::source_file::SourceFile;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_tab_within_a_field_moves_the_fields_behind_it() {
        let line = b"       1       1       1       2\t3";
        assert_eq!(
            fixed_shell(line, &columns(TEN_BY_8, Layout::Standard)),
            None
        );
    }

    #[test]
    fn repeated_corners_make_triangles_or_nothing() {
        assert_eq!(distinct_corners([1, 2, 3, 4]), Some([0, 1, 2, 3]));
        assert_eq!(distinct_corners([1, 2, 3, 3]), Some([0, 1, 2, 2]));
        assert_eq!(distinct_corners([1, 2, 3, 0]), Some([0, 1, 2, 2]));
        assert_eq!(distinct_corners([1, 2, 3, 1]), Some([0, 1, 2, 2]));
        assert_eq!(distinct_corners([1, 1, 2, 3]), Some([0, 2, 3, 3]));
        assert_eq!(distinct_corners([1, 2, 2, 3]), Some([0, 2, 3, 3]));
        assert_eq!(distinct_corners([1, 2, 2, 2]), None);
        assert_eq!(distinct_corners([1, 2, 0, 0]), None);
        assert_eq!(distinct_corners([1, 2, 1, 2]), Some([0, 1, 2, 3]));
    }

    #[test]
    fn large_ids_survive_packing() {
        let mut first = PackedIds::default();
        let mut later = PackedIds::default();
        let ids = [1, 1 << 31, u64::MAX, 7];
        let a = ids.map(|id| first.pack(id));
        let b = ids.map(|id| later.pack(id));
        let moved = first.append(later);
        assert_eq!(a.map(|packed| first.unpack(packed)), ids);
        assert_eq!(b.map(|packed| first.unpack(moved(packed))), ids);
    }

    proptest! {
        #[test]
        fn the_fast_way_reads_what_the_general_way_reads(
            line in "([ ]{0,7}[0-9]{1,7}){0,10}[ 0-9.,&\t]{0,50}",
        ) {
            let file = SourceFile::new("t.k", line.clone());
            for layout in [Layout::Standard, Layout::I10, Layout::Long] {
                let card = Card::new(line.as_bytes(), 0, layout, &file, None);
                if let Some(fast) = fixed_shell(line.as_bytes(), &columns(TEN_BY_8, layout)) {
                    prop_assert_eq!(Ok(fast), shell_card(&card));
                }
            }
        }
    }
}
