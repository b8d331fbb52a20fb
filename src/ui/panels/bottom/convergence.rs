//! Residual and share of kept pairs over the iterations of every start, live. Pointing at the curve of the chosen
//! start shows the pose of that iteration, a click or the arrow keys keep it.

use egui::{Button, ComboBox, Key, Modifiers, RichText, Ui, vec2};
use egui_plot::{PlotPoints, VLine};

use super::charts;
use crate::app::{AppState, Command, Preview, PreviewCommand};
use crate::registration::{IterationRecord, StartRecord};
use crate::report::distances::{self, RESIDUAL};
use crate::report::start_name;
use crate::text::{Lengths, counted};
use crate::ui::focus;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{icon_button, nothing_yet, percent};

/// The curves of one frame.
struct Curves<'a> {
    starts: &'a [StartRecord],
    /// Number of the start that stands out.
    leader: usize,
    /// The iteration that is shown.
    shown: Option<usize>,
    has_others: bool,
    lengths: Lengths,
}

impl Curves<'_> {
    /// Those of the start that stands out.
    fn iterations(&self) -> &[IterationRecord] {
        &self.starts[self.leader].iterations
    }
}

/// What the pointer did on a chart.
#[derive(Default)]
struct Pointed {
    over: Option<usize>,
    is_clicked: bool,
    is_inside: bool,
}

/// Two charts with one axis of iterations; the chosen start stands out.
pub fn convergence_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let starts = state.match_starts();
    let leader = state
        .leading_start()
        .unwrap_or(0)
        .min(starts.len().saturating_sub(1));
    if starts.is_empty() {
        nothing_yet(
            ui,
            "No iterations yet",
            "The curves of every start grow here while a match runs",
        );
        return;
    }
    let shown = match state.preview() {
        Some(Preview::Step { start, iteration }) if start == leader => Some(iteration),
        _ => None,
    };
    let mut curves = Curves {
        starts,
        leader,
        shown,
        has_others: has_others(ui),
        lengths: state.lengths(),
    };
    let is_free = state.jobs.locking_job().is_none();
    head_ui(ui, state, &mut curves, commands);
    let size = vec2((ui.available_width() - 16.0) / 2.0, ui.available_height());
    let mut pointed = Pointed::default();
    ui.horizontal_top(|ui| {
        for chart in [RMS, KEPT] {
            let at = chart.show(ui, &curves, size);
            pointed.is_inside |= at.is_inside;
            pointed.is_clicked |= at.is_clicked;
            pointed.over = pointed.over.or(at.over);
        }
    });
    if is_free {
        scrub(ui, state, &curves, &pointed, commands);
    }
}

/// The pose under the pointer, kept by a click; the arrow keys step on from it.
fn scrub(
    ui: &Ui,
    state: &AppState,
    curves: &Curves<'_>,
    pointed: &Pointed,
    commands: &mut Vec<Command>,
) {
    let start = curves.leader;
    let n_steps = curves.iterations().len();
    let over = pointed.over.filter(|at| *at < n_steps);
    let over = over.map(|iteration| Preview::Step { start, iteration });
    if pointed.is_inside {
        let pressed = |key| ui.input_mut(|i| i.consume_key(Modifiers::NONE, key));
        let way = i32::from(pressed(Key::ArrowRight)) - i32::from(pressed(Key::ArrowLeft));
        if way != 0 {
            step(state, curves, way, commands);
            return;
        }
    }
    if pointed.is_clicked && over.is_some() {
        commands.push(PreviewCommand::Pin(over).into());
    }
    // A pointer that rests must not fight with the keys.
    let is_moving = ui.input(|i| i.pointer.is_moving());
    if over != state.previews.hovered && (is_moving || over.is_none()) {
        commands.push(PreviewCommand::Hover(over).into());
    }
}

/// One iteration on or back from the shown one.
fn step(state: &AppState, curves: &Curves<'_>, way: i32, commands: &mut Vec<Command>) {
    let n_steps = curves.iterations().len();
    let Some(last) = n_steps.checked_sub(1) else {
        return;
    };
    let iteration = match curves.shown {
        Some(at) if way > 0 => (at + 1).min(last),
        Some(at) => at.saturating_sub(1),
        None => last,
    };
    let start = curves.leader;
    if state.previews.hovered.is_some() {
        commands.push(PreviewCommand::Hover(None).into());
    }
    commands.push(PreviewCommand::Pin(Some(Preview::Step { start, iteration })).into());
}

fn others_id() -> egui::Id {
    egui::Id::unique("curves of the other starts")
}

fn has_others(ui: &Ui) -> bool {
    ui.data(|data| data.get_temp(others_id())).unwrap_or(true)
}

/// Which start, its figures, and the steps through its iterations.
fn head_ui(ui: &mut Ui, state: &AppState, curves: &mut Curves<'_>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        // The figures beside it are seen whole.
        let width = (ui.available_width() - FIGURES).clamp(150.0, 360.0);
        ui.scope(|ui| {
            ui.set_max_width(width);
            start_choice(ui, curves, width, commands);
        });
        let mut has_others = curves.has_others;
        if ui.checkbox(&mut has_others, "All starts").changed() {
            ui.data_mut(|data| data.insert_temp(others_id(), has_others));
            curves.has_others = has_others;
        }
        let is_free = state.jobs.locking_job().is_none() && !curves.iterations().is_empty();
        for (sign, name, way) in [("◀", "Iteration before", -1), ("▶", "Next iteration", 1)] {
            if icon_button(ui, sign, name, is_free).clicked() {
                step(state, curves, way, commands);
            }
        }
        if state.previews.pinned.is_some() {
            let button = Button::new("Back to the result").min_size(vec2(0.0, ROW));
            if ui.add(button).clicked() {
                commands.push(PreviewCommand::Pin(None).into());
            }
        }
        figures_ui(ui, curves);
    });
}

