//! Small pieces that every panel uses, so that they look alike everywhere.

use super::focus::is_ringed;
use super::theme::{Palette, ROW, TALL, UNIT, color, ink};
use crate::app::{Action, AppState, Command, NoticeLevel};
use crate::assess::Verdict;
use crate::colormap::ColorScale;
use crate::role::Role;
pub use crate::text::{grouped, length, percent, signed};
use egui::{
    Align, Button, Color32, CornerRadius, Frame, Layout, Margin, Rect, Response, RichText, Sense,
    Stroke, TextStyle, Ui, Vec2, pos2, vec2,
};

/// A count on a chip: full, 50k, 2k, 500.
pub fn short_count(n: usize) -> String {
    if n >= 10_000 || (n >= 1000 && n.is_multiple_of(1000)) {
        format!("{}k", n / 1000)
    } else {
        grouped(n)
    }
}

/// Draws the mark of a part, ■ or ▲, in its colour.
pub fn paint_role_mark(painter: &egui::Painter, rect: Rect, role: Role, color: Color32) {
    match role {
        Role::Crash => {
            let square = Rect::from_center_size(rect.center(), Vec2::splat(rect.width() * 0.78));
            painter.rect_filled(square, 1.0, color);
        }
        Role::Stamped => {
            let (left, right) = (rect.left(), rect.right());
            let points = vec![
                pos2(rect.center().x, rect.top() + rect.height() * 0.06),
                pos2(right, rect.bottom() - rect.height() * 0.08),
                pos2(left, rect.bottom() - rect.height() * 0.08),
            ];
            painter.add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
        }
    }
}

/// The mark of a part as a widget.
pub fn role_mark(ui: &mut Ui, role: Role) -> Response {
    let height = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, height), Sense::hover());
    let mark = Rect::from_center_size(rect.center(), Vec2::splat(11.0));
    paint_role_mark(ui.painter(), mark, role, Palette::of(ui).role(role));
    let name = match role {
        Role::Crash => "Crash, fixed",
        Role::Stamped => "Stamped, moves",
    };
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, role.word()));
    response.on_hover_text(name)
}

/// Text of less weight.
pub fn secondary(ui: &mut Ui, text: impl Into<String>) -> Response {
    let color = Palette::of(ui).secondary;
    ui.label(RichText::new(text).color(color))
}

/// Small quiet text.
pub fn caption(ui: &mut Ui, text: impl Into<String>) -> Response {
    let color = Palette::of(ui).secondary;
    ui.label(RichText::new(text).small().color(color))
}

/// Quiet text that wraps within the column.
pub fn paragraph(ui: &mut Ui, text: impl Into<String>) -> Response {
    let color = Palette::of(ui).secondary;
    ui.add(egui::Label::new(RichText::new(text).color(color)).wrap())
}

/// Tooltip of an action: what it does and its key.
pub fn action_tooltip(action: Action) -> String {
    let info = action.row();
    match info.shortcut() {
        Some(shortcut) => format!("{}   {shortcut}", info.tooltip),
        None => info.tooltip.to_owned(),
    }
}

/// How a button of an action looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Look {
    /// Like all others.
    #[default]
    Plain,
    /// The one thing to do next.
    Primary,
    /// A choice that is on.
    On,
}

/// A button that does an action; disabled with the reason where the action is.
pub fn action_button(
    ui: &mut Ui,
    state: &AppState,
    action: Action,
    button: (&str, Look, Vec2),
    commands: &mut Vec<Command>,
) -> Response {
    let response = told_button(ui, state, action, button, &action_tooltip(action));
    if response.clicked() {
        commands.extend(action.command(state));
    }
    response
}

/// A button that looks like that of an action, with a tooltip of its own; what a click does is left to the caller.
pub fn told_button(
    ui: &mut Ui,
    state: &AppState,
    action: Action,
    button: (&str, Look, Vec2),
    tooltip: &str,
) -> Response {
    let (label, look, size) = button;
    let palette = Palette::of(ui);
    let enabled = action.enabled(state);
    let mut text = RichText::new(label);
    let is_accented = match look {
        Look::Plain => false,
        Look::Primary | Look::On => enabled.is_ok(),
    };
    if is_accented {
        text = text.color(palette.on_accent);
    }
    let mut button = Button::new(text).min_size(size);
    if is_accented {
        button = button.fill(palette.accent);
    }
    let response = ui.add_enabled(enabled.is_ok(), button);
    if is_accented {
        accent_ring(ui, &response);
    }
    match enabled {
        Ok(()) => response.on_hover_text(tooltip),
        Err(reason) => response.on_disabled_hover_text(format!("{tooltip}\n{reason}")),
    }
}

