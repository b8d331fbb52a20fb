//! The menu *View*: display, inspection, section, camera, size of the window's text.

use super::conditions::{
    always, has_mapping, has_two_pictures, has_unused_parts, is_reduced, require,
};
use super::row::keys::{ctrl, ctrl_digit, digit, function, key, shift};
use super::row::some;
use super::{Action, ActionRow, Key, Keys, MenuGroup, Reason, Shortcut, section};
use crate::app::{
    AppState, ColorBy, Command, Display, ExportCommand, InspectCommand, MapCommand, MapPicture,
    Settings, ShownGeometry, ViewCommand,
};
use crate::geometry::camera::{OrbitStyle, StandardView};

pub(super) const GROUPS: &[MenuGroup] = &[
    MenuGroup::plain(COMPARE),
    MenuGroup::submenu("Display", DISPLAY),
    MenuGroup::submenu("Inspect", INSPECT),
    MenuGroup::submenu("Mapping", MAPPING),
    MenuGroup::submenu("Section", section::ROWS),
    MenuGroup::submenu("Camera", CAMERA),
    MenuGroup::plain(WINDOW),
];

const COMPARE: &[ActionRow] = &[
    ActionRow {
        action: Action::ToggleMoveOver,
        label: "Move over",
        tooltip: "Show the stamped part in the left window, or back in its own",
        keys: Keys::press(&[key('M')]),
        enabled: |state| state.document.has_both_parts(),
        command: |_| some(ViewCommand::ToggleMoveOver),
    },
    ActionRow {
        action: Action::Blink,
        label: "Blink",
        tooltip: "Hold to see the full mesh, or the other part when moved over",
        keys: Keys::hold(&[key('B')]),
        enabled: has_two_pictures,
        command: |_| some(ViewCommand::SetBlinking(true)),
    },
    ActionRow {
        action: Action::ToggleSeeThrough,
        label: "See-through",
        tooltip: "Make the crash part transparent",
        keys: Keys::press(&[key('X')]),
        enabled: always,
        command: |state| shown_with(state, |display| display.is_see_through ^= true),
    },
    ActionRow {
        action: Action::FitAll,
        label: "Fit all",
        tooltip: "Bring everything visible into view in both windows",
        keys: Keys::press(&[Shortcut::plain(Key::Home)]),
        enabled: |state| state.document.has_any_part(),
        command: |_| some(ViewCommand::FitBoth),
    },
];

const DISPLAY: &[ActionRow] = &[
    ActionRow {
        action: Action::ToggleDetailed,
        label: "Detailed geometry",
        tooltip: "Show the full meshes instead of the reduced ones",
        keys: Keys::press(&[shift('D')]),
        enabled: is_reduced,
        command: |state| {
            some(ViewCommand::SetShown(match state.view.shown {
                ShownGeometry::Reduced => ShownGeometry::Detailed,
                ShownGeometry::Detailed => ShownGeometry::Reduced,
            }))
        },
    },
    ActionRow {
        action: Action::ToggleSplit,
        label: "Reduced | full",
        tooltip: "Split each window: reduced mesh left, full mesh right of a line",
        keys: Keys::press(&[shift('W')]),
        enabled: is_reduced,
        command: |state| shown_with(state, |display| toggle_line(&mut display.split)),
    },
    ActionRow {
        action: Action::ToggleWipe,
        label: "Wipe",
        tooltip: "A line with the stamped part on one side only; before moving over: reduced | full",
        keys: Keys::press(&[key('W')]),
        enabled: has_two_pictures,
        // Before the part is moved over, the same key wipes between reduced and full.
        command: |state| {
            let is_split = !state.view.is_moved_over && is_reduced(state).is_ok();
            shown_with(state, |display| {
                toggle_line(if is_split {
                    &mut display.split
                } else {
                    &mut display.wipe
                });
            })
        },
    },
    ActionRow {
        action: Action::ToggleEdges,
        label: "Mesh edges",
        tooltip: "Draw the edges of the mesh",
        keys: Keys::press(&[key('E')]),
        enabled: always,
        command: |state| shown_with(state, |display| display.has_edges ^= true),
    },
    ActionRow {
        action: Action::ToggleFeatureEdges,
        label: "Feature edges",
        tooltip: "Draw sharp edges and borders",
        keys: Keys::press(&[shift('E')]),
        enabled: always,
        command: |state| shown_with(state, |display| display.has_feature_edges ^= true),
    },
    ActionRow {
        action: Action::TogglePoints,
        label: "Nodes",
        tooltip: "Draw the nodes as points",
        keys: Keys::NONE,
        enabled: always,
        command: |state| shown_with(state, |display| display.has_points ^= true),
    },
    ActionRow {
        action: Action::ToggleUnused,
        label: "Show unused parts",
        tooltip: "Draw the parts of a deck that are not used for the match, grey and faint",
        keys: Keys::NONE,
        enabled: has_unused_parts,
        command: |state| shown_with(state, |display| display.has_unused ^= true),
    },
];

