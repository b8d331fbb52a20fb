//! The menu *Export*: what leaves the program.

use super::conditions::{always, has_valid_mapping, shows_its_pose, shows_result};
use super::row::keys::{ctrl_shift, function};
use super::row::some;
use super::{Action, ActionRow, Key, Keys, MenuGroup, Shortcut, toggled_dialog};
use crate::app::{AppState, Command, CopyForm, Dialog, ExportCommand};
use crate::pipeline::map::WriteKind;
use crate::pipeline::outputs::{MeshOutput, Output};
use crate::report::{CardForm, MatrixForm};

pub(super) const GROUPS: &[MenuGroup] = &[
    MenuGroup::plain(COPY),
    MenuGroup::plain(SAVE),
    MenuGroup::plain(MAPPED),
    MenuGroup::plain(IMAGE),
];

const COPY: &[ActionRow] = &[
    ActionRow {
        action: Action::CopyMatrix,
        label: "Copy matrix",
        tooltip: "Copy the pose (stamped → crash) in the form used last",
        keys: Keys::press(&[ctrl_shift('C')]),
        enabled: shows_its_pose,
        command: |state| some(ExportCommand::Copy(state.copy_form())),
    },
    ActionRow {
        action: Action::CopyCommandLine,
        label: "Copy as command line",
        tooltip: "Copy the command that gives this pose again without the window, bit for bit",
        keys: Keys::NONE,
        enabled: |state| {
            state.document.can_copy_command_line()?;
            state.shows_its_pose()
        },
        command: |_| some(ExportCommand::CopyCommandLine),
    },
    ActionRow {
        action: Action::CopyMapCommandLine,
        label: "Copy mapping as command line",
        tooltip: "Copy the command that maps at this pose with these choices without the window, bit for bit",
        keys: Keys::NONE,
        enabled: |state| {
            state.document.can_copy_map_command_line()?;
            state.shows_its_pose()
        },
        command: |_| some(ExportCommand::CopyMapCommandLine),
    },
    ActionRow {
        action: Action::CopyLog,
        label: "Copy log",
        tooltip: "Copy the rows of the log as text",
        keys: Keys::NONE,
        enabled: always,
        command: |_| some(ExportCommand::CopyLog),
    },
];

const MAPPED: &[ActionRow] = &[
    ActionRow {
        action: Action::SaveMappedDeck,
        label: "Save mapped deck…",
        tooltip: "Write a copy of the crash deck with mapped thickness and states, all else byte for byte",
        keys: Keys::NONE,
        enabled: has_valid_mapping,
        command: |_| save(Output::Mapped(WriteKind::Deck)),
    },
    ActionRow {
        action: Action::SaveMappedPart,
        label: "Save mapped part…",
        tooltip: "Write all elements of the crash part with mapped thickness, and the states",
        keys: Keys::NONE,
        enabled: has_valid_mapping,
        command: |_| save(Output::Mapped(WriteKind::Part)),
    },
    ActionRow {
        action: Action::SaveMappedInclude,
        label: "Save mapped include…",
        tooltip: "Write the states as an include, and beside it the elements with their thickness, which take \
                  the place of the crash deck's",
        keys: Keys::NONE,
        enabled: has_valid_mapping,
        command: |_| save(Output::Mapped(WriteKind::Include)),
    },
    ActionRow {
        action: Action::SaveMapReport,
        label: "Save mapping report…",
        tooltip: "Write statistics and pictures before and after as one HTML page",
        keys: Keys::NONE,
        enabled: has_valid_mapping,
        command: |_| save(Output::MapReport),
    },
    ActionRow {
        action: Action::SaveMapTable,
        label: "Save mapping table…",
        tooltip: "Write status, distances and values of every crash element, as CSV",
        keys: Keys::NONE,
        enabled: has_valid_mapping,
        command: |_| save(Output::MapTable),
    },
];

const SAVE: &[ActionRow] = &[
    ActionRow {
        action: Action::SaveReport,
        label: "Save report…",
        tooltip: "Write pictures, verdict, tables and settings as one HTML page",
        keys: Keys::NONE,
        enabled: shows_result,
        command: |_| save(Output::Report),
    },
    ActionRow {
        action: Action::SaveRecord,
        label: "Save record…",
        tooltip: "Write the whole match as JSON: matrix, verdict, settings, times",
        keys: Keys::NONE,
        enabled: shows_result,
        command: |_| save(Output::Record),
    },
    ActionRow {
        action: Action::SaveDeviations,
        label: "Save node deviations…",
        tooltip: "Write the distance of every node from the other part, as CSV",
        keys: Keys::NONE,
        enabled: |state| {
            state.document.has_both_parts()?;
            state.shows_its_pose()
        },
        command: |_| save(Output::Deviations),
    },
    ActionRow {
        action: Action::SaveMatrix,
        label: "Save matrix…",
        tooltip: "Write the pose as text",
        keys: Keys::NONE,
        enabled: shows_its_pose,
        command: |state| save(Output::Matrix(last_matrix(state))),
    },
    ActionRow {
        action: Action::SaveCards,
        label: "Save LS-DYNA cards…",
        tooltip: "Write the cards that map the stamped part, and check them by reading them back",
        keys: Keys::NONE,
        enabled: shows_result,
        command: |_| save(Output::Cards(CardForm::ALL[0])),
    },
    ActionRow {
        action: Action::SaveMoved,
        label: "Save moved part…",
        tooltip: "Write the stamped part at its pose on the crash part",
        keys: Keys::NONE,
        enabled: shows_its_pose,
        command: |_| save(Output::Mesh(MeshOutput::Moved)),
    },
];

const IMAGE: &[ActionRow] = &[
    ActionRow {
        action: Action::PictureOptions,
        label: "Save image…",
        tooltip: "Choose size, background and windows of an image, then write it",
        keys: Keys::press(&[Shortcut::shift(Key::Function(12))]),
        enabled: |state| state.document.has_any_part(),
        command: |state| some(toggled_dialog(state, Dialog::Picture)),
    },
    ActionRow {
        action: Action::TakePicture,
        label: "Save image again",
        tooltip: "Write an image of the 3D windows with the settings used last",
        keys: Keys::press(&[function(12)]),
        enabled: |state| state.document.has_any_part(),
        command: |_| take_picture(false),
    },
    ActionRow {
        action: Action::TakePictureTransparent,
        label: "Save image without background",
        tooltip: "Write an image of the 3D windows with a transparent background",
        keys: Keys::press(&[Shortcut::ctrl(Key::Function(12))]),
        enabled: |state| state.document.has_any_part(),
        command: |_| take_picture(true),
    },
];

fn save(kind: Output) -> Option<Command> {
    some(ExportCommand::AskSave(kind))
}

fn take_picture(is_transparent: bool) -> Option<Command> {
    some(ExportCommand::TakePicture { is_transparent })
}

/// The form of the matrix that was copied last.
fn last_matrix(state: &AppState) -> MatrixForm {
    match state.copy_form() {
        CopyForm::Matrix(form) => form,
        CopyForm::Cards(_) => MatrixForm::Rows,
    }
}