/// Room for what stands beside the choice of the start.
const FIGURES: f32 = 460.0;

/// The start that stands out.
fn start_choice(ui: &mut Ui, curves: &Curves<'_>, width: f32, commands: &mut Vec<Command>) {
    let leader = curves.leader;
    let menu = ComboBox::from_id_salt("start of the curve")
        .selected_text(start_text(leader, &curves.starts[leader]))
        .width(width)
        .truncate();
    let shown = focus::menu(ui, menu, |ui| {
        for (number, start) in curves.starts.iter().enumerate() {
            let is_on = number == leader;
            let choice = ui.selectable_label(is_on, start_text(number, start));
            if focus::chosen(ui, is_on, choice).clicked() {
                commands.push(PreviewCommand::ChooseStart(Some(number)).into());
            }
        }
    });
    shown.response.accessible_name("Start of the curve");
}

fn figures_ui(ui: &mut Ui, curves: &Curves<'_>) {
    let iterations = curves.iterations();
    let n_steps = iterations.len();
    let words = |step: &IterationRecord| {
        format!(
            "{} {} · {} {}",
            RESIDUAL.name,
            curves.lengths.of(step.rmse),
            distances::KEPT.name,
            percent(step.fraction)
        )
    };
    let text = match curves.shown {
        Some(at) => iterations.get(at).map(|step| {
            format!(
                "preview of iteration {} of {n_steps} · {}",
                at + 1,
                words(step)
            )
        }),
        None => iterations
            .last()
            .map(|step| format!("{} · {}", counted(n_steps, "iteration"), words(step))),
    };
    let text = text.unwrap_or_else(|| "no iteration yet".to_owned());
    let text = RichText::new(text).small();
    let text = text.color(Palette::of(ui).secondary);
    ui.add(egui::Label::new(text).truncate());
}

fn start_text(number: usize, start: &StartRecord) -> String {
    format!("{} · {}", number + 1, start_name(start))
}

/// A chart lower than this has no names along its axes.
const LOW: f32 = 100.0;

struct Chart {
    name: &'static str,
    value: fn(&IterationRecord) -> f64,
    is_length: bool,
}

const RMS: Chart = Chart {
    name: RESIDUAL.name,
    value: |iteration| iteration.rmse,
    is_length: true,
};
const KEPT: Chart = Chart {
    name: distances::KEPT.name,
    value: |iteration| iteration.fraction,
    is_length: false,
};

impl Chart {
    fn points(&self, start: &StartRecord) -> PlotPoints<'static> {
        let curve = start.iterations.iter().enumerate();
        let points = curve.map(|(n, iteration)| {
            let value = (self.value)(iteration);
            let shown = if self.is_length {
                value.max(1e-9).log10()
            } else {
                value
            };
            [n as f64, shown]
        });
        points.collect::<Vec<_>>().into()
    }

    /// Draws; what the pointer does on it.
    fn show(&self, ui: &mut Ui, curves: &Curves<'_>, size: egui::Vec2) -> Pointed {
        let palette = Palette::of(ui);
        let is_length = self.is_length;
        let label = if is_length {
            format!("{}{}", self.name, curves.lengths.suffix())
        } else {
            self.name.to_owned()
        };
        let chart = charts::still_chart(ui, self.name, size).y_axis_min_width(48.0);
        let chart = if is_length {
            charts::with_log_upright(chart)
        } else {
            charts::with_round_shares(chart, if size.y < LOW { 2 } else { 5 })
        };
        // Names of axes take a third of a low chart; there what is drawn stands in it.
        let chart = if size.y < LOW {
            let at = ui.cursor().min + vec2(size.x - 8.0, 2.0);
            let font = egui::TextStyle::Small.resolve(ui.style());
            let color = palette.secondary;
            ui.painter()
                .text(at, egui::Align2::RIGHT_TOP, label, font, color);
            chart
        } else {
            chart.x_axis_label("iteration").y_axis_label(label)
        };
        let shown = chart.show(ui, |plot| {
            let quiet = palette.secondary.gamma_multiply(0.5);
            let leader = curves.leader;
            let others = curves.starts.iter().enumerate();
            let others = others.filter(|(number, _)| curves.has_others && *number != leader);
            for (number, start) in others {
                let name = format!("start {}", number + 1);
                let line = charts::exact_line(&name, self.points(start));
                plot.line(line.color(quiet).width(1.0).allow_hover(false));
            }
            let name = format!("start {}", leader + 1);
            let line = charts::exact_line(&name, self.points(&curves.starts[leader]));
            plot.line(line.color(palette.accent_text).width(2.0));
            if let Some(at) = curves.shown {
                let line = VLine::new("shown", at as f64);
                plot.vline(line.color(palette.secondary));
            }
            let response = plot.response();
            let is_over = response.hovered();
            let at = plot.pointer_coordinate().filter(|_| is_over);
            (at, response.clicked(), is_over)
        });
        let (at, is_clicked, is_inside) = shown.inner;
        let over = at.map(|at| at.x.round()).filter(|x| *x >= 0.0);
        Pointed {
            over: over.map(|x| x as usize),
            is_clicked,
            is_inside,
        }
    }
}
