//! Is the mapping right? Means, percentiles and histograms of both sides, and the way back.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::history::SourceHistory;
use super::layered::Layered;
use super::options::{MapOptions, Quantities};
use super::source::SourcePart;
use super::target::{Mapped, TargetPart};
use super::{MappingError, PlacedSource, map};
use crate::geometry::Similarity;
use crate::geometry::chunks::for_chunks;
use crate::monitor::{Cancelled, Monitor};

/// Area-weighted distribution of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distribution {
    /// Area-weighted mean.
    pub mean: f64,
    /// Smallest value.
    pub min: f64,
    /// 5, 50, 95 and 99 % of the area lie at or below these values.
    pub percentiles: [f64; 4],
    /// Largest value.
    pub max: f64,
    /// Area that has the quantity.
    pub area: f64,
}

/// The percentiles of [`Distribution::percentiles`].
const PERCENTILES: [f64; 4] = [0.05, 0.5, 0.95, 0.99];
/// Bins of a histogram.
const N_BINS: usize = 50;

/// The distribution of values with the area each stands for; values that are not finite are left
/// out. `None` if there are none. O(n log n).
pub fn distribution(values: impl Iterator<Item = (f64, f64)>) -> Option<Distribution> {
    let mut sorted: Vec<(f64, f64)> = values
        .filter(|(value, area)| value.is_finite() && *area > 0.0)
        .collect();
    sorted.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    let area: f64 = sorted.iter().map(|(_, area)| area).sum();
    let mean = sorted.iter().map(|(value, area)| value * area).sum::<f64>() / area;
    let (min, max) = (sorted.first()?.0, sorted.last()?.0);
    let mut percentiles = [max; 4];
    let mut below = 0.0;
    let mut next = 0;
    for (value, own) in &sorted {
        below += own;
        while next < PERCENTILES.len() && below >= PERCENTILES[next] * area {
            percentiles[next] = *value;
            next += 1;
        }
    }
    Some(Distribution {
        mean,
        min,
        percentiles,
        max,
        area,
    })
}

/// Shares of the area in equal bins over a range.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueHistogram {
    /// Lower end of the first bin.
    pub min: f64,
    /// Upper end of the last bin.
    pub max: f64,
    /// Share of the area in each bin; they sum to 1.
    pub shares: Vec<f64>,
}

impl ValueHistogram {
    /// Fifty bins over a range; values outside it count in the first or last bin.
    pub fn new(values: impl Iterator<Item = (f64, f64)>, min: f64, max: f64) -> Self {
        let mut shares = vec![0.0; N_BINS];
        let width = (max - min).max(f64::MIN_POSITIVE);
        for (value, area) in values.filter(|(value, _)| value.is_finite()) {
            let bin = ((value - min) / width * N_BINS as f64).floor();
            shares[bin.clamp(0.0, N_BINS as f64 - 1.0) as usize] += area;
        }
        let all: f64 = shares.iter().sum();
        if all > 0.0 {
            shares.iter_mut().for_each(|share| *share /= all);
        }
        Self { min, max, shares }
    }
}

/// Half the sum of the differences of two histograms over the same range: 0 for equal, 1 for
/// disjoint ones.
pub fn histogram_distance(a: &ValueHistogram, b: &ValueHistogram) -> f64 {
    let pairs = a.shares.iter().zip(&b.shares);
    0.5 * pairs.map(|(a, b)| (a - b).abs()).sum::<f64>()
}

/// How far one quantity of the sources is from what comes back, weighted by area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackDifference {
    /// Root mean square.
    pub rms: f64,
    /// 95 % of the area differ by less.
    pub p95: f64,
    /// The sources' 95th less their 5th percentile, to compare with.
    pub range: f64,
}

impl BackDifference {
    /// What 95 % of the area differ by less than, as a share of the range; `None` where the range is 0.
    pub fn share_of_range(&self) -> Option<f64> {
        (self.range > 0.0).then(|| self.p95 / self.range)
    }
}

/// What comes back when the mapped values are mapped onto the sources again. Two mappings lie
/// between the values compared, so the error of one is about half.
#[derive(Debug, Clone, PartialEq)]
pub struct MapBack {
    /// Difference of the thickness.
    pub thickness: BackDifference,
    /// Difference of the plastic strain, mean over the layers.
    pub plastic: BackDifference,
    /// Share of the sources' area that the way back reached.
    pub coverage: f64,
    /// For each element of each source whether the way back reached it. Where several sources overlap, it
    /// reaches the one that the values were taken from.
    pub is_covered: Vec<Vec<bool>>,
}

