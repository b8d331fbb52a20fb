//! Both sides of a pair, from settings to placed meshes.

use super::forming::{ShellForming, element_means, form};
use super::mesher::{self, FlatMesh};
use super::parts::Design;
use super::placement::random_placement;
use super::{SamplePart, SampleSettings, SampleVariant};
use crate::geometry::{Point3, Pose, Similarity, TriMesh, Vector3};

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
    /// Forming results of each element, in the order of `elements`; empty on the crash side.
    pub forming: Vec<ShellForming>,
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
        for forming in &mut self.forming {
            *forming = forming.transformed(target_from_source);
        }
        self.thickness *= target_from_source.scale;
        if target_from_source.is_mirrored() {
            self.reverse_corners();
        }
        self
    }

    /// Normals to the other side, where inner and outer surface change places too.
    fn flipped(mut self) -> Self {
        self.reverse_corners();
        for forming in &mut self.forming {
            forming.layers.swap(0, 1);
        }
        self
    }

    fn reverse_corners(&mut self) {
        for element in &mut self.elements {
            let [a, b, c, d] = *element;
            *element = if c == d { [a, c, b, b] } else { [a, d, c, b] };
        }
        for (forming, element) in self.forming.iter_mut().zip(&self.elements) {
            let [a, b, c, d] = forming.thickness;
            let triangle = element[2] == element[3];
            forming.thickness = if triangle { [a, c, b, b] } else { [a, d, c, b] };
        }
    }
}

/// A crash part and its stamped counterpart.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplePair {
    /// What was asked for.
    pub settings: SampleSettings,
    /// The fixed side, in vehicle axes and millimetres.
    pub crash: SampleMesh,
    /// Other parts of the crash model; none but for [`SampleVariant::WholeModel`].
    pub neighbours: Vec<SampleMesh>,
    /// The moving side, in die axes: drawing along z.
    pub stamped: SampleMesh,
    /// The true pose, which the match must find. It mirrors for [`SampleVariant::OppositeHand`],
    /// and scales where the stamped side has another unit.
    pub crash_from_stamped: Similarity,
}

/// Makes a pair. Deterministic. A floor takes about a tenth of a second.
pub fn generate(settings: &SampleSettings) -> SamplePair {
    let SampleSettings { part, variant, .. } = *settings;
    let mut design = shaped(settings);
    let placement = random_placement(settings.seed);
    let crash_from_die = Similarity::from(placement);
    let crash = crash_mesh(part, variant, &design, settings.crash_size);
    if let Some(version) = &settings.version {
        design = design.varied(version);
    }
    let stamped = stamped_mesh(part, variant, &design, settings.stamped_size);
    let (stamped, stamped_from_die) = as_stamped(stamped, variant);
    let neighbours = if variant == SampleVariant::WholeModel {
        neighbours(part, &placement)
    } else {
        Vec::new()
    };
    SamplePair {
        settings: *settings,
        crash: crash.transformed(&crash_from_die),
        neighbours,
        stamped,
        crash_from_stamped: crash_from_die.after(&stamped_from_die.inverse()),
    }
}

/// The fields of [`ShellForming`] are functions on the sheet; these are their means over the elements
/// of the stamped mesh, in its own axes and unit. In the order of its elements.
pub fn stamped_means(settings: &SampleSettings) -> Vec<ShellForming> {
    let mut design = shaped(settings);
    if let Some(version) = &settings.version {
        design = design.varied(version);
    }
    let SampleSettings { variant, .. } = *settings;
    let flat = stamped_flat(variant, &design, settings.stamped_size);
    let stamped = SampleMesh {
        forming: element_means(&design.sheet, &flat, design.thickness),
        ..lift(settings.part, &design, &flat)
    };
    as_stamped(stamped, variant).0.forming
}

/// What a perfect mapping of [`stamped_means`] gives: the means over the crash elements. In the order
/// of the crash part's elements, tensors in vehicle axes. Holds for pairs without another version.
pub fn crash_means(settings: &SampleSettings) -> Vec<ShellForming> {
    let design = shaped(settings);
    let flat = crash_flat(settings.variant, &design, settings.crash_size);
    let crash_from_die = Similarity::from(random_placement(settings.seed));
    let means = element_means(&design.sheet, &flat, design.thickness).into_iter();
    means
        .map(|shell| shell.transformed(&crash_from_die))
        .collect()
}

fn shaped(settings: &SampleSettings) -> Design {
    let design = Design::of(settings.part);
    match &settings.shape {
        Some(shape) => design.varied(shape),
        None => design,
    }
}

