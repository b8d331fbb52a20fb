//! Menus, search, unit, bell.

use egui::containers::menu::MenuState;
use egui::{
    Button, Event, Id, Key, MenuBar, Modifiers, Popup, Response, RichText, ScrollArea, Sense, Ui,
    pos2, vec2,
};

use super::rail::fold_ui;
use super::units::window_unit_ui;
use crate::app::{
    Action, ActionRow, AppState, Command, CopyForm, Dialog, ExportCommand, Menu, MenuGroup, Reason,
    ViewCommand,
};
use crate::pipeline::outputs::{MeshOutput, Output};
use crate::pipeline::project::is_project;
use crate::report::{CardForm, MatrixForm};
use crate::role::Role;
use crate::ui::focus;
use crate::ui::project_dialogs::recovered_menu_ui;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{caption, focus_ring};

/// The bar at the top.
pub fn top_bar_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        fold_ui(ui, state, commands);
        let room = ui.available_width();
        if room < NARROW {
            // One menu of menus.
            let all = ui.menu_button("☰ Menu", |ui| {
                menus_ui(ui, state, 0.0, commands);
            });
            turn_by_keys(ui, &[all.response]);
        } else {
            let bottom = ui.max_rect().bottom();
            let menus = menus_ui(ui, state, bottom, commands);
            turn_by_keys(ui, &menus);
        }
        let has_unit = room >= MEDIUM;
        let is_search_wide = ui.available_width() > if has_unit { WIDE } else { WIDE - UNIT };
        RowEnd::new(ui, "top bar").show(ui, |ui| {
            search_ui(ui, is_search_wide, commands);
            if has_unit {
                window_unit_ui(ui, state);
            }
            bell_ui(ui, state, commands);
        });
    });
}

/// Air between a menu and what it hangs from, and below it.
const MENU_GAP: f32 = 6.0;
/// Room below which the menus are one, and below which the unit is left out.
const NARROW: f32 = 480.0;
const MEDIUM: f32 = 560.0;
/// Room beside the menus from which on the search shows its key, and what of it the unit takes.
const WIDE: f32 = 370.0;
const UNIT: f32 = 104.0;

/// The menus, each of which opens below `top` or, where it has no bar, anywhere in the window.
fn menus_ui(ui: &mut Ui, state: &AppState, top: f32, commands: &mut Vec<Command>) -> Vec<Response> {
    let mut titles = Vec::new();
    for menu in Menu::ALL {
        let shown = ui.menu_button(menu.label(), |ui| {
            scrolling(ui, top, |ui| menu_ui(ui, state, menu, commands));
        });
        titles.push(shown.response);
    }
    titles
}

/// The items of a menu, which scroll where the window below `top` is lower than they are.
fn scrolling(ui: &mut Ui, top: f32, items: impl FnOnce(&mut Ui)) {
    let frame = ui.spacing().menu_margin.sum().y + 2.0 * MENU_GAP;
    let room = ui.ctx().content_rect().bottom() - top - frame;
    let mut area = ScrollArea::vertical().max_height(room);
    if focus::is_just_opened(ui, ui.scope_id().with("scrolled")) {
        area = area.vertical_scroll_offset(0.0);
    }
    area.show(ui, |ui| {
        ui.set_min_width(248.0);
        items(ui);
    });
}

/// What the keyboard comes to is seen.
fn keep_in_sight(item: &Response) {
    if item.gained_focus() {
        item.scroll_to_me(None);
    }
}

/// F10 or Alt opens the first menu or closes the open one; Left and Right go from one open menu to the next, unless
/// they enter or leave a menu in it.
fn turn_by_keys(ui: &Ui, titles: &[Response]) {
    let ctx = ui.ctx();
    for title in titles {
        focus_ring(ui, title.rect, title);
    }
    let ids: Vec<Id> = titles.iter().map(Popup::default_response_id).collect();
    let open = ids.iter().position(|id| Popup::is_id_open(ctx, *id));
    let is_other_open = open.is_none() && Popup::is_any_open(ctx);
    let is_pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let is_wanted = was_alt_alone(ui) || is_pressed(Key::F10);
    let is_in_submenu = open.is_some_and(|at| !MenuState::is_deepest_open_sub_menu(ctx, ids[at]));
    let next = match open {
        _ if is_other_open => None,
        None => is_wanted.then_some(0),
        Some(at) if is_wanted => {
            Popup::close_id(ctx, ids[at]);
            None
        }
        Some(_) if is_in_submenu => None,
        Some(at) if is_pressed(Key::ArrowRight) => Some((at + 1) % ids.len()),
        Some(at) if is_pressed(Key::ArrowLeft) => Some((at + ids.len() - 1) % ids.len()),
        Some(_) => None,
    };
    if let Some(next) = next {
        Popup::open_id(ctx, ids[next]);
        titles[next].request_focus();
    }
}

