//! Everything that can happen in the window, as data.

use std::path::PathBuf;

use super::{Axis, FreeWindow, NoticeLevel};
use super::{
    AxisFrame, BottomTab, CopyForm, Dialog, Display, Document, GestureId, InspectCommand, LikeWhat,
    ModalInput, MotionKind, MoveFrame, NoticeId, PartRef, PickedPoint, PictureChoice, Preview,
    Section, SectionView, Settings, ShownGeometry,
};
use crate::geometry::camera::{OrbitStyle, StandardView};
use crate::geometry::{Camera, Point3, Similarity};
use crate::jobs::{JobEvent, Live, Located, PartSource, ProjectRequest};
use crate::pipeline::autosave::RecoveredSession;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::outputs::Output;
use crate::pipeline::sweep::SweepSettings;
use crate::role::{PerRole, Role};
use crate::units::Units;

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
    /// Pairs of points.
    Pair(PairCommand),
    /// What leaves the program.
    Export(ExportCommand),
    /// What is shown and how.
    View(ViewCommand),
    /// Distances, labels, section.
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
    /// Ends the present tool, preview or run, whichever is on top.
    Escape,
    /// Leave the program.
    Quit,
}

/// Files and parts come and go.
#[derive(Debug, Clone, PartialEq)]
pub enum FileCommand {
    /// Ask for a file with a dialog.
    AskOpen(Role),
    /// Open files, dropped or chosen. Without a role it is guessed from the content.
    Open {
        /// One or two files.
        paths: Vec<PathBuf>,
        /// The part they are meant to be.
        role: Option<Role>,
    },
    /// Open the example pair.
    OpenExample,
    /// Read a part again.
    Reload(Role),
    /// Read all loaded parts again.
    ReloadAll,
    /// Forget a part.
    Close(Role),
    /// Exchange the two parts without reading anything.
    Swap,
    /// Multiply the lengths of a file, from the model in memory.
    SetLengthFactor {
        /// Which.
        role: Role,
        /// Factor on the coordinates of the file.
        factor: f64,
    },
    /// Say which units a file is in, or with `None` leave that to the file and its sizes.
    SetUnits {
        /// Which.
        role: Role,
        /// Its units.
        units: Option<Units>,
    },
    /// The sizes really are different.
    DismissUnitHint,
    /// Remove an entry from the recent files.
    ForgetRecent(PathBuf),
}

/// Projects: files that hold the work.
#[derive(Debug, Clone)]
pub enum ProjectCommand {
    /// Ask for a project with a dialog.
    AskOpen,
    /// Open a project.
    Open(ProjectRequest),
    /// Open an autosaved session.
    Restore(PathBuf),
    /// Ask where a file of the project is that was not found.
    AskLocate(Role),
    /// A file of the project is there, or is done without.
    Locate(Role, Located),
    /// Do not open the project whose files are missing.
    GiveUp,
    /// Write the project to its file, or ask where to.
    Save,
    /// Ask where to write the project.
    SaveAs,
    /// Write the project there.
    Write(PathBuf),
    /// The shell wrote this state of the work.
    Written(PathBuf, Box<Document>),
    /// The shell could not write, or the user closed the dialog.
    NotWritten,
    /// Save the session in case of a crash, if there is something new.
    Autosave,
    /// The shell found sessions of the last runs.
    NotifyRecovered(Vec<RecoveredSession>),
    /// Leave lost sessions where they are; the menu still offers them.
    DismissRecovery,
    /// Save, and leave the program when that is done.
    SaveAndQuit,
    /// Leave the program without saving.
    QuitUnsaved,
}

