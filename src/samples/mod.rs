//! Generated pairs of sheet parts with a known pose: a crash mesh and an independently made mesh of
//! the stamped part, both with their nodes exactly on one analytic surface.
//!
//! [`generate`] makes a [`SamplePair`] from [`SampleSettings`]; the same settings give the same pair.

mod bundle;
mod decks;
pub mod disturb;
mod floor;
mod forming;
mod hard_parts;
mod mesher;
mod pair;
mod parts;
mod path;
mod placement;
mod random;
mod scatter;
pub mod scenario;
mod sheet;
mod variation;

pub use bundle::{bundled, bundled_settings, realistic, realistic_pair};
pub use decks::{SampleFile, files, write_crash_deck, write_stamped_deck, write_truth};
pub use forming::{FormingLayer, ShellForming};
pub use pair::{SampleMesh, SamplePair, crash_means, generate, stamped_means};
pub use placement::random_placement;
pub use variation::SampleShape;

/// A part that can be generated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SamplePart {
    /// Car floor, 1.63 m diagonal, with tunnel, beads, flanges and twelve holes.
    #[default]
    Floor,
    /// Front side member, an open hat section with a kick.
    Rail,
    /// Centre pillar, a bowed hat section that flares to its foot.
    Pillar,
    /// Doubly curved outer skin with a wheel arch.
    Fender,
    /// Small bracket that a half turn almost lays on itself.
    Bracket,
    /// Closed hat profile, whose normals cancel.
    Sill,
    /// Large, gently curved outer panel with few features.
    Door,
    /// Flat plate with holes.
    Plate,
    /// Round cup with one small hole in its flange.
    Cup,
    /// U-rail with a regular row of holes.
    Channel,
    /// Cross member whose left-hand and right-hand parts differ by one hole.
    Crossmember,
}

impl SamplePart {
    /// Every sample part.
    pub const ALL: [Self; 11] = [
        Self::Floor,
        Self::Rail,
        Self::Pillar,
        Self::Fender,
        Self::Bracket,
        Self::Sill,
        Self::Door,
        Self::Plate,
        Self::Cup,
        Self::Channel,
        Self::Crossmember,
    ];

    /// Those that stand together in a whole model.
    pub(crate) const OF_CAR: [Self; 5] = [
        Self::Floor,
        Self::Rail,
        Self::Pillar,
        Self::Fender,
        Self::Bracket,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Floor => "floor",
            Self::Rail => "rail",
            Self::Pillar => "pillar",
            Self::Fender => "fender",
            Self::Bracket => "bracket",
            Self::Sill => "sill",
            Self::Door => "door",
            Self::Plate => "plate",
            Self::Cup => "cup",
            Self::Channel => "channel",
            Self::Crossmember => "crossmember",
        }
    }

    /// The part's title in a crash deck.
    pub fn title(self) -> &'static str {
        match self {
            Self::Floor => "FLOOR PAN FRONT",
            Self::Rail => "FRONT SIDE MEMBER INNER LH",
            Self::Pillar => "B-PILLAR REINFORCEMENT LH",
            Self::Fender => "FENDER OUTER LH",
            Self::Bracket => "SEAT BRACKET",
            Self::Sill => "SILL REINFORCEMENT CLOSED LH",
            Self::Door => "DOOR OUTER LH",
            Self::Plate => "MOUNTING PLATE",
            Self::Cup => "DAMPER CUP",
            Self::Channel => "SEAT RAIL",
            Self::Crossmember => "CROSS MEMBER REAR LH",
        }
    }

    /// The part of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }

    /// Part number in the crash deck.
    fn id(self) -> u64 {
        2_000_012 + 7 * self as u64
    }
}

/// What differs between the two sides besides mesh and pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SampleVariant {
    /// The same outline on both sides.
    #[default]
    Plain,
    /// The stamped side still carries its addendum and lacks half of the holes.
    Addendum,
    /// The stamped side has no flanges yet.
    MissingFlanges,
    /// The crash side is cut off.
    Cut,
    /// The crash side is cut off and the stamped side carries its addendum: both overhang.
    AddendumAndCut,
    /// The stamped side is the part of the other side of the car.
    OppositeHand,
    /// The stamped side is in metres.
    Metres,
    /// The stamped side is in inches.
    Inches,
    /// The stamped side's normals point to the other side of the sheet.
    FlippedNormals,
    /// The crash deck holds neighbouring parts too.
    WholeModel,
}

impl SampleVariant {
    /// Every variant.
    pub const ALL: [Self; 10] = [
        Self::Plain,
        Self::Addendum,
        Self::MissingFlanges,
        Self::Cut,
        Self::AddendumAndCut,
        Self::OppositeHand,
        Self::Metres,
        Self::Inches,
        Self::FlippedNormals,
        Self::WholeModel,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Addendum => "addendum",
            Self::MissingFlanges => "missing-flanges",
            Self::Cut => "cut",
            Self::AddendumAndCut => "addendum-and-cut",
            Self::OppositeHand => "opposite-hand",
            Self::Metres => "metres",
            Self::Inches => "inches",
            Self::FlippedNormals => "flipped-normals",
            Self::WholeModel => "whole-model",
        }
    }

    /// The variant of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|variant| variant.name() == name)
    }

    /// One line of help.
    pub fn help(self) -> &'static str {
        match self {
            Self::Plain => "The same outline on both sides",
            Self::Addendum => "The stamped side carries its addendum and lacks half of the holes",
            Self::MissingFlanges => "The stamped side has no flanges yet",
            Self::Cut => "The crash side is cut off",
            Self::AddendumAndCut => {
                "Addendum on the stamped side, crash side cut off: both overhang"
            }
            Self::OppositeHand => "The stamped side is the part of the car's other side",
            Self::Metres => "The stamped side is in metres",
            Self::Inches => "The stamped side is in inches",
            Self::FlippedNormals => "The stamped normals point to the other side of the sheet",
            Self::WholeModel => "The crash deck holds neighbouring parts too",
        }
    }

    /// Millimetres in the stamped side's unit of length.
    fn unit(self) -> f64 {
        match self {
            Self::Metres => 1000.0,
            Self::Inches => 25.4,
            _ => 1.0,
        }
    }
}

/// What to generate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SampleSettings {
    /// The part it is a variant of.
    pub part: SamplePart,
    /// What differs between the sides.
    pub variant: SampleVariant,
    /// Chooses the pose. The meshes do not depend on it.
    pub seed: u64,
    /// Other dimensions of the part, on both sides; its own if `None`.
    pub shape: Option<SampleShape>,
    /// Further changes of the dimensions on the stamped side only: another version of the part,
    /// for which no pose is true.
    pub version: Option<SampleShape>,
    /// Edge length of the crash mesh in millimetres; the part's own if `None`.
    pub crash_size: Option<f64>,
    /// Largest edge length of the stamped mesh in millimetres; if `None`, the part's own, which for
    /// a floor with its finished outline means exactly 34,808 triangles.
    pub stamped_size: Option<f64>,
}
