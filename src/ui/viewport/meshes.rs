//! Meshes prepared for drawing and picking, made off the frame and kept while they are used.

use std::sync::Arc;

use super::identity::Identity;
use crate::app::Part;
use crate::geometry::{Point3, TriMesh};
use crate::jobs::MeasuredLevel;
use crate::pipeline::load::LoadedPart;
use crate::render::{COARSE, COARSE_ON_PROCESSOR, MeshInput, RenderMesh};
use crate::role::{PerRole, Role};
use crate::search::{Bvh, RayHit};
use crate::ui::background::{Background, Task};

/// Meshes kept although no window shows them now: the levels one flips between.
const KEPT: usize = 8;

/// Which mesh of a part: the full one or a level.
#[derive(Debug, Clone)]
pub(super) struct MeshSource {
    pub part: Arc<LoadedPart>,
    pub level: Option<Arc<MeasuredLevel>>,
}

impl MeshSource {
    /// The chosen level of a part, or the full mesh.
    pub fn of(part: &Part, is_detailed: bool) -> Self {
        let level = part.level.as_ref().filter(|_| !is_detailed);
        Self {
            part: part.loaded.to_arc(),
            level: level.map(|level| level.to_arc()),
        }
    }

    /// The full mesh of what was read.
    pub fn full(part: Arc<LoadedPart>) -> Self {
        Self { part, level: None }
    }

    pub fn mesh(&self) -> &Arc<TriMesh> {
        match &self.level {
            Some(level) => &level.level.mesh,
            None => &self.part.mesh,
        }
    }

    /// Triangle of the full mesh that a triangle is or descends from.
    pub fn full_triangle(&self, triangle: usize) -> usize {
        match &self.level {
            Some(level) => level.level.triangle_of[triangle] as usize,
            None => triangle,
        }
    }

    /// Element of the deck that a triangle is or descends from.
    pub fn element(&self, triangle: usize) -> u32 {
        let triangle = self.full_triangle(triangle) as u32;
        self.part.ids.element_of(triangle).unwrap_or(u32::MAX)
    }

    fn part_index(&self, triangle: usize) -> u32 {
        let triangle = self.full_triangle(triangle) as u32;
        self.part.ids.part_of(triangle).unwrap_or_default()
    }

    fn key(&self) -> Identity {
        Identity::of(self.mesh())
    }
}

/// A mesh that can be drawn and picked.
pub(super) struct ShownMesh {
    pub source: MeshSource,
    pub drawn: Arc<RenderMesh>,
    pub part_of_triangle: Vec<u32>,
    /// The tree of a level; the part has that of the full mesh.
    tree_of_level: Option<Bvh>,
}

impl ShownMesh {
    /// Prepares a mesh, whose coarse picture has about `n_coarse` triangles. O(triangles · log triangles).
    pub fn new(source: MeshSource, n_coarse: usize) -> Self {
        let mesh = source.mesh();
        let triangles = 0..mesh.n_triangles();
        let part_of_triangle: Vec<u32> = triangles.clone().map(|t| source.part_index(t)).collect();
        // A level's triangles are its elements; the full mesh shows its quadrilaterals.
        let elements = source.level.is_none();
        let elements: Option<Vec<u32>> =
            elements.then(|| triangles.map(|t| source.element(t)).collect());
        let input = MeshInput {
            mesh,
            part_of_triangle: Some(&part_of_triangle),
            element_of_triangle: elements.as_deref(),
            n_coarse,
        };
        let is_level = source.level.is_some();
        let (drawn, tree_of_level) = rayon::join(
            || RenderMesh::new(input),
            || is_level.then(|| Bvh::build(Arc::clone(mesh))),
        );
        Self {
            drawn: Arc::new(drawn),
            tree_of_level,
            part_of_triangle,
            source,
        }
    }

    pub fn key(&self) -> Identity {
        self.source.key()
    }

    pub fn mesh(&self) -> &TriMesh {
        self.source.mesh()
    }

