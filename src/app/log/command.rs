//! What can happen to toasts and bell.

use super::{NoticeId, NoticeLevel};

/// Toasts and bell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoticeCommand {
    /// Close a toast.
    Dismiss(NoticeId),
    /// The bell's list was opened.
    MarkRead,
    /// Why what was asked for is not possible: a toast that is over once it was read.
    Explain(String),
    /// The shell has something to say, for example that a file could not be written.
    Tell(NoticeLevel, String),
}
