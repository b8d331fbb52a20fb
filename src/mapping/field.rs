//! Values of the source elements through their layers, and the linear field around each element.

use rayon::prelude::*;

use super::layers::LayerMatrix;
use super::rule::LayerRule;
use super::shells::{Neighbours, ShellMesh};
use crate::geometry::Vector3;
use crate::geometry::tensor::{Tensor, Turn, smallest_rotation, von_mises_sq};

/// Places that belong to one layer: points of a layer share their T but for rounding.
const SAME_LAYER: f64 = 1e-4;
/// Neighbours whose normals differ by more than this are beyond an edge of the sheet.
const MAX_DIHEDRAL_COS: f64 = 0.766_044_443_118_978; // cos 40°
/// A jump in thickness by more than this fraction is a weld line between two gauges.
const WELD_LINE_JUMP: f64 = 0.05;

/// `N` numbers at points through the thickness of each element; elements may differ in their layers
/// or have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Layered<const N: usize> {
    /// For each element its first value and its rule; `NO_RULE` where it has none.
    records: Vec<(u32, u16)>,
    rules: Vec<LayerRule>,
    values: Vec<[f64; N]>,
}

const NO_RULE: u16 = u16::MAX;

impl<const N: usize> Layered<N> {
    /// No values for `n_elements` elements.
    pub fn new(n_elements: usize) -> Self {
        Self {
            records: vec![(0, NO_RULE); n_elements],
            rules: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Sets the values of an element from its integration points (T, values) in any order: points of
    /// one layer are averaged, layers sorted by T. Nothing is set without points, with a value that is
    /// not finite, or beyond 65,534 different rules.
    pub fn set(&mut self, element: usize, points: impl Iterator<Item = (f64, [f64; N])>) {
        let mut points: Vec<(f64, [f64; N])> = points.collect();
        let finite = |(t, values): &(f64, [f64; N])| {
            t.is_finite() && values.iter().all(|value| value.is_finite())
        };
        if points.is_empty() || !points.iter().all(finite) {
            return;
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut places = Vec::new();
        let first = self.values.len();
        let mut rest = &points[..];
        while let Some(&(t, _)) = rest.first() {
            let n = rest
                .iter()
                .take_while(|(other, _)| other - t < SAME_LAYER)
                .count();
            let mut mean = [0.0; N];
            for (_, values) in &rest[..n] {
                for (sum, value) in mean.iter_mut().zip(values) {
                    *sum += value;
                }
            }
            places.push(t);
            self.values.push(if n == 1 {
                rest[0].1
            } else {
                mean.map(|sum| sum / n as f64)
            });
            rest = &rest[n..];
        }
        let known = self.rules.iter().position(|rule| rule.has_places(&places));
        let rule = known.unwrap_or_else(|| {
            self.rules.push(LayerRule::from_places(places));
            self.rules.len() - 1
        });
        if rule < NO_RULE as usize {
            self.records[element] = (first as u32, rule as u16);
        }
    }

    /// Number of elements, with and without values.
    pub fn n_elements(&self) -> usize {
        self.records.len()
    }

    /// Number of elements that have values.
    pub fn n_present(&self) -> usize {
        self.records
            .iter()
            .filter(|record| record.1 != NO_RULE)
            .count()
    }

    /// The different rules that occur.
    pub fn rules(&self) -> &[LayerRule] {
        &self.rules
    }

    /// Rule and layer values of an element, rising in T; `None` if it has none.
    pub fn of(&self, element: usize) -> Option<(&LayerRule, &[[f64; N]])> {
        let (first, rule) = self.records[element];
        let rule = self.rules.get(rule as usize)?;
        Some((rule, &self.values[first as usize..][..rule.len()]))
    }

    /// The values at the layers of `target`, each with its own matrix; `matrices` makes, for one
    /// source rule, the matrix of each of the `N` numbers.
    pub(super) fn at_layers(
        &self,
        target: &LayerRule,
        matrices: impl Fn(&LayerRule) -> [LayerMatrix; N],
    ) -> LayerValues<N> {
        let of_rule: Vec<[LayerMatrix; N]> = self.rules.iter().map(matrices).collect();
        let n_layers = target.len();
        let mut values = vec![[0.0; N]; self.records.len() * n_layers];
        let is_present = self
            .records
            .iter()
            .map(|record| record.1 != NO_RULE)
            .collect();
        let chunks = values.par_chunks_mut(n_layers.max(1)).zip(&self.records);
        chunks.for_each(|(out, &(first, rule))| {
            let Some(matrices) = of_rule.get(rule as usize) else {
                return;
            };
            let n_source = self.rules[rule as usize].len();
            let given = &self.values[first as usize..][..n_source];
            if matrices[0].is_identity() {
                out.copy_from_slice(given);
                return;
            }
            for (number, matrix) in matrices.iter().enumerate() {
                for (layer, row) in matrix.rows().enumerate() {
                    let terms = row.iter().zip(given).map(|(w, v)| w * v[number]);
                    out[layer][number] = terms.sum();
                }
            }
        });
        LayerValues {
            n_layers,
            values,
            is_present,
        }
    }
}

/// Values of all elements at the same layers.
#[derive(Debug, Clone)]
pub(super) struct LayerValues<const N: usize> {
    pub n_layers: usize,
    /// Element by element, layer by layer.
    pub values: Vec<[f64; N]>,
    pub is_present: Vec<bool>,
}

impl<const N: usize> LayerValues<N> {
    pub fn of(&self, element: usize) -> &[[f64; N]] {
        &self.values[element * self.n_layers..][..self.n_layers]
    }
}

/// Weights that make the gradient of any quantity from its differences to the neighbours: a least
/// squares fit weighted by the inverse squared distance, in the tangent plane of the element.
pub(super) struct Stencils {
    start: Vec<u32>,
    neighbours: Vec<u32>,
    weights: Vec<[f64; 2]>,
    bases: Vec<[Vector3; 2]>,
}

impl Stencils {
    /// Neighbours across another part, an edge of the sheet or a weld line are left out; with fewer
    /// than three, or all in one line, the gradient is zero. `thickness` may be empty.
    pub fn new(mesh: &ShellMesh, neighbours: &Neighbours, thickness: &[f64]) -> Self {
        let rows: Vec<Vec<(u32, [f64; 2])>> = (0..mesh.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|element| stencil(mesh, neighbours, thickness, element))
            .collect();
        let mut start = vec![0_u32];
        let mut list = Vec::with_capacity(8 * rows.len());
        let mut weights = Vec::with_capacity(8 * rows.len());
        for row in rows {
            for (neighbour, weight) in row {
                list.push(neighbour);
                weights.push(weight);
            }
            start.push(list.len() as u32);
        }
        Self {
            start,
            neighbours: list,
            weights,
            bases: (0..mesh.len())
                .map(|element| basis(mesh, element))
                .collect(),
        }
    }

    fn of(&self, element: usize) -> impl Iterator<Item = (usize, &[f64; 2])> {
        let range = self.start[element] as usize..self.start[element + 1] as usize;
        let neighbours = self.neighbours[range.clone()].iter();
        neighbours.map(|&n| n as usize).zip(&self.weights[range])
    }

    /// Coordinates of a displacement in the tangent plane of an element.
    pub fn in_plane(&self, element: usize, displacement: &Vector3) -> [f64; 2] {
        self.bases[element].map(|axis| axis.dot(displacement))
    }
}

/// Two unit directions that span the tangent plane.
fn basis(mesh: &ShellMesh, element: usize) -> [Vector3; 2] {
    let normal = mesh.normals()[element];
    let x = mesh.corner_points(element);
    let along = (x[2] - x[0]).try_normalize(0.0).unwrap_or_default();
    let along = (along - normal * along.dot(&normal))
        .try_normalize(0.0)
        .unwrap_or_default();
    [along, normal.cross(&along)]
}

/// True if the gauge of the sheet changes between two neighbours, or the part.
pub(super) fn is_weld_line(mesh: &ShellMesh, thickness: &[f64], a: usize, b: usize) -> bool {
    let is_jump = match (thickness.get(a), thickness.get(b)) {
        (Some(a), Some(b)) => (a - b).abs() > WELD_LINE_JUMP * a.min(*b),
        _ => false,
    };
    is_jump || mesh.parts()[a] != mesh.parts()[b]
}

fn stencil(
    mesh: &ShellMesh,
    neighbours: &Neighbours,
    thickness: &[f64],
    element: usize,
) -> Vec<(u32, [f64; 2])> {
    let centre = mesh.centroids()[element];
    let axes = basis(mesh, element);
    let offset = |other: u32| {
        let away = mesh.centroids()[other as usize] - centre;
        let flat = axes.map(|axis| axis.dot(&away));
        let length = flat[0].hypot(flat[1]);
        // Unfolded into the tangent plane: the distance along a bent sheet is kept.
        let stretch = if length > 0.0 {
            away.norm() / length
        } else {
            0.0
        };
        flat.map(|x| x * stretch)
    };
    let usable = neighbours.of(element).iter().copied();
    let usable = usable.filter(|&n| {
        let n = n as usize;
        mesh.normals()[element].dot(&mesh.normals()[n]) >= MAX_DIHEDRAL_COS
            && !is_weld_line(mesh, thickness, element, n)
    });
    let usable: Vec<(u32, [f64; 2])> = usable.map(|n| (n, offset(n))).collect();
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for (_, [x, y]) in &usable {
        let weight = 1.0 / (x * x + y * y);
        if !weight.is_finite() {
            return Vec::new();
        }
        xx += weight * x * x;
        xy += weight * x * y;
        yy += weight * y * y;
    }
    let determinant = xx * yy - xy * xy;
    if usable.len() < 3 || determinant <= 1e-6 * (xx + yy) * (xx + yy) {
        return Vec::new();
    }
    let weights = usable.into_iter().map(|(neighbour, [x, y])| {
        let weight = 1.0 / ((x * x + y * y) * determinant);
        let solved = [weight * (yy * x - xy * y), weight * (xx * y - xy * x)];
        (neighbour, solved)
    });
    weights.collect()
}

/// A quantity of the source with its linear variation around each element.
pub(super) struct Field<const N: usize> {
    pub layers: LayerValues<N>,
    /// Like the values: derivatives along the two directions of the element's tangent plane.
    gradients: Vec<[[f64; N]; 2]>,
}

/// What kind of numbers a field holds, which decides how they turn and how steep they may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FieldKind {
    /// Each number by itself, kept within the range of the neighbours.
    Scalars,
    /// Six stress components, turned and kept below the neighbours' largest von Mises stress, and
    /// scalars after them.
    Stress,
    /// Six components that are turned and not limited.
    Strain,
}

impl FieldKind {
    /// The numbers turned by a rotation.
    pub fn turned<const N: usize>(self, values: &[f64; N], turn: &Turn) -> [f64; N] {
        let mut turned = *values;
        if self != Self::Scalars {
            turned[..6].copy_from_slice(&turn.apply(&tensor_of(values)));
        }
        turned
    }
}

fn tensor_of<const N: usize>(values: &[f64; N]) -> Tensor {
    std::array::from_fn(|i| values[i])
}

impl<const N: usize> Field<N> {
    /// Fits the gradients and limits them (Barth and Jespersen 1989) so that the field stays within
    /// the values around, also at the corners of the element. O(elements · layers).
    pub fn new(
        kind: FieldKind,
        layers: LayerValues<N>,
        mesh: &ShellMesh,
        stencils: &Stencils,
    ) -> Self {
        let n_layers = layers.n_layers.max(1);
        let mut gradients = vec![[[0.0; N]; 2]; layers.values.len()];
        let chunks = gradients
            .par_chunks_mut(n_layers)
            .enumerate()
            .with_min_len(256);
        chunks.for_each_init(Vec::new, |ranges, (element, out)| {
            if !layers.is_present[element] {
                return;
            }
            // A neighbour without the quantity would leave the fit one-sided.
            if !stencils
                .of(element)
                .all(|(other, _)| layers.is_present[other])
            {
                return;
            }
            fit(kind, (&layers, mesh, stencils), element, ranges, out);
        });
        Self { layers, gradients }
    }

    /// weight · value + gradient · offset of one layer, for sums over points of an element: `offset`
    /// is the weighted sum of their places relative to the centroid, in the tangent plane.
    pub fn weighted(
        &self,
        element: usize,
        layer: usize,
        weight: f64,
        offset: &[f64; 2],
    ) -> [f64; N] {
        let at = element * self.layers.n_layers + layer;
        let (value, gradient) = (&self.layers.values[at], &self.gradients[at]);
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

impl<const N: usize> Range<N> {
    fn of(kind: FieldKind, values: &[f64; N]) -> Self {
        let mises_sq = match kind {
            FieldKind::Stress => von_mises_sq(&tensor_of(values)),
            _ => 0.0,
        };
        Self {
            low: *values,
            high: *values,
            mises_sq,
        }
    }
}

/// `ranges` is room that is used again.
fn fit<const N: usize>(
    kind: FieldKind,
    (layers, mesh, stencils): (&LayerValues<N>, &ShellMesh, &Stencils),
    element: usize,
    ranges: &mut Vec<Range<N>>,
    out: &mut [[[f64; N]; 2]],
) {
    // Numbers that keep to the range of the neighbours.
    let first_scalar = match kind {
        FieldKind::Scalars => 0,
        _ => 6.min(N),
    };
    let own = layers.of(element);
    let normal = mesh.normals()[element];
    ranges.clear();
    ranges.extend(own.iter().map(|values| Range::of(kind, values)));
    for (other, weight) in stencils.of(element) {
        let turn = match kind {
            FieldKind::Scalars => None,
            _ => smallest_rotation(&mesh.normals()[other], &normal),
        };
        let turn = turn.map(|turn| Turn::new(&turn));
        for (layer, values) in layers.of(other).iter().enumerate() {
            let values = match &turn {
                Some(turn) => kind.turned(values, turn),
                None => *values,
            };
            let [along, across] = &mut out[layer];
            for i in 0..N {
                let difference = values[i] - own[layer][i];
                along[i] += weight[0] * difference;
                across[i] += weight[1] * difference;
            }
            let range = &mut ranges[layer];
            let span = range.low.iter_mut().zip(&mut range.high).zip(&values);
            for ((low, high), value) in span.skip(first_scalar) {
                *low = low.min(*value);
                *high = high.max(*value);
            }
            if kind == FieldKind::Stress {
                range.mises_sq = range.mises_sq.max(von_mises_sq(&tensor_of(&values)));
            }
        }
    }
    let centre = mesh.centroids()[element];
    let corners = mesh.corner_points(element);
    let offsets = corners.map(|corner| stencils.in_plane(element, &(corner - centre)));
    for ((own, gradient), range) in own.iter().zip(out).zip(ranges) {
        if kind == FieldKind::Stress {
            limit_stress(own, gradient, &offsets, range.mises_sq);
        }
        for i in first_scalar..N {
            let slope = [gradient[0][i], gradient[1][i]];
            let factor = scalar_limit(own[i], slope, &offsets, [range.low[i], range.high[i]]);
            gradient[0][i] *= factor;
            gradient[1][i] *= factor;
        }
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
