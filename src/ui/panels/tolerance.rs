//! How far the shapes may differ, beside the verdict.

use egui::Ui;

use crate::app::{AppState, Command, MatchCommand, MatchResult};
use crate::registration::limits;
use crate::settings::setting;
use crate::ui::row_end::RowEnd;
use crate::ui::typed::{Takes, told_field};
use crate::ui::widgets::{caption, chip};

const TOLERANCE_HELP: &str = "Shape tolerance: how far the shapes may differ besides springback. The \
                              verdict follows at once; the pose stays. An empty field takes the automatic \
                              tolerance";

/// Air between the verdict and the name of the tolerance.
const AIR: f32 = 6.0;

/// What the tolerance is called, as long as there is room: in a narrow column its name would touch the verdict.
fn tolerance_name_ui(ui: &mut Ui, label: &str) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let fits = |name: &&str| {
        let color = egui::Color32::PLACEHOLDER;
        let laid = ui
            .painter()
            .layout_no_wrap((*name).to_owned(), font.clone(), color);
        laid.size().x + AIR < ui.available_width()
    };
    if let Some(name) = [label, "tolerance", "tol."].into_iter().find(fits) {
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| caption(ui, name));
    }
}

/// The tolerance of the verdict, at the end of its row; another one gives a new verdict.
pub(super) fn tolerance_ui(
    ui: &mut Ui,
    state: &AppState,
    result: &MatchResult,
    commands: &mut Vec<Command>,
) {
    let (Some(setting), Some(shape)) = (
        setting("shape-tolerance"),
        result.run.assessment.shape.as_ref(),
    ) else {
        return;
    };
    let mut recipe = state.document.recipe.clone();
    let tolerance = &mut recipe.settings.shape_tolerance;
    let is_automatic = *tolerance == 0.0;
    let usual = shape.tolerance.remainder;
    let mut shown = if is_automatic { usual } else { *tolerance };
    let is_free = state.jobs.locking_job().is_none();
    let end = RowEnd::new(ui, "tolerance");
    end.before(ui, |ui| tolerance_name_ui(ui, setting.label));
    end.show(ui, |ui| {
        if !is_free {
            ui.disable();
        }
        let takes = Takes::length(setting.label, state.lengths(), limits::LENGTH);
        let lengths = state.lengths();
        let before = shown;
        let field = takes.field(&mut shown).speed(0.01 * usual).max_decimals(4);
        let field = if is_automatic {
            field.custom_formatter(move |value, _| lengths.number(value))
        } else {
            field
        };
        let field = told_field(ui, setting.label, before, field, |text| match text.trim() {
            // The automatic one.
            "" => Ok(0.0),
            text => takes.read(text),
        });
        if field.on_hover_text(TOLERANCE_HELP).changed() {
            *tolerance = shown;
        }
        let auto = chip(ui, "auto", is_automatic);
        let auto = auto.on_hover_text("The larger of 1 mm and the thickness of the sheet");
        if auto.clicked() {
            *tolerance = 0.0;
        }
    });
    if recipe != state.document.recipe {
        commands.push(MatchCommand::SetRecipe(Box::new(recipe)).into());
    }
}
