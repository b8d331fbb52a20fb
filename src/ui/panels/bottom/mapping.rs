//! The mapping looked at closely: its checks, the distribution of a quantity on both sides, and the probe.

use egui::{Align, Layout, RichText, Sense, TextStyle, Ui, vec2};
use egui_extras::{Column, TableBuilder};
use egui_plot::PlotPoints;

use super::charts;
use super::percentiles::{CHART, PERCENTILE, fitting_columns, percentiles_ui};
use super::probe::{probe_ui, with_unit};
use crate::app::{
    AppState, ColorBy, Command, InspectCommand, MapResult, Section, ViewCommand, file_names,
};
use crate::pipeline::forming_values::FormingValue;
use crate::pipeline::map::{CheckRecord, ComparisonRecord, PairRecord};
use crate::role::Role;
use crate::text::{fixed, grouped, inside, sentence};
use crate::ui::panels::mapping::STALE;
use crate::ui::theme::Palette;
use crate::ui::widgets::{caption, length, nothing_yet, segments, signed};

/// Height of a row.
const LINE: f32 = 17.0;

/// Checks, distributions, probe, side by side.
pub fn mapping_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(result) = state.document.current_mapping() else {
        let hint = "Map the forming results in section 4, and their checks stand here";
        nothing_yet(ui, "Nothing is mapped at this pose", hint);
        return;
    };
    let scroll = &mut ui.spacing_mut().scroll;
    scroll.floating_allocated_width = scroll.bar_width;
    if ui.available_height() < LOW {
        return low_ui(ui, state, result, commands);
    }
    if ui.available_width() < NARROW {
        return one_by_one_ui(ui, state, result, commands);
    }
    let (width, height) = (ui.available_width(), ui.available_height());
    // The names of the checks are read whole, and six percentiles stand beside each other. While no element is
    // probed, the checks have most of its room.
    let probe = if state.probed().is_some() {
        0.325 * width
    } else {
        0.19 * width
    };
    let widths = [0.715 * width - probe, 0.285 * width, probe - 44.0];
    // In a wide pane a number stays beside its name.
    let widths = [0, 1, 2].map(|i| widths[i].min(WIDEST[i]));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 20.0;
        for (view, width) in View::ALL.into_iter().zip(widths) {
            column_ui(ui, vec2(width, height), |ui| {
                view.show(ui, state, (result, false), commands);
            });
        }
    });
}

/// A column of a row, as wide and high as this whatever is in it.
pub(super) fn column_ui(ui: &mut Ui, size: egui::Vec2, add_contents: impl FnOnce(&mut Ui)) {
    ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
        ui.set_width(size.x);
        ui.spacing_mut().item_spacing.x = 8.0;
        add_contents(ui);
    });
}

/// In a pane lower than this only one of the three is shown too, with its parts beside each other.
const LOW: f32 = 110.0;
/// Width of the choice between them there.
const CHOICE: f32 = 92.0;
/// Largest widths of the three.
const WIDEST: [f32; 3] = [620.0, 760.0, 640.0];

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

    fn show(
        self,
        ui: &mut Ui,
        state: &AppState,
        (result, is_low): (&MapResult, bool),
        commands: &mut Vec<Command>,
    ) {
        match self {
            Self::Checks => checks_ui(ui, state, result, commands),
            Self::Distribution => distributions_ui(ui, state, (result, is_low), commands),
            Self::Probe => probe_ui(ui, state, is_low, commands),
        }
    }
}

fn view_id() -> egui::Id {
    egui::Id::unique("mapping view")
}

/// The one that is shown where there is room for one: what was chosen, or the probe once an element is probed.
fn shown_view(ui: &Ui, state: &AppState) -> View {
    let probe = state.probed();
    let known: Option<(View, Option<usize>)> = ui.data(|data| data.get_temp(view_id()));
    let (mut view, before) = known.unwrap_or((View::Checks, None));
    if probe.is_some() && probe != before {
        view = View::Probe;
    }
    choose_view(ui, state, view);
    view
}

fn choose_view(ui: &Ui, state: &AppState, view: View) {
    let probe = state.probed();
    ui.data_mut(|data| data.insert_temp(view_id(), (view, probe)));
}

