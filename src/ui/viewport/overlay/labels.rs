//! Values pinned to nodes: a plate beside each node, joined to it by a line.

use std::collections::BTreeMap;

use egui::{
    Color32, CornerRadius, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};

use super::{MARGIN, Overlay, legend};
use crate::app::{BottomTab, Command, InspectCommand, Label, ViewCommand};
use crate::role::Role;
use crate::ui::focus::is_ringed;
use crate::ui::theme::color;
use crate::ui::viewport::navigation::{pixel_of, pos_of, screen_of};

/// Distances of a plate from its node, tried in turn.
const REACHES: [f32; 10] = [
    34.0, 58.0, 90.0, 130.0, 180.0, 230.0, 290.0, 360.0, 440.0, 530.0,
];
/// So many of them are near enough for a plate that has to lie over the part.
const N_NEAR: usize = 4;
/// A plate is beside the part if none of so many points across and up lies on it.
const PROBES: [usize; 2] = [5, 3];
/// Directions tried at each distance, upwards first.
const DIRECTIONS: [Vec2; 8] = [
    vec2(0.8, -0.8),
    vec2(-0.8, -0.8),
    vec2(1.0, 0.0),
    vec2(-1.0, 0.0),
    vec2(0.0, -1.0),
    vec2(0.8, 0.8),
    vec2(-0.8, 0.8),
    vec2(0.0, 1.0),
];
/// How far in front of a node a surface must be to hide it, as a share of the picture's box.
const HIDING: f64 = 0.004;

/// A label with its place on the screen.
struct Placed<'a> {
    role: Role,
    label: &'a Label,
    anchor: Pos2,
    is_hidden: bool,
}

/// Draws the labels of the parts in this window. Plates keep clear of each other and of what else
/// lies over the picture, and lie beside the parts where there is room; each stays where it was as long
/// as it can. Returns what other plates must not cover.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) -> Vec<Rect> {
    let labels: Vec<Placed<'_>> = placed(over);
    let mut taken = taken(ui, over);
    if labels.is_empty() {
        return taken;
    }
    let memory = ui.make_persistent_id(("label places", over.role().word()));
    let last: BTreeMap<u64, usize> = ui.data(|data| data.get_temp(memory)).unwrap_or_default();
    let mut now = BTreeMap::new();
    taken.extend(
        labels
            .iter()
            .map(|l| Rect::from_center_size(l.anchor, Vec2::splat(8.0))),
    );
    for placed in &labels {
        let texts = texts(over, placed);
        let size = plate_size(ui, over, &texts);
        let before = last.get(&placed.label.id).copied();
        let is_beside = |plate: &Rect| is_beside_parts(over, plate);
        let room = (over.frame.rect(), &taken[..]);
        let (choice, plate) = place(room, placed.anchor, size, before, is_beside);
        now.insert(placed.label.id, choice);
        taken.push(plate);
        one(ui, over, (placed, &texts, plate), commands);
    }
    ui.data_mut(|data| data.insert_temp(memory, now));
    taken
}

fn placed<'a>(over: &Overlay<'a>) -> Vec<Placed<'a>> {
    let camera = &over.frame.view.camera;
    let depth = |p: &crate::geometry::Point3| p.coords.dot(&camera.forward());
    let slack = HIDING * over.frame.picture.bounds.diagonal();
    let labels = over.frame.state.document.shown_labels();
    let placed = labels.filter_map(|(role, label)| {
        let at = over.frame.picture.world_of(role, &label.position)?;
        let anchor = pos_of(over.frame.rect(), camera, &at)?;
        if !over.frame.rect().contains(anchor) {
            return None;
        }
        let pixel = pixel_of(over.frame.rect(), anchor);
        let hit = over
            .frame
            .picture
            .hit(camera, pixel, screen_of(over.frame.rect()));
        let is_hidden = hit.is_some_and(|hit| depth(&hit.point) < depth(&at) - slack);
        Some(Placed {
            role,
            label,
            anchor,
            is_hidden,
        })
    });
    placed.collect()
}

/// What plates must not cover: names, buttons, legend, axes.
fn taken(ui: &Ui, over: &Overlay<'_>) -> Vec<Rect> {
    let rect = over.frame.rect();
    let mut taken = vec![
        Rect::from_min_size(rect.min, vec2(190.0, 56.0)),
        Rect::from_min_max(
            pos2(rect.right() - 230.0, rect.top()),
            pos2(rect.right(), rect.top() + 40.0),
        ),
        Rect::from_min_max(
            pos2(rect.left(), rect.bottom() - 90.0),
            pos2(rect.left() + 96.0, rect.bottom()),
        ),
    ];
    taken.extend(legend::last_place(ui, over));
    taken
}

