//! Pairs as they come from real work, each with one kind of difference and the pose that is true, if
//! there is one.

use super::random::Random;
use super::{
    SamplePair, SamplePart, SampleSettings, SampleShape, SampleVariant, disturb, generate,
};
use crate::geometry::{Similarity, TriMesh};

/// One kind of difference between the two sides. Lengths in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scenario {
    /// Another mesh of the same surface.
    SameSurface,
    /// Nodes of the stamped side off their surface, with this deviation.
    Noise(f64),
    /// The stamped side bent and twisted by up to so much.
    Springback(f64),
    /// The stamped side lies off by this share of the thickness.
    Offset(f64),
    /// The crash side is cut to this share of its area.
    Cut(f64),
    /// Three strips of the crash side are missing.
    Strips,
    /// The crash side is in two pieces with a gap.
    TwoPieces,
    /// The crash mesh has edges of 16 to 20 mm.
    Coarse,
    /// The stamped mesh has edges of 0.5 to 1 mm, or so many triangles as that gives on a small part.
    Fine,
    /// The stamped normals point to the other side.
    FlippedNormals,
    /// Every third triangle of the stamped side is turned.
    MixedNormals,
    /// The crash side has a second sheet 2 mm over a part of it.
    DoubleSheet,
    /// The stamped side carries its addendum and lacks half of the holes.
    Addendum,
    /// The stamped side carries its addendum, and the crash side is cut off.
    AddendumAndCut,
    /// Noise, half an offset, springback of 2 mm and a cut to 70 % together.
    Mixed,
    /// The part of the car's other side.
    OtherHand,
    /// Another version: all dimensions of the stamped side changed by up to this share.
    OtherVersion(f64),
    /// Another part.
    OtherPart,
    /// The stamped side is in metres or inches.
    OtherUnit,
}

/// A pair, disturbed.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioPair {
    /// The fixed side.
    pub crash: TriMesh,
    /// The moving side.
    pub stamped: TriMesh,
    /// The pose that aligns the stamped side with the crash side; `None` where the shapes differ, so that
    /// none is true.
    pub crash_from_stamped: Option<Similarity>,
    /// How far the surfaces lie off each other at the true pose because they were disturbed: largest
    /// springback, deviation of the noise times three, offset.
    pub disturbance: f64,
    /// The offset of the stamped side along its normals, part of `disturbance`.
    pub offset: f64,
    /// Thickness of the crash sheet.
    pub thickness: f64,
}

/// Most triangles of the finest meshes.
const FINEST: f64 = 100_000.0;

impl Scenario {
    /// Every scenario, in the order of the table.
    pub const ALL: [Self; 28] = [
        Self::SameSurface,
        Self::Noise(0.1),
        Self::Noise(0.3),
        Self::Noise(1.0),
        Self::Springback(1.0),
        Self::Springback(3.0),
        Self::Springback(8.0),
        Self::Offset(0.5),
        Self::Offset(1.0),
        Self::Cut(0.6),
        Self::Cut(0.35),
        Self::Cut(0.2),
        Self::Strips,
        Self::TwoPieces,
        Self::Coarse,
        Self::Fine,
        Self::FlippedNormals,
        Self::MixedNormals,
        Self::DoubleSheet,
        Self::Addendum,
        Self::AddendumAndCut,
        Self::Mixed,
        Self::OtherHand,
        Self::OtherVersion(0.01),
        Self::OtherVersion(0.03),
        Self::OtherVersion(0.1),
        Self::OtherPart,
        Self::OtherUnit,
    ];

    /// The name in tables.
    pub fn name(self) -> String {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        match self {
            Self::SameSurface => "same surface".into(),
            Self::Noise(deviation) => format!("noise {deviation} mm"),
            Self::Springback(largest) => format!("springback {largest} mm"),
            Self::Offset(share) => format!("offset {share} x thickness"),
            Self::Cut(share) => format!("cut to {}", percent(share)),
            Self::Strips => "strips missing".into(),
            Self::TwoPieces => "two pieces".into(),
            Self::Coarse => "coarse, 16-20 mm".into(),
            Self::Fine => "fine, 0.5-1 mm".into(),
            Self::FlippedNormals => "flipped normals".into(),
            Self::MixedNormals => "mixed normals".into(),
            Self::DoubleSheet => "double sheet".into(),
            Self::Addendum => "addendum".into(),
            Self::AddendumAndCut => "both overhang".into(),
            Self::Mixed => "mixed".into(),
            Self::OtherHand => "other hand".into(),
            Self::OtherVersion(spread) => format!("other version {}", percent(spread)),
            Self::OtherPart => "other part".into(),
            Self::OtherUnit => "other unit".into(),
        }
    }

    /// Whether both sides are one part, so that a pose is true.
    pub fn is_same_part(self) -> bool {
        !matches!(
            self,
            Self::OtherHand | Self::OtherVersion(_) | Self::OtherPart | Self::OtherUnit
        )
    }

