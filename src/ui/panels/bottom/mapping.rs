//! The mapping looked at closely: its checks, the distribution of a quantity on both sides, and one
//! element with its profile through the thickness.

use egui::{Align, Layout, RichText, Sense, Ui, vec2};
use egui_extras::{Column, TableBuilder};
use egui_plot::{Line, MarkerShape, PlotPoints, Points};

use super::charts;
use crate::app::{
    Action, AppState, ColorBy, Command, InspectCommand, MapCommand, MapResult, ProbeReport,
    ViewCommand, file_names,
};
use crate::pipeline::map::{CheckRecord, ComparisonRecord, DistributionRecord, PairRecord};
use crate::role::Role;
use crate::text::grouped;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{
    Look, action_button, caption, length, nothing_yet, percent, segments, signed,
};

/// Height of a row.
const LINE: f32 = 19.0;

/// Checks, distributions, probe, side by side.
pub fn mapping_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(result) = state.document.current_mapping() else {
        let hint = "Map the forming results in section 4, and their checks stand here";
        nothing_yet(ui, "Nothing is mapped at this pose", hint);
        return;
    };
    let scroll = &mut ui.spacing_mut().scroll;
    scroll.floating_allocated_width = scroll.bar_width;
    if ui.available_width() < NARROW {
        return one_by_one_ui(ui, state, result, commands);
    }
    let (width, height) = (ui.available_width(), ui.available_height());
    // The names of the checks are read whole, and six percentiles stand beside each other.
    let widths = [0.39 * width, 0.285 * width, 0.325 * width - 44.0];
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 20.0;
        for (view, width) in View::ALL.into_iter().zip(widths) {
            ui.allocate_ui_with_layout(vec2(width, height), Layout::top_down(Align::Min), |ui| {
                ui.set_width(width);
                ui.spacing_mut().item_spacing.x = 8.0;
                view.show(ui, state, result, commands);
            });
        }
    });
}

/// In a pane narrower than this only one of the three is shown at a time.
const NARROW: f32 = 860.0;

/// What the tab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum View {
    Checks,
    Distribution,
    Probe,
}

impl View {
    const ALL: [Self; 3] = [Self::Checks, Self::Distribution, Self::Probe];

    fn label(self) -> &'static str {
        match self {
            Self::Checks => "Checks",
            Self::Distribution => "Distribution",
            Self::Probe => "Probe",
        }
    }

    fn show(self, ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
        match self {
            Self::Checks => checks_ui(ui, state, result, commands),
            Self::Distribution => distributions_ui(ui, state, result, commands),
            Self::Probe => probe_ui(ui, state, commands),
        }
    }
}

/// One of the three below a choice between them.
fn one_by_one_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let id = ui.scope_id().with("mapping view");
    let now = ui.data(|data| data.get_temp(id)).unwrap_or(View::Checks);
    let labels = View::ALL.map(|view| (view.label(), view == now, true));
    let width = 300.0_f32.min(ui.available_width());
    if let Some(index) = segments(ui, &labels, width) {
        ui.data_mut(|data| data.insert_temp(id, View::ALL[index]));
    }
    now.show(ui, state, result, commands);
}

