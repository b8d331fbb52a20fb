//! Moves by hand: handles, keys, numbers, pasted matrices, and the overlap that follows them.

mod command;
pub mod gizmo;
mod modal;
mod motion;
mod overlap;

use std::f64::consts::PI;

pub use command::MoveCommand;
pub use modal::{Constraint, ModalInput, ModalMove, ModalOutcome, MotionKind, short_number};
pub use motion::{
    Axis, AxisFrame, MoveFrame, rotation_about, translation_along, turns_deg, with_turns_deg,
};
pub use overlap::PoseOverlap;

use super::follow_up::FollowUp;
use super::work::Work;
use super::{AppState, GestureId, NoticeLevel, Reason, StampedPose};
use crate::app::LogStep;
use crate::geometry::{Point3, Similarity};
use crate::jobs::Stamp;
use crate::report::parse_matrix;
use crate::role::Role;

/// A move or rotation by keys that is under way.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveTool {
    /// What was typed and dragged so far.
    pub modal: ModalMove,
    /// Pivot and axes as they were at its beginning.
    pub frame: MoveFrame,
    /// Its one undo step.
    pub gesture: GestureId,
}

/// The tools that move the stamped part, and what is under way with them.
#[derive(Debug, Clone, Default)]
pub struct MovingState {
    /// The gizmo is shown.
    pub has_gizmo: bool,
    /// Whose axes gizmo and keys use.
    pub axes: AxisFrame,
    /// The move by keys that is under way.
    pub tool: Option<MoveTool>,
    /// The pose at the beginning of the drag or move by keys that is under way.
    grab: Option<(GestureId, StampedPose)>,
    /// The overlap after the last move.
    overlap: Option<PoseOverlap>,
    /// The state whose overlap was asked for last.
    overlap_asked: Option<Stamp>,
}

impl AppState {
    /// `Ok` if the stamped part may be moved now.
    pub fn can_move(&self) -> Result<(), Reason> {
        self.document.can_move(&self.jobs)
    }

    /// Pivot and axes for a typed move; the view axes are those of the focused window.
    pub fn move_frame(&self) -> Option<MoveFrame> {
        let pivot = self.document.stamped_center()?;
        let camera = self.view.cameras.get(self.view.focus);
        let view = *camera.world_from_view.to_rotation_matrix().matrix();
        let frame = MoveFrame::new(pivot, self.document.crash_from_stamped(), view);
        Some(frame.with_unit(self.document.unit_suffix()))
    }
}

impl MovingState {
    /// True while the part is grabbed by pointer or keys.
    pub fn is_moving(&self) -> bool {
        self.is_grabbed() || self.tool.is_some()
    }

    /// True while the part is dragged.
    pub(super) fn is_grabbed(&self) -> bool {
        self.grab.is_some()
    }

    /// `frame` is [`AppState::move_frame`].
    pub(super) fn apply(
        &mut self,
        work: &mut Work<'_>,
        command: MoveCommand,
        frame: Option<MoveFrame>,
    ) {
        match command {
            MoveCommand::ToggleGizmo => self.has_gizmo = !self.has_gizmo,
            MoveCommand::SetAxes(axes) => self.axes = axes,
            MoveCommand::EndDrag => self.end_drag(work),
            // The part is let go, and stays where the job that holds it has it.
            MoveCommand::AbandonDrag(_) if work.can_move().is_err() => self.end_drag(work),
            _ if work.can_move().is_err() => {}
            MoveCommand::Begin { .. } | MoveCommand::Input(_) => {
                self.move_part(work, command, frame);
            }
            _ => {
                // Another move ends the one by keys as it is, so that Escape does not take back both.
                if self.tool.take().is_some() {
                    self.end_drag(work);
                }
                self.move_part(work, command, frame);
            }
        }
    }

    /// Ends the move by keys without a trace.
    pub(super) fn reject_tool(&mut self, work: &mut Work<'_>) {
        if work.can_move().is_ok() {
            self.input_move(work, ModalInput::Reject);
        }
    }

