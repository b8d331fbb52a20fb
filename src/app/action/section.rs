//! The submenu *View › Section*.

use super::conditions::require;
use super::row::keys::{key, shift};
use super::row::some;
use super::{Action, ActionRow, Key, Keys, Reason, Shortcut};
use crate::app::{AppState, Command, InspectCommand, SectionView};
use crate::geometry::Vector3;

pub(super) const ROWS: &[ActionRow] = &[
    ActionRow {
        action: Action::ToggleSection,
        label: "Section",
        tooltip: "Cut both parts with a plane and show their outlines",
        keys: Keys::press(&[key('S')]),
        enabled: |state| state.document.has_any_part(),
        command: |state| some(InspectCommand::SetSection(state.toggled_section())),
    },
    ActionRow {
        action: Action::ToggleSectionClip,
        label: "Cut away one half",
        tooltip: "Hide what lies in front of the section plane",
        keys: Keys::press(&[shift('S')]),
        enabled: |state| state.document.has_any_part(),
        command: |state| {
            some(InspectCommand::SetSection(SectionView {
                is_clipped: !state.inspect.section.is_clipped,
                ..state.section_across(&section_normal(state))
            }))
        },
    },
    ActionRow {
        action: Action::SectionX,
        label: "Section across X",
        tooltip: "Section plane normal to x",
        keys: Keys::NONE,
        enabled: |state| state.document.has_any_part(),
        command: |state| section_across(state, &Vector3::x()),
    },
    ActionRow {
        action: Action::SectionY,
        label: "Section across Y",
        tooltip: "Section plane normal to y",
        keys: Keys::NONE,
        enabled: |state| state.document.has_any_part(),
        command: |state| section_across(state, &Vector3::y()),
    },
    ActionRow {
        action: Action::SectionZ,
        label: "Section across Z",
        tooltip: "Section plane normal to z",
        keys: Keys::NONE,
        enabled: |state| state.document.has_any_part(),
        command: |state| section_across(state, &Vector3::z()),
    },
    ActionRow {
        action: Action::SectionView,
        label: "Section across the view",
        tooltip: "Section plane facing the viewer",
        keys: Keys::NONE,
        enabled: |state| state.document.has_any_part(),
        command: |state| {
            let camera = state.view.cameras.get(state.view.focus);
            section_across(state, &-camera.forward())
        },
    },
    ActionRow {
        action: Action::SectionForward,
        label: "Section forward",
        tooltip: "Move the section plane by a tenth of an element along its normal",
        keys: Keys::press(&[Shortcut::shift(Key::PageUp)]),
        enabled: has_section,
        command: |state| section_moved(state, 1.0),
    },
    ActionRow {
        action: Action::SectionBack,
        label: "Section back",
        tooltip: "Move the section plane back by a tenth of an element",
        keys: Keys::press(&[Shortcut::shift(Key::PageDown)]),
        enabled: has_section,
        command: |state| section_moved(state, -1.0),
    },
];

fn has_section(state: &AppState) -> Result<(), Reason> {
    state.document.has_any_part()?;
    require(state.inspect.section.is_on, "Show the section first.")
}

/// What the section plane is normal to now, or would be.
fn section_normal(state: &AppState) -> Vector3 {
    let plane = state.inspect.section.plane;
    plane
        .unwrap_or_else(|| state.default_section_plane())
        .normal
}

fn section_across(state: &AppState, normal: &Vector3) -> Option<Command> {
    some(InspectCommand::SetSection(state.section_across(normal)))
}

fn section_moved(state: &AppState, n_steps: f64) -> Option<Command> {
    let section = state
        .inspect
        .section
        .moved(n_steps * state.document.section_step())?;
    some(InspectCommand::SetSection(section))
}
