//! The stamped part made ready: moved once, resampled to the target's layers, with its fields.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::field::{Field, FieldKind, LayerValues, Layered, Stencils, is_weld_line};
use super::history::SourceHistory;
use super::layers::{LayerBalance, LayerMatrix};
use super::options::MapOptions;
use super::rule::LayerRule;
use super::shells::{Neighbours, ShellMesh};
use crate::geometry::tensor::Turn;
use crate::geometry::{Matrix3, Point3, Similarity, Vector3};
use crate::search::{Bvh, ClosestPoint, Feature, NormalFilter, SurfaceHit};

/// Gauges smaller than this share of the sheet belong to their surroundings.
const SMALLEST_GAUGE: f64 = 0.01;

/// A stamped part with its forming results, in its own frame.
#[derive(Debug, Clone)]
pub struct SourcePart {
    /// Elements the values belong to.
    pub mesh: ShellMesh,
    /// Thickness at the corners in the target's length unit; NaN or 0 where it is not known. Empty if
    /// there is none at all.
    pub thickness: Vec<[f64; 4]>,
    /// Stress xx, yy, zz, xy, yz, zx and effective plastic strain at each layer.
    pub states: Layered<7>,
    /// Strain xx, yy, zz, xy, yz, zx (tensor shear) at each layer or at both surfaces.
    pub strains: Layered<6>,
    /// History variables.
    pub history: SourceHistory,
    /// Material law of the parts (as [`ShellMesh::parts`] numbers them) whose law is known.
    pub laws: BTreeMap<u32, String>,
}

impl SourcePart {
    /// Mean of the corner thicknesses of an element; NaN if one is not known.
    pub fn mean_thickness(&self, element: usize) -> f64 {
        self.thickness.get(element).map_or(f64::NAN, mean_thickness)
    }

    /// Effective plastic strain of an element, weighted over its layers; NaN if it has none.
    pub fn mean_plastic_strain(&self, element: usize) -> f64 {
        self.states.of(element).map_or(f64::NAN, |(rule, values)| {
            let terms = rule.weights().iter().zip(values);
            terms.map(|(weight, value)| weight * value[6]).sum::<f64>() / 2.0
        })
    }
}

/// Mean of the corners of an element that has a thickness at all of them, else NaN.
pub(super) fn mean_thickness(corners: &[f64; 4]) -> f64 {
    if corners.iter().all(|t| t.is_finite() && *t > 0.0) {
        corners.iter().sum::<f64>() / 4.0
    } else {
        f64::NAN
    }
}

/// The point of a source that a point of the target takes its values from.
#[derive(Debug, Clone, Copy)]
pub(super) struct SourcePoint {
    pub element: u32,
    pub point: Point3,
    pub distance_sq: f64,
    /// The closest point lies on the border of the sheet.
    pub is_on_border: bool,
    /// The normals point to opposite sides.
    pub is_flipped: bool,
    /// Thickness interpolated between corners that differ, else NaN.
    pub uneven_thickness: f64,
}

/// A source in the frame of the target, ready to be asked.
pub(super) struct PreparedSource {
    pub mesh: ShellMesh,
    bvh: Bvh,
    triangle_element: Vec<u32>,
    border_bits: Vec<u8>,
    /// Which sheet of one gauge each element belongs to.
    pub gauge: Vec<u32>,
    pub corner_thickness: Vec<[f64; 4]>,
    is_uneven: Vec<bool>,
    pub thickness: Option<Field<1>>,
    /// Smallest and largest thickness that occurs.
    pub thickness_range: (f64, f64),
    /// One for each layer rule of the target.
    pub states: Vec<Field<7>>,
    pub strains: Vec<Field<6>>,
    pub stencils: Stencils,
    pub neighbours: Neighbours,
}

