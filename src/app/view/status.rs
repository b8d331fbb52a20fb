//! The sections of the left column, what in them is out of date, and which bottom tabs have content.

use super::BottomTab;
use crate::app::conditions::PartChange;
use crate::app::{AppState, Command, FileCommand, MoveCommand, Part};
use crate::jobs::JobKey;
use crate::role::Role;

/// The paper's three sections, and the mapping after them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// 1 Load & display.
    Load,
    /// 2 Reduce.
    Reduce,
    /// 3 Match.
    Match,
    /// 4 Map, beyond the paper.
    Map,
}

impl Section {
    /// All, from top to bottom.
    pub const ALL: [Self; 4] = [Self::Load, Self::Reduce, Self::Match, Self::Map];

    /// Its place, from 0.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Title of the section with its number.
    pub fn title(self) -> &'static str {
        match self {
            Self::Load => "Load & display",
            Self::Reduce => "Reduce",
            Self::Match => "Match",
            Self::Map => "Map",
        }
    }

    /// What is done in it.
    pub fn help(self) -> &'static str {
        match self {
            Self::Load => "Section 1: files, units, parts and how they are shown",
            Self::Reduce => "Section 2: fewer triangles",
            Self::Match => "Section 3: first poses, method, result, point pairs",
            Self::Map => "Section 4: forming results onto the crash mesh",
        }
    }

    /// The section whose work a command is, if it is plainly one section's.
    pub(in crate::app) fn of_command(command: &Command) -> Option<Self> {
        match command {
            // Nobody asked for this one.
            Command::File(FileCommand::ChangedOnDisk(_)) => None,
            Command::File(_) => Some(Self::Load),
            Command::Reduce(_) => Some(Self::Reduce),
            // How tools and curves are shown is no work on the match.
            Command::Move(MoveCommand::ToggleGizmo | MoveCommand::SetAxes(_)) => None,
            Command::Match(_) | Command::Move(_) => Some(Self::Match),
            Command::Map(_) => Some(Self::Map),
            _ => None,
        }
    }

    /// Whether the sections stay as they are at a command, whatever it does to what is in them.
    pub(in crate::app) fn is_held_at(command: &Command) -> bool {
        matches!(
            command,
            Command::History(_) | Command::Move(_) | Command::Reduce(_)
        )
    }
}

/// Why what a section shows no longer fits the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stale {
    /// In words, for the tooltip.
    pub reason: &'static str,
}

/// What a section asks the user to decide; its header says so while it is folded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenQuestion {
    /// For the header.
    pub short: &'static str,
    /// The whole, for the tooltip.
    pub text: String,
}

impl AppState {
    /// What is to be decided in a section.
    pub fn open_question(&self, section: Section) -> Option<OpenQuestion> {
        if section != Section::Load {
            return None;
        }
        let of_unit = || {
            let hint = self.unit_hint()?;
            Some(OpenQuestion {
                short: "⚠ unit in doubt",
                text: hint.text(),
            })
        };
        let of_change = || {
            let mut roles = Role::ALL.into_iter();
            let role = roles.find(|role| self.has_changed_on_disk(*role))?;
            Some(OpenQuestion {
                short: "⚠ changed on disk",
                text: format!("The {} file has changed on disk", role.word()),
            })
        };
        of_unit().or_else(of_change)
    }

    /// The mark "out of date — rerun" of a section.
    pub fn stale(&self, section: Section) -> Option<Stale> {
        let reason = match section {
            Section::Load => None,
            Section::Reduce => Role::ALL
                .into_iter()
                .any(|role| self.is_reduction_stale(role))
                .then_some("the part was read anew after it was reduced"),
            Section::Match => self.match_stale_reason(),
            Section::Map => self.map_stale_reason(),
        };
        reason.map(|reason| Stale { reason })
    }

    fn map_stale_reason(&self) -> Option<&'static str> {
        let result = self.document.mapping.result.as_ref()?;
        if result.stamp != self.document.stamp() {
            Some("parts or pose changed after the mapping")
        } else {
            self.document.mapping_changes()
        }
    }

    fn is_reduction_stale(&self, role: Role) -> bool {
        let is_stale = |part: &Part| part.wanted_level.is_some() && part.level.is_none();
        self.document.part(role).is_some_and(is_stale) && !self.jobs.is_active(JobKey::Reduce(role))
    }

    fn match_stale_reason(&self) -> Option<&'static str> {
        let result = self.document.result.as_ref()?;
        match self.document.change_after(result) {
            Some(PartChange::Unit) => Some("the unit was changed after the match"),
            Some(PartChange::Part) => Some("a part was changed after the match"),
            None if result.stamp.pose != self.document.stamp().pose => {
                Some("the stamped part was moved after the match")
            }
            None => None,
        }
    }

    /// True if a tab has something to show, or something to begin; the others stay away.
    pub fn has_content(&self, tab: BottomTab) -> bool {
        match tab {
            BottomTab::Timings => self.log.rows().iter().any(|row| row.took.is_some()),
            BottomTab::Starts | BottomTab::Convergence => {
                self.matching.has_live_starts(&self.document)
                    || self.document.result.is_some()
                    || self.jobs.is_active(JobKey::Match)
            }
            BottomTab::Sweep | BottomTab::Deviation => self.document.both().is_some(),
            BottomTab::Section => {
                self.inspect.section.shown().is_some() && self.document.has_any_part().is_ok()
            }
            BottomTab::Mapping => self.document.current_mapping().is_some(),
            BottomTab::History => {
                self.history.undo_name().is_some() || self.history.redo_name().is_some()
            }
            BottomTab::Diagnostics => self.document.files_with_diagnostics().next().is_some(),
            BottomTab::Log => true,
        }
    }

    /// The length factor that follows the hint: that of the stamped file times the hint's.
    pub fn hinted_length_factor(&self) -> Option<f64> {
        let hint = self.unit_hint()?;
        let part = self.document.part(Role::Stamped)?;
        Some(part.length_factor() * hint.factor)
    }
}
