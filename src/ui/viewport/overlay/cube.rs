//! The view cube: the axes with their letters on a small cube whose faces, edges and corners turn the view.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, vec2,
};

use super::{MARGIN, Overlay};
use crate::app::{Command, ViewCommand};
use crate::geometry::camera::StandardView;
use crate::geometry::{Camera, Vector3};
use crate::ui::focus::is_ringed;

/// Width and height of its place.
pub(super) const SIZE: f32 = 80.0;
/// Windows lower than this have none.
const LOW: f32 = 300.0;
/// Half of a side of the cube.
const HALF: f32 = 14.5;
/// How far an axis reaches beyond the cube, and its letter beyond that.
const BEYOND: f32 = 5.0;
const LETTER: f32 = 12.0;
/// Radius of the ground below a letter.
const BELOW_LETTER: f32 = 8.0;
/// Of a face whose normal reaches so little towards the viewer only its outline would be seen, as a spike.
const EDGE_ON: f64 = 0.07;
/// Edges and corners begin at this share of half a side.
const EDGE: f32 = 0.55;

/// A low window has no room for it.
pub(super) fn is_shown(over: &Overlay<'_>) -> bool {
    over.frame.state.view.display.has_axes && over.frame.rect().height() >= LOW
}

/// Draws the cube in the lower left corner; a click turns the view.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    if !is_shown(over) {
        return;
    }
    let corner = over.frame.rect().left_bottom();
    let center = corner + vec2(MARGIN + 0.5 * SIZE, -MARGIN - 0.5 * SIZE);
    let cube = Cube::new(&over.frame.view.camera, center);
    let response = touch(ui, over, center);
    let at = response.hover_pos().filter(|_| over.drag.is_none());
    let picked = at.and_then(|at| cube.direction_at(at));
    cube.paint(&over.painter(ui), over, picked);
    let is_clicked = response.clicked();
    let by_pointer = response.interact_pointer_pos();
    let Some(direction) = picked else {
        // By key it goes to where everything begins.
        if is_clicked && by_pointer.is_none() {
            let view = StandardView::Isometric;
            commands.push(ViewCommand::Standard(over.frame.camera_role(), view).into());
        }
        return;
    };
    let response = response.on_hover_text(name(direction));
    if response.clicked() {
        let role = over.frame.camera_role();
        commands.push(ViewCommand::LookFrom(role, direction).into());
    }
}

/// The place that is pointed at and clicked.
fn touch(ui: &mut Ui, over: &Overlay<'_>, center: Pos2) -> Response {
    let rect = Rect::from_center_size(center, Vec2::splat(3.6 * HALF));
    let id = ui.scope_id().with("view cube");
    let response = ui.interact(rect, id, Sense::click());
    let label = format!("View cube ({})", over.role().word());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
    if is_ringed(&response) {
        let painter = over.painter(ui);
        let stroke = Stroke::new(1.5, over.frame.look.tool);
        painter.circle_stroke(center, 0.5 * SIZE, stroke);
    }
    response
}

/// "Front view", "View from +X −Y".
fn name(direction: [i8; 3]) -> String {
    if let Some(view) = StandardView::from_direction(direction) {
        return format!("{} view", view.label());
    }
    let axes = direction.into_iter().zip(["X", "Y", "Z"]);
    let signed = axes.filter_map(|(sign, axis)| match sign {
        0 => None,
        1 => Some(format!("+{axis}")),
        _ => Some(format!("−{axis}")),
    });
    format!("View from {}", signed.collect::<Vec<_>>().join(" "))
}

/// The cube as a camera sees it.
struct Cube {
    center: Pos2,
    /// The axes of the world, with z towards the viewer.
    axes: [Vector3; 3],
}

impl Cube {
    fn new(camera: &Camera, center: Pos2) -> Self {
        Self {
            center,
            axes: camera.axes_in_view(),
        }
    }

    /// A place of the cube on the screen, in halves of its sides.
    fn place(&self, at: [f32; 3]) -> Pos2 {
        let along = |k: usize| vec2(self.axes[k].x as f32, -self.axes[k].y as f32) * at[k];
        self.center + (along(0) + along(1) + along(2)) * HALF
    }

    /// Faces that are seen: the axis they stand across, and on which side.
    fn faces(&self) -> impl Iterator<Item = (usize, i8)> {
        let faces = (0..3).flat_map(|axis| [(axis, 1), (axis, -1)]);
        faces.filter(|&(axis, side)| f64::from(side) * self.axes[axis].z > EDGE_ON)
    }

    /// The direction from which the face, edge or corner at a place of the screen is seen upright.
    fn direction_at(&self, at: Pos2) -> Option<[i8; 3]> {
        let at = (at - self.center) / HALF;
        let (x, y) = (f64::from(at.x), f64::from(-at.y));
        self.faces().find_map(|(axis, side)| {
            let across = &self.axes[axis];
            let z = (f64::from(side) - across.x * x - across.y * y) / across.z;
            let on_cube = self.axes.map(|axis| axis.dot(&Vector3::new(x, y, z)));
            let is_on_face = on_cube.iter().all(|c| c.abs() <= 1.0 + 1e-6);
            is_on_face.then(|| on_cube.map(|c| step(c as f32)))
        })
    }

