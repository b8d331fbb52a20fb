//! Poses from holes: two holes of the smaller part on two of the larger one that are as large and as far apart, or its
//! only hole on each that is as large. Where a part can slide along its counterpart, holes determine where it belongs.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::cloud::{Cloud, Motion32};
use super::rounds::First;
use super::seeds::{aligned, frame, matrix};
use crate::geometry::{Matrix3, Point3, Rotation, Vector3};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::surface::Surface;
use crate::search::FeatureGrid;

/// Holes of the smaller and of the larger part that poses are made of, the largest first …
const MOST_HOLES: [usize; 2] = [24, 64];
/// … and holes of a part that are counted: the only one that distinguishes places of a regular pattern may be small.
const MOST_COUNTED: usize = 500;
/// Holes are as large if their radii differ by at most this share of the larger one and so many mean edge lengths,
/// which the corners of a coarse or ragged hole take from it.
const SAME_RADIUS: f64 = 0.15;
const RADIUS_EDGES: f64 = 0.25;
/// Two holes are as far apart as two others if the distances differ by at most so many mean edge lengths and this
/// share of the smaller part's diagonal, by which springback moves them.
const DISTANCE_EDGES: f64 = 0.5;
const DISTANCE_SHARE: f64 = 0.005;
/// Holes nearer to each other than this share of the diagonal fix no direction.
const LEAST_APART: f64 = 0.05;
/// Two cosines between holes and the sheet around them are the same if they differ by no more than this.
const SAME_COSINE: f64 = 0.25;
/// A hole has its counterpart within so many mean edge lengths and this share of the diagonal.
const NEAR_EDGES: f64 = 0.5;
const NEAR_SHARE: f64 = 0.02;
/// The sum of the normals of two holes must stand across the way between them by this much.
const LEAST_ACROSS: f64 = 0.5;
/// Turns about the normal of an only hole.
const N_TURNS: usize = 36;
/// Where less than this share of the most holes have a counterpart, others lie closer to where the part belongs.
const NEARLY_MOST: f64 = 0.85;
/// Unless so many poses have more.
const LEAST_FIRST: usize = 4;
/// First poses at most: of a plate with hundreds of like holes they determine nothing.
const MOST_FIRST: usize = 10_000;
/// First poses whose holes are counted between two questions whether the search is cancelled.
const CHUNK: usize = 256;

/// A hole in grid units, of the data in the frame of its cloud.
#[derive(Debug, Clone, Copy)]
struct Hole {
    center: Vector3,
    /// Mean distance of its border from its middle.
    radius: f64,
    /// Unit normal of the sheet around it.
    normal: Vector3,
}

/// The holes of both parts.
pub(super) struct Holes {
    data: Vec<Hole>,
    model: Vec<Hole>,
    /// The holes of the model along an axis, by their middles.
    along: AlongAxis,
    alike: Alike,
}

impl Holes {
    pub(super) fn of(
        cloud: &Cloud,
        (data, model): (&Surface, &Surface),
        grid: &FeatureGrid,
    ) -> Self {
        let of_model = holes(model, |point| (point - grid.origin()) * cloud.scale);
        let mut of_data = holes(data, |point| (point - cloud.center) * cloud.scale);
        if cloud.is_mirrored {
            for hole in &mut of_data {
                hole.center.x = -hole.center.x;
                hole.normal.x = -hole.normal.x;
            }
        }
        let edge = [data, model].map(|part| part.measures().mean_edge_length);
        Self {
            data: of_data,
            along: AlongAxis::of(&of_model),
            model: of_model,
            alike: Alike {
                edge: edge[0].max(edge[1]) * cloud.scale,
                diagonal: f64::from(cloud.diagonal),
            },
        }
    }

    /// The first poses that they give under which nearly the most holes have their counterpart, in a fixed order; none
    /// where a part has no holes. O(holes of the data² · holes of the model²), both bounded.
    pub(super) fn first_poses(&self, monitor: &Monitor) -> Result<Vec<First>, Cancelled> {
        let mut found = Vec::new();
        let [data, model] = [(&self.data, MOST_HOLES[0]), (&self.model, MOST_HOLES[1])]
            .map(|(holes, most)| &holes[..holes.len().min(most)]);
        match data {
            [only] => self.alike.align_single(only, model, &mut found),
            _ => self.alike.align_pairs(data, model, &mut found),
        }
        let counted = found.par_chunks(CHUNK).map(|chunk| {
            monitor.check()?;
            let counts = chunk.iter().map(|first| self.aligned(&first.motion).0);
            Ok(counts.collect())
        });
        let counted: Result<Vec<Vec<usize>>, Cancelled> = counted.collect();
        let counts = counted?.concat();
        let mut sorted = counts.clone();
        sorted.sort_unstable_by(|a, b| b.cmp(a));
        // Surfaces do not distinguish the places of a regular pattern: those that most holes support come alone.
        let of_these = sorted.get(LEAST_FIRST).or(sorted.last()).copied();
        let nearly = NEARLY_MOST * sorted.first().copied().unwrap_or(0) as f64;
        let least = of_these.unwrap_or(0).max(nearly.ceil() as usize);
        let mut counts = counts.into_iter();
        found.retain(|_| counts.next().is_some_and(|n| n >= least));
        Ok(found)
    }

