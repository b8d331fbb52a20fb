//! Which part of a window's picture is free of what lies over it, so that parts are fitted into that and letters are
//! seen whole.

use egui::{Rect, Ui, vec2};

use super::{MARGIN, Overlay, cube, free, header, legend, marks};
use crate::app::{Command, ViewCommand, ViewRoom};
use crate::geometry::camera::Covered;

/// Height of the scale bar with its number.
const SCALE_BAR: f32 = 30.0;
/// What lies so near to an edge covers it; further off it lies there on purpose.
const NEAR_EDGE: f32 = 24.0;
/// Air between a part and what lies over the window.
const AIR: f32 = 4.0;

/// Tells the state the shape of the window and what covers it, if that changed. `foot` is what lies above the scale
/// bar.
pub(super) fn tell(
    over: &Overlay<'_>,
    legend: Option<Rect>,
    foot: Option<Rect>,
    commands: &mut Vec<Command>,
) {
    let room = ViewRoom {
        aspect: over.frame.view.aspect,
        covered: covered(over, legend, foot),
    };
    let role = over.role();
    if room.differs(over.frame.state.view.rooms.get(role)) {
        commands.push(ViewCommand::SetRoom(role, room).into());
    }
}

fn covered(over: &Overlay<'_>, legend: Option<Rect>, foot: Option<Rect>) -> Covered {
    let window = over.frame.rect();
    let head = header::height(over).unwrap_or(free::BELOW_CHOICE);
    let foot = foot.map(|foot| window.bottom() - foot.top());
    let foot = foot.unwrap_or(MARGIN + SCALE_BAR + marks::bar_lift(over));
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
        cover(&mut covered, legend, window);
    } else if legend::is_awaited(over) && over.frame.picture.has_colored() {
        // The picture does not grow and shrink while the next map is worked out.
        let last = over.frame.state.view.rooms.get(over.role()).covered;
        (covered.beside, covered.above) = (last.beside, last.above);
    }
    covered
}

/// Adds what a legend covers, where it lies at an edge.
fn cover(covered: &mut Covered, legend: Rect, window: Rect) {
    if window.right() - legend.right() < NEAR_EDGE {
        covered.beside[1] = share(window.right() - legend.left(), window.width());
    } else if legend.left() - window.left() < NEAR_EDGE {
        covered.beside[0] = share(legend.right() - window.left(), window.width());
    } else {
        return;
    }
    covered.above = share(legend.bottom() - window.top(), window.height());
}

/// The places of a window that nothing lies over, as it was drawn last.
pub(in crate::ui::viewport) struct FreeRoom {
    /// Below what lies along the upper edge and above what lies along the lower one.
    between: Rect,
    /// The cube and the legend.
    taken: Vec<Rect>,
}

impl FreeRoom {
    /// That of a window before the rest is drawn over it.
    pub fn of(ui: &Ui, over: &Overlay<'_>) -> Self {
        let window = over.frame.rect();
        let covered = over.frame.state.view.rooms.get(over.role()).covered;
        let at = |x: f64, y: f64| window.lerp_inside(vec2(x as f32, y as f32));
        let [width, height] = covered.corner;
        let corner = Rect::from_min_max(at(0.0, 1.0 - height), at(width, 1.0));
        Self {
            between: Rect::from_min_max(at(0.0, covered.top), at(1.0, 1.0 - covered.bottom)),
            taken: legend::last_place(ui, over)
                .into_iter()
                .chain([corner])
                .collect(),
        }
    }

    /// True if all of a place is free.
    pub fn holds(&self, place: Rect) -> bool {
        let is_taken = |taken: &Rect| taken.intersects(place);
        self.between.contains_rect(place) && !self.taken.iter().any(is_taken)
    }
}

fn share(points: f32, of: f32) -> f64 {
    f64::from((points + AIR) / of.max(1.0))
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_legend_at_an_edge_covers_the_strip_beside_it_or_the_one_above_its_foot() {
        let window = Rect::from_min_max(pos2(0.0, 0.0), pos2(470.0, 570.0));
        let head = Covered {
            top: 0.12,
            ..Covered::default()
        };
        let mut right = head;
        let legend = Rect::from_min_max(pos2(270.0, 44.0), pos2(460.0, 120.0));
        cover(&mut right, legend, window);
        assert!((right.above - 124.0 / 570.0).abs() < 1e-6);
        assert!((right.beside[1] - 204.0 / 470.0).abs() < 1e-6);
        assert_eq!(right.beside[0], 0.0);
        // What lies over the window besides stays as it is.
        assert_eq!((right.left, right.right, right.top), (0.0, 0.0, 0.12));
        let mut left = head;
        let legend = Rect::from_min_max(pos2(10.0, 44.0), pos2(84.0, 344.0));
        cover(&mut left, legend, window);
        assert!((left.beside[0] - 88.0 / 470.0).abs() < 1e-6);
        assert!((left.above - 348.0 / 570.0).abs() < 1e-6);
        assert_eq!(left.beside[1], 0.0);
        // One that was dragged into the picture lies there on purpose.
        let mut none = head;
        let legend = Rect::from_min_max(pos2(100.0, 44.0), pos2(290.0, 120.0));
        cover(&mut none, legend, window);
        assert_eq!(none, head);
    }
}
