//! Coordinates along the axes of a chart, as many as have room.

use std::rc::Rc;

use egui::{Color32, Ui};
use egui_plot::{GridMark, Plot};

use crate::text::tick_number;

/// Least way between two numbers along the axis across, at which a chart no longer fades them, and the air
/// between them.
const APART: f64 = 80.0;
const AIR: f64 = 12.0;

/// A chart, so wide without its upright axis, with coordinates and their unit along both axes. Along one of sign −1
/// they fall.
pub(super) fn with_coordinates<'a>(
    ui: &Ui,
    plot: Plot<'a>,
    (width, unit): (f32, &'static str),
    [across, up]: [f64; 2],
) -> Plot<'a> {
    // Zero has no sign.
    let signed = move |sign: f64, value: f64, step| tick_text(sign * value + 0.0, step) + unit;
    let text = move |value, step| signed(across, value, step);
    let painter = ui.painter().clone();
    let font = egui::TextStyle::Body.resolve(ui.style());
    let numbers = Rc::new(Across {
        pixels: f64::from(width),
        width_of: move |value, step| {
            let galley = painter.layout_no_wrap(text(value, step), font.clone(), Color32::WHITE);
            f64::from(galley.size().x)
        },
    });
    let numbered = Rc::clone(&numbers);
    plot.x_grid_spacer(move |input| {
        let bounds = input.bounds;
        numbered.widened(egui_plot::log_grid_spacer(10)(input), bounds)
    })
    .x_axis_formatter(move |mark, range| {
        let has_number = numbers.has_number(mark.value, (*range.start(), *range.end()));
        let text = has_number.then(|| text(mark.value, mark.step_size));
        text.unwrap_or_default()
    })
    .y_axis_formatter(move |mark, _| signed(up, mark.value, mark.step_size))
}

/// The numbers along the axis across: as near to each other as they have room, whole at both ends.
struct Across<F> {
    /// Width of the chart.
    pixels: f64,
    /// Width of the number at a place, with the digits of a step.
    width_of: F,
}

impl<F: Fn(f64, f64) -> f64> Across<F> {
    /// The finest of 1, 2 and 5 with zeros at which no two numbers meet.
    fn step(&self, (from, to): (f64, f64)) -> f64 {
        let per_pixel = (to - from) / self.pixels.max(1.0);
        if !(per_pixel > 0.0 && per_pixel.is_finite()) {
            return f64::INFINITY;
        }
        let first = (APART * per_pixel).log10().floor() as i32;
        let steps = (first..).flat_map(|n| [1.0, 2.0, 5.0].map(|factor| factor * 10_f64.powi(n)));
        let has_room = |step: &f64| {
            let widest = (self.width_of)(from, *step).max((self.width_of)(to, *step));
            *step >= (widest + AIR).max(APART) * per_pixel
        };
        steps.take(9).find(has_room).unwrap_or(f64::INFINITY)
    }

    /// Whether the line at `value` has a number, which at an end would be cut.
    fn has_number(&self, value: f64, bounds: (f64, f64)) -> bool {
        let step = self.step(bounds);
        let half = 0.5 * (self.width_of)(value, step) * (bounds.1 - bounds.0) / self.pixels;
        is_multiple(value, step) && value + half <= bounds.1
    }

    /// Lines that have a number count as far apart as numbers are: a chart leaves out numbers of near lines.
    fn widened(&self, mut lines: Vec<GridMark>, bounds: (f64, f64)) -> Vec<GridMark> {
        let step = self.step(bounds);
        for line in lines
            .iter_mut()
            .filter(|line| is_multiple(line.value, step))
        {
            line.step_size = line.step_size.max(step);
        }
        lines
    }
}

fn is_multiple(value: f64, step: f64) -> bool {
    let n = value / step;
    step.is_finite() && (n - n.round()).abs() < 0.01
}

/// A coordinate with the digits of its grid.
fn tick_text(value: f64, step: f64) -> String {
    let digits = (-step.abs().max(1e-12).log10()).ceil().clamp(0.0, 6.0) as usize;
    tick_number(value, digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines that have a number, with the step of the numbers.
    fn shown(unit: f64, pixels: f64, from: f64) -> (Vec<GridMark>, f64) {
        let numbers = Across {
            pixels,
            width_of: text_width,
        };
        let bounds = (from, from + unit * pixels);
        let lines = egui_plot::log_grid_spacer(10)(egui_plot::GridInput {
            bounds,
            base_step_size: 8.0 * unit,
        });
        let mut lines = numbers.widened(lines, bounds);
        lines.retain(|line| numbers.has_number(line.value, bounds));
        (lines, numbers.step(bounds))
    }

    fn text_width(value: f64, step: f64) -> f64 {
        7.5 * (tick_text(value, step).chars().count() + 3) as f64
    }

    #[test]
    fn numbers_across_have_room_and_are_several() {
        // Lines every 10 mm lie nearer than the width of their numbers.
        let values = shown(0.175, 417.0, 3448.0).0.into_iter();
        let values: Vec<f64> = values.map(|line| line.value).collect();
        assert_eq!(values, [3460.0, 3480.0, 3500.0]);
        for unit in [1e-4, 0.07, 1.0, 3.3, 42.0, 1234.5] {
            for pixels in [240.0, 417.0, 900.0] {
                for from in [-6e4, 3448.0, 0.0] {
                    let (lines, step) = shown(unit, pixels, from);
                    let case = format!("{unit} from {from} on {pixels}: {lines:?}");
                    // One may be cut at the end.
                    let room = (pixels * unit / step) as usize;
                    assert!(lines.len() + 1 >= room, "{case}");
                    for line in &lines {
                        let text = text_width(line.value, line.step_size);
                        assert!(line.step_size >= text * unit, "{case}");
                    }
                    for pair in lines.windows(2) {
                        assert!(pair[1].value - pair[0].value > 0.99 * step, "{case}");
                    }
                }
            }
        }
    }
}