/// [`action_button`] over the whole width of a column.
pub fn wide_action(
    ui: &mut Ui,
    state: &AppState,
    action: Action,
    (label, look, height): (&str, Look, f32),
    commands: &mut Vec<Command>,
) -> Response {
    let size = vec2(ui.available_width(), height);
    ui.horizontal(|ui| action_button(ui, state, action, (label, look, size), commands))
        .inner
}

/// A square button with a sign, for menus and steps; as wide as it is high.
pub fn square(sign: &str, height: f32) -> Button<'static> {
    let text = RichText::new(sign.to_owned()).size(14.0);
    Button::new(text).min_size(vec2(ROW, height))
}

/// Runs `add` with buttons that need no room left and right of their sign.
pub fn tight<R>(ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
    let before = ui.spacing().button_padding.x;
    ui.spacing_mut().button_padding.x = 4.0;
    let result = add(ui);
    ui.spacing_mut().button_padding.x = before;
    result
}

/// Least room on both sides of a label of [`segments`] together.
const AROUND: f32 = 14.0;

/// The widths of segments: the same for all, unless a label would touch the edge of its own; then all have
/// the same room around their labels.
fn segment_widths(ui: &Ui, labels: &[(&str, bool, bool)], width: f32) -> Vec<f32> {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let of = |(label, ..): &(&str, bool, bool)| {
        let text = (*label).to_owned();
        let galley = ui
            .painter()
            .layout_no_wrap(text, font.clone(), Color32::WHITE);
        galley.size().x
    };
    let texts: Vec<f32> = labels.iter().map(of).collect();
    let n = labels.len().max(1) as f32;
    if texts.iter().all(|text| text + AROUND <= width / n) {
        return vec![width / n; labels.len()];
    }
    let around = (width - texts.iter().sum::<f32>()) / n;
    texts.iter().map(|text| text + around).collect()
}

/// Choices side by side in one frame; the index of the one clicked.
pub fn segments(ui: &mut Ui, labels: &[(&str, bool, bool)], width: f32) -> Option<usize> {
    let palette = Palette::of(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(width, ROW + 4.0), Sense::hover());
    let radius = CornerRadius::same(4);
    ui.painter().rect_filled(rect, radius, palette.field);
    let stroke = Stroke::new(1.0, palette.line);
    ui.painter()
        .rect_stroke(rect, radius, stroke, egui::StrokeKind::Inside);
    let widths = segment_widths(ui, labels, rect.width());
    let mut left = rect.left();
    let mut clicked = None;
    for (index, ((label, is_on, can), width)) in labels.iter().zip(widths).enumerate() {
        let cell = Rect::from_min_size(pos2(left, rect.top()), vec2(width, rect.height()));
        left += width;
        let id = ui.unique_id().with(("segment", *label));
        let sense = if *can { Sense::click() } else { Sense::hover() };
        let response = ui.interact(cell, id, sense);
        let inner = cell.shrink(2.0);
        if *is_on {
            ui.painter().rect_filled(inner, 3.0, palette.accent);
        } else if *can && response.hovered() {
            ui.painter().rect_filled(inner, 3.0, palette.hovered);
        }
        if *is_on {
            accent_ring(ui, &response);
        } else {
            focus_ring(ui, inner, &response);
        }
        let color = match (*is_on, *can) {
            (true, _) => palette.on_accent,
            (false, true) => palette.text,
            (false, false) => palette.secondary.gamma_multiply(0.7),
        };
        let font = egui::TextStyle::Body.resolve(ui.style());
        let middle = egui::Align2::CENTER_CENTER;
        ui.painter().text(cell.center(), middle, label, font, color);
        response
            .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, *can, *is_on, label));
        if response.clicked() {
            clicked = Some(index);
        }
    }
    clicked
}

/// [`action_button`] with the action's own label.
pub fn plain_action(
    ui: &mut Ui,
    state: &AppState,
    action: Action,
    commands: &mut Vec<Command>,
) -> Response {
    let label = action.row().label;
    action_button(
        ui,
        state,
        action,
        (label, Look::Plain, vec2(0.0, ROW)),
        commands,
    )
}

