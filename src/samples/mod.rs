//! Generated pairs of sheet parts with a known pose: a crash mesh and an independently made mesh of
//! the stamped part, both with their nodes exactly on one analytic surface.
//!
//! [`generate`] makes a [`SamplePair`] from [`SampleSettings`]; the same settings give the same pair.

mod mesher;
mod parts;
mod path;
mod placement;
mod scatter;
mod sheet;

pub use placement::random_placement;

use crate::geometry::{Point3, Similarity, TriMesh};
use mesher::FlatMesh;
use parts::Design;
use sheet::Sheet;

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
}

impl SamplePart {
    /// All parts.
    pub const ALL: [Self; 5] = [
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
    /// All variants.
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
    /// Which part.
    pub part: SamplePart,
    /// What differs between the sides.
    pub variant: SampleVariant,
    /// Chooses the pose. The meshes do not depend on it.
    pub seed: u64,
    /// Edge length of the crash mesh in millimetres; the part's own if `None`.
    pub crash_size: Option<f64>,
    /// Largest edge length of the stamped mesh in millimetres; if `None`, the part's own, which for
    /// a floor with its finished outline means exactly 34,808 triangles.
    pub stamped_size: Option<f64>,
}

/// A shell mesh of one part.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleMesh {
    /// Part number in a deck.
    pub part_id: u64,
    /// Part title in a deck.
    pub title: String,
    /// Node positions.
    pub positions: Vec<Point3>,
    /// Quadrilaterals; a triangle repeats its last node.
    pub elements: Vec<[u32; 4]>,
    /// Sheet thickness before forming.
    pub thickness: f64,
}

impl SampleMesh {
    /// Triangles, each quadrilateral split along its first diagonal.
    pub fn to_trimesh(&self) -> TriMesh {
        let mut triangles = Vec::with_capacity(2 * self.elements.len());
        for &[a, b, c, d] in &self.elements {
            triangles.push([a, b, c]);
            if c != d {
                triangles.push([a, c, d]);
            }
        }
        TriMesh::new(self.positions.clone(), triangles)
            .expect("the mesher's indices are in range and its nodes are finite")
    }

    fn transformed(mut self, target_from_source: &Similarity) -> Self {
        for position in &mut self.positions {
            *position = target_from_source.apply(position);
        }
        self.thickness *= target_from_source.scale;
        if target_from_source.is_mirrored() {
            self = self.flipped();
        }
        self
    }

    fn flipped(mut self) -> Self {
        for element in &mut self.elements {
            let [a, b, c, d] = *element;
            *element = if c == d { [a, c, b, b] } else { [a, d, c, b] };
        }
        self
    }
}

/// A crash part and its stamped counterpart.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplePair {
    /// What was asked for.
    pub settings: SampleSettings,
    /// The fixed side, in vehicle axes and millimetres.
    pub crash: SampleMesh,
    /// The moving side, in die axes: drawing along z.
    pub stamped: SampleMesh,
    /// The true pose, which the match must find.
    pub crash_from_stamped: Similarity,
}

/// Makes a pair. Deterministic. A floor takes about a tenth of a second.
pub fn generate(settings: &SampleSettings) -> SamplePair {
    let SampleSettings { part, variant, .. } = *settings;
    let design = Design::of(part);
    let crash_from_die = Similarity::from(random_placement(settings.seed));
    let crash = crash_mesh(part, variant, &design, settings.crash_size);
    let stamped = stamped_mesh(part, variant, &design, settings.stamped_size);
    let mut stamped_from_die = Similarity::from_scale(1.0 / variant.unit());
    if variant == SampleVariant::OppositeHand {
        stamped_from_die = Similarity::mirror_x();
    }
    let mut stamped = stamped.transformed(&stamped_from_die);
    if variant == SampleVariant::FlippedNormals {
        stamped = stamped.flipped();
    }
    SamplePair {
        settings: *settings,
        crash: crash.transformed(&crash_from_die),
        stamped,
        crash_from_stamped: crash_from_die.after(&stamped_from_die.inverse()),
    }
}

fn crash_mesh(
    part: SamplePart,
    variant: SampleVariant,
    design: &Design,
    size: Option<f64>,
) -> SampleMesh {
    let mut layout = design.crash;
    layout.size = size.unwrap_or(layout.size);
    let flat = mesher::mesh(&design.sheet, &design.crash_trim(variant), &layout);
    lift(part, design, &flat)
}

fn stamped_mesh(
    part: SamplePart,
    variant: SampleVariant,
    design: &Design,
    size: Option<f64>,
) -> SampleMesh {
    let trim = design.stamped_trim(variant);
    let mut layout = design.stamped;
    layout.size = size.unwrap_or(layout.size);
    let finished = !matches!(
        variant,
        SampleVariant::Addendum | SampleVariant::AddendumAndCut | SampleVariant::MissingFlanges
    );
    let flat = match design.n_stamped_triangles {
        Some(n) if size.is_none() && finished => {
            mesher::mesh_exactly(&design.sheet, &trim, &layout, n)
        }
        _ => mesher::mesh(&design.sheet, &trim, &layout),
    };
    SampleMesh {
        part_id: 1,
        ..lift(part, design, &flat)
    }
}

/// The flat mesh on its surface, in die axes.
fn lift(part: SamplePart, design: &Design, flat: &FlatMesh) -> SampleMesh {
    let sheet: &Sheet = &design.sheet;
    SampleMesh {
        part_id: part.id(),
        title: part.title().to_owned(),
        positions: flat.nodes.iter().map(|p| sheet.point(p)).collect(),
        elements: flat.elements.clone(),
        thickness: design.thickness,
    }
}
