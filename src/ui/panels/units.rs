//! The units of a file: the menu that sets them, and the question where two files disagree.

use egui::{Label, RichText, Ui};

use crate::app::{AppState, Command, FileCommand, MapCommand};
use crate::role::Role;
use crate::text::factor_note;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, card};
use crate::units::{KnownUnits, LengthUnit, UnitSystem, Units};

/// What is known of a part's units, and every choice.
pub fn part_units_ui(ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    let Some(part) = state.document.part(role) else {
        return;
    };
    let guess = part.loaded.guessed_units;
    let unset = format!("As guessed: {}", label_of(guess));
    let (known, by_user) = (state.units_of(role), part.loaded.settings.units);
    if let Some(units) = units_menu_ui(ui, known, by_user, unset) {
        commands.push(FileCommand::SetUnits { role, units }.into());
    }
}

/// The same of a further stamped file.
pub fn further_units_ui(ui: &mut Ui, revision: u64, state: &AppState, commands: &mut Vec<Command>) {
    let Some(further) = state.document.further(revision) else {
        return;
    };
    let unset = format!("As the first: {}", label_of(state.units_of(Role::Stamped)));
    let known = state.document.further_units(&further.loaded);
    if let Some(units) = units_menu_ui(ui, known, further.loaded.settings.units, unset) {
        commands.push(MapCommand::SetFurtherUnits(revision, units).into());
    }
}

fn label_of(known: Option<KnownUnits>) -> &'static str {
    known.map_or("unknown", |known| known.units.label())
}

/// What is known, and every choice, the first of which leaves the units open. What was chosen.
fn units_menu_ui(
    ui: &mut Ui,
    known: Option<KnownUnits>,
    by_user: Option<Units>,
    unset: String,
) -> Option<Option<Units>> {
    ui.set_min_width(216.0);
    caption(
        ui,
        known.map_or_else(|| "Unit unknown".to_owned(), |k| k.words()),
    );
    let mut chosen = None;
    let mut choice = |ui: &mut Ui, label: String, units: Option<Units>| {
        if ui.radio(by_user == units, label).clicked() {
            chosen = Some(units);
            ui.close();
        }
    };
    choice(ui, unset, None);
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
    chosen
}

/// The sizes or the units of the two files hint at a factor between them.
pub fn unit_question_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(hint), Some((label, remedy))) = (state.unit_hint(), state.unit_remedy()) else {
        return;
    };
    card(ui, |ui| {
        let palette = Palette::of(ui);
        let text = RichText::new(format!("⚠ {}.", hint.text())).color(palette.check);
        ui.add(Label::new(text).wrap());
        if ui.button(label).clicked() {
            commands.extend(remedy);
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
                text += &factor_note(part.length_factor());
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
