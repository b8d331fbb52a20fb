//! What the colours of a window mean.

mod bar;
mod deviation;
mod menu;
mod overlap;

use egui::{
    Align, CornerRadius, Frame, Layout, Margin, Pos2, Rect, Sense, Shape, Ui, UiBuilder, vec2,
};

use super::{MARGIN, Overlay};
use crate::app::Command;
use crate::ui::viewport::fields::FieldKind;

/// Width of what is inside the plate, and of the folded one.
const WIDTH: f32 = 172.0;
const SLIM: f32 = 52.0;
/// Windows lower than this have no legend, those lower than the next a short one.
const LEAST_HEIGHT: f32 = 240.0;
const FULL_HEIGHT: f32 = 440.0;

/// The legend below the buttons of the camera.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    let Some((kind, scale)) = over.scale else {
        // The first measurement is under way.
        if over.kind.is_some_and(is_measured) && over.frame.picture.has_colored() {
            plate(ui, over, |ui| deviation::waiting(ui, over, commands));
        }
        return;
    };
    let is_low =
        over.frame.rect().height() < LEAST_HEIGHT || over.frame.rect().width() < 2.0 * WIDTH;
    if is_low || !over.frame.picture.has_colored() {
        return;
    }
    if kind == FieldKind::Deviation && is_folded(ui, over) {
        plate(ui, over, |ui| {
            deviation::slim(ui, over, &scale);
        });
        return;
    }
    let room = Room {
        is_full: over.frame.rect().height() >= FULL_HEIGHT,
        bar: if over.frame.rect().height() >= FULL_HEIGHT {
            176.0
        } else {
            (over.frame.rect().height() - 170.0).clamp(70.0, 150.0)
        },
    };
    plate(ui, over, |ui| match kind {
        FieldKind::Deviation => deviation::show(ui, over, &scale, room, commands),
        FieldKind::Overlap => overlap::show(ui, over, commands),
        FieldKind::Thickness | FieldKind::ReductionError | FieldKind::Forming(_) => {
            bar::plain(ui, over, kind.label(), &scale, room.bar, commands);
        }
    });
}

fn is_measured(kind: FieldKind) -> bool {
    matches!(kind, FieldKind::Deviation | FieldKind::Overlap)
}

/// True if the user folded the legend of a window, or the section takes the room for it.
fn is_folded(ui: &Ui, over: &Overlay<'_>) -> bool {
    let is_tight = over.frame.state.inspect.section.is_on && over.frame.rect().width() < 640.0;
    ui.data(|data| data.get_temp(fold_id(ui, over)))
        .unwrap_or(is_tight)
}

fn fold_id(ui: &Ui, over: &Overlay<'_>) -> egui::Id {
    egui::Id::unique(("legend folded", over.role().word())).with(ui.ctx().viewport_id())
}

/// The button that folds the legend to its bar and back.
fn fold(ui: &mut Ui, over: &Overlay<'_>) {
    let is_folded = is_folded(ui, over);
    let (sign, name) = if is_folded {
        ("<", "Unfold the legend")
    } else {
        (">", "Fold the legend")
    };
    let button = egui::Button::new(egui::RichText::new(sign).size(11.5)).small();
    let response = ui.add(button).on_hover_text(name);
    let name = format!("{name} ({})", over.role().word());
    if response.accessible_name(name).clicked() {
        ui.data_mut(|data| data.insert_temp(fold_id(ui, over), !is_folded));
    }
}

/// How much a legend may show.
#[derive(Debug, Clone, Copy)]
struct Room {
    is_full: bool,
    /// Height of the bar.
    bar: f32,
}

/// Where the legend of a window was drawn last.
pub(super) fn last_place(ui: &Ui, over: &Overlay<'_>) -> Option<Rect> {
    over.scale.as_ref()?;
    let id = ui.make_persistent_id(("legend", over.role().word()));
    ui.data(|data| data.get_temp(id))
}

/// A plate in the upper right corner, as high as what is on it; the pointer does not reach through.
fn plate(ui: &mut Ui, over: &Overlay<'_>, add: impl FnOnce(&mut Ui)) {
    let id = ui.make_persistent_id(("legend", over.role().word()));
    if let Some(last) = ui.data(|data| data.get_temp::<Rect>(id)) {
        ui.interact(last, id, Sense::click_and_drag());
    }
    let is_slim = over.kind == Some(FieldKind::Deviation) && is_folded(ui, over);
    let outer = if is_slim { SLIM } else { WIDTH } + 20.0;
    let corner = Pos2::new(
        over.frame.rect().right() - MARGIN - outer,
        over.frame.rect().top() + 44.0,
    );
    let room = Rect::from_min_max(
        corner,
        Pos2::new(
            over.frame.rect().right() - MARGIN,
            over.frame.rect().bottom() - MARGIN,
        ),
    );
    let ground = ui.painter().add(Shape::Noop);
    let builder = UiBuilder::new()
        .max_rect(room)
        .layout(Layout::top_down(Align::Min));
    let shown = ui.scope_builder(builder, |ui| {
        ui.set_clip_rect(over.frame.rect());
        ui.spacing_mut().item_spacing = vec2(5.0, 3.0);
        ui.spacing_mut().button_padding = vec2(4.0, 1.0);
        ui.spacing_mut().interact_size = vec2(36.0, 18.0);
        ui.visuals_mut().override_text_color = Some(over.frame.look.text);
        Frame::new()
            .inner_margin(Margin::symmetric(10, 8))
            .show(ui, |ui| {
                ui.set_width(outer - 20.0);
                add(ui);
            });
    });
    let used = shown.response.rect;
    let shape = Shape::rect_filled(
        used,
        CornerRadius::same(6),
        over.frame.look.plate.to_opaque(),
    );
    ui.painter().set(ground, shape);
    ui.data_mut(|data| data.insert_temp(id, used));
}

/// As many digits as the step between ticks needs.
fn tick_text(tick: f64, ticks: &[f64]) -> String {
    let step = ticks
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .next();
    let digits = step
        .map_or(3.0, |step| (-step.log10() + 0.3).ceil())
        .clamp(0.0, 9.0);
    let text = format!("{tick:.0$}", digits as usize);
    if text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.')
    {
        "0".to_owned()
    } else {
        text.replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_digits_of_their_step() {
        assert_eq!(tick_text(0.5, &[0.0, 0.5, 1.0]), "0.5");
        assert_eq!(tick_text(20.0, &[0.0, 20.0]), "20");
        assert_eq!(tick_text(-1e-17, &[-0.2, 0.0]), "0");
        assert_eq!(tick_text(1.25, &[1.2, 1.25]), "1.25");
    }
}
