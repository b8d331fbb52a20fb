//! The values of a target element from those of its partners.

use super::element::Context;
use super::field::{Aligned, Field, Fields, from_local, tensor_of};
use super::gather::Group;
use super::layered::PLASTIC_STRAIN;
use super::patch::{Seen, frame, spin};
use super::source::PreparedSource;
use crate::geometry::tensor::{Turn, normal_component};
use crate::geometry::{Matrix3, Point3, Vector3};

/// A stress component along the normal below this share of the stress is rounding.
const NORMAL_STRESS_ROUNDING: f64 = 1e-9;
/// A component below this share of the largest is rounding.
const DUST: f64 = 4e-15;
/// Part of an element's area that must have partners, and of these that must have a quantity, for it
/// to carry their mean.
pub(super) const LEAST_COVERAGE: f64 = 0.5;

/// What one source element gives to a target element.
struct Share<'a> {
    group: &'a Group,
    fields: &'a Fields,
    /// Its place in the patch of the fields.
    slot: usize,
    /// Area-weighted sum of places in its tangent plane.
    offset: [f64; 2],
    /// From the source element's frame into that of the target element.
    aligned: Aligned,
}

/// The weighted mean of the partners' values, turned into the element's tangent plane.
pub(super) struct Blend<'a> {
    context: &'a Context<'a>,
    element: usize,
    is_copy: bool,
    /// Two directions in the plane of the element, and its normal: tensors are added in this frame.
    frame: [Vector3; 3],
    shares: Vec<Share<'a>>,
}

impl<'a> Blend<'a> {
    /// `fields_of` gives the fields of a source at the element's layers. A copy is turned by the pose
    /// alone.
    pub fn new(
        context: &'a Context<'a>,
        element: usize,
        groups: &'a [Group],
        is_copy: bool,
        fields_of: impl Fn(&Group) -> &'a Fields,
    ) -> Self {
        let own_frame = frame(&context.target.mesh, Seen::from_above(element as u32));
        let mut shares = Vec::with_capacity(groups.len());
        shares.extend(groups.iter().filter_map(|group| {
            let fields = fields_of(group);
            let slot = fields.patch.slot(group.element)?;
            let source = &context.sources[group.source as usize];
            Some(Share {
                group,
                fields,
                slot,
                offset: fields
                    .patch
                    .in_plane(slot, &source.in_source(&group.offset)),
                aligned: aligned(source, fields.patch.frame(slot), group, &own_frame),
            })
        }));
        Self {
            context,
            element,
            is_copy,
            frame: own_frame,
            shares,
        }
    }

    /// Area mean of the thickness; NaN if less than half of the area has one.
    pub fn thickness(&self) -> f64 {
        let (mut sum, mut known, mut all) = (0.0, 0.0, 0.0);
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for share in &self.shares {
            let group = share.group;
            all += group.area;
            let field = share.fields.thickness.as_ref();
            let Some(field) = field.filter(|field| field.has(share.slot)) else {
                continue;
            };
            known += group.area;
            sum += if group.uneven_thickness.is_finite() {
                group.uneven_thickness
            } else {
                field.weighted(share.slot, 0, group.area, &share.offset)[0]
            };
            let source = &self.context.sources[group.source as usize];
            range = (
                range.0.min(source.thickness_range.0),
                range.1.max(source.thickness_range.1),
            );
        }
        if known <= 0.0 || known < LEAST_COVERAGE * all {
            return f64::NAN;
        }
        (sum / known).clamp(range.0, range.1) * self.context.options.thickness_scale
    }

    /// Appends stress and plastic strain of each layer, inside a layer plane point by plane point;
    /// nothing if less than half of the area has them.
    pub fn states(&self, n_layers: usize, out: &mut Vec<[f64; 7]>) {
        let normal = self.context.target.mesh.normals()[self.element];
        let n_plane = self.context.target.planes(self.element);
        let first = out.len();
        if self.is_copy {
            self.copy(n_plane, out, |source, group, plane| {
                let rule = self.context.rule(self.element, group.is_flipped);
                source.states_of(rule, group.element as usize, plane)
            });
        } else {
            self.blend(n_layers, n_plane, |fields| fields.states.as_ref(), out);
        }
        for value in &mut out[first..] {
            value[PLASTIC_STRAIN] = value[PLASTIC_STRAIN].max(0.0);
            drop_rounding_along(value, &normal);
        }
    }

    /// Appends the strains of each layer; nothing if less than half of the area has them.
    pub fn strains(&self, n_layers: usize, out: &mut Vec<[f64; 6]>) {
        if self.is_copy {
            self.copy(1, out, |source, group, _| {
                let rule = self.context.strain_rule(self.element, group.is_flipped);
                source.strains_of(rule, group.element as usize)
            });
        } else {
            self.blend(n_layers, 1, |fields| fields.strains.as_ref(), out);
        }
    }

