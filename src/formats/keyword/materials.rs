//! Materials: what law each has, so that history variables go to their own kind alone.

use super::super::model::Material;
use super::block::Block;
use super::card::EIGHT_BY_10;
use super::include::Context;
use super::nodes::shifted;

/// Laws of sheet metal with their numbers, which may stand in place of the name.
const NUMBERS: &[(&str, u32)] = &[
    ("ELASTIC", 1),
    ("PLASTIC_KINEMATIC", 3),
    ("JOHNSON_COOK", 15),
    ("POWER_LAW_PLASTICITY", 18),
    ("RIGID", 20),
    ("PIECEWISE_LINEAR_PLASTICITY", 24),
    ("BARLAT_ANISOTROPIC_PLASTICITY", 33),
    ("3-PARAMETER_BARLAT", 36),
    ("TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC", 37),
    ("FLD_TRANSVERSELY_ANISOTROPIC", 39),
    ("RATE_SENSITIVE_POWERLAW_PLASTICITY", 64),
    ("PLASTICITY_WITH_DAMAGE", 81),
    ("SIMPLIFIED_JOHNSON_COOK", 98),
    ("ANISOTROPIC_VISCOPLASTIC", 103),
    ("MODIFIED_JOHNSON_COOK", 107),
    ("TRIP", 113),
    ("GURSON", 120),
    ("HILL_3R", 122),
    ("MODIFIED_PIECEWISE_LINEAR_PLASTICITY", 123),
    ("KINEMATIC_HARDENING_TRANSVERSELY_ANISOTROPIC", 125),
    ("BARLAT_YLD2000", 133),
    ("WTM_STM", 135),
    ("CORUS_VEGTER", 136),
    ("SAMP-1", 187),
    ("TABULATED_JOHNSON_COOK", 224),
    ("KINEMATIC_HARDENING_BARLAT89", 226),
    ("KINEMATIC_HARDENING_BARLAT2000", 242),
    ("HILL_90", 243),
    ("UHS_STEEL", 244),
];

/// Options that leave the law what it is.
const OPTIONS: &[&str] = &["_TITLE", "_LOG_INTERPOLATION", "_STOCHASTIC", "_MIDFAIL"];

/// Reads the first card of a `*MAT_…` block; `None` for keywords that are no material of their own
/// and for a card without an id. The modulus is in the units of the deck that includes the file.
pub(crate) fn read_material(block: &Block<'_>, context: &Context) -> Option<Material> {
    let law = law_of(&block.name)?;
    let mut cards = block.cards();
    if block.has_option("TITLE") {
        cards.next_line();
    }
    let card = cards.next()?;
    let real = |index| card.real(EIGHT_BY_10, index).ok().flatten().unwrap_or(0.0);
    Some(Material {
        id: shifted(
            card.required_id(EIGHT_BY_10, 0).ok()?,
            context.offsets.material,
        ),
        law,
        density: real(1) * context.density,
        modulus: real(2) * context.stress,
    })
}

/// The keyword of a law as [`law_of`] names it, without `*`.
pub(super) fn keyword_of(law: &str) -> String {
    let n_digits = law.bytes().take_while(u8::is_ascii_digit).count();
    let (digits, rest) = law.split_at(n_digits);
    let numbered = format!("MAT_{digits:0>3}{rest}");
    if law_of(&numbered).as_deref() == Some(law) {
        numbered
    } else {
        format!("MAT_{law}")
    }
}

/// The law that a keyword (`MAT_…`) names; `None` for one that is no material of its own.
pub fn law_of(keyword: &str) -> Option<String> {
    let mut name = keyword.strip_prefix("MAT_")?;
    if name.starts_with("ADD_") || name.starts_with("THERMAL_") {
        return None;
    }
    while let Some(shorter) = OPTIONS.iter().find_map(|option| name.strip_suffix(option)) {
        name = shorter;
    }
    let digits = name.bytes().take_while(u8::is_ascii_digit).count();
    let is_number = digits == 3 && !name[digits..].starts_with('-');
    Some(match NUMBERS.iter().find(|(known, _)| *known == name) {
        Some((_, number)) => number.to_string(),
        // "MAT_036E" is another law than 36.
        None if is_number => name.trim_start_matches('0').to_owned(),
        None => name.to_owned(),
    })
}

/// True for a law of sheet metal, as [`law_of`] names it.
pub fn is_known_law(law: &str) -> bool {
    let is_number = |(_, number): &(&str, u32)| number.to_string() == law;
    NUMBERS.iter().any(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_names_are_one_law() {
        let law = |keyword: &str| law_of(keyword).unwrap_or_default();
        assert_eq!(law("MAT_024"), "24");
        assert_eq!(law("MAT_PIECEWISE_LINEAR_PLASTICITY_TITLE"), "24");
        assert_eq!(
            law("MAT_PIECEWISE_LINEAR_PLASTICITY_LOG_INTERPOLATION"),
            "24"
        );
        assert_eq!(law("MAT_3-PARAMETER_BARLAT"), "36");
        assert_eq!(law("MAT_036E_TITLE"), "36E");
        assert_eq!(law("MAT_PLASTICITY_WITH_DAMAGE"), "81");
        assert_eq!(
            law("MAT_PLASTICITY_WITH_DAMAGE_ORTHO"),
            "PLASTICITY_WITH_DAMAGE_ORTHO"
        );
        assert_eq!(law_of("MAT_ADD_EROSION"), None);
        assert_eq!(keyword_of("24"), "MAT_024");
        for law in [
            "24",
            "36",
            "36E",
            "224",
            "3D_LAW",
            "PLASTICITY_WITH_DAMAGE_ORTHO",
            "SPOTWELD",
        ] {
            assert_eq!(law_of(&keyword_of(law)).as_deref(), Some(law));
        }
        assert_eq!(law_of("MATERIAL"), None);
    }
}
