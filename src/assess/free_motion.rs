//! Motions that slide the surfaces on each other.

use nalgebra::{Const, SMatrix, SymmetricEigen};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::contact::{ContactSearch, Contacts, FEW_NODES};
use super::small_motion::{self, Six, turn_and_shift};
use crate::geometry::serial::{any_float, xyz};
use crate::geometry::{Matrix3, Point3, Rotation, Similarity, Vector3, z_order};
use crate::registration::Surface;
use crate::search::ClosestPoint;

/// A motion is free if it meets less than this fraction of the resistance of the stiffest motion.
/// Shapes that are exactly flat, cylindrical or extruded measure below 1e-5 on real meshes, an
/// extrusion with one shallow bead above 1e-3.
const FREE_BELOW: f64 = 1e-4;
/// Facets that cut across a fold are tilted at random, and resist a slide along the fold that nothing holds. What
/// resists one is tilted alike at places beside each other: each is compared with so many others.
const N_BESIDE: usize = 3;
/// Only facets resist a motion where such places agree on less than this share of the resistance.
const BY_FACETS: f64 = 0.5;
/// The weakest motion is free then, and so is any that meets up to so many times its resistance.
const FACETS_MORE: f64 = 1.2;
/// A motion is weak if it meets less than this fraction.
const WEAK_BELOW: f64 = 3e-3;

/// The weakest motion slides a slightly wound or arched profile along itself below this fraction.
const WEAKEST_BELOW: f64 = 5e-2;

/// Nodes that are looked at; more do not change the eigenvalues by a percent.
const MAX_NODES: usize = 3000;

/// A motion with less of a turn is a shift (square of the turn's share).
const SHIFT: f64 = 1e-12;
/// A smooth panel resists a small motion as little as a faceted surface of revolution does. Over distances beyond
/// its elements it comes apart the more the farther it is moved, a surface that slides on itself does not: the part
/// is moved by these shares of the mean distance from its centroid.
const MOVED_BY: [f64; 2] = [0.05, 0.1];
/// Distances up to this share of it are rounding.
const NOTHING: f64 = 1e-6;
/// Of a panel that comes apart the surfaces lie so many times as far apart as before, and as facets explain, …
const APART: f64 = 2.0;
/// … and so many times as far as under half the motion.
const FARTHER: f64 = 1.5;

/// What kind of surface slides on itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FreeMotionKind {
    /// Two shifts in the plane and the turn about its normal.
    Flat,
    /// The shift along an axis and the turn about it.
    Cylindrical,
    /// The shift along an axis.
    Extruded,
    /// The turn about an axis (a surface of revolution, or a screw).
    Revolved,
    /// All turns about a centre.
    Spherical,
    /// Some other combination.
    Other,
}

impl FreeMotionKind {
    /// Whether poses along such a motion can be searched one after the other.
    pub(crate) fn is_searched(self) -> bool {
        !matches!(self, Self::Spherical | Self::Other)
    }
}

/// A family of motions that the surfaces do not resist.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FreeMotion {
    /// Translation, rotation or both.
    pub kind: FreeMotionKind,
    /// Unit direction of the axis or of the plane's normal, in the target's frame.
    #[serde(with = "xyz")]
    pub direction: Vector3,
    /// A point of the axis, in the target's frame.
    #[serde(with = "xyz")]
    pub point: Point3,
}

impl FreeMotion {
    /// The same in another frame.
    pub(crate) fn moved(&self, other_from_target: &Similarity) -> Self {
        Self {
            kind: self.kind,
            direction: other_from_target.rotate(&self.direction),
            point: other_from_target.apply(&self.point),
        }
    }

    /// Unit direction in which the motion takes a point of the target's frame; `None` where it may take it in several,
    /// or leaves it where it is.
    pub(super) fn way_at(&self, point: &Point3) -> Option<Vector3> {
        match self.kind {
            FreeMotionKind::Extruded => Some(self.direction),
            FreeMotionKind::Revolved => {
                let way = self.direction.cross(&(point - self.point));
                way.try_normalize(0.0)
            }
            _ => None,
        }
    }
}

/// How firmly the overlap holds the pose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Freedom {
    /// The motions that are free.
    pub motion: Option<FreeMotion>,
    /// How many of the six motions are free.
    pub n_free: usize,
    /// Resistance of the weakest motion relative to the stiffest (λ6/λ1 of Gelfand et al. 2003,
    /// lengths scaled to a mean distance of 1 from the centroid).
    #[serde(with = "any_float")]
    pub weakest: f64,
}

