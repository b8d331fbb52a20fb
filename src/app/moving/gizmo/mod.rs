//! Handles that move and turn the stamped part: three arrows, three squares, three rings, a ring
//! about the view axis, and a dot. Maths and state; the window only draws them.
//!
//! Pixels are points of the window, from the top left corner of the 3D view. A drag gives the whole
//! motion since the grab, in the space of the crash model; the caller lays it on the pose at the
//! grab, so that nothing jumps and no rounding piles up.

mod layout;

pub use layout::{DOT, GizmoView, HIT_SLOP, Layout, RADIUS, Shape};

use crate::app::{
    Axis, AxisFrame, GestureId, MoveFrame, rotation_about, short_number, translation_along,
};
use crate::geometry::{Similarity, Vector3};

/// Rotations snap to this many degrees, with Shift to one.
const SNAP_DEG: f64 = 15.0;
/// A snapped step is at least so many pixels long.
const MIN_SNAP_PIXELS: f64 = 6.0;
/// How much slower Shift makes a drag.
const FINE: f64 = 0.1;

/// A part of the gizmo that can be grabbed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handle {
    /// Moves along an axis.
    Arrow(Axis),
    /// Moves in the plane across an axis.
    Square(Axis),
    /// Turns about an axis.
    Ring(Axis),
    /// Turns about the direction of view.
    ViewRing,
    /// Moves in the plane of the screen.
    Dot,
}

impl Handle {
    /// What it does, for tooltip and screen reader.
    pub fn label(self, frame: AxisFrame) -> String {
        let named = |axis: Axis| match frame {
            AxisFrame::Global => axis.letter().to_string(),
            other => format!("{} ({})", axis.letter(), other.label()),
        };
        match self {
            Self::Arrow(axis) => format!("Move along {}", named(axis)),
            Self::Square(axis) => format!("Move across {}", named(axis)),
            Self::Ring(axis) => format!("Rotate about {}", named(axis)),
            Self::ViewRing => "Rotate about the view axis".to_owned(),
            Self::Dot => "Move in the plane of the screen".to_owned(),
        }
    }
}

/// The pointer in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointerInput {
    /// Where it is, `None` outside the view or over a panel.
    pub position: Option<[f64; 2]>,
    /// The left button went down in this frame.
    pub is_pressed: bool,
    /// The left button is down.
    pub is_down: bool,
    /// Shift is held.
    pub shift: bool,
    /// Ctrl is held.
    pub ctrl: bool,
    /// Escape was pressed: take the drag back.
    pub is_abandoned: bool,
}

/// What a frame of dragging says.
#[derive(Debug, Clone, PartialEq)]
pub enum GizmoDelta {
    /// The motion since the grab, for `MoveCommand::Drag`.
    Drag {
        /// One per drag.
        gesture: GestureId,
        /// In the space of the crash model.
        delta: Similarity,
        /// "Move 12.5 along Z".
        name: String,
    },
    /// The button was let go, for `MoveCommand::EndDrag`.
    End,
    /// The drag is taken back, for `MoveCommand::AbandonDrag`.
    Abandon(GestureId),
}

#[derive(Debug, Clone, PartialEq)]
struct Drag {
    handle: Handle,
    gesture: GestureId,
    frame: MoveFrame,
    axes: AxisFrame,
    /// Where the pointer was in the last frame.
    last: [f64; 2],
    /// Distances along the handle's axes, or radians in the first place.
    amount: Vector3,
    /// What was given out last, with snapping.
    snapped: Vector3,
}

/// The gizmo between two frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gizmo {
    hovered: Option<Handle>,
    drag: Option<Drag>,
}

impl Gizmo {
    /// The handle under the pointer, or the one that is dragged.
    pub fn active(&self) -> Option<Handle> {
        self.drag.as_ref().map(|drag| drag.handle).or(self.hovered)
    }

    /// What the drag has done so far: "Move 12.5 mm along Z".
    pub fn motion_name(&self) -> Option<String> {
        self.drag.as_ref().map(Drag::name)
    }

    /// True while a handle is held; the camera then leaves the left button alone.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Ends a drag where the part was taken from under it; true if there was one.
    pub fn let_go(&mut self) -> bool {
        self.hovered = None;
        self.drag.take().is_some()
    }

    /// Takes one frame of the pointer.
    ///
    /// A press with Shift or Ctrl held belongs to the camera and grabs nothing; once a handle is
    /// held, Shift slows down ten times and Ctrl snaps.
    pub fn interact(&mut self, view: &GizmoView<'_>, pointer: &PointerInput) -> Option<GizmoDelta> {
        if self.drag.is_some() {
            return self.go_on(view, pointer);
        }
        let layout = Layout::new(view)?;
        self.hovered = pointer.position.and_then(|at| layout.hit(at));
        if pointer.is_pressed && !pointer.shift && !pointer.ctrl {
            self.grab(view, pointer.position?);
        }
        None
    }

    fn grab(&mut self, view: &GizmoView<'_>, at: [f64; 2]) {
        let Some(handle) = self.hovered else {
            return;
        };
        self.drag = Some(Drag {
            handle,
            gesture: GestureId::new(),
            frame: *view.frame,
            axes: view.axes,
            last: at,
            amount: Vector3::zeros(),
            snapped: Vector3::zeros(),
        });
    }

