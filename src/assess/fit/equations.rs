//! The unknowns of the fit that splits gaps into a motion, an offset and bends.

use nalgebra::SVector;

use super::bends::N_BENDS;

/// Unknowns of the fit: a rigid motion, an offset, and the bends.
pub(in crate::assess) const N_SMOOTH: usize = 7 + N_BENDS;

/// One row of the fit.
pub(in crate::assess) type Row = SVector<f64, N_SMOOTH>;
