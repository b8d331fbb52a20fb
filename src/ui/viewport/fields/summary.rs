//! Figures of a field: what its colours span, and what its legend says of the values.

use crate::geometry::TriMesh;

/// Share of the values on either end that may lie beyond the colours.
const TAIL: f64 = 0.005;
/// Differences up to this share of the largest value are rounding.
const ROUNDING: f64 = 1e-6;

/// What a legend says of the values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::ui::viewport) struct Summary {
    pub min: f64,
    pub max: f64,
    /// How many nodes or elements have one.
    pub n: usize,
    pub is_of_elements: bool,
    /// Sum over the area, and the area.
    sum: f64,
    area: f64,
}

impl Summary {
    fn nothing(is_of_elements: bool) -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            n: 0,
            is_of_elements,
            sum: 0.0,
            area: 0.0,
        }
    }

    fn add(&mut self, value: f64, area: f64) {
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += area * value;
        self.area += area;
    }

    /// Of values at the nodes of a mesh. `None` where none is known. O(triangles).
    pub(super) fn of_nodes(mesh: &TriMesh, values: &[f32]) -> Option<Self> {
        let mut found = Self::nothing(false);
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            let area = mesh.triangle_area(triangle) / 3.0;
            for &node in corners {
                let value = values.get(node as usize).copied().map(f64::from);
                if let Some(value) = value.filter(|value| value.is_finite()) {
                    found.add(value, area);
                }
            }
        }
        found.n = values.iter().filter(|value| value.is_finite()).count();
        (found.area > 0.0).then_some(found)
    }

    /// Of the values of the elements of a deck, to which the triangles of its full mesh belong. `None` where none is
    /// known. O(triangles).
    pub(super) fn of_elements(mesh: &TriMesh, elements: &[u32], values: &[f64]) -> Option<Self> {
        let mut found = Self::nothing(true);
        let mut last = None;
        for (triangle, &element) in elements.iter().enumerate() {
            let value = values.get(element as usize);
            if let Some(&value) = value.filter(|value| value.is_finite()) {
                found.add(value, mesh.triangle_area(triangle));
                // The triangles of an element follow each other.
                found.n += usize::from(last != Some(element));
            }
            last = Some(element);
        }
        (found.area > 0.0).then_some(found)
    }

    /// The figures of both together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            n: self.n + other.n,
            is_of_elements: self.is_of_elements,
            sum: self.sum + other.sum,
            area: self.area + other.area,
        }
    }

    /// The mean over the area.
    pub fn mean(&self) -> f64 {
        self.sum / self.area
    }

    /// True if there is nothing but zero.
    pub fn is_nothing(&self) -> bool {
        self.min == 0.0 && self.max == 0.0
    }
}

/// Differences of values of these sizes; all zero where all are rounding, which shows nothing but noise.
pub(super) fn without_rounding(
    mut differences: Vec<f64>,
    sizes: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let largest = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
    let is_rounding = |value: &f64| value.is_nan() || value.abs() <= ROUNDING * largest;
    if differences.iter().all(is_rounding) {
        let known = differences.iter_mut().filter(|value| !value.is_nan());
        known.for_each(|value| *value = 0.0);
    }
    differences
}

/// Smallest and largest value without the tails, widened if they coincide; nothing without values.
pub(super) fn robust_range(values: &[f32]) -> Option<[f64; 2]> {
    let mut finite: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return None;
    }
    finite.sort_unstable_by(f32::total_cmp);
    let tail = (TAIL * finite.len() as f64) as usize;
    let (low, high) = (
        f64::from(finite[tail]),
        f64::from(finite[finite.len() - 1 - tail]),
    );
    Some(if high - low > 1e-6 * high.abs() {
        [low, high]
    } else {
        let air = if high == 0.0 { 1.0 } else { 0.05 * high.abs() };
        [low - air, high + air]
    })
}
