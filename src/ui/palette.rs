//! Search over all commands.

use super::theme::ROW;
use super::widgets::{draft, secondary, set_draft};
use crate::app::{Action, AppState, Command, ViewCommand};
use egui::{ScrollArea, Ui, vec2};

/// The field and the list of what fits.
pub fn palette_ui(ui: &mut Ui, state: &AppState, room: egui::Vec2, commands: &mut Vec<Command>) {
    ui.set_width(480.0);
    let id = egui::Id::unique("palette search");
    let mut text = draft(ui, id);
    let field = egui::TextEdit::singleline(&mut text)
        .hint_text("Search commands")
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 6));
    let field = ui.add(field).accessible_name("Search commands");
    if !field.has_focus() && !field.lost_focus() {
        field.request_focus();
    }
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    let wanted = text.to_lowercase();
    let fits = |action: &&Action| {
        let info = action.info();
        let all = format!("{} {}", info.label, info.tooltip).to_lowercase();
        wanted.split_whitespace().all(|word| all.contains(word))
    };
    let found: Vec<Action> = Action::ALL.iter().filter(fits).copied().collect();
    let mut chosen = None;
    if is_entered {
        chosen = found.iter().find(|a| a.enabled(state).is_ok()).copied();
    }
    ScrollArea::vertical()
        .max_height(room.y.min(400.0))
        .auto_shrink([false, true])
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if found.is_empty() {
                secondary(ui, "No command of that name");
            }
            for action in found {
                let info = action.info();
                let enabled = action.enabled(state);
                let keys = info.shortcut.map_or_else(String::new, |s| s.to_string());
                let button = egui::Button::new(info.label)
                    .shortcut_text(keys)
                    .frame_when_inactive(false)
                    .min_size(vec2(ui.available_width(), ROW));
                let response = ui.add_enabled(enabled.is_ok(), button);
                let response = response.on_hover_text(info.tooltip);
                let response = match enabled {
                    Ok(()) => response,
                    Err(reason) => response.on_disabled_hover_text(format!("Not now: {reason}")),
                };
                if response.clicked() {
                    chosen = Some(action);
                }
            }
        });
    set_draft(ui, id, text);
    if let Some(action) = chosen {
        set_draft(ui, id, String::new());
        commands.push(ViewCommand::SetDialog(None).into());
        commands.extend(action.to_commands(state));
    }
}
