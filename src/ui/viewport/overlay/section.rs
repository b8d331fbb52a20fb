//! The handle of the section plane in the picture.

use egui::{CursorIcon, PointerButton, Pos2, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

use super::Overlay;
use crate::app::{Command, InspectCommand, SectionView};
use crate::geometry::{Plane, Point3};
use crate::ui::pictures::is_screen_taken;
use crate::ui::viewport::navigation::{pos_of, screen_of};

/// Radius of the handle and length of its arrow.
const HANDLE: f32 = 9.0;
const ARROW: f32 = 34.0;
/// Turn per point of a drag, radians.
const TURN: f64 = 0.006;

/// The handle in the middle of the plane: left drag moves it along its normal, right drag turns it.
pub(super) fn handle(ui: &Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let Some((plane, center)) = over.frame.state.inspect.section.shown().zip(middle(over)) else {
        return;
    };
    let Some(at) = pos_of(over.frame.rect(), &over.frame.view.camera, &center) else {
        return;
    };
    if !over.frame.rect().contains(at) {
        return;
    }
    let id = ui.make_persistent_id(("section handle", over.role().word()));
    let grip = Rect::from_center_size(at, Vec2::splat(2.0 * HANDLE + 8.0));
    let response = ui.interact(grip, id, Sense::drag());
    let response = response.on_hover_and_drag_cursor(CursorIcon::Grab);
    response.widget_info(|| {
        let name = format!("Section plane ({})", over.role().word());
        WidgetInfo::labeled(egui::Role::Slider, true, name)
    });
    let way = along_normal(over, &plane, &center, at);
    let delta = response.drag_delta();
    if delta != Vec2::ZERO {
        let moved = if response.dragged_by(PointerButton::Primary) {
            Some(pushed(over, &plane, &center, (way, delta)))
        } else if response.dragged_by(PointerButton::Secondary) {
            Some(tilted(over, &plane, &center, delta))
        } else {
            None
        };
        if let Some(plane) = moved {
            set(over, plane, commands);
        }
    }
    let is_held = response.hovered() || response.dragged();
    if !is_screen_taken(ui.ctx()) {
        paint(ui, over, at, way, is_held);
    }
    response.on_hover_text("Drag: along the normal\nRight drag: tilt");
}

/// The middle of the plane's frame.
fn middle(over: &Overlay<'_>) -> Option<Point3> {
    let corners = over.frame.picture.section_frame.as_ref()?;
    Some(nalgebra::center(&corners[0], &corners[2]))
}

/// Points on the screen per length along the normal.
fn along_normal(over: &Overlay<'_>, plane: &Plane, center: &Point3, at: Pos2) -> Vec2 {
    let camera = &over.frame.view.camera;
    let pixel = camera.pixel_size(screen_of(over.frame.rect()), center);
    let tip = center + plane.normal * (100.0 * pixel);
    let tip = pos_of(over.frame.rect(), camera, &tip).unwrap_or(at);
    (tip - at) / (100.0 * pixel) as f32
}

/// The plane moved along its normal as far as the pointer went along it on the screen; where the
/// normal points at the viewer, up moves it away.
fn pushed(over: &Overlay<'_>, plane: &Plane, center: &Point3, (way, delta): (Vec2, Vec2)) -> Plane {
    let pixel = over
        .frame
        .view
        .camera
        .pixel_size(screen_of(over.frame.rect()), center);
    let is_seen = f64::from(way.length()) * pixel > 0.15;
    let length = if is_seen {
        f64::from(delta.dot(way) / way.length_sq())
    } else {
        let towards = -over.frame.view.camera.forward().dot(&plane.normal).signum();
        f64::from(delta.y) * pixel * towards
    };
    Plane {
        point: plane.point + plane.normal * length,
        ..*plane
    }
}

/// The plane turned about the axes of the screen through its middle.
fn tilted(over: &Overlay<'_>, plane: &Plane, center: &Point3, delta: Vec2) -> Plane {
    let camera = &over.frame.view.camera;
    let turn =
        camera.up() * (f64::from(delta.x) * TURN) + camera.right() * (f64::from(delta.y) * TURN);
    let normal = nalgebra::Rotation3::new(turn) * plane.normal;
    Plane::new(*center, &normal)
}

/// Takes a plane over.
fn set(over: &Overlay<'_>, plane: Plane, commands: &mut Vec<Command>) {
    let section = SectionView {
        plane: Some(plane),
        ..over.frame.state.inspect.section
    };
    commands.push(InspectCommand::SetSection(section).into());
}

/// A disc with an arrow along the normal.
fn paint(ui: &Ui, over: &Overlay<'_>, at: Pos2, way: Vec2, is_held: bool) {
    let painter = over.painter(ui);
    let color = over.frame.look.tool;
    let width = if is_held { 2.5 } else { 1.8 };
    if way.length() > 0.0 {
        let direction = way.normalized();
        let pixel = {
            let camera = &over.frame.view.camera;
            camera.pixel_size(screen_of(over.frame.rect()), &camera.target)
        };
        // Foreshortened as the normal is.
        let length = ARROW * (f64::from(way.length()) * pixel).min(1.0) as f32;
        if length > HANDLE {
            let tip = at + direction * (length + HANDLE);
            painter.line_segment([at, tip], Stroke::new(width + 2.5, over.frame.look.plate));
            painter.line_segment([at, tip], Stroke::new(width, color));
            let side = direction.rot90();
            for leg in [side, -side] {
                let back = tip - direction * 7.0 + leg * 4.5;
                painter.line_segment([tip, back], Stroke::new(width, color));
            }
        }
    }
    painter.circle(
        at,
        HANDLE,
        over.frame.look.plate.to_opaque(),
        Stroke::new(width, color),
    );
    // Two strokes through the disc: the plane seen from its edge.
    let across = if way.length() > 0.0 {
        way.normalized().rot90()
    } else {
        vec2(1.0, 0.0)
    };
    let ends = [at - across * 5.0, at + across * 5.0];
    painter.line_segment(ends, Stroke::new(2.0, color));
}
