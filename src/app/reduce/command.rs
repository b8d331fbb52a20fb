//! What can happen to the levels of reduction.

use crate::role::PerRole;

/// Reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReduceCommand {
    /// Reduce to at most so many triangles.
    To {
        /// Sides to reduce.
        roles: PerRole<bool>,
        /// Maximum number of triangles.
        max_triangles: usize,
    },
    /// Go back to the full mesh.
    Full(PerRole<bool>),
    /// Next coarser (+1) or finer (−1) marked level, on all loaded parts that are ticked.
    Step(i32),
}
