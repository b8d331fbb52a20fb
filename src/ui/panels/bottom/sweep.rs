//! The paper's tables, measured here, with the paper's own figures beside them.

use crate::app::{AppState, Command, ExportCommand, MatchCommand};
use crate::jobs::JobKey;
use crate::pipeline::sweep::{PAPER_MATCHING, PAPER_REDUCTION, Sweep, SweepSettings};
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{caption, grouped, length, nothing_yet};
use egui::{Align, Button, Color32, Layout, ScrollArea, Ui, vec2};
use egui_extras::{Column, TableBuilder};
use egui_plot::{Legend, Line, LineStyle, Plot, PlotPoints, Points};
use std::fmt::Write as _;

/// Buttons, tables, charts.
pub fn sweep_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        if state.jobs.is_active(JobKey::Sweep) {
            if ui.button("Stop the sweep").clicked() {
                commands.push(MatchCommand::Stop.into());
            }
        } else {
            let can = state.can_match();
            let button = Button::new("Run the sweep").min_size(vec2(0.0, ROW));
            let response = ui.add_enabled(can.is_ok(), button);
            if response.clicked() {
                commands.push(MatchCommand::Sweep(Box::new(settings(state))).into());
            }
            if let Err(reason) = can {
                response.on_disabled_hover_text(format!("Not now: {reason}"));
            }
        }
        if let Some(sweep) = &state.sweep
            && ui.button("Copy as CSV").clicked()
        {
            let (text, what) = (csv(sweep), "Sweep (CSV)".to_owned());
            commands.push(ExportCommand::CopyText { text, what }.into());
        }
        caption(
            ui,
            "Reduction and match over levels, each time the best of three",
        );
    });
    let Some(sweep) = &state.sweep else {
        let title = if state.jobs.is_active(JobKey::Sweep) {
            "The sweep is running"
        } else {
            "No sweep yet"
        };
        nothing_yet(
            ui,
            title,
            "Its times and errors stand here beside those of the paper",
        );
        return;
    };
    ui.horizontal_top(|ui| {
        let height = ui.available_height();
        let width = (0.46 * ui.available_width()).min(560.0);
        ui.allocate_ui_with_layout(vec2(width, height), Layout::top_down(Align::Min), |ui| {
            ui.set_width(width);
            ScrollArea::vertical()
                .id_salt("sweep tables")
                .auto_shrink([false, false])
                .show(ui, |ui| tables_ui(ui, sweep));
        });
        charts_ui(ui, sweep, height);
    });
}

fn settings(state: &AppState) -> SweepSettings {
    let mut settings = state.document.recipe.settings.clone();
    // The same starts at every level, so that the times compare.
    settings.starts.widen = false;
    SweepSettings {
        settings,
        ..SweepSettings::default()
    }
}

fn tables_ui(ui: &mut Ui, sweep: &Sweep) {
    let reduction: Vec<Vec<String>> = sweep
        .reduction
        .iter()
        .map(|row| {
            vec![
                grouped(row.triangles),
                length(row.time_ms),
                paper(row.paper_ms),
                length(row.rms),
                length(row.max),
            ]
        })
        .collect();
    let title = format!("Reduction of {} triangles", grouped(sweep.n_triangles));
    table_ui(
        ui,
        &title,
        &["triangles", "ms", "paper ms", "rms", "max"],
        &reduction,
    );
    let matching: Vec<Vec<String>> = sweep
        .matching
        .iter()
        .map(|row| {
            let level = match row.max_triangles {
                Some(n) => grouped(n),
                None => "full".to_owned(),
            };
            vec![
                level,
                length(row.time_ms),
                paper(row.paper_ms),
                length(row.node_rms),
                length(row.finished_node_rms),
            ]
        })
        .collect();
    ui.add_space(8.0);
    let titles = ["triangles", "ms", "paper ms", "node rms", "finished"];
    table_ui(ui, "Match", &titles, &matching);
}

fn paper(ms: Option<f64>) -> String {
    ms.map_or_else(|| "–".to_owned(), |ms| grouped(ms.round() as usize))
}

fn table_ui(ui: &mut Ui, title: &str, titles: &[&str], rows: &[Vec<String>]) {
    ui.label(title);
    ui.push_id(title, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let width = (ui.available_width() - 8.0 * titles.len() as f32) / titles.len() as f32;
        TableBuilder::new(ui)
            .vscroll(false)
            .cell_layout(Layout::right_to_left(Align::Center))
            .columns(Column::exact(width.max(40.0)), titles.len())
            .header(18.0, |mut header| {
                for title in titles {
                    header.col(|ui| {
                        caption(ui, *title);
                    });
                }
            })
            .body(|body| {
                body.rows(18.0, rows.len(), |mut table_row| {
                    for text in &rows[table_row.index()] {
                        table_row.col(|ui| {
                            ui.label(text);
                        });
                    }
                });
            });
    });
}

