//! Values of elements through their layers, as the source has them and at the layers of a target.

use std::collections::BTreeMap;

use super::layers::{LayerBalance, LayerMatrix};
use super::rule::{LayerRule, SAME_PLACE, SAME_RULE};

/// Where the effective plastic strain stands in the state of a point, behind the six stresses.
pub const PLASTIC_STRAIN: usize = 6;

/// `N` numbers at points through the thickness of each element; elements may differ in their layers
/// or have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Layered<const N: usize> {
    /// For each element its first value and its rule; `NO_RULE` where it has none.
    records: Vec<(u32, u16)>,
    rules: Vec<LayerRule>,
    /// The rules by their number of layers and, in cells, their first place.
    by_place: BTreeMap<(usize, i64), Vec<u16>>,
    values: Vec<[f64; N]>,
    in_plane: InPlane<N>,
    n_left_out: usize,
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

/// Where a rule is looked up: one with the same places lies there or beside it.
fn cell(places: &[f64]) -> (usize, i64) {
    let first = places.first().copied().unwrap_or_default();
    (places.len(), (first / (2.0 * SAME_RULE)).round() as i64)
}

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
            by_place: BTreeMap::new(),
            values: Vec::new(),
            in_plane: InPlane {
                starts: Vec::new(),
                points: Vec::new(),
            },
            n_left_out: 0,
        }
    }

    /// No values for `n_elements` elements; those with layers at the places of one of the rules have it.
    pub fn with_rules(n_elements: usize, rules: Vec<LayerRule>) -> Self {
        let mut layered = Self::new(n_elements);
        for rule in rules {
            layered.add_rule(rule);
        }
        layered
    }

    /// The number of the new rule; `None` beyond as many as can be numbered.
    fn add_rule(&mut self, rule: LayerRule) -> Option<u16> {
        let number = u16::try_from(self.rules.len()).ok();
        let number = number.filter(|&number| number != NO_RULE)?;
        let of_cell = self.by_place.entry(cell(rule.places())).or_default();
        of_cell.push(number);
        self.rules.push(rule);
        Some(number)
    }

    /// The first rule with layers at these places.
    fn known_rule(&self, places: &[f64]) -> Option<u16> {
        let (n, at) = cell(places);
        let beside = (n, at.saturating_sub(1))..=(n, at.saturating_add(1));
        let near = self.by_place.range(beside).flat_map(|(_, rules)| rules);
        let same = near.filter(|&&rule| self.rules[rule as usize].has_places(places));
        same.min().copied()
    }

    /// Sets the values of an element from its integration points (T, values) in any order: points of
    /// one layer are averaged, layers sorted by T. Nothing is set without points or with a value that is
    /// not finite. Beyond 65,535 different rules an element is left out and counted.
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
        let known = self.known_rule(&places);
        let Some(rule) = known.or_else(|| self.add_rule(LayerRule::from_places(places))) else {
            self.n_left_out += 1;
            return;
        };
        let first = self.values.len();
        self.values
            .extend(layers.into_iter().map(|(_, values)| values));
        self.records[element] = (first as u32, rule);
        self.in_plane.set(element, in_plane);
    }

    /// How many times an element was left out because its layers lie elsewhere than those of as many others as can be
    /// told apart.
    pub fn n_left_out(&self) -> usize {
        self.n_left_out
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

    /// The values at the layers of `target`, each number by its balance. `keeps_matrices` says whether those of all
    /// rules are made now, or each where it is asked for.
    pub(super) fn at_layers(
        &self,
        target: &LayerRule,
        balances: [LayerBalance; N],
        keeps_matrices: bool,
    ) -> AtLayers<'_, N> {
        let kept = if keeps_matrices { &self.rules[..] } else { &[] };
        let matrices = |from: &LayerRule| LayerMatrices::new(from, target, &balances);
        AtLayers {
            from: self,
            matrices: kept.iter().map(matrices).collect(),
            target: target.clone(),
            balances,
        }
    }
}

/// From the layers of one rule to those of another.
struct LayerMatrices {
    linear: LayerMatrix,
    /// Where force and moment of some number are to stay.
    balanced: Option<LayerMatrix>,
}

impl LayerMatrices {
    fn new(from: &LayerRule, to: &LayerRule, balances: &[LayerBalance]) -> Self {
        let of = |balance| LayerMatrix::new(from, to, balance);
        let balanced = LayerBalance::ForceAndMoment;
        Self {
            linear: of(LayerBalance::Linear),
            balanced: balances.contains(&balanced).then(|| of(balanced)),
        }
    }

