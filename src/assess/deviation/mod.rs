//! How far each part lies from the other, vertex by vertex, with a sign.
//!
//! The sign is that of the crash normal for both directions: positive where the source lies in
//! front of the target, negative where it lies behind. So one place of the pair has one colour,
//! whichever of the two parts carries it.

mod field;
mod offset;
mod spots;
mod stats;

pub use field::{DeviationField, OverlapClass, both_ways, source_on_target, target_on_source};
pub use offset::{ConstantOffset, ConstantPart, OffsetKind};
pub use spots::{Spot, worst_spots};
pub use stats::{DeviationStats, Histogram};

use super::overlap_limit;
use super::tolerance::faceting;
use crate::geometry::Similarity;
use crate::monitor::{Cancelled, Monitor};
use crate::registration::Surface;

/// What a comparison depends on besides the parts and the pose. Lengths are target lengths.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DeviationSettings {
    /// Distance up to which a place counts as matched; by default [`overlap_limit`].
    pub limit: Option<f64>,
    /// Distance beyond which nothing is a counterpart; by default a twentieth of the target's
    /// diagonal.
    pub reach: Option<f64>,
    /// Thickness of the sheet, if known, for [`DeviationStats::offset`].
    pub thickness: Option<f64>,
}

/// Default reach as a share of the target's diagonal.
const REACH: f64 = 0.05;
/// A reach is never less than so many limits.
const LEAST_REACH: f64 = 2.0;
/// Worst spots that are listed, and how many mean edges lie between two of them.
const N_SPOTS: usize = 12;
const SPOT_EDGES: f64 = 6.0;

impl DeviationSettings {
    /// The limit that holds for two surfaces, under poses of this scale.
    pub fn limit_for(&self, source: &Surface, target: &Surface, scale: f64) -> f64 {
        self.limit
            .unwrap_or_else(|| overlap_limit(source, target, scale, 0.0))
    }

    /// The reach that holds for two surfaces: never less than twice the limit.
    pub fn reach_for(&self, source: &Surface, target: &Surface, scale: f64) -> f64 {
        let reach = self
            .reach
            .unwrap_or_else(|| REACH * target.measures().diagonal);
        reach.max(LEAST_REACH * self.limit_for(source, target, scale))
    }
}

/// One direction: values, numbers and worst places.
#[derive(Debug, Clone)]
pub struct OneWay {
    /// The value of every vertex.
    pub field: DeviationField,
    /// Numbers over the area that has a counterpart.
    pub stats: DeviationStats,
    /// The largest deviations, the worst first.
    pub spots: Vec<Spot>,
}

/// Both directions under one pose.
#[derive(Debug, Clone)]
pub struct Deviation {
    /// Source vertices against target triangles.
    pub source_on_target: OneWay,
    /// Target vertices against source triangles.
    pub target_on_source: OneWay,
    /// False where the target cannot be oriented: then all values are distances without a side.
    pub is_signed: bool,
    /// Distance up to which a place counts as matched, in target length units.
    pub limit: f64,
    /// Mean edge length of both meshes, source first, in target length units.
    pub mean_edge_lengths: [f64; 2],
}

/// Compares two parts in both directions. O(n · log n) in the vertices of both, on all threads.
pub fn compare(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    settings: &DeviationSettings,
    monitor: &Monitor,
) -> Result<Deviation, Cancelled> {
    let pose = target_from_source;
    let [forth, back] = both_ways(source, target, pose, settings, monitor)?;
    let noise = faceting([source, target], pose.scale);
    let finish = |field: DeviationField, surface: &Surface, scale: f64| {
        let separation = SPOT_EDGES * surface.measures().mean_edge_length;
        let spots = worst_spots(&field, surface, scale, separation * scale, N_SPOTS);
        monitor.check()?;
        let stats = DeviationStats::of(&field, settings.thickness, noise);
        Ok(OneWay {
            field,
            stats,
            spots,
        })
    };
    monitor.check()?;
    let source_on_target = finish(forth, source, pose.scale)?;
    monitor.check()?;
    let target_on_source = finish(back, target, 1.0)?;
    monitor.check()?;
    Ok(Deviation {
        is_signed: source_on_target.field.is_signed,
        limit: source_on_target.field.limit,
        source_on_target,
        target_on_source,
        mean_edge_lengths: [
            source.measures().mean_edge_length * pose.scale,
            target.measures().mean_edge_length,
        ],
    })
}