    /// The values of the one partner as they are, turned by the pose: of each point in the plane those of the
    /// partner's point at the same corner.
    fn copy<const N: usize>(
        &self,
        n_plane: usize,
        out: &mut Vec<[f64; N]>,
        values_of: impl Fn(&PreparedSource<'_>, &Group, Option<usize>) -> Option<Vec<[f64; N]>>,
    ) {
        let Some(share) = self.shares.first() else {
            return;
        };
        let source = &self.context.sources[share.group.source as usize];
        let planes: Vec<Option<usize>> = if n_plane == 1 {
            vec![None]
        } else {
            let own = self.context.target.mesh.corner_points(self.element);
            let theirs = source.mesh.corner_points(share.group.element as usize);
            let apart = |corner: &Point3, at: usize| (theirs[at] - corner).norm_squared();
            let nearest = |corner: Point3| {
                (0..4).min_by(|&a, &b| apart(&corner, a).total_cmp(&apart(&corner, b)))
            };
            own.map(nearest).to_vec()
        };
        let points: Option<Vec<Vec<[f64; N]>>> = planes
            .into_iter()
            .map(|plane| values_of(source, share.group, plane))
            .collect();
        let Some(mut points) = points else {
            return;
        };
        if share.group.is_flipped {
            points.iter_mut().for_each(|values| values.reverse());
        }
        let pose = source.pose.rotation;
        if pose != Matrix3::identity() {
            let turn = Turn::new(&pose);
            for value in points.iter_mut().flatten() {
                let turned = turn.apply(&tensor_of(value));
                value[..6].copy_from_slice(&turned);
            }
        }
        let n_layers = points.first().map_or(0, Vec::len);
        out.extend((0..n_layers).flat_map(|layer| points.iter().map(move |values| values[layer])));
    }

    fn blend<const N: usize>(
        &self,
        n_layers: usize,
        n_plane: usize,
        field_of: impl Fn(&'a Fields) -> Option<&'a Field<N>>,
        out: &mut Vec<[f64; N]>,
    ) {
        let all: f64 = self.shares.iter().map(|share| share.group.area).sum();
        let present = || {
            self.shares.iter().filter_map(|share| {
                let field = field_of(share.fields)?;
                field.has(share.slot).then_some((share, field))
            })
        };
        let known: f64 = present().map(|(share, _)| share.group.area).sum();
        if known <= 0.0 || known < LEAST_COVERAGE * all {
            return;
        }
        let first = out.len();
        out.resize(first + n_layers * n_plane, [0.0; N]);
        let values = &mut out[first..];
        for plane in 0..n_plane {
            let is_here = |group: &Group| {
                let quadrant = group.quadrant;
                n_plane == 1 || quadrant.is_none_or(|quadrant| quadrant as usize == plane)
            };
            let here = present().filter(|(share, _)| is_here(share.group));
            let area: f64 = here.map(|(share, _)| share.group.area).sum();
            // A quadrant without partners takes the mean of the element.
            let area_or_all = if area > 0.0 { area } else { known };
            for (share, field) in present() {
                let group = share.group;
                if area > 0.0 && !is_here(group) {
                    continue;
                }
                let weight = group.area / area_or_all;
                let offset = share.offset.map(|x| x / area_or_all);
                for layer in 0..n_layers {
                    let from = if group.is_flipped {
                        n_layers - 1 - layer
                    } else {
                        layer
                    };
                    let mut value = field.weighted(share.slot, from, weight, &offset);
                    let aligned = share.aligned.apply(tensor_of(&value));
                    value[..6].copy_from_slice(&aligned);
                    let sum = &mut values[layer * n_plane + plane];
                    for (sum, value) in sum.iter_mut().zip(value) {
                        *sum += value;
                    }
                }
            }
        }
        let out_of_frame = Turn::new(&Matrix3::from_columns(&self.frame));
        for value in values {
            let turned = from_local(&tensor_of(value), &out_of_frame);
            value[..6].copy_from_slice(&turned);
            drop_dust(value);
        }
    }
}

/// The pose's rotation and after it the smallest one from the source element's tangent plane into the
/// target element's, whose frame is `into`.
fn aligned(
    source: &PreparedSource<'_>,
    [along, ..]: &[Vector3; 3],
    group: &Group,
    into: &[Vector3; 3],
) -> Aligned {
    let normal = source.mesh.normals()[group.element as usize];
    let side = if group.is_flipped { -normal } else { normal };
    let along = source.pose.rotation * along;
    Aligned::new(
        spin([&along, &side], into),
        source.is_mirrored,
        group.is_flipped,
    )
}

/// Sets components of the tensor to zero that turning it there and back has left.
fn drop_dust<const N: usize>(value: &mut [f64; N]) {
    let tensor = &mut value[..6];
    let largest = tensor.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for component in tensor {
        if component.abs() <= DUST * largest {
            *component = 0.0;
        }
    }
}

/// Sets a normal stress to zero that is rounding only; a larger one shows a wrong frame and stays.
fn drop_rounding_along(value: &mut [f64; 7], normal: &Vector3) {
    let tensor = tensor_of(value);
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
