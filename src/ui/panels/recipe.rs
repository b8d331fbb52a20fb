//! Every setting of a match behind the gear, as the table of settings has them.

use egui::{ComboBox, Rect, Sense, Stroke, Ui, Vec2, pos2};

use crate::app::AppState;
use crate::registration::{Floor, MatchSettings, Method};
use crate::settings::{ChoiceWords, Domain, Group, MatchRecipe, SETTINGS, Setting, Value};
use crate::text::Lengths;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{
    caption, card, count_field, form_row, length_field, number_field, segments, tight,
};

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

/// Another method brings its own settings; start, rotation step, hand and tolerances stay.
pub fn set_method(settings: &mut MatchSettings, method: Method) {
    let mut new = MatchSettings::of(method);
    new.starts.method = settings.starts.method;
    new.starts.angle_segment_deg = settings.starts.angle_segment_deg;
    new.hand = settings.hand;
    new.allowance = settings.allowance;
    new.shape_tolerance = settings.shape_tolerance;
    new.remove_offset = settings.remove_offset;
    *settings = new;
}

/// The form, while the gear is on.
pub fn recipe_ui(ui: &mut Ui, state: &AppState, recipe: &mut MatchRecipe) {
    if !is_open(ui) {
        return;
    }
    card(ui, |ui| {
        presets_ui(ui, recipe);
        for (group, title) in [
            (Group::Starts, "Starts"),
            (Group::Correspondences, "Pairs"),
            (Group::Search, "Search and stop"),
        ] {
            ui.add_space(UNIT / 2.0);
            ui.label(title);
            // Method and start stand above the form.
            for setting in SETTINGS.iter().filter(|row| row.group == group) {
                setting_ui(ui, state, setting, recipe);
            }
        }
    });
}

/// Whole sets of settings: quick on reduced meshes, the default, and as in the paper.
fn presets_ui(ui: &mut Ui, recipe: &mut MatchRecipe) {
    let preset = |method, max_triangles| {
        let mut settings = recipe.settings.clone();
        set_method(&mut settings, method);
        settings.starts.angle_segment_deg = MatchSettings::of(method).starts.angle_segment_deg;
        MatchRecipe {
            settings,
            max_triangles,
        }
    };
    let presets = [
        ("Fast", preset(Method::Fractional, Some(USUAL_LEVEL))),
        ("Default", preset(Method::Fractional, None)),
        ("Paper", preset(Method::Paper, Some(USUAL_LEVEL))),
    ];
    let is_on = |index: usize| presets[index].1 == *recipe;
    let labels = [0, 1, 2].map(|index| (presets[index].0, is_on(index), true));
    if let Some(index) = segments(ui, &labels, ui.available_width()) {
        *recipe = presets[index].1.clone();
    }
}

/// Room at the end of a row for its help and for the way back to the usual value.
const BESIDE: f32 = 40.0;

/// One setting, where the others leave a place for it, with its help and the way back.
fn setting_ui(ui: &mut Ui, state: &AppState, setting: &Setting, recipe: &mut MatchRecipe) {
    let Some(value) = setting.get(recipe) else {
        return;
    };
    let unused = setting.unused(recipe);
    let mut new = value.clone();
    let room = ui.available_width();
    let row = ui.scope(|ui| {
        ui.set_max_width(room - BESIDE);
        let response = ui.add_enabled_ui(unused.is_none(), |ui| {
            value_ui(ui, state, setting, &mut new);
        });
        if let Some(reason) = unused {
            let tip = format!("{}\n{reason}", setting.help);
            response.response.on_disabled_hover_text(tip);
        }
    });
    let row = row.response.rect;
    if row.height() > 1.0 {
        let usual = MatchRecipe {
            settings: MatchSettings::of(recipe.settings.method),
            max_triangles: None,
        };
        let usual = setting.get(&usual).filter(|usual| *usual != value);
        let right = row.left() + room;
        let at =
            |x: f32| Rect::from_center_size(pos2(right - x, row.center().y), Vec2::splat(18.0));
        help_ui(ui, at(30.0), setting);
        if let Some(usual) = usual.filter(|_| unused.is_none())
            && back_ui(ui, at(10.0), setting)
        {
            new = usual;
        }
    }
    if new != value {
        setting.set(recipe, &new);
    }
}

/// A question mark that tells what a setting does.
fn help_ui(ui: &Ui, at: Rect, setting: &Setting) {
    let id = ui.scope_id().with(("help", setting.option));
    let response = ui.interact(at, id, Sense::hover());
    let palette = Palette::of(ui);
    let color = if response.hovered() {
        palette.text
    } else {
        palette.secondary
    };
    let font = egui::TextStyle::Small.resolve(ui.style());
    let middle = egui::Align2::CENTER_CENTER;
    ui.painter().text(at.center(), middle, "?", font, color);
    ui.painter()
        .circle_stroke(at.center(), 7.0, Stroke::new(1.0, color));
    response.on_hover_text(setting.help);
}

/// The way back to the usual value of a setting that was changed; true if it was taken.
fn back_ui(ui: &mut Ui, at: Rect, setting: &Setting) -> bool {
    let button = egui::Button::new("⟲").frame_when_inactive(false);
    let response = tight(ui, |ui| ui.put(at, button));
    let name = format!("Reset {}", setting.label);
    response
        .on_hover_text("Back to the value of the method")
        .accessible_name(name)
        .clicked()
}

fn value_ui(ui: &mut Ui, state: &AppState, setting: &Setting, value: &mut Value) {
    let lengths = state.lengths();
    match (&setting.domain, value) {
        (Domain::Choice(words), Value::Choice(name)) => choice_ui(ui, setting, &words(), name),
        (Domain::Switch, Value::Switch(is_on)) => {
            ui.checkbox(is_on, setting.label)
                .on_hover_text(setting.help);
        }
        (Domain::Count(range), Value::Count(n)) => {
            form_row(ui, setting.label, LABEL, |ui| {
                ui.add(count_field(n).range(range.clone()).speed(1.0))
                    .on_hover_text(setting.help);
            });
        }
        (Domain::Number { unit, range, step }, Value::Number(number)) => {
            form_row(ui, setting.label, LABEL, |ui| {
                let field = number_field(number, unit.suffix(lengths))
                    .range(range.clone())
                    .speed(*step)
                    .max_decimals(6);
                ui.add(field).on_hover_text(setting.help);
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
                ui.add(length_field(length, lengths).range(0.0..=1e6).speed(0.01));
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
        ui.checkbox(&mut is_on, "Reduce search to")
            .on_hover_text(setting.help);
        if is_on != limit.is_some() {
            *limit = is_on.then_some(USUAL_LEVEL);
        }
        if let Some(n) = limit {
            ui.name_inputs(setting.label, |ui| {
                ui.add(count_field(n).range(100..=10_000_000).speed(20.0));
            });
        }
    });
}
