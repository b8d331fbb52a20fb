//! A constant distance between the sheets, such as half a thickness.

use nalgebra::{SMatrix, SVector};

use super::{DeviationField, DeviationStats};
use crate::assess::fit::LEAST_OWN;
use crate::assess::least_squares::NormalEquations;
use crate::geometry::{Point3, Vector3};

/// Which surfaces of the sheet two meshes stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OffsetKind {
    /// Half a thickness apart: one mesh is the tool side, the other the mid-surface.
    ToolSideAgainstMidSurface,
    /// A whole thickness apart: the two meshes are opposite sides of the sheet.
    OppositeSides,
}

/// The parts are the same distance apart nearly everywhere, which is no bad fit but another
/// reference surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantOffset {
    /// The signed offset, in target length units.
    pub value: f64,
    /// How much the distances vary about it.
    pub spread: f64,
    /// The thickness it was compared with.
    pub thickness: f64,
    /// What it looks like.
    pub kind: OffsetKind,
}

/// A place with its signed distance, in the target's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) point: Point3,
    /// Unit normal of the target's front.
    pub(super) normal: Vector3,
    pub(super) distance: f64,
    pub(super) weight: f64,
}

/// The constant o of distances d = o + n · (t + ω × x): what is left of them when the best small
/// rigid move (t, ω) is taken out. A match by least squares hides an offset of bent parts in the
/// pose; this finds it again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantPart {
    /// The constant, in target length units.
    pub value: f64,
    /// Root mean square of what neither constant nor move explains.
    pub residual: f64,
}

/// Times that places far off the fit are left out and the fit is made again.
const ROUNDS: usize = 3;
/// How far off, in residuals.
const OUTLIER: f64 = 2.5;

/// The constant, then the shift and the turn of a move.
type Unknowns = SVector<f64, 7>;

impl ConstantPart {
    /// Weighted least squares over seven unknowns, outliers left out. O(samples).
    pub(super) fn of(samples: &[Sample]) -> Option<Self> {
        let total: f64 = samples.iter().map(|s| s.weight).sum();
        let origin = samples.first()?.point;
        let mean = |of: &dyn Fn(&Sample) -> Vector3| {
            let sum: Vector3 = samples.iter().map(|s| of(s) * s.weight).sum();
            sum / total
        };
        let center = origin + mean(&|s| s.point - origin);
        let radius = mean(&|s| Vector3::new((s.point - center).norm(), 0.0, 0.0)).x;
        if !(total > 0.0 && radius > 0.0) {
            return None;
        }
        let row = |s: &Sample| {
            let lever = ((s.point - center) / radius).cross(&s.normal);
            let n = &s.normal;
            Unknowns::from([1.0, n.x, n.y, n.z, lever.x, lever.y, lever.z])
        };
        let mut found: Option<(Unknowns, f64)> = None;
        for _ in 0..ROUNDS {
            let is_kept = |s: &Sample, row: &Unknowns| {
                found.is_none_or(|(fit, rms)| {
                    (s.distance - fit.dot(row)).abs() <= OUTLIER * rms + f64::MIN_POSITIVE
                })
            };
            let mut equations = NormalEquations::<7>::default();
            let (mut kept, mut square) = (0.0, 0.0);
            for sample in samples {
                let row = row(sample);
                if is_kept(sample, &row) {
                    equations.add_symmetric(&row, sample.distance, sample.weight);
                    kept += sample.weight;
                    square += sample.weight * sample.distance * sample.distance;
                }
            }
            let NormalEquations { matrix, right } = equations;
            // Flat, round and extruded parts leave some moves free; those are left out.
            let inverse = matrix.svd(true, true).pseudo_inverse(1e-9 * kept).ok()?;
            if !is_separable(&matrix) {
                return None;
            }
            let fit = inverse * right;
            let left = (square - fit.dot(&right)).max(0.0);
            found = Some((fit, (left / kept).sqrt()));
        }
        let (fit, residual) = found?;
        Some(Self {
            value: fit[0],
            residual,
        })
    }
}

/// True if enough of the constant's column lies outside the span of the six columns of a move.
fn is_separable(matrix: &SMatrix<f64, 7, 7>) -> bool {
    let moves: SMatrix<f64, 6, 6> = matrix.fixed_view::<6, 6>(1, 1).into();
    let mixed: SVector<f64, 6> = matrix.fixed_view::<6, 1>(1, 0).into();
    let whole = matrix[(0, 0)];
    let inverse = moves.svd(true, true).pseudo_inverse(1e-9 * whole);
    inverse.is_ok_and(|inverse| whole - mixed.dot(&(inverse * mixed)) > LEAST_OWN * whole)
}

/// The offset must be this many spreads away from zero: then hardly any area lies on the other side.
const SIGNIFICANT: f64 = 3.0;
/// And this many times the faceting.
const ABOVE_NOISE: f64 = 2.0;
/// How far the offset may be from half or all of the thickness, as a share of the thickness.
const TOLERANCE: f64 = 0.15;

impl ConstantOffset {
    /// Looks for an offset of about half or all of the thickness: in the constant part, or where
    /// that is not known in the median.
    pub(super) fn of(
        field: &DeviationField,
        stats: &DeviationStats,
        thickness: f64,
        noise: f64,
    ) -> Option<Self> {
        if stats.is_empty() || thickness <= 0.0 {
            return None;
        }
        let median = || {
            let spread = (stats.quantile(0.75) - stats.quantile(0.25)) / 2.0;
            (stats.quantile(0.5), spread)
        };
        let constant = field.constant.map(|part| (part.value, part.residual));
        let (value, spread) = constant.unwrap_or_else(median);
        if value.abs() < (SIGNIFICANT * spread).max(ABOVE_NOISE * noise) {
            return None;
        }
        let ratio = value.abs() / thickness;
        let kind = if (ratio - 0.5).abs() <= TOLERANCE {
            OffsetKind::ToolSideAgainstMidSurface
        } else if (ratio - 1.0).abs() <= TOLERANCE {
            OffsetKind::OppositeSides
        } else {
            return None;
        };
        Some(Self {
            value,
            spread,
            thickness,
            kind,
        })
    }
}
