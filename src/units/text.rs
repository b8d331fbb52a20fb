//! Units as files and people spell them.

use super::{KnownUnits, LengthUnit, UnitOrigin, UnitSystem, Units};

/// What a word of a comment is a unit of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Word {
    Length(LengthUnit),
    Mass(Mass),
    Time(Time),
    /// An inch, but more often a preposition: "units in mm".
    In,
    Other,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Mass {
    Gram,
    Kilogram,
    Ton,
    Pound,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Time {
    Second,
    Millisecond,
}

fn word(text: &str) -> Word {
    use LengthUnit as L;
    match text {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => {
            Word::Length(L::Millimeter)
        }
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => {
            Word::Length(L::Centimeter)
        }
        "m" | "mtr" | "meter" | "meters" | "metre" | "metres" => Word::Length(L::Meter),
        "in" => Word::In,
        "inch" | "inches" => Word::Length(L::Inch),
        "ft" | "foot" | "feet" => Word::Length(L::Foot),
        "g" | "gm" | "gram" | "grams" => Word::Mass(Mass::Gram),
        "kg" | "kilogram" | "kilograms" => Word::Mass(Mass::Kilogram),
        "t" | "mtrton" | "ton" | "tons" | "tonne" | "tonnes" => Word::Mass(Mass::Ton),
        "lb" | "lbf" | "lbs" | "pound" | "pounds" => Word::Mass(Mass::Pound),
        "s" | "sec" | "second" | "seconds" => Word::Time(Time::Second),
        "ms" | "msec" | "millisecond" | "milliseconds" => Word::Time(Time::Millisecond),
        _ => Word::Other,
    }
}

/// The units that a title or comment names, if it names exactly one unit of length.
///
/// Understood are what follows the word "unit" or "units" ("Unit system: mm, ms, kg"), and units of
/// length, mass and time next to each other ("ton-mm-s").
pub fn of_text(line: &str) -> Option<KnownUnits> {
    let lower = line.to_lowercase();
    let words: Vec<&str> = lower
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let is_unit = |word: &&str| matches!(*word, "unit" | "units");
    let named = words.iter().position(is_unit);
    let units = named
        .and_then(|at| units_of(words[at + 1..].iter().map(|w| word(w))))
        .or_else(|| words.windows(3).find_map(triple))?;
    let origin = UnitOrigin::Text;
    Some(KnownUnits { units, origin })
}

/// Length, mass and time next to each other, in any order.
fn triple(words: &[&str]) -> Option<Units> {
    let units = words.iter().map(|text| word(text));
    let has = |is: fn(Word) -> bool| units.clone().filter(|unit| is(*unit)).count() == 1;
    let is_whole = has(|unit| matches!(unit, Word::Length(_) | Word::In))
        && has(|unit| matches!(unit, Word::Mass(_)))
        && has(|unit| matches!(unit, Word::Time(_)));
    if is_whole { units_of(units) } else { None }
}

fn units_of(words: impl Iterator<Item = Word>) -> Option<Units> {
    let (mut length, mut mass, mut time, mut has_in) = (None, None, None, false);
    for word in words {
        match word {
            Word::Length(unit) if length.is_some_and(|known| known != unit) => return None,
            Word::Length(unit) => length = Some(unit),
            Word::Mass(unit) => mass = mass.or(Some(unit)),
            Word::Time(unit) => time = time.or(Some(unit)),
            Word::In => has_in = true,
            Word::Other => {}
        }
    }
    let is_inch = has_in && mass.is_some() && time.is_some();
    let length = length.or(is_inch.then_some(LengthUnit::Inch))?;
    let system = match (length, mass, time) {
        (LengthUnit::Meter, Some(Mass::Kilogram), Some(Time::Second)) => Some(UnitSystem::KgMS),
        (LengthUnit::Millimeter, Some(Mass::Ton), Some(Time::Second)) => Some(UnitSystem::TonMmS),
        (LengthUnit::Millimeter, Some(Mass::Kilogram), Some(Time::Millisecond)) => {
            Some(UnitSystem::KgMmMs)
        }
        (LengthUnit::Millimeter, Some(Mass::Gram), Some(Time::Millisecond)) => {
            Some(UnitSystem::GMmMs)
        }
        (LengthUnit::Inch, Some(Mass::Pound), Some(Time::Second)) => Some(UnitSystem::LbInS),
        _ => None,
    };
    Some(Units { length, system })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(line: &str) -> Option<&'static str> {
        of_text(line).map(|known| known.units.label())
    }

    #[test]
    fn comments_name_units_in_many_ways() {
        assert_eq!(label("$ Unit system: mm, ms, kg, kN"), Some("kg-mm-ms"));
        assert_eq!(label("$ UNITS = MM"), Some("mm"));
        assert_eq!(label("B-pillar (ton/mm/s)"), Some("ton-mm-s"));
        assert_eq!(label("$ kg-m-s"), Some("kg-m-s"));
        assert_eq!(label("$# length unit [inch]"), Some("in"));
        assert_eq!(
            label("units: length m, mass kg, time s, stress Pa"),
            Some("kg-m-s")
        );
        assert_eq!(label("lb_in_s"), Some("lb-in-s"));
        assert_eq!(label("All units in mm"), Some("mm"));
    }

    #[test]
    fn other_words_are_no_units() {
        assert_eq!(label("$ part in t=0.8 m position"), None);
        assert_eq!(label("$ Units: mm or m"), None);
        assert_eq!(label("$ unit cell in the foam"), None);
        assert_eq!(label("Crash model, sample part floor"), None);
        assert_eq!(
            label("$#   nid               x               y               z"),
            None
        );
    }
}
