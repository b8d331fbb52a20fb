//! The question which parts of a crash model are matched, where one of them is plainly the stamped one.

use egui::{Label, Ui};

use crate::app::{AppState, Command, PartCommand};
use crate::role::Role;
use crate::ui::widgets::card;

/// Names the part that is most like the stamped part, with a button for it and one for all.
pub fn part_question_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(more) = state.part_question() else {
        return;
    };
    card(ui, |ui| {
        let title = state.document.part_title(more.part);
        let n_used = more.n_used;
        let mut parts = state.document.parts.iter();
        let is_full = parts.all(|(_, part)| part.as_ref().is_none_or(|part| part.level.is_none()));
        let what_now = if is_full {
            ". Match tries the most alike one by one."
        } else {
            ""
        };
        let text = format!(
            "{n_used} crash parts are chosen. Most like the stamped part: {title}{what_now}"
        );
        ui.add(Label::new(text).wrap());
        ui.horizontal_wrapped(|ui| {
            if ui.button("Match only this").clicked() {
                commands.push(PartCommand::UseOnly(more.part).into());
            }
            if ui.button("Use all").clicked() {
                commands.push(PartCommand::UseAll(Role::Crash).into());
            }
        });
    });
}
