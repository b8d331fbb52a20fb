//! Which pairs cannot count, whatever their distance.

use crate::geometry::Point3;
use crate::registration::surface::Surface;
use crate::search::SurfaceHit;

/// Which pairs may not count at all, before any selection by distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RejectRules {
    /// Only partners whose normal n′ has n · n′ of at least this count; −1 lets all through. The
    /// closest compatible partner is searched, so the other side of a flange or of a U does not
    /// hide the right one.
    pub min_cos: f64,
    /// Partners farther away do not count.
    pub max_distance: f64,
    /// Points that lie beyond the border by more than this have no partner (Turk and Levoy 1994):
    /// their closest point on the border is not where they belong. Infinite switches the rule off.
    pub max_overhang: f64,
}

impl Default for RejectRules {
    fn default() -> Self {
        Self {
            min_cos: -1.0,
            max_distance: f64::INFINITY,
            max_overhang: f64::INFINITY,
        }
    }
}

impl RejectRules {
    /// True if `moved`, whose closest point is `hit`, lies beyond the border of the model.
    pub(crate) fn rejects(&self, model: &Surface, hit: &SurfaceHit, moved: &Point3) -> bool {
        if self.max_overhang.is_infinite() || !model.is_on_border(hit) {
            return false;
        }
        let offset = moved - hit.point;
        let normal = model.mesh().normal(hit.triangle as usize);
        let sideways = offset - normal * offset.dot(&normal);
        sideways.norm() > self.max_overhang
    }
}
