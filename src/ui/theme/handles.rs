//! Colours of the handles that move a part.

use egui::Color32;

use super::rgb;

/// Colours of the handles in one theme.
pub(in crate::ui) struct HandleColors {
    /// X, Y, Z.
    pub axes: [Color32; 3],
    /// The outer ring and the dot.
    pub neutral: Color32,
    /// The active handle.
    pub highlight: Color32,
    /// Colour around lines.
    pub rim: Color32,
    /// Of the axes.
    pub letter: Color32,
    /// Middle and rim of the dot.
    pub dot: [Color32; 2],
    /// Colour around letters.
    pub halo: Color32,
}

const DARK: HandleColors = HandleColors {
    axes: [rgb(0xE2_4B_4B), rgb(0x5C_BE_50), rgb(0x4A_86_F0)],
    neutral: Color32::from_gray(225),
    highlight: rgb(0xFF_E1_5A),
    rim: Color32::from_black_alpha(90),
    letter: Color32::WHITE,
    dot: [Color32::WHITE, Color32::from_black_alpha(200)],
    halo: Color32::from_black_alpha(150),
};

const LIGHT: HandleColors = HandleColors {
    axes: [rgb(0xC6_28_28), rgb(0x1E_7B_34), rgb(0x1D_4E_C4)],
    neutral: Color32::from_gray(70),
    highlight: rgb(0x7B_1F_A2),
    rim: Color32::from_rgba_unmultiplied_const(255, 255, 255, 150),
    letter: Color32::from_gray(20),
    dot: [Color32::WHITE, Color32::from_black_alpha(200)],
    halo: Color32::from_rgba_unmultiplied_const(255, 255, 255, 210),
};

impl HandleColors {
    /// Those of a theme.
    pub fn of_theme(is_dark: bool) -> &'static Self {
        if is_dark { &DARK } else { &LIGHT }
    }
}
