//! Moving the stamped part with the pointer: the gizmo, and moves begun by keys.

use egui::{Event, InputState, Key, Modifiers, PointerButton, Pos2, Ui};

use super::frame::FrameContext;
use super::navigation::{angle_between, pixel_of, pos_of, screen_of};
use super::overlay::FreeRoom;
use crate::app::gizmo::{Gizmo, GizmoDelta, GizmoView, Layout, PointerInput};
use crate::app::{AppState, Command, GestureId, ModalInput, MoveCommand, MoveFrame, MoveTool};
use crate::geometry::Point3;
use crate::role::Role;
use crate::ui::gizmo::paint;
use crate::ui::pictures::is_screen_taken;

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

/// True if the stamped part is in this window and at rest.
fn has_stamped(frame: &FrameContext<'_>) -> bool {
    let window = if frame.state.view.is_moved_over {
        Role::Crash
    } else {
        Role::Stamped
    };
    window == frame.view.window && frame.state.document.part(Role::Stamped).is_some()
}

/// Where the left button went down on this window in this frame.
fn place_of_press(ui: &Ui, frame: &FrameContext<'_>) -> Option<[f64; 2]> {
    let is_over = frame.response.contains_pointer();
    let place = ui.input(|i| {
        let is_pressed = i.pointer.button_pressed(PointerButton::Primary);
        i.pointer.press_origin().filter(|_| is_pressed)
    });
    let place = place.filter(|at| is_over && frame.rect().contains(*at))?;
    Some(pixel_of(frame.rect(), place))
}

/// Where the left button was let go in this frame, and what was held then.
fn release(input: &InputState) -> Option<(Pos2, Modifiers)> {
    input.events.iter().find_map(|event| match event {
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed: false,
            modifiers,
        } => Some((*pos, *modifiers)),
        _ => None,
    })
}

/// Pivot and axes now, with the camera of this frame.
fn move_frame(frame: &FrameContext<'_>) -> Option<MoveFrame> {
    let pivot = frame.state.document.stamped_center()?;
    let view = frame.view.camera.world_from_view.to_rotation_matrix();
    let pose = frame.state.document.crash_from_stamped();
    let moves = MoveFrame::new(pivot, pose, view.into_inner());
    Some(moves.with_unit(frame.state.document.unit_suffix()))
}

impl Tools {
    /// True while a handle is held or under the pointer: the left button is not the camera's.
    pub fn takes_left(&self) -> bool {
        self.has_gizmo && self.gizmo.active().is_some()
    }

    /// Like [`Self::takes_left`], before this frame's pointer is taken: a slow frame may hold the way to a handle,
    /// the press on it and the way on.
    pub fn takes_left_now(&self, ui: &Ui, frame: &FrameContext<'_>) -> bool {
        let pressed = place_of_press(ui, frame).filter(|_| !self.gizmo.is_dragging());
        match (pressed, move_frame(frame)) {
            (Some(at), Some(axes)) => {
                let layout = Layout::new(&gizmo_view(frame, &axes));
                self.has_gizmo && layout.is_some_and(|layout| layout.hit(at).is_some())
            }
            _ => self.takes_left(),
        }
    }

    /// True while the part is moved by hand.
    pub fn is_moving(&self) -> bool {
        self.gizmo.is_dragging() || self.modal.is_some()
    }

    /// Takes a frame of the pointer.
    pub fn update(&mut self, ui: &Ui, frame: &FrameContext<'_>, commands: &mut Vec<Command>) {
        let tool = frame.state.moving.tool.as_ref();
        match tool.filter(|_| has_stamped(frame)) {
            Some(tool) => self.update_modal(ui, frame, tool, commands),
            None => self.modal = None,
        }
        // While points are picked, a click on a handle is meant for the part below it.
        let is_free = tool.is_none() && !frame.state.is_picking();
        let is_drawn = has_stamped(frame) && !frame.state.is_mapped_alone();
        let is_wanted = frame.state.moving.has_gizmo && is_free && is_drawn;
        let can_move = frame.state.can_move().is_ok() && !frame.state.is_preview();
        self.has_gizmo = is_wanted && (can_move || self.gizmo.is_dragging());
        if self.has_gizmo {
            self.update_gizmo(ui, frame, commands);
        } else if self.gizmo.let_go() {
            // The part left this window while it was held.
            commands.push(MoveCommand::EndDrag.into());
        }
    }

