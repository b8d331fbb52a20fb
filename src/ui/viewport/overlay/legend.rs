//! The colours of a field with their numbers.

use egui::{
    Align2, Color32, ColorImage, CornerRadius, FontId, Pos2, Rect, Stroke, TextureOptions, Ui, vec2,
};

use super::{MARGIN, Overlay};
use crate::colormap::ColorScale;

/// Colours of the bar.
const STEPS: usize = 64;
/// Size of the bar.
const WIDTH: f32 = 12.0;
const HEIGHT: f32 = 150.0;

/// The bar on the right edge, with a title and ticks.
pub(super) fn show(ui: &Ui, over: &Overlay<'_>) {
    let Some((title, scale)) = &over.scale else {
        return;
    };
    if over.rect.height() < HEIGHT + 150.0 {
        return;
    }
    let painter = over.painter(ui);
    let small = FontId::proportional(11.0);
    let title = painter.layout_no_wrap((*title).to_owned(), small.clone(), over.look.text);
    let ticks = scale.ticks(6);
    let texts: Vec<String> = ticks.iter().map(|tick| tick_text(*tick, &ticks)).collect();
    let widest = texts.iter().map(|t| t.len()).max().unwrap_or(1) as f32 * 6.2;
    let width = title.size().x.max(WIDTH + 10.0 + widest) + 16.0;
    let corner = Pos2::new(over.rect.right() - MARGIN - width, over.rect.top() + 48.0);
    let plate = Rect::from_min_size(corner, vec2(width, HEIGHT + 38.0));
    painter.rect_filled(plate, CornerRadius::same(6), over.look.plate);
    painter.galley(corner + vec2(8.0, 5.0), title, over.look.text);
    let bar = Rect::from_min_size(corner + vec2(8.0, 26.0), vec2(WIDTH, HEIGHT));
    fill(ui, over, scale, bar);
    for (tick, text) in ticks.iter().zip(texts) {
        let y = bar.bottom() - scale.position(*tick) as f32 * bar.height();
        let from = Pos2::new(bar.right(), y);
        painter.line_segment(
            [from, from + vec2(4.0, 0.0)],
            Stroke::new(1.0, over.look.weak),
        );
        let at = from + vec2(7.0, 0.0);
        painter.text(at, Align2::LEFT_CENTER, text, small.clone(), over.look.text);
    }
}

/// Low values at the foot.
fn fill(ui: &Ui, over: &Overlay<'_>, scale: &ColorScale, bar: Rect) {
    let painter = over.painter(ui);
    let colors = scale.table(STEPS).into_iter().rev();
    let pixels = colors.map(|[r, g, b]| Color32::from_rgb(r, g, b)).collect();
    // The texture lives as long as the data of the window; egui frees the old one when it changes.
    let id = ui.make_persistent_id(("legend", over.role().word()));
    let known: Option<(ColorScale, egui::TextureHandle)> = ui.data(|data| data.get_temp(id));
    let texture = match known.filter(|(of, _)| of == scale) {
        Some((_, texture)) => texture,
        None => {
            let image = ColorImage::new([1, STEPS], pixels);
            let texture = ui
                .ctx()
                .load_texture("legend", image, TextureOptions::LINEAR);
            ui.data_mut(|data| data.insert_temp(id, (*scale, texture.clone())));
            texture
        }
    };
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture.id(), bar, whole, Color32::WHITE);
    let stroke = Stroke::new(1.0, over.look.plate_line);
    painter.rect_stroke(bar, 0.0, stroke, egui::StrokeKind::Outside);
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
        text
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
