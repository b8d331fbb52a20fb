//! What lies under the pointer: hovering, selecting, the menu of the right button.

use egui::Ui;

use super::frame::FrameContext;
use super::picture::Hit;
use crate::app::{
    BottomTab, ColorBy, Command, InspectCommand, MapCommand, PartCommand, PartRef, ViewCommand,
};
use crate::role::Role;
use crate::ui::panels::part_row::{Row, menu_ui};

/// What a window remembers about the pointer.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Pointing {
    /// The part that was reported under the pointer.
    hovered: Option<PartRef>,
    /// What lay under the pointer when the menu was opened.
    menu: Option<Hit>,
}

impl Pointing {
    /// What lies under the pointer, after telling the state about it. `is_busy`: the camera or a tool
    /// has the pointer.
    pub fn update(
        &mut self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        is_busy: bool,
        commands: &mut Vec<Command>,
    ) -> Option<Hit> {
        let hit = if is_busy { None } else { hit(frame) };
        let part = hit.as_ref().and_then(|hit| hit.part);
        if !is_busy && self.hovered != part {
            self.hovered = part;
            commands.push(PartCommand::Hover(part).into());
        }
        if frame.state.moving.tool.is_none() {
            if !frame.state.is_picking() {
                self.click(ui, frame, hit.as_ref(), commands);
            }
            if frame.response.secondary_clicked() {
                self.menu.clone_from(&hit);
            }
            frame
                .response
                .context_menu(|ui| self.menu(ui, frame, commands));
        }
        self.pick_pivot(ui, frame, hit.as_ref(), commands);
        hit
    }

    fn click(
        &self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        hit: Option<&Hit>,
        commands: &mut Vec<Command>,
    ) {
        let part = hit.and_then(|hit| hit.part);
        let is_toggling = ui.input(|i| i.modifiers.command);
        if frame.response.double_clicked() {
            commands.push(PartCommand::Select(part).into());
            commands.push(ViewCommand::Focus(frame.camera_role()).into());
        } else if frame.response.clicked()
            && let Some(hit) = hit.filter(|hit| hit.further.is_none() && pins(ui, frame, hit))
        {
            commands.push(InspectCommand::Pin(hit.role, hit.in_part).into());
        } else if frame.response.clicked()
            && let Some(element) = hit.and_then(|hit| probed(ui, frame, hit))
        {
            commands.push(MapCommand::Probe(Some(element)).into());
            commands.push(ViewCommand::SetTab(BottomTab::Mapping).into());
        } else if frame.response.clicked() {
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
    fn pick_pivot(
        &self,
        ui: &Ui,
        frame: &FrameContext<'_>,
        hit: Option<&Hit>,
        commands: &mut Vec<Command>,
    ) {
        let role = frame.camera_role();
        if frame.state.view.pivot.get(role).is_some() {
            return;
        }
        let is_typing = ui.ctx().egui_wants_keyboard_input() && !frame.response.has_focus();
        // Taken, so that the action of the key does not forget it at once.
        let take = |i: &mut egui::InputState| i.consume_key(egui::Modifiers::NONE, egui::Key::P);
        if let Some(hit) = hit.filter(|_| !is_typing && ui.input_mut(take)) {
            commands.push(ViewCommand::SetPivot(role, Some(hit.point)).into());
        }
    }

    fn menu(&self, ui: &mut Ui, frame: &FrameContext<'_>, commands: &mut Vec<Command>) {
        let role = frame.camera_role();
        let file = self.menu.as_ref().and_then(|hit| hit.further.as_ref());
        if let Some(file) = file {
            ui.weak(file.loaded.file_name());
            let hide = ViewCommand::ShowFile(file.loaded.path.clone(), false);
            entry(ui, "Hide", commands, hide);
            ui.separator();
        }
        let part = self.menu.as_ref().and_then(|hit| hit.part);
        match part.and_then(|part| Row::of(frame.state, part)) {
            Some(row) => {
                ui.weak(row.name());
                menu_ui(ui, &row, frame.state, commands);
                ui.separator();
            }
            None => entry(ui, "Show all", commands, PartCommand::ShowAll),
        }
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
        if frame.state.view.pivot.get(role).is_some() {
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

/// A click on a part that shows its deviation pins the value there.
fn pins(ui: &Ui, frame: &FrameContext<'_>, hit: &Hit) -> bool {
    let display = &frame.state.view.display;
    let is_toggling = ui.input(|i| i.modifiers.command);
    let is_colored = *display.coloring.on.get(hit.role);
    let shown = frame.state.color_by(frame.view.window);
    shown == ColorBy::Deviation && is_colored && !is_toggling
}

/// The element of the mapping under a click, where the mapping is shown.
fn probed(ui: &Ui, frame: &FrameContext<'_>, hit: &Hit) -> Option<usize> {
    let is_toggling = ui.input(|i| i.modifiers.command);
    if is_toggling || !frame.state.is_mapping_shown() {
        return None;
    }
    let (document, id) = (&frame.state.document, hit.element?);
    match (hit.role, &hit.further) {
        (Role::Crash, _) => document.mapped_element(id),
        (Role::Stamped, Some(file)) => document.element_mapped_from(&file.loaded, id),
        (Role::Stamped, None) => {
            let first = &document.part(Role::Stamped)?.loaded;
            document.element_mapped_from(first, id)
        }
    }
}

fn hit(frame: &FrameContext<'_>) -> Option<Hit> {
    let pixel = frame.pixel(frame.response.hover_pos()?);
    let camera = &frame.view.camera;
    frame.picture.hit(camera, pixel, frame.screen())
}
