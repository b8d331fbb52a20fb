//! Moving by keys: G or R, then an axis, a plane, a value, and Enter. A pure state machine.

use crate::app::{Axis, AxisFrame, MoveFrame, rotation_about, translation_along};
use crate::geometry::{Similarity, Vector3};
use crate::text::{length, trimmed};

/// Longest value that is taken from the keys.
const MAX_TYPED: usize = 24;

/// Move or rotate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionKind {
    /// Translation along axes.
    Move,
    /// About an axis.
    Rotate,
}

/// What the motion is bound to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Constraint {
    /// Moves follow the pointer in the plane of the screen; rotations turn about the view axis.
    Free,
    /// Along or about one axis.
    Axis(Axis, AxisFrame),
    /// In the plane across this axis; rotations know no planes and turn about the axis.
    Plane(Axis, AxisFrame),
}

/// One input of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModalInput {
    /// X, Y or Z; with Shift the plane across it.
    Axis {
        /// Axis the motion is constrained to.
        axis: Axis,
        /// True with Shift held.
        is_plane: bool,
    },
    /// A digit, a point or comma, or a minus, which may come at any time.
    Character(char),
    /// Takes the last character back.
    Backspace,
    /// Where the pointer has gone since the beginning, in the space of the move.
    Pointer {
        /// Displacement in the plane of the screen through the pivot.
        offset: Vector3,
        /// Angle swept about the pivot on the screen, radians, counter-clockwise.
        angle: f64,
    },
    /// Keeps the motion as one undo step.
    Accept,
    /// Restores the pose from before the tool.
    Reject,
}

/// What the tool says to an input.
#[derive(Debug, Clone, PartialEq)]
pub enum ModalOutcome {
    /// Show this motion, relative to the pose at the beginning, and go on.
    Continue(Similarity),
    /// Take this motion, under this name.
    Accepted(Similarity, String),
    /// Nothing happened; the old pose stays.
    Rejected,
}

/// The state of a move by keys.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalMove {
    kind: MotionKind,
    constraint: Constraint,
    typed: String,
    offset: Vector3,
    angle: f64,
}

impl ModalMove {
    /// Begins; nothing has moved yet.
    pub fn new(kind: MotionKind) -> Self {
        Self {
            kind,
            constraint: Constraint::Free,
            typed: String::new(),
            offset: Vector3::zeros(),
            angle: 0.0,
        }
    }

    /// Move or rotate.
    pub fn kind(&self) -> MotionKind {
        self.kind
    }

    /// What it is bound to.
    pub fn constraint(&self) -> Constraint {
        self.constraint
    }

    /// Takes one input.
    pub fn input(&mut self, input: ModalInput, frame: &MoveFrame) -> ModalOutcome {
        match input {
            ModalInput::Axis { axis, is_plane } => self.constrain(axis, is_plane),
            ModalInput::Character(c) => self.type_character(c),
            ModalInput::Backspace => {
                self.typed.pop();
            }
            ModalInput::Pointer { offset, angle } => {
                self.offset = offset;
                self.angle = angle;
            }
            ModalInput::Reject => return ModalOutcome::Rejected,
            ModalInput::Accept => {
                let motion = self.motion(frame);
                return if motion == Similarity::identity() {
                    ModalOutcome::Rejected
                } else {
                    ModalOutcome::Accepted(motion, self.name(frame))
                };
            }
        }
        ModalOutcome::Continue(self.motion(frame))
    }

    /// A first press takes the global axis, a second the part's, a third none.
    fn constrain(&mut self, axis: Axis, is_plane: bool) {
        let make = |frame| {
            if is_plane && self.kind == MotionKind::Move {
                Constraint::Plane(axis, frame)
            } else {
                Constraint::Axis(axis, frame)
            }
        };
        let (global, part) = (make(AxisFrame::Global), make(AxisFrame::Part));
        self.constraint = if self.constraint == global {
            part
        } else if self.constraint == part {
            Constraint::Free
        } else {
            global
        };
    }

    fn type_character(&mut self, c: char) {
        match c {
            '-' => match self.typed.strip_prefix('-') {
                Some(rest) => self.typed = rest.to_owned(),
                None => self.typed.insert(0, '-'),
            },
            '.' | ',' if !self.typed.contains('.') => self.typed.push('.'),
            '0'..='9' if self.typed.len() < MAX_TYPED => self.typed.push(c),
            _ => {}
        }
    }

    /// The typed value: a length, or degrees. `None` while nothing that is a number was typed.
    pub fn typed_value(&self) -> Option<f64> {
        self.typed.parse().ok().filter(|v: &f64| v.is_finite())
    }

