//! Moving the stamped part with the pointer: the gizmo, and moves begun by keys.

use egui::{Key, PointerButton, Pos2, Response, Ui};

use super::cast::Stage;
use super::navigation::{angle_between, pixel_of, pos_of, screen_of};
use crate::app::{AppState, Command, GestureId, ModalInput, MoveCommand, MoveFrame, MoveTool};
use crate::geometry::Point3;
use crate::jobs::Role;
use crate::ui::gizmo::{Gizmo, GizmoDelta, GizmoView, PointerInput, paint};

/// The tools of one window.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Tools {
    gizmo: Gizmo,
    /// The gizmo is in this window and can be grabbed.
    has_gizmo: bool,
    modal: Option<ModalPointer>,
}

/// Where the pointer has been since a move by keys began.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ModalPointer {
    gesture: GestureId,
    begin: Pos2,
    last: Pos2,
    angle: f64,
}

/// A window as the tools meet it.
pub(super) struct Bench<'a> {
    pub ui: &'a Ui,
    pub response: &'a Response,
    pub state: &'a AppState,
    pub stage: &'a Stage,
}

impl Bench<'_> {
    /// True if the stamped part is in this window and at rest.
    fn has_stamped(&self) -> bool {
        let window = if self.state.view.is_moved_over {
            Role::Crash
        } else {
            Role::Stamped
        };
        window == self.stage.window && self.state.document.part(Role::Stamped).is_some()
    }

    /// Pivot and axes now, with the camera of this frame.
    fn frame(&self) -> Option<MoveFrame> {
        let pivot = self.state.document.stamped_center()?;
        let view = self.stage.camera.world_from_view.to_rotation_matrix();
        let pose = self.state.document.crash_from_stamped();
        Some(MoveFrame::new(pivot, pose, view.into_inner()))
    }
}

impl Tools {
    /// True while a handle is held or under the pointer: the left button is not the camera's.
    pub fn takes_left(&self) -> bool {
        self.has_gizmo && self.gizmo.active().is_some()
    }

    /// True while the part is moved by hand.
    pub fn is_moving(&self) -> bool {
        self.gizmo.is_dragging() || self.modal.is_some()
    }

    /// Takes a frame of the pointer.
    pub fn update(&mut self, bench: &Bench<'_>, commands: &mut Vec<Command>) {
        let tool = bench.state.view.move_tool.as_ref();
        match tool.filter(|_| bench.has_stamped()) {
            Some(tool) => self.update_modal(bench, tool, commands),
            None => self.modal = None,
        }
        let is_wanted = bench.state.view.has_gizmo && tool.is_none() && bench.has_stamped();
        let can_move = bench.state.can_move().is_ok() && !bench.state.is_preview();
        self.has_gizmo = is_wanted && (can_move || self.gizmo.is_dragging());
        if self.has_gizmo {
            self.update_gizmo(bench, commands);
        }
    }

    fn update_gizmo(&mut self, bench: &Bench<'_>, commands: &mut Vec<Command>) {
        let Some(frame) = bench.frame() else {
            return;
        };
        let view = gizmo_view(bench, &frame);
        let rect = bench.response.rect;
        let is_over = bench.response.contains_pointer() || self.gizmo.is_dragging();
        let pointer = bench.ui.input(|i| PointerInput {
            position: i
                .pointer
                .latest_pos()
                .filter(|_| is_over)
                .map(|p| pixel_of(rect, p)),
            is_pressed: i.pointer.button_pressed(PointerButton::Primary) && is_over,
            is_down: i.pointer.primary_down(),
            shift: i.modifiers.shift,
            ctrl: i.modifiers.command,
            is_abandoned: i.key_pressed(Key::Escape),
        });
        let command = match self.gizmo.interact(&view, &pointer) {
            Some(GizmoDelta::Drag {
                gesture,
                delta,
                name,
            }) => MoveCommand::Drag {
                gesture,
                delta,
                name,
            },
            Some(GizmoDelta::End) => MoveCommand::EndDrag,
            Some(GizmoDelta::Abandon(gesture)) => MoveCommand::AbandonDrag(gesture),
            None => return,
        };
        commands.push(command.into());
    }

    /// Draws the gizmo and says what its active handle does.
    pub fn paint(&self, bench: &Bench<'_>) {
        if let Some(frame) = bench.frame().filter(|_| self.has_gizmo) {
            let painter = bench.ui.painter_at(bench.response.rect);
            let view = gizmo_view(bench, &frame);
            let is_dark = bench.ui.visuals().dark_mode;
            paint(
                &painter,
                bench.response.rect.min,
                &view,
                &self.gizmo,
                is_dark,
            );
        }
    }

    /// Name of the handle under the pointer.
    pub fn hint(&self, state: &AppState) -> Option<String> {
        let handle = self.gizmo.active().filter(|_| self.has_gizmo)?;
        Some(handle.label(state.view.move_axes))
    }

    fn update_modal(&mut self, bench: &Bench<'_>, tool: &MoveTool, commands: &mut Vec<Command>) {
        let rect = bench.response.rect;
        let pos = bench.ui.input(|i| i.pointer.latest_pos());
        let Some(pos) = pos.filter(|pos| rect.contains(*pos) || self.modal.is_some()) else {
            return;
        };
        let fresh = ModalPointer {
            gesture: tool.gesture,
            begin: pos,
            last: pos,
            angle: 0.0,
        };
        let known = self.modal.filter(|known| known.gesture == tool.gesture);
        let pointer = self.modal.insert(known.unwrap_or(fresh));
        if pointer.last != pos {
            pointer.go_to(pos, bench, &tool.frame.pivot);
            let pixel = |pos| pixel_of(rect, pos);
            let (camera, screen) = (&bench.stage.camera, screen_of(rect));
            let at = |pos| camera.unproject(pixel(pos), screen, &tool.frame.pivot);
            let offset = at(pointer.last) - at(pointer.begin);
            let angle = pointer.angle;
            commands.push(MoveCommand::Input(ModalInput::Pointer { offset, angle }).into());
        }
        let response = bench.response;
        if response.clicked() {
            commands.push(MoveCommand::Input(ModalInput::Accept).into());
        } else if response.secondary_clicked() {
            commands.push(MoveCommand::Input(ModalInput::Reject).into());
        }
    }
}

impl ModalPointer {
    /// Adds up the angle swept about the pivot, so that several turns count.
    fn go_to(&mut self, pos: Pos2, bench: &Bench<'_>, pivot: &Point3) {
        if let Some(center) = pos_of(bench.response.rect, &bench.stage.camera, pivot) {
            self.angle += angle_between(self.last - center, pos - center);
        }
        self.last = pos;
    }
}

fn gizmo_view<'a>(bench: &'a Bench<'_>, frame: &'a MoveFrame) -> GizmoView<'a> {
    GizmoView {
        camera: &bench.stage.camera,
        screen: screen_of(bench.response.rect),
        frame,
        axes: bench.state.view.move_axes,
    }
}
