//! The line across a window that wipes between the parts or splits reduced from full.

use egui::{
    Align2, CornerRadius, CursorIcon, FontId, Pos2, Rect, Role as WidgetRole, Sense, Stroke, Ui,
    Vec2, WidgetInfo, vec2,
};

use super::Overlay;
use crate::app::{AppState, Command, ViewCommand};
use crate::ui::pictures::is_screen_taken;
use crate::ui::viewport::visible_parts::{Divider, divider};

/// How far beside the line it can be grabbed.
const SLOP: f32 = 6.0;
/// The line stays inside the window.
const ENDS: std::ops::RangeInclusive<f32> = 0.02..=0.98;

/// Draws the line with what lies on either side of it, and drags it.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let Some(divider) = divider(over.frame.state, over.frame.view) else {
        return;
    };
    let x = over.frame.rect().left() + divider.share() * over.frame.rect().width();
    let line = Rect::from_x_y_ranges(x..=x, over.frame.rect().y_range());
    let id = ui.make_persistent_id(("divider", over.role().word()));
    let response = ui.interact(line.expand2(vec2(SLOP, 0.0)), id, Sense::drag());
    let names = names(divider, over.frame.state);
    let label = format!("Line between {} and {}", names[0], names[1]);
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Slider, true, &label));
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if let Some(pos) = response
        .interact_pointer_pos()
        .filter(|_| response.dragged())
    {
        let share = (pos.x - over.frame.rect().left()) / over.frame.rect().width();
        let share = share.clamp(*ENDS.start(), *ENDS.end());
        let mut display = over.frame.state.view.display.clone();
        match divider {
            Divider::Wipe(_) => display.wipe = Some(share),
            Divider::Split(_) => display.split = Some(share),
        }
        commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    }
    let width = if response.hovered() || response.dragged() {
        2.5
    } else {
        1.5
    };
    paint(ui, over, line, width);
    sides(ui, over, names, x);
}

/// What lies on either side.
fn names(divider: Divider, state: &AppState) -> [&'static str; 2] {
    match divider {
        Divider::Wipe(_) if state.is_mapping_apart() => ["mapped", "stamped"],
        Divider::Wipe(_) => ["crash", "stamped"],
        Divider::Split(_) => ["reduced", "full"],
    }
}

fn paint(ui: &Ui, over: &Overlay<'_>, line: Rect, width: f32) {
    let painter = over.painter(ui);
    let ends = [line.center_top(), line.center_bottom()];
    painter.line_segment(ends, Stroke::new(width + 2.5, over.frame.look.plate));
    painter.line_segment(ends, Stroke::new(width, over.frame.look.tool));
    if is_screen_taken(ui.ctx()) {
        return;
    }
    let grip = line.center();
    painter.circle(
        grip,
        9.0,
        over.frame.look.plate,
        Stroke::new(1.5, over.frame.look.tool),
    );
    for side in [-1.0, 1.0] {
        let tip = grip + vec2(side * 5.5, 0.0);
        let back = Vec2::new(-side * 3.0, 0.0);
        for leg in [-3.0, 3.0] {
            let stroke = Stroke::new(1.5, over.frame.look.tool);
            painter.line_segment([tip, tip + back + vec2(0.0, leg)], stroke);
        }
    }
}

/// The names of the two sides, at the foot of the line.
fn sides(ui: &Ui, over: &Overlay<'_>, names: [&str; 2], x: f32) {
    let painter = over.painter(ui);
    let y = over.frame.rect().bottom() - 52.0;
    let places = [(-8.0, Align2::RIGHT_CENTER), (8.0, Align2::LEFT_CENTER)];
    for (name, (shift, align)) in names.into_iter().zip(places) {
        let font = FontId::proportional(11.5);
        let galley = painter.layout_no_wrap(name.to_owned(), font, over.frame.look.text);
        let area = align.anchor_size(Pos2::new(x + shift, y), galley.size());
        painter.rect_filled(
            area.expand2(vec2(6.0, 3.0)),
            CornerRadius::same(5),
            over.frame.look.plate,
        );
        painter.galley(area.min, galley, over.frame.look.text);
    }
}
