//! What the colours of a window mean.

mod bar;
mod deviation;
mod files;
mod limits;
mod menu;
mod overlap;
mod status;

use egui::{
    Align, CornerRadius, Frame, Layout, Margin, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui,
    UiBuilder, Vec2, vec2,
};

use super::{MARGIN, Overlay, header};
use crate::app::{Command, MapPicture, file_names};
use crate::colormap::ColorScale;
use crate::pipeline::forming_values::LayerChoice;
use crate::text::{inside, tick_number};
use crate::ui::pictures::clickable;
use crate::ui::theme::Palette;
use crate::ui::viewport::fields::FieldKind;

/// Width of what is inside the plate, and of the folded one; air beside it.
const WIDTH: f32 = 172.0;
const SLIM: f32 = 58.0;
/// Width of the classes of the overlap with a column of shares for each of two parts, and of the narrowest window
/// that has room for it beside the names of the parts.
const TWO_SHARES: f32 = 212.0;
const BESIDE_NAMES: f32 = 420.0;
const AIR: f32 = 8.0;
/// Room above the legend for the buttons of the camera, and below it for the scale bar.
const ABOVE: f32 = 44.0;
const BELOW: f32 = 36.0;
/// Windows narrower than this have the names of the parts above the legend, or, if they are too low for
/// both, shorter ones beside it; narrower than the next they have no legend.
const NARROW: f32 = 6.0 * SLIM;
const NARROWEST: f32 = 5.0 * SLIM;
/// Least height of a folded legend below the names.
const BELOW_NAMES: f32 = 260.0;
/// Windows lower than this have no legend, and up to the next only the folded one.
const LEAST_HEIGHT: f32 = 170.0;
const OPEN_HEIGHT: f32 = 260.0;
const FULL_HEIGHT: f32 = 440.0;

/// The legend at the right edge, below the buttons of the camera; returns where it lies.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) -> Option<Rect> {
    let window = over.frame.rect();
    let has_room = top(over).is_some() && !is_narrow(over);
    let Some((kind, scale)) = over.scale.filter(|_| !is_awaited(over)) else {
        // The first measurement is under way.
        if has_room && over.kind.is_some_and(is_measured) {
            plate(ui, over, WIDTH, |ui| deviation::waiting(ui, over, commands));
        }
        return None;
    };
    let classes: Option<Classes> = match kind {
        FieldKind::Overlap => Some(overlap::show),
        FieldKind::Map(MapPicture::Status) => Some(status::show),
        FieldKind::Map(MapPicture::File) => Some(files::show),
        _ => None,
    };
    if let Some(classes) = classes {
        let has_two = kind == FieldKind::Overlap && over.frame.picture.roles().len() > 1;
        let (width, least) = if has_two {
            (TWO_SHARES, BESIDE_NAMES)
        } else {
            (WIDTH, 0.0)
        };
        if has_room && window.width() >= least {
            return Some(plate(ui, over, width, |ui| classes(ui, over, commands)));
        }
        behind_button(ui, over, width, |ui| classes(ui, over, commands));
        return None;
    }
    if top(over).is_none() {
        behind_button(ui, over, WIDTH, |ui| {
            slim(ui, over, (kind, &scale), false, commands);
        });
        return None;
    }
    let can_open = window.height() >= OPEN_HEIGHT && window.width() >= 2.0 * WIDTH;
    if is_folded(ui, over) || !can_open {
        return Some(plate(ui, over, SLIM, |ui| {
            slim(ui, over, (kind, &scale), can_open, commands);
        }));
    }
    let room = Room {
        is_full: window.height() >= FULL_HEIGHT,
        bar: if window.height() >= FULL_HEIGHT {
            (window.height() - 290.0).clamp(150.0, 176.0)
        } else {
            (window.height() - 212.0).clamp(56.0, 150.0)
        },
    };
    Some(plate(ui, over, WIDTH, |ui| match kind {
        FieldKind::Deviation => deviation::show(ui, over, &scale, room, commands),
        _ => {
            let title = [Some(title(over, kind)), unit(over, kind)];
            let title = title.into_iter().flatten().collect::<Vec<_>>().join(", ");
            bar::plain(ui, over, &title, &scale, room.bar, commands);
        }
    }))
}

/// True while the colours that have a legend are still being made.
pub(super) fn is_awaited(over: &Overlay<'_>) -> bool {
    let is_measured = over.frame.state.comparison().is_some();
    over.kind
        .is_some_and(|kind| over.scale.is_none() || kind == FieldKind::Overlap && !is_measured)
}

