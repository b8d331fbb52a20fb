//! The two 3D windows with what stands in them while there is nothing to draw.

use std::path::PathBuf;

use egui::{Align, CursorIcon, Layout, Rect, RichText, Sense, Shape, Stroke, Ui, UiBuilder, vec2};

use super::drop::{self, DropTarget};
use crate::app::{
    Action, AppState, Command, FileCommand, FreeWindow, PictureWindows, Settings, age_text,
};
use crate::jobs::JobKey;
use crate::report::picture::Picture;
use crate::role::Role;
use crate::ui::overlays::mouse_choice;
use crate::ui::pictures::clickable;
use crate::ui::theme::{Palette, ROW, TALL, UNIT};
use crate::ui::viewport::Viewports;
use crate::ui::viewport::{free_choice, read_points};
use crate::ui::widgets::{Look, action_button, card, paragraph, role_mark, secondary};

/// Where the windows lay in the last frame, for drops and toasts.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    crash: Rect,
    stamped: Rect,
}

fn place(ctx: &egui::Context) -> Option<Place> {
    ctx.data(|data| data.get_temp(egui::Id::unique("graphics place")))
}

/// The window a dropped file is meant for.
pub fn role_under_pointer(ctx: &egui::Context) -> Option<Role> {
    let at = ctx.pointer_latest_pos()?;
    let place = place(ctx)?;
    if place.crash.contains(at) {
        Some(Role::Crash)
    } else if place.stamped.contains(at) {
        Some(Role::Stamped)
    } else {
        None
    }
}

/// What both windows take together.
pub fn area(ctx: &egui::Context) -> Rect {
    place(ctx).map_or_else(
        || ctx.content_rect(),
        |place| place.crash.union(place.stamped),
    )
}

/// The part of a picture of the screen that shows the 3D windows.
pub fn cut_out(
    ctx: &egui::Context,
    screen: &egui::ColorImage,
    windows: PictureWindows,
) -> Option<Picture> {
    let place = place(ctx)?;
    let rect = match windows {
        PictureWindows::AsShown => place.crash.union(place.stamped),
        PictureWindows::Left => place.crash,
        PictureWindows::Right => place.stamped,
    };
    let part = screen.region(&rect, Some(ctx.pixels_per_point()));
    let [width, height] = part.size;
    let rgba = part
        .pixels
        .iter()
        .flat_map(|pixel| pixel.to_srgba_unmultiplied());
    Some(Picture {
        width,
        height,
        rgba: rgba.collect(),
    })
}

/// Both windows side by side, crash left.
pub fn graphics_ui(
    ui: &mut Ui,
    state: &AppState,
    viewports: &mut Viewports,
    commands: &mut Vec<Command>,
) {
    let room = ui.available_rect_before_wrap();
    let share = splitter(ui, room);
    let middle = room.left() + share * room.width();
    let crash = Rect::from_min_max(room.min, egui::pos2(middle - 1.0, room.bottom()));
    let stamped = Rect::from_min_max(egui::pos2(middle + 1.0, room.top()), room.max);
    let line = Stroke::new(2.0, Palette::of(ui).bar);
    ui.painter().vline(middle, room.y_range(), line);
    for (role, rect) in [(Role::Crash, crash), (Role::Stamped, stamped)] {
        let mut child = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(role.word()));
        child.set_clip_rect(rect.intersect(ui.clip_rect()));
        child.spacing_mut().item_spacing = vec2(0.0, 0.0);
        pane_ui(&mut child, role, state, viewports, commands);
    }
    ui.data_mut(|data| {
        data.insert_temp(egui::Id::unique("graphics place"), Place { crash, stamped });
    });
    ui.advance_cursor_after_rect(room);
    drop_hint(ui, state, crash, stamped);
}

/// The line between the windows can be dragged; a double click puts it back.
fn splitter(ui: &Ui, room: Rect) -> f32 {
    let id = egui::Id::unique("graphics splitter");
    let mut share: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(0.5);
    let x = room.left() + share * room.width();
    let grip = Rect::from_x_y_ranges(x - 4.0..=x + 4.0, room.y_range());
    let response = ui.interact(grip, id.with("grip"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Splitter, true, "Between the 3D windows")
    });
    if response.hovered() || response.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if let Some(at) = response
        .interact_pointer_pos()
        .filter(|_| response.dragged())
    {
        share = ((at.x - room.left()) / room.width()).clamp(0.15, 0.85);
    }
    if response.double_clicked() {
        share = 0.5;
    }
    ui.data_mut(|data| data.insert_temp(id, share));
    share
}

