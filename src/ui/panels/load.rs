//! Section 1: files, their parts, how they are shown.

use egui::{Align, Layout, Sense, TextStyle, Ui, vec2};

use super::part_list::part_list_ui;
use super::part_question::part_question_ui;
use super::section::{elided, elided_middle, section_ui};
use super::units;
use crate::app::{
    Action, AppState, BottomTab, ColorBy, Command, Display, FileCommand, Part, PreviewCommand,
    Section, ViewCommand,
};
use crate::jobs::JobKey;
use crate::role::Role;
use crate::text::{counted, tidy_factor};
use crate::ui::focus;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{
    Look, action_button, caption, chip, grouped, icon_button, role_mark, secondary, square, tight,
};

/// Draws section 1.
pub fn load_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let summary = summary(state);
    section_ui(
        ui,
        state,
        Section::Load,
        &summary,
        commands,
        |ui, commands| {
            for role in Role::ALL {
                file_ui(ui, role, state, commands);
                changed_ui(ui, role, state, commands);
            }
            if state.document.has_one_file() {
                let text = "⚠ Both parts are read from one file";
                ui.colored_label(Palette::of(ui).check, text);
            }
            units::unit_question_ui(ui, state, commands);
            part_question_ui(ui, state, commands);
            if state.document.parts.iter().any(|(_, part)| part.is_some()) {
                tools_ui(ui, state, commands);
                part_list_ui(ui, state, commands);
                display_ui(ui, state, commands);
            }
        },
    );
}

fn summary(state: &AppState) -> String {
    let count = |role| {
        let part = state.document.part(role);
        part.map_or_else(|| "–".to_owned(), |p| grouped(p.loaded.report.n_triangles))
    };
    if state.document.parts.iter().all(|(_, part)| part.is_none()) {
        return String::new();
    }
    format!("■ {}  ▲ {}", count(Role::Crash), count(Role::Stamped))
}

/// One file: name, size, diagnostics, open, more.
fn file_ui(ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        role_mark(ui, role);
        match state.document.part(role) {
            Some(part) => loaded_ui(ui, role, part, state, commands),
            None => {
                let action = match role {
                    Role::Crash => Action::OpenCrash,
                    Role::Stamped => Action::OpenStamped,
                };
                if state.jobs.is_active(JobKey::Load(role)) {
                    caption(ui, format!("Loading the {} part…", role.word()));
                } else {
                    let size = vec2(ui.available_width(), ROW);
                    let look = (action.row().label, Look::Plain, size);
                    action_button(ui, state, action, look, commands);
                }
            }
        }
    });
}

/// The file is another one now; what was read stays until the user wants the new content.
fn changed_ui(ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    if !state.has_changed_on_disk(role) {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.colored_label(Palette::of(ui).check, "⚠ Changed on disk");
        let can = state.jobs.is_unlocked().is_ok();
        let reload = ui.add_enabled(can, egui::Button::new("Reload"));
        let name = format!("Reload the {} file", role.word());
        if reload.accessible_name(name).clicked() {
            commands.push(FileCommand::Reload(role).into());
        }
    });
}

fn loaded_ui(ui: &mut Ui, role: Role, part: &Part, state: &AppState, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let name = state.document.name_of(role);
    let has_badge = role == Role::Stamped && state.document.has_pose();
    let badge = if has_badge { ROW + UNIT } else { 0.0 };
    let room = ui.available_width() - ROW - UNIT - badge;
    let (rect, response) = ui.allocate_exact_size(vec2(room, 36.0), Sense::hover());
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let title = elided_middle(ui, &name, body, palette.text, room);
    ui.painter()
        .galley(rect.left_top() + vec2(0.0, 1.0), title, palette.text);
    let detail = elided(
        ui,
        &detail(role, part, state),
        small,
        palette.secondary,
        room,
    );
    ui.painter()
        .galley(rect.left_top() + vec2(0.0, 19.0), detail, palette.secondary);
    let spoken = format!("{} part: {name}", role.word());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &spoken));
    response.on_hover_text(part.loaded.path.display().to_string());
    if has_badge {
        badge_ui(ui, state, commands);
    }
    let label = format!("{} file", role.word());
    let menu = egui::containers::menu::MenuButton::from_button(square("…", ROW));
    let (button, _) = tight(ui, |ui| {
        menu.ui(ui, |ui| file_menu_ui(ui, role, part, state, commands))
    });
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
    button.on_hover_text("Open another, reload, close, diagnostics");
}

/// Says that a pose is applied; a click shows the part as loaded, another one at its pose.
fn badge_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_as_loaded = state.is_as_loaded();
    let response = tight(ui, |ui| ui.add(square("T", ROW).selected(!is_as_loaded)));
    let (name, help) = if is_as_loaded {
        (
            "Show at its pose",
            "Shown as loaded. Click: shown at its pose again",
        )
    } else {
        (
            "Show as loaded",
            "A pose is applied. Click: shown as loaded; the pose stays",
        )
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    if response.on_hover_text(help).clicked() {
        commands.push(PreviewCommand::AsLoaded(!is_as_loaded).into());
    }
}

