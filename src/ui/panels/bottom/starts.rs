//! The starts of a match, the best first, while it runs and after it: what became of each, and a small
//! picture. Pointing at a row shows its pose in the window, a click takes it.

use std::cmp::Ordering;

use egui::{Align, Button, Color32, Label, Layout, RichText, Sense, Ui};
use egui_extras::{Column, TableBuilder, TableRow};

use super::thumbnails::Thumbnails;
use crate::app::{AppState, Command, MatchCommand, Preview, PreviewCommand, duration_text};
use crate::geometry::Similarity;
use crate::registration::{StartGroup, StartOutcome, StartRecord, group_starts};
use crate::report::distances::{KEPT, PAIRS_P95, RESIDUAL};
use crate::report::{
    outcome_words, start_data_words, start_kind_help, start_kind_words, start_name,
};
use crate::text::{Lengths, counted};
use crate::ui::theme::{Palette, UNIT};
use crate::ui::widgets::{caption, nothing_yet, percent, tight};

/// Height of a row with its picture.
const HEIGHT: f32 = 44.0;
/// Width of a picture.
const PICTURE: f32 = 64.0;
/// Least width of where a start came from.
const NAME: f32 = 150.0;
/// Width of what became of it, and where only its sign and a word have room.
const OUTCOME: f32 = 190.0;
const SHORT_OUTCOME: f32 = 100.0;
/// Between the columns.
const GAP: f32 = UNIT;

/// One line of the table: a start, and the group if it leads one.
struct Line<'a> {
    number: usize,
    start: &'a StartRecord,
    group: Option<&'a StartGroup>,
    /// Farthest that a corner of the part's box lies from where the first group has it.
    distance: Option<f64>,
}

/// What every row needs.
struct Table<'a> {
    state: &'a AppState,
    n_starts: usize,
    n_best: usize,
    lines: Vec<Line<'a>>,
    open: Vec<usize>,
    sorted: Option<Sorted>,
}

/// The figure that the groups are sorted by, by that of their best start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sorted {
    by: Figure,
    is_falling: bool,
}

impl Sorted {
    /// What a click on a heading makes of the order: rising, falling, as the match ranks them.
    fn clicked(before: Option<Self>, by: Figure) -> Option<Self> {
        let is_falling = match before {
            Some(before) if before.by == by && before.is_falling => return None,
            Some(before) => before.by == by,
            None => false,
        };
        Some(Self { by, is_falling })
    }

    /// Of two numbers; a start without one comes last either way.
    fn order(self, a: Option<f64>, b: Option<f64>) -> Ordering {
        match (a, b) {
            (Some(a), Some(b)) if self.is_falling => b.total_cmp(&a),
            (Some(a), Some(b)) => a.total_cmp(&b),
            (a, b) => b.is_some().cmp(&a.is_some()),
        }
    }
}

/// Draws the table of starts.
pub fn starts_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let starts = state.match_starts();
    if starts.is_empty() {
        nothing_yet(
            ui,
            "No starts yet",
            "A match tries many first poses; each has a row here with its picture and its outcome",
        );
        return;
    }
    let groups = group_starts(starts, &state.stamped_extent());
    let open = open_groups(ui);
    let sorted = ui.data(|data| data.get_temp(sorted_id()));
    let table = Table {
        state,
        n_starts: starts.len(),
        n_best: groups.first().map_or(0, |group| group.members.len()),
        lines: lines(state, &groups, &open, sorted),
        open,
        sorted,
    };
    head_ui(ui, &table);
    let hovered = table_ui(ui, &table, commands);
    let shown = state.previews.hovered;
    if hovered != shown && state.jobs.locking_job().is_none() {
        commands.push(PreviewCommand::Hover(hovered).into());
    }
}

fn lines<'a>(
    state: &'a AppState,
    groups: &'a [StartGroup],
    open: &[usize],
    sorted: Option<Sorted>,
) -> Vec<Line<'a>> {
    let starts = state.match_starts();
    let corners = state.stamped_corners();
    let first = groups.first().map(|group| starts[group.best()].last);
    let distance = |pose: &Similarity| Some(pose.max_displacement(&first?, &corners?));
    let mut of_groups = Vec::new();
    for group in groups {
        let mut lines = Vec::new();
        for (place, &number) in group.members.iter().enumerate() {
            let is_best = place == 0;
            if !is_best && !open.contains(&group.best()) {
                break;
            }
            let start = &starts[number];
            lines.push(Line {
                number,
                start,
                group: is_best.then_some(group),
                distance: distance(&start.last).filter(|_| is_best),
            });
        }
        of_groups.push(lines);
    }
    if let Some(sorted) = sorted {
        let value = |lines: &Vec<Line<'_>>| sorted.by.value(lines.first()?);
        of_groups.sort_by(|a, b| sorted.order(value(a), value(b)));
    }
    of_groups.into_iter().flatten().collect()
}