/// Value, and below it the name or the node.
fn texts(over: &Overlay<'_>, placed: &Placed<'_>) -> [String; 2] {
    let label = placed.label;
    let value = over.frame.state.label_text(label);
    let node = label.node.map(|node| format!("node {node}"));
    let below = match (label.name.as_str(), node) {
        ("", Some(node)) => node,
        ("", None) => format!("vertex {}", label.vertex),
        (name, _) => name.to_owned(),
    };
    [value, below]
}

fn fonts() -> [FontId; 2] {
    [FontId::proportional(12.5), FontId::proportional(10.5)]
}

fn plate_size(ui: &Ui, over: &Overlay<'_>, texts: &[String; 2]) -> Vec2 {
    let [value, below] = fonts();
    let painter = ui.painter();
    let color = over.frame.look.text;
    let first = painter
        .layout_no_wrap(texts[0].clone(), value, color)
        .size();
    let second = painter
        .layout_no_wrap(texts[1].clone(), below, color)
        .size();
    vec2(first.x.max(second.x) + 16.0, first.y + second.y + 7.0)
}

/// True if nothing is drawn where the plate would be.
fn is_beside_parts(over: &Overlay<'_>, plate: &Rect) -> bool {
    let camera = &over.frame.view.camera;
    let screen = screen_of(over.frame.rect());
    let [n_across, n_up] = PROBES.map(|n| (n - 1) as f32);
    let plate = plate.expand(4.0);
    let places = (0..PROBES[0]).flat_map(|i| (0..PROBES[1]).map(move |j| (i as f32, j as f32)));
    places.into_iter().all(|(i, j)| {
        let at = plate.min + plate.size() * vec2(i / n_across, j / n_up);
        let pixel = pixel_of(over.frame.rect(), at);
        over.frame.picture.hit(camera, pixel, screen).is_none()
    })
}

/// The nearest free place of a plate beside the parts, its last one before all others. Where the parts
/// fill the window, the first free one over them; the last resort covers.
fn place(
    (window, taken): (Rect, &[Rect]),
    anchor: Pos2,
    size: Vec2,
    before: Option<usize>,
    is_beside: impl Fn(&Rect) -> bool,
) -> (usize, Rect) {
    let room = window.shrink(MARGIN / 2.0);
    let n = REACHES.len() * DIRECTIONS.len();
    let at = |choice: usize| {
        let reach = REACHES[choice / DIRECTIONS.len()];
        let direction = DIRECTIONS[choice % DIRECTIONS.len()];
        // The near edge of the plate is where the line ends.
        let center = anchor + direction * reach + direction * size / 2.0;
        Rect::from_center_size(center, size)
    };
    let is_free = |plate: &Rect| {
        room.contains_rect(*plate) && !taken.iter().any(|t| t.intersects(plate.expand(3.0)))
    };
    let choices = |n: usize| {
        let choices = before.into_iter().chain(0..n);
        choices
            .filter(move |choice| *choice < n)
            .map(|choice| (choice, at(choice)))
    };
    let beside = choices(n).find(|(_, plate)| is_free(plate) && is_beside(plate));
    let near = || choices(N_NEAR * DIRECTIONS.len()).find(|(_, plate)| is_free(plate));
    beside.or_else(near).unwrap_or_else(|| (0, at(0)))
}

