//! Scale bar, readout, pivot.

use egui::{CornerRadius, FontId, Painter, Pos2, Rect, Stroke, Ui, Vec2, vec2};

use super::{MARGIN, Overlay, cube, legend};
use crate::app::{AppState, ColorBy, MapPicture};
use crate::assess::deviation::OverlapClass;
use crate::colormap::ColorScale;
use crate::geometry::camera::scale_bar;
use crate::mapping::Status;
use crate::pipeline::forming_values::FormingValue;
use crate::role::Role;
use crate::text::{fixed, inside, length};
use crate::ui::viewport::fields::FieldKind;
use crate::ui::viewport::navigation::{DragKind, pos_of, screen_of};
use crate::ui::viewport::picture::Hit;
use crate::ui::widgets::signed;

/// Height of the scale bar with its number, below a readout that has no room beside it.
const ABOVE_BAR: f32 = 30.0;
/// Most rows of a readout.
const READOUT_ROWS: usize = 3;
/// Less room beside a legend breaks its words.
const LEAST_ROOM: f32 = 170.0;
/// Longest scale bar.
const MAX_BAR: f64 = 150.0;

/// Scale bar, and a readout that keeps off the legend and off what is `said` at the foot of the window, from below.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>, legend: Option<Rect>, said: [Option<Rect>; 2]) {
    let painter = over.painter(ui);
    let display = &over.frame.state.view.display;
    let mut taken = over.frame.rect().left() + MARGIN;
    if display.has_scale_bar && !over.frame.picture.is_empty() {
        taken = bar(&painter, over);
    }
    readout(&painter, over, taken, (legend, said));
}

/// Longest scale bar in this window.
fn max_bar(over: &Overlay<'_>) -> f64 {
    MAX_BAR.min(f64::from(over.frame.rect().width()) * 0.25)
}

/// How far from the left edge the scale bar begins.
fn bar_begin(over: &Overlay<'_>) -> f32 {
    let beside = if cube::is_shown(over) {
        cube::SIZE + 14.0
    } else {
        8.0
    };
    MARGIN + beside
}

/// Least room for the number of a scale bar with its ground.
const BAR_NUMBER: f32 = 72.0;

/// How much higher than usual the scale bar lies, over a button for which there is no room beside it.
pub(super) fn bar_lift(over: &Overlay<'_>) -> f32 {
    let window = over.frame.rect();
    let widest = (max_bar(over) as f32 + 16.0).max(BAR_NUMBER);
    let right = window.left() + bar_begin(over) - 8.0 + widest;
    match legend::button(over) {
        Some(button) if right > button.left() => window.bottom() - button.top(),
        _ => 0.0,
    }
}

/// The scale bar; returns where it ends.
fn bar(painter: &Painter, over: &Overlay<'_>) -> f32 {
    let camera = &over.frame.view.camera;
    let size = camera.pixel_size(screen_of(over.frame.rect()), &camera.target);
    let max_bar = max_bar(over);
    let Some(bar) = scale_bar(size, max_bar) else {
        return over.frame.rect().left() + MARGIN;
    };
    let above = MARGIN + 8.0 + bar_lift(over);
    let left = over.frame.rect().left_bottom() + vec2(bar_begin(over), -above);
    let right = left + vec2(bar.pixels as f32, 0.0);
    // Both parts in one window lie in the space of the crash part.
    let state = over.frame.state;
    let space = if state.view.is_moved_over {
        Role::Crash
    } else {
        over.role()
    };
    let text = length_text(bar.length) + state.lengths_of(space).suffix();
    let galley = painter.layout_no_wrap(text, FontId::proportional(11.5), over.frame.look.text);
    // A number wider than its bar needs the room, not the margin.
    let beyond = vec2((0.5 * (galley.size().x - (right.x - left.x))).max(0.0), 0.0);
    let (left, right) = (left + beyond, right + beyond);
    let ground = Rect::from_min_max(
        left - beyond + vec2(-8.0, -21.0),
        right + beyond + vec2(8.0, 8.0),
    );
    painter.rect_filled(
        ground,
        CornerRadius::same(5),
        over.frame.look.plate.gamma_multiply(0.7),
    );
    let stroke = Stroke::new(1.5, over.frame.look.text);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }
    let middle = left + (right - left) * 0.5 - vec2(galley.size().x * 0.5, 18.0);
    painter.galley(middle, galley, over.frame.look.text);
    ground.right()
}

