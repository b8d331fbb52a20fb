//! Poses that are shown instead of the real one, without moving anything.

use crate::app::{AppState, PreviewCommand};
use crate::geometry::Similarity;

/// A start or an iteration whose pose is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preview {
    /// Where a start of the last match ended.
    Start(usize),
    /// Where a start was at one of its iterations.
    Step {
        /// Number of the start in the starts table.
        start: usize,
        /// The iteration, counted from 0.
        iteration: usize,
    },
}

impl Preview {
    /// The start it belongs to.
    pub fn start(self) -> usize {
        match self {
            Self::Start(start) | Self::Step { start, .. } => start,
        }
    }
}

/// What is looked at instead of the real pose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Previews {
    /// The best pose of the running match.
    pub live: Option<Similarity>,
    /// The first pose of the last alignment that is shown.
    pub start: Option<usize>,
    /// The pose of a start or an iteration that is shown while the pointer is on it.
    pub hovered: Option<Preview>,
    /// The pose of a start or an iteration that is shown until it is let go.
    pub pinned: Option<Preview>,
    /// The start whose curve was chosen; by default that of the winner.
    pub chosen_start: Option<usize>,
    /// The stamped part is shown where its file has it, until it is moved.
    pub is_as_loaded: bool,
}

impl Previews {
    /// Shows the real pose again.
    pub(in crate::app) fn drop_all(&mut self) {
        self.hovered = None;
        self.pinned = None;
        self.is_as_loaded = false;
        self.start = None;
    }

    /// What is shown of the last match: under the pointer, else pinned.
    pub fn of_match(&self) -> Option<Preview> {
        self.hovered.or(self.pinned)
    }

    /// While a job holds the inputs, no pose of the last match is shown.
    pub(in crate::app) fn apply(&mut self, command: PreviewCommand, is_unlocked: bool) {
        match command {
            PreviewCommand::AsLoaded(is_as_loaded) => {
                self.drop_all();
                self.is_as_loaded = is_as_loaded;
            }
            PreviewCommand::Hover(preview) => self.hovered = preview.filter(|_| is_unlocked),
            PreviewCommand::Pin(preview) => self.pinned = preview.filter(|_| is_unlocked),
            PreviewCommand::ChooseStart(start) => self.chosen_start = start,
        }
    }
}

impl AppState {
    /// What is shown instead of the real pose; `None` while that is shown.
    pub fn shown_instead(&self) -> Option<String> {
        if self.previews.live.is_some() {
            return Some("the running match".to_owned());
        }
        if self.is_as_loaded() {
            return Some("the part as loaded".to_owned());
        }
        if self.shown_start().is_some() {
            return Some(format!("start {}", self.previews.start? + 1));
        }
        self.previewed_pose()?;
        Some(match self.preview()? {
            Preview::Start(start) => format!("the end of start {}", start + 1),
            Preview::Step { start, iteration } => {
                format!("start {}, iteration {}", start + 1, iteration + 1)
            }
        })
    }
}
