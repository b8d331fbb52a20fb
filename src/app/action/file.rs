//! The menu *File*.

use super::conditions::{always, any_changed_unlocked, any_part_unlocked, part_unlocked, require};
use super::row::keys::{ctrl, ctrl_shift};
use super::row::some;
use super::{Action, ActionRow, Keys, MenuGroup, toggled_dialog};
use crate::app::{Command, Dialog, FileCommand, ProjectCommand};
use crate::jobs::ProjectRequest;
use crate::role::Role;

pub(super) const GROUPS: &[MenuGroup] = &[
    MenuGroup::plain(OPEN),
    MenuGroup::plain(PROJECT),
    MenuGroup::plain(PARTS),
    MenuGroup::plain(PROGRAM),
];

const OPEN: &[ActionRow] = &[
    ActionRow {
        action: Action::OpenCrash,
        label: "Open crash model…",
        tooltip: "Choose the crash model; its part stays fixed",
        keys: Keys::press(&[ctrl('O')]),
        enabled: |state| state.jobs.is_unlocked(),
        command: |_| some(FileCommand::AskOpen(Role::Crash)),
    },
    ActionRow {
        action: Action::OpenStamped,
        label: "Open stamped part…",
        tooltip: "Choose the result of the stamping simulation; this part moves",
        keys: Keys::press(&[ctrl_shift('O')]),
        enabled: |state| state.jobs.is_unlocked(),
        command: |_| some(FileCommand::AskOpen(Role::Stamped)),
    },
    ActionRow {
        action: Action::OpenExample,
        label: "Open the example pair",
        tooltip: "Load a generated crash part and its stamped part",
        keys: Keys::NONE,
        enabled: |state| state.jobs.is_unlocked(),
        command: |_| some(FileCommand::OpenExample),
    },
    ActionRow {
        action: Action::OpenRealisticExample,
        label: "Open the realistic pair",
        tooltip: "Load a generated pair that differs as real pairs do: springback, trim, skin against \
                  mid-surface, noise",
        keys: Keys::NONE,
        enabled: |state| state.jobs.is_unlocked(),
        command: |_| some(FileCommand::OpenRealisticExample),
    },
];

const PROJECT: &[ActionRow] = &[
    ActionRow {
        action: Action::OpenProject,
        label: "Open project…",
        tooltip: "Open saved work: both files, pose, levels, settings and result",
        keys: Keys::NONE,
        enabled: |state| state.jobs.is_unlocked(),
        command: |_| some(ProjectCommand::AskOpen),
    },
    ActionRow {
        action: Action::ReopenProject,
        label: "Open project again",
        tooltip: "Open the project as its file has it now; the step back leads to this work",
        keys: Keys::NONE,
        enabled: |state| {
            require(
                state.project_path().is_some(),
                "The work is no saved project.",
            )?;
            state.jobs.is_unlocked()
        },
        command: |state| {
            let path = state.project_path()?.clone();
            some(ProjectCommand::Open(ProjectRequest {
                path,
                ..ProjectRequest::default()
            }))
        },
    },
    ActionRow {
        action: Action::SaveProject,
        label: "Save project",
        tooltip: "Save pose, levels, settings and result; the geometry stays in its files",
        keys: Keys::press(&[ctrl('S')]),
        enabled: |state| state.document.has_any_part(),
        command: |_| some(ProjectCommand::Save),
    },
    ActionRow {
        action: Action::SaveProjectAs,
        label: "Save project as…",
        tooltip: "Save the work to another file",
        keys: Keys::press(&[ctrl_shift('S')]),
        enabled: |state| state.document.has_any_part(),
        command: |_| some(ProjectCommand::SaveAs),
    },
];

const PARTS: &[ActionRow] = &[
    ActionRow {
        action: Action::ReloadAll,
        label: "Reload",
        tooltip: "Read the files again; choices and pose are kept",
        keys: Keys::NONE,
        enabled: any_part_unlocked,
        command: |_| some(FileCommand::ReloadAll),
    },
    ActionRow {
        action: Action::ReloadChanged,
        label: "Reload changed files",
        tooltip: "Read those files again that have changed on disk; choices and pose are kept",
        keys: Keys::NONE,
        enabled: any_changed_unlocked,
        command: |_| some(FileCommand::ReloadChanged),
    },
    ActionRow {
        action: Action::Swap,
        label: "Swap crash and stamped",
        tooltip: "Exchange the two parts without reading the files again",
        keys: Keys::NONE,
        enabled: |state| {
            any_part_unlocked(state)?;
            state.jobs.are_parts_read()
        },
        command: |_| some(FileCommand::Swap),
    },
    ActionRow {
        action: Action::CloseCrash,
        label: "Close crash part",
        tooltip: "Remove the crash part",
        keys: Keys::NONE,
        enabled: |state| part_unlocked(state, Role::Crash),
        command: |_| some(FileCommand::Close(Role::Crash)),
    },
    ActionRow {
        action: Action::CloseStamped,
        label: "Close stamped part",
        tooltip: "Remove the stamped part",
        keys: Keys::NONE,
        enabled: |state| part_unlocked(state, Role::Stamped),
        command: |_| some(FileCommand::Close(Role::Stamped)),
    },
];

const PROGRAM: &[ActionRow] = &[
    ActionRow {
        action: Action::Preferences,
        label: "Preferences…",
        tooltip: "Theme, UI scale, mouse controls, notifications",
        keys: Keys::press(&[ctrl_shift('P')]),
        enabled: always,
        command: |state| some(toggled_dialog(state, Dialog::Preferences)),
    },
    ActionRow {
        action: Action::Quit,
        label: "Quit",
        tooltip: "Close the program",
        keys: Keys::press(&[ctrl('Q')]),
        enabled: always,
        command: |_| Some(Command::Quit),
    },
];
