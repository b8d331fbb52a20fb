//! One element of a mapping: where its values come from, both sides in numbers and through the thickness.

use egui::{RichText, Ui, vec2};
use egui_plot::{MarkerShape, Points};

use super::charts;
use super::mapping::{column_ui, look_at_element, number};
use crate::app::{Action, AppState, ColorBy, Command, InspectCommand, MapCommand, ProbeReport};
use crate::role::Role;
use crate::text::{grouped, inside};
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{Look, action_button, caption, paragraph, percent};

/// One element: where its values come from, both sides in numbers and through the thickness.
pub fn probe_ui(ui: &mut Ui, state: &AppState, is_low: bool, commands: &mut Vec<Command>) {
    let Some(probe) = state.probe() else {
        caption(ui, "Probe");
        caption(ui, "Click an element of either part to see its values here");
        pins_ui(ui, state, commands);
        return;
    };
    if is_low {
        return low_probe_ui(ui, state, &probe, commands);
    }
    probe_head_ui(ui, state, &probe, commands);
    facts_ui(ui, state, &probe);
    let (width, height) = (ui.available_width(), ui.available_height());
    ui.horizontal_top(|ui| {
        column_ui(ui, vec2(0.5 * width, height), |ui| {
            values_ui(ui, state, &probe, |_| {});
        });
        profile_ui(ui, state, &probe, vec2(ui.available_width(), height));
    });
}

/// Room of a low pane for the head of the probe, its values, and the profile beside each other.
const THREE: f32 = 560.0;

/// The probe in a low pane: the profile has its whole height.
fn low_probe_ui(ui: &mut Ui, state: &AppState, probe: &ProbeReport, commands: &mut Vec<Command>) {
    let (width, height) = (ui.available_width(), ui.available_height());
    ui.horizontal_top(|ui| {
        if width < THREE {
            column_ui(ui, vec2(0.52 * width, height), |ui| {
                probe_head_ui(ui, state, probe, commands);
                values_ui(ui, state, probe, |ui| facts_ui(ui, state, probe));
            });
        } else {
            column_ui(ui, vec2(0.34 * width, height), |ui| {
                probe_head_ui(ui, state, probe, commands);
                facts_ui(ui, state, probe);
            });
            column_ui(ui, vec2(0.28 * width, height), |ui| {
                values_ui(ui, state, probe, |_| {});
            });
        }
        profile_ui(ui, state, probe, vec2(ui.available_width(), height));
    });
}

/// The element, and what can be done with it.
fn probe_head_ui(ui: &mut Ui, state: &AppState, probe: &ProbeReport, commands: &mut Vec<Command>) {
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
        RowEnd::new(ui, "probe").show(ui, |ui| {
            pins_ui(ui, state, commands);
            let is_pinned = state.document.mapping.pins.contains(&probe.id);
            let pin = if is_pinned {
                ("Pinned", Look::Primary, vec2(0.0, ROW))
            } else {
                ("Pin", Look::Plain, vec2(0.0, ROW))
            };
            let button = action_button(ui, state, Action::PinProbe, pin, commands);
            button.accessible_name(Action::PinProbe.row().label);
            let end = ("×", Look::Plain, vec2(ROW, ROW));
            let button = action_button(ui, state, Action::EndProbe, end, commands);
            button.accessible_name(Action::EndProbe.row().label);
        });
    });
}

fn facts_ui(ui: &mut Ui, state: &AppState, probe: &ProbeReport) {
    let text = RichText::new(facts(state, probe)).small();
    let text = text.color(Palette::of(ui).secondary);
    ui.add(egui::Label::new(text).wrap());
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
                let element = state.document.mapped_element(id);
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
    let file = probe.stamped_file.as_ref();
    let file = file.map_or_else(String::new, |file| format!(" of {file}"));
    format!(
        "{status} from ▲ {stamped}{file} · {} · {angle:.0}° · {} covered · confidence {confidence:.2}",
        state.lengths().signed_of(distance),
        percent(coverage),
    )
}

/// Name of a quantity with its unit, where it has one that is known.
pub(super) fn with_unit(state: &AppState, by: ColorBy) -> String {
    match state.document.unit_of(Role::Crash, by.forming()) {
        Some(unit) => format!("{}, {unit}", by.label()),
        None => by.label().to_owned(),
    }
}

/// The values of both sides, below what stands `before` them.
fn values_ui(ui: &mut Ui, state: &AppState, probe: &ProbeReport, before: impl FnOnce(&mut Ui)) {
    let palette = Palette::of(ui);
    let text = |by: ColorBy, value: f64| {
        if value.is_finite() {
            number(by, value)
        } else {
            "–".to_owned()
        }
    };
    egui::ScrollArea::vertical()
        .id_salt("probe values")
        .auto_shrink([false, false])
        .show(ui, |ui| {
            before(ui);
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
                        // The unit says that it is a stress.
                        let name = with_unit(state, *by).replace(" stress,", ",");
                        ui.label(RichText::new(name).small().color(palette.secondary));
                        ui.label(RichText::new(text(*by, *stamped)).small());
                        ui.label(RichText::new(text(*by, *crash)).small());
                        ui.end_row();
                    }
                });
        });
}

