//! History variables: those of one source element each, never averaged, and only where both
//! materials follow the same law.

use std::collections::BTreeMap;

use super::PlacedSource;
use super::options::Quantities;
use super::rule::SAME_PLACE;
use super::target::{ElementReport, Partner, TargetPart};
use crate::geometry::Matrix3;
use crate::geometry::tensor::{Tensor, rotated, smallest_rotation};

/// What one layer of a source element keeps: history variables, and tensors among them in the global
/// frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerHistory<'a> {
    /// Numbers that are carried as they are.
    pub values: &'a [f64],
    /// Tensors that turn with the sheet.
    pub tensors: &'a [Tensor],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Record {
    first_place: u32,
    n_layers: u32,
    first_value: u32,
    n_values: u32,
    first_tensor: u32,
    n_tensors: u32,
}

/// History variables of the source elements that have any.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SourceHistory {
    /// Empty, or one for each element.
    records: Vec<Record>,
    places: Vec<f64>,
    values: Vec<f64>,
    tensors: Vec<Tensor>,
}

impl SourceHistory {
    /// No history for `n_elements` elements.
    pub fn new(n_elements: usize) -> Self {
        Self {
            records: vec![Record::default(); n_elements],
            ..Self::default()
        }
    }

    /// True if no element has any.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Sets the history of an element from its layers (T, what it keeps), all with the same number of
    /// variables. Of several points at one T the first counts, because means of such variables mean
    /// nothing.
    pub fn set<'a>(
        &mut self,
        element: usize,
        layers: impl Iterator<Item = (f64, LayerHistory<'a>)>,
    ) {
        let mut layers: Vec<_> = layers.filter(|(t, _)| t.is_finite()).collect();
        layers.sort_by(|a, b| a.0.total_cmp(&b.0));
        layers.dedup_by(|later, first| (later.0 - first.0).abs() < SAME_PLACE);
        let Some((_, of_first)) = layers.first() else {
            return;
        };
        let (n_values, n_tensors) = (of_first.values.len(), of_first.tensors.len());
        if n_values + n_tensors == 0 {
            return;
        }
        self.records[element] = Record {
            first_place: self.places.len() as u32,
            n_layers: layers.len() as u32,
            first_value: self.values.len() as u32,
            n_values: n_values as u32,
            first_tensor: self.tensors.len() as u32,
            n_tensors: n_tensors as u32,
        };
        for (t, layer) in layers {
            self.places.push(t);
            self.values.extend_from_slice(layer.values);
            self.tensors.extend_from_slice(layer.tensors);
        }
    }

    fn record(&self, element: usize) -> Option<&Record> {
        self.records
            .get(element)
            .filter(|record| record.n_layers > 0)
    }

    /// What the layer nearest to `t` keeps; of two equally near ones the lower.
    fn nearest(&self, record: &Record, t: f64) -> LayerHistory<'_> {
        let places = &self.places[record.first_place as usize..][..record.n_layers as usize];
        let nearer = |a: &usize, b: &usize| {
            let off = |i: &usize| (places[*i] - t).abs();
            off(a).total_cmp(&off(b)).then(a.cmp(b))
        };
        let layer = (0..places.len()).min_by(nearer).unwrap_or(0);
        let (n_values, n_tensors) = (record.n_values as usize, record.n_tensors as usize);
        LayerHistory {
            values: &self.values[record.first_value as usize + layer * n_values..][..n_values],
            tensors: &self.tensors[record.first_tensor as usize + layer * n_tensors..][..n_tensors],
        }
    }
}

/// Elements that got no history because their laws are not known to agree.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LawGap {
    /// Law of the source, if known.
    pub source: Option<String>,
    /// Law of the target, if known.
    pub target: Option<String>,
    /// How many elements.
    pub n_elements: usize,
}

