//! Keywords that hold node coordinates.

use std::ops::Range;

use super::super::MAX_LENGTH;
use super::super::diagnostic::Diagnostics;
use super::block::Block;
use super::card::{Card, EIGHT_BY_10, FieldError, Misread, columns};
use super::chunks::{Cut, Irregular};
use super::number::{parse_digits, parse_real};
use super::shells::not_negative;
use crate::geometry::Point3;

/// Standard widths of a `*NODE` card: id, x, y, z, translational and rotational constraint.
pub const NODE: &[u8] = &[8, 16, 16, 16, 8, 8];

/// Nodes of one piece of a block.
#[derive(Debug, Default)]
pub(crate) struct NodeChunk {
    pub ids: Vec<u64>,
    pub positions: Vec<Point3>,
    pub diagnostics: Diagnostics,
    pub had_tabs: bool,
}

/// True for the keywords whose cards are those of `*NODE`.
pub(crate) fn holds_nodes(name: &str) -> bool {
    matches!(name, "NODE" | "NODE_RIGID_SURFACE" | "NODE_NODES")
}

/// Each line of a node list is a node of its own.
pub(crate) const CUT: Cut = Cut::Every(1);

/// Reads the nodes in a byte range of a block; `offset` is added to ids.
pub(crate) fn read_nodes(
    block: &Block<'_>,
    range: Range<usize>,
    offset: i64,
) -> Result<NodeChunk, Irregular> {
    let mut chunk = NodeChunk::default();
    let columns = columns::<5>(NODE, block.layout);
    let n_expected = range.len() / (columns[4] + 1) + 1;
    chunk.ids.reserve(n_expected);
    chunk.positions.reserve(n_expected);
    let mut cards = block.cards_in(range);
    while let Some((line, at)) = cards.next_line() {
        if let Some((id, position)) = fixed_node(line, &columns) {
            chunk.ids.push(shifted(id, offset));
            chunk.positions.push(position);
            continue;
        }
        let card = cards.card(line, at);
        chunk.had_tabs |= card.had_tabs();
        if card.is_blank() {
            continue;
        }
        match node(&card) {
            Ok((id, position)) => {
                chunk.ids.push(shifted(id, offset));
                chunk.positions.push(position);
            }
            Err(error) => {
                let misread = card.misread(is_node);
                let kind = Misread::kind(misread, &error);
                let describe = || card.diagnose_misread(&error, misread, &node_name(&card));
                chunk.diagnostics.push_with(kind, describe);
            }
        }
    }
    Ok(chunk)
}

/// An id moved by the offset of an include; 0 stays 0 because it means "none".
pub(crate) fn shifted(id: u64, offset: i64) -> u64 {
    if id == 0 {
        0
    } else {
        id.saturating_add_signed(offset)
    }
}

/// True if a card is a node.
pub(crate) fn is_node(card: &Card<'_>) -> bool {
    node(card).is_ok()
}

fn node_name(card: &Card<'_>) -> String {
    match card.id(NODE, 0) {
        Ok(id) if id != 0 => format!("node {id}"),
        _ => "the node".to_owned(),
    }
}

/// A node from its card. Exactly what [`fixed_node`] does, for every form of card.
fn node(card: &Card<'_>) -> Result<(u64, Point3), FieldError> {
    let id = card.required_id(NODE, 0)?;
    let x = card.length_or_zero(NODE, 1)?;
    let y = card.length_or_zero(NODE, 2)?;
    let z = card.length_or_zero(NODE, 3)?;
    Ok((id, Point3::new(x, y, z)))
}

/// A node from a line of plain fixed columns; `None` leaves the line to the general way.
#[inline]
fn fixed_node(line: &[u8], columns: &[usize; 5]) -> Option<(u64, Point3)> {
    if line.len() < columns[3] || memchr::memchr2(b',', b'\t', line).is_some() {
        return None;
    }
    let end = columns[4].min(line.len());
    let id = parse_digits(&line[..columns[1]])?;
    let real = |from: usize, to: usize| {
        let text = line[from..to].trim_ascii();
        parse_real(text).filter(|value| value.abs() <= MAX_LENGTH)
    };
    let x = real(columns[1], columns[2])?;
    let y = real(columns[2], columns[3])?;
    let z = real(columns[3], end)?;
    (id != 0).then(|| (id, Point3::new(x, y, z)))
}

