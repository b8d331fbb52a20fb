//! The units of a file: the menu that sets them, and the question where two files disagree.

use egui::{Label, RichText, Ui};

use crate::app::{AppState, Command, FileCommand};
use crate::role::Role;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, card};
use crate::units::{LengthUnit, UnitSystem, Units};

/// What is known of a file's units, and every choice.
pub fn units_menu_ui(ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    let Some(part) = state.document.part(role) else {
        return;
    };
    ui.set_min_width(216.0);
    let known = state.units_of(role);
    caption(
        ui,
        known.map_or_else(|| "Unit unknown".to_owned(), |k| k.words()),
    );
    let by_user = part.loaded.settings.units;
    let mut choice = |ui: &mut Ui, label: String, units: Option<Units>| {
        if ui.radio(by_user == units, label).clicked() {
            commands.push(FileCommand::SetUnits { role, units }.into());
            ui.close();
        }
    };
    let guess = part.loaded.guessed_units;
    let guess = guess.map_or("unknown", |known| known.units.label());
    choice(ui, format!("As guessed: {guess}"), None);
    ui.separator();
    for unit in LengthUnit::ALL {
        let label = format!("{unit}, {}", unit.plural());
        choice(ui, label, Some(unit.into()));
    }
    ui.separator();
    for system in UnitSystem::ALL {
        let label = format!("{}, stress in {}", system.label(), system.stress());
        choice(ui, label, Some(system.into()));
    }
}

/// The sizes or the units of the two files hint at a factor between them.
pub fn unit_question_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(hint), Some(factor)) = (state.unit_hint(), state.hinted_length_factor()) else {
        return;
    };
    let role = Role::Stamped;
    card(ui, |ui| {
        let palette = Palette::of(ui);
        let text = RichText::new(format!("⚠ {}.", hint.text())).color(palette.check);
        ui.add(Label::new(text).wrap());
        let (label, command) = match hint.unit {
            Some(unit) => (
                format!("Treat stamped as {unit}"),
                FileCommand::SetUnits {
                    role,
                    units: Some(unit.into()),
                },
            ),
            None => (
                format!("Multiply stamped lengths by {factor}"),
                FileCommand::SetLengthFactor { role, factor },
            ),
        };
        if ui.button(label).clicked() {
            commands.push(command.into());
        }
        if ui.button("The sizes do differ").clicked() {
            commands.push(FileCommand::DismissUnitHint.into());
        }
    });
}

/// The unit of all lengths in the window, with where it is known from.
pub fn window_unit_ui(ui: &mut Ui, state: &AppState) {
    let units = state.document.units();
    if state.document.parts.iter().all(|(_, part)| part.is_none()) {
        return;
    }
    let (text, color) = match units.lengths {
        Some(unit) => (format!("units: {unit}"), Palette::of(ui).secondary),
        None => ("unit unknown".to_owned(), Palette::of(ui).check),
    };
    let label = ui.label(RichText::new(text).color(color));
    label.on_hover_ui(|ui| {
        for role in Role::ALL {
            if let Some(part) = state.document.part(role) {
                let known = state.units_of(role);
                let words = known.map_or_else(|| "unit unknown".to_owned(), |k| k.words());
                let mut text = format!("{} {}: {words}", role.mark(), part.loaded.file_name());
                if part.length_factor() != 1.0 {
                    text += &format!(", lengths × {}", part.length_factor());
                }
                ui.label(text);
            }
        }
        caption(
            ui,
            "Every length in this window is in the unit of the crash file.",
        );
        caption(ui, "The menu … of a file sets its units.");
    });
}