/// A small square button with one sign on it, named for those who cannot see the sign.
pub fn icon_button(ui: &mut Ui, sign: &str, name: &str, is_enabled: bool) -> Response {
    let response = tight(ui, |ui| ui.add_enabled(is_enabled, square(sign, ROW)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_enabled, name));
    response.on_hover_text(name)
}

/// The ring around a widget of our own that has the keyboard.
pub fn focus_ring(ui: &Ui, rect: Rect, response: &Response) {
    if is_ringed(response) {
        let ring = Stroke::new(1.5, Palette::of(ui).accent_text);
        let inside = egui::StrokeKind::Inside;
        ui.painter().rect_stroke(rect, 4.0, ring, inside);
    }
}

/// The ring within a widget on the accent colour, on which that of other widgets is hardly seen.
fn accent_ring(ui: &Ui, response: &Response) {
    if is_ringed(response) {
        let ring = Stroke::new(1.5, Palette::of(ui).on_accent);
        let inside = egui::StrokeKind::Inside;
        let rect = response.rect.shrink(2.5);
        ui.painter().rect_stroke(rect, 3.0, ring, inside);
    }
}

/// Adds a field for text, with its border.
pub fn text_field(ui: &mut Ui, field: egui::TextEdit<'_>) -> Response {
    let response = ui.add(field);
    text_border(ui, &response);
    response
}

/// The border of a field for text: on a bright ground its own colour does not tell it from what is around it.
pub fn text_border(ui: &Ui, response: &Response) {
    let palette = Palette::of(ui);
    let border = if response.has_focus() {
        Stroke::new(1.5, palette.accent_text)
    } else {
        Stroke::new(1.0, palette.secondary.gamma_multiply(0.6))
    };
    let inside = egui::StrokeKind::Inside;
    ui.painter().rect_stroke(response.rect, 4.0, border, inside);
}

/// An eye that is open or struck out: the switch that shows something in 3D.
pub fn eye(ui: &Ui, rect: Rect, response: &Response, (is_open, name): (bool, &str)) {
    let can_click = response.sense.senses_click();
    let palette = Palette::of(ui);
    focus_ring(ui, rect, response);
    let color = if is_open {
        palette.text
    } else {
        palette.secondary
    };
    let stroke = Stroke::new(1.2, color);
    let c = rect.center();
    let lid = |up: f32| {
        let points = [
            c + vec2(-6.5, 0.0),
            c + vec2(-3.0, up),
            c + vec2(3.0, up),
            c + vec2(6.5, 0.0),
        ];
        let clear = Color32::TRANSPARENT;
        egui::epaint::CubicBezierShape::from_points_stroke(points, false, clear, stroke)
    };
    ui.painter().add(lid(-5.5));
    ui.painter().add(lid(5.5));
    if is_open {
        ui.painter().circle_filled(c, 2.2, color);
    } else {
        let line = [c + vec2(-6.0, 5.0), c + vec2(6.0, -5.0)];
        ui.painter().line_segment(line, stroke);
    }
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, can_click, is_open, name));
}

/// A chip: one of several choices side by side.
pub fn chip(ui: &mut Ui, label: &str, is_on: bool) -> Response {
    let palette = Palette::of(ui);
    let color = if is_on {
        palette.on_accent
    } else {
        palette.text
    };
    let text = RichText::new(label).color(color);
    let fill = if is_on {
        palette.accent
    } else {
        palette.widget
    };
    let response = ui.add(Button::new(text).fill(fill).min_size(vec2(0.0, ROW)));
    if is_on {
        accent_ring(ui, &response);
    }
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_on, label));
    response
}

/// A raised area that belongs together.
pub fn card<R>(ui: &mut Ui, add_contents: impl FnOnce(&mut Ui) -> R) -> R {
    let palette = Palette::of(ui);
    Frame::new()
        .fill(palette.card)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::symmetric(12, 8))
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            add_contents(ui)
        })
        .inner
}

