//! What was done, when, and how long it took.

use std::collections::{BTreeMap, BTreeSet};

use egui::text::LayoutJob;
use egui::{Align, FontId, Layout, Rect, RichText, Sense, TextStyle, Ui, Vec2};
use egui_extras::{Column, TableBuilder, TableRow};

use crate::app::{
    Action, AppState, Command, ExportCommand, LogRow, LogStep, NoticeLevel, clock_text,
    duration_text,
};
use crate::pipeline::outputs::Output;
use crate::text::counted;
use crate::ui::row_end::RowEnd;
use crate::ui::theme::{Palette, ROW};
use crate::ui::widgets::{level_color, nothing_yet, paint_role_mark, plain_action};

/// Height of a row of one line.
const LINE: f32 = 20.0;
/// Columns of fixed width: time of day, step, part, duration.
const COLUMNS: [f32; 4] = [58.0, 58.0, 12.0, 72.0];
/// Space above and below the text of a row, together.
const MARGIN: f32 = 4.0;
/// Space between the columns.
const GAP: f32 = 8.0;
/// In a pane narrower than this the time of day is left to the tooltip.
const NARROW: f32 = 420.0;

/// Rows that show their whole text, by their numbers since the program began.
type Opened = BTreeSet<usize>;

/// Heights of rows of several lines, measured once: laying out a text takes longer than a frame has for all of them.
#[derive(Clone, Default)]
struct Heights {
    /// The width of the texts, their font and the pixels of a point.
    look: Option<(f32, FontId, f32)>,
    /// By the number of a row, with its lines and how often its message came.
    known: BTreeMap<usize, (Lines, usize, f32)>,
}

impl Heights {
    /// Forgets what was measured for texts of another look, and rows before this number.
    fn keep(&mut self, ui: &Ui, room: f32, first: usize) {
        let font = TextStyle::Body.resolve(ui.style());
        let look = Some((room, font, ui.pixels_per_point()));
        if self.look != look {
            self.known.clear();
            self.look = look;
        }
        while self
            .known
            .first_key_value()
            .is_some_and(|(number, _)| *number < first)
        {
            self.known.pop_first();
        }
    }

    /// One line, or as many as the text needs, up to these.
    fn of(&mut self, ui: &Ui, number: usize, row: &LogRow, lines: Lines) -> f32 {
        if lines == Lines::ONE {
            return LINE;
        }
        match self.known.get(&number) {
            Some((of, count, height)) if (*of, *count) == (lines, row.count) => *height,
            _ => {
                let room = self.look.as_ref().map_or(f32::INFINITY, |look| look.0);
                let height = row_height(ui, row, lines, room);
                self.known.insert(number, (lines, row.count, height));
                height
            }
        }
    }
}

/// The table, newest row in sight, and the sums.
pub fn log_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let rows = state.log.rows();
    if rows.is_empty() {
        nothing_yet(
            ui,
            "No steps yet",
            "Each step is logged here with its duration",
        );
        return;
    }
    let height = (ui.available_height() - ROW - ui.spacing().item_spacing.y).max(LINE);
    ui.allocate_ui(egui::vec2(ui.available_width(), height), |ui| {
        ui.set_min_height(height);
        table_ui(ui, rows, state.log.n_dropped(), height);
    });
    sums_ui(ui, state, commands);
}

/// `first`: the number of the first row.
fn table_ui(ui: &mut Ui, rows: &[LogRow], first: usize, height: f32) {
    let id = egui::Id::unique("opened log rows");
    let mut opened: Opened = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let is_narrow = ui.available_width() < NARROW;
    let fixed = if is_narrow {
        &COLUMNS[1..]
    } else {
        &COLUMNS[..]
    };
    let others: f32 = fixed.iter().map(|width| width + GAP).sum();
    // The bar stands beside the times and not over them.
    let scroll = &mut ui.spacing_mut().scroll;
    scroll.floating_allocated_width = scroll.bar_width;
    let beside = others + GAP + scroll.bar_width;
    let room = (ui.available_width() - beside).max(40.0);
    let fitting = Lines::that_fit(ui, height);
    let lines_of =
        |index: usize| Lines::of(&rows[index], opened.contains(&(first + index)), fitting);
    let heights = heights_of(ui, (rows, first), lines_of, room);
    let mut clicked = None;
    ui.spacing_mut().item_spacing = egui::vec2(GAP, 0.0);
    let mut table = TableBuilder::new(ui)
        .id_salt(("log", is_narrow))
        .sense(Sense::click())
        .stick_to_bottom(true)
        .auto_shrink([false, false])
        .min_scrolled_height(0.0)
        .max_scroll_height(height)
        .cell_layout(Layout::left_to_right(Align::Center));
    let [time, step, part, took] = COLUMNS;
    if !is_narrow {
        table = table.column(Column::exact(time));
    }
    table
        .column(Column::exact(step))
        .column(Column::exact(part))
        .column(Column::remainder().clip(true))
        .column(Column::exact(took))
        .body(|body| {
            body.heterogeneous_rows(heights.into_iter(), |mut table_row| {
                let index = table_row.index();
                let row = &rows[index];
                row_ui(&mut table_row, row, is_narrow, lines_of(index));
                let response = table_row.response();
                if response.clicked() {
                    clicked = Some(index);
                }
                response.on_hover_text(hover_text(row));
            });
        });
    if let Some(index) = clicked {
        let number = first + index;
        if !opened.remove(&number) {
            opened.insert(number);
        }
        ui.data_mut(|data| data.insert_temp(id, opened));
    }
}

