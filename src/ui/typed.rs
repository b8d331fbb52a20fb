//! Fields for numbers: what they read, and at the field the reason why a typed text is refused.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::{DragValue, Response, RichText, Stroke, Ui, emath::Numeric, vec2};

use super::theme::Palette;
use crate::text::{
    Lengths, grouped, is_too_large, trimmed, typed_count, typed_length, typed_number,
};

/// What a field is called and which values it takes.
#[derive(Debug, Clone)]
pub struct Takes<'a> {
    name: &'a str,
    kind: Kind,
    range: RangeInclusive<f64>,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Number(&'static str),
    Length(Lengths),
    Count,
}

impl<'a> Takes<'a> {
    /// A number with its unit, as people type it: `12,5`, `-3 °`.
    pub fn number(name: &'a str, unit: &'static str, range: RangeInclusive<f64>) -> Self {
        let kind = Kind::Number(unit);
        Self { name, kind, range }
    }

    /// A length of the window, which may be typed in another unit: `0.5 in`.
    pub fn length(name: &'a str, lengths: Lengths, range: RangeInclusive<f64>) -> Self {
        let kind = Kind::Length(lengths);
        Self { name, kind, range }
    }

    /// A whole number: `2,000`, `2k`.
    pub fn count(name: &'a str, range: RangeInclusive<usize>) -> Self {
        Self {
            name,
            kind: Kind::Count,
            range: *range.start() as f64..=*range.end() as f64,
        }
    }

    /// The field of a value, which a drag keeps within the range too.
    pub fn field<'v, N: Numeric>(&self, value: &'v mut N) -> DragValue<'v> {
        self.bare_field(value).suffix(self.suffix())
    }

    /// The same without the unit, which a second suffix would only follow.
    pub fn bare_field<'v, N: Numeric>(&self, value: &'v mut N) -> DragValue<'v> {
        let (least, most) = (*self.range.start(), *self.range.end());
        let range = N::from_f64(least)..=N::from_f64(most);
        // What is there already stays until the user changes it.
        DragValue::new(value)
            .range(range)
            .clamp_existing_to_range(false)
    }

    /// The value that a text says, or why it says none.
    pub fn read(&self, text: &str) -> Result<f64, String> {
        let (value, what) = match self.kind {
            Kind::Number(unit) => (typed_number(text, unit), "number"),
            Kind::Length(lengths) => (typed_length(text, lengths), "length"),
            Kind::Count => (typed_count(text).map(|n| n as f64), "whole number"),
        };
        match value {
            Some(value) if self.range.contains(&value) => Ok(value),
            Some(_) => Err(self.range_sentence()),
            None if text.trim().is_empty() => Err(format!("Enter a {what}.")),
            None if is_too_large(text) => Err(format!("“{}” is too large.", text.trim())),
            // Of whole numbers below zero the range says more.
            None if typed_number(text, "").is_some_and(|n| n < 0.0) => Err(self.range_sentence()),
            None => Err(format!("“{}” is not a {what}.", text.trim())),
        }
    }

    fn range_sentence(&self) -> String {
        format!("{}: {}.", self.name, self.range_words())
    }

    fn suffix(&self) -> &'static str {
        match self.kind {
            Kind::Number(unit) => unit,
            Kind::Length(lengths) => lengths.suffix(),
            Kind::Count => "",
        }
    }

    /// `1 to 60°`, `0 mm or more`, `above 0 mm`.
    fn range_words(&self) -> String {
        let (least, most) = (*self.range.start(), *self.range.end());
        let unit = self.suffix();
        let is_above = least == f64::MIN_POSITIVE;
        // Such an end of factors and lengths only keeps out numbers without a meaning.
        let is_length_or_factor = is_above || matches!(self.kind, Kind::Length(_));
        let is_open = most == f64::MAX || is_length_or_factor && most >= 1e9;
        match (is_above, is_open) {
            (true, true) => format!("above 0{unit}"),
            (false, true) => format!("{}{unit} or more", bound(least)),
            (true, false) => format!("above 0, up to {}{unit}", bound(most)),
            (false, false) => format!("{} to {}{unit}", bound(least), bound(most)),
        }
    }
}

/// An end of a range.
fn bound(value: f64) -> String {
    if value >= 1000.0 && value.fract() == 0.0 {
        grouped(value as usize)
    } else {
        trimmed(value, 9)
    }
}

/// Why a text was refused, and the value that the field had then.
#[derive(Debug, Clone, PartialEq)]
struct Refused {
    why: String,
    at: f64,
    /// How often fields had taken a value by then.
    n_taken: u64,
}

/// Where the number of the frame is kept in which a field was left by Escape.
fn left_id(field: egui::Id) -> egui::Id {
    field.with("left by Escape")
}

/// Whether the field of this id was just left by Escape, so that what was typed is no value: the keyboard is told as
/// lost for two frames, Escape in the first of them alone.
fn is_abandoned(ui: &Ui, field: egui::Id) -> bool {
    let left_at: Option<u64> = ui.data(|data| data.get_temp(left_id(field)));
    left_at.is_some_and(|at| ui.ctx().cumulative_pass_nr() <= at + 2)
}

