//! Parts, shell sections and `*CONTROL_SHELL`: titles, thickness, formulation, layers.

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::super::model::{Plies, Section, ShellControl, ShellFormulation};
use super::super::text;
use super::block::{Block, Cards};
use super::card::{Card, EIGHT_BY_10, FieldError};
use super::nodes::shifted;
use super::shells::not_negative;

/// What an include adds to the ids on part and section cards, and the factor on lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PartOffsets {
    pub part: i64,
    pub section: i64,
    pub material: i64,
    pub length: f64,
}

/// A part as its cards have it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RawPart {
    pub id: u64,
    /// The title, byte by byte.
    pub title: Vec<u8>,
    pub section_id: u64,
    pub material_id: u64,
    /// The text that stands in place of the part's id, which is 0 then.
    pub label: Option<String>,
    /// The text that stands in place of the section's id, which is 0 then.
    pub section_label: Option<String>,
    /// Those of `*PART_COMPOSITE`.
    pub plies: Option<Plies>,
    /// Byte offset of its card.
    pub at: usize,
}

impl RawPart {
    /// Sum of the plies, at each corner.
    pub(crate) fn thickness(&self) -> Option<[f64; 4]> {
        let plies = self.plies.as_ref()?;
        Some([plies.thickness.iter().sum(); 4])
    }
}

/// Keywords that begin like a part's but define none.
const NOT_PARTS: &[&str] = &[
    "MOVE",
    "MODES",
    "SENSOR",
    "DUPLICATE",
    "ANNEAL",
    "STACKED",
    "ADAPTIVE",
];

/// Reads `*PART` with its options or `*PART_COMPOSITE`; nothing for keywords that define no parts.
pub(crate) fn read_parts(
    block: &Block<'_>,
    offsets: &PartOffsets,
    found: &mut Diagnostics,
) -> Vec<RawPart> {
    let mut options = block.name.split('_').skip(1);
    if options.any(|option| NOT_PARTS.contains(&option)) {
        return Vec::new();
    }
    let mut parts = Vec::new();
    let mut cards = block.cards();
    while let Some(heading) = cards.next() {
        if heading.is_blank() && !is_heading(cards.clone()) {
            continue;
        }
        let Some(card) = cards.next() else {
            found.push_with(DiagnosticKind::MissingCard, || {
                let message = "the last part has a heading but no card";
                block
                    .diagnose(DiagnosticKind::MissingCard, message)
                    .at(heading.position(0))
            });
            break;
        };
        match part(block, &heading, &card, &mut cards, offsets) {
            Ok(part) => {
                if let Some(plies) = &part.plies {
                    let thickness = plies.thickness.iter().sum();
                    let what = format!("part {}", part.id);
                    tell_nodes_off(&card, plies.nloc, thickness, &what, found);
                }
                parts.push(part);
            }
            Err(error) => {
                let what = format!("part {:?}", text::shown(heading.title()));
                found.push_with(error.kind, || card.diagnose(&error, &what));
            }
        }
    }
    parts
}

/// True if a blank line before these cards is the empty title of a part, and not one of those
/// that stand between parts or at a block's end.
fn is_heading(mut rest: Cards<'_>) -> bool {
    let has_id =
        |card: Option<Card<'_>>| card.is_some_and(|card| card.required_id(EIGHT_BY_10, 0).is_ok());
    let Some(next) = rest.next().filter(|card| !card.is_blank()) else {
        return false;
    };
    // A text before a line with an id is the title of the part below.
    has_id(Some(next)) || !has_id(rest.next())
}

