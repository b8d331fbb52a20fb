//! The verdict in one word.

use serde::{Deserialize, Serialize};

/// Whether the pose can be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The pose can be used.
    Good,
    /// Probably right; check the reasons.
    Check,
    /// Do not use it.
    Poor,
}
