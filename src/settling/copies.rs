//! Poses on copies of the component that a part lies on. A crash model has brackets several times, parts that are
//! matched as one may hold two of them, and a die may form two parts at once. A part turned by half a turn about one of
//! its principal axes may be a copy of itself.

use rayon::prelude::*;

use super::candidate::{Candidate, FewPlaces, Judged, LITTLE_LESS, judged};
use super::chosen_pose::{ChosenPose, as_likely, beaten};
use super::context::PairContext;
use super::refine_with_borders::Refinement;
use crate::assess::contact::{MAX_NODES, Meeting};
use crate::assess::tolerance::{UNREMARKABLE, is_source_smaller};
use crate::geometry::{Matrix3, Point3, Similarity, TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::{
    Alternative, MatchOutcome, Surface, axes_on_axes, principal_frame, same_pose,
};
use crate::search::ClosestPoint as _;

/// Vertices of a part that tell which component of the other it lies on.
const N_PLACES: usize = 300;
/// A copy has the area and the spread of the component up to this share of them.
const LIKE: f64 = 0.03;
/// What lies nearer than this share of the component's spread is a further layer of the sheet and no copy.
const LAYER: f64 = 0.3;
/// Components that are compared, those whose area is most alike first.
const MOST_COMPARED: usize = 32;
/// Copies that are tried.
const MOST: usize = 4;
/// Poses under which less than this share of what meets under the result does are not looked at.
const NEARLY_AS_MUCH: f64 = 0.8;

/// The pose of `outcome` with those beside it under which the source lies on copies of the component that it lies on,
/// or a copy of the source's component does, and its half turns that fit; one of them takes its place where the shapes
/// surely differ less there. `None` where there are no copies, where it fits none of them, and where rivals were not to
/// be looked for.
/// O(triangles + copies · (border edges + nodes · log triangles)).
pub fn placed_on_copies(
    context: &PairContext<'_>,
    outcome: &MatchOutcome,
) -> Result<Option<ChosenPose>, Cancelled> {
    context.check()?;
    if !outcome.rivals_sought {
        return Ok(None);
    }
    let found = &outcome.target_from_source;
    let mut first = poses_on_copies(context, found)?;
    let few = FewPlaces::new(context, found.scale);
    let own = few.meeting(found);
    let least = NEARLY_AS_MUCH * own.share;
    first.extend(half_turns(context, found, (&few, own)));
    if first.is_empty() {
        return Ok(None);
    }
    let refinement = Refinement::new(context, found.scale, MAX_NODES);
    let settle = |pose: &Similarity| {
        context.check()?;
        if few.meeting(pose).share < least {
            return Ok(None);
        }
        Ok(Some(refinement.closest(pose)?.unwrap_or(*pose)))
    };
    let settled: Result<Vec<Option<Similarity>>, Cancelled> =
        first.par_iter().map(settle).collect();
    let settled: Vec<Similarity> = settled?.into_iter().flatten().collect();
    let Judged { result, candidates } = judged(context, found, &settled, |pose, shape| {
        few.candidate(pose, shape)
    })?;
    let fits = |copy: &&Candidate| copy.meets_as_much_as(&result) && !result.beats(copy);
    let copies: Vec<&Candidate> = candidates.iter().filter(fits).collect();
    let better = copies.iter().filter(|copy| copy.beats(&result));
    let better = better.min_by_key(|copy| copy.n_differences);
    let winner = better.copied().unwrap_or(&result);
    let noise = context.distances(found.scale).noise;
    let rated = |other: &Candidate| {
        let alternative = as_likely(other.pose, outcome);
        match other.ratio_to(winner, noise) {
            Some(score_ratio) => Alternative {
                score_ratio,
                ..alternative
            },
            None => beaten(alternative),
        }
    };
    let rated = copies.into_iter().chain([&result]).map(rated);
    let others: Vec<Alternative> = rated.chain(outcome.alternatives.iter().copied()).collect();
    Ok(Some(ChosenPose::new(
        winner.pose,
        others.into_iter(),
        context.source,
    )))
}

/// The half turns of the smaller part about its principal axes, under which as much of it lies about as close to the
/// other part.
fn half_turns(
    context: &PairContext<'_>,
    pose: &Similarity,
    (few, own): (&FewPlaces<'_>, Meeting),
) -> Vec<Similarity> {
    let [source, target] = context.surfaces();
    let is_of_source = is_source_smaller(source, target, pose.scale);
    let measures = if is_of_source { source } else { target }.measures();
    let frame = (measures.centroid, measures.principal_axes);
    let distances = context.distances(pose.scale);
    let most = distances
        .as_close_as(UNREMARKABLE, own.gap)
        .max(distances.tolerance.springback);
    let turned = axes_on_axes(frame, frame).into_iter().map(|turn| {
        if is_of_source {
            pose.after(&turn)
        } else {
            turn.after(pose)
        }
    });
    let fits = |turned: &Similarity| {
        let meeting = few.meeting(turned);
        meeting.share >= own.share - LITTLE_LESS && meeting.gap <= most
    };
    let part = source.measures().into();
    turned
        .filter(|turned| !same_pose(turned, pose, &part) && fits(turned))
        .collect()
}

/// The pose moved to each copy of the component that the source lies on, and of the one of the source that the target
/// lies on, in the four ways that bring the principal directions of one to those of the other.
fn poses_on_copies(
    context: &PairContext<'_>,
    pose: &Similarity,
) -> Result<Vec<Similarity>, Cancelled> {
    let [source, target] = context.surfaces();
    let on_target = motions_to_copies(target, source, pose, context.monitor)?;
    let on_source = motions_to_copies(source, target, &pose.inverse(), context.monitor)?;
    let on_target = on_target.iter().map(|motion| motion.after(pose));
    let on_source = on_source.iter().map(|motion| pose.after(&motion.inverse()));
    Ok(on_target.chain(on_source).collect())
}

/// Motions of the component of `part` that most of `other` lies on to its copies. Nearly O(triangles).
fn motions_to_copies(
    part: &Surface,
    other: &Surface,
    part_from_other: &Similarity,
    monitor: &Monitor,
) -> Result<Vec<Similarity>, Cancelled> {
    let (component_of, n_components) = part.mesh().components();
    monitor.check()?;
    if n_components < 2 {
        return Ok(Vec::new());
    }
    let vertices = other.mesh().positions();
    let step = vertices.len().div_ceil(N_PLACES).max(1);
    let hits = vertices.iter().step_by(step).filter_map(|vertex| {
        let place = part_from_other.apply(vertex);
        let hit = part.bvh().closest(&place, f64::INFINITY, None, None)?;
        Some(component_of[hit.triangle as usize])
    });
    let mut hits: Vec<u32> = hits.collect();
    hits.sort_unstable();
    let groups = hits.chunk_by(|a, b| a == b);
    let most = groups.max_by_key(|group| group.len());
    let Some(met) = most.filter(|group| 2 * group.len() > hits.len()) else {
        return Ok(Vec::new());
    };
    let found = Component::like(part.mesh(), met[0], (&component_of, n_components), monitor)?;
    let Some((own, others)) = found.split_first() else {
        return Ok(Vec::new());
    };
    let copies = others.iter().filter(|other| other.is_copy_of(own));
    let motions = copies
        .take(MOST)
        .flat_map(|copy| axes_on_axes((own.centroid, own.axes), (copy.centroid, copy.axes)));
    Ok(motions.collect())
}

/// Where a component lies, and how large it is.
struct Component {
    centroid: Point3,
    /// Principal directions as columns.
    axes: Matrix3,
    /// Standard deviation along them.
    spread: Vector3,
}

impl Component {
    /// Component `own` of a mesh, and then those of like area. `component_of` gives the number of every triangle's.
    fn like(
        mesh: &TriMesh,
        own: u32,
        (component_of, n_components): (&[u32], usize),
        monitor: &Monitor,
    ) -> Result<Vec<Self>, Cancelled> {
        let mut areas = vec![0.0; n_components];
        for (triangle, &component) in component_of.iter().enumerate() {
            areas[component as usize] += mesh.triangle_area(triangle);
        }
        monitor.check()?;
        let own_area = areas[own as usize];
        let off = |component: u32| (areas[component as usize] - own_area).abs();
        let mut like: Vec<u32> = (0..n_components as u32)
            .filter(|&component| component != own && off(component) <= LIKE * own_area)
            .collect();
        like.sort_by(|&a, &b| off(a).total_cmp(&off(b)));
        like.truncate(MOST_COMPARED);
        like.insert(0, own);
        let mut corners = vec![Vec::new(); like.len()];
        for (triangle, component) in component_of.iter().enumerate() {
            if let Some(place) = like.iter().position(|other| other == component) {
                corners[place].extend(mesh.corners(triangle));
            }
        }
        monitor.check()?;
        let each = corners.into_iter();
        each.map(|corners| Self::of(corners, monitor)).collect()
    }

    /// That of triangles with these corners.
    fn of(corners: Vec<Point3>, monitor: &Monitor) -> Result<Self, Cancelled> {
        let vertices: Vec<u32> = (0..corners.len() as u32).collect();
        let (triangles, _) = vertices.as_chunks();
        let mesh = TriMesh::new(corners, triangles.to_vec()).expect("each corner is a vertex");
        let vectors: Vec<Vector3> = (0..mesh.n_triangles())
            .map(|triangle| mesh.area_vector(triangle))
            .collect();
        let (centroid, axes, spread) = principal_frame(&mesh, &vectors, mesh.area(), monitor)?;
        Ok(Self {
            centroid,
            axes,
            spread,
        })
    }

    fn is_copy_of(&self, other: &Self) -> bool {
        let size = other.spread.norm();
        (self.spread - other.spread).amax() <= LIKE * size
            && (self.centroid - other.centroid).norm() > LAYER * size
    }
}
