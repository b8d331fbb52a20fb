//! Points on an edge or a node that several elements share: rounding alone would decide which of them they are on,
//! and with it whose values they take, so that results would change with the order of corners.

use super::source::{PartnerFilter, PreparedSource};
use crate::geometry::Point3;

/// Weights of a triangle's corners up to this are rounding.
pub(super) const ON_EDGE: f64 = 1e-9;

impl PreparedSource<'_> {
    /// Of the elements that share a point on the border of `own`, which is an element and whether it is flipped, the
    /// one with the lowest number that the filter lets through. The point is given by corners of `own` and their
    /// weights.
    pub(super) fn lowest_sharing(
        &self,
        own: (u32, bool),
        corners: &[(Point3, f64); 3],
        filter: &PartnerFilter,
    ) -> (u32, bool) {
        let mesh = &self.mesh;
        let holds = |element: usize| {
            let theirs = mesh.corner_points(element);
            let mut ends = corners.iter().filter(|(_, weight)| *weight > ON_EDGE);
            ends.all(|(end, _)| theirs.contains(end))
        };
        let neighbours = self.neighbours().of(own.0 as usize).iter();
        let lower = neighbours.copied().take_while(|&other| other < own.0);
        let cosines =
            lower.map(|other| (other, mesh.normals()[other as usize].dot(&filter.normal)));
        let mut sharing = cosines.filter(|&(other, cos)| {
            mesh.areas()[other as usize] > 0.0
                && filter.facing.cosine(cos) >= filter.min_cos
                && holds(other as usize)
        });
        sharing
            .next()
            .map_or(own, |(other, cos)| (other, cos < 0.0))
    }

    /// The thickness between those corners of an element, by their weights; NaN if it has none at one of them.
    pub(super) fn thickness_between(&self, element: u32, corners: &[(Point3, f64); 3]) -> f64 {
        let Some(values) = self.corner_thickness(element as usize) else {
            return f64::NAN;
        };
        let own = self.mesh.corner_points(element as usize);
        let known = corners.iter().filter(|(_, weight)| *weight > ON_EDGE);
        let (mut sum, mut weights) = (0.0, 0.0);
        for (corner, weight) in known {
            let at = own.iter().position(|own| own == corner);
            sum += weight * at.map_or(f64::NAN, |at| values[at]);
            weights += weight;
        }
        sum / weights
    }
}
