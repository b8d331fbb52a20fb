//! The evidence of a pose: where the surfaces and the borders of two parts meet under it. The search for it is
//! prepared once and asked for one pose after another.

use super::borders::{BorderComparison, Borders};
use super::contact::{Contact, ContactSearch, Contacts, MAX_NODES};
use super::coverage::FarNodes;
use super::least_squares::NormalEquations;
use super::tolerance::Distances;
use crate::geometry::{Point3, Similarity};
use crate::registration::Surface;

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
    /// Nodes of both parts that lie farther apart than the tolerance, where all were measured; else none.
    pub(super) far: [FarNodes; 2],
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

    /// Where the far nodes meet the other part: those of the source, and those of the target.
    /// O(far nodes · log triangles).
    pub(super) fn of_far(&self) -> [Vec<Contact>; 2] {
        let search = self.search();
        let [of_source, of_target] = &self.far;
        [(true, of_source), (false, of_target)]
            .map(|(of_source, far)| search.of_nodes(&self.pose, of_source, &far.nodes))
    }

    /// Places of the smaller part that lie over a place of the larger one, where neither meets anything.
    /// O(nodes that meet nothing · log triangles).
    pub(super) fn displaced(&self) -> Vec<Contact> {
        self.search().displaced(&self.pose, &self.contacts)
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
            far: Default::default(),
        })
    }
}
