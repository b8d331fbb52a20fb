//! Colours, sizes and fonts: one place, two themes.

mod handles;
mod views;

pub(in crate::ui) use handles::HandleColors;
pub use views::part_color;
pub(in crate::ui) use views::{Look, ink};

use egui::{
    Color32, CornerRadius, FontDefinitions, FontFamily, FontId, Margin, Shadow, Stroke, Style,
    TextStyle, Visuals, emath, style::NumberFormatter, style::ScrollAnimation, vec2,
};

use crate::colormap::Rgb;
use crate::palette::{ROLES_ON_DARK, ROLES_ON_LIGHT};
use crate::role::Role;

/// The step everything is spaced by.
pub const UNIT: f32 = 8.0;
/// Height of buttons, fields and rows that are clicked.
pub const ROW: f32 = 24.0;
/// Height of a primary button.
pub const TALL: f32 = 32.0;
/// Width of the label column of a form.
pub const LABEL: f32 = 88.0;

/// Seconds that menus and folds take to glide into place.
const GLIDE: f32 = 0.1;

/// The colours of one theme. Pairs of text and ground keep a contrast of at least 4.5.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Palette {
    /// The crash part ■.
    pub crash: Color32,
    /// The stamped part ▲.
    pub stamped: Color32,
    /// The one accent: what is primary, on, or selected.
    pub accent: Color32,
    /// Text on the accent.
    pub on_accent: Color32,
    /// The accent as text.
    pub accent_text: Color32,
    /// Ground of panels.
    pub panel: Color32,
    /// Ground of the bars above and below.
    pub bar: Color32,
    /// Ground of cards on a panel.
    pub card: Color32,
    /// Ground of fields and plots.
    pub field: Color32,
    /// A widget at rest.
    pub widget: Color32,
    /// A widget under the pointer.
    pub hovered: Color32,
    /// Thin lines between areas.
    pub line: Color32,
    /// Ordinary text.
    pub text: Color32,
    /// Text that says less.
    pub secondary: Color32,
    /// Verdict good, success.
    pub good: Color32,
    /// Verdict check, warning.
    pub check: Color32,
    /// Verdict poor, error.
    pub poor: Color32,
    /// The 3D windows.
    pub ground: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// A colour of the program as egui has it.
pub const fn color([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// For eyes in a dim room.
const DARK: Palette = Palette {
    crash: color(ROLES_ON_DARK.crash),
    stamped: color(ROLES_ON_DARK.stamped),
    accent: rgb(0x6A_5A_E0),
    on_accent: Color32::WHITE,
    accent_text: rgb(0xB0_A6_FF),
    panel: rgb(0x24_28_2E),
    bar: rgb(0x1B_1E_22),
    card: rgb(0x2B_30_37),
    field: rgb(0x1B_1E_23),
    widget: rgb(0x36_3C_45),
    hovered: rgb(0x43_4B_56),
    line: rgb(0x38_3E_47),
    text: rgb(0xE6_E9_ED),
    secondary: rgb(0xA9_B2_BD),
    good: rgb(0x5C_CB_8F),
    check: rgb(0xE8_C8_4A),
    poor: rgb(0xFF_7B_80),
    ground: rgb(0x1E_21_26),
};

/// For bright rooms and print.
const LIGHT: Palette = Palette {
    crash: color(ROLES_ON_LIGHT.crash),
    stamped: color(ROLES_ON_LIGHT.stamped),
    accent: rgb(0x55_46_C8),
    on_accent: Color32::WHITE,
    accent_text: rgb(0x4B_3D_B8),
    panel: rgb(0xF7_F8_FA),
    bar: rgb(0xE9_EC_F0),
    card: rgb(0xFF_FF_FF),
    field: rgb(0xFF_FF_FF),
    widget: rgb(0xE3_E7_EC),
    hovered: rgb(0xD5_DB_E3),
    line: rgb(0xD3_D8_DF),
    text: rgb(0x1C_21_27),
    secondary: rgb(0x55_5F_6B),
    good: rgb(0x1B_7A_45),
    check: rgb(0x85_5F_00),
    poor: rgb(0xBC_26_2E),
    ground: rgb(0xEC_EE_F1),
};

impl Palette {
    /// The palette in force.
    pub fn of(ui: &egui::Ui) -> &'static Self {
        Self::of_visuals(ui.visuals())
    }

    /// The palette of dark or light visuals.
    pub fn of_visuals(visuals: &Visuals) -> &'static Self {
        if visuals.dark_mode { &DARK } else { &LIGHT }
    }

    /// The colour of a part.
    pub fn role(&self, role: Role) -> Color32 {
        match role {
            Role::Crash => self.crash,
            Role::Stamped => self.stamped,
        }
    }
}

/// Fonts and both styles; once, before the first frame.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.set_style_of(egui::Theme::Dark, style(&DARK, true));
    ctx.set_style_of(egui::Theme::Light, style(&LIGHT, false));
    // Ctrl with + and − are actions of ours, which remember the size.
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
}

