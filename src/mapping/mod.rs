//! Carries forming results from the shells of stamped parts to the shells of a crash part.
//!
//! Every target element is covered by points; each point takes the closest compatible point of the
//! stamped sheet (distance, signed normal, border) and the linear field around it; the values are
//! averaged over the element, tensors are turned by the pose and into the element's tangent plane,
//! layers resampled from the stamped rule to the crash rule. Every element ends with one
//! [`Status`] and its reason, and none carries an invented value without a mark.
//!
//! Second order in the element size for smooth fields, exact for constants; the mean over the part
//! is kept to a few hundredths of a percent (`tests/core/mapping.rs`).

mod balance;
mod blend;
mod checks;
mod corners;
mod element;
mod error;
mod field;
mod fill;
mod gather;
mod history;
mod layered;
mod layers;
mod links;
mod nodal;
mod options;
mod patch;
mod points;
mod rule;
mod shared;
mod shells;
mod source;
mod target;
mod uniqueness;

pub use balance::ForceBalance;
pub use checks::{
    BackDifference, Distribution, MapBack, ValueHistogram, distribution, histogram_distance,
    map_back,
};
pub use error::MappingError;
pub use history::{LawGap, LayerHistory, MappedHistory, SourceHistory};
pub use layered::{Layered, PLASTIC_STRAIN, into_layers};
pub use layers::{LayerBalance, LayerMatrix};
pub use links::{Links, Neighbours};
pub use options::{MapMethod, MapOptions, NormalSense, Overlap, Quantities, Status, limits};
pub use rule::{LayerRule, RuleKind, SAME_PLACE};
pub use shells::ShellMesh;
pub use source::SourcePart;
pub use target::{ElementReport, Facing, Mapped, MappedLayers, Partner, TargetPart};

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::geometry::{Similarity, z_order_for};
use crate::monitor::{Cancelled, Monitor};
use element::{Buffers, Context, Limits, Scratch};
use points::PointRules;
use source::{PartnerFilter, PreparedSource, SourcePoint};

/// Target elements that are mapped between two questions for a cancel, and the unit of parallel work.
const CHUNK: usize = 1024;
/// Share of the area that must agree for normals to have a sign.
const SIGNED_SHARE: f64 = 0.9;
/// Elements with one sheet within reach decide if they make up this share of the area.
const LEAST_ALONE: f64 = 0.05;
/// Stamped parts that overlap on less than this share of the target touch by chance.
const CONFLICT_SHARE: f64 = 0.02;

/// A stamped part with its pose on the crash part.
#[derive(Debug, Clone, Copy)]
pub struct PlacedSource<'a> {
    /// The part in its own frame.
    pub part: &'a SourcePart,
    /// Pose of the source.
    pub target_from_source: Similarity,
}

