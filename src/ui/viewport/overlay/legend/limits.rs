//! The values at the ends of a bar of colours, typed or dragged, and whether what lies beyond them is drawn.

use egui::{Rect, RichText, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::bar::Grip;
use crate::colormap::ColorScale;
use crate::text::{length, signed};
use crate::ui::pictures::{clickable, is_screen_taken};
use crate::ui::typed::{Takes, told_field};
use crate::ui::viewport::overlay::Overlay;

/// How quickly a dragged limit grows, per point.
const DRAG_RATE: f64 = 0.012;

/// An end of the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limit {
    Upper,
    Lower,
}

impl Limit {
    fn name(self) -> &'static str {
        match self {
            Self::Upper => "Upper limit",
            Self::Lower => "Lower limit",
        }
    }
}

/// The value at an end of the bar, typed or dragged, so far from the left.
pub(super) fn field(
    ui: &mut Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    (limit, left): (Limit, f32),
    limits: &mut Option<[f64; 2]>,
) {
    let mut value = match limit {
        Limit::Upper => scale.max,
        Limit::Lower => scale.min,
    };
    let before = value;
    let number = if scale.min < 0.0 { signed } else { length };
    ui.horizontal(|ui| {
        ui.add_space(left);
        let takes = Takes::number(limit.name(), "", -1e15..=1e15);
        let field = takes
            .field(&mut value)
            .speed(0.01 * scale.max.abs().max(scale.min.abs()))
            .custom_formatter(move |value, _| number(value));
        let is_alone = ui.input(|i| i.modifiers.alt);
        let response = told_field(ui, limit.name(), before, field, |text| {
            let value = takes.read(text)?;
            limits_with(scale, limit, value, is_alone)?;
            Ok(value)
        });
        response.widget_info(|| {
            let name = format!("{} ({})", limit.name(), over.role().word());
            WidgetInfo::labeled(egui::Role::SpinButton, true, name)
        });
        if response.changed()
            && let Ok(found) = limits_with(scale, limit, value, is_alone)
        {
            *limits = Some(found);
        }
        let hint = if scale.min == -scale.max {
            "Drag or type; both ends move together unless Alt is held"
        } else {
            "Drag or type"
        };
        response.on_hover_text(hint);
    });
}

/// The limits with a new value at one end, which the other end mirrors while they are symmetric, unless the end
/// is moved alone; or why they are none.
fn limits_with(
    scale: &ColorScale,
    limit: Limit,
    value: f64,
    is_alone: bool,
) -> Result<[f64; 2], String> {
    let is_alone = is_alone || scale.min != -scale.max;
    let limits = match limit {
        _ if !is_alone && value != 0.0 => [-value.abs(), value.abs()],
        Limit::Upper => [scale.min, value],
        Limit::Lower => [value, scale.max],
    };
    if limits[0] < limits[1] {
        return Ok(limits);
    }
    Err(match limit {
        Limit::Upper => format!("{}: above {}.", limit.name(), signed(scale.min)),
        Limit::Lower => format!("{}: below {}.", limit.name(), signed(scale.max)),
    })
}

/// The ends of the bar, dragged up or down.
pub(super) fn drag_ends(
    ui: &Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    bar: Rect,
    limits: &mut Option<[f64; 2]>,
) {
    for limit in [Limit::Upper, Limit::Lower] {
        let dragged = drag_end(ui, over, scale, (limit, bar));
        *limits = dragged.or(*limits);
    }
}

/// An end of the bar; the limits that a drag gives.
fn drag_end(
    ui: &Ui,
    over: &Overlay<'_>,
    scale: &ColorScale,
    (limit, bar): (Limit, Rect),
) -> Option<[f64; 2]> {
    let y = match limit {
        Limit::Upper => bar.top(),
        Limit::Lower => bar.bottom(),
    };
    let at = Rect::from_center_size(pos2(bar.center().x, y), vec2(bar.width() + 8.0, 14.0));
    let Grip {
        response,
        is_held,
        color,
    } = Grip::new(ui, over, at, &format!("{} of the colours", limit.name()));
    if !is_screen_taken(ui.ctx()) {
        let width = if is_held { 3.0 } else { 2.0 };
        let line = bar.left() - width..=bar.right() + width;
        ui.painter().hline(line, y, Stroke::new(width, color));
    }
    if !response.dragged() {
        return None;
    }
    let up = -f64::from(response.drag_delta().y);
    let (value, outward) = match limit {
        Limit::Upper => (scale.max, up),
        Limit::Lower => (scale.min, -up),
    };
    let span = scale.max - scale.min;
    let is_symmetric = scale.min == -scale.max;
    let value = if is_symmetric {
        value * (DRAG_RATE * outward).exp()
    } else {
        value + up * DRAG_RATE * span
    };
    let is_alone = ui.input(|i| i.modifiers.alt);
    limits_with(scale, limit, value, is_alone).ok()
}

/// True if the bar was clicked twice.
pub(super) fn is_automatic_asked(ui: &Ui, over: &Overlay<'_>, bar: Rect) -> bool {
    let id = ui.make_persistent_id(("bar", over.role().word()));
    let middle = bar.shrink2(vec2(0.0, 14.0));
    let response = ui.interact(middle, id, Sense::click());
    let is_asked = response.double_clicked();
    response.on_hover_text("Double click: automatic limits");
    is_asked
}

/// Whether what lies beyond the limits is drawn.
pub(super) fn hide_box(ui: &mut Ui, over: &Overlay<'_>, hides_beyond: &mut bool) {
    let text = RichText::new("Hide outside the limits").size(11.5);
    let response = if *hides_beyond {
        // It says in a picture too that not everything is drawn.
        ui.checkbox(hides_beyond, text)
    } else {
        clickable(ui, |ui| ui.checkbox(hides_beyond, text))
    };
    let name = format!("Hide outside the limits ({})", over.role().word());
    let hint = "Draws only what has a value between limits that were set by hand, in both windows; places without a \
        value stay, and so does everything while the limits are automatic";
    response.on_hover_text(hint).accessible_name(name);
}

/// Says below a folded legend that not everything is drawn.
pub(super) fn hidden_note(ui: &mut Ui, over: &Overlay<'_>, scale: &ColorScale) {
    if scale.hides_beyond {
        let note = RichText::new("rest hidden").size(10.5);
        ui.label(note.color(over.frame.look.weak));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colormap::ColorMap;

    #[test]
    fn limits_of_one_sign_move_alone_and_never_cross() {
        let scale = ColorScale::new(ColorMap::Viridis, 0.5, 0.9);
        let with = |limit, value| limits_with(&scale, limit, value, false);
        assert_eq!(with(Limit::Upper, 0.8), Ok([0.5, 0.8]));
        assert_eq!(with(Limit::Lower, 0.6), Ok([0.6, 0.9]));
        assert!(with(Limit::Lower, 0.9).is_err() && with(Limit::Upper, 0.4).is_err());
        let signed = ColorScale::symmetric(2.0, 0.0);
        let both = limits_with(&signed, Limit::Upper, 1.0, false);
        assert_eq!(both, Ok([-1.0, 1.0]));
        let alone = limits_with(&signed, Limit::Upper, 1.0, true);
        assert_eq!(alone, Ok([-2.0, 1.0]));
    }
}
