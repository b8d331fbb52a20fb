//! Search over all commands, recent files and exports.

use egui::{
    Align, Event, Key, Layout, Modifiers, Rect, RichText, ScrollArea, Sense, Ui, pos2, vec2,
};

use super::overlays::MARGIN;
use super::theme::{Palette, ROW, UNIT};
use super::widgets::{caption, draft, secondary, set_draft, text_field};
use crate::app::{AppState, Command, PaletteEntry, ViewCommand};

/// Width of the search.
const WIDTH: f32 = 560.0;

/// Height of the list at most.
const LIST: f32 = 13.5 * ROW;
/// Field, foot and margins beside the list.
const BESIDE_LIST: f32 = 130.0;

/// Where the search begins in a window of this height: with the whole list it stands in the middle.
pub fn top(window: f32) -> f32 {
    let list = LIST.min(window - MARGIN.y);
    (0.5 * (window - list - BESIDE_LIST)).max(0.0)
}

/// The field and the list of what fits.
pub fn palette_ui(ui: &mut Ui, state: &AppState, room: egui::Vec2, commands: &mut Vec<Command>) {
    ui.set_width(WIDTH.min(room.x));
    let ids = ids();
    let before = draft(ui, ids[0]);
    let mut text = before.clone();
    let mut at: usize = ui.data(|data| data.get_temp(ids[1])).unwrap_or(0);
    let steps = arrow_steps(ui);
    let id = egui::Id::unique("palette field");
    let entered: Option<bool> = ui.data_mut(|data| data.remove_temp(ids[2]));
    let mut is_entered = entered.unwrap_or_default();
    if !ui.memory(|memory| memory.has_focus(id)) {
        // What is typed while the search opens.
        ui.input(|input| {
            text.extend(typed(&input.events));
            is_entered |= has_enter(&input.events);
        });
    }
    let field = egui::TextEdit::singleline(&mut text)
        .id(id)
        .hint_text("Search commands, recent files, exports")
        .desired_width(f32::INFINITY)
        .margin(egui::Margin::symmetric(8, 6));
    let field = text_field(ui, field).accessible_name("Search commands");
    if !field.has_focus() && !field.lost_focus() {
        field.request_focus();
    }
    is_entered |= field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    let found = state.palette(&text);
    if text != before {
        at = 0;
    }
    at = at
        .saturating_add_signed(steps)
        .min(found.len().saturating_sub(1));
    let has_moved = steps != 0 || text != before;
    let mut chosen = is_entered.then(|| found.get(at)).flatten();
    ScrollArea::vertical()
        .max_height(room.y.min(LIST))
        .auto_shrink([false, true])
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if found.is_empty() {
                secondary(ui, "No matching command");
            }
            for (index, entry) in found.iter().enumerate() {
                let response = row_ui(ui, entry, index == at);
                if index == at && has_moved {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    chosen = Some(entry);
                }
            }
        });
    foot_ui(ui, found.get(at));
    let chosen = chosen
        .map(|entry| entry.commands(state))
        .unwrap_or_default();
    let is_done = !chosen.is_empty();
    if is_done {
        commands.push(ViewCommand::SetDialog(None).into());
        commands.extend(chosen);
    } else if is_entered {
        // Nothing came of it, and the search goes on.
        field.request_focus();
    }
    set_draft(ui, ids[0], text);
    ui.data_mut(|data| data.insert_temp(ids[1], at));
}

/// Where the text, the chosen line and an Enter of before are kept while the search is open.
fn ids() -> [egui::Id; 3] {
    ["palette search", "palette choice", "palette enter"].map(egui::Id::unique)
}

/// True if Enter was pressed, and not only held.
fn has_enter(events: &[Event]) -> bool {
    events.iter().any(|event| {
        matches!(
            event,
            Event::Key {
                key: Key::Enter,
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
                ..
            }
        )
    })
}

/// The texts among some events.
fn typed(events: &[Event]) -> impl Iterator<Item = &str> {
    events.iter().filter_map(|event| match event {
        Event::Text(text) => Some(text.as_str()),
        _ => None,
    })
}

/// Begins the search with what was typed right behind the key that opens it.
pub fn begin_with(ctx: &egui::Context, events: &[Event]) {
    let text: String = typed(events).collect();
    let [search, _, enter] = ids();
    ctx.data_mut(|data| {
        data.insert_temp(search, text);
        data.insert_temp(enter, has_enter(events));
    });
}

