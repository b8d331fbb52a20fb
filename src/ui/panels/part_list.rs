//! The parts of both decks: filter, order by likeness, rows.

use std::sync::Arc;

use egui::{Align, Layout, ScrollArea, TextStyle, Ui, vec2};

use super::part_row::{Columns, Row, count_text, row_ui, thickness_text};
use crate::app::filter::PartFilter;
use crate::app::{AppState, ColorBy, Command, LikeWhat, PartCommand, PartRef};
use crate::role::{PerRole, Role};
use crate::ui::row_end::RowEnd;
use crate::ui::theme::ROW;
use crate::ui::widgets::{caption, chip, draft, grouped, icon_button, set_draft, text_field};

/// Most rows that are seen at once; the rest scrolls.
const MAX_ROWS: f32 = 6.0;
/// The same for a deck of so many parts that it has to be searched.
const MAX_ROWS_OF_MANY: f32 = 9.0;
/// A deck has many parts from here on.
const MANY: usize = 20;

/// Filter and list.
pub fn part_list_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let n_parts: usize = Role::ALL
        .into_iter()
        .filter_map(|role| state.document.part(role))
        .map(|part| part.facts.parts.len())
        .sum();
    let filter = filter_ui(ui, state, n_parts, commands);
    let listed = listed(ui, state, &filter);
    if listed.is_empty() {
        let text = format!("No part matches the filter ({} in all)", grouped(n_parts));
        caption(ui, text);
        return;
    }
    if !filter.is_empty() {
        let n = grouped(listed.len());
        caption(ui, format!("{n} of {} parts", grouped(n_parts)));
    }
    // A filter that leaves two of many takes no titles away.
    let has_titles = n_parts > 2;
    rows_ui(ui, state, &listed, has_titles, commands);
    chosen_ui(ui, state, commands);
}

/// The field, where there is anything to be filtered, and the order; what was typed.
fn filter_ui(ui: &mut Ui, state: &AppState, n_parts: usize, commands: &mut Vec<Command>) -> String {
    let id = egui::Id::unique("part filter");
    let mut text = draft(ui, id);
    if n_parts <= 2 && text.is_empty() {
        return text;
    }
    let can_order = state.document.both().is_some();
    let size = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        let end = RowEnd::new(ui, "filter");
        end.before(ui, |ui| {
            let field = egui::TextEdit::singleline(&mut text)
                .id(id.with("field"))
                .hint_text("2000012, 100-200, pillar, t>1.4")
                .margin(egui::Margin::symmetric(8, 3))
                .desired_width(ui.available_width());
            text_field(ui, field)
                .on_hover_text(
                    "Ids, a range of ids, words of the name, thickness; a comma means or",
                )
                .accessible_name("Filter parts");
        });
        end.show(ui, |ui| {
            // It stands there always: a button that came with the first letter moved the field away.
            if icon_button(ui, "×", "Clear the filter", !text.is_empty()).clicked() {
                text.clear();
            }
            if can_order {
                order_ui(ui, state, commands);
            }
        });
    });
    set_draft(ui, id, text.clone());
    text
}

/// Sorts the crash parts by their likeness to the stamped part.
fn order_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let likeness = state.current_likeness();
    let label = match likeness.map(|l| l.to) {
        Some(LikeWhat::Part(part)) if part.role == Role::Crash => "Like ■",
        _ => "Like ▲",
    };
    let response = chip(ui, label, likeness.is_some());
    response.widget_info(|| {
        let name = "Sort by likeness";
        egui::WidgetInfo::selected(egui::Role::Button, true, likeness.is_some(), name)
    });
    let help = "Sort the crash parts by area, size and thickness: most like the stamped part first";
    if response.on_hover_text(help).clicked() {
        let to = likeness.is_none().then_some(LikeWhat::Used(Role::Stamped));
        commands.push(PartCommand::OrderLike(to).into());
    }
}

/// The rows that are listed: model and place in its deck.
type Listed = Arc<Vec<(Role, u32)>>;

/// What a list was made of.
#[derive(Debug, Clone, PartialEq)]
struct Key {
    parts: PerRole<u64>,
    filter: String,
    order: Option<LikeWhat>,
}

