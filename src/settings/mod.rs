//! The settings of a match and of a mapping by name: one row each.
//!
//! A row of [`SETTINGS`] or [`MAP_SETTINGS`] holds everything that is said about a setting: its names on the
//! command line and in records, label, help, unit, range, and how it is read and changed. The command line, "copy as
//! command line", the form of the window, the JSON record and the report walk these rows, so that a new
//! setting is a row and its use. The words of the choices stand in `choices.rs`.

mod choice;
mod choices;
mod map_table;
mod recipe;
mod setting;
mod table;
mod value;

pub use choice::{Choice, ChoiceWords};
pub use map_table::MAP_SETTINGS;
pub use recipe::MatchRecipe;
pub use setting::{Access, Domain, Group, Setting, Unit, changed_setting};
pub use table::{SETTINGS, setting};
pub use value::{Value, exact};

#[cfg(test)]
mod tests;