/// One of the three below a choice between them.
fn one_by_one_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let now = shown_view(ui, state);
    let labels = View::ALL.map(|view| (view.label(), view == now, true));
    let width = 300.0_f32.min(ui.available_width());
    if let Some(index) = segments(ui, &labels, width) {
        choose_view(ui, state, View::ALL[index]);
    }
    now.show(ui, state, (result, false), commands);
}

/// One of the three beside a choice between them, at full height.
fn low_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let now = shown_view(ui, state);
    let height = ui.available_height();
    ui.horizontal_top(|ui| {
        column_ui(ui, vec2(CHOICE, height), |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            let n = View::ALL.len() as f32;
            let size = vec2(CHOICE, ((height - (n - 1.0) * 2.0) / n).floor());
            for view in View::ALL {
                let button = egui::Button::selectable(view == now, view.label());
                let button = ui.add(button.min_size(size));
                if button.clicked() {
                    choose_view(ui, state, view);
                }
            }
        });
        ui.add_space(8.0);
        let width = match now {
            View::Checks => ui.available_width().min(WIDEST[0]),
            View::Distribution | View::Probe => ui.available_width(),
        };
        column_ui(ui, vec2(width, height), |ui| {
            now.show(ui, state, (result, true), commands);
        });
    });
}

/// One row for each check; a click shows the picture in which it is seen and flies to the worst place.
fn checks_ui(ui: &mut Ui, state: &AppState, result: &MapResult, commands: &mut Vec<Command>) {
    let checks = &result.record.checks;
    let (n_met, n_asked) = result.record.n_met();
    if let Some(stale) = state.stale(Section::Map) {
        let title = format!("Checks out of date: {n_met} of {n_asked} met then");
        let title = RichText::new(title).small().color(Palette::of(ui).check);
        let why = format!("{} Map again.", sentence(stale.reason));
        ui.label(title).on_hover_text(why);
        ui.multiply_opacity(STALE);
    } else {
        caption(
            ui,
            format!("Checks: {n_met} of {n_asked} met (click to see)"),
        );
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let [name, found] = check_columns(ui, checks);
    // A table keeps its columns as wide and its rows where they were first: one for each width and place.
    let place = [ui.available_width(), ui.cursor().left(), name, found];
    let place = place.map(|x| x.round() as i32);
    TableBuilder::new(ui)
        .id_salt(("mapping checks", place))
        .sense(Sense::click())
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::exact(SIGN))
        .column(Column::exact(name).clip(true))
        .column(Column::exact(found).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(LINE, checks.len(), |mut row| {
                let check = &checks[row.index()];
                let palette = row_palette(&mut row, check);
                row.col(|ui| {
                    ui.add(egui::Label::new(&check.name).truncate());
                });
                row.col(|ui| {
                    let found = egui::Label::new(&check.found).truncate();
                    // The tooltip of the row says it whole.
                    ui.add(found.show_tooltip_when_elided(false));
                });
                row.col(|ui| {
                    let text = RichText::new(&check.limit).small().color(palette);
                    if ui.available_width() >= LEAST[2] {
                        ui.add(egui::Label::new(text).truncate());
                    }
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
                response.on_hover_ui(|ui| {
                    let (name, found, limit) = (&check.name, &check.found, &check.limit);
                    ui.label(format!("{name}: {found} ({limit})"));
                    if let Some(reason) = check.reason {
                        ui.label(reason.label());
                    }
                });
            });
        });
}

/// Width of the column of marks.
const SIGN: f32 = 14.0;

/// Least widths of a name, of what was found and of what is asked for.
const LEAST: [f32; 3] = [80.0, 62.0, 60.0];

/// Widths of the names and of what was found, by their longest texts. Where not all of a row has room, what
/// was found is cut to three tenths of it first, then what is asked for, which is left out where a name would have to
/// be cut for it.
fn check_columns(ui: &Ui, checks: &[CheckRecord]) -> [f32; 2] {
    let widest = |style: TextStyle, text: fn(&CheckRecord) -> &str| {
        let font = style.resolve(ui.style());
        let of = |check: &CheckRecord| {
            let text = text(check).to_owned();
            let laid = ui
                .painter()
                .layout_no_wrap(text, font.clone(), egui::Color32::WHITE);
            laid.size().x.ceil() + 2.0
        };
        checks.iter().map(of).fold(0.0, f32::max)
    };
    let [name, found] = [
        widest(TextStyle::Body, |check| &check.name),
        widest(TextStyle::Body, |check| &check.found),
    ];
    let limit = widest(TextStyle::Small, |check| &check.limit);
    let gaps = 3.0 * ui.spacing().item_spacing.x + ui.spacing().scroll.bar_width;
    column_widths(ui.available_width() - SIGN - gaps, [name, found, limit])
}

fn column_widths(room: f32, [name, found, limit]: [f32; 3]) -> [f32; 2] {
    if name + LEAST[1] + LEAST[2] > room {
        let name = name.min((room - LEAST[1]).max(LEAST[0]));
        return [name, (room - name).max(LEAST[1])];
    }
    let fair = (room - name - limit).max(0.3 * room);
    let found = found.min(fair.min(room - name - LEAST[2]).max(LEAST[1]));
    [name, found]
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
            text: match check.is_met {
                Some(false) => check.name.clone(),
                Some(true) => format!("{}: met, worst here", check.name),
                None => format!("{}: worst here", check.name),
            },
        };
        commands.push(look.into());
    }
}