const INSPECT: &[ActionRow] = &[
    ActionRow {
        action: Action::ToggleDeviation,
        label: "Deviation map",
        tooltip: "Colour the parts by the signed distance between them",
        keys: Keys::press(&[key('D')]),
        enabled: |state| state.document.has_both_parts(),
        command: |state| map_toggled(state, ColorBy::Deviation),
    },
    ActionRow {
        action: Action::ToggleOverlap,
        label: "Overlap map",
        tooltip: "Show where the parts match, where they deviate, and what only one of them has",
        keys: Keys::press(&[key('O')]),
        enabled: |state| state.document.has_both_parts(),
        command: |state| map_toggled(state, ColorBy::Overlap),
    },
    ActionRow {
        action: Action::ToggleUncertainty,
        label: "Uncertainty map",
        tooltip: "Colour the stamped part by how far the pose may be off there",
        keys: Keys::press(&[key('U')]),
        enabled: AppState::has_uncertainty,
        command: |state| map_toggled(state, ColorBy::Uncertainty),
    },
    ActionRow {
        action: Action::UpdateDeviation,
        label: "Update the deviation",
        tooltip: "Measure the deviation again at the shown pose and levels",
        keys: Keys::NONE,
        enabled: |state| state.document.has_both_parts(),
        command: |_| some(InspectCommand::Update),
    },
    ActionRow {
        action: Action::MeasureDistance,
        label: "Measure distance",
        tooltip: "Measure between two points that are clicked in a 3D window",
        keys: Keys::press(&[key('I')]),
        enabled: |state| state.document.has_any_part(),
        command: |_| some(InspectCommand::ToggleDistance),
    },
    ActionRow {
        action: Action::CopyDistance,
        label: "Copy distance",
        tooltip: "Copy the measured distance with its components along the axes",
        keys: Keys::NONE,
        enabled: |state| {
            let is_measured = state.measured_distance().is_some();
            require(
                is_measured,
                "Measure the distance between two points first.",
            )
        },
        command: |state| {
            let text = state.measured_distance()?.join(", ");
            let what = "Distance".to_owned();
            some(ExportCommand::CopyText { text, what })
        },
    },
];

const MAPPING: &[ActionRow] = &[
    ActionRow {
        action: Action::ShowMapped,
        label: "Mapped values",
        tooltip: "Colour the crash part by the mapped quantity and the stamped part by its own",
        keys: Keys::press(&[key('C')]),
        enabled: has_mapping,
        command: |state| mapping_picture(state, None),
    },
    ActionRow {
        action: Action::ShowMapDifference,
        label: "Mapping difference",
        tooltip: "Colour the crash part by the mapped less the stamped value",
        keys: Keys::press(&[shift('C')]),
        enabled: has_mapping,
        command: |state| mapping_picture(state, Some(MapPicture::Difference)),
    },
    ActionRow {
        action: Action::ShowMapDistance,
        label: "Mapping distance",
        tooltip: "Colour the crash part by the distance of the stamped sheet along its normals",
        keys: Keys::NONE,
        enabled: has_mapping,
        command: |state| mapping_picture(state, Some(MapPicture::Distance)),
    },
    ActionRow {
        action: Action::ShowMapAngle,
        label: "Mapping angle",
        tooltip: "Colour the crash part by the angle between its normals and those of the stamped sheet",
        keys: Keys::NONE,
        enabled: has_mapping,
        command: |state| mapping_picture(state, Some(MapPicture::Angle)),
    },
    ActionRow {
        action: Action::ShowMapConfidence,
        label: "Mapping confidence",
        tooltip: "Colour the crash part by how far its mapped values can be trusted",
        keys: Keys::NONE,
        enabled: has_mapping,
        command: |state| mapping_picture(state, Some(MapPicture::Confidence)),
    },
    ActionRow {
        action: Action::ShowMapStatus,
        label: "Mapping status",
        tooltip: "Show which elements were mapped, and why others were not",
        keys: Keys::NONE,
        enabled: has_mapping,
        command: |state| mapping_picture(state, Some(MapPicture::Status)),
    },
    ActionRow {
        action: Action::ShowMapFile,
        label: "Mapping from file",
        tooltip: "Show which stamped file gave each element its values",
        keys: Keys::NONE,
        enabled: |state| {
            has_mapping(state)?;
            let is_missing = state.missing_for(ColorBy::MapFile).is_some();
            require(!is_missing, "Map from several stamped files first.")
        },
        command: |state| mapping_picture(state, Some(MapPicture::File)),
    },
    ActionRow {
        action: Action::ShowMapOther,
        label: "Mapping against other result",
        tooltip: "Colour the crash part by the mapped value less that of the file it was compared with",
        keys: Keys::NONE,
        enabled: |state| {
            has_mapping(state)?;
            let is_missing = state.missing_for(ColorBy::MapOther).is_some();
            require(!is_missing, "Compare the mapping with another file first.")
        },
        command: |state| mapping_picture(state, Some(MapPicture::Other)),
    },
    ActionRow {
        action: Action::NextMapQuantity,
        label: "Next mapped quantity",
        tooltip: "Show the next quantity of the mapping",
        keys: Keys::press(&[key('Q')]),
        enabled: has_mapping,
        command: |state| shown(state.with_next_map_quantity()),
    },
    ActionRow {
        action: Action::NextLayer,
        label: "Next layer",
        tooltip: "Show another layer of the sheet: mean, extreme, bottom, middle, top, or as is usual",
        keys: Keys::press(&[shift('Q')]),
        enabled: has_mapping,
        command: |state| shown(state.with_next_layer()),
    },
    ActionRow {
        action: Action::PinProbe,
        label: "Pin the probe",
        tooltip: "Put the probed element into the report of the mapping, or take it out again",
        keys: Keys::press(&[shift('P')]),
        enabled: is_probed,
        command: |state| some(MapCommand::TogglePin(state.probe()?.id)),
    },
    ActionRow {
        action: Action::EndProbe,
        label: "End the probe",
        tooltip: "Forget the probed element of the mapping",
        keys: Keys::NONE,
        enabled: is_probed,
        command: |_| some(MapCommand::Probe(None)),
    },
];