impl PreparedSource {
    /// Moves, resamples and fits. `rules` are those of the target, `strain_rules` where it wants its
    /// strains. O(elements · layers).
    pub fn new(
        part: &SourcePart,
        target_from_source: &Similarity,
        rules: &[LayerRule],
        strain_rules: &[LayerRule],
        options: &MapOptions,
    ) -> Self {
        let mesh = part.mesh.moved(target_from_source);
        let (triangles, triangle_element) = mesh.triangles();
        let (bvh, (border_bits, neighbours)) = rayon::join(
            || Bvh::build(triangles.clone()),
            || (mesh.border_bits(&triangles), mesh.neighbours()),
        );
        let thickness: Vec<f64> = part.thickness.iter().map(mean_thickness).collect();
        let stencils = Stencils::new(&mesh, &neighbours, &thickness);
        let gauge = gauges(&mesh, &neighbours, &thickness);
        let turned = |field: LayerValues<7>| turn_all(field, FieldKind::Stress, target_from_source);
        let states = if options.quantities.needs_states() && part.states.n_present() > 0 {
            let at = |rule: &LayerRule| turned(states_at(part, rule, options.stress_balance()));
            let fit = |rule| Field::new(FieldKind::Stress, at(rule), &mesh, &stencils);
            rules.iter().map(fit).collect()
        } else {
            Vec::new()
        };
        let strains = if options.quantities.strain && part.strains.n_present() > 0 {
            let at = |rule: &LayerRule| {
                let linear = |from: &LayerRule| LayerMatrix::new(from, rule, LayerBalance::Linear);
                let values = part
                    .strains
                    .at_layers(rule, |from| std::array::from_fn(|_| linear(from)));
                turn_all(values, FieldKind::Strain, target_from_source)
            };
            let fit = |rule| Field::new(FieldKind::Strain, at(rule), &mesh, &stencils);
            strain_rules.iter().map(fit).collect()
        } else {
            Vec::new()
        };
        let is_known = |t: &&f64| t.is_finite();
        let thickness_range = thickness
            .iter()
            .filter(is_known)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
                (low.min(*t), high.max(*t))
            });
        let is_wanted = options.quantities.thickness && thickness_range.0.is_finite();
        Self {
            thickness: is_wanted.then(|| thickness_field(&thickness, &mesh, &stencils)),
            is_uneven: part.thickness.iter().map(is_uneven).collect(),
            corner_thickness: part.thickness.clone(),
            bvh,
            triangle_element,
            border_bits,
            gauge,
            thickness_range,
            states,
            strains,
            stencils,
            neighbours,
            mesh,
        }
    }

    /// The closest point within `max_distance` whose element's normal is within the angle of
    /// `normal`; of both signs the nearer one if `sense` is `None`.
    pub fn closest(
        &self,
        query: &Point3,
        filter: &PartnerFilter,
        max_distance: f64,
        hint: Option<u32>,
    ) -> Option<(u32, SourcePoint)> {
        let ask = |is_flipped: bool, reach: f64| {
            let direction = if is_flipped {
                -filter.normal
            } else {
                filter.normal
            };
            let cone = NormalFilter {
                direction,
                min_cos: filter.min_cos,
            };
            let hit = self.bvh.closest(query, reach, hint, Some(&cone))?;
            Some((hit, is_flipped))
        };
        let found = match filter.sense {
            Some(is_flipped) => ask(is_flipped, max_distance),
            None => {
                let same = ask(false, max_distance);
                let reach = same.map_or(max_distance, |(hit, _)| hit.distance_sq.sqrt());
                let other = ask(true, reach).filter(|(other, _)| {
                    same.is_none_or(|(same, _)| other.distance_sq < same.distance_sq)
                });
                other.or(same)
            }
        };
        found.map(|(hit, is_flipped)| (hit.triangle, self.source_point(&hit, is_flipped)))
    }

    /// Distance to the sheet whatever its normal, if within `max_distance`.
    pub fn distance(&self, query: &Point3, max_distance: f64) -> Option<f64> {
        let hit = self.bvh.closest(query, max_distance, None, None)?;
        Some(hit.distance_sq.sqrt())
    }

    /// The nearest element on the far side of `from` along `direction` within `reach`: a second sheet.
    pub fn next_sheet(&self, from: &Point3, direction: &Vector3, reach: f64) -> Option<(u32, f64)> {
        let hit = self.bvh.first_hit_within(from, direction, reach)?;
        Some((self.triangle_element[hit.triangle as usize], hit.distance))
    }

    fn source_point(&self, hit: &SurfaceHit, is_flipped: bool) -> SourcePoint {
        let triangle = hit.triangle as usize;
        let element = self.triangle_element[triangle];
        let bits = self.border_bits[triangle];
        let is_on_border = match hit.feature {
            Feature::Face => false,
            Feature::Edge(edge) => bits & (1 << edge) != 0,
            Feature::Vertex(corner) => bits & (8 << corner) != 0,
        };
        let is_uneven = self
            .is_uneven
            .get(element as usize)
            .copied()
            .unwrap_or(false);
        SourcePoint {
            element,
            point: hit.point,
            distance_sq: hit.distance_sq,
            is_on_border,
            is_flipped,
            uneven_thickness: if is_uneven {
                self.interpolated_thickness(hit, element)
            } else {
                f64::NAN
            },
        }
    }

    fn interpolated_thickness(&self, hit: &SurfaceHit, element: u32) -> f64 {
        let nodes = self.bvh.mesh().triangles()[hit.triangle as usize];
        let corners = self.mesh.corners()[element as usize];
        let values = self.corner_thickness[element as usize];
        let at = |node: u32| {
            let corner = corners.iter().position(|&c| c == node);
            corner.map_or(f64::NAN, |corner| values[corner])
        };
        (0..3).map(|i| hit.barycentric[i] * at(nodes[i])).sum()
    }
}

