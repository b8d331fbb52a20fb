//! The menu *Help*.

use super::conditions::always;
use super::row::keys::{ctrl, function};
use super::row::some;
use super::{Action, ActionRow, Keys, MenuGroup, toggled_dialog};
use crate::app::Dialog;

pub(super) const GROUPS: &[MenuGroup] = &[MenuGroup::plain(HELP), MenuGroup::plain(ABOUT)];

const HELP: &[ActionRow] = &[
    ActionRow {
        action: Action::Palette,
        label: "Search commands…",
        tooltip: "Find any command by its name",
        keys: Keys::press(&[ctrl('K')]),
        enabled: always,
        command: |state| some(toggled_dialog(state, Dialog::Palette)),
    },
    ActionRow {
        action: Action::Help,
        label: "Keys and mouse",
        tooltip: "Show all keys",
        keys: Keys::press(&[function(1)]),
        enabled: always,
        command: |state| some(toggled_dialog(state, Dialog::Help)),
    },
];

const ABOUT: &[ActionRow] = &[ActionRow {
    action: Action::About,
    label: "About",
    tooltip: "Name, version, licences",
    keys: Keys::NONE,
    enabled: always,
    command: |state| some(toggled_dialog(state, Dialog::About)),
}];
