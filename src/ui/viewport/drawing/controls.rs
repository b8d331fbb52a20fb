//! The controls of a drawing of the section: what the colours are, where the plane lies, what is seen of it.

use egui::{Button, RichText, Sense, Ui, Vec2, WidgetInfo};

use super::Drawing;
use super::choices::{Choices, Zoom};
use crate::app::{Action, Command, InspectCommand, SectionView};
use crate::geometry::{Plane, Vector3};
use crate::role::Role;
use crate::text::capital;
use crate::ui::viewport::outlines::Lie;
use crate::ui::widgets::{file_swatch, paint_role_mark, segments};

/// Width of the choice of directions.
const CHOICE: f32 = 150.0;

impl Drawing<'_> {
    /// Which colour is which part.
    pub(super) fn names(&self, ui: &mut Ui) {
        for role in Role::ALL {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (rect, _) = ui.allocate_exact_size(Vec2::splat(11.0), Sense::hover());
            paint_role_mark(ui.painter(), rect, role, self.look.role(role));
            ui.label(RichText::new(role.word()).size(12.0));
            ui.add_space(6.0);
        }
        for file in self.state.shown_further() {
            let (rect, swatch) = ui.allocate_exact_size(Vec2::splat(11.0), Sense::hover());
            file_swatch(ui.painter(), rect, file.number);
            let name = file.loaded.file_name();
            swatch.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &name));
            swatch.on_hover_text(name);
        }
        if self.unused.iter().any(|(_, lines)| !lines.is_empty()) {
            ui.label(RichText::new("— unused").size(12.0).color(self.look.weak));
        }
        ui.spacing_mut().item_spacing.x = 6.0;
    }

    /// Across which direction the plane lies, as one choice.
    pub(super) fn directions(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let actions = [
            ("X", Action::SectionX, Vector3::x()),
            ("Y", Action::SectionY, Vector3::y()),
            ("Z", Action::SectionZ, Vector3::z()),
        ];
        let lies = |axis: &Vector3| self.plane.normal.dot(axis).abs() > 1.0 - 1e-9;
        let is_other = !actions.iter().any(|(_, _, axis)| lies(axis));
        let mut labels = actions
            .map(|(sign, _, axis)| (sign, lies(&axis), true))
            .to_vec();
        labels.push(("View", is_other, true));
        if let Some(index) = segments(ui, &labels, CHOICE) {
            let action = actions.get(index).map_or(Action::SectionView, |row| row.1);
            commands.extend(action.command(self.state));
        }
    }

    /// Flip and cut.
    pub(super) fn plane_buttons(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let flip = ui
            .button("Flip")
            .on_hover_text("Look at the plane from behind");
        if flip.accessible_name("Flip the section plane").clicked() {
            let section = SectionView {
                plane: Some(Plane::new(self.plane.point, &-self.plane.normal)),
                ..self.state.inspect.section
            };
            commands.push(InspectCommand::SetSection(section).into());
        }
        let is_clipped = self.state.inspect.section.is_clipped;
        self.switch(ui, ("Cut", Action::ToggleSectionClip, is_clipped), commands);
    }

    /// A button with a sign that does an action.
    pub(super) fn switch(
        &self,
        ui: &mut Ui,
        (sign, action, is_on): (&str, Action, bool),
        commands: &mut Vec<Command>,
    ) {
        let row = action.row();
        let response = ui.add(Button::new(sign).selected(is_on));
        let name = format!("{} (section)", row.label);
        let response = response.on_hover_text(row.tooltip).accessible_name(name);
        if response.clicked() {
            commands.extend(action.command(self.state));
        }
    }

    /// How the outlines are shown.
    pub(super) fn zoom_buttons(&self, ui: &mut Ui, choices: &mut Choices) {
        if matches!(choices.lie, Some(Lie::Apart(_))) {
            for role in Role::ALL {
                let button = ui.button(capital(role.word()));
                let name = format!("Show the outline of the {} part", role.word());
                if button.on_hover_text(&name).accessible_name(&name).clicked() {
                    choices.zoom = Some(Zoom::Part(role));
                }
            }
            return Self::all_button(ui, choices);
        }
        let button = Button::new("×10 gap").selected(choices.is_exaggerated);
        let has_gaps = self.gaps.is_some() && choices.lie == Some(Lie::Together);
        let response = ui.add_enabled(has_gaps, button);
        let response = response.on_hover_text(
            "Draw the stamped outline ten times as far from the crash outline as it is",
        );
        if response.clicked() {
            choices.is_exaggerated ^= true;
        }
        let has_worst = self.gaps.is_some_and(|gaps| gaps.worst().is_some());
        let worst = ui.add_enabled(has_worst, Button::new("Worst gap"));
        if worst.on_hover_text("Zoom to the widest gap").clicked() {
            choices.zoom = Some(Zoom::WorstGap);
        }
        Self::all_button(ui, choices);
    }

    fn all_button(ui: &mut Ui, choices: &mut Choices) {
        if ui
            .button("All")
            .on_hover_text("Show the whole outlines")
            .clicked()
        {
            choices.zoom = Some(Zoom::All);
        }
    }
}