fn pane_ui(
    ui: &mut Ui,
    role: Role,
    state: &AppState,
    viewports: &mut Viewports,
    commands: &mut Vec<Command>,
) {
    let is_flying = viewports.is_crossing(ui.input(|input| input.time));
    let is_free = state.free_window() == Some(FreeWindow::Nothing) && !is_flying;
    let is_away = role == Role::Stamped && is_free;
    let is_drawing = role == Role::Stamped && state.free_window() == Some(FreeWindow::Section);
    let is_drawn = is_drawing && !is_flying;
    let has_part = state.document.part(role).is_some();
    if has_part && !is_away && !is_drawn {
        viewports.show(ui, role, state, commands);
        return;
    }
    viewports.show_none(role);
    if is_drawn {
        drawing_ui(ui, state, viewports, commands);
        return;
    }
    let rect = ui.max_rect();
    let palette = Palette::of(ui);
    ui.painter().add(viewports.fill(rect, palette.ground));
    if is_away {
        away_ui(ui, rect, state, commands);
    } else {
        empty_ui(ui, rect, role, state, commands);
    }
}

/// The section laid flat, below the choice of what the window shows.
fn drawing_ui(ui: &mut Ui, state: &AppState, viewports: &Viewports, commands: &mut Vec<Command>) {
    let rect = ui.max_rect();
    ui.painter()
        .add(viewports.fill(rect, Palette::of(ui).ground));
    let inner = rect.shrink2(vec2(14.0, 10.0));
    ui.scope_builder(UiBuilder::new().max_rect(inner), |ui| {
        ui.spacing_mut().item_spacing = vec2(UNIT, UNIT);
        let width = 496.0_f32.min(inner.width());
        clickable(ui, |ui| free_choice(ui, state, width, commands));
        viewports.section_ui(ui, state, commands);
    });
}

/// The stamped part is shown in the left window.
fn away_ui(ui: &mut Ui, rect: Rect, state: &AppState, commands: &mut Vec<Command>) {
    let size = vec2(430.0_f32.min(rect.width() - 32.0), 170.0);
    centered(ui, rect, size, |ui| {
        ui.vertical_centered(|ui| {
            role_mark(ui, Role::Stamped);
            ui.label(if state.is_mapped_alone() {
                "Not drawn: the left window shows the mapped crash part"
            } else {
                "Moved to the left window"
            });
            ui.add_space(UNIT);
            clickable(ui, |ui| {
                let look = ("Move back", Look::Plain, vec2(128.0, TALL));
                action_button(ui, state, Action::ToggleMoveOver, look, commands);
                ui.add_space(UNIT);
                secondary(ui, "Use this window for");
                free_choice(ui, state, ui.available_width(), commands);
            });
        });
    });
}

/// Dashed frame, what to drop here, and the other ways in.
fn empty_ui(ui: &mut Ui, rect: Rect, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let is_low = rect.height() < 320.0;
    let frame = rect.shrink(if is_low { 8.0 } else { 24.0 });
    let corners = [
        frame.left_top(),
        frame.right_top(),
        frame.right_bottom(),
        frame.left_bottom(),
        frame.left_top(),
    ];
    let stroke = Stroke::new(1.0, palette.secondary.gamma_multiply(0.5));
    ui.painter()
        .extend(Shape::dashed_line(&corners, stroke, 6.0, 6.0));
    let is_loading = state.jobs.is_active(JobKey::Load(role));
    let running = state.jobs.running();
    let shape = running.filter(|job| job.key == JobKey::Load(role) && is_loading);
    if let Some(points) = shape.and_then(|job| job.shape.as_ref()) {
        read_points(ui, frame.shrink(UNIT), role, points);
    }
    let room = frame.shrink(8.0).size();
    let size = vec2(320.0_f32.min(room.x), 440.0_f32.min(room.y));
    // A low window keeps the words and the buttons and leaves the ornament.
    centered(ui, rect, size, |ui| {
        egui::ScrollArea::vertical()
            .id_salt(("empty", role.word()))
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.vertical_centered(|ui| {
                    if !is_low {
                        ui.add_space(2.0 * UNIT);
                        let (mark, _) = ui.allocate_exact_size(vec2(32.0, 32.0), Sense::hover());
                        let color = palette.role(role);
                        crate::ui::widgets::paint_role_mark(ui.painter(), mark, role, color);
                        ui.add_space(UNIT);
                    }
                    if is_loading {
                        loading_ui(ui, role, state, commands);
                    } else {
                        invitation_ui(ui, role, (state, is_low), commands);
                    }
                });
            });
    });
}