fn part(
    block: &Block<'_>,
    heading: &Card<'_>,
    card: &Card<'_>,
    cards: &mut Cards<'_>,
    offsets: &PartOffsets,
) -> Result<RawPart, FieldError> {
    let composite = block.has_option("COMPOSITE");
    let id = card.required_id(EIGHT_BY_10, 0);
    let section = if composite {
        Ok(0)
    } else {
        card.id(EIGHT_BY_10, 1)
    };
    let material = if composite {
        0
    } else {
        card.id(EIGHT_BY_10, 2).unwrap_or(0)
    };
    // The other cards are passed over even if this one is no good.
    let plies = if composite {
        Some(Plies {
            thickness: read_plies(block, cards, offsets.length),
            elform: card.int_or_zero(EIGHT_BY_10, 1).unwrap_or(0),
            nloc: card.real_or_zero(EIGHT_BY_10, 3).unwrap_or(0.0),
        })
    } else {
        pass_over_options(block, cards);
        None
    };
    let (id, label) = or_label(id)?;
    let (section, section_label) = or_label(section)?;
    Ok(RawPart {
        id: shifted(id, offsets.part),
        title: heading.title().to_owned(),
        section_id: shifted(section, offsets.section),
        material_id: shifted(material, offsets.material),
        label,
        section_label,
        plies: plies.filter(|plies| !plies.thickness.is_empty()),
        at: card.offset(),
    })
}

/// An id, or 0 and the text that newer decks may have in its place.
fn or_label(id: Result<u64, FieldError>) -> Result<(u64, Option<String>), FieldError> {
    let is_text = |error: &FieldError| {
        error.kind == DiagnosticKind::BadField
            && error.found.starts_with(|c: char| c.is_ascii_alphabetic())
    };
    match id {
        Ok(id) => Ok((id, None)),
        Err(error) if is_text(&error) => Ok((0, Some(error.found))),
        Err(error) => Err(error),
    }
}

/// Passes over the cards that the options of `*PART` bring, in the order of the manual.
fn pass_over_options(block: &Block<'_>, cards: &mut Cards<'_>) {
    if block.has_option("INERTIA") {
        let first = cards.next();
        let own_axes = first.is_some_and(|card| card.int(EIGHT_BY_10, 4) == Ok(Some(1)));
        for _ in 0..2 + usize::from(own_axes) {
            cards.next_line();
        }
    }
    for option in ["REPOSITION", "CONTACT", "PRINT", "ATTACHMENT", "FIELD"] {
        if block.has_option(option) {
            cards.next_line();
        }
    }
}

/// Thickness of the plies that follow, without those that have none; the heading of the next part ends them.
fn read_plies(block: &Block<'_>, cards: &mut Cards<'_>, length: f64) -> Vec<f64> {
    if block.has_option("CONTACT") {
        cards.next_line();
    }
    let one_ply_a_card = block.has_option("LONG");
    let mut thickness = Vec::new();
    loop {
        let before = cards.clone();
        let Some(card) = cards.next() else { break };
        let Some((first, second)) = plies(&card) else {
            *cards = before;
            break;
        };
        let of_card = [first, if one_ply_a_card { 0.0 } else { second }];
        thickness.extend(of_card.into_iter().filter(|&t| t > 0.0).map(|t| t * length));
    }
    thickness
}

/// The two ply thicknesses on a card: all of its filled fields are numbers and the first is an id.
fn plies(card: &Card<'_>) -> Option<(f64, f64)> {
    let mut values = [None; 8];
    for (i, value) in values.iter_mut().enumerate() {
        *value = card.length(EIGHT_BY_10, i).ok()?;
    }
    card.required_id(EIGHT_BY_10, 0).ok()?;
    values[1]?;
    Some((values[1].unwrap_or(0.0), values[5].unwrap_or(0.0)))
}

/// Reads `*SECTION_SHELL` with its options, each section with the byte offset of its card. Sections are repeated
/// below one keyword.
pub(crate) fn read_shell_sections(
    block: &Block<'_>,
    offsets: &PartOffsets,
    found: &mut Diagnostics,
) -> Vec<(Section, usize)> {
    let mut sections = Vec::new();
    let mut cards = block.cards();
    loop {
        if block.has_option("TITLE") {
            cards.next_line();
        }
        let Some(first) = cards.next() else { break };
        let second = cards.next();
        if first.is_blank() && second.as_ref().is_none_or(Card::is_blank) {
            break;
        }
        let Some(second) = second else {
            found.push_with(DiagnosticKind::MissingCard, || {
                let message = "the last section has no card with thicknesses";
                block
                    .diagnose(DiagnosticKind::MissingCard, message)
                    .at(first.position(0))
            });
            break;
        };
        match section(&first, &second, offsets) {
            Ok(section) => {
                let [a, b, c, d] = section.thickness;
                let what = format!("section {}", section.id);
                tell_nodes_off(&second, section.nloc, (a + b + c + d) / 4.0, &what, found);
                sections.push((section, first.offset()));
            }
            Err((card, error)) => {
                found.push_with(error.kind, || card.diagnose(&error, "the shell section"));
            }
        }
        pass_over_section_cards(block, &first, &mut cards);
    }
    sections
}