    /// A motion of the data shifted so that its holes lie on their counterparts in the mean, and how many have one.
    pub(super) fn aligned(&self, motion: &Motion32) -> (usize, Motion32) {
        let (mut n, mut sum) = (0, Vector3::zeros());
        for hole in &self.data {
            let moved = motion.apply(&hole.center);
            let off = |&i: &u32| self.model[i as usize].center - moved;
            let near = self.along.within(&self.model, &moved, self.alike.near());
            let like = near.iter().filter(|&&i| {
                let other = &self.model[i as usize];
                self.alike.are_as_large(hole, other)
            });
            // Of holes that lie equally close the first one.
            let nearest = like.map(|i| (off(i), i)).min_by(|a, b| {
                let closer = a.0.norm().total_cmp(&b.0.norm());
                closer.then(a.1.cmp(b.1))
            });
            let nearest = nearest.map(|(off, _)| off);
            if let Some(off) = nearest.filter(|off| off.norm() <= self.alike.near()) {
                n += 1;
                sum += off;
            }
        }
        let shift = sum / n.max(1) as f64;
        (n, motion.shifted(&shift))
    }
}

/// Holes in the order of their middles along the axis of the frame in which they extend farthest.
struct AlongAxis {
    axis: usize,
    holes: Vec<u32>,
}

impl AlongAxis {
    fn of(holes: &[Hole]) -> Self {
        let extent = |axis: usize| {
            let places = holes.iter().map(|hole| hole.center[axis]);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            high - low
        };
        let axis = (0..3).max_by(|&a, &b| extent(a).total_cmp(&extent(b)));
        let axis = axis.unwrap_or(0);
        let at = |i: u32| holes[i as usize].center[axis];
        let mut sorted: Vec<u32> = (0..holes.len() as u32).collect();
        sorted.sort_by(|&a, &b| at(a).total_cmp(&at(b)));
        Self {
            axis,
            holes: sorted,
        }
    }

    /// The holes that lie no farther than `near` from a point along the axis, among which are all that lie no farther
    /// from it.
    fn within(&self, holes: &[Hole], point: &Vector3, near: f64) -> &[u32] {
        let off = |&i: &u32| holes[i as usize].center[self.axis] - point[self.axis];
        let first = self.holes.partition_point(|i| off(i) < -near);
        let rest = &self.holes[first..];
        &rest[..rest.partition_point(|i| off(i) <= near)]
    }
}

/// The largest holes of a part, with their middles moved by `to_local`.
fn holes(surface: &Surface, to_local: impl Fn(&Point3) -> Vector3) -> Vec<Hole> {
    let mesh = surface.mesh();
    let found = surface.borders().iter().filter(|border| border.is_hole);
    let mut found: Vec<Hole> = found
        .filter_map(|border| {
            let center = to_local(&border.center);
            let (mut sum, mut length, mut area) = (0.0, 0.0, Vector3::zeros());
            for ends in border.segments(mesh) {
                let [a, b] = ends.map(|point| to_local(&point) - center);
                let edge = (b - a).norm();
                sum += edge * (0.5 * (a + b)).norm();
                length += edge;
                // The sheet lies to the left of its border, so around a hole its normal turns the other way.
                area -= a.cross(&b);
            }
            Some(Hole {
                center,
                radius: sum / length,
                normal: area.try_normalize(0.0)?,
            })
        })
        .collect();
    found.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    found.truncate(MOST_COUNTED);
    found
}

/// What counts as the same, in grid units.
struct Alike {
    /// The larger mean edge length.
    edge: f64,
    /// Diagonal of the data.
    diagonal: f64,
}

impl Alike {
    /// Within this a hole has its counterpart: the grid leaves a pose that can slide free by a cell.
    fn near(&self) -> f64 {
        NEAR_EDGES * self.edge + NEAR_SHARE * self.diagonal
    }

    fn are_as_large(&self, a: &Hole, b: &Hole) -> bool {
        let larger = a.radius.max(b.radius);
        (a.radius - b.radius).abs() <= SAME_RADIUS * larger + RADIUS_EDGES * self.edge
    }

    /// The only hole of the data on each hole of the model that is as large, turned about its normal.
    fn align_single(&self, only: &Hole, of_model: &[Hole], found: &mut Vec<First>) {
        for hole in of_model {
            if !self.are_as_large(only, hole) {
                continue;
            }
            for (turn, flipped) in (0..N_TURNS).flat_map(|k| [(k, false), (k, true)]) {
                let angle = TAU * turn as f64 / N_TURNS as f64;
                let turn = matrix(&Rotation::from_axis_angle(&Vector3::z_axis(), angle));
                let normal = if flipped { -only.normal } else { only.normal };
                let own = frame(&normal, &Vector3::x());
                let turn = frame(&hole.normal, &Vector3::x()) * turn * own.transpose();
                found.push(First {
                    flipped,
                    motion: aligned(&turn, &only.center, &hole.center),
                });
            }
        }
    }

