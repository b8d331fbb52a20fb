//! The crash part as the mapping sees it, and what it gets.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::history::MappedHistory;
use super::layered::PLASTIC_STRAIN;
use super::options::Status;
use super::rule::LayerRule;
use super::shells::ShellMesh;

/// Elements whose values one thread puts together at a time.
const PIECE: usize = 4096;

/// A crash part: its shells and the layers its elements want.
#[derive(Debug, Clone)]
pub struct TargetPart {
    /// The shells, in the frame the pose leads to.
    pub mesh: ShellMesh,
    /// The different rules through the thickness.
    pub rules: Vec<LayerRule>,
    /// For each element its rule.
    pub rule_of: Vec<u16>,
    /// For each element its points in the plane: 1 or 4. Triangles always have 1.
    pub n_plane: Vec<u8>,
    /// For each element the thickness of its section; NaN where there is none.
    pub nominal_thickness: Vec<f64>,
    /// Material law of the parts (as [`ShellMesh::parts`] numbers them) whose law is known.
    pub laws: BTreeMap<u32, String>,
}

impl TargetPart {
    /// A part whose elements all have one rule and one point in the plane.
    pub fn uniform(mesh: ShellMesh, rule: LayerRule, nominal_thickness: f64) -> Self {
        let n = mesh.len();
        Self {
            mesh,
            rules: vec![rule],
            rule_of: vec![0; n],
            n_plane: vec![1; n],
            nominal_thickness: vec![nominal_thickness; n],
            laws: BTreeMap::new(),
        }
    }

    /// Points in the plane of an element's layers.
    pub(super) fn planes(&self, element: usize) -> usize {
        if self.n_plane[element] == 4 && !self.mesh.is_triangle(element) {
            4
        } else {
            1
        }
    }
}

/// Which side of the target the normals of a source point to, and with it which source elements may be
/// partners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// That of the target's normals.
    Same,
    /// The other one: all layers are taken from the other end.
    Opposite,
    /// Now this one, now that one: each pair of elements decides for itself.
    Mixed,
}

impl Facing {
    /// True if an element may be a partner, given whether its normal points to the opposite side.
    pub(super) fn takes(self, is_flipped: bool) -> bool {
        match self {
            Self::Same => !is_flipped,
            Self::Opposite => is_flipped,
            Self::Mixed => true,
        }
    }

    /// What it is for an element whose own normal points to the other side than those around it.
    pub(super) fn turned_over(self) -> Self {
        match self {
            Self::Same => Self::Opposite,
            Self::Opposite => Self::Same,
            Self::Mixed => Self::Mixed,
        }
    }

    /// The cosine between the target's normal and a source's, `cos` from corner orders, as it counts.
    pub(super) fn cosine(self, cos: f64) -> f64 {
        match self {
            Self::Same => cos,
            Self::Opposite => -cos,
            Self::Mixed => cos.abs(),
        }
    }
}

/// The source element nearest to the centre of a target element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Partner {
    /// Which of the stamped parts.
    pub source: u32,
    /// Number of the element the point lies on.
    pub element: u32,
    /// The normals point to opposite sides, so layers are taken from the other end.
    pub is_flipped: bool,
    /// Both elements are the same, so values were copied and not averaged.
    pub is_copy: bool,
}

/// How one target element found its values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementReport {
    /// What became of it.
    pub status: Status,
    /// Signed distance of the sheet from the element's centre along the element's normal: of the centre's partner, or
    /// where the centre has none, of the largest group of partners that the other points have.
    pub normal_distance: f64,
    /// Distance of the same place across the normal.
    pub tangential_distance: f64,
    /// Angle between the normals there, degrees; NaN without partner.
    pub angle_deg: f64,
    /// Share of the element's area that has partners, 0 to 1.
    pub coverage: f64,
    /// Ranking from 0 (doubtful) to 1: coverage, distance, angle and a second sheet near by.
    pub confidence: f64,
    /// Where the values come from.
    pub partner: Option<Partner>,
}

/// Layer values of the target elements that have any, `N` numbers at each point.
#[derive(Debug, Clone, PartialEq)]
pub struct MappedLayers<const N: usize> {
    /// For each element where its values begin; one entry more than elements.
    starts: Vec<u32>,
    values: Vec<[f64; N]>,
}

impl<const N: usize> Default for MappedLayers<N> {
    fn default() -> Self {
        Self {
            starts: vec![0],
            values: Vec::new(),
        }
    }
}

