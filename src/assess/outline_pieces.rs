//! Pieces of sheet at the outline that only one part has: a lug, or what a notch or a cut corner took from the other.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::border_curve::{BorderCurve, Place, along};
use super::evidence::PoseEvidence;
use crate::geometry::serial::xyz;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::registration::Surface;
use crate::search::ClosestPoint;

/// A piece reaches beyond the other part by more than so many times what borders may lie apart: less is a matter of
/// their trims, …
const REACHES: f64 = 2.0;
/// … and by more than this share of the mean edge length of the coarser mesh: less is what an element cuts off the
/// corner of a lug or a notch.
const CORNER: f64 = 0.6;
/// A longer piece, as a share of the outline, is a side or an end that was trimmed elsewhere.
const LONGEST: f64 = 0.2;
/// Beside a piece the outline lies on the other part for at least this share of its length on each side, …
const BESIDE: f64 = 0.25;
/// … and goes on after it no farther turned than by this angle, as along a corner and unlike around an end. Cosine
/// of 120°.
const TURNED: f64 = -0.5;
/// At most so many places along the outlines of a part are looked at, …
const N_PLACES: f64 = 1000.0;
/// … and no closer together than so many times what borders may lie apart: a piece is wider.
const SPACING: f64 = 1.5;

/// Pieces of sheet at the outlines that only one part has. In target units and the target's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OutlinePieces {
    /// Pieces of the source that reach beyond the target's outline.
    pub only_source: usize,
    /// Pieces of the target that reach beyond the source's.
    pub only_target: usize,
    /// How far the one that reaches farthest lies beyond the other part.
    pub by: f64,
    /// Where it does.
    #[serde(with = "xyz")]
    pub at: Point3,
}

/// Lengths in target units.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// A place lies on the other part if it lies no farther beyond it.
    beside: f64,
    /// A piece reaches farther.
    reaches: f64,
}

/// How far a piece reaches, and where.
struct Piece {
    by: f64,
    at: Point3,
}

impl OutlinePieces {
    /// The pieces under the pose of the evidence, by the borders of source and target; `limit` is how far these may lie
    /// apart. `None` where there are none. O(places along the outlines · log triangles).
    pub(super) fn of(
        evidence: &PoseEvidence<'_>,
        [source_borders, target_borders]: [&[BorderCurve]; 2],
        limit: f64,
    ) -> Option<Self> {
        let (pose, back) = (evidence.pose, evidence.pose.inverse());
        let still = Similarity::identity();
        let (source, target) = (evidence.source, evidence.target);
        let limits = Limits {
            beside: limit,
            reaches: (REACHES * limit).max(CORNER * evidence.borders.edge),
        };
        let (of_source, of_target) = rayon::join(
            || pieces(source_borders, (target, &pose, 1.0), limits),
            || pieces(target_borders, (source, &back, pose.scale), limits),
        );
        let places = [(&of_source, &pose), (&of_target, &still)];
        let places = places.into_iter().flat_map(|(pieces, target_from_own)| {
            let place = |piece: &Piece| (piece.by, target_from_own.apply(&piece.at));
            pieces.iter().map(place).collect::<Vec<_>>()
        });
        let (by, at) = places.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self {
            only_source: of_source.len(),
            only_target: of_target.len(),
            by,
            at,
        })
    }

    /// Whether each part has a piece that the other lacks.
    pub(super) fn are_of_both(&self) -> bool {
        self.only_source > 0 && self.only_target > 0
    }
}

/// The pieces of a part with these borders, each with its place in the part's own frame. The other part comes with the
/// motion to its frame and the length of its unit in target units, in which the pieces are measured.
fn pieces(
    borders: &[BorderCurve],
    (other, other_from_own, unit): (&Surface, &Similarity, f64),
    limits: Limits,
) -> Vec<Piece> {
    let outlines = borders.iter().filter(|border| !border.is_hole);
    let outlines: Vec<&BorderCurve> = outlines.collect();
    let length: f64 = outlines.iter().map(|outline| outline.length).sum();
    let own_unit = unit * other_from_own.scale;
    let spacing = (SPACING * limits.beside / own_unit).max(length / N_PLACES);
    let found = outlines.into_par_iter().flat_map_iter(|outline| {
        let places = along(std::slice::from_ref(outline), spacing);
        let beyond = beyond(&places, other, other_from_own);
        let beyond: Vec<f64> = beyond.into_iter().map(|by| by * unit).collect();
        runs(&beyond, limits.beside)
            .filter_map(|run| piece(&places, &beyond, run, limits))
            .filter(|piece| piece.by > limits.reaches)
            .collect::<Vec<_>>()
    });
    found.collect()
}

/// How far each place lies beyond the borders of the other part within its sheet, in the other's unit; 0 over it.
fn beyond(places: &[Place], other: &Surface, other_from_own: &Similarity) -> Vec<f64> {
    let mut near = None;
    let mut beyond = |place: &Place| {
        let moved = place.moved(other_from_own);
        let hit = other
            .bvh()
            .closest(&moved.point, f64::INFINITY, near, None)?;
        near = Some(hit.triangle);
        let away = moved.point - hit.point;
        // Over a fold, coarse facets lie off it as seen from the one part or from the other.
        let within = |normal: Vector3| (away - normal * away.dot(&normal)).norm();
        let is_beyond = other.is_on_border(&hit);
        is_beyond.then(|| within(moved.normal).min(within(other.normal_at(&hit))))
    };
    let found = places.iter().map(|place| beyond(place).unwrap_or(0.0));
    found.collect()
}

/// Places of a closed curve one after the other: the first, which may lie before the end, and how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    first: usize,
    n: usize,
}

/// The runs of values above a limit along a closed curve; none where all are.
fn runs(values: &[f64], limit: f64) -> impl Iterator<Item = Run> {
    let n = values.len();
    let is_above = move |i: usize| values[i % n] > limit;
    let starts = (0..n).filter(move |&i| is_above(i) && !is_above(i + n - 1));
    starts.map(move |first| Run {
        first,
        n: (first..first + n)
            .take_while(|&i| values[i % n] > limit)
            .count(),
    })
}

/// What a run of places beyond the other part is, if it is a piece of the outline and no side or end of the part.
fn piece(places: &[Place], beyond: &[f64], run: Run, limits: Limits) -> Option<Piece> {
    let n = places.len();
    if run.n as f64 > LONGEST * n as f64 {
        return None;
    }
    let beside = ((BESIDE * run.n as f64) as usize).max(2);
    let sides = [run.first + n - beside, run.first + run.n].map(|from| from..from + beside);
    let directions = sides.clone().map(|side| {
        let along = side.map(|i| places[i % n].tangent);
        along.sum::<Vector3>()
    });
    let [before, after] = directions;
    let goes_on = before.dot(&after) > TURNED * before.norm() * after.norm();
    let is_on_the_other = |i: usize| beyond[i % n] <= limits.reaches;
    let lies_beside = sides.into_iter().flatten().all(is_on_the_other);
    let inside = (run.first..run.first + run.n).map(|i| i % n);
    let farthest = inside.max_by(|&a, &b| beyond[a].total_cmp(&beyond[b]))?;
    (goes_on && lies_beside).then(|| Piece {
        by: beyond[farthest],
        at: places[farthest].point,
    })
}
