//! What stands in a window until its picture is there.

use egui::{Align2, FontId, Ui, vec2};

use super::Overlay;
use crate::geometry::Similarity;
use crate::role::Role;
use crate::ui::viewport::shape::part_points;

/// Three dots that take turns, slow enough to leave the processor to the work.
pub(super) fn preparing(ui: &Ui, over: &Overlay<'_>) {
    let view = over.frame.view;
    let role = over.role();
    if let Some(part) = over.frame.state.document.part(role) {
        let pose = match role {
            Role::Crash => Similarity::identity(),
            Role::Stamped => view.pose,
        };
        let place = (over.frame.rect(), &view.camera);
        part_points(ui, place, (role, &pose), part);
    }
    let painter = over.painter(ui);
    let center = over.frame.rect().center();
    let text = "Building the 3D view…";
    let font = FontId::proportional(14.0);
    painter.text(
        center,
        Align2::CENTER_CENTER,
        text,
        font,
        over.frame.look.weak,
    );
    let now = ui.input(|i| i.time);
    let color = over.frame.look.role(over.role());
    for dot in 0..3_u8 {
        let phase = (now * 1.4 - f64::from(dot) * 0.18).rem_euclid(1.0) as f32;
        let strength = 0.25 + 0.75 * (1.0 - phase).powi(2);
        let at = center + vec2(14.0 * (f32::from(dot) - 1.0), 24.0);
        painter.circle_filled(at, 3.5, color.gamma_multiply(strength));
    }
    let pause = std::time::Duration::from_millis(66);
    ui.ctx().request_repaint_after(pause);
}
