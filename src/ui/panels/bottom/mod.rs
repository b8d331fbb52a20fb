//! The pane at the bottom: a row of tabs over one of them.

mod convergence;
mod diagnostics;
mod history;
mod log;
mod starts;
mod sweep;
mod thumbnails;
mod timings;

use crate::app::{AppState, BottomTab, Command, ViewCommand};
use crate::ui::theme::{Palette, ROW, UNIT};
use crate::ui::widgets::caption;
use egui::scroll_area::ScrollBarVisibility;
use egui::{Align, Button, Frame, Layout, Margin, RichText, ScrollArea, Stroke, Ui, vec2};

/// Tabs and content.
pub fn bottom_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.take_available_space();
    ui.spacing_mut().item_spacing.y = 0.0;
    tabs_ui(ui, state, commands);
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
            BottomTab::Log | BottomTab::Deviation => log::log_ui(ui, state, commands),
            BottomTab::Timings => timings::timings_ui(ui, state),
            BottomTab::Starts => starts::starts_ui(ui, state, commands),
            BottomTab::Convergence => convergence::convergence_ui(ui, state, commands),
            BottomTab::Sweep => sweep::sweep_ui(ui, state, commands),
            BottomTab::History => history::history_ui(ui, state, commands),
            BottomTab::Diagnostics => diagnostics::diagnostics_ui(ui, state),
        }
    });
}

/// The distances between the parts have no tab yet.
const SHOWN: [BottomTab; 7] = [
    BottomTab::Log,
    BottomTab::Timings,
    BottomTab::Starts,
    BottomTab::Convergence,
    BottomTab::Sweep,
    BottomTab::History,
    BottomTab::Diagnostics,
];

fn tabs_ui(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let bar = Frame::new()
        .fill(palette.bar)
        .inner_margin(Margin::symmetric(8, 2));
    bar.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            // At a large text size the tabs scroll sideways rather than being cut.
            let room = ui.available_width();
            let is_narrow = room < 720.0;
            let tabs = if is_narrow { room } else { room - 200.0 };
            ScrollArea::horizontal()
                .id_salt("tabs")
                .max_width(tabs)
                .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden)
                .show(ui, |ui| {
                    ui.horizontal(|ui| {
                        for tab in SHOWN {
                            tab_ui(ui, tab, state, commands);
                        }
                    });
                });
            if !is_narrow {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    status_ui(ui, state);
                });
            }
        });
    });
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
    let response = ui.add(button);
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

/// What runs, at the right edge of the tabs.
fn status_ui(ui: &mut Ui, state: &AppState) {
    let Some(job) = state.jobs.running() else {
        caption(ui, "ready");
        return;
    };
    let mut text = job.key.label().to_owned();
    if let Some(progress) = job.progress {
        text += &format!(" · {}", progress.phase);
        if let Some(total) = progress.total.filter(|total| *total > 0) {
            text += &format!(" {:.0} %", 100.0 * progress.done as f64 / total as f64);
        }
    }
    let label = caption(ui, text);
    ui.ctx().accesskit_node_builder(label.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
}
