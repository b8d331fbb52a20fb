//! Charts as inline SVG, drawn with the colours of the page.

use std::cmp::Reverse;
use std::fmt::Write as _;

use maud::{Markup, html};

use crate::assess::deviation::{DeviationStats, Histogram};
use crate::colormap::{ColorMap, ColorScale, Rgb};
use crate::registration::{MatchOutcome, StartOutcome, StartRecord};
use crate::role::PerRole;
use crate::text::{Lengths, counted, percent, trimmed};

/// Width of the charts and of the legend of the colours.
const WIDTH: f64 = 960.0;
const LEGEND_WIDTH: f64 = 520.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 18.0;
/// Bins of the histogram.
const N_BINS: usize = 60;
/// Curves besides that of the best start.
const N_CURVES: usize = 14;
/// Decimals of the numbers on axes.
const DECIMALS: usize = 6;

/// A rectangle of the picture with numbers on its sides.
struct Axes {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    x: [f64; 2],
    y: [f64; 2],
}

/// A coordinate as it is written.
fn px(value: f64) -> String {
    format!("{value:.1}")
}

impl Axes {
    fn x(&self, value: f64) -> f64 {
        let t = (value - self.x[0]) / (self.x[1] - self.x[0]);
        self.left + (self.right - self.left) * t
    }

    fn y(&self, value: f64) -> f64 {
        let t = (value - self.y[0]) / (self.y[1] - self.y[0]);
        self.bottom - (self.bottom - self.top) * t
    }

    /// The line at the bottom with its ticks and its name.
    fn bottom_axis(&self, ticks: &[(f64, String)], name: &str) -> Markup {
        let (left, right, bottom) = (self.left, self.right, self.bottom);
        html! {
            path.axis d={ "M" (left) " " (bottom) "H" (right) } {}
            @for (value, label) in ticks {
                @let x = px(self.x(*value));
                path.axis d={ "M" (x) " " (bottom) "v5" } {}
                text x=(x) y=(bottom + 19.0) text-anchor="middle" { (label) }
            }
            text x=((left + right) / 2.0) y=(bottom + 40.0) text-anchor="middle" { (name) }
        }
    }

    /// Grid lines with their numbers at the left.
    fn left_axis(&self, ticks: &[(f64, String)], name: &str) -> Markup {
        let (left, right) = (self.left, self.right);
        html! {
            @for (value, label) in ticks {
                @let y = self.y(*value);
                path.grid d={ "M" (left) " " (px(y)) "H" (right) } {}
                text x=(left - 9.0) y=(px(y + 4.0)) text-anchor="end" { (label) }
            }
            text x="0" y=(self.top - 10.0) { (name) }
        }
    }
}

