use super::layout::{DOT, Layout, Shape};
use super::{Gizmo, GizmoView, Handle};
use crate::app::Axis;
use egui::{Align2, Color32, FontId, Painter, Pos2, Stroke, pos2, vec2};

/// Draws the gizmo over the parts. `origin` is the top left corner of the 3D view. Letters name
/// the axes, because their colours do not for everyone; the active handle is thicker and brighter.
pub fn paint(painter: &Painter, origin: Pos2, view: &GizmoView<'_>, gizmo: &Gizmo) {
    let Some(layout) = Layout::new(view) else {
        return;
    };
    let active = gizmo.active();
    for shape in &layout.shapes {
        let is_active = active == Some(shape.handle);
        let is_dimmed = gizmo.is_dragging() && !is_active;
        paint_shape(painter, origin, shape, is_active, is_dimmed);
    }
    let center = at(origin, layout.center);
    let is_active = active == Some(Handle::Dot);
    let fill = if is_active {
        highlight()
    } else {
        Color32::WHITE
    };
    let rim = Stroke::new(1.5, Color32::from_black_alpha(160));
    painter.circle(center, DOT as f32, fill, rim);
}

fn paint_shape(painter: &Painter, origin: Pos2, shape: &Shape, is_active: bool, is_dimmed: bool) {
    let mut color = color_of(shape.handle);
    if is_active {
        color = highlight();
    } else if is_dimmed {
        color = color.gamma_multiply(0.25);
    }
    let width = if is_active { 4.0 } else { 2.5 };
    // A dark rim keeps thin lines readable on light and on coloured parts.
    let rim = Stroke::new(width + 2.0, Color32::from_black_alpha(90));
    let stroke = Stroke::new(width, color);
    for line in &shape.lines {
        let points: Vec<Pos2> = line.iter().map(|pixel| at(origin, *pixel)).collect();
        if matches!(shape.handle, Handle::Square(_)) {
            let fill = color.gamma_multiply(if is_active { 0.7 } else { 0.4 });
            painter.add(egui::Shape::convex_polygon(points, fill, stroke));
            continue;
        }
        painter.line(points.clone(), rim);
        if let (Handle::Arrow(axis), [foot, tip]) = (shape.handle, points.as_slice()) {
            paint_tip(painter, *foot, *tip, axis, color);
        }
        painter.line(points, stroke);
    }
}

fn paint_tip(painter: &Painter, foot: Pos2, tip: Pos2, axis: Axis, color: Color32) {
    let along = (tip - foot).normalized() * 14.0;
    let side = along.rot90() * 0.4;
    let corners = vec![tip, tip - along + side, tip - along - side];
    painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
    let place = tip + along.normalized() * 12.0;
    let letter = axis.letter().to_string();
    let font = FontId::proportional(14.0);
    let shadow = Color32::from_black_alpha(200);
    painter.text(
        place + vec2(1.0, 1.0),
        Align2::CENTER_CENTER,
        &letter,
        font.clone(),
        shadow,
    );
    painter.text(place, Align2::CENTER_CENTER, letter, font, Color32::WHITE);
}

fn at(origin: Pos2, pixel: [f64; 2]) -> Pos2 {
    pos2(origin.x + pixel[0] as f32, origin.y + pixel[1] as f32)
}

fn highlight() -> Color32 {
    Color32::from_rgb(255, 225, 90)
}

fn color_of(handle: Handle) -> Color32 {
    match handle {
        Handle::Arrow(axis) | Handle::Square(axis) | Handle::Ring(axis) => match axis {
            Axis::X => Color32::from_rgb(226, 75, 75),
            Axis::Y => Color32::from_rgb(92, 190, 80),
            Axis::Z => Color32::from_rgb(74, 134, 240),
        },
        Handle::ViewRing | Handle::Dot => Color32::from_gray(225),
    }
}
