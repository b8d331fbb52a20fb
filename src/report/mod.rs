//! What the program writes: the record of a file or a match, the matrix in all its forms, cards, HTML reports.

mod card_reader;
pub mod cards;
pub mod command_line;
pub mod csv;
pub mod distances;
pub mod html;
mod info;
pub mod matrix;
pub mod picture;
mod pose;
mod record;
mod starts;

pub use cards::{
    CardError, CardForm, CardOptions, Cards, IdOffsets, Receiver, write as write_cards,
};
pub use info::{Bounds, DiagnosticInfo, FileInfo, FormingInfo, ModelInfo, PartInfo};
pub use matrix::{MatrixForm, ParsedMatrix, number, parse_matrix};
pub use pose::{AxisAngle, PoseRecord, SampleNode};
pub use record::{
    AlternativeRecord, DIRECTION, FileRecord, IncludedFile, Machine, MatchRecord, Metrics, OneWay,
    OverlapRecord, Parameters, RecordContext, TimingsRecord, UnitsRecord, build_id, role_of,
};
pub use starts::{
    few_agree_words, outcome_words, start_data_words, start_kind_help, start_kind_words,
    start_kinds, start_name,
};
