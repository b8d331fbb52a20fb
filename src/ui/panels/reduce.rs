//! Section 2: fewer triangles, at any level, with the full mesh kept.

use super::section::section_ui;
use crate::app::{
    Action, AppState, ColorBy, Command, Part, ReduceCommand, Section, Settings, ViewCommand,
};
use crate::jobs::{JobKey, PerRole, Role};
use crate::ui::theme::{LABEL, ROW, UNIT};
use crate::ui::widgets::{
    Look, action_button, caption, chip, form_row, grouped, icon_button, length, paragraph,
    role_mark, short_count,
};
use egui::{DragValue, Slider, Ui, vec2};

/// The section.
pub fn reduce_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let summary = summary(state);
    section_ui(
        ui,
        state,
        Section::Reduce,
        &summary,
        commands,
        |ui, commands| {
            if state.document.parts.iter().all(|(_, part)| part.is_none()) {
                paragraph(ui, "Not now: load a part first.");
                return;
            }
            ceiling_ui(ui, state, commands);
            strip_ui(ui, state, commands);
            for role in Role::ALL {
                if let Some(part) = state.document.part(role) {
                    achieved_ui(ui, role, part, state);
                }
            }
            views_ui(ui, state, commands);
        },
    );
}

fn summary(state: &AppState) -> String {
    let level = |role: Role| {
        let part = state.document.part(role)?;
        let text = match &part.level {
            Some(level) => grouped(level.level.mesh.n_triangles()),
            None => "full".to_owned(),
        };
        Some(format!("{} {text}", role.mark()))
    };
    let levels: Vec<String> = Role::ALL.into_iter().filter_map(level).collect();
    if levels.is_empty() {
        String::new()
    } else {
        levels.join("  ")
    }
}

/// The maximum, what it is for, and the button.
fn ceiling_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut settings: Settings = state.settings.clone();
    let mut is_entered = false;
    form_row(ui, "Max triangles", LABEL, |ui| {
        let field = DragValue::new(&mut settings.max_triangles)
            .range(4..=50_000_000)
            .speed(20.0)
            .update_while_editing(false)
            .custom_formatter(|n, _| grouped(n as usize))
            .custom_parser(|text| {
                let digits: String = text.chars().filter(char::is_ascii_digit).collect();
                digits.parse().ok()
            })
            .min_size(vec2(98.0, ROW));
        let field = ui.add(field);
        ui.spacing_mut().button_padding.x = 8.0;
        is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let roles = settings.reduce_roles;
        for (label, name, chosen) in [
            ("■", "Reduce the crash part", [true, false]),
            ("▲", "Reduce the stamped part", [false, true]),
            ("both", "Reduce both parts", [true, true]),
        ] {
            let [crash, stamped] = chosen;
            let is_on = roles == PerRole { crash, stamped };
            let response = chip(ui, label, is_on);
            response
                .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_on, name));
            if response.on_hover_text(name).clicked() {
                settings.reduce_roles = PerRole { crash, stamped };
            }
        }
    });
    let roles = settings.reduce_roles;
    let max_triangles = settings.max_triangles;
    if settings != state.settings {
        commands.push(Command::Settings(Box::new(settings)));
    }
    ui.horizontal(|ui| {
        let is_busy = Role::ALL
            .into_iter()
            .any(|r| state.jobs.is_active(JobKey::Reduce(r)));
        let label = if is_busy { "Reducing…" } else { "Reduce" };
        let width = ui.available_width() - 2.0 * (ROW + UNIT);
        let size = vec2(width, ROW + 4.0);
        let look = (label, Look::Plain, size);
        let clicked = action_button(ui, state, Action::Reduce, look, &mut Vec::new()).clicked();
        if (clicked || is_entered) && state.can_reduce().is_ok() {
            let command = ReduceCommand::To {
                roles,
                max_triangles,
            };
            commands.push(command.into());
        }
        for (sign, action) in [("−", Action::NextLevel), ("+", Action::PreviousLevel)] {
            let enabled = action.enabled(state).is_ok();
            let name = format!("{}   {}", action.info().label, keys(action));
            if icon_button(ui, sign, &name, enabled).clicked() {
                commands.extend(action.to_commands(state));
            }
        }
    });
}

fn keys(action: Action) -> String {
    let shortcut = action.info().shortcut;
    shortcut.map_or_else(String::new, |s| s.to_string())
}

