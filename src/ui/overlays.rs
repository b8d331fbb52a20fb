//! What lies over the window: help sheet, command search, preferences, messages, about.

use egui::style::ScrollStyle;
use egui::{Align, Layout, Modal, RichText, ScrollArea, Ui, vec2};

use super::focus;
use super::help::help_ui;
use super::palette::{self, palette_ui};
use super::picture_options::picture_ui;
use super::project_dialogs::{missing_ui, unsaved_ui};
use super::theme::{Palette, UNIT};
use super::typed::{Takes, told_field};
use super::widgets::{caption, chip, form_row, level_color, paragraph, secondary};
use crate::app::{
    AppState, Command, Dialog, ExportCommand, MouseScheme, Notice, NoticeCommand, NoticeLevel,
    Settings, Theme, ViewCommand, clock_text,
};
use crate::colormap::ColorMap;
use crate::text::{fixed, trimmed};

/// What a dialog leaves of the window, with its own title and foot.
pub(super) const MARGIN: egui::Vec2 = vec2(96.0, 160.0);

/// Draws the open dialog, if any. `is_on_processor`: every pixel costs the processor time.
pub fn overlays_ui(
    ctx: &egui::Context,
    state: &AppState,
    is_on_processor: bool,
    commands: &mut Vec<Command>,
) {
    if state.view.dialog != Some(Dialog::Palette) {
        palette::forget(ctx);
    }
    let Some(dialog) = state.view.dialog else {
        return;
    };
    let id = egui::Id::unique(("dialog", dialog as u8));
    let mut modal = modal(ctx, id, is_on_processor);
    let window = ctx.content_rect().size();
    if dialog == Dialog::Palette {
        // Its field stays where it is, however many lines are found.
        let top = egui::vec2(0.0, palette::top(window.y));
        modal.area = Modal::default_area(id).anchor(egui::Align2::CENTER_TOP, top);
    }
    let response = modal.show(ctx, |ui| {
        ui.spacing_mut().item_spacing.y = UNIT;
        let room = window - MARGIN;
        match dialog {
            Dialog::Help => help_ui(ui, room),
            Dialog::Palette => palette_ui(ui, state, room, commands),
            Dialog::Preferences => preferences_ui(ui, state, commands),
            Dialog::Messages => messages_ui(ui, state, room, commands),
            Dialog::Picture => {
                ui.set_width(440.0);
                title(ui, "Image", Some(commands));
                picture_ui(ui, state, commands);
            }
            Dialog::About => about_ui(ui),
            Dialog::Unsaved => unsaved_ui(ui, state, commands),
            Dialog::MissingFiles => missing_ui(ui, state, commands),
        }
    });
    let by_pointer = response.backdrop_response.clicked();
    if by_pointer {
        commands.push(ViewCommand::SetDialog(None).into());
    }
}

/// A dialog over the window. `is_on_processor`: every pixel costs the processor time.
pub(super) fn modal(ctx: &egui::Context, id: egui::Id, is_on_processor: bool) -> Modal {
    let frame = egui::Frame::popup(&ctx.global_style())
        .inner_margin(24)
        .corner_radius(8);
    let modal = Modal::new(id).frame(frame);
    if is_on_processor {
        // Darkening the whole window would take several times as long as the rest of the frame.
        modal.backdrop_color(egui::Color32::TRANSPARENT)
    } else {
        modal
    }
}

/// The head of a sheet with the way out of it.
pub(super) fn title(ui: &mut Ui, text: &str, commands: Option<&mut Vec<Command>>) {
    ui.horizontal(|ui| {
        ui.heading(text);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            match commands {
                Some(commands) => {
                    if ui.button("Close").clicked() {
                        commands.push(ViewCommand::SetDialog(None).into());
                    }
                }
                None => {
                    caption(ui, "Esc to close");
                }
            };
        });
    });
    ui.separator();
}

/// The title of a group in a sheet.
pub(super) fn group_title(ui: &mut Ui, text: &str) {
    ui.add_space(UNIT);
    let color = Palette::of(ui).accent_text;
    ui.label(RichText::new(text).color(color));
}

