//! Section 2: fewer triangles, at any level, with the full mesh kept.

use std::ops::RangeInclusive;

use egui::{Response, Slider, Ui, vec2};

use super::section::section_ui;
use crate::app::{
    Action, AppState, ColorBy, Command, LevelResult, LogStep, Part, ReduceCommand, Section,
    Settings, ViewCommand, duration_text,
};
use crate::jobs::{JobKey, MeasuredLevel};
use crate::role::{PerRole, Role};
use crate::text::counted;
use crate::ui::theme::{LABEL, Palette, ROW, UNIT};
use crate::ui::typed::{Takes, is_refused, told_field};
use crate::ui::widgets::{
    Look, action_button, caption, chip, focus_ring, form_row, grouped, icon_button, paragraph,
    role_mark, short_count, square, tight,
};

/// Draws section 2.
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
                paragraph(ui, "Load a part first.");
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

/// Room for the choice of parts beside the maximum.
const CHOICE: f32 = 128.0;

/// What a maximum may be.
const MAX_TRIANGLES: RangeInclusive<usize> = 4..=50_000_000;

/// The maximum, what it is for, and the button.
fn ceiling_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut settings: Settings = state.settings.clone();
    let mut is_entered = false;
    form_row(ui, "Max triangles", LABEL, |ui| {
        let takes = Takes::count("Max triangles", MAX_TRIANGLES);
        let before = settings.max_triangles as f64;
        let field = takes
            .field(&mut settings.max_triangles)
            .speed(20.0)
            .custom_formatter(|n, _| grouped(n as usize))
            .min_size(vec2((ui.available_width() - CHOICE).clamp(56.0, 98.0), ROW));
        let field = told_field(ui, "Max triangles", before, field, |text| takes.read(text));
        ui.spacing_mut().button_padding.x = 8.0;
        let is_left = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        is_entered = is_left && !is_refused(ui, &field);
        let roles = settings.reduce_roles;
        for (label, name, chosen) in [
            ("■", "Reduce the crash part", PerRole::new(true, false)),
            ("▲", "Reduce the stamped part", PerRole::new(false, true)),
            ("both", "Reduce both parts", PerRole::both(true)),
        ] {
            let is_on = roles == chosen;
            let response = chip(ui, label, is_on);
            response
                .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_on, name));
            if response.on_hover_text(name).clicked() {
                settings.reduce_roles = chosen;
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
            let name = format!("{}   {}", action.row().label, keys(action));
            if icon_button(ui, sign, &name, enabled).clicked() {
                commands.extend(action.command(state));
            }
        }
    });
}

fn keys(action: Action) -> String {
    let shortcut = action.row().shortcut();
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
            // So narrow that all usual levels and their menu have one row.
            ui.spacing_mut().item_spacing = vec2(3.0, 4.0);
            ui.spacing_mut().button_padding.x = 5.0;
            let full = chip(ui, "full", wanted.is_none());
            if with_result(ui, full, state, None).clicked() {
                commands.push(ReduceCommand::Full(roles).into());
            }
            for max_triangles in state.reachable_levels() {
                let is_on = wanted == Some(max_triangles);
                let response = chip(ui, &short_count(max_triangles), is_on);
                let response = with_result(ui, response, state, Some(max_triangles));
                if response.clicked() {
                    let command = ReduceCommand::To {
                        roles,
                        max_triangles,
                    };
                    commands.push(command.into());
                }
            }
            marks_menu(ui, state, commands);
        });
        result_ui(ui, state, wanted);
        let least = 200.min(n_full);
        if least == n_full {
            return;
        }
        let mut n = wanted.unwrap_or(n_full).clamp(least, n_full);
        ui.spacing_mut().slider_width = ui.available_width();
        let slider = Slider::new(&mut n, least..=n_full)
            .logarithmic(true)
            .show_value(false);
        let slider = ui.add(slider).accessible_name("Level of reduction");
        focus_ring(ui, slider.rect, &slider);
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

/// A dot on a chip whose level was matched, with what came out.
fn with_result(ui: &Ui, chip: Response, state: &AppState, level: Option<usize>) -> Response {
    let Some(result) = state.level_result(level) else {
        return chip;
    };
    let at = chip.rect.right_top() + vec2(-4.0, 4.0);
    ui.painter().circle_filled(at, 2.0, Palette::of(ui).good);
    chip.on_hover_text(format!("Match: {}", result_text(state, result, true)))
}

/// "RMS 0.439 mm · 741 ms · 0.02 mm from full".
fn result_text(state: &AppState, result: &LevelResult, has_rms: bool) -> String {
    let mut parts = Vec::new();
    if let Some(rmse) = result.rmse.filter(|_| has_rms) {
        parts.push(format!("RMS {}", state.lengths().of(rmse)));
    }
    parts.push(duration_text(result.took));
    if result.max_triangles.is_some()
        && let Some(far) = state.distance_to_full(result)
    {
        parts.push(format!("pose {} from full", state.lengths().of(far)));
    }
    parts.join(" · ")
}

