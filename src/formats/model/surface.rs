//! From a model to the triangle mesh that is matched.

use std::collections::{BTreeSet, HashMap};

use serde::{Deserialize, Serialize};

use super::super::diagnostic::{Diagnostic, DiagnosticKind, Diagnostics};
use super::{Model, Nodes, Solid};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{Aabb, MeshError, Point3, TriMesh};
use crate::monitor::{Cancelled, Monitor};

/// Marks a node no chosen element uses.
const UNUSED: u32 = u32::MAX;

/// Which elements make the surface.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// Every shell, and the skin of every solid.
    #[default]
    All,
    /// The parts that may be the formed sheet ([`Model::sheet_parts`]): not the tools.
    Sheet,
    /// The elements of these part ids.
    Parts(Vec<u64>),
    /// The elements of parts with this title, letter case and blanks around it ignored.
    PartTitle(String),
    /// The elements of the parts in a `*SET_PART`.
    PartSet(u64),
    /// The shells in a `*SET_SHELL`.
    ShellSet(u64),
    /// The shells whose nodes are all in a `*SET_NODE`.
    NodeSet(u64),
}

impl Selection {
    /// The choice as it is typed on the command line.
    pub fn typed(&self) -> String {
        match self {
            Self::All => "all".to_owned(),
            Self::Sheet => "sheet".to_owned(),
            Self::Parts(ids) => {
                let ids: Vec<String> = ids.iter().map(u64::to_string).collect();
                ids.join(",")
            }
            Self::PartTitle(title) => format!("title:{title}"),
            Self::PartSet(id) => format!("set:{id}"),
            Self::ShellSet(id) => format!("shell-set:{id}"),
            Self::NodeSet(id) => format!("node-set:{id}"),
        }
    }
}

/// Why a selection gives no surface.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SelectionError {
    /// No part has the id.
    #[error("there is no part {0}")]
    NoSuchPart(u64),
    /// No part has the title.
    #[error("there is no part with the title {0:?}")]
    NoSuchTitle(String),
    /// No set of the kind has the id.
    #[error("there is no {kind} set {id}")]
    NoSuchSet {
        /// `"part"`, `"shell"` or `"node"`.
        kind: &'static str,
        /// The set's id.
        id: u64,
    },
    /// The chosen elements have no triangle with area.
    #[error("there is no shell or solid with area")]
    Empty,
    /// A set holds nothing that is in the file.
    #[error("{kind} set {id} holds no {kind} of the file")]
    EmptySet {
        /// `"part"`, `"shell"` or `"node"`.
        kind: &'static str,
        /// The set's id.
        id: u64,
    },
    /// The triangles make no mesh.
    #[error("the surface cannot be built: {0}")]
    Mesh(#[from] MeshError),
    /// The work was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The triangles of the chosen elements and where they come from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChosenMesh {
    /// The mesh. Every vertex is used by a triangle, every triangle has area.
    pub mesh: TriMesh,
    /// For each vertex its node index.
    pub vertex_node: Vec<u32>,
    /// For each triangle its element: an index into the shells, or, from `shells.len()` on, into
    /// the solids.
    pub triangle_element: Vec<u32>,
    /// For each triangle the index of its part.
    pub triangle_part: Vec<u32>,
    /// Elements that were left out because they have no area.
    pub diagnostics: Diagnostics,
}

/// One row of the list of parts.
#[derive(Debug, Clone, PartialEq)]
pub struct PartSummary {
    /// The deck's part id.
    pub id: u64,
    /// Title; empty if none was given.
    pub title: String,
    /// Number of shells.
    pub n_shells: usize,
    /// Number of solids and thick shells.
    pub n_solids: usize,
    /// Triangles the shells are cut into; solids are not counted.
    pub n_triangles: usize,
    /// Mean over the shells of their corner thickness; the part's own if it has no shells.
    pub thickness: Option<f64>,
}

impl Model {
    /// The triangle mesh of the chosen elements. Quads are cut along the shorter diagonal (equal
    /// ones from the first corner), concave ones along the inner one; of solids the faces used once are
    /// taken, facing outward. Elements with a node absurdly far from all others are left out. O(elements).
    pub fn surface(&self, selection: &Selection) -> Result<ChosenMesh, SelectionError> {
        self.build_surface(selection, &Monitor::silent())
    }

