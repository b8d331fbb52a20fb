//! The element keywords: which cards each has.

use super::block::Block;

/// What is known of an element keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ElementKeyword {
    /// `*ELEMENT_SHELL…`.
    Shell(ShellCards),
    /// `*ELEMENT_SOLID…` and `*ELEMENT_TSHELL…`.
    Solid(SolidCards),
    /// An element list of a kind that has no surface, or no element list at all.
    Skipped,
    /// Has a surface, but its cards are not known.
    Unknown,
}

/// The fifth field of a shell's thickness card.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum FifthField {
    /// The material angle, with the options `THICKNESS` and `BETA`.
    #[default]
    Angle,
    /// The id of the material's coordinate system, with the option `MCID`.
    CoordinateSystem,
}

/// The cards of one shell after its first, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct ShellCards {
    /// Corner thickness and material angle.
    pub thickness: bool,
    /// What its fifth field is.
    pub fifth: FifthField,
    /// The first of the cards that are passed over is the distance of the nodes from the mid-surface.
    pub offset: bool,
    /// Cards for offset and scalar nodes, which are passed over.
    pub n_passed_over: usize,
    /// Any number of cards with plies.
    pub plies: bool,
}

/// The cards of one solid or thick shell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct SolidCards {
    /// A thick shell, always on one line.
    pub thick_shell: bool,
    /// Lines with nodes after the line with the ids; `None` if the first card tells.
    pub n_node_cards: Option<usize>,
    /// Corners among the nodes of the keyword: 8, or 4 for quadratic and cubic tetrahedra.
    pub n_corners: usize,
    /// Cards after the nodes, which are passed over.
    pub n_passed_over: usize,
    /// Any number of cards with plies.
    pub plies: bool,
}

/// Solids of higher order: option, lines with nodes, corners.
const SOLID_ORDERS: &[(&str, usize, usize)] = &[
    ("H20", 2, 8),
    ("H27", 3, 8),
    ("H64", 7, 8),
    ("T15", 2, 4),
    ("T20", 2, 4),
];

/// Options of `*ELEMENT_SOLID` that ask for other elements to be made and have no cards.
const SOLID_CONVERSIONS: &[&str] = &["TET4TOTET10", "H8TOH20", "H8TOH27", "H8TOH64"];

/// First words of the element keywords that have no surface, or none that is read.
const WITHOUT_SURFACE: &[&str] = &[
    "BEAM",
    "BEARING",
    "BLANKING",
    "DIRECT",
    "DISCRETE",
    "INERTIA",
    "INTERPOLATION",
    "LANCING",
    "MASS",
    "PLOTEL",
    "SEATBELT",
    "SPH",
    "TRIM",
];

/// What the cards of a block's keyword are.
pub(crate) fn element_keyword(block: &Block<'_>) -> ElementKeyword {
    let Some(rest) = block.name.strip_prefix("ELEMENT_") else {
        return ElementKeyword::Skipped;
    };
    let mut words = rest.split('_');
    let keyword = match words.next() {
        Some("SHELL") => shell_cards(words).map(ElementKeyword::Shell),
        Some("SOLID") => solid_cards(words).map(ElementKeyword::Solid),
        Some("TSHELL") => thick_shell_cards(words).map(ElementKeyword::Solid),
        Some(other) if WITHOUT_SURFACE.contains(&other) => Some(ElementKeyword::Skipped),
        _ => None,
    };
    keyword.unwrap_or(ElementKeyword::Unknown)
}

fn shell_cards<'a>(options: impl Iterator<Item = &'a str>) -> Option<ShellCards> {
    let mut cards = ShellCards::default();
    for option in options {
        match option {
            "THICKNESS" | "BETA" => cards.thickness = true,
            "MCID" => (cards.thickness, cards.fifth) = (true, FifthField::CoordinateSystem),
            "OFFSET" => {
                cards.offset = true;
                cards.n_passed_over += 1;
            }
            "DOF" => cards.n_passed_over += 1,
            "COMPOSITE" => cards.plies = true,
            // `COMPOSITE_LONG` has one ply a card; `SHL4_TO_SHL8` has no cards of its own.
            "LONG" | "SHL4" | "TO" | "SHL8" => {}
            _ => return None,
        }
    }
    Some(cards)
}

fn solid_cards<'a>(options: impl Iterator<Item = &'a str>) -> Option<SolidCards> {
    let mut cards = SolidCards {
        n_corners: 8,
        ..SolidCards::default()
    };
    for option in options {
        if let Some(&(_, n_cards, n_corners)) = SOLID_ORDERS.iter().find(|row| row.0 == option) {
            cards.n_node_cards = Some(n_cards);
            cards.n_corners = n_corners;
        } else if option == "ORTHO" {
            cards.n_passed_over += 2;
        } else if option == "DOF" {
            cards.n_passed_over += 1;
        } else if !SOLID_CONVERSIONS.contains(&option) {
            return None;
        }
    }
    Some(cards)
}

fn thick_shell_cards<'a>(options: impl Iterator<Item = &'a str>) -> Option<SolidCards> {
    let mut cards = SolidCards {
        thick_shell: true,
        n_corners: 8,
        ..SolidCards::default()
    };
    for option in options {
        match option {
            "BETA" => cards.n_passed_over += 1,
            "COMPOSITE" => cards.plies = true,
            _ => return None,
        }
    }
    Some(cards)
}
