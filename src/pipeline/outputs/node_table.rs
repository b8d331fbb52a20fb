//! How far every node of both parts lies from the other part, as a table.

use crate::assess::PoseUncertainty;
use crate::assess::deviation::{DeviationField, DeviationSettings, OverlapClass, both_ways};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{Point3, Similarity};
use crate::monitor::Monitor;
use crate::pipeline::PipelineError;
use crate::pipeline::id_map::NodeVertex;
use crate::pipeline::load::LoadedPart;
use crate::pipeline::units::PairUnits;
use crate::registration::Surface;
use crate::report::csv::{NodeDeviation, add_deviations, deviation_head};
use crate::report::{DIRECTION, build_id};
use crate::role::{PerRole, Role};
use crate::search::{SurfaceHit, closest_many};

/// Measures both directions: first the nodes of the stamped part, then those of the crash part, in
/// the order of their files. `uncertainty` is that of the pose, where it is known. O(n · log n) in the
/// nodes of both.
pub fn node_deviations(
    parts: PerRole<&LoadedPart>,
    crash_from_stamped: &Similarity,
    uncertainty: Option<&PoseUncertainty>,
    monitor: &Monitor,
) -> Result<(Vec<NodeDeviation>, DeviationField), PipelineError> {
    let PerRole { crash, stamped } = parts;
    let (target, source) = (&crash.surface, &stamped.surface);
    let pose = crash_from_stamped;
    let settings = DeviationSettings::default();
    let [forth, back] = both_ways(source, target, pose, &settings, monitor)?;
    let still = Similarity::identity();
    let mut rows = Vec::new();
    let ways = [
        (Role::Stamped, pose, target, *pose, &forth),
        (Role::Crash, &still, source, pose.inverse(), &back),
    ];
    for (role, world_from_own, other, other_from_own, field) in ways {
        let (own, other_part) = (*parts.get(role), *parts.get(role.other()));
        let hits = nearest(own, other, &other_from_own, monitor)?;
        rows.extend(own.ids.nodes().iter().map(|&NodeVertex { node, vertex }| {
            let vertex = vertex as usize;
            let hit = hits.get(vertex).and_then(Option::as_ref);
            let at = world_from_own.apply(&own.mesh.positions()[vertex]);
            let stated = uncertainty.filter(|_| role == Role::Stamped);
            NodeDeviation {
                role,
                node: own.model.nodes.ids()[node as usize],
                at,
                distance: field.signed[vertex],
                class: field.class[vertex],
                nearest_element: hit.and_then(|hit| other_part.element_id(hit.triangle)),
                pose_uncertainty: stated.map(|stated| stated.at(&at)),
            }
        }));
    }
    Ok((rows, forth))
}

/// The place of the other part that is nearest to each vertex of the mesh.
fn nearest(
    own: &LoadedPart,
    other: &Surface,
    other_from_own: &Similarity,
    monitor: &Monitor,
) -> Result<Vec<Option<SurfaceHit>>, PipelineError> {
    let moved = |point: &Point3| other_from_own.apply(point);
    let queries: Vec<Point3> = own.mesh.positions().iter().map(moved).collect();
    Ok(closest_many(other.bvh(), &queries, f64::INFINITY, monitor)?)
}

/// The table as text, with what its numbers mean at its head.
pub fn node_table(
    parts: PerRole<&LoadedPart>,
    crash_from_stamped: &Similarity,
    uncertainty: Option<&PoseUncertainty>,
    monitor: &Monitor,
) -> Result<String, PipelineError> {
    let (rows, field) = node_deviations(parts, crash_from_stamped, uncertainty, monitor)?;
    let sign = if field.is_signed {
        "positive where the stamped part lies in front of the crash part (side of its normals)"
    } else {
        "without sign, because the crash part has no consistent sides"
    };
    let side = |part: &LoadedPart| {
        let hash = part
            .hash()
            .map_or_else(String::new, |hash| format!(", SHA-256 {hash}"));
        format!("{}{hash}", part.file_name())
    };
    let mut comments = vec![
        "Distances of the nodes of both parts from the other part".to_owned(),
        format!("crash: {}", side(parts.crash)),
        format!("stamped: {}", side(parts.stamped)),
        DIRECTION.to_owned(),
    ];
    comments.extend(PairUnits::sentences(parts));
    comments.extend([
        "x y z: where the node lies in the crash part's frame, stamped nodes moved".to_owned(),
        format!(
            "distance: to the other part, {sign}; beside a border of it the height over its sheet"
        ),
        format!(
            "class: matched within {}; off: {}; only_here: {}, because the other part ends there",
            field.limit,
            OverlapClass::OffByMore.label(),
            OverlapClass::OnlyHere.label()
        ),
        "pose_uncertainty: how far the pose of the match may be off at this stamped node; empty where it \
         is not known"
            .to_owned(),
        build_id(),
    ]);
    let mut table = deviation_head(&comments, rows.len());
    for_chunks(rows.len(), monitor, |some| {
        add_deviations(&mut table, &rows[some]);
    })?;
    Ok(table)
}
