//! What a match hands over: the matrix in all its forms, LS-DYNA cards, the record of a run.

pub mod matrix;

pub use matrix::{MatrixForm, ParsedMatrix, parse_matrix};
