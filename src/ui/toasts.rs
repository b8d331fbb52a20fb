//! Short messages in the lower right corner; at most three.

use super::theme::{Palette, UNIT};
use super::widgets::{icon_button, level_color};
use crate::app::{
    AppState, BottomTab, Command, ExportCommand, NoticeCommand, NoticeLevel, ViewCommand,
};
use egui::{Align2, Frame, Margin, RichText, Stroke, vec2};

/// Width of a toast.
const WIDTH: f32 = 360.0;

/// Draws the toasts over everything but dialogs, clear of the bottom pane.
pub fn toasts_ui(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let bottom = super::panels::graphics::bottom_edge(ctx);
    let lift = (ctx.content_rect().bottom() - bottom).max(0.0);
    let area = egui::Area::new(egui::Id::unique("toasts"))
        .anchor(Align2::RIGHT_BOTTOM, vec2(-2.0 * UNIT, -lift - 6.0 * UNIT))
        .order(egui::Order::Foreground);
    if state.notices.toasts().next().is_none() {
        return;
    }
    area.show(ctx, |ui| {
        ui.spacing_mut().item_spacing.y = UNIT;
        let toasts: Vec<_> = state.notices.toasts().collect();
        for notice in toasts.into_iter().rev() {
            toast_ui(ui, notice, commands);
        }
    });
}

fn toast_ui(ui: &mut egui::Ui, notice: &crate::app::Notice, commands: &mut Vec<Command>) {
    let palette = Palette::of(ui);
    let color = level_color(palette, notice.level);
    let frame = Frame::new()
        .fill(palette.card)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(6)
        .shadow(ui.visuals().popup_shadow)
        .inner_margin(Margin {
            left: 16,
            right: 8,
            top: 8,
            bottom: 8,
        });
    let shown = frame.show(ui, |ui| {
        ui.set_width(WIDTH);
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(notice.level.mark()).color(color).size(15.0));
            ui.vertical(|ui| {
                ui.set_width(WIDTH - 72.0);
                let text = if notice.count > 1 {
                    format!("{} (×{})", notice.text, notice.count)
                } else {
                    notice.text.clone()
                };
                ui.add(egui::Label::new(text).wrap());
                if notice.level >= NoticeLevel::Warning {
                    ui.horizontal(|ui| {
                        if ui.button("Show in log").clicked() {
                            commands.push(ViewCommand::SetTab(BottomTab::Log).into());
                            commands.push(NoticeCommand::Dismiss(notice.id).into());
                        }
                        if ui.button("Copy details").clicked() {
                            let (text, what) = (notice.text.clone(), "Message".to_owned());
                            commands.push(ExportCommand::CopyText { text, what }.into());
                        }
                    });
                }
            });
            if icon_button(ui, "×", "Close the message", true).clicked() {
                commands.push(NoticeCommand::Dismiss(notice.id).into());
            }
        });
    });
    let rect = shown.response.rect;
    let edge = egui::Rect::from_min_max(rect.min, egui::pos2(rect.left() + 4.0, rect.bottom()));
    let radius = egui::CornerRadius {
        nw: 6,
        sw: 6,
        ne: 0,
        se: 0,
    };
    ui.painter().rect_filled(edge, radius, color);
}
