//! Mouse and keys to cameras.

use egui::{Key, Modifiers, PointerButton, Pos2, Rect, Ui, Vec2};

use super::frame::FrameContext;
use crate::app::MouseScheme;
use crate::geometry::camera::{OrbitStyle, ScreenSize};
use crate::geometry::{Camera, Point3};

/// Turn of a drag over the height of the window, radians.
const TURN_PER_HEIGHT: f64 = 1.2 * std::f64::consts::PI;
/// Turn of an arrow key, radians.
const TURN_PER_KEY: f64 = std::f64::consts::PI / 24.0;
/// Logarithm of the zoom per point of drag and of wheel.
const ZOOM_PER_DRAG_POINT: f64 = 0.008;
const ZOOM_PER_WHEEL_POINT: f64 = 0.0035;
/// Zoom of a key.
const ZOOM_PER_KEY: f64 = 1.15;
/// Share of the height that a key pans.
const PAN_PER_KEY: f32 = 0.06;
/// Radius, as a share of the window's height, outside which free dragging rolls.
const ROLL_RADIUS: f32 = 1.0 / 3.0;

/// What a drag does to the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DragKind {
    Rotate,
    Roll,
    Pan,
    Zoom,
}

/// What a button means in a scheme. Plain buttons work in all of them: left rotates, middle pans
/// (rotates where that is the habit), right zooms.
pub(super) fn drag_kind(
    scheme: MouseScheme,
    button: PointerButton,
    held: Modifiers,
) -> Option<DragKind> {
    use DragKind::{Pan, Roll, Rotate, Zoom};
    use PointerButton::{Middle, Primary, Secondary};
    if button == Primary {
        let is_roll = held.command && held.shift;
        return Some(if is_roll { Roll } else { Rotate });
    }
    let kind = match (scheme, button) {
        (MouseScheme::LsPrePost | MouseScheme::Ansa, Middle) => Pan,
        (MouseScheme::HyperWorks, Middle) if held.command => Zoom,
        (MouseScheme::HyperWorks, Middle) => Pan,
        (MouseScheme::HyperWorks, Secondary) if held.command => Pan,
        (MouseScheme::Cad, Middle) if held.command => Pan,
        (MouseScheme::Cad, Middle) if held.shift => Zoom,
        (MouseScheme::Blender, Middle) if held.shift => Pan,
        (MouseScheme::Blender, Middle) if held.command => Zoom,
        (MouseScheme::Cad | MouseScheme::Blender, Middle) => Rotate,
        (_, Secondary) => Zoom,
        _ => return None,
    };
    Some(kind)
}

/// True if a drag draws edges only: with Ctrl, where no habit gives that another meaning.
fn is_bare(scheme: MouseScheme, button: PointerButton, held: Modifiers) -> bool {
    let is_free = button == PointerButton::Primary || scheme == MouseScheme::LsPrePost;
    held.command && !held.shift && is_free
}

impl FrameContext<'_> {
    /// The point under the cursor, or the one at the depth of the scene's middle.
    fn anchor(&self, pos: Pos2) -> Point3 {
        let pixel = self.pixel(pos);
        let hit = self.picture.hit(&self.view.camera, pixel, self.screen());
        hit.map_or_else(
            || {
                self.view
                    .camera
                    .unproject(pixel, self.screen(), &self.middle())
            },
            |hit| hit.point,
        )
    }

    /// The point a rotation that starts here leaves where it is: the picked one, the one under the
    /// cursor, or the middle of the scene.
    fn pivot_at(&self, pos: Pos2) -> Point3 {
        let hit = || {
            self.picture
                .hit(&self.view.camera, self.pixel(pos), self.screen())
        };
        let under_cursor = || hit().map(|hit| hit.point);
        self.pivot()
            .or_else(under_cursor)
            .unwrap_or_else(|| self.middle())
    }

    fn middle(&self) -> Point3 {
        if self.picture.bounds.is_empty() {
            self.view.camera.target
        } else {
            self.picture.bounds.center()
        }
    }
}

/// Size of a window in points, which is what cameras here count in.
pub(super) fn screen_of(rect: Rect) -> ScreenSize {
    ScreenSize {
        width: f64::from(rect.width()),
        height: f64::from(rect.height()),
    }
}

/// A place relative to the top left corner of a window.
pub(super) fn pixel_of(rect: Rect, pos: Pos2) -> [f64; 2] {
    let at = pos - rect.min;
    [f64::from(at.x), f64::from(at.y)]
}

