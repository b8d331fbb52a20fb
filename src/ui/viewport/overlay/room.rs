//! Which part of a window's picture is free of what lies over it, so that parts are fitted into that.

use egui::Rect;

use super::{MARGIN, Overlay, banner, cube, free, header};
use crate::app::{Command, ViewCommand, ViewRoom};
use crate::geometry::camera::Covered;

/// Height of the scale bar with its number.
const SCALE_BAR: f32 = 30.0;
/// What lies so near to an edge covers it; further off it lies there on purpose.
const NEAR_EDGE: f32 = 24.0;
/// Air between a part and what lies over the window.
const AIR: f32 = 4.0;

/// Tells the state the shape of the window and what covers it, if that changed.
pub(super) fn tell(
    over: &Overlay<'_>,
    legend: Option<Rect>,
    has_banner: bool,
    commands: &mut Vec<Command>,
) {
    let room = ViewRoom {
        aspect: over.frame.view.aspect,
        covered: covered(over, legend, has_banner),
    };
    let role = over.role();
    if room.differs(over.frame.state.view.rooms.get(role)) {
        commands.push(ViewCommand::SetRoom(role, room).into());
    }
}

fn covered(over: &Overlay<'_>, legend: Option<Rect>, has_banner: bool) -> Covered {
    let window = over.frame.rect();
    let head = header::height(over).unwrap_or(free::BELOW_CHOICE);
    let foot = if has_banner {
        banner::TOP
    } else {
        MARGIN + SCALE_BAR
    };
    let corner = if cube::is_shown(over) {
        let [width, height] = [MARGIN + cube::SIZE; 2];
        [share(width, window.width()), share(height, window.height())]
    } else {
        [0.0; 2]
    };
    let mut covered = Covered {
        corner,
        top: share(MARGIN + head, window.height()),
        bottom: share(foot, window.height()),
        ..Covered::default()
    };
    if let Some(legend) = legend {
        if window.right() - legend.right() < NEAR_EDGE {
            covered.right = share(window.right() - legend.left(), window.width());
        } else if legend.left() - window.left() < NEAR_EDGE {
            covered.left = share(legend.right() - window.left(), window.width());
        }
    }
    covered
}

fn share(points: f32, of: f32) -> f64 {
    f64::from((points + AIR) / of.max(1.0))
}