/// One row for each check; a click shows the picture in which it is seen and flies to the worst place.
fn checks_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let checks = &result.record.checks;
    let (n_met, n_asked) = result.record.n_met();
    let title = format!("Checks: {n_met} of {n_asked} met (click to see)");
    caption(ui, title);
    ui.spacing_mut().item_spacing.y = 0.0;
    // A table keeps its columns as wide as they were first: one for each width.
    let width = ui.available_width().round() as u32;
    TableBuilder::new(ui)
        .id_salt(("mapping checks", width))
        .sense(Sense::click())
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::exact(14.0))
        .column(Column::remainder().clip(true))
        .column(Column::exact(62.0).clip(true))
        .column(Column::exact(92.0).clip(true))
        .body(|body| {
            body.rows(LINE, checks.len(), |mut row| {
                let check = &checks[row.index()];
                let palette = row_palette(&mut row, check);
                row.col(|ui| {
                    ui.add(egui::Label::new(&check.name).truncate());
                });
                row.col(|ui| {
                    ui.add(egui::Label::new(&check.found).truncate());
                });
                row.col(|ui| {
                    let text = RichText::new(&check.limit).small().color(palette);
                    ui.add(egui::Label::new(text).truncate());
                });
                let response = row.response();
                response.widget_info(|| {
                    let met = match check.is_met {
                        Some(true) => ", met",
                        Some(false) => ", not met",
                        None => "",
                    };
                    let name = format!("{}: {}{met}", check.name, check.found);
                    egui::WidgetInfo::labeled(egui::Role::Button, true, name)
                });
                if response.clicked() {
                    show_check(state, result, check, commands);
                }
                if let Some(reason) = check.reason {
                    response.on_hover_text(reason.label());
                }
            });
        });
}

/// The mark of a check; the quiet colour of its table.
fn row_palette(row: &mut egui_extras::TableRow<'_, '_>, check: &CheckRecord) -> egui::Color32 {
    let mut quiet = egui::Color32::GRAY;
    row.col(|ui| {
        let palette = Palette::of(ui);
        quiet = palette.secondary;
        let (sign, color) = match check.is_met {
            Some(true) => ("✔", palette.good),
            Some(false) => ("✖", palette.poor),
            None => ("·", palette.secondary),
        };
        ui.label(RichText::new(sign).small().color(color));
    });
    quiet
}

fn show_check(
    state: &AppState,
    result: &MapResult,
    check: &CheckRecord,
    commands: &mut Vec<Command>,
) {
    let display = state.with_check(check.picture);
    commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
    if let Some(worst) = check.worst {
        let look = InspectCommand::LookAt {
            role: Role::Crash,
            point: result.run.target.mesh.centroids()[worst],
            text: check.name.clone(),
        };
        commands.push(look.into());
    }
}

/// The statistics of a quantity, where they were made.
fn pair_of(result: &MapResult, by: ColorBy) -> Option<&PairRecord> {
    let record = &result.record;
    match by {
        ColorBy::Thickness => record.thickness.as_ref(),
        ColorBy::PlasticStrain => record.plastic_strain.as_ref(),
        ColorBy::VonMises => record.von_mises.as_ref(),
        _ => None,
    }
}

/// Percentiles and overlaid histograms of both sides.
fn distributions_ui(
    ui: &mut Ui,
    state: &AppState,
    result: &MapResult,
    commands: &mut Vec<Command>,
) {
    let by = state.map_quantity();
    if let Some(comparison) = &result.record.comparison
        && state.color_by(Role::Crash) == ColorBy::MapOther
    {
        // Within its own height: the pane grows with nothing that is in it.
        egui::ScrollArea::vertical()
            .id_salt("mapping compared")
            .auto_shrink([false, false])
            .show(ui, |ui| {
                compared_ui(ui, state, (result, comparison), commands);
            });
        return;
    }
    let Some(pair) = pair_of(result, by) else {
        caption(
            ui,
            format!("{}: no statistics of this quantity", by.label()),
        );
        return;
    };
    let of_layers = match by {
        ColorBy::PlasticStrain => ", mean of the layers",
        ColorBy::VonMises => ", largest of the layers",
        _ => "",
    };
    caption(ui, format!("{}{of_layers}, by area", by.label()));
    let palette = Palette::of(ui);
    let rows = [
        ("▲", &pair.stamped, palette.stamped),
        ("■", &pair.crash, palette.crash),
    ];
    percentiles_ui(ui, &rows);
    let size = vec2(ui.available_width(), ui.available_height().max(40.0));
    histogram_ui(ui, pair, size);
}