fn preferences_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.set_width(560.0_f32.min(ui.ctx().content_rect().width() - 96.0));
    title(ui, "Preferences", Some(commands));
    let mut settings: Settings = state.settings.clone();
    let room = ui.ctx().content_rect().height() - MARGIN.y;
    // A bar that floats is not seen before the pointer is there, and the sheet would look complete.
    ui.spacing_mut().scroll = ScrollStyle::solid();
    let sheet = ScrollArea::vertical()
        .max_height(room)
        .min_scrolled_height(room);
    sheet.show(ui, |ui| {
        // The frames of the widest fields lie beside the edge, not under it.
        ui.set_max_width(ui.available_width() - 4.0);
        group_title(ui, "Display");
        display_ui(ui, &mut settings);
        map_row(ui, "Deviation colours", &mut settings.signed_map);
        map_row(ui, "Other colours", &mut settings.plain_map);
        group_title(ui, "Numbers");
        decimals_ui(ui, &mut settings);
        group_title(ui, "Mouse");
        form_row(ui, "Mouse controls", LABEL, |ui| {
            mouse_choice(ui, &mut settings);
        });
        ui.horizontal(|ui| {
            ui.add_space(LABEL + UNIT);
            paragraph(ui, settings.mouse.help());
        });
        group_title(ui, "Messages");
        messages_choice(ui, &mut settings);
        group_title(ui, "Files");
        form_row(ui, "Autosave", LABEL, |ui| {
            ui.checkbox(&mut settings.keeps_work, "Keep the work for recovery")
                .on_hover_text("After each step, in the folder of the program's data");
        });
        form_row(ui, "Read limit", LABEL, |ui| {
            let takes = Takes::number("Read limit", " GiB", Settings::READ_LIMITS);
            let before = settings.read_limit;
            let field = takes.field(&mut settings.read_limit).speed(0.1);
            let field = told_field(ui, "Read limit", before, field, |text| takes.read(text));
            field.on_hover_text(
                "Largest file that is read, unpacked and with all its included files. Reload a file \
                 after raising it.",
            );
        });
    });
    if settings != state.settings {
        commands.push(Command::Settings(Box::new(settings)));
    }
}

/// Width of the labels of the preferences.
const LABEL: f32 = 120.0;

/// Colours and sizes of the window.
fn display_ui(ui: &mut Ui, settings: &mut Settings) {
    form_row(ui, "Theme", LABEL, |ui| {
        for theme in Theme::ALL {
            if chip(ui, theme.label(), settings.theme == theme).clicked() {
                settings.theme = theme;
            }
        }
    });
    form_row(ui, "UI scale", LABEL, |ui| {
        ui.spacing_mut().button_padding.x = 6.0;
        let now = settings.ui_scale;
        let mut scales = vec![0.75, 1.0, 1.25, 1.5, 2.0, 2.5];
        if !scales.contains(&now) {
            // One that the keys chose.
            scales.push(now);
            scales.sort_by(f32::total_cmp);
        }
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            for scale in scales {
                let label = trimmed(f64::from(100.0 * scale), 1) + " %";
                if chip(ui, &label, scale == now).clicked() {
                    settings.ui_scale = scale;
                }
            }
        });
    });
    form_row(ui, "Motion", LABEL, |ui| {
        ui.checkbox(&mut settings.reduce_motion, "Reduce motion");
    });
    form_row(ui, "Log", LABEL, |ui| {
        ui.checkbox(&mut settings.is_log_wide, "Full-width log");
    });
}

/// The colours of one kind of values.
fn map_row(ui: &mut Ui, name: &str, map: &mut ColorMap) {
    form_row(ui, name, LABEL, |ui| {
        let menu = egui::ComboBox::from_id_salt(name)
            .selected_text(map.label())
            .width(200.0);
        let shown = focus::menu(ui, menu, |ui| {
            for choice in ColorMap::ALL {
                let holds = *map == choice;
                let row = ui.selectable_value(map, choice, choice.label());
                focus::chosen(ui, holds, row);
            }
        });
        shown
            .response
            .on_hover_text("Holds at once and for new work; the legend can choose another map")
            .accessible_name(name);
    });
}

