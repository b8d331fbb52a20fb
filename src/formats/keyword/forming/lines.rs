//! How the lines of forming results are cut.

use super::super::card::{EIGHT_BY_10, FIVE_BY_16};

/// How the lines of one kind of data are cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lines {
    pub widths: &'static [u8],
    pub per_line: usize,
}

pub(super) const SMALL: Lines = Lines {
    widths: EIGHT_BY_10,
    per_line: 8,
};
pub(super) const SMALL_TENSOR: Lines = Lines {
    widths: EIGHT_BY_10,
    per_line: 6,
};
pub(super) const LARGE: Lines = Lines {
    widths: FIVE_BY_16,
    per_line: 5,
};
