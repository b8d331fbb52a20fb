//! Charts that stand still, and those with logarithmic axes.

use std::ops::RangeInclusive;

use egui::{Ui, Vec2};
use egui_plot::{GridInput, GridMark, Line, Plot, PlotPoints};

use crate::text::{tick_number, trimmed};
use crate::ui::theme::Palette;

/// A chart that shows and does not move: no zoom, no drag, quiet grid.
pub fn still_chart(ui: &Ui, name: &str, size: Vec2) -> Plot<'static> {
    Plot::new(name)
        .width(size.x)
        .height(size.y)
        .show_background(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .x_axis_formatter(|mark, _| mark_text(mark))
        .y_axis_formatter(|mark, _| mark_text(mark))
        .grid_color(Palette::of(ui).line)
}

/// A line through its points as they are. The library would join those less than a pixel apart to one as thick as they
/// are high, which makes a ramp of a step.
pub fn exact_line<'a>(name: &str, points: impl Into<PlotPoints<'a>>) -> Line<'a> {
    Line::new(name, points).allow_band(false)
}

/// The number at a mark, with the decimals of its step.
fn mark_text(mark: GridMark) -> String {
    let decimals = -mark.step_size.abs().max(1e-12).log10().floor();
    tick_number(mark.value, decimals.clamp(0.0, 9.0) as usize)
}

/// A still chart of logarithms, with the numbers themselves along the axes.
pub fn log_chart(ui: &Ui, name: &str, size: Vec2) -> Plot<'static> {
    with_log_upright(still_chart(ui, name, size))
        .y_axis_label(name.to_owned())
        .y_axis_min_width(44.0)
        .x_axis_formatter(|mark, range| mark_of_decades(mark.value, range))
        .x_grid_spacer(|input| decades(&input, ACROSS))
}

/// Pixels between two lines of the finest grid that the library draws.
const GRID: f64 = 8.0;
/// Least pixels between two numbers upright and across.
const UPRIGHT: f64 = 13.0;
const ACROSS: f64 = 36.0;
const DIGITS: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];

/// The number whose logarithm this is: 0.01, 3, 20k. Two digits count.
pub fn decade_text(log: f64) -> String {
    log_text(log, 2)
}

/// The number at a mark of [`decades`], with the digits that tell it from the next one.
fn mark_of_decades(log: f64, bounds: &RangeInclusive<f64>) -> String {
    let width = (bounds.end() - bounds.start()).max(1e-9);
    log_text(log, (1.5 - width.log10()).ceil().clamp(2.0, 8.0) as i32)
}

fn log_text(log: f64, n_digits: i32) -> String {
    let value = 10_f64.powf(log);
    let (value, unit) = if value >= 999.0 {
        (value / 1000.0, "k")
    } else {
        (value, "")
    };
    // Rounded up, 9.96 has its last digit before the point.
    let first = (value.log10() + 0.0022).floor() as i32;
    let decimals = (n_digits - 1 - first).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    format!("{text}{unit}")
}

