//! Picked pairs: numbered marks in the shape and colour of their part, and what the next click picks.

use egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Shape, Stroke, Ui, vec2};

use super::Overlay;
use crate::role::Role;
use crate::ui::viewport::navigation::pos_of;
use crate::ui::widgets::paint_role_mark;

/// From a point to the plate with its number.
const LEADER: egui::Vec2 = vec2(16.0, -20.0);

/// The marks of the parts in this window.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    let pairs = over.frame.state.document.current_pairs();
    if pairs.is_empty() || over.frame.view.over > 0.0 && over.frame.view.over < 1.0 {
        return;
    }
    let painter = over.painter(ui);
    let worst = over
        .frame
        .state
        .document
        .pair_fit()
        .ok()
        .and_then(|fit| fit.worst());
    for (index, pair) in pairs.iter().enumerate() {
        let place = |role: Role| {
            let picked = (*pair.get(role))?;
            let place = over.frame.picture.place_of(role)?;
            pos_of(
                over.frame.rect(),
                &over.frame.view.camera,
                &place.to_window(&picked.point),
            )
        };
        let [crash, stamped] = Role::ALL.map(place);
        if let (Some(from), Some(to)) = (stamped, crash) {
            let stroke = Stroke::new(1.5, over.frame.look.tool);
            painter.extend(Shape::dashed_line(&[from, to], stroke, 4.0, 4.0));
        }
        for (role, at) in [(Role::Crash, crash), (Role::Stamped, stamped)] {
            if let Some(at) = at {
                let is_worst = worst == Some(index);
                mark(&painter, over, role, at, index + 1, is_worst);
            }
        }
    }
}

/// What a click would pick, at the pointer, or the part that is asked for.
pub(super) fn next(ui: &Ui, over: &Overlay<'_>) {
    let Some((pair, asked)) = over.frame.state.next_pick() else {
        return;
    };
    let Some(pos) = ui.input(|i| i.pointer.hover_pos()) else {
        return;
    };
    if !over.frame.response.contains_pointer() || over.drag.is_some() {
        return;
    }
    let painter = over.painter(ui);
    let role = over.pick.map_or(asked, |pick| pick.role);
    let text = match over.pick {
        Some(pick) => format!("{} {}", pair + 1, pick.picked.kind.words()),
        None if over.frame.state.view.is_moved_over || over.role() == asked => {
            format!("{} on the {} part", pair + 1, asked.word())
        }
        None => return,
    };
    let at = over.pick.map_or(pos, |pick| pick.at);
    crosshair(&painter, over, at);
    plate(
        &painter,
        over,
        role,
        at + vec2(16.0, 16.0),
        &text,
        over.frame.look.text,
    );
}

/// A cross with a gap in its middle, so that the place itself stays seen.
pub(super) fn crosshair(painter: &Painter, over: &Overlay<'_>, at: Pos2) {
    for (width, color) in [(4.0, over.frame.look.plate), (1.5, over.frame.look.tool)] {
        let stroke = Stroke::new(width, color);
        for way in [
            vec2(1.0, 0.0),
            vec2(-1.0, 0.0),
            vec2(0.0, 1.0),
            vec2(0.0, -1.0),
        ] {
            painter.line_segment([at + way * 4.0, at + way * 13.0], stroke);
        }
    }
}

fn mark(
    painter: &Painter,
    over: &Overlay<'_>,
    role: Role,
    at: Pos2,
    number: usize,
    is_worst: bool,
) {
    // At the right edge the number stands on the other side.
    let has_room = at.x + 90.0 < over.frame.rect().right();
    let leader = if has_room {
        LEADER
    } else {
        vec2(-LEADER.x - 46.0, LEADER.y)
    };
    let end = at + leader;
    let color = over.frame.look.role(role);
    for (width, color) in [(4.0, over.frame.look.plate), (1.5, color)] {
        painter.line_segment([at, end], Stroke::new(width, color));
        painter.circle_stroke(at, 4.5, Stroke::new(width, color));
    }
    let text = if is_worst {
        format!("{number} ⚠")
    } else {
        number.to_string()
    };
    plate(
        painter,
        over,
        role,
        end - vec2(0.0, 9.0),
        &text,
        over.frame.look.text,
    );
}

/// A role mark and a text on a plate that begins at `left`, its middle line.
fn plate(
    painter: &Painter,
    over: &Overlay<'_>,
    role: Role,
    left: Pos2,
    text: &str,
    color: Color32,
) {
    let font = FontId::proportional(12.5);
    let galley = painter.layout_no_wrap(text.to_owned(), font, color);
    let size = vec2(galley.size().x + 28.0, 20.0);
    let ground = Rect::from_center_size(left + vec2(size.x / 2.0, 0.0), size);
    let over_edge = (ground.right() - over.frame.rect().right() + 4.0).max(0.0);
    let ground = ground.translate(vec2(-over_edge, 0.0));
    painter.rect_filled(ground, CornerRadius::same(5), over.frame.look.plate);
    let edge = Stroke::new(1.0, over.frame.look.role(role));
    painter.rect_stroke(
        ground,
        CornerRadius::same(5),
        edge,
        egui::StrokeKind::Inside,
    );
    let sign = Rect::from_center_size(ground.left_center() + vec2(11.0, 0.0), vec2(10.0, 10.0));
    paint_role_mark(painter, sign, role, over.frame.look.role(role));
    let text_at =
        Align2::LEFT_CENTER.anchor_size(ground.left_center() + vec2(20.0, 0.0), galley.size());
    painter.galley(text_at.min, galley, color);
}
