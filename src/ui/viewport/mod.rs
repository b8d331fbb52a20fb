//! The two 3D windows.

use crate::app::{AppState, Command};
use crate::jobs::Role;

/// What the 3D windows keep between frames.
pub struct Viewports;

impl Viewports {
    /// Without a render state nothing but the ground is drawn.
    pub fn new(_render_state: Option<&eframe::egui_wgpu::RenderState>) -> Self {
        Self
    }

    /// Draws one window into the space that is left.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        role: Role,
        _state: &AppState,
        _commands: &mut Vec<Command>,
    ) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), egui::Sense::drag());
        let palette = crate::ui::theme::Palette::of(ui);
        ui.painter().rect_filled(rect, 0.0, palette.ground);
        let name = format!("3D window of the {} part", role.word());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    }
}
