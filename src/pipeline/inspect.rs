//! How far two loaded parts lie from each other under a pose, ready to be drawn.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::PipelineError;
use super::load::LoadedPart;
use crate::assess::deviation::{
    self, Deviation, DeviationField, DeviationSettings, OneWay, OverlapClass, Spot,
    source_on_target, target_on_source,
};
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::registration::Surface;
use crate::role::{PerRole, Role};

/// The values of one mesh as they are drawn.
#[derive(Debug, Clone)]
pub struct DrawnDeviation {
    /// The mesh: a full one or a level.
    pub mesh: Arc<TriMesh>,
    /// Signed distance of each vertex; NaN where the other part is not there.
    pub signed: Arc<[f32]>,
    /// 0 matched, 1 off by more than the limit, NaN only here.
    pub overlap: Arc<[f32]>,
}

/// Two parts compared at one pose. The stamped part is the source, the crash part the target.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Pose the distances were taken at.
    pub crash_from_stamped: Similarity,
    /// Distances of the full meshes, in both directions.
    pub deviation: Deviation,
    /// What is drawn: both full meshes and both levels.
    pub drawn: Vec<DrawnDeviation>,
    /// Nodes of the worst spots of each part, in the order of its spots.
    pub spot_nodes: PerRole<Vec<Option<u64>>>,
    /// How long it took.
    pub took: Duration,
}

/// A worst spot with where it is in the decks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundSpot {
    /// Value and place.
    pub spot: Spot,
    /// The part the node belongs to.
    pub role: Role,
    /// The node in its deck.
    pub node: Option<u64>,
}

impl Comparison {
    /// The worst spots of both directions together, the worst first.
    pub fn worst_spots(&self) -> Vec<FoundSpot> {
        let of = |role: Role, way: &OneWay| {
            let spots = way.spots.iter().zip(self.spot_nodes.get(role));
            let found = spots.map(|(spot, node)| FoundSpot {
                spot: *spot,
                role,
                node: *node,
            });
            found.collect::<Vec<_>>()
        };
        let mut found = of(Role::Stamped, &self.deviation.source_on_target);
        found.extend(of(Role::Crash, &self.deviation.target_on_source));
        found.sort_by(|a, b| b.spot.value.abs().total_cmp(&a.spot.value.abs()));
        found
    }

    /// The values of a mesh, by identity.
    pub fn drawn(&self, mesh: &Arc<TriMesh>) -> Option<&DrawnDeviation> {
        self.drawn
            .iter()
            .find(|drawn| Arc::ptr_eq(&drawn.mesh, mesh))
    }
}

/// Compares two parts in both directions on their full meshes. Levels are measured against the full
/// mesh of the other part with the same limits, so that their colours mean the same.
pub fn compare_parts(
    parts: PerRole<&LoadedPart>,
    levels: PerRole<Option<&Arc<TriMesh>>>,
    crash_from_stamped: &Similarity,
    monitor: &Monitor,
) -> Result<Comparison, PipelineError> {
    let begin = Instant::now();
    let PerRole { crash, stamped } = parts;
    let (target, source) = (&crash.surface, &stamped.surface);
    let thickness = crash.mean_thickness().or_else(|| stamped.mean_thickness());
    let settings = DeviationSettings {
        thickness,
        ..DeviationSettings::default()
    };
    let pose = crash_from_stamped;
    let deviation = deviation::compare(source, target, pose, &settings, monitor)?;
    let settings = DeviationSettings {
        limit: Some(deviation.limit),
        reach: Some(deviation.source_on_target.field.reach),
        ..settings
    };
    let mut drawn = vec![
        draw(&crash.mesh, &deviation.target_on_source.field),
        draw(&stamped.mesh, &deviation.source_on_target.field),
    ];
    if let Some(level) = levels.crash {
        let reduced = Surface::build(level, "target", monitor)?;
        let field = target_on_source(source, &reduced, pose, &settings, monitor)?;
        drawn.push(draw(level, &field));
    }
    if let Some(level) = levels.stamped {
        let reduced = Surface::build(level, "source", monitor)?;
        let field = source_on_target(&reduced, target, pose, &settings, monitor)?;
        drawn.push(draw(level, &field));
    }
    let nodes = |part: &LoadedPart, way: &OneWay| {
        let spots = way.spots.iter();
        spots.map(|spot| part.node_id(spot.vertex)).collect()
    };
    Ok(Comparison {
        spot_nodes: PerRole {
            crash: nodes(crash, &deviation.target_on_source),
            stamped: nodes(stamped, &deviation.source_on_target),
        },
        crash_from_stamped: *crash_from_stamped,
        deviation,
        drawn,
        took: begin.elapsed(),
    })
}

fn draw(mesh: &Arc<TriMesh>, field: &DeviationField) -> DrawnDeviation {
    let values = 0..field.signed.len();
    let signed = values.map(|v| field.compared(v).map_or(f32::NAN, |d| d as f32));
    let overlap = field.class.iter().map(|class| match class {
        OverlapClass::Matched => 0.0,
        OverlapClass::OffByMore => 1.0,
        OverlapClass::OnlyHere => f32::NAN,
    });
    DrawnDeviation {
        mesh: Arc::clone(mesh),
        signed: signed.collect(),
        overlap: overlap.collect(),
    }
}
