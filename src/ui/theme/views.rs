//! Colours of the 3D windows in the dark and the light theme.

use egui::Color32;

use super::{color, rgb};
use crate::app::{AppState, ColorBy};
use crate::colormap::Rgb;
use crate::palette::{PARTS, ROLES_ON_DARK, ROLES_ON_LIGHT, SURFACES_ON_DARK, SURFACES_ON_LIGHT};
use crate::render::{Background, LineLook};
use crate::role::{PerRole, Role};

/// Colours of one theme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::ui) struct Look {
    /// Crash and stamped.
    pub roles: PerRole<Rgb>,
    /// Their surfaces in the light.
    pub surfaces: PerRole<Rgb>,
    pub background: Background,
    pub lines: LineLook,
    /// Brightness of the light on the parts.
    pub exposure: f32,
    /// Share of the light that comes from everywhere. On a light ground deep shade reads as dirt.
    pub ambient: f32,
    /// Text over the picture, and the same fainter.
    pub text: Color32,
    pub weak: Color32,
    /// Ground of texts, buttons and cards over the picture.
    pub plate: Color32,
    pub plate_line: Color32,
    /// Accent of tools: pivot ring, picked node, wipe line.
    pub tool: Color32,
    /// Letters and lines of the axes X, Y, Z.
    pub axes: [Color32; 3],
    pub is_dark: bool,
}

/// The colour of the part of a deck with this place in it, while colours tell parts.
pub fn part_color(ui: &egui::Ui, state: &AppState, index: usize) -> Option<Rgb> {
    let is_by_part = state.view.display.color_by == ColorBy::Part;
    is_by_part.then(|| Look::of(ui.visuals().dark_mode).part(index))
}

impl Look {
    pub const DARK: Self = Self {
        roles: ROLES_ON_DARK,
        surfaces: SURFACES_ON_DARK,
        background: Background::DARK,
        lines: LineLook::DARK,
        exposure: 1.0,
        ambient: 0.0,
        text: Color32::from_rgb(0xEC, 0xEF, 0xF3),
        weak: Color32::from_rgb(0xA9, 0xB2, 0xBD),
        plate: Color32::from_rgba_unmultiplied_const(0x16, 0x19, 0x1D, 0xC8),
        plate_line: Color32::from_rgba_unmultiplied_const(0xFF, 0xFF, 0xFF, 0x1E),
        tool: Color32::from_rgb(0xFF, 0xFF, 0xFF),
        axes: [rgb(0xF2_6D_6D), rgb(0x7C_D6_7C), rgb(0x7D_B4_FF)],
        is_dark: true,
    };
    pub const LIGHT: Self = Self {
        roles: ROLES_ON_LIGHT,
        surfaces: SURFACES_ON_LIGHT,
        background: Background::LIGHT,
        lines: LineLook::LIGHT,
        exposure: 1.25,
        ambient: 0.4,
        text: Color32::from_rgb(0x1B, 0x20, 0x26),
        weak: Color32::from_rgb(0x4E, 0x58, 0x63),
        plate: Color32::from_rgba_unmultiplied_const(0xFF, 0xFF, 0xFF, 0xD2),
        plate_line: Color32::from_rgba_unmultiplied_const(0x00, 0x00, 0x00, 0x22),
        tool: Color32::from_rgb(0x10, 0x14, 0x18),
        axes: [rgb(0xC6_28_28), rgb(0x1E_7B_34), rgb(0x1D_4E_C4)],
        is_dark: false,
    };

    /// The look of the theme a window has.
    pub fn of(is_dark: bool) -> Self {
        if is_dark { Self::DARK } else { Self::LIGHT }
    }

    /// Colour of a role for egui.
    pub fn role(&self, role: Role) -> Color32 {
        color(*self.roles.get(role))
    }

    /// The grey of a role's surface.
    pub fn ghost(&self, role: Role) -> Rgb {
        let [red, green, blue] = self.surfaces.get(role).map(u16::from);
        [((red + 2 * green + blue) / 4) as u8; 3]
    }

    /// Colour of the n-th part of a deck, if parts are told apart: ten colours that differ in
    /// lightness too, away from those of the roles.
    pub fn part(&self, index: usize) -> Rgb {
        let part = PARTS[index % PARTS.len()];
        if self.is_dark {
            part
        } else {
            part.map(|c| (f32::from(c) * 0.78) as u8)
        }
    }
}

/// Ink of patterns over colours: black of this opacity.
pub(in crate::ui) const fn ink(opacity: u8) -> Color32 {
    Color32::from_black_alpha(opacity)
}