const CAMERA: &[ActionRow] = &[
    ActionRow {
        action: Action::FocusSelection,
        label: "Fit selection",
        tooltip: "Bring the selected parts into view, or everything",
        keys: Keys::press(&[key('F')]),
        enabled: |state| state.document.has_any_part(),
        command: |state| some(ViewCommand::Focus(state.view.focus)),
    },
    ActionRow {
        action: Action::PreviousView,
        label: "Previous view",
        tooltip: "Back to the camera before the last jump",
        keys: Keys::press(&[digit(0)]),
        enabled: always,
        command: |state| some(ViewCommand::PreviousCamera(state.view.focus)),
    },
    ActionRow {
        action: Action::ViewFront,
        label: "Front",
        tooltip: "Look along +y",
        keys: Keys::press(&[digit(1)]),
        enabled: always,
        command: |state| look(state, StandardView::Front),
    },
    ActionRow {
        action: Action::ViewBack,
        label: "Back",
        tooltip: "Look along −y",
        keys: Keys::press(&[ctrl_digit(1)]),
        enabled: always,
        command: |state| look(state, StandardView::Back),
    },
    ActionRow {
        action: Action::ViewRight,
        label: "Right",
        tooltip: "Look along −x",
        keys: Keys::press(&[digit(3)]),
        enabled: always,
        command: |state| look(state, StandardView::Right),
    },
    ActionRow {
        action: Action::ViewLeft,
        label: "Left",
        tooltip: "Look along +x",
        keys: Keys::press(&[ctrl_digit(3)]),
        enabled: always,
        command: |state| look(state, StandardView::Left),
    },
    ActionRow {
        action: Action::ViewTop,
        label: "Top",
        tooltip: "Look along −z",
        keys: Keys::press(&[digit(7)]),
        enabled: always,
        command: |state| look(state, StandardView::Top),
    },
    ActionRow {
        action: Action::ViewBottom,
        label: "Bottom",
        tooltip: "Look along +z",
        keys: Keys::press(&[ctrl_digit(7)]),
        enabled: always,
        command: |state| look(state, StandardView::Bottom),
    },
    ActionRow {
        action: Action::ViewIsometric,
        label: "Isometric",
        tooltip: "Look from (+x, −y, +z)",
        keys: Keys::press(&[digit(9)]),
        enabled: always,
        command: |state| look(state, StandardView::Isometric),
    },
    ActionRow {
        action: Action::ToggleProjection,
        label: "Perspective",
        tooltip: "Perspective or parallel projection",
        keys: Keys::press(&[digit(5)]),
        enabled: always,
        command: |state| some(ViewCommand::ToggleProjection(state.view.focus)),
    },
    ActionRow {
        action: Action::ToggleLink,
        label: "Link views",
        tooltip: "Rotate and zoom both windows together",
        keys: Keys::press(&[key('L')]),
        enabled: always,
        command: |_| some(ViewCommand::ToggleLink),
    },
    ActionRow {
        action: Action::ToggleOrbitStyle,
        label: "Free orbit",
        tooltip: "Rotate freely instead of about the vertical axis",
        keys: Keys::press(&[key('T')]),
        enabled: always,
        command: |state| {
            some(ViewCommand::SetOrbitStyle(match state.view.orbit_style {
                OrbitStyle::Turntable => OrbitStyle::Free,
                OrbitStyle::Free => OrbitStyle::Turntable,
            }))
        },
    },
    ActionRow {
        action: Action::ClearPivot,
        label: "Clear pivot",
        tooltip: "Rotate about the point under the pointer again",
        keys: Keys::press(&[key('P')]),
        enabled: |state| {
            let pivot = state.view.pivot.get(state.view.focus);
            require(pivot.is_some(), "No pivot was picked.")
        },
        command: |state| some(ViewCommand::SetPivot(state.view.focus, None)),
    },
];

