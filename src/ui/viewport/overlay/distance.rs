//! The distance between two points: a line with its length, always over the sheets, and what a click would take.

use egui::text::{LayoutJob, TextFormat};
use egui::{
    CornerRadius, FontId, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, vec2,
};

use super::marks::{ring, ringed_line};
use super::pairs::crosshair;
use super::{MARGIN, Overlay};
use crate::geometry::Point3;
use crate::role::Role;
use crate::ui::viewport::navigation::pos_of;

/// Between the line and the plate with its length.
const GAP: f32 = 8.0;
/// Around the text of a plate.
const PADDING: Vec2 = vec2(8.0, 4.0);

/// The points that were picked and the line between them; after the first one the line ends at the pointer.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    if over.frame.state.inspect.distance.is_none() {
        return;
    }
    let painter = over.painter(ui);
    let mut ends = over.frame.state.distance_ends();
    let pick = over.pick.filter(|_| over.drag.is_none());
    if ends.len() == 1 {
        ends.extend(pick.map(|pick| (pick.role, pick.picked.point)));
    }
    let places: Vec<_> = ends.iter().map(|end| place(over, end)).collect();
    if let ([from, to], [Some(a), Some(b)]) = (&ends[..], &places[..]) {
        ringed_line(&painter, over, [*a, *b]);
        length(ui, over, [*from, *to], [*a, *b]);
    }
    for at in places.into_iter().flatten() {
        ring(&painter, over, at, 4.5);
    }
    if let Some(pick) = pick {
        crosshair(&painter, over, pick.at);
    }
}

/// Where a point is drawn; not where the stamped part is shown at a pose that the distance is not of.
fn place(over: &Overlay<'_>, (role, point): &(Role, Point3)) -> Option<Pos2> {
    let at = over.frame.picture.world_of(*role, point)?;
    let is_seen = !over.frame.shows_other_pose();
    pos_of(over.frame.rect(), &over.frame.view.camera, &at).filter(|_| is_seen)
}

/// The length beside the middle of the line, and below it the way along each axis.
fn length(ui: &Ui, over: &Overlay<'_>, ends: [(Role, Point3); 2], line: [Pos2; 2]) {
    let texts = over.frame.state.distance_texts(ends);
    let painter = over.painter(ui);
    let galley = painter.layout_job(two_lines(over, &texts));
    let plate = beside(line, galley.size() + 2.0 * PADDING);
    let plate = within(over.frame.rect().shrink(MARGIN / 2.0), plate);
    let id = ui.make_persistent_id(("distance", over.role().word()));
    let response = ui.interact(plate, id, Sense::hover());
    response.widget_info(|| {
        let name = format!("Distance {}, {}", texts[0], texts[1]);
        WidgetInfo::labeled(egui::Role::Label, true, name)
    });
    let look = over.frame.look;
    painter.rect(
        plate,
        CornerRadius::same(5),
        look.plate.to_opaque(),
        Stroke::new(1.2, look.tool),
        StrokeKind::Inside,
    );
    painter.galley(plate.min + PADDING, galley, look.text);
}

fn two_lines(over: &Overlay<'_>, [length, axes]: &[String; 2]) -> LayoutJob {
    let look = over.frame.look;
    let mut job = LayoutJob::default();
    let format = |size, color| TextFormat::simple(FontId::proportional(size), color);
    job.append(length, 0.0, format(12.5, look.text));
    job.append(&format!("\n{axes}"), 0.0, format(10.5, look.weak));
    job
}

/// A plate above the middle of a line, which it does not touch.
fn beside([from, to]: [Pos2; 2], size: Vec2) -> Rect {
    let along = (to - from).normalized();
    let up = if along.x < 0.0 {
        vec2(-along.y, along.x)
    } else {
        vec2(along.y, -along.x)
    };
    let up = if up == Vec2::ZERO { -Vec2::Y } else { up };
    let reach = 0.5 * (up.abs() * size).dot(Vec2::splat(1.0)) + GAP;
    Rect::from_center_size(from + 0.5 * (to - from) + up * reach, size)
}

/// The plate moved into the window.
fn within(window: Rect, plate: Rect) -> Rect {
    let farthest = (window.max - plate.size()).max(window.min);
    Rect::from_min_size(plate.min.clamp(window.min, farthest), plate.size())
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn the_length_lies_beside_its_line_in_the_window() {
        let window = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let size = vec2(120.0, 30.0);
        let middle = pos2(200.0, 150.0);
        for end in [
            pos2(260.0, 150.0),
            pos2(140.0, 150.0),
            pos2(200.0, 90.0),
            pos2(230.0, 190.0),
            middle,
        ] {
            let line = [middle, end];
            let plate = within(window, beside(line, size));
            for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let at = middle + share * (end - middle);
                assert!(plate.distance_to_pos(at) > 0.9 * GAP, "{end:?}: {plate:?}");
            }
        }
        let outside = [pos2(-900.0, 20.0), pos2(-100.0, 10.0)];
        assert!(window.contains_rect(within(window, beside(outside, size))));
        let small = Rect::from_min_size(Pos2::ZERO, vec2(50.0, 20.0));
        assert_eq!(within(small, beside(outside, size)).min, small.min);
    }
}
