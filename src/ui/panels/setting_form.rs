//! Settings as rows of a form, each as its row in the table of settings says.

use std::ops::RangeInclusive;

use egui::{ComboBox, DragValue, Rect, Sense, Stroke, Ui, Vec2, pos2, vec2};

use crate::app::AppState;
use crate::mapping::limits::POSITIVE;
use crate::registration::{Floor, limits};
use crate::settings::{Domain, Setting, Unit, Value};
use crate::text::{Lengths, capital};
use crate::ui::focus;
use crate::ui::theme::{Palette, ROW};
use crate::ui::typed::{Takes, told_field};
use crate::ui::widgets::{caption, form_row, tight};

/// Width of the column of labels.
const LABEL: f32 = 104.0;
/// The level that reducing for the search begins with.
pub const USUAL_LEVEL: usize = 2000;
/// A length that is left to the program, as the command line calls it.
const AUTO: &str = "auto";
/// Name of the field of a floor that is a length.
const FLOOR_LENGTH: &str = "Length of the floor";
/// What the form takes as a level of the search.
const LEVELS: RangeInclusive<usize> = 100..=10_000_000;

/// The button that shows and hides the settings of a section.
#[derive(Debug, Clone, Copy)]
pub struct Gear {
    /// Where it is remembered that it is on.
    pub id: &'static str,
    /// What it shows.
    pub what: &'static str,
}

impl Gear {
    /// True while the settings are shown.
    pub fn is_on(self, ui: &Ui) -> bool {
        let id = egui::Id::unique(self.id);
        ui.data(|data| data.get_temp(id)).unwrap_or(false)
    }

    /// Draws the button, with a mark while a setting behind it is not the usual one.
    pub fn ui(self, ui: &mut Ui, has_own: bool) {
        let is_on = self.is_on(ui);
        let name = if is_on {
            format!("Hide the {}", self.what)
        } else {
            capital(self.what)
        };
        let button = egui::Button::new("⚙")
            .selected(is_on)
            .min_size(Vec2::splat(ROW));
        let response = tight(ui, |ui| ui.add(button));
        if has_own {
            let at = response.rect.right_top() + vec2(-4.0, 4.0);
            ui.painter().circle_filled(at, 3.0, Palette::of(ui).check);
        }
        let tip = if has_own {
            format!("{name}: some are not the usual ones")
        } else {
            name.clone()
        };
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.on_hover_text(tip).clicked() {
            let id = egui::Id::unique(self.id);
            ui.data_mut(|data| data.insert_temp(id, !is_on));
        }
    }
}

/// Room at the end of a row for its help and for the way back to the usual value.
const BESIDE: f32 = 40.0;

