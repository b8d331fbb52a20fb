//! What the user chose for a drawing of the section, and which view of it is kept.

use egui::Vec2;
use egui_plot::PlotUi;

use crate::geometry::Vector3;
use crate::role::{PerRole, Role};
use crate::ui::viewport::outlines::Lie;

/// Zoom per point of the wheel.
const ZOOM: f32 = 0.004;

/// What the user chose, kept while the program runs; the tab and the window have their own, as they differ in shape.
#[derive(Debug, Clone, Default)]
pub(super) struct Choices {
    pub is_exaggerated: bool,
    /// Clicked points.
    pub picked: Vec<[f64; 2]>,
    /// What the view belongs to.
    drawn: Option<Drawn>,
    /// It was zoomed, at first or by the user: it stays as it is.
    pub is_zoomed: bool,
    pub zoom: Option<Zoom>,
    /// How the outlines lay when they were drawn last.
    pub lie: Option<Lie>,
}

/// What a view belongs to. The plane may move along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Drawn {
    normal: Vector3,
    /// The revisions of the parts.
    parts: PerRole<u64>,
    are_apart: bool,
}

/// Where the drawing goes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Zoom {
    WorstGap,
    Part(Role),
    All,
}

impl Choices {
    /// Notices across which direction which parts are cut, and asks for the first view of them. True if that is
    /// another drawing than before, to which the view of the last one does not belong.
    pub fn notice(
        &mut self,
        (normal, parts): (Vector3, PerRole<u64>),
        lie: Lie,
        has_worst: bool,
    ) -> bool {
        let are_apart = match lie {
            Lie::Apart(_) => true,
            Lie::Together => false,
            // An outline may still be to come.
            Lie::Alone(_) | Lie::Nowhere => self.drawn.is_some_and(|drawn| drawn.are_apart),
        };
        let drawn = Drawn {
            normal,
            parts,
            are_apart,
        };
        let is_new = self.drawn.replace(drawn) != Some(drawn);
        if is_new {
            self.is_zoomed = false;
            // Points of another plane are none of this one.
            self.picked.clear();
        }
        let first = match lie {
            Lie::Apart(_) => Some(Zoom::Part(Role::Crash)),
            Lie::Together => has_worst.then_some(Zoom::WorstGap),
            Lie::Alone(_) | Lie::Nowhere => None,
        };
        if let Some(first) = first.filter(|_| !self.is_zoomed) {
            self.zoom = self.zoom.or(Some(first));
            self.is_zoomed = true;
        }
        is_new
    }
}

/// The wheel zooms, down to a height of `least`.
pub(super) fn zoom_by_wheel(plot: &mut PlotUi<'_>, least: f64) {
    if plot.response().hovered() {
        let scroll = plot.ctx().input(|i| i.smooth_scroll_delta().y);
        let most = (plot.plot_bounds().height() / least).max(1.0) as f32;
        let factor = (scroll * ZOOM).exp().min(most);
        if factor != 1.0 {
            plot.zoom_bounds_around_hovered(Vec2::splat(factor));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_is_kept_until_plane_or_parts_change() {
        let mut choices = Choices::default();
        let parts = PerRole {
            crash: 1,
            stamped: 2,
        };
        let across = Vector3::x();
        assert!(choices.notice((across, parts), Lie::Together, false));
        assert_eq!(choices.zoom, None, "no gap is known yet");
        assert!(!choices.notice((across, parts), Lie::Together, true));
        assert_eq!(choices.zoom.take(), Some(Zoom::WorstGap));
        for lie in [Lie::Together, Lie::Nowhere, Lie::Alone(Role::Crash)] {
            assert!(!choices.notice((across, parts), lie, true), "{lie:?}");
            assert_eq!(choices.zoom, None, "{lie:?}");
        }
        assert!(choices.notice((across, parts), Lie::Apart(9.0), false));
        assert_eq!(choices.zoom.take(), Some(Zoom::Part(Role::Crash)));
        let others = PerRole { crash: 3, ..parts };
        for drawn in [(Vector3::y(), parts), (Vector3::y(), others)] {
            assert!(choices.notice(drawn, Lie::Together, true), "{drawn:?}");
            assert_eq!(choices.zoom.take(), Some(Zoom::WorstGap), "{drawn:?}");
        }
        // Who zooms before the gaps are known keeps that.
        assert!(choices.notice((across, others), Lie::Together, false));
        choices.is_zoomed = true;
        assert!(!choices.notice((across, others), Lie::Together, true));
        assert_eq!(choices.zoom, None);
    }
}
