//! What a deck says about its units: in comments, in its title, in `*CONTROL_UNITS`, and by its
//! materials.

use super::super::text;
use super::block::{Block, next_line};
use super::card::EIGHT_BY_10;
use super::include::Context;
use super::source_file::SourceFile;
use crate::units::{self, KnownUnits};

/// Comments further down a file are not about the file.
const HEAD: usize = 1 << 16;

/// What was found so far.
#[derive(Debug, Clone, Default)]
pub(super) struct UnitClues {
    stated: Option<KnownUnits>,
    /// Density and modulus of each material.
    materials: Vec<[f64; 2]>,
}

impl UnitClues {
    /// Reads the comments at the head of a file.
    pub(super) fn read_head(&mut self, file: &SourceFile) {
        let bytes = file.bytes();
        let end = bytes.len().min(HEAD);
        let mut next = 0;
        while self.stated.is_none()
            && let Some((line, _, after)) = next_line(bytes, next, end)
        {
            next = after;
            if line.first() == Some(&b'$') {
                self.read_text(&text::decoded(line));
            }
        }
    }

    /// Reads a title or comment; the first that names units counts.
    pub(super) fn read_text(&mut self, text: &str) {
        self.stated = self.stated.or_else(|| units::of_text(text));
    }

    /// Reads a `*CONTROL_UNITS` block.
    pub(super) fn read_control(&mut self, block: &Block<'_>) {
        let card = block.cards().next().map(|card| card.line_text());
        self.read_text(&format!("units {}", card.unwrap_or_default()));
    }

    /// Reads a `*MAT_…` block, whose numbers the include that it stands in may convert.
    pub(super) fn read_material(&mut self, block: &Block<'_>, context: &Context) {
        if block.name.starts_with("MAT_ADD") {
            return;
        }
        let mut cards = block.cards();
        if block.has_option("TITLE") {
            cards.next();
        }
        let Some(card) = cards.next() else { return };
        let field = |index| card.real(EIGHT_BY_10, index).ok().flatten();
        let found = field(1).zip(field(2));
        let converted = found.map(|(density, e)| [density * context.density, e * context.stress]);
        self.materials.extend(converted);
    }

    /// What all of it comes to.
    pub(super) fn units(&self) -> Option<KnownUnits> {
        self.stated.or_else(|| units::of_materials(&self.materials))
    }

    /// The units that a comment names and those of the materials, in words, where they are not the same.
    pub(super) fn contradiction(&self) -> Option<String> {
        let stated = self.stated?;
        let found = units::of_materials(&self.materials)?;
        let is_same = match stated.units.system {
            Some(_) => stated.units == found.units,
            None => stated.units.length == found.units.length,
        };
        (!is_same).then(|| {
            format!(
                "a title or comment names {}, density and modulus of the materials are those of {}; the first is \
                believed",
                stated.units.label(),
                found.units.label()
            )
        })
    }
}
