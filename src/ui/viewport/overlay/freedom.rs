//! The motion that leaves the pose open, drawn on the part: arrows along free shifts, a ring about a
//! free turn. One sentence says it at the foot of the window, where it lies over no part that is fitted.

use egui::{CornerRadius, FontId, Painter, Pos2, Rect, Stroke, Ui, Vec2, vec2};

use super::{MARGIN, Overlay, banner, cube};
use crate::app::Part;
use crate::assess::{FreeMotion, FreeMotionKind};
use crate::geometry::{Point3, Vector3};
use crate::role::Role;
use crate::text::capital;
use crate::ui::viewport::navigation::pos_of;

/// Half the length of an arrow and the radius of a ring, as shares of the part's size.
const REACH: f64 = 0.22;
const RADIUS: f64 = 0.16;
/// Points of a ring.
const N_POINTS: usize = 64;
/// Length of an arrow's head.
const HEAD: f32 = 11.0;
/// Widest and narrowest lines of the sentence.
const WIDEST: f32 = 340.0;
const NARROWEST: f32 = 120.0;
/// Between the sentence and what is below it.
const AIR: f32 = 4.0;

/// The free motion of the present result and the part that it moves, in the window with both parts.
fn shown<'a>(over: &Overlay<'a>) -> Option<(&'a FreeMotion, &'a Part)> {
    let state = over.frame.state;
    if over.role() != Role::Crash || over.frame.view.over < 1.0 || state.is_preview() {
        return None;
    }
    let result = state.document.current_result()?;
    let motion = result.run.assessment.open_motion()?;
    Some((motion, state.document.part(Role::Stamped)?))
}

/// Arrows and ring, on the part.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    let Some((motion, part)) = shown(over) else {
        return;
    };
    let size = part.bounds().diagonal() * over.frame.view.pose.scale;
    let painter = over.painter(ui);
    let [across, up] = frame(&motion.direction);
    let arrow = |direction: &Vector3| draw_arrow(&painter, over, motion, direction, REACH * size);
    let ring = || draw_ring(&painter, over, motion, [across, up], RADIUS * size);
    match motion.kind {
        FreeMotionKind::Flat => {
            arrow(&across);
            arrow(&up);
            ring();
        }
        FreeMotionKind::Cylindrical => {
            arrow(&motion.direction);
            ring();
        }
        FreeMotionKind::Extruded => arrow(&motion.direction),
        FreeMotionKind::Revolved | FreeMotionKind::Spherical | FreeMotionKind::Other => ring(),
    }
}

/// Two directions across a third and each other.
fn frame(direction: &Vector3) -> [Vector3; 2] {
    let helper = if direction.x.abs() < 0.9 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let across = direction.cross(&helper).normalize();
    [across, direction.cross(&across)]
}

fn seen(over: &Overlay<'_>, point: &Point3) -> Option<Pos2> {
    pos_of(over.frame.rect(), &over.frame.view.camera, point)
}

/// A line that is seen on any ground.
fn line(painter: &Painter, over: &Overlay<'_>, points: &[Pos2]) {
    for (width, color) in [(5.0, over.frame.look.plate), (2.5, over.frame.look.tool)] {
        painter.line(points.to_vec(), Stroke::new(width, color));
    }
}

/// An arrow to both sides.
fn draw_arrow(
    painter: &Painter,
    over: &Overlay<'_>,
    motion: &FreeMotion,
    direction: &Vector3,
    reach: f64,
) {
    let ends = [-1.0, 1.0].map(|side| seen(over, &(motion.point + direction * (side * reach))));
    let [Some(from), Some(to)] = ends else {
        return;
    };
    if from.distance(to) < 2.0 * HEAD {
        return;
    }
    line(painter, over, &[from, to]);
    head(painter, over, to, to - from);
    head(painter, over, from, from - to);
}

fn head(painter: &Painter, over: &Overlay<'_>, tip: Pos2, way: Vec2) {
    let way = way.normalized();
    let side = way.rot90() * (0.5 * HEAD);
    let back = tip - way * HEAD;
    line(painter, over, &[back + side, tip, back - side]);
}

fn draw_ring(
    painter: &Painter,
    over: &Overlay<'_>,
    motion: &FreeMotion,
    [across, up]: [Vector3; 2],
    radius: f64,
) {
    let at = |k: usize| {
        // Not quite closed: the gap has the head of an arrow.
        let angle = 0.95 * std::f64::consts::TAU * k as f64 / N_POINTS as f64;
        let (sin, cos) = angle.sin_cos();
        seen(over, &(motion.point + (across * cos + up * sin) * radius))
    };
    let points: Option<Vec<Pos2>> = (0..=N_POINTS).map(at).collect();
    let Some(points) = points else {
        return;
    };
    let (tip, before) = (points[N_POINTS], points[N_POINTS - 1]);
    line(painter, over, &points);
    head(painter, over, tip, tip - before);
}

/// The sentence, above the scale bar or the banner; returns where it lies.
pub(super) fn sentence(ui: &Ui, over: &Overlay<'_>, banner: Option<Rect>) -> Option<Rect> {
    let (motion, _) = shown(over)?;
    let window = over.frame.rect();
    let painter = over.painter(ui);
    // The cube in the corner stays beside it.
    let beside = if cube::is_shown(over) {
        MARGIN + cube::SIZE
    } else {
        MARGIN
    };
    let room = window.width() - 2.0 * (beside + 2.0 * AIR) - 16.0;
    let galley = painter.layout(
        capital(&motion.words()),
        FontId::proportional(12.5),
        over.frame.look.text,
        room.clamp(NARROWEST, WIDEST),
    );
    let foot = banner.map_or(banner::BOTTOM, |banner| {
        window.bottom() - banner.top() + AIR
    });
    let size = galley.size() + vec2(16.0, 8.0);
    let center = window.center_bottom() - vec2(0.0, foot + 0.5 * size.y);
    let plate = Rect::from_center_size(center, size);
    painter.rect_filled(plate, CornerRadius::same(5), over.frame.look.plate);
    painter.galley(plate.min + vec2(8.0, 4.0), galley, over.frame.look.text);
    Some(plate)
}
