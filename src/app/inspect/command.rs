//! What can happen to deviation, section, labels and the distance between two points.

use super::SectionView;
use crate::app::GestureId;
use crate::geometry::Point3;
use crate::role::Role;

/// What becomes of labels, what is looked at, and what is measured.
#[derive(Debug, Clone, PartialEq)]
pub enum InspectCommand {
    /// Measure the deviation at the shown pose.
    Update,
    /// Let the range of the map be that of its values.
    FitRange,
    /// Pin a label to the node next to a point of the part's own frame.
    Pin(Role, Point3),
    /// Call a label so.
    Rename {
        /// Number of the label.
        id: u64,
        /// What it is called.
        name: String,
        /// The typing it belongs to.
        gesture: GestureId,
    },
    /// Take a label away.
    Remove(u64),
    /// Take all labels away.
    RemoveAll,
    /// Bring a point of the part's own frame close into view.
    LookAt {
        /// Of which part.
        role: Role,
        /// Point of the surface, in crash coordinates.
        point: Point3,
        /// What is said about it where it is marked.
        text: String,
    },
    /// Begin to measure between two points, or end it.
    ToggleDistance,
    /// Measure from or to a point of the part's own frame.
    MeasureTo(Role, Point3),
    /// The section plane, as a whole.
    SetSection(SectionView),
}