/// The last card in a range that defines the node `id`, and its offset.
pub(crate) fn find_node(
    block: &Block<'_>,
    range: Range<usize>,
    id: u64,
    offset: i64,
) -> Option<usize> {
    let same = |card: &Card<'_>| card.id(NODE, 0).is_ok_and(|i| shifted(i, offset) == id);
    let cards = block.cards_in(range).filter(same);
    cards.last().map(|card| card.offset())
}

/// A row of `*NODE_THICKNESS`: nodes `first`, `first + step` … `last` have this thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NodeThickness {
    pub first: u64,
    pub last: u64,
    pub step: u64,
    pub thickness: f64,
    /// The first id is that of a node set.
    pub is_set: bool,
}

/// Reads `*NODE_THICKNESS`, `_SET` and `_GENERATE`.
pub(crate) fn read_node_thickness(
    block: &Block<'_>,
    offset: i64,
    set_offset: i64,
    found: &mut Diagnostics,
) -> Vec<NodeThickness> {
    let is_set = block.has_option("SET");
    let is_range = block.has_option("GENERATE");
    let row = |card: &Card<'_>| -> Result<NodeThickness, FieldError> {
        let by = if is_set { set_offset } else { offset };
        let first = shifted(card.required_id(EIGHT_BY_10, 0)?, by);
        let last = shifted(card.id(EIGHT_BY_10, 2)?, by);
        Ok(NodeThickness {
            first,
            last: if is_range && last > first {
                last
            } else {
                first
            },
            step: card.id(EIGHT_BY_10, 3)?.max(1),
            thickness: not_negative(card, EIGHT_BY_10, 1)?.unwrap_or(0.0),
            is_set,
        })
    };
    let mut rows = Vec::new();
    for card in block.cards().filter(|card| !card.is_blank()) {
        match row(&card) {
            Ok(row) => rows.push(row),
            Err(error) => {
                found.push_with(error.kind, || card.diagnose(&error, "the node thickness"));
            }
        }
    }
    rows
}

/// A card of `*NODE_TRANSFORM`: the transformation and the node set it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NodeTransform {
    pub transformation: u64,
    pub node_set: u64,
    /// IMMED: carried out as soon as it is read, on the nodes read so far.
    pub at_once: bool,
}

/// Reads `*NODE_TRANSFORM`. Ids are those of the file, without offsets.
pub(crate) fn read_node_transforms(
    block: &Block<'_>,
    found: &mut Diagnostics,
) -> Vec<(NodeTransform, usize)> {
    let mut rows = Vec::new();
    for card in block.cards().filter(|card| !card.is_blank()) {
        let row = card.required_id(EIGHT_BY_10, 0).and_then(|transformation| {
            let node_set = card.required_id(EIGHT_BY_10, 1)?;
            Ok(NodeTransform {
                transformation,
                node_set,
                at_once: card.int_or_zero(EIGHT_BY_10, 2)? != 0,
            })
        });
        match row {
            Ok(row) => rows.push((row, card.offset())),
            Err(error) => {
                found.push_with(error.kind, || {
                    card.diagnose(&error, "the node transformation")
                });
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::card::Layout;
    use super::super::source_file::SourceFile;
    use super::*;
    use proptest::prelude::*;

    fn check_line(line: &str) {
        let file = SourceFile::new("t.k", line);
        for layout in [Layout::Standard, Layout::I10, Layout::Long] {
            let card = Card::new(line.as_bytes(), 0, layout, &file, None);
            if let Some(fast) = fixed_node(line.as_bytes(), &columns::<5>(NODE, layout)) {
                let (id, position) = node(&card).expect("the general way reads it too");
                assert_eq!(fast.0, id, "{line:?}");
                for axis in 0..3 {
                    assert_eq!(fast.1[axis].to_bits(), position[axis].to_bits(), "{line:?}");
                }
            }
        }
    }

    proptest! {
        #[test]
        fn the_fast_way_reads_what_the_general_way_reads(
            line in "[ 0-9]{0,10}[-+ 0-9.eEdD&x,\t]{0,90}",
        ) {
            check_line(&line);
        }

        #[test]
        fn well_formed_lines_are_read_the_fast_way(
            id in 1u64..99_999_999,
            at in proptest::array::uniform3(-1e6f64..1e6),
        ) {
            let [x, y, z] = at;
            let line = format!("{id:8}{x:16.6}{y:16.8e}{z:>16}", z = format!("{z:.3}"));
            let (got, position) = fixed_node(line.as_bytes(), &columns(NODE, Layout::Standard)).unwrap();
            prop_assert_eq!(got, id);
            prop_assert!((position.z - z).abs() < 1e-3);
            check_line(&line);
        }
    }
}