    fn of(&self, balance: LayerBalance) -> &LayerMatrix {
        let balanced = self.balanced.as_ref();
        let balanced = balanced.filter(|_| balance == LayerBalance::ForceAndMoment);
        balanced.unwrap_or(&self.linear)
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
    /// For each rule of the source; empty where they are made when they are asked for.
    matrices: Vec<LayerMatrices>,
    target: LayerRule,
    balances: [LayerBalance; N],
}

impl<const N: usize> AtLayers<'_, N> {
    /// What an element has at each layer, at one of its four points in the plane if it has some and one is asked
    /// for; `None` if it has nothing.
    pub(super) fn of(&self, element: usize, plane: Option<usize>) -> Option<Vec<[f64; N]>> {
        let (rule, mean) = self.from.of(element)?;
        let own = plane.and_then(|plane| self.from.in_plane.of(element, plane, rule.len()));
        let given = own.as_deref().unwrap_or(mean);
        let mut values = Vec::with_capacity(self.target.len());
        let (_, rule) = self.from.records[element];
        self.push_at_layers(given, rule, &mut values);
        Some(values)
    }

    /// Appends what the layers of a target have, from those of an element of a rule.
    fn push_at_layers(&self, given: &[[f64; N]], rule: u16, out: &mut Vec<[f64; N]>) {
        match self.matrices.get(usize::from(rule)) {
            Some(matrices) => self.push_by(matrices, given, out),
            None => {
                let from = &self.from.rules[usize::from(rule)];
                let matrices = LayerMatrices::new(from, &self.target, &self.balances);
                self.push_by(&matrices, given, out);
            }
        }
    }

    fn push_by(&self, matrices: &LayerMatrices, given: &[[f64; N]], out: &mut Vec<[f64; N]>) {
        if matrices.linear.is_identity() {
            out.extend_from_slice(given);
            return;
        }
        let first = out.len();
        out.resize(first + self.target.len(), [0.0; N]);
        for (number, balance) in self.balances.into_iter().enumerate() {
            for (layer, row) in matrices.of(balance).rows().enumerate() {
                let terms = row.iter().zip(given).map(|(w, v)| w * v[number]);
                out[first + layer][number] = terms.sum();
            }
        }
    }
}

impl<const N: usize> Numbers<N> for AtLayers<'_, N> {
    fn n_layers(&self) -> usize {
        self.target.len()
    }

    fn has(&self, element: usize) -> bool {
        self.from.records[element].1 != NO_RULE
    }

    fn push(&self, element: usize, out: &mut Vec<[f64; N]>) {
        let (at, rule) = self.from.records[element];
        let Some(own) = self.from.rules.get(usize::from(rule)) else {
            out.resize(out.len() + self.target.len(), [0.0; N]);
            return;
        };
        let given = &self.from.values[at as usize..][..own.len()];
        self.push_at_layers(given, rule, out);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn points(places: &[f64]) -> impl Iterator<Item = (f64, [f64; 1])> {
        places.iter().map(|&t| (t, [t]))
    }

    #[test]
    fn the_first_rule_with_the_same_places_is_found() {
        let n = 3000;
        let mut layered = Layered::with_rules(n, vec![LayerRule::of_plies(&[0.2, 0.3, 0.5])]);
        let mut rules = layered.rules().to_vec();
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        for element in 0..n {
            // Some a little apart from others, some with layers close together, some of two layers.
            let first = -0.8 + 0.02 * random();
            let second = first + 0.015 + 0.01 * random();
            let all = [first, second, 0.5 + 0.003 * random()];
            let places = &all[..2 + element % 2];
            let known = rules.iter().position(|rule| rule.has_places(places));
            let expected = known.unwrap_or_else(|| {
                rules.push(LayerRule::from_places(places.to_vec()));
                rules.len() - 1
            });
            layered.set(element, points(places));
            assert_eq!(layered.records[element].1 as usize, expected);
        }
        assert!(rules.len() > 100, "{} rules", rules.len());
        assert_eq!(layered.rules(), rules);
        assert_eq!(layered.n_left_out(), 0);
    }

    #[test]
    fn elements_beyond_the_last_rule_are_left_out_and_counted() {
        let most = NO_RULE as usize;
        let n = most + 500;
        let mut layered = Layered::new(n);
        for element in 0..n - 1 {
            let first = -0.01 * element as f64;
            layered.set(element, points(&[first, first + 0.5]));
        }
        layered.set(n - 1, points(&[0.0, 0.5]));
        assert_eq!(layered.rules().len(), most);
        assert_eq!(layered.n_left_out(), 499);
        assert_eq!(layered.n_present(), most + 1);
        assert_eq!(
            layered.values.len(),
            2 * (most + 1),
            "nothing is left of the others"
        );
        assert!(layered.of(most - 1).is_some() && layered.of(most).is_none());
        assert_eq!(layered.of(n - 1), layered.of(0));
    }
}