impl<const N: usize> MappedLayers<N> {
    /// The values of elements, in their order, put together on all threads.
    pub(super) fn of_elements<'a>(elements: impl Iterator<Item = &'a [[f64; N]]>) -> Self {
        let elements: Vec<&[[f64; N]]> = elements.collect();
        let mut starts = Vec::with_capacity(elements.len() + 1);
        starts.push(0);
        let mut n_values = 0;
        starts.extend(elements.iter().map(|of_element| {
            n_values += of_element.len() as u32;
            n_values
        }));
        let mut values = vec![[0.0; N]; n_values as usize];
        let mut rest = &mut values[..];
        let mut pieces = Vec::with_capacity(elements.len().div_ceil(PIECE));
        for of_piece in elements.chunks(PIECE) {
            let n_values = of_piece.iter().map(|of_element| of_element.len()).sum();
            let (piece, after) = rest.split_at_mut(n_values);
            pieces.push((piece, of_piece));
            rest = after;
        }
        pieces.into_par_iter().for_each(|(piece, of_piece)| {
            let mut rest = piece;
            for of_element in of_piece {
                let (own, after) = rest.split_at_mut(of_element.len());
                own.copy_from_slice(of_element);
                rest = after;
            }
        });
        Self { starts, values }
    }

    /// Room for that many elements with that many values in all.
    pub(super) fn with_room(n_elements: usize, n_values: usize) -> Self {
        let mut layers = Self::default();
        layers.starts.reserve_exact(n_elements);
        layers.values.reserve_exact(n_values);
        layers
    }

    /// Adds the values of the next element; none if it has none.
    pub fn push(&mut self, values: &[[f64; N]]) {
        self.values.extend_from_slice(values);
        self.starts.push(self.values.len() as u32);
    }

    /// Adds the next element with the values that `fill` appends.
    pub(super) fn push_from(&mut self, fill: impl FnOnce(&mut Vec<[f64; N]>)) {
        fill(&mut self.values);
        self.starts.push(self.values.len() as u32);
    }

    /// Values of an element, layer by layer in rising T and inside a layer point by point around the
    /// element; empty if it has none.
    pub fn of(&self, element: usize) -> &[[f64; N]] {
        let range = self.starts[element] as usize..self.starts[element + 1] as usize;
        &self.values[range]
    }
}

/// What a mapping gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapped {
    /// One for each target element.
    pub elements: Vec<ElementReport>,
    /// Thickness of each target element; NaN where it keeps its section's. Empty if not asked for.
    pub thickness: Vec<f64>,
    /// Thickness at the corners of each element, whose mean is its thickness. Empty if not asked for.
    pub corners: Vec<[f64; 4]>,
    /// Stress (six) and effective plastic strain at each layer, if asked for. Zero stress where only
    /// plastic strain was; both zero where only history variables were.
    pub states: Option<MappedLayers<7>>,
    /// Strain at both surfaces, or at each layer where the source has more than the surfaces.
    pub strains: Option<MappedLayers<6>>,
    /// History variables, if they were asked for and a source has some.
    pub history: Option<MappedHistory>,
    /// True if the strains are those of the two surfaces.
    pub strains_are_at_surfaces: bool,
    /// For each source, the side that its normals point to.
    pub facings: Vec<Facing>,
    /// Median signed distance between the sheets along the target's normals: a constant offset such
    /// as half a thickness, or 0 without partners.
    pub median_offset: f64,
    /// Elements whose sheet distance without the offset exceeds half the largest distance.
    pub n_distant: usize,
}

impl Mapped {
    /// Number of elements with each status, in the order of [`Status::ALL`].
    pub fn counts(&self) -> [usize; Status::ALL.len()] {
        let mut counts = [0; Status::ALL.len()];
        for element in &self.elements {
            counts[element.status as usize] += 1;
        }
        counts
    }

    /// Effective plastic strain of an element, weighted over its layers; NaN if it has none.
    pub fn mean_plastic_strain(&self, target: &TargetPart, element: usize) -> f64 {
        let values = self
            .states
            .as_ref()
            .map_or(&[][..], |states| states.of(element));
        if values.is_empty() {
            return f64::NAN;
        }
        let rule = &target.rules[target.rule_of[element] as usize];
        let n_plane = values.len() / rule.len();
        let weighted = rule.weights().iter().zip(values.chunks_exact(n_plane));
        let sum: f64 = weighted
            .map(|(weight, layer)| {
                weight * layer.iter().map(|value| value[PLASTIC_STRAIN]).sum::<f64>()
            })
            .sum();
        sum / (2.0 * n_plane as f64)
    }

    /// Share of the target's area that has values.
    pub fn mapped_area(&self, target: &ShellMesh) -> f64 {
        self.share(target, Status::has_values)
    }

    /// Share of the target's area whose elements have a status.
    pub fn area_share(&self, status: Status, target: &ShellMesh) -> f64 {
        self.share(target, |other| other == status)
    }

    fn share(&self, target: &ShellMesh, counts: impl Fn(Status) -> bool) -> f64 {
        let (mut sum, mut all) = (0.0, 0.0);
        for (report, area) in self.elements.iter().zip(target.areas()) {
            all += area;
            if counts(report.status) {
                sum += area;
            }
        }
        if all > 0.0 { sum / all } else { 0.0 }
    }
}