    /// The motion so far, relative to the pose at the beginning.
    pub fn motion(&self, frame: &MoveFrame) -> Similarity {
        match self.kind {
            MotionKind::Move => Similarity::from_translation(self.translation(frame)),
            MotionKind::Rotate => rotation_about(
                &frame.pivot,
                &self.rotation_axis(frame),
                self.radians(frame),
            ),
        }
    }

    fn translation(&self, frame: &MoveFrame) -> Vector3 {
        match (self.constraint, self.typed_value()) {
            (Constraint::Axis(axis, of), Some(value)) => {
                translation_along(&frame.axis(axis, of), value).translation
            }
            // A length without an axis goes along x, as in the programs this key comes from.
            (Constraint::Free, Some(value)) => Vector3::new(value, 0.0, 0.0),
            (Constraint::Plane(axis, of), value) => {
                let normal = frame.axis(axis, of);
                let in_plane = self.offset - normal * normal.dot(&self.offset);
                value.map_or(in_plane, |length| {
                    translation_along(&in_plane, length).translation
                })
            }
            (Constraint::Axis(axis, of), None) => {
                let direction = frame.axis(axis, of);
                direction * direction.dot(&self.offset)
            }
            (Constraint::Free, None) => self.offset,
        }
    }

    fn rotation_axis(&self, frame: &MoveFrame) -> Vector3 {
        match self.constraint {
            Constraint::Free => frame.axis(Axis::Z, AxisFrame::View),
            Constraint::Axis(axis, of) | Constraint::Plane(axis, of) => frame.axis(axis, of),
        }
    }

    fn radians(&self, frame: &MoveFrame) -> f64 {
        if let Some(degrees) = self.typed_value() {
            return degrees.to_radians();
        }
        // The pointer turns the part the way it goes, also when the axis points away.
        let towards_viewer = frame.axis(Axis::Z, AxisFrame::View);
        if self.rotation_axis(frame).dot(&towards_viewer) < 0.0 {
            -self.angle
        } else {
            self.angle
        }
    }

    /// Readable name of the motion: "Rotate 12.5° about Z", "Move 12.5 mm along X (part)".
    pub fn name(&self, frame: &MoveFrame) -> String {
        let motion = match self.kind {
            MotionKind::Rotate => {
                format!("Rotate {}°", short_number(self.radians(frame).to_degrees()))
            }
            MotionKind::Move => {
                let signed = match self.constraint {
                    Constraint::Axis(axis, of) => {
                        self.translation(frame).dot(&frame.axis(axis, of))
                    }
                    _ => self.translation(frame).norm(),
                };
                format!("Move {}{}", short_number(signed), frame.unit)
            }
        };
        format!("{motion}{}", self.constraint_text())
    }

    fn constraint_text(&self) -> String {
        let of_frame = |frame| match frame {
            AxisFrame::Global => "",
            AxisFrame::Part => " (part)",
            AxisFrame::View => " (view)",
        };
        match (self.kind, self.constraint) {
            (MotionKind::Move, Constraint::Free) => String::new(),
            (MotionKind::Rotate, Constraint::Free) => " about the view axis".to_owned(),
            (MotionKind::Move, Constraint::Axis(axis, of)) => {
                format!(" along {}{}", axis.letter(), of_frame(of))
            }
            (MotionKind::Move, Constraint::Plane(axis, of)) => {
                format!(" across {}{}", axis.letter(), of_frame(of))
            }
            (MotionKind::Rotate, Constraint::Axis(axis, of) | Constraint::Plane(axis, of)) => {
                format!(" about {}{}", axis.letter(), of_frame(of))
            }
        }
    }

    /// The line in the window's header: the motion and what is being typed.
    pub fn header(&self, frame: &MoveFrame) -> String {
        let name = self.name(frame);
        if self.typed.is_empty() {
            name
        } else {
            format!("{name}   [{}]", self.typed)
        }
    }
}

/// A number for a name: at most three decimals, no trailing zeros, no "-0"; of what is smaller, such as a thickness in
/// metres, three digits.
pub fn short_number(value: f64) -> String {
    let is_small = value != 0.0 && value.abs() < 0.01;
    if is_small {
        length(value)
    } else {
        trimmed(value, 3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_for_a_name_is_short_and_not_nothing() {
        let numbers = [12.5, -3.0, 0.25, 0.0, 0.0004];
        let texts = numbers.map(short_number);
        assert_eq!(texts, ["12.5", "−3", "0.25", "0", "0.000400"]);
    }
}
