//! Name of the window, what it shows, and the buttons of its camera.

use std::sync::Arc;

use egui::{
    Align, Button, Color32, CornerRadius, FontId, Galley, Layout, Painter, Pos2, Rect, RichText,
    Sense, Shape, Stroke, Ui, UiBuilder, Vec2, vec2,
};

use super::{MARGIN, Overlay, grouped, legend};
use crate::app::{AppState, Command, PoseOverlap, Preview, ViewCommand, short_number};
use crate::geometry::camera::StandardView;
use crate::report::start_kind_words;
use crate::role::Role;
use crate::text::{Lengths, counted, tidy_factor, whole_percent};
use crate::ui::focus::is_ringed;
use crate::ui::row_end::RowEnd;
use crate::ui::viewport::visible_parts::visible_parts;

/// Width and height of the row of camera buttons, and the least width of the names beside it.
const BUTTONS: Vec2 = vec2(212.0, 24.0);
const LEAST_NAMES: f32 = 150.0;
/// Height of a part's name with its facts, and in one line.
const BLOCK: f32 = 40.0;
const LINE: f32 = 22.0;
/// Windows smaller than this name each part in one line.
const NARROW: f32 = 400.0;
const LOW: f32 = 300.0;
/// Least width of the facts about a part.
const LEAST_FACTS: f32 = 90.0;
/// Height of a note.
const NOTE: f32 = 17.0;

/// Height of the names of the parts with the notes that last; `None` in a window with a header of its own.
pub(super) fn height(over: &Overlay<'_>) -> Option<f32> {
    (!is_free(over)).then(|| names_height(over) + NOTE * lasting_notes(over).len() as f32)
}

fn names_height(over: &Overlay<'_>) -> f32 {
    block_height(over) * roles(over).len() as f32 + 3.0
}

/// Role mark, name and facts of each part in the window, then what is shown instead of the real pose.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    let painter = over.painter(ui);
    frame(over, &painter, over.frame.look.role(over.role()));
    if is_free(over) {
        return;
    }
    let window = over.frame.rect();
    let beside = if has_buttons(over) {
        BUTTONS.x + 8.0
    } else {
        0.0
    };
    let beside = beside.max(legend::beside_names(over));
    let whole = window.width() - 2.0 * MARGIN - 36.0;
    let room = whole - beside;
    let small =
        |text: String, room: f32| fitted(&painter, text, 11.5, (over.frame.look.weak, room));
    let blocks: Vec<_> = roles(over)
        .iter()
        .map(|&role| {
            let title = title(&painter, over, role, whole);
            let used = if is_small(over) {
                title_width(&title) + 9.0
            } else {
                0.0
            };
            // The beginning of a number says nothing.
            let facts = match room - used {
                left if left < LEAST_FACTS => String::new(),
                _ => facts(over, role),
            };
            (role, title, small(facts, room - used))
        })
        .collect();
    let notes = passing_notes(over).into_iter().chain(lasting_notes(over));
    let notes: Vec<_> = notes.map(|text| small(text, room)).collect();
    let widths = blocks.iter().map(|(_, title, facts)| {
        let [title, facts] = [title_width(title), facts.size().x];
        if is_small(over) {
            title + 9.0 + facts
        } else {
            title.max(facts)
        }
    });
    let widest = widths
        .chain(notes.iter().map(|note| note.size().x))
        .fold(0.0, f32::max);
    let height = names_height(over) + NOTE * notes.len() as f32;
    let top = window.min + Vec2::splat(MARGIN);
    let plate = Rect::from_min_size(top, vec2(widest + 36.0, height));
    painter.rect_filled(plate, CornerRadius::same(6), over.frame.look.plate);
    let mut at = top + vec2(25.0, if is_small(over) { 3.0 } else { 5.0 });
    for (role, title, facts) in blocks {
        let mark_at = at + vec2(-12.0, 8.0);
        mark(&painter, role, mark_at, 5.0, over.frame.look.role(role));
        let after = at + vec2(title_width(&title) + 9.0, 1.5);
        let [name, what] = title;
        let second = at + vec2(name.size().x + 7.0, 0.0);
        painter.galley(at, name, over.frame.look.text);
        painter.galley(second, what, over.frame.look.weak);
        let below = if is_small(over) {
            after
        } else {
            at + vec2(0.0, 18.0)
        };
        painter.galley(below, facts, over.frame.look.weak);
        at.y += block_height(over);
    }
    for note in notes {
        painter.galley(at - vec2(0.0, 2.0), note, over.frame.look.text);
        at.y += NOTE;
    }
}

