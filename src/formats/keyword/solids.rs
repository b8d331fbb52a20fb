//! `*ELEMENT_SOLID` in both of its layouts, and `*ELEMENT_TSHELL`.

use std::ops::Range;

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::SolidKind;
use super::block::{Block, Cards};
use super::card::{Card, EIGHT_BY_10, FieldError, Misread, TEN_BY_8};
use super::chunks::{Cut, Irregular};
use super::mesh::SolidCards;
use super::nodes::shifted;
use super::shells::{ElementOffsets, PartIds};

/// A solid with ids in place of node indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RawSolid {
    pub id: u64,
    pub part: u32,
    pub nodes: [u64; 8],
    pub kind: SolidKind,
}

/// Solids of one piece of a block.
#[derive(Debug, Default)]
pub(crate) struct SolidChunk {
    pub solids: Vec<RawSolid>,
    pub parts: PartIds,
    pub diagnostics: Diagnostics,
}

impl SolidCards {
    /// Where a block of such solids may be cut; its first card tells the layout.
    pub(crate) fn cut(self, block: &Block<'_>) -> Cut {
        if self.plies {
            Cut::Nowhere
        } else {
            Cut::Every(1 + self.node_cards(block) + self.n_passed_over)
        }
    }

    /// Lines with nodes after the first line.
    fn node_cards(self, block: &Block<'_>) -> usize {
        if self.thick_shell {
            return 0;
        }
        self.n_node_cards.unwrap_or_else(|| {
            let first = block.cards().find(|card| !card.is_blank());
            // The old layout has the nodes on the line of the ids.
            usize::from(first.is_some_and(|card| card.n_fields(8) <= 2))
        })
    }
}

/// Reads the solids in a byte range of a block.
pub(crate) fn read_solids(
    block: &Block<'_>,
    range: Range<usize>,
    cards: SolidCards,
    offsets: &ElementOffsets,
) -> Result<SolidChunk, Irregular> {
    let n_node_cards = cards.node_cards(block);
    let mut chunk = SolidChunk::default();
    let mut lines = block.cards_in(range);
    while let Some(card) = lines.next() {
        if card.is_blank() {
            continue;
        }
        let nodes = match node_ids(&card, &mut lines, n_node_cards) {
            Some(nodes) => nodes,
            None => {
                let kind = DiagnosticKind::MissingCard;
                let diagnostic = Diagnostic::new(kind, "the last solid has no card with nodes");
                chunk.diagnostics.push(diagnostic.at(card.position(0)));
                break;
            }
        };
        let added = nodes.and_then(|ids| add_solid(&mut chunk, &card, &ids, cards, offsets));
        if let Err(error) = added {
            let misread = card.misread(|card| card.required_id(TEN_BY_8, 0).is_ok());
            // Node cards of their own would have to be read anew too.
            let misread = misread.filter(|misread| *misread == Misread::Keyword);
            let kind = Misread::kind(misread, &error);
            let describe = || card.diagnose_misread(&error, misread, &solid_name(&card));
            chunk.diagnostics.push_with(kind, describe);
        }
        for _ in 0..cards.n_passed_over {
            lines.next_line();
        }
        if cards.plies {
            pass_over_plies(&mut lines);
        }
    }
    Ok(chunk)
}

/// The first ten node ids of a solid; `None` if its cards end too early.
fn node_ids(
    first: &Card<'_>,
    lines: &mut Cards<'_>,
    n_node_cards: usize,
) -> Option<Result<[u64; 10], FieldError>> {
    let read = |card: &Card<'_>, skip: usize| {
        let mut ids = [0; 10];
        for (i, id) in ids.iter_mut().enumerate().take(10 - skip) {
            *id = card.id(TEN_BY_8, i + skip)?;
        }
        Ok(ids)
    };
    if n_node_cards == 0 {
        return Some(read(first, 2));
    }
    let ids = read(&lines.next()?, 0);
    for _ in 1..n_node_cards {
        lines.next_line()?;
    }
    Some(ids)
}

