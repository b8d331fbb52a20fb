//! The bar of colours with its ticks.

use egui::{
    Align, Align2, Color32, CursorIcon, FontId, Layout, Painter, Pos2, Rect, Response, RichText,
    Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};

use super::limits::{self, Limit};
use super::menu;
use super::tick_text;
use crate::app::Command;
use crate::colormap::{ColorScale, Pattern};
use crate::text::{counted, length, signed};
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{color, ink};
use crate::ui::viewport::fields::{FieldKind, Summary};
use crate::ui::viewport::overlay::Overlay;

/// Width of the bar.
pub(super) const BAR: f32 = 14.0;
/// Least height of the bar.
const LEAST: f32 = 40.0;
/// Left of the figures beside bar and ticks.
const NUMBERS: f32 = 76.0;

/// A mark beside the bar that is dragged up and down; `name` is told to screen readers with the part.
pub(super) struct Grip {
    pub(super) response: Response,
    pub(super) is_held: bool,
    pub(super) color: Color32,
}

impl Grip {
    pub(super) fn new(ui: &Ui, over: &Overlay<'_>, at: Rect, name: &str) -> Self {
        let role = over.role().word();
        let id = ui.make_persistent_id((name, role));
        let response = ui.interact(at, id, Sense::drag());
        let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeVertical);
        response.widget_info(|| {
            WidgetInfo::labeled(egui::Role::Slider, true, format!("{name} ({role})"))
        });
        let is_held = response.hovered() || response.dragged();
        let look = &over.frame.look;
        let color = if is_held { look.tool } else { look.weak };
        Self {
            response,
            is_held,
            color,
        }
    }
}

/// Title, menu, bar with its limits, ticks, and the figures of the values.
pub(super) fn plain(
    ui: &mut Ui,
    over: &Overlay<'_>,
    title: &str,
    scale: &ColorScale,
    height: f32,
    commands: &mut Vec<Command>,
) {
    let head = head(ui, over, title, commands);
    // The bar gives way to a title of several lines.
    let height = (height + ui.spacing().interact_size.y - head).max(LEAST);
    ui.add_space(6.0);
    if over.is_equal() {
        equal(ui, scale, over);
        return;
    }
    let state = over.frame.state;
    let mut display = state.view.display.clone();
    let by = state.color_by(over.role());
    let mut limits = display.limits.get(&by).copied();
    limits::field(ui, over, scale, (Limit::Upper, 0.0), &mut limits);
    let (room, _) = ui.allocate_exact_size(vec2(super::WIDTH, height + 8.0), Sense::hover());
    let bar = Rect::from_min_size(room.min + vec2(2.0, 4.0), vec2(BAR, height));
    paint(ui.painter(), scale, bar, over);
    ticks(ui.painter(), scale, bar, over, true);
    limits::drag_ends(ui, over, scale, bar, &mut limits);
    if limits::is_automatic_asked(ui, over, bar) {
        limits = None;
    }
    if let Some(summary) = over.summary {
        let left = pos2(room.left() + NUMBERS, room.top());
        let room = Rect::from_min_max(left, room.max);
        numbers(ui, over, &summary, (scale, room));
    }
    limits::field(ui, over, scale, (Limit::Lower, 0.0), &mut limits);
    limits::hide_box(ui, over, &mut display.coloring.hides_beyond);
    match limits {
        Some(limits) => display.limits.insert(by, limits),
        None => display.limits.remove(&by),
    };
    menu::set(over, display, commands);
}

/// The title in the width that the buttons beside it leave; returns its height.
fn head(ui: &mut Ui, over: &Overlay<'_>, title: &str, commands: &mut Vec<Command>) -> f32 {
    let row = ui.horizontal(|ui| {
        let end = RowEnd::new(ui, "legend");
        end.before(ui, |ui| {
            ui.with_layout(Layout::top_down(Align::Min), |ui| {
                ui.add(egui::Label::new(RichText::new(title).size(12.0)).wrap());
            });
        });
        end.show(ui, |ui| {
            let values = if over.kind.is_some_and(FieldKind::has_signed_colors) {
                menu::Values::Signed
            } else {
                menu::Values::Plain
            };
            menu::maps(ui, over, values, commands);
            super::fold(ui, over);
        });
    });
    row.response.rect.height()
}

/// Extremes of the values and their mean over the area, and of how many elements or nodes they are.
fn numbers(ui: &mut Ui, over: &Overlay<'_>, of: &Summary, (scale, room): (&ColorScale, Rect)) {
    let number = if scale.min < 0.0 { signed } else { length };
    let values = if of.is_of_elements {
        counted(of.n, "element")
    } else {
        format!("at {}", counted(of.n, "node"))
    };
    let builder = UiBuilder::new()
        .max_rect(room)
        .layout(Layout::top_down(Align::Min));
    let mut beside = ui.new_child(builder);
    for text in [
        format!("max {}", number(of.max)),
        format!("mean {}", number(of.mean())),
        format!("min {}", number(of.min)),
        values,
    ] {
        let text = RichText::new(text).size(11.0);
        beside.label(text.color(over.frame.look.weak));
    }
}

/// The one colour of differences that are all rounding.
pub(super) fn equal(ui: &mut Ui, scale: &ColorScale, over: &Overlay<'_>) {
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(vec2(BAR, BAR), Sense::hover());
        ui.painter()
            .rect_filled(swatch, 0.0, color(scale.color(0.0)));
        let stroke = Stroke::new(1.0, over.frame.look.plate_line);
        ui.painter()
            .rect_stroke(swatch, 0.0, stroke, egui::StrokeKind::Outside);
        ui.label(RichText::new("equal").size(11.0));
    });
}

