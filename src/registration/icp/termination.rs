//! Why an iteration ended.

use serde::{Deserialize, Serialize};

/// Why an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// The last step moved no corner of the part's box by more than the tolerance.
    Converged,
    /// The iteration cap was reached first.
    MaxIterations,
    /// More iterations would not have helped: the score rose, or was too far behind that of another start.
    NoGain,
    /// The user asked to stop; the pose is the best so far.
    Stopped,
    /// The kept pairs fix no motion (too few of them, or all on one line).
    Degenerate,
    /// No point found a partner.
    NoPairs,
    /// A closed-form fit, which does not iterate.
    ClosedForm,
}
