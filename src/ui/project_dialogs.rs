//! Questions about the work as a whole: save it, restore it, find its files.

use egui::{Button, Frame, Margin, Panel, RichText, Stroke, Ui, vec2};

use super::theme::{Palette, ROW, UNIT};
use super::typed::refusal;
use super::widgets::{caption, paragraph, role_mark, secondary};
use crate::app::{AppState, Command, ProjectCommand, ViewCommand};
use crate::jobs::Located;

/// Least width of the buttons that answer.
const BUTTON: f32 = 104.0;

/// Unsaved work, before the program ends.
pub fn unsaved_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.set_width(400.0);
    let is_unsaved = state.is_unsaved();
    ui.heading(if is_unsaved {
        "Save changes before closing?"
    } else {
        "Close now?"
    });
    let name = state.project_name().unwrap_or_else(|| state.work_title());
    paragraph(ui, name);
    if is_unsaved {
        paragraph(
            ui,
            "Unsaved changes to pose, levels, settings and results will be lost.",
        );
    }
    if let Some(running) = state.unfinished_work() {
        paragraph(ui, format!("{running} It ends without a result."));
    }
    ui.add_space(UNIT);
    ui.horizontal(|ui| {
        if is_unsaved && primary(ui, "Save").clicked() {
            commands.push(ProjectCommand::SaveAndQuit.into());
        }
        let without = if is_unsaved { "Don’t save" } else { "Close" };
        if plain(ui, without).clicked() {
            commands.push(ProjectCommand::QuitUnsaved.into());
        }
        if plain(ui, "Cancel").clicked() {
            commands.push(ViewCommand::SetDialog(None).into());
        }
    });
}

/// Files of a project that are neither where it says nor beside it.
pub fn missing_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.set_width(480.0);
    let Some((request, missing)) = &state.project.missing else {
        commands.push(ViewCommand::SetDialog(None).into());
        return;
    };
    ui.heading("Project files not found");
    paragraph(ui, request.path.display().to_string());
    for (file, path) in missing {
        ui.add_space(UNIT);
        ui.horizontal(|ui| {
            role_mark(ui, file.role());
            ui.add(egui::Label::new(path.display().to_string()).truncate());
        });
        ui.horizontal(|ui| {
            let what = file.words();
            if plain(ui, "Locate…")
                .accessible_name(format!("Locate {what}"))
                .clicked()
            {
                commands.push(ProjectCommand::AskLocate(*file).into());
            }
            let without = plain(ui, "Open without it");
            if without
                .accessible_name(format!("Open without {what}"))
                .clicked()
            {
                commands.push(ProjectCommand::Locate(*file, Located::Without).into());
            }
        });
    }
    ui.add_space(UNIT);
    refusal(ui, state.project.refused.clone());
    paragraph(
        ui,
        "They are neither where the project has them nor beside it. Locate one, and the others are searched for \
         next to it.",
    );
    // In a row as the other answers are, which has the words in the middle of the buttons.
    ui.horizontal(|ui| {
        if plain(ui, "Cancel").clicked() {
            commands.push(ProjectCommand::GiveUp.into());
        }
    });
}

/// Work that its program did not live to save, offered until something was loaded: a strip of its own, so
/// that it covers neither the ways to open files nor the log.
pub fn restore_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_empty = state.document.parts.iter().all(|(_, part)| part.is_none());
    let is_new = is_empty && state.history.names().next().is_none();
    let Some(work) = state
        .project
        .lost_session()
        .filter(|_| is_new && !state.jobs.is_busy())
    else {
        return;
    };
    let palette = Palette::of(ui);
    let frame = Frame::new()
        .fill(palette.card)
        .stroke(Stroke::new(1.0, palette.line))
        .inner_margin(Margin::symmetric(16, 6));
    Panel::top("recovery").frame(frame).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(UNIT, 4.0);
            let when = state.when_text(work.saved_at);
            ui.label(format!("Recover unsaved project from {when}?"))
                .on_hover_text("The program ended before it was saved.");
            secondary(ui, work.title.clone());
            if primary(ui, "Recover").clicked() {
                commands.push(ProjectCommand::Restore(work.path.clone()).into());
            }
            if plain(ui, "Not now").clicked() {
                commands.push(ProjectCommand::DismissRecovery.into());
            }
            // Where it would wrap, the menu alone says it.
            if ui.available_size_before_wrap().x > 240.0 {
                caption(ui, "Also under File › Recovered sessions");
            }
        });
    });
}

/// The sessions of the last runs, in the menu.
pub fn recovered_menu_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.menu_button("Recovered sessions", |ui| {
        for work in &state.project.sessions {
            let label = format!("{}   {}", state.when_text(work.saved_at), work.title);
            if ui.button(label).clicked() {
                commands.push(ProjectCommand::Restore(work.path.clone()).into());
                ui.close();
            }
        }
        caption(ui, "The last five sessions, saved after each step");
    });
}

fn primary(ui: &mut Ui, label: &str) -> egui::Response {
    let palette = Palette::of(ui);
    let text = RichText::new(label).color(palette.on_accent);
    ui.add(
        Button::new(text)
            .fill(palette.accent)
            .min_size(vec2(BUTTON, ROW + 4.0)),
    )
}

fn plain(ui: &mut Ui, label: &str) -> egui::Response {
    ui.add(Button::new(label).min_size(vec2(BUTTON, ROW + 4.0)))
}
