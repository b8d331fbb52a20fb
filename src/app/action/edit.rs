//! The menu *Edit*: history, visibility of parts, moves by hand.

use super::conditions::{always, any_part_unlocked, has_selection, require};
use super::row::keys::{ctrl, ctrl_shift, key, shift};
use super::row::some;
use super::{Action, ActionRow, Key, Keys, MenuGroup, Shortcut};
use crate::app::{
    AppState, Axis, AxisFrame, Command, HistoryCommand, MotionKind, MoveCommand, PairCommand,
    PartCommand, Reason,
};
use crate::geometry::Similarity;

pub(super) const GROUPS: &[MenuGroup] = &[
    MenuGroup::plain(HISTORY),
    MenuGroup::plain(PARTS),
    MenuGroup::plain(TOOLS),
    MenuGroup::plain(POSE),
];

const HISTORY: &[ActionRow] = &[
    ActionRow {
        action: Action::Undo,
        label: "Undo",
        tooltip: "Undo the last step",
        keys: Keys::repeat(&[ctrl('Z')]),
        enabled: |state| {
            require(state.history.undo_name().is_some(), "Nothing to undo.")?;
            state.jobs.is_unlocked()
        },
        command: |_| some(HistoryCommand::Undo),
    },
    ActionRow {
        action: Action::Redo,
        label: "Redo",
        tooltip: "Redo the step that was undone last",
        keys: Keys::repeat(&[ctrl_shift('Z'), ctrl('Y')]),
        enabled: |state| {
            require(state.history.redo_name().is_some(), "Nothing to redo.")?;
            state.jobs.is_unlocked()
        },
        command: |_| some(HistoryCommand::Redo),
    },
    ActionRow {
        action: Action::ResetAll,
        label: "Reset to initial state",
        tooltip: "Pose, levels, visibility and colours as after loading, without a result and what its remedies set; one undo \
                  step",
        keys: Keys::NONE,
        enabled: any_part_unlocked,
        command: |_| some(HistoryCommand::ResetAll),
    },
    ActionRow {
        action: Action::Escape,
        label: "Close or cancel",
        tooltip: "Close what is open; then cancel the run",
        keys: Keys::press(&[Shortcut::plain(Key::Escape)]),
        enabled: always,
        command: |_| Some(Command::Escape),
    },
];

const PARTS: &[ActionRow] = &[
    ActionRow {
        action: Action::HideSelected,
        label: "Hide",
        tooltip: "Hide the selected parts",
        keys: Keys::press(&[key('H')]),
        enabled: has_selection,
        command: |_| some(PartCommand::HideSelected),
    },
    ActionRow {
        action: Action::IsolateSelected,
        label: "Show only this",
        tooltip: "Hide all parts but the selected ones",
        keys: Keys::press(&[shift('H')]),
        enabled: has_selection,
        command: |_| some(PartCommand::ShowOnlySelected),
    },
    ActionRow {
        action: Action::ShowAllParts,
        label: "Show all",
        tooltip: "Show all parts of both models",
        keys: Keys::press(&[Shortcut::alt(Key::Letter('H'))]),
        enabled: always,
        command: |_| some(PartCommand::ShowAll),
    },
];

const TOOLS: &[ActionRow] = &[
    ActionRow {
        action: Action::MoveTool,
        label: "Move",
        tooltip: "Move the stamped part with the pointer; X/Y/Z: constrain to axis; digits: distance",
        keys: Keys::press(&[key('G')]),
        enabled: AppState::can_move,
        command: |state| begin(state, MotionKind::Move),
    },
    ActionRow {
        action: Action::RotateTool,
        label: "Rotate",
        tooltip: "Rotate the stamped part with the pointer; X/Y/Z: constrain to axis; digits: degrees",
        keys: Keys::press(&[key('R')]),
        enabled: AppState::can_move,
        command: |state| begin(state, MotionKind::Rotate),
    },
    ActionRow {
        action: Action::ToggleGizmo,
        label: "Gizmo",
        tooltip: "Show handles that move and rotate the stamped part",
        keys: Keys::press(&[shift('G')]),
        enabled: can_show_gizmo,
        command: |_| some(MoveCommand::ToggleGizmo),
    },
    ActionRow {
        action: Action::PairTool,
        label: "Point pairs",
        tooltip: "Pick corresponding points, in turn on the crash and the stamped part",
        keys: Keys::press(&[key('N')]),
        enabled: AppState::can_match,
        command: |_| some(PairCommand::ToggleTool),
    },
    ActionRow {
        action: Action::CycleMoveAxes,
        label: "Cycle axes",
        tooltip: "Move along the axes of the crash model, of the part, or of the view",
        keys: Keys::NONE,
        enabled: always,
        command: |state| some(MoveCommand::SetAxes(next_axes(state.moving.axes))),
    },
];

const POSE: &[ActionRow] = &[
    ActionRow {
        action: Action::FlipX,
        label: "Flip about X (180°)",
        tooltip: "Rotate the stamped part by 180° about its own x axis",
        keys: Keys::press(&[shift('R')]),
        enabled: AppState::can_move,
        command: |_| some(MoveCommand::Flip(Axis::X)),
    },
    ActionRow {
        action: Action::FlipY,
        label: "Flip about Y (180°)",
        tooltip: "Rotate the stamped part by 180° about its own y axis",
        keys: Keys::NONE,
        enabled: AppState::can_move,
        command: |_| some(MoveCommand::Flip(Axis::Y)),
    },
    ActionRow {
        action: Action::FlipZ,
        label: "Flip about Z (180°)",
        tooltip: "Rotate the stamped part by 180° about its own z axis",
        keys: Keys::NONE,
        enabled: AppState::can_move,
        command: |_| some(MoveCommand::Flip(Axis::Z)),
    },
    ActionRow {
        action: Action::AlignCenters,
        label: "Align centres",
        tooltip: "Move the stamped part so that the centres of both bounding boxes coincide",
        keys: Keys::NONE,
        enabled: AppState::can_match,
        command: |_| some(MoveCommand::AlignCenters),
    },
    ActionRow {
        action: Action::ResetPose,
        label: "Reset pose",
        tooltip: "Put the stamped part back where its file has it",
        keys: Keys::NONE,
        enabled: |state| {
            state.can_move()?;
            let is_moved = *state.document.crash_from_stamped() != Similarity::identity();
            require(is_moved, "The part is where its file has it.")
        },
        command: |_| some(MoveCommand::Reset),
    },
];

/// While points are picked a click on a handle is meant for the part below it, so there are none.
fn can_show_gizmo(state: &AppState) -> Result<(), Reason> {
    require(
        !state.is_picking(),
        "Clicks pick points now, so the gizmo is hidden: Esc ends that.",
    )
}

fn begin(state: &AppState, kind: MotionKind) -> Option<Command> {
    let frame = state.move_frame()?;
    some(MoveCommand::Begin { kind, frame })
}

fn next_axes(axes: AxisFrame) -> AxisFrame {
    match axes {
        AxisFrame::Global => AxisFrame::Part,
        AxisFrame::Part => AxisFrame::View,
        AxisFrame::View => AxisFrame::Global,
    }
}