    fn paint(&self, painter: &Painter, over: &Overlay<'_>, picked: Option<[i8; 3]>) {
        let look = over.frame.look;
        // The letters alone have a ground: a plate below all would cover the part.
        let ends = [0, 1, 2].map(|axis| {
            let at = |reach: f32| {
                let mut at = [-1.0; 3];
                at[axis] = reach;
                self.place(at)
            };
            let reach = 1.0 + BEYOND / HALF;
            painter.line_segment([at(-1.0), at(reach)], Stroke::new(2.0, look.axes[axis]));
            at(1.0 + LETTER / HALF)
        });
        for end in ends {
            painter.circle_filled(end, BELOW_LETTER, look.plate);
        }
        for (axis, side) in self.faces() {
            self.paint_face(painter, over, (axis, side), picked);
        }
        for axis in 0..3 {
            let font = FontId::proportional(11.5);
            let text = ["X", "Y", "Z"][axis];
            painter.text(
                ends[axis],
                Align2::CENTER_CENTER,
                text,
                font,
                look.axes[axis],
            );
        }
    }

    /// A face, brighter the more it is turned to the viewer, with what the pointer is on.
    fn paint_face(
        &self,
        painter: &Painter,
        over: &Overlay<'_>,
        (axis, side): (usize, i8),
        picked: Option<[i8; 3]>,
    ) {
        let look = over.frame.look;
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let corner = |on_u: f32, on_v: f32| {
            let mut at = [0.0; 3];
            at[axis] = f32::from(side);
            at[u] = on_u;
            at[v] = on_v;
            self.place(at)
        };
        let patch = |[u0, u1]: [f32; 2], [v0, v1]: [f32; 2]| {
            vec![
                corner(u0, v0),
                corner(u1, v0),
                corner(u1, v1),
                corner(u0, v1),
            ]
        };
        let towards = (f64::from(side) * self.axes[axis].z) as f32;
        let ground = mixed(look.plate, look.weak, 0.25 + 0.35 * towards);
        let line = Stroke::new(1.0, look.text.gamma_multiply(0.55));
        let whole = patch([-1.0, 1.0], [-1.0, 1.0]);
        painter.add(Shape::convex_polygon(whole, ground, line));
        let Some(picked) = picked.filter(|picked| picked[axis] == side) else {
            return;
        };
        let span = |step: i8| match step {
            0 => [-EDGE, EDGE],
            1 => [EDGE, 1.0],
            _ => [-1.0, -EDGE],
        };
        let lit = patch(span(picked[u]), span(picked[v]));
        painter.add(Shape::convex_polygon(lit, look.tool, Stroke::NONE));
    }
}

/// −1, 0 or 1: the low edge, the middle, the high edge.
fn step(on_side: f32) -> i8 {
    if on_side.abs() < EDGE {
        0
    } else if on_side > 0.0 {
        1
    } else {
        -1
    }
}

fn mixed(a: Color32, b: Color32, share: f32) -> Color32 {
    a.lerp_to_gamma(b, share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_clicked_is_looked_at_from_there() {
        let center = Pos2::new(200.0, 300.0);
        for view in StandardView::ALL {
            let mut camera = Camera::default();
            camera.set_standard_view(view);
            let cube = Cube::new(&camera, center);
            for x in -1..=1_i8 {
                for y in -1..=1_i8 {
                    for z in -1..=1_i8 {
                        let direction = [x, y, z];
                        let back = Vector3::from(direction.map(f64::from));
                        let is_seen = cube.faces().any(|(axis, side)| direction[axis] == side);
                        if back == Vector3::zeros() || !is_seen {
                            continue;
                        }
                        let at = cube.place(direction.map(|c| 0.95 * f32::from(c)));
                        let found = cube.direction_at(at);
                        // What lies on the rim of the picture may belong to either side of it.
                        let is_plain = cube.faces().all(|(axis, side)| direction[axis] != -side);
                        if is_plain {
                            assert_eq!(found, Some(direction), "{view:?}");
                        }
                    }
                }
            }
            assert_eq!(cube.direction_at(center + vec2(60.0, 0.0)), None);
        }
    }

    #[test]
    fn faces_that_are_seen_from_their_edges_are_left_out() {
        let n_faces = |angle: f64| {
            let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), angle.to_radians());
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| turn * axis);
            let center = Pos2::ZERO;
            Cube { center, axes }.faces().count()
        };
        assert_eq!([0.0, 1.0, 3.0, 10.0, 87.0].map(n_faces), [1, 1, 1, 2, 1]);
    }

    #[test]
    fn directions_are_named_by_view_or_axes() {
        assert_eq!(name([0, -1, 0]), "Front view");
        assert_eq!(name([1, -1, 1]), "Isometric view");
        assert_eq!(name([1, 0, -1]), "View from +X −Z");
    }
}