/// A chart of logarithms upright, with the numbers themselves along the axis.
pub fn with_log_upright(plot: Plot<'_>) -> Plot<'_> {
    plot.y_axis_formatter(|mark, range| mark_of_decades(mark.value, range))
        .y_grid_spacer(|input| decades(&input, UPRIGHT))
}

/// A chart of shares upright, with two to five round ones along the axis, but at most `most`.
pub fn with_round_shares(plot: Plot<'_>, most: usize) -> Plot<'_> {
    plot.y_axis_formatter(|mark, _| share_text(mark.value))
        .y_grid_spacer(move |input| {
            let mut ticks = round_shares(input.bounds);
            if ticks.len() > most {
                // The ends say most.
                ticks.drain(1..ticks.len() - 1);
            }
            let ticks = ticks.into_iter();
            // A mark is labelled when its step is wide on the screen.
            let step_size = input.bounds.1 - input.bounds.0;
            ticks.map(|value| GridMark { value, step_size }).collect()
        })
}

/// Multiples of the coarsest round step of which there are two.
fn round_shares((low, high): (f64, f64)) -> Vec<f64> {
    let steps = (0..6).flat_map(|n| [1.0, 0.5, 0.2].map(|factor| factor * 0.1_f64.powi(n)));
    let among = |step: f64| {
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        (first..=last)
            .map(|n| n as f64 * step)
            .collect::<Vec<f64>>()
    };
    let mut ticks = steps.map(among);
    ticks.find(|ticks| ticks.len() >= 2).unwrap_or_default()
}

/// Grid of a logarithmic axis whose numbers are at least so many pixels apart.
fn decades(input: &GridInput, apart: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let has_way = high > low && (high - low).is_finite() && input.base_step_size > 0.0;
    if !has_way {
        return Vec::new();
    }
    let per_pixel = input.base_step_size / GRID;
    let ticks = log_ticks((low, high), apart * per_pixel).into_iter();
    // A mark is labelled when its step is wide on the screen.
    let step_size = high - low;
    ticks.map(|value| GridMark { value, step_size }).collect()
}

/// The logarithms of at least two round numbers that have room at this least distance: 2 and 5 between the decades
/// where they have, else decades or some of them; every digit, or finer, where less than one decade is seen.
fn log_ticks((low, high): (f64, f64), least: f64) -> Vec<f64> {
    let is_seen = |value: &f64| (low..=high).contains(value);
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let marks = |factors: &[f64]| -> Vec<f64> {
        let all = (first..=last)
            .flat_map(|decade| factors.iter().map(move |f| f64::from(decade) + f.log10()));
        all.filter(is_seen).collect()
    };
    // Those with room for all of them, else the ends.
    let apart = |ticks: Vec<f64>| match ticks[..] {
        [first, .., last] if ticks.windows(2).any(|pair| pair[1] - pair[0] < least) => {
            vec![first, last]
        }
        _ => ticks,
    };
    let n_decades = least.ceil().max(1.0) as i32;
    let ticks = if least <= 2_f64.log10() {
        marks(&[1.0, 2.0, 5.0])
    } else {
        let mut ticks = marks(&[1.0]);
        ticks.retain(|value| (value.round() as i32) % n_decades == 0);
        ticks
    };
    if ticks.len() >= 2 {
        return ticks;
    }
    for ticks in [marks(&[1.0]), marks(&[1.0, 2.0, 5.0]), marks(&DIGITS)] {
        if ticks.len() >= 2 {
            return apart(ticks);
        }
    }
    let values = (10_f64.powf(low), 10_f64.powf(high));
    let fine = round_ticks(values, 3).0.into_iter();
    apart(fine.map(f64::log10).filter(is_seen).collect())
}

/// Share of a narrow chart at either end where a number would reach beyond it, and least share between two.
const END: f64 = 0.2;
const APART: f64 = 0.45;
/// Pixels that a digit takes along a chart, and the air between two numbers.
const DIGIT: f64 = 7.2;
const AIR: f64 = 4.0;

/// Two round numbers along a chart of so many pixels that do not meet, none near its ends, with the decimals that
/// they need; a single one where two have no room.
fn inner_ticks((low, high): (f64, f64), pixels: f64) -> (Vec<f64>, usize) {
    let width = high - low;
    if !(width > 0.0 && width.is_finite()) {
        return (Vec::new(), 0);
    }
    let (first, last) = (low + END * width, high - END * width);
    let mut single = None;
    let mut decade = 10_f64.powf(width.log10().ceil());
    while decade > 1e-3 * width {
        for factor in [1.0, 0.5, 0.2] {
            let step = factor * decade;
            let ends = [(first / step).ceil() * step, (last / step).floor() * step];
            let n_decimals = (-step.log10() + 1e-9).ceil().clamp(0.0, 9.0) as usize;
            let letters = ends.map(|end| tick_number(end, n_decimals).chars().count());
            let room = DIGIT * letters[0].max(letters[1]) as f64 + AIR;
            if ends[1] >= ends[0] {
                single.get_or_insert((vec![ends[0]], n_decimals));
            }
            if (ends[1] - ends[0]) / width * pixels > room.max(APART * pixels) {
                return (ends.to_vec(), n_decimals);
            }
        }
        decade /= 10.0;
    }
    single.unwrap_or_default()
}

/// A narrow chart, of this width without its axis, with numbers along its values that neither meet nor reach
/// beyond it.
pub fn with_inner_numbers(plot: Plot<'_>, width: f32) -> Plot<'_> {
    let pixels = f64::from(width);
    plot.x_grid_spacer(move |input| inner_marks(input.bounds, pixels))
        .x_axis_formatter(move |mark, range| {
            inner_text(mark.value, (*range.start(), *range.end()), pixels)
        })
}

/// Room for a number along a chart with the air beside it.
const NUMBER: f32 = 54.0;

/// At most `most` round numbers along a chart, at least four of them where so many have room; none so near an
/// end that it reaches beyond the chart. With the step between them.
fn round_ticks((low, high): (f64, f64), most: usize) -> (Vec<f64>, f64) {
    let width = high - low;
    if !(width > 0.0 && width.is_finite()) {
        return (Vec::new(), 1.0);
    }
    // Half a number reaches to either side of its place.
    let margin = (0.5 / most.max(2) as f64).min(0.1) * width;
    let (low, high) = (low + margin, high - margin);
    let among = |step: f64| {
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        (first..=last)
            .map(|n| n as f64 * step)
            .collect::<Vec<f64>>()
    };
    let decade = 10_f64.powf(width.log10().floor() - 1.0);
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0, 20.0, 50.0].map(|factor| factor * decade);
    // The coarsest step that gives four, else the finest that has room.
    let fitting = || steps.iter().map(|step| (among(*step), *step));
    let mut fitting: Vec<_> = fitting().filter(|(ticks, _)| ticks.len() <= most).collect();
    let enough = fitting.iter().rposition(|(ticks, _)| ticks.len() >= 4);
    if fitting.is_empty() {
        return (Vec::new(), 1.0);
    }
    fitting.swap_remove(enough.unwrap_or(0))
}

/// A chart of this width with at least four numbers along its values, fewer where they have no room.
pub fn with_round_numbers(plot: Plot<'_>, width: f32) -> Plot<'_> {
    let most = ((width / NUMBER) as usize).clamp(2, 8);
    plot.x_grid_spacer(move |input| {
        let ticks = round_ticks(input.bounds, most).0.into_iter();
        // A mark is labelled when its step is wide on the screen.
        let step_size = input.bounds.1 - input.bounds.0;
        ticks.map(|value| GridMark { value, step_size }).collect()
    })
    .x_axis_formatter(move |mark, range| {
        let (_, step) = round_ticks((*range.start(), *range.end()), most);
        trimmed(
            mark.value,
            (2.0 - step.log10()).ceil().clamp(0.0, 9.0) as usize,
        )
    })
}

/// A low chart of shares with two numbers upright: nothing, and a round one below the top.
pub fn with_two_shares(plot: Plot<'_>) -> Plot<'_> {
    plot.y_grid_spacer(|input| {
        let high = input.bounds.1;
        let marks = std::iter::once(0.0).chain(round_below(high));
        // A mark is labelled when its step is wide on the screen.
        marks
            .map(|value| GridMark {
                value,
                step_size: high,
            })
            .collect()
    })
    .y_axis_formatter(|mark, _| share_text(mark.value))
}

/// The largest of 1, 2 and 5 with zeros that leaves a tenth of the way to `high` free; `None` without a way.
fn round_below(high: f64) -> Option<f64> {
    let limit = 0.9 * high;
    let decade = 10_f64.powf(limit.log10().floor());
    let factors = [5.0, 2.0, 1.0].into_iter();
    let mut marks = factors.map(|factor| factor * decade);
    marks.find(|mark| *mark > 0.0 && *mark <= limit)
}

/// A share with the digits that a round one needs.
fn share_text(share: f64) -> String {
    format!("{}\u{a0}%", trimmed(100.0 * share, 6))
}

/// Grid of a narrow chart that has its numbers inside.
fn inner_marks(bounds: (f64, f64), pixels: f64) -> Vec<GridMark> {
    // A mark is labelled when its step is wide on the screen.
    let step_size = bounds.1 - bounds.0;
    let marks = inner_ticks(bounds, pixels).0.into_iter();
    marks.map(|value| GridMark { value, step_size }).collect()
}

/// The number at a mark of [`inner_marks`], with the digits that its step needs.
fn inner_text(value: f64, bounds: (f64, f64), pixels: f64) -> String {
    tick_number(value, inner_ticks(bounds, pixels).1)
}

/// The range of some values with a margin, for an axis that must not touch its curves.
pub fn range(values: impl Iterator<Item = f64>) -> Option<RangeInclusive<f64>> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let margin = 0.06 * (high - low).max(0.5);
    (low <= high).then_some(low - margin..=high + margin)
}

/// The ends of some values with a margin of a tenth, or of their size where they are all the same.
pub fn margined(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let size = low.abs().max(high.abs());
    let margin = (0.1 * (high - low)).max(0.05 * size).max(1e-9);
    (low <= high).then_some([low - margin, high + margin])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_keep_equal_values_apart_from_the_edge() {
        assert_eq!(margined([1.0, 3.0].into_iter()), Some([0.8, 3.2]));
        let [low, high] = margined([2.0, f64::NAN, 2.0].into_iter()).unwrap();
        assert!(low < 2.0 && high > 2.0);
        assert_eq!(margined([f64::NAN].into_iter()), None);
    }

    #[test]
    fn a_step_is_drawn_as_one() {
        let points = || vec![[0.0, 1.0], [0.02, 1.0], [0.02, 0.0], [1.0, 0.0]];
        let n_bands = |line: fn(Vec<[f64; 2]>) -> Line<'static>| {
            let output = egui::Context::default().run_ui(egui::RawInput::default(), |ui| {
                still_chart(ui, "steps", egui::vec2(200.0, 80.0))
                    .show(ui, |plot| plot.line(line(points())));
            });
            let shapes = output.shapes.iter();
            let is_band = |shape: &egui::Shape| match shape {
                egui::Shape::Vec(inner) => {
                    let is_band = |shape: &egui::Shape| matches!(shape, egui::Shape::Band(_));
                    inner.iter().any(is_band)
                }
                shape => matches!(shape, egui::Shape::Band(_)),
            };
            let n_bands = shapes.filter(|clipped| is_band(&clipped.shape)).count();
            output.drop_without_applying_deltas();
            n_bands
        };
        assert_eq!(n_bands(|points| exact_line("steps", points)), 0);
        assert_eq!(n_bands(|points| Line::new("steps", points)), 1);
    }

    #[test]
    fn shares_upright_have_two_to_five_round_numbers() {
        assert_eq!(round_shares((-0.05, 1.05)), [0.0, 1.0]);
        assert_eq!(round_shares((0.19, 1.0)), [0.5, 1.0]);
        for (low, high) in [(0.91, 0.985), (0.99, 0.9999), (0.4, 0.41)] {
            let ticks = round_shares((low, high));
            assert!((2..=5).contains(&ticks.len()), "{low} {high}: {ticks:?}");
        }
    }

    #[test]
    fn a_narrow_chart_has_numbers_inside_that_do_not_meet() {
        for (low, high, n) in [
            (0.0, 1.0, 2),
            (0.7085, 0.7915, 2),
            (-312.0, 420.0, 2),
            (3.0, 3.37, 2),
            (0.0408, 0.0473, 2),
            (0.041_002, 0.041_061, 1),
            (-1e-7, 1e-7, 1),
        ] {
            let bounds = (low, high);
            let marks = inner_marks(bounds, 87.0);
            let texts = marks.iter().map(|m| inner_text(m.value, bounds, 87.0));
            let texts: Vec<String> = texts.collect();
            assert_eq!(marks.len(), n, "{bounds:?} {texts:?}");
            assert!(marks.iter().all(|m| low < m.value && m.value < high));
            if let [a, b] = &marks[..] {
                let between = 87.0 * (b.value - a.value) / (high - low);
                let letters = texts.iter().map(|text| text.chars().count()).max();
                assert!(between > DIGIT * letters.unwrap() as f64, "{texts:?}");
            }
        }
        assert!(inner_marks((1.0, 1.0), 87.0).is_empty());
    }

    #[test]
    fn a_chart_of_values_has_four_round_numbers_where_they_have_room() {
        for bounds in [
            (0.0, 1.0),
            (0.7085, 0.7915),
            (-312.0, 420.0),
            (3.0, 3.37),
            (129.0, 238.0),
        ] {
            for most in 2..=8 {
                let (ticks, step) = round_ticks(bounds, most);
                let least = if most >= 6 { 4 } else { 1 };
                let n = ticks.len();
                assert!((least..=most).contains(&n), "{bounds:?}, {most}: {ticks:?}");
                let is_inside = |tick: &f64| bounds.0 < *tick && *tick < bounds.1;
                assert!(ticks.iter().all(is_inside));
                let mut apart = ticks.windows(2).map(|pair| pair[1] - pair[0]);
                assert!(apart.all(|d| (d - step).abs() < 1e-9));
            }
        }
        assert!(round_ticks((1.0, 1.0), 5).0.is_empty());
    }

    #[test]
    fn a_low_chart_names_a_round_share_below_its_top() {
        let read = [0.106, 0.3, 1.0, 0.0021].map(|high| share_text(round_below(high).unwrap()));
        assert_eq!(read, ["5\u{a0}%", "20\u{a0}%", "50\u{a0}%", "0.1\u{a0}%"]);
        assert_eq!(round_below(0.0), None);
    }

    #[test]
    fn a_logarithmic_axis_has_two_numbers_that_have_room_at_least() {
        for (low, high) in [
            (-9.6, 1.8),
            (-2.7, -2.4),
            (-1.2, 2.0),
            (0.31, 0.46),
            (2.0, 2.001),
            (-9.0, -8.0),
        ] {
            for pixels in [50.0, 70.0, 100.0, 400.0] {
                let input = GridInput {
                    bounds: (low, high),
                    base_step_size: GRID * (high - low) / pixels,
                };
                let marks = decades(&input, UPRIGHT);
                let range = low..=high;
                let texts = marks.iter().map(|m| mark_of_decades(m.value, &range));
                let texts: Vec<String> = texts.collect();
                let case = format!("{low} {high} on {pixels}: {texts:?}");
                assert!(marks.len() >= 2, "{case}");
                assert!(marks.iter().all(|m| range.contains(&m.value)), "{case}");
                assert!(texts.windows(2).all(|pair| pair[0] != pair[1]), "{case}");
                // The library leaves out numbers of narrower steps.
                assert!(
                    marks
                        .iter()
                        .all(|m| m.step_size * pixels / (high - low) > 30.0)
                );
                let per = pixels / (high - low);
                let mut apart = marks.windows(2).map(|m| (m[1].value - m[0].value) * per);
                assert!(apart.all(|pixels| pixels > UPRIGHT - 1e-6), "{case}");
            }
        }
    }

    #[test]
    fn axes_are_read_in_numbers() {
        let read = [-2.0, 0.0, 2.0_f64.log10(), 3.0, 4.0, 50_000_f64.log10()].map(decade_text);
        assert_eq!(read, ["0.01", "1", "2", "1k", "10k", "50k"]);
    }

    #[test]
    fn a_range_holds_its_values() {
        let range = range([1.0, 3.0, 2.0].into_iter()).unwrap();
        assert!(*range.start() < 1.0 && *range.end() > 3.0);
        assert!(super::range(std::iter::empty()).is_none());
    }
}
