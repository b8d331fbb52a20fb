//! What a file holds, whatever its format: nodes, shells, solids, parts, sets, forming results.

mod chosen;
mod evidence;
mod forming;
mod formulation;
mod index;
mod sheet;
mod stray;
mod surface;
mod titles;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use evidence::{FormingEvidence, other_order};
pub use forming::{Forming, OtherResults, ShellStrain, ShellStress, StrainPoint, StressPoint};
pub use formulation::{ShellControl, ShellFormulation};
pub use index::IdIndex;
pub use surface::{ChosenMesh, PartSummary, Selection, SelectionError};
pub(crate) use surface::{has_area, has_crossed_edges};
pub use titles::RawTitles;

use super::Format;
use super::diagnostic::{Diagnostics, Position};
use super::hash::FileHash;
use super::keyword::card::Layout;
use crate::geometry::{Matrix3, Matrix4, Point3, TriMesh};
use crate::units::KnownUnits;

/// Nodes in the order of the files, found by id.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Nodes {
    ids: Vec<u64>,
    positions: Vec<Point3>,
    index: IdIndex,
}

impl Nodes {
    /// Takes ids and positions; the second value lists the indices of repeated ids, of which the
    /// first counts in look-ups. Both must have the same length.
    pub fn new(ids: Vec<u64>, positions: Vec<Point3>) -> (Self, Vec<u32>) {
        assert_eq!(ids.len(), positions.len(), "one id for each position");
        let (index, repeated) = IdIndex::new(&ids);
        let nodes = Self {
            ids,
            positions,
            index,
        };
        (nodes, repeated)
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Ids in the order of the files.
    pub fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// Positions in the order of the files, in the deck's length unit.
    pub fn positions(&self) -> &[Point3] {
        &self.positions
    }

    /// Positions to be moved; ids stay.
    pub fn positions_mut(&mut self) -> &mut [Point3] {
        &mut self.positions
    }

    /// Index of a node id.
    #[inline]
    pub fn index_of(&self, id: u64) -> Option<u32> {
        self.index.get(id)
    }

    /// Position of a node id.
    pub fn position_of(&self, id: u64) -> Option<Point3> {
        self.index_of(id)
            .map(|index| self.positions[index as usize])
    }
}

/// A shell of three or four corners. A triangle repeats its third node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shell {
    /// The deck's element id.
    pub id: u64,
    /// Node indices of the corners.
    pub nodes: [u32; 4],
    /// Index into [`Model::parts`].
    pub part: u32,
}

impl Shell {
    /// True if it has three corners.
    pub fn is_triangle(&self) -> bool {
        self.nodes[2] == self.nodes[3]
    }

    /// Its three or four corners.
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..if self.is_triangle() { 3 } else { 4 }]
    }
}

/// What only some shells carry, sorted by shell index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellExtra {
    /// Index into [`Model::shells`].
    pub shell: u32,
    /// Thickness at the corners; 0 where the section's thickness counts.
    pub thickness: [f64; 4],
    /// Material angle in degrees; 0 if none was given.
    pub beta: f64,
    /// Plies of its own, which are its layers: an index into [`Model::ply_stacks`].
    pub plies: Option<u32>,
}

/// Kind of a solid element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolidKind {
    /// `*ELEMENT_SOLID`.
    Solid,
    /// `*ELEMENT_TSHELL`: a brick that behaves like a shell.
    ThickShell,
}

/// A brick or what remains of one when nodes repeat: wedge, pyramid, tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Solid {
    /// The deck's element id.
    pub id: u64,
    /// Node indices of the corners: bottom face 0–3, top face 4–7.
    pub nodes: [u32; 8],
    /// Index into [`Model::parts`].
    pub part: u32,
    /// Solid or thick shell.
    pub kind: SolidKind,
}

/// A part: what the elements of one sheet or casting have in common.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// The deck's part id.
    pub id: u64,
    /// Title; empty if none was given.
    pub title: String,
    /// Id of the section; 0 if none was given.
    pub section_id: u64,
    /// Id of the material; 0 if none was given.
    pub material_id: u64,
    /// Thickness that elements without their own take: at the four corners.
    pub thickness: Option<[f64; 4]>,
    /// What it has in place of a section (`*PART_COMPOSITE`).
    pub plies: Option<Plies>,
    /// False if elements name the part but no file defines it.
    pub is_defined: bool,
}

