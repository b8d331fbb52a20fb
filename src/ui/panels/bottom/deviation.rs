//! How far the parts lie apart: numbers of both directions, the worst places, pinned labels.

use std::fmt::Write as _;

use egui::{Align, Button, Layout, RichText, ScrollArea, Sense, TextEdit, Ui, vec2};
use egui_extras::{Column, TableBuilder};

use crate::app::{
    Action, AppState, Command, ExportCommand, Freshness, GestureId, InspectCommand, ViewCommand,
};
use crate::assess::deviation::{DeviationStats, OverlapClass};
use crate::geometry::Point3;
use crate::pipeline::inspect::Comparison;
use crate::report::distances::{COMPARED_P95, COMPARED_RMS};
use crate::role::Role;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{
    Look, action_button, caption, chip, icon_button, nothing_yet, percent, role_mark, text_field,
};

/// Height of a row.
const LINE: f32 = 20.0;
/// Height of a row of numbers, so that the largest stand there without scrolling.
const NUMBER: f32 = 16.0;

/// A pane narrower than this has room for two lists.
const NARROW: f32 = 720.0;
/// Air between the lists, and between the columns of one.
const BETWEEN: f32 = 20.0;
const GAP: f32 = 8.0;
/// What a row of the places and one of the labels need.
const SPOTS: f32 = 250.0;
const LABELS: f32 = 200.0;

/// Head line and three lists side by side.
pub fn deviation_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(comparison) = state.comparison() else {
        let (title, hint) = match state.freshness() {
            Freshness::Updating => ("The deviation is being measured", ""),
            _ if state.document.both().is_some() => (
                "Not measured yet",
                "It is measured as soon as nothing else runs",
            ),
            _ => (
                "No deviation yet",
                "Load both parts, and the distances between them stand here",
            ),
        };
        nothing_yet(ui, title, hint);
        return;
    };
    // A bar that is shown beside the digits, not over them.
    let scroll = &mut ui.spacing_mut().scroll;
    scroll.floating_allocated_width = scroll.bar_width;
    head_ui(ui, state, comparison, commands);
    let height = ui.available_height();
    let width = ui.available_width();
    let has_labels = state.document.shown_labels().next().is_some();
    let rows = rows(state, comparison);
    let columns = columns(ui, (width, has_labels), rows_width(ui, &rows));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = BETWEEN;
        for (width, column) in columns {
            ui.allocate_ui_with_layout(vec2(width, height), Layout::top_down(Align::Min), |ui| {
                ui.set_width(width);
                ui.spacing_mut().item_spacing.x = GAP;
                match column {
                    Column3::Numbers => numbers_ui(ui, state, comparison, &rows),
                    Column3::Spots => spots_ui(ui, state, comparison, commands),
                    Column3::Labels => labels_ui(ui, state, commands),
                }
            });
        }
    });
}

/// The lists that have room, each with its width. The numbers have what their longest row needs, the other lists the
/// rest.
fn columns(ui: &Ui, (width, has_labels): (f32, bool), rows_width: f32) -> Vec<(f32, Column3)> {
    let beside_bar = ui.spacing().scroll.bar_width;
    let room = width - beside_bar - BETWEEN;
    let numbers = rows_width.min(0.6 * room);
    match (width < NARROW, has_labels) {
        (false, _) => {
            let rest = room - numbers - BETWEEN;
            let labels = (0.42 * rest).max(LABELS.min(rest - SPOTS));
            vec![
                (numbers, Column3::Numbers),
                (rest - labels, Column3::Spots),
                (labels, Column3::Labels),
            ]
        }
        (true, false) => vec![
            (numbers, Column3::Numbers),
            (room - numbers, Column3::Spots),
        ],
        // What was pinned is looked at.
        (true, true) => vec![
            (0.53 * room, Column3::Spots),
            (0.47 * room, Column3::Labels),
        ],
    }
}

/// The three lists.
#[derive(Debug, Clone, Copy)]
enum Column3 {
    Numbers,
    Spots,
    Labels,
}

