//! Poses from holes: two holes of the smaller part on two of the larger one that are as large and as far apart, or its
//! only hole on each that is as large. Where a part can slide along its counterpart, holes determine where it belongs.

use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::cloud::{Cloud, Motion32};
use super::rounds::First;
use super::seeds::{aligned, matrix};
use crate::geometry::{Matrix3, Point3, Rotation, Vector3, frame_about};
use crate::monitor::{Cancelled, Monitor};
use crate::registration::surface::Surface;
use crate::search::{FeatureGrid, PointTree};

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
struct GridHole {
    center: Vector3,
    /// Mean distance of its border from its middle.
    radius: f64,
    /// Unit normal of the sheet around it.
    normal: Vector3,
}

/// The holes of both parts.
pub(super) struct GridHoles {
    data: Vec<GridHole>,
    model: Vec<GridHole>,
    /// The middles of the holes of the model.
    centers: PointTree,
    alike: Alike,
}

impl GridHoles {
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
        let centers: Vec<Point3> = of_model.iter().map(|hole| hole.center.into()).collect();
        Self {
            data: of_data,
            centers: PointTree::build(centers),
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
        let most = AtomicUsize::new(0);
        let counted = found.par_chunks(CHUNK).map(|chunk| {
            monitor.check()?;
            let counts = chunk
                .iter()
                .map(|first| self.n_paired(&first.motion, &most));
            Ok(counts.collect())
        });
        let counted: Result<Vec<Vec<usize>>, Cancelled> = counted.collect();
        let counts = counted?.concat();
        let mut sorted = counts.clone();
        sorted.sort_unstable_by(|a, b| b.cmp(a));
        // Surfaces do not distinguish the places of a regular pattern: those that most holes support come alone.
        let of_these = sorted.get(LEAST_FIRST).or(sorted.last()).copied();
        let least = of_these
            .unwrap_or(0)
            .max(nearly(sorted.first().copied().unwrap_or(0)));
        let mut counts = counts.into_iter();
        found.retain(|_| counts.next().is_some_and(|n| n >= least));
        Ok(found)
    }

    /// A motion of the data shifted so that its holes lie on their counterparts in the mean, and how many have one.
    pub(super) fn aligned(&self, motion: &Motion32) -> (usize, Motion32) {
        let offs = self.data.iter().filter_map(|hole| self.off(hole, motion));
        let (n, sum) = offs.fold((0, Vector3::zeros()), |(n, sum), off| (n + 1, sum + off));
        (n, motion.shifted(&(sum / n.max(1) as f64)))
    }

    /// How many holes of the data have their counterpart under a motion; fewer are told where that is fewer than
    /// [`NEARLY_MOST`] of those that have it under another one. `most` is how many have it under any so far.
    fn n_paired(&self, motion: &Motion32, most: &AtomicUsize) -> usize {
        let least = nearly(most.load(Ordering::Relaxed));
        let mut n = 0;
        for (hole, n_left) in self.data.iter().zip((0..self.data.len()).rev()) {
            n += usize::from(self.off(hole, motion).is_some());
            if n + n_left < least {
                return n;
            }
        }
        most.fetch_max(n, Ordering::Relaxed);
        n
    }

    /// The way from a hole of the data to the nearest one of the model that is as large.
    fn off(&self, hole: &GridHole, motion: &Motion32) -> Option<Vector3> {
        let moved = motion.apply(&hole.center);
        let is_as_large = |i: u32| self.alike.are_as_large(hole, &self.model[i as usize]);
        let near = self.alike.near();
        let nearest = self
            .centers
            .nearest_of(is_as_large, &moved.into(), near, None)?;
        Some(self.model[nearest.index as usize].center - moved)
    }
}

/// The least number of holes that is nearly as many.
fn nearly(most: usize) -> usize {
    (NEARLY_MOST * most as f64).ceil() as usize
}

