//! The normal equations of the fit that splits gaps into a motion, an offset and bends.

use nalgebra::{SMatrix, SVector};

use super::bends::N_BENDS;
use crate::assess::contact::solve;

/// Unknowns of the fit: a rigid motion, an offset, and the bends.
pub(in crate::assess) const N_SMOOTH: usize = 7 + N_BENDS;

/// One row of the fit.
pub(in crate::assess) type Row = SVector<f64, N_SMOOTH>;

/// Normal equations of the fit.
pub(super) struct Equations {
    pub(super) matrix: SMatrix<f64, N_SMOOTH, N_SMOOTH>,
    pub(super) right: Row,
}

impl Default for Equations {
    fn default() -> Self {
        Self {
            matrix: SMatrix::zeros(),
            right: Row::zeros(),
        }
    }
}

impl Equations {
    /// Adds the equation of one place.
    pub(super) fn add(&mut self, row: &Row, gap: f64, weight: f64) {
        self.matrix.ger(weight, row, row, 1.0);
        self.right += row * (weight * gap);
    }

    /// Keeps an unknown at nothing.
    pub(super) fn leave_out(&mut self, unknown: usize) {
        self.matrix.row_mut(unknown).fill(0.0);
        self.matrix.column_mut(unknown).fill(0.0);
        self.right[unknown] = 0.0;
    }
}

/// Share of the offset's column that lies outside the span of all others.
pub(super) fn own_share(matrix: &SMatrix<f64, N_SMOOTH, N_SMOOTH>) -> f64 {
    let whole = matrix[(6, 6)];
    if whole <= 0.0 {
        return 0.0;
    }
    let mut others = *matrix;
    let mut mixed: SVector<f64, N_SMOOTH> = matrix.column(6).into();
    others.row_mut(6).fill(0.0);
    others.column_mut(6).fill(0.0);
    mixed[6] = 0.0;
    (whole - mixed.dot(&solve(&others, &mixed))) / whole
}
