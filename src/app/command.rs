//! Everything that can happen in the window, as data.

use super::{
    ExportCommand, FileCommand, HistoryCommand, InspectCommand, MapCommand, MatchCommand,
    MoveCommand, NoticeCommand, PairCommand, PartCommand, PreviewCommand, ProjectCommand,
    ReduceCommand, Settings, ViewCommand,
};
use crate::jobs::{JobEvent, Live};

/// Everything that can happen to the window, with its data.
#[derive(Debug, Clone)]
pub enum Command {
    /// Files and parts come and go.
    File(FileCommand),
    /// Projects: files that hold the work.
    Project(ProjectCommand),
    /// The parts of a deck.
    Part(PartCommand),
    /// Reduction.
    Reduce(ReduceCommand),
    /// Moves by hand.
    Move(MoveCommand),
    /// Alignment, match, sweep.
    Match(MatchCommand),
    /// Forming results onto the crash part.
    Map(MapCommand),
    /// Poses shown without moving anything.
    Preview(PreviewCommand),
    /// Pairs of points.
    Pair(PairCommand),
    /// What leaves the program.
    Export(ExportCommand),
    /// What is shown and how.
    View(ViewCommand),
    /// Deviation, labels, section, distances.
    Inspect(InspectCommand),
    /// Undo and redo.
    History(HistoryCommand),
    /// Toasts and bell.
    Notice(NoticeCommand),
    /// New preferences, as a whole.
    Settings(Box<Settings>),
    /// The worker said something.
    Job(Box<JobEvent>),
    /// The worker's latest progress and iterations.
    Live(Box<Live>),
    /// Ends the job that holds the inputs, else the one that runs, without a result.
    CancelPresent,
    /// Closes what is open, the topmost first; ends the run when nothing is.
    Escape,
    /// Leave the program.
    Quit,
}

impl Command {
    /// True if it changes what a move by keys stands on, or runs for long: such a move ends before it. What only
    /// points at something or comes from the program itself ends none.
    pub(super) fn ends_move(&self) -> bool {
        match self {
            Self::File(command) => !matches!(command, FileCommand::ChangedOnDisk(_)),
            Self::Project(command) => !matches!(
                command,
                ProjectCommand::Autosave
                    | ProjectCommand::Written(..)
                    | ProjectCommand::NotWritten
                    | ProjectCommand::SaveFailed { .. }
                    | ProjectCommand::NotifyRecovered(_)
            ),
            Self::Part(command) => !matches!(command, PartCommand::Hover(_)),
            Self::Reduce(_) | Self::Match(_) | Self::Map(_) | Self::Pair(_) | Self::History(_) => {
                true
            }
            _ => false,
        }
    }
}

macro_rules! from_group {
    ($($group:ident => $arm:ident),*) => {$(
        impl From<$group> for Command {
            fn from(command: $group) -> Self {
                Self::$arm(command)
            }
        }
    )*};
}

from_group!(
    FileCommand => File,
    PairCommand => Pair,
    PreviewCommand => Preview,
    ProjectCommand => Project,
    PartCommand => Part,
    ReduceCommand => Reduce,
    MoveCommand => Move,
    MapCommand => Map,
    MatchCommand => Match,
    ExportCommand => Export,
    ViewCommand => View,
    InspectCommand => Inspect,
    HistoryCommand => History,
    NoticeCommand => Notice
);

impl From<JobEvent> for Command {
    fn from(event: JobEvent) -> Self {
        Self::Job(Box::new(event))
    }
}
