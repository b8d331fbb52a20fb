//! What lies under the pointer: hovering, selecting, the menu of the right button.

use egui::{Response, Ui};

use super::cast::Stage;
use super::navigation::{pixel_of, screen_of};
use super::stage::{Hit, Picture};
use crate::app::{AppState, ColorBy, Command, InspectCommand, PartCommand, PartRef, ViewCommand};

/// What a window remembers about the pointer.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Pointing {
    /// The part that was told to be under the pointer.
    hovered: Option<PartRef>,
    /// What lay under the pointer when the menu was opened.
    menu: Option<Hit>,
}

/// A window as the pointer meets it.
pub(super) struct Target<'a> {
    pub ui: &'a Ui,
    pub response: &'a Response,
    pub state: &'a AppState,
    pub stage: &'a Stage,
    pub picture: &'a Picture,
    /// The camera or a tool has the pointer.
    pub is_busy: bool,
}

impl Pointing {
    /// What lies under the pointer, after telling the state about it.
    pub fn update(&mut self, target: &Target<'_>, commands: &mut Vec<Command>) -> Option<Hit> {
        let response = target.response;
        let hit = target.hit();
        let part = hit.as_ref().and_then(|hit| hit.part);
        if !target.is_busy && self.hovered != part {
            self.hovered = part;
            commands.push(PartCommand::Hover(part).into());
        }
        if target.state.view.move_tool.is_none() {
            if target.state.view.pair_tool.is_none() {
                self.click(target, hit.as_ref(), commands);
            }
            if response.secondary_clicked() {
                self.menu.clone_from(&hit);
            }
            response.context_menu(|ui| self.menu(ui, target, commands));
        }
        self.pick_pivot(target, hit.as_ref(), commands);
        hit
    }

    fn click(&self, target: &Target<'_>, hit: Option<&Hit>, commands: &mut Vec<Command>) {
        let part = hit.and_then(|hit| hit.part);
        let is_toggling = target.ui.input(|i| i.modifiers.command);
        if target.response.double_clicked() {
            commands.push(PartCommand::Select(part).into());
            commands.push(ViewCommand::Focus(target.state.camera_of(target.stage.window)).into());
        } else if target.response.clicked()
            && let Some(hit) = hit.filter(|hit| target.pins(hit))
        {
            commands.push(InspectCommand::Pin(hit.role, hit.in_part).into());
        } else if target.response.clicked() {
            // Beside the parts, Ctrl keeps what was selected.
            match part {
                Some(part) if is_toggling => {
                    commands.push(PartCommand::ToggleSelected(part).into());
                }
                None if is_toggling => {}
                _ => commands.push(PartCommand::Select(part).into()),
            }
        }
    }

    /// P takes the point under the pointer; with a pivot picked, the action of that key forgets it.
    fn pick_pivot(&self, target: &Target<'_>, hit: Option<&Hit>, commands: &mut Vec<Command>) {
        let role = target.state.camera_of(target.stage.window);
        if target.state.view.pivot.get(role).is_some() {
            return;
        }
        let is_typing = target.ui.ctx().egui_wants_keyboard_input() && !target.response.has_focus();
        let pressed = |i: &egui::InputState| i.key_pressed(egui::Key::P) && i.modifiers.is_none();
        if let Some(hit) = hit.filter(|_| !is_typing && target.ui.input(pressed)) {
            commands.push(ViewCommand::SetPivot(role, Some(hit.point)).into());
        }
    }

    fn menu(&self, ui: &mut Ui, target: &Target<'_>, commands: &mut Vec<Command>) {
        let role = target.state.camera_of(target.stage.window);
        if let Some(part) = self.menu.as_ref().and_then(|hit| hit.part) {
            ui.weak(format!("Part {}", part.id));
            entry(ui, "Hide", commands, PartCommand::SetVisible(part, false));
            entry(ui, "Hide all others", commands, PartCommand::ShowOnly(part));
            if ui.button("Focus").clicked() {
                commands.push(PartCommand::Select(Some(part)).into());
                commands.push(ViewCommand::Focus(role).into());
            }
            ui.separator();
        }
        entry(ui, "Show all parts", commands, PartCommand::ShowAll);
        entry(ui, "Fit", commands, ViewCommand::FitAll(role));
        entry(
            ui,
            "Previous view",
            commands,
            ViewCommand::PreviousCamera(role),
        );
        if let Some(hit) = &self.menu {
            ui.separator();
            let pivot = ViewCommand::SetPivot(role, Some(hit.point));
            entry(ui, "Rotate about this point", commands, pivot);
        }
        if target.state.view.pivot.get(role).is_some() {
            let pivot = ViewCommand::SetPivot(role, None);
            entry(ui, "Rotate about what is under the cursor", commands, pivot);
        }
    }
}

fn entry(ui: &mut Ui, text: &str, commands: &mut Vec<Command>, command: impl Into<Command>) {
    if ui.button(text).clicked() {
        commands.push(command.into());
    }
}

impl Target<'_> {
    /// A click on a part that shows its deviation pins the value there.
    fn pins(&self, hit: &Hit) -> bool {
        let display = &self.state.view.display;
        let is_toggling = self.ui.input(|i| i.modifiers.command);
        let is_colored = *display.coloring.on.get(hit.role);
        let shown = self.state.color_by(self.stage.window);
        shown == ColorBy::Deviation && is_colored && !is_toggling
    }

    fn hit(&self) -> Option<Hit> {
        let pos = self.response.hover_pos().filter(|_| !self.is_busy)?;
        let rect = self.response.rect;
        self.picture
            .hit(&self.stage.camera, pixel_of(rect, pos), screen_of(rect))
    }
}
