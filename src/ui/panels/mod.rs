//! The panels of the window and how they share its space.

pub mod bottom;
pub mod drop;
pub mod explain;
pub mod graphics;
pub mod load;
pub mod manual_move;
pub mod mapping;
pub mod matching;
pub mod pairs;
pub mod part_list;
pub mod part_question;
pub mod part_row;
pub mod rail;
pub mod recipe;
pub mod reduce;
pub mod result;
pub mod section;
mod setting_form;
pub mod stamped_files;
mod tolerance;
pub mod top_bar;
pub mod units;

use egui::{Frame, InnerResponse, Margin, Panel, ScrollArea, Sense, Shape, Ui, UiBuilder, vec2};

use super::project_dialogs::restore_ui;
use super::theme::{Palette, UNIT};
use super::viewport::Viewports;
use crate::app::{AppState, ColumnRoom, Command, Settings, ViewCommand};

/// Width of the left column at the first start.
const COLUMN: f32 = 344.0;
/// Height of the bottom pane at the first start: tabs, six lines, footer.
const PANE: f32 = 200.0;
/// Its height in a low window: tabs, three lines, footer.
const LOW_PANE: f32 = 126.0;
/// A window lower than this is low.
const LOW: f32 = 780.0;
/// Least and largest width of the left column, and the share of the window it takes at most.
const COLUMN_RANGE: [f32; 2] = [304.0, 480.0];
const COLUMN_SHARE: f32 = 0.4;
/// In a window smaller than this only the 3D windows, the rail and the menus have room.
const TINY: egui::Vec2 = vec2(480.0, 330.0);

/// The whole window.
pub fn window_ui(
    ui: &mut Ui,
    state: &AppState,
    viewports: &mut Viewports,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(ui);
    // Below all panels.
    let whole = ui.ctx().content_rect();
    ui.painter().add(viewports.fill(whole, palette.panel));
    if state.view.is_graphics_only {
        graphics::graphics_ui(ui, state, viewports, commands);
        return;
    }
    let [column, pane] = state.settings.pane_sizes;
    on_bar(ui, viewports, |ui| {
        Panel::top("top bar")
            .frame(Frame::new().inner_margin(Margin::symmetric(8, 4)))
            .show(ui, |ui| top_bar::top_bar_ui(ui, state, commands))
    });
    restore_ui(ui, state, commands);
    let shown = &*viewports;
    let bottom = |ui: &mut Ui, commands: &mut Vec<Command>| {
        let room = ui.available_height();
        // A name for each of the two, because a panel asks for its size at the first look only.
        let is_low = ui.ctx().content_rect().height() < LOW;
        let (name, size) = match (pane, is_low) {
            (Some(pane), _) => ("bottom pane", pane),
            (None, false) => ("bottom pane", PANE),
            (None, true) => ("low bottom pane", LOW_PANE),
        };
        reset_by_double_click(ui, state, (name, 1), commands);
        let shown = Panel::bottom(name)
            .resizable(true)
            .default_size(size)
            .size_range(100.0..=(0.6 * room).max(120.0))
            .frame(Frame::NONE)
            .show(ui, |ui| bottom::bottom_ui(ui, state, shown, commands));
        shown.response.rect.height()
    };
    let window = ui.ctx().content_rect().size();
    let is_tiny = window.x < TINY.x || window.y < TINY.y;
    let column_room = if COLUMN_SHARE * window.x >= COLUMN_RANGE[0] {
        ColumnRoom::Enough
    } else if is_tiny {
        ColumnRoom::Tiny
    } else {
        ColumnRoom::Narrow
    };
    if column_room != state.view.column_room {
        commands.push(ViewCommand::SetColumnRoom(column_room).into());
    }
    if state.view.is_column_folded() {
        rail::rail_ui(ui, state, commands);
        if !is_tiny {
            bottom(ui, commands);
        }
        graphics::graphics_ui(ui, state, viewports, commands);
        return;
    }
    let mut height = None;
    if state.settings.is_log_wide && !is_tiny {
        height = Some(bottom(ui, commands));
    }
    let [least, most] = COLUMN_RANGE;
    let most = most.min(COLUMN_SHARE * window.x).max(least);
    // A name of its own where the usual width has no room, which it then has again in a wider window.
    let name = if most < column.unwrap_or(COLUMN) {
        "narrow left column"
    } else {
        "left column"
    };
    reset_by_double_click(ui, state, (name, 0), commands);
    let left = Panel::left(name)
        .resizable(true)
        .default_size(column.unwrap_or(COLUMN))
        .size_range(least..=most)
        .frame(Frame::NONE)
        .show(ui, |ui| left_column_ui(ui, state, commands));
    if is_tiny {
        graphics::graphics_ui(ui, state, viewports, commands);
        return;
    }
    let height = height.unwrap_or_else(|| bottom(ui, commands));
    graphics::graphics_ui(ui, state, viewports, commands);
    remember_sizes(ui, state, [left.response.rect.width(), height], commands);
}