/// The mapping against another result: both sides by area, the differences, and the way to the largest.
fn compared_ui(
    ui: &mut Ui,
    state: &AppState,
    (result, comparison): (&MapResult, &ComparisonRecord),
    commands: &mut Vec<Command>,
) {
    let by = state.map_quantity();
    let files = file_names(&comparison.files);
    caption(ui, format!("{} against {files}, by area", by.label()));
    let record = match by {
        ColorBy::Thickness => comparison.thickness.as_ref(),
        ColorBy::PlasticStrain => comparison.plastic_strain.as_ref(),
        ColorBy::VonMises => comparison.von_mises.as_ref(),
        ColorBy::MajorStrain => comparison.major_strain.as_ref(),
        ColorBy::MinorStrain => comparison.minor_strain.as_ref(),
        _ => None,
    };
    let Some(record) = record else {
        let hint = "no statistics of this quantity, or the other file has nothing of it";
        caption(ui, hint);
        return;
    };
    let palette = Palette::of(ui);
    let rows = [
        ("here", &record.here, palette.crash),
        ("there", &record.other, palette.secondary),
    ];
    percentiles_ui(ui, &rows);
    ui.add_space(2.0);
    let numbers = format!(
        "mean difference {} · RMS {} · 95\u{a0}%\u{a0}below {}",
        signed(record.mean),
        length(record.rms),
        length(record.p95)
    );
    ui.add(egui::Label::new(RichText::new(numbers).small()).wrap());
    let worst = format!(
        "largest {} at element {}",
        length(record.max),
        record.element
    );
    let go = ui.button(RichText::new(worst).small());
    if go.on_hover_text("Look there").clicked() {
        look_at_element(state, result, record.element, commands);
    }
    let text = format!(
        "{} in both, {} only here, {} only there; {} compared",
        grouped(comparison.n_both),
        grouped(comparison.n_only_here),
        grouped(comparison.n_only_other),
        grouped(record.n_elements)
    );
    let text = RichText::new(text).small().color(palette.secondary);
    ui.add(egui::Label::new(text).wrap());
}

fn look_at_element(state: &AppState, result: &MapResult, id: u64, commands: &mut Vec<Command>) {
    let Some(crash) = state.document.part(Role::Crash) else {
        return;
    };
    let mut all = 0..result.run.shells.len();
    let Some(element) = all.find(|&element| result.element_id(&crash.loaded, element) == id) else {
        return;
    };
    let look = InspectCommand::LookAt {
        role: Role::Crash,
        point: result.run.target.mesh.centroids()[element],
        text: format!("element {id}"),
    };
    commands.push(look.into());
}

/// One row for each side: its sign, its numbers, its colour.
fn percentiles_ui(ui: &mut Ui, rows: &[(&str, &DistributionRecord, egui::Color32)]) {
    let palette = Palette::of(ui);
    let titles = ["mean", "5 %", "50 %", "95 %", "99 %", "max"];
    let numbers =
        |of: &DistributionRecord| [of.mean, of.p5, of.p50, of.p95, of.p99, of.max].map(length);
    let quiet = |text: &str| RichText::new(text).small().color(palette.secondary);
    egui::Grid::new("mapping percentiles")
        .num_columns(titles.len() + 1)
        .spacing(vec2(6.0, 0.0))
        .min_row_height(15.0)
        .show(ui, |ui| {
            ui.label("");
            for title in titles {
                ui.label(quiet(title));
            }
            ui.end_row();
            for (name, of, color) in rows {
                ui.label(RichText::new(*name).small().color(*color));
                for number in numbers(of) {
                    ui.label(RichText::new(number).small());
                }
                ui.end_row();
            }
        });
}

