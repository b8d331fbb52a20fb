//! What a row of the log is about.

/// The step of the work that a row of the log is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogStep {
    /// Surface normals are aligned.
    Align,
    /// The deviation is measured.
    Compare,
    /// A file is written.
    Export,
    /// A file is read.
    Load,
    /// Forming results are mapped.
    Map,
    /// A match runs, or one of its poses is taken.
    Match,
    /// Distances are measured.
    Measure,
    /// The stamped part is moved by hand.
    Move,
    /// Pairs of points move the stamped part.
    Pairs,
    /// A project is opened or saved.
    Project,
    /// A step is done again.
    Redo,
    /// A mesh is reduced.
    Reduce,
    /// The outcome of a match.
    Result,
    /// Parts of a file are chosen.
    Select,
    /// A match settles on borders, holes and bends.
    Settle,
    /// The paper's tables are measured.
    Sweep,
    /// A step is taken back.
    Undo,
    /// A unit is set.
    Units,
    /// A match is judged anew.
    Verdict,
    /// The pose is verified.
    Verify,
    /// The window has something to say.
    Window,
}

impl LogStep {
    /// The step in one word.
    pub fn label(self) -> &'static str {
        match self {
            Self::Align => "align",
            Self::Compare => "compare",
            Self::Export => "export",
            Self::Load => "load",
            Self::Map => "map",
            Self::Match => "match",
            Self::Measure => "measure",
            Self::Move => "move",
            Self::Pairs => "pairs",
            Self::Project => "project",
            Self::Redo => "redo",
            Self::Reduce => "reduce",
            Self::Result => "result",
            Self::Select => "select",
            Self::Settle => "settle",
            Self::Sweep => "sweep",
            Self::Undo => "undo",
            Self::Units => "units",
            Self::Verdict => "verdict",
            Self::Verify => "verify",
            Self::Window => "window",
        }
    }
}