/// The parts of a deck.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PartCommand {
    /// Select this part and no other, or none.
    Select(Option<PartRef>),
    /// Add a part to the selection, or take it out.
    ToggleSelected(PartRef),
    /// The pointer is over it.
    Hover(Option<PartRef>),
    /// Show or hide.
    SetVisible(PartRef, bool),
    /// Hide all others of this model.
    ShowOnly(PartRef),
    /// Hide the selected parts.
    HideSelected,
    /// Hide all others of the models that something is selected of.
    ShowOnlySelected,
    /// Show everything.
    ShowAll,
    /// Match this part of the deck, or leave it out.
    SetUsed(PartRef, bool),
    /// Match this part of the deck and no other.
    UseOnly(PartRef),
    /// Match all parts of a deck.
    UseAll(Role),
    /// Sort the other deck's parts by likeness, or all as in the files.
    OrderLike(Option<LikeWhat>),
    /// Give a colour, or take it back.
    SetColor(PartRef, Option<[u8; 3]>),
}

/// Reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReduceCommand {
    /// Reduce to at most so many triangles.
    To {
        /// Which parts.
        roles: PerRole<bool>,
        /// The ceiling.
        max_triangles: usize,
    },
    /// Go back to the full mesh.
    Full(PerRole<bool>),
    /// Next coarser (+1) or finer (−1) marked level, on all loaded parts that are ticked.
    Step(i32),
}

/// Moves of the stamped part by hand. The crash part has no pose.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveCommand {
    /// While dragging: the motion since the grab, in the space of the crash model.
    Drag {
        /// The drag.
        gesture: GestureId,
        /// Motion since the grab.
        delta: Similarity,
        /// Name of the undo step.
        name: String,
    },
    /// The drag ended.
    EndDrag,
    /// The drag is taken back.
    AbandonDrag(GestureId),
    /// A typed distance along an axis of a frame.
    Translate {
        /// Which axis.
        axis: Axis,
        /// Of which frame.
        frame: AxisFrame,
        /// In lengths of the crash model.
        distance: f64,
    },
    /// A typed angle about an axis of a frame through the part's centre.
    Rotate {
        /// Which axis.
        axis: Axis,
        /// Of which frame.
        frame: AxisFrame,
        /// In degrees.
        degrees: f64,
    },
    /// A whole new pose, for example from a field.
    SetPose {
        /// The pose.
        crash_from_stamped: Similarity,
        /// Name of the undo step.
        name: String,
    },
    /// A pose as text, in any common layout.
    Paste(String),
    /// Rotate by 180° about one of the part's own axes through its centre.
    Flip(Axis),
    /// Make the centres of the two boxes coincide.
    AlignCenters,
    /// Back to the pose as loaded.
    Reset,
    /// Begin to move or rotate by keys.
    Begin {
        /// Move or rotate.
        kind: MotionKind,
        /// Pivot and axes now.
        frame: MoveFrame,
    },
    /// An input to the move by keys.
    Input(ModalInput),
}

/// Alignment, match, sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum MatchCommand {
    /// New settings, as a whole; one undo step for a series of changes.
    SetRecipe(Box<MatchRecipe>),
    /// "Align surface normals": make the first poses.
    Align,
    /// Show a first pose without taking it; `None` shows the real pose again.
    ShowStart(Option<usize>),
    /// Show the next (+1) or previous (−1) first pose.
    StepStart(i32),
    /// Put the stamped part where a start of the last match ended.
    UseMatchStart(usize),
    /// Take the shown first pose over.
    UseStart(usize),
    /// Run the match.
    Run,
    /// Run the match from the present pose, whatever the recipe begins with.
    Refine,
    /// End the run with the best pose so far.
    Stop,
    /// End the run with the old pose.
    Cancel,
    /// Take over one of the alternatives, or with `None` the best pose again.
    ShowAlternative(Option<usize>),
    /// To the next alternative and round to the best.
    NextAlternative,
    /// Measure distances and overlap at the present pose.
    Measure,
    /// Run the paper's tables.
    Sweep(Box<SweepSettings>),
}

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
    /// Forget all.
    DeleteAll,
    /// Lay the stamped points on the crash points.
    Fit,
}

