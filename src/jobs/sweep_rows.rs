//! The rows of a benchmark as they come.

use std::sync::{Arc, Mutex, PoisonError};

use crate::pipeline::sweep::SweepRow;

/// Rows of a running sweep: the worker puts them down, the window takes them up.
#[derive(Debug, Clone, Default)]
pub struct SweepRows(Arc<Mutex<Vec<SweepRow>>>);

impl SweepRows {
    /// Puts a row down.
    pub fn push(&self, row: SweepRow) {
        self.lock().push(row);
    }

    /// The rows since the last call, in their order.
    pub fn take(&self) -> Vec<SweepRow> {
        std::mem::take(&mut *self.lock())
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<SweepRow>> {
        // Every write leaves a whole list, so a poisoned lock still guards a usable one.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
