//! Values of elements through their layers, as the source has them and at the layers of a target.

use super::layers::LayerMatrix;
use super::rule::{LayerRule, SAME_PLACE};

/// Where the effective plastic strain stands in the state of a point, behind the six stresses.
pub const PLASTIC_STRAIN: usize = 6;

/// `N` numbers at points through the thickness of each element; elements may differ in their layers
/// or have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Layered<const N: usize> {
    /// For each element its first value and its rule; `NO_RULE` where it has none.
    records: Vec<(u32, u16)>,
    rules: Vec<LayerRule>,
    values: Vec<[f64; N]>,
    in_plane: InPlane<N>,
}

/// The points of elements that have four in each layer, whose means are the values there.
#[derive(Debug, Clone, PartialEq)]
struct InPlane<const N: usize> {
    /// For each element up to the last one with such points, where these begin.
    starts: Vec<Option<u32>>,
    /// Layer by layer in rising T, in a layer in the order of the file.
    points: Vec<[f64; N]>,
}

impl<const N: usize> InPlane<N> {
    /// Takes the points of an element, with their places; `None` for other points than four in each layer.
    fn set(&mut self, element: usize, points: Option<Vec<(f64, [f64; N])>>) {
        if let Some(points) = points {
            let n_known = self.starts.len().max(element + 1);
            self.starts.resize(n_known, None);
            self.starts[element] = Some(self.points.len() as u32);
            let values = points.into_iter().map(|(_, values)| values);
            self.points.extend(values);
        } else if let Some(start) = self.starts.get_mut(element) {
            *start = None;
        }
    }

    /// What one of the four points of each layer has; `None` for an element without such points.
    fn of(&self, element: usize, plane: usize, n_layers: usize) -> Option<Vec<[f64; N]>> {
        let start = (*self.starts.get(element)?)?;
        let all = &self.points[start as usize..][..4 * n_layers];
        Some(all.iter().skip(plane).step_by(4).copied().collect())
    }
}

const NO_RULE: u16 = u16::MAX;

/// Integration points (T, values) of an element in any order as layers that rise in T: points of one layer are
/// averaged.
pub fn into_layers<const N: usize>(mut points: Vec<(f64, [f64; N])>) -> Vec<(f64, [f64; N])> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut n_layers, mut start) = (0, 0);
    while start < points.len() {
        let t = points[start].0;
        let of_layer = points[start..].iter();
        let n = of_layer
            .take_while(|(other, _)| other - t < SAME_PLACE)
            .count();
        // One point is its own layer, a T that is no number included.
        let n = n.max(1);
        if n > 1 {
            let mut mean = [0.0; N];
            for (_, values) in &points[start..start + n] {
                for (sum, value) in mean.iter_mut().zip(values) {
                    *sum += value;
                }
            }
            points[n_layers] = (t, mean.map(|sum| sum / n as f64));
        } else {
            points[n_layers] = points[start];
        }
        n_layers += 1;
        start += n;
    }
    points.truncate(n_layers);
    points
}

impl<const N: usize> Layered<N> {
    /// No values for `n_elements` elements.
    pub fn new(n_elements: usize) -> Self {
        Self {
            records: vec![(0, NO_RULE); n_elements],
            rules: Vec::new(),
            values: Vec::new(),
            in_plane: InPlane {
                starts: Vec::new(),
                points: Vec::new(),
            },
        }
    }

