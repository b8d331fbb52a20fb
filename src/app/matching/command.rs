//! What can happen to alignment, match and sweep, and to the poses they show.

use super::Preview;
use crate::pipeline::match_parts::MatchRecipe;
use crate::pipeline::sweep::SweepSettings;

/// Alignment, match, sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum MatchCommand {
    /// New settings, as a whole; one undo step for a series of changes.
    SetRecipe(Box<MatchRecipe>),
    /// The settings that a remedy asks for, for the present parts alone.
    SetRemedy {
        /// Name of the undo step.
        name: String,
        /// All settings.
        recipe: Box<MatchRecipe>,
        /// The match that follows belongs to the same undo step.
        is_matched: bool,
    },
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

/// Poses that are shown without moving anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PreviewCommand {
    /// Show the stamped part where its file has it, or at its pose again.
    AsLoaded(bool),
    /// Show the pose of a start or an iteration while the pointer is on it; `None` when it left.
    Hover(Option<Preview>),
    /// Show the pose of a start or an iteration until it is let go; `None` shows the real pose again.
    Pin(Option<Preview>),
    /// Let the curve of a start stand out; `None` for that of the winner.
    ChooseStart(Option<usize>),
}
