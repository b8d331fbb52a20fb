//! The left column folded to a rail: the numbers of its sections, each of which unfolds it.

use egui::{CornerRadius, Frame, Panel, Rect, Sense, Stroke, TextStyle, Ui, pos2, vec2};

use crate::app::{AppState, Command, Section, ViewCommand};
use crate::ui::theme::{Palette, TALL};
use crate::ui::widgets::focus_ring;

/// Width of the rail.
const WIDTH: f32 = 40.0;

/// The rail.
pub fn rail_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    Panel::left("rail")
        .resizable(false)
        .exact_size(WIDTH)
        .frame(Frame::NONE)
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for section in Section::ALL {
                number_ui(ui, state, section, commands);
            }
        });
}

/// The number of a section, marked if it is out of date.
fn number_ui(ui: &mut Ui, state: &AppState, section: Section, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(WIDTH, TALL), Sense::click());
    let number = (section.index() + 1).to_string();
    let title = section.title();
    let name = format!("{number} {title}");
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, false, &name));
    if response.hovered() {
        ui.painter()
            .rect_filled(rect.shrink(2.0), 4.0, palette.hovered);
    }
    focus_ring(ui, rect.shrink(2.0), &response);
    let badge = Rect::from_center_size(rect.center(), vec2(20.0, 20.0));
    ui.painter()
        .rect_filled(badge, CornerRadius::same(10), palette.widget);
    let font = TextStyle::Small.resolve(ui.style());
    ui.painter().text(
        badge.center(),
        egui::Align2::CENTER_CENTER,
        number,
        font,
        palette.text,
    );
    let stale = state.stale(section);
    let question = state.open_question(section);
    if stale.is_some() || question.is_some() {
        let at = pos2(badge.right(), badge.top() + 2.0);
        ui.painter().circle_filled(at, 3.5, palette.check);
    }
    let tip = match (question, stale) {
        (Some(question), _) => format!("{title}\n{}", question.text),
        (None, Some(stale)) => format!("{title}\nOut of date: {}", stale.reason),
        (None, None) => title.to_owned(),
    };
    if response.on_hover_text(tip).clicked() {
        commands.push(ViewCommand::ShowSection(section).into());
    }
}

/// The button that folds the column and unfolds it, as a window with its left part set off.
pub fn fold_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let is_folded = state.view.is_column_folded();
    let (rect, response) = ui.allocate_exact_size(vec2(28.0, 24.0), Sense::click());
    let name = if is_folded {
        "Unfold the left column"
    } else {
        "Fold the left column"
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, palette.hovered);
    }
    focus_ring(ui, rect, &response);
    let icon = Rect::from_center_size(rect.center(), vec2(15.0, 12.0));
    let stroke = Stroke::new(1.3, palette.secondary);
    ui.painter()
        .rect_stroke(icon, 2.0, stroke, egui::StrokeKind::Inside);
    let split = icon.left() + 5.5;
    ui.painter().vline(split, icon.y_range(), stroke);
    if !is_folded {
        let part = Rect::from_min_max(icon.min, pos2(split, icon.bottom()));
        ui.painter().rect_filled(part, 2.0, palette.secondary);
    }
    if response.on_hover_text(format!("{name}   Ctrl+B")).clicked() {
        commands.push(ViewCommand::FoldColumn(!is_folded).into());
    }
}