/// Draws what the classes of a picture are.
type Classes = fn(&mut Ui, &Overlay<'_>, &mut Vec<Command>);

/// What is said of values that would be others now, and how strong they are drawn.
pub(super) const OUT_OF_DATE: &str = "out of date";
const OLD: f32 = 0.45;
/// Height of the note below a folded legend.
const NOTE: f32 = 16.0;
/// Height of the button that opens a legend for which its window has no room.
const BUTTON: f32 = 20.0;

fn button_place(over: &Overlay<'_>) -> Rect {
    let window = over.frame.rect();
    let size = vec2(56.0_f32.min(window.width()), BUTTON);
    Rect::from_min_size(window.max - size - Vec2::splat(4.0), size)
}

/// Where the button lies that opens the legend of a window too small for it.
pub(super) fn button(over: &Overlay<'_>) -> Option<Rect> {
    let is_there = over.scale.is_some() && over.frame.picture.has_colored();
    (is_there && top(over).is_none()).then(|| button_place(over))
}

/// A button at the foot of the window that opens the legend over it.
fn behind_button(ui: &mut Ui, over: &Overlay<'_>, width: f32, add: impl FnOnce(&mut Ui)) {
    if !over.frame.picture.has_colored() {
        return;
    }
    let place = button_place(over);
    let builder = UiBuilder::new()
        .max_rect(place)
        .layout(Layout::right_to_left(Align::Center));
    let button_ui = |ui: &mut Ui| {
        let text = egui::RichText::new("Legend").size(11.0);
        let button = egui::Button::new(text).fill(over.frame.look.plate.to_opaque());
        let close = egui::PopupCloseBehavior::CloseOnClickOutside;
        let config = egui::containers::menu::MenuConfig::new().close_behavior(close);
        let menu = egui::containers::menu::MenuButton::from_button(button).config(config);
        let (response, _) = menu.ui(ui, |ui| {
            ui.set_width(width);
            egui::ScrollArea::vertical()
                .max_height(ui.ctx().content_rect().height() - 2.0 * BUTTON)
                .show(ui, |ui| of_mapping(ui, over, add));
        });
        let name = format!("Legend ({})", over.role().word());
        response
            .on_hover_text("What the colours mean")
            .accessible_name(name);
    };
    clickable(ui, |ui| ui.scope_builder(builder, button_ui));
}

/// True in a window where names of parts and a legend have no room beside each other.
fn is_narrow(over: &Overlay<'_>) -> bool {
    header::height(over).is_some() && over.frame.rect().width() < NARROW
}

/// How far below the top of its window the legend begins; `None` where there is none.
fn top(over: &Overlay<'_>) -> Option<f32> {
    let window = over.frame.rect();
    let is_small = window.height() < LEAST_HEIGHT || window.width() < 4.0 * SLIM;
    if is_small || !over.frame.picture.has_colored() {
        return None;
    }
    let Some(names) = header::height(over).filter(|_| is_narrow(over)) else {
        return Some(ABOVE);
    };
    let below = MARGIN + names + 6.0;
    if window.height() - below >= BELOW_NAMES {
        return Some(below);
    }
    (window.width() >= NARROWEST).then_some(MARGIN)
}

/// Width of the legend where the names of the parts leave it room beside them.
pub(super) fn beside_names(over: &Overlay<'_>) -> f32 {
    let is_wide_one = over.kind.is_none_or(|kind| {
        matches!(
            kind,
            FieldKind::Overlap | FieldKind::Map(MapPicture::Status | MapPicture::File)
        )
    });
    let is_beside = is_narrow(over) && top(over) == Some(MARGIN);
    if is_beside && over.scale.is_some() && !is_wide_one {
        SLIM + 2.0 * AIR + MARGIN
    } else {
        0.0
    }
}

/// What the numbers are, with what of it is shown.
fn title(over: &Overlay<'_>, kind: FieldKind) -> String {
    let state = over.frame.state;
    let quantity = state.map_quantity();
    let layered = |name: &str, layer: Option<LayerChoice>| match layer {
        Some(layer) => format!("{name}, {}", layer.label().to_lowercase()),
        None => name.to_owned(),
    };
    match kind {
        FieldKind::Map(MapPicture::Difference) => {
            let name = format!("Difference of {}", inside(quantity.label()));
            layered(&name, state.shown_layer(quantity))
        }
        FieldKind::Map(MapPicture::Other) => {
            let compared = state.document.current_mapping();
            let compared = compared.and_then(|result| result.record.comparison.as_ref());
            let files = compared.map_or_else(String::new, |record| file_names(&record.files));
            let name = format!("{}, less {files}", quantity.label());
            layered(&name, state.shown_layer(quantity))
        }
        FieldKind::Map(MapPicture::Angle) => "Angle of the normals".to_owned(),
        FieldKind::Forming(value) => layered(kind.label(), state.shown_layer(value.into())),
        _ => kind.label().to_owned(),
    }
}

/// The unit of the numbers; `None` where they have none or it is not known.
fn unit(over: &Overlay<'_>, kind: FieldKind) -> Option<String> {
    let state = over.frame.state;
    let value = match kind {
        FieldKind::Overlap
        | FieldKind::Map(MapPicture::Confidence | MapPicture::Status | MapPicture::File) => {
            return None;
        }
        FieldKind::Map(MapPicture::Angle) => return Some("°".to_owned()),
        FieldKind::Thickness | FieldKind::ReductionError => {
            let unit = state.lengths_of(over.role()).unit;
            return unit.map(|unit| unit.symbol().to_owned());
        }
        FieldKind::Forming(value) => Some(value),
        FieldKind::Map(MapPicture::Difference | MapPicture::Other) => {
            state.map_quantity().forming()
        }
        _ => None,
    };
    let unit = state.document.unit_of(over.role(), value);
    unit.map(str::to_owned)
}

fn is_measured(kind: FieldKind) -> bool {
    matches!(kind, FieldKind::Deviation | FieldKind::Overlap)
}

/// What the colours say, and the bar with its numbers; the rest behind a button.
fn slim(
    ui: &mut Ui,
    over: &Overlay<'_>,
    (kind, scale): (FieldKind, &ColorScale),
    can_open: bool,
    commands: &mut Vec<Command>,
) {
    let name = RichText::new(title(over, kind)).size(11.0);
    ui.add(egui::Label::new(name).wrap());
    if let Some(unit) = unit(over, kind) {
        let unit = RichText::new(unit).size(11.0);
        ui.label(unit.color(over.frame.look.weak));
    }
    let opacity = ui.opacity();
    if kind == FieldKind::Deviation {
        deviation::slim_head(ui, over);
    }
    if over.is_equal() {
        bar::equal(ui, scale, over);
    } else {
        let note = if scale.hides_beyond { NOTE } else { 0.0 };
        let left = over.frame.rect().height() - top(over).unwrap_or(ABOVE) - BELOW - 84.0 - note;
        let height = left.clamp(60.0, 220.0);
        let (room, _) = ui.allocate_exact_size(vec2(SLIM, height + 16.0), Sense::hover());
        let bar = Rect::from_min_size(room.min + vec2(1.0, 8.0), vec2(bar::BAR, height));
        bar::paint(ui.painter(), scale, bar, over);
        bar::ticks(ui.painter(), scale, bar, over, false);
        limits::hidden_note(ui, over, scale);
    }
    ui.set_opacity(opacity);
    if can_open {
        fold(ui, over);
    }
    if kind == FieldKind::Deviation {
        deviation::slim_freshness(ui, over, commands);
    }
}

/// True unless the user unfolded the legend of a window: folded it leaves the picture free.
fn is_folded(ui: &Ui, over: &Overlay<'_>) -> bool {
    let id = fold_id(ui, over);
    ui.data(|data| data.get_temp(id)).unwrap_or(true)
}

fn fold_id(ui: &Ui, over: &Overlay<'_>) -> egui::Id {
    egui::Id::unique(("legend folded", over.role().word())).with(ui.ctx().viewport_id())
}

/// The button that folds the legend to its bar and back.
fn fold(ui: &mut Ui, over: &Overlay<'_>) {
    let is_folded = is_folded(ui, over);
    let (sign, name) = if is_folded {
        ("<  more", "Unfold the legend")
    } else {
        (">", "Fold the legend")
    };
    let button = egui::Button::new(egui::RichText::new(sign).size(11.0)).small();
    let response = clickable(ui, |ui| ui.add(button)).on_hover_text(name);
    let name = format!("{name} ({})", over.role().word());
    if response.accessible_name(name).clicked() {
        let id = fold_id(ui, over);
        ui.data_mut(|data| data.insert_temp(id, !is_folded));
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

/// An opaque plate at the right edge, as high as what is on it, which can be dragged elsewhere; the
/// pointer does not reach through. Returns where it lies.
fn plate(ui: &mut Ui, over: &Overlay<'_>, width: f32, add: impl FnOnce(&mut Ui)) -> Rect {
    let id = ui.make_persistent_id(("legend", over.role().word()));
    let last = ui.data(|data| data.get_temp::<Rect>(id));
    let moved = last.map_or(Vec2::ZERO, |last| dragged(ui, id, last));
    let window = over.frame.rect();
    let outer = width + 2.0 * AIR;
    let size = vec2(outer, last.map_or(0.0, |last| last.height()));
    let home = Pos2::new(
        window.right() - MARGIN - outer,
        window.top() + top(over).unwrap_or(ABOVE),
    );
    let low = window.min + Vec2::splat(4.0);
    let high = (window.max - size - Vec2::splat(4.0)).max(low);
    let corner = (home + moved).clamp(low, high);
    let room = Rect::from_min_max(corner, Pos2::new(corner.x + outer, window.bottom() - 4.0));
    let ground = ui.painter().add(Shape::Noop);
    let builder = UiBuilder::new()
        .max_rect(room)
        .layout(Layout::top_down(Align::Min));
    let shown = ui.scope_builder(builder, |ui| {
        ui.set_clip_rect(window);
        ui.spacing_mut().item_spacing = vec2(5.0, 3.0);
        ui.spacing_mut().button_padding = vec2(4.0, 1.0);
        ui.spacing_mut().interact_size = vec2(36.0, 18.0);
        ui.visuals_mut().override_text_color = Some(over.frame.look.text);
        Frame::new()
            .inner_margin(Margin::same(AIR as i8))
            .show(ui, |ui| {
                ui.set_width(width);
                of_mapping(ui, over, add);
            });
    });
    let used = shown.response.rect;
    let fill = over.frame.look.plate.to_opaque();
    let line = Stroke::new(1.0, over.frame.look.plate_line);
    let radius = CornerRadius::same(6);
    let shape = egui::epaint::RectShape::new(used, radius, fill, line, egui::StrokeKind::Inside);
    ui.painter().set(ground, Shape::Rect(shape));
    ui.data_mut(|data| data.insert_temp(id, used));
    used
}

/// The legend of mapped values that are out of date is pale and says so at its foot, so that its bar stays where it is.
fn of_mapping(ui: &mut Ui, over: &Overlay<'_>, add: impl FnOnce(&mut Ui)) {
    if !over.frame.state.is_old_mapping_shown(over.role()) {
        return add(ui);
    }
    let opacity = ui.opacity();
    ui.set_opacity(OLD * opacity);
    add(ui);
    ui.set_opacity(opacity);
    let text = RichText::new(OUT_OF_DATE).size(11.0);
    ui.add(egui::Label::new(text.color(Palette::of(ui).check)).wrap());
}

/// How far the user dragged the legend from its place; a double click puts it back.
fn dragged(ui: &Ui, id: egui::Id, last: Rect) -> Vec2 {
    let response = ui.interact(last, id, Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(egui::CursorIcon::Grab);
    let id = id.with("moved");
    let before: Vec2 = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let moved = if response.double_clicked() {
        Vec2::ZERO
    } else {
        before + response.drag_delta()
    };
    if moved != before {
        ui.data_mut(|data| data.insert_temp(id, moved));
    }
    moved
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
    if digits > MOST_DIGITS && tick != 0.0 {
        let text = format!("{tick:.1e}").replace('-', "−");
        return text.replace(".0e", "e");
    }
    tick_number(tick, digits as usize)
}

/// Numbers with more decimals have no room beside the bar.
const MOST_DIGITS: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_digits_of_their_step() {
        assert_eq!(tick_text(0.5, &[0.0, 0.5, 1.0]), "0.5");
        assert_eq!(tick_text(20.0, &[0.0, 20.0]), "20");
        assert_eq!(tick_text(-1e-17, &[-0.2, 0.0]), "0");
        assert_eq!(tick_text(1.25, &[1.2, 1.25]), "1.25");
        let tiny = [-2e-7, 0.0, 2e-7, 1.2e-6];
        let read = tiny.map(|tick| tick_text(tick, &tiny));
        assert_eq!(read, ["−2e−7", "0", "2e−7", "1.2e−6"]);
    }
}