/// Shows a bar with its ground behind it.
fn on_bar<R>(
    ui: &mut Ui,
    viewports: &Viewports,
    show: impl FnOnce(&mut Ui) -> InnerResponse<R>,
) -> InnerResponse<R> {
    let behind = ui.painter().add(Shape::Noop);
    let shown = show(ui);
    let ground = viewports.fill(shown.response.rect, Palette::of(ui).bar);
    ui.painter().set(behind, ground);
    shown
}

/// The paper's three sections and the mapping, top to bottom.
fn left_column_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.take_available_space();
    let height = ui.available_height();
    ScrollArea::vertical()
        .id_salt("left column")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            // A child of fixed width: nothing in it may push the edge of the column outwards.
            let room = ui.available_rect_before_wrap();
            let width = room.width();
            let mut column = ui.new_child(UiBuilder::new().max_rect(room));
            column.spacing_mut().item_spacing.y = 0.0;
            section::fold_ui(&column, state, height);
            load::load_ui(&mut column, state, commands);
            reduce::reduce_ui(&mut column, state, commands);
            matching::matching_ui(&mut column, state, commands);
            mapping::mapping_ui(&mut column, state, commands);
            section::drawn_ui(&column, state);
            column.add_space(UNIT);
            let height = column.min_rect().height();
            ui.allocate_exact_size(vec2(width, height), Sense::hover());
        });
}

/// A double click on the edge of a panel gives it its first size again. To be called right before
/// the panel is shown, in the same place.
fn reset_by_double_click(
    ui: &Ui,
    state: &AppState,
    (name, index): (&str, usize),
    commands: &mut Vec<Command>,
) {
    let panel = ui.scope_id().with_salt(egui::IdSalt::new(name));
    // The name egui gives the edge of a panel.
    let edge = ui.ctx().read_response(panel.with("__resize"));
    if edge.is_some_and(|edge| edge.double_clicked()) {
        ui.data_mut(|data| data.remove::<egui::containers::panel::PanelState>(panel));
        let mut settings: Settings = state.settings.clone();
        settings.pane_sizes[index] = None;
        commands.push(Command::Settings(Box::new(settings)));
        ui.ctx().request_repaint();
    }
}

/// Keeps what the user dragged, once the button is up.
fn remember_sizes(ui: &Ui, state: &AppState, sizes: [f32; 2], commands: &mut Vec<Command>) {
    let is_dragging = ui.input(|input| input.pointer.any_down());
    let id = egui::Id::unique("pane sizes");
    let before: Option<[f32; 2]> = ui.data(|data| data.get_temp(id));
    let Some(before) = before else {
        ui.data_mut(|data| data.insert_temp(id, sizes));
        return;
    };
    let has_changed = before
        .iter()
        .zip(sizes)
        .any(|(before, now)| (before - now).abs() > 0.5);
    let was_dragged = ui.input(|input| input.pointer.any_released());
    if has_changed && !is_dragging {
        ui.data_mut(|data| data.insert_temp(id, sizes));
        if was_dragged {
            commands.push(Command::Settings(Box::new(Settings {
                pane_sizes: sizes.map(Some),
                ..state.settings.clone()
            })));
        }
    }
}