/// Finds the motions that slide the overlap on itself (Gelfand et al. 2003): the small eigenvalues
/// of Σ a aᵀ with a = ((x − c) × n, n) over source nodes within `limit` of the target. Where facets resist the weakest
/// motion at random, what places beside each other agree on counts. There are none where the surfaces come apart when
/// the part is moved along the weakest.
pub fn free_motions(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
) -> Freedom {
    let pair = [source, target];
    let Some(resistance) = Resistance::of(source, target, target_from_source, limit) else {
        return Freedom::ALL;
    };
    let is_by_facets = resistance.is_by_facets();
    let below = if is_by_facets {
        FREE_BELOW.max(FACETS_MORE * resistance.weakest_share())
    } else {
        FREE_BELOW
    };
    let found = resistance.below(below);
    let is_apart = || resistance.comes_apart(pair, target_from_source, limit, is_by_facets);
    if found.motion.is_some() && is_apart() {
        return Freedom {
            motion: None,
            n_free: 0,
            ..found
        };
    }
    found
}

/// How far surfaces lie apart, without a constant distance of the sheets.
fn off(contacts: &Contacts) -> f64 {
    let gaps: Vec<f64> = contacts.list.iter().map(|contact| contact.gap).collect();
    let middle = median(gaps.clone());
    median(gaps.iter().map(|gap| (gap - middle).abs()).collect())
}

/// 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The motion that the overlap resists so little that noise, springback or facets may hide where it ends.
pub(crate) fn weak_motion(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
) -> Option<FreeMotion> {
    let resistance = Resistance::of(source, target, target_from_source, limit)?;
    resistance.below(WEAK_BELOW).motion
}

/// The one motion that the overlap resists least, as a shift or a turn, where that is no more than a profile resists
/// that is slid along itself.
pub(crate) fn weakest_motion(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
) -> Option<FreeMotion> {
    let resistance = Resistance::of(source, target, target_from_source, limit)?;
    let eigenvalues = &resistance.eigen.eigenvalues;
    if eigenvalues.min() > WEAKEST_BELOW * eigenvalues.max() {
        return None;
    }
    let (omega, shift, on_axis) = resistance.weakest();
    let is_shift = shift.norm() > omega.norm();
    let direction = if is_shift { shift } else { omega };
    Some(FreeMotion {
        kind: if is_shift {
            FreeMotionKind::Extruded
        } else {
            FreeMotionKind::Revolved
        },
        direction: direction.try_normalize(0.0)?,
        point: if is_shift { resistance.center } else { on_axis },
    })
}

impl Freedom {
    /// The surfaces do not meet: nothing resists.
    const ALL: Self = Self {
        motion: None,
        n_free: 6,
        weakest: 0.0,
    };

    /// Whether the overlap resists every motion.
    pub(super) fn is_none(&self) -> bool {
        self.n_free == 0
    }
}

/// What the overlap resists: Σ a aᵀ and Σ n nᵀ over its points.
struct Resistance {
    held: Vec<Held>,
    eigen: SymmetricEigen<f64, Const<6>>,
    normals: Matrix3,
    /// Centroid of the points and their mean distance from it.
    center: Point3,
    radius: f64,
}

impl Resistance {
    /// `None` without an overlap that resists anything.
    fn of(
        source: &Surface,
        target: &Surface,
        target_from_source: &Similarity,
        limit: f64,
    ) -> Option<Self> {
        let held = held_points(source, target, target_from_source, limit);
        let total: f64 = held.iter().map(|(_, _, weight)| weight).sum();
        let origin = held.first().filter(|_| total > 0.0)?.0;
        let sum: Vector3 = held.iter().map(|(p, _, w)| (p - origin) * *w).sum();
        let center = origin + sum / total;
        let radius = held
            .iter()
            .map(|(p, _, w)| (p - center).norm() * w)
            .sum::<f64>()
            / total;
        if radius <= 0.0 {
            return None;
        }
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut normals = Matrix3::zeros();
        for (point, normal, weight) in &held {
            let row = small_motion::row(&((point - center) / radius), normal);
            matrix += row * row.transpose() * *weight;
            normals += normal * normal.transpose() * *weight;
        }
        let eigen = SymmetricEigen::new(matrix);
        (eigen.eigenvalues.max() > 0.0).then_some(Self {
            held,
            eigen,
            normals,
            center,
            radius,
        })
    }