/// A round length without needless digits.
fn length_text(length: f64) -> String {
    if (1e-3..1e6).contains(&length) {
        // The shortest text of 1, 2 or 5 times a power of ten, free of rounding.
        let digits = (-length.log10().floor()).max(0.0) as usize;
        format!("{length:.digits$}")
    } else {
        format!("{length:e}")
    }
}

/// What lies under the cursor, bottom right, or above the scale bar where there is no room beside it; in
/// several rows where one is too long.
fn readout(
    painter: &Painter,
    over: &Overlay<'_>,
    taken: f32,
    (legend, said): (Option<Rect>, [Option<Rect>; 2]),
) {
    let Some(hit) = over.hit else {
        return;
    };
    let pieces = pieces(over, hit);
    // A row ends between two pieces only.
    let whole = pieces
        .iter()
        .map(|piece: &String| piece.replace(' ', "\u{a0}"));
    let text = whole.collect::<Vec<_>>().join("  ");
    let window = over.frame.rect();
    // The lower left corner is that of the cube.
    let left = if cube::is_shown(over) {
        window.left() + MARGIN + cube::SIZE
    } else {
        window.left() + MARGIN
    };
    let within = |right: f32| {
        let font = FontId::monospace(11.0);
        let room = (right - left - MARGIN - 20.0).max(0.0);
        let color = over.frame.look.text;
        let lay = |text: String, max_rows: usize| {
            let mut job = egui::text::LayoutJob::simple(text, font.clone(), color, room);
            job.wrap.max_rows = max_rows;
            painter.layout_job(job)
        };
        let mut galley = lay(text.clone(), READOUT_ROWS);
        let coordinates = pieces.iter().flat_map(|piece| piece.split_inclusive(", "));
        let widths = coordinates.map(|text| {
            let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), color);
            galley.size().x
        });
        if widths.fold(0.0, f32::max) > room {
            // Better broken between any two words than within one.
            galley = lay(text.replace('\u{a0}', " "), 2 * READOUT_ROWS);
        } else if galley.elided {
            // Too narrow for a place: better broken than cut.
            galley = lay(text.replace(",\u{a0}", ", "), 2 * READOUT_ROWS);
        }
        let size = galley.size() + vec2(14.0, 8.0);
        let mut corner = Pos2::new(right, window.bottom()) - Vec2::splat(MARGIN) - size;
        if corner.x < taken + 6.0 {
            corner.y -= ABOVE_BAR + bar_lift(over);
        }
        let mut ground = Rect::from_min_size(corner, size);
        for said in said.into_iter().flatten() {
            if ground.expand(4.0).intersects(said) {
                ground = ground.translate(vec2(0.0, said.top() - 6.0 - ground.bottom()));
            }
        }
        (galley, ground)
    };
    let (mut galley, mut ground) = within(window.right());
    let is_right = |legend: &Rect| legend.left() > window.center().x;
    if let Some(legend) = legend.filter(is_right)
        && ground.expand(4.0).intersects(legend)
    {
        if legend.left() - left < LEAST_ROOM {
            // Above a legend that leaves no room beside it.
            let up = legend.top() - 6.0 - ground.bottom();
            ground = ground.translate(vec2(0.0, up));
        } else {
            (galley, ground) = within(legend.left());
        }
    }
    painter.rect_filled(ground, CornerRadius::same(5), over.frame.look.plate);
    painter.galley(ground.min + vec2(7.0, 4.0), galley, over.frame.look.text);
}

/// What is said of a place, piece by piece.
fn pieces(over: &Overlay<'_>, hit: &Hit) -> Vec<String> {
    let mut pieces: Vec<String> = value_text(over, hit).into_iter().collect();
    let parts = hit
        .part
        .map(|part| (part, over.frame.state.document.part(part.role)));
    if let Some((part, Some(of))) = parts
        && of.facts.used.len() > 1
    {
        pieces.push(format!("part {}", part.id));
    }
    pieces.extend(file_name(over.frame.state, hit));
    pieces.extend(hit.node_id.map(|id| format!("node {id}")));
    let place = hit.node_id.map_or(&hit.point, |_| &hit.node);
    let lengths = over.frame.state.lengths_of(hit.role);
    pieces.push(lengths.place((*place).into()) + lengths.suffix());
    pieces.extend(hit.element.map(|element| format!("element {element}")));
    pieces
}