/// Filters and sorts once per change, not once per frame.
fn listed(ui: &Ui, state: &AppState, filter: &str) -> Listed {
    let key = Key {
        parts: state.document.stamp().parts,
        filter: filter.to_owned(),
        order: state.current_likeness().map(|l| l.to),
    };
    let id = egui::Id::unique("listed parts");
    let kept: Option<(Key, Listed)> = ui.data(|data| data.get_temp(id));
    if let Some((_, listed)) = kept.filter(|(of, _)| *of == key) {
        return listed;
    }
    let listed: Listed = Arc::new(list(state, filter));
    ui.data_mut(|data| data.insert_temp(id, (key, Arc::clone(&listed))));
    listed
}

fn list(state: &AppState, filter: &str) -> Vec<(Role, u32)> {
    let filter = PartFilter::parse(filter);
    let likeness = state.current_likeness();
    let first = likeness.map_or(Role::Crash, |l| l.to.role().other());
    let mut listed = Vec::new();
    for role in [first, first.other()] {
        let Some(part) = state.document.part(role) else {
            continue;
        };
        let from = listed.len();
        let rows = part.facts.parts.iter().enumerate();
        let fitting = rows.filter(|(_, row)| filter.accepts(row));
        listed.extend(fitting.map(|(index, _)| (role, index as u32)));
        if let Some(likeness) = likeness.filter(|l| l.to.role() != role) {
            let id = |&(_, index): &(Role, u32)| part.facts.parts[index as usize].id;
            let rank = |row: &(Role, u32)| likeness.of_part.get(&id(row)).copied().unwrap_or(-1.0);
            listed[from..].sort_by(|a, b| rank(b).total_cmp(&rank(a)));
        }
    }
    listed
}

fn row_of<'a>(state: &'a AppState, &(role, index): &(Role, u32)) -> Option<Row<'a>> {
    let part = state.document.part(role)?;
    let index = index as usize;
    let summary = part.facts.parts.get(index)?;
    let likeness = state.current_likeness().filter(|l| l.to.role() != role);
    Some(Row {
        role,
        part,
        summary,
        index,
        likeness: likeness.and_then(|l| l.of_part.get(&summary.id).copied()),
    })
}

fn rows_ui(
    ui: &mut Ui,
    state: &AppState,
    listed: &Listed,
    has_titles: bool,
    commands: &mut Vec<Command>,
) {
    let is_sorted = state.current_likeness().is_some();
    let columns = columns(ui, state, listed);
    let max_rows = if listed.len() > MANY {
        MAX_ROWS_OF_MANY
    } else {
        MAX_ROWS
    };
    let height = ROW * (listed.len() as f32).min(max_rows);
    let offset = egui::Id::unique("part list offset");
    let wanted: Option<f32> = ui.data_mut(|data| data.remove_temp(offset));
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        if has_titles {
            columns.header_ui(ui, if is_sorted { "like" } else { "elem." });
        }
        let mut area = ScrollArea::vertical()
            .id_salt("parts")
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink([false, true]);
        if let Some(wanted) = wanted {
            area = area.vertical_scroll_offset(wanted);
        }
        let shown = area.show_rows(ui, ROW, listed.len(), |ui, range| {
            let mut hovered = None;
            for index in range {
                let Some(row) = row_of(state, &listed[index]) else {
                    continue;
                };
                let (is_over, response) = row_ui(ui, &row, &columns, state, commands);
                if is_over {
                    hovered = Some(row.at());
                }
                if response.has_focus() {
                    step_by_key(ui, &response, (state, listed, index));
                }
            }
            tell_hovered(ui, state, hovered, commands);
        });
        scroll_to_focus(
            ui,
            listed,
            (shown.state.unclamped_offset().y, height),
            offset,
        );
    });
}

