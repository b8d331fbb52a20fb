//! The window without the window: what it knows, what can be asked of it, and what follows.
//!
//! Panels read [`AppState`] and queue [`Command`]s; the shell hands each to [`AppState::apply`] and
//! carries out the [`Effect`]s that come back. Nothing here draws, waits or touches the disk, so
//! every behaviour of the window has a test without one.

mod action;
mod apply;
mod command;
mod command_line;
mod document;
mod effect;
mod explain;
mod export;
mod facts;
mod free_window;
mod fuzzy;
pub mod gizmo;
mod history;
mod inspect;
mod job_board;
mod level_result;
mod likeness;
mod log;
mod match_starts;
mod modal_move;
mod motion;
mod notice;
mod pairs;
mod palette;
pub mod part_filter;
mod picture;
mod project;
mod sections;
mod settings;
mod shared;
mod state;
mod status;
mod unit_memory;
mod units;
mod view;

pub use action::{Action, ActionRow, Key, KeyMode, Keys, Menu, MenuGroup, Reason, Shortcut};
pub use command::{
    Command, ExportCommand, FileCommand, HistoryCommand, MatchCommand, MoveCommand, NoticeCommand,
    PairCommand, PartCommand, ProjectCommand, ReduceCommand, ViewCommand,
};
pub use document::{Document, MatchResult, Part, StampedPose};
pub use effect::Effect;
pub use explain::Cause;
pub use export::CopyForm;
pub use free_window::FreeWindow;
pub use history::{GestureId, History, HistoryRow, StepKind};
pub use inspect::{Coloring, Compared, Freshness, InspectCommand, Label, SectionView};
pub use job_board::{JobBoard, RunningJob};
pub use level_result::LevelResult;
pub use likeness::{LikeWhat, Likeness};
pub use log::{Clock, Log, LogRow, age_text, clock_text, duration_text};
pub use match_starts::{LiveStarts, Preview};
pub use modal_move::{Constraint, ModalInput, ModalMove, ModalOutcome, MotionKind, short_number};
pub use motion::{
    Axis, AxisFrame, MoveFrame, rotation_about, translation_along, turns_deg, with_turns_deg,
};
pub use notice::{Notice, NoticeId, NoticeLevel, Notices};
pub use pairs::{PairTool, PairVerdict, PickKind, PickedPoint, PointPair, PointPairs};
pub use palette::PaletteEntry;
pub use picture::{PictureChoice, PicturePlace, PictureSize, PictureWindows};

pub use project::ProjectState;
pub use sections::Sections;
pub use settings::{MouseScheme, Settings, StartupOptions, Theme};
pub use shared::Shared;
pub use state::{AppState, PoseOverlap, Starts};
pub use status::{Section, Stale};
pub use unit_memory::UnitMemory;
pub use units::UnitHint;
pub use view::{BottomTab, ColorBy, Dialog, Display, MoveTool, PartRef, ShownGeometry, ViewState};