fn add_solid(
    chunk: &mut SolidChunk,
    card: &Card<'_>,
    ids: &[u64; 10],
    cards: SolidCards,
    offsets: &ElementOffsets,
) -> Result<(), FieldError> {
    let id = shifted(card.required_id(TEN_BY_8, 0)?, offsets.element);
    let part = shifted(card.id(TEN_BY_8, 1)?, offsets.part);
    let Some(corners) = brick(ids, cards) else {
        chunk
            .diagnostics
            .push_with(DiagnosticKind::DegenerateElement, || {
                let message = format!("solid {id} has fewer than four different nodes");
                let diagnostic = Diagnostic::new(DiagnosticKind::DegenerateElement, message);
                diagnostic.at(card.position(0))
            });
        return Ok(());
    };
    chunk.solids.push(RawSolid {
        id,
        part: chunk.parts.index(part),
        nodes: corners.map(|node| shifted(node, offsets.node)),
        kind: if cards.thick_shell {
            SolidKind::ThickShell
        } else {
            SolidKind::Solid
        },
    });
    Ok(())
}

/// The eight corners, repeated so that the faces of a brick are those of the solid.
fn brick(ids: &[u64; 10], cards: SolidCards) -> Option<[u64; 8]> {
    let &[a, b, c, d, e, f, g, h, ninth, _] = ids;
    let all_same = [e, f, g, h].iter().all(|&n| n == d || n == 0);
    let is_tetrahedron = cards.n_corners == 4 || ninth != 0 && cards.n_node_cards.is_none();
    let nodes = if cards.thick_shell && g == 0 && h == 0 && e != 0 {
        // Six nodes: bottom triangle, top triangle.
        [a, b, c, c, d, e, f, f]
    } else if is_tetrahedron || all_same {
        [a, b, c, c, d, d, d, d]
    } else {
        let or = |node: u64, last: u64| if node == 0 { last } else { node };
        let f = or(f, e);
        let g = or(g, f);
        [a, b, c, d, e, f, g, or(h, g)]
    };
    let mut distinct = nodes;
    distinct.sort_unstable();
    let n_distinct = 1 + distinct
        .windows(2)
        .filter(|pair| pair[0] != pair[1])
        .count();
    (n_distinct >= 4 && distinct[0] != 0).then_some(nodes)
}

/// Passes over cards whose second ten-wide field is written as a real.
fn pass_over_plies(lines: &mut Cards<'_>) {
    loop {
        let before = lines.clone();
        match lines.next() {
            Some(card) if card.field(EIGHT_BY_10, 1).text.contains(&b'.') => {}
            _ => {
                *lines = before;
                return;
            }
        }
    }
}

fn solid_name(card: &Card<'_>) -> String {
    match card.id(TEN_BY_8, 0) {
        Ok(id) if id != 0 => format!("solid {id}"),
        _ => "the solid".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degenerate_bricks_keep_the_faces_of_what_they_are() {
        let cards = SolidCards {
            n_corners: 8,
            ..SolidCards::default()
        };
        let tetrahedron = Some([1, 2, 3, 3, 4, 4, 4, 4]);
        assert_eq!(brick(&[1, 2, 3, 4, 4, 4, 4, 4, 0, 0], cards), tetrahedron);
        assert_eq!(brick(&[1, 2, 3, 4, 0, 0, 0, 0, 0, 0], cards), tetrahedron);
        assert_eq!(brick(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10], cards), tetrahedron);
        let wedge = [1, 2, 3, 4, 5, 5, 6, 6];
        assert_eq!(brick(&[1, 2, 3, 4, 5, 5, 6, 6, 0, 0], cards), Some(wedge));
        let pyramid = [1, 2, 3, 4, 5, 5, 5, 5];
        assert_eq!(brick(&[1, 2, 3, 4, 5, 5, 5, 5, 0, 0], cards), Some(pyramid));
        assert_eq!(brick(&[1, 2, 3, 3, 3, 3, 3, 3, 0, 0], cards), None);
        let thick = SolidCards {
            thick_shell: true,
            ..cards
        };
        let six = Some([1, 2, 3, 3, 4, 5, 6, 6]);
        assert_eq!(brick(&[1, 2, 3, 4, 5, 6, 0, 0, 0, 0], thick), six);
    }
}
