//! What the program hands over: the record of a file or a run, the matrix in all its forms, cards.

mod card_reader;
pub mod cards;
mod info;
pub mod matrix;
pub mod picture;
mod record;
mod text;

pub use cards::{CardError, CardForm, CardOptions, Cards, Receiver, write as write_cards};
pub use info::{Bounds, DiagnosticInfo, FileInfo, FormingInfo, ModelInfo, PartInfo};
pub use matrix::{MatrixForm, ParsedMatrix, number, parse_matrix};
pub use record::{
    AlternativeRecord, DIRECTION, FileRecord, Files, MatchRecord, OverlapRecord, Parameters,
    RecordContext, StartEntry, TimingsRecord, build_id, fate_words, side_word,
};
pub use text::{grouped, length};
