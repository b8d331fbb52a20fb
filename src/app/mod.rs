//! What the window knows, what can be asked of it, and what follows; without drawing anything.
//!
//! Panels read [`AppState`] and queue [`Command`]s; the shell hands each to [`AppState::apply`] and
//! carries out the [`Effect`]s that come back. The state is composed by topic: `parts`, `reduce`,
//! `matching`, `mapping`, `moving`, `pairs`, `inspect`, `view`, `export`, `project`, `history` and `log`
//! each have their commands, their own state and what follows from them. A topic is lent its own state
//! and the work (document, history, jobs, preferences, messages), nothing else; what other topics must do
//! after a change, it states as a `FollowUp`. Topics meet in `apply.rs` and `follow_up.rs`, where results arrive
//! (`job_events.rs`, `mapping/results.rs`), and where a project is opened (`project/open.rs`).
//! Nothing here draws, waits or touches the disk, so every behaviour of the window has a test without one.

mod action;
mod apply;
mod command;
mod conditions;
mod document;
mod effect;
mod export;
mod facts;
mod follow_up;
mod fuzzy;
mod history;
mod inspect;
mod job_board;
mod job_events;
mod log;
mod mapping;
mod matching;
mod moving;
mod of_parts;
mod pairs;
mod palette;
mod parts;
mod project;
mod reduce;
mod settings;
mod shared;
mod state;
mod view;
mod work;

pub use action::{Action, ActionRow, Key, KeyMode, Keys, Menu, MenuGroup, Reason, Shortcut};
pub use command::Command;
pub use document::{Document, MatchResult, Part, StampedPose};
pub use effect::Effect;
pub use export::{
    CopyForm, ExportCommand, PictureChoice, PicturePlace, PictureSize, PictureWindows,
};
pub use history::{GestureId, History, HistoryCommand, HistoryRow, StepKind};
pub use inspect::{
    Coloring, DistanceTool, Freshness, InspectCommand, InspectState, Label, LookedAt, SectionView,
};
pub use job_board::{JobBoard, RunningJob};
pub use log::{
    Clock, Log, LogRow, LogState, LogStep, Notice, NoticeCommand, NoticeId, NoticeLevel, Notices,
    Showing, age_text, clock_text, duration_text,
};
pub use mapping::{
    DoubtfulElement, FileShare, Further, FurtherPose, MapCommand, MapDisplay, MapPicture,
    MapResult, Mapping, MappingState, Placing, ProbeReport, Quantity, ShownFile, StampedRow,
    StampedState, UnmappedElement, file_names,
};
pub use matching::{Cause, MatchCommand, MatchState, Preview, PreviewCommand, Previews};
pub use moving::{
    Axis, AxisFrame, Constraint, ModalInput, ModalMove, ModalOutcome, MotionKind, MoveCommand,
    MoveFrame, MoveTool, MovingState, PoseOverlap, gizmo, rotation_about, short_number,
    translation_along, turns_deg, with_turns_deg,
};
pub use of_parts::OfParts;
pub use pairs::{
    PairCommand, PairTool, PairVerdict, PairsState, PickKind, PickedPoint, PointPair, PointPairs,
};
pub use palette::PaletteEntry;
pub use parts::{
    FileCommand, LikeWhat, Likeness, MoreAlike, PartCommand, PartRef, PartsState, UnitHint,
    UnitMemory, filter, together,
};
pub use project::{Kept, ProjectCommand, ProjectState};
pub use reduce::{LevelResult, ReduceCommand, ReduceState};
pub use settings::{MouseScheme, Settings, StartupOptions, Theme};
pub use shared::Shared;
pub use state::AppState;
pub use view::{
    BottomTab, ColorBy, ColumnRoom, Dialog, Display, FreeWindow, OpenQuestion, Section, Sections,
    ShownGeometry, Stale, ViewCommand, ViewRoom, ViewState,
};