/// One setting, where the others leave a place for it, with its help and the way back to its usual value.
pub fn setting_ui<R>(
    ui: &mut Ui,
    state: &AppState,
    setting: &Setting<R>,
    (recipe, usual): (&mut R, &R),
) {
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
        // A second field may stand below the row.
        let middle = row.top() + row.height().min(ROW) / 2.0;
        let usual = setting.get(usual).filter(|usual| *usual != value);
        let right = row.left() + room;
        let at = |x: f32| Rect::from_center_size(pos2(right - x, middle), Vec2::splat(18.0));
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

/// A question mark that says what a setting does.
fn help_ui<R>(ui: &Ui, at: Rect, setting: &Setting<R>) {
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
fn back_ui<R>(ui: &mut Ui, at: Rect, setting: &Setting<R>) -> bool {
    let button = egui::Button::new("⟲").frame_when_inactive(false);
    // A button is never lower than this, and would hang out below.
    let size = vec2(at.width(), ui.spacing().interact_size.y);
    let at = Rect::from_center_size(at.center(), size);
    let response = tight(ui, |ui| ui.place(at, button));
    let name = format!("Reset {}", setting.label);
    response
        .on_hover_text("Back to the usual value")
        .accessible_name(name)
        .clicked()
}

fn value_ui<R>(ui: &mut Ui, state: &AppState, setting: &Setting<R>, value: &mut Value) {
    let lengths = state.lengths();
    match (&setting.domain, value) {
        (Domain::Choice(_), Value::Choice(name)) => choice_ui(ui, setting, name),
        (Domain::Switch, Value::Switch(is_on)) => {
            ui.checkbox(is_on, setting.label)
                .on_hover_text(setting.help);
        }
        (Domain::Count(range), Value::Count(n)) => {
            let takes = Takes::count(setting.label, range.clone());
            let before = *n as f64;
            let field = takes.field(n).speed(1.0);
            typed_ui(ui, setting, (before, field), |text| takes.read(text));
        }
        (
            Domain::Number {
                unit: Unit::LengthOrAuto,
                range,
                step,
            },
            Value::Number(length),
        ) => auto_length_ui(ui, setting, length, (lengths, range.clone(), *step)),
        (Domain::Number { unit, range, step }, Value::Number(number)) => {
            let takes = match unit {
                Unit::Length => Takes::length(setting.label, lengths, range.clone()),
                // The whole words have no room; the help says them.
                Unit::EdgeLengths => Takes::number(setting.label, " edges", range.clone()),
                _ => Takes::number(setting.label, unit.suffix(lengths), range.clone()),
            };
            let before = *number;
            let field = takes.field(number).speed(*step).max_decimals(6);
            typed_ui(ui, setting, (before, field), |text| takes.read(text));
        }
        (Domain::Reach, Value::Reach(reach)) => {
            // No reach is 0; it stands for the word.
            let mut length = reach.unwrap_or(0.0);
            auto_length_ui(ui, setting, &mut length, (lengths, POSITIVE, 0.05));
            *reach = Some(length).filter(|length| *length > 0.0);
        }
        (Domain::Floor, Value::Floor(floor)) => floor_ui(ui, setting, floor, lengths),
        (Domain::Limit(_), Value::Limit(limit)) => limit_ui(ui, state, setting, limit),
        // The window takes its poses from the parts and from picked pairs.
        _ => {}
    }
}

/// A row with a field for a number.
fn typed_ui<R>(
    ui: &mut Ui,
    setting: &Setting<R>,
    (value, field): (f64, DragValue<'_>),
    read: impl Fn(&str) -> Result<f64, String>,
) {
    form_row(ui, setting.label, LABEL, |ui| {
        told_field(ui, setting.label, value, field, read).on_hover_text(setting.help);
    });
}

/// A menu of choices.
fn choice_ui<R>(ui: &mut Ui, setting: &Setting<R>, name: &mut &'static str) {
    let Domain::Choice(words) = setting.domain else {
        return;
    };
    let words = words();
    form_row(ui, setting.label, LABEL, |ui| {
        let chosen = words.iter().find(|words| words.name == *name);
        let menu = ComboBox::from_id_salt(setting.option)
            .selected_text(chosen.map_or("", |words| words.label))
            .width(ui.available_width())
            .truncate();
        let shown = focus::menu(ui, menu, |ui| {
            for words in &words {
                let holds = *name == words.name;
                let choice = ui.selectable_value(name, words.name, words.label);
                focus::chosen(ui, holds, choice).on_hover_text(words.help);
            }
        });
        shown.response.on_hover_ui(|ui| {
            ui.label(setting.help);
            // The menu may have had no room for its words.
            if let Some(words) = chosen {
                ui.label(format!("{}: {}", words.label, words.help));
            }
        });
    });
}

fn floor_ui<R>(ui: &mut Ui, setting: &Setting<R>, floor: &mut Floor, lengths: Lengths) {
    form_row(ui, setting.label, LABEL, |ui| {
        let words = |floor: &Floor| match floor {
            Floor::Auto => "Estimated",
            Floor::Length(_) => "Length",
            Floor::None => "None",
        };
        let menu = ComboBox::from_id_salt(setting.option)
            .selected_text(words(floor))
            .width(ui.available_width());
        let shown = focus::menu(ui, menu, |ui| {
            for choice in [Floor::Auto, Floor::Length(0.1), Floor::None] {
                let is_on = words(&choice) == words(floor);
                let row = ui.selectable_label(is_on, words(&choice));
                if focus::chosen(ui, is_on, row).clicked() && !is_on {
                    *floor = choice;
                }
            }
        });
        shown.response.on_hover_text(setting.help);
    });
    // Beside the choice it would lie below the help of the row.
    if let Floor::Length(length) = floor {
        let takes = Takes::length(FLOOR_LENGTH, lengths, limits::LENGTH);
        form_row(ui, "", LABEL, |ui| {
            let before = *length;
            let field = takes.field(length).speed(0.01).max_decimals(6);
            told_field(ui, FLOOR_LENGTH, before, field, |text| takes.read(text));
        });
    }
}

/// A length, or "auto", which an empty field says too and for which the length is 0.
fn auto_length_ui<R>(
    ui: &mut Ui,
    setting: &Setting<R>,
    length: &mut f64,
    (lengths, range, step): (Lengths, RangeInclusive<f64>, f64),
) {
    let before = *length;
    let is_auto = before == 0.0;
    let takes = Takes::length(setting.label, lengths, range);
    let field = takes
        .bare_field(length)
        .range(0.0..=f64::MAX)
        .speed(step)
        .max_decimals(6)
        .suffix(if is_auto { "" } else { lengths.suffix() })
        .custom_formatter(|length, decimals| {
            if length > 0.0 {
                egui::emath::format_with_decimals_in_range(length, decimals)
            } else {
                AUTO.to_owned()
            }
        });
    typed_ui(ui, setting, (before, field), |text| match text.trim() {
        "" | AUTO => Ok(0.0),
        text => takes.read(text),
    });
}

/// Levels of section 2 come before one of the settings.
fn limit_ui<R>(ui: &mut Ui, state: &AppState, setting: &Setting<R>, limit: &mut Option<usize>) {
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
        let takes = Takes::count(setting.label, LEVELS);
        if let Some(limit) = limit {
            let before = *limit as f64;
            let field = takes.field(limit).speed(20.0);
            told_field(ui, setting.label, before, field, |text| takes.read(text));
        }
    });
}