/// The height of each row.
fn heights_of(
    ui: &Ui,
    (rows, first): (&[LogRow], usize),
    lines_of: impl Fn(usize) -> Lines,
    room: f32,
) -> Vec<f32> {
    let id = egui::Id::unique("heights of log rows");
    // Measuring needs the fonts, which are not to be had while the data are held.
    let take = |data: &mut egui::util::IdTypeMap| {
        std::mem::take(data.get_temp_mut_or_default::<Heights>(id))
    };
    let mut heights = ui.data_mut(take);
    heights.keep(ui, room, first);
    let of_row = |(index, row)| heights.of(ui, first + index, row, lines_of(index));
    let found = rows.iter().enumerate().map(of_row).collect();
    ui.data_mut(|data| data.insert_temp(id, heights));
    found
}

/// Lines that a row takes at most.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Lines(usize);

impl Lines {
    const ONE: Self = Self(1);

    /// As many as the pane has room for below another row, which the fading edge of the table lies on.
    fn that_fit(ui: &Ui, height: f32) -> Self {
        let line = ui.text_style_height(&TextStyle::Body);
        Self((((height - LINE - MARGIN) / line) as usize).max(1))
    }

    /// All of a row that was opened. What came out of a match and what went wrong are shown with as many as fit, so
    /// that the newest row begins in sight; other rows take one.
    fn of(row: &LogRow, is_opened: bool, fitting: Self) -> Self {
        if is_opened {
            Self(usize::MAX)
        } else if row.step == LogStep::Result || row.level >= NoticeLevel::Warning {
            fitting
        } else {
            Self::ONE
        }
    }
}

/// As many lines as the text needs, up to these.
fn row_height(ui: &Ui, row: &LogRow, lines: Lines, room: f32) -> f32 {
    let mut job = job_of(ui, row, lines);
    job.wrap.max_width = room;
    let galley = ui.painter().layout_job(job);
    (galley.size().y + MARGIN).max(LINE)
}

/// The text of a row, cut after these lines.
fn job_of(ui: &Ui, row: &LogRow, lines: Lines) -> LayoutJob {
    let color = if row.level >= NoticeLevel::Note {
        level_color(Palette::of(ui), row.level)
    } else {
        ui.visuals().text_color()
    };
    let font = TextStyle::Body.resolve(ui.style());
    let mut job = LayoutJob::simple(text_of(row), font, color, f32::INFINITY);
    job.wrap.max_rows = lines.0;
    job
}

fn row_ui(table_row: &mut TableRow<'_, '_>, row: &LogRow, is_narrow: bool, lines: Lines) {
    if !is_narrow {
        table_row.col(|ui| {
            let color = Palette::of(ui).secondary;
            let text = RichText::new(clock_text(row.at)).small().color(color);
            ui.add(egui::Label::new(text).selectable(false));
        });
    }
    table_row.col(|ui| {
        ui.add(egui::Label::new(row.step.label()).selectable(false));
    });
    table_row.col(|ui| role_cell(ui, row));
    table_row.col(|ui| text_cell(ui, row, lines));
    table_row.col(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(4.0);
            if let Some(took) = row.took {
                ui.add(egui::Label::new(duration_text(took)).selectable(false));
            }
        });
    });
}

/// Total, build and threads on the left; copy and save on the right.
fn sums_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let size = egui::vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        let end = RowEnd::new(ui, "log");
        end.before(ui, |ui| {
            let color = Palette::of(ui).secondary;
            let text = RichText::new(sums(state)).small().color(color);
            ui.add(egui::Label::new(text).truncate());
        });
        end.show(ui, |ui| {
            plain_action(ui, state, Action::CopyLog, commands);
            if ui.button("Save log…").clicked() {
                commands.push(ExportCommand::AskSave(Output::Log).into());
            }
        });
    });
}

fn sums(state: &AppState) -> String {
    let total = duration_text(state.log.total());
    let threads = counted(rayon::current_num_threads(), "thread");
    let build = crate::report::build_id();
    let dropped = match state.log.n_dropped() {
        0 => String::new(),
        n => format!("{} left out · ", counted(n, "old row")),
    };
    format!("total {total} · {dropped}{threads} · build {build}")
}

fn text_of(row: &LogRow) -> String {
    let mark = row.level.mark();
    let text = row.counted_text();
    if row.level >= NoticeLevel::Note {
        format!("{mark} {text}")
    } else {
        text
    }
}

fn hover_text(row: &LogRow) -> String {
    let took = row
        .took
        .map_or_else(String::new, |took| format!(", {}", duration_text(took)));
    format!(
        "{} {}{took}\n{}\nClick for the whole text",
        clock_text(row.at),
        row.step.label(),
        text_of(row)
    )
}

fn role_cell(ui: &mut Ui, row: &LogRow) {
    let Some(role) = row.role else { return };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(12.0), Sense::hover());
    let mark = Rect::from_center_size(rect.center(), Vec2::splat(9.0));
    paint_role_mark(ui.painter(), mark, role, Palette::of(ui).role(role));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, role.word()));
}

fn text_cell(ui: &mut Ui, row: &LogRow, lines: Lines) {
    let label = egui::Label::new(job_of(ui, row, lines)).selectable(false);
    if lines == Lines::ONE {
        ui.add(label.truncate().show_tooltip_when_elided(false));
    } else {
        ui.add(label.wrap().show_tooltip_when_elided(false));
    }
}
