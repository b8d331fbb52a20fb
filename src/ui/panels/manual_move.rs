//! Moves by hand: numbers, turn-over, snapping, pasted matrices.

use std::ops::RangeInclusive;

use egui::{CollapsingHeader, Color32, Key, Modifiers, TextStyle, Ui, vec2};

use crate::app::{
    Action, AppState, Axis, AxisFrame, Command, MoveCommand, turns_deg, with_turns_deg,
};
use crate::geometry::Similarity;
use crate::report::{ParsedMatrix, parse_matrix};
use crate::role::Role;
use crate::text::{fixed, trimmed};
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::typed::{Takes, told_field};
use crate::ui::widgets::{
    Look, action_button, caption, chip, focus_ring, form_row, plain_action, set_draft, text_field,
};

/// Width of the label column.
const LABEL: f32 = 76.0;
/// Left and right of the text in one of several fields or buttons beside each other.
const PADDING: f32 = 4.0;
/// What a typed move, angle or coordinate may be.
const MOVES: RangeInclusive<f64> = -1e9..=1e9;

/// The fold "Move by hand".
pub fn manual_move_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let id = egui::Id::unique("asked for the move by hand");
    let n_asked = state.view.n_asked_by_hand;
    let n_before: u64 =
        ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default(id), n_asked));
    let is_asked = n_before < n_asked;
    let shown = CollapsingHeader::new("Move by hand")
        .id_salt("move by hand")
        .open(is_asked.then_some(true))
        .show_unindented(ui, |ui| {
            let is_free = state.can_move().is_ok();
            ui.add_enabled_ui(is_free, |ui| {
                axes_ui(ui, state, commands);
                steps_ui(ui, state, commands);
                flip_ui(ui, state, commands);
                position_ui(ui, state, commands);
                paste_ui(ui, commands);
            });
        });
    focus_ring(ui, shown.header_response.rect, &shown.header_response);
    if is_asked {
        shown.header_response.scroll_to_me(Some(egui::Align::TOP));
    }
}

fn axes_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    form_row(ui, "Axes", LABEL, |ui| {
        tighten(ui);
        for frame in AxisFrame::ALL {
            if chip(ui, frame.label(), state.moving.axes == frame).clicked() {
                commands.push(MoveCommand::SetAxes(frame).into());
            }
        }
        let look = if state.moving.has_gizmo {
            Look::On
        } else {
            Look::Plain
        };
        let gizmo = ("Gizmo", look, vec2(0.0, ROW));
        action_button(ui, state, Action::ToggleGizmo, gizmo, commands);
    });
}

/// A row that fits the narrowest column.
fn tighten(ui: &mut Ui) {
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.spacing_mut().button_padding.x = PADDING;
}

/// A typed move along and a typed turn about each axis.
fn steps_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let frame = state.moving.axes;
    let length_unit = state.lengths().suffix();
    let decimals = length_decimals(state);
    let millimetre = 10_f64.powi(LENGTH_DECIMALS as i32 - decimals as i32);
    for (name, unit, is_turn) in [("Move", length_unit, false), ("Rotate", "°", true)] {
        let id = egui::Id::unique(("typed move", name, decimals));
        let usual = if is_turn { 15.0 } else { 10.0 * millimetre };
        let mut value: f64 = ui.data(|data| data.get_temp(id)).unwrap_or(usual);
        form_row(ui, name, LABEL, |ui| {
            tighten(ui);
            let (takes, speed) = if is_turn {
                (Takes::number(name, unit, MOVES), 1.0)
            } else {
                let takes = Takes::length(name, state.lengths(), MOVES);
                (takes, 0.5 * millimetre)
            };
            let before = value;
            let field = takes
                .field(&mut value)
                .speed(speed)
                .max_decimals(3 + decimals)
                .min_size(vec2(68.0, ROW));
            let spoken = format!("{name} by");
            told_field(ui, &spoken, before, field, |text| takes.read(text));
            for axis in Axis::ALL {
                let label = format!("{} {}", if value < 0.0 { "−" } else { "+" }, axis.letter());
                let spoken = format!("{name} by {value}{unit} on {}", axis.letter());
                let response = ui.add(egui::Button::new(label).min_size(vec2(36.0, ROW)));
                response
                    .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
                if response.on_hover_text(&spoken).clicked() {
                    let command = if is_turn {
                        MoveCommand::Rotate {
                            axis,
                            frame,
                            degrees: value,
                        }
                    } else {
                        MoveCommand::Translate {
                            axis,
                            frame,
                            distance: value,
                        }
                    };
                    commands.push(command.into());
                }
            }
        });
        ui.data_mut(|data| data.insert_temp(id, value));
    }
}