fn section<'a, 'b>(
    first: &'a Card<'b>,
    second: &'a Card<'b>,
    offsets: &PartOffsets,
) -> Result<Section, (&'a Card<'b>, FieldError)> {
    let id = first.required_id(EIGHT_BY_10, 0).map_err(|e| (first, e))?;
    let mut thickness = [0.0; 4];
    for i in 0..4 {
        let value = not_negative(second, EIGHT_BY_10, i).map_err(|e| (second, e))?;
        // Blank corners take the first one's thickness.
        let value = value.filter(|&t| t != 0.0).map(|t| t * offsets.length);
        thickness[i] = value.unwrap_or(thickness[0]);
    }
    let number = |index| first.real_or_zero(EIGHT_BY_10, index).unwrap_or(0.0);
    let elform = first.int_or_zero(EIGHT_BY_10, 1).unwrap_or(0);
    Ok(Section {
        id: shifted(id, offsets.section),
        thickness,
        nloc: second.real_or_zero(EIGHT_BY_10, 4).unwrap_or(0.0),
        formulation: ShellFormulation::new(elform, number(3), number(5)),
    })
}

/// Says how far the nodes lie off the mid-surface, if they do.
fn tell_nodes_off(card: &Card<'_>, nloc: f64, thickness: f64, what: &str, found: &mut Diagnostics) {
    if nloc == 0.0 {
        return;
    }
    let kind = DiagnosticKind::OffMidSurface;
    found.push_with(kind, || {
        // Without digits that come from rounding.
        let off = (nloc.abs() * thickness / 2.0) as f32;
        let message = format!(
            "the nodes of shells of {what} lie {off} off their mid-surface (NLOC {nloc}) and are taken to lie in it"
        );
        Diagnostic::new(kind, message).at(card.position(0))
    });
}

/// Reads `*CONTROL_SHELL`; fields that cannot be read and cards that are missing keep what was there.
pub(crate) fn read_shell_control(block: &Block<'_>, control: &mut ShellControl) {
    let cards: Vec<Card<'_>> = block.cards().take(5).collect();
    let int = |card: usize, field| {
        let card = cards.get(card)?;
        card.int(EIGHT_BY_10, field).ok().flatten()
    };
    if let Some(theory) = int(0, 4) {
        control.elform = theory;
    }
    if let Some(rule) = int(1, 1) {
        control.is_lobatto = rule == 1;
    }
    if let Some(set) = int(4, 1) {
        control.element_axes_set = set.unsigned_abs();
    }
}

/// Passes over angle cards, the cards of options and those of user-defined shells.
fn pass_over_section_cards(block: &Block<'_>, first: &Card<'_>, cards: &mut Cards<'_>) {
    let int = |index| first.int_or_zero(EIGHT_BY_10, index).unwrap_or(0);
    if int(6) == 1 {
        let n_points = match int(3).unsigned_abs() as usize {
            0 => 2,
            n => n.min(10_000),
        };
        for _ in 0..n_points.div_ceil(8) {
            cards.next_line();
        }
    }
    for option in ["EFG", "THERMAL", "XFEM", "MISC"] {
        if block.has_option(option) {
            cards.next_line();
        }
    }
    if (101..=105).contains(&int(1)) {
        pass_over_user_cards(cards);
    }
}

/// User shells: a card NIPP, NXDOF, IUNF, IHGF, ITAJ, LMC, NHSV, ILOC; then NIPP integration
/// points (five fields), then LMC parameters, eight a card.
fn pass_over_user_cards(cards: &mut Cards<'_>) {
    let Some(card) = cards.next() else { return };
    let count = |index| {
        card.int_or_zero(EIGHT_BY_10, index)
            .unwrap_or(0)
            .clamp(0, 1000) as usize
    };
    for _ in 0..count(0) + count(5).div_ceil(8) {
        cards.next_line();
    }
}