/// History variables of the target elements.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MappedHistory {
    /// One more than elements, as are the next two.
    first_value: Vec<u32>,
    first_tensor: Vec<u32>,
    values: Vec<f64>,
    tensors: Vec<Tensor>,
    /// Why elements whose partner has some got none, the most frequent pair of laws first.
    pub left_out: Vec<LawGap>,
}

impl MappedHistory {
    /// Values and tensors of an element, layer by layer in rising T; empty if it has none.
    pub fn of(&self, element: usize) -> LayerHistory<'_> {
        let range = |first: &[u32]| first[element] as usize..first[element + 1] as usize;
        LayerHistory {
            values: &self.values[range(&self.first_value)],
            tensors: &self.tensors[range(&self.first_tensor)],
        }
    }

    /// Number of elements that have some.
    pub fn n_present(&self) -> usize {
        let pairs = self
            .first_value
            .windows(2)
            .zip(self.first_tensor.windows(2));
        pairs.filter(|(v, t)| v[0] < v[1] || t[0] < t[1]).count()
    }
}

/// Carries the history of each element's partner, if it is asked for and any source has some. Layers
/// take that of the nearest one of the partner; tensors turn as stresses do.
pub(super) fn carry(
    sources: &[PlacedSource<'_>],
    target: &TargetPart,
    elements: &[ElementReport],
    quantities: Quantities,
) -> Option<MappedHistory> {
    let is_known = sources.iter().any(|placed| !placed.part.history.is_empty());
    if !quantities.history || !is_known {
        return None;
    }
    let mut carried = MappedHistory {
        first_value: vec![0],
        first_tensor: vec![0],
        ..MappedHistory::default()
    };
    let mut gaps: BTreeMap<[Option<&String>; 2], usize> = BTreeMap::new();
    for (element, report) in elements.iter().enumerate() {
        if let Some(partner) = &report.partner {
            let placed = &sources[partner.source as usize];
            let own = partner.element as usize;
            if let Some(record) = placed.part.history.record(own) {
                let laws = [
                    placed.part.laws.get(&placed.part.mesh.parts()[own]),
                    target.laws.get(&target.mesh.parts()[element]),
                ];
                if laws[0].is_some() && laws[0] == laws[1] {
                    carried.push(placed, record, partner, target, element);
                } else {
                    *gaps.entry(laws).or_default() += 1;
                }
            }
        }
        carried.first_value.push(carried.values.len() as u32);
        carried.first_tensor.push(carried.tensors.len() as u32);
    }
    let gaps = gaps
        .into_iter()
        .map(|([source, target], n_elements)| LawGap {
            source: source.cloned(),
            target: target.cloned(),
            n_elements,
        });
    carried.left_out = gaps.collect();
    carried
        .left_out
        .sort_by_key(|gap| std::cmp::Reverse(gap.n_elements));
    Some(carried)
}

impl MappedHistory {
    fn push(
        &mut self,
        placed: &PlacedSource<'_>,
        record: &Record,
        partner: &Partner,
        target: &TargetPart,
        element: usize,
    ) {
        let rotation = &placed.target_from_source.rotation;
        let turn = if partner.is_copy {
            None
        } else {
            let normal = rotation * placed.part.mesh.normals()[partner.element as usize];
            let side = if partner.is_flipped { -normal } else { normal };
            smallest_rotation(&side, &target.mesh.normals()[element])
        };
        let turned = |tensor: &Tensor| {
            let whole: Matrix3 = turn.map_or(*rotation, |turn| turn * rotation);
            if whole == Matrix3::identity() {
                *tensor
            } else {
                rotated(tensor, &whole)
            }
        };
        let rule = &target.rules[target.rule_of[element] as usize];
        for &t in rule.places() {
            let t = if partner.is_flipped { -t } else { t };
            let layer = placed.part.history.nearest(record, t);
            self.values.extend_from_slice(layer.values);
            self.tensors.extend(layer.tensors.iter().map(turned));
        }
    }
}