/// Maps the results of `sources` onto `target`.
///
/// The result depends on the inputs alone, bit for bit, not on the number of threads. An error if a
/// mesh has no elements, if no source has a quantity that was asked for, if a choice lies outside
/// its range, or if `monitor` is cancelled. About a million partner searches per second and core.
pub fn map(
    sources: &[PlacedSource<'_>],
    target: &TargetPart,
    options: &MapOptions,
    monitor: &Monitor,
) -> Result<Mapped, MappingError> {
    check(sources, target, options)?;
    let has_history = |placed: &PlacedSource<'_>| !placed.part.history.is_empty();
    let mut options = options.clone();
    // Else history alone would ask for states, all of them 0.
    options.quantities.history &= sources.iter().any(has_history);
    let options = &options;
    let surfaces = LayerRule::surfaces();
    let has_surfaces_only = |placed: &PlacedSource<'_>| {
        let mut rules = placed.part.strains.rules().iter();
        rules.all(|rule| rule.has_places(surfaces.places()))
    };
    let strains_at_surfaces = sources.iter().all(has_surfaces_only);
    let (rules, turned_over) = rules_of_both_sides(&target.rules);
    let strain_rules = if strains_at_surfaces {
        vec![surfaces]
    } else {
        rules.clone()
    };
    let mut prepared = Vec::with_capacity(sources.len());
    for (number, placed) in sources.iter().enumerate() {
        monitor.check()?;
        monitor.progress("prepare mapping", number as u64, Some(sources.len() as u64));
        prepared.push(PreparedSource::new(
            placed.part,
            &placed.target_from_source,
            &rules,
            &strain_rules,
            options,
            monitor,
        )?);
    }
    let min_cos = options.max_angle_deg.to_radians().cos();
    let source_sizes: Vec<f64> = prepared
        .iter()
        .map(|source| usual_size(&source.mesh))
        .collect();
    monitor.check()?;
    let facings: Vec<Facing> = prepared
        .iter()
        .zip(&source_sizes)
        .map(|(source, &size)| facing(source, target, options, size))
        .collect();
    let is_reversed = reversed_targets(target, options, &facings, monitor)?;
    let context = Context {
        sources: &prepared,
        target,
        options,
        facings: &facings,
        is_reversed: &is_reversed,
        turned_over: &turned_over,
        points: PointRules::new(),
        min_cos,
        strains_at_surfaces,
        source_sizes: &source_sizes,
    };
    // Elements that are mapped together have most of their partners in common, however they are numbered.
    let order = z_order_for(target.mesh.centroids(), monitor)?;
    let chunks = map_chunks(&order, &context, monitor)?;
    let mut mapped = assemble(&chunks, &order, &context, monitor)?;
    monitor.check()?;
    mapped.history = history::carry(sources, target, &mapped.elements, options.quantities);
    monitor.check()?;
    fill::fill(&mut mapped, target, options, monitor)?;
    if options.corner_thickness && !mapped.thickness.is_empty() {
        mapped.corners = corners::corner_thickness(&mapped.thickness, target, monitor)?;
    }
    Ok(mapped)
}