/// Share of the area over the value, as two stepped lines.
fn histogram_ui(ui: &mut Ui, pair: &PairRecord, size: egui::Vec2) {
    let palette = Palette::of(ui);
    let low = pair.stamped.min.min(pair.crash.min);
    let high = pair.stamped.max.max(pair.crash.max);
    let steps = |shares: &[f64]| -> PlotPoints<'static> {
        let width = (high - low) / shares.len().max(1) as f64;
        let at = |bin: usize| low + width * bin as f64;
        let corners = shares.iter().enumerate();
        let corners = corners.flat_map(|(bin, share)| [[at(bin), *share], [at(bin + 1), *share]]);
        corners.collect::<Vec<_>>().into()
    };
    charts::still_chart(ui, "mapping histogram", size)
        .include_y(0.0)
        .y_axis_min_width(36.0)
        .y_axis_formatter(|mark, _| percent(mark.value))
        .show(ui, |plot| {
            let [stamped, crash] = &pair.histograms;
            let line = Line::new("▲ stamped", steps(stamped)).fill(0.0);
            plot.line(line.color(palette.stamped).width(1.5).fill_alpha(0.15));
            let line = Line::new("■ crash, mapped", steps(crash)).fill(0.0);
            plot.line(line.color(palette.crash).width(1.5).fill_alpha(0.15));
        });
}

/// One element: where its values come from, both sides in numbers and through the thickness.
fn probe_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(probe) = state.probe() else {
        caption(ui, "Probe");
        caption(ui, "Click an element of either part to see its values here");
        pins_ui(ui, state, commands);
        return;
    };
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let go = ui.button(probe.id.to_string()).on_hover_text("Look there");
        let go = go.accessible_name(format!("Element {}", probe.id));
        if go.clicked() {
            let look = InspectCommand::LookAt {
                role: Role::Crash,
                point: probe.center,
                text: format!("element {}", probe.id),
            };
            commands.push(look.into());
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let end = ("×", Look::Plain, vec2(ROW, ROW));
            let button = action_button(ui, state, Action::EndProbe, end, commands);
            button.accessible_name(Action::EndProbe.row().label);
            let is_pinned = state.document.mapping.pins.contains(&probe.id);
            let pin = if is_pinned {
                ("Pinned", Look::Primary, vec2(0.0, ROW))
            } else {
                ("Pin", Look::Plain, vec2(0.0, ROW))
            };
            let button = action_button(ui, state, Action::PinProbe, pin, commands);
            button.accessible_name(Action::PinProbe.row().label);
            pins_ui(ui, state, commands);
        });
    });
    let text = RichText::new(facts(state, &probe)).small();
    let text = text.color(Palette::of(ui).secondary);
    ui.add(egui::Label::new(text).wrap());
    let width = ui.available_width();
    let height = ui.available_height();
    ui.horizontal_top(|ui| {
        let table = vec2(0.5 * width, height);
        ui.allocate_ui_with_layout(table, Layout::top_down(Align::Min), |ui| {
            values_ui(ui, &probe);
        });
        profile_ui(ui, &probe, vec2(ui.available_width(), height));
    });
}

/// The elements that were pinned for the report: a click probes one and flies there, the cross takes it out.
fn pins_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let pins = &state.document.mapping.pins;
    if pins.is_empty() {
        return;
    }
    let label = format!("{} ▾", grouped(pins.len()));
    let (button, _) = egui::containers::menu::MenuButton::new(label).ui(ui, |ui| {
        caption(ui, "Pinned for the report");
        for &id in pins {
            ui.horizontal(|ui| {
                let element = state.document.mapped_element(Role::Crash, id);
                let name = format!("Element {id}");
                let go = ui.add_enabled(element.is_some(), egui::Button::new(name));
                if go.clicked() {
                    commands.push(MapCommand::Probe(element).into());
                    if let Some(result) = state.document.current_mapping() {
                        look_at_element(state, result, id, commands);
                    }
                    ui.close();
                }
                let remove = ui.button("×").on_hover_text("Take it out of the report");
                let remove = remove.accessible_name(format!("Remove the pin of element {id}"));
                if remove.clicked() {
                    commands.push(MapCommand::TogglePin(id).into());
                }
            });
        }
    });
    let button = button.on_hover_text("Elements that were pinned for the report");
    button.accessible_name("Pinned elements");
}

