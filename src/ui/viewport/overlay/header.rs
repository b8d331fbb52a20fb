//! Name of the window, what it shows, and the buttons of its camera.

use egui::{
    Align, Button, Color32, CornerRadius, FontId, Layout, Pos2, Rect, RichText, Sense, Stroke, Ui,
    UiBuilder, Vec2, vec2,
};

use super::{MARGIN, Overlay, grouped};
use crate::app::{Command, ShownGeometry, ViewCommand};
use crate::geometry::camera::StandardView;
use crate::jobs::Role;
use crate::registration::StartKind;

/// Role mark, name, count of triangles.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    let painter = over.painter(ui);
    let color = over.look.role(over.role());
    let (name, what) = match over.role() {
        Role::Crash => ("CRASH", "fixed"),
        Role::Stamped => ("STAMPED", "moves"),
    };
    let title = painter.layout_no_wrap(name.to_owned(), FontId::proportional(13.5), over.look.text);
    let role = painter.layout_no_wrap(what.to_owned(), FontId::proportional(13.5), over.look.weak);
    let lines: Vec<_> = facts(over)
        .into_iter()
        .map(|line| painter.layout_no_wrap(line, FontId::proportional(11.5), over.look.weak))
        .collect();
    let top = over.rect.min + Vec2::splat(MARGIN);
    let text_left = top.x + 25.0;
    let first_width = title.size().x + 7.0 + role.size().x;
    let widest = lines.iter().map(|l| l.size().x).fold(first_width, f32::max);
    let n_lines = lines.len() as f32;
    let plate = Rect::from_min_size(top, vec2(widest + 35.0, 25.0 + 16.0 * n_lines));
    painter.rect_filled(plate, CornerRadius::same(6), over.look.plate);
    mark(&painter, over.role(), top + vec2(13.0, 13.0), 5.0, color);
    let baseline = top.y + 5.0;
    let title_width = title.size().x;
    painter.galley(Pos2::new(text_left, baseline), title, over.look.text);
    let at = Pos2::new(text_left + title_width + 7.0, baseline);
    painter.galley(at, role, over.look.weak);
    for (index, line) in lines.into_iter().enumerate() {
        let y = baseline + 18.0 + 16.0 * index as f32;
        painter.galley(Pos2::new(text_left, y), line, over.look.weak);
    }
    frame(over, &painter, color);
}

/// A line in the role's colour marks the window that keys act on, a frame the keyboard's focus.
fn frame(over: &Overlay<'_>, painter: &egui::Painter, color: Color32) {
    let is_target = over.state.view.focus == over.role();
    let strength = if is_target { 1.0 } else { 0.28 };
    let line = Rect::from_min_size(over.rect.min, vec2(over.rect.width(), 2.0));
    painter.rect_filled(line, 0.0, color.gamma_multiply(strength));
    if over.is_focused {
        let inner = over.rect.shrink(1.0);
        let stroke = Stroke::new(1.0, color.gamma_multiply(0.7));
        painter.rect_stroke(inner, 0.0, stroke, egui::StrokeKind::Inside);
    }
}

/// A square for crash, a triangle for stamped: shape and colour say the same.
pub(super) fn mark(painter: &egui::Painter, role: Role, center: Pos2, radius: f32, color: Color32) {
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

/// What the window shows, line by line.
fn facts(over: &Overlay<'_>) -> Vec<String> {
    let state = over.state;
    let mut lines = Vec::new();
    if let Some(part) = state.document.part(over.role()) {
        let full = grouped(part.loaded.mesh.n_triangles());
        let is_reduced = state.view.shown == ShownGeometry::Reduced && !state.view.is_blinking;
        let triangles = match part.level.as_ref().filter(|_| is_reduced) {
            Some(level) => {
                format!(
                    "{} of {full} triangles",
                    grouped(level.level.mesh.n_triangles())
                )
            }
            None => format!("{full} triangles"),
        };
        let n_parts = part.facts.used.len();
        let parts = if n_parts > 1 {
            format!(" · {n_parts} parts")
        } else {
            String::new()
        };
        lines.push(format!("{triangles}{parts}"));
    }
    let is_left = over.role() == Role::Crash;
    if is_left && let Some(tool) = &state.view.move_tool {
        lines.push(tool.modal.header(&tool.frame));
    }
    lines.extend(over.hint.clone());
    if is_left && let Some(preview) = preview(over) {
        lines.push(preview);
    }
    let separation = state.view.display.separation;
    if is_left && state.view.is_moved_over && separation != 0.0 {
        lines.push(format!("shown {separation} apart"));
    }
    lines
}

/// What is shown instead of the real pose.
fn preview(over: &Overlay<'_>) -> Option<String> {
    let state = over.state;
    if state.live_pose.is_some() {
        let running = state.jobs.running().and_then(|job| job.latest.as_ref());
        let text = running.map(|report| format!("matching · iteration {}", report.iteration));
        return Some(text.unwrap_or_else(|| "matching".to_owned()));
    }
    if let Some(start) = state.shown_start() {
        let starts = state.current_starts()?;
        let index = starts.shown? + 1;
        let kind = start_text(start.kind);
        return Some(format!("start {index} of {}{kind}", starts.poses.len()));
    }
    let iteration = state.view.scrubbed_iteration?;
    let n = state.convergence.len();
    Some(format!("iteration {} of {n}", iteration + 1))
}

/// How a start came to be, in a few words.
fn start_text(kind: StartKind) -> String {
    match kind {
        StartKind::SurfaceNormal { angle_deg } => format!(" · normals, turned {angle_deg:.0}°"),
        StartKind::Patch { angle_deg, .. } => format!(" · patch, turned {angle_deg:.0}°"),
        StartKind::PrincipalFrame { .. } => " · principal axes".to_owned(),
        _ => String::new(),
    }
}

/// Buttons of the camera, top right.
pub(super) fn buttons(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
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
    let size = vec2(212.0, 24.0);
    let corner = Pos2::new(
        over.rect.right() - MARGIN - size.x,
        over.rect.top() + MARGIN,
    );
    let area = Rect::from_min_size(corner, size);
    if area.left() < over.rect.left() + 150.0 {
        return;
    }
    ui.painter()
        .rect_filled(area, CornerRadius::same(6), over.look.plate);
    let builder = UiBuilder::new()
        .max_rect(area.shrink(2.0))
        .layout(Layout::right_to_left(Align::Center));
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding = vec2(7.0, 2.0);
        for (label, tooltip, command) in entries.into_iter().rev() {
            let is_on = label == "Link" && over.state.view.are_linked;
            let text = RichText::new(label).size(11.5);
            let text = if is_on {
                text.color(over.look.text).strong()
            } else {
                text.color(over.look.weak)
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
    });
}
