//! Draws the handles that move the stamped part.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, pos2, vec2};

use super::theme::HandleColors;
use crate::app::Axis;
use crate::app::gizmo::{DOT, Gizmo, GizmoView, Handle, Layout, Shape};

/// Size of a letter with its halo, and how far beyond the tip of its arrow it stands.
const LETTER: f32 = 18.0;
const BEYOND: f32 = 12.0;
/// Places along an arrow that are tried for its letter.
const N_PLACES: u8 = 24;

/// Draws the gizmo over the parts. `origin` is the top left corner of the 3D view. Letters name
/// the axes, because their colours do not for everyone; they stand where nothing else is drawn over the view, which
/// `is_free` tells. The active handle is thicker and brighter.
pub fn paint(
    painter: &Painter,
    origin: Pos2,
    view: &GizmoView<'_>,
    gizmo: &Gizmo,
    is_dark: bool,
    is_free: impl Fn(Rect) -> bool,
) {
    let Some(layout) = Layout::new(view) else {
        return;
    };
    let tint = HandleColors::of_theme(is_dark);
    let active = gizmo.active();
    for shape in &layout.shapes {
        let is_active = active == Some(shape.handle);
        let is_dimmed = gizmo.is_dragging() && !is_active;
        paint_shape(painter, origin, shape, is_active, is_dimmed, tint);
    }
    for shape in &layout.shapes {
        let (Handle::Arrow(axis), [line]) = (shape.handle, shape.lines.as_slice()) else {
            continue;
        };
        if let [foot, tip] = line[..]
            && let Some(place) = letter_place(at(origin, foot), at(origin, tip), &is_free)
        {
            paint_letter(painter, place, axis, tint);
        }
    }
    let center = at(origin, layout.center);
    let is_active = active == Some(Handle::Dot);
    let fill = if is_active {
        tint.highlight
    } else {
        tint.dot[0]
    };
    let rim = Stroke::new(1.5, tint.dot[1]);
    painter.circle(center, DOT as f32, fill, rim);
}

fn paint_shape(
    painter: &Painter,
    origin: Pos2,
    shape: &Shape,
    is_active: bool,
    is_dimmed: bool,
    tint: &HandleColors,
) {
    let mut color = color_of(tint, shape.handle);
    if is_active {
        color = tint.highlight;
    } else if is_dimmed {
        color = color.gamma_multiply(0.25);
    }
    let width = if is_active { 4.0 } else { 2.5 };
    // A rim of the opposite lightness keeps thin lines readable on any ground and on coloured parts.
    let strength = if is_dimmed { 0.3 } else { 1.0 };
    let rim = Stroke::new(width + 2.0, tint.rim.gamma_multiply(strength));
    let stroke = Stroke::new(width, color);
    for line in &shape.lines {
        let points: Vec<Pos2> = line.iter().map(|pixel| at(origin, *pixel)).collect();
        if matches!(shape.handle, Handle::Square(_)) {
            let fill = color.gamma_multiply(if is_active { 0.7 } else { 0.4 });
            painter.add(egui::Shape::convex_polygon(points, fill, stroke));
            continue;
        }
        painter.line(points.clone(), rim);
        if let (Handle::Arrow(_), [foot, tip]) = (shape.handle, points.as_slice()) {
            paint_tip(painter, *foot, *tip, color);
        }
        painter.line(points, stroke);
    }
}

fn paint_tip(painter: &Painter, foot: Pos2, tip: Pos2, color: Color32) {
    let along = (tip - foot).normalized() * 14.0;
    let side = along.rot90() * 0.4;
    let corners = vec![tip, tip - along + side, tip - along - side];
    painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
}

/// Beyond the tip of an arrow, or as far along it as the letter is seen whole; `None` where it is nowhere.
fn letter_place(foot: Pos2, tip: Pos2, is_free: impl Fn(Rect) -> bool) -> Option<Pos2> {
    let beyond = tip + (tip - foot).normalized() * BEYOND;
    let mut places = (0..=N_PLACES).map(|n| beyond.lerp(foot, f32::from(n) / f32::from(N_PLACES)));
    places.find(|place| is_free(Rect::from_center_size(*place, Vec2::splat(LETTER))))
}

fn paint_letter(painter: &Painter, place: Pos2, axis: Axis, tint: &HandleColors) {
    let letter = axis.letter().to_string();
    let font = FontId::proportional(14.0);
    let put = |shift, color| {
        painter.text(
            place + shift,
            Align2::CENTER_CENTER,
            &letter,
            font.clone(),
            color,
        );
    };
    for shift in [
        vec2(1.0, 1.0),
        vec2(-1.0, 1.0),
        vec2(1.0, -1.0),
        vec2(-1.0, -1.0),
    ] {
        put(shift, tint.halo);
    }
    put(egui::Vec2::ZERO, tint.letter);
}

fn at(origin: Pos2, pixel: [f64; 2]) -> Pos2 {
    pos2(origin.x + pixel[0] as f32, origin.y + pixel[1] as f32)
}

fn color_of(tint: &HandleColors, handle: Handle) -> Color32 {
    match handle {
        Handle::Arrow(axis) | Handle::Square(axis) | Handle::Ring(axis) => match axis {
            Axis::X => tint.axes[0],
            Axis::Y => tint.axes[1],
            Axis::Z => tint.axes[2],
        },
        Handle::ViewRing | Handle::Dot => tint.neutral,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_stand_beyond_the_tips_or_along_the_arrows_where_they_are_seen() {
        let [foot, tip] = [pos2(100.0, 80.0), pos2(100.0, 20.0)];
        let window = Rect::from_min_max(Pos2::ZERO, pos2(200.0, 200.0));
        assert_eq!(
            letter_place(foot, tip, |_| true),
            Some(pos2(100.0, 20.0 - BEYOND))
        );
        // At the edge it is drawn back, no farther than it must.
        let place = letter_place(foot, tip, |letter| window.contains_rect(letter)).unwrap();
        assert!((place.x - 100.0).abs() < 1e-3, "{place}");
        assert!(
            (LETTER / 2.0..LETTER / 2.0 + 4.0).contains(&place.y),
            "{place}"
        );
        // The whole arrow lies under something.
        let legend = Rect::from_min_max(pos2(60.0, 0.0), pos2(140.0, 120.0));
        assert_eq!(
            letter_place(foot, tip, |letter| !legend.intersects(letter)),
            None
        );
    }
}
