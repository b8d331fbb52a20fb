//! What stands in a window without a part: an invitation, the loading, or where the part went.

use egui::{
    Align, Align2, Button, CornerRadius, FontId, Layout, Pos2, Rect, RichText, Shape, Stroke, Ui,
    UiBuilder, vec2,
};

use super::{Overlay, header};
use crate::app::{Command, FileCommand, ViewCommand};
use crate::jobs::{JobKey, Role};

/// Shows the card of an empty window; false if there is a picture.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) -> bool {
    let role = over.role();
    let is_loading = over.state.jobs.is_active(JobKey::Load(role));
    let has_part = over.state.document.part(role).is_some();
    if is_loading && !has_part {
        loading(ui, over, "Reading the file");
        return true;
    }
    if !has_part && over.picture.is_empty() {
        invite(ui, over, commands);
        return true;
    }
    let is_away = role == Role::Stamped && over.stage.over >= 1.0;
    if is_away {
        away(ui, over, commands);
        return true;
    }
    if over.picture.is_empty() {
        loading(ui, over, "Preparing the picture");
        return true;
    }
    false
}

fn loading(ui: &Ui, over: &Overlay<'_>, text: &str) {
    let painter = over.painter(ui);
    let center = over.rect.center();
    painter.text(
        center,
        Align2::CENTER_CENTER,
        text,
        FontId::proportional(14.0),
        over.look.weak,
    );
    let now = ui.input(|i| i.time);
    let color = over.look.role(over.role());
    for dot in 0..3 {
        let phase = (now * 1.4 - f64::from(dot) * 0.18).rem_euclid(1.0) as f32;
        let strength = 0.25 + 0.75 * (1.0 - phase).powi(2);
        let at = center + vec2(14.0 * (dot as f32 - 1.0), 24.0);
        painter.circle_filled(at, 3.5, color.gamma_multiply(strength));
    }
    // Slow enough to leave the processor to the work.
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_millis(66));
}

/// "Drop the part here" in a dashed frame, with buttons.
fn invite(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let role = over.role();
    let (title, hint) = match role {
        Role::Crash => (
            "Drop the crash model here",
            "LS-DYNA keyword deck, STL, OBJ or PLY",
        ),
        Role::Stamped => (
            "Drop the stamped part here",
            "result of the forming simulation: dynain, keyword deck, STL, OBJ or PLY",
        ),
    };
    let painter = over.painter(ui);
    let is_dropping = ui.input(|i| !i.raw.hovered_files.is_empty());
    let color = over.look.role(role);
    let line = if is_dropping {
        color
    } else {
        over.look.weak.gamma_multiply(0.45)
    };
    let frame = over
        .rect
        .shrink2(vec2(28.0, 28.0))
        .with_min_y(over.rect.top() + 64.0);
    dashed(&painter, frame, Stroke::new(1.5, line));
    let center = frame.center();
    header::mark(
        &painter,
        role,
        center - vec2(0.0, 78.0),
        13.0,
        color.gamma_multiply(0.9),
    );
    let wide = frame.width() - 24.0;
    let text = |size, color, text: &str| {
        painter.layout(text.to_owned(), FontId::proportional(size), color, wide)
    };
    let title = text(17.0, over.look.text, title);
    let hint = text(12.0, over.look.weak, hint);
    let at = |galley: &egui::Galley, y: f32| center + vec2(-galley.size().x * 0.5, y);
    painter.galley(at(&title, -46.0), title, over.look.text);
    painter.galley(at(&hint, -18.0), hint, over.look.weak);
    let open: (&str, String, Command) = (
        "Open…",
        format!("Open the {} part…", role.word()),
        FileCommand::AskOpen(role).into(),
    );
    let example: (&str, String, Command) = (
        "Open the example pair",
        format!("Open the example pair ({} window)", role.word()),
        FileCommand::OpenExample.into(),
    );
    buttons(
        ui,
        center + vec2(0.0, 30.0),
        [open, example].into(),
        commands,
    );
}

/// Where the stamped part went, and the way back.
fn away(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let painter = over.painter(ui);
    let center = over.rect.center();
    let card = Rect::from_center_size(center, vec2(280.0, 128.0));
    painter.rect_filled(card, CornerRadius::same(10), over.look.plate);
    let stroke = Stroke::new(1.0, over.look.plate_line);
    painter.rect_stroke(
        card,
        CornerRadius::same(10),
        stroke,
        egui::StrokeKind::Inside,
    );
    let color = over.look.role(Role::Stamped);
    header::mark(
        &painter,
        Role::Stamped,
        center - vec2(0.0, 40.0),
        8.0,
        color,
    );
    let title = FontId::proportional(14.5);
    let at = center - vec2(0.0, 14.0);
    let text = "Moved to the left window";
    painter.text(at, Align2::CENTER_CENTER, text, title, over.look.text);
    let back: (&str, String, Command) = (
        "Move back",
        "Move the stamped part back".to_owned(),
        ViewCommand::ToggleMoveOver.into(),
    );
    buttons(ui, center + vec2(0.0, 26.0), vec![back], commands);
}

/// A row of buttons about a point.
fn buttons(
    ui: &mut Ui,
    center: Pos2,
    entries: Vec<(&str, String, Command)>,
    commands: &mut Vec<Command>,
) {
    let font = FontId::proportional(13.0);
    let width = |text: &str| {
        let galley =
            ui.painter()
                .layout_no_wrap(text.to_owned(), font.clone(), egui::Color32::WHITE);
        galley.size().x + 28.0
    };
    let widths: Vec<f32> = entries.iter().map(|(text, ..)| width(text)).collect();
    let gaps = 8.0 * (entries.len() as f32 - 1.0);
    let size = vec2(widths.iter().sum::<f32>() + gaps, 30.0);
    let builder = UiBuilder::new()
        .max_rect(Rect::from_center_size(center, size))
        .layout(Layout::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        for ((text, name, command), width) in entries.into_iter().zip(widths) {
            let button = Button::new(RichText::new(text).size(13.0)).min_size(vec2(width, 30.0));
            if ui.add(button).accessible_name(name).clicked() {
                commands.push(command);
            }
        }
    });
}

fn dashed(painter: &egui::Painter, frame: Rect, stroke: Stroke) {
    let corners = [
        frame.left_top(),
        frame.right_top(),
        frame.right_bottom(),
        frame.left_bottom(),
        frame.left_top(),
    ];
    painter.extend(Shape::dashed_line(&corners, stroke, 7.0, 6.0));
}
