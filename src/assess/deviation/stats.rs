//! Mean, spread and percentiles of distances.

use super::offset::ConstantOffset;
use super::{DeviationField, OverlapClass};
use crate::text::NOTHING;

/// Numbers over the area that has a counterpart (`Matched` and `OffByMore`), each vertex weighted
/// with its area. Lengths in target length units.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviationStats {
    /// Mean signed distance.
    pub mean: f64,
    /// Root mean square distance.
    pub rms: f64,
    /// Standard deviation about the mean.
    pub std: f64,
    /// Distance that 95 % of the area does not exceed, without sign.
    pub p95: f64,
    /// Smallest signed distance.
    pub min: f64,
    /// Largest signed distance.
    pub max: f64,
    /// Share of the part's whole area that is matched, off by more, only here, in the order of
    /// [`OverlapClass::ALL`].
    pub class_shares: [f64; 3],
    /// A constant offset that explains the distances, if there is one.
    pub offset: Option<ConstantOffset>,
    /// Signed values, sorted, each with the area up to and with it.
    values: Vec<(f64, f64)>,
}

/// How much area has which value.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Values at both ends.
    pub range: [f64; 2],
    /// Share of the compared area in each bin, from the lower to the upper end. The last bin
    /// holds the upper end.
    pub shares: Vec<f64>,
    /// Share below the range.
    pub below: f64,
    /// Share above the range.
    pub above: f64,
}

impl DeviationStats {
    /// Counts a field. `thickness` is that of the sheet, `noise` the size of distances that mean
    /// nothing; both are for the offset. O(n log n).
    pub fn of(field: &DeviationField, thickness: Option<f64>, noise: f64) -> Self {
        let compared = field.class.iter().enumerate();
        let mut values: Vec<(f64, f64)> = compared
            .filter(|(_, class)| **class != OverlapClass::OnlyHere)
            .map(|(vertex, _)| (field.signed[vertex], field.area[vertex]))
            .filter(|(_, area)| *area > 0.0)
            .collect();
        values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let total: f64 = values.iter().map(|(_, area)| area).sum();
        let mean_of = |f: &dyn Fn(f64) -> f64| {
            let sum: f64 = values.iter().map(|(value, area)| f(*value) * area).sum();
            if total > 0.0 { sum / total } else { 0.0 }
        };
        let mean = mean_of(&|value| value);
        let rms = mean_of(&|value| value * value).sqrt();
        let std = mean_of(&|value| (value - mean).powi(2)).sqrt();
        let [min, max] = [values.first(), values.last()].map(|end| end.map_or(0.0, |end| end.0));
        let mut running = 0.0;
        for (_, area) in &mut values {
            running += *area;
            *area = running;
        }
        let mut stats = Self {
            mean,
            rms,
            std,
            p95: 0.0,
            min,
            max,
            class_shares: field.class_shares(),
            offset: None,
            values,
        };
        stats.p95 = stats.distance_of_share(0.95);
        let offset = |thickness| ConstantOffset::of(field, &stats, thickness, noise);
        stats.offset = thickness.and_then(offset);
        stats
    }

    /// True if nothing has a counterpart.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Area that has a counterpart, in target units squared.
    pub fn compared_area(&self) -> f64 {
        self.values.last().map_or(0.0, |(_, area)| *area)
    }

    /// Share of the compared area within ± `tolerance`. O(log n).
    pub fn share_inside(&self, tolerance: f64) -> f64 {
        let inside = self.area_up_to(tolerance) - self.area_below(-tolerance);
        self.share(inside)
    }

    /// Signed value that `share` of the compared area does not exceed: 0.5 for the median. O(log n).
    pub fn quantile(&self, share: f64) -> f64 {
        let wanted = share * self.compared_area();
        let at = self.values.partition_point(|(_, area)| *area < wanted);
        let at = at.min(self.values.len().saturating_sub(1));
        self.values.get(at).map_or(0.0, |(value, _)| *value)
    }

    /// Smallest distance, without sign, that holds at least `share` of the compared area within it.
    pub fn distance_of_share(&self, share: f64) -> f64 {
        let wanted = share.min(1.0) * (1.0 - 1e-12);
        let (mut low, mut high) = (0.0, self.min.abs().max(self.max.abs()));
        if self.share_inside(low) >= wanted {
            return low;
        }
        // Halving ends at neighbouring numbers, where `high` is one of the values.
        loop {
            let middle = low + (high - low) / 2.0;
            if middle <= low || middle >= high {
                return high;
            }
            if self.share_inside(middle) >= wanted {
                high = middle;
            } else {
                low = middle;
            }
        }
    }

    /// Shares of the compared area in `n_bins` equal bins over `range`. O(bins · log n).
    pub fn histogram(&self, n_bins: usize, range: [f64; 2]) -> Histogram {
        let [low, high] = range;
        let n = n_bins.max(1);
        let edge = |i: usize| low + (high - low) * i as f64 / n as f64;
        let below = self.area_below(low);
        let mut from = below;
        let shares = (1..=n).map(|i| {
            let to = if i == n {
                self.area_up_to(high)
            } else {
                self.area_below(edge(i))
            };
            let share = self.share(to - from);
            from = to;
            share
        });
        let shares = shares.collect();
        Histogram {
            range,
            shares,
            below: self.share(below),
            above: self.share(self.compared_area() - self.area_up_to(high)),
        }
    }

    /// A limit for the colours: the 99th percentile of the distances, rounded up to 1, 2 or 5 times
    /// a power of ten. 1 if there is nothing to see but rounding.
    pub fn round_limit(&self) -> f64 {
        let wanted = self.distance_of_share(0.99);
        if wanted < NOTHING || !wanted.is_finite() {
            return 1.0;
        }
        let power = 10f64.powf(wanted.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
        let enough = steps.into_iter().find(|&s| s >= wanted * (1.0 - 1e-9));
        enough.unwrap_or(10.0 * power)
    }

    fn share(&self, area: f64) -> f64 {
        let total = self.compared_area();
        if total > 0.0 {
            (area / total).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    fn area_below(&self, value: f64) -> f64 {
        self.area_of_first(self.values.partition_point(|(v, _)| *v < value))
    }

    fn area_up_to(&self, value: f64) -> f64 {
        self.area_of_first(self.values.partition_point(|(v, _)| *v <= value))
    }

    fn area_of_first(&self, n: usize) -> f64 {
        n.checked_sub(1).map_or(0.0, |last| self.values[last].1)
    }
}