/// The stamped file under the cursor, where there are several.
fn file_name(state: &AppState, hit: &Hit) -> Option<String> {
    let has_several = !state.document.mapping.further.is_empty();
    match (&hit.further, hit.role) {
        (Some(file), _) => Some(file.loaded.file_name()),
        (None, Role::Stamped) if has_several => {
            Some(state.document.part(hit.role)?.loaded.file_name())
        }
        (None, _) => None,
    }
}

/// The value of the element under the cursor, where it is known without the others; the colours blend it with those
/// around.
fn element_value(state: &AppState, kind: FieldKind, hit: &Hit) -> Option<f64> {
    let shell = hit.shell?;
    let by = match kind {
        FieldKind::Thickness => ColorBy::Thickness,
        FieldKind::Forming(value) => value.into(),
        _ => return None,
    };
    if hit.role == Role::Crash
        && let Some(run) = state.mapped_for(by)
    {
        let shown = state.shown_value(by);
        let value = run.shown(run.element_of(shell)?, &shown);
        let factor = shown.value.map_or(1.0, FormingValue::shown_factor);
        return Some(value * factor).filter(|value| value.is_finite());
    }
    if by != ColorBy::Thickness {
        return None;
    }
    let part = match &hit.further {
        Some(file) => &file.loaded,
        None => &state.document.part(hit.role)?.loaded,
    };
    let mean = part.model.mean_shell_thickness(shell)?;
    let mean = mean * part.settings.length_factor;
    Some(mean).filter(|mean| *mean > 0.0)
}

/// What the colour under the cursor says; of an element its own value, which is then said.
fn value_text(over: &Overlay<'_>, hit: &Hit) -> Option<String> {
    let own = element_value(over.frame.state, over.kind?, hit);
    let text = shown_value_text(over, hit, own.or(hit.value))?;
    Some(if own.is_some() {
        text + " (element)"
    } else {
        text
    })
}

fn shown_value_text(over: &Overlay<'_>, hit: &Hit, value: Option<f64>) -> Option<String> {
    let state = over.frame.state;
    let is_colored = |role| *state.view.display.coloring.on.get(role);
    match (over.kind?, value) {
        (FieldKind::Deviation, Some(value)) => Some(state.lengths().signed_of(value)),
        (FieldKind::Deviation, None) if is_colored(hit.role) => {
            Some(OverlapClass::OnlyHere.label().to_owned())
        }
        (FieldKind::Deviation, None) => None,
        (FieldKind::Overlap, value) => {
            let class = match value {
                Some(value) if value < 0.5 => OverlapClass::Matched,
                Some(_) => OverlapClass::OffByMore,
                None => OverlapClass::OnlyHere,
            };
            state.comparison().map(|_| class.label().to_owned())
        }
        (FieldKind::Uncertainty, Some(value)) => Some(format!("± {}", state.lengths().of(value))),
        (FieldKind::Forming(value), Some(number)) => {
            Some(forming_text(state, hit.role, value, number))
        }
        (FieldKind::Map(picture), value) => map_text(state, picture, value),
        (_, value) => value.map(|value| state.lengths_of(hit.role).of(value)),
    }
}

/// What a picture of the mapping says of an element.
fn map_text(state: &AppState, picture: MapPicture, value: Option<f64>) -> Option<String> {
    let Some(number) = value else {
        return Some("no value".to_owned());
    };
    let by = state.map_quantity();
    Some(match picture {
        MapPicture::Difference | MapPicture::Other => {
            let text = match by {
                ColorBy::Thickness => state.lengths().signed_of(number),
                _ => {
                    let unit = state.document.unit_of(Role::Crash, by.forming());
                    let unit = unit.map_or_else(String::new, |unit| format!("\u{a0}{unit}"));
                    signed(number) + &unit
                }
            };
            format!("difference {text}")
        }
        MapPicture::Distance => format!("distance {}", state.lengths().signed_of(number)),
        MapPicture::Angle => format!("angle {}°", fixed(number, 1)),
        MapPicture::Confidence => format!("confidence {}", fixed(number, 2)),
        MapPicture::File => {
            // Beyond the looks there are, a value stands for several files.
            let run = &state.document.current_mapping()?.run;
            let last = run.sources.len() - 1;
            let is_told = ColorScale::file_value(last) == last as f64;
            let number = Some(number.round() as usize).filter(|_| is_told)?;
            let file = state.document.mapped_file(number)?;
            format!("from {}", file.file_name())
        }
        MapPicture::Status => Status::ALL.get(number.round() as usize)?.label().to_owned(),
    })
}

