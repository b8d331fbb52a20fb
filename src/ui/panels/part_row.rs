//! One row of the part list.

use egui::{
    Align2, Color32, FontId, Rangef, Rect, Response, Sense, Stroke, TextStyle, Ui, Vec2, pos2, vec2,
};

use super::section::elided_middle;
use crate::app::{Action, AppState, Command, LikeWhat, Part, PartCommand, PartRef, ViewCommand};
use crate::formats::PartSummary;
use crate::role::Role;
use crate::text::{counted, whole_percent};
use crate::ui::theme::{Palette, ROW, color};
use crate::ui::widgets::{eye, focus_ring, grouped, paint_role_mark};

/// Space between two columns.
const GAP: f32 = 6.0;
/// Narrower lists leave the thickness to the tooltip, so that names keep their room.
const WITH_THICKNESS: f32 = 380.0;

/// A part of a deck with what it belongs to.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    /// Side the part belongs to.
    pub role: Role,
    /// The model's part in the document.
    pub part: &'a Part,
    /// The part of the deck.
    pub summary: &'a PartSummary,
    /// Its place in the deck, which gives its colour.
    pub index: usize,
    /// How like it is to what the list is sorted by.
    pub likeness: Option<f64>,
}

impl<'a> Row<'a> {
    /// A part of a deck, wherever it was pointed at.
    pub fn of(state: &'a AppState, at: PartRef) -> Option<Self> {
        let part = state.document.part(at.role)?;
        let index = part.facts.parts.iter().position(|row| row.id == at.id)?;
        Some(Self {
            role: at.role,
            part,
            summary: &part.facts.parts[index],
            index,
            likeness: None,
        })
    }

    /// Its name in commands.
    pub fn at(&self) -> PartRef {
        PartRef {
            role: self.role,
            id: self.summary.id,
        }
    }

    /// "Part 12 Floor".
    pub fn name(&self) -> String {
        format!("Part {} {}", self.summary.id, self.summary.title)
            .trim_end()
            .to_owned()
    }

    /// Name of its widget.
    pub fn widget(&self) -> egui::Id {
        egui::Id::unique("part row").with((self.role, self.summary.id))
    }
}

/// Where the columns lie, from left to right.
#[derive(Debug, Clone, Copy)]
pub struct Columns {
    eye: Rangef,
    mark: Rangef,
    color: Rangef,
    id: Rangef,
    name: Rangef,
    count: Rangef,
    thickness: Rangef,
    tick: Rangef,
}

impl Columns {
    /// Columns between two edges; `id`, `count` and `thickness` are the widths of their longest texts. Colours have
    /// a column only where they say more than the mark of the role.
    pub fn new(
        [left, right]: [f32; 2],
        [id, count, thickness]: [f32; 3],
        has_colors: bool,
    ) -> Self {
        let from = |start: f32, width: f32| Rangef::new(start, start + width);
        let to = |end: f32, width: f32| Rangef::new(end - width, end);
        let eye = from(left, 22.0);
        let mark = from(eye.max + 2.0, 10.0);
        let color = if has_colors {
            from(mark.max + GAP, 10.0)
        } else {
            from(mark.max, 0.0)
        };
        let id = from(color.max + GAP, id);
        let tick = to(right, 22.0);
        let has_thickness = right - left >= WITH_THICKNESS;
        let thickness = to(tick.min - 2.0, if has_thickness { thickness } else { 0.0 });
        let count = to(thickness.min - if has_thickness { GAP } else { 0.0 }, count);
        let name = Rangef::new(id.max + GAP, count.min - GAP);
        Self {
            eye,
            mark,
            color,
            id,
            name,
            count,
            thickness,
            tick,
        }
    }

    /// The titles above the columns.
    pub fn header_ui(&self, ui: &mut Ui, count: &str) {
        let size = vec2(ui.available_width(), 16.0);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let font = FontId::proportional(11.0);
        let color = Palette::of(ui).secondary;
        let middle = rect.center().y;
        let titles = [
            ("id", self.id.min, Align2::LEFT_CENTER),
            ("name", self.name.min, Align2::LEFT_CENTER),
            (count, self.count.max, Align2::RIGHT_CENTER),
            ("t", self.thickness.max, Align2::RIGHT_CENTER),
            ("use", self.tick.max - 2.0, Align2::RIGHT_CENTER),
        ];
        for (text, x, align) in titles {
            let has_room = match text {
                "name" => self.name.span() >= 32.0,
                "t" => self.thickness.span() > 0.0,
                _ => true,
            };
            if !has_room {
                continue;
            }
            ui.painter()
                .text(pos2(x, middle), align, text, font.clone(), color);
        }
    }
}

