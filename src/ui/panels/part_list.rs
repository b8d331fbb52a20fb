//! The parts of both decks: eye, role, id, name, thickness, tick for the match.

use super::part_filter::PartFilter;
use super::section::elided;
use crate::app::{AppState, Command, Part, PartCommand, PartRef, ViewCommand};
use crate::formats::PartSummary;
use crate::jobs::Role;
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::{caption, draft, grouped, paint_role_mark, set_draft};
use egui::{Align2, Rect, Response, ScrollArea, Sense, Stroke, TextStyle, Ui, Vec2, pos2, vec2};

/// Most rows that are seen at once; the rest scrolls.
const MAX_ROWS: f32 = 6.0;

type Row<'a> = (Role, &'a Part, &'a PartSummary);

/// Filter and list.
pub fn part_list_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let id = egui::Id::unique("part filter");
    let mut text = draft(ui, id);
    let n_parts: usize = state
        .document
        .parts
        .iter()
        .filter_map(|(_, part)| part.as_ref())
        .map(|part| part.facts.parts.len())
        .sum();
    if n_parts > 2 || !text.is_empty() {
        let field = egui::TextEdit::singleline(&mut text)
            .hint_text("Filter: 2000012, 100-200, pillar, t>1.4")
            .margin(egui::Margin::symmetric(8, 3))
            .desired_width(f32::INFINITY);
        ui.add(field).accessible_name("Filter parts");
        set_draft(ui, id, text.clone());
    }
    let filter = PartFilter::parse(&text);
    let rows: Vec<Row<'_>> = state
        .document
        .parts
        .iter()
        .filter_map(|(role, part)| Some((role, part.as_ref()?)))
        .flat_map(|(role, part)| part.facts.parts.iter().map(move |row| (role, part, row)))
        .filter(|(_, _, row)| filter.accepts(row))
        .collect();
    if rows.is_empty() {
        caption(
            ui,
            format!("None of {} parts fits the filter", grouped(n_parts)),
        );
        return;
    }
    let height = ROW * (rows.len() as f32).min(MAX_ROWS);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        ScrollArea::vertical()
            .id_salt("parts")
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink([false, true])
            .show_rows(ui, ROW, rows.len(), |ui, range| {
                let mut hovered = None;
                for row in &rows[range] {
                    if row_ui(ui, row, state, commands) {
                        hovered = Some(PartRef {
                            role: row.0,
                            id: row.2.id,
                        });
                    }
                }
                let is_ours = ui.rect_contains_pointer(ui.clip_rect());
                if is_ours && hovered != state.view.hovered {
                    commands.push(PartCommand::Hover(hovered).into());
                }
            });
    });
}

/// One row; true while the pointer is over it.
fn row_ui(
    ui: &mut Ui,
    &(role, part, row): &Row<'_>,
    state: &AppState,
    commands: &mut Vec<Command>,
) -> bool {
    let palette = Palette::of(ui);
    let at = PartRef { role, id: row.id };
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let id = ui.scope_id().with(("part", role, row.id));
    let response = ui.interact(rect, id, Sense::click());
    let is_visible = part.is_visible(row.id);
    let is_selected = state.view.selected.contains(&at);
    if is_selected {
        ui.painter()
            .rect_filled(rect, 4.0, palette.accent.gamma_multiply(0.35));
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, palette.card);
    }
    let eye = Rect::from_min_size(rect.min, Vec2::splat(ROW));
    let tick = Rect::from_min_size(pos2(rect.right() - ROW, rect.top()), Vec2::splat(ROW));
    paint_row(ui, rect, (role, row), is_visible);
    let name = match row.title.is_empty() {
        true => format!("Part {}", row.id),
        false => format!("Part {} {}", row.id, row.title),
    };
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, &name));
    let eye = eye_ui(ui, eye, id, is_visible, &name);
    if eye.clicked() {
        let only = ui.input(|input| input.modifiers.command);
        commands.push(if only {
            PartCommand::ShowOnly(at).into()
        } else {
            PartCommand::SetVisible(at, !is_visible).into()
        });
    }
    let tick = tick_ui(ui, tick, id, (part.is_used(row.id), state), &name);
    if tick.clicked() {
        let is_used = part.is_used(row.id);
        commands.push(PartCommand::SetUsed(at, !is_used).into());
    }
    row_clicks(ui, &response, at, commands);
    response.context_menu(|ui| row_menu(ui, at, part, commands));
    let is_over = response.hovered() || eye.hovered() || tick.hovered();
    response.on_hover_text(format!(
        "{name}\n{} shells, {} solids, {} triangles",
        grouped(row.n_shells),
        grouped(row.n_solids),
        grouped(row.n_triangles)
    ));
    is_over
}

fn row_clicks(ui: &Ui, response: &Response, at: PartRef, commands: &mut Vec<Command>) {
    if response.double_clicked() {
        commands.push(PartCommand::Select(Some(at)).into());
        commands.push(ViewCommand::Focus(at.role).into());
    } else if response.middle_clicked() {
        commands.push(PartCommand::ShowOnly(at).into());
    } else if response.clicked() {
        let is_toggling = ui.input(|input| input.modifiers.command);
        commands.push(if is_toggling {
            PartCommand::ToggleSelected(at).into()
        } else {
            PartCommand::Select(Some(at)).into()
        });
    }
}