/// Puts a mesh from die axes into those of the stamped side; also the motion that did it.
fn as_stamped(stamped: SampleMesh, variant: SampleVariant) -> (SampleMesh, Similarity) {
    let stamped_from_die = if variant == SampleVariant::OppositeHand {
        Similarity::mirror_x()
    } else {
        Similarity::from_scale(1.0 / variant.unit())
    };
    let stamped = stamped.transformed(&stamped_from_die);
    if variant == SampleVariant::FlippedNormals {
        return (stamped.flipped(), stamped_from_die);
    }
    (stamped, stamped_from_die)
}

fn crash_mesh(
    part: SamplePart,
    variant: SampleVariant,
    design: &Design,
    size: Option<f64>,
) -> SampleMesh {
    lift(part, design, &crash_flat(variant, design, size))
}

fn crash_flat(variant: SampleVariant, design: &Design, size: Option<f64>) -> FlatMesh {
    let mut layout = design.crash;
    layout.size = size.unwrap_or(layout.size);
    mesher::mesh(&design.sheet, &design.crash_trim(variant), &layout)
}

fn stamped_mesh(
    part: SamplePart,
    variant: SampleVariant,
    design: &Design,
    size: Option<f64>,
) -> SampleMesh {
    let flat = stamped_flat(variant, design, size);
    SampleMesh {
        part_id: 1,
        forming: form(&design.sheet, &flat, design.thickness),
        ..lift(part, design, &flat)
    }
}

fn stamped_flat(variant: SampleVariant, design: &Design, size: Option<f64>) -> FlatMesh {
    let trim = design.stamped_trim(variant);
    let mut layout = design.stamped;
    layout.size = size.unwrap_or(layout.size);
    let finished = !matches!(
        variant,
        SampleVariant::Addendum | SampleVariant::AddendumAndCut | SampleVariant::MissingFlanges
    );
    match design.n_stamped_triangles {
        Some(n) if size.is_none() && finished => {
            mesher::mesh_exactly(&design.sheet, &trim, &layout, n)
        }
        _ => mesher::mesh(&design.sheet, &trim, &layout),
    }
}

/// The flat mesh on its surface, in die axes.
fn lift(part: SamplePart, design: &Design, flat: &FlatMesh) -> SampleMesh {
    SampleMesh {
        part_id: part.id(),
        title: part.title().to_owned(),
        positions: flat.nodes.iter().map(|p| design.sheet.point(p)).collect(),
        elements: flat.elements.clone(),
        thickness: design.thickness,
        forming: Vec::new(),
    }
}

/// Where a part's die axes stand in a car whose floor is at the origin.
fn station(part: SamplePart) -> Pose {
    let (offset, turn) = match part {
        SamplePart::Floor => (Vector3::zeros(), Vector3::zeros()),
        SamplePart::Rail => (Vector3::new(-80.0, 300.0, -130.0), Vector3::z() * 3.1),
        SamplePart::Pillar => (Vector3::new(260.0, 640.0, 470.0), Vector3::y() * 1.5),
        SamplePart::Fender => (Vector3::new(-1100.0, 600.0, 330.0), Vector3::x() * -0.5),
        SamplePart::Bracket => (Vector3::new(250.0, 330.0, 60.0), Vector3::z() * 0.4),
        _ => (Vector3::new(0.0, 0.0, 600.0), Vector3::zeros()),
    };
    Pose::new(offset, turn)
}

/// The other parts as they stand around `part` in the car.
fn neighbours(part: SamplePart, placement: &Pose) -> Vec<SampleMesh> {
    let crash_from_car = placement * station(part).inverse();
    SamplePart::OF_CAR
        .into_iter()
        .filter(|&other| other != part)
        .map(|other| {
            let crash_from_die = Similarity::from(crash_from_car * station(other));
            crash_mesh(other, SampleVariant::Plain, &Design::of(other), None)
                .transformed(&crash_from_die)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{BorderEdges, Topology};

    #[test]
    fn every_node_of_both_sides_lies_on_the_border_curves_or_the_surface() {
        // Nodes come from the plane, so the surface is met by construction; the border is the
        // claim: every border node must lie on a trim curve, every free one off it.
        for part in SamplePart::ALL {
            let design = Design::of(part);
            for variant in [SampleVariant::Plain, SampleVariant::Addendum] {
                let trim = design.stamped_trim(variant);
                let flat = mesher::mesh(&design.sheet, &trim, &design.stamped);
                let mesh = lift(part, &design, &flat).to_trimesh();
                let edges = BorderEdges::of(&mesh, &Topology::of(&mesh));
                let on_border: Vec<usize> = edges
                    .loops()
                    .iter()
                    .flat_map(|border| border.vertices.iter().map(|&v| v as usize))
                    .collect();
                for &v in &on_border {
                    assert!(trim.distance(&flat.nodes[v]) < 1e-9);
                }
                let near = flat.nodes.iter().filter(|p| trim.distance(p) < 1e-9);
                assert_eq!(near.count(), on_border.len(), "{part:?} {variant:?}");
            }
        }
    }
}
