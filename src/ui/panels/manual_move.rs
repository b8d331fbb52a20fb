//! Moves by hand: numbers, turn-over, snapping, pasted matrices.

use crate::app::{Action, AppState, Axis, AxisFrame, Command, MoveCommand, ViewCommand};
use crate::geometry::Similarity;
use crate::ui::theme::{ROW, UNIT};
use crate::ui::widgets::{Look, action_button, caption, chip, form_row, plain_action, set_draft};
use egui::{CollapsingHeader, DragValue, Ui, vec2};

/// Width of the label column.
const LABEL: f32 = 56.0;

/// The fold "Move by hand".
pub fn manual_move_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    CollapsingHeader::new("Move by hand")
        .id_salt("move by hand")
        .show_unindented(ui, |ui| {
            let is_free = state.can_move().is_ok();
            ui.add_enabled_ui(is_free, |ui| {
                axes_ui(ui, state, commands);
                steps_ui(ui, state, commands);
                turn_over_ui(ui, state, commands);
                position_ui(ui, state, commands);
                paste_ui(ui, commands);
            });
        });
}

fn axes_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    form_row(ui, "Axes", LABEL, |ui| {
        for frame in AxisFrame::ALL {
            if chip(ui, frame.label(), state.view.move_axes == frame).clicked() {
                commands.push(ViewCommand::SetMoveAxes(frame).into());
            }
        }
        let look = if state.view.has_gizmo {
            Look::On
        } else {
            Look::Plain
        };
        let gizmo = ("Gizmo", look, vec2(0.0, ROW));
        action_button(ui, state, Action::ToggleGizmo, gizmo, commands);
    });
}

/// A typed move along and a typed turn about each axis.
fn steps_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let frame = state.view.move_axes;
    for (name, unit, is_turn) in [("Move", "", false), ("Turn", "°", true)] {
        let id = egui::Id::unique(("typed move", name));
        let mut value: f64 =
            ui.data(|data| data.get_temp(id))
                .unwrap_or(if is_turn { 15.0 } else { 10.0 });
        form_row(ui, name, LABEL, |ui| {
            let field = DragValue::new(&mut value)
                .speed(if is_turn { 1.0 } else { 0.5 })
                .suffix(unit)
                .max_decimals(6)
                .min_size(vec2(80.0, ROW));
            ui.add(field);
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

fn turn_over_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    form_row(ui, "Turn over", LABEL, |ui| {
        for (action, label) in [
            (Action::TurnOverX, "about X"),
            (Action::TurnOverY, "about Y"),
            (Action::TurnOverZ, "about Z"),
        ] {
            let look = (label, Look::Plain, vec2(0.0, ROW));
            action_button(ui, state, action, look, commands);
        }
    });
    ui.horizontal(|ui| {
        let look = ("Centres together", Look::Plain, vec2(0.0, ROW));
        action_button(ui, state, Action::BringCentersTogether, look, commands);
        plain_action(ui, state, Action::ResetPose, commands);
    });
}

/// Where the centre of the part is; typing moves it there.
fn position_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(center) = state.document.stamped_center() else {
        return;
    };
    form_row(ui, "Centre", LABEL, |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for axis in Axis::ALL {
            let before = center[axis.index()];
            let mut value = before;
            let field = DragValue::new(&mut value)
                .max_decimals(3)
                .speed(0.5)
                .update_while_editing(false)
                .min_size(vec2(68.0, ROW));
            let spoken = format!("Centre {}", axis.letter());
            let response = ui.name_inputs(spoken, |ui| ui.add(field));
            if response.changed() && value != before {
                let mut pose: Similarity = *state.document.crash_from_stamped();
                pose.translation[axis.index()] += value - before;
                let name = format!("Centre to {} {value:.3}", axis.letter());
                let crash_from_stamped = pose;
                let command = MoveCommand::SetPose {
                    crash_from_stamped,
                    name,
                };
                commands.push(command.into());
            }
        }
    });
}

/// A field that takes any matrix and says what it understood.
fn paste_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let id = egui::Id::unique("pasted matrix");
    let mut text = crate::ui::widgets::draft(ui, id);
    let field = egui::TextEdit::multiline(&mut text)
        .hint_text("Paste a 4×4 here: rows or columns, commas, tabs, brackets, JSON")
        .desired_rows(2)
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 4))
        .font(egui::TextStyle::Monospace);
    ui.add(field).accessible_name("Matrix to paste");
    ui.horizontal(|ui| {
        let can = !text.trim().is_empty();
        if ui.add_enabled(can, egui::Button::new("Set pose")).clicked() {
            commands.push(MoveCommand::Paste(std::mem::take(&mut text)).into());
        }
        ui.add_space(UNIT);
        caption(ui, "moves stamped onto crash");
    });
    set_draft(ui, id, text);
}
