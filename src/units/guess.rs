//! Units guessed from sizes and thicknesses.

use super::{KnownUnits, LengthUnit, UnitOrigin, UnitSystem};

/// Density in kg/m³ and Young's modulus in Pa of what sheet parts are made of: steel, aluminium,
/// magnesium.
const METALS: [[f64; 2]; 3] = [[7850.0, 2.07e11], [2700.0, 7.0e10], [1800.0, 4.5e10]];
/// How far density and modulus in a deck may be from these, as a factor.
const METAL_TOLERANCE: [f64; 2] = [1.08, 1.2];

/// A usual sheet and a usual part, in millimetres, with the factor that is one standard deviation.
const SHEET: [f64; 2] = [1.2, 2.0];
const PART: [f64; 2] = [800.0, 3.0];
/// Above this sum of squares a size is no size of a sheet part at all.
const WORST: f64 = 9.0;
/// How much worse than the best the second best has to be.
const MARGIN: f64 = 1.0;

/// The system in which most of the materials are a metal of sheet parts. Each material is its
/// density and its Young's modulus; `None` if no material is, or two systems tie.
pub fn of_materials(materials: &[[f64; 2]]) -> Option<KnownUnits> {
    let count = |system: UnitSystem| {
        let is_metal = |material: &&[f64; 2]| is_metal_in(system, **material);
        materials.iter().filter(is_metal).count()
    };
    let mut counts = UnitSystem::ALL.map(|system| (count(system), system));
    counts.sort_by_key(|(n, _)| std::cmp::Reverse(*n));
    let [(n_best, best), (n_next, _), ..] = counts;
    (n_best > n_next).then_some(KnownUnits {
        units: best.into(),
        origin: UnitOrigin::Materials,
    })
}

fn is_metal_in(system: UnitSystem, [density, modulus]: [f64; 2]) -> bool {
    let [length, mass, time] = system.in_si();
    let density = density * mass / length.powi(3);
    let modulus = modulus * mass / (length * time * time);
    METALS.iter().any(|metal| {
        let off = [density / metal[0], modulus / metal[1]];
        let within = |(off, most): (&f64, f64)| off.ln().abs() <= most.ln();
        off.iter().zip(METAL_TOLERANCE).all(within)
    })
}

/// The unit in which a part of this size and thickness is a sheet part. Without a thickness only
/// millimetres and metres are told apart. `None` if nothing or more than one unit fits.
///
/// The squares of the distances from a usual sheet (1.2, factor 2) and a usual part (800 mm, factor
/// 3) are summed in the logarithm; units that decks are rarely written in start behind.
pub fn of_sizes(diagonal: f64, thickness: Option<f64>) -> Option<KnownUnits> {
    if !(diagonal.is_finite() && diagonal > 0.0) {
        return None;
    }
    let thickness = thickness.filter(|t| t.is_finite() && *t > 0.0);
    let known: &[LengthUnit] = match thickness {
        Some(_) => &LengthUnit::ALL,
        None => &[LengthUnit::Millimeter, LengthUnit::Meter],
    };
    let off = |value: f64, [usual, deviation]: [f64; 2]| {
        ((value / usual).ln() / f64::ln(deviation)).powi(2)
    };
    let score = |unit: LengthUnit| {
        let in_mm = unit.factor_to(LengthUnit::Millimeter);
        let of_sheet = thickness.map_or(0.0, |t| off(t * in_mm, SHEET));
        of_sheet + off(diagonal * in_mm, PART) + rarity(unit)
    };
    let mut scores: Vec<(f64, LengthUnit)> = known.iter().map(|&u| (score(u), u)).collect();
    scores.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_clear = scores[0].0 < WORST && scores[1].0 - scores[0].0 > MARGIN;
    is_clear.then(|| KnownUnits {
        units: scores[0].1.into(),
        origin: match thickness {
            Some(_) => UnitOrigin::SizeAndThickness,
            None => UnitOrigin::Size,
        },
    })
}

/// How far behind a unit starts.
fn rarity(unit: LengthUnit) -> f64 {
    match unit {
        LengthUnit::Millimeter | LengthUnit::Meter => 0.0,
        LengthUnit::Inch => 3.0,
        LengthUnit::Centimeter => 5.0,
        LengthUnit::Foot => 8.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sized(diagonal: f64, thickness: impl Into<Option<f64>>) -> Option<(LengthUnit, UnitOrigin)> {
        of_sizes(diagonal, thickness.into()).map(|known| (known.units.length, known.origin))
    }

    #[test]
    fn sheet_parts_are_known_by_their_size() {
        use LengthUnit as U;
        use UnitOrigin as O;
        assert_eq!(
            sized(900.0, 1.5),
            Some((U::Millimeter, O::SizeAndThickness))
        );
        assert_eq!(sized(0.9, 0.0015), Some((U::Meter, O::SizeAndThickness)));
        assert_eq!(sized(35.0, 0.05), Some((U::Inch, O::SizeAndThickness)));
        assert_eq!(
            sized(4500.0, 1.0),
            Some((U::Millimeter, O::SizeAndThickness))
        );
        assert_eq!(
            sized(150.0, 2.0),
            Some((U::Millimeter, O::SizeAndThickness))
        );
        assert_eq!(sized(900.0, None), Some((U::Millimeter, O::Size)));
        assert_eq!(sized(0.9, None), Some((U::Meter, O::Size)));
        // A cube of one is a part in nothing; 25 without a thickness may be many things.
        assert_eq!(sized(25.0, None), None);
        assert_eq!(sized(0.0, 1.0), None);
        assert_eq!(sized(f64::NAN, 1.0), None);
        assert_eq!(sized(1e9, 1e5), None);
    }

    #[test]
    fn steel_and_aluminium_name_their_system() {
        let system = |materials: &[[f64; 2]]| of_materials(materials)?.units.system;
        assert_eq!(system(&[[7.85e-9, 2.1e5]]), Some(UnitSystem::TonMmS));
        assert_eq!(system(&[[7.89e-6, 210.0]]), Some(UnitSystem::KgMmMs));
        assert_eq!(system(&[[2.7e-3, 70_000.0]]), Some(UnitSystem::GMmMs));
        assert_eq!(system(&[[7830.0, 2.07e11]]), Some(UnitSystem::KgMS));
        assert_eq!(system(&[[7.35e-4, 3.0e7]]), Some(UnitSystem::LbInS));
        // Foam says nothing, and one steel among it is enough.
        assert_eq!(system(&[[6e-11, 5.0]]), None);
        assert_eq!(
            system(&[[6e-11, 5.0], [7.85e-9, 2.1e5]]),
            Some(UnitSystem::TonMmS)
        );
        assert_eq!(system(&[]), None);
    }
}