    fn move_part(&mut self, work: &mut Work<'_>, command: MoveCommand, now: Option<MoveFrame>) {
        match command {
            MoveCommand::ToggleGizmo | MoveCommand::SetAxes(_) | MoveCommand::EndDrag => {}
            MoveCommand::Drag {
                gesture,
                delta,
                name,
            } => self.drag(work, gesture, &delta, name),
            MoveCommand::AbandonDrag(gesture) => self.abandon(work, gesture),
            MoveCommand::Translate {
                axis,
                frame,
                distance,
            } => translate(
                work,
                now,
                &TypedMove {
                    axis,
                    of: frame,
                    by: distance,
                },
            ),
            MoveCommand::Rotate {
                axis,
                frame,
                degrees,
            } => rotate(
                work,
                now,
                &TypedMove {
                    axis,
                    of: frame,
                    by: degrees,
                },
            ),
            MoveCommand::SetPose {
                crash_from_stamped,
                name,
            } => set_pose(work, name, crash_from_stamped),
            MoveCommand::Paste(text) => paste(work, &text),
            MoveCommand::Flip(axis) => flip(work, now, axis),
            MoveCommand::AlignCenters => align_centers(work),
            MoveCommand::Reset => set_pose(work, "Reset pose".to_owned(), Similarity::identity()),
            MoveCommand::Begin { kind, frame } => self.begin_move(work, kind, frame),
            MoveCommand::Input(input) => self.input_move(work, input),
        }
    }

    /// The pose at the grab plus one motion, so that rounding does not pile up over a drag.
    fn drag(&mut self, work: &mut Work<'_>, gesture: GestureId, delta: &Similarity, name: String) {
        let grabbed = self.grab.filter(|(of, _)| *of == gesture);
        let (_, begin) = *self
            .grab
            .insert(grabbed.unwrap_or((gesture, work.document.pose)));
        if *delta == Similarity::identity() && work.history.is_open(gesture) {
            // Back where it was grabbed: the very same state, so that no step remains.
            work.document.pose = begin;
        } else {
            work.commit_pose(name, Some(gesture), delta.after(&begin.crash_from_stamped));
        }
    }

    fn end_drag(&mut self, work: &mut Work<'_>) {
        let grabbed = self.grab.take();
        work.history.end_gesture(work.document);
        let has_moved = grabbed.is_some_and(|(_, begin)| begin != work.document.pose);
        let name = work.history.undo_name().filter(|_| has_moved);
        if let Some(name) = name.map(str::to_owned) {
            log_move(work, name);
        }
    }

    fn abandon(&mut self, work: &mut Work<'_>, gesture: GestureId) {
        let grabbed = self.grab.take().filter(|(of, _)| *of == gesture);
        if let Some(document) = work.history.abandon_gesture(gesture) {
            *work.document = document;
        }
        if let Some((_, begin)) = grabbed {
            // If another step came between, taking the drag back is a step of its own.
            work.commit_pose("Take the move back", None, begin.crash_from_stamped);
        }
    }

    fn begin_move(&mut self, work: &mut Work<'_>, kind: MotionKind, frame: MoveFrame) {
        if let Some(tool) = self.tool.take() {
            self.abandon(work, tool.gesture);
        }
        work.previews.drop_all();
        self.end_drag(work);
        self.tool = Some(MoveTool {
            modal: ModalMove::new(kind),
            frame,
            gesture: GestureId::new(),
        });
    }

    fn input_move(&mut self, work: &mut Work<'_>, input: ModalInput) {
        let Some(mut tool) = self.tool.take() else {
            return;
        };
        match tool.modal.input(input, &tool.frame) {
            ModalOutcome::Continue(delta) => {
                let name = tool.modal.name(&tool.frame);
                self.drag(work, tool.gesture, &delta, name);
                self.tool = Some(tool);
            }
            ModalOutcome::Accepted(delta, name) => {
                self.drag(work, tool.gesture, &delta, name);
                self.end_drag(work);
            }
            ModalOutcome::Rejected => self.abandon(work, tool.gesture),
        }
    }
}

