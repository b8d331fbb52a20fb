//! The panels of the window and how they share its space.

pub mod bottom;
pub mod graphics;
pub mod load;
pub mod manual_move;
pub mod matching;
pub mod part_filter;
pub mod part_list;
pub mod recipe;
pub mod reduce;
pub mod result;
pub mod section;
pub mod top_bar;
pub mod units;

use super::theme::{Palette, UNIT};
use super::viewport::Viewports;
use crate::app::{AppState, Command, Settings};
use egui::{Frame, Margin, Panel, ScrollArea, Sense, Ui, UiBuilder, vec2};

/// Width of the left column at the first start.
const COLUMN: f32 = 344.0;
/// Height of the bottom pane at the first start.
const PANE: f32 = 200.0;

/// The whole window.
pub fn window_ui(
    ui: &mut Ui,
    state: &AppState,
    viewports: &mut Viewports,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(ui);
    if state.view.is_graphics_only {
        graphics::graphics_ui(ui, state, viewports, commands);
        return;
    }
    let [column, pane] = state.settings.pane_sizes;
    let bar = Frame::new()
        .fill(palette.bar)
        .inner_margin(Margin::symmetric(8, 4));
    Panel::top("top bar")
        .frame(bar)
        .show(ui, |ui| top_bar::top_bar_ui(ui, state, commands));
    let bottom = |ui: &mut Ui, commands: &mut Vec<Command>| {
        let room = ui.available_height();
        let shown = Panel::bottom("bottom pane")
            .resizable(true)
            .default_size(pane.unwrap_or(PANE.min(0.28 * room)))
            .size_range(96.0..=(0.6 * room).max(120.0))
            .frame(Frame::new().fill(palette.panel).inner_margin(Margin::ZERO))
            .show(ui, |ui| bottom::bottom_ui(ui, state, commands));
        shown.response.rect.height()
    };
    let mut height = None;
    if state.settings.is_log_wide {
        height = Some(bottom(ui, commands));
    }
    let left = Panel::left("left column")
        .resizable(true)
        .default_size(column.unwrap_or(COLUMN))
        .size_range(304.0..=480.0)
        .frame(Frame::new().fill(palette.panel).inner_margin(Margin::ZERO))
        .show(ui, |ui| left_column_ui(ui, state, commands));
    let height = height.unwrap_or_else(|| bottom(ui, commands));
    graphics::graphics_ui(ui, state, viewports, commands);
    remember_sizes(ui, state, [left.response.rect.width(), height], commands);
}

/// The paper's three sections, top to bottom.
fn left_column_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.take_available_space();
    ScrollArea::vertical()
        .id_salt("left column")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            // A child of fixed width: nothing in it may push the edge of the column outwards.
            let room = ui.available_rect_before_wrap();
            let width = room.width();
            let mut column = ui.new_child(UiBuilder::new().max_rect(room));
            column.spacing_mut().item_spacing.y = 0.0;
            load::load_ui(&mut column, state, commands);
            reduce::reduce_ui(&mut column, state, commands);
            matching::matching_ui(&mut column, state, commands);
            column.add_space(UNIT);
            let height = column.min_rect().height();
            ui.allocate_exact_size(vec2(width, height), Sense::hover());
        });
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
