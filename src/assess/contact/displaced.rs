//! Pieces of a part that meet nothing while the other part does not end there: a flange or a hem that is not where it
//! belongs, or one that is bent the other way or not at all.

use rayon::prelude::*;

use super::{Contact, ContactSearch, Contacts, MIN_FACING, NodesOnSurface, is_beside};
use crate::geometry::Similarity;
use crate::registration::WeightedNode;
use crate::search::ClosestPoint;

/// Such a piece is looked for up to so many times the distance within which parts meet.
const FARTHEST: f64 = 4.0;

impl ContactSearch<'_> {
    /// The nodes of the smaller part that meet nothing, which `contacts` under this pose name, and lie over a place of
    /// the larger one that meets nothing either, as where they met. What was trimmed lies beside the other part, and
    /// what lies over a sheet that meets another place is one more layer. O(nodes that meet nothing · log triangles).
    pub(in crate::assess) fn displaced(
        &self,
        pose: &Similarity,
        contacts: &Contacts,
    ) -> Vec<Contact> {
        let sides = NodesOnSurface::new([self.source, self.target], pose, self.of_source);
        let displaced = contacts.unmet.par_iter().filter_map(|&node| {
            let far = sides.contact(node, FARTHEST * self.reach, None, &mut None)?;
            (!sides.is_met_beneath(node, self.reach)).then_some(far)
        });
        displaced.collect()
    }

    /// The nodes of the smaller part that meet nothing, which `contacts` under this pose name, and turn away from the
    /// place of the larger one closest to them, farther away than `least`, which is none of its borders: there both
    /// parts go on, each its own way. What was trimmed ends. O(nodes that meet nothing · log triangles).
    pub(in crate::assess) fn astray(
        &self,
        pose: &Similarity,
        contacts: &Contacts,
        least: f64,
    ) -> Vec<Contact> {
        let sides = NodesOnSurface::new([self.source, self.target], pose, self.of_source);
        let nodes = contacts.unmet.par_iter();
        nodes
            .filter_map(|&node| sides.astray(node, least))
            .collect()
    }
}

impl NodesOnSurface<'_> {
    /// A node and the way from the model's surface to it, if that is longer than `least` and begins off its borders.
    fn astray(&self, node: WeightedNode, least: f64) -> Option<Contact> {
        let Self { data, model, .. } = self;
        let position = data.mesh().positions()[node.vertex as usize];
        let moved = self.model_from_data.apply(&position);
        let hit = model.bvh().closest(&moved, f64::INFINITY, None, None)?;
        let away = moved - hit.point;
        let length = away.norm() * self.unit;
        let normal = model.normal_at(&hit);
        let own = self
            .model_from_data
            .rotate(&data.vertex_normals()[node.vertex as usize]);
        let turns_away = own.dot(&normal).abs() < MIN_FACING;
        if length <= least || !turns_away || model.is_on_border(&hit) {
            return None;
        }
        let (point, of_target, side) = if self.of_source {
            (moved, normal, 1.0)
        } else {
            (position, self.pose.rotate(&normal), -1.0)
        };
        Some(Contact {
            point,
            normal: of_target,
            gap: length.copysign(side * away.dot(&normal)),
            weight: node.area,
            // They explain nothing of it.
            facet: 0.0,
        })
    }

    /// Whether the place of the model closest to a node has a counterpart on the other part within `reach`.
    fn is_met_beneath(&self, node: WeightedNode, reach: f64) -> bool {
        let Self { data, model, .. } = self;
        let moved = self
            .model_from_data
            .apply(&data.mesh().positions()[node.vertex as usize]);
        let Some(beneath) = model.bvh().closest(&moved, f64::INFINITY, None, None) else {
            return false;
        };
        let data_from_model = self.model_from_data.inverse();
        let at = data_from_model.apply(&beneath.point);
        let reach = reach / self.unit * data_from_model.scale;
        data.bvh()
            .closest(&at, reach, None, None)
            .is_some_and(|hit| {
                let normal = data_from_model.rotate(&model.normal_at(&beneath));
                let is_facing = normal.dot(&data.normal_at(&hit)).abs() >= MIN_FACING;
                is_facing && !(data.is_on_border(&hit) && is_beside(data, &hit, &at))
            })
    }
}
