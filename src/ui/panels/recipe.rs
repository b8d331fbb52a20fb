//! Every setting of a match behind the gear, as the table of settings has them.

use egui::{ComboBox, DragValue, Ui, Vec2};

use crate::app::AppState;
use crate::registration::{Floor, MatchSettings, Method};
use crate::settings::{ChoiceWords, Domain, Group, MatchRecipe, SETTINGS, Setting, Value};
use crate::text::Lengths;
use crate::ui::theme::{ROW, UNIT};
use crate::ui::widgets::{caption, card, form_row, tight};

/// Width of the column of labels.
const LABEL: f32 = 112.0;
/// The level that reducing for the search begins with.
const USUAL_LEVEL: usize = 2000;

fn gear_id() -> egui::Id {
    egui::Id::unique("recipe is open")
}

fn is_open(ui: &Ui) -> bool {
    ui.data(|data| data.get_temp(gear_id())).unwrap_or(false)
}

/// The button that shows and hides the settings.
pub fn gear_ui(ui: &mut Ui) {
    let is_open = is_open(ui);
    let name = if is_open {
        "Hide the match settings"
    } else {
        "Match settings"
    };
    let button = egui::Button::new("⚙")
        .selected(is_open)
        .min_size(Vec2::splat(ROW));
    let response = tight(ui, |ui| ui.add(button));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    if response.on_hover_text(name).clicked() {
        ui.data_mut(|data| data.insert_temp(gear_id(), !is_open));
    }
}

/// Another method brings its own settings; start, rotation step, hand and allowance stay.
pub fn set_method(settings: &mut MatchSettings, method: Method) {
    let mut new = MatchSettings::of(method);
    new.starts.method = settings.starts.method;
    new.starts.angle_segment_deg = settings.starts.angle_segment_deg;
    new.hand = settings.hand;
    new.allowance = settings.allowance;
    *settings = new;
}

/// The form, while the gear is on.
pub fn recipe_ui(ui: &mut Ui, state: &AppState, recipe: &mut MatchRecipe) {
    if !is_open(ui) {
        return;
    }
    card(ui, |ui| {
        for group in [Group::Starts, Group::Correspondences, Group::Search] {
            // Method and start stand above the form.
            for setting in SETTINGS.iter().filter(|row| row.group == group) {
                setting_ui(ui, state, setting, recipe);
            }
            ui.separator();
        }
        ui.add_space(UNIT / 2.0);
        if ui.button("Method defaults").clicked() {
            *recipe = MatchRecipe {
                settings: MatchSettings::of(recipe.settings.method),
                max_triangles: None,
            };
        }
    });
}

/// One setting, where the others leave a place for it.
fn setting_ui(ui: &mut Ui, state: &AppState, setting: &Setting, recipe: &mut MatchRecipe) {
    let Some(value) = setting.get(recipe) else {
        return;
    };
    let unused = setting.unused(recipe);
    let mut new = value.clone();
    let response = ui.add_enabled_ui(unused.is_none(), |ui| {
        value_ui(ui, state, setting, &mut new);
    });
    if let Some(reason) = unused {
        let tip = format!("{}\n{reason}", setting.help);
        response.response.on_disabled_hover_text(tip);
    }
    if new != value {
        setting.set(recipe, &new);
    }
}

fn value_ui(ui: &mut Ui, state: &AppState, setting: &Setting, value: &mut Value) {
    let lengths = state.document.lengths();
    match (&setting.domain, value) {
        (Domain::Choice(words), Value::Choice(name)) => choice_ui(ui, setting, &words(), name),
        (Domain::Switch, Value::Switch(is_on)) => {
            ui.checkbox(is_on, setting.label)
                .on_hover_text(setting.help);
        }
        (Domain::Count(range), Value::Count(n)) => {
            form_row(ui, setting.label, LABEL, |ui| {
                ui.add(DragValue::new(n).range(range.clone()).speed(1.0))
                    .on_hover_text(setting.help);
            });
        }
        (Domain::Number { unit, range, step }, Value::Number(number)) => {
            form_row(ui, setting.label, LABEL, |ui| {
                let field = DragValue::new(number)
                    .range(range.clone())
                    .speed(*step)
                    .max_decimals(6);
                ui.add(field.suffix(unit.suffix(lengths)))
                    .on_hover_text(setting.help);
            });
        }
        (Domain::Floor, Value::Floor(floor)) => floor_ui(ui, setting, floor, lengths),
        (Domain::Limit(_), Value::Limit(limit)) => limit_ui(ui, state, setting, limit),
        // The window takes its poses from the parts and from picked pairs.
        _ => {}
    }
}

/// A menu of choices.
fn choice_ui(ui: &mut Ui, setting: &Setting, words: &[ChoiceWords], name: &mut &'static str) {
    form_row(ui, setting.label, LABEL, |ui| {
        let chosen = words.iter().find(|words| words.name == *name);
        ComboBox::from_id_salt(setting.option)
            .selected_text(chosen.map_or("", |words| words.label))
            .width(ui.available_width())
            .truncate()
            .show_ui(ui, |ui| {
                for words in words {
                    ui.selectable_value(name, words.name, words.label)
                        .on_hover_text(words.help);
                }
            })
            .response
            .on_hover_text(setting.help);
    });
}

fn floor_ui(ui: &mut Ui, setting: &Setting, floor: &mut Floor, lengths: Lengths) {
    form_row(ui, setting.label, LABEL, |ui| {
        let words = |floor: &Floor| match floor {
            Floor::Auto => "Estimated",
            Floor::Length(_) => "Length",
            Floor::None => "None",
        };
        ComboBox::from_id_salt(setting.option)
            .selected_text(words(floor))
            .width(120.0)
            .show_ui(ui, |ui| {
                for choice in [Floor::Auto, Floor::Length(0.1), Floor::None] {
                    let is_on = words(&choice) == words(floor);
                    if ui.selectable_label(is_on, words(&choice)).clicked() && !is_on {
                        *floor = choice;
                    }
                }
            })
            .response
            .on_hover_text(setting.help);
        if let Floor::Length(length) = floor {
            ui.name_inputs("Length of the floor", |ui| {
                let value = DragValue::new(length).range(0.0..=1e6).speed(0.01);
                ui.add(value.suffix(lengths.suffix()));
            });
        }
    });
}

/// Levels of section 2 come before one of the settings.
fn limit_ui(ui: &mut Ui, state: &AppState, setting: &Setting, limit: &mut Option<usize>) {
    let mut parts = state.document.parts.iter();
    if parts.any(|(_, part)| part.as_ref().is_some_and(|part| part.level.is_some())) {
        caption(ui, "The search uses the levels of section 2");
        return;
    }
    let mut is_on = limit.is_some();
    ui.horizontal(|ui| {
        ui.checkbox(&mut is_on, "Reduce for the search to")
            .on_hover_text(setting.help);
        if is_on != limit.is_some() {
            *limit = is_on.then_some(USUAL_LEVEL);
        }
        if let Some(n) = limit {
            ui.name_inputs(setting.label, |ui| {
                ui.add(DragValue::new(n).range(100..=10_000_000).speed(20.0));
            });
        }
    });
}
