//! What a match hands over: the matrix in all its forms, LS-DYNA cards, the record of a run.

mod card_reader;
pub mod cards;
pub mod matrix;

pub use cards::{CardError, CardForm, CardOptions, Cards, Receiver};
pub use matrix::{MatrixForm, ParsedMatrix, parse_matrix};