/// How lengths are written.
fn decimals_ui(ui: &mut Ui, settings: &mut Settings) {
    form_row(ui, "Lengths", LABEL, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            let automatic = chip(ui, "Automatic", settings.decimals.is_none())
                .on_hover_text("Three significant digits");
            if automatic.clicked() {
                settings.decimals = None;
            }
            for n in Settings::DECIMALS {
                let example = fixed(0.0, usize::from(n)) + " mm";
                let one = chip(ui, &example, settings.decimals == Some(n)).on_hover_text(
                    "So many decimals of a millimetre; other units get as many as show no less. Exports and \
                     typed numbers keep all digits.",
                );
                if one.clicked() {
                    settings.decimals = Some(n);
                }
            }
        });
    });
}

/// Which messages come up over the windows.
fn messages_choice(ui: &mut Ui, settings: &mut Settings) {
    form_row(ui, "Notifications", LABEL, |ui| {
        ui.horizontal_wrapped(|ui| {
            for level in NoticeLevel::TOLD {
                let mut is_shown = !settings.muted.contains(&level);
                if ui.checkbox(&mut is_shown, level.label()).changed() {
                    if is_shown {
                        settings.muted.remove(&level);
                    } else {
                        settings.muted.insert(level);
                    }
                }
            }
        });
    });
}

/// A menu of mouse habits.
pub fn mouse_choice(ui: &mut Ui, settings: &mut Settings) {
    let menu = egui::ComboBox::from_id_salt("mouse scheme")
        .selected_text(settings.mouse.label())
        .width(200.0_f32.min(ui.available_width()))
        .truncate();
    focus::menu(ui, menu, |ui| {
        for scheme in MouseScheme::ALL {
            let holds = settings.mouse == scheme;
            let choice = ui.selectable_value(&mut settings.mouse, scheme, scheme.label());
            focus::chosen(ui, holds, choice).on_hover_text(scheme.help());
        }
    });
}

/// When, what, and a way to take it along.
fn message_ui(ui: &mut Ui, state: &AppState, notice: &Notice, commands: &mut Vec<Command>) {
    ui.horizontal_top(|ui| {
        let color = level_color(Palette::of(ui), notice.level);
        ui.label(RichText::new(notice.level.mark()).color(color));
        caption(ui, clock_text(state.log.clock.day_time_at(notice.at)));
        let room = ui.available_width() - 64.0;
        ui.vertical(|ui| {
            ui.set_width(room);
            ui.add(egui::Label::new(notice.shown()).wrap());
        });
        if ui.small_button("Copy").clicked() {
            let (text, what) = (notice.text.clone(), "Message".to_owned());
            commands.push(ExportCommand::CopyText { text, what }.into());
        }
    });
}

fn messages_ui(ui: &mut Ui, state: &AppState, room: egui::Vec2, commands: &mut Vec<Command>) {
    ui.set_width(520.0);
    title(ui, "Messages", Some(commands));
    if state.log.notices.n_unread() > 0 {
        commands.push(NoticeCommand::MarkRead.into());
    }
    ScrollArea::vertical()
        .max_height(room.y.min(480.0))
        .auto_shrink([false, true])
        .show(ui, |ui| {
            let mut is_empty = true;
            for notice in state.log.notices.kept() {
                is_empty = false;
                message_ui(ui, state, notice, commands);
            }
            if is_empty {
                secondary(ui, "No messages");
            }
        });
}

fn about_ui(ui: &mut Ui) {
    ui.set_width(440.0);
    title(ui, "shapematch", None);
    ui.label(format!("Version {}", env!("CARGO_PKG_VERSION")));
    secondary(ui, format!("Build {}", crate::report::build_id()));
    paragraph(ui, env!("CARGO_PKG_DESCRIPTION"));
    paragraph(ui, "MIT or Apache-2.0, as you like");
}