/// A curve: name, colour, points, and whether it is only for reference.
type Curve = (&'static str, Color32, Vec<[f64; 2]>, bool);

fn charts_ui(ui: &mut Ui, sweep: &Sweep, height: f32) {
    let palette = Palette::of(ui);
    let matched = || sweep.matching.iter();
    let reduced = || sweep.reduction.iter();
    let n = |row: &crate::pipeline::sweep::MatchingRow| row.triangles[1] as f64;
    let of_paper = |table: &[(usize, f64)]| curve(table.iter().map(|&(n, ms)| [n as f64, ms]));
    let times: Vec<Curve> = vec![
        (
            "match",
            palette.accent_text,
            curve(matched().map(|row| [n(row), row.time_ms])),
            false,
        ),
        (
            "reduce",
            palette.good,
            curve(reduced().map(|row| [row.triangles as f64, row.time_ms])),
            false,
        ),
        (
            "match, paper",
            palette.accent_text,
            of_paper(&PAPER_MATCHING),
            true,
        ),
        (
            "reduce, paper",
            palette.good,
            of_paper(&PAPER_REDUCTION),
            true,
        ),
    ];
    let errors: Vec<Curve> = vec![
        (
            "node rms",
            palette.accent_text,
            curve(matched().map(|row| [n(row), row.node_rms])),
            false,
        ),
        (
            "reduction rms",
            palette.good,
            curve(reduced().map(|row| [row.triangles as f64, row.rms])),
            false,
        ),
    ];
    let width = (ui.available_width() - 8.0) / 2.0;
    chart_ui(ui, "time, ms", times, vec2(width, height));
    chart_ui(ui, "error", errors, vec2(width, height));
}

/// Points of a curve in logarithms, from few triangles to many. What is zero or less, such as the
/// error of the level that nothing was taken from, has no place on a logarithmic axis.
fn curve(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let above_zero = points.filter(|[x, y]| *x > 0.0 && *y > 1e-9);
    let mut curve: Vec<[f64; 2]> = above_zero.map(|point| point.map(f64::log10)).collect();
    curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
    curve
}

fn chart_ui(ui: &mut Ui, title: &str, curves: Vec<Curve>, size: egui::Vec2) {
    let decade = |mark: egui_plot::GridMark, _: &std::ops::RangeInclusive<f64>| {
        if mark.value.fract().abs() > 1e-6 {
            return String::new();
        }
        let value = 10_f64.powf(mark.value);
        if value >= 1000.0 {
            format!("{}k", value / 1000.0)
        } else {
            format!("{value}")
        }
    };
    Plot::new(title)
        .width(size.x)
        .height(size.y)
        .show_background(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .grid_color(Palette::of(ui).line)
        .legend(Legend::default())
        .x_axis_formatter(decade)
        .y_axis_formatter(decade)
        .y_axis_min_width(40.0)
        .y_axis_label(title)
        .show(ui, |plot| {
            for (name, color, points, is_reference) in curves {
                let line = Line::new(name, PlotPoints::from(points.clone())).color(color);
                if is_reference {
                    plot.line(line.width(1.0).style(LineStyle::dashed_loose()));
                } else {
                    plot.line(line.width(1.5));
                    plot.points(
                        Points::new(name, PlotPoints::from(points))
                            .color(color)
                            .radius(3.0),
                    );
                }
            }
        });
}

/// Both tables as text between commas.
fn csv(sweep: &Sweep) -> String {
    let paper = |ms: Option<f64>| ms.map_or_else(String::new, |ms| ms.to_string());
    let mut text = String::from(
        "table,max_triangles,triangles,time_ms,paper_ms,rms,max,finished_ms,finished_rms\n",
    );
    for row in &sweep.reduction {
        let _ = writeln!(
            text,
            "reduction,{},{},{},{},{},{},,",
            row.max_triangles,
            row.triangles,
            row.time_ms,
            paper(row.paper_ms),
            row.rms,
            row.max
        );
    }
    for row in &sweep.matching {
        let max = row
            .max_triangles
            .map_or_else(String::new, |n| n.to_string());
        let _ = writeln!(
            text,
            "matching,{max},{},{},{},{},{},{},{}",
            row.triangles[1],
            row.time_ms,
            paper(row.paper_ms),
            row.node_rms,
            row.node_max,
            row.finished_ms,
            row.finished_node_rms
        );
    }
    text
}
