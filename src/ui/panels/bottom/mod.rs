//! The pane at the bottom: a row of tabs over one of them.

pub mod charts;
mod convergence;
mod deviation;
mod diagnostics;
mod history;
mod log;
mod mapping;
mod percentiles;
mod probe;
mod starts;
mod sweep;
mod thumbnails;
mod timings;

use egui::{Align, Button, Frame, InnerResponse, Layout, Margin, RichText, Stroke, Ui, vec2};

use super::on_bar;
use crate::app::{Action, AppState, BottomTab, Command, ViewCommand};
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::viewport::Viewports;
use crate::ui::widgets::{Look, action_button, caption};

/// Tabs and content.
pub fn bottom_ui(
    ui: &mut Ui,
    state: &AppState,
    viewports: &Viewports,
    commands: &mut Vec<Command>,
) {
    ui.take_available_space();
    ui.spacing_mut().item_spacing.y = 0.0;
    on_bar(ui, viewports, |ui| tabs_ui(ui, state, commands));
    let margin = Margin {
        left: 16,
        right: 8,
        top: 4,
        bottom: 4,
    };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(UNIT, 4.0);
        ui.take_available_space();
        match state.view.tab {
            BottomTab::Log => log::log_ui(ui, state, commands),
            BottomTab::Deviation => deviation::deviation_ui(ui, state, commands),
            BottomTab::Section => viewports.section_ui(ui, state, commands),
            BottomTab::Mapping => mapping::mapping_ui(ui, state, commands),
            BottomTab::Timings => timings::timings_ui(ui, state),
            BottomTab::Starts => starts::starts_ui(ui, state, commands),
            BottomTab::Convergence => convergence::convergence_ui(ui, state, commands),
            BottomTab::Sweep => sweep::sweep_ui(ui, state, commands),
            BottomTab::History => history::history_ui(ui, state, commands),
            BottomTab::Diagnostics => diagnostics::diagnostics_ui(ui, state, commands),
        }
    });
}

/// In a pane narrower than this the tabs become a menu, so that the status keeps its place.
const NARROW: f32 = 440.0;
/// Room for the status at the right of the tabs.
const STATUS: f32 = 216.0;

fn tabs_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) -> InnerResponse<()> {
    let bar = Frame::new().inner_margin(Margin::symmetric(8, 2));
    bar.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            let is_shown = |tab: &BottomTab| *tab == state.view.tab || state.has_content(*tab);
            let tabs: Vec<BottomTab> = BottomTab::ALL.into_iter().filter(is_shown).collect();
            let room = ui.available_width();
            if room < NARROW {
                tab_menu(ui, &tabs, state, commands);
            } else {
                tab_row(ui, &tabs, state, (room - STATUS, commands));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                status_ui(ui, state, commands);
            });
        });
    })
}

/// As many tabs as fit, the one that is shown among them; the rest stand in a menu at their end.
fn tab_row(
    ui: &mut Ui,
    tabs: &[BottomTab],
    state: &AppState,
    (room, commands): (f32, &mut Vec<Command>),
) {
    let (shown, more) = fitting(ui, tabs, state.view.tab, room);
    for tab in shown {
        tab_ui(ui, tab, state, commands);
    }
    if !more.is_empty() {
        let (button, _) = egui::containers::menu::MenuButton::new("More  ▾")
            .ui(ui, |ui| tab_items(ui, &more, state, commands));
        button.on_hover_text("Tabs that have no room here");
    }
}

/// Room for the menu of the tabs that do not fit.
const MORE: f32 = 72.0;

/// The tabs that fit, and the others.
fn fitting(
    ui: &Ui,
    tabs: &[BottomTab],
    now: BottomTab,
    room: f32,
) -> (Vec<BottomTab>, Vec<BottomTab>) {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let around = 2.0 * ui.spacing().button_padding.x + ui.spacing().item_spacing.x;
    let width = |tab: &BottomTab| {
        let color = egui::Color32::PLACEHOLDER;
        let text = tab.label().to_owned();
        let text = ui.painter().layout_no_wrap(text, font.clone(), color);
        text.size().x + around
    };
    let widths: Vec<f32> = tabs.iter().map(width).collect();
    if widths.iter().sum::<f32>() <= room {
        return (tabs.to_vec(), Vec::new());
    }
    let at = tabs.iter().position(|tab| *tab == now);
    let mut left = room - MORE - at.map_or(0.0, |at| widths[at]);
    let (mut shown, mut more) = (Vec::new(), Vec::new());
    for (tab, width) in tabs.iter().zip(widths) {
        if *tab != now {
            left -= width;
        }
        if *tab == now || left >= 0.0 {
            shown.push(*tab);
        } else {
            more.push(*tab);
        }
    }
    (shown, more)
}

/// The tabs as a menu whose button names the one that is shown.
fn tab_menu(ui: &mut Ui, tabs: &[BottomTab], state: &AppState, commands: &mut Vec<Command>) {
    let label = format!("{}  ▾", state.view.tab.label());
    let (button, _) = egui::containers::menu::MenuButton::new(label).ui(ui, |ui| {
        tab_items(ui, tabs, state, commands);
    });
    let name = format!("Tab {}", state.view.tab.label());
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
}

fn tab_items(ui: &mut Ui, tabs: &[BottomTab], state: &AppState, commands: &mut Vec<Command>) {
    for tab in tabs {
        let is_on = *tab == state.view.tab;
        if ui.selectable_label(is_on, tab.label()).clicked() {
            commands.push(ViewCommand::SetTab(*tab).into());
            ui.close();
        }
    }
}

fn tab_ui(ui: &mut Ui, tab: BottomTab, state: &AppState, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let is_on = state.view.tab == tab;
    let color = if is_on {
        palette.text
    } else {
        palette.secondary
    };
    let text = RichText::new(tab.label()).color(color);
    let button = Button::new(text)
        .frame_when_inactive(false)
        .min_size(vec2(0.0, ROW));
    let response = ui.scope(|ui| {
        // A frame would look like the keyboard's.
        ui.visuals_mut().widgets.hovered.bg_stroke = Stroke::NONE;
        ui.add(button)
    });
    let response = response.inner;
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Tab, true, is_on, tab.label()));
    if is_on {
        let rect = response.rect;
        let line = Stroke::new(2.0, palette.accent_text);
        let inner = rect.left() + 8.0..=rect.right() - 8.0;
        ui.painter().hline(inner, rect.bottom() + 1.0, line);
    }
    if response.clicked() {
        commands.push(ViewCommand::SetTab(tab).into());
    }
}

/// What runs, at the right edge of the tabs, and the way out of it wherever the left column stands.
fn status_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.jobs.locking_job().is_some() {
        let look = ("Cancel", Look::Plain, vec2(0.0, ROW));
        let button = action_button(ui, state, Action::CancelRun, look, commands);
        button.accessible_name(Action::CancelRun.row().label);
        ui.add_space(6.0);
    }
    let Some(job) = state.jobs.running() else {
        caption(ui, "ready");
        return;
    };
    let text = if job.is_cancelling {
        format!("{} · cancelling…", job.key.label())
    } else if job.file.is_some() {
        job.words()
    } else {
        format!("{} · {}", job.key.label(), job.words().to_lowercase())
    };
    let text = RichText::new(text).small().color(Palette::of(ui).secondary);
    let label = ui.add(egui::Label::new(text).truncate());
    ui.ctx().accesskit_node_builder(label.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
}