/// Draws a row with its clicks; true while the pointer is over it.
pub fn row_ui(
    ui: &mut Ui,
    row: &Row<'_>,
    columns: &Columns,
    state: &AppState,
    commands: &mut Vec<Command>,
) -> (bool, Response) {
    let palette = Palette::of(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let id = row.widget();
    let response = ui.interact(rect, id, Sense::click());
    let (at, name) = (row.at(), row.name());
    let is_selected = state.parts.selected.contains(&at);
    if is_selected {
        let fill = palette.accent.gamma_multiply(0.35);
        ui.painter().rect_filled(rect, 4.0, fill);
    } else if response.hovered() || state.parts.hovered == Some(at) {
        ui.painter().rect_filled(rect, 4.0, palette.card);
    }
    focus_ring(ui, rect, &response);
    paint(ui, rect, row, columns, state);
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, &name));
    let cell = |x: Rangef| Rect::from_x_y_ranges(x, rect.y_range());
    let eye = eye_ui(ui, cell(columns.eye), row, (state, &name));
    if eye.clicked() {
        let only = ui.input(|input| input.modifiers.command);
        commands.push(eye_command(row, only).into());
    }
    let tick = tick_ui(ui, cell(columns.tick), row, (state, &name));
    if tick.clicked() {
        let is_used = state.is_part_used(at);
        commands.push(PartCommand::SetUsed(at, !is_used).into());
    }
    clicks(ui, &response, at, commands);
    response.context_menu(|ui| menu_ui(ui, row, state, commands));
    let is_over = response.hovered() || eye.hovered() || tick.hovered();
    let response = response.on_hover_text(hover_text(row, state));
    (is_over, response)
}

/// Shows or hides; alone, shows only this one, or everything if it is the only one already.
fn eye_command(row: &Row<'_>, is_alone: bool) -> PartCommand {
    let at = row.at();
    let is_visible = row.part.is_visible(at.id);
    let n_others = row.part.facts.parts.len() - 1;
    let is_only = is_visible && n_others > 0 && row.part.hidden.len() >= n_others;
    match (is_alone, is_only) {
        (true, true) => PartCommand::ShowAll,
        (true, false) => PartCommand::ShowOnly(at),
        (false, _) => PartCommand::SetVisible(at, !is_visible),
    }
}

fn hover_text(row: &Row<'_>, state: &AppState) -> String {
    let summary = row.summary;
    let mut text = format!(
        "{}\n{}, {}, {}",
        row.name(),
        counted(summary.n_shells, "shell"),
        counted(summary.n_solids, "solid"),
        counted(summary.n_triangles, "triangle")
    );
    if let Some(thickness) = summary.thickness {
        text += &format!(", thickness {}", state.lengths_of(row.role).of(thickness));
    }
    if let Some(likeness) = row.likeness {
        text += &format!("\nlikeness {}", whole_percent(likeness));
    }
    text + "\nClick selects, double click brings it into view, middle click shows only it"
}