    /// [`Model::surface`] that ends when `monitor` is cancelled.
    pub fn build_surface(
        &self,
        selection: &Selection,
        monitor: &Monitor,
    ) -> Result<ChosenMesh, SelectionError> {
        let chosen = self.chosen(selection)?;
        let mut builder = Builder::new(&self.nodes);
        for_chunks(self.shells.len(), monitor, |range| {
            for index in range {
                let shell = &self.shells[index];
                if chosen.shell(index, shell.part) && !self.is_stray(&shell.nodes) {
                    let name = || format!("shell {}", shell.id);
                    builder.polygon(shell.corners(), index as u32, shell.part, name);
                }
            }
        })?;
        self.add_skin(&chosen, &mut builder, monitor)?;
        builder.finish(monitor)
    }

    /// The parts in the order they were met. O(elements).
    pub fn part_summaries(&self) -> Vec<PartSummary> {
        let row = |part: &super::Part| PartSummary {
            id: part.id,
            title: part.title.clone(),
            n_shells: 0,
            n_solids: 0,
            n_triangles: 0,
            thickness: part.mean_thickness(),
        };
        let mut rows: Vec<PartSummary> = self.parts.iter().map(row).collect();
        let mut means = vec![Mean::default(); rows.len()];
        for (index, shell) in self.shells.iter().enumerate() {
            let row = &mut rows[shell.part as usize];
            row.n_shells += 1;
            row.n_triangles += shell.corners().len() - 2;
            let n = shell.corners().len();
            let corners = self.shell_thickness(index as u32).unwrap_or_default();
            for &corner in &corners[..n] {
                means[shell.part as usize].add(corner, 1.0 / n as f64);
            }
        }
        for solid in &self.solids {
            rows[solid.part as usize].n_solids += 1;
        }
        for (row, mean) in rows.iter_mut().zip(means) {
            if row.n_shells > 0 {
                row.thickness = Some(mean.value()).filter(|&mean| mean > 0.0);
            }
        }
        rows
    }

    /// Box around the nodes that shells and solids use; around all nodes if there are none.
    pub fn bounds(&self) -> Aabb {
        let positions = self.nodes.positions();
        let of_shells = self.shells.iter().flat_map(|shell| &shell.nodes);
        let of_solids = self.solids.iter().flat_map(|solid| &solid.nodes);
        let used = of_shells.chain(of_solids).map(|&n| &positions[n as usize]);
        let aabb = Aabb::of_points(used);
        if aabb.is_empty() {
            Aabb::of_points(positions)
        } else {
            aabb
        }
    }

    pub(super) fn chosen(&self, selection: &Selection) -> Result<Chosen, SelectionError> {
        let no_set = |kind, id| SelectionError::NoSuchSet { kind, id };
        match selection {
            Selection::All => Ok(Chosen::Parts(vec![true; self.parts.len()])),
            Selection::Sheet => Ok(Chosen::Parts(self.sheet_parts())),
            Selection::Parts(ids) => self.chosen_parts(ids),
            Selection::PartTitle(title) => {
                let wanted = title.trim().to_lowercase();
                let same = |part: &super::Part| part.title.trim().to_lowercase() == wanted;
                let parts: Vec<bool> = self.parts.iter().map(same).collect();
                if parts.contains(&true) {
                    Ok(Chosen::Parts(parts))
                } else {
                    Err(SelectionError::NoSuchTitle(title.clone()))
                }
            }
            Selection::PartSet(id) => {
                let set = self.sets.parts.get(id).ok_or(no_set("part", *id))?;
                // A set may list parts of a file that was not found; the others still count.
                let known: BTreeSet<u64> = self.parts.iter().map(|part| part.id).collect();
                let ids: Vec<u64> = set
                    .ids
                    .iter()
                    .copied()
                    .filter(|i| known.contains(i))
                    .collect();
                if ids.is_empty() {
                    return Err(SelectionError::EmptySet {
                        kind: "part",
                        id: *id,
                    });
                }
                self.chosen_parts(&ids)
            }
            Selection::ShellSet(id) => {
                let set = self.sets.shells.get(id).ok_or(no_set("shell", *id))?;
                let ids: BTreeSet<u64> = set.ids.iter().copied().collect();
                let shells = self.shells.iter().map(|shell| ids.contains(&shell.id));
                let shells: Vec<bool> = shells.collect();
                if !shells.contains(&true) {
                    return Err(SelectionError::EmptySet {
                        kind: "shell",
                        id: *id,
                    });
                }
                Ok(Chosen::Shells(shells))
            }
            Selection::NodeSet(id) => {
                let set = self.sets.nodes.get(id).ok_or(no_set("node", *id))?;
                let mut is_in = vec![false; self.nodes.len()];
                for index in set.ids.iter().filter_map(|&id| self.nodes.index_of(id)) {
                    is_in[index as usize] = true;
                }
                let all_in = |shell: &super::Shell| shell.nodes.iter().all(|&n| is_in[n as usize]);
                Ok(Chosen::Shells(self.shells.iter().map(all_in).collect()))
            }
        }
    }

