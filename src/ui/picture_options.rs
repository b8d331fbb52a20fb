//! The dialog of a picture: size, background, windows.

use egui::Ui;

use super::theme::UNIT;
use super::typed::{Takes, told_field};
use super::widgets::{caption, chip, form_row, large_button};
use crate::app::{
    AppState, Command, ExportCommand, PictureChoice, PictureSize, PictureWindows, Settings,
    ViewCommand,
};

const LABEL: f32 = 96.0;

/// The choices, kept at once, and the button that asks where to put the picture.
pub fn picture_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut choice = state.settings.picture;
    // The Enter that ends a number or presses what has the keyboard is not meant for the button.
    let is_free = ui.memory(|memory| memory.focused().is_none());
    let is_entered = is_free && ui.input(|input| input.key_pressed(egui::Key::Enter));
    size_ui(ui, &mut choice);
    form_row(ui, "Shows", LABEL, |ui| {
        for windows in PictureWindows::ALL {
            if chip(ui, windows.label(), choice.windows == windows).clicked() {
                choice.windows = windows;
            }
        }
    });
    ui.add_enabled_ui(!choice.has_overlays, |ui| {
        ui.checkbox(&mut choice.is_transparent, "Without background");
    });
    ui.checkbox(&mut choice.has_overlays, "With legend, names and scale")
        .on_hover_text("As on the screen, in the size it has there");
    ui.add_space(UNIT);
    let is_taken = ui
        .horizontal(|ui| {
            let is_clicked = large_button(ui, "Save image…", true).clicked();
            caption(ui, "F12 repeats this");
            is_clicked || is_entered
        })
        .inner;
    if is_taken {
        commands.push(ViewCommand::SetDialog(None).into());
        commands.push(ExportCommand::AskPicture(choice).into());
    } else if choice != state.settings.picture {
        let settings = Settings {
            picture: choice,
            ..state.settings.clone()
        };
        commands.push(Command::Settings(Box::new(settings)));
    }
}

fn size_ui(ui: &mut Ui, choice: &mut PictureChoice) {
    ui.add_enabled_ui(!choice.has_overlays, |ui| {
        form_row(ui, "Size", LABEL, |ui| {
            for size in &PictureSize::PRESETS[..3] {
                if chip(ui, &size.label(), choice.size == *size).clicked() {
                    choice.size = *size;
                }
            }
        });
        form_row(ui, "", LABEL, |ui| {
            for size in &PictureSize::PRESETS[3..] {
                if chip(ui, &size.label(), choice.size == *size).clicked() {
                    choice.size = *size;
                }
            }
        });
        form_row(ui, "Custom size", LABEL, |ui| {
            let mut sides = match choice.size {
                PictureSize::Pixels(sides) => sides,
                PictureSize::Window(_) => [1920, 1080],
            };
            let before = sides;
            for (side, name) in sides
                .iter_mut()
                .zip(["Width in pixels", "Height in pixels"])
            {
                let (least, most) = (*PictureSize::SIDES.start(), *PictureSize::SIDES.end());
                let takes = Takes::count(name, least as usize..=most as usize);
                let before = f64::from(*side);
                let field = takes.field(side).speed(8.0);
                told_field(ui, name, before, field, |text| takes.read(text));
            }
            caption(ui, "pixels");
            if sides != before {
                choice.size = PictureSize::Pixels(sides);
            }
        });
    });
}