fn clicks(ui: &Ui, response: &Response, at: PartRef, commands: &mut Vec<Command>) {
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

/// What can be done with a part, in the list and in 3D.
pub fn menu_ui(ui: &mut Ui, row: &Row<'_>, state: &AppState, commands: &mut Vec<Command>) {
    let at = row.at();
    let is_visible = row.part.is_visible(at.id);
    let is_used = state.is_part_used(at);
    let like = Some(LikeWhat::Part(at));
    if ui.button(Action::FocusSelection.row().label).clicked() {
        commands.push(PartCommand::Select(Some(at)).into());
        commands.push(ViewCommand::Focus(state.view.camera_of(at.role)).into());
        ui.close();
    }
    let groups: [&[(&str, PartCommand)]; 3] = [
        &[
            (
                if is_visible { "Hide" } else { "Show" },
                PartCommand::SetVisible(at, !is_visible),
            ),
            ("Show only this", PartCommand::ShowOnly(at)),
            ("Show all", PartCommand::ShowAll),
        ],
        &[
            (
                if is_used {
                    "Ignore for the match"
                } else {
                    "Use for the match"
                },
                PartCommand::SetUsed(at, !is_used),
            ),
            ("Match only this", PartCommand::UseOnly(at)),
            ("Match all parts of this deck", PartCommand::UseAll(at.role)),
        ],
        &[("Find parts like this", PartCommand::OrderLike(like))],
    ];
    let is_free = state.jobs.is_unlocked();
    for items in groups {
        for (label, command) in items {
            let locked = is_free.as_ref().err().filter(|_| command.chooses());
            let button = ui.add_enabled(locked.is_none(), egui::Button::new(*label));
            let button = match locked {
                Some(reason) => button.on_disabled_hover_text(reason.to_string()),
                None => button,
            };
            if button.clicked() {
                commands.push((*command).into());
                ui.close();
            }
        }
        ui.separator();
    }
    if !is_used {
        unused_ui(ui, state, commands);
    }
    color_ui(ui, row, commands);
}

/// Whether all parts that are not used are drawn.
fn unused_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let action = Action::ToggleUnused;
    let mut is_on = action.is_on(state) == Some(true);
    let row = action.row();
    if ui
        .checkbox(&mut is_on, row.label)
        .on_hover_text(row.tooltip)
        .changed()
    {
        commands.extend(action.command(state));
        ui.close();
    }
    ui.separator();
}

fn color_ui(ui: &mut Ui, row: &Row<'_>, commands: &mut Vec<Command>) {
    let at = row.at();
    let given = row.part.colors.get(&at.id).copied();
    let mut color = given.unwrap_or([128, 128, 128]);
    let before = color;
    ui.horizontal(|ui| {
        ui.label("Colour");
        ui.name_inputs("Colour of the part", |ui| {
            ui.color_edit_button_srgb(&mut color);
        });
        if ui
            .add_enabled(given.is_some(), egui::Button::new("As its role"))
            .clicked()
        {
            commands.push(PartCommand::SetColor(at, None).into());
        }
    });
    if color != before {
        commands.push(PartCommand::SetColor(at, Some(color)).into());
    }
}

/// Mark, colour, id, title, count, thickness.
fn paint(ui: &Ui, rect: Rect, row: &Row<'_>, columns: &Columns, state: &AppState) {
    let palette = Palette::of(ui);
    let is_visible = row.part.is_visible(row.summary.id);
    let strong = if is_visible {
        palette.text
    } else {
        palette.secondary
    };
    let middle = rect.center().y;
    let square = |x: Rangef| Rect::from_center_size(pos2(x.center(), middle), Vec2::splat(9.0));
    paint_role_mark(
        ui.painter(),
        square(columns.mark),
        row.role,
        palette.role(row.role),
    );
    if columns.color.span() > 0.0 {
        let color = part_color(ui, row, state);
        let at = square(columns.color).center();
        ui.painter().circle_filled(at, 4.5, color);
    }
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let left = |x: Rangef, text: &str, color: Color32| {
        let whole = |font: &FontId| {
            let laid = ui
                .painter()
                .layout_no_wrap(text.to_owned(), font.clone(), color);
            laid.size().x <= x.span()
        };
        // A title is read whole in small letters sooner than cut.
        let font = if whole(&small) && !whole(&body) {
            &small
        } else {
            &body
        };
        let galley = elided_middle(ui, text, font.clone(), color, x.span());
        let at = pos2(x.min, middle - galley.size().y / 2.0);
        ui.painter().galley(at, galley, color);
    };
    left(columns.id, &row.summary.id.to_string(), strong);
    if columns.name.span() > 24.0 {
        left(columns.name, &row.summary.title, strong);
    }
    let right = |x: Rangef, text: String| {
        let at = pos2(x.max, middle);
        ui.painter().text(
            at,
            Align2::RIGHT_CENTER,
            text,
            small.clone(),
            palette.secondary,
        );
    };
    right(columns.count, count_text(row, state));
    let thickness = row.summary.thickness;
    if let Some(thickness) = thickness.filter(|_| columns.thickness.span() > 0.0) {
        right(columns.thickness, thickness_text(row, state, thickness));
    }
}

/// A thickness as a number in the unit of the other lengths.
pub fn thickness_text(row: &Row<'_>, state: &AppState, thickness: f64) -> String {
    state.lengths_of(row.role).number(thickness)
}