/// True when Alt is let go after it was pressed with nothing else: no key, no click, no other window.
fn was_alt_alone(ui: &Ui) -> bool {
    let id = Id::unique("alt alone");
    let mut is_alone: bool = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut is_let_go = false;
    ui.input(|input| {
        for event in &input.events {
            match event {
                Event::Key {
                    key: Key::AltLeft,
                    pressed,
                    ..
                } => {
                    is_let_go |= is_alone && !pressed;
                    is_alone = *pressed && !input.pointer.any_down();
                }
                Event::Key { .. }
                | Event::Text(_)
                | Event::PointerButton { .. }
                | Event::MouseWheel { .. }
                | Event::WindowFocused(_) => is_alone = false,
                _ => {}
            }
        }
    });
    ui.data_mut(|data| data.insert_temp(id, is_alone));
    // There it writes other letters.
    is_let_go && !ui.ctx().os().is_mac()
}

/// The items of a menu; the table of actions says which.
fn menu_ui(ui: &mut Ui, state: &AppState, menu: Menu, commands: &mut Vec<Command>) {
    let mut before: Option<&MenuGroup> = None;
    for group in menu.groups() {
        // Submenus stand together; a line sets off every other group.
        let are_submenus = |before: &MenuGroup| before.submenu.and(group.submenu).is_some();
        if before.is_some_and(|before| !are_submenus(before)) {
            ui.separator();
        }
        before = Some(group);
        let items = |ui: &mut Ui, commands: &mut Vec<Command>| {
            for row in group.rows {
                item_ui(ui, state, row, commands);
            }
        };
        match group.submenu {
            Some(name) => {
                let opener = ui.menu_button(name, |ui| {
                    scrolling(ui, 0.0, |ui| items(ui, commands));
                });
                keep_in_sight(&opener.response);
            }
            None => items(ui, commands),
        }
        // Below what opens other files.
        let is_open = group.rows.iter().any(|row| row.action == Action::OpenCrash);
        if is_open && !state.settings.recent.is_empty() {
            recent_ui(ui, state, commands);
        }
        if is_open && !state.project.sessions.is_empty() {
            recovered_menu_ui(ui, state, commands);
        }
    }
    if menu == Menu::Export {
        ui.separator();
        export_forms_ui(ui, state, commands);
    }
}

fn item_ui(ui: &mut Ui, state: &AppState, row: &ActionRow, commands: &mut Vec<Command>) {
    let action = row.action;
    let enabled = action.enabled(state);
    let label = match (action, state.history.undo_name(), state.history.redo_name()) {
        (Action::Undo, Some(name), _) => format!("Undo “{name}”"),
        (Action::Redo, _, Some(name)) => format!("Redo “{name}”"),
        _ => row.label.to_owned(),
    };
    let is_on = action.is_on(state);
    let mut button = match is_on {
        Some(true) => Button::new(format!("{label}  ✔")),
        _ => Button::new(label.as_str()),
    };
    let mut name = label;
    if let Some(shortcut) = row.shortcut() {
        button = button.shortcut_text(shortcut.to_string());
        name += &format!(" {shortcut}");
    }
    let is_enabled = enabled.is_ok();
    let response = ui.add_enabled(is_enabled, button);
    keep_in_sight(&response);
    if let Some(is_on) = is_on {
        // The tick is no part of the name.
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::Button, is_enabled, is_on, &name)
        });
    }
    let response = match enabled {
        Ok(()) => response.on_hover_text(row.tooltip),
        Err(reason) => response.on_disabled_hover_text(format!("{}\n{reason}", row.tooltip)),
    };
    if response.clicked() {
        commands.extend(action.command(state));
        ui.close();
    }
}

/// Every form of matrix, card and mesh.
fn export_forms_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let opener = ui.menu_button("Copy as", |ui| copy_forms_ui(ui, state, commands));
    keep_in_sight(&opener.response);
    let matrices = MatrixForm::ALL
        .iter()
        .map(|form| (form.label(), Output::Matrix(*form)));
    let enabled = Action::SaveMatrix.enabled(state);
    save_menu(ui, "Save matrix as", enabled, matrices, commands);
    let cards = CardForm::ALL
        .iter()
        .map(|form| (form.label(), Output::Cards(*form)));
    let enabled = Action::SaveCards.enabled(state);
    save_menu(ui, "Save cards as", enabled, cards, commands);
    let meshes = MeshOutput::ALL
        .into_iter()
        .filter(|mesh| state.document.can_write(Output::Mesh(*mesh)))
        .map(|mesh| (mesh.label(), Output::Mesh(mesh)));
    let enabled = state.document.has_any_part();
    save_menu(ui, "Save part as", enabled, meshes, commands);
}

