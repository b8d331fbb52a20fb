//! A round length for the scale bar.

/// A bar of a round length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleBar {
    /// World length: 1, 2 or 5 times a power of ten.
    pub length: f64,
    /// Length on the screen in pixels.
    pub pixels: f64,
}

/// The longest bar of round length that is at most `max_pixels` long, where one pixel is
/// `pixel_size` world units. `None` unless both are positive and finite.
pub fn scale_bar(pixel_size: f64, max_pixels: f64) -> Option<ScaleBar> {
    let longest = pixel_size * max_pixels;
    if !(longest.is_finite() && longest > 0.0) {
        return None;
    }
    let power = 10f64.powf(longest.log10().floor());
    let length = [5.0, 2.0, 1.0]
        .into_iter()
        .map(|digit| digit * power)
        .find(|&length| length <= longest * (1.0 + 1e-9))
        .unwrap_or(power);
    Some(ScaleBar {
        length,
        pixels: length / pixel_size,
    })
}