fn svg([width, height]: [f64; 2], description: &str, content: &Markup) -> Markup {
    html! {
        svg viewBox={ "0 0 " (width) " " (height) } role="img" aria-label=(description) {
            (content)
        }
    }
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// How the distances of both directions spread: bars for the stamped nodes, a line for the crash nodes,
/// the band where distances mean nothing, and the limit of the overlap.
pub fn histogram(
    stats: PerRole<&DeviationStats>,
    scale: &ColorScale,
    limit: f64,
    lengths: Lengths,
) -> Markup {
    let range = [scale.min, scale.max];
    let counted = stats.map(|stats| stats.histogram(N_BINS, range));
    let both = counted.stamped.shares.iter().chain(&counted.crash.shares);
    let highest = both.copied().fold(1e-6, f64::max);
    let axes = Axes {
        left: LEFT,
        right: WIDTH - RIGHT,
        top: 30.0,
        bottom: 232.0,
        x: range,
        // The square root shows the few that lie far off beside the many that lie near.
        y: [0.0, (highest * 1.06).sqrt()],
    };
    let fractions = [0.0, 0.01, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];
    let fractions = fractions.into_iter().filter(|f| *f <= highest * 1.06);
    let fractions: Vec<_> = fractions
        .map(|f| (f.sqrt(), format!("{} %", trimmed(100.0 * f, DECIMALS))))
        .collect();
    let width = (range[1] - range[0]) / N_BINS as f64;
    let limits = [-limit, limit];
    let limits = limits
        .into_iter()
        .filter(|at| (range[0]..=range[1]).contains(at));
    let content = html! {
        (band(&axes, scale.tolerance, range))
        (axes.left_axis(&fractions, "fraction of the area, square root scale"))
        @for (i, &fraction) in counted.stamped.shares.iter().enumerate() {
            (bar(&axes, scale, range[0] + width * i as f64, [width, fraction]))
        }
        path.outline d=(outline(&axes, &counted.crash, width)) {}
        @for at in limits {
            path.limit d={ "M" (px(axes.x(at))) " " (axes.top) "V" (axes.bottom) } {}
        }
        (axes.bottom_axis(&signed_ticks(scale, 9), &lengths.axis("signed distance")))
    };
    let description = format!(
        "Histogram of the signed distances: {} of the compared area of the stamped part lies within {}",
        percent(stats.stamped.share_inside(limit)),
        lengths.of(limit)
    );
    svg([WIDTH, 282.0], &description, &content)
}

/// A bar from `from` on, as wide and high as the values say.
fn bar(axes: &Axes, scale: &ColorScale, from: f64, [width, fraction]: [f64; 2]) -> Markup {
    let to = from + width;
    let (x, y) = (axes.x(from), axes.y(fraction.sqrt()));
    let (w, h) = (axes.x(to) - x, axes.bottom - y);
    let color = hex(scale.color((from + to) / 2.0));
    html! {
        @if h > 0.05 {
            rect.bar x=(px(x)) y=(px(y)) width=(px(w)) height=(px(h)) fill=(color) {}
        }
    }
}

fn band(axes: &Axes, tolerance: f64, range: [f64; 2]) -> Markup {
    let from = axes.x((-tolerance).max(range[0]));
    let width = axes.x(tolerance.min(range[1])) - from;
    html! {
        @if tolerance > 0.0 {
            rect.band x=(px(from)) y=(axes.top) width=(px(width)) height=(axes.bottom - axes.top) {}
        }
    }
}

fn outline(axes: &Axes, histogram: &Histogram, width: f64) -> String {
    let mut path = format!("M{:.1} {:.1}", axes.x(histogram.range[0]), axes.bottom);
    for (i, fraction) in histogram.shares.iter().enumerate() {
        let to = axes.x(histogram.range[0] + width * (i + 1) as f64);
        // Writing to a string cannot fail.
        let _ = write!(path, "V{:.1}H{to:.1}", axes.y(fraction.sqrt()));
    }
    path + &format!("V{}", axes.bottom)
}

/// The colours of the map with their numbers.
pub fn color_legend(scale: &ColorScale, lengths: Lengths) -> Markup {
    let title = "Colours of the deviation map";
    let ticks = signed_ticks(scale, 7);
    legend(scale, &ticks, &lengths.axis("signed distance"), title)
}

/// The colours of a scale over an axis with its ticks.
fn legend(scale: &ColorScale, ticks: &[(f64, String)], axis: &str, title: &str) -> Markup {
    let axes = Axes {
        left: RIGHT,
        right: LEGEND_WIDTH - RIGHT,
        top: 2.0,
        bottom: 20.0,
        x: [scale.min, scale.max],
        y: [0.0, 1.0],
    };
    let content = html! {
        (color_strip(scale, &axes))
        (axes.bottom_axis(ticks, axis))
    };
    svg([LEGEND_WIDTH, 64.0], title, &content)
}

/// The map from end to end as a background.
pub fn css_gradient(scale: &ColorScale) -> String {
    let colors: Vec<String> = scale.table(5).into_iter().map(hex).collect();
    format!("linear-gradient(90deg,{})", colors.join(","))
}

/// The best start and those that came closest to it, which are drawn over.
fn curves(outcome: &MatchOutcome) -> Option<Vec<&StartRecord>> {
    let is_best = |start: &&StartRecord| start.outcome == Some(StartOutcome::Won);
    let best = outcome.starts.iter().find(is_best)?;
    let mut others: Vec<&StartRecord> = outcome.starts.iter().filter(|s| !is_best(s)).collect();
    others.sort_by_key(|start| {
        let is_dropped = start.outcome != Some(StartOutcome::RunnerUp);
        (is_dropped, Reverse(start.iterations.len()))
    });
    others.truncate(N_CURVES);
    others.push(best);
    Some(others)
}

/// The distance of the kept pairs over the iterations of the starts that matter.
pub fn convergence(outcome: &MatchOutcome, lengths: Lengths) -> Option<Markup> {
    let starts = curves(outcome)?;
    let iterations = starts.iter().flat_map(|start| &start.iterations);
    let values = iterations.map(|i| i.rmse).filter(|&v| v > 0.0);
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), v: f64| {
        (v.min(low), v.max(high))
    });
    let n = starts.iter().map(|start| start.iterations.len()).max()?;
    if n < 2 || low >= high {
        return None;
    }
    let axes = Axes {
        left: LEFT,
        right: WIDTH - RIGHT,
        top: 30.0,
        bottom: 252.0,
        x: [1.0, n as f64],
        y: [low.log10() - 0.05, high.log10() + 0.05],
    };
    let scale = ColorScale::new(ColorMap::Viridis, 1.0, n as f64);
    let ticks = scale.ticks(10);
    let ticks: Vec<_> = ticks.iter().map(|&v| (v, trimmed(v, DECIMALS))).collect();
    let content = html! {
        (axes.left_axis(&decades(axes.y), &lengths.axis("Residual")))
        @for start in starts {
            path class=(class(start.outcome)) d=(curve(&axes, start)) {}
        }
        (axes.bottom_axis(&ticks, "iteration"))
    };
    let iterations = counted(n, "iteration");
    let description = format!("Residual over up to {iterations}, logarithmic");
    Some(svg([WIDTH, 302.0], &description, &content))
}