fn check(
    sources: &[PlacedSource<'_>],
    target: &TargetPart,
    options: &MapOptions,
) -> Result<(), MappingError> {
    if target.mesh.area() <= 0.0 {
        return Err(MappingError::EmptyTarget);
    }
    if sources.is_empty() || sources.iter().any(|placed| placed.part.mesh.area() <= 0.0) {
        return Err(MappingError::EmptySource);
    }
    let wanted = options.quantities;
    let has_any = sources.iter().any(|placed| {
        let part = placed.part;
        (wanted.thickness
            && part
                .thickness
                .iter()
                .any(|t| source::mean_thickness(t).is_finite()))
            || ((wanted.stress || wanted.plastic_strain) && part.states.n_present() > 0)
            || (wanted.history && !part.history.is_empty())
            || (wanted.strain && part.strains.n_present() > 0)
    });
    if !has_any {
        return Err(MappingError::NoResults);
    }
    let setting = |name, value: f64, range| Err(MappingError::Setting { name, value, range });
    if let Some(distance) = options.max_distance
        && !limits::POSITIVE.contains(&distance)
    {
        return setting("the largest distance", distance, "above 0");
    }
    if !limits::ANGLE_DEG.contains(&options.max_angle_deg) {
        return setting("the largest angle", options.max_angle_deg, "1° to 90°");
    }
    if !limits::THICKNESS_SCALE.contains(&options.thickness_scale) {
        let range = "0.001 to 1000";
        return setting("the thickness factor", options.thickness_scale, range);
    }
    Ok(())
}

/// The rules, and behind them those of which the other side sees other layers, as it sees them; of each of all the
/// number of the one seen from the other side.
fn rules_of_both_sides(rules: &[LayerRule]) -> (Vec<LayerRule>, Vec<usize>) {
    let mut all = rules.to_vec();
    let mut turned_over: Vec<usize> = (0..rules.len()).collect();
    for (number, rule) in rules.iter().enumerate() {
        if !rule.is_symmetric() {
            turned_over[number] = all.len();
            turned_over.push(number);
            all.push(rule.turned_over());
        }
    }
    (all, turned_over)
}

/// Mean element size, doubled so that the coarser regions of a graded mesh count too.
fn usual_size(mesh: &ShellMesh) -> f64 {
    2.0 * (mesh.area() / mesh.len().max(1) as f64).sqrt()
}

/// Which side the normals point to, by area.
fn facing(
    source: &PreparedSource<'_>,
    target: &TargetPart,
    options: &MapOptions,
    source_size: f64,
) -> Facing {
    match options.normal_sense {
        NormalSense::Either => return Facing::Mixed,
        NormalSense::Signed => return Facing::Same,
        NormalSense::Auto => {}
    }
    // A thousand elements spread over the mesh tell the sign of all.
    let step = (target.mesh.len() / 1000).max(1);
    let ask = |element: usize| {
        let normal = target.mesh.normals()[element];
        let centre = target.mesh.centroids()[element];
        let closest = |facing| {
            let filter = PartnerFilter {
                normal,
                min_cos: options.max_angle_deg.to_radians().cos(),
                facing,
            };
            let own = target.mesh.size(element).max(source_size);
            let reach = options.max_distance.unwrap_or(own);
            source.closest(&centre, &filter, reach, None)
        };
        let (_, found) = closest(Facing::Mixed)?;
        let other = if found.is_flipped {
            Facing::Same
        } else {
            Facing::Opposite
        };
        // One that lies above or below is another sheet; a neighbour of the partner that is turned over lies beside it.
        let is_above = |other: SourcePoint| {
            let off = other.point - centre;
            let height = off.dot(&normal);
            let beside = (off - normal * height).norm();
            (height - (found.point - centre).dot(&normal)).abs() > beside
        };
        let is_alone = closest(other).is_none_or(|(_, other)| !is_above(other));
        Some((target.mesh.areas()[element], found.is_flipped, is_alone))
    };
    let asked = (0..target.mesh.len().div_ceil(step)).into_par_iter();
    let found: Vec<Option<(f64, bool, bool)>> = asked.map(|number| ask(number * step)).collect();
    // Between two sheets the closer one may be the wrong one: elements with one sheet within reach tell more.
    let sum = |of_flipped: bool, of_all: bool| -> f64 {
        let votes = found.iter().flatten();
        let votes = votes
            .filter(|(_, is_flipped, is_alone)| *is_flipped == of_flipped && (of_all || *is_alone));
        votes.map(|(area, ..)| area).sum()
    };
    let [all_same, all_opposite] = [sum(false, true), sum(true, true)];
    let [mut same, mut opposite] = [sum(false, false), sum(true, false)];
    if same + opposite < LEAST_ALONE * (all_same + all_opposite) {
        [same, opposite] = [all_same, all_opposite];
    }
    let all = same + opposite;
    if all > 0.0 && same >= SIGNED_SHARE * all {
        Facing::Same
    } else if all > 0.0 && opposite >= SIGNED_SHARE * all {
        Facing::Opposite
    } else {
        Facing::Mixed
    }
}

/// The elements whose normal points to the other side than those around them, where that tells which sheet they
/// belong to.
fn reversed_targets(
    target: &TargetPart,
    options: &MapOptions,
    facings: &[Facing],
    monitor: &Monitor,
) -> Result<Vec<bool>, Cancelled> {
    let is_signed = facings.iter().any(|facing| *facing != Facing::Mixed);
    if options.normal_sense != NormalSense::Auto || !is_signed {
        return Ok(Vec::new());
    }
    Ok(target.mesh.links(monitor)?.neighbours.reversed().to_vec())
}

fn map_chunks(
    order: &[u32],
    context: &Context<'_>,
    monitor: &Monitor,
) -> Result<Vec<Buffers>, MappingError> {
    let n_elements = order.len() as u64;
    let done = AtomicU64::new(0);
    order
        .par_chunks(CHUNK)
        .map_init(Scratch::default, |scratch, elements| {
            monitor.check()?;
            let buffers = context.map_elements(elements, scratch);
            let n_done = elements.len() as u64;
            let n_done = n_done + done.fetch_add(n_done, Ordering::Relaxed);
            monitor.progress("map elements", n_done, Some(n_elements));
            Ok(buffers)
        })
        .collect()
}

/// Puts together what `chunks` of `order` gave, by the numbers of the elements.
fn assemble(
    chunks: &[Buffers],
    order: &[u32],
    context: &Context<'_>,
    monitor: &Monitor,
) -> Result<Mapped, Cancelled> {
    let target = context.target;
    let n = target.mesh.len();
    let mut place = vec![0; n];
    for (at, &element) in order.iter().enumerate() {
        place[element as usize] = at;
    }
    let places = || place.iter().map(|at| (&chunks[at / CHUNK], at % CHUNK));
    let reports =
        || -> Vec<ElementReport> { places().map(|(chunk, at)| chunk.reports[at]).collect() };
    monitor.check()?;
    let wanted = context.options.quantities;
    let (states, (strains, mut elements)) = rayon::join(
        || MappedLayers::of_elements(places().map(|(chunk, at)| chunk.states.of(at))),
        || {
            let strains = places().map(|(chunk, at)| chunk.strains.of(at));
            (MappedLayers::of_elements(strains), reports())
        },
    );
    monitor.check()?;
    let median_offset = median_offset(&elements);
    monitor.check()?;
    let mut n_distant = 0;
    for (report, (chunk, at)) in elements.iter_mut().zip(places()) {
        if report.partner.is_none() {
            continue;
        }
        let limits = &chunk.limits[at];
        let distance = (report.normal_distance - median_offset).abs() / limits.max_distance;
        n_distant += usize::from(distance > 0.5);
        let near = (1.0 - distance * distance).max(0.0);
        let cos = report.angle_deg.to_radians().cos();
        report.confidence = report.coverage * near * cos * cos * limits.uniqueness;
    }
    monitor.check()?;
    let limits = places().map(|(chunk, at)| &chunk.limits[at]);
    drop_small_conflicts(&mut elements, limits, &target.mesh);
    let thickness = if wanted.thickness {
        places().map(|(chunk, at)| chunk.thickness[at]).collect()
    } else {
        Vec::new()
    };
    Ok(Mapped {
        elements,
        thickness,
        corners: Vec::new(),
        states: wanted.needs_states().then_some(states),
        strains: wanted.strain.then_some(strains),
        strains_are_at_surfaces: context.strains_at_surfaces,
        history: None,
        facings: context.facings.to_vec(),
        median_offset,
        n_distant,
    })
}

fn median_offset(elements: &[ElementReport]) -> f64 {
    let with_partner = elements.iter().filter(|report| report.partner.is_some());
    let distances = with_partner.map(|report| report.normal_distance);
    let mut distances: Vec<f64> = distances.filter(|distance| distance.is_finite()).collect();
    if distances.is_empty() {
        return 0.0;
    }
    let middle = distances.len() / 2;
    *distances.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Parts that merely touch, as at a weld line, are in no conflict.
fn drop_small_conflicts<'a>(
    elements: &mut [ElementReport],
    limits: impl Iterator<Item = &'a Limits>,
    mesh: &ShellMesh,
) {
    let in_conflict = elements.iter().zip(mesh.areas());
    let area: f64 = in_conflict
        .filter(|(report, _)| report.status == Status::Conflict)
        .map(|(_, area)| area)
        .sum();
    if area > CONFLICT_SHARE * mesh.area() {
        return;
    }
    for (report, limits) in elements.iter_mut().zip(limits) {
        if report.status == Status::Conflict {
            report.status = limits.without_conflict;
        }
    }
}
