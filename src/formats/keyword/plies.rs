//! Which card behind the first of a composite shell is one of its plies.

use super::card::{Card, EIGHT_BY_10};
use super::shells::is_whole_shell;

/// A ply card has up to eight ten-wide fields of which the second is its thickness. Where that is written as a whole
/// number, or a parameter may be any number, the card is a ply's unless it can be read as a shell's.
pub(crate) fn is_ply(card: &Card<'_>) -> bool {
    if card.n_fields(10) > 8 || card.int(EIGHT_BY_10, 0).is_err() {
        return false;
    }
    let is_real = is_real_text(card.field(EIGHT_BY_10, 1).text);
    let is_certain = is_real && !card.line_text().contains('&');
    is_certain || (is_real || is_ply_of_integers(card)) && !is_whole_shell(card)
}

/// Whether all fields of a card are numbers and the first two stand as those of a ply do. Between commas they may
/// stand anywhere; in columns they end where the fields end, which those of a shell that lacks nodes do not.
fn is_ply_of_integers(card: &Card<'_>) -> bool {
    let is_number = |index: usize| card.real(EIGHT_BY_10, index).is_ok();
    let ends_with_its_field = |index: usize| {
        let field = card.field(EIGHT_BY_10, index);
        field.column + field.text.len() == (index + 1) * card.layout().width(10)
    };
    (0..card.n_fields(10)).all(is_number)
        && !card.is_empty_field(EIGHT_BY_10, 1)
        && (card.is_free() || [0, 1].into_iter().all(ends_with_its_field))
}

fn is_real_text(text: &[u8]) -> bool {
    text.contains(&b'.') || text.iter().any(|b| b"eEdD".contains(b)) || text.first() == Some(&b'&')
}