/// The marked levels as chips, and every level between them on a slider.
fn strip_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let roles = state.settings.reduce_roles;
    let ticked = Role::ALL.into_iter().filter(|role| *roles.get(*role));
    let parts: Vec<&Part> = ticked
        .filter_map(|role| state.document.part(role))
        .collect();
    let Some(n_full) = parts.iter().map(|p| p.loaded.report.n_triangles).max() else {
        return;
    };
    let wanted = parts.iter().find_map(|part| part.wanted_level);
    let is_free = state.can_reduce().is_ok();
    ui.add_enabled_ui(is_free, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            ui.spacing_mut().button_padding.x = 7.0;
            if chip(ui, "full", wanted.is_none()).clicked() {
                commands.push(ReduceCommand::Full(roles).into());
            }
            let marks = state.settings.marked_levels.iter().filter(|n| **n < n_full);
            for &max_triangles in marks {
                let is_on = wanted == Some(max_triangles);
                if chip(ui, &short_count(max_triangles), is_on).clicked() {
                    let command = ReduceCommand::To {
                        roles,
                        max_triangles,
                    };
                    commands.push(command.into());
                }
            }
        });
        let least = 200.min(n_full);
        let mut n = wanted.unwrap_or(n_full).clamp(least, n_full);
        ui.spacing_mut().slider_width = ui.available_width();
        let slider = Slider::new(&mut n, least..=n_full)
            .logarithmic(true)
            .show_value(false);
        let slider = ui.add(slider).accessible_name("Level of reduction");
        if slider.changed() && Some(n) != wanted {
            commands.push(if n >= n_full {
                ReduceCommand::Full(roles).into()
            } else {
                let max_triangles = n;
                ReduceCommand::To {
                    roles,
                    max_triangles,
                }
                .into()
            });
        }
    });
}

/// What one part got and how far it is from the full mesh.
fn achieved_ui(ui: &mut Ui, role: Role, part: &Part, state: &AppState) {
    ui.spacing_mut().interact_size.y = 18.0;
    ui.horizontal(|ui| {
        role_mark(ui, role);
        let Some(level) = &part.level else {
            let n = part.loaded.report.n_triangles;
            let text = if part.wanted_level.is_some() {
                "⚠ out of date: reduce again".to_owned()
            } else {
                format!("{} triangles, full", grouped(n))
            };
            ui.label(text);
            return;
        };
        let n = level.level.mesh.n_triangles();
        ui.label(format!(
            "{} of at most {}",
            grouped(n),
            grouped(level.max_triangles)
        ));
    });
    let Some(level) = &part.level else { return };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 0.0);
        ui.add_space(12.0 + UNIT);
        match level.deviation.get() {
            Some(d) => {
                let text = format!(
                    "rms {} · max {} · border {}",
                    length(d.rms),
                    length(d.max),
                    length(d.border_max)
                );
                caption(ui, text).on_hover_text(
                    "Distance between the reduced and the full mesh, measured both ways",
                );
                if d.loops_after != d.loops_before {
                    let lost = d.loops_before.abs_diff(d.loops_after);
                    caption(ui, format!("⚠ {lost} holes closed"));
                }
            }
            None if state.jobs.is_active(JobKey::MeasureLevel(role)) => {
                caption(ui, "measuring the distance to the full mesh…");
            }
            None => {}
        }
        let report = &level.level.report;
        if report.triangles_after > level.max_triangles {
            caption(ui, format!("⚠ {}", report.stop_reason));
        }
        let row = state
            .log
            .rows()
            .iter()
            .rev()
            .find(|r| r.step == "reduce" && r.role == Some(role));
        if let Some(took) = row.and_then(|row| row.took) {
            caption(ui, format!("· {}", crate::app::duration_text(took)));
        }
    });
}

fn views_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let is_error = state.view.display.color_by == ColorBy::ReductionError;
        let can = Action::ReduceToFull.enabled(state).is_ok() || is_error;
        let response = ui
            .add_enabled_ui(can, |ui| chip(ui, "Error colours", is_error))
            .inner;
        if response
            .on_hover_text("Colour by the distance to the full mesh")
            .clicked()
        {
            let mut display = state.view.display.clone();
            display.color_by = if is_error {
                ColorBy::Role
            } else {
                ColorBy::ReductionError
            };
            commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
        }
        let look = if state.view.display.split.is_some() {
            Look::On
        } else {
            Look::Plain
        };
        let split = ("Split view", look, vec2(0.0, ROW));
        action_button(ui, state, Action::ToggleSplit, split, commands);
        caption(ui, format!("hold {} for full", keys(Action::Blink)));
    });
}
