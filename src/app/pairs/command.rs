//! What can happen to picked pairs of points.

use super::PickedPoint;
use crate::role::Role;

/// Pairs of points that were picked on both parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairCommand {
    /// Begin to pick, or end.
    ToggleTool,
    /// A point was clicked.
    Pick {
        /// On which part.
        role: Role,
        /// What and where.
        point: PickedPoint,
    },
    /// The next click picks this point of this pair again.
    Repick {
        /// Its number, counted from 0.
        pair: usize,
        /// On which part.
        role: Role,
    },
    /// Forget a pair.
    Delete(usize),
    /// Deletes all pairs.
    DeleteAll,
    /// Lay the stamped points on the crash points.
    Fit,
}