/// The plies of a part: each is a layer with one integration point in its middle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plies {
    /// Thickness of each, from the bottom side up.
    pub thickness: Vec<f64>,
    /// Element formulation `ELFORM`; 0 where the card leaves it to `*CONTROL_SHELL`.
    pub elform: i64,
    /// Where the nodes lie through the thickness, as in [`Section::nloc`].
    pub nloc: f64,
}

impl Part {
    /// Mean of the four corner thicknesses.
    pub fn mean_thickness(&self) -> Option<f64> {
        self.thickness.map(mean_of_corners)
    }
}

/// By pairs, so that the mean of equal corners is their value.
fn mean_of_corners([a, b, c, d]: [f64; 4]) -> f64 {
    ((a + b) + (c + d)) / 4.0
}

/// `*SECTION_SHELL`: thickness of the parts that name it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// The deck's section id.
    pub id: u64,
    /// Thickness at the four corners.
    pub thickness: [f64; 4],
    /// Where the nodes lie through the thickness (`NLOC`): 0 in the middle, 1 at the top, −1 at the bottom.
    pub nloc: f64,
    /// Element formulation, layers and rule.
    pub formulation: ShellFormulation,
}

/// `*MAT_…`: what a material is called, how heavy and how stiff it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The deck's material id.
    pub id: u64,
    /// The law: its number where the keyword is one or a usual name ("24", "36"), else the keyword
    /// without `MAT_`.
    pub law: String,
    /// Density in the deck's unit; 0 where the card's second field is none.
    pub density: f64,
    /// Young's modulus in the deck's unit; 0 where the card's third field is none.
    pub modulus: f64,
}

/// A named list of ids.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Set {
    /// Title; empty if none was given.
    pub title: String,
    /// Ids in the order of the deck.
    pub ids: Vec<u64>,
}

/// Sets by id.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Sets {
    /// `*SET_PART…`.
    pub parts: BTreeMap<u64, Set>,
    /// `*SET_SHELL…`.
    pub shells: BTreeMap<u64, Set>,
    /// `*SET_NODE…`.
    pub nodes: BTreeMap<u64, Set>,
}

/// An `*INCLUDE_STAMPED_PART` or one of its kin: the solver maps the forming results of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StampedInclude {
    /// The file, as the deck names it.
    pub file: String,
    /// The part, or the set of parts, that gets them.
    pub onto: u64,
    /// True for a set.
    pub is_set: bool,
    /// Where the keyword stands.
    pub position: Position,
}

/// A motion of nodes that the deck asked for and that was carried out.
#[derive(Debug, Clone, PartialEq)]
pub struct AppliedMotion {
    /// Where the deck asks for it.
    pub position: Position,
    /// `TRANID`; 0 for the unit factor of an include.
    pub transformation: u64,
    /// What was done to the nodes, for column vectors.
    pub matrix: Matrix4,
    /// How many nodes were moved.
    pub n_nodes: usize,
}

/// How the deck reads a file that it includes: what it adds to the ids there, and its factors on numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IncludedAs {
    /// Width of fields where the file itself says nothing.
    pub layout: Layout,
    /// True if the file's own wish for a width does not count.
    pub layout_is_fixed: bool,
    /// Added to element ids.
    pub element_offset: i64,
    /// Added to node ids.
    pub node_offset: i64,
    /// Added to part ids.
    pub part_offset: i64,
    /// Added to ids of sets.
    pub set_offset: i64,
    /// Added to ids of coordinate systems.
    pub system_offset: i64,
    /// Factor on lengths that are not coordinates: thicknesses.
    pub length_factor: f64,
    /// Factor on stresses.
    pub stress_factor: f64,
    /// The deck mirrors it: corners of shells and solids in the order 2 1 4 3 of their cards.
    pub is_mirrored: bool,
    /// How the deck turns it, and with it the tensors in it.
    pub rotation: Matrix3,
}

