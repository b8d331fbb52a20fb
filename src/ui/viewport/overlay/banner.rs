//! A line at the foot of the left window when what is shown is not simply the part at its pose: a preview
//! that was pinned, or one of several poses that fit.

use egui::{Button, CornerRadius, FontId, Rect, RichText, Stroke, Ui, Vec2, vec2};

use super::{MARGIN, Overlay, cube};
use crate::app::{Action, AppState, Command, PreviewCommand};
use crate::assess::fit_beside;
use crate::role::Role;
use crate::ui::pictures::clickable;

/// Above the scale bar and the readout.
pub(super) const BOTTOM: f32 = 62.0;
const HEIGHT: f32 = 32.0;
/// Air between it and the edges of the window.
const EDGE: f32 = 4.0;

/// What the banner says and the button on it.
struct Banner {
    text: String,
    /// What it says where it has no room for all.
    short: String,
    label: String,
    commands: Vec<Command>,
}

/// The banner, if there is something to say and room for it; returns where it lies.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) -> Option<Rect> {
    if over.role() != Role::Crash {
        return None;
    }
    let banner = preview(over.frame.state).or_else(|| poses(over.frame.state))?;
    let font = FontId::proportional(12.5);
    let painter = over.painter(ui);
    let lay = |text: String| painter.layout_no_wrap(text, font.clone(), over.frame.look.text);
    let label = lay(banner.label.clone());
    let button_width = label.size().x + 20.0;
    let mut texts = [banner.text, banner.short].into_iter().map(lay);
    let (text, ground) = texts.find_map(|text| {
        let size = vec2(text.size().x + button_width + 34.0, HEIGHT);
        Some((text, place(over, size)?))
    })?;
    painter.rect_filled(ground, CornerRadius::same(6), over.frame.look.plate);
    let edge = Stroke::new(1.0, over.frame.look.role(Role::Stamped));
    painter.rect_stroke(
        ground,
        CornerRadius::same(6),
        edge,
        egui::StrokeKind::Inside,
    );
    let text_at = ground.left_center() + vec2(12.0, -text.size().y / 2.0);
    let name = text.text().to_owned();
    let response = ui.interact(
        Rect::from_min_size(text_at, text.size()),
        ui.scope_id().with("banner"),
        egui::Sense::hover(),
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    painter.galley(text_at, text, over.frame.look.text);
    let size = vec2(button_width, HEIGHT - 8.0);
    let corner = ground.right_center() + vec2(-size.x - 5.0, -size.y / 2.0);
    let area = Rect::from_min_size(corner, size);
    let button = Button::new(RichText::new(banner.label).size(12.5));
    if clickable(ui, |ui| ui.put(area, button)).clicked() {
        commands.extend(banner.commands);
    }
    Some(ground)
}

/// Where a banner of a size lies: in the middle, further right beside the cube, or above it; `None` where it has no
/// room.
fn place(over: &Overlay<'_>, size: Vec2) -> Option<Rect> {
    let window = over.frame.rect().shrink2(vec2(EDGE, 0.0));
    if size.x > window.width() {
        return None;
    }
    let middle = window.center_bottom() - vec2(0.0, BOTTOM + HEIGHT / 2.0);
    let ground = Rect::from_center_size(middle, size);
    let cube = Rect::from_min_max(window.left_bottom(), window.left_bottom())
        .translate(vec2(MARGIN, -MARGIN));
    let cube = cube.union(cube.translate(vec2(cube::SIZE, -cube::SIZE)));
    if !cube::is_shown(over) || ground.left() >= cube.right() + EDGE {
        return Some(ground);
    }
    let beside = ground.translate(vec2(cube.right() + EDGE - ground.left(), 0.0));
    if beside.right() <= window.right() {
        return Some(beside);
    }
    Some(ground.translate(vec2(0.0, cube.top() - EDGE - ground.bottom())))
}

/// A pose that is shown until it is let go.
fn preview(state: &AppState) -> Option<Banner> {
    let pinned = state.previews.pinned?;
    Some(Banner {
        text: format!("Preview of start {}: nothing was moved", pinned.start() + 1),
        short: format!("Preview of start {}", pinned.start() + 1),
        label: "Show the real pose".to_owned(),
        commands: vec![PreviewCommand::Pin(None).into()],
    })
}

/// One of several poses that fit nearly as well.
fn poses(state: &AppState) -> Option<Banner> {
    let result = state.document.current_result()?;
    let n_poses = state.n_equal_poses();
    if n_poses < 2 || state.is_preview() {
        return None;
    }
    let number = result.alternative.map_or(1, |index| index + 2);
    let short = format!("Pose {number} of {n_poses}");
    let mut text = short.clone();
    // As card, record and report tell the poses apart.
    let shown = result.alternative;
    match shown.and_then(|index| result.run.outcome.alternatives.get(index)) {
        Some(other) => {
            text += &format!(" · {}", fit_beside(other.score_ratio, other.by_shape));
        }
        None => text += " · the best",
    }
    let key = Action::NextAlternative.row().shortcut();
    let key = key.map_or_else(String::new, |key| format!("   {key}"));
    Some(Banner {
        text,
        short,
        label: format!("Flip{key}"),
        commands: Action::NextAlternative.command(state).into_iter().collect(),
    })
}
