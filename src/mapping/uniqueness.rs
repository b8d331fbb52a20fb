//! Is there a second sheet that would do as well?

use super::element::Context;
use super::gather::Centre;
use super::source::PreparedSource;

/// A second sheet whose distance makes the first more than this share of it is as good a partner.
pub(super) const AMBIGUOUS_RATIO: f64 = 0.7;
/// Where more elements than these lie between, two are taken for one sheet.
const MOST_SEEN: usize = 400;

impl Context<'_> {
    /// 1 without a second compatible sheet within reach; else 2 · (1 − d₁/d₂), at most 1.
    pub(super) fn uniqueness(&self, element: usize, centre: &Centre, reach: f64) -> f64 {
        let from = self.target.mesh.centroids()[element];
        let normal = self.target.mesh.normals()[element];
        let first = centre.point.distance_sq.sqrt();
        let mut uniqueness = 1.0_f64;
        let step = 1e-6 * self.target.mesh.size(element);
        // From just beyond the first sheet, and from the centre on the side where it does not lie: no compatible
        // sheet is nearer than the first.
        let along = (centre.point.point - from).dot(&normal);
        let beyond = [along, -along].map(|along| along.max(0.0) + step);
        for (number, source) in self.sources.iter().enumerate() {
            let found = source.next_sheets(&from, &normal, beyond, reach);
            for (other, second) in found.into_iter().flatten() {
                let partner = (centre.source as usize, centre.point.element);
                if second >= reach
                    || second <= first + step
                    || !self.is_compatible(element, number, other)
                    || (number == partner.0
                        && source.is_near_along_sheet(partner.1, other, 2.0 * reach))
                {
                    continue;
                }
                uniqueness = uniqueness.min(2.0 * (1.0 - first / second));
            }
        }
        uniqueness.clamp(0.0, 1.0)
    }

    fn is_compatible(&self, element: usize, source: usize, other: u32) -> bool {
        let normal = self.target.mesh.normals()[element];
        let cos = self.sources[source].mesh.normals()[other as usize].dot(&normal);
        self.facing(element, source).cosine(cos) >= self.min_cos
    }
}

impl PreparedSource<'_> {
    /// True if two elements are linked by elements that all lie within `radius` of the first.
    fn is_near_along_sheet(&self, first: u32, second: u32, radius: f64) -> bool {
        let centre = self.mesh.centroids()[first as usize];
        let mut seen = vec![first];
        let mut at = 0;
        while let Some(&element) = seen.get(at) {
            at += 1;
            if element == second {
                return true;
            }
            for &other in self.neighbours().of(element as usize) {
                let is_near = (self.mesh.centroids()[other as usize] - centre).norm() <= radius;
                if is_near && !seen.contains(&other) {
                    seen.push(other);
                }
                if seen.len() > MOST_SEEN {
                    return true;
                }
            }
        }
        false
    }
}
