//! What can happen to the history.

/// Undo and redo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HistoryCommand {
    /// One step back.
    Undo,
    /// One step forward.
    Redo,
    /// To the state with so many steps in force.
    JumpTo(usize),
    /// Pose, level, visibility and result as they were after loading; itself one step.
    ResetAll,
}