/// Empties the field, so that the search begins anew when it is opened again.
pub fn forget(ctx: &egui::Context) {
    let [text, choice, enter] = ids();
    ctx.data_mut(|data| {
        data.remove::<String>(text);
        data.remove::<usize>(choice);
        data.remove::<bool>(enter);
    });
}

/// Down and up move the choice; the field keeps left and right.
fn arrow_steps(ui: &Ui) -> isize {
    ui.input_mut(|input| {
        let mut pressed = |key| input.count_and_consume_key(Modifiers::NONE, key) as isize;
        pressed(Key::ArrowDown) - pressed(Key::ArrowUp)
            + 10 * (pressed(Key::PageDown) - pressed(Key::PageUp))
    })
}

/// One entry: name on the left, key or menu on the right.
fn row_ui(ui: &mut Ui, entry: &PaletteEntry, is_chosen: bool) -> egui::Response {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let is_possible = entry.reason.is_none();
    let spoken = format!("{}, {}", entry.label, entry.group);
    response.widget_info(|| {
        egui::WidgetInfo::selected(egui::Role::ListBoxOption, is_possible, is_chosen, &spoken)
    });
    if is_chosen {
        ui.painter().rect_filled(rect, 4.0, palette.hovered);
        let line = Rect::from_min_size(rect.min, vec2(3.0, rect.height()));
        ui.painter().rect_filled(line, 1.5, palette.accent);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, palette.widget);
    }
    let (font, small) = (
        egui::TextStyle::Body.resolve(ui.style()),
        egui::TextStyle::Small.resolve(ui.style()),
    );
    let color = if is_possible {
        palette.text
    } else {
        palette.secondary
    };
    let right = rect.right() - 12.0;
    let keys = ui
        .painter()
        .layout_no_wrap(entry.keys.clone(), font.clone(), palette.secondary);
    let keys_at = pos2(right - keys.size().x, rect.center().y - keys.size().y / 2.0);
    let group = if entry.is_recent {
        format!("recent · {}", entry.group)
    } else {
        entry.group.to_owned()
    };
    let group = ui.painter().layout_no_wrap(group, small, palette.secondary);
    let group_left = right - 104.0_f32.max(keys.size().x + 16.0) - group.size().x;
    let group_at = pos2(group_left, rect.center().y - group.size().y / 2.0);
    ui.painter().galley(keys_at, keys, palette.secondary);
    ui.painter().galley(group_at, group, palette.secondary);
    let width = group_left - rect.left() - 20.0;
    let label = marked(ui, entry, &font, color, width);
    let at = pos2(rect.left() + 12.0, rect.center().y - label.size().y / 2.0);
    ui.painter().galley(at, label, color);
    response
}

/// The label with the letters that were found standing out, cut at the width.
fn marked(
    ui: &Ui,
    entry: &PaletteEntry,
    font: &egui::FontId,
    color: egui::Color32,
    width: f32,
) -> std::sync::Arc<egui::Galley> {
    let found = Palette::of(ui).accent_text;
    let mut job = egui::text::LayoutJob::default();
    let mut letters = entry.letters.iter().copied().peekable();
    for (index, letter) in entry.label.chars().enumerate() {
        let is_found = letters.next_if_eq(&index).is_some();
        let color = if is_found { found } else { color };
        let format = egui::TextFormat::simple(font.clone(), color);
        job.append(letter.encode_utf8(&mut [0; 4]), 0.0, format);
    }
    job.wrap = egui::text::TextWrapping::truncate_at_width(width.max(0.0));
    ui.painter().layout_job(job)
}

/// What the chosen entry does, and why it may not.
fn foot_ui(ui: &mut Ui, chosen: Option<&PaletteEntry>) {
    ui.separator();
    ui.horizontal(|ui| {
        ui.set_height(ROW);
        let Some(entry) = chosen else { return };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            caption(ui, "↑ ↓   Enter   Esc");
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add_space(UNIT);
                let palette = Palette::of(ui);
                let (text, color) = match entry.reason {
                    Some(reason) => (reason.to_owned(), palette.check),
                    None => (entry.help.clone(), palette.secondary),
                };
                let text = RichText::new(text).small().color(color);
                ui.add(egui::Label::new(text).truncate());
            });
        });
    });
}