/// The colours, low values at the foot, with their patterns.
pub(super) fn paint(painter: &Painter, scale: &ColorScale, bar: Rect, over: &Overlay<'_>) {
    let n = bar.height().round().max(1.0) as usize;
    for (i, rgb) in scale.table(n).into_iter().enumerate() {
        let bottom = bar.bottom() - i as f32;
        // Below the next one: rows that end between two pixels leave no seam.
        let top = (bottom - 1.5).max(bar.top());
        let row = Rect::from_min_max(pos2(bar.left(), top), pos2(bar.right(), bottom));
        painter.rect_filled(row, 0.0, color(rgb));
    }
    patterns(painter, bar, |y| {
        let share = f64::from((bar.bottom() - y) / bar.height());
        scale.pattern(scale.value_at(share))
    });
    let stroke = Stroke::new(1.0, over.frame.look.plate_line);
    painter.rect_stroke(bar, 0.0, stroke, egui::StrokeKind::Outside);
}

/// Draws lines and dots over a rectangle as the shader draws them over parts.
pub(super) fn patterns(painter: &Painter, rect: Rect, pattern_at: impl Fn(f32) -> Pattern) {
    const STEP: f32 = 6.0;
    let ink = ink(170);
    let whole = pattern_at(rect.center().y);
    if matches!(whole, Pattern::Rising | Pattern::Falling | Pattern::Crossed) {
        slanted(painter, rect, whole);
        return;
    }
    let n_rows = (rect.height() / STEP) as usize;
    for row in 0..n_rows {
        let y = rect.top() + STEP * (row as f32 + 0.5);
        match pattern_at(y) {
            Pattern::Plain | Pattern::Rising | Pattern::Falling | Pattern::Crossed => {}
            Pattern::Lines => {
                painter.hline(rect.x_range(), y, Stroke::new(1.5, ink));
            }
            Pattern::Dots => {
                let shift = if row % 2 == 0 { 0.25 } else { 0.75 };
                let n = (rect.width() / STEP).ceil() as usize;
                for column in 0..n {
                    let x = rect.left() + STEP * (column as f32 + shift);
                    if x <= rect.right() - 1.0 {
                        painter.circle_filled(pos2(x, y), 1.5, ink);
                    }
                }
            }
        }
    }
}

/// Lines that rise, fall, or both.
fn slanted(painter: &Painter, rect: Rect, pattern: Pattern) {
    let stroke = Stroke::new(1.4, ink(170));
    let painter = painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    let mut x = rect.left() - rect.height();
    while x < rect.right() {
        let (from, to) = (x, x + rect.height());
        if pattern != Pattern::Falling {
            painter.line_segment([pos2(from, rect.bottom()), pos2(to, rect.top())], stroke);
        }
        if pattern != Pattern::Rising {
            painter.line_segment([pos2(from, rect.top()), pos2(to, rect.bottom())], stroke);
        }
        x += 5.0 * std::f32::consts::SQRT_2;
    }
}

/// Round values beside the bar.
///
/// Ends that have a field of their own need no tick.
pub(super) fn ticks(
    painter: &Painter,
    scale: &ColorScale,
    bar: Rect,
    over: &Overlay<'_>,
    has_fields: bool,
) {
    let n_ticks = ((bar.height() / 26.0) as usize).clamp(3, 7);
    let ticks = telling_ticks(scale, n_ticks);
    let is_end = |tick: f64| (scale.position(tick) - 0.5).abs() > 0.46;
    for tick in ticks.iter().filter(|t| !(has_fields && is_end(**t))) {
        let at = Pos2::new(bar.right(), y_of(scale, bar, *tick));
        painter.line_segment(
            [at + vec2(1.0, 0.0), at + vec2(5.0, 0.0)],
            Stroke::new(1.0, over.frame.look.weak),
        );
        painter.text(
            at + vec2(8.0, 0.0),
            Align2::LEFT_CENTER,
            tick_text(*tick, &ticks),
            FontId::proportional(11.0),
            over.frame.look.text,
        );
    }
}

/// Round values, about as many as asked for: one number alone says nothing of a scale.
fn telling_ticks(scale: &ColorScale, n_ticks: usize) -> Vec<f64> {
    let mut finer = (n_ticks..n_ticks + 5).map(|n| scale.ticks(n));
    finer.find(|ticks| ticks.len() > 1).unwrap_or_default()
}

/// Height of a value on the bar.
pub(super) fn y_of(scale: &ColorScale, bar: Rect, value: f64) -> f32 {
    bar.bottom() - scale.position(value) as f32 * bar.height()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colormap::ColorMap;

    #[test]
    fn no_scale_has_one_number_alone() {
        for max in [0.7915, 0.76, 0.753, 0.8, 1.2, 7.0, 1000.0] {
            let scale = ColorScale::new(ColorMap::Viridis, 0.7085, max);
            let n = telling_ticks(&scale, 3).len();
            assert!((2..=5).contains(&n), "{n} up to {max}");
        }
        let empty = ColorScale::new(ColorMap::Viridis, 1.0, 1.0);
        assert!(telling_ticks(&empty, 3).is_empty());
    }
}