fn flip_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    form_row(ui, "Flip 180°", LABEL, |ui| {
        tighten(ui);
        for (action, label) in [
            (Action::FlipX, "about X"),
            (Action::FlipY, "about Y"),
            (Action::FlipZ, "about Z"),
        ] {
            let look = (label, Look::Plain, vec2(0.0, ROW));
            action_button(ui, state, action, look, commands);
        }
    });
    ui.horizontal(|ui| {
        let look = ("Align centres", Look::Plain, vec2(0.0, ROW));
        action_button(ui, state, Action::AlignCenters, look, commands);
        plain_action(ui, state, Action::ResetPose, commands);
    });
}

/// Where the centre is, how far it went since loading, and how the part is turned; all can be typed.
fn position_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(center), Some(part)) = (
        state.document.stamped_center(),
        state.document.part(Role::Stamped),
    ) else {
        return;
    };
    let pose = *state.document.crash_from_stamped();
    let pivot = part.bounds().center();
    let at: [f64; 3] = center.coords.into();
    let moved: [f64; 3] = (center - pivot).into();
    let lengths = state.lengths();
    let unit = lengths.suffix();
    axes_row_ui(ui, unit);
    let decimals = length_decimals(state);
    for (row, values) in [(CENTER, at), (CENTER_MOVE, moved)] {
        if let Some((axis, by, value)) = fields_ui(
            ui,
            &row,
            values,
            |name| Takes::length(name, lengths, MOVES),
            (unit, decimals),
        ) {
            let mut crash_from_stamped: Similarity = pose;
            crash_from_stamped.translation[axis.index()] += by;
            let value = fixed(value, decimals);
            let name = format!("{} {} {value}{unit}", row.step, axis.letter());
            commands.push(set_pose(crash_from_stamped, name));
        }
    }
    let Some(turns) = turns_deg(&pose) else {
        caption(ui, "The pose is mirrored: no rotation angles");
        return;
    };
    if let Some((axis, by, value)) = fields_ui(
        ui,
        &ROTATION,
        turns,
        |name| Takes::number(name, "°", MOVES),
        ("°", LENGTH_DECIMALS),
    ) {
        let mut turns = turns;
        turns[axis.index()] += by;
        let crash_from_stamped = with_turns_deg(&pose, turns, &pivot);
        let name = format!("{} {} {}°", ROTATION.step, axis.letter(), fixed(value, 3));
        commands.push(set_pose(crash_from_stamped, name));
    }
}

fn set_pose(crash_from_stamped: Similarity, name: String) -> Command {
    MoveCommand::SetPose {
        crash_from_stamped,
        name,
    }
    .into()
}

/// What a row of three numbers is of.
struct Three {
    label: &'static str,
    spoken: &'static str,
    /// What the step is called when one of them is typed.
    step: &'static str,
    help: &'static str,
}

const CENTER: Three = Three {
    label: "Centre",
    spoken: "Centre",
    step: "Centre",
    help: "In the axes and the unit of the crash part",
};
const CENTER_MOVE: Three = Three {
    label: "Moved by",
    spoken: "Move of centre since loading,",
    step: "Move by",
    help: "In the axes and the unit of the crash part; t of the matrix is the move of the origin",
};
const ROTATION: Three = Three {
    label: "Rotation",
    spoken: "Rotation since loading,",
    step: "Rotation",
    help: "In degrees, about x, then y, then z of the crash part",
};

/// Above the three columns of numbers: their axes, and what they are in.
fn axes_row_ui(ui: &mut Ui, unit: &str) {
    let units = match unit.trim() {
        "" => "°".to_owned(),
        unit => format!("{unit}, °"),
    };
    form_row(ui, &units, LABEL, |ui| {
        tighten(ui);
        let width = column_width(ui);
        for axis in Axis::ALL {
            let (rect, _) = ui.allocate_exact_size(vec2(width, 16.0), egui::Sense::hover());
            ui.painter().text(
                rect.center(),
                egui::Align2::CENTER_CENTER,
                axis.letter(),
                TextStyle::Small.resolve(ui.style()),
                Palette::of(ui).secondary,
            );
        }
    });
}

/// The width of one of three fields beside each other.
fn column_width(ui: &Ui) -> f32 {
    (ui.available_width() - 8.0) / 3.0
}

