//! Conditions that several actions share.

use super::Reason;
use crate::app::{AppState, Part};
use crate::role::Role;

/// `Ok` if the condition holds, else the reason.
pub(super) fn require(is_met: bool, otherwise: &'static str) -> Result<(), Reason> {
    if is_met {
        Ok(())
    } else {
        Err(Reason(otherwise))
    }
}

#[expect(
    clippy::unnecessary_wraps,
    reason = "conditions of all rows have one type"
)]
pub(super) fn always(_: &AppState) -> Result<(), Reason> {
    Ok(())
}

/// A part is loaded and no job holds the inputs.
pub(super) fn any_part_unlocked(state: &AppState) -> Result<(), Reason> {
    state.document.has_any_part()?;
    state.jobs.is_unlocked()
}

/// A file of a part has changed on disk, and no job holds the inputs.
pub(super) fn any_changed_unlocked(state: &AppState) -> Result<(), Reason> {
    any_part_unlocked(state)?;
    let has_changed = state.has_any_changed_on_disk();
    require(has_changed, "No file has changed on disk.")
}

/// The part is loaded and no job holds the inputs.
pub(super) fn part_unlocked(state: &AppState, role: Role) -> Result<(), Reason> {
    state.document.has_part(role)?;
    state.jobs.is_unlocked()
}

pub(super) fn shows_its_pose(state: &AppState) -> Result<(), Reason> {
    state.document.has_part(Role::Stamped)?;
    state.shows_its_pose()
}

/// There is a result, and nothing else is shown.
pub(super) fn shows_result(state: &AppState) -> Result<(), Reason> {
    state.document.has_result()?;
    state.shows_its_pose()
}

pub(super) fn has_selection(state: &AppState) -> Result<(), Reason> {
    require(!state.parts.selected.is_empty(), "Select a part first.")
}

pub(super) fn is_reduced(state: &AppState) -> Result<(), Reason> {
    let is_reduced = |role| state.document.part(role).is_some_and(|p| p.level.is_some());
    let any = Role::ALL.into_iter().any(is_reduced);
    require(any, "No part is reduced.")
}

/// A deck holds parts beside those that are matched.
pub(super) fn has_unused_parts(state: &AppState) -> Result<(), Reason> {
    let has_unused = |role| state.document.part(role).is_some_and(Part::has_unused);
    let any = Role::ALL.into_iter().any(has_unused);
    require(any, "Every part is used for the match.")
}

/// `Ok` if there is something to blink or wipe between.
pub(super) fn has_two_pictures(state: &AppState) -> Result<(), Reason> {
    let any = state.view.is_moved_over || is_reduced(state).is_ok();
    require(any, "Move the stamped part over first, or reduce a part.")?;
    let is_alone = state.is_mapping_apart() && !state.can_compare_mapped();
    require(
        !is_alone,
        "Only the crash part has these colours: show a quantity that both parts have.",
    )
}

pub(super) fn has_mapping(state: &AppState) -> Result<(), Reason> {
    let has_mapping = state.document.current_mapping().is_some();
    require(has_mapping, "Map the forming results first.")
}

/// There is a mapping, and it is the one that would be made now.
pub(super) fn has_valid_mapping(state: &AppState) -> Result<(), Reason> {
    has_mapping(state)?;
    let is_valid = !state.document.is_mapping_out_of_date();
    require(is_valid, "The mapping is out of date: map again.")
}

pub(super) fn has_starts(state: &AppState) -> Result<(), Reason> {
    let n_starts = state.current_starts().map_or(0, <[_]>::len);
    require(n_starts > 0, "Align the surface normals first.")?;
    state.jobs.is_unlocked()
}