/// A typed distance or angle along or about an axis.
struct TypedMove {
    axis: Axis,
    of: AxisFrame,
    by: f64,
}

/// A new pose as a step of its own, with a row in the log.
fn set_pose(work: &mut Work<'_>, name: String, crash_from_stamped: Similarity) {
    if work.commit_pose(name.clone(), None, crash_from_stamped) {
        log_move(work, name);
    }
}

fn log_move(work: &mut Work<'_>, name: String) {
    work.follow(FollowUp::MovedByHand);
    work.log_step(LogStep::Move, Some(Role::Stamped), name, None);
}

/// Applies a motion of the crash model's space to the stamped part.
fn move_by(work: &mut Work<'_>, name: String, delta: &Similarity) {
    set_pose(work, name, delta.after(work.document.crash_from_stamped()));
}

fn translate(work: &mut Work<'_>, frame: Option<MoveFrame>, typed: &TypedMove) {
    let TypedMove { axis, of, by } = *typed;
    let Some(frame) = frame.filter(|_| by != 0.0) else {
        return;
    };
    let delta = translation_along(&frame.axis(axis, of), by);
    let name = format!(
        "Move {}{} along {}",
        short_number(by),
        work.document.unit_suffix(),
        axis_name(axis, of)
    );
    move_by(work, name, &delta);
}

fn rotate(work: &mut Work<'_>, frame: Option<MoveFrame>, typed: &TypedMove) {
    let TypedMove { axis, of, by } = *typed;
    let Some(frame) = frame.filter(|_| by != 0.0) else {
        return;
    };
    let axis_vector = frame.axis(axis, of);
    let delta = rotation_about(&frame.pivot, &axis_vector, by.to_radians());
    let name = format!("Rotate {}° about {}", short_number(by), axis_name(axis, of));
    move_by(work, name, &delta);
}

fn paste(work: &mut Work<'_>, text: &str) {
    match parse_matrix(text) {
        Ok(parsed) => {
            work.commit_pose("Pasted pose", None, parsed.motion);
            let remark = parsed.remark();
            let remark = remark.map_or_else(String::new, |remark| format!(", {remark}"));
            let understood = format!("pasted: {}{remark}", parsed.layout.label());
            work.log_at(NoticeLevel::Success, LogStep::Move, None, understood, None);
            for note in parsed.notes {
                work.log_at(NoticeLevel::Note, LogStep::Move, None, note, None);
            }
        }
        Err(error) => {
            let text = format!("nothing pasted: {error}");
            work.log_at(NoticeLevel::Error, LogStep::Move, None, text, None);
        }
    }
}

fn flip(work: &mut Work<'_>, frame: Option<MoveFrame>, axis: Axis) {
    let Some(frame) = frame else {
        return;
    };
    let delta = rotation_about(&frame.pivot, &frame.axis(axis, AxisFrame::Part), PI);
    move_by(work, format!("Flip about {} (180°)", axis.letter()), &delta);
}

fn align_centers(work: &mut Work<'_>) {
    let (Some(here), Some(there)) = (work.document.stamped_center(), crash_center(work)) else {
        return;
    };
    let delta = Similarity::from_translation(there - here);
    move_by(work, "Align centres".to_owned(), &delta);
}

fn crash_center(work: &Work<'_>) -> Option<Point3> {
    Some(work.document.parts.crash.as_ref()?.bounds().center())
}

fn axis_name(axis: Axis, frame: AxisFrame) -> String {
    match frame {
        AxisFrame::Global => axis.letter().to_string(),
        AxisFrame::Part | AxisFrame::View => format!("{} ({})", axis.letter(), frame.label()),
    }
}
