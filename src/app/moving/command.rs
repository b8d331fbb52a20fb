//! What can happen to the pose by hand.

use super::{Axis, AxisFrame, ModalInput, MotionKind, MoveFrame};
use crate::app::GestureId;
use crate::geometry::Similarity;

/// Moves of the stamped part by hand. The crash part has no pose.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveCommand {
    /// While dragging: the motion since the grab, in the space of the crash model.
    Drag {
        /// The drag all its motions belong to; they are one undo step.
        gesture: GestureId,
        /// Motion since the grab.
        delta: Similarity,
        /// Name of the undo step.
        name: String,
    },
    /// The drag ended.
    EndDrag,
    /// The drag is taken back.
    AbandonDrag(GestureId),
    /// A typed distance along an axis of a frame.
    Translate {
        /// Axis of the translation.
        axis: Axis,
        /// Of which frame.
        frame: AxisFrame,
        /// In lengths of the crash model.
        distance: f64,
    },
    /// A typed angle about an axis of a frame through the part's centre.
    Rotate {
        /// Axis of the rotation.
        axis: Axis,
        /// Of which frame.
        frame: AxisFrame,
        /// Angle in degrees, by the right-hand rule.
        degrees: f64,
    },
    /// A whole new pose, for example from a field.
    SetPose {
        /// The new pose.
        crash_from_stamped: Similarity,
        /// Name of the undo step.
        name: String,
    },
    /// A pose as text, in any common layout.
    Paste(String),
    /// Rotate by 180° about one of the part's own axes through its centre.
    Flip(Axis),
    /// Make the centres of the two boxes coincide.
    AlignCenters,
    /// Back to the pose as loaded.
    Reset,
    /// Begin to move or rotate by keys.
    Begin {
        /// Move or rotate.
        kind: MotionKind,
        /// Pivot and axes now.
        frame: MoveFrame,
    },
    /// An input to the move by keys.
    Input(ModalInput),
    /// Show the gizmo or not.
    ToggleGizmo,
    /// Whose axes gizmo and keys use.
    SetAxes(AxisFrame),
}