    /// Resistance of the weakest motion relative to the stiffest.
    fn weakest_share(&self) -> f64 {
        let eigenvalues = &self.eigen.eigenvalues;
        (eigenvalues.min() / eigenvalues.max()).max(0.0)
    }

    /// The motions that meet less than this fraction of the resistance of the stiffest one.
    fn below(&self, below: f64) -> Freedom {
        let eigen = &self.eigen;
        let below = below * eigen.eigenvalues.max();
        let free: Vec<Six> = (0..6)
            .filter(|&k| eigen.eigenvalues[k] < below)
            .map(|k| eigen.eigenvectors.column(k).into())
            .collect();
        Freedom {
            motion: classify(&free, &self.normals, below, self.center, self.radius),
            n_free: free.len(),
            weakest: self.weakest_share(),
        }
    }

    /// Whether only facets resist the weakest motion: places beside each other do not agree on what does.
    fn is_by_facets(&self) -> bool {
        let weakest = self.weakest_share();
        let most = FREE_BELOW.min(BY_FACETS * weakest);
        weakest < WEAKEST_BELOW && self.agreed() < most * self.eigen.eigenvalues.max()
    }

    /// Whether the surfaces come apart, to both sides, when the source is moved along the motion that they resist
    /// least; by more than the facets lie apart where only these resist it.
    fn comes_apart(
        &self,
        pair: [&Surface; 2],
        pose: &Similarity,
        limit: f64,
        is_by_facets: bool,
    ) -> bool {
        let mut search = ContactSearch::new(pair, pose.scale, limit, FEW_NODES);
        let mut under = |by: f64| {
            let moved = self.along_weakest(by * self.radius);
            search.at(&moved.after(pose))
        };
        let Some(now) = under(0.0) else {
            return false;
        };
        let facets = if is_by_facets {
            now.typical_gap(0.0)
        } else {
            median(now.list.iter().map(|contact| contact.facet).collect())
        };
        let nothing = off(&now).max(facets).max(NOTHING * self.radius);
        [1.0, -1.0].into_iter().all(|side| {
            let [near, far] = MOVED_BY.map(|by| under(side * by).as_ref().map_or(0.0, off));
            far >= APART * nothing && far >= FARTHER * near
        })
    }

    /// What of the resistance to the weakest motion places beside each other agree on: instead of the squares of what
    /// each meets the products with what the next ones along a curve through all places meet. O(n log n).
    fn agreed(&self) -> f64 {
        let weakest = self
            .eigen
            .eigenvectors
            .column(self.eigen.eigenvalues.imin());
        let points: Vec<Point3> = self.held.iter().map(|(point, ..)| *point).collect();
        let order = z_order(&points);
        let meets = |place: u32| {
            let (point, normal, weight) = &self.held[place as usize];
            let row = small_motion::row(&((point - self.center) / self.radius), normal);
            (row.dot(&weakest), *weight)
        };
        let met: Vec<(f64, f64)> = order.into_iter().map(meets).collect();
        let beside = (1..=N_BESIDE).flat_map(|lag| met.iter().zip(met.iter().skip(lag)));
        let (sum, weights) = beside.fold((0.0, 0.0), |(sum, weights), (a, b)| {
            let weight = (a.1 * b.1).sqrt();
            (sum + a.0 * b.0 * weight, weights + weight)
        });
        if weights > 0.0 {
            let total: f64 = met.iter().map(|(_, weight)| weight).sum();
            sum / weights * total
        } else {
            f64::INFINITY
        }
    }

    /// The motion that meets the least resistance: its turn, lengths scaled by the radius, its shift at the centroid,
    /// and a point of its axis.
    fn weakest(&self) -> (Vector3, Vector3, Point3) {
        let weakest = self.eigen.eigenvalues.imin();
        let motion = self.eigen.eigenvectors.column(weakest).into();
        let [omega, shift] = turn_and_shift(&motion);
        let arm = omega.cross(&shift) * self.radius / omega.norm_squared().max(1e-300);
        (omega, shift, self.center + arm)
    }