/// What can be put on the clipboard; what needs a match waits for one.
pub fn copy_forms_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    for form in CopyForm::all() {
        let enabled = form.enabled(state);
        let button = ui.add_enabled(enabled.is_ok(), Button::new(form.label()));
        let button = match enabled {
            Ok(()) => button,
            Err(reason) => button.on_disabled_hover_text(reason.0),
        };
        if button.clicked() {
            commands.push(ExportCommand::Copy(form).into());
            ui.close();
        }
    }
}

/// A menu of things to write.
fn save_menu(
    ui: &mut Ui,
    name: &str,
    enabled: Result<(), Reason>,
    items: impl Iterator<Item = (&'static str, Output)>,
    commands: &mut Vec<Command>,
) {
    ui.add_enabled_ui(enabled.is_ok(), |ui| {
        let menu = ui.menu_button(name, |ui| {
            for (label, kind) in items {
                if ui.button(label).clicked() {
                    commands.push(ExportCommand::AskSave(kind).into());
                    ui.close();
                }
            }
        });
        keep_in_sight(&menu.response);
        if let Err(reason) = enabled {
            menu.response.on_disabled_hover_text(reason.0);
        }
    });
}

fn recent_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    use crate::app::FileCommand;
    let opener = ui.menu_button("Recent files", |ui| {
        for path in &state.settings.recent {
            let name = state.settings.recent_name(path);
            if is_project(path) {
                let open = ui.button(name);
                if open.on_hover_text(path.display().to_string()).clicked() {
                    let (paths, role) = (vec![path.clone()], None);
                    commands.push(FileCommand::Open { paths, role }.into());
                    ui.close();
                }
                continue;
            }
            let name = match state.settings.opened_as.get(path) {
                Some(role) => format!("{} {name}", role.mark()),
                None => name,
            };
            ui.menu_button(name, |ui| {
                caption(ui, path.display().to_string());
                for role in Role::ALL {
                    let label = format!("Open as the {} part", role.word());
                    if ui.button(label).clicked() {
                        let (paths, role) = (vec![path.clone()], Some(role));
                        commands.push(FileCommand::Open { paths, role }.into());
                        ui.close();
                    }
                }
                if ui.button("Remove from the list").clicked() {
                    commands.push(FileCommand::ForgetRecent(path.clone()).into());
                    ui.close();
                }
            });
        }
    });
    keep_in_sight(&opener.response);
}

fn bell_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let n_unread = state.log.notices.n_unread();
    let palette = Palette::of(ui);
    let color = if n_unread > 0 {
        palette.check
    } else {
        palette.secondary
    };
    let name = match n_unread {
        0 => "Messages".to_owned(),
        n => format!("Messages, {n} unread"),
    };
    let width = if n_unread > 0 { 40.0 } else { ROW };
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click());
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, palette.hovered);
    }
    focus_ring(ui, rect, &response);
    let at = pos2(rect.left() + ROW / 2.0, rect.center().y);
    paint_bell(ui.painter(), at, color);
    if n_unread > 0 {
        let font = egui::TextStyle::Small.resolve(ui.style());
        let place = pos2(rect.right() - 6.0, rect.center().y);
        let text = n_unread.to_string();
        ui.painter()
            .text(place, egui::Align2::RIGHT_CENTER, text, font, color);
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.on_hover_text(&name).clicked() {
        commands.push(ViewCommand::SetDialog(Some(Dialog::Messages)).into());
    }
}

/// A bell: dome, rim, clapper.
fn paint_bell(painter: &egui::Painter, at: egui::Pos2, color: egui::Color32) {
    let outline = [
        (-6.0, 3.5),
        (-4.5, 1.5),
        (-4.5, -1.5),
        (-3.0, -4.5),
        (0.0, -6.0),
        (3.0, -4.5),
        (4.5, -1.5),
        (4.5, 1.5),
        (6.0, 3.5),
    ];
    let points = outline.map(|(x, y)| at + vec2(x, y)).to_vec();
    let stroke = egui::Stroke::new(1.3, color);
    painter.add(egui::Shape::closed_line(points, stroke));
    painter.circle_filled(at + vec2(0.0, 5.6), 1.6, color);
}

fn search_ui(ui: &mut Ui, is_wide: bool, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    ui.spacing_mut().button_padding.x = 8.0;
    let text = if is_wide { "Search commands" } else { "Search" };
    let mut button = Button::new(RichText::new(text).color(palette.secondary))
        .fill(palette.panel)
        .stroke(egui::Stroke::new(1.0, palette.line))
        .frame_when_inactive(true)
        .min_size(vec2(if is_wide { 208.0 } else { 0.0 }, ROW));
    if is_wide {
        button = button.shortcut_text("Ctrl+K");
    }
    let response = ui.add(button).on_hover_text("Search commands   Ctrl+K");
    // Its own border takes the place of the one that a button has while the keyboard is at it.
    focus_ring(ui, response.rect, &response);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Search commands"));
    if response.clicked() {
        commands.push(ViewCommand::SetDialog(Some(Dialog::Palette)).into());
    }
}