/// True in a window without room for two lines about each part.
fn is_small(over: &Overlay<'_>) -> bool {
    over.frame.rect().width() < NARROW || over.frame.rect().height() < LOW
}

fn block_height(over: &Overlay<'_>) -> f32 {
    if is_small(over) { LINE } else { BLOCK }
}

/// The parts that are named.
fn roles(over: &Overlay<'_>) -> &'static [Role] {
    let state = over.frame.state;
    match over.role() {
        Role::Crash if state.is_mapped_blinking() => &[Role::Stamped],
        Role::Crash if state.mapped_wipe().is_some() => &Role::ALL,
        Role::Crash if state.view.is_moved_over && !state.is_mapping_apart() => &Role::ALL,
        Role::Crash => &[Role::Crash],
        Role::Stamped => &[Role::Stamped],
    }
}

fn title_width(title: &[Arc<Galley>; 2]) -> f32 {
    title[0].size().x + 7.0 + title[1].size().x
}

/// One line of text, cut with an ellipsis where there is no room for it.
pub(super) fn fitted(
    painter: &Painter,
    text: String,
    size: f32,
    (color, room): (Color32, f32),
) -> Arc<Galley> {
    let font = FontId::proportional(size);
    let mut job = egui::text::LayoutJob::simple_singleline(text, font, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(0.0));
    painter.layout_job(job)
}

/// True in the right window once its part has left it: it has the left one's camera, and a header of
/// its own.
fn is_free(over: &Overlay<'_>) -> bool {
    let is_gone = over.role() == Role::Stamped && over.frame.view.over >= 1.0;
    is_gone && over.frame.state.view.is_moved_over
}

/// Name of a part and, where there is room, what becomes of it.
fn title(painter: &Painter, over: &Overlay<'_>, role: Role, room: f32) -> [Arc<Galley>; 2] {
    let state = over.frame.state;
    let (name, what) = match role {
        Role::Crash if state.is_old_mapping_shown(role) => ("CRASH", "mapped, out of date"),
        Role::Crash if state.is_mapping_shown() => ("CRASH", "mapped"),
        Role::Crash => ("CRASH", "fixed"),
        Role::Stamped if state.shown_pose().is_mirrored() => ("STAMPED", "moves, mirrored"),
        Role::Stamped => ("STAMPED", "moves"),
    };
    let galley = |text: &str, color| {
        painter.layout_no_wrap(text.to_owned(), FontId::proportional(13.5), color)
    };
    let title = |what| {
        [
            galley(name, over.frame.look.text),
            galley(what, over.frame.look.weak),
        ]
    };
    let whole = title(what);
    if title_width(&whole) > room {
        return title("");
    }
    whole
}

/// A line in the role's colour marks the window that keys act on, a frame the keyboard's focus.
fn frame(over: &Overlay<'_>, painter: &Painter, color: Color32) {
    let is_target = over.frame.state.view.focus == over.role();
    let strength = if is_target { 1.0 } else { 0.28 };
    let line = Rect::from_min_size(over.frame.rect().min, vec2(over.frame.rect().width(), 2.0));
    painter.rect_filled(line, 0.0, color.gamma_multiply(strength));
    if is_ringed(over.frame.response) {
        let inner = over.frame.rect().shrink(1.0);
        let stroke = Stroke::new(1.0, color.gamma_multiply(0.7));
        painter.rect_stroke(inner, 0.0, stroke, egui::StrokeKind::Inside);
    }
}

/// A square for crash, a triangle for stamped: shape and colour say the same.
fn mark(painter: &Painter, role: Role, center: Pos2, radius: f32, color: Color32) {
    match role {
        Role::Crash => {
            let square = Rect::from_center_size(center, Vec2::splat(2.0 * radius));
            painter.rect_filled(square, 1.0, color);
        }
        Role::Stamped => {
            let r = radius * 1.15;
            let corners = [vec2(0.0, -r), vec2(r, 0.8 * r), vec2(-r, 0.8 * r)];
            let corners = corners.map(|corner| center + corner).to_vec();
            painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
        }
    }
}

/// How much of a part is shown.
fn facts(over: &Overlay<'_>, role: Role) -> String {
    let state = over.frame.state;
    let Some(part) = state.document.part(role) else {
        return "nothing loaded".to_owned();
    };
    let full = counted(part.loaded.mesh.n_triangles(), "triangle");
    // Values by element are drawn on the full mesh, whichever is chosen.
    let drawn = visible_parts(state, over.frame.view);
    let mut drawn = drawn.iter().filter(|instance| instance.role == role);
    let is_reduced = drawn.any(|instance| instance.further.is_none() && !instance.is_detailed);
    let triangles = match part.level.as_ref().filter(|_| is_reduced) {
        Some(level) => {
            let reduced = grouped(level.level.mesh.n_triangles());
            format!("{reduced} of {full}")
        }
        None => full,
    };
    let mut facts = triangles;
    let n_parts = part.facts.used.len();
    if n_parts > 1 {
        facts += &format!(" · {}", counted(n_parts, "part"));
    } else if let Some(id) = part
        .facts
        .used
        .first()
        .filter(|_| part.loaded.report.n_parts > 1)
    {
        facts += &format!(" · part {id}");
    }
    let n_files = 1 + state.document.mapping.further.len();
    if role == Role::Stamped && n_files > 1 {
        facts += &format!(" · first of {}", counted(n_files, "file"));
    }
    match state.units_of(role) {
        Some(known) => facts += &format!(" · {}", known.units.length.symbol()),
        None => facts += " · unit unknown",
    }
    if part.length_factor() != 1.0 {
        facts += &format!(" × {}", tidy_factor(part.length_factor()));
    }
    facts
}

/// What is shown for as long as something is done: the tool, a preview.
fn passing_notes(over: &Overlay<'_>) -> Vec<String> {
    let state = over.frame.state;
    let is_left = over.role() == Role::Crash;
    let mut notes: Vec<String> = over.hint.clone().into_iter().collect();
    if is_left == state.view.is_moved_over
        && let Some(tool) = &state.moving.tool
    {
        notes.push(tool.modal.header(&tool.frame));
    }
    notes.extend(state.distance_prompt().map(str::to_owned));
    if is_left {
        notes.extend(preview(over));
    }
    notes
}

/// What the user should know about the picture as long as it is shown; in a small window in one line.
fn lasting_notes(over: &Overlay<'_>) -> Vec<String> {
    let state = over.frame.state;
    let is_left = over.role() == Role::Crash;
    let mut notes: Vec<String> = Vec::new();
    if is_left {
        notes.extend(overlap(state));
    }
    notes.extend(stripes(over));
    let separation = state.view.display.separation;
    if is_left && state.view.is_moved_over && separation != 0.0 {
        notes.push(format!(
            "shown {}{} apart",
            short_number(separation),
            state.document.unit_suffix()
        ));
    }
    if is_small(over) && notes.len() > 1 {
        notes = vec![notes.join(" · ")];
    }
    notes
}

/// What the stripes in the picture say, where both sheets are drawn and are not known to lie apart.
fn stripes(over: &Overlay<'_>) -> Option<String> {
    let scene = &over.frame.picture.scene;
    scene.coinciding()?;
    let known = over.frame.state.current_overlap();
    let distance = scene
        .coincidence
        .filter(|_| known.is_none_or(|known| known.overlap > 0.0))?;
    let unit = over.frame.state.document.unit_suffix();
    Some(format!(
        "striped: both within {}{unit}",
        short_number(distance)
    ))
}

/// How warm the pose is, with the change since the last one. Not where the verdict states the overlap: this one is
/// of few points; nor for parts that lie apart as they were loaded, once a match or a move is undone.
fn overlap(state: &AppState) -> Option<String> {
    let is_measured = state.document.current_result().is_some();
    let known = state
        .current_overlap()
        .filter(|_| !is_measured && !state.is_preview())?;
    (known.overlap > 0.0 || state.document.has_pose())
        .then(|| overlap_words(known, state.lengths()))
}

/// `95 % of crash within 4.50 mm (−5 points)`: short enough for a narrow window.
fn overlap_words(known: &PoseOverlap, lengths: Lengths) -> String {
    let mut text = format!(
        "{} of {} within {}",
        whole_percent(known.overlap),
        known.of.word(),
        lengths.of(known.limit)
    );
    // Less than half a percent is no change to speak of.
    if let Some(change) = known.change.filter(|change| change.abs() >= 0.005) {
        // Without an arrow: a triangle stands for the stamped part.
        let sign = if change > 0.0 { "+" } else { "−" };
        let points = counted((100.0 * change.abs()).round() as usize, "point");
        text += &format!(" ({sign}{points})");
    }
    text
}

/// What is shown instead of the real pose.
fn preview(over: &Overlay<'_>) -> Option<String> {
    let state = over.frame.state;
    if state.previews.live.is_some() {
        let running = state.jobs.running().and_then(|job| job.latest.as_ref());
        let text = running.map(|latest| format!("matching · iteration {}", latest.number + 1));
        return Some(text.unwrap_or_else(|| "matching".to_owned()));
    }
    if let Some(start) = state.shown_start() {
        let starts = state.current_starts()?;
        let index = state.previews.start? + 1;
        let kind = start_kind_words(start.kind);
        return Some(format!("start {index} of {} · {kind}", starts.len()));
    }
    preview_text(state)
}

/// Which start and iteration is shown.
fn preview_text(state: &AppState) -> Option<String> {
    let preview = state.preview()?;
    let number = preview.start() + 1;
    Some(match preview {
        Preview::Start(_) => format!("preview: where start {number} ended"),
        Preview::Step { start, iteration } => {
            let n_steps = state.match_start(start)?.iterations.len();
            format!(
                "preview: start {number}, iteration {} of {n_steps}",
                iteration + 1
            )
        }
    })
}

/// True where there is room for the buttons of the camera beside the names.
fn has_buttons(over: &Overlay<'_>) -> bool {
    over.frame.rect().width() >= LEAST_NAMES + 8.0 + BUTTONS.x + 2.0 * MARGIN
}

/// Wheel and drags do not reach through to the part from here: buttons alone take clicks only. Tab passes it by.
pub(super) fn shield(ui: &Ui, area: Rect) {
    let id = ui.scope_id().with(("shield", area.min.x as i32));
    ui.interact(area, id, Sense::CLICK | Sense::DRAG);
}

/// Buttons of the camera, top right.
pub(super) fn buttons(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    if is_free(over) || !has_buttons(over) {
        return;
    }
    let role = over.role();
    let standard = |view| ViewCommand::Standard(role, view);
    let entries = [
        ("Fit", "Fit everything visible", ViewCommand::FitAll(role)),
        ("Iso", "Isometric view", standard(StandardView::Isometric)),
        ("X", "Look along X", standard(StandardView::Right)),
        ("Y", "Look along Y", standard(StandardView::Front)),
        ("Z", "Look along Z", standard(StandardView::Top)),
        (
            "Link",
            "Turn and zoom both windows together",
            ViewCommand::ToggleLink,
        ),
    ];
    let corner = Pos2::new(
        over.frame.rect().right() - MARGIN - BUTTONS.x,
        over.frame.rect().top() + MARGIN,
    );
    let area = Rect::from_min_size(corner, BUTTONS);
    let plate = ui.painter().add(Shape::Noop);
    shield(ui, area);
    let builder = UiBuilder::new()
        .max_rect(area.shrink(2.0))
        .layout(Layout::left_to_right(Align::Center));
    let buttons_ui = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding = vec2(7.0, 2.0);
        for (label, tooltip, command) in entries {
            let is_on = label == "Link" && over.frame.state.view.are_linked;
            let text = RichText::new(label).size(11.5);
            let text = if is_on {
                text.color(over.frame.look.text).strong()
            } else {
                text.color(over.frame.look.weak)
            };
            let button = Button::new(text)
                .frame_when_inactive(is_on)
                .selected(is_on)
                .sense(Sense::click());
            let name = format!("{tooltip} ({})", role.word());
            let response = ui.add(button).on_hover_text(tooltip).accessible_name(name);
            if response.clicked() {
                commands.push(command.into());
            }
        }
        ui.min_rect()
    };
    let row = ui.scope_builder(builder, |ui| RowEnd::new(ui, "camera").show(ui, buttons_ui));
    let used = row.inner.expand(2.0);
    let ground = Shape::rect_filled(used, CornerRadius::same(6), over.frame.look.plate);
    ui.painter().set(plate, ground);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::Stamp;
    use crate::units::LengthUnit;

    #[test]
    fn the_overlap_is_said_in_a_few_words() {
        let mut known = PoseOverlap {
            stamp: Stamp::default(),
            of: Role::Crash,
            overlap: 0.95,
            limit: 4.5,
            change: Some(-0.05),
        };
        let lengths = Lengths::new(Some(LengthUnit::Millimeter));
        let words = overlap_words(&known, lengths);
        assert_eq!(words, "95 % of crash within 4.50 mm (−5 points)");
        known.change = Some(0.001);
        let words = overlap_words(&known, lengths);
        assert_eq!(words, "95 % of crash within 4.50 mm");
    }
}