/// A forming result with its name; stresses with the unit of the deck, if that is known.
fn forming_text(state: &AppState, role: Role, value: FormingValue, number: f64) -> String {
    let name = inside(value.label());
    if value == FormingValue::Thinning {
        return format!("{name} {}\u{a0}%", fixed(number, 1));
    }
    if !value.is_stress() {
        return format!("{name} {}", fixed(number, 4));
    }
    let unit = state
        .document
        .stress_unit(role)
        .map_or_else(String::new, |unit| format!(" {unit}"));
    format!("{name} {}{unit}", length(number))
}

/// A ring about the point a rotation turns about, and a cross at the picked pivot.
pub(super) fn pivot(ui: &Ui, over: &Overlay<'_>) {
    let painter = over.painter(ui);
    let camera = &over.frame.view.camera;
    if let Some(pivot) = over
        .frame
        .state
        .view
        .pivot
        .get(over.frame.state.view.camera_of(over.role()))
        && let Some(at) = pos_of(over.frame.rect(), camera, pivot)
    {
        for way in [vec2(6.0, 0.0), vec2(0.0, 6.0)] {
            ringed_line(&painter, over, [at - way, at + way]);
        }
    }
    let turning =
        |drag: &&super::CameraDrag| matches!(drag.kind, DragKind::Rotate | DragKind::Roll);
    if let Some(drag) = over.drag.filter(turning)
        && let Some(at) = pos_of(over.frame.rect(), camera, &drag.anchor)
    {
        ring(&painter, over, at, 7.0);
    }
}

/// A small ring at the node under the cursor.
pub(super) fn node(ui: &Ui, over: &Overlay<'_>) {
    let Some(hit) = over.hit.filter(|hit| hit.node_id.is_some()) else {
        return;
    };
    if let Some(at) = pos_of(over.frame.rect(), &over.frame.view.camera, &hit.node) {
        ring(&over.painter(ui), over, at, 3.5);
    }
}

/// The place that was looked at, ringed, with what is said about it.
pub(super) fn place(ui: &Ui, over: &Overlay<'_>) {
    let Some((role, place)) = over.frame.state.looked_at() else {
        return;
    };
    let shown = over.frame.picture.place_of(role);
    let point = shown.map(|shown| shown.to_window(&place.point));
    let at = point.and_then(|point| pos_of(over.frame.rect(), &over.frame.view.camera, &point));
    let Some(at) = at else {
        return;
    };
    let painter = over.painter(ui);
    ring(&painter, over, at, 9.0);
    let font = FontId::proportional(12.5);
    let text = painter.layout_no_wrap(place.text.clone(), font, over.frame.look.text);
    let corner = at + vec2(16.0, -16.0 - text.size().y);
    let plate = Rect::from_min_size(corner, text.size()).expand2(vec2(6.0, 3.0));
    painter.rect_filled(plate, CornerRadius::same(3), over.frame.look.plate);
    painter.galley(corner, text, over.frame.look.text);
}

/// The probed element, ringed on the crash part and where its values come from on the stamped one.
pub(super) fn probe(ui: &Ui, over: &Overlay<'_>) {
    let state = over.frame.state;
    if !state.is_mapping_shown() {
        return;
    }
    let places = state.probed_places();
    for (role, number, point) in places {
        let shown = over.frame.picture.place_of_file(role, number);
        let point = shown.map(|shown| shown.to_window(&point));
        let at = point.and_then(|point| pos_of(over.frame.rect(), &over.frame.view.camera, &point));
        if let Some(at) = at {
            ring(&over.painter(ui), over, at, 6.0);
        }
    }
}

/// A ring that is seen on any ground.
pub(super) fn ring(painter: &Painter, over: &Overlay<'_>, at: Pos2, radius: f32) {
    painter.circle_stroke(at, radius, Stroke::new(3.0, over.frame.look.plate));
    painter.circle_stroke(at, radius, Stroke::new(1.5, over.frame.look.tool));
}

/// A line that is seen on any ground.
pub(super) fn ringed_line(painter: &Painter, over: &Overlay<'_>, ends: [Pos2; 2]) {
    painter.line_segment(ends, Stroke::new(4.0, over.frame.look.plate));
    painter.line_segment(ends, Stroke::new(1.5, over.frame.look.tool));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_written_without_needless_digits() {
        let texts = [200.0, 5.0, 0.5, 0.02, 1e-5].map(length_text);
        assert_eq!(texts, ["200", "5", "0.5", "0.02", "1e-5"]);
    }
}
