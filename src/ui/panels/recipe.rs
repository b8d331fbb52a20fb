//! Everything the core offers for a match, behind the gear. The lists come from the core's tables.

use crate::app::AppState;
use crate::pipeline::match_parts::MatchRecipe;
use crate::registration::{
    DataSide, Floor, Hand, MatchSettings, Method, Metric, Motion, PairWith, Search, Selection,
    StartMethod,
};
use crate::ui::theme::{ROW, UNIT};
use crate::ui::widgets::{caption, card, form_row, tight};
use egui::{ComboBox, DragValue, Ui, Vec2};

const LABEL: f32 = 104.0;

fn gear_id() -> egui::Id {
    egui::Id::unique("recipe is open")
}

fn is_open(ui: &Ui) -> bool {
    ui.data(|data| data.get_temp(gear_id())).unwrap_or(false)
}

/// The button that unfolds the settings.
pub fn gear_ui(ui: &mut Ui) {
    let is_open = is_open(ui);
    let name = if is_open {
        "Hide the settings of the match"
    } else {
        "Settings of the match"
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

/// Another method takes its own settings along; where to start and the hand stay.
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
        starts_ui(ui, recipe);
        ui.separator();
        pairs_ui(ui, &mut recipe.settings, state.unit_suffix());
        ui.separator();
        iteration_ui(ui, &mut recipe.settings, state.unit_suffix());
        ui.separator();
        level_ui(ui, state, recipe);
        ui.add_space(4.0);
        if ui.button("Defaults of this method").clicked() {
            *recipe = MatchRecipe {
                settings: MatchSettings::of(recipe.settings.method),
                max_triangles: None,
            };
        }
    });
}

/// A menu of choices that tell their own labels.
fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    value: &mut T,
    choices: &[T],
    words: impl Fn(&T) -> (&'static str, &'static str),
) {
    form_row(ui, name, LABEL, |ui| {
        ComboBox::from_id_salt(name)
            .selected_text(words(value).0)
            .width(ui.available_width())
            .truncate()
            .show_ui(ui, |ui| {
                for choice in choices {
                    let (label, help) = words(choice);
                    ui.selectable_value(value, *choice, label)
                        .on_hover_text(help);
                }
            });
    });
}

fn starts_ui(ui: &mut Ui, recipe: &mut MatchRecipe) {
    let settings = &mut recipe.settings;
    let is_turned = matches!(
        settings.starts.method,
        StartMethod::SurfaceNormals | StartMethod::All
    );
    ui.add_enabled_ui(is_turned, |ui| {
        form_row(ui, "Turned by", LABEL, |ui| {
            let value = &mut settings.starts.angle_segment_deg;
            ui.add(
                DragValue::new(value)
                    .range(1.0..=60.0)
                    .speed(0.5)
                    .suffix("°"),
            )
            .on_hover_text("Angle between neighbouring starts; 40° gives nine, as in the paper")
            .on_disabled_hover_text(
                "Not now: only starts from surface normals are turned; choose them as the start",
            );
        });
    });
    ui.checkbox(
        &mut settings.starts.both_signs,
        "Both directions of the normal",
    );
    ui.checkbox(
        &mut settings.starts.widen,
        "More starts where none convinces",
    );
    choice(ui, "Search", &mut settings.search, &Search::ALL, |s| {
        (s.label(), s.help())
    });
    choice(ui, "Hand", &mut settings.hand, &Hand::ALL, |h| {
        (h.label(), h.help())
    });
}

fn pairs_ui(ui: &mut Ui, settings: &mut MatchSettings, unit: &'static str) {
    choice(
        ui,
        "Points of",
        &mut settings.data_side,
        &DataSide::ALL,
        |d| (d.label(), d.help()),
    );
    choice(
        ui,
        "Paired with",
        &mut settings.pair_with,
        &PairWith::ALL,
        |p| (p.label(), p.help()),
    );
    selection_ui(ui, settings, unit);
    choice(ui, "Minimise", &mut settings.metric, &Metric::ALL, |m| {
        (m.label(), m.help())
    });
    choice(ui, "Motion", &mut settings.motion, &Motion::ALL, |m| {
        (m.label(), m.help())
    });
}