    /// No values for `n_elements` elements; those with layers at the places of one of the rules have it.
    pub fn with_rules(n_elements: usize, rules: Vec<LayerRule>) -> Self {
        Self {
            rules,
            ..Self::new(n_elements)
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
        // Places that differ by rounding would bring the points of a layer into another order.
        let is_layer = |four: &[(f64, [f64; N])]| four.len() == 4 && four[3].0 == four[0].0;
        let in_plane = points.chunks(4).all(is_layer).then(|| points.clone());
        let layers = into_layers(points);
        // Eight points in one place are no two layers of four.
        let in_plane = in_plane.filter(|points| points.len() == 4 * layers.len());
        let places: Vec<f64> = layers.iter().map(|(t, _)| *t).collect();
        let first = self.values.len();
        self.values
            .extend(layers.into_iter().map(|(_, values)| values));
        let known = self.rules.iter().position(|rule| rule.has_places(&places));
        let rule = known.unwrap_or_else(|| {
            self.rules.push(LayerRule::from_places(places));
            self.rules.len() - 1
        });
        if rule < NO_RULE as usize {
            self.records[element] = (first as u32, rule as u16);
            self.in_plane.set(element, in_plane);
        }
    }

    /// One number of an element, weighted over its layers; NaN if it has none.
    pub fn mean(&self, element: usize, component: usize) -> f64 {
        self.of(element).map_or(f64::NAN, |(rule, layers)| {
            let terms = rule.weights().iter().zip(layers);
            terms
                .map(|(weight, values)| weight * values[component])
                .sum::<f64>()
                / 2.0
        })
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

    /// The different rules that occur, behind those that were given.
    pub fn rules(&self) -> &[LayerRule] {
        &self.rules
    }

    /// Rule and layer values of an element, rising in T; `None` if it has none.
    pub fn of(&self, element: usize) -> Option<(&LayerRule, &[[f64; N]])> {
        let (first, rule) = self.records[element];
        let rule = self.rules.get(rule as usize)?;
        Some((rule, &self.values[first as usize..][..rule.len()]))
    }

    /// The values at the layers of `target`; `matrices` makes, for one source rule, the matrix of each
    /// of the `N` numbers.
    pub(super) fn at_layers(
        &self,
        target: &LayerRule,
        matrices: impl Fn(&LayerRule) -> [LayerMatrix; N],
    ) -> AtLayers<'_, N> {
        AtLayers {
            from: self,
            matrices: self.rules.iter().map(matrices).collect(),
            n_layers: target.len(),
        }
    }
}

/// Numbers that fields are fitted to, the same layers for all elements.
pub(super) trait Numbers<const N: usize> {
    /// Layers of each element.
    fn n_layers(&self) -> usize;
    /// True if an element has values.
    fn has(&self, element: usize) -> bool;
    /// Appends the values of an element, one for each layer; zeros if it has none.
    fn push(&self, element: usize, out: &mut Vec<[f64; N]>);
}

/// Values at the layers of a target, made where they are asked for: most elements are asked for few
/// times, and all of them at once would take several times the memory of the results.
pub(super) struct AtLayers<'a, const N: usize> {
    from: &'a Layered<N>,
    /// For each rule of the source the matrix of each number.
    matrices: Vec<[LayerMatrix; N]>,
    n_layers: usize,
}

impl<const N: usize> AtLayers<'_, N> {
    /// What an element has at each layer, at one of its four points in the plane if it has some and one is asked
    /// for; `None` if it has nothing.
    pub(super) fn of(&self, element: usize, plane: Option<usize>) -> Option<Vec<[f64; N]>> {
        let (rule, mean) = self.from.of(element)?;
        let own = plane.and_then(|plane| self.from.in_plane.of(element, plane, rule.len()));
        let given = own.as_deref().unwrap_or(mean);
        let mut values = Vec::with_capacity(self.n_layers);
        let (_, rule) = self.from.records[element];
        self.push_at_layers(given, &self.matrices[rule as usize], &mut values);
        Some(values)
    }

    /// Appends what the layers of a target have, from those of an element.
    fn push_at_layers(
        &self,
        given: &[[f64; N]],
        matrices: &[LayerMatrix; N],
        out: &mut Vec<[f64; N]>,
    ) {
        if matrices[0].is_identity() {
            out.extend_from_slice(given);
            return;
        }
        let first = out.len();
        out.resize(first + self.n_layers, [0.0; N]);
        for (number, matrix) in matrices.iter().enumerate() {
            for (layer, row) in matrix.rows().enumerate() {
                let terms = row.iter().zip(given).map(|(w, v)| w * v[number]);
                out[first + layer][number] = terms.sum();
            }
        }
    }
}

impl<const N: usize> Numbers<N> for AtLayers<'_, N> {
    fn n_layers(&self) -> usize {
        self.n_layers
    }

    fn has(&self, element: usize) -> bool {
        self.from.records[element].1 != NO_RULE
    }

    fn push(&self, element: usize, out: &mut Vec<[f64; N]>) {
        let (at, rule) = self.from.records[element];
        let Some(matrices) = self.matrices.get(rule as usize) else {
            out.resize(out.len() + self.n_layers, [0.0; N]);
            return;
        };
        let n_source = self.from.rules[rule as usize].len();
        let given = &self.from.values[at as usize..][..n_source];
        self.push_at_layers(given, matrices, out);
    }
}

/// One number for each element; NaN where there is none.
pub(super) struct PerElement<'a>(pub &'a [f64]);

impl Numbers<1> for PerElement<'_> {
    fn n_layers(&self) -> usize {
        1
    }

    fn has(&self, element: usize) -> bool {
        self.0[element].is_finite()
    }

    fn push(&self, element: usize, out: &mut Vec<[f64; 1]>) {
        out.push([self.0[element]]);
    }
}
