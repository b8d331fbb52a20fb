//! Undo steps with small pictures of poses; a click goes there.

use egui::{Rect, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use super::thumbnails::Thumbnails;
use crate::app::{
    Action, AppState, Command, Document, HistoryCommand, HistoryRow, StepKind, clock_text,
};
use crate::ui::theme::Palette;
use crate::ui::widgets::plain_action;

/// Height of a row, with room for a picture.
const HEIGHT: f32 = 34.0;
/// Size of the pictures.
const PICTURE: egui::Vec2 = vec2(48.0, 30.0);

/// The list, oldest first; the present step is marked, what was undone is quiet.
pub fn history_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        plain_action(ui, state, Action::Undo, commands);
        plain_action(ui, state, Action::Redo, commands);
        plain_action(ui, state, Action::ResetAll, commands);
    });
    let thumbnails = Thumbnails::of(ui.ctx());
    let mut thumbnails = thumbnails.lock();
    let n_done = state.history.n_done();
    let n_rows = n_done + state.history.n_undone() + 1;
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::vertical()
        .id_salt("history")
        .auto_shrink([false, false]);
    // The present step is seen after every step, wherever the list was scrolled to before.
    let id = egui::Id::unique("step that the history shows");
    if ui.data(|data| data.get_temp(id)) != Some(n_done) {
        ui.data_mut(|data| data.insert_temp(id, n_done));
        let above = 0.5 * (ui.available_height() - HEIGHT);
        area = area.vertical_scroll_offset((HEIGHT * n_done as f32 - above).max(0.0));
    }
    area.show_rows(ui, HEIGHT, n_rows, |ui, range| {
        for number in range {
            row_ui(ui, number, state, &mut thumbnails, commands);
        }
    });
    thumbnails.make(ui, state);
}

/// The work after so many steps.
fn row_ui(
    ui: &mut Ui,
    number: usize,
    state: &AppState,
    thumbnails: &mut Thumbnails,
    commands: &mut Vec<Command>,
) {
    let n_done = state.history.n_done();
    let row = number
        .checked_sub(1)
        .and_then(|index| state.history.row(index, &state.document));
    let name = row.as_ref().map_or("Start", |row| row.name);
    let (is_now, is_undone) = (number == n_done, number > n_done);
    let can_jump = state.jobs.is_unlocked().is_ok() && !is_now;
    let sense = if can_jump {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), sense);
    let when = if is_undone { ", undone" } else { "" };
    let spoken = format!("Step {number}: {name}{when}");
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, can_jump, is_now, &spoken));
    let palette = Palette::of(ui);
    let painter = ui.painter();
    if is_now {
        painter.rect_filled(rect, 4.0, palette.hovered);
        let line = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
        painter.rect_filled(line, 1.5, palette.accent);
    } else if response.hovered() && can_jump {
        painter.rect_filled(rect, 4.0, palette.widget);
    }
    let color = if is_undone {
        palette.secondary.gamma_multiply(0.75)
    } else {
        palette.text
    };
    let font = egui::TextStyle::Body.resolve(ui.style());
    let middle = rect.center().y;
    let left_center = egui::Align2::LEFT_CENTER;
    let count = pos2(rect.left() + 36.0, middle);
    let right_center = egui::Align2::RIGHT_CENTER;
    painter.text(count, right_center, number, font.clone(), palette.secondary);
    if let Some(row) = &row {
        let sign = pos2(rect.left() + 58.0, middle);
        painter.text(
            sign,
            egui::Align2::CENTER_CENTER,
            row.kind.sign(),
            font.clone(),
            color,
        );
        let at = pos2(rect.right() - 12.0, middle);
        let time = clock_text(state.log.clock.day_time_at(row.at));
        painter.text(at, right_center, time, font.clone(), palette.secondary);
    }
    let label = pos2(rect.left() + 136.0, middle);
    painter.text(label, left_center, name, font, color);
    if let Some(row) = row.as_ref().filter(|row| has_picture(row, &state.document)) {
        let place = Rect::from_min_size(pos2(rect.left() + 76.0, middle - 15.0), PICTURE);
        let mut place = ui.new_child(UiBuilder::new().max_rect(place));
        if is_undone {
            place.set_opacity(0.5);
        }
        let pose = Some(*row.document.crash_from_stamped());
        thumbnails.show(&mut place, state, pose, PICTURE);
    }
    let hint = row.map_or("The empty window", |row| row.kind.word());
    if response.on_hover_text(hint).clicked() {
        commands.push(HistoryCommand::JumpTo(number).into());
    }
}

/// A pose has a picture if it is of the parts that are loaded now.
fn has_picture(row: &HistoryRow<'_>, now: &Document) -> bool {
    let moves = matches!(row.kind, StepKind::Pose | StepKind::Match);
    moves && now.both().is_some() && row.document.stamp().parts == now.stamp().parts
}