    fn chosen_parts(&self, ids: &[u64]) -> Result<Chosen, SelectionError> {
        let mut parts = vec![false; self.parts.len()];
        for &id in ids {
            let mut found = false;
            for (chosen, part) in parts.iter_mut().zip(&self.parts) {
                if part.id == id {
                    *chosen = true;
                    found = true;
                }
            }
            if !found {
                return Err(SelectionError::NoSuchPart(id));
            }
        }
        Ok(Chosen::Parts(parts))
    }

    /// Adds the faces that exactly one chosen solid has.
    fn add_skin(
        &self,
        chosen: &Chosen,
        builder: &mut Builder,
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let is_chosen = |index: &usize| {
            let solid = &self.solids[*index];
            chosen.solid(solid.part) && !self.is_stray(&solid.nodes)
        };
        let mut uses: HashMap<[u32; 4], u32> = HashMap::new();
        for_chunks(self.solids.len(), monitor, |range| {
            for index in range.filter(is_chosen) {
                for face in faces(&self.solids[index]) {
                    *uses.entry(face_key(&face)).or_default() += 1;
                }
            }
        })?;
        for_chunks(self.solids.len(), monitor, |range| {
            for index in range.filter(is_chosen) {
                let solid = &self.solids[index];
                let element = (self.shells.len() + index) as u32;
                for face in faces(solid).filter(|face| uses[&face_key(face)] == 1) {
                    let name = || format!("solid {}", solid.id);
                    builder.polygon(&face, element, solid.part, name);
                }
            }
        })
    }
}

/// A weighted mean. That of equal values is that value, without the rounding of their sum.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    first: Option<f64>,
    /// Of what the others differ from the first.
    sum: f64,
    weights: f64,
}

impl Mean {
    fn add(&mut self, value: f64, weight: f64) {
        let first = *self.first.get_or_insert(value);
        self.sum += weight * (value - first);
        self.weights += weight;
    }

    fn value(&self) -> f64 {
        self.first
            .map_or(0.0, |first| first + self.sum / self.weights)
    }
}

/// The chosen elements.
pub(super) enum Chosen {
    /// By part index.
    Parts(Vec<bool>),
    /// By shell index; no solids.
    Shells(Vec<bool>),
}

impl Chosen {
    pub(super) fn shell(&self, index: usize, part: u32) -> bool {
        match self {
            Self::Parts(parts) => parts[part as usize],
            Self::Shells(shells) => shells[index],
        }
    }

    pub(super) fn solid(&self, part: u32) -> bool {
        match self {
            Self::Parts(parts) => parts[part as usize],
            Self::Shells(_) => false,
        }
    }
}

/// The faces of a solid with three or more different nodes, seen from outside counter-clockwise.
fn faces(solid: &Solid) -> impl Iterator<Item = Vec<u32>> + use<> {
    const FACES: [[usize; 4]; 6] = [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ];
    let nodes = solid.nodes;
    let distinct = move |face: [usize; 4]| {
        let mut corners: Vec<u32> = Vec::with_capacity(4);
        for node in face.map(|i| nodes[i]) {
            if !corners.contains(&node) {
                corners.push(node);
            }
        }
        corners
    };
    FACES
        .into_iter()
        .map(distinct)
        .filter(|face| face.len() >= 3)
}

/// The same for a face seen from both of its solids.
fn face_key(face: &[u32]) -> [u32; 4] {
    let mut key = [u32::MAX; 4];
    key[..face.len()].copy_from_slice(face);
    key.sort_unstable();
    key
}

/// Collects triangles and gives their nodes vertex numbers.
struct Builder<'a> {
    nodes: &'a Nodes,
    node_vertex: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    surface: ChosenMesh,
}

