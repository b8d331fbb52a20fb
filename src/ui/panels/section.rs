//! The frame of the three sections: number, title, summary, fold.

use crate::app::{AppState, Command, Section, ViewCommand};
use crate::ui::theme::{Palette, TALL, UNIT};
use egui::{
    Align2, CornerRadius, FontId, Margin, Rect, Sense, Stroke, TextStyle, Ui, UiBuilder, pos2, vec2,
};

/// A section: its header is always there, its body while it is unfolded.
pub fn section_ui(
    ui: &mut Ui,
    state: &AppState,
    section: Section,
    summary: &str,
    commands: &mut Vec<Command>,
    body: impl FnOnce(&mut Ui, &mut Vec<Command>),
) {
    let (index, title) = match section {
        Section::Load => (0, "Load & display"),
        Section::Reduce => (1, "Reduce"),
        Section::Match => (2, "Match"),
    };
    let is_open = state.view.open_sections[index];
    if header_ui(ui, state, section, (index, title, summary)) {
        commands.push(ViewCommand::ToggleSection(index).into());
    }
    if !is_open {
        return;
    }
    let margin = Margin {
        left: 16,
        right: 16,
        top: 4,
        bottom: 12,
    };
    // A child of fixed width: nothing in it may push the edges of those below outwards.
    let room = ui.available_rect_before_wrap() - margin;
    let mut inner = ui.new_child(UiBuilder::new().max_rect(room).id_salt(title));
    inner.spacing_mut().item_spacing = vec2(UNIT, 6.0);
    body(&mut inner, commands);
    let height = inner.min_rect().height() + margin.sum().y;
    ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
}

/// Draws the header; true if it was clicked.
fn header_ui(
    ui: &mut Ui,
    state: &AppState,
    section: Section,
    (index, title, summary): (usize, &str, &str),
) -> bool {
    let palette = Palette::of(ui);
    let is_open = state.view.open_sections[index];
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TALL), Sense::click());
    let name = format!("{} {title}", index + 1);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_open, &name));
    let painter = ui.painter();
    if index > 0 {
        painter.hline(rect.x_range(), rect.top(), Stroke::new(1.0, palette.line));
    }
    if response.hovered() || response.has_focus() {
        let inner = rect.shrink2(vec2(4.0, 2.0));
        painter.rect_filled(inner, 4.0, palette.card);
        if response.has_focus() {
            let ring = Stroke::new(1.5, palette.accent_text);
            painter.rect_stroke(inner, 4.0, ring, egui::StrokeKind::Inside);
        }
    }
    let middle = rect.center().y;
    let badge = Rect::from_center_size(pos2(rect.left() + 25.0, middle), vec2(18.0, 18.0));
    painter.rect_filled(badge, CornerRadius::same(9), palette.widget);
    let small = TextStyle::Small.resolve(ui.style());
    let number = (index + 1).to_string();
    painter.text(
        badge.center(),
        Align2::CENTER_CENTER,
        number,
        small.clone(),
        palette.text,
    );
    let title_font = FontId::proportional(15.0);
    let at = pos2(badge.right() + UNIT, middle);
    let title_rect = painter.text(at, Align2::LEFT_CENTER, title, title_font, palette.text);
    paint_fold(painter, pos2(rect.right() - 24.0, middle), is_open, palette);
    let stale = state.stale(section);
    let (text, color) = match stale {
        Some(_) => ("⚠ out of date", palette.check),
        None => (summary, palette.secondary),
    };
    let room = rect.right() - 40.0 - title_rect.right() - UNIT;
    let galley = elided(ui, text, small, color, room);
    let at = pos2(
        rect.right() - 40.0 - galley.size().x,
        middle - galley.size().y / 2.0,
    );
    ui.painter().galley(at, galley, color);
    let response = match stale {
        Some(stale) => response.on_hover_text(format!("Out of date: {}", stale.reason)),
        None => response,
    };
    response.clicked()
}

/// One line of text, cut with an ellipsis where it does not fit.
pub fn elided(
    ui: &Ui,
    text: &str,
    font: FontId,
    color: egui::Color32,
    room: f32,
) -> std::sync::Arc<egui::Galley> {
    let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(0.0));
    ui.painter().layout_job(job)
}

fn paint_fold(painter: &egui::Painter, at: egui::Pos2, is_open: bool, palette: &Palette) {
    let corners = if is_open {
        [vec2(-4.0, -2.5), vec2(4.0, -2.5), vec2(0.0, 3.0)]
    } else {
        [vec2(-2.5, -4.0), vec2(3.0, 0.0), vec2(-2.5, 4.0)]
    };
    let points = corners.map(|corner| at + corner).to_vec();
    painter.add(egui::Shape::convex_polygon(
        points,
        palette.secondary,
        Stroke::NONE,
    ));
}
