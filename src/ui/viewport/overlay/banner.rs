//! A line at the foot of the left window when what is shown is not simply the part at its pose: a preview
//! that was pinned, or one of several poses that fit.

use egui::{Button, CornerRadius, FontId, Rect, RichText, Stroke, Ui, vec2};

use super::Overlay;
use crate::app::{Action, AppState, Command, MatchResult, ViewCommand};
use crate::jobs::Role;
use crate::registration::MatchOutcome;
use crate::ui::widgets::length;

/// Above the scale bar and the readout.
const BOTTOM: f32 = 62.0;
const HEIGHT: f32 = 32.0;
/// Residuals below this are rounding.
const NOTHING: f64 = 1e-5;

/// What the banner says and the button on it.
struct Banner {
    text: String,
    label: String,
    commands: Vec<Command>,
}

/// The banner, if there is something to say.
pub(super) fn show(ui: &mut Ui, over: &Overlay<'_>, commands: &mut Vec<Command>) {
    if over.role() != Role::Crash {
        return;
    }
    let Some(banner) = preview(over.state).or_else(|| poses(over.state)) else {
        return;
    };
    let font = FontId::proportional(12.5);
    let painter = over.painter(ui);
    let text = painter.layout_no_wrap(banner.text, font.clone(), over.look.text);
    let label = painter.layout_no_wrap(banner.label.clone(), font, over.look.text);
    let button_width = label.size().x + 20.0;
    let width = text.size().x + button_width + 34.0;
    let center = over.rect.center_bottom() - vec2(0.0, BOTTOM + HEIGHT / 2.0);
    let ground = Rect::from_center_size(center, vec2(width, HEIGHT));
    if width > over.rect.width() - 8.0 {
        return;
    }
    painter.rect_filled(ground, CornerRadius::same(6), over.look.plate);
    let edge = Stroke::new(1.0, over.look.role(Role::Stamped));
    painter.rect_stroke(
        ground,
        CornerRadius::same(6),
        edge,
        egui::StrokeKind::Inside,
    );
    let text_at = ground.left_center() + vec2(12.0, -text.size().y / 2.0);
    let name = text.text().to_owned();
    let response = ui.interact(
        Rect::from_min_size(text_at, text.size()),
        ui.scope_id().with("banner"),
        egui::Sense::hover(),
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    painter.galley(text_at, text, over.look.text);
    let size = vec2(button_width, HEIGHT - 8.0);
    let corner = ground.right_center() + vec2(-size.x - 5.0, -size.y / 2.0);
    let area = Rect::from_min_size(corner, size);
    let button = Button::new(RichText::new(banner.label).size(12.5));
    if ui.put(area, button).clicked() {
        commands.extend(banner.commands);
    }
}

/// A pose that is shown until it is let go.
fn preview(state: &AppState) -> Option<Banner> {
    let pinned = state.view.pinned_preview?;
    Some(Banner {
        text: format!("Preview of start {}: nothing was moved", pinned.start() + 1),
        label: "Show the real pose".to_owned(),
        commands: vec![ViewCommand::PinPreview(None).into()],
    })
}

/// One of several poses that fit nearly as well.
fn poses(state: &AppState) -> Option<Banner> {
    let result = state.document.current_result()?;
    let n_poses = state.n_equal_poses();
    if n_poses < 2 || state.is_preview() {
        return None;
    }
    let number = result.alternative.map_or(1, |index| index + 2);
    let mut text = format!("Pose {number} of {n_poses}");
    let told = residuals(result).filter(|both| both.iter().any(|rmse| *rmse > NOTHING));
    if let Some([own, best]) = told {
        text += &format!(
            " · RMS {} against {}{}",
            length(own),
            length(best),
            state.unit_suffix()
        );
    }
    let key = Action::FlipAlternative.info().shortcut;
    let key = key.map_or_else(String::new, |key| format!("   {key}"));
    Some(Banner {
        text,
        label: format!("Flip{key}"),
        commands: Action::FlipAlternative.to_commands(state),
    })
}

/// Residual of the shown pose and of the one it is compared with, both before the last refinement, so
/// that they compare.
fn residuals(result: &MatchResult) -> Option<[f64; 2]> {
    let outcome = &result.run.outcome;
    let best = compared(outcome, outcome.winner)?;
    let shown = result.alternative.unwrap_or(0);
    let other = compared(outcome, outcome.alternatives.get(shown)?.start)?;
    Some(match result.alternative {
        Some(_) => [other, best],
        None => [best, other],
    })
}

/// Residual of a start at the end of the stage that all contenders went through.
fn compared(outcome: &MatchOutcome, start: usize) -> Option<f64> {
    let steps = &outcome.starts.get(start)?.iterations;
    let last = steps.iter().rev().find(|step| step.stage != "finish");
    last.map(|step| step.rmse)
}
