//! The units of both files and the question where they disagree.

use super::PartsState;
use crate::app::{AppState, Document, Settings};
use crate::geometry::Aabb;
use crate::pipeline::units::PairUnits;
use crate::role::{PerRole, Role};
use crate::text::Lengths;
use crate::units::{KnownUnits, LengthUnit};

/// Factors between length units people use: cm, inch, foot and metre against millimetre.
const FACTORS: [f64; 4] = [10.0, 25.4, 304.8, 1000.0];
/// How far the sizes of the two parts may be from an exact factor: trimmed flanges change a size.
const TOLERANCE: f64 = 1.4;

/// Sizes or units of the two parts differ by about a known factor between units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitHint {
    /// What the stamped part's lengths would have to be multiplied by, in addition to its factor.
    pub factor: f64,
    /// The unit the stamped file would then be in, if that of the crash file is known.
    pub unit: Option<LengthUnit>,
}

impl UnitHint {
    /// Compares the diagonals of the two boxes; `None` if they are alike or differ otherwise.
    pub fn of_sizes(crash: &Aabb, stamped: &Aabb) -> Option<Self> {
        let ratio = size_ratio(crash, stamped)?;
        let both_ways = FACTORS.iter().flat_map(|&f| [f, 1.0 / f]);
        let nearest = both_ways.min_by(|a, b| off(ratio, *a).total_cmp(&off(ratio, *b)))?;
        (off(ratio, nearest) < TOLERANCE.ln()).then_some(Self {
            factor: nearest,
            unit: None,
        })
    }

    /// Compares what both files say of themselves; the sizes have to speak for it too, since a
    /// comment may be older than its file.
    fn of_units(crash: LengthUnit, stamped: LengthUnit, ratio: f64, applied: f64) -> Option<Self> {
        let factor = stamped.factor_to(crash) / applied;
        let is_likelier = off(ratio, factor) < off(ratio, 1.0);
        ((factor - 1.0).abs() > 1e-9 && is_likelier).then_some(Self {
            factor,
            unit: Some(stamped),
        })
    }

    /// The hint in words: "Stamped looks 1000 × smaller than crash".
    pub fn text(&self) -> String {
        if self.factor >= 1.0 {
            format!("Stamped looks {} × smaller than crash", tidy(self.factor))
        } else {
            let factor = tidy(1.0 / self.factor);
            format!("Stamped looks {factor} × larger than crash")
        }
    }
}

/// 25.4 rather than 25.400000000000002.
fn tidy(factor: f64) -> f64 {
    (factor * 1e6).round() / 1e6
}

fn size_ratio(crash: &Aabb, stamped: &Aabb) -> Option<f64> {
    let ratio = crash.diagonal() / stamped.diagonal();
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

/// How far a ratio is from a factor, in the logarithm.
fn off(ratio: f64, factor: f64) -> f64 {
    (ratio / factor).ln().abs()
}

impl Document {
    /// What is known about the units of both files.
    pub fn units(&self) -> PairUnits {
        let part = |role| self.part(role).map(|part| &*part.loaded);
        PairUnits::of(PerRole::from_fn(part))
    }

    /// The unit of every length in the window, if it is known.
    pub fn length_unit(&self) -> Option<LengthUnit> {
        self.units().lengths
    }

    /// What follows a length: `" mm"`, or nothing where the unit is unknown.
    pub fn unit_suffix(&self) -> &'static str {
        Lengths::new(self.length_unit()).suffix()
    }

    /// Lengths as the window writes them, with so many decimals of a millimetre.
    pub(in crate::app) fn lengths(&self, decimals: Option<u8>) -> Lengths {
        Lengths::new(self.length_unit()).with_decimals(decimals)
    }

    /// The factor that the stamped file's lengths need, where the user said its unit.
    pub(super) fn wanted_length_factor(&self) -> Option<f64> {
        let PerRole { crash, stamped } = self.both()?;
        let of_crash = crash.loaded.units()?.units.length;
        let of_stamped = stamped.loaded.settings.units?.length;
        Some(of_stamped.factor_to(of_crash))
    }
}

impl AppState {
    /// How the window writes every length that it shows.
    pub fn lengths(&self) -> Lengths {
        self.document.lengths(self.settings.decimals)
    }

    /// The hint about units, until it is answered.
    pub fn unit_hint(&self) -> Option<UnitHint> {
        self.parts.unit_hint(&self.document, &self.settings)
    }

    /// The units of one file. While it is asked whether the stamped file is in another unit, they
    /// are what that file says, else what was made of it.
    pub fn units_of(&self, role: Role) -> Option<KnownUnits> {
        let own = self.document.part(role)?.loaded.units();
        let is_asked = role == Role::Stamped && self.unit_hint().is_some();
        if is_asked {
            own
        } else {
            *self.document.units().files.get(role)
        }
    }
}

impl PartsState {
    /// The hint about units, until it is answered.
    fn unit_hint(&self, document: &Document, settings: &Settings) -> Option<UnitHint> {
        let PerRole { crash, stamped } = document.both()?;
        if self.is_unit_question_answered(document, settings) {
            return None;
        }
        let firm = |known: Option<KnownUnits>| known.filter(|known| known.origin.is_firm());
        let (of_crash, of_stamped) = (crash.loaded.units(), stamped.loaded.units());
        let applied = stamped.length_factor();
        if let (Some(a), Some(b)) = (firm(of_crash), firm(of_stamped)) {
            let ratio = size_ratio(&crash.bounds(), &stamped.bounds())?;
            return UnitHint::of_units(a.units.length, b.units.length, ratio, applied);
        }
        let mut hint = UnitHint::of_sizes(&crash.bounds(), &stamped.bounds())?;
        let of_crash = of_crash.map(|known| known.units.length);
        hint.unit = of_crash.and_then(|unit| unit.times(applied * hint.factor));
        Some(hint)
    }

    fn is_unit_question_answered(&self, document: &Document, settings: &Settings) -> bool {
        let Some(PerRole { crash, stamped }) = document.both() else {
            return true;
        };
        let is_told_apart = crash.loaded.hash().is_some_and(|crash| {
            let memory = &settings.unit_memory;
            memory.differs(&stamped.loaded.path, stamped.loaded.hash(), crash)
        });
        self.unit_hint_dismissed_for == Some(document.stamp().parts)
            || stamped.loaded.settings.units.is_some()
            || is_told_apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn cube(size: f64) -> Aabb {
        Aabb::of_points(&[Point3::origin(), Point3::new(size, size, size)])
    }

    #[test]
    fn sees_metres_inches_and_nothing_where_nothing_is() {
        let hint = UnitHint::of_sizes(&cube(900.0), &cube(1.0)).unwrap();
        assert_eq!(hint.factor, 1000.0);
        assert_eq!(hint.text(), "Stamped looks 1000 × smaller than crash");
        assert_eq!(
            UnitHint::of_sizes(&cube(1.0), &cube(26.0)).unwrap().factor,
            1.0 / 25.4
        );
        assert_eq!(UnitHint::of_sizes(&cube(1.0), &cube(1.3)), None);
        assert_eq!(UnitHint::of_sizes(&cube(1.0), &cube(3.0)), None);
        assert_eq!(UnitHint::of_sizes(&cube(1.0), &cube(0.0)), None);
        assert_eq!(UnitHint::of_sizes(&Aabb::empty(), &cube(1.0)), None);
    }
}
