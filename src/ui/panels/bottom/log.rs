//! What was done and how long it took.

use crate::app::{
    Action, AppState, Command, ExportCommand, ExportKind, LogRow, NoticeLevel, duration_text,
};
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{caption, level_color, nothing_yet, paint_role_mark, plain_action};
use egui::{Align, Layout, Rect, RichText, Ui, Vec2};
use egui_extras::{Column, TableBuilder};

const LINE: f32 = 20.0;

/// The table, newest row in sight, and the sums.
pub fn log_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let rows = state.log.rows();
    if rows.is_empty() {
        nothing_yet(
            ui,
            "Nothing was done yet",
            "Every step is written here with the time it took",
        );
        return;
    }
    let height = (ui.available_height() - ROW - 4.0).max(LINE);
    ui.allocate_ui(egui::vec2(ui.available_width(), height), |ui| {
        ui.set_min_height(height);
        ui.spacing_mut().item_spacing.y = 0.0;
        TableBuilder::new(ui)
            .id_salt("log")
            .stick_to_bottom(true)
            .auto_shrink([false, false])
            .min_scrolled_height(0.0)
            .max_scroll_height(height)
            .cell_layout(Layout::left_to_right(Align::Center))
            .column(Column::exact(56.0))
            .column(Column::exact(64.0))
            .column(Column::exact(16.0))
            .column(Column::remainder().clip(true))
            .column(Column::exact(88.0))
            .body(|body| {
                body.rows(LINE, rows.len(), |mut table_row| {
                    let row = &rows[table_row.index()];
                    table_row.col(|ui| {
                        caption(ui, clock(row.at));
                    });
                    table_row.col(|ui| {
                        ui.label(row.step);
                    });
                    table_row.col(|ui| role_cell(ui, row));
                    table_row.col(|ui| text_cell(ui, row));
                    table_row.col(|ui| {
                        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                            ui.add_space(8.0);
                            if let Some(took) = row.took {
                                ui.label(duration_text(took));
                            }
                        });
                    });
                });
            });
    });
    ui.horizontal(|ui| {
        let total = duration_text(state.log.total());
        caption(
            ui,
            format!("total {total} · build {}", crate::report::build_id()),
        );
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("Save log…").clicked() {
                commands.push(ExportCommand::AskSave(ExportKind::Log).into());
            }
            plain_action(ui, state, Action::CopyLog, commands);
        });
    });
}

/// Minutes, seconds and tenths since the window opened.
fn clock(at: std::time::Duration) -> String {
    let tenths = at.as_millis() / 100;
    format!(
        "{:02}:{:02}.{}",
        tenths / 600,
        tenths / 10 % 60,
        tenths % 10
    )
}

fn role_cell(ui: &mut Ui, row: &LogRow) {
    let Some(role) = row.role else { return };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(12.0), egui::Sense::hover());
    let mark = Rect::from_center_size(rect.center(), Vec2::splat(9.0));
    paint_role_mark(ui.painter(), mark, role, Palette::of(ui).role(role));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, role.word()));
}

fn text_cell(ui: &mut Ui, row: &LogRow) {
    let palette = Palette::of(ui);
    let text = if row.level >= NoticeLevel::Note {
        let text = format!("{} {}", row.level.mark(), row.text);
        RichText::new(text).color(level_color(palette, row.level))
    } else {
        RichText::new(&row.text)
    };
    ui.add(egui::Label::new(text).truncate().selectable(true));
}