fn row_menu(ui: &mut Ui, at: PartRef, part: &Part, commands: &mut Vec<Command>) {
    let is_visible = part.is_visible(at.id);
    let items: [(&str, PartCommand); 6] = [
        (
            if is_visible { "Hide" } else { "Show" },
            PartCommand::SetVisible(at, !is_visible),
        ),
        ("Show only this", PartCommand::ShowOnly(at)),
        ("Show all", PartCommand::ShowAll),
        ("Match only this", PartCommand::UseOnly(at)),
        ("Match all parts of this deck", PartCommand::UseAll(at.role)),
        ("Colour as its role", PartCommand::SetColor(at, None)),
    ];
    for (label, command) in items {
        if ui.button(label).clicked() {
            commands.push(command.into());
        }
    }
    let mut color = part.colors.get(&at.id).copied().unwrap_or([128, 128, 128]);
    let before = color;
    ui.horizontal(|ui| {
        ui.label("Colour");
        ui.name_inputs("Colour of the part", |ui| {
            ui.color_edit_button_srgb(&mut color);
        });
    });
    if color != before {
        commands.push(PartCommand::SetColor(at, Some(color)).into());
    }
}

/// Mark, id, title, thickness.
fn paint_row(ui: &Ui, rect: Rect, (role, row): (Role, &PartSummary), is_visible: bool) {
    let palette = Palette::of(ui);
    let text = if is_visible {
        palette.text
    } else {
        palette.secondary
    };
    let middle = rect.center().y;
    let mark = Rect::from_center_size(pos2(rect.left() + ROW + 6.0, middle), Vec2::splat(9.0));
    paint_role_mark(ui.painter(), mark, role, palette.role(role));
    let font = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let right = rect.right() - ROW - 4.0;
    let thickness = row
        .thickness
        .map_or_else(String::new, |t| format!("{t:.2}"));
    let thickness_rect = ui.painter().text(
        pos2(right, middle),
        Align2::RIGHT_CENTER,
        thickness,
        small,
        palette.secondary,
    );
    let left = mark.right() + UNIT;
    let name = match row.title.is_empty() {
        true => row.id.to_string(),
        false => format!("{}  {}", row.id, row.title),
    };
    let room = thickness_rect.left().min(right) - UNIT - left;
    let galley = elided(ui, &name, font, text, room);
    let at = pos2(left, middle - galley.size().y / 2.0);
    ui.painter().galley(at, galley, text);
}

/// An eye that is open or struck out.
fn eye_ui(ui: &Ui, rect: Rect, id: egui::Id, is_visible: bool, name: &str) -> Response {
    let palette = Palette::of(ui);
    let response = ui.interact(rect, id.with("eye"), Sense::click());
    let color = if is_visible {
        palette.text
    } else {
        palette.secondary
    };
    let stroke = Stroke::new(1.2, color);
    let c = rect.center();
    let lid = |up: f32| {
        let points = [
            c + vec2(-6.5, 0.0),
            c + vec2(-3.0, up),
            c + vec2(3.0, up),
            c + vec2(6.5, 0.0),
        ];
        egui::epaint::CubicBezierShape::from_points_stroke(
            points,
            false,
            egui::Color32::TRANSPARENT,
            stroke,
        )
    };
    ui.painter().add(lid(-5.5));
    ui.painter().add(lid(5.5));
    if is_visible {
        ui.painter().circle_filled(c, 2.2, color);
    } else {
        ui.painter()
            .line_segment([c + vec2(-6.0, 5.0), c + vec2(6.0, -5.0)], stroke);
    }
    let label = format!("Show {name}");
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_visible, &label));
    response.on_hover_text("Show or hide. With Ctrl: show only this")
}

/// The tick "use for match".
fn tick_ui(
    ui: &Ui,
    rect: Rect,
    id: egui::Id,
    (is_used, state): (bool, &AppState),
    name: &str,
) -> Response {
    let palette = Palette::of(ui);
    let is_free = state.locking_job().is_none();
    let sense = if is_free {
        Sense::click()
    } else {
        Sense::hover()
    };
    let response = ui.interact(rect, id.with("use"), sense);
    let square = Rect::from_center_size(rect.center(), Vec2::splat(14.0));
    let (fill, stroke) = if is_used {
        (palette.accent, Stroke::NONE)
    } else {
        (palette.field, Stroke::new(1.0, palette.secondary))
    };
    ui.painter()
        .rect(square, 3.0, fill, stroke, egui::StrokeKind::Inside);
    if is_used {
        let c = square.center();
        let points = vec![
            c + vec2(-3.5, 0.0),
            c + vec2(-1.0, 3.0),
            c + vec2(4.0, -3.5),
        ];
        ui.painter()
            .line(points, Stroke::new(1.6, palette.on_accent));
    }
    let label = format!("Use {name} for the match");
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, is_free, is_used, &label));
    response.on_hover_text("Use for the match")
}
