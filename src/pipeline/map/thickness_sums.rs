//! Mapped thickness over an area, beside that of the sections there.

/// Usual ratio of the mean thickness of a formed part to that of its section.
const USUAL_THINNING: std::ops::RangeInclusive<f64> = 0.75..=1.1;

/// Sums over crash elements. Thicknesses are those that the deck gets, with the thickness factor.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::pipeline) struct ThicknessSums {
    /// Area of all elements.
    pub area: f64,
    with_thickness: f64,
    thickness: f64,
    /// The mapped thickness where the section has one too, and that.
    beside_section: f64,
    section: f64,
}

impl ThicknessSums {
    /// Adds an element. A thickness that is NaN, and a section without one, count nothing.
    pub fn add(&mut self, area: f64, thickness: f64, section: f64) {
        self.area += area;
        if !thickness.is_finite() {
            return;
        }
        self.with_thickness += area;
        self.thickness += area * thickness;
        if section.is_finite() && section > 0.0 {
            self.beside_section += area * thickness;
            self.section += area * section;
        }
    }

    /// Mean thickness; NaN where none was mapped.
    pub fn mean(&self) -> f64 {
        self.thickness / self.with_thickness
    }

    /// The thickness over that of the sections where that is unusual: another gauge or another unit.
    pub fn unusual_ratio(&self) -> Option<f64> {
        let ratio = self.beside_section / self.section;
        (self.section > 0.0 && !USUAL_THINNING.contains(&ratio)).then_some(ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_elements_that_have_both_are_compared() {
        let mut sums = ThicknessSums::default();
        sums.add(3.0, 0.9, 1.0);
        // Of another gauge, and nothing was mapped onto it.
        sums.add(50.0, f64::NAN, 3.0);
        // Without a section.
        sums.add(1.0, 0.5, f64::NAN);
        assert_eq!(sums.area, 54.0);
        assert!((sums.mean() - 0.8).abs() < 1e-12);
        assert_eq!(sums.unusual_ratio(), None);
        // A large thin element beside a small thick one.
        sums.add(97.0, 0.5, 1.0);
        assert!((sums.unusual_ratio().unwrap() - 0.512).abs() < 1e-12);
        assert!(ThicknessSums::default().mean().is_nan());
    }
}