fn sorted_id() -> egui::Id {
    egui::Id::unique("order of the starts")
}

fn open_id() -> egui::Id {
    egui::Id::unique("unfolded groups of starts")
}

fn open_groups(ui: &Ui) -> Vec<usize> {
    ui.data(|data| data.get_temp(open_id())).unwrap_or_default()
}

fn head_ui(ui: &mut Ui, table: &Table<'_>) {
    let starts = counted(table.n_starts, "start");
    let text = if table.state.jobs.locking_job().is_some() {
        format!("{starts} so far; rows fill while they run")
    } else {
        let n_best = table.n_best;
        format!(
            "{n_best} of {starts} ended in the best pose · point at a row to see its pose, \
             click to take it"
        )
    };
    caption(ui, text);
}

/// The rows; the preview of the one under the pointer.
fn table_ui(ui: &mut Ui, table: &Table<'_>, commands: &mut Vec<Command>) -> Option<Preview> {
    let unit = table.state.document.unit_suffix();
    let columns = Columns::fitting(ui.available_width());
    let figures = &columns.figures;
    let mut hovered = None;
    let thumbnails = Thumbnails::of(ui.ctx());
    let mut thumbnails = thumbnails.lock();
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut builder = TableBuilder::new(ui)
        // A table keeps its columns: one for each choice of them.
        .id_salt(("starts", figures.len(), columns.is_short))
        .sense(Sense::click())
        .min_scrolled_height(0.0)
        .auto_shrink([false, false])
        .cell_layout(Layout::left_to_right(Align::Center))
        .column(Column::exact(PICTURE + 8.0))
        .column(Column::remainder().at_least(NAME).clip(true))
        .column(Column::exact(columns.outcome()).clip(true));
    for figure in figures {
        builder = builder.column(Column::exact(figure.width()));
    }
    builder
        .header(20.0, |mut header| {
            for title in ["", "start", "outcome"] {
                header.col(|ui| {
                    caption(ui, title);
                });
            }
            for figure in figures {
                header.col(|ui| heading_ui(ui, *figure, unit, table.sorted));
            }
        })
        .body(|body| {
            body.rows(HEIGHT, table.lines.len(), |mut row| {
                let line = &table.lines[row.index()];
                row_ui(&mut row, table, (line, &columns), &mut thumbnails, commands);
                let index = line.number;
                let response = row.response();
                if response.hovered() {
                    hovered = Some(Preview::Start(index));
                }
                if response.clicked() && table.state.can_move().is_ok() {
                    commands.push(MatchCommand::UseMatchStart(index).into());
                }
            });
        });
    thumbnails.make(ui, table.state);
    hovered
}

