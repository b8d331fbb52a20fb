//! Residual and overlap over the iterations, live; the pointer scrubs through the poses.

use crate::app::{AppState, Command, ViewCommand};
use crate::monitor::IterationReport;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, length, nothing_yet, percent};
use egui::{Ui, vec2};
use egui_plot::{Line, Plot, PlotPoints, VLine};

/// Two charts with one axis of iterations.
pub fn convergence_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let iterations = &state.convergence;
    if iterations.is_empty() {
        nothing_yet(
            ui,
            "No iterations yet",
            "The curves grow here while a match runs",
        );
        return;
    }
    let scrubbed = state.view.scrubbed_iteration;
    match scrubbed.and_then(|index| Some((index, iterations.get(index)?))) {
        Some((index, it)) => caption(
            ui,
            format!(
                "iteration {} of {} · start {} · rmse {} · overlap {} · the windows show this pose",
                index + 1,
                iterations.len(),
                it.start_idx + 1,
                length(it.rmse),
                percent(it.fraction)
            ),
        ),
        None => caption(
            ui,
            format!(
                "{} iterations of all starts · point at a curve to see the pose",
                iterations.len()
            ),
        ),
    };
    let palette = Palette::of(ui);
    let size = vec2((ui.available_width() - 16.0) / 2.0, ui.available_height());
    let mut pointed = None;
    ui.horizontal_top(|ui| {
        type Value = fn(&IterationReport) -> f64;
        let charts: [(&str, Value, egui::Color32); 2] = [
            ("rmse", |it| it.rmse, palette.accent_text),
            ("overlap", |it| it.fraction, palette.good),
        ];
        for (name, value, color) in charts {
            let points: Vec<[f64; 2]> = thinned(iterations)
                .map(|(index, it)| [index as f64, value(it)])
                .collect();
            let shown = Plot::new(name)
                .width(size.x)
                .height(size.y)
                .show_background(false)
                .allow_scroll(false)
                .allow_drag(false)
                .allow_zoom(false)
                .allow_boxed_zoom(false)
                .include_y(0.0)
                .y_axis_label(name)
                .y_axis_min_width(48.0)
                .show(ui, |plot| {
                    plot.line(
                        Line::new(name, PlotPoints::from(points))
                            .color(color)
                            .width(1.5),
                    );
                    if let Some(index) = scrubbed {
                        plot.vline(VLine::new("shown", index as f64).color(palette.secondary));
                    }
                    let is_over = plot.response().hovered();
                    plot.pointer_coordinate().filter(|_| is_over)
                });
            if let Some(at) = shown.inner {
                pointed = Some(at.x.round().max(0.0) as usize);
            }
        }
    });
    let can_scrub = state.locking_job().is_none();
    let pointed = pointed.filter(|index| can_scrub && *index < iterations.len());
    if pointed != scrubbed && (pointed.is_some() || can_scrub) {
        commands.push(ViewCommand::ScrubIteration(pointed).into());
    }
}

/// At most some thousand points, so that a long match draws as fast as a short one.
fn thinned(iterations: &[IterationReport]) -> impl Iterator<Item = (usize, &IterationReport)> {
    let step = iterations.len().div_ceil(4000).max(1);
    iterations.iter().enumerate().step_by(step)
}