/// The largest holes of a part, with their middles moved by `to_local`.
fn holes(surface: &Surface, to_local: impl Fn(&Point3) -> Vector3) -> Vec<GridHole> {
    let mesh = surface.mesh();
    let found = surface.borders().iter().filter(|border| border.is_hole);
    let mut found: Vec<GridHole> = found
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
            Some(GridHole {
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

    fn are_as_large(&self, a: &GridHole, b: &GridHole) -> bool {
        let larger = a.radius.max(b.radius);
        (a.radius - b.radius).abs() <= SAME_RADIUS * larger + RADIUS_EDGES * self.edge
    }

    /// The only hole of the data on each hole of the model that is as large, turned about its normal.
    fn align_single(&self, only: &GridHole, of_model: &[GridHole], found: &mut Vec<First>) {
        for hole in of_model {
            if !self.are_as_large(only, hole) {
                continue;
            }
            for (turn, flipped) in (0..N_TURNS).flat_map(|k| [(k, false), (k, true)]) {
                let angle = TAU * turn as f64 / N_TURNS as f64;
                let turn = matrix(&Rotation::from_axis_angle(&Vector3::z_axis(), angle));
                let normal = if flipped { -only.normal } else { only.normal };
                let own = frame_about(&normal, &Vector3::x());
                let turn = frame_about(&hole.normal, &Vector3::x()) * turn * own.transpose();
                found.push(First {
                    flipped,
                    motion: aligned(&turn, &only.center, &hole.center),
                });
            }
        }
    }

    /// Every two holes of the data on every two of the model that stand to each other as they do.
    fn align_pairs(&self, of_data: &[GridHole], of_model: &[GridHole], found: &mut Vec<First>) {
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
    fn two(&self, holes: &[GridHole], [first, second]: [usize; 2]) -> Option<Two> {
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
            frame: frame_about(&along, &normal),
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
    holes: [GridHole; 2],
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
    fn rows(n: usize) -> Vec<GridHole> {
        let hole = |i: usize| GridHole {
            center: Vector3::new(0.1 * (i % 7) as f64, 0.05 * (i / 9) as f64, 0.0),
            radius: if i.is_multiple_of(3) { 0.02 } else { 0.03 },
            normal: Vector3::z(),
        };
        (0..n).map(hole).collect()
    }

    fn holes(n: usize) -> GridHoles {
        let model = rows(n);
        let centers: Vec<Point3> = model.iter().map(|hole| hole.center.into()).collect();
        GridHoles {
            data: rows(60),
            centers: PointTree::build(centers),
            model,
            alike: Alike {
                edge: 0.01,
                diagonal: 1.0,
            },
        }
    }

    fn shifted(by: f32) -> Motion32 {
        aligned(
            &Matrix3::identity(),
            &Vector3::zeros(),
            &Vector3::new(by.into(), (1.7 * by).into(), 0.004),
        )
    }

    #[test]
    fn a_counterpart_is_the_nearest_of_all_holes_that_are_as_large() {
        let holes = holes(200);
        let near = holes.alike.near();
        let mut n_beside = 0;
        for i in 0..400_u16 {
            let motion = shifted(0.0017 * f32::from(i));
            let own = &holes.data[usize::from(i) % 60];
            let at = motion.apply(&own.center);
            let alike = holes
                .model
                .iter()
                .filter(|hole| holes.alike.are_as_large(own, hole));
            let apart = alike.map(|hole| (hole.center - at).norm());
            let least = apart.min_by(f64::total_cmp).filter(|apart| *apart <= near);
            let found = holes.off(own, &motion).map(|off| off.norm());
            assert_eq!(found, least);
            n_beside += usize::from(found.is_some());
        }
        assert!(n_beside > 50, "{n_beside}");
    }

    #[test]
    fn holes_are_counted_as_far_as_it_matters() {
        let holes = holes(200);
        let motions: Vec<Motion32> = (0..200_u16)
            .map(|i| shifted(0.002 * f32::from(i)))
            .collect();
        let all = motions.iter().map(|motion| holes.aligned(motion).0);
        let all: Vec<usize> = all.collect();
        let most = AtomicUsize::new(0);
        let told = motions.iter().map(|motion| holes.n_paired(motion, &most));
        let told: Vec<usize> = told.collect();
        let least = nearly(*all.iter().max().unwrap());
        assert!(all.iter().any(|n| *n < least) && all.iter().any(|n| *n >= least));
        for (told, all) in told.into_iter().zip(all) {
            assert!(told == all || told < all && all < least, "{told} {all}");
        }
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