/// The result at the level that is shown, in words.
fn result_ui(ui: &mut Ui, state: &AppState, level: Option<usize>) {
    if let Some(result) = state.level_result(level) {
        let of = level.map_or_else(|| "full".to_owned(), short_count);
        // The card of the result says its own.
        let is_told = state.document.current_result().is_some_and(|told| {
            let pose = &told.run.crash_from_stamped;
            told.alternative.is_none() && *pose == result.crash_from_stamped
        });
        let text = format!("match at {of}: {}", result_text(state, result, !is_told));
        let color = Palette::of(ui).secondary;
        let text = egui::RichText::new(text).small().color(color);
        ui.add(egui::Label::new(text).truncate());
    }
}

/// Adds what stands in the field to the marked levels, or takes levels away.
fn marks_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut settings: Settings = state.settings.clone();
    let menu = egui::containers::menu::MenuButton::from_button(square("…", ROW));
    let (button, _) = tight(ui, |ui| {
        menu.ui(ui, |ui| {
            ui.set_min_width(168.0);
            let n = settings.max_triangles;
            let is_new = !settings.marked_levels.contains(&n);
            let add = egui::Button::new(format!("Add {}", grouped(n)));
            if ui.add_enabled(is_new, add).clicked() {
                settings.marked_levels.push(n);
                ui.close();
            }
            ui.separator();
            for n in settings.marked_levels.clone() {
                if ui.button(format!("Remove {}", grouped(n))).clicked() {
                    settings.marked_levels.retain(|known| *known != n);
                    ui.close();
                }
            }
            ui.separator();
            if ui.button("Reset to defaults").clicked() {
                settings.marked_levels = Settings::default().marked_levels;
                ui.close();
            }
        })
    });
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Marked levels"));
    button.on_hover_text("Add or remove levels");
    if settings != state.settings {
        commands.push(Command::Settings(Box::new(settings)));
    }
}

/// What one part got and how far it is from the full mesh.
fn achieved_ui(ui: &mut Ui, role: Role, part: &Part, state: &AppState) {
    ui.spacing_mut().interact_size.y = 18.0;
    ui.horizontal(|ui| {
        role_mark(ui, role);
        ui.label(achieved(part));
    });
    let Some(level) = &part.level else { return };
    let mut lines = vec![error_text(role, level, state)];
    let report = &level.level.report;
    if report.triangles_after > level.max_triangles {
        lines.push(format!("⚠ {}", report.stop_reason));
    }
    if let Some(d) = level
        .deviation
        .get()
        .filter(|d| d.loops_after != d.loops_before)
    {
        let lost = d.loops_before.abs_diff(d.loops_after);
        lines.push(format!("⚠ {} closed", counted(lost, "hole")));
    }
    lines.extend(flipped_text(level.level.n_flipped));
    for text in lines.into_iter().filter(|text| !text.is_empty()) {
        ui.horizontal(|ui| {
            ui.add_space(12.0 + UNIT);
            let color = Palette::of(ui).secondary;
            let text = egui::RichText::new(text).small().color(color);
            ui.add(egui::Label::new(text).wrap())
                .on_hover_text("Distance between the reduced and the full mesh, both ways");
        });
    }
}

/// "1,999 triangles (max 2,000)".
fn achieved(part: &Part) -> String {
    match &part.level {
        Some(level) => format!(
            "{} (max {})",
            counted(level.level.mesh.n_triangles(), "triangle"),
            grouped(level.max_triangles)
        ),
        None if part.wanted_level.is_some() => "⚠ out of date: reduce again".to_owned(),
        None => format!(
            "{}, full",
            counted(part.loaded.report.n_triangles, "triangle")
        ),
    }
}

/// What is said about triangles that face the other way; nothing where there are none.
fn flipped_text(n_flipped: usize) -> Option<String> {
    let n = counted(n_flipped, "triangle");
    (n_flipped > 0).then(|| format!("⚠ {n} turned over by the reduction"))
}

/// "RMS 0.061 · max 0.72 · border 0.42 mm · 28 ms".
fn error_text(role: Role, level: &MeasuredLevel, state: &AppState) -> String {
    let mut text = match level.deviation.get() {
        Some(d) => unbroken(&format!(
            "RMS {} · max {} · border {}",
            state.lengths().number(d.rms),
            state.lengths().number(d.max),
            state.lengths().of(d.border_max)
        )),
        None if state.jobs.is_active(JobKey::MeasureLevel(role)) => {
            "measuring the distance to the full mesh…".to_owned()
        }
        None => return String::new(),
    };
    let rows = state.log.rows().iter().rev();
    let mut reductions = rows.filter(|r| r.step == LogStep::Reduce && r.role == Some(role));
    if let Some(took) = reductions.next().and_then(|row| row.took) {
        text += &format!(" · {}", unbroken(&duration_text(took)));
    }
    text
}

/// Figures that lines break between, not before a unit.
fn unbroken(figures: &str) -> String {
    figures.replace(' ', "\u{a0}").replace("·\u{a0}", "· ")
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