impl Default for IncludedAs {
    /// As a file is read that nothing includes.
    fn default() -> Self {
        Self {
            layout: Layout::Standard,
            layout_is_fixed: false,
            element_offset: 0,
            node_offset: 0,
            part_offset: 0,
            set_offset: 0,
            system_offset: 0,
            length_factor: 1.0,
            stress_factor: 1.0,
            is_mirrored: false,
            rotation: Matrix3::identity(),
        }
    }
}

impl IncludedAs {
    /// True if tensors in it are others in the whole deck; a turn by less than 1e-9 is rounding.
    pub fn is_turned(&self) -> bool {
        (self.rotation - Matrix3::identity()).norm() > 1e-9
    }

    /// True if ids, lengths and corners in the file are those of the whole deck.
    pub fn keeps_numbers(&self) -> bool {
        let offsets = [
            self.element_offset,
            self.node_offset,
            self.part_offset,
            self.system_offset,
        ];
        offsets == [0; 4] && self.length_factor == 1.0 && !self.is_mirrored
    }
}

/// A file that was read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadFile {
    /// The path it was opened under.
    pub path: PathBuf,
    /// Its length, unpacked.
    pub n_bytes: u64,
    /// Its content by name; `None` until it is asked for, and for a pipe.
    pub hash: Option<FileHash>,
    /// How the deck reads it. A file that is included twice is there twice.
    pub included_as: IncludedAs,
}

/// Everything that was read from a file and the files it includes.
///
/// Lengths are in the deck's own unit. Indices are dense and in the order of the files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// What the file is.
    pub format: Format,
    /// Width of the deck's fields where a keyword says nothing.
    pub layout: Layout,
    /// The deck's title; empty if it has none.
    pub title: String,
    /// Titles as the file has them, where they are not shown byte by byte.
    pub raw_titles: RawTitles,
    /// The units that the deck names or that follow from its materials.
    pub stated_units: Option<KnownUnits>,
    /// Nodes.
    pub nodes: Nodes,
    /// Shells whose nodes all exist.
    pub shells: Vec<Shell>,
    /// Mid-side nodes (N5–N8) of quadratic shells, sorted by shell index; `u32::MAX` where there
    /// is none.
    pub mid_side: Vec<(u32, [u32; 4])>,
    /// Corner thickness and material angle of the shells that have their own.
    pub shell_extras: Vec<ShellExtra>,
    /// Thickness of the plies, from the bottom side up, of shells that have their own (`_COMPOSITE`); stacks that
    /// are alike stand here once.
    pub ply_stacks: Vec<Vec<f64>>,
    /// Shells that have a distance of their nodes from the mid-surface on a card (`_OFFSET`), which is not kept:
    /// indices into [`Model::shells`].
    pub offset_shells: Vec<u32>,
    /// Solids and thick shells whose nodes all exist.
    pub solids: Vec<Solid>,
    /// Parts, the defined ones and those that only elements name, in the order they were met.
    pub parts: Vec<Part>,
    /// Shell sections.
    pub sections: Vec<Section>,
    /// Materials; of those with the same id the first counts.
    pub materials: Vec<Material>,
    /// What holds for the shells of all sections.
    pub shell_control: ShellControl,
    /// Sets of parts, shells and nodes.
    pub sets: Sets,
    /// Nodes of elements that lie absurdly far from all others, ascending.
    pub stray_nodes: Vec<u32>,
    /// Forming results. Tensors are in the global frame: those of a file that was included under a
    /// transformation, or of shells that `*NODE_TRANSFORM` moved, are turned with its rotation.
    /// The sides of a shell are those of its corner order, which an include that is mirrored reverses with its
    /// normals, as the solver does; `*NODE_TRANSFORM` moves nodes alone.
    pub forming: Forming,
    /// Motions that includes and `*NODE_TRANSFORM` brought, in the order they were carried out.
    pub motions: Vec<AppliedMotion>,
    /// Files that the solver maps onto parts of the deck.
    pub stamped_includes: Vec<StampedInclude>,
    /// Ids of the `*DEFINE_TRANSFORMATION`s, ascending.
    pub transformations: Vec<u64>,
    /// What could not be understood.
    pub diagnostics: Diagnostics,
    /// The files that were read, the one asked for first.
    pub files: Vec<ReadFile>,
}

