//! Colours that mean the same wherever they are seen: the two parts, the axes, the ground behind
//! the parts. Window, renderer, pictures and report read them here.

use crate::colormap::Rgb;
use crate::role::PerRole;

/// The two parts on a dark ground. Blue and orange differ for every kind of colour vision (Okabe and
/// Ito 2008).
pub const ROLES_ON_DARK: PerRole<Rgb> = PerRole {
    crash: [0x56, 0xB4, 0xE9],
    stamped: [0xE6, 0x9F, 0x00],
};
/// The same on a light ground, darker so that text in them can be read.
pub const ROLES_ON_LIGHT: PerRole<Rgb> = PerRole {
    crash: [0x00, 0x72, 0xB2],
    stamped: [0xB2, 0x6B, 0x00],
};
/// Surfaces of the two parts on a dark ground: as the colours above, but also apart in lightness, so that
/// they are told without colours.
pub const SURFACES_ON_DARK: PerRole<Rgb> = PerRole {
    crash: [0x3A, 0x97, 0xCF],
    stamped: [0xF7, 0xBC, 0x45],
};
/// The same on a light ground, fuller: what is pale there is lost in it.
pub const SURFACES_ON_LIGHT: PerRole<Rgb> = PerRole {
    crash: [0x2F, 0x88, 0xBD],
    stamped: [0xEC, 0xA6, 0x2E],
};
/// Top and bottom of the dark ground behind the parts.
pub const DARK_GROUND: [Rgb; 2] = [[0x2B, 0x30, 0x37], [0x17, 0x1A, 0x1E]];
/// Top and bottom of the light ground behind the parts.
pub const LIGHT_GROUND: [Rgb; 2] = [[0xF7, 0xF8, 0xFA], [0xDF, 0xE3, 0xE8]];
/// Parts of one deck that are told apart: ten colours that differ in lightness too, away from those
/// of the roles.
pub const PARTS: [Rgb; 10] = [
    [0x77, 0xAA, 0xDD],
    [0xEE, 0x88, 0x66],
    [0xEE, 0xDD, 0x88],
    [0x44, 0xBB, 0x99],
    [0xFF, 0xAA, 0xBB],
    [0x99, 0xDD, 0xFF],
    [0xBB, 0xCC, 0x33],
    [0xB0, 0x8C, 0xD8],
    [0xAA, 0xAA, 0x00],
    [0xDD, 0xDD, 0xDD],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE lightness L* of a colour.
    fn lightness(color: Rgb) -> f64 {
        let linear = color.map(|byte| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        });
        let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        116.0 * luminance.cbrt() - 16.0
    }

    #[test]
    fn the_two_parts_are_told_apart_in_grey() {
        for surfaces in [SURFACES_ON_DARK, SURFACES_ON_LIGHT] {
            let apart = lightness(surfaces.stamped) - lightness(surfaces.crash);
            assert!(apart > 18.0, "{apart:.1} apart");
        }
    }

    /// The page of the report is a file of its own, which cannot read constants.
    #[test]
    fn the_report_has_the_colours_of_the_parts() {
        let style = include_str!("report/html/style.css");
        for roles in [ROLES_ON_DARK, ROLES_ON_LIGHT] {
            for (name, [r, g, b]) in [("crash", roles.crash), ("stamped", roles.stamped)] {
                let line = format!("--{name}: #{r:02x}{g:02x}{b:02x};");
                assert!(style.contains(&line), "{line}");
            }
        }
    }
}
