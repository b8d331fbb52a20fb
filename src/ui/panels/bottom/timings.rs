//! Times of the steps as bars.

use egui::{Align2, Rect, ScrollArea, Sense, TextStyle, Ui, pos2, vec2};

use super::super::section::elided;
use crate::app::{AppState, LogRow, duration_text};
use crate::ui::theme::Palette;
use crate::ui::widgets::nothing_yet;

/// Width of the names, points.
const TITLES: f32 = 144.0;

/// One bar for each step that took time, in order; lengths share one scale.
pub fn timings_ui(ui: &mut Ui, state: &AppState) {
    let rows: Vec<&LogRow> = state
        .log
        .rows()
        .iter()
        .filter(|r| r.took.is_some())
        .collect();
    let longest = rows.iter().filter_map(|row| row.took).max();
    let Some(longest) = longest.filter(|longest| !longest.is_zero()) else {
        nothing_yet(
            ui,
            "No times yet",
            "Load, reduce and match to see where the time goes",
        );
        return;
    };
    ScrollArea::vertical()
        .id_salt("timings")
        .auto_shrink([false, false])
        .stick_to_bottom(true)
        .show_rows(ui, 20.0, rows.len(), |ui, range| {
            for row in &rows[range] {
                let took = row.took.unwrap_or_default();
                bar_ui(ui, row, (took.as_secs_f64() / longest.as_secs_f64()) as f32);
            }
        });
}

fn bar_ui(ui: &mut Ui, row: &LogRow, share: f32) {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 20.0), Sense::hover());
    let font = TextStyle::Body.resolve(ui.style());
    let middle = rect.center().y;
    let role = row.role.map_or("", crate::role::Role::mark);
    let name = format!("{role} {}", row.title());
    let color = row
        .role
        .map_or(palette.accent_text, |role| palette.role(role));
    let left = pos2(rect.left(), middle);
    let title = elided(ui, name.trim(), font.clone(), palette.text, TITLES - 8.0);
    let at = left - vec2(0.0, 0.5 * title.size().y);
    ui.painter().galley(at, title, palette.text);
    let painter = ui.painter();
    let bars = rect.left() + TITLES;
    let room = (rect.right() - bars - 96.0).max(16.0);
    let bar = Rect::from_min_max(
        pos2(bars, middle - 5.0),
        pos2(bars + (share * room).max(2.0), middle + 5.0),
    );
    painter.rect_filled(bar, 2.0, color);
    let text = duration_text(row.took.unwrap_or_default());
    let at = pos2(bar.right() + 8.0, middle);
    painter.text(at, Align2::LEFT_CENTER, &text, font, palette.secondary);
    let spoken = format!("{} {text}", name.trim());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &spoken));
    response.on_hover_text(&row.text);
}