/// Whether what has the keyboard has a ring: it is drawn as what is pressed.
pub fn set_ring(ctx: &egui::Context, is_shown: bool) {
    ctx.all_styles_mut(|style| {
        let accent = Palette::of_visuals(&style.visuals).accent_text;
        let widgets = &mut style.visuals.widgets;
        widgets.active.bg_stroke = if is_shown {
            Stroke::new(1.5, accent)
        } else {
            widgets.hovered.bg_stroke
        };
    });
}

/// Whether menus, folds and lists glide into place or are there at once.
pub fn set_motion(ctx: &egui::Context, moves: bool) {
    ctx.all_styles_mut(|style| {
        style.animation_time = if moves { GLIDE } else { 0.0 };
        style.scroll_animation = if moves {
            ScrollAnimation::default()
        } else {
            ScrollAnimation::none()
        };
    });
}

/// The default fonts; arrows and role marks, which the text face lacks, come from the mono face.
fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    if let Some(family) = fonts.families.get_mut(&FontFamily::Proportional) {
        family.insert(1, "Hack".to_owned());
    }
    fonts
}

fn style(palette: &Palette, is_dark: bool) -> Style {
    let mut style = Style {
        visuals: visuals(palette, is_dark),
        animation_time: GLIDE,
        // A minus, as in every other text.
        number_formatter: NumberFormatter::new(|value, decimals| {
            emath::format_with_decimals_in_range(value, decimals).replace('-', "−")
        }),
        ..Style::default()
    };
    let proportional = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Small, proportional(12.0)),
        (TextStyle::Body, proportional(13.5)),
        (TextStyle::Button, proportional(13.5)),
        (TextStyle::Heading, proportional(16.0)),
        (
            TextStyle::Monospace,
            FontId::new(12.0, FontFamily::Monospace),
        ),
    ]
    .into();
    style.drag_value_text_style = TextStyle::Body;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(UNIT, 6.0);
    spacing.button_padding = vec2(10.0, 3.0);
    spacing.interact_size = vec2(32.0, ROW);
    spacing.menu_margin = Margin::same(6);
    // Menus are as high as what they hold, where the window is; 400 is the default.
    spacing.default_area_size = vec2(600.0, f32::MAX);
    spacing.window_margin = Margin::same(16);
    spacing.indent = 16.0;
    spacing.icon_width = 16.0;
    spacing.icon_width_inner = 10.0;
    spacing.icon_spacing = 6.0;
    spacing.combo_width = 64.0;
    spacing.text_edit_width = 160.0;
    spacing.slider_width = 120.0;
    spacing.slider_rail_height = 4.0;
    spacing.tooltip_width = 320.0;
    spacing.scroll.bar_width = 8.0;
    spacing.scroll.floating_width = 6.0;
    style.interaction.tooltip_delay = 0.4;
    style.interaction.selectable_labels = false;
    style
}

fn visuals(palette: &Palette, is_dark: bool) -> Visuals {
    let mut visuals = if is_dark {
        Visuals::dark()
    } else {
        Visuals::light()
    };
    let radius = CornerRadius::same(4);
    let hair = Stroke::new(1.0, palette.line);
    let rest = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut rest.noninteractive, palette.card, palette.text),
        (&mut rest.inactive, palette.widget, palette.text),
        (&mut rest.hovered, palette.hovered, palette.text),
        // Its text is that of everything strong, on any ground.
        (&mut rest.active, palette.hovered, palette.text),
        (&mut rest.open, palette.hovered, palette.text),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
    visuals.widgets.noninteractive.bg_stroke = hair;
    let edge = Stroke::new(1.0, palette.secondary.gamma_multiply(0.6));
    visuals.widgets.active.bg_stroke = edge;
    visuals.widgets.hovered.bg_stroke = edge;
    visuals.selection.bg_fill = palette.accent;
    visuals.selection.stroke = Stroke::new(1.0, palette.on_accent);
    visuals.weak_text_color = Some(palette.secondary);
    visuals.hyperlink_color = palette.accent_text;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = hair;
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = palette.field;
    visuals.text_edit_bg_color = Some(palette.field);
    visuals.faint_bg_color = palette.card;
    visuals.code_bg_color = palette.field;
    visuals.warn_fg_color = palette.check;
    visuals.error_fg_color = palette.poor;
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    visuals.disabled_alpha = 0.55;
    let shadow = Shadow {
        offset: [0, 4],
        blur: 16,
        spread: 0,
        color: Color32::from_black_alpha(if is_dark { 110 } else { 40 }),
    };
    visuals.window_shadow = shadow;
    visuals.popup_shadow = shadow;
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2 contrast of two opaque colours.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b, _] = egui::Rgba::from(color).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    #[test]
    fn all_text_can_be_read() {
        for palette in [DARK, LIGHT] {
            for ground in [palette.panel, palette.card, palette.bar, palette.field] {
                for text in [
                    palette.text,
                    palette.secondary,
                    palette.accent_text,
                    palette.good,
                    palette.check,
                    palette.poor,
                ] {
                    let found = contrast(text, ground);
                    assert!(found >= 4.5, "{text:?} on {ground:?}: {found:.2}");
                }
            }
            for ground in [palette.widget, palette.hovered] {
                assert!(contrast(palette.text, ground) >= 4.5);
            }
            assert!(contrast(palette.on_accent, palette.accent) >= 4.5);
        }
    }
}