impl Model {
    /// The layout of a deck that this one includes and that names any of the shells: one that an including deck has
    /// counts for what it includes. O(shells).
    pub fn layout_of_include(&self) -> Layout {
        let largest = self.shells.iter().map(|shell| shell.id).max();
        self.layout.max(Layout::holding(largest.unwrap_or(0)))
    }

    /// The first file whose content is another one than in `before`, the files of an earlier read of this model.
    pub fn changed_since(&self, before: &[ReadFile]) -> Option<&Path> {
        let is_as_before =
            |(now, then): (&ReadFile, &ReadFile)| now.path == then.path && now.hash == then.hash;
        let same = self.files.iter().zip(before);
        let n_same = same.take_while(|&pair| is_as_before(pair)).count();
        if n_same == self.files.len() && n_same == before.len() {
            return None;
        }
        // Where a file is missing, another one does not ask for it any more.
        let other = self.files.get(n_same).or(self.files.first())?;
        Some(&other.path)
    }

    /// A model of one part from a bare triangle mesh; ids count from 1.
    pub fn from_mesh(mesh: &TriMesh, title: impl Into<String>) -> Self {
        let ids = (1..=mesh.n_vertices() as u64).collect();
        let (nodes, _) = Nodes::new(ids, mesh.positions().to_vec());
        let shell = |(&[a, b, c], id): (&[u32; 3], u64)| Shell {
            id,
            nodes: [a, b, c, c],
            part: 0,
        };
        let title = title.into();
        let part = Part {
            id: 1,
            title: title.clone(),
            is_defined: true,
            ..Part::default()
        };
        Self {
            title,
            nodes,
            shells: mesh.triangles().iter().zip(1..).map(shell).collect(),
            parts: vec![part],
            ..Self::default()
        }
    }

    /// Index of a part id. O(parts).
    pub fn part_index(&self, id: u64) -> Option<u32> {
        let at = self.parts.iter().position(|part| part.id == id)?;
        u32::try_from(at).ok()
    }

    /// True if the file holds results of forming: stresses, strains, or a thickness of its elements' own.
    pub fn has_results(&self) -> bool {
        let mut extras = self.shell_extras.iter();
        !self.forming.is_empty() || extras.any(|extra| extra.thickness != [0.0; 4])
    }

    /// The material of a part, by index; `None` if it is not in the deck. O(materials).
    pub fn material(&self, part: u32) -> Option<&Material> {
        let id = self.parts.get(part as usize)?.material_id;
        self.materials.iter().find(|material| material.id == id)
    }

    /// Corner thickness of a shell: its own where that is not 0, else its part's. The fourth of a triangle, which
    /// cards leave blank, is the mean of the three, so that the mean of all four is that of the element.
    pub fn shell_thickness(&self, index: u32) -> Option<[f64; 4]> {
        let shell = &self.shells[index as usize];
        let of_part = self.parts[shell.part as usize].thickness;
        let own = self.shell_extra(index).map(|extra| extra.thickness);
        let mut corners = match (own.filter(|own| *own != [0.0; 4]), of_part) {
            (Some(own), Some(part)) => {
                std::array::from_fn(|i| if own[i] == 0.0 { part[i] } else { own[i] })
            }
            (own, part) => own.or(part)?,
        };
        if shell.is_triangle() {
            let [a, b, c, _] = corners;
            // As differences, so that equal thicknesses have themselves as mean.
            corners[3] = a + ((b - a) + (c - a)) / 3.0;
        }
        Some(corners)
    }

    /// Mean thickness of a shell, as of the corners that [`Model::shell_thickness`] gives.
    pub fn mean_shell_thickness(&self, index: u32) -> Option<f64> {
        self.shell_thickness(index).map(mean_of_corners)
    }

    /// The plies of a shell that has its own: their index and thickness. O(log shells).
    pub fn shell_plies(&self, shell: u32) -> Option<(u32, &[f64])> {
        let index = self.shell_extra(shell)?.plies?;
        Some((index, &self.ply_stacks[index as usize]))
    }

    /// Thickness and material angle written with the shell itself. O(log shells).
    pub fn shell_extra(&self, shell: u32) -> Option<&ShellExtra> {
        let at = self
            .shell_extras
            .binary_search_by_key(&shell, |extra| extra.shell);
        at.ok().map(|at| &self.shell_extras[at])
    }
}