    /// Makes a pair of `part` with dimensions, placement and disturbance drawn from `seed`.
    pub fn pair(self, part: SamplePart, seed: u64) -> ScenarioPair {
        let random = &mut Random::new(seed ^ 0x0d15_7b1e);
        let settings = self.settings(part, seed, random);
        let pair = generate(&settings);
        let thickness = pair.crash.thickness;
        let mut crash = pair.crash.to_trimesh();
        let mut stamped = self.stamped(&pair, seed);
        let mut truth = self.is_same_part().then_some(pair.crash_from_stamped);
        let (mut disturbance, mut offset) = (0.0, 0.0);
        match self {
            Self::Noise(deviation) => {
                stamped = disturb::noisy(&stamped, deviation, seed);
                disturbance = 3.0 * deviation;
            }
            Self::Springback(largest) => {
                stamped = disturb::sprung(&stamped, largest, seed);
                disturbance = largest;
            }
            Self::Offset(share) => {
                offset = share * thickness * random.sign();
                stamped = disturb::offset(&stamped, offset);
                disturbance = offset.abs();
            }
            Self::Cut(share) => crash = disturb::cut(&crash, share, seed),
            Self::Strips => crash = disturb::without_strips(&crash, 3, 0.25, seed),
            Self::TwoPieces => crash = disturb::without_strips(&crash, 1, 0.06, seed),
            Self::MixedNormals => stamped = disturb::mixed_normals(&stamped, 1.0 / 3.0, seed),
            Self::DoubleSheet => {
                crash = disturb::doubled(&crash, 2.0, 0.4, seed);
                disturbance = 2.0;
            }
            Self::Mixed => {
                offset = 0.5 * thickness;
                stamped = disturb::sprung(&stamped, 2.0, seed);
                stamped = disturb::offset(&stamped, offset);
                stamped = disturb::noisy(&stamped, 0.2, seed);
                crash = disturb::cut(&crash, 0.7, seed);
                disturbance = 2.0 + offset + 0.6;
            }
            _ => {}
        }
        if self == Self::OtherPart {
            truth = None;
        }
        ScenarioPair {
            crash,
            stamped,
            crash_from_stamped: truth,
            disturbance,
            offset,
            thickness,
        }
    }

    fn settings(self, part: SamplePart, seed: u64, random: &mut Random) -> SampleSettings {
        let [crash_size, stamped_size] = usual_sizes(part);
        let variant = match self {
            Self::FlippedNormals => SampleVariant::FlippedNormals,
            Self::Addendum => SampleVariant::Addendum,
            Self::AddendumAndCut => SampleVariant::AddendumAndCut,
            Self::OtherHand => SampleVariant::OppositeHand,
            Self::OtherUnit if random.unit() < 0.5 => SampleVariant::Metres,
            Self::OtherUnit => SampleVariant::Inches,
            _ => SampleVariant::Plain,
        };
        let version = match self {
            Self::OtherVersion(spread) => Some(SampleShape {
                seed: seed ^ 0x7e57,
                spread,
            }),
            _ => None,
        };
        let crash_size = match self {
            Self::Coarse => 16.0 + 4.0 * random.unit(),
            _ => crash_size * (0.8 + 0.4 * random.unit()),
        };
        let stamped_size = match self {
            // The layout halves its cells in radii and at borders, up to twice.
            Self::Fine => (1.0 + random.unit()).max(finest_size(part)),
            _ => stamped_size * (0.8 + 0.4 * random.unit()),
        };
        SampleSettings {
            part,
            variant,
            seed,
            shape: Some(SampleShape { seed, spread: 0.1 }),
            version,
            crash_size: Some(crash_size),
            stamped_size: Some(stamped_size),
        }
    }

    /// The stamped mesh: for another part, that of the next in the list by a drawn distance.
    fn stamped(self, pair: &SamplePair, seed: u64) -> TriMesh {
        if self != Self::OtherPart {
            return pair.stamped.to_trimesh();
        }
        let all = SamplePart::ALL;
        let own = pair.settings.part as usize;
        let step = 1 + seed as usize % (all.len() - 1);
        let other = all[(own + step) % all.len()];
        let settings = SampleSettings {
            part: other,
            stamped_size: Some(usual_sizes(other)[1]),
            ..pair.settings
        };
        generate(&settings).stamped.to_trimesh()
    }
}

/// Edge lengths of the crash mesh and the stamped mesh that a part is usually meshed with; coarser than
/// production meshes where that says as much.
fn usual_sizes(part: SamplePart) -> [f64; 2] {
    match part {
        SamplePart::Floor | SamplePart::Door => [14.0, 34.0],
        SamplePart::Fender => [9.0, 16.0],
        SamplePart::Bracket | SamplePart::Plate | SamplePart::Cup => [4.5, 5.0],
        _ => [6.0, 7.0],
    }
}

/// The lattice size that gives about the most triangles that are wanted.
fn finest_size(part: SamplePart) -> f64 {
    let area: f64 = match part {
        SamplePart::Floor => 1.5e6,
        SamplePart::Door => 7.0e5,
        SamplePart::Fender => 4.5e5,
        SamplePart::Pillar => 2.8e5,
        SamplePart::Rail | SamplePart::Sill | SamplePart::Channel => 1.5e5,
        _ => 4e4,
    };
    // Finer in radii and at borders, so about four triangles for a cell.
    (4.0 * area / FINEST).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_repeat_and_have_a_pose_where_they_are_one_part() {
        for scenario in Scenario::ALL {
            let pair = scenario.pair(SamplePart::Bracket, 11);
            assert_eq!(pair, scenario.pair(SamplePart::Bracket, 11), "{scenario:?}");
            assert_eq!(pair.crash_from_stamped.is_some(), scenario.is_same_part());
            assert!(!pair.crash.is_empty() && !pair.stamped.is_empty());
        }
    }

    #[test]
    fn shapes_of_all_parts_mesh_at_any_seed() {
        for part in SamplePart::ALL {
            for seed in 0..4 {
                let pair = Scenario::SameSurface.pair(part, seed);
                let [a, b] = [&pair.crash, &pair.stamped].map(TriMesh::area);
                assert!((a / b - 1.0).abs() < 0.01, "{part:?} {seed}: {a} {b}");
            }
        }
    }
}
