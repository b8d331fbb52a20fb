//! Nodes and elements.

use super::super::diagnostic::Diagnostics;
use super::block::Block;
use super::card::{Card, FieldError, TEN_BY_8};
use crate::geometry::Point3;

/// Standard widths of a `*NODE` card.
pub const NODE: &[u8] = &[8, 16, 16, 16, 8, 8];

/// A shell as its card has it, with ids in place of indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawShell {
    /// Element id.
    pub id: u64,
    /// Part id.
    pub part: u64,
    /// Node ids of the corners.
    pub nodes: [u64; 4],
}

/// Reads the cards of `*NODE`.
pub fn read_nodes(block: &Block<'_>, into: &mut Vec<(u64, Point3)>, found: &mut Diagnostics) {
    for card in block.cards().filter(|card| !card.is_blank()) {
        match node(&card) {
            Ok(node) => into.push(node),
            Err(error) => found.push_with(error.kind, || card.diagnose(&error, "the node")),
        }
    }
}

fn node(card: &Card<'_>) -> Result<(u64, Point3), FieldError> {
    let id = card.id(NODE, 0)?;
    let x = card.real_or_zero(NODE, 1)?;
    let y = card.real_or_zero(NODE, 2)?;
    let z = card.real_or_zero(NODE, 3)?;
    Ok((id, Point3::new(x, y, z)))
}

/// Reads the cards of `*ELEMENT_SHELL`.
pub fn read_shells(block: &Block<'_>, into: &mut Vec<RawShell>, found: &mut Diagnostics) {
    for card in block.cards().filter(|card| !card.is_blank()) {
        match shell(&card) {
            Ok(shell) => into.push(shell),
            Err(error) => found.push_with(error.kind, || card.diagnose(&error, "the shell")),
        }
    }
}

fn shell(card: &Card<'_>) -> Result<RawShell, FieldError> {
    let mut nodes = [0; 4];
    for (i, node) in nodes.iter_mut().enumerate() {
        *node = card.id(TEN_BY_8, 2 + i)?;
    }
    if nodes[3] == 0 {
        nodes[3] = nodes[2];
    }
    Ok(RawShell {
        id: card.id(TEN_BY_8, 0)?,
        part: card.id(TEN_BY_8, 1)?,
        nodes,
    })
}
