//! The linear field around the elements that a chunk of the target takes its values from.
//!
//! Fields are fitted where they are needed, chunk by chunk, and forgotten: kept for the whole source
//! they would take twice its memory, and filling that takes longer than the fit.
//!
//! Tensors are held in the frame of each element (two directions in its plane, and its normal). There
//! the smallest rotation from one tangent plane into the next is a turn within the plane, which takes
//! eight products instead of thirty-six.

use super::layered::{Numbers, PerElement};
use super::patch::{Link, Patch, Spin};
use crate::geometry::Matrix3;
use crate::geometry::tensor::{Tensor, Turn};

/// The tensor at the head of some numbers.
pub(super) fn tensor_of<const N: usize>(values: &[f64; N]) -> Tensor {
    std::array::from_fn(|i| values[i])
}

/// A tensor in the frame of an element: mean and half difference of xx and yy, then zz, xy, yz, zx.
#[inline]
fn into_local(tensor: &Tensor, into_frame: &Turn) -> Tensor {
    let [xx, yy, zz, xy, yz, zx] = into_frame.apply(tensor);
    [(xx + yy) / 2.0, (xx - yy) / 2.0, zz, xy, yz, zx]
}

/// The components in the axes that `out_of_frame` leads to.
#[inline]
pub(super) fn from_local(local: &Tensor, out_of_frame: &Turn) -> Tensor {
    let [mean, half, zz, xy, yz, zx] = *local;
    out_of_frame.apply(&[mean + half, mean - half, zz, xy, yz, zx])
}

/// The components in a frame that is turned within the plane.
#[inline]
fn spun([mean, half, zz, xy, yz, zx]: Tensor, spin: &Spin) -> Tensor {
    [
        mean,
        half * spin.cos2 - xy * spin.sin2,
        zz,
        half * spin.sin2 + xy * spin.cos2,
        zx * spin.sin + yz * spin.cos,
        zx * spin.cos - yz * spin.sin,
    ]
}

/// How the frame of a source element lies in that of a target element, once it has been turned into its plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Aligned {
    /// Of its first direction.
    spin: Spin,
    /// −1 where its second direction lies on the other side of the first, because of a mirror or a flip.
    second: f64,
    /// −1 where the normals are opposite.
    normal: f64,
}

impl Aligned {
    /// `spin` takes the first direction along; what a mirror and a flip do to the others comes before.
    pub fn new(spin: Spin, is_mirrored: bool, is_flipped: bool) -> Self {
        let sign = |is_negative| if is_negative { -1.0 } else { 1.0 };
        Self {
            spin,
            second: sign(is_mirrored != is_flipped),
            normal: sign(is_flipped),
        }
    }

    /// A tensor in the frame of the source element in that of the target element.
    #[inline]
    pub fn apply(&self, [mean, half, zz, xy, yz, zx]: Tensor) -> Tensor {
        let (second, normal) = (self.second, self.normal);
        let mirrored = [
            mean,
            half,
            zz,
            second * xy,
            second * normal * yz,
            normal * zx,
        ];
        spun(mirrored, &self.spin)
    }
}

/// Square of the von Mises equivalent.
#[inline]
fn von_mises_sq([mean, half, zz, xy, yz, zx]: &Tensor) -> f64 {
    (mean - zz).powi(2) + 3.0 * (half * half + xy * xy + yz * yz + zx * zx)
}

/// A quantity at the elements of a [`Patch`] with its linear variation around the fitted ones.
///
/// One number is kept within the range of the neighbours. Six are a strain, which is turned and not
/// limited. Seven are a stress, turned and kept below the neighbours' largest von Mises stress, and a
/// number.
#[derive(Default)]
pub(super) struct Field<const N: usize> {
    n_layers: usize,
    /// Slot by slot, layer by layer; tensors in the frame of the slot.
    values: Vec<[f64; N]>,
    is_present: Vec<bool>,
    /// Square of the von Mises stress of the values, for stresses.
    mises_sq: Vec<f64>,
    /// Of the fitted slots, like the values: derivatives along the two directions of the tangent plane.
    gradients: Vec<[[f64; N]; 2]>,
}

