//! Short messages in the lower right corner; at most two.

use egui::text::LayoutJob;
use egui::{Align2, Color32, Frame, Margin, RichText, Stroke, TextStyle, Ui, vec2};

use super::pictures::is_screen_taken;
use super::theme::{Palette, ROW, UNIT};
use super::widgets::{icon_button, level_color};
use crate::app::{
    Action, AppState, BottomTab, Command, ExportCommand, Notice, NoticeCommand, NoticeLevel,
    ViewCommand,
};

/// Width of a toast, if there is so much room.
const WIDTH: f32 = 344.0;
/// Left and right of its text: sign, cross, margins.
const BESIDE: f32 = 64.0;
/// Height above the toasts that stays free for headers, view buttons and legend.
const FREE: f32 = 260.0;
/// Height below them, for axes and scale bar.
const LIFT: f32 = 5.0 * UNIT;
/// Lines of a text; the rest stands in the log and in the tooltip.
const MAX_LINES: usize = 6;

/// Draws the toasts over everything but dialogs, within the 3D windows.
pub fn toasts_ui(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    if state.log.notices.toasts().next().is_none() {
        return;
    }
    let room = super::panels::graphics::area(ctx);
    let content = ctx.content_rect();
    let aside = vec2(
        content.right() - room.right(),
        content.bottom() - room.bottom(),
    );
    let width = WIDTH.min(room.width() - 4.0 * UNIT).max(160.0);
    let area = egui::Area::new(egui::Id::unique("toasts"))
        .anchor(Align2::RIGHT_BOTTOM, -aside - vec2(2.0 * UNIT, LIFT))
        .order(egui::Order::Foreground);
    area.show(ctx, |ui| {
        ui.spacing_mut().item_spacing.y = UNIT;
        if is_screen_taken(ctx) {
            ui.set_opacity(0.0);
        }
        let toasts = fitting(ui, state, width, room.height() - FREE - LIFT);
        for notice in toasts.into_iter().rev() {
            toast_ui(ui, notice, state, (width, commands));
        }
    });
}

/// The newest toasts that fit; the latest is always shown, the others wait behind the bell.
fn fitting<'a>(ui: &Ui, state: &'a AppState, width: f32, room: f32) -> Vec<&'a Notice> {
    let mut left = room;
    let mut fitting = Vec::new();
    for notice in state.log.notices.toasts() {
        let lines = ui.painter().layout_job(text(ui, notice, width));
        let buttons = if buttons(notice) { ROW + 6.0 } else { 0.0 };
        left -= lines.size().y + buttons + 3.0 * UNIT;
        if left < 0.0 && !fitting.is_empty() {
            break;
        }
        fitting.push(notice);
    }
    fitting
}

fn buttons(notice: &Notice) -> bool {
    notice.level >= NoticeLevel::Warning || !notice.offers.is_empty()
}

fn text(ui: &Ui, notice: &Notice, width: f32) -> LayoutJob {
    let font = TextStyle::Body.resolve(ui.style());
    let job = |text| LayoutJob::simple(text, font.clone(), Palette::of(ui).text, width - BESIDE);
    let fits = |text: &str| {
        let laid = ui.painter().layout_job(job(text.to_owned()));
        laid.rows.len() <= MAX_LINES
    };
    job(shortened(notice.shown(), fits))
}

/// As much of a text as fits, cut in its middle: a path says most at its end.
fn shortened(text: String, fits: impl Fn(&str) -> bool) -> String {
    if fits(&text) {
        return text;
    }
    let letters: Vec<char> = text.chars().collect();
    let kept = |n: usize| {
        let (head, tail) = (n.div_ceil(2), n / 2);
        let head: String = letters[..head].iter().collect();
        let tail: String = letters[letters.len() - tail..].iter().collect();
        format!("{head}…{tail}")
    };
    let (mut low, mut high) = (0, letters.len());
    while low + 1 < high {
        let middle = low.midpoint(high);
        if fits(&kept(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    kept(low)
}

fn toast_ui(
    ui: &mut Ui,
    notice: &Notice,
    state: &AppState,
    (width, commands): (f32, &mut Vec<Command>),
) {
    let palette = Palette::of(ui);
    let color = level_color(palette, notice.level);
    let frame = Frame::new()
        .fill(palette.card)
        .stroke(Stroke::new(1.0, palette.line))
        .corner_radius(6)
        .shadow(ui.visuals().popup_shadow)
        .inner_margin(Margin {
            left: 14,
            right: 6,
            top: 8,
            bottom: 8,
        });
    let shown = frame.show(ui, |ui| {
        ui.set_width(width - 20.0);
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(notice.level.mark()).color(color).size(15.0));
            ui.vertical(|ui| {
                ui.set_width(width - BESIDE);
                let job = text(ui, notice, width);
                let is_whole = job.text == notice.shown();
                let mut label = ui.add(egui::Label::new(job));
                if !is_whole {
                    label = label.on_hover_text(&notice.text);
                }
                ui.ctx().accesskit_node_builder(label.id, |node| {
                    node.set_live(match notice.level {
                        NoticeLevel::Error => egui::accesskit::Live::Assertive,
                        _ => egui::accesskit::Live::Polite,
                    });
                });
                if buttons(notice) {
                    ui.horizontal(|ui| buttons_ui(ui, notice, state, commands));
                }
            });
            if icon_button(ui, "×", "Close the message", true).clicked() {
                commands.push(NoticeCommand::Dismiss(notice.id).into());
            }
        });
    });
    paint_edge(ui, shown.response.rect, color);
}

fn buttons_ui(ui: &mut Ui, notice: &Notice, state: &AppState, commands: &mut Vec<Command>) {
    for &action in &notice.offers {
        let label = match action {
            Action::Swap => "Swap",
            Action::ReloadChanged => "Reload",
            Action::SaveProjectAs => "Save as…",
            Action::ReopenProject => "Open again",
            other => other.row().label,
        };
        let can = action.enabled(state).is_ok();
        if ui.add_enabled(can, egui::Button::new(label)).clicked() {
            commands.extend(action.command(state));
            commands.push(NoticeCommand::Dismiss(notice.id).into());
        }
    }
    if notice.level >= NoticeLevel::Warning {
        // Beside several offers there is no room for both.
        if notice.offers.len() < 2 && ui.button("Show in log").clicked() {
            commands.push(ViewCommand::SetTab(BottomTab::Log).into());
            commands.push(NoticeCommand::Dismiss(notice.id).into());
        }
        if ui.button("Copy details").clicked() {
            let (text, what) = (notice.text.clone(), "Message".to_owned());
            commands.push(ExportCommand::CopyText { text, what }.into());
        }
    }
}

/// The level as a coloured left edge.
fn paint_edge(ui: &Ui, rect: egui::Rect, color: Color32) {
    let edge = egui::Rect::from_min_max(rect.min, egui::pos2(rect.left() + 4.0, rect.bottom()));
    let radius = egui::CornerRadius {
        nw: 6,
        sw: 6,
        ne: 0,
        se: 0,
    };
    ui.painter().rect_filled(edge, radius, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_keeps_its_ends() {
        let fits = |text: &str| text.chars().count() <= 9;
        let short = |text: &str| shortened(text.to_owned(), fits);
        assert_eq!(short("a/b/c.k"), "a/b/c.k");
        assert_eq!(short("written: /a/b/c/d.k"), "writ…/d.k");
        assert_eq!(short("ä".repeat(40).as_str()), "ääää…ääää");
    }
}
