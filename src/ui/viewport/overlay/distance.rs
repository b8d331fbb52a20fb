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
/// Air between a plate and what it must not cover.
const AIR: f32 = 3.0;
/// Places of a plate along its line, as shares of it, and how much farther from the line than usual, tried in turn.
const ALONG: [f32; 7] = [0.5, 0.35, 0.65, 0.2, 0.8, 0.0, 1.0];
const FARTHER: [f32; 4] = [0.0, 30.0, 80.0, 150.0];
/// Above the middle of the line, as near as usual.
const ABOVE: (f32, f32, f32) = (0.5, 1.0, 0.0);

/// The points that were picked and the line between them; after the first one the line ends at the pointer. The plate
/// with the length keeps clear of what is `taken`.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>, taken: &[Rect]) {
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
        length(ui, over, ([*from, *to], [*a, *b]), taken);
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

/// The length beside the line, below it the way along each axis, and which ends are centres of holes.
fn length(
    ui: &Ui,
    over: &Overlay<'_>,
    (ends, line): ([(Role, Point3); 2], [Pos2; 2]),
    taken: &[Rect],
) {
    let state = over.frame.state;
    let mut texts = state.distance_texts(ends).to_vec();
    texts.extend(state.distance_holes(ends).map(str::to_owned));
    let painter = over.painter(ui);
    let galley = painter.layout_job(lines(over, &texts));
    let window = over.frame.rect().shrink(MARGIN / 2.0);
    let plate = plate_place((window, taken), line, galley.size() + 2.0 * PADDING);
    let id = ui.make_persistent_id(("distance", over.role().word()));
    let response = ui.interact(plate, id, Sense::hover());
    response.widget_info(|| {
        let name = format!("Distance {}", texts.join(", "));
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

fn lines(over: &Overlay<'_>, texts: &[String]) -> LayoutJob {
    let look = over.frame.look;
    let mut job = LayoutJob::default();
    for (i, text) in texts.iter().enumerate() {
        let (break_before, size, color) = match i {
            0 => ("", 12.5, look.text),
            _ => ("\n", 10.5, look.weak),
        };
        let format = TextFormat::simple(FontId::proportional(size), color);
        job.append(&format!("{break_before}{text}"), 0.0, format);
    }
    job
}

/// The first free place of a plate beside its line, above the middle before all others. Where none is free, it covers.
fn plate_place((window, taken): (Rect, &[Rect]), line: [Pos2; 2], size: Vec2) -> Rect {
    let is_free = |plate: &Rect| !taken.iter().any(|t| t.intersects(plate.expand(AIR)));
    let sides = [1.0, -1.0];
    let places = FARTHER.into_iter().flat_map(|farther| {
        let along = ALONG
            .into_iter()
            .flat_map(move |share| sides.map(|side| (share, side)));
        along.map(move |(share, side)| within(window, beside(line, (share, side, farther), size)))
    });
    let mut free = places.filter(|plate| is_free(plate) && !is_crossed(plate, line));
    free.next()
        .unwrap_or_else(|| within(window, beside(line, ABOVE, size)))
}

/// True if the line runs through the plate, or touches it nearly.
fn is_crossed(plate: &Rect, [from, to]: [Pos2; 2]) -> bool {
    let plate = plate.expand(AIR);
    // Which part of the line lies between the edges, as shares of it.
    let mut part = [0.0_f32, 1.0];
    for axis in 0..2 {
        let (low, high) = (plate.min[axis], plate.max[axis]);
        let (at, way) = (from[axis], to[axis] - from[axis]);
        if way == 0.0 {
            if at < low || at > high {
                return false;
            }
            continue;
        }
        let ends = [(low - at) / way, (high - at) / way];
        part = [
            part[0].max(ends[0].min(ends[1])),
            part[1].min(ends[0].max(ends[1])),
        ];
    }
    part[0] <= part[1]
}

/// A plate beside a line, which it does not touch: where along it, above (1) or below (−1), how much farther away than
/// usual.
fn beside([from, to]: [Pos2; 2], (share, side, farther): (f32, f32, f32), size: Vec2) -> Rect {
    let along = (to - from).normalized();
    let up = if along.x < 0.0 {
        vec2(-along.y, along.x)
    } else {
        vec2(along.y, -along.x)
    };
    let up = if up == Vec2::ZERO { -Vec2::Y } else { up };
    let reach = 0.5 * (up.abs() * size).dot(Vec2::splat(1.0)) + GAP + farther;
    Rect::from_center_size(from + share * (to - from) + up * (side * reach), size)
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
            let plate = within(window, beside(line, ABOVE, size));
            for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let at = middle + share * (end - middle);
                assert!(plate.distance_to_pos(at) > 0.9 * GAP, "{end:?}: {plate:?}");
            }
        }
        let outside = [pos2(-900.0, 20.0), pos2(-100.0, 10.0)];
        assert!(window.contains_rect(within(window, beside(outside, ABOVE, size))));
        let small = Rect::from_min_size(Pos2::ZERO, vec2(50.0, 20.0));
        assert_eq!(within(small, beside(outside, ABOVE, size)).min, small.min);
    }

    #[test]
    fn the_length_keeps_clear_of_labels_and_legend() {
        let window = Rect::from_min_size(Pos2::ZERO, vec2(600.0, 400.0));
        let size = vec2(120.0, 44.0);
        let line = [pos2(150.0, 200.0), pos2(450.0, 200.0)];
        let usual = plate_place((window, &[]), line, size);
        assert_eq!(usual, beside(line, ABOVE, size));
        // What lies over the usual place, over both sides of the middle, over all that is above.
        let below = beside(line, (0.5, -1.0, 0.0), size);
        let above = Rect::from_min_max(Pos2::ZERO, pos2(600.0, 195.0));
        for taken in [&[usual][..], &[usual, below], &[above], &[above, below]] {
            let plate = plate_place((window, taken), line, size);
            let is_clear = taken.iter().all(|t| !t.intersects(plate));
            assert!(
                is_clear && window.contains_rect(plate),
                "{taken:?}: {plate:?}"
            );
            for x in 150..450 {
                let at = pos2(x as f32, 200.0);
                assert!(plate.distance_to_pos(at) > 2.0, "{plate:?}");
            }
        }
        // Nowhere is free.
        assert_eq!(plate_place((window, &[window]), line, size), usual);
    }
}
