//! Where the cards of each element's results stand.

use std::ops::Range;

use super::super::super::diagnostic::Diagnostics;
use super::super::super::model::Forming;
use super::super::block::Block;
use super::super::card::EIGHT_BY_10;
use super::super::nodes::shifted;
use super::{Reader, ResultUnits, Results};

/// The cards of the stresses or strains of one shell, or of one set of shells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultCards {
    /// Stresses, not strains.
    pub is_stress: bool,
    /// Those of a set of shells.
    pub is_of_set: bool,
    /// Id of the shell or the set in the whole deck.
    pub id: u64,
    /// Where they stand in the file, from the first card to the end of the last.
    pub range: Range<usize>,
}

/// Finds the cards of each shell and each set in a block of their results; none in blocks of others. `Err`
/// is where a card stands that is out of step.
pub(crate) fn result_cards(
    block: &Block<'_>,
    units: ResultUnits,
) -> Result<Vec<ResultCards>, usize> {
    let (is_stress, is_of_set) = match Results::of_keyword(&block.name) {
        Some(Results::Stress) => (true, false),
        Some(Results::Strain) => (false, false),
        Some(Results::SetStress) => (true, true),
        Some(Results::SetStrain) => (false, true),
        _ => return Ok(Vec::new()),
    };
    // What cannot be read was told when the deck was read.
    let mut told = Diagnostics::default();
    let mut reader = Reader::new(block, units, &mut told);
    let mut found = Vec::new();
    while let Some(card) = reader.next_card() {
        if card.is_blank() {
            continue;
        }
        let mut values = Forming::default();
        let read = if is_stress {
            reader.stress(&card, 0, &mut values)
        } else {
            reader.strain(&card, 0, &mut values)
        };
        let offset = if is_of_set { units.set } else { units.element };
        match (read, card.required_id(EIGHT_BY_10, 0)) {
            (Ok(()), Ok(id)) => found.push(ResultCards {
                is_stress,
                is_of_set,
                id: shifted(id, offset),
                range: card.offset()..reader.after,
            }),
            _ => return Err(card.offset()),
        }
    }
    Ok(found)
}