/// Columns that fit the longest id and count among the rows that matter.
fn columns(ui: &Ui, state: &AppState, listed: &Listed) -> Columns {
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let largest = |of: &dyn Fn(&Row<'_>) -> usize| -> usize {
        let sizes = Role::ALL.into_iter().filter_map(|role| {
            let part = state.document.part(role)?;
            (0..part.facts.parts.len().min(256))
                .filter_map(|index| row_of(state, &(role, index as u32)))
                .map(|row| of(&row))
                .max()
        });
        sizes.max().unwrap_or(1).min(10)
    };
    let width = |n: usize, font: egui::FontId| {
        let digits = "0".repeat(n);
        ui.painter()
            .layout_no_wrap(digits, font, egui::Color32::WHITE)
            .size()
            .x
    };
    let id = width(largest(&|row| row.summary.id.to_string().len()), body);
    let count = largest(&|row| count_text(row, state).len());
    let count = width(count, small.clone()).max(30.0);
    let thickness = |row: &Row<'_>| {
        let thickness = row.summary.thickness?;
        Some(thickness_text(row, state, thickness).len())
    };
    let thickness = width(largest(&|row| thickness(row).unwrap_or(0)), small).max(30.0);
    let room = ui.available_rect_before_wrap();
    // The scroll bar of a long list floats over the edge of the ticks otherwise.
    let bar = if listed.len() > MAX_ROWS as usize {
        6.0
    } else {
        0.0
    };
    let has_colors = Role::ALL
        .into_iter()
        .filter_map(|role| state.document.part(role))
        .any(|part| !part.colors.is_empty());
    let is_by_part = state.view.display.color_by == ColorBy::Part;
    let ends = [room.left(), room.right() - bar];
    Columns::new(ends, [id, count, thickness], has_colors || is_by_part)
}

fn tell_hovered(ui: &Ui, state: &AppState, hovered: Option<PartRef>, commands: &mut Vec<Command>) {
    let id = egui::Id::unique("part list hovered");
    let ours: Option<PartRef> = ui.data(|data| data.get_temp(id));
    if hovered == ours {
        return;
    }
    ui.data_mut(|data| match hovered {
        Some(hovered) => {
            data.insert_temp(id, hovered);
        }
        None => data.remove::<PartRef>(id),
    });
    if hovered != state.parts.hovered {
        commands.push(PartCommand::Hover(hovered).into());
    }
}

/// Arrow keys go from row to row, also to those that are not in sight.
fn step_by_key(
    ui: &Ui,
    response: &egui::Response,
    (state, listed, index): (&AppState, &Listed, usize),
) {
    let filter = egui::EventFilter {
        vertical_arrows: true,
        ..egui::EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    // Taken away, or the next row would take the same key once more in this frame.
    let step = ui.input_mut(|input| {
        let mut pressed = |key| isize::from(input.consume_key(egui::Modifiers::NONE, key));
        pressed(egui::Key::ArrowDown) - pressed(egui::Key::ArrowUp)
    });
    let next = index.saturating_add_signed(step).min(listed.len() - 1);
    if next == index {
        return;
    }
    if let Some(row) = row_of(state, &listed[next]) {
        ui.memory_mut(|memory| memory.request_focus(row.widget()));
        ui.data_mut(|data| data.insert_temp(goal_id(), next));
    }
}

fn goal_id() -> egui::Id {
    egui::Id::unique("part row to come into sight")
}

/// Brings the row the keys went to into sight.
fn scroll_to_focus(ui: &Ui, listed: &Listed, (at, height): (f32, f32), offset: egui::Id) {
    let goal: Option<usize> = ui.data_mut(|data| data.remove_temp(goal_id()));
    let Some(goal) = goal.filter(|goal| *goal < listed.len()) else {
        return;
    };
    let (top, bottom) = (ROW * goal as f32, ROW * (goal + 1) as f32);
    let wanted = at.clamp(bottom - height, top.max(bottom - height));
    if (wanted - at).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(offset, wanted));
        ui.ctx().request_repaint();
    }
}

/// The selected part of a large deck: one click makes it the one that is matched.
fn chosen_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut selected = state.parts.selected.iter();
    let (Some(&at), None) = (selected.next(), selected.next()) else {
        return;
    };
    let Some(part) = state.document.part(at.role) else {
        return;
    };
    let is_alone = part.facts.used.len() == 1 && part.is_used(at.id);
    if part.facts.parts.len() < 2 || is_alone {
        return;
    }
    let label = format!("Match only {} {}", at.role.mark(), at.id);
    let button = egui::Button::new(label).min_size(vec2(ui.available_width(), ROW));
    let can = state.jobs.locking_job().is_none();
    // In a row of its own the text stands in the middle.
    ui.horizontal(|ui| {
        if ui.add_enabled(can, button).clicked() {
            commands.push(PartCommand::UseOnly(at).into());
        }
    });
}
