//! The paper's tables, measured here, with the paper's own figures beside them.

use egui::{Align, Button, Color32, Layout, ScrollArea, Sense, Ui, vec2};
use egui_extras::{Column, TableBuilder};
use egui_plot::{HoverPosition, LineStyle, PlotBounds, PlotPoints, Points};

use super::charts::{decade_text, exact_line, log_chart, range};
use crate::app::{AppState, Command, ExportCommand, MatchCommand, MoveCommand};
use crate::jobs::JobKey;
use crate::pipeline::sweep::{MatchingRow, PAPER_MATCHING, PAPER_REDUCTION, Sweep, SweepSettings};
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{caption, grouped, length, nothing_yet};

/// Buttons, tables, charts.
pub fn sweep_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    head_ui(ui, state, commands);
    let Some(sweep) = state
        .shown_sweep()
        .filter(|sweep| !sweep.reduction.is_empty())
    else {
        let title = if state.jobs.is_active(JobKey::Sweep) {
            "The sweep is running"
        } else {
            "No sweep yet"
        };
        let hint = "Its times and errors appear here, beside those of the paper";
        nothing_yet(ui, title, hint);
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
                .show(ui, |ui| tables_ui(ui, sweep, state, commands));
        });
        charts_ui(ui, sweep, height, (state, commands));
    });
}

fn head_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        if state.jobs.is_active(JobKey::Sweep) {
            if ui.button("Stop the sweep").clicked() {
                commands.push(MatchCommand::Stop.into());
            }
        } else {
            let can = state.can_match_as_asked();
            let button = Button::new("Run the sweep").min_size(vec2(0.0, ROW));
            let response = ui.add_enabled(can.is_ok(), button);
            if response.clicked() {
                commands.push(MatchCommand::Sweep(Box::new(settings(state))).into());
            }
            if let Err(reason) = can {
                response.on_disabled_hover_text(reason.to_string());
            }
        }
        if let Some(sweep) = state.shown_sweep() {
            for form in ["CSV", "JSON"] {
                if ui.button(format!("Copy as {form}")).clicked() {
                    let what = format!("Sweep ({form})");
                    let text = match form {
                        "CSV" => sweep.to_csv(),
                        _ => sweep.to_json(),
                    };
                    commands.push(ExportCommand::CopyText { text, what }.into());
                }
            }
        }
        let color = Palette::of(ui).secondary;
        let text = "Reduction and match over levels, each time the best of three";
        let text = egui::RichText::new(text).small().color(color);
        ui.add(egui::Label::new(text).truncate());
    });
}

fn settings(state: &AppState) -> SweepSettings {
    let mut settings = state.document.recipe.settings.clone();
    // The same starts at every level, so that the times compare.
    settings.starts.wide_search = false;
    SweepSettings {
        settings,
        ..SweepSettings::default()
    }
}

fn tables_ui(ui: &mut Ui, sweep: &Sweep, state: &AppState, commands: &mut Vec<Command>) {
    let unit = state.document.unit_suffix();
    let reduction = sweep.reduction.iter().map(|row| {
        vec![
            grouped(row.triangles),
            length(row.time_ms),
            paper(row.paper_ms),
            error(row.rms),
            error(row.max),
        ]
    });
    let title = format!("Reduction of {} triangles", grouped(sweep.n_triangles));
    let (rms, max) = (format!("RMS{unit}"), format!("max{unit}"));
    let titles = ["triangles", "ms", "paper ms", &rms, &max];
    table_ui(ui, &title, &titles, &reduction.collect::<Vec<_>>(), None);
    let matching = sweep.matching.iter().map(|row| {
        vec![
            level_text(row),
            length(row.time_ms),
            paper(row.paper_ms),
            error(row.node_rms),
            error(row.finished_node_rms),
        ]
    });
    let matching: Vec<_> = matching.collect();
    if matching.is_empty() {
        return;
    }
    ui.add_space(8.0);
    let node = format!("node RMS{unit}");
    let titles = ["triangles", "ms", "paper ms", &node, "finished"];
    let help = "Click to put the stamped part at the pose of this level";
    let clicked = table_ui(ui, "Match", &titles, &matching, Some(help));
    if let Some(row) = clicked.and_then(|index| sweep.matching.get(index)) {
        open_pose(row, state, commands);
    }
}