/// What became of it and where the values come from, in a line.
fn facts(state: &AppState, probe: &ProbeReport) -> String {
    let [distance, angle, coverage, confidence] = probe.facts;
    let status = probe.status.label();
    let Some(stamped) = probe.stamped_id else {
        return format!("{status} · no stamped element gave it values");
    };
    format!(
        "{status} from ▲ {stamped} · {} · {angle:.0}° · {} covered · confidence {confidence:.2}",
        state.lengths().signed_of(distance),
        percent(coverage),
    )
}

fn values_ui(ui: &mut Ui, probe: &ProbeReport) {
    let palette = Palette::of(ui);
    let number = |value: f64| {
        if value.is_finite() {
            length(value)
        } else {
            "–".to_owned()
        }
    };
    egui::ScrollArea::vertical()
        .id_salt("probe values")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            egui::Grid::new("probe values")
                .num_columns(3)
                .spacing(vec2(8.0, 1.0))
                .min_row_height(16.0)
                .show(ui, |ui| {
                    ui.label("");
                    ui.label(RichText::new("▲").small().color(palette.stamped));
                    ui.label(RichText::new("■").small().color(palette.crash));
                    ui.end_row();
                    for (by, [stamped, crash]) in &probe.values {
                        ui.label(RichText::new(by.label()).small().color(palette.secondary));
                        ui.label(RichText::new(number(*stamped)).small());
                        ui.label(RichText::new(number(*crash)).small());
                        ui.end_row();
                    }
                });
        });
}

/// Value over T: bottom −1, top +1; points are the layers.
fn profile_ui(ui: &mut Ui, probe: &ProbeReport, size: egui::Vec2) {
    let Some(by) = probe.profile_of else {
        caption(ui, "no quantity with layers was mapped");
        return;
    };
    let upright = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|[t, value]| [*value, *t]).collect()
    };
    let stamped = upright(&probe.profile.stamped);
    let crash = upright(&probe.profile.crash);
    let values = stamped.iter().chain(&crash).map(|point| point[0]);
    let range = charts::margined(values);
    ui.vertical(|ui| profile_plot(ui, by, [stamped, crash], (range, size)));
}

/// The line of each side, values to the right.
fn profile_plot(
    ui: &mut Ui,
    by: ColorBy,
    [stamped, crash]: [Vec<[f64; 2]>; 2],
    (range, size): (Option<[f64; 2]>, egui::Vec2),
) {
    let palette = Palette::of(ui);
    let before = ui.cursor().top();
    caption(ui, format!("{} over T", by.label()));
    let size = vec2(
        size.x - 16.0,
        (size.y - (ui.cursor().top() - before)).max(40.0),
    );
    let mut plot = charts::still_chart(ui, "profile", size)
        .include_y(-1.1)
        .include_y(1.1)
        .y_axis_min_width(26.0)
        .x_grid_spacer(|input| charts::inner_marks(input.bounds))
        .x_axis_formatter(|mark, range| {
            charts::inner_text(mark.value, (*range.start(), *range.end()))
        });
    if let Some([low, high]) = range {
        plot = plot.include_x(low).include_x(high);
    }
    plot.show(ui, |plot| {
        let line = Line::new("▲ stamped", stamped.clone());
        plot.line(line.color(palette.stamped).width(1.5));
        let points = Points::new("▲ stamped", stamped).shape(MarkerShape::Up);
        plot.points(points.color(palette.stamped).radius(4.0));
        let line = Line::new("■ crash", crash.clone());
        plot.line(line.color(palette.crash).width(1.5));
        let points = Points::new("■ crash", crash).shape(MarkerShape::Square);
        plot.points(points.color(palette.crash).radius(3.5));
    });
}
