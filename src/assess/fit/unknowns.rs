//! The unknowns of the fit, in their order: a rigid motion, an offset of the sheets, and the bends.

use nalgebra::SVector;

use super::bends::N_BENDS;
use crate::assess::small_motion::{Six, Unknown};

/// Unknowns of the fit: a rigid motion, an offset, and the bends.
pub(in crate::assess) const N_SMOOTH: usize = Unknown::OFFSET + 1 + N_BENDS;

/// A number for each unknown.
pub(in crate::assess) type Row = SVector<f64, N_SMOOTH>;

/// Those of the motion, of the offset, and of the bends.
pub(super) fn joined(motion: &Six, offset: f64, bends: &SVector<f64, N_BENDS>) -> Row {
    let mut row = Row::zeros();
    row.fixed_rows_mut::<6>(0).copy_from(motion);
    row[Unknown::OFFSET] = offset;
    row.fixed_rows_mut::<N_BENDS>(Unknown::OFFSET + 1)
        .copy_from(bends);
    row
}

/// Those of the bends.
pub(super) fn bends_of(unknowns: &Row) -> SVector<f64, N_BENDS> {
    unknowns.fixed_rows::<N_BENDS>(Unknown::OFFSET + 1).into()
}