impl<'a> Builder<'a> {
    fn new(nodes: &'a Nodes) -> Self {
        Self {
            nodes,
            node_vertex: vec![UNUSED; nodes.len()],
            triangles: Vec::new(),
            surface: ChosenMesh::default(),
        }
    }

    fn polygon(&mut self, corners: &[u32], element: u32, part: u32, name: impl Fn() -> String) {
        let n_before = self.triangles.len();
        if let &[a, b, c, d] = corners {
            let point = |n: u32| self.nodes.positions()[n as usize];
            let along_ac = (point(c) - point(a)).norm_squared();
            let along_bd = (point(d) - point(b)).norm_squared();
            // A concave quad has one diagonal inside; on the other its halves look apart.
            let folds = |[p, q, r, s]: [u32; 4]| {
                let [p, q, r, s] = [p, q, r, s].map(point);
                (q - p).cross(&(r - p)).dot(&(r - p).cross(&(s - p))) < 0.0
            };
            let is_ac = match (folds([a, b, c, d]), folds([b, c, d, a])) {
                (false, true) => true,
                (true, false) => false,
                _ => along_ac <= along_bd,
            };
            if is_ac {
                self.triangle([a, b, c], element, part);
                self.triangle([a, c, d], element, part);
            } else {
                self.triangle([a, b, d], element, part);
                self.triangle([b, c, d], element, part);
            }
        } else if let &[a, b, c] = corners {
            self.triangle([a, b, c], element, part);
        }
        if self.triangles.len() == n_before {
            let kind = DiagnosticKind::ZeroArea;
            let message = || Diagnostic::new(kind, format!("{} has no area", name()));
            self.surface.diagnostics.push_with(kind, message);
        }
    }

    fn triangle(&mut self, corners: [u32; 3], element: u32, part: u32) {
        let [a, b, c] = corners.map(|n| self.nodes.positions()[n as usize]);
        if !has_area(a, b, c) {
            return;
        }
        self.triangles.push(corners);
        self.surface.triangle_element.push(element);
        self.surface.triangle_part.push(part);
    }

    /// Numbers the used nodes in the order of the file, so that neighbours stay neighbours.
    fn finish(mut self, monitor: &Monitor) -> Result<ChosenMesh, SelectionError> {
        if self.triangles.is_empty() {
            return Err(SelectionError::Empty);
        }
        let n_triangles = self.triangles.len();
        for_chunks(n_triangles, monitor, |range| {
            for &node in self.triangles[range].iter().flatten() {
                self.node_vertex[node as usize] = 0;
            }
        })?;
        let mut positions = Vec::new();
        for_chunks(self.node_vertex.len(), monitor, |range| {
            for node in range {
                let vertex = &mut self.node_vertex[node];
                if *vertex != UNUSED {
                    *vertex = positions.len() as u32;
                    positions.push(self.nodes.positions()[node]);
                    self.surface.vertex_node.push(node as u32);
                }
            }
        })?;
        for_chunks(n_triangles, monitor, |range| {
            for node in self.triangles[range].iter_mut().flatten() {
                *node = self.node_vertex[*node as usize];
            }
        })?;
        self.surface.mesh = TriMesh::new(positions, self.triangles)?;
        Ok(self.surface)
    }
}

/// Whether the edges of a quad cross: on either diagonal its halves, which have area, look apart. Those of a warped
/// quad do so at most a little.
pub(crate) fn has_crossed_edges([a, b, c, d]: [Point3; 4]) -> bool {
    let looks_apart = |[p, q, r, s]: [Point3; 4]| {
        let (first, second) = ((q - p).cross(&(r - p)), (r - p).cross(&(s - p)));
        first.dot(&second) < -0.5 * first.norm() * second.norm()
            && has_area(p, q, r)
            && has_area(p, r, s)
    };
    looks_apart([a, b, c, d]) && looks_apart([b, c, d, a])
}

/// False if the corners lie on a line to the accuracy of their coordinates' differences.
pub(crate) fn has_area(a: Point3, b: Point3, c: Point3) -> bool {
    let (u, v) = (b - a, c - a);
    let longest_sq = u
        .norm_squared()
        .max(v.norm_squared())
        .max((c - b).norm_squared());
    u.cross(&v).norm() > 1e-12 * longest_sq
}