    fn update_gizmo(&mut self, ui: &Ui, frame: &FrameContext<'_>, commands: &mut Vec<Command>) {
        let Some(axes) = move_frame(frame) else {
            return;
        };
        let view = gizmo_view(frame, &axes);
        for pointer in self.pointer_inputs(ui, frame) {
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
                None => continue,
            };
            commands.push(command.into());
        }
    }

    /// What the pointer did in this frame, one after the other: it went down, came here, was let go. In a slow frame
    /// these are different places.
    fn pointer_inputs(&self, ui: &Ui, frame: &FrameContext<'_>) -> Vec<PointerInput> {
        let rect = frame.rect();
        let is_over = frame.response.contains_pointer() || self.gizmo.is_dragging();
        let pressed = place_of_press(ui, frame).filter(|_| !self.gizmo.is_dragging());
        let (now, released) = ui.input(|i| {
            // While a button turns the camera, no handle is pointed at.
            let is_turning = i.pointer.any_down() && !self.gizmo.is_dragging() && pressed.is_none();
            let place = i.pointer.latest_pos().filter(|_| is_over && !is_turning);
            let now = PointerInput {
                position: place.map(|at| pixel_of(rect, at)),
                is_pressed: false,
                is_down: i.pointer.primary_down(),
                shift: i.modifiers.shift,
                ctrl: i.modifiers.command,
                is_abandoned: i.key_pressed(Key::Escape),
            };
            (now, release(i))
        });
        let before = if self.gizmo.is_dragging() {
            released.map(|(at, held)| PointerInput {
                position: Some(pixel_of(rect, at)),
                is_down: true,
                shift: held.shift,
                ctrl: held.command,
                ..now
            })
        } else {
            pressed.map(|at| PointerInput {
                position: Some(at),
                is_pressed: true,
                ..now
            })
        };
        before.into_iter().chain([now]).collect()
    }

    /// Draws the gizmo, its letters where `free` has room for them.
    pub fn paint(&self, ui: &Ui, frame: &FrameContext<'_>, free: &FreeRoom) {
        let is_shown = self.has_gizmo && !is_screen_taken(ui.ctx());
        if let Some(axes) = move_frame(frame).filter(|_| is_shown) {
            let painter = ui.painter_at(frame.rect());
            let view = gizmo_view(frame, &axes);
            let is_dark = ui.visuals().dark_mode;
            let is_free = |place| free.holds(place);
            let origin = frame.rect().min;
            paint(&painter, origin, &view, &self.gizmo, is_dark, is_free);
        }
    }

    /// Name of the handle under the pointer; of one that is held, how far it has moved the part.
    pub fn hint(&self, state: &AppState) -> Option<String> {
        let handle = self.gizmo.active().filter(|_| self.has_gizmo)?;
        let label = || handle.label(state.moving.axes);
        Some(self.gizmo.motion_name().unwrap_or_else(label))
    }

    fn update_modal(
        &mut self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        tool: &MoveTool,
        commands: &mut Vec<Command>,
    ) {
        let rect = frame.rect();
        let pos = ui.input(|i| i.pointer.latest_pos());
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
            pointer.go_to(pos, frame, &tool.frame.pivot);
            let pixel = |pos| pixel_of(rect, pos);
            let (camera, screen) = (&frame.view.camera, screen_of(rect));
            let at = |pos| camera.unproject(pixel(pos), screen, &tool.frame.pivot);
            let offset = at(pointer.last) - at(pointer.begin);
            let angle = pointer.angle;
            commands.push(MoveCommand::Input(ModalInput::Pointer { offset, angle }).into());
        }
        let response = frame.response;
        if response.clicked() {
            commands.push(MoveCommand::Input(ModalInput::Accept).into());
        } else if response.secondary_clicked() {
            commands.push(MoveCommand::Input(ModalInput::Reject).into());
        }
    }
}

impl ModalPointer {
    /// Adds up the angle swept about the pivot, so that several turns count.
    fn go_to(&mut self, pos: Pos2, frame: &FrameContext<'_>, pivot: &Point3) {
        if let Some(center) = pos_of(frame.rect(), &frame.view.camera, pivot) {
            self.angle += angle_between(self.last - center, pos - center);
        }
        self.last = pos;
    }
}

fn gizmo_view<'a>(frame: &'a FrameContext<'_>, axes: &'a MoveFrame) -> GizmoView<'a> {
    GizmoView {
        camera: &frame.view.camera,
        screen: frame.screen(),
        frame: axes,
        axes: frame.state.moving.axes,
    }
}
