//! Charts as inline SVG, drawn with the colours of the page.

use std::fmt::Write as _;

use crate::assess::deviation::{DeviationStats, Histogram};
use crate::colormap::ColorScale;
use crate::registration::{Fate, MatchOutcome, StartRecord};

use super::Lengths;
use super::page::escaped;

/// Width of the charts and of the legend of the colours.
const WIDTH: f64 = 960.0;
const LEGEND_WIDTH: f64 = 520.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 18.0;
/// Bins of the histogram.
const N_BINS: usize = 60;
/// Curves besides the winner's.
const N_CURVES: usize = 14;

/// A rectangle of the picture with numbers on its sides.
struct Axes {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    x: [f64; 2],
    y: [f64; 2],
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
    fn bottom_axis(&self, ticks: &[(f64, String)], name: &str) -> String {
        let (left, right, bottom) = (self.left, self.right, self.bottom);
        let mut svg = format!("<path class=\"axis\" d=\"M{left} {bottom}H{right}\"/>");
        for (value, label) in ticks {
            let x = self.x(*value);
            let text = bottom + 19.0;
            let _ = write!(
                svg,
                "<path class=\"axis\" d=\"M{x:.1} {bottom}v5\"/><text x=\"{x:.1}\" y=\"{text}\" text-anchor=\"middle\">{label}</text>"
            );
        }
        let (middle, y) = ((left + right) / 2.0, bottom + 40.0);
        let name = escaped(name);
        svg + &format!("<text x=\"{middle}\" y=\"{y}\" text-anchor=\"middle\">{name}</text>")
    }

    /// Grid lines with their numbers at the left.
    fn left_axis(&self, ticks: &[(f64, String)], name: &str) -> String {
        let (left, right) = (self.left, self.right);
        let mut svg = String::new();
        for (value, label) in ticks {
            let y = self.y(*value);
            let (x, text) = (left - 9.0, y + 4.0);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{left} {y:.1}H{right}\"/><text x=\"{x}\" y=\"{text:.1}\" text-anchor=\"end\">{label}</text>"
            );
        }
        let (name, top) = (escaped(name), self.top - 10.0);
        svg + &format!("<text x=\"0\" y=\"{top}\">{name}</text>")
    }
}

fn svg(width: f64, height: f64, description: &str, content: &str) -> String {
    let description = escaped(description);
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{description}\">{content}</svg>\n"
    )
}

/// How the distances of both directions spread: bars for the stamped nodes, a line for the crash nodes,
/// the band where distances mean nothing, and the limit of the overlap.
pub fn histogram(
    [stamped, crash]: [&DeviationStats; 2],
    scale: &ColorScale,
    limit: f64,
    lengths: Lengths,
) -> String {
    let range = [scale.min, scale.max];
    let [bars, line] = [stamped, crash].map(|stats| stats.histogram(N_BINS, range));
    let highest = bars
        .shares
        .iter()
        .chain(&line.shares)
        .copied()
        .fold(1e-6, f64::max);
    let axes = Axes {
        left: LEFT,
        right: WIDTH - RIGHT,
        top: 30.0,
        bottom: 232.0,
        x: range,
        // The square root shows the few that lie far off beside the many that lie near.
        y: [0.0, (highest * 1.06).sqrt()],
    };
    let mut content = band(&axes, scale.tolerance, range);
    let shares = [0.0, 0.01, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];
    let shares = shares.iter().filter(|share| **share <= highest * 1.06);
    let shares: Vec<_> = shares
        .map(|&share| (share.sqrt(), format!("{} %", trimmed(100.0 * share))))
        .collect();
    content += &axes.left_axis(&shares, "share of the area, square root scale");
    let width = (range[1] - range[0]) / N_BINS as f64;
    for (i, share) in bars.shares.iter().enumerate() {
        let (from, to) = (
            range[0] + width * i as f64,
            range[0] + width * (i + 1) as f64,
        );
        let [r, g, b] = scale.color((from + to) / 2.0);
        let (x, w) = (axes.x(from), axes.x(to) - axes.x(from));
        let (y, h) = (axes.y(share.sqrt()), axes.bottom - axes.y(share.sqrt()));
        if h > 0.05 {
            let _ = write!(
                content,
                "<rect class=\"bar\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>"
            );
        }
    }
    content += &outline(&axes, &line, width);
    for at in [-limit, limit] {
        if (range[0]..=range[1]).contains(&at) {
            let (x, top, bottom) = (axes.x(at), axes.top, axes.bottom);
            let _ = write!(
                content,
                "<path class=\"limit\" d=\"M{x:.1} {top}V{bottom}\"/>"
            );
        }
    }
    let ticks = scale.ticks(9);
    let ticks: Vec<_> = ticks.iter().map(|&v| (v, signed(v))).collect();
    content += &axes.bottom_axis(&ticks, &lengths.axis("signed distance"));
    let description = format!(
        "Histogram of the signed distances: {:.1} % of the compared area of the stamped part lies within {}",
        100.0 * stamped.share_inside(limit),
        lengths.of(limit)
    );
    svg(WIDTH, 282.0, &description, &content)
}

