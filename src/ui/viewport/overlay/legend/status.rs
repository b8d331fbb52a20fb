//! What became of the elements of a mapping: how many, how much area, and the way to the first of each.

use egui::{Align, Layout, Rect, RichText, Sense, Stroke, Ui, vec2};

use super::bar;
use crate::app::{Command, InspectCommand, MapPicture};
use crate::colormap::ColorScale;
use crate::role::Role;
use crate::text::{self, counted, grouped};
use crate::ui::theme::color;
use crate::ui::viewport::overlay::Overlay;

/// A row for each status that occurs; a click flies to the first element that has it.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let title = RichText::new(MapPicture::Status.label()).size(12.5);
    ui.label(title.color(over.frame.look.text));
    ui.add_space(3.0);
    for (status, n, share, first) in over.frame.state.map_statuses() {
        let class = Class {
            name: status.label(),
            size: (n, share),
            first: Some(first),
            look: (ColorScale::statuses(), f64::from(status as u8)),
        };
        row(ui, over, &class, commands);
    }
    sizes(ui, over);
}

/// What the numbers of the rows are.
pub(super) fn sizes(ui: &mut Ui, over: &Overlay<'_>) {
    ui.label(
        RichText::new("elements and share of the area")
            .size(11.0)
            .color(over.frame.look.weak),
    );
}

/// The elements of one class.
pub(super) struct Class<'a> {
    /// What they have in common.
    pub name: &'a str,
    /// How many there are, and their share of the area.
    pub size: (usize, f64),
    /// The first of them, by its place in the run.
    pub first: Option<usize>,
    /// Their value on a scale.
    pub look: (ColorScale, f64),
}

/// Look, name and size of a class; a click flies to its first element.
pub(super) fn row(ui: &mut Ui, over: &Overlay<'_>, class: &Class<'_>, commands: &mut Vec<Command>) {
    let (n, share) = class.size;
    let place = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::hover());
        swatch(ui, rect, class.look, over);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let name = RichText::new(class.name).size(12.0);
            ui.add(egui::Label::new(name).truncate());
            let numbers = RichText::new(format!("{} · {}", grouped(n), text::share(share)));
            ui.label(numbers.size(11.0).color(over.frame.look.weak));
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |_| {});
    });
    let Some(first) = class.first else {
        return;
    };
    let id = ui.make_persistent_id(("class", class.name, over.role().word()));
    let response = ui.interact(place.response.rect, id, Sense::click());
    let name = format!(
        "{}: {}, {}",
        class.name,
        counted(n, "element"),
        text::share(share)
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let response = response.on_hover_text("Look at the first of these elements");
    if response.clicked()
        && let Some(result) = over.frame.state.document.current_mapping()
    {
        let look = InspectCommand::LookAt {
            role: Role::Crash,
            point: result.run.target.mesh.centroids()[first],
            text: class.name.to_owned(),
        };
        commands.push(look.into());
    }
}

/// Colour and pattern as on the part.
fn swatch(ui: &Ui, rect: Rect, (scale, value): (ColorScale, f64), over: &Overlay<'_>) {
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, color(scale.color(value)));
    bar::patterns(&painter, rect, |_| scale.pattern(value));
    let stroke = Stroke::new(1.0, over.frame.look.plate_line);
    ui.painter()
        .rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Outside);
}
