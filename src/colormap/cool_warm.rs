//! The cool–warm map of Moreland (2009), "Diverging color maps for scientific visualization": straight
//! lines in Msh space, the polar form of CIELAB, from either end to an unsaturated middle.

use super::{Rgb, linear_of_srgb};

/// White point D65, which sRGB refers to.
const WHITE: [f64; 3] = [0.95047, 1.0, 1.08883];
const COLD: Rgb = [59, 76, 192];
const WARM: Rgb = [180, 4, 38];
/// Magnitude M of the middle: the brighter of 88 and both ends (section 4).
const MIDDLE_MAGNITUDE: f64 = 88.0;

pub(super) fn sample(t: f64) -> Rgb {
    let (end, share) = if t < 0.5 {
        (msh_from_rgb(COLD), 2.0 * t)
    } else {
        (msh_from_rgb(WARM), 2.0 - 2.0 * t)
    };
    let [magnitude, saturation, hue] = end;
    let middle_hue = hue_of_the_middle(end);
    let blend = |from: f64, to: f64| from + (to - from) * share;
    rgb_from_msh([
        blend(magnitude, MIDDLE_MAGNITUDE),
        blend(saturation, 0.0),
        blend(hue, middle_hue),
    ])
}

/// The hue that an end turns to on its way to the unsaturated middle, so that the map does not look
/// bent (Moreland's AdjustHue).
fn hue_of_the_middle([magnitude, saturation, hue]: [f64; 3]) -> f64 {
    if magnitude >= MIDDLE_MAGNITUDE {
        return hue;
    }
    let spin = saturation * (MIDDLE_MAGNITUDE.powi(2) - magnitude * magnitude).sqrt()
        / (magnitude * saturation.sin());
    if hue > -std::f64::consts::FRAC_PI_3 {
        hue + spin
    } else {
        hue - spin
    }
}

fn msh_from_rgb(color: Rgb) -> [f64; 3] {
    let [r, g, b] = color.map(|byte| linear_of_srgb(f64::from(byte) / 255.0));
    let xyz = [
        0.4124 * r + 0.3576 * g + 0.1805 * b,
        0.2126 * r + 0.7152 * g + 0.0722 * b,
        0.0193 * r + 0.1192 * g + 0.9505 * b,
    ];
    let f = |i: usize| {
        let q = xyz[i] / WHITE[i];
        if q > 0.008856 {
            q.cbrt()
        } else {
            7.787 * q + 16.0 / 116.0
        }
    };
    let (l, a, b) = (
        116.0 * f(1) - 16.0,
        500.0 * (f(0) - f(1)),
        200.0 * (f(1) - f(2)),
    );
    let magnitude = (l * l + a * a + b * b).sqrt();
    [magnitude, (l / magnitude).acos(), b.atan2(a)]
}

fn rgb_from_msh([magnitude, saturation, hue]: [f64; 3]) -> Rgb {
    let l = magnitude * saturation.cos();
    let a = magnitude * saturation.sin() * hue.cos();
    let b = magnitude * saturation.sin() * hue.sin();
    let y = (l + 16.0) / 116.0;
    let inverse = |f: f64| {
        if f.powi(3) > 0.008856 {
            f.powi(3)
        } else {
            (f - 16.0 / 116.0) / 7.787
        }
    };
    let x = WHITE[0] * inverse(y + a / 500.0);
    let z = WHITE[2] * inverse(y - b / 200.0);
    let y = WHITE[1] * inverse(y);
    let linear = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    linear.map(|c| (encode(c.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

fn encode(c: f64) -> f64 {
    if c <= 0.0031308 {
        c * 12.92
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}