fn loading_ui(ui: &mut Ui, role: Role, state: &AppState, commands: &mut Vec<Command>) {
    ui.label(RichText::new(format!("Loading the {} part", role.word())).size(16.0));
    ui.add_space(UNIT);
    let running = state
        .jobs
        .running()
        .filter(|job| job.key == JobKey::Load(role));
    let Some(job) = running else {
        secondary(ui, "Waiting for the previous file");
        return;
    };
    let counted = job.progress.and_then(|progress| {
        let total = progress.total.filter(|total| *total > 0)?;
        Some(progress.done as f32 / total as f32)
    });
    if let Some(share) = counted {
        let bar = egui::ProgressBar::new(share)
            .desired_width(240.0)
            .desired_height(6.0);
        ui.add(bar).accessible_name("Loading");
        ui.add_space(UNIT);
    }
    ui.add(egui::Label::new(RichText::new(job.words()).color(Palette::of(ui).secondary)).wrap());
    ui.add_space(UNIT);
    if ui.button("Cancel loading").clicked() {
        commands.push(Command::CancelPresent);
    }
}

fn invitation_ui(
    ui: &mut Ui,
    role: Role,
    (state, is_low): (&AppState, bool),
    commands: &mut Vec<Command>,
) {
    let (title, text, action) = match role {
        Role::Crash => (
            "Drop the crash model here",
            "Fixed. It keeps its place.",
            Action::OpenCrash,
        ),
        Role::Stamped => (
            "Drop the stamped part here",
            "Moves onto the crash part.",
            Action::OpenStamped,
        ),
    };
    ui.add(egui::Label::new(RichText::new(title).size(16.0)).wrap());
    ui.add_space(4.0);
    if !is_low {
        secondary(ui, text);
        ui.add_space(2.0 * UNIT);
    }
    let width = 208.0_f32.min(ui.available_width());
    let is_empty = state.document.parts.iter().all(|(_, part)| part.is_none());
    let look = if role == Role::Crash && is_empty {
        Look::Primary
    } else {
        Look::Plain
    };
    let is_narrow = width < 160.0;
    let name = if is_narrow {
        "Open…"
    } else {
        action.row().label
    };
    action_button(ui, state, action, (name, look, vec2(width, TALL)), commands);
    if role == Role::Crash && is_empty {
        ui.add_space(UNIT);
        let name = if is_narrow {
            "Example"
        } else {
            "Open the example pair"
        };
        let example = (name, Look::Plain, vec2(width, TALL));
        action_button(ui, state, Action::OpenExample, example, commands);
        let has_room = ui.clip_rect().height() > 340.0;
        if !is_narrow && has_room {
            let realistic = ("Open the realistic pair", Look::Plain, vec2(width, TALL));
            action_button(ui, state, Action::OpenRealisticExample, realistic, commands);
        }
    }
    // The other window lists recent files too, and a question must be seen whole.
    let room = ui.clip_rect().bottom() - ui.cursor().top();
    let has_room = ui.available_width() > 240.0 && room > CARD;
    let has_card = role == Role::Stamped && is_empty && has_room && !state.settings.is_mouse_asked;
    let n_recent = if has_card {
        ((room - CARD - 5.0 * UNIT) / ROW).clamp(0.0, N_RECENT as f32) as usize
    } else {
        N_RECENT
    };
    recent_ui(ui, role, (state, n_recent), commands);
    if has_card {
        ui.add_space(2.0 * UNIT);
        mouse_card(ui, state, commands);
    }
}

/// Files opened last that are offered, where there is room.
const N_RECENT: usize = 3;
/// Height of the question about the mouse with the space above it, in a narrow window.
const CARD: f32 = 166.0;
/// From this width on the choice stands beside its name.
const WIDE_CARD: f32 = 300.0;