/// Which pairs count, with the parameters of the choice.
fn selection_ui(ui: &mut Ui, settings: &mut MatchSettings, unit: &'static str) {
    form_row(ui, "Pairs kept", LABEL, |ui| {
        ComboBox::from_id_salt("pairs kept")
            .selected_text(settings.selection.label())
            .width(ui.available_width())
            .truncate()
            .show_ui(ui, |ui| {
                for selection in Selection::ALL {
                    let is_on = selection.label() == settings.selection.label();
                    let response = ui.selectable_label(is_on, selection.label());
                    if response.on_hover_text(selection.help()).clicked() && !is_on {
                        settings.selection = selection;
                    }
                }
            });
    });
    match &mut settings.selection {
        Selection::Trimmed { overlap } => {
            form_row(ui, "Overlap", LABEL, |ui| {
                ui.add(
                    DragValue::new(overlap)
                        .range(0.001..=1.0)
                        .speed(0.01)
                        .fixed_decimals(2),
                )
                .on_hover_text("Share of the points that are kept");
            });
        }
        Selection::Fractional { lambda, floor } => {
            form_row(ui, "λ", LABEL, |ui| {
                ui.add(DragValue::new(lambda).range(0.01..=100.0).speed(0.01))
                    .on_hover_text("Price of leaving points out; larger keeps more");
            });
            floor_ui(ui, floor, unit);
        }
        Selection::All | Selection::TrimmedSearch => {}
    }
}

fn floor_ui(ui: &mut Ui, floor: &mut Floor, unit: &'static str) {
    form_row(ui, "Floor", LABEL, |ui| {
        let words = |floor: &Floor| match floor {
            Floor::Auto => "From the meshes",
            Floor::Length(_) => "Length",
            Floor::None => "None, as published",
        };
        ComboBox::from_id_salt("floor")
            .selected_text(words(floor))
            .width(120.0)
            .show_ui(ui, |ui| {
                for choice in [Floor::Auto, Floor::Length(0.1), Floor::None] {
                    let is_on = words(&choice) == words(floor);
                    if ui.selectable_label(is_on, words(&choice)).clicked() && !is_on {
                        *floor = choice;
                    }
                }
            });
        if let Floor::Length(length) = floor {
            ui.name_inputs("Length of the floor", |ui| {
                let value = DragValue::new(length).range(0.0..=1e6).speed(0.01);
                ui.add(value.suffix(unit));
            });
        }
    });
}

fn iteration_ui(ui: &mut Ui, settings: &mut MatchSettings, unit: &'static str) {
    let count = |ui: &mut Ui, name: &str, value: &mut usize, help: &str| {
        form_row(ui, name, LABEL, |ui| {
            ui.add(DragValue::new(value).range(1..=1_000_000).speed(1.0))
                .on_hover_text(help);
        });
    };
    count(
        ui,
        "Iterations",
        &mut settings.max_iterations,
        "At most so many per run",
    );
    form_row(ui, "Settled below", LABEL, |ui| {
        let value = &mut settings.motion_tolerance;
        ui.add(
            DragValue::new(value)
                .range(0.0..=1.0)
                .speed(1e-4)
                .max_decimals(6),
        )
        .on_hover_text("A step that moves no corner by more than this share of an edge length");
        caption(ui, "edge lengths");
    });
    form_row(ui, "Normals within", LABEL, |ui| {
        let value = &mut settings.max_normal_angle_deg;
        ui.add(
            DragValue::new(value)
                .range(1.0..=180.0)
                .speed(0.5)
                .suffix("°"),
        )
        .on_hover_text("Largest angle between the normals of a pair; 180° lets all through");
    });
    form_row(ui, "Allowance", LABEL, |ui| {
        ui.add(
            DragValue::new(&mut settings.allowance)
                .range(0.0..=1e6)
                .speed(0.01)
                .suffix(unit),
        )
        .on_hover_text("Deviation to be expected besides faceting, such as springback");
    });
    let help = "Points of the first and the second stage of the race";
    count(ui, "Race points", &mut settings.n_race_points, help);
    count(ui, "Refine points", &mut settings.n_refine_points, help);
}

/// Which meshes the search runs on.
fn level_ui(ui: &mut Ui, state: &AppState, recipe: &mut MatchRecipe) {
    let is_reduced = state
        .document
        .parts
        .iter()
        .any(|(_, part)| part.as_ref().is_some_and(|part| part.level.is_some()));
    if is_reduced {
        caption(ui, "The starts run on the levels of section 2");
    } else {
        let mut is_on = recipe.max_triangles.is_some();
        ui.horizontal(|ui| {
            ui.checkbox(&mut is_on, "Reduce first to");
            if is_on != recipe.max_triangles.is_some() {
                recipe.max_triangles = is_on.then_some(2000);
            }
            if let Some(n) = &mut recipe.max_triangles {
                ui.name_inputs("Triangles for the search", |ui| {
                    ui.add(DragValue::new(n).range(100..=10_000_000).speed(20.0));
                });
            }
        });
    }
    ui.checkbox(&mut recipe.settings.finish, "Finish on the full meshes");
    ui.add_space(UNIT / 2.0);
}