    /// Every two holes of the data on every two of the model that stand to each other as they do.
    fn align_pairs(&self, of_data: &[Hole], of_model: &[Hole], found: &mut Vec<First>) {
        let there: Vec<Two> = (0..of_model.len())
            .flat_map(|k| (0..of_model.len()).map(move |l| [k, l]))
            .filter_map(|two| self.two(of_model, two))
            .collect();
        let own = (0..of_data.len())
            .flat_map(|j| (0..j).map(move |i| [i, j]))
            .filter_map(|two| self.two(of_data, two));
        for (own, flipped) in own.flat_map(|own| [(own, false), (own.turned_over(), true)]) {
            for other in &there {
                if found.len() == MOST_FIRST {
                    return;
                }
                if self.stand_alike(&own, other) {
                    found.push(First {
                        flipped,
                        motion: aligned(
                            &(other.frame * own.frame.transpose()),
                            &own.middle,
                            &other.middle,
                        ),
                    });
                }
            }
        }
    }

    /// Two holes of a part; `None` if they fix no pose.
    fn two(&self, holes: &[Hole], [first, second]: [usize; 2]) -> Option<Two> {
        if first == second {
            return None;
        }
        let holes = [holes[first], holes[second]];
        let [a, b] = holes;
        let along = b.center - a.center;
        let apart = along.norm();
        let normal = a.normal + b.normal;
        let is_wide = apart >= LEAST_APART * self.diagonal;
        let along = along.try_normalize(0.0).filter(|_| is_wide)?;
        // Of holes on opposite sides, or above each other, the normals do not fix the turn about the way between them.
        if along.cross(&normal).norm() < LEAST_ACROSS {
            return None;
        }
        Some(Two {
            apart,
            middle: 0.5 * (a.center + b.center),
            cosines: [
                a.normal.dot(&along),
                b.normal.dot(&along),
                a.normal.dot(&b.normal),
            ],
            frame: frame(&along, &normal),
            holes,
        })
    }

    fn stand_alike(&self, own: &Two, other: &Two) -> bool {
        let away = DISTANCE_EDGES * self.edge + DISTANCE_SHARE * self.diagonal;
        let mut holes = own.holes.iter().zip(&other.holes);
        let mut cosines = own.cosines.iter().zip(other.cosines);
        (own.apart - other.apart).abs() <= away
            && holes.all(|(a, b)| self.are_as_large(a, b))
            && cosines.all(|(a, b)| (a - b).abs() <= SAME_COSINE)
    }
}

/// Two holes of one part, the first one first.
#[derive(Debug, Clone, Copy)]
struct Two {
    holes: [Hole; 2],
    apart: f64,
    middle: Vector3,
    /// Of the normals with the way from the first hole to the second, and with each other.
    cosines: [f64; 3],
    /// Its third axis is that way, its first one the mean normal as far as it stands across it.
    frame: Matrix3,
}

impl Two {
    /// The same with the normals reversed.
    fn turned_over(self) -> Self {
        let [a, b, between] = self.cosines;
        let columns = [
            -self.frame.column(0),
            -self.frame.column(1),
            self.frame.column(2).into(),
        ];
        Self {
            cosines: [-a, -b, between],
            frame: Matrix3::from_columns(&columns),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holes of two sizes in rows, some of them at one place.
    fn rows(n: usize) -> Vec<Hole> {
        let hole = |i: usize| Hole {
            center: Vector3::new(0.1 * (i % 7) as f64, 0.05 * (i / 9) as f64, 0.0),
            radius: if i.is_multiple_of(3) { 0.02 } else { 0.03 },
            normal: Vector3::z(),
        };
        (0..n).map(hole).collect()
    }

    fn holes(n: usize) -> Holes {
        let model = rows(n);
        Holes {
            data: rows(60),
            along: AlongAxis::of(&model),
            model,
            alike: Alike {
                edge: 0.01,
                diagonal: 1.0,
            },
        }
    }

    #[test]
    fn counterparts_are_those_among_all_holes() {
        let holes = holes(200);
        let near = holes.alike.near();
        let mut n_beside = 0;
        for i in 0..400 {
            let at = Vector3::new(0.0017 * f64::from(i), 0.0029 * f64::from(i), 0.004);
            let found = holes.along.within(&holes.model, &at, near);
            let is_near = |&i: &u32| (holes.model[i as usize].center - at).norm() <= near;
            let mut found: Vec<u32> = found.iter().copied().filter(is_near).collect();
            found.sort_unstable();
            let all: Vec<u32> = (0..200).filter(is_near).collect();
            n_beside += all.len();
            assert_eq!(found, all);
        }
        assert!(n_beside > 50, "{n_beside}");
        assert!(
            AlongAxis::of(&[])
                .within(&[], &Vector3::zeros(), near)
                .is_empty()
        );
    }

    #[test]
    fn the_search_for_first_poses_can_be_cancelled() {
        let monitor = Monitor::silent();
        let holes = holes(40);
        assert!(!holes.first_poses(&monitor).unwrap().is_empty());
        monitor.request_cancel();
        assert!(holes.first_poses(&monitor).is_err());
    }
}