/// The statistics of a quantity, where they were made.
fn pair_of(result: &MapResult, by: ColorBy) -> Option<&PairRecord> {
    let record = &result.record;
    match by {
        ColorBy::Thickness => record.thickness.as_ref(),
        ColorBy::Thinning => record.thinning.as_ref(),
        ColorBy::PlasticStrain => record.plastic_strain.as_ref(),
        ColorBy::VonMises => record.von_mises.as_ref(),
        _ => None,
    }
}

/// Percentiles and overlaid histograms of both sides.
fn distributions_ui(
    ui: &mut Ui,
    state: &AppState,
    (result, is_low): (&MapResult, bool),
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
        ColorBy::VonMises => ", middle of the sheet",
        _ => "",
    };
    let room = ui.available_width() - if is_low { CHART } else { 0.0 };
    let columns = fitting_columns(room);
    let numbers = |ui: &mut Ui| {
        let of_thickness = matches!(by, ColorBy::Thickness | ColorBy::Thinning);
        let thickness = result.record.thickness.as_ref().filter(|_| of_thickness);
        let of_stamped = thickness
            .and_then(|thickness| thickness.stamped_factor)
            .map_or_else(String::new, |factor| {
                format!(", stamped thickness × {factor}")
            });
        let title = format!("{}{of_layers}, by area{of_stamped}", with_unit(state, by));
        caption(ui, title);
        let palette = Palette::of(ui);
        let rows = [
            ("▲", &pair.stamped, palette.stamped),
            ("■", &pair.crash, palette.crash),
        ];
        percentiles_ui(ui, &rows, columns, by);
    };
    if is_low {
        let height = ui.available_height();
        ui.horizontal_top(|ui| {
            let width = PERCENTILE * (columns.len() + 1) as f32;
            column_ui(ui, vec2(width, height), numbers);
            histogram_ui(ui, (pair, by), vec2(ui.available_width() - 8.0, height));
        });
        return;
    }
    numbers(ui);
    let size = vec2(ui.available_width(), ui.available_height().max(40.0));
    histogram_ui(ui, (pair, by), size);
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
    let Some(record) = comparison.of(by.forming()) else {
        let in_both = state.compared_quantities();
        if in_both.is_empty() {
            caption(ui, format!("{files} has no quantity that was mapped"));
            return;
        }
        let missing = inside(by.label());
        let text = format!("There are no figures of {missing} beside {files}, but of:");
        caption(ui, text);
        ui.horizontal_wrapped(|ui| {
            for other in in_both {
                if ui.button(other.label()).clicked() {
                    let display = state.with_map_quantity(other);
                    commands.push(ViewCommand::SetDisplay(Box::new(display)).into());
                }
            }
        });
        return;
    };
    let palette = Palette::of(ui);
    let rows = [
        ("here", &record.here, palette.crash),
        ("there", &record.other, palette.secondary),
    ];
    percentiles_ui(ui, &rows, fitting_columns(ui.available_width()), by);
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