/// The title of a figure; a click sorts by it.
fn heading_ui(ui: &mut Ui, figure: Figure, unit: &str, sorted: Option<Sorted>) {
    let title = figure.title(unit);
    let sign = match sorted.filter(|sorted| sorted.by == figure) {
        Some(sorted) if sorted.is_falling => " ▼",
        Some(_) => " ▲",
        None => "",
    };
    let text = RichText::new(format!("{title}{sign}")).small();
    let text = text.color(Palette::of(ui).secondary);
    let button = Button::new(text).frame(false).truncate();
    let response = tight(ui, |ui| {
        // As high as the titles beside it, so that all stand on one line.
        ui.spacing_mut().interact_size.y = 0.0;
        ui.add(button)
    });
    let name = format!("Sort by {title}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let help = figure
        .help()
        .map_or_else(String::new, |help| format!("{help}\n"));
    let response = response.on_hover_text(format!("{help}Click to sort"));
    if response.clicked() {
        let next = Sorted::clicked(sorted, figure);
        ui.data_mut(|data| match next {
            Some(next) => {
                data.insert_temp(sorted_id(), next);
            }
            None => data.remove::<Sorted>(sorted_id()),
        });
    }
}

fn row_ui(
    row: &mut TableRow<'_, '_>,
    table: &Table<'_>,
    (line, columns): (&Line<'_>, &Columns),
    thumbnails: &mut Thumbnails,
    commands: &mut Vec<Command>,
) {
    let start = line.start;
    row.col(|ui| {
        let pose = start.outcome.map(|_| start.last);
        thumbnails.show(ui, table.state, pose, egui::vec2(PICTURE, HEIGHT - 4.0));
    });
    row.col(|ui| {
        ui.vertical(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            ui.add_space(3.0);
            name_ui(ui, table, line, commands);
        });
    });
    let outcome = outcome_text(start, table.state, columns.is_short);
    let is_best = start.outcome == Some(StartOutcome::Won);
    row.col(|ui| {
        let palette = Palette::of(ui);
        let color = match start.outcome {
            Some(StartOutcome::Won) => palette.good,
            Some(StartOutcome::Dropped { .. } | StartOutcome::MergedInto { .. }) => {
                palette.secondary
            }
            _ => palette.text,
        };
        cell(ui, outcome, color);
    });
    for figure in &columns.figures {
        let text = figure.text(line, table.state.lengths());
        row.col(|ui| {
            let palette = Palette::of(ui);
            let color = if is_best { palette.good } else { palette.text };
            cell(ui, text, color);
        });
    }
}

/// Number and origin; below, the others that ended here and which nodes were paired.
fn name_ui(ui: &mut Ui, table: &Table<'_>, line: &Line<'_>, commands: &mut Vec<Command>) {
    let index = line.number;
    let indent = if line.group.is_some() { "" } else { "   " };
    let origin = start_kind_words(line.start.kind);
    let text = format!("{indent}{} · {origin}", index + 1);
    let can = table.state.can_move().is_ok();
    let button = Button::new(text).frame(false).truncate();
    let response = tight(ui, |ui| ui.add_enabled(can, button));
    let name = format!("Use the pose of start {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, can, &name));
    let help = start_kind_help(line.start.kind);
    let response = response.on_hover_text(format!("{}\n{help}", start_name(line.start)));
    if response.clicked() {
        commands.push(MatchCommand::UseMatchStart(index).into());
    }
    ui.horizontal(|ui| {
        group_ui(ui, table, line);
        let color = Palette::of(ui).secondary;
        let words = format!("{indent}{}", start_data_words(line.start));
        let text = RichText::new(words).small().color(color);
        ui.add(Label::new(text).truncate());
    });
}

/// How many ended here, which unfolds them.
fn group_ui(ui: &mut Ui, table: &Table<'_>, line: &Line<'_>) {
    let index = line.number;
    let Some(group) = line.group.filter(|group| group.members.len() > 1) else {
        return;
    };
    let is_open = table.open.contains(&index);
    let sign = if is_open { "▼" } else { "▶" };
    let n_here = group.members.len();
    let text = format!("{sign} {n_here} of {} starts", table.n_starts);
    let text = RichText::new(text).small().color(Palette::of(ui).secondary);
    let response = tight(ui, |ui| ui.add(Button::new(text).frame(false)));
    let response = response.on_hover_text("They ended in one pose; click to see each");
    if response.clicked() {
        let mut open = table.open.clone();
        match open.iter().position(|at| *at == index) {
            Some(at) => drop(open.remove(at)),
            None => open.push(index),
        }
        ui.data_mut(|data| data.insert_temp(open_id(), open));
    }
}

fn cell(ui: &mut Ui, text: String, color: Color32) {
    ui.add(Label::new(RichText::new(text).color(color)).truncate());
}

/// Sign and words of what became of a start; of the words only the first where room is short.
fn outcome_text(start: &StartRecord, state: &AppState, is_short: bool) -> String {
    let (sign, without_end) = match start.outcome {
        Some(StartOutcome::Won) => ("✔", ""),
        Some(StartOutcome::RunnerUp) => ("●", ""),
        Some(StartOutcome::MergedInto { .. }) => ("↪", ""),
        Some(StartOutcome::Dropped { .. }) => ("▼", ""),
        Some(StartOutcome::Failed) => ("✖", ""),
        None if state.jobs.locking_job().is_some() => ("▶", "running"),
        None => ("■", "not ended"),
    };
    let words = outcome_words(start).unwrap_or_else(|| without_end.to_owned());
    let end = words.find(' ').filter(|_| is_short).unwrap_or(words.len());
    format!("{sign} {}", &words[..end])
}

/// What a table of some width has room for.
struct Columns {
    figures: Vec<Figure>,
    /// Outcomes are cut to their first word.
    is_short: bool,
}

impl Columns {
    fn fitting(width: f32) -> Self {
        let mut columns = Self {
            figures: Figure::ALL.to_vec(),
            is_short: false,
        };
        for least in Figure::LEAST {
            // Words are cut before the error stands alone.
            columns.is_short = least == Figure::ToBest && columns.width() > width;
            if columns.width() > width {
                columns.figures.retain(|figure| *figure != least);
            }
        }
        columns
    }

    fn outcome(&self) -> f32 {
        if self.is_short {
            SHORT_OUTCOME
        } else {
            OUTCOME
        }
    }

    /// The least width.
    fn width(&self) -> f32 {
        let figures = self.figures.iter().map(|figure| figure.width() + GAP);
        PICTURE + 8.0 + NAME + self.outcome() + 4.0 * GAP + figures.sum::<f32>()
    }
}

/// A number of a start, in the order of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Figure {
    Kept,
    Residual,
    P95,
    Iterations,
    Time,
    ToBest,
}

impl Figure {
    const ALL: [Self; 6] = [
        Self::Kept,
        Self::Residual,
        Self::P95,
        Self::Iterations,
        Self::Time,
        Self::ToBest,
    ];
    /// What is left out first where not all have room.
    const LEAST: [Self; 5] = [
        Self::Time,
        Self::Iterations,
        Self::P95,
        Self::Kept,
        Self::ToBest,
    ];

    fn title(self, unit: &str) -> String {
        match self {
            Self::Kept => KEPT.name.to_owned(),
            Self::Residual => format!("{}{unit}", RESIDUAL.name),
            Self::P95 => format!("{}{unit}", PAIRS_P95.name),
            Self::Iterations => "iterations".to_owned(),
            Self::Time => "time".to_owned(),
            Self::ToBest => format!("to best{unit}"),
        }
    }

    /// Over what it is measured, where its name does not say it.
    fn help(self) -> Option<&'static str> {
        match self {
            Self::Kept => Some(KEPT.help),
            Self::Residual => Some(RESIDUAL.help),
            Self::P95 => Some(PAIRS_P95.help),
            Self::Iterations | Self::Time => None,
            Self::ToBest => Some(
                "Farthest that a corner of the part’s box lies from where the best pose has it",
            ),
        }
    }

    fn width(self) -> f32 {
        match self {
            Self::Kept => 62.0,
            Self::Residual => 84.0,
            Self::P95 => 96.0,
            Self::Iterations => 60.0,
            Self::Time => 64.0,
            Self::ToBest => 72.0,
        }
    }

    /// The number itself; a time is in seconds.
    fn value(self, line: &Line<'_>) -> Option<f64> {
        let start = line.start;
        let last = start.iterations.last();
        match self {
            Self::Kept => last.map(|step| step.fraction),
            Self::Residual => last.map(|step| step.rmse),
            Self::P95 => Some(start.p95).filter(|p95| p95.is_finite()),
            Self::Iterations => Some(start.iterations.len() as f64),
            Self::Time => start.outcome.map(|_| start.took.as_secs_f64()),
            Self::ToBest => line.distance,
        }
    }

    fn text(self, line: &Line<'_>, lengths: Lengths) -> String {
        let Some(value) = self.value(line) else {
            return "–".to_owned();
        };
        match self {
            Self::Kept => percent(value),
            Self::Residual | Self::P95 | Self::ToBest => lengths.number(value),
            Self::Iterations => line.start.iterations.len().to_string(),
            Self::Time => duration_text(line.start.took),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_sorts_up_then_down_then_not() {
        let rising = Sorted::clicked(None, Figure::P95);
        let falling = Sorted::clicked(rising, Figure::P95);
        assert_eq!(Sorted::clicked(falling, Figure::P95), None);
        let other = Sorted::clicked(falling, Figure::Time).unwrap();
        assert!(other.by == Figure::Time && !other.is_falling);
        for (sorted, ranked) in [(rising, [1.0, 3.0]), (falling, [3.0, 1.0])] {
            let mut values = [None, Some(3.0), Some(1.0)];
            values.sort_by(|a, b| sorted.unwrap().order(*a, *b));
            assert_eq!(values, [Some(ranked[0]), Some(ranked[1]), None]);
        }
    }

    #[test]
    fn what_says_least_is_left_out_first() {
        let wide = Columns::fitting(1000.0);
        assert_eq!(wide.figures, Figure::ALL);
        let narrow = Columns::fitting(660.0);
        assert_eq!(narrow.figures, [Figure::Residual, Figure::ToBest]);
        assert!(!narrow.is_short);
        let small = Columns::fitting(460.0);
        assert_eq!(small.figures, [Figure::Residual]);
        assert!(small.is_short && small.width() <= 460.0);
    }
}