const WINDOW: &[ActionRow] = &[
    ActionRow {
        action: Action::ToggleGraphicsOnly,
        label: "Graphics only",
        tooltip: "Hide everything but the 3D windows",
        keys: Keys::press(&[function(11)]),
        enabled: always,
        command: |_| some(ViewCommand::ToggleGraphicsOnly),
    },
    ActionRow {
        action: Action::ToggleColumn,
        label: "Left column",
        tooltip: "Fold the left column to a rail, or unfold it",
        keys: Keys::press(&[ctrl('B')]),
        enabled: always,
        command: |state| some(ViewCommand::FoldColumn(!state.view.is_column_folded())),
    },
    ActionRow {
        action: Action::ScaleUp,
        label: "Increase UI scale",
        tooltip: "Make text and controls larger",
        keys: Keys::repeat(&[Shortcut::ctrl(Key::Plus)]),
        enabled: |state| {
            let is_less = state.settings.ui_scale < *Settings::UI_SCALES.end();
            require(is_less, "This is the largest UI scale.")
        },
        command: |state| scaled(state, state.settings.ui_scale + 0.125),
    },
    ActionRow {
        action: Action::ScaleDown,
        label: "Decrease UI scale",
        tooltip: "Make text and controls smaller",
        keys: Keys::repeat(&[Shortcut::ctrl(Key::Minus)]),
        enabled: |state| {
            let is_more = state.settings.ui_scale > *Settings::UI_SCALES.start();
            require(is_more, "This is the smallest UI scale.")
        },
        command: |state| scaled(state, state.settings.ui_scale - 0.125),
    },
    ActionRow {
        action: Action::ScaleReset,
        label: "Reset UI scale",
        tooltip: "UI scale back to 100 %",
        keys: Keys::press(&[ctrl_digit(0)]),
        enabled: always,
        command: |state| scaled(state, 1.0),
    },
];

fn is_probed(state: &AppState) -> Result<(), Reason> {
    let is_probed = state.probe().is_some();
    require(is_probed, "No element of a mapping is probed.")
}

/// The picture with one choice changed.
fn shown_with(state: &AppState, change: impl FnOnce(&mut Display)) -> Option<Command> {
    let mut display = state.view.display.clone();
    change(&mut display);
    shown(display)
}

fn shown(display: Display) -> Option<Command> {
    some(ViewCommand::SetDisplay(Box::new(display)))
}

fn mapping_picture(state: &AppState, picture: Option<MapPicture>) -> Option<Command> {
    shown(state.with_map_picture(picture))
}

/// A map of the match in place of the colours, or these again.
fn map_toggled(state: &AppState, by: ColorBy) -> Option<Command> {
    let before = state.view.colors_before_map;
    shown_with(state, |display| {
        display.color_by = if display.color_by == by { before } else { by };
    })
}

/// A line that was not there begins in the middle.
fn toggle_line(line: &mut Option<f32>) {
    *line = match line {
        None => Some(0.5),
        Some(_) => None,
    };
}

fn look(state: &AppState, view: StandardView) -> Option<Command> {
    some(ViewCommand::Standard(state.view.focus, view))
}

fn scaled(state: &AppState, ui_scale: f32) -> Option<Command> {
    Some(Command::Settings(Box::new(Settings {
        ui_scale,
        ..state.settings.clone()
    })))
}
