//! Units of length, and the unit systems of LS-DYNA decks, which never state their own.
//!
//! What a file is in can only be guessed, from what it says in its comments ([`of_text`]), from its
//! materials ([`of_materials`]) or from its sizes ([`of_sizes`]), and then be set by the user.

mod guess;
mod system;
mod text;

pub use guess::{of_materials, of_sizes};
pub use system::UnitSystem;
pub use text::of_text;

use serde::{Deserialize, Serialize};

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// mm.
    Millimeter,
    /// cm.
    Centimeter,
    /// m.
    Meter,
    /// in.
    Inch,
    /// ft.
    Foot,
}

impl LengthUnit {
    /// All, in the order of menus.
    pub const ALL: [Self; 5] = [
        Self::Millimeter,
        Self::Centimeter,
        Self::Meter,
        Self::Inch,
        Self::Foot,
    ];

    /// What stands behind a number.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimeter => "mm",
            Self::Centimeter => "cm",
            Self::Meter => "m",
            Self::Inch => "in",
            Self::Foot => "ft",
        }
    }

    /// What follows a number in a text: `" mm"`.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Millimeter => " mm",
            Self::Centimeter => " cm",
            Self::Meter => " m",
            Self::Inch => " in",
            Self::Foot => " ft",
        }
    }

    /// Its name in the plural: "millimetres".
    pub fn plural(self) -> &'static str {
        match self {
            Self::Millimeter => "millimetres",
            Self::Centimeter => "centimetres",
            Self::Meter => "metres",
            Self::Inch => "inches",
            Self::Foot => "feet",
        }
    }

    /// The unit of a symbol, as on the command line.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.symbol() == symbol)
    }

    /// So many tenths of a millimetre; a whole number for each unit, so that factors are exact.
    fn tenths_of_millimeter(self) -> u32 {
        match self {
            Self::Millimeter => 10,
            Self::Centimeter => 100,
            Self::Meter => 10_000,
            Self::Inch => 254,
            Self::Foot => 3048,
        }
    }

    /// What lengths in this unit are multiplied by to be lengths in `other`; 1000 from m to mm.
    pub fn factor_to(self, other: Self) -> f64 {
        f64::from(self.tenths_of_millimeter()) / f64::from(other.tenths_of_millimeter())
    }

    /// The unit that is `factor` times this one, if there is one: m for mm and 1000.
    pub fn times(self, factor: f64) -> Option<Self> {
        let is_it = |unit: &Self| (unit.factor_to(self) / factor - 1.0).abs() < 1e-6;
        Self::ALL.into_iter().find(is_it)
    }
}

impl std::fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.symbol())
    }
}

/// The unit of length of a file, and its whole system where that is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Units {
    /// Unit of its lengths.
    pub length: LengthUnit,
    /// Units of mass and time too.
    pub system: Option<UnitSystem>,
}

impl Units {
    /// The units of a [`Units::label`].
    pub fn from_label(label: &str) -> Option<Self> {
        Self::all().find(|units| units.label() == label)
    }

    /// Every length alone, then every system.
    pub fn all() -> impl Iterator<Item = Self> {
        let lengths = LengthUnit::ALL.into_iter().map(Self::from);
        lengths.chain(UnitSystem::ALL.into_iter().map(Self::from))
    }

    /// The name of the system, or the length alone.
    pub fn label(self) -> &'static str {
        match self.system {
            Some(system) => system.label(),
            None => self.length.symbol(),
        }
    }
}

impl From<LengthUnit> for Units {
    fn from(length: LengthUnit) -> Self {
        Self {
            length,
            system: None,
        }
    }
}

impl From<UnitSystem> for Units {
    fn from(system: UnitSystem) -> Self {
        Self {
            length: system.length(),
            system: Some(system),
        }
    }
}

/// How the units of a file became known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitOrigin {
    /// The user said so.
    User,
    /// A title or comment names them.
    Text,
    /// Density and modulus are those of steel or aluminium in this system.
    Materials,
    /// Size and thickness are those of a sheet part.
    SizeAndThickness,
    /// The size is that of a part or a car; no more than that is known.
    Size,
    /// The other part's units are known, and this one's lengths are as those.
    OtherPart,
}

impl UnitOrigin {
    /// In words: "from title or comment".
    pub fn words(self) -> &'static str {
        match self {
            Self::User => "set by you",
            Self::Text => "from title or comment",
            Self::Materials => "from density and modulus",
            Self::SizeAndThickness => "guessed from size and thickness",
            Self::Size => "guessed from size",
            Self::OtherPart => "assumed from the other part",
        }
    }

    /// True unless only a size speaks for it, or nothing of its own.
    pub fn is_firm(self) -> bool {
        !matches!(self, Self::Size | Self::OtherPart)
    }
}

/// Units with where they are known from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct KnownUnits {
    /// The units found.
    pub units: Units,
    /// How they became known.
    pub origin: UnitOrigin,
}

impl KnownUnits {
    /// "mm, guessed from size and thickness".
    pub fn words(self) -> String {
        format!("{}, {}", self.units.label(), self.origin.words())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_exact_and_lead_back() {
        use LengthUnit as U;
        assert_eq!(U::Meter.factor_to(U::Millimeter), 1000.0);
        assert_eq!(U::Millimeter.factor_to(U::Meter), 0.001);
        assert_eq!(U::Inch.factor_to(U::Millimeter), 25.4);
        assert_eq!(U::Foot.factor_to(U::Millimeter), 304.8);
        assert_eq!(U::Foot.factor_to(U::Inch), 12.0);
        for a in U::ALL {
            assert_eq!(U::from_symbol(a.symbol()), Some(a));
            for b in U::ALL {
                assert_eq!(a.times(b.factor_to(a)), Some(b));
            }
        }
        assert_eq!(U::Millimeter.times(3.0), None);
    }
}