    fn go_on(&mut self, view: &GizmoView<'_>, pointer: &PointerInput) -> Option<GizmoDelta> {
        let drag = self.drag.as_mut()?;
        if pointer.is_abandoned {
            let gesture = drag.gesture;
            self.drag = None;
            return Some(GizmoDelta::Abandon(gesture));
        }
        if !pointer.is_down {
            self.drag = None;
            return Some(GizmoDelta::End);
        }
        let at = pointer.position.filter(|at| *at != drag.last);
        drag.follow(view, at, pointer)
    }
}

impl Drag {
    fn follow(
        &mut self,
        view: &GizmoView<'_>,
        at: Option<[f64; 2]>,
        pointer: &PointerInput,
    ) -> Option<GizmoDelta> {
        if let Some(at) = at {
            let is_fine = pointer.shift && !pointer.ctrl;
            let speed = if is_fine { FINE } else { 1.0 };
            self.amount += self.step(view, at) * speed;
            self.last = at;
        }
        let snapped = self.snap(view, pointer);
        if snapped == self.snapped {
            return None;
        }
        self.snapped = snapped;
        Some(GizmoDelta::Drag {
            gesture: self.gesture,
            delta: self.motion(),
            name: self.name(),
        })
    }

    /// How far the pointer went since the last frame, with the camera of this frame.
    fn step(&self, view: &GizmoView<'_>, at: [f64; 2]) -> Vector3 {
        let pivot = self.pivot_now();
        let only_first = |amount: f64| Vector3::new(amount, 0.0, 0.0);
        match self.handle {
            Handle::Arrow(_) => {
                let axis = self.directions()[0];
                let there = view.along_line(&pivot, &axis, at);
                let before = view.along_line(&pivot, &axis, self.last);
                only_first(there.zip(before).map_or(0.0, |(a, b)| a - b))
            }
            Handle::Square(axis) => {
                let normal = self.frame.axis(axis, self.axes);
                let there = view.on_plane(&pivot, &normal, at);
                let before = view.on_plane(&pivot, &normal, self.last);
                let moved = there.zip(before).map(|(a, b)| a - b);
                self.components(&moved.unwrap_or_default())
            }
            Handle::Dot => {
                let there = view.camera.unproject(at, view.screen, &pivot);
                let before = view.camera.unproject(self.last, view.screen, &pivot);
                self.components(&(there - before))
            }
            Handle::Ring(_) | Handle::ViewRing => {
                only_first(view.swept(&pivot, &self.directions()[0], self.last, at))
            }
        }
    }

    /// Where the pivot lies now: it goes with the part.
    fn pivot_now(&self) -> crate::geometry::Point3 {
        self.motion().apply(&self.frame.pivot)
    }

    /// The directions the amounts count along. Rings: the axis of the rotation.
    fn directions(&self) -> [Vector3; 2] {
        let of = |axis| self.frame.axis(axis, self.axes);
        let on_screen = |axis| self.frame.axis(axis, AxisFrame::View);
        match self.handle {
            Handle::Arrow(axis) | Handle::Ring(axis) => [of(axis), Vector3::zeros()],
            Handle::Square(Axis::X) => [of(Axis::Y), of(Axis::Z)],
            Handle::Square(Axis::Y) => [of(Axis::Z), of(Axis::X)],
            Handle::Square(Axis::Z) => [of(Axis::X), of(Axis::Y)],
            Handle::ViewRing => [on_screen(Axis::Z), Vector3::zeros()],
            Handle::Dot => [on_screen(Axis::X), on_screen(Axis::Y)],
        }
    }

    fn components(&self, moved: &Vector3) -> Vector3 {
        let [first, second] = self.directions();
        Vector3::new(first.dot(moved), second.dot(moved), 0.0)
    }

    fn snap(&self, view: &GizmoView<'_>, pointer: &PointerInput) -> Vector3 {
        if !pointer.ctrl {
            return self.amount;
        }
        let step = match self.handle {
            Handle::Ring(_) | Handle::ViewRing if pointer.shift => 1f64.to_radians(),
            Handle::Ring(_) | Handle::ViewRing => SNAP_DEG.to_radians(),
            _ => {
                let step = view.round_step(&self.frame.pivot, MIN_SNAP_PIXELS);
                if pointer.shift { step * FINE } else { step }
            }
        };
        self.amount.map(|amount| (amount / step).round() * step)
    }

    fn motion(&self) -> Similarity {
        let [first, second] = self.directions();
        match self.handle {
            Handle::Ring(_) | Handle::ViewRing => {
                rotation_about(&self.frame.pivot, &first, self.snapped.x)
            }
            Handle::Arrow(_) => translation_along(&first, self.snapped.x),
            Handle::Square(_) | Handle::Dot => {
                Similarity::from_translation(first * self.snapped.x + second * self.snapped.y)
            }
        }
    }

    /// "Move 12.5 mm along Z", "Rotate 12.5° about Z (part)".
    fn name(&self) -> String {
        let label = self.handle.label(self.axes);
        let amount = match self.handle {
            Handle::Ring(_) | Handle::ViewRing => {
                format!("{}°", short_number(self.snapped.x.to_degrees()))
            }
            Handle::Arrow(_) => short_number(self.snapped.x) + self.frame.unit,
            Handle::Square(_) | Handle::Dot => short_number(self.snapped.norm()) + self.frame.unit,
        };
        match label.split_once(' ') {
            Some((verb, rest)) => format!("{verb} {amount} {rest}"),
            None => label,
        }
    }
}

#[cfg(test)]
mod tests;