fn detail(role: Role, part: &Part, state: &AppState) -> String {
    let report = &part.loaded.report;
    let mut text = counted(report.n_triangles, "triangle");
    match state.units_of(role) {
        Some(known) => text += &format!(" · {}", known.units.label()),
        None => text += " · unit unknown",
    }
    // Before what a narrow column may cut off.
    if part.length_factor() != 1.0 {
        text += &format!(" × {}", tidy_factor(part.length_factor()));
    }
    if report.n_parts > 1 {
        text += &format!(
            " · {} of {} parts",
            grouped(part.facts.used.len()),
            grouped(report.n_parts)
        );
    }
    if let Some(thickness) = part.facts.thickness {
        text += &format!(" · t {}", state.lengths_of(role).of(thickness));
    }
    if report.n_diagnostics > 0 {
        text += &format!(" · ⚠ {}", report.n_diagnostics);
    }
    text
}

fn file_menu_ui(
    ui: &mut Ui,
    role: Role,
    part: &Part,
    state: &AppState,
    commands: &mut Vec<Command>,
) {
    ui.set_min_width(184.0);
    let (open, close) = match role {
        Role::Crash => (Action::OpenCrash, Action::CloseCrash),
        Role::Stamped => (Action::OpenStamped, Action::CloseStamped),
    };
    let is_free = open.enabled(state).is_ok();
    if ui
        .add_enabled(is_free, egui::Button::new("Open another…"))
        .clicked()
    {
        commands.extend(open.command(state));
    }
    if ui
        .add_enabled(is_free, egui::Button::new("Reload"))
        .clicked()
    {
        commands.push(FileCommand::Reload(role).into());
    }
    let n_diagnostics = part.loaded.report.n_diagnostics;
    let diagnostics = match n_diagnostics {
        0 => "Diagnostics".to_owned(),
        n => counted(usize::try_from(n).unwrap_or(usize::MAX), "diagnostic"),
    };
    if ui.button(diagnostics).clicked() {
        commands.push(ViewCommand::SetTab(BottomTab::Diagnostics).into());
    }
    ui.add_enabled_ui(is_free, |ui| {
        ui.menu_button("Units", |ui| {
            units::part_units_ui(ui, role, state, commands);
        });
    });
    ui.separator();
    if ui
        .add_enabled(is_free, egui::Button::new("Close"))
        .clicked()
    {
        commands.extend(close.command(state));
    }
}

fn tools_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let swap = ("⇄ Swap", Look::Plain, vec2(72.0, ROW));
        action_button(ui, state, Action::Swap, swap, commands);
        let look = if state.view.are_linked {
            Look::On
        } else {
            Look::Plain
        };
        let link = ("Link views", look, vec2(88.0, ROW));
        action_button(ui, state, Action::ToggleLink, link, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let response = icon_button(ui, "⟳", "Reload both files", true);
            if response.clicked() {
                commands.extend(Action::ReloadAll.command(state));
            }
        });
    });
}

/// Room from which on the choice of colours has its name before it.
const NAMED_COLOUR: f32 = 190.0;

fn display_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut display: Display = state.view.display.clone();
    let size = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().button_padding.x = 7.0;
        let end = RowEnd::new(ui, "display");
        end.before(ui, |ui| {
            // In a narrow column what is chosen is worth more than the word before it.
            if ui.available_width() > NAMED_COLOUR {
                secondary(ui, "Colour");
            }
            ui.name_inputs("Colour by", |ui| {
                let menu = egui::ComboBox::from_id_salt("colour by")
                    .selected_text(state.color_by(Role::Crash).label())
                    .width(ui.available_width())
                    .truncate()
                    // All choices at once: nobody looks for what lies below the edge of a list.
                    .height(ui.ctx().content_rect().height());
                focus::menu(ui, menu, |ui| {
                    ui.spacing_mut().item_spacing.y = 1.0;
                    let mut group = "";
                    for by in ColorBy::ALL {
                        if by.group() != group {
                            group = by.group();
                            caption(ui, group);
                        }
                        color_row(ui, state, &mut display.color_by, by);
                    }
                });
            });
        });
        end.show(ui, |ui| {
            if chip(ui, "Edges", display.has_edges).clicked() {
                display.has_edges ^= true;
            }
            if chip(ui, "Nodes", display.has_points).clicked() {
                display.has_points ^= true;
            }
        });
    });
    if display != state.view.display {
        commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    }
}

/// One row of the colours; greyed with its reason where no loaded part has such results.
fn color_row(ui: &mut Ui, state: &AppState, chosen: &mut ColorBy, by: ColorBy) {
    let reason = state.missing_for(by);
    let row = egui::Button::selectable(*chosen == by, by.label());
    let response = ui.add_enabled(reason.is_none(), row);
    let response = focus::chosen(ui, *chosen == by, response);
    let response = match reason {
        Some(reason) => response.on_disabled_hover_text(reason),
        None => response,
    };
    if response.clicked() {
        *chosen = by;
    }
}