/// Elements, or the likeness while the list is sorted by it; what it is compared with has none.
pub fn count_text(row: &Row<'_>, state: &AppState) -> String {
    match row.likeness {
        Some(likeness) => whole_percent(likeness),
        None if state.current_likeness().is_some() => String::new(),
        None => grouped(row.summary.n_shells + row.summary.n_solids),
    }
}

/// The colour it is drawn in.
fn part_color(ui: &Ui, row: &Row<'_>, state: &AppState) -> Color32 {
    let given = row.part.colors.get(&row.summary.id).copied();
    let rgb = given.or_else(|| crate::ui::theme::part_color(ui, state, row.index));
    match rgb {
        Some(rgb) => color(rgb),
        None => Palette::of(ui).role(row.role),
    }
}

/// An eye that is open or struck out; struck out and without effect for a part that is not drawn because it is not
/// matched.
fn eye_ui(ui: &Ui, rect: Rect, row: &Row<'_>, (state, name): (&AppState, &str)) -> Response {
    let is_drawn = row.part.is_used(row.summary.id) || state.view.display.has_unused;
    let is_visible = is_drawn && row.part.is_visible(row.summary.id);
    let sense = if is_drawn {
        Sense::click()
    } else {
        Sense::hover()
    };
    let response = ui.interact(rect, row.widget().with("eye"), sense);
    eye(ui, rect, &response, (is_visible, &format!("Show {name}")));
    response.on_hover_text(if is_drawn {
        "Show or hide. With Ctrl: show only this"
    } else {
        "Not matched and so not shown; View › Display shows unused parts"
    })
}

/// How strong the tick is that cannot be taken away.
const FADED: f32 = 0.5;

/// The tick "use for match".
fn tick_ui(ui: &Ui, rect: Rect, row: &Row<'_>, (state, name): (&AppState, &str)) -> Response {
    let palette = Palette::of(ui);
    let is_used = state.is_part_used(row.at());
    let is_only = state.is_only_part_used(row.at());
    let is_free = state.jobs.locking_job().is_none() && !is_only;
    let sense = if is_free {
        Sense::click()
    } else {
        Sense::hover()
    };
    let response = ui.interact(rect, row.widget().with("use"), sense);
    focus_ring(ui, rect, &response);
    let square = Rect::from_center_size(rect.center(), Vec2::splat(14.0));
    let (fill, stroke) = if is_used && is_only {
        (palette.accent.gamma_multiply(FADED), Stroke::NONE)
    } else if is_used {
        (palette.accent, Stroke::NONE)
    } else {
        (palette.field, Stroke::new(1.0, palette.secondary))
    };
    let inside = egui::StrokeKind::Inside;
    ui.painter().rect(square, 3.0, fill, stroke, inside);
    if is_used {
        let c = square.center();
        let points = [vec2(-3.5, 0.0), vec2(-1.0, 3.0), vec2(4.0, -3.5)];
        let points = points.map(|by| c + by).to_vec();
        ui.painter()
            .line(points, Stroke::new(1.6, palette.on_accent));
    }
    let label = format!("Use {name} for the match");
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, is_free, is_used, &label));
    response.on_hover_text(if is_only {
        "The only part that is used; use another one to leave this one out"
    } else {
        "Use for the match"
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::formats::Model;
    use crate::geometry::{Point3, TriMesh};
    use crate::jobs::{PartFacts, PartSource};
    use crate::monitor::Monitor;
    use crate::pipeline::load::{LoadSettings, prepare};

    #[test]
    fn a_thickness_has_its_digits_in_every_unit() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]].map(Point3::from);
        let mesh = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let model = Arc::new(Model::from_mesh(&mesh, "triangle"));
        let (path, monitor) = (Path::new("triangle.k"), Monitor::silent());
        let loaded = prepare(path, model, &LoadSettings::default(), &monitor).unwrap();
        let facts = PartFacts::of(&loaded, &monitor).unwrap();
        let source = PartSource::File(path.to_path_buf());
        let part = Part::new(Arc::new(loaded), Arc::new(facts), source, 1);
        let row = Row {
            role: Role::Crash,
            part: &part,
            summary: &part.facts.parts[0],
            index: 0,
            likeness: None,
        };
        let state = AppState::default();
        for (thickness, text) in [(1.8, "1.80"), (0.0015, "0.00150")] {
            assert_eq!(thickness_text(&row, &state, thickness), text);
        }
    }
}
