//! The motion that leaves the pose open, drawn on the part: arrows along free shifts, a ring about a
//! free turn, with one sentence.

use egui::{Align2, CornerRadius, FontId, Painter, Pos2, Rect, Stroke, Ui, Vec2, vec2};

use super::Overlay;
use crate::assess::{FreeMotion, FreeMotionKind};
use crate::geometry::{Point3, Vector3};
use crate::role::Role;
use crate::ui::viewport::navigation::pos_of;

/// Half the length of an arrow and the radius of a ring, as shares of the part's size.
const REACH: f64 = 0.22;
const RADIUS: f64 = 0.16;
/// Points of a ring.
const N_POINTS: usize = 64;
/// Length of an arrow's head.
const HEAD: f32 = 11.0;

/// The free motion of the present result, in the window with both parts.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    if over.role() != Role::Crash || over.frame.view.over < 1.0 || over.frame.state.is_preview() {
        return;
    }
    let Some(result) = over.frame.state.document.current_result() else {
        return;
    };
    let Some(motion) = result.run.assessment.open_motion() else {
        return;
    };
    let Some(part) = over.frame.state.document.part(Role::Stamped) else {
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
    label(&painter, over, motion, size);
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

fn label(painter: &Painter, over: &Overlay<'_>, motion: &FreeMotion, size: f64) {
    let Some(at) = seen(over, &motion.point) else {
        return;
    };
    let words = motion.words();
    let mut letters = words.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    let text = format!("{}{}", first.unwrap_or_default(), letters.as_str());
    let room = over.frame.rect().width() - 40.0;
    let galley = painter.layout(
        text,
        FontId::proportional(12.5),
        over.frame.look.text,
        room.min(340.0),
    );
    let pixel = over.frame.view.camera.pixel_size(
        crate::ui::viewport::navigation::screen_of(over.frame.rect()),
        &motion.point,
    );
    let below = (RADIUS * size / pixel) as f32 + 22.0;
    let plate =
        Align2::CENTER_TOP.anchor_size(at + vec2(0.0, below), galley.size() + vec2(16.0, 8.0));
    let inside = over.frame.rect().shrink(12.0);
    let shift = vec2(
        (inside.left() - plate.left()).max(0.0) + (inside.right() - plate.right()).min(0.0),
        (inside.top() - plate.top()).max(0.0) + (inside.bottom() - 60.0 - plate.bottom()).min(0.0),
    );
    let plate: Rect = plate.translate(shift);
    painter.rect_filled(plate, CornerRadius::same(5), over.frame.look.plate);
    painter.galley(plate.min + vec2(8.0, 4.0), galley, over.frame.look.text);
}
