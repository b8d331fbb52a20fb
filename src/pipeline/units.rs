//! The units of two parts that are brought together: what is known of either, and the unit that all
//! lengths are in.

use super::load::LoadedPart;
use crate::registration::guess_unit;
use crate::role::{PerRole, Role};
use crate::settings::exact;
use crate::text::tidy_factor;
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

/// What speaks against the units that the user set: what each file says itself, and the sizes of both parts.
pub fn doubts_of_set_units(parts: PerRole<&LoadedPart>) -> Vec<String> {
    let of_files = parts
        .iter()
        .filter_map(|(_, part)| doubt_of_set_units(part));
    of_files.chain(doubt_of_sizes(parts)).collect()
}

/// What a file says of its units, in words, where the user set others.
pub fn doubt_of_set_units(part: &LoadedPart) -> Option<String> {
    let (set, own) = (part.settings.units?, part.guessed_units?);
    let is_same = match set.system.and(own.units.system) {
        Some(_) => set == own.units,
        None => set.length == own.units.length,
    };
    // A size alone tells millimetres from metres and no more.
    let is_told = own.origin != UnitOrigin::Size
        || matches!(set.length, LengthUnit::Millimeter | LengthUnit::Meter);
    (is_told && !is_same).then(|| {
        format!(
            "the units of {} are set to {}, which contradicts {}",
            part.file_name(),
            set.label(),
            own.words()
        )
    })
}

/// Says that the parts are as large as each other although the units, of which the user set some, differ.
fn doubt_of_sizes(parts: PerRole<&LoadedPart>) -> Option<String> {
    let is_set = parts.iter().any(|(_, part)| part.settings.units.is_some());
    let factor = factor_left(parts).filter(|factor| is_set && !speaks_for(*factor, parts))?;
    let PerRole { crash, stamped } = parts.map(|part| {
        let words = part.units().map_or_else(String::new, KnownUnits::words);
        format!("{} ({words})", part.file_name())
    });
    // The units of both files may be told as they follow from this, which is not what the stamped file says.
    let lengths = PairUnits::of(parts.map(Some)).lengths;
    let taken = lengths.map_or_else(String::new, |unit| {
        format!(", so the lengths of both are taken to be in {unit}")
    });
    Some(format!(
        "the units of {stamped} and {crash} differ by the factor {}, but the sizes of the parts do not; no factor was \
         applied{taken}",
        tidy_factor(factor)
    ))
}

/// What the stamped part's lengths have still to be multiplied by: both files say their units, and the sizes of
/// the parts speak for it too, since a comment may be older than its file.
pub fn missing_factor(parts: PerRole<&LoadedPart>) -> Option<f64> {
    factor_left(parts).filter(|factor| speaks_for(*factor, parts))
}

/// Whether both parts are in one unit as they were read, as far as their files or the user say in which.
pub fn are_in_one_unit(parts: PerRole<&LoadedPart>) -> bool {
    factor_of_units(parts).is_some_and(|factor| (factor - 1.0).abs() <= 1e-9)
}

/// The factor between the units of both files that was not applied; `None` if there is none.
fn factor_left(parts: PerRole<&LoadedPart>) -> Option<f64> {
    factor_of_units(parts).filter(|factor| (factor - 1.0).abs() > 1e-9)
}

/// The factor between the units of both files over the one that was applied; `None` where one does not say its unit.
fn factor_of_units(parts: PerRole<&LoadedPart>) -> Option<f64> {
    let PerRole { crash, stamped } = parts.map(|part| {
        let known = part.units().filter(|known| known.origin.is_firm())?;
        Some(known.units.length)
    });
    Some(stamped?.factor_to(crash?) / parts.stamped.settings.length_factor)
}

/// Whether the sizes of the parts would be more alike with the stamped lengths multiplied by a factor.
fn speaks_for(factor: f64, parts: PerRole<&LoadedPart>) -> bool {
    let size = |part: &LoadedPart| part.surface.measures().diagonal;
    let ratio = size(parts.crash) / size(parts.stamped);
    let off = |from: f64| (ratio / from).ln().abs();
    off(factor) < off(1.0)
}

/// The unit of lengths after a factor was applied.
fn after_factor(known: KnownUnits, factor: f64) -> Option<LengthUnit> {
    known.units.length.times(1.0 / factor)
}

/// A file's own units where the user set them or they agree with the unit of all lengths, else those that follow.
fn agreed(
    part: Option<&LoadedPart>,
    known: Option<KnownUnits>,
    lengths: Option<LengthUnit>,
) -> Option<KnownUnits> {
    let factor = part?.settings.length_factor;
    let Some(lengths) = lengths else {
        return known;
    };
    let stands = |known: &KnownUnits| {
        known.origin == UnitOrigin::User || after_factor(*known, factor) == Some(lengths)
    };
    known.filter(stands).or_else(|| {
        Some(KnownUnits {
            units: lengths.times(factor)?.into(),
            origin: UnitOrigin::OtherPart,
        })
    })
}

/// Says that a pose of this scale changes no thickness.
pub fn scaled_pose(part: &LoadedPart, scale: f64) -> Option<String> {
    let is_rounding = (scale - 1.0).abs() <= 1e-6;
    let unit = guess_unit(scale).map_or_else(String::new, |unit| {
        let factor = exact(unit.factor() * part.settings.length_factor);
        format!("; --stamped-length-factor {factor} converts the file with its thicknesses instead")
    });
    (!is_rounding).then(|| {
        format!(
            "{}: the pose scales the part by {}, and no thickness{unit}",
            part.file_name(),
            exact(scale)
        )
    })
}
