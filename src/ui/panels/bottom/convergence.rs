//! Residual and overlap over the iterations, live; the pointer scrubs through the poses.

use crate::app::{AppState, Command, ViewCommand};
use crate::monitor::IterationReport;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, length, nothing_yet, percent};
use egui::{Ui, vec2};
use egui_plot::{GridMark, Line, Plot, PlotPoints, VLine};
use std::collections::BTreeMap;

/// The iterations of each start, with their place in the whole list.
type Curves<'a> = BTreeMap<usize, Vec<(usize, &'a IterationReport)>>;

/// Two charts with one axis of iterations; the start that leads stands out.
pub fn convergence_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.convergence.is_empty() {
        nothing_yet(
            ui,
            "No iterations yet",
            "The curves grow here while a match runs",
        );
        return;
    }
    let mut curves: Curves<'_> = BTreeMap::new();
    for (index, report) in state.convergence.iter().enumerate() {
        curves
            .entry(report.start_idx)
            .or_default()
            .push((index, report));
    }
    let leader = leader(state);
    head_ui(ui, state, curves.len(), leader);
    let led = curves.get(&leader).map_or(&[][..], Vec::as_slice);
    let shown = state.view.scrubbed_iteration;
    let mark = shown.and_then(|index| led.iter().position(|(i, _)| *i == index));
    let size = vec2((ui.available_width() - 16.0) / 2.0, ui.available_height());
    let mut pointed = None;
    ui.horizontal_top(|ui| {
        let rmse = Chart {
            name: "rmse",
            value: |report| report.rmse.max(1e-9).log10(),
            is_logarithmic: true,
        };
        let overlap = Chart {
            name: "overlap",
            value: |report| report.fraction,
            is_logarithmic: false,
        };
        for chart in [rmse, overlap] {
            let at = chart.show(ui, &curves, (leader, mark), size);
            pointed = pointed.or(at);
        }
    });
    if state.locking_job().is_some() {
        return;
    }
    let pointed = pointed.and_then(|at| led.get(at)).map(|(index, _)| *index);
    if pointed != shown {
        commands.push(ViewCommand::ScrubIteration(pointed).into());
    }
}

/// The start that won, or while the match runs the one that was heard of last.
fn leader(state: &AppState) -> usize {
    let latest = state
        .convergence
        .last()
        .map_or(0, |report| report.start_idx);
    match &state.document.result {
        Some(result) if state.locking_job().is_none() => result.run.outcome.winner,
        _ => latest,
    }
}

fn head_ui(ui: &mut Ui, state: &AppState, n_starts: usize, leader: usize) {
    let shown = state.view.scrubbed_iteration;
    let text = match shown.and_then(|index| state.convergence.get(index)) {
        Some(report) => format!(
            "start {} · rmse {} · overlap {} · the windows show this pose",
            report.start_idx + 1,
            length(report.rmse),
            percent(report.fraction)
        ),
        None => format!(
            "{} iterations of {n_starts} starts, start {} in front · point at a curve to see the pose",
            state.convergence.len(),
            leader + 1
        ),
    };
    caption(ui, text);
}

struct Chart {
    name: &'static str,
    value: fn(&IterationReport) -> f64,
    is_logarithmic: bool,
}

impl Chart {
    /// Draws; the iteration of the leader under the pointer.
    fn show(
        &self,
        ui: &mut Ui,
        curves: &Curves<'_>,
        (leader, mark): (usize, Option<usize>),
        size: egui::Vec2,
    ) -> Option<usize> {
        let palette = Palette::of(ui);
        let is_logarithmic = self.is_logarithmic;
        let format = move |mark: GridMark, _: &std::ops::RangeInclusive<f64>| {
            if !is_logarithmic {
                return format!("{:.0} %", 100.0 * mark.value);
            }
            let is_decade = mark.value.fract().abs() < 1e-6;
            if is_decade {
                10_f64.powf(mark.value).to_string()
            } else {
                String::new()
            }
        };
        let points = |reports: &[(usize, &IterationReport)]| -> Vec<[f64; 2]> {
            let reports = reports.iter().enumerate();
            reports
                .map(|(n, (_, report))| [n as f64, (self.value)(report)])
                .collect()
        };
        let shown = Plot::new(self.name)
            .width(size.x)
            .height(size.y)
            .show_background(false)
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_boxed_zoom(false)
            .allow_axis_zoom_drag(false)
            .grid_color(palette.line)
            .y_axis_label(self.name)
            .y_axis_min_width(48.0)
            .y_axis_formatter(format)
            .show(ui, |plot| {
                let quiet = palette.secondary.gamma_multiply(0.4);
                for (start, reports) in curves.iter().filter(|(start, _)| **start != leader) {
                    let name = format!("start {}", start + 1);
                    let line = Line::new(name, PlotPoints::from(points(reports)));
                    plot.line(line.color(quiet).width(1.0).allow_hover(false));
                }
                if let Some(reports) = curves.get(&leader) {
                    let name = format!("start {}", leader + 1);
                    let line = Line::new(name, PlotPoints::from(points(reports)));
                    plot.line(line.color(palette.accent_text).width(2.0));
                }
                if let Some(mark) = mark {
                    let line = VLine::new("shown", mark as f64);
                    plot.vline(line.color(palette.secondary));
                }
                let is_over = plot.response().hovered();
                plot.pointer_coordinate().filter(|_| is_over)
            });
        let at = shown.inner?.x.round();
        (at >= 0.0).then_some(at as usize)
    }
}