/// Which part carries the colours, whether the numbers are up to date, and the way out.
fn head_ui(ui: &mut Ui, state: &AppState, comparison: &Comparison, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.set_min_height(ROW);
        let is_on = state.view.display.color_by == crate::app::ColorBy::Deviation;
        let look = if is_on { Look::On } else { Look::Plain };
        let map = ("Deviation map", look, vec2(0.0, ROW));
        action_button(ui, state, Action::ToggleDeviation, map, commands);
        for (role, name) in [(Role::Stamped, "on ▲ stamped"), (Role::Crash, "on ■ crash")] {
            let mut display = state.view.display.clone();
            let on = display.coloring.on.get_mut(role);
            if chip(ui, name, is_on && *on).clicked() {
                // A click on a map that is off shows it on that part.
                *on = !(is_on && *on);
                display.color_by = crate::app::ColorBy::Deviation;
                commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
            }
        }
        freshness_ui(ui, state, commands);
        if let Some(shown) = measured_at(state) {
            ui.label(RichText::new(format!("at {shown}")).color(Palette::of(ui).check));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("Copy as CSV").clicked() {
                let text = csv(state, comparison);
                let what = match measured_at(state) {
                    Some(shown) => format!("Deviation at {shown} (CSV)"),
                    None => "Deviation (CSV)".to_owned(),
                };
                commands.push(ExportCommand::CopyText { text, what }.into());
            }
            let sign = if comparison.deviation.is_signed {
                "full meshes · + in front of the crash part, on the side of its normals"
            } else {
                "full meshes · without sign: the crash part has no clear sides"
            };
            ui.add(
                egui::Label::new(RichText::new(sign).small().color(Palette::of(ui).secondary))
                    .truncate(),
            );
        });
    });
}

/// The pose that the numbers stand for, where it is not that of the part.
fn measured_at(state: &AppState) -> Option<String> {
    let is_of_shown = state.freshness() == Freshness::Current;
    state.shown_instead().filter(|_| is_of_shown)
}

fn freshness_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    match state.freshness() {
        Freshness::Current | Freshness::Missing => {}
        Freshness::Updating => {
            let color = Palette::of(ui).check;
            ui.label(RichText::new("measuring…").color(color));
        }
        Freshness::OutOfDate => {
            let color = Palette::of(ui).check;
            ui.label(RichText::new("out of date").color(color));
            let update = ("Update", Look::Plain, vec2(0.0, ROW));
            action_button(ui, state, Action::UpdateDeviation, update, commands);
        }
    }
}

/// Name of a row and its value in both directions.
fn rows(state: &AppState, comparison: &Comparison) -> Vec<NumberRow> {
    let tolerance = state.deviation_scale().map_or(0.0, |scale| scale.tolerance);
    let deviation = &comparison.deviation;
    let both = [&deviation.source_on_target, &deviation.target_on_source];
    let shares = |name: &str, of: &dyn Fn(&DeviationStats) -> String| {
        (name.to_owned(), both.map(|way| of(&way.stats)))
    };
    // Where nothing has a counterpart there is no distance, and 0 would be one.
    let row = |name: &str, of: &dyn Fn(&DeviationStats) -> String| {
        let of_way = |stats: &DeviationStats| match stats.is_empty() {
            true => "–".to_owned(),
            false => of(stats),
        };
        (name.to_owned(), both.map(|way| of_way(&way.stats)))
    };
    let lengths = state.lengths();
    let inside = format!("within ±{}", lengths.of(tolerance));
    let mut rows = vec![
        row(&inside, &|s| percent(s.share_inside(tolerance))),
        row("mean", &|s| lengths.signed(s.mean)),
        // Beside those of the overlap, which leave out what lies beyond the limit.
        row(COMPARED_RMS.name, &|s| lengths.number(s.rms)),
        row(COMPARED_P95.name, &|s| lengths.number(s.p95)),
        row("min", &|s| lengths.signed(s.min)),
        row("max", &|s| lengths.signed(s.max)),
        row("standard deviation", &|s| lengths.number(s.std)),
    ];
    for (index, class) in OverlapClass::ALL.into_iter().enumerate() {
        let name = match class {
            OverlapClass::Matched => {
                format!("{} ≤ {}", class.label(), lengths.of(deviation.limit))
            }
            OverlapClass::OffByMore | OverlapClass::OnlyHere => class.label().to_owned(),
        };
        rows.push(shares(&name, &|s| percent(s.class_shares[index])));
    }
    rows
}

/// A row of numbers: its name and the values of both directions.
type NumberRow = (String, [String; 2]);

/// What the two directions are called.
const WAYS: [&str; 2] = ["▲ → ■", "■ → ▲"];

/// Widths of the names and of the values.
fn row_widths(ui: &Ui, rows: &[NumberRow]) -> [f32; 2] {
    let names = rows.iter().map(|(name, _)| name.as_str());
    let values = rows.iter().flat_map(|(_, values)| values);
    let values = values.map(String::as_str).chain(WAYS);
    [widest(ui, names), widest(ui, values)]
}

/// Width of a column that holds these texts whole.
fn widest<'a>(ui: &Ui, texts: impl Iterator<Item = &'a str>) -> f32 {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let width = |text: &str| {
        let color = egui::Color32::PLACEHOLDER;
        let laid = ui
            .painter()
            .layout_no_wrap(text.to_owned(), font.clone(), color);
        laid.size().x
    };
    texts.map(width).fold(0.0, f32::max).ceil() + 1.0
}

