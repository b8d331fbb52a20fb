//! Undo steps; a click goes there.

use crate::app::{Action, AppState, Command, HistoryCommand};
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::plain_action;
use egui::{Align, Button, Layout, RichText, ScrollArea, Ui, vec2};

/// The list, oldest first; what was undone is quiet.
pub fn history_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        plain_action(ui, state, Action::Undo, commands);
        plain_action(ui, state, Action::Redo, commands);
        plain_action(ui, state, Action::BackToAsLoaded, commands);
    });
    let n_done = state.history.n_done();
    let names: Vec<&str> = std::iter::once("Start")
        .chain(state.history.names())
        .collect();
    let is_free = Action::OpenExample.enabled(state).is_ok();
    ScrollArea::vertical()
        .id_salt("history")
        .auto_shrink([false, false])
        .stick_to_bottom(true)
        .show_rows(ui, ROW, names.len(), |ui, range| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for index in range {
                row_ui(ui, (index, names[index]), (n_done, is_free), commands);
            }
        });
}

fn row_ui(
    ui: &mut Ui,
    (index, name): (usize, &str),
    (n_done, is_free): (usize, bool),
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(ui);
    let color = if index > n_done {
        palette.secondary
    } else {
        palette.text
    };
    let text = RichText::new(format!("{index:>3}   {name}")).color(color);
    let button = Button::new(text)
        .frame_when_inactive(false)
        .selected(index == n_done)
        .min_size(vec2(ui.available_width(), ROW));
    let layout = Layout::left_to_right(Align::Center).with_main_justify(true);
    ui.with_layout(layout.with_main_align(Align::Min), |ui| {
        if ui.add_enabled(is_free, button).clicked() && index != n_done {
            commands.push(HistoryCommand::JumpTo(index).into());
        }
    });
}