/// What leaves the program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExportCommand {
    /// The matrix, or cards, on the clipboard.
    Copy(CopyForm),
    /// Ask where to write something.
    AskSave(Output),
    /// Write something.
    Write {
        /// What.
        kind: Output,
        /// Where.
        path: PathBuf,
    },
    /// The line that does the match without the window.
    CopyCommandLine,
    /// The log as text.
    CopyLog,
    /// A text that a panel shows.
    CopyText {
        /// The text.
        text: String,
        /// What it is, for the toast.
        what: String,
    },
    /// A picture as the last one was taken, at once where a folder is known; perhaps without background.
    TakePicture {
        /// Without background, whatever the last one had.
        is_transparent: bool,
    },
    /// Ask where to put a picture that is taken so.
    AskPicture(PictureChoice),
    /// A picture into a file.
    WritePicture {
        /// How.
        choice: PictureChoice,
        /// Where.
        path: PathBuf,
    },
}

/// What is shown and how.
#[derive(Debug, Clone, PartialEq)]
pub enum ViewCommand {
    /// A new camera after a drag or a turn of the wheel.
    SetCamera(Role, Camera),
    /// A view with a key of its own.
    Standard(Role, StandardView),
    /// The camera before the last jump.
    PreviousCamera(Role),
    /// Orthographic or perspective.
    ToggleProjection(Role),
    /// Fit what is visible.
    FitAll(Role),
    /// Fit the selected part, or all.
    Focus(Role),
    /// Link the two cameras or not.
    ToggleLink,
    /// Turntable or free.
    SetOrbitStyle(OrbitStyle),
    /// Pick or forget the pivot of a window.
    SetPivot(Role, Option<Point3>),
    /// Width over height of a window; the shell tells when it changes.
    SetAspect(Role, f64),
    /// The window that keys act on.
    SetFocus(Role),
    /// Move over or back.
    ToggleMoveOver,
    /// Reduced or detailed.
    SetShown(ShownGeometry),
    /// The blink key went down or up.
    SetBlinking(bool),
    /// Plain choices about the picture, as a whole.
    SetDisplay(Box<Display>),
    /// The section plane, as a whole.
    SetSection(SectionView),
    /// A tab of the bottom pane.
    SetTab(BottomTab),
    /// What the right window shows while its part is in the left one.
    SetFreeWindow(FreeWindow),
    /// Fold or unfold a section.
    OpenSection(Section, bool),
    /// The user works in a section; it is the last to be folded for want of room.
    UseSection(Section),
    /// Only the 3D windows, or everything.
    ToggleGraphicsOnly,
    /// Open something over the window, or close it.
    SetDialog(Option<Dialog>),
    /// Show the gizmo or not.
    ToggleGizmo,
    /// Whose axes gizmo and keys use.
    SetMoveAxes(AxisFrame),
    /// Show the stamped part where its file has it, or at its pose again.
    ShowAsLoaded(bool),
    /// Show the pose of a start or an iteration while the pointer is on it; `None` when it left.
    HoverPreview(Option<Preview>),
    /// Show the pose of a start or an iteration until it is let go; `None` shows the real pose again.
    PinPreview(Option<Preview>),
    /// Let the curve of a start stand out; `None` for that of the winner.
    ChooseStart(Option<usize>),
}

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

/// Toasts and bell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoticeCommand {
    /// Close a toast.
    Dismiss(NoticeId),
    /// The bell's list was opened.
    MarkRead,
    /// The shell has something to say, for example that a file could not be written.
    Tell(NoticeLevel, String),
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
    ProjectCommand => Project,
    PartCommand => Part,
    ReduceCommand => Reduce,
    MoveCommand => Move,
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

impl FileCommand {
    /// Opens a recent or given source as a part.
    pub fn open(source: PartSource, role: Role) -> Self {
        match source {
            PartSource::File(path) => Self::Open {
                paths: vec![path],
                role: Some(role),
            },
            PartSource::Example => Self::OpenExample,
        }
    }
}