/// The style of the curve of a start.
fn class(outcome: Option<StartOutcome>) -> &'static str {
    match outcome {
        Some(StartOutcome::Won) => "best",
        Some(StartOutcome::RunnerUp) => "close",
        _ => "rest",
    }
}

fn curve(axes: &Axes, start: &StartRecord) -> String {
    let mut path = String::new();
    for (i, iteration) in start.iterations.iter().enumerate() {
        if iteration.rmse > 0.0 {
            let step = if path.is_empty() { 'M' } else { 'L' };
            let (x, y) = (axes.x(1.0 + i as f64), axes.y(iteration.rmse.log10()));
            // Writing to a string cannot fail.
            let _ = write!(path, "{step}{x:.1} {y:.1}");
        }
    }
    path
}

/// 1, 2 and 5 times the powers of ten in a range of logarithms; only 1 where there are many.
fn decades([low, high]: [f64; 2]) -> Vec<(f64, String)> {
    let steps: &[f64] = if high - low > 2.5 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let powers = (low.floor() as i32)..=(high.ceil() as i32);
    let values = powers.flat_map(|power| steps.iter().map(move |s| s * 10f64.powi(power)));
    values
        .filter(|v| (low..=high).contains(&v.log10()))
        .map(|v| (v.log10(), trimmed(v, DECIMALS)))
        .collect()
}

/// Round values of a scale with their signs.
fn signed_ticks(scale: &ColorScale, n: usize) -> Vec<(f64, String)> {
    let sign = |value: f64| if value > 0.0 { "+" } else { "−" };
    let text = |value: f64| match trimmed(value.abs(), DECIMALS) {
        zero if zero == "0" => zero,
        digits => sign(value).to_owned() + &digits,
    };
    scale.ticks(n).iter().map(|&v| (v, text(v))).collect()
}

/// The colours of a map with plain numbers below.
pub fn plain_legend(scale: &ColorScale, name: &str) -> Markup {
    legend(
        scale,
        &plain_ticks(scale, 7),
        name,
        &format!("Colours: {name}"),
    )
}

fn color_strip(scale: &ColorScale, axes: &Axes) -> Markup {
    let colors = scale.table(120);
    let step = (axes.right - axes.left) / colors.len() as f64;
    // A little wider than its place, so that no line shows between two.
    let width = format!("{:.2}", step + 0.6);
    html! {
        @for (i, color) in colors.into_iter().enumerate() {
            @let x = format!("{:.2}", axes.left + step * i as f64);
            rect x=(x) y="2" width=(width) height="18" fill=(hex(color)) {}
        }
    }
}

fn plain_ticks(scale: &ColorScale, n: usize) -> Vec<(f64, String)> {
    let ticks = scale.ticks(n).into_iter();
    ticks.map(|at| (at, trimmed(at, DECIMALS))).collect()
}

/// Two histograms over one range: the first as bars, the second as a line.
pub fn two_histograms(shares: &[Vec<f64>; 2], range: [f64; 2], name: &str) -> Markup {
    let highest = shares.iter().flatten().copied().fold(1e-6, f64::max);
    let scale = ColorScale::new(ColorMap::Viridis, range[0], range[1]);
    let axes = Axes {
        left: LEFT,
        right: WIDTH - RIGHT,
        top: 30.0,
        bottom: 232.0,
        x: [scale.min, scale.max],
        y: [0.0, highest * 1.06],
    };
    let fractions = ColorScale::new(ColorMap::Viridis, 0.0, 100.0 * highest).ticks(5);
    let fractions: Vec<_> = fractions
        .into_iter()
        .map(|share| (share / 100.0, format!("{} %", trimmed(share, 2))))
        .collect();
    let place = |bins: &[f64], i: usize| {
        let at = scale.min + (scale.max - scale.min) * i as f64 / bins.len().max(1) as f64;
        axes.x(at)
    };
    let mut path = format!("M{:.1} {:.1}", axes.left, axes.bottom);
    for (i, share) in shares[1].iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(
            path,
            "V{:.1}H{:.1}",
            axes.y(*share),
            place(&shares[1], i + 1)
        );
    }
    let content = html! {
        (axes.left_axis(&fractions, "fraction of the area"))
        @for (i, share) in shares[0].iter().enumerate() {
            @let (x, end) = (place(&shares[0], i), place(&shares[0], i + 1));
            @let top = axes.y(*share);
            rect x=(px(x)) y=(px(top)) width=(px(end - x)) height=(px(axes.bottom - top))
                style="fill:var(--stamped);opacity:.45" {}
        }
        path d=(path) style="fill:none;stroke:var(--crash);stroke-width:2" {}
        (axes.bottom_axis(&plain_ticks(&scale, 9), name))
    };
    let description = format!("Histograms of both sides: {name}");
    svg([WIDTH, 282.0], &description, &content)
}