pub(super) fn look_at_element(
    state: &AppState,
    result: &MapResult,
    id: u64,
    commands: &mut Vec<Command>,
) {
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

/// A number of a quantity as it is read, without its unit.
pub(super) fn number(by: ColorBy, value: f64) -> String {
    match by.forming() {
        Some(FormingValue::Thinning) => fixed(FormingValue::Thinning.shown_factor() * value, 1),
        _ => length(value),
    }
}

/// The outline of a histogram over a range. A corner stands only where the height changes: a line
/// through points that coincide has no direction there, and is drawn several times as wide.
fn outline(shares: &[f64], [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let width = (high - low) / shares.len().max(1) as f64;
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for (bin, &share) in shares.iter().enumerate() {
        let ends = [bin, bin + 1].map(|edge| low + width * edge as f64);
        match corners.last_mut() {
            Some([end, height]) if *height == share => *end = ends[1],
            _ => corners.extend(ends.map(|x| [x, share])),
        }
    }
    corners
}

/// Share of the area over the value, as two stepped lines.
fn histogram_ui(ui: &mut Ui, (pair, by): (&PairRecord, ColorBy), size: egui::Vec2) {
    let palette = Palette::of(ui);
    let factor = by.forming().map_or(1.0, FormingValue::shown_factor);
    let low = factor * pair.stamped.min.min(pair.crash.min);
    let high = factor * pair.stamped.max.max(pair.crash.max);
    let steps = |shares: &[f64]| PlotPoints::from(outline(shares, [low, high]));
    let plot = charts::still_chart(ui, "mapping histogram", size)
        .include_y(0.0)
        .y_axis_min_width(36.0);
    let plot = charts::with_round_numbers(charts::with_two_shares(plot), size.x);
    plot.show(ui, |plot| {
        let [stamped, crash] = &pair.histograms;
        let line = charts::exact_line("▲ stamped", steps(stamped)).fill(0.0);
        plot.line(line.color(palette.stamped).width(1.5).fill_alpha(0.15));
        let line = charts::exact_line("■ crash, mapped", steps(crash)).fill(0.0);
        plot.line(line.color(palette.crash).width(1.5).fill_alpha(0.15));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_has_no_points_that_coincide() {
        let corners = outline(&[0.0, 0.0, 0.5, 0.5, 0.2, 0.0], [0.0, 6.0]);
        let expected = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 0.5],
            [4.0, 0.5],
            [4.0, 0.2],
            [5.0, 0.2],
            [5.0, 0.0],
            [6.0, 0.0],
        ];
        assert_eq!(corners, expected);
        assert!(outline(&[], [0.0, 1.0]).is_empty());
    }

    #[test]
    fn columns_are_as_wide_as_their_texts_where_there_is_room() {
        assert_eq!(column_widths(500.0, [180.0, 100.0, 90.0]), [180.0, 100.0]);
        // A long finding gives way before the names do.
        assert_eq!(column_widths(400.0, [180.0, 300.0, 90.0]), [180.0, 130.0]);
        // The words of the pose have room beside a limit that is long.
        assert_eq!(column_widths(354.0, [150.0, 85.0, 190.0]), [150.0, 85.0]);
        assert_eq!(column_widths(310.0, [180.0, 300.0, 90.0]), [180.0, 70.0]);
        // No name is cut for what is asked for.
        assert_eq!(column_widths(300.0, [180.0, 300.0, 90.0]), [180.0, 120.0]);
        assert_eq!(column_widths(220.0, [180.0, 300.0, 90.0]), [158.0, 62.0]);
    }

    #[test]
    fn thinning_is_read_in_per_cent() {
        assert_eq!(number(ColorBy::Thinning, 0.1523), "15.2");
        assert_eq!(number(ColorBy::PlasticStrain, 0.1523), "0.152");
    }
}