/// A distance; what is only rounding is none.
fn error(value: f64) -> String {
    if value < 1e-6 {
        "0".to_owned()
    } else {
        length(value)
    }
}

fn level_text(row: &MatchingRow) -> String {
    row.max_triangles.map_or_else(|| "full".to_owned(), grouped)
}

fn paper(ms: Option<f64>) -> String {
    ms.map_or_else(|| "–".to_owned(), |ms| grouped(ms.round() as usize))
}

/// A table of figures; the index of the row that was clicked, where rows can be.
fn table_ui(
    ui: &mut Ui,
    title: &str,
    titles: &[&str],
    rows: &[Vec<String>],
    help: Option<&str>,
) -> Option<usize> {
    let mut clicked = None;
    ui.label(title);
    ui.push_id(title, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let width = (ui.available_width() - 8.0 * titles.len() as f32) / titles.len() as f32;
        let sense = if help.is_some() {
            Sense::click()
        } else {
            Sense::hover()
        };
        TableBuilder::new(ui)
            .vscroll(false)
            .sense(sense)
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
                    let index = table_row.index();
                    for text in &rows[index] {
                        table_row.col(|ui| {
                            ui.add(egui::Label::new(text).selectable(false));
                        });
                    }
                    if let Some(help) = help {
                        let response = table_row.response();
                        if response.clicked() {
                            clicked = Some(index);
                        }
                        response.on_hover_text(help);
                    }
                });
            });
    });
    clicked
}

/// A curve in logarithms; a reference is dashed and has no dots.
struct Curve {
    name: &'static str,
    color: Color32,
    points: Vec<[f64; 2]>,
    is_reference: bool,
}

impl Curve {
    /// Points from few triangles to many. What is zero or less, such as the error of the level that
    /// nothing was taken from, has no place on a logarithmic axis.
    fn new(name: &'static str, color: Color32, points: impl Iterator<Item = [f64; 2]>) -> Self {
        let above_zero = points.filter(|[x, y]| *x > 0.0 && *y > 1e-9);
        let mut points: Vec<[f64; 2]> = above_zero.map(|p| p.map(f64::log10)).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self {
            name,
            color,
            points,
            is_reference: false,
        }
    }

    fn of_paper(name: &'static str, color: Color32, table: &[(usize, f64)]) -> Self {
        let points = table.iter().map(|&(n, ms)| [n as f64, ms]);
        Self {
            is_reference: true,
            ..Self::new(name, color, points)
        }
    }
}

fn charts_ui(
    ui: &mut Ui,
    sweep: &Sweep,
    height: f32,
    (state, commands): (&AppState, &mut Vec<Command>),
) {
    let palette = Palette::of(ui);
    let matched = || sweep.matching.iter();
    let reduced = || sweep.reduction.iter();
    let n = |row: &MatchingRow| row.triangles.stamped as f64;
    let (ours, theirs) = (palette.accent_text, palette.good);
    let times = [
        Curve::new("match", ours, matched().map(|row| [n(row), row.time_ms])),
        Curve::new(
            "reduce",
            theirs,
            reduced().map(|row| [row.triangles as f64, row.time_ms]),
        ),
        Curve::of_paper("match, paper", ours, &PAPER_MATCHING),
        Curve::of_paper("reduce, paper", theirs, &PAPER_REDUCTION),
    ];
    let errors = [
        Curve::new(
            "node RMS",
            ours,
            matched().map(|row| [n(row), row.node_rms]),
        ),
        Curve::new(
            "reduction RMS",
            theirs,
            reduced().map(|row| [row.triangles as f64, row.rms]),
        ),
    ];
    let width = (ui.available_width() - 8.0) / 2.0;
    let size = vec2(width, height);
    let clicked = chart_ui(ui, "time, ms", &times, size);
    let clicked = clicked.or(chart_ui(ui, &state.lengths().axis("error"), &errors, size));
    let off = |row: &&MatchingRow, at: f64| (n(row).max(1.0).log10() - at).abs();
    let nearest = |at: f64| matched().min_by(|a, b| off(a, at).total_cmp(&off(b, at)));
    if let Some(row) = clicked.and_then(nearest) {
        open_pose(row, state, commands);
    }
}

