//! A part before its picture is there: its box and points spread over it.

use egui::{Pos2, Rect, Stroke, Ui, vec2};

use super::navigation::pos_of;
use crate::app::Part;
use crate::geometry::camera::StandardView;
use crate::geometry::{Aabb, Camera, Point3, Similarity};
use crate::role::Role;
use crate::ui::theme::Look;

/// Points of a part that is loaded.
const N_POINTS: usize = 3000;
/// Side of a point.
const SIDE: f32 = 2.0;

/// Draws points that were read, from where parts are seen at first.
pub fn read_points(ui: &Ui, rect: Rect, role: Role, points: &[[f64; 3]]) {
    let points: Vec<Point3> = points.iter().map(|p| Point3::from(*p)).collect();
    let bounds = Aabb::of_points(&points);
    if bounds.is_empty() {
        return;
    }
    let mut camera = Camera::default();
    camera.set_standard_view(StandardView::Isometric);
    let aspect = f64::from(rect.width() / rect.height().max(1.0));
    camera.fit(&bounds, aspect);
    draw(ui, (rect, &camera), role, &points, &bounds.corners());
}

/// Draws points of a part whose picture is being made.
pub(super) fn part_points(
    ui: &Ui,
    (rect, camera): (Rect, &Camera),
    (role, pose): (Role, &Similarity),
    part: &Part,
) {
    let positions = part.loaded.mesh.positions();
    let step = positions.len().div_ceil(N_POINTS).max(1);
    let points = positions.iter().step_by(step).map(|p| pose.apply(p));
    let points: Vec<Point3> = points.collect();
    if !points.is_empty() {
        let corners = part.bounds().corners().map(|corner| pose.apply(&corner));
        draw(ui, (rect, camera), role, &points, &corners);
    }
}

fn draw(
    ui: &Ui,
    (rect, camera): (Rect, &Camera),
    role: Role,
    points: &[Point3],
    corners: &[Point3; 8],
) {
    let painter = ui.painter_at(rect);
    let look = Look::of(ui.visuals().dark_mode);
    let color = look.role(role);
    let at = |point: &Point3| pos_of(rect, camera, point);
    let stroke = Stroke::new(1.0, color.gamma_multiply(0.5));
    for (a, b) in edges(corners) {
        if let Some((a, b)) = at(a).zip(at(b)) {
            painter.line_segment([a, b], stroke);
        }
    }
    let color = color.gamma_multiply(0.8);
    let dot = |pos: Pos2| Rect::from_center_size(pos, vec2(SIDE, SIDE));
    for pos in points.iter().filter_map(at) {
        painter.rect_filled(dot(pos), 0.0, color);
    }
}

/// Pairs of corners of a box that differ along one axis.
fn edges(corners: &[Point3; 8]) -> impl Iterator<Item = (&Point3, &Point3)> {
    let pairs = (0..8).flat_map(|a| (0..3).map(move |axis| (a, a ^ (1 << axis))));
    let pairs = pairs.filter(|(a, b)| a < b);
    pairs.map(|(a, b)| (&corners[a], &corners[b]))
}