impl<const N: usize> Field<N> {
    const IS_TENSOR: bool = N >= 6;
    const IS_STRESS: bool = N == 7;
    /// Numbers before this one are turned, those from it on keep to the range of the neighbours.
    const fn first_scalar() -> usize {
        if Self::IS_TENSOR { 6 } else { 0 }
    }

    /// Takes the values of a patch; fields start flat. The second numbers are those at the places of the layers as
    /// the other side of the sheet sees them, for the elements that are seen from there.
    pub fn load<T: Numbers<N>>(&mut self, [numbers, from_below]: [&T; 2], patch: &Patch) {
        self.n_layers = numbers.n_layers();
        self.values.clear();
        self.is_present.clear();
        for (slot, seen) in patch.seen().iter().enumerate() {
            let element = seen.element as usize;
            self.is_present.push(numbers.has(element));
            let first = self.values.len();
            if seen.from_below {
                from_below.push(element, &mut self.values);
                self.values[first..].reverse();
            } else {
                numbers.push(element, &mut self.values);
            }
            if !Self::IS_TENSOR {
                continue;
            }
            let [x, y, z] = patch.frame(slot).map(|axis| axis.transpose());
            let into_frame = Turn::new(&Matrix3::from_rows(&[x, y, z]));
            for value in &mut self.values[first..] {
                let local = into_local(&tensor_of(value), &into_frame);
                value[..6].copy_from_slice(&local);
            }
        }
        self.mises_sq.clear();
        if Self::IS_STRESS {
            let squares = self.values.iter().map(|v| von_mises_sq(&tensor_of(v)));
            self.mises_sq.extend(squares);
        }
        self.gradients.clear();
        let n_fitted = patch.n_fitted() * self.n_layers;
        self.gradients.resize(n_fitted, [[0.0; N]; 2]);
    }

    /// True if the element of a slot has values.
    pub fn has(&self, slot: usize) -> bool {
        self.is_present[slot]
    }

    /// Applies a change to all values.
    pub fn change(&mut self, change: impl Fn(&mut [f64; N])) {
        self.values.iter_mut().for_each(change);
    }

    /// True if a slot and all that its fit needs have values: a neighbour without the quantity would
    /// leave the fit one-sided.
    fn may_fit(&self, slot: usize, links: &[Link]) -> bool {
        self.has(slot) && links.iter().all(|link| self.has(link.slot as usize))
    }

    /// Fits the gradient of each layer around a slot.
    fn fit(&mut self, slot: usize, links: &[Link], corners: &[[f64; 2]; 4]) {
        for layer in 0..self.n_layers {
            let own = slot * self.n_layers + layer;
            let (mut gradient, range) = self.around(own, layer, links);
            limit(&self.values[own], &mut gradient, corners, &range);
            self.gradients[own] = gradient;
        }
    }

    /// The gradient of a layer at the value `own`, and what the values around span.
    #[inline]
    fn around(&self, own: usize, layer: usize, links: &[Link]) -> ([[f64; N]; 2], Range<N>) {
        let values = &self.values[own];
        let mut range = Range {
            low: *values,
            high: *values,
            mises_sq: self.mises_sq.get(own).copied().unwrap_or(0.0),
        };
        let [mut along, mut across] = [[0.0; N]; 2];
        for link in links {
            let at = link.slot as usize * self.n_layers + layer;
            let mut other = self.values[at];
            if Self::IS_TENSOR {
                let spun = spun(tensor_of(&other), &link.spin);
                other[..6].copy_from_slice(&spun);
            }
            for i in 0..N {
                let difference = other[i] - values[i];
                along[i] += link.weight[0] * difference;
                across[i] += link.weight[1] * difference;
            }
            for (i, value) in other.iter().enumerate().skip(Self::first_scalar()) {
                range.low[i] = range.low[i].min(*value);
                range.high[i] = range.high[i].max(*value);
            }
            if Self::IS_STRESS {
                range.mises_sq = range.mises_sq.max(self.mises_sq[at]);
            }
        }
        ([along, across], range)
    }

    /// weight · value + gradient · offset of one layer, for sums over points of an element: `offset`
    /// is the weighted sum of their places relative to the centroid, in the tangent plane.
    #[inline]
    pub fn weighted(&self, slot: usize, layer: usize, weight: f64, offset: &[f64; 2]) -> [f64; N] {
        let at = slot * self.n_layers + layer;
        let (value, gradient) = (&self.values[at], &self.gradients[at]);
        std::array::from_fn(|i| {
            weight * value[i] + offset[0] * gradient[0][i] + offset[1] * gradient[1][i]
        })
    }
}