/// Where a world point lies in egui's window; `None` behind the eye.
pub(super) fn pos_of(rect: Rect, camera: &Camera, point: &Point3) -> Option<Pos2> {
    let seen = camera.project(point, screen_of(rect))?;
    Some(rect.min + Vec2::new(seen.x as f32, seen.y as f32))
}

/// A drag of the camera under way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CameraDrag {
    pub kind: DragKind,
    /// What stays under the cursor, or where it is.
    pub anchor: Point3,
    /// Begun with Ctrl, which draws edges only as long as it lasts.
    pub is_bare: bool,
    button: PointerButton,
    last: Pos2,
}

/// The mouse in one window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Navigator {
    drag: Option<CameraDrag>,
}

impl Navigator {
    /// The drag under way.
    pub fn drag(&self) -> Option<&CameraDrag> {
        self.drag.as_ref()
    }

    /// The camera after this frame's input, if it moved. `is_left_taken`: the left button belongs
    /// to a tool.
    pub fn update(
        &mut self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        is_left_taken: bool,
    ) -> Option<Camera> {
        let mut camera = frame.view.camera;
        self.begin_drag(ui, frame, is_left_taken);
        self.go_on_dragging(ui, frame, &mut camera);
        if self.drag.is_none() {
            turn_wheel(ui, frame, &mut camera);
        }
        if frame.response.has_focus() {
            press_keys(ui, frame, &mut camera);
        }
        (camera != frame.view.camera).then_some(camera)
    }

    fn begin_drag(&mut self, ui: &Ui, frame: &FrameContext<'_>, is_left_taken: bool) {
        use PointerButton::{Middle, Primary, Secondary};
        if self.drag.is_some() {
            return;
        }
        let started = [Primary, Middle, Secondary]
            .into_iter()
            .filter(|button| !(is_left_taken && *button == Primary))
            .find(|&button| frame.response.drag_started_by(button));
        let Some(button) = started else {
            return;
        };
        let (origin, held) = ui.input(|i| (i.pointer.press_origin(), i.modifiers));
        let (Some(pos), Some(kind)) = (origin, drag_kind(frame.state.settings.mouse, button, held))
        else {
            return;
        };
        let center_distance = (pos - frame.rect().center()).length();
        let is_outside = center_distance > ROLL_RADIUS * frame.rect().height();
        let is_free = frame.state.view.orbit_style == OrbitStyle::Free;
        let kind = match kind {
            DragKind::Rotate if is_free && is_outside => DragKind::Roll,
            kind => kind,
        };
        let anchor = match kind {
            DragKind::Rotate => frame.pivot_at(pos),
            DragKind::Roll => frame.pivot().unwrap_or(frame.view.camera.target),
            DragKind::Pan | DragKind::Zoom => frame.anchor(pos),
        };
        ui.ctx().request_repaint();
        self.drag = Some(CameraDrag {
            kind,
            anchor,
            is_bare: is_bare(frame.state.settings.mouse, button, held),
            button,
            last: pos,
        });
    }

    fn go_on_dragging(&mut self, ui: &Ui, frame: &FrameContext<'_>, camera: &mut Camera) {
        let Some(drag) = &mut self.drag else {
            return;
        };
        if let Some(pos) = ui.input(|i| place_of_drag(i, drag.button)) {
            drag.apply(pos, frame, camera);
            drag.last = pos;
        }
        if !frame.response.dragged_by(drag.button) {
            self.drag = None;
            ui.ctx().request_repaint();
        }
    }
}

/// Where a drag has come to: the place of the release if the button went up in this frame. A slow
/// frame can also hold what the pointer did after that, which is no part of the drag.
fn place_of_drag(input: &egui::InputState, button: PointerButton) -> Option<Pos2> {
    let released = input.events.iter().find_map(|event| match event {
        egui::Event::PointerButton {
            pos,
            button: of,
            pressed: false,
            ..
        } if *of == button => Some(*pos),
        _ => None,
    });
    released.or_else(|| input.pointer.interact_pos())
}