/// Between the profile and the edge of the pane.
const MARGIN: f32 = 16.0;

/// Value over T: bottom −1, top +1; points are the layers.
fn profile_ui(ui: &mut Ui, state: &AppState, probe: &ProbeReport, size: egui::Vec2) {
    let Some(by) = probe.profile_of else {
        paragraph(ui, "No quantity with layers was mapped.");
        return;
    };
    let upright = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().map(|[t, value]| [*value, *t]).collect()
    };
    let stamped = upright(&probe.profile.stamped);
    let crash = upright(&probe.profile.crash);
    let values = stamped.iter().chain(&crash).map(|point| point[0]);
    let name = with_unit(state, by);
    let Some(range) = charts::margined(values) else {
        let text = format!("Neither part has {} here.", inside(by.label()));
        ui.vertical(|ui| {
            ui.set_max_width(size.x - MARGIN);
            paragraph(ui, text);
        });
        return;
    };
    ui.vertical(|ui| profile_plot(ui, &name, [stamped, crash], (range, size)));
}

/// The line of each side, values to the right.
fn profile_plot(
    ui: &mut Ui,
    name: &str,
    [stamped, crash]: [Vec<[f64; 2]>; 2],
    ([low, high], size): ([f64; 2], egui::Vec2),
) {
    let palette = Palette::of(ui);
    let before = ui.cursor().top();
    ui.set_max_width(size.x - MARGIN);
    // In two lines it would take the room of the chart, and the pane would grow.
    let title = RichText::new(format!("{name} through the thickness")).small();
    ui.add(egui::Label::new(title.color(palette.secondary)).truncate());
    let size = vec2(
        size.x - MARGIN,
        (size.y - (ui.cursor().top() - before)).max(40.0),
    );
    let plot = charts::still_chart(ui, "profile", size)
        .include_y(-1.1)
        .include_y(1.1)
        .include_x(low)
        .include_x(high)
        .y_axis_min_width(26.0);
    charts::with_inner_numbers(plot, size.x - 40.0).show(ui, |plot| {
        let line = charts::exact_line("▲ stamped", stamped.clone());
        plot.line(line.color(palette.stamped).width(1.5));
        let points = Points::new("▲ stamped", stamped).shape(MarkerShape::Up);
        plot.points(points.color(palette.stamped).radius(4.0));
        let line = charts::exact_line("■ crash", crash.clone());
        plot.line(line.color(palette.crash).width(1.5));
        let points = Points::new("■ crash", crash).shape(MarkerShape::Square);
        plot.points(points.color(palette.crash).radius(3.5));
    });
}

#[cfg(test)]
mod tests {
    use egui::{Context, RawInput, Rect, Shape, pos2};

    use super::*;
    use crate::app::Settings;
    use crate::geometry::Point3;
    use crate::mapping::Status;
    use crate::pipeline::map::Profile;

    /// The texts of a profile at the right edge of a pane, and how far they reach.
    fn painted(profile: &Profile) -> Vec<(String, f32)> {
        let state = AppState::new(Settings::default());
        let probe = ProbeReport {
            element: 0,
            id: 1,
            center: Point3::origin(),
            status: Status::ALL[0],
            stamped_id: None,
            stamped_file: None,
            facts: [f64::NAN; 4],
            values: Vec::new(),
            profile_of: Some(ColorBy::PlasticStrain),
            profile: profile.clone(),
        };
        let input = || RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(400.0, 160.0))),
            ..RawInput::default()
        };
        let ctx = Context::default();
        let draw = |ui: &mut Ui| {
            ui.horizontal_top(|ui| {
                ui.allocate_space(vec2(250.0, 20.0));
                let size = ui.available_size();
                profile_ui(ui, &state, &probe, size);
            });
        };
        ctx.run_ui(input(), draw).drop_without_applying_deltas();
        let output = ctx.run_ui(input(), draw);
        let texts = output
            .shapes
            .iter()
            .filter_map(|clipped| match &clipped.shape {
                Shape::Text(text) => {
                    let right = text.pos.x + text.galley.rect.right();
                    Some((text.galley.text().to_owned(), right))
                }
                _ => None,
            });
        let texts = texts.collect();
        output.drop_without_applying_deltas();
        texts
    }

    #[test]
    fn a_profile_keeps_its_margin_and_says_what_is_missing() {
        let points = vec![[-1.0, 0.1], [1.0, 0.2]];
        let full = Profile {
            stamped: points.clone(),
            crash: points,
        };
        let [with, without] = [&full, &Profile::default()].map(painted);
        let is_title = |(text, _): &&(String, f32)| text.ends_with("through the thickness");
        assert_eq!(with.iter().filter(is_title).count(), 1, "{with:?}");
        assert_eq!(without.len(), 1, "{without:?}");
        assert_eq!(without[0].0, "Neither part has plastic strain here.");
        for (text, right) in with.iter().chain(&without) {
            assert!(*right <= 400.0 - MARGIN, "{text} to {right}");
        }
    }
}
