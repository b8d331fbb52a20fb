//! The two files and the parts in them: which are loaded, chosen, matched and alike, in which units.

mod changed;
mod choice;
mod command;
mod files;
pub mod filter;
mod likeness;
mod roles;
mod set_units;
mod unit_memory;
mod units;

use std::collections::BTreeSet;
use std::path::PathBuf;

pub use command::{FileCommand, PartCommand};
pub(super) use files::NewPart;
pub use likeness::{LikeWhat, Likeness, MoreAlike, together};
pub use unit_memory::UnitMemory;
pub use units::UnitHint;
pub(super) use units::length_factor_of;

use super::{Document, GestureId, OfParts, Part};
use crate::pipeline::load::LoadSettings;
use crate::role::{PerRole, Role};

/// A part of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartRef {
    /// In which of the two models.
    pub role: Role,
    /// The deck's number.
    pub id: u64,
}

/// What is chosen among the parts, and what is still asked about the files.
#[derive(Debug, Clone, Default)]
pub struct PartsState {
    /// The selected parts of the decks.
    pub selected: BTreeSet<PartRef>,
    /// The part of a deck under the pointer, in the tree or in a window.
    pub hovered: Option<PartRef>,
    /// What the part list is sorted by, if not the order of the files.
    likeness: Option<Likeness>,
    /// The part that should be matched alone, if there is one.
    more_alike: Option<OfParts<MoreAlike>>,
    /// What each part is being made again with, by the part's number.
    pending: PerRole<Option<(u64, LoadSettings)>>,
    /// The part that is matched as soon as it is the only one of its deck.
    match_when_chosen: Option<PartRef>,
    /// The user said with the choice under way that all parts of the crash model are meant.
    are_all_meant_when_chosen: bool,
    guess: Guess,
    /// The parts for which the hint about units was answered.
    unit_hint_dismissed_for: Option<PerRole<u64>>,
    /// The undo step of a change of units that a new factor belongs to.
    unit_gesture: Option<GestureId>,
    /// The undo step of files that are read together.
    together_gesture: Option<GestureId>,
    /// Files whose content on disk is another than the one that was read.
    changed_on_disk: BTreeSet<PathBuf>,
}

/// Roles that were not said but have to be found out from the content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Guess {
    /// Loads of this guess that have not ended.
    n_pending: usize,
}

impl Document {
    /// True if a deck has this part.
    fn knows_part(&self, part: PartRef) -> bool {
        let has = |p: &Part| p.facts.parts.iter().any(|row| row.id == part.id);
        self.part(part.role).is_some_and(has)
    }

    /// True if it is matched and no other of its deck.
    fn is_only_used(&self, part: PartRef) -> bool {
        let used = self.part(part.role).map(|p| &p.facts.used);
        used.is_some_and(|used| used.iter().eq([&part.id]))
    }
}

impl PartsState {
    /// A file could not be read, or was not waited for.
    pub(super) fn load_ended(&mut self) {
        self.guess.n_pending = self.guess.n_pending.saturating_sub(1);
    }

    /// Another choice was made, or given up.
    pub(super) fn choice_ended(&mut self) {
        self.match_when_chosen = None;
        self.are_all_meant_when_chosen = false;
    }

    /// What is selected may be gone after a step back, or with its file.
    pub(super) fn forget_missing(&mut self, document: &Document) {
        self.selected.retain(|part| document.knows_part(*part));
    }
}