/// Maps `mapped` back onto its sources and compares thickness and plastic strain.
pub fn map_back(
    sources: &[PlacedSource<'_>],
    target: &TargetPart,
    mapped: &Mapped,
    options: &MapOptions,
    monitor: &Monitor,
) -> Result<MapBack, MappingError> {
    let n = target.mesh.len();
    let mut states = Layered::new(n);
    if let Some(layers) = &mapped.states {
        for_chunks(n, monitor, |range| {
            for element in range {
                let rule = &target.rules[target.rule_of[element] as usize];
                let values = layers.of(element);
                let planes = values.len() / rule.len().max(1);
                let places = rule
                    .places()
                    .iter()
                    .flat_map(|&t| std::iter::repeat_n(t, planes));
                states.set(element, places.zip(values.iter().copied()));
            }
        })?;
    }
    monitor.check()?;
    let as_source = SourcePart {
        mesh: target.mesh.clone(),
        thickness: mapped
            .thickness
            .iter()
            .map(|&t| [t / options.thickness_scale; 4])
            .collect(),
        states,
        strains: Layered::new(n),
        history: SourceHistory::default(),
        laws: BTreeMap::new(),
    };
    let mapped_quantities = options.quantities;
    let options = MapOptions {
        quantities: Quantities::USUAL,
        fill_rings: 0,
        thickness_scale: 1.0,
        ..options.clone()
    };
    let placed = PlacedSource {
        part: &as_source,
        target_from_source: Similarity::identity(),
    };
    let mut compared = Compared {
        has_plastic: mapped_quantities.plastic_strain,
        ..Compared::default()
    };
    for (number, source) in sources.iter().enumerate() {
        let moved = source.part.mesh.moved(&source.target_from_source);
        monitor.check()?;
        let as_target = TargetPart {
            rule_of: vec![0; moved.len()],
            n_plane: vec![1; moved.len()],
            nominal_thickness: vec![f64::NAN; moved.len()],
            laws: BTreeMap::new(),
            rules: target.rules.iter().take(1).cloned().collect(),
            mesh: moved,
        };
        let back = map(&[placed], &as_target, &options, monitor)?;
        // What another source gave says nothing of this one.
        let is_own = |element: usize| {
            let partner = back.elements[element].partner;
            let giver = partner.and_then(|there| mapped.elements[there.element as usize].partner);
            giver.is_none_or(|giver| giver.source as usize == number)
        };
        compared.add(source.part, &as_target, (&back, &is_own), monitor)?;
    }
    Ok(compared.summary(monitor)?)
}

/// Values with the area each stands for.
type Weighted = Vec<(f64, f64)>;

/// Values of the sources and what the way back leaves of them.
#[derive(Default)]
struct Compared {
    /// The plastic strain was mapped, and is not 0 because nobody asked for it.
    has_plastic: bool,
    thickness: (Weighted, Weighted),
    plastic: (Weighted, Weighted),
    is_covered: Vec<Vec<bool>>,
    covered_area: f64,
    area: f64,
}

impl Compared {
    fn add(
        &mut self,
        source: &SourcePart,
        as_target: &TargetPart,
        (back, is_own): (&Mapped, &dyn Fn(usize) -> bool),
        monitor: &Monitor,
    ) -> Result<(), Cancelled> {
        let areas = as_target.mesh.areas();
        let (thickness, plastic) = (&mut self.thickness, &mut self.plastic);
        let mut is_covered = Vec::with_capacity(areas.len());
        for_chunks(areas.len(), monitor, |range| {
            for element in range {
                let area = areas[element];
                let has_values = back.elements[element].status.has_values();
                let is_here = is_own(element);
                is_covered.push(has_values && is_here);
                if !is_here {
                    continue;
                }
                let own = source.mean_thickness(element);
                let returned = back.thickness.get(element).copied().unwrap_or(f64::NAN);
                if own.is_finite() && returned.is_finite() {
                    thickness.0.push((own, area));
                    thickness.1.push(((returned - own).abs(), area));
                }
                let own = source.mean_plastic_strain(element);
                let returned = back.mean_plastic_strain(as_target, element);
                if self.has_plastic && own.is_finite() && returned.is_finite() {
                    plastic.0.push((own, area));
                    plastic.1.push(((returned - own).abs(), area));
                }
            }
        })?;
        let covered = is_covered
            .iter()
            .zip(areas)
            .filter(|(covered, _)| **covered);
        self.covered_area += covered.map(|(_, area)| area).sum::<f64>();
        self.area += as_target.mesh.area();
        self.is_covered.push(is_covered);
        Ok(())
    }

    fn summary(self, monitor: &Monitor) -> Result<MapBack, Cancelled> {
        let Self {
            thickness,
            plastic,
            is_covered,
            covered_area,
            area,
            ..
        } = self;
        Ok(MapBack {
            thickness: back_difference(thickness, monitor)?,
            plastic: back_difference(plastic, monitor)?,
            coverage: covered_area / area,
            is_covered,
        })
    }
}

fn back_difference(
    (own, differences): (Weighted, Weighted),
    monitor: &Monitor,
) -> Result<BackDifference, Cancelled> {
    let range = distribution(own.into_iter()).map_or(0.0, |d| d.percentiles[2] - d.percentiles[0]);
    monitor.check()?;
    let squares = differences
        .iter()
        .map(|(d, area)| d * d * area)
        .sum::<f64>();
    let area: f64 = differences.iter().map(|(_, area)| area).sum();
    let p95 = distribution(differences.into_iter()).map_or(0.0, |d| d.percentiles[2]);
    let rms = if area > 0.0 {
        (squares / area).sqrt()
    } else {
        0.0
    };
    monitor.check()?;
    Ok(BackDifference { rms, p95, range })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_by_area() {
        let values = [(1.0, 94.0), (5.0, 4.5), (9.0, 1.5), (f64::NAN, 50.0)];
        let found = distribution(values.into_iter()).unwrap();
        assert_eq!((found.min, found.max, found.area), (1.0, 9.0, 100.0));
        assert_eq!(found.percentiles, [1.0, 1.0, 5.0, 9.0]);
        assert!((found.mean - (94.0 + 22.5 + 13.5) / 100.0).abs() < 1e-12);
        assert_eq!(distribution(std::iter::empty()), None);
    }

    #[test]
    fn histograms_differ_by_the_share_that_moved() {
        let a = ValueHistogram::new([(0.1, 1.0), (0.9, 3.0)].into_iter(), 0.0, 1.0);
        let b = ValueHistogram::new([(0.1, 2.0), (0.9, 2.0)].into_iter(), 0.0, 1.0);
        assert_eq!(histogram_distance(&a, &a), 0.0);
        assert_eq!(histogram_distance(&a, &b), 0.25);
    }
}
