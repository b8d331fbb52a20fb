//! What stands at the right end of a row. A layout from right to left would have the keyboard go backwards through
//! it, because Tab takes widgets in the order in which they are added.

use std::fmt::Debug;
use std::hash::Hash;

use egui::{Align, Id, Layout, Rect, Ui, UiBuilder, Vec2};

/// A change of the width by less is rounding.
const ROUNDING: f32 = 0.5;

/// The right end of a row: as wide as it was when it was drawn last.
pub struct RowEnd {
    id: Id,
    width: Option<f32>,
}

impl RowEnd {
    /// `name` tells it from others of the same surroundings.
    pub fn new(ui: &Ui, name: impl Hash + Debug) -> Self {
        let id = ui.scope_id().with(("row end", name));
        let width = ui.data(|data| data.get_temp(id));
        Self { id, width }
    }

    /// Adds from left to right what has the rest of the row.
    pub fn before<R>(&self, ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
        let taken = self.width.unwrap_or_default() + ui.spacing().item_spacing.x;
        let rest = Vec2::new(
            (ui.available_width() - taken).max(0.0),
            ui.available_height(),
        );
        let layout = Layout::left_to_right(Align::Center);
        ui.allocate_ui_with_layout(rest, layout, |ui| {
            ui.set_max_width(rest.x);
            add(ui)
        })
        .inner
    }

    /// Adds from left to right what ends at the right edge.
    pub fn show<R>(self, ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> R {
        let room = ui.available_rect_before_wrap();
        let left = room.right() - self.width.unwrap_or_default().min(room.width());
        let place = Rect::from_x_y_ranges(left..=room.right(), room.y_range());
        let layout = Layout::left_to_right(Align::Center);
        let shown = ui.scope_builder(UiBuilder::new().max_rect(place).layout(layout), add);
        let used = shown.response.rect.width();
        let is_as_wide = |width: f32| (used - width).abs() < ROUNDING;
        if !self.width.is_some_and(is_as_wide) {
            ui.data_mut(|data| data.insert_temp(self.id, used));
            // Before anyone sees it beside its place.
            ui.ctx()
                .request_discard("the end of a row has another width");
        }
        shown.inner
    }
}

#[cfg(test)]
mod tests {
    use egui::{Button, Context, RawInput, pos2, vec2};

    use super::*;

    /// Draws a row and returns the places of its widgets, in the order in which Tab takes them.
    fn row(ctx: &Context, names: [&str; 2]) -> Vec<Rect> {
        let screen = Rect::from_min_size(pos2(0.0, 0.0), vec2(300.0, 100.0));
        let input = RawInput {
            screen_rect: Some(screen),
            ..RawInput::default()
        };
        let mut places = Vec::new();
        let mut output = ctx.run_ui(input, |ui| {
            places.clear();
            ui.horizontal(|ui| {
                let end = RowEnd::new(ui, "test");
                let rest = end.before(ui, |ui| {
                    let size = vec2(ui.available_width(), 18.0);
                    ui.add_sized(size, Button::new("rest")).rect
                });
                places.push(rest);
                end.show(ui, |ui| {
                    places.extend(names.map(|name| ui.button(name).rect));
                });
            });
        });
        output.textures_delta.clear();
        places
    }

    #[test]
    fn the_end_of_a_row_is_added_from_left_to_right_and_ends_at_the_edge() {
        let ctx = Context::default();
        let wide = row(&ctx, ["one", "two"]);
        // Another width is known in the same frame.
        let narrow = row(&ctx, ["1", "2"]);
        for places in [&wide, &narrow] {
            let [rest, first, last] = places[..] else {
                panic!("{places:?}");
            };
            assert!(
                rest.right() < first.left() && first.right() < last.left(),
                "{places:?}"
            );
            assert!(first.left() - rest.right() < 12.0, "{places:?}");
        }
        assert!(
            (wide[2].right() - narrow[2].right()).abs() < 1.0,
            "{wide:?} {narrow:?}"
        );
        assert!(narrow[0].width() > wide[0].width() + 10.0);
    }
}
