//! What the right window is used for while its part is in the left one.

use egui::{CornerRadius, Rect, Shape, Ui, UiBuilder, vec2};

use super::header::{fitted, shield};
use super::{MARGIN, Overlay};
use crate::app::{AppState, Command, FreeWindow, ViewCommand};
use crate::role::Role;
use crate::ui::focus;
use crate::ui::pictures::clickable;
use crate::ui::widgets::segments;

/// Size of the choice.
const WIDTH: f32 = 496.0;
const HEIGHT: f32 = 28.0;

/// Where the row of choices has no room the choice is a menu.
const NARROW: f32 = 400.0;
const MENU: f32 = 150.0;
/// Room for the folded legend.
const LEGEND: f32 = 84.0;
/// How far the choice and what it says reach down.
pub(super) const BELOW_CHOICE: f32 = 2.0 + HEIGHT + 8.0 + 22.0;

/// The choice between the uses.
pub fn free_choice(ui: &mut Ui, state: &AppState, width: f32, commands: &mut Vec<Command>) {
    let now = state.free_window();
    if width < NARROW {
        free_menu(ui, state, width.min(MENU), commands);
        return;
    }
    let label = |free: FreeWindow| (free.label(), now == Some(free), state.can_use_free(free));
    let labels = FreeWindow::ALL.map(label);
    if let Some(index) = segments(ui, &labels, width) {
        commands.push(ViewCommand::SetFreeWindow(FreeWindow::ALL[index]).into());
    }
}

/// The same as a menu.
fn free_menu(ui: &mut Ui, state: &AppState, width: f32, commands: &mut Vec<Command>) {
    let now = state.free_window();
    let menu = egui::ComboBox::from_id_salt("free window")
        .selected_text(now.map_or("", FreeWindow::label))
        .width(width)
        .truncate();
    ui.name_inputs("Use of the right window", |ui| {
        focus::menu(ui, menu, |ui| {
            for free in FreeWindow::ALL {
                let is_on = now == Some(free);
                let row = egui::Button::selectable(is_on, free.label());
                let choice = ui.add_enabled(state.can_use_free(free), row);
                if focus::chosen(ui, is_on, choice).clicked() {
                    commands.push(ViewCommand::SetFreeWindow(free).into());
                }
            }
        });
    });
}

/// The choice in the upper left corner, and below it what is shown.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let is_here = over.role() == Role::Stamped && over.frame.view.over >= 1.0;
    let Some(free) = over.frame.state.free_window().filter(|_| is_here) else {
        return;
    };
    let painter = over.painter(ui);
    let room = over.frame.rect().width() - 2.0 * MARGIN - 8.0;
    let width = if room < NARROW { MENU } else { WIDTH };
    let width = width.min(room);
    let corner = over.frame.rect().min + vec2(MARGIN + 4.0, MARGIN + 2.0);
    let area = Rect::from_min_size(corner, vec2(width, HEIGHT));
    let plate = area.expand(4.0);
    clickable(ui, |ui| {
        let ground = Shape::rect_filled(plate, CornerRadius::same(6), over.frame.look.plate);
        over.painter(ui).add(ground);
        shield(ui, plate);
        ui.scope_builder(UiBuilder::new().max_rect(area), |ui| {
            free_choice(ui, over.frame.state, width, commands);
        });
    });
    let corner = area.left_bottom() + vec2(-4.0, 8.0);
    let weak = over.frame.look.weak;
    // A narrow window has the legend beside it.
    let beside = if room < NARROW { LEGEND } else { 8.0 };
    let fitted = |text: &str| fitted(&painter, text.to_owned(), 11.5, (weak, room - beside));
    let says = says(over.frame.state, free);
    let mut text = fitted(says);
    if text.elided {
        // What is seen comes first; how it is seen is left out rather than cut.
        text = fitted(says.split(" · ").next().unwrap_or_default());
    }
    let plate = Rect::from_min_size(corner, text.size() + vec2(16.0, 8.0));
    painter.rect_filled(plate, CornerRadius::same(6), over.frame.look.plate);
    painter.galley(corner + vec2(8.0, 4.0), text, weak);
}

fn says(state: &AppState, free: FreeWindow) -> &'static str {
    match free {
        FreeWindow::Nothing | FreeWindow::Section => "",
        FreeWindow::Deviation => "distance between the parts · same camera",
        FreeWindow::Stamped if !state.shown_further().is_empty() => {
            "stamped files at their poses · same camera"
        }
        FreeWindow::Stamped => "stamped part at its pose · same camera",
        // Two sheets that lie in each other show the colours of one.
        FreeWindow::FullMesh if state.is_mapping_shown() => {
            "both parts without reduction, the stamped one in front · same camera"
        }
        FreeWindow::FullMesh => "both parts without reduction · same camera",
        FreeWindow::Alternative => {
            let result = state.document.current_result();
            match result.and_then(|result| result.alternative) {
                Some(_) => "the best pose of the match · same camera",
                None if state.has_alike_pose() => "the next best pose of the match · same camera",
                None => "the next best pose, which fits clearly worse · same camera",
            }
        }
    }
}