fn band(axes: &Axes, tolerance: f64, range: [f64; 2]) -> String {
    let from = axes.x((-tolerance).max(range[0]));
    let width = axes.x(tolerance.min(range[1])) - from;
    let (top, height) = (axes.top, axes.bottom - axes.top);
    if tolerance <= 0.0 {
        return String::new();
    }
    format!(
        "<rect class=\"band\" x=\"{from:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{height}\"/>"
    )
}

fn outline(axes: &Axes, histogram: &Histogram, width: f64) -> String {
    let mut path = format!("M{:.1} {:.1}", axes.x(histogram.range[0]), axes.bottom);
    for (i, share) in histogram.shares.iter().enumerate() {
        let to = axes.x(histogram.range[0] + width * (i + 1) as f64);
        let _ = write!(path, "V{:.1}H{to:.1}", axes.y(share.sqrt()));
    }
    let bottom = axes.bottom;
    format!("<path class=\"outline\" d=\"{path}V{bottom}\"/>")
}

/// The colours of the map with their numbers.
pub fn color_legend(scale: &ColorScale, lengths: Lengths) -> String {
    let axes = Axes {
        left: RIGHT,
        right: LEGEND_WIDTH - RIGHT,
        top: 2.0,
        bottom: 20.0,
        x: [scale.min, scale.max],
        y: [0.0, 1.0],
    };
    let colors = scale.table(120);
    let width = (axes.right - axes.left) / colors.len() as f64;
    let mut content = String::new();
    for (i, [r, g, b]) in colors.iter().enumerate() {
        let x = axes.left + width * i as f64;
        // A little wider than its place, so that no line shows between two.
        let w = width + 0.6;
        let _ = write!(
            content,
            "<rect x=\"{x:.2}\" y=\"2\" width=\"{w:.2}\" height=\"18\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>"
        );
    }
    let ticks: Vec<_> = scale.ticks(7).iter().map(|&v| (v, signed(v))).collect();
    content += &axes.bottom_axis(&ticks, &lengths.axis("signed distance"));
    svg(LEGEND_WIDTH, 64.0, "Colours of the deviation map", &content)
}

/// The map from end to end as a background.
pub fn css_gradient(scale: &ColorScale) -> String {
    let colors = scale.table(5).into_iter();
    let colors: Vec<String> = colors
        .map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
        .collect();
    format!("linear-gradient(90deg,{})", colors.join(","))
}

/// The distance of the kept pairs over the iterations of the starts that matter.
pub fn convergence(outcome: &MatchOutcome, lengths: Lengths) -> Option<String> {
    let winner = outcome
        .starts
        .iter()
        .find(|start| start.fate == Fate::Won)?;
    let mut others: Vec<&StartRecord> = outcome
        .starts
        .iter()
        .filter(|start| start.fate != Fate::Won)
        .collect();
    others.sort_by_key(|start| {
        (
            start.fate != Fate::RunnerUp,
            std::cmp::Reverse(start.iterations.len()),
        )
    });
    others.truncate(N_CURVES);
    let shown = || others.iter().copied().chain([winner]);
    let values = || {
        shown()
            .flat_map(|s| &s.iterations)
            .map(|i| i.rmse)
            .filter(|&v| v > 0.0)
    };
    let (low, high) = (
        values().fold(f64::INFINITY, f64::min),
        values().fold(0.0, f64::max),
    );
    let n = shown().map(|start| start.iterations.len()).max()?;
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
    let mut content = axes.left_axis(&decades(axes.y), &lengths.axis("rms distance"));
    for start in shown() {
        let class = match start.fate {
            Fate::Won => "winner",
            Fate::RunnerUp => "runner",
            _ => "rest",
        };
        let mut path = String::new();
        for (i, iteration) in start.iterations.iter().enumerate() {
            if iteration.rmse > 0.0 {
                let step = if path.is_empty() { 'M' } else { 'L' };
                let (x, y) = (axes.x(1.0 + i as f64), axes.y(iteration.rmse.log10()));
                let _ = write!(path, "{step}{x:.1} {y:.1}");
            }
        }
        let _ = write!(content, "<path class=\"{class}\" d=\"{path}\"/>");
    }
    let scale = ColorScale::new(crate::colormap::ColorMap::Viridis, 1.0, n as f64);
    let ticks: Vec<_> = scale.ticks(10).iter().map(|&v| (v, trimmed(v))).collect();
    content += &axes.bottom_axis(&ticks, "iteration");
    let description = format!("Root mean square distance over up to {n} iterations, logarithmic");
    Some(svg(WIDTH, 302.0, &description, &content))
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
        .map(|v| (v.log10(), trimmed(v)))
        .collect()
}

fn trimmed(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A number of an axis with its sign.
fn signed(value: f64) -> String {
    let text = format!("{:.6}", value.abs());
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if value.abs() < 5e-7 {
        "0".to_owned()
    } else if value < 0.0 {
        format!("−{text}")
    } else {
        format!("+{text}")
    }
}