fn recent_ui(ui: &mut Ui, role: Role, (state, n): (&AppState, usize), commands: &mut Vec<Command>) {
    // A file that was the other part is offered in the other window.
    let settings = &state.settings;
    let is_other = |path: &PathBuf| settings.opened_as.get(path) == Some(&role.other());
    let recent = settings.recent.iter().filter(|path| !is_other(path));
    let recent: Vec<&PathBuf> = recent.take(n).collect();
    if recent.is_empty() {
        return;
    }
    ui.add_space(2.0 * UNIT);
    secondary(ui, "Recent");
    let width = 260.0_f32.min(ui.available_width());
    let now = state.log.clock.unix_at(state.log.now);
    for path in recent {
        let name = settings.recent_name(path);
        let age = state.settings.opened.get(path);
        let age = age.map(|at| age_text(now.saturating_sub(*at)));
        let mut button = egui::Button::new(&name).truncate();
        if let Some(age) = age {
            button = button.right_text(RichText::new(age).small().color(Palette::of(ui).secondary));
        }
        let button = button.frame_when_inactive(false).min_size(vec2(width, ROW));
        // One as wide as the other, whatever their names.
        let link = ui.allocate_ui(vec2(width, ROW), |ui| ui.add(button)).inner;
        if link.on_hover_text(path.display().to_string()).clicked() {
            let (paths, role) = (vec![path.clone()], Some(role));
            commands.push(FileCommand::Open { paths, role }.into());
        }
    }
}

/// The one question of the first start.
fn mouse_card(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut settings: Settings = state.settings.clone();
    let mut is_done = false;
    ui.with_layout(Layout::top_down(Align::Min), |ui| {
        card(ui, |ui| {
            ui.spacing_mut().item_spacing = vec2(UNIT, 6.0);
            let mut choice_ui = |ui: &mut Ui| {
                ui.label("Mouse controls");
                ui.name_inputs("Mouse controls", |ui| mouse_choice(ui, &mut settings));
            };
            // In a narrow window the choice stands below its name.
            if ui.available_width() < WIDE_CARD {
                choice_ui(ui);
            } else {
                ui.horizontal(choice_ui);
            }
            paragraph(ui, settings.mouse.help());
            is_done = ui.button("OK").clicked();
        });
    });
    if is_done || settings.mouse != state.settings.mouse {
        settings.is_mouse_asked = is_done;
        commands.push(Command::Settings(Box::new(settings)));
    }
}

/// A child in the middle of a rectangle.
fn centered(ui: &mut Ui, rect: Rect, size: egui::Vec2, add: impl FnOnce(&mut Ui)) {
    let inner = Rect::from_center_size(rect.center(), size);
    let mut child = ui.new_child(UiBuilder::new().max_rect(inner));
    child.spacing_mut().item_spacing = vec2(UNIT, 4.0);
    add(&mut child);
}

/// While a file hangs over the window: where it would go.
fn drop_hint(ui: &Ui, state: &AppState, crash: Rect, stamped: Rect) {
    let files = drop::hovered(ui);
    let n_files = files.len();
    let target = DropTarget::under_pointer(ui.ctx(), state, &files);
    if n_files == 0 || target == DropTarget::StampedFiles {
        return;
    }
    let palette = Palette::of(ui);
    if let Err(reason) = state.jobs.is_unlocked() {
        let text = format!("{} Stop it first.", reason.0);
        drop::hint(ui, crash.union(stamped), palette.check, text);
        return;
    }
    if target == DropTarget::Project {
        let text = "Drop to open the project".to_owned();
        drop::hint(ui, crash.union(stamped), palette.text, text);
        return;
    }
    let at = ui.ctx().pointer_latest_pos();
    let is_beside = at.is_some_and(|at| !crash.union(stamped).contains(at));
    for (role, rect) in [(Role::Crash, crash), (Role::Stamped, stamped)] {
        let text = match n_files {
            1 if is_beside => "Drop: the content tells which part it is".to_owned(),
            1 if at.is_none_or(|at| rect.contains(at)) => {
                format!("Drop as the {} part", role.word())
            }
            1 => continue,
            2 => "Drop: the content tells which is which".to_owned(),
            _ => "Drop: the first two are opened".to_owned(),
        };
        drop::hint(ui, rect, palette.role(role), text);
    }
}