/// Puts the stamped part where the match of a level put it.
fn open_pose(row: &MatchingRow, state: &AppState, commands: &mut Vec<Command>) {
    if state.can_move().is_ok() {
        let command = MoveCommand::SetPose {
            crash_from_stamped: row.crash_from_stamped,
            name: format!("Pose of the sweep at {}", level_text(row)),
        };
        commands.push(command.into());
    }
}

/// The names above the curves rather than over them, then the curves. Returns where it was
/// clicked, as the logarithm of a number of triangles.
fn chart_ui(ui: &mut Ui, title: &str, curves: &[Curve], size: egui::Vec2) -> Option<f64> {
    let mut clicked = None;
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        names_ui(ui, curves);
        let room = vec2(size.x, (size.y - 16.0).max(60.0));
        let of = |axis: usize| {
            let all = curves.iter().flat_map(|curve| &curve.points);
            range(all.map(|point| point[axis]))
        };
        let (Some(x), Some(y)) = (of(0), of(1)) else {
            return;
        };
        let plot = log_chart(ui, title, room).label_formatter(point_text);
        let shown = plot.show(ui, |plot| {
            let (low, high) = ([*x.start(), *y.start()], [*x.end(), *y.end()]);
            plot.set_plot_bounds(PlotBounds::from_min_max(low, high));
            for curve in curves {
                let points = || PlotPoints::from(curve.points.clone());
                let line = exact_line(curve.name, points()).color(curve.color);
                if curve.is_reference {
                    plot.line(line.width(1.0).style(LineStyle::dashed_loose()));
                } else {
                    plot.line(line.width(1.5));
                    let dots = Points::new(curve.name, points());
                    plot.points(dots.color(curve.color).radius(3.0));
                }
            }
            let is_clicked = plot.response().clicked();
            plot.pointer_coordinate().filter(|_| is_clicked)
        });
        clicked = shown.inner.map(|at| at.x);
    });
    clicked
}

/// What stands at a point of a curve under the pointer.
fn point_text(hovered: &HoverPosition<'_>) -> Option<String> {
    match hovered {
        HoverPosition::NearDataPoint {
            plot_name,
            position,
            ..
        } => {
            let (at, value) = (decade_text(position.x), decade_text(position.y));
            Some(format!("{plot_name}\n{at} triangles: {value}"))
        }
        HoverPosition::Elsewhere { .. } => None,
    }
}

/// A legend in one line: a dash in the colour, then the name; one dashed entry for all references.
fn names_ui(ui: &mut Ui, curves: &[Curve]) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let font = egui::FontId::proportional(11.0);
    let text = Palette::of(ui).secondary;
    let drawn = || curves.iter().filter(|curve| !curve.points.is_empty());
    let own = drawn().filter(|curve| !curve.is_reference);
    let mut entries: Vec<_> = own.map(|curve| (curve.name, curve.color, false)).collect();
    if drawn().any(|curve| curve.is_reference) {
        entries.push(("the paper", text, true));
    }
    let mut x = rect.left() + 48.0;
    for (name, color, is_dashed) in entries {
        let galley = ui
            .painter()
            .layout_no_wrap(name.to_owned(), font.clone(), text);
        let middle = rect.center().y;
        let ends = [egui::pos2(x, middle), egui::pos2(x + 14.0, middle)];
        let stroke = egui::Stroke::new(1.5, color);
        if is_dashed {
            let dashes = egui::Shape::dashed_line(&ends, stroke, 4.0, 2.5);
            ui.painter().extend(dashes);
        } else {
            ui.painter().line_segment(ends, stroke);
        }
        let at = egui::pos2(x + 18.0, middle - galley.size().y / 2.0);
        x = at.x + galley.size().x + 14.0;
        ui.painter().galley(at, galley, text);
    }
}
