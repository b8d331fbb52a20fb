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
const OF_SCREEN: &str = "With legend, names and scale the image is that of the screen, in its size";

/// The choices, kept at once, and the button that asks where to put the picture.
pub fn picture_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut choice = state.settings.picture;
    // The Enter that ends a number or presses what has the keyboard is not meant for the button.
    let is_free = ui.memory(|memory| memory.focused().is_none());
    let is_entered = is_free && ui.input(|input| input.key_pressed(egui::Key::Enter));
    let mut has_overlays = choice.has_overlays(state);
    let shown = choice.size_of(state);
    ui.add_enabled_ui(!has_overlays, |ui| size_ui(ui, shown, &mut choice));
    form_row(ui, "Shows", LABEL, |ui| {
        for windows in PictureWindows::ALL {
            if chip(ui, windows.label(), choice.windows == windows).clicked() {
                choice.windows = windows;
            }
        }
    });
    ui.add_enabled_ui(!has_overlays, |ui| {
        let is_bare = ui.checkbox(&mut choice.is_transparent, "Without background");
        is_bare.on_disabled_hover_text(OF_SCREEN);
    });
    let with_overlays = ui
        .checkbox(&mut has_overlays, "With legend, names and scale")
        .on_hover_text("As on the screen, in the size it has there");
    if with_overlays.changed() {
        choice.overlays = Some(has_overlays);
    }
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

/// The sizes, of which `shown` is the one that the image gets.
fn size_ui(ui: &mut Ui, shown: PictureSize, choice: &mut PictureChoice) {
    let (usual, exact) = PictureSize::PRESETS.split_at(3);
    for (name, sizes) in [("Size", usual), ("", exact)] {
        form_row(ui, name, LABEL, |ui| {
            for size in sizes {
                let chip = chip(ui, &size.label(), shown == *size);
                if chip.on_disabled_hover_text(OF_SCREEN).clicked() {
                    choice.size = *size;
                }
            }
        });
    }
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
            let field = told_field(ui, name, before, field, |text| takes.read(text));
            field.on_disabled_hover_text(OF_SCREEN);
        }
        caption(ui, "pixels");
        if sides != before {
            choice.size = PictureSize::Pixels(sides);
        }
    });
}