/// Which normals count as partners.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartnerFilter {
    /// Normal of the target element.
    pub normal: Vector3,
    pub min_cos: f64,
    /// `Some(false)`: the same side only; `Some(true)`: the opposite side only; `None`: either.
    pub sense: Option<bool>,
}

fn is_uneven(corners: &[f64; 4]) -> bool {
    let mean = mean_thickness(corners);
    mean.is_finite() && corners.iter().any(|t| (t - mean).abs() > 1e-9 * mean)
}

pub(super) fn thickness_field(
    thickness: &[f64],
    mesh: &ShellMesh,
    stencils: &Stencils,
) -> Field<1> {
    let values = LayerValues {
        n_layers: 1,
        values: thickness.iter().map(|&t| [t]).collect(),
        is_present: thickness.iter().map(|t| t.is_finite()).collect(),
    };
    Field::new(FieldKind::Scalars, values, mesh, stencils)
}

/// Stresses by the chosen balance, plastic strains always linear and never negative.
fn states_at(part: &SourcePart, rule: &LayerRule, balance: LayerBalance) -> LayerValues<7> {
    let mut values = part.states.at_layers(rule, |from| {
        let stress = LayerMatrix::new(from, rule, balance);
        let plastic = LayerMatrix::new(from, rule, LayerBalance::Linear);
        std::array::from_fn(|i| {
            if i < 6 {
                stress.clone()
            } else {
                plastic.clone()
            }
        })
    });
    for value in &mut values.values {
        value[6] = value[6].max(0.0);
    }
    values
}

fn turn_all<const N: usize>(
    mut values: LayerValues<N>,
    kind: FieldKind,
    target_from_source: &Similarity,
) -> LayerValues<N> {
    if target_from_source.rotation != Matrix3::identity() {
        let turn = Turn::new(&target_from_source.rotation);
        let all = values.values.par_iter_mut().with_min_len(1024);
        all.for_each(|value| *value = kind.turned(value, &turn));
    }
    values
}

/// Numbers the sheets of one gauge: elements that are linked by smooth neighbours. Small islands
/// join the neighbour they have most to do with, because a spot of strong thinning is no weld line.
fn gauges(mesh: &ShellMesh, neighbours: &Neighbours, thickness: &[f64]) -> Vec<u32> {
    let mut gauge = vec![u32::MAX; mesh.len()];
    let mut areas = Vec::new();
    let mut waiting = Vec::new();
    for first in 0..mesh.len() {
        if gauge[first] != u32::MAX {
            continue;
        }
        let number = areas.len() as u32;
        areas.push(0.0);
        gauge[first] = number;
        waiting.push(first);
        while let Some(element) = waiting.pop() {
            areas[number as usize] += mesh.areas()[element];
            for &other in neighbours.of(element) {
                let other = other as usize;
                if gauge[other] == u32::MAX && !is_weld_line(mesh, thickness, element, other) {
                    gauge[other] = number;
                    waiting.push(other);
                }
            }
        }
    }
    let least = SMALLEST_GAUGE * areas.iter().sum::<f64>();
    for element in 0..mesh.len() {
        if areas[gauge[element] as usize] < least {
            let large = neighbours.of(element).iter().map(|&n| gauge[n as usize]);
            if let Some(joined) = large.filter(|&g| areas[g as usize] >= least).min() {
                gauge[element] = joined;
            }
        }
    }
    gauge
}
