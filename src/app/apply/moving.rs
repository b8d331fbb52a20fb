//! What moves by hand change: handles, keys, numbers, pasted matrices.

use std::f64::consts::PI;

use crate::app::view::MoveTool;
use crate::app::{
    AppState, Axis, AxisFrame, Effect, GestureId, ModalInput, ModalMove, ModalOutcome, MotionKind,
    MoveCommand, MoveFrame, NoticeLevel, rotation_about, short_number, translation_along,
};
use crate::geometry::{Point3, Similarity};
use crate::report::parse_matrix;
use crate::role::Role;

impl AppState {
    pub(super) fn apply_move(&mut self, command: MoveCommand) -> Vec<Effect> {
        if self.can_move().is_ok() {
            self.move_part(command);
        }
        Vec::new()
    }

    fn move_part(&mut self, command: MoveCommand) {
        match command {
            MoveCommand::Drag {
                gesture,
                delta,
                name,
            } => self.drag(gesture, &delta, name),
            MoveCommand::EndDrag => self.end_drag(),
            MoveCommand::AbandonDrag(gesture) => self.abandon(gesture),
            MoveCommand::Translate {
                axis,
                frame,
                distance,
            } => self.translate(axis, frame, distance),
            MoveCommand::Rotate {
                axis,
                frame,
                degrees,
            } => self.rotate(axis, frame, degrees),
            MoveCommand::SetPose {
                crash_from_stamped,
                name,
            } => self.set_pose(name, crash_from_stamped),
            MoveCommand::Paste(text) => self.paste(&text),
            MoveCommand::Flip(axis) => self.flip(axis),
            MoveCommand::AlignCenters => self.align_centers(),
            MoveCommand::Reset => self.set_pose("Reset pose".to_owned(), Similarity::identity()),
            MoveCommand::Begin { kind, frame } => self.begin_move(kind, frame),
            MoveCommand::Input(input) => self.input_move(input),
        }
    }

    /// Pivot and axes for a typed move; the view axes are those of the focused window.
    pub fn move_frame(&self) -> Option<MoveFrame> {
        let pivot = self.document.stamped_center()?;
        let camera = self.view.cameras.get(self.view.focus);
        let view = *camera.world_from_view.to_rotation_matrix().matrix();
        let frame = MoveFrame::new(pivot, self.document.crash_from_stamped(), view);
        Some(frame.with_unit(self.unit_suffix()))
    }

    /// The pose at the grab plus one motion, so that rounding does not pile up over a drag.
    fn drag(&mut self, gesture: GestureId, delta: &Similarity, name: String) {
        let grabbed = self.grab.filter(|(of, _)| *of == gesture);
        let (_, begin) = *self
            .grab
            .insert(grabbed.unwrap_or((gesture, self.document.pose)));
        if *delta == Similarity::identity() && self.history.is_open(gesture) {
            // Back where it was grabbed: the very same state, so that no step remains.
            self.document.pose = begin;
        } else {
            self.commit_pose(name, Some(gesture), delta.after(&begin.crash_from_stamped));
        }
    }

    fn end_drag(&mut self) {
        let grabbed = self.grab.take();
        self.history.end_gesture(&self.document);
        let has_moved = grabbed.is_some_and(|(_, begin)| begin != self.document.pose);
        let name = self.history.undo_name().filter(|_| has_moved);
        if let Some(name) = name.map(str::to_owned) {
            self.log_move(name);
        }
    }

    /// A new pose as a step of its own, with a row in the log.
    fn set_pose(&mut self, name: String, crash_from_stamped: Similarity) {
        if self.commit_pose(name.clone(), None, crash_from_stamped) {
            self.log_move(name);
        }
    }

    fn log_move(&mut self, name: String) {
        self.log_step("move", Some(Role::Stamped), name, None);
    }

