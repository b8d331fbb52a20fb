//! Every setting of a match behind the gear, as the table of settings has them.

use egui::Ui;

use super::setting_form::{Gear, USUAL_LEVEL, setting_ui};
use crate::app::AppState;
use crate::registration::{MatchSettings, Method};
use crate::settings::{Group, MatchRecipe, SETTINGS, Setting};
use crate::ui::theme::UNIT;
use crate::ui::widgets::{card, segments};

/// The gear that shows and hides the settings.
pub const GEAR: Gear = Gear {
    id: "recipe is open",
    what: "match settings",
};

/// The form, while the gear is on.
pub fn recipe_ui(ui: &mut Ui, state: &AppState, recipe: &mut MatchRecipe) {
    if !GEAR.is_on(ui) {
        return;
    }
    let usual = usual(recipe);
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
                setting_ui(ui, state, setting, (recipe, &usual));
            }
        }
    });
}

/// True if a setting behind the gear is not the method's.
pub fn has_own_settings(recipe: &MatchRecipe) -> bool {
    let usual = usual(recipe);
    let is_own = |row: &Setting| row.group != Group::Method && row.get(recipe) != row.get(&usual);
    SETTINGS.iter().any(is_own)
}

/// The recipe that the method brings.
fn usual(recipe: &MatchRecipe) -> MatchRecipe {
    MatchRecipe {
        settings: MatchSettings::of(recipe.settings.method),
        max_triangles: None,
    }
}

/// Whole sets of settings: quick on reduced meshes, the default, and as in the paper.
fn presets_ui(ui: &mut Ui, recipe: &mut MatchRecipe) {
    let preset = |method, max_triangles| {
        let mut settings = recipe.settings.clone();
        settings.set_method(method);
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
