//! The values of a target element from those of its partners.

use super::element::Context;
use super::field::Field;
use super::gather::Group;
use crate::geometry::Vector3;
use crate::geometry::tensor::{Tensor, Turn, normal_component, smallest_rotation};

/// A stress component along the normal below this share of the stress is rounding.
const NORMAL_STRESS_ROUNDING: f64 = 1e-9;
/// Part of an element's area that must have partners, and of these that must have a quantity, for it
/// to carry their mean.
pub(super) const LEAST_COVERAGE: f64 = 0.5;

impl Context<'_> {
    /// Area mean of the thickness; NaN if less than half of the area has one.
    pub(super) fn thickness(&self, groups: &[Group]) -> f64 {
        let (mut sum, mut known, mut all) = (0.0, 0.0, 0.0);
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for group in groups {
            all += group.area;
            let source = &self.sources[group.source as usize];
            let Some(field) = &source.thickness else {
                continue;
            };
            if !field.layers.is_present[group.element as usize] {
                continue;
            }
            known += group.area;
            sum += if group.uneven_thickness.is_finite() {
                group.uneven_thickness
            } else {
                field.weighted(group.element as usize, 0, group.area, &group.offset)[0]
            };
            range = (
                range.0.min(source.thickness_range.0),
                range.1.max(source.thickness_range.1),
            );
        }
        if known <= LEAST_COVERAGE * all {
            return f64::NAN;
        }
        (sum / known).clamp(range.0, range.1) * self.options.thickness_scale
    }
}

/// The weighted mean of the partners' layer values, turned into the element's tangent plane.
pub(super) struct Blend<'a> {
    pub context: &'a Context<'a>,
    pub element: usize,
    pub groups: &'a [Group],
    pub is_copy: bool,
}

impl Blend<'_> {
    pub(super) fn states(&self, n_layers: usize) -> Vec<[f64; 7]> {
        let rule = self.context.target.rule_of[self.element] as usize;
        let normal = self.context.target.mesh.normals()[self.element];
        let mut values = self.blend(
            n_layers,
            self.context.target.planes(self.element),
            |group| {
                let field = self.context.sources[group.source as usize]
                    .states
                    .get(rule)?;
                field.layers.is_present[group.element as usize].then_some(field)
            },
        );
        for value in &mut values {
            value[6] = value[6].max(0.0);
            drop_rounding_along(value, &normal);
        }
        values
    }

    pub(super) fn strains(&self, n_layers: usize) -> Vec<[f64; 6]> {
        let rule = if self.context.strains_at_surfaces {
            0
        } else {
            self.context.target.rule_of[self.element] as usize
        };
        self.blend(n_layers, 1, |group| {
            let field = self.context.sources[group.source as usize]
                .strains
                .get(rule)?;
            field.layers.is_present[group.element as usize].then_some(field)
        })
    }

    /// Layer by layer, inside a layer plane point by plane point. Empty if less than half of the area
    /// has the quantity.
    fn blend<'f, const N: usize>(
        &self,
        n_layers: usize,
        n_plane: usize,
        field_of: impl Fn(&Group) -> Option<&'f Field<N>>,
    ) -> Vec<[f64; N]> {
        let all: f64 = self.groups.iter().map(|group| group.area).sum();
        let present = self
            .groups
            .iter()
            .filter_map(|group| Some((group, field_of(group)?)));
        let present: Vec<_> = present
            .map(|(group, field)| (group, field, self.turn(group)))
            .collect();
        let known: f64 = present.iter().map(|(group, ..)| group.area).sum();
        if known <= LEAST_COVERAGE * all {
            return Vec::new();
        }
        let mut values = vec![[0.0; N]; n_layers * n_plane];
        for plane in 0..n_plane {
            let is_here = |group: &Group| {
                n_plane == 1
                    || group
                        .quadrant
                        .is_none_or(|quadrant| quadrant as usize == plane)
            };
            let area: f64 = present
                .iter()
                .filter(|p| is_here(p.0))
                .map(|p| p.0.area)
                .sum();
            // A quadrant without partners takes the mean of the element.
            let area_or_all = if area > 0.0 { area } else { known };
            for (group, field, turn) in &present {
                if area > 0.0 && !is_here(group) {
                    continue;
                }
                for layer in 0..n_layers {
                    let from = if group.is_flipped {
                        n_layers - 1 - layer
                    } else {
                        layer
                    };
                    let element = group.element as usize;
                    let mut value = field.weighted(element, from, group.area, &group.offset);
                    if let Some(turn) = turn {
                        let tensor: Tensor = std::array::from_fn(|i| value[i]);
                        value[..6].copy_from_slice(&turn.apply(&tensor));
                    }
                    let sum = &mut values[layer * n_plane + plane];
                    for (sum, value) in sum.iter_mut().zip(value) {
                        *sum += value / area_or_all;
                    }
                }
            }
        }
        values
    }

    /// The smallest rotation from the source element's tangent plane into this element's.
    fn turn(&self, group: &Group) -> Option<Turn> {
        if self.is_copy {
            return None;
        }
        let source = &self.context.sources[group.source as usize];
        let normal = source.mesh.normals()[group.element as usize];
        let side = if group.is_flipped { -normal } else { normal };
        let normal = &self.context.target.mesh.normals()[self.element];
        smallest_rotation(&side, normal).map(|turn| Turn::new(&turn))
    }
}

/// Sets a normal stress to zero that is rounding only; a larger one shows a wrong frame and stays.
fn drop_rounding_along(value: &mut [f64; 7], normal: &Vector3) {
    let tensor: Tensor = std::array::from_fn(|i| value[i]);
    let along = normal_component(&tensor, normal);
    let size = tensor.iter().map(|x| x * x).sum::<f64>().sqrt();
    if along == 0.0 || along.abs() > NORMAL_STRESS_ROUNDING * size {
        return;
    }
    let n = normal;
    let dyad = [
        n.x * n.x,
        n.y * n.y,
        n.z * n.z,
        n.x * n.y,
        n.y * n.z,
        n.z * n.x,
    ];
    for (component, weight) in value.iter_mut().zip(dyad) {
        *component -= along * weight;
    }
}
