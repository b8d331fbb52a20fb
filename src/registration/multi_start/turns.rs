//! Poses of a part that looks the same after a share of a full turn, like a wheel: one small hole may be all that
//! distinguishes them, and of so many that score alike the usual starts keep any few.

use std::f64::consts::TAU;

use nalgebra::Unit;
use rayon::prelude::*;

use super::candidate::{Candidate, DataChoice};
use super::starts::{Start, StartKind};
use crate::geometry::{Point3, Rotation, Similarity, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::subsample::subsample;
use crate::registration::surface::{Measures, Surface};
use crate::search::FeatureGrid;

/// Three or more like sectors spread a part equally in all directions across their axis. Spreads of which the
/// larger is at most this many times the smaller are equal: features of one sector may differ.
const SAME_SPREAD: f64 = 1.05;
/// Angles that are looked at in one turn: a sector of a wheel of twelve has 15 of them.
const N_ANGLES: usize = 180;
/// Points of the data that they are looked at with.
const N_POINTS: usize = 300;
/// Distances count up to this share of the diagonal of the model, which is the unit of its grid.
const REACH: f64 = 0.04;
/// A turned pose is like the one it was made from if its mean squared distance is at most this many times as
/// large …
const AS_CLOSE: f64 = 4.0;
/// … and the distance of so many cells of the grid more.
const CELLS: f64 = 0.5;
/// Where more than this share of all angles is alike, the part is round: it is free to turn and its borders
/// determine where it belongs.
const ROUND: f64 = 0.5;
/// Turned poses that are tried at most.
const MOST: usize = 16;

/// The pose of `best` turned about the axis of a nearly rotationally symmetric part to all angles at which
/// the parts lie on each other as well. Empty for other parts, and where there is no grid to look on.
/// O(angles · points).
pub(crate) fn turns(
    choice: &DataChoice<'_>,
    best: &Candidate,
    monitor: &Monitor,
) -> Result<Vec<Start>, Cancelled> {
    let (data, model) = (choice.coarse.data, choice.coarse.model);
    let pose = best.run.model_from_data;
    let Some(grid) = choice.grid.as_deref() else {
        return Ok(Vec::new());
    };
    let Some(axis) = Axis::of(data, model, &pose) else {
        return Ok(Vec::new());
    };
    let points: Vec<Point3> = subsample(data, N_POINTS, monitor)?
        .iter()
        .map(|sample| pose.apply(&sample.point))
        .collect();
    let at = |i: usize| axis.turn(TAU * i as f64 / N_ANGLES as f64);
    let apart: Vec<f64> = (0..N_ANGLES)
        .into_par_iter()
        .map(|i| mean_square(grid, &points, &at(i)))
        .collect();
    monitor.check()?;
    let more = CELLS * f64::from(grid.cell());
    let limit = AS_CLOSE * apart[0] + more * more;
    let n_alike = apart.iter().filter(|&&apart| apart <= limit).count();
    if n_alike as f64 > ROUND * N_ANGLES as f64 {
        return Ok(Vec::new());
    }
    let is_lowest = |&i: &usize| {
        let next = apart[(i + 1) % N_ANGLES];
        apart[i] <= limit && apart[i] < apart[i - 1] && apart[i] <= next
    };
    // The first is where it lies.
    let mut found: Vec<usize> = (1..N_ANGLES).filter(is_lowest).collect();
    found.sort_by(|&a, &b| apart[a].total_cmp(&apart[b]).then(a.cmp(&b)));
    found.truncate(MOST);
    found.sort_unstable();
    let start = |(index, i)| {
        let turned = at(i).after(&pose);
        Start {
            kind: StartKind::Turned { index },
            flipped: best.start.flipped,
            target_from_source: choice.data_side().oriented(&turned),
        }
    };
    Ok(found.into_iter().enumerate().map(start).collect())
}

/// An axis in the frame of the model.
struct Axis {
    direction: Unit<Vector3>,
    point: Point3,
}

impl Axis {
    /// That of the model, or else of the data under its pose; `None` if neither is spread equally around one.
    fn of(data: &Surface, model: &Surface, model_from_data: &Similarity) -> Option<Self> {
        let still = Similarity::identity();
        let axis = |surface: &Surface, pose: &Similarity| {
            let measures = surface.measures();
            let direction = pose.rotate(&direction_around(measures)?);
            Some(Self {
                direction: Unit::new_normalize(direction),
                point: pose.apply(&measures.centroid),
            })
        };
        axis(model, &still).or_else(|| axis(data, model_from_data))
    }

    fn turn(&self, angle: f64) -> Similarity {
        let rotation = Rotation::from_axis_angle(&self.direction, angle);
        Similarity::about(&self.point, *rotation.to_rotation_matrix().matrix())
    }
}

/// The principal direction across which a part is spread equally.
fn direction_around(measures: &Measures) -> Option<Vector3> {
    let spread = &measures.principal_spread;
    let ratios = [(2, spread[0] / spread[1]), (0, spread[1] / spread[2])];
    let equal = ratios
        .into_iter()
        .filter(|(_, ratio)| *ratio <= SAME_SPREAD);
    let (axis, _) = equal.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(measures.principal_axes.column(axis).into())
}

/// Of the distances of turned points from the samples of a grid, in its units.
fn mean_square(grid: &FeatureGrid, points: &[Point3], turn: &Similarity) -> f64 {
    let squares = points.iter().map(|point| {
        let local = grid.to_local(&turn.apply(point));
        let nearest = grid.nearest(local);
        let off = |k: usize| f64::from(local[k] - nearest.point[k]);
        let along = (0..3).map(|k| off(k) * f64::from(nearest.normal[k]));
        let along: f64 = along.sum();
        // Samples lie apart on the sheet; beyond its border the way there counts whole.
        let whole: f64 = (0..3).map(|k| off(k) * off(k)).sum();
        let cell = 2.0 * f64::from(grid.cell());
        let beyond = (whole - along * along - cell * cell).max(0.0);
        (along * along + beyond).min(REACH * REACH)
    });
    squares.sum::<f64>() / points.len().max(1) as f64
}
