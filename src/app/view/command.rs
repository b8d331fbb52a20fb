//! What can happen to cameras, windows and panels.

use std::path::PathBuf;

use super::{BottomTab, ColumnRoom, Dialog, Display, FreeWindow, Section, ShownGeometry, ViewRoom};
use crate::geometry::camera::{OrbitStyle, StandardView};
use crate::geometry::{Camera, Point3};
use crate::role::Role;

/// What is shown and how.
#[derive(Debug, Clone, PartialEq)]
pub enum ViewCommand {
    /// A new camera after a drag or a turn of the wheel.
    SetCamera(Role, Camera),
    /// A view with a key of its own.
    Standard(Role, StandardView),
    /// From a direction, each component −1, 0 or 1.
    LookFrom(Role, [i8; 3]),
    /// The camera before the last jump.
    PreviousCamera(Role),
    /// Orthographic or perspective.
    ToggleProjection(Role),
    /// Fit what is visible in a window.
    FitAll(Role),
    /// The same in both windows.
    FitBoth,
    /// Fit the selected part, or all.
    Focus(Role),
    /// Link the two cameras or not.
    ToggleLink,
    /// Turntable or free.
    SetOrbitStyle(OrbitStyle),
    /// Pick or forget the pivot of a window.
    SetPivot(Role, Option<Point3>),
    /// Shape of a window and what lies over it; the shell reports when it changes.
    SetRoom(Role, ViewRoom),
    /// The window that keys act on.
    SetFocus(Role),
    /// Draw a stamped file or not.
    ShowFile(PathBuf, bool),
    /// Move over or back.
    ToggleMoveOver,
    /// Reduced or detailed.
    SetShown(ShownGeometry),
    /// The blink key went down or up.
    SetBlinking(bool),
    /// Plain choices about the picture, as a whole.
    SetDisplay(Box<Display>),
    /// A tab of the bottom pane.
    SetTab(BottomTab),
    /// What the right window shows while its part is in the left one.
    SetFreeWindow(FreeWindow),
    /// Fold or unfold a section.
    OpenSection(Section, bool),
    /// Unfold a section, and the column where it is folded.
    ShowSection(Section),
    /// Show section 3 and unfold what moves the part by hand in it.
    ShowMoveByHand,
    /// The user works in a section; it is the last to be folded for want of room.
    UseSection(Section),
    /// Fold the left column to a rail, or unfold it.
    FoldColumn(bool),
    /// The room for the left column beside the 3D windows, as the shell reports.
    SetColumnRoom(ColumnRoom),
    /// Only the 3D windows, or everything.
    ToggleGraphicsOnly,
    /// Open something over the window, or close it.
    SetDialog(Option<Dialog>),
}
