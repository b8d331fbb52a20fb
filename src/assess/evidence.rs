//! The evidence of a pose: where the surfaces and the borders of two parts meet under it. The search for it is
//! prepared once and asked for one pose after another.

use rayon::prelude::*;

use super::borders::{BorderComparison, Borders};
use super::contact::{Contact, ContactSearch, Contacts, MAX_NODES};
use super::coverage::{NearNode, NearNodes};
use super::least_squares::NormalEquations;
use super::tolerance::Distances;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::registration::{Surface, WeightedNode};

/// Two parts under a pose, and where they meet.
pub(crate) struct PoseEvidence<'a> {
    pub(crate) source: &'a Surface,
    pub(super) target: &'a Surface,
    pub(crate) pose: Similarity,
    pub(crate) contacts: Contacts,
    pub(crate) borders: Borders,
    /// Faceting of both meshes.
    pub(super) noise: f64,
    /// Surfaces within it are compared.
    pub(super) reach: f64,
    /// The largest offset between two skins of one sheet.
    pub(super) most_offset: f64,
    /// Nodes of both parts within reach of the other, where all were measured; else none.
    pub(super) near: [NearNodes; 2],
}

impl PoseEvidence<'_> {
    /// The pose moved to where the squares of the distances of the surfaces, without an offset, are least; what lies
    /// far apart counts in full, as beads do beside the smooth rest. O(places).
    pub(crate) fn closer_surfaces(&self) -> Similarity {
        let contacts = &self.contacts;
        let mut equations = NormalEquations::<6>::default();
        let gaps = contacts.without_offset(f64::INFINITY);
        for (contact, gap) in contacts.list.iter().zip(gaps) {
            let row = contacts.row(&contact.point, &contact.normal);
            equations.add(&row, gap, contact.weight);
        }
        contacts.undo(&equations.solved()).after(&self.pose)
    }

    /// Share of the smaller part's area that lies beyond the borders of the other.
    pub(super) fn overhang(&self) -> f64 {
        self.search().overhang(&self.pose)
    }

    /// Where nodes of the larger part meet the smaller one: those that lie where `is_asked` says.
    /// O(nodes + places · log triangles).
    pub(super) fn of_larger(&self, is_asked: impl Fn(&Point3) -> bool + Sync) -> Vec<Contact> {
        self.search().of_larger(&self.pose, is_asked)
    }

    /// Where nodes meet the other part: those of the source, and those of the target, of which `is_asked` says so by
    /// a rough place, normal and gap; those that lie nearer than `least` are not. None of a side of which more than
    /// `most` are.
    /// O(nodes near the other part + nodes asked · log triangles).
    pub(super) fn of_near(
        &self,
        least: f64,
        is_asked: impl Fn(&Point3, &Vector3, f64) -> bool + Sync,
        most: usize,
    ) -> [Vec<Contact>; 2] {
        let search = self.search();
        [true, false].map(|of_source| {
            let near = &self.near[usize::from(!of_source)];
            let data = if of_source { self.source } else { self.target };
            let far = near.nodes.par_iter().filter(|near| near.distance >= least);
            let asked = far.filter(|near| {
                let (point, normal, gap) = self.roughly(near, of_source);
                is_asked(&point, &normal, gap)
            });
            let asked = asked.map(|place| {
                let mut node = WeightedNode::of(data, place.node);
                node.area *= near.per_node as f64;
                node
            });
            let asked: Vec<WeightedNode> = asked.collect();
            if asked.len() > most {
                return Vec::new();
            }
            search.of_nodes(&self.pose, of_source, &asked)
        })
    }

    /// A contact by the plane of the closest triangle: place, normal on the target's side, and how far the source lies
    /// in front of the target.
    fn roughly(&self, near: &NearNode, of_source: bool) -> (Point3, Vector3, f64) {
        let (data, model, model_from_data) = if of_source {
            (self.source, self.target, self.pose)
        } else {
            (self.target, self.source, self.pose.inverse())
        };
        let position = data.mesh().positions()[near.node as usize];
        let moved = model_from_data.apply(&position);
        let [corner, ..] = model.mesh().corners(near.triangle as usize);
        let normal = model.mesh().normal(near.triangle as usize);
        let gap = near.distance.copysign((moved - corner).dot(&normal));
        if of_source {
            return (moved, normal, gap);
        }
        let own = data.vertex_normals()[near.node as usize];
        let side = self.pose.rotate(&normal).dot(&own).signum();
        (position, own, -gap * side)
    }

    /// Places of the smaller part that lie over a place of the larger one, where neither meets anything.
    /// O(nodes that meet nothing · log triangles).
    pub(super) fn displaced(&self) -> Vec<Contact> {
        self.search().displaced(&self.pose, &self.contacts)
    }

    /// Places of the smaller part that meet nothing although the larger one does not end there, and lie off it by more
    /// than `least`. O(nodes that meet nothing · log triangles).
    pub(super) fn astray(&self, least: f64) -> Vec<Contact> {
        self.search().astray(&self.pose, &self.contacts, least)
    }

    fn search(&self) -> ContactSearch<'_> {
        let pair = [self.source, self.target];
        ContactSearch::new(pair, self.pose.scale, self.reach, MAX_NODES)
    }
}

/// The search for what two parts show. Both are prepared once for all poses of one scale.
pub(crate) struct EvidenceSearch<'a, 'b> {
    contacts: ContactSearch<'a>,
    borders: &'b BorderComparison<'a>,
    noise: f64,
    most_offset: f64,
}

impl<'a, 'b> EvidenceSearch<'a, 'b> {
    pub(crate) fn new(
        contacts: ContactSearch<'a>,
        borders: &'b BorderComparison<'a>,
        distances: &Distances,
    ) -> Self {
        Self {
            contacts,
            borders,
            noise: distances.noise,
            most_offset: distances.most_offset,
        }
    }

    /// What the parts show under a pose; `None` where their surfaces do not meet.
    /// O(border edges + nodes · log triangles), less for a pose near the last one.
    pub(crate) fn at(&mut self, pose: &Similarity) -> Option<PoseEvidence<'a>> {
        let contacts = self.contacts.at(pose)?;
        let [source, target] = self.contacts.surfaces();
        Some(PoseEvidence {
            source,
            target,
            pose: *pose,
            contacts,
            borders: self.borders.at(pose),
            noise: self.noise,
            reach: self.contacts.reach(),
            most_offset: self.most_offset,
            near: Default::default(),
        })
    }
}
