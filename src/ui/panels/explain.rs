//! Why a match is weak or failed, and one button for each likely cause.

use egui::{Button, RichText, Ui, vec2};

use crate::app::{AppState, Cause, Command};
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{card, paragraph};

/// The causes of a weak result, within its card; the remedy of the first one may be what is to be done.
pub fn causes_ui(
    ui: &mut Ui,
    causes: Vec<Cause>,
    is_first_meant: bool,
    commands: &mut Vec<Command>,
) {
    for (place, cause) in causes.into_iter().enumerate() {
        ui.add_space(4.0);
        ui.separator();
        let title = RichText::new(cause.title).color(Palette::of(ui).text);
        ui.label(title.size(14.0));
        paragraph(ui, cause.evidence);
        let Some((label, remedy)) = cause.remedy else {
            continue;
        };
        let palette = Palette::of(ui);
        let button = if is_first_meant && place == 0 {
            let label = RichText::new(label).color(palette.on_accent);
            Button::new(label).fill(palette.accent)
        } else {
            Button::new(label)
        };
        let button = button.min_size(vec2(0.0, ROW));
        if ui.add(button).clicked() {
            commands.extend(remedy);
        }
    }
}

/// What to do after a match that gave no pose; the old pose stands.
pub fn failure_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(message) = state.match_failure() else {
        return;
    };
    ui.add_space(2.0);
    card(ui, |ui| {
        let color = Palette::of(ui).check;
        let label = ui.label(RichText::new("⚠ NO POSE FOUND").color(color).size(17.0));
        ui.ctx().accesskit_node_builder(label.id, |node| {
            node.set_live(egui::accesskit::Live::Polite);
        });
        paragraph(ui, format!("The part stays where it was: {message}."));
        causes_ui(ui, state.failure_causes(), false, commands);
    });
}