    /// Tree for rays and closest points.
    pub fn tree(&self) -> &Bvh {
        self.tree_of_level
            .as_ref()
            .unwrap_or_else(|| self.source.part.surface.bvh())
    }

    /// Deck number of a part by its index.
    pub fn part_id(&self, index: u32) -> Option<u64> {
        let parts = &self.source.part.model.parts;
        parts.get(index as usize).map(|part| part.id)
    }

    /// The corner of the met triangle next to the hit: its position and, on the full mesh, its
    /// number in the deck.
    pub fn nearest_node(&self, hit: &RayHit) -> (Point3, Option<u64>) {
        let corners = self.mesh().triangles()[hit.triangle as usize];
        let distance = |v: u32| (self.mesh().positions()[v as usize] - hit.point).norm_squared();
        let [first, others @ ..] = corners;
        let mut nearest = first;
        for vertex in others {
            if distance(vertex) < distance(nearest) {
                nearest = vertex;
            }
        }
        let position = self.mesh().positions()[nearest as usize];
        // The vertices of a level are not nodes.
        let is_full = self.source.level.is_none();
        let node = is_full.then(|| self.source.part.node_id(nearest));
        (position, node.flatten())
    }
}

/// The prepared meshes.
pub(super) struct MeshStore {
    background: Background<Identity, ShownMesh>,
    /// Most recently used last.
    ready: Vec<Arc<ShownMesh>>,
    /// Those that could not be prepared, as long as someone holds them.
    failed: Vec<Identity>,
    /// How many each window shows.
    n_shown: PerRole<usize>,
    n_coarse: usize,
}

impl MeshStore {
    /// `is_on_processor`: a software driver draws them.
    pub fn new(is_on_processor: bool) -> Self {
        let n_coarse = if is_on_processor {
            COARSE_ON_PROCESSOR
        } else {
            COARSE
        };
        Self {
            n_coarse,
            background: Background::new("meshes"),
            ready: Vec::new(),
            failed: Vec::new(),
            n_shown: PerRole::default(),
        }
    }

    /// The meshes of a window; `None` for those that are not ready yet.
    pub fn get(
        &mut self,
        role: Role,
        sources: &[MeshSource],
        wake: &egui::Context,
    ) -> Vec<Option<Arc<ShownMesh>>> {
        let n_coarse = self.n_coarse;
        let wanted = sources
            .iter()
            .filter(|source| !self.is_known(&source.key()));
        let wanted = wanted.map(|source| {
            let source = source.clone();
            Task {
                key: source.key(),
                work: Box::new(move || ShownMesh::new(source, n_coarse)),
            }
        });
        let wanted = wanted.collect();
        for (key, mesh) in self.background.exchange(role, wanted, wake) {
            match mesh {
                Some(mesh) => self.ready.push(Arc::new(mesh)),
                None => self.failed.push(key),
            }
        }
        let found = sources.iter().map(|source| self.take(&source.key()));
        let found = found.collect();
        *self.n_shown.get_mut(role) = sources.len();
        self.forget();
        found
    }

    /// True while meshes are being made.
    pub fn is_waiting(&self) -> bool {
        self.background.is_waiting()
    }

    fn is_known(&self, key: &Identity) -> bool {
        self.failed.contains(key) || self.ready.iter().any(|mesh| mesh.key() == *key)
    }

    /// Finds a mesh and makes it the most recently used.
    fn take(&mut self, key: &Identity) -> Option<Arc<ShownMesh>> {
        let at = self.ready.iter().position(|mesh| mesh.key() == *key)?;
        let mesh = self.ready.remove(at);
        self.ready.push(Arc::clone(&mesh));
        Some(mesh)
    }

    fn forget(&mut self) {
        let n_shown = self.n_shown.crash + self.n_shown.stamped;
        let n = self.ready.len().saturating_sub(KEPT + n_shown);
        self.ready.drain(..n);
        self.failed.retain(Identity::is_there);
    }
}
