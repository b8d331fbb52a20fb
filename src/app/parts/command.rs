//! What can happen to files and the parts in them.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::{LikeWhat, PartRef};
use crate::jobs::PartSource;
use crate::role::Role;
use crate::units::Units;

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
    /// Load the realistic example pair.
    OpenRealisticExample,
    /// Read a part again.
    Reload(Role),
    /// Read all loaded parts again.
    ReloadAll,
    /// Read those parts again whose files have changed on disk.
    ReloadChanged,
    /// These files have another content now than was read from them; the shell reports when that changes.
    ChangedOnDisk(BTreeSet<PathBuf>),
    /// Forget a part.
    Close(Role),
    /// Exchange the two parts without reading anything.
    Swap,
    /// Multiply the lengths of a file, from the model in memory.
    SetLengthFactor {
        /// Side whose units change.
        role: Role,
        /// Factor on the coordinates of the file.
        factor: f64,
    },
    /// Say which units a file is in, or with `None` leave that to the file and its sizes.
    SetUnits {
        /// Side whose units change.
        role: Role,
        /// The units to use; `None` takes those the file states or implies.
        units: Option<Units>,
    },
    /// The sizes really are different.
    DismissUnitHint,
    /// Remove an entry from the recent files.
    ForgetRecent(PathBuf),
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
    /// The same, and match at once.
    MatchOnly(PartRef),
    /// Match one of the choices among the parts of the crash model that are most like the stamped part, and no other
    /// part; by its place in [`MoreAlike`](super::MoreAlike).
    UseAlike(usize),
    /// Match all parts of a deck.
    UseAll(Role),
    /// Sort the other deck's parts by likeness, or all as in the files.
    OrderLike(Option<LikeWhat>),
    /// Give a colour, or take it back.
    SetColor(PartRef, Option<[u8; 3]>),
}

impl PartCommand {
    /// True if it changes which parts are matched, which no job may hold meanwhile.
    pub fn chooses(&self) -> bool {
        use PartCommand as Is;
        matches!(
            self,
            Is::SetUsed(..) | Is::UseOnly(_) | Is::MatchOnly(_) | Is::UseAlike(_) | Is::UseAll(_)
        )
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
            PartSource::RealisticExample => Self::OpenRealisticExample,
        }
    }
}