    fn abandon(&mut self, gesture: GestureId) {
        let grabbed = self.grab.take().filter(|(of, _)| *of == gesture);
        if let Some(document) = self.history.abandon_gesture(gesture) {
            self.document = document;
        }
        if let Some((_, begin)) = grabbed {
            // If another step came between, taking the drag back is a step of its own.
            self.commit_pose("Take the move back", None, begin.crash_from_stamped);
        }
    }

    /// Applies a motion of the crash model's space to the stamped part.
    fn move_by(&mut self, name: String, delta: &Similarity) {
        self.set_pose(name, delta.after(self.document.crash_from_stamped()));
    }

    fn translate(&mut self, axis: Axis, of: AxisFrame, distance: f64) {
        let Some(frame) = self.move_frame().filter(|_| distance != 0.0) else {
            return;
        };
        let delta = translation_along(&frame.axis(axis, of), distance);
        let name = format!(
            "Move {}{} along {}",
            short_number(distance),
            self.unit_suffix(),
            axis_name(axis, of)
        );
        self.move_by(name, &delta);
    }

    fn rotate(&mut self, axis: Axis, of: AxisFrame, degrees: f64) {
        let Some(frame) = self.move_frame().filter(|_| degrees != 0.0) else {
            return;
        };
        let axis_vector = frame.axis(axis, of);
        let delta = rotation_about(&frame.pivot, &axis_vector, degrees.to_radians());
        let name = format!(
            "Rotate {}° about {}",
            short_number(degrees),
            axis_name(axis, of)
        );
        self.move_by(name, &delta);
    }

    fn paste(&mut self, text: &str) {
        match parse_matrix(text) {
            Ok(parsed) => {
                self.commit_pose("Pasted pose", None, parsed.motion);
                let understood = format!("pasted: {}", parsed.layout.label());
                self.log_at(NoticeLevel::Success, "move", None, understood, None);
                for note in parsed.notes {
                    self.log_at(NoticeLevel::Note, "move", None, note, None);
                }
            }
            Err(error) => {
                let text = format!("nothing pasted: {error}");
                self.log_at(NoticeLevel::Error, "move", None, text, None);
            }
        }
    }

    fn flip(&mut self, axis: Axis) {
        let Some(frame) = self.move_frame() else {
            return;
        };
        let delta = rotation_about(&frame.pivot, &frame.axis(axis, AxisFrame::Part), PI);
        self.move_by(format!("Flip about {} (180°)", axis.letter()), &delta);
    }

    fn align_centers(&mut self) {
        let (Some(here), Some(there)) = (self.document.stamped_center(), self.crash_center())
        else {
            return;
        };
        let delta = Similarity {
            translation: there - here,
            ..Similarity::identity()
        };
        self.move_by("Align centres".to_owned(), &delta);
    }

    fn crash_center(&self) -> Option<Point3> {
        Some(self.document.parts.crash.as_ref()?.bounds().center())
    }

    fn begin_move(&mut self, kind: MotionKind, frame: MoveFrame) {
        if let Some(tool) = self.view.move_tool.take() {
            self.abandon(tool.gesture);
        }
        self.drop_previews();
        self.end_drag();
        self.view.move_tool = Some(MoveTool {
            modal: ModalMove::new(kind),
            frame,
            gesture: self.next_gesture(),
        });
    }

    fn input_move(&mut self, input: ModalInput) {
        let Some(mut tool) = self.view.move_tool.take() else {
            return;
        };
        match tool.modal.input(input, &tool.frame) {
            ModalOutcome::Continue(delta) => {
                let name = tool.modal.name(&tool.frame);
                self.drag(tool.gesture, &delta, name);
                self.view.move_tool = Some(tool);
            }
            ModalOutcome::Accepted(delta, name) => {
                self.drag(tool.gesture, &delta, name);
                self.end_drag();
            }
            ModalOutcome::Rejected => self.abandon(tool.gesture),
        }
    }
}

fn axis_name(axis: Axis, frame: AxisFrame) -> String {
    match frame {
        AxisFrame::Global => axis.letter().to_string(),
        AxisFrame::Part | AxisFrame::View => format!("{} ({})", axis.letter(), frame.label()),
    }
}