/// Width of the longest row.
fn rows_width(ui: &Ui, rows: &[NumberRow]) -> f32 {
    let [names, values] = row_widths(ui, rows);
    names + 2.0 * (GAP + values) + ui.spacing().scroll.bar_width + GAP
}

fn numbers_ui(ui: &mut Ui, state: &AppState, comparison: &Comparison, rows: &[NumberRow]) {
    ui.spacing_mut().item_spacing.y = 0.0;
    if let Some(offset) = &comparison.deviation.source_on_target.stats.offset {
        let words = offset.words(|value| state.lengths().of(value));
        let text = RichText::new(format!("Constant offset: {words}"));
        ui.add(egui::Label::new(text).wrap());
    }
    let unit = state.document.unit_suffix();
    let width = ui.available_width().round() as i32;
    let [_, values] = row_widths(ui, rows);
    TableBuilder::new(ui)
        .id_salt(("deviation numbers", width, values as i32))
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::remainder().clip(true))
        .columns(Column::exact(values), 2)
        .header(NUMBER, |mut header| {
            header.col(|ui| {
                if !unit.is_empty() {
                    caption(ui, format!("lengths in{unit}"));
                }
            });
            for title in WAYS {
                header.col(|ui| {
                    right(
                        ui,
                        RichText::new(title)
                            .small()
                            .color(Palette::of(ui).secondary),
                    );
                });
            }
        })
        .body(|body| {
            body.rows(NUMBER, rows.len(), |mut row| {
                let (name, values) = &rows[row.index()];
                row.col(|ui| {
                    let text = RichText::new(name).color(Palette::of(ui).secondary);
                    let label = ui.add(egui::Label::new(text).truncate());
                    let named = [COMPARED_RMS, COMPARED_P95].into_iter();
                    for measure in named.filter(|measure| measure.name == name) {
                        label.clone().on_hover_text(measure.help);
                    }
                });
                for value in values {
                    row.col(|ui| right(ui, RichText::new(value)));
                }
            });
        });
}

fn right(ui: &mut Ui, text: RichText) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(text));
}

/// The worst places of both directions; a click flies there, the pin keeps them in the picture.
fn spots_ui(ui: &mut Ui, state: &AppState, comparison: &Comparison, commands: &mut Vec<Command>) {
    let spots = comparison.worst_spots();
    caption(ui, "Largest deviations (click to zoom)");
    if spots.is_empty() {
        let both = [
            &comparison.deviation.source_on_target,
            &comparison.deviation.target_on_source,
        ];
        let are_apart = both.iter().all(|way| way.stats.is_empty());
        caption(
            ui,
            if are_apart {
                "none: nothing has a counterpart"
            } else {
                "none: the parts coincide"
            },
        );
        return;
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    // A mark is as high as this, and would make each row reach into the next.
    ui.spacing_mut().interact_size.y = LINE;
    // A table keeps its columns: one for each width.
    let width = ui.available_width().round() as i32;
    let values: Vec<String> = spots
        .iter()
        .map(|found| state.lengths().signed_of(found.spot.value))
        .collect();
    let value_width = widest(ui, values.iter().map(String::as_str));
    TableBuilder::new(ui)
        .id_salt(("worst places", width, value_width as i32))
        .sense(Sense::click())
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::exact(18.0))
        .column(Column::exact(value_width))
        .column(Column::remainder().clip(true))
        .column(Column::exact(30.0))
        .body(|body| {
            body.rows(LINE, spots.len(), |mut row| {
                let found = &spots[row.index()];
                let role = found.role;
                let place = found.spot.position;
                let value = &values[row.index()];
                let node = match found.node {
                    Some(node) => format!("node {node}"),
                    None => format!("vertex {}", found.spot.vertex),
                };
                row.col(|ui| {
                    role_mark(ui, role);
                });
                row.col(|ui| {
                    ui.label(value);
                });
                row.col(|ui| node_ui(ui, &node));
                row.col(|ui| {
                    let name = format!("Pin {value} at {node}");
                    let pin = ui
                        .add(Button::new("+").small())
                        .on_hover_text("Pin a label here");
                    if pin.accessible_name(name).clicked() {
                        commands.push(InspectCommand::Pin(role, place).into());
                    }
                });
                let response = row.response();
                response.widget_info(|| {
                    let name = format!("{} {value} at {node}", role.word());
                    egui::WidgetInfo::labeled(egui::Role::Button, true, name)
                });
                if response.clicked() {
                    commands.push(look_at(role, place, format!("{value} · {node}")));
                }
            });
        });
}