/// Adds a field of a value that is read when it is left: a text that `read` refuses changes nothing. Why it was refused
/// is said below the framed field, over what stands there, until the pointer or Escape is pressed, the field is edited
/// again, it or another field takes a value, or the value changes: the value that is shown then is a right one.
pub fn told_field(
    ui: &mut Ui,
    name: &str,
    value: f64,
    field: DragValue<'_>,
    read: impl Fn(&str) -> Result<f64, String>,
) -> Response {
    let refused: RefCell<Option<Option<String>>> = RefCell::default();
    let is_abandoned = is_abandoned(ui, ui.next_auto_id());
    let read = |text: &str| {
        if is_abandoned {
            return None;
        }
        let value = read(text);
        refused.replace(Some(value.as_ref().err().cloned()));
        value.ok()
    };
    let field = field.update_while_editing(false).custom_parser(read);
    // A field with a unit is named after the unit otherwise.
    let response = ui.add(field).accessible_name(name);
    if response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
        let now = ui.ctx().cumulative_pass_nr();
        ui.data_mut(|data| data.insert_temp(left_id(response.id), now));
    }
    let id = refused_id(&response);
    let known: Option<Refused> = ui.data(|data| data.get_temp(id)).flatten();
    let is_pressed = ui.input(|input| input.pointer.any_pressed());
    let n_taken = n_taken(ui, response.changed());
    let is_over = response.has_focus()
        || response.changed()
        || is_pressed
        || ui.input(|input| input.key_pressed(egui::Key::Escape))
        || known
            .as_ref()
            .is_some_and(|known| known.at != value || known.n_taken != n_taken);
    let now = match refused.take() {
        Some(why) => why.map(|why| Refused {
            why,
            at: value,
            n_taken,
        }),
        None if is_over => None,
        None => known.clone(),
    };
    if now != known {
        ui.data_mut(|data| data.insert_temp(id, now.clone()));
    }
    let Some(now) = now else {
        return response;
    };
    let frame = Stroke::new(1.5, Palette::of(ui).poor);
    let inside = egui::StrokeKind::Inside;
    ui.painter().rect_stroke(response.rect, 4.0, frame, inside);
    tell(ui, &response, now.why);
    response
}

/// How often fields have taken a value, with one that does so now.
fn n_taken(ui: &Ui, is_taken: bool) -> u64 {
    let id = egui::Id::unique("values taken by fields");
    ui.data_mut(|data| {
        let n_taken: &mut u64 = data.get_temp_mut_or_default(id);
        *n_taken += u64::from(is_taken);
        *n_taken
    })
}

fn refused_id(field: &Response) -> egui::Id {
    field.id.with("refused")
}

/// Whether the text that was typed last into a [`told_field`] was refused.
pub fn is_refused(ui: &Ui, field: &Response) -> bool {
    let known: Option<Refused> = ui.data(|data| data.get_temp(refused_id(field))).flatten();
    known.is_some()
}

/// Widest reason below a field.
const WIDEST: f32 = 280.0;

/// Why a text was refused, below its field. It takes no room, so that nothing moves, and no clicks.
fn tell(ui: &Ui, field: &Response, why: String) {
    if !ui.clip_rect().intersects(field.rect) {
        return;
    }
    egui::Area::new(refused_id(field))
        .order(egui::Order::Tooltip)
        .fixed_pos(field.rect.left_bottom() + vec2(0.0, 2.0))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(egui::Margin::symmetric(6, 3))
                .show(ui, |ui| {
                    ui.set_max_width(WIDEST);
                    refusal(ui, Some(why));
                });
        });
}

/// Why something was refused.
pub fn refusal(ui: &mut Ui, why: Option<String>) {
    if let Some(why) = why {
        let text = RichText::new(why).small().color(Palette::of(ui).poor);
        let label = ui.add(egui::Label::new(text).wrap());
        ui.ctx().accesskit_node_builder(label.id, |node| {
            node.set_live(egui::accesskit::Live::Polite);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::LengthUnit;

    #[test]
    fn what_a_field_does_not_take_is_told_with_what_it_takes() {
        let mm = Lengths::new(Some(LengthUnit::Millimeter));
        let angle = Takes::number("Rotation step", "°", 1.0..=60.0);
        let reach = Takes::length("Largest distance", mm, f64::MIN_POSITIVE..=f64::MAX);
        let floor = Takes::length("Floor", mm, 0.0..=f64::MAX);
        let points = Takes::count("Coarse points", 1..=1_000_000_000);
        let shift = Takes::number("Move", "", -0.5..=0.5);
        for (takes, text, read) in [
            (&angle, "12,5 °", Ok(12.5)),
            (&angle, "0", Err("Rotation step: 1 to 60°.")),
            (&angle, "steep", Err("“steep” is not a number.")),
            (&angle, " ", Err("Enter a number.")),
            (&reach, "0", Err("Largest distance: above 0 mm.")),
            (&floor, "0,2 cm", Ok(2.0)),
            (&floor, "-1", Err("Floor: 0 mm or more.")),
            (&floor, "1 kg", Err("“1 kg” is not a length.")),
            (&points, "0", Err("Coarse points: 1 to 1,000,000,000.")),
            (&points, "1.5", Err("“1.5” is not a whole number.")),
            (&points, "-5", Err("Coarse points: 1 to 1,000,000,000.")),
            (&angle, "1e999", Err("“1e999” is too large.")),
            (&points, "1e30", Err("“1e30” is too large.")),
            (&shift, "2", Err("Move: −0.5 to 0.5.")),
        ] {
            assert_eq!(takes.read(text), read.map_err(str::to_owned), "{text}");
        }
    }
}