/// What the values of a layer around an element span.
#[derive(Debug, Clone, Copy)]
struct Range<const N: usize> {
    low: [f64; N],
    high: [f64; N],
    /// Largest square of the von Mises stress.
    mises_sq: f64,
}

/// The quantities of a source at one layer rule, where it has them.
pub(super) struct Fields {
    pub patch: Patch,
    pub thickness: Option<Field<1>>,
    pub states: Option<Field<7>>,
    pub strains: Option<Field<6>>,
}

impl Fields {
    /// One number of each element, as thickness, fitted on a patch.
    pub fn of_thickness(patch: Patch, numbers: &[f64]) -> Self {
        let mut field = Field::default();
        let numbers = PerElement(numbers);
        field.load([&numbers; 2], &patch);
        let mut fields = Self {
            patch,
            thickness: Some(field),
            states: None,
            strains: None,
        };
        fields.fit();
        fields
    }

    /// Fits all gradients of the patch.
    pub fn fit(&mut self) {
        let patch = &self.patch;
        for slot in 0..patch.n_fitted() {
            fit(&mut self.thickness, slot, patch);
            fit(&mut self.states, slot, patch);
            fit(&mut self.strains, slot, patch);
        }
    }
}

/// Fits the gradients around a slot, if the field is there and can be fitted.
fn fit<const N: usize>(field: &mut Option<Field<N>>, slot: usize, patch: &Patch) {
    let links = patch.links(slot);
    let field = field.as_mut().filter(|field| field.may_fit(slot, links));
    if let Some(field) = field.filter(|_| !links.is_empty()) {
        field.fit(slot, links, patch.corners(slot));
    }
}

/// Limits a gradient (Barth and Jespersen 1989) so that the field stays within the values around, also
/// at the corners of the element.
#[inline]
fn limit<const N: usize>(
    own: &[f64; N],
    gradient: &mut [[f64; N]; 2],
    corners: &[[f64; 2]; 4],
    range: &Range<N>,
) {
    if Field::<N>::IS_STRESS {
        limit_stress(own, gradient, corners, range.mises_sq);
    }
    for i in Field::<N>::first_scalar()..N {
        let slope = [gradient[0][i], gradient[1][i]];
        let factor = scalar_limit(own[i], slope, corners, [range.low[i], range.high[i]]);
        gradient[0][i] *= factor;
        gradient[1][i] *= factor;
    }
}

/// Largest factor up to 1 that keeps value + factor · gradient · offset within the range.
fn scalar_limit(
    value: f64,
    gradient: [f64; 2],
    offsets: &[[f64; 2]; 4],
    [low, high]: [f64; 2],
) -> f64 {
    let mut factor = 1.0_f64;
    for offset in offsets {
        let change = gradient[0] * offset[0] + gradient[1] * offset[1];
        let room = if change > 0.0 {
            high - value
        } else {
            value - low
        };
        if change.abs() > room {
            factor = factor.min(room / change.abs());
        }
    }
    factor
}

/// Halves the gradient of a stress until no corner exceeds the largest von Mises stress around.
fn limit_stress<const N: usize>(
    value: &[f64; N],
    gradient: &mut [[f64; N]; 2],
    offsets: &[[f64; 2]; 4],
    largest_sq: f64,
) {
    let exceeds = |factor: f64| {
        offsets.iter().any(|offset| {
            let at_corner: Tensor = std::array::from_fn(|i| {
                value[i] + factor * (gradient[0][i] * offset[0] + gradient[1][i] * offset[1])
            });
            von_mises_sq(&at_corner) > largest_sq * (1.0 + 2e-12)
        })
    };
    let mut factor = 1.0;
    while factor > 0.06 && exceeds(factor) {
        factor *= 0.5;
    }
    let factor = if factor > 0.06 { factor } else { 0.0 };
    for direction in gradient {
        for component in &mut direction[..6] {
            *component *= factor;
        }
    }
}

#[cfg(test)]
mod tests;
