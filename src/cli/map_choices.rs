//! The words and numbers that the options of `shapematch map` take.

use clap::ValueEnum;

use crate::formats::keyword::materials::law_of as material_law;
use crate::geometry::Similarity;
use crate::mapping::{Quantities, limits};
use crate::pipeline::map::{DefaultThickness, WriteKind};
use crate::registration::Hand;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum RuleName {
    Gauss,
    Lobatto,
    Equal,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum HandName {
    Same,
    Opposite,
    Either,
}

impl HandName {
    pub(super) fn hand(self) -> Hand {
        match self {
            Self::Same => Hand::Same,
            Self::Opposite => Hand::Mirrored,
            Self::Either => Hand::Either,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum KindName {
    Include,
    Part,
    Deck,
}

impl KindName {
    pub(super) fn kind(self) -> WriteKind {
        match self {
            Self::Include => WriteKind::Include,
            Self::Part => WriteKind::Part,
            Self::Deck => WriteKind::Deck,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum MirrorName {
    None,
    Yz,
    Zx,
    Xy,
    /// At whatever plane the match finds.
    Free,
}

impl MirrorName {
    /// The mirror at a plane through the origin; `None` where there is none to be given.
    pub(super) fn motion(self) -> Option<Similarity> {
        match self {
            Self::None | Self::Free => None,
            Self::Yz => Some(Similarity::mirror(0)),
            Self::Zx => Some(Similarity::mirror(1)),
            Self::Xy => Some(Similarity::mirror(2)),
        }
    }
}

pub(super) fn default_thickness(text: &str) -> Result<DefaultThickness, String> {
    match text {
        "section" => Ok(DefaultThickness::Section),
        "nearest" => Ok(DefaultThickness::Nearest),
        _ => match text.parse::<f64>() {
            Ok(value) if limits::POSITIVE.contains(&value) => Ok(DefaultThickness::Fixed(value)),
            _ => Err(format!(
                "{text:?} is none of section, nearest and a thickness"
            )),
        },
    }
}

/// `thickness,plastic` and the two presets, which stand for their quantities among others too.
pub(super) fn quantities(text: &str) -> Result<Quantities, String> {
    let mut chosen = Quantities::NONE;
    for word in text.split(',') {
        let name = match word.trim() {
            "plastic-strain" => "plastic",
            name => name,
        };
        let mut preset = match name {
            "usual" => Quantities::USUAL,
            "full" => Quantities::FULL,
            _ => Quantities::NONE,
        };
        let mut is_known = preset != Quantities::NONE;
        for ((known, is_on), (_, is_preset)) in chosen.named().into_iter().zip(preset.named()) {
            *is_on |= *is_preset || known == name;
            is_known |= known == name;
        }
        if !is_known {
            let names = chosen.named().map(|(name, _)| name).join(", ");
            return Err(format!("{name:?} is none of {names}, usual, full"));
        }
    }
    Ok(chosen)
}

/// A law as its number or its keyword, with or without `MAT_`.
pub(super) fn law(text: &str) -> Result<String, String> {
    let name = text.trim().to_ascii_uppercase();
    let name = name.trim_start_matches('*').trim_start_matches("MAT_");
    let name = match name.parse::<u16>() {
        Ok(number) => format!("{number:03}"),
        Err(_) => name.to_owned(),
    };
    material_law(&format!("MAT_{name}")).ok_or_else(|| format!("{text:?} is no material law"))
}