/// A label in the left column of a form and its widget in the right one.
pub fn form_row<R>(
    ui: &mut Ui,
    label: &str,
    width: f32,
    add_contents: impl FnOnce(&mut Ui) -> R,
) -> R {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let (rect, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::hover());
        let palette = Palette::of(ui);
        let font = egui::TextStyle::Body.resolve(ui.style());
        let galley = ui
            .painter()
            .layout_no_wrap(label.to_owned(), font, palette.secondary);
        let at = pos2(rect.left(), rect.center().y - galley.size().y / 2.0);
        ui.painter().galley(at, galley, palette.secondary);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, label));
        ui.name_inputs(label, add_contents)
    })
    .inner
}

/// True if a [`figure`] of this name and value takes one line.
pub fn figure_fits(ui: &Ui, name: &str, value: &str) -> bool {
    let font = TextStyle::Body.resolve(ui.style());
    let width = |text: &str| {
        let text = text.to_owned();
        let laid = ui
            .painter()
            .layout_no_wrap(text, font.clone(), Color32::WHITE);
        laid.size().x
    };
    width(name) + ui.spacing().item_spacing.x + width(value) <= ui.available_width()
}

/// A name on the left and a value on the right edge, for lists of figures.
pub fn figure(ui: &mut Ui, name: &str, value: &str) -> Response {
    ui.spacing_mut().interact_size.y = 18.0;
    let has_room = figure_fits(ui, name, value);
    let value_ui = |ui: &mut Ui| {
        let right = Layout::right_to_left(Align::Center);
        ui.with_layout(right, |ui| ui.label(value)).inner
    };
    let row = ui.horizontal(|ui| {
        let name = secondary(ui, name);
        if has_room { name | value_ui(ui) } else { name }
    });
    if has_room {
        row.inner
    } else {
        row.inner | ui.horizontal(value_ui).inner
    }
}

/// A button of a question; the usual answer is filled.
pub fn large_button(ui: &mut Ui, label: &str, is_usual: bool) -> Response {
    let palette = Palette::of(ui);
    let size = vec2(88.0, ROW + 4.0);
    if !is_usual {
        return ui.add(Button::new(label).min_size(size));
    }
    let text = RichText::new(label).color(palette.on_accent);
    let button = Button::new(text).fill(palette.accent);
    let response = ui.add(button.min_size(size));
    accent_ring(ui, &response);
    response
}

/// The colour of a verdict.
pub fn verdict_color(palette: &Palette, verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Good => palette.good,
        Verdict::Check => palette.check,
        Verdict::Poor => palette.poor,
    }
}

/// Colour and sign of a level of loudness.
pub fn level_color(palette: &Palette, level: NoticeLevel) -> Color32 {
    match level {
        NoticeLevel::Info => palette.text,
        NoticeLevel::Success => palette.good,
        NoticeLevel::Note => palette.accent_text,
        NoticeLevel::Warning => palette.check,
        NoticeLevel::Error => palette.poor,
    }
}

/// A text that a panel keeps between frames, for example a filter.
pub fn draft(ui: &Ui, id: egui::Id) -> String {
    ui.data(|data| data.get_temp(id)).unwrap_or_default()
}

/// Puts a [`draft`] back.
pub fn set_draft(ui: &Ui, id: egui::Id, text: String) {
    ui.data_mut(|data| data.insert_temp(id, text));
}

/// Centre-aligned message with a title, for tabs that have nothing to show yet.
pub fn nothing_yet(ui: &mut Ui, title: &str, hint: &str) {
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() / 2.0 - TALL).max(UNIT));
        ui.label(title);
        caption(ui, hint);
    });
}

/// Colour and pattern of a stamped file.
pub fn file_swatch(painter: &egui::Painter, rect: Rect, number: usize) {
    let (rgb, is_hatched) = ColorScale::file_look(number);
    painter.rect_filled(rect, 2.0, color(rgb));
    if is_hatched {
        let line = [rect.left_bottom(), rect.right_top()];
        painter.line_segment(line, Stroke::new(1.4, ink(170)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(41_208), "41,208");
        assert_eq!(grouped(999), "999");
        assert_eq!(length(0.041_23), "0.0412");
        assert_eq!(length(1.349), "1.35");
        assert_eq!(length(-128.4), "−128");
        assert_eq!(length(0.0), "0");
        assert_eq!(percent(0.8704), "87.0 %");
        assert_eq!(short_count(50_000), "50k");
        assert_eq!(short_count(500), "500");
        assert_eq!(short_count(34_808), "34k");
    }
}
