//! What the window shows of a loaded part, worked out by the worker.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::PartSummary;
use crate::formats::model::FormingEvidence;
use crate::geometry::{Aabb, Border, Landmarks, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::pipeline::joined_parts::joined_parts;
use crate::pipeline::likeness::{Moments, moments_of_parts};
use crate::pipeline::load::LoadedPart;

/// What the window shows about a part, counted once by the worker so that no frame has to.
#[derive(Debug, Clone, PartialEq)]
pub struct PartFacts {
    /// The parts of the deck, for the tree.
    pub parts: Vec<PartSummary>,
    /// Ids of the parts that are matched.
    pub used: BTreeSet<u64>,
    /// Ids of parts that are no formed sheet but tools, where the file says so.
    pub tools: BTreeSet<u64>,
    /// Box around each of them, in the crash model's unit.
    pub part_bounds: BTreeMap<u64, Aabb>,
    /// Area and spread of each part of the deck that has shells, in the crash model's unit.
    pub moments: BTreeMap<u64, Moments>,
    /// Parts in use that share nodes, as [`joined_parts`] groups them.
    pub joined: BTreeSet<Vec<u64>>,
    /// Box around the mesh.
    pub bounds: Aabb,
    /// Area of the mesh.
    pub area: f64,
    /// Mean edge length of the mesh, the natural size of everything that is measured on it.
    pub edge_length: f64,
    /// Area-weighted mean normal; its length says how flat the part is.
    pub mean_normal: Vector3,
    /// Holes and corners of each part with borders, to be pointed at.
    pub landmarks: BTreeMap<u64, Landmarks>,
    /// Mean thickness of the matched elements, if known.
    pub thickness: Option<f64>,
    /// How much the file looks like the end of a forming simulation.
    pub formed: FormingEvidence,
}

impl PartFacts {
    /// Counts and measures. O(elements).
    pub fn of(part: &LoadedPart, monitor: &Monitor) -> Result<Self, Cancelled> {
        let (model, measures) = (&part.model, part.surface.measures());
        let mut parts = model.part_summaries();
        for row in &mut parts {
            row.thickness = part.lengthened(row.thickness);
        }
        monitor.check()?;
        let part_bounds = part_bounds(part);
        monitor.check()?;
        let moments = moments_of_parts(model, part.settings.length_factor, monitor)?;
        let used = part.chosen_part_ids().into_iter().collect();
        let joined = joined_parts(model, &used);
        monitor.check()?;
        Ok(Self {
            parts,
            used,
            joined,
            tools: model.tools().into_iter().collect(),
            part_bounds,
            moments,
            bounds: part.mesh.aabb(),
            area: measures.area,
            edge_length: measures.mean_edge_length,
            mean_normal: measures.mean_normal,
            landmarks: landmarks(part),
            thickness: part.mean_thickness(),
            formed: FormingEvidence::of(model),
        })
    }
}

/// The landmarks of the parts, each border among those of the part of its first vertex. O(triangles).
fn landmarks(part: &LoadedPart) -> BTreeMap<u64, Landmarks> {
    let mesh = part.surface.mesh();
    let mut part_of_vertex = vec![0; mesh.n_vertices()];
    for (triangle, &owner) in mesh.triangles().iter().zip(part.ids.parts()) {
        for &vertex in triangle {
            part_of_vertex[vertex as usize] = owner;
        }
    }
    let mut borders: BTreeMap<u64, Vec<&Border>> = BTreeMap::new();
    for border in part.surface.borders() {
        let Some(&first) = border.vertices.first() else {
            continue;
        };
        let owner = part_of_vertex[first as usize];
        let id = part.model.parts[owner as usize].id;
        borders.entry(id).or_default().push(border);
    }
    let of_part = |(id, borders)| (id, Landmarks::of(mesh, borders));
    borders.into_iter().map(of_part).collect()
}

fn part_bounds(part: &LoadedPart) -> BTreeMap<u64, Aabb> {
    let mut bounds = vec![Aabb::empty(); part.model.parts.len()];
    for (triangle, &part_idx) in part.ids.parts().iter().enumerate() {
        for corner in part.mesh.corners(triangle) {
            bounds[part_idx as usize].insert(&corner);
        }
    }
    let boxes = part.model.parts.iter().zip(bounds);
    boxes
        .filter(|(_, bounds)| !bounds.is_empty())
        .map(|(part, bounds)| (part.id, bounds))
        .collect()
}
