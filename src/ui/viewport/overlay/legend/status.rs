//! What became of the elements of a mapping: how many, how much area, and the way to the first of each.

use egui::{Align, Layout, Rect, RichText, Sense, Stroke, Ui, vec2};

use super::bar;
use crate::app::{Command, InspectCommand, MapPicture};
use crate::colormap::ColorScale;
use crate::mapping::Status;
use crate::role::Role;
use crate::text::grouped;
use crate::ui::theme::color;
use crate::ui::viewport::overlay::Overlay;
use crate::ui::widgets::percent;

/// A row for each status that occurs; a click flies to the first element that has it.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let title = RichText::new(MapPicture::Status.label()).size(12.5);
    ui.label(title.color(over.frame.look.text));
    ui.add_space(3.0);
    for (status, n, share, first) in over.frame.state.map_statuses() {
        row(ui, over, (status, n, share, first), commands);
    }
    ui.label(
        RichText::new("elements and share of the area")
            .size(11.0)
            .color(over.frame.look.weak),
    );
}

fn row(
    ui: &mut Ui,
    over: &Overlay<'_>,
    (status, n, share, first): (Status, usize, f64, usize),
    commands: &mut Vec<Command>,
) {
    let place = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::hover());
        swatch(ui, rect, status, over);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            ui.label(RichText::new(status.label()).size(12.0));
            let numbers = RichText::new(format!("{} · {}", grouped(n), percent(share)));
            ui.label(numbers.size(11.0).color(over.frame.look.weak));
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |_| {});
    });
    let id = ui.make_persistent_id(("status", status.name(), over.role().word()));
    let response = ui.interact(place.response.rect, id, Sense::click());
    let name = format!(
        "{}: {} elements, {}",
        status.label(),
        grouped(n),
        percent(share)
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let response = response.on_hover_text("Look at the first of these elements");
    if response.clicked()
        && let Some(result) = over.frame.state.document.current_mapping()
    {
        let look = InspectCommand::LookAt {
            role: Role::Crash,
            point: result.run.target.mesh.centroids()[first],
            text: status.label().to_owned(),
        };
        commands.push(look.into());
    }
}

/// Colour and pattern as on the part.
fn swatch(ui: &Ui, rect: Rect, status: Status, over: &Overlay<'_>) {
    let scale = ColorScale::statuses();
    let number = f64::from(status as u8);
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, color(scale.color(number)));
    bar::patterns(&painter, rect, |_| scale.pattern(number));
    let stroke = Stroke::new(1.0, over.frame.look.plate_line);
    ui.painter()
        .rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Outside);
}