/// Line, ring at the node, plate, texts; a click opens the list, the cross takes the label away.
fn one(
    ui: &Ui,
    over: &Overlay<'_>,
    (placed, texts, plate): (&Placed<'_>, &[String; 2], Rect),
    commands: &mut Vec<Command>,
) {
    let id = ui.make_persistent_id(("label", placed.label.id, over.role().word()));
    let response = ui.interact(plate, id, Sense::click());
    response.widget_info(|| {
        let name = format!("Label {}: {}", texts[1], texts[0]);
        WidgetInfo::labeled(egui::Role::Button, true, name)
    });
    let is_hovered = response.hovered() || is_ringed(&response);
    let strength = if placed.is_hidden && !is_hovered {
        0.45
    } else {
        1.0
    };
    let fade = |color: Color32| color.gamma_multiply(strength);
    let painter = over.painter(ui);
    let end = plate.clamp(placed.anchor);
    let line = Stroke::new(1.2, fade(over.frame.look.text));
    let halo = Stroke::new(3.0, fade(over.frame.look.plate));
    painter.line_segment([placed.anchor, end], halo);
    if placed.is_hidden {
        painter.extend(Shape::dashed_line(&[placed.anchor, end], line, 4.0, 3.0));
    } else {
        painter.line_segment([placed.anchor, end], line);
    }
    let fill = fade(color_of(over, placed));
    painter.circle(
        placed.anchor,
        4.0,
        fill,
        Stroke::new(1.5, fade(over.frame.look.text)),
    );
    let solid = over.frame.look.plate.to_opaque();
    let ground = if is_hovered { solid } else { fade(solid) };
    let edge = fade(over.frame.look.role(placed.role));
    painter.rect(
        plate,
        CornerRadius::same(5),
        ground,
        Stroke::new(if is_hovered { 1.8 } else { 1.2 }, edge),
        egui::StrokeKind::Inside,
    );
    let [value, below] = fonts();
    let at = plate.min + vec2(8.0, 3.0);
    let drawn = painter.text(
        at,
        egui::Align2::LEFT_TOP,
        &texts[0],
        value,
        fade(over.frame.look.text),
    );
    painter.text(
        pos2(at.x, drawn.bottom()),
        egui::Align2::LEFT_TOP,
        &texts[1],
        below,
        fade(over.frame.look.weak),
    );
    if is_hovered {
        let cross = Rect::from_center_size(plate.right_top(), Vec2::splat(15.0));
        remove(ui, over, (placed, cross), commands);
    }
    if response.clicked() {
        commands.push(ViewCommand::SetTab(BottomTab::Deviation).into());
    }
}

/// The round button with a cross on the corner of a plate.
fn remove(
    ui: &Ui,
    over: &Overlay<'_>,
    (placed, cross): (&Placed<'_>, Rect),
    commands: &mut Vec<Command>,
) {
    let id = ui.make_persistent_id(("remove label", placed.label.id, over.role().word()));
    let response = ui.interact(cross, id, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Remove label"));
    let painter = over.painter(ui);
    let ground = over.frame.look.plate.to_opaque();
    painter.circle(
        cross.center(),
        7.0,
        ground,
        Stroke::new(1.0, over.frame.look.weak),
    );
    let color = if response.hovered() {
        over.frame.look.text
    } else {
        over.frame.look.weak
    };
    for way in [vec2(3.0, 3.0), vec2(3.0, -3.0)] {
        let ends = [cross.center() - way, cross.center() + way];
        painter.line_segment(ends, Stroke::new(1.5, color));
    }
    if response.clicked() {
        commands.push(InspectCommand::Remove(placed.label.id).into());
    }
}

/// The colour of the value on the scale, or that of the part.
fn color_of(over: &Overlay<'_>, placed: &Placed<'_>) -> Color32 {
    let value = over.frame.state.label_value(placed.label);
    match (value, &over.scale) {
        (Some(value), Some((kind, scale))) if kind.is_signed() => color(scale.color(value)),
        _ => over.frame.look.role(placed.role),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plates_keep_clear_of_each_other_and_stay_where_they_were() {
        let window = Rect::from_min_size(Pos2::ZERO, vec2(600.0, 400.0));
        let size = vec2(70.0, 30.0);
        let mut taken = Vec::new();
        let mut choices = Vec::new();
        for i in 0..6 {
            let anchor = pos2(300.0 + 3.0 * i as f32, 200.0);
            let (choice, plate) = place((window, &taken), anchor, size, None, |_| true);
            assert!(taken.iter().all(|t: &Rect| !t.intersects(plate)), "{i}");
            assert!(window.contains_rect(plate));
            taken.push(plate);
            choices.push(choice);
        }
        let (choice, _) = place(
            (window, &[]),
            pos2(310.0, 210.0),
            size,
            Some(choices[3]),
            |_| true,
        );
        assert_eq!(choice, choices[3]);
    }

    #[test]
    fn plates_lie_beside_the_part_where_there_is_room() {
        let size = vec2(70.0, 30.0);
        let middle = pos2(400.0, 300.0);
        let part = Rect::from_center_size(middle, vec2(300.0, 240.0));
        let is_beside = |plate: &Rect| !plate.intersects(part);
        let wide = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        let mut taken = Vec::new();
        for anchor in [middle, part.left_top(), part.right_center(), middle] {
            let (_, plate) = place((wide, &taken), anchor, size, None, is_beside);
            assert!(is_beside(&plate) && wide.contains_rect(plate), "{plate:?}");
            taken.push(plate);
        }
        // A part that fills the window: near its node, over the part.
        let (_, plate) = place((part, &[]), middle, size, None, is_beside);
        assert!(part.contains_rect(plate));
        assert!(plate.distance_to_pos(middle) < 60.0, "{plate:?}");
    }
}