/// Three numbers in a row; the axis that was typed at, by how much it changed, and its new value.
fn fields_ui(
    ui: &mut Ui,
    row: &Three,
    values: [f64; 3],
    takes: impl Fn(&str) -> Takes<'_>,
    (unit, most_decimals): (&str, usize),
) -> Option<(Axis, f64, f64)> {
    let speed = 500.0 * 0.1_f64.powi(most_decimals as i32);
    let mut typed = None;
    form_row(ui, row.label, LABEL, |ui| {
        tighten(ui);
        ui.style_mut().drag_value_text_style = TextStyle::Small;
        let width = column_width(ui);
        // As wide while it is typed in.
        ui.spacing_mut().interact_size.x = width;
        for axis in Axis::ALL {
            // What would be shown as −0.000 is nothing.
            let before = values[axis.index()];
            let is_nothing = rounded(before, most_decimals) == 0.0;
            let before = if is_nothing { 0.0 } else { before };
            let mut value = before;
            // Three have no room for their unit.
            let name = format!("{} {}", row.spoken, axis.letter());
            let takes = takes(&name);
            let decimals = fitting_decimals(ui, before, width - 2.0 * PADDING, most_decimals);
            let field = takes
                .bare_field(&mut value)
                .fixed_decimals(decimals)
                .speed(speed)
                .min_size(vec2(width, ROW));
            let response = told_field(ui, &name, before, field, |text| takes.read(text));
            // A field that was only looked into holds the value as it is shown.
            let is_other = value != rounded(before, decimals);
            if response.changed() && is_other {
                typed = Some((axis, value - before, value));
            }
            let value = trimmed(before, 9);
            response.on_hover_text(format!("{name}: {value}{unit}\n{}", row.help));
        }
    });
    typed
}

/// Decimals of lengths in millimetres or inches, and of angles.
const LENGTH_DECIMALS: usize = 3;
/// Lengths in metres, in which no part is as large as this, are told as finely with so many.
const METRES: f64 = 10.0;
const METRE_DECIMALS: usize = 6;

/// Decimals that tell lengths of the stamped part as finely, whatever unit they are in.
fn length_decimals(state: &AppState) -> usize {
    let part = state.document.part(Role::Stamped);
    match part.map(|part| part.bounds().diagonal()) {
        Some(size) if size < METRES => METRE_DECIMALS,
        _ => LENGTH_DECIMALS,
    }
}

/// A number as it is shown with so many decimals.
fn rounded(value: f64, decimals: usize) -> f64 {
    fixed(value, decimals)
        .replace('−', "-")
        .parse()
        .unwrap_or(value)
}

/// The decimals, at most so many, with which a number fits its field.
fn fitting_decimals(ui: &Ui, value: f64, room: f32, most: usize) -> usize {
    let font = TextStyle::Small.resolve(ui.style());
    let fits = |decimals: &usize| {
        let text = fixed(value, *decimals);
        let laid = ui
            .painter()
            .layout_no_wrap(text, font.clone(), Color32::WHITE);
        laid.size().x <= room
    };
    (0..=most).rev().find(fits).unwrap_or(0)
}

/// A field that takes any matrix and says what it understood.
fn paste_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let id = egui::Id::unique("pasted matrix");
    let mut text = crate::ui::widgets::draft(ui, id);
    let field_id = id.with("field");
    // In the field Ctrl+Enter takes the matrix; it does not run the match.
    let is_entered = ui.memory(|memory| memory.has_focus(field_id))
        && ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Enter));
    let field = egui::TextEdit::multiline(&mut text)
        .id(field_id)
        .hint_text("Paste a 4×4 here: rows or columns, commas, tabs, brackets, JSON")
        .desired_rows(2)
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 4))
        .font(egui::TextStyle::Monospace);
    text_field(ui, field).accessible_name("Matrix to paste");
    let read = (!text.trim().is_empty()).then(|| parse_matrix(&text));
    let remark = read.iter().flatten().find_map(ParsedMatrix::remark);
    let understood = match &read {
        None => "moves stamped onto crash".to_owned(),
        Some(Ok(parsed)) => {
            let first = remark.as_deref().unwrap_or("stamped onto crash");
            format!("{first}: {}", parsed.layout.label())
        }
        Some(Err(error)) => format!("⚠ {error}"),
    };
    ui.horizontal(|ui| {
        let can = matches!(read, Some(Ok(_)));
        let set = ui.add_enabled(can, egui::Button::new("Set pose"));
        if set.on_hover_text("Ctrl+Enter").clicked() || (is_entered && can) {
            commands.push(MoveCommand::Paste(std::mem::take(&mut text)).into());
        }
        ui.add_space(UNIT);
        let palette = Palette::of(ui);
        let color = if remark.is_some() {
            palette.check
        } else {
            palette.secondary
        };
        let understood = egui::RichText::new(understood).small().color(color);
        ui.add(egui::Label::new(understood).wrap());
    });
    set_draft(ui, id, text);
}