/// A node with its number; the number alone rather than cut.
fn node_ui(ui: &mut Ui, node: &str) {
    let has_room = widest(ui, [node].into_iter()) <= ui.available_width();
    let number = node.split(' ').next_back().unwrap_or(node);
    let text = RichText::new(if has_room { node } else { number });
    let text = text.color(Palette::of(ui).secondary);
    ui.add(egui::Label::new(text).truncate());
}

/// The pinned labels: value, place, name, the way to them, and the way out.
fn labels_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let labels: Vec<_> = state.document.shown_labels().collect();
    ui.horizontal(|ui| {
        caption(ui, "Pinned labels");
        if !labels.is_empty() {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let button = Button::new(RichText::new("Remove all").small()).small();
                if ui.add(button).clicked() {
                    commands.push(InspectCommand::RemoveAll.into());
                }
            });
        }
    });
    if labels.is_empty() {
        caption(ui, "Click on the map to pin the value of a node");
        return;
    }
    let area = ScrollArea::vertical()
        .id_salt("labels")
        .auto_shrink([false, false]);
    area.show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        for (role, label) in labels {
            label_ui(ui, state, (role, label), commands);
        }
    });
}

fn look_at(role: Role, point: Point3, text: String) -> Command {
    InspectCommand::LookAt { role, point, text }.into()
}

fn label_ui(
    ui: &mut Ui,
    state: &AppState,
    (role, label): (Role, &crate::app::Label),
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        role_mark(ui, role);
        let value = state.label_text(label);
        let node = label.node.map_or_else(
            || format!("vertex {}", label.vertex),
            |n| format!("node {n}"),
        );
        let go = Button::new(value).min_size(vec2(60.0, LINE));
        let response = ui.add(go).on_hover_text(format!("Go to {node}"));
        let response = response.accessible_name(format!("Go to {node}"));
        if response.clicked() {
            commands.push(look_at(role, label.position, node.clone()));
        }
        let end = RowEnd::new(ui, label.id);
        end.before(ui, |ui| {
            let mut name = label.name.clone();
            let field = TextEdit::singleline(&mut name)
                .hint_text(&node)
                .desired_width(f32::INFINITY);
            let response = text_field(ui, field).accessible_name(format!("Name of {node}"));
            if response.changed() {
                // One step for one stay in the field.
                let gesture = GestureId::of_label(label.id);
                let id = label.id;
                commands.push(InspectCommand::Rename { id, name, gesture }.into());
            }
        });
        end.show(ui, |ui| {
            let remove = icon_button(ui, "×", &format!("Remove the label at {node}"), true);
            if remove.clicked() {
                commands.push(InspectCommand::Remove(label.id).into());
            }
        });
    });
}

/// Numbers, worst places and labels as a table for other programs.
fn csv(state: &AppState, comparison: &Comparison) -> String {
    let mut text = String::from("quantity,stamped to crash,crash to stamped\n");
    let deviation = &comparison.deviation;
    let both = [
        &deviation.source_on_target.stats,
        &deviation.target_on_source.stats,
    ];
    let tolerance = state.deviation_scale().map_or(0.0, |scale| scale.tolerance);
    let mut line = |name: &str, values: [f64; 2]| {
        // Writing into a text cannot fail.
        let _ = writeln!(text, "{name},{},{}", values[0], values[1]);
    };
    line("tolerance", [tolerance; 2]);
    line("share inside", both.map(|s| s.share_inside(tolerance)));
    line("mean", both.map(|s| s.mean));
    line(COMPARED_RMS.name, both.map(|s| s.rms));
    line("standard deviation", both.map(|s| s.std));
    line(COMPARED_P95.name, both.map(|s| s.p95));
    line("Min", both.map(|s| s.min));
    line("Max", both.map(|s| s.max));
    for (index, class) in OverlapClass::ALL.into_iter().enumerate() {
        line(class.label(), both.map(|s| s.class_shares[index]));
    }
    text += "\nplace,part,node,value,x,y,z\n";
    let mut place =
        |what: &str, role: Role, node: Option<u64>, value: Option<f64>, at: [f64; 3]| {
            let node = node.map_or_else(String::new, |n| n.to_string());
            let value = value.map_or_else(String::new, |v| v.to_string());
            let [x, y, z] = at;
            let _ = writeln!(text, "{what},{},{node},{value},{x},{y},{z}", role.word());
        };
    for found in comparison.worst_spots() {
        let at = found.spot.position.coords.into();
        place("worst", found.role, found.node, Some(found.spot.value), at);
    }
    for (role, label) in state.document.shown_labels() {
        let name = if label.name.is_empty() {
            "label".to_owned()
        } else {
            format!("\"{}\"", label.name.replace('"', "\"\""))
        };
        let value = state.label_value(label);
        place(&name, role, label.node, value, label.position.coords.into());
    }
    text
}
