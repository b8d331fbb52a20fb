//! The units of two parts that are brought together: what is known of either, and the unit that all
//! lengths are in.

use super::load::LoadedPart;
use crate::role::{PerRole, Role};
use crate::units::{KnownUnits, LengthUnit, UnitOrigin};

/// The units of a pair, or of one part alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairUnits {
    /// Units of each file, before its factor was applied.
    pub files: PerRole<Option<KnownUnits>>,
    /// The unit that every length is in once the factors are applied; `None` if unknown.
    pub lengths: Option<LengthUnit>,
}

impl PairUnits {
    /// What both files say together. The crash file's units count; a stamped file says only what
    /// that one leaves open, unless it needs a factor that was not applied.
    pub fn of(parts: PerRole<Option<&LoadedPart>>) -> Self {
        let mut units = Self::settled(parts);
        if let (Some(crash), Some(stamped)) = (parts.crash, parts.stamped)
            && missing_factor(PerRole::new(crash, stamped)).is_some()
        {
            units.files.stamped = stamped.units();
        }
        units
    }

    /// The same where the factor between the two is what was chosen for the stamped file, whatever it says.
    pub fn settled(parts: PerRole<Option<&LoadedPart>>) -> Self {
        let known = parts.map(|part| part?.units());
        let lengths_of = |role: Role, must_be_firm: bool| {
            let known = known
                .get(role)
                .filter(|known| !must_be_firm || known.origin.is_firm());
            after_factor(known?, (*parts.get(role))?.settings.length_factor)
        };
        let lengths = lengths_of(Role::Crash, true)
            .or_else(|| lengths_of(Role::Stamped, true))
            .or_else(|| lengths_of(Role::Crash, false))
            .or_else(|| lengths_of(Role::Stamped, false));
        Self {
            files: PerRole::from_fn(|role| agreed(*parts.get(role), *known.get(role), lengths)),
            lengths,
        }
    }

    /// The unit of all lengths, the files' units and factors, for exports: "lengths in mm",
    /// "stamped.dynain: m, set by you; its lengths were multiplied by 1000".
    pub fn sentences(parts: PerRole<&LoadedPart>) -> Vec<String> {
        let units = Self::of(parts.map(Some));
        let mut sentences = vec![match units.lengths {
            Some(unit) => format!("lengths in {unit}"),
            None => "unit of lengths unknown".to_owned(),
        }];
        for (role, part) in parts.iter() {
            let name = part.file_name();
            let words = units
                .files
                .get(role)
                .map_or_else(|| "unit unknown".to_owned(), KnownUnits::words);
            let factor = part.settings.length_factor;
            let own = units.files.get(role).map(|known| known.units.length);
            sentences.push(if factor == 1.0 && own != units.lengths {
                format!("{name}: {words}; no factor was applied")
            } else if factor == 1.0 {
                format!("{name}: {words}")
            } else {
                format!("{name}: {words}; its lengths were multiplied by {factor}")
            });
        }
        sentences
    }

    /// A warning where both systems are known and their stresses are in different units, which no
    /// card converts.
    pub fn stress_warning(parts: PerRole<&LoadedPart>) -> Option<String> {
        let PerRole { crash, stamped } = parts;
        let stress = |part: &LoadedPart| Some(part.units()?.units.system?.stress());
        let (target, source) = (stress(crash)?, stress(stamped)?);
        let has_stress = !stamped.model.forming.is_empty();
        (has_stress && target != source).then(|| {
            format!(
                "stresses in {} are in {source}, those of {} in {target}; the cards do not \
                 convert them",
                stamped.file_name(),
                crash.file_name()
            )
        })
    }
}

/// What the stamped part's lengths have still to be multiplied by: both files say their units, and the sizes of
/// the parts speak for it too, since a comment may be older than its file.
pub fn missing_factor(parts: PerRole<&LoadedPart>) -> Option<f64> {
    let PerRole { crash, stamped } = parts.map(|part| {
        let known = part.units().filter(|known| known.origin.is_firm())?;
        Some(known.units.length)
    });
    let factor = stamped?.factor_to(crash?) / parts.stamped.settings.length_factor;
    let size = |part: &LoadedPart| part.surface.measures().diagonal;
    let ratio = size(parts.crash) / size(parts.stamped);
    let off = |from: f64| (ratio / from).ln().abs();
    ((factor - 1.0).abs() > 1e-9 && off(factor) < off(1.0)).then_some(factor)
}

/// The unit of lengths after a factor was applied.
fn after_factor(known: KnownUnits, factor: f64) -> Option<LengthUnit> {
    known.units.length.times(1.0 / factor)
}

/// A file's own units where they agree with the unit of all lengths, else those that follow.
fn agreed(
    part: Option<&LoadedPart>,
    known: Option<KnownUnits>,
    lengths: Option<LengthUnit>,
) -> Option<KnownUnits> {
    let factor = part?.settings.length_factor;
    let Some(lengths) = lengths else {
        return known;
    };
    let agrees = |known: &KnownUnits| after_factor(*known, factor) == Some(lengths);
    known.filter(agrees).or_else(|| {
        Some(KnownUnits {
            units: lengths.times(factor)?.into(),
            origin: UnitOrigin::OtherPart,
        })
    })
}