impl CameraDrag {
    /// Moves the camera by the way from the last place to `pos`.
    fn apply(&self, pos: Pos2, frame: &FrameContext<'_>, camera: &mut Camera) {
        let way = pos - self.last;
        if way == Vec2::ZERO {
            return;
        }
        let per_point = TURN_PER_HEIGHT / f64::from(frame.rect().height().max(1.0));
        match self.kind {
            DragKind::Rotate => {
                let (right, up) = (f64::from(way.x), -f64::from(way.y));
                camera.orbit(
                    frame.state.view.orbit_style,
                    &self.anchor,
                    right * per_point,
                    up * per_point,
                );
            }
            DragKind::Roll => {
                let center = frame.rect().center();
                let turn = angle_between(self.last - center, pos - center);
                camera.roll(&self.anchor, turn);
            }
            DragKind::Pan => {
                let (from, to) = (frame.pixel(self.last), frame.pixel(pos));
                camera.pan(from, to, frame.screen(), &self.anchor);
            }
            DragKind::Zoom => {
                let factor = (f64::from(way.y) * ZOOM_PER_DRAG_POINT).exp();
                camera.zoom(factor, &self.anchor, &frame.picture.bounds);
            }
        }
    }
}

/// Counter-clockwise angle from one direction on the screen to another, within ±π.
pub(super) fn angle_between(from: Vec2, to: Vec2) -> f64 {
    let cross = f64::from(from.x * to.y - from.y * to.x);
    let dot = f64::from(from.x * to.x + from.y * to.y);
    // y points down on the screen.
    -cross.atan2(dot)
}

fn turn_wheel(ui: &Ui, frame: &FrameContext<'_>, camera: &mut Camera) {
    let Some(pos) = frame.response.hover_pos() else {
        return;
    };
    let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
    let factor = (-f64::from(scroll) * ZOOM_PER_WHEEL_POINT).exp() / f64::from(pinch);
    if factor != 1.0 {
        camera.zoom(factor, &frame.anchor(pos), &frame.picture.bounds);
    }
}

fn press_keys(ui: &Ui, frame: &FrameContext<'_>, camera: &mut Camera) {
    let (arrows, zoom, is_pan) = ui.input(|i| {
        let pressed = |key| i32::from(i.key_pressed(key));
        let right = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        let up = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
        let closer = pressed(Key::Plus) + pressed(Key::Equals) - pressed(Key::Minus);
        let is_plain = !i.modifiers.command && !i.modifiers.alt;
        let zoom = if is_plain { closer } else { 0 };
        ([right, up], zoom, i.modifiers.shift)
    });
    let [right, up] = arrows;
    if (right, up) != (0, 0) {
        if is_pan {
            let way = Vec2::new(right as f32, -up as f32) * PAN_PER_KEY * frame.rect().height();
            let from = frame.rect().center();
            let (from, to) = (frame.pixel(from), frame.pixel(from + way));
            camera.pan(from, to, frame.screen(), &frame.view.camera.target);
        } else {
            let pivot = frame.pivot().unwrap_or_else(|| frame.middle());
            let turn = [right, up].map(|n| f64::from(n) * TURN_PER_KEY);
            camera.orbit(frame.state.view.orbit_style, &pivot, turn[0], turn[1]);
        }
    }
    if zoom != 0 {
        let factor = ZOOM_PER_KEY.powi(-zoom);
        camera.zoom(factor, &frame.view.camera.target, &frame.picture.bounds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_habits_of_each_scheme_are_kept() {
        use DragKind::{Pan, Roll, Rotate, Zoom};
        use PointerButton::{Middle, Primary, Secondary};
        let (plain, ctrl, shift) = (Modifiers::NONE, Modifiers::COMMAND, Modifiers::SHIFT);
        for scheme in MouseScheme::ALL {
            assert_eq!(drag_kind(scheme, Primary, plain), Some(Rotate));
            assert_eq!(drag_kind(scheme, Secondary, plain), Some(Zoom));
            assert_eq!(drag_kind(scheme, Primary, ctrl | shift), Some(Roll));
        }
        for held in [plain, ctrl, shift] {
            assert_eq!(
                drag_kind(MouseScheme::LsPrePost, Primary, held),
                Some(Rotate)
            );
            assert_eq!(drag_kind(MouseScheme::LsPrePost, Middle, held), Some(Pan));
            assert_eq!(
                drag_kind(MouseScheme::LsPrePost, Secondary, held),
                Some(Zoom)
            );
        }
        assert_eq!(
            drag_kind(MouseScheme::HyperWorks, Secondary, ctrl),
            Some(Pan)
        );
        assert_eq!(drag_kind(MouseScheme::Blender, Middle, plain), Some(Rotate));
        assert_eq!(drag_kind(MouseScheme::Blender, Middle, shift), Some(Pan));
        assert_eq!(drag_kind(MouseScheme::Cad, Middle, ctrl), Some(Pan));
    }

    #[test]
    fn angles_on_the_screen_count_against_the_clock() {
        let (right, up) = (Vec2::new(1.0, 0.0), Vec2::new(0.0, -1.0));
        assert!((angle_between(right, up) - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    }
}
