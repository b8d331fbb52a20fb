//! Files dragged over the window or dropped on it: where they go, and the words that say so.

use std::path::PathBuf;

use egui::{Color32, FontId, Rect, Stroke, Ui, vec2};

use super::{graphics, section};
use crate::app::{AppState, Command, FileCommand, MapCommand, Section};
use crate::pipeline::project::is_project;
use crate::role::Role;
use crate::ui::theme::{Palette, TALL};

/// Where files go that are dropped now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DropTarget {
    /// A project is among them, which is opened wherever it falls.
    Project,
    /// Into a window of its own part; without one their content tells what they are.
    Part(Option<Role>),
    /// Into the list of stamped files, in section 4.
    StampedFiles,
}

impl DropTarget {
    /// The target of these files under the pointer.
    pub fn under_pointer(ctx: &egui::Context, state: &AppState, files: &[PathBuf]) -> Self {
        if files.iter().any(|file| is_project(file)) {
            return Self::Project;
        }
        let at = ctx.pointer_latest_pos();
        let section = section::place_of(ctx, Section::Map);
        let is_over = |rect: Rect| at.is_some_and(|at| rect.contains(at));
        if state.document.is_stamped_placed() && section.is_some_and(is_over) {
            return Self::StampedFiles;
        }
        Self::Part(match files.len() {
            1 => graphics::role_under_pointer(ctx),
            _ => None,
        })
    }

    /// What follows from the drop.
    pub fn commands(self, paths: Vec<PathBuf>) -> Vec<Command> {
        match self {
            Self::Project => vec![FileCommand::Open { paths, role: None }.into()],
            Self::Part(role) => vec![FileCommand::Open { paths, role }.into()],
            Self::StampedFiles => {
                let add = |path| MapCommand::AddFurther(path).into();
                paths.into_iter().map(add).collect()
            }
        }
    }
}

/// The files that hang over the window. Not every desktop names them before they fall.
pub fn hovered(ui: &Ui) -> Vec<PathBuf> {
    ui.input(|input| {
        let files = input.raw.hovered_files.iter();
        files
            .map(|file| file.path.clone().unwrap_or_default())
            .collect()
    })
}

/// While files hang over section 4: that they go into its list.
pub fn section_hint(ui: &Ui, state: &AppState) {
    let files = hovered(ui);
    if files.is_empty()
        || DropTarget::under_pointer(ui.ctx(), state, &files) != DropTarget::StampedFiles
    {
        return;
    }
    let text = match files.len() {
        1 => "Drop as one more stamped file",
        _ => "Drop as more stamped files",
    };
    if let Some(place) = section::place_of(ui.ctx(), Section::Map) {
        let color = Palette::of(ui).role(Role::Stamped);
        hint(ui, place, color, text.to_owned());
    }
}

/// A place that takes what hangs over it, with words.
pub fn hint(ui: &Ui, rect: Rect, color: Color32, text: String) {
    let palette = Palette::of(ui);
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, color.gamma_multiply(0.12));
    let stroke = Stroke::new(2.0, color);
    painter.rect_stroke(rect.shrink(2.0), 4.0, stroke, egui::StrokeKind::Inside);
    // A folded section is as high as its header.
    let (size, air) = if rect.height() < 2.0 * TALL {
        (13.0, vec2(8.0, 3.0))
    } else {
        (18.0, vec2(16.0, 10.0))
    };
    let font = FontId::proportional(size);
    let room = rect.width() - 3.0 * air.x;
    let galley = painter.layout(text, font, palette.text, room);
    let plate = Rect::from_center_size(rect.center(), galley.size() + 2.0 * air);
    painter.rect_filled(plate, 8.0, palette.card);
    painter.galley(plate.min + air, galley, palette.text);
}
