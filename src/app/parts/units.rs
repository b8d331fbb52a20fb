//! The units of both files and the question where they disagree.

use super::{FileCommand, PartsState};
use crate::app::{AppState, Command, Document, Settings};
use crate::pipeline::forming_values::FormingValue;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::{PairUnits, missing_factor};
use crate::registration::guess_unit;
use crate::role::{PerRole, Role};
use crate::text::{Lengths, tidy_factor};
use crate::units::{KnownUnits, LengthUnit};

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
    fn of_sizes(crash: f64, stamped: f64) -> Option<Self> {
        let guess = guess_unit(size_ratio(crash, stamped)?)?;
        Some(Self {
            factor: guess.factor(),
            unit: None,
        })
    }

    /// What the units of two parts say where both are known, else their sizes.
    pub(in crate::app) fn of_parts(crash: &LoadedPart, stamped: &LoadedPart) -> Option<Self> {
        let firm = |known: Option<KnownUnits>| known.filter(|known| known.origin.is_firm());
        let (of_crash, of_stamped) = (crash.units(), stamped.units());
        let applied = stamped.settings.length_factor;
        if let (Some(_), Some(own)) = (firm(of_crash), firm(of_stamped)) {
            let factor = missing_factor(PerRole::new(crash, stamped))?;
            return Some(Self {
                factor,
                unit: Some(own.units.length),
            });
        }
        let size = |part: &LoadedPart| part.surface.measures().diagonal;
        let mut hint = Self::of_sizes(size(crash), size(stamped))?;
        let of_crash = of_crash.map(|known| known.units.length);
        hint.unit = of_crash.and_then(|unit| unit.times(applied * hint.factor));
        Some(hint)
    }

    /// The hint in words: "Stamped looks 1000 × smaller than crash".
    pub fn text(&self) -> String {
        format!("Stamped {}", self.words())
    }

    /// The same of a file that is named before: "looks 1000 × smaller than crash".
    pub fn words(&self) -> String {
        if self.factor >= 1.0 {
            format!("looks {} × smaller than crash", tidy_factor(self.factor))
        } else {
            let factor = tidy_factor(1.0 / self.factor);
            format!("looks {factor} × larger than crash")
        }
    }
}

fn size_ratio(crash: f64, stamped: f64) -> Option<f64> {
    let ratio = crash / stamped;
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

impl Document {
    /// What is known about the units of both files under their factors; [`AppState::units_of`] knows what is asked.
    pub fn units(&self) -> PairUnits {
        let part = |role| self.part(role).map(|part| &*part.loaded);
        PairUnits::settled(PerRole::from_fn(part))
    }

    /// The units of a further stamped file, before its factor was applied.
    pub fn further_units(&self, further: &LoadedPart) -> Option<KnownUnits> {
        let crash = self.part(Role::Crash).map(|part| &*part.loaded);
        let units = PairUnits::of(PerRole::new(crash, Some(further)));
        units.files.stamped
    }

    /// The unit of every length in the window, if it is known.
    pub fn length_unit(&self) -> Option<LengthUnit> {
        self.units().lengths
    }

    /// Unit of the stresses of a part, which stay in that of its file. What only the other file says is taken for
    /// both, as a mapping does.
    pub fn stress_unit(&self, role: Role) -> Option<&'static str> {
        let said = |role| self.part(role)?.loaded.units()?.units.system;
        let system = said(role).or_else(|| said(role.other()));
        system.map(|system| system.stress())
    }

    /// The unit a forming value of a part is shown in, with `None` of a length; `None` where it has none or it is not
    /// known.
    pub fn unit_of(&self, role: Role, value: Option<FormingValue>) -> Option<&'static str> {
        let unit = match value {
            Some(value) if value.is_stress() => self.stress_unit(role)?,
            Some(FormingValue::Thinning) => "%",
            Some(_) => return None,
            None => self.unit_suffix().trim(),
        };
        (!unit.is_empty()).then_some(unit)
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
        length_factor_of(&crash.loaded, &stamped.loaded)
    }
}

/// The factor that a stamped file's lengths need on a crash part, where the user said the file's unit.
pub(in crate::app) fn length_factor_of(crash: &LoadedPart, stamped: &LoadedPart) -> Option<f64> {
    let of_crash = crash.units()?.units.length;
    let of_stamped = stamped.settings.units?.length;
    Some(of_stamped.factor_to(of_crash))
}

impl AppState {
    /// How the window writes every length that it shows.
    pub fn lengths(&self) -> Lengths {
        self.document.lengths(self.settings.decimals)
    }

    /// How the window writes the lengths of one file alone: in the unit of all lengths, unless it is asked
    /// whether that file is in another.
    pub fn lengths_of(&self, role: Role) -> Lengths {
        let own = self.document.part(role).and_then(|part| {
            let known = self.units_of(role)?;
            known.units.length.times(1.0 / part.length_factor())
        });
        let is_asked = role == Role::Stamped && self.unit_hint().is_some();
        let unit = if is_asked {
            own
        } else {
            self.document.length_unit()
        };
        Lengths::new(unit).with_decimals(self.settings.decimals)
    }

    /// The hint about units, until it is answered.
    pub fn unit_hint(&self) -> Option<UnitHint> {
        self.parts.unit_hint(&self.document, &self.settings)
    }

    /// What makes both files agree while the hint stands: the label of its button and what it does.
    pub fn unit_remedy(&self) -> Option<(String, Vec<Command>)> {
        let hint = self.unit_hint()?;
        let factor = self.hinted_length_factor()?;
        let role = Role::Stamped;
        let (label, command) = match hint.unit {
            Some(unit) => {
                let units = Some(unit.into());
                let label = format!("Treat stamped as {unit}");
                (label, FileCommand::SetUnits { role, units })
            }
            None => {
                let label = format!("Multiply stamped lengths by {}", tidy_factor(factor));
                (label, FileCommand::SetLengthFactor { role, factor })
            }
        };
        Some((label, vec![command.into()]))
    }

    /// The units of one file. While it is asked whether the stamped file is in another unit, they
    /// are what that file says, and no guess that the question contradicts; else what was made of it.
    pub fn units_of(&self, role: Role) -> Option<KnownUnits> {
        let own = self.document.part(role)?.loaded.units();
        let Some(hint) = self.unit_hint().filter(|_| role == Role::Stamped) else {
            return *self.document.units().files.get(role);
        };
        own.filter(|known| known.origin.is_firm() || hint.unit == Some(known.units.length))
    }
}

impl PartsState {
    /// The hint about units, until it is answered.
    fn unit_hint(&self, document: &Document, settings: &Settings) -> Option<UnitHint> {
        let PerRole { crash, stamped } = document.both()?;
        if self.is_unit_question_answered(document, settings) {
            return None;
        }
        UnitHint::of_parts(&crash.loaded, &stamped.loaded)
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

    #[test]
    fn sees_metres_inches_and_nothing_where_nothing_is() {
        let factor = |crash, stamped| {
            let hint = UnitHint::of_sizes(crash, stamped)?;
            Some(hint.factor)
        };
        let hint = UnitHint::of_sizes(900.0, 1.0).unwrap();
        assert_eq!(hint.factor, 1000.0);
        assert_eq!(hint.text(), "Stamped looks 1000 × smaller than crash");
        assert_eq!(factor(1.0, 26.0), Some(1.0 / 25.4));
        for [crash, stamped] in [[1.0, 1.3], [8.6, 1.0], [1.0, 3.0], [1.0, 0.0], [0.0, 1.0]] {
            assert_eq!(factor(crash, stamped), None);
        }
    }
}