    /// The same as a screw that moves points by about `amount`.
    fn along_weakest(&self, amount: f64) -> Similarity {
        let (omega, shift, on_axis) = self.weakest();
        let turned = omega.norm_squared();
        if turned < SHIFT {
            return Similarity::from_translation(shift * amount);
        }
        let turn = Rotation::from_scaled_axis(omega * amount / self.radius);
        let turn = Similarity::about(&on_axis, *turn.to_rotation_matrix().matrix());
        let along = omega * omega.dot(&shift) / turned;
        Similarity::from_translation(along * amount).after(&turn)
    }
}

/// A point of the overlap in the target's frame, with the target's normal and the area it stands for.
type Held = (Point3, Vector3, f64);

/// Points of the overlap.
fn held_points(
    source: &Surface,
    target: &Surface,
    target_from_source: &Similarity,
    limit: f64,
) -> Vec<Held> {
    (source.even_nodes(MAX_NODES).par_iter())
        .filter_map(|node| {
            let vertex = node.vertex as usize;
            let moved = target_from_source.apply(&source.mesh().positions()[vertex]);
            let hit = target.bvh().closest(&moved, limit, None, None)?;
            Some((hit.point, target.normal_at(&hit), node.area))
        })
        .filter(|(_, _, weight)| *weight > 0.0)
        .collect()
}

fn classify(
    free: &[Six],
    normals: &Matrix3,
    free_below: f64,
    center: Point3,
    radius: f64,
) -> Option<FreeMotion> {
    if free.is_empty() {
        return None;
    }
    // Shifts are free along directions that no normal has a part in.
    let eigen = SymmetricEigen::new(*normals);
    let is_free = |k: usize| eigen.eigenvalues[k] < free_below;
    let n_shifts = (0..3).filter(|&k| is_free(k)).count();
    let along: Vector3 = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    let across: Vector3 = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into();
    let turn = free
        .iter()
        .map(|motion| {
            let [omega, shift] = turn_and_shift(motion);
            (omega, shift * radius)
        })
        .max_by(|a, b| a.0.norm().total_cmp(&b.0.norm()))?;
    let (omega, tau) = turn;
    let turn_axis = omega.try_normalize(1e-9).unwrap_or(along);
    let on_axis = center + omega.cross(&tau) / omega.norm_squared().max(1e-300);
    let (kind, direction, point) = match (free.len(), n_shifts) {
        (3, 2) => (FreeMotionKind::Flat, across, center),
        (2, 1) => (FreeMotionKind::Cylindrical, along, on_axis),
        (1, 1) => (FreeMotionKind::Extruded, along, center),
        (1, 0) => (FreeMotionKind::Revolved, turn_axis, on_axis),
        (3, 0) => (FreeMotionKind::Spherical, turn_axis, on_axis),
        _ => (FreeMotionKind::Other, turn_axis, on_axis),
    };
    // The sign of an axis is arbitrary; the largest component is made positive.
    let sign = direction[direction.iamax()].signum();
    Some(FreeMotion {
        kind,
        direction: direction * sign,
        point,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriMesh;

    /// A Z profile of 1,000 mm along x that is arched and winds a little.
    fn profile() -> Surface {
        let (n_x, n_s) = (100_u32, 20_u32);
        let at = |i: u32, j: u32| {
            let x = 1000.0 * (f64::from(i) / f64::from(n_x) - 0.5);
            let s = 100.0 * (f64::from(j) / f64::from(n_s) - 0.5);
            let z = 18.0 * (s / 9.0).tanh();
            let (sin, cos) = (5.5e-4 * x).sin_cos();
            let along = x / 500.0;
            Point3::new(
                x,
                s * cos - z * sin + 30.0 * along * along,
                s * sin + z * cos + 20.0 * along.powi(3),
            )
        };
        let nodes = (0..=n_s).flat_map(|j| (0..=n_x).map(move |i| at(i, j)));
        let cells = (0..n_s).flat_map(|j| (0..n_x).map(move |i| j * (n_x + 1) + i));
        let triangles =
            cells.flat_map(|a| [[a, a + 1, a + n_x + 2], [a, a + n_x + 2, a + n_x + 1]]);
        let mesh = TriMesh::new(nodes.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn a_wound_profile_is_searched_along_itself() {
        let still = Similarity::identity();
        let wound = profile();
        let motion = weakest_motion(&wound, &wound, &still, 1.0).unwrap();
        assert_eq!(motion.kind, FreeMotionKind::Extruded);
        assert!(motion.direction.x.abs() > 0.98, "{motion:?}");
    }
}
