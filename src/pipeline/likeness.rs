//! How alike two parts are before anything is matched: by area, spread and thickness.
//!
//! A crash model has thousands of parts. Comparing three or four numbers of each names the few that
//! a stamped part can belong to; the match then decides.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::Model;
use crate::geometry::chunks::for_chunks;
use crate::geometry::{Matrix3, Point3, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Area and its first and second moments. Sums over several parts are the moments of all together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    area: f64,
    /// Integral of the position, about the first node of the model.
    first: Vector3,
    /// Integral of the position times its transpose.
    second: Matrix3,
}

impl Default for Moments {
    fn default() -> Self {
        Self {
            area: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
        }
    }
}

impl Moments {
    /// Adds a triangle, exactly: its mass stands at the middles of its edges.
    fn add_triangle(&mut self, corners: [Point3; 3]) {
        let [a, b, c] = corners.map(|corner| corner.coords);
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        if !area.is_finite() {
            return;
        }
        self.area += area;
        for middle in [(a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0] {
            self.first += middle * (area / 3.0);
            self.second += middle * middle.transpose() * (area / 3.0);
        }
    }

    /// The moments of both parts together.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            area: self.area + other.area,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    /// Area and edges, which no motion changes; `None` without area.
    pub fn signature(&self, thickness: Option<f64>) -> Option<Signature> {
        if self.area.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let mean = self.first / self.area;
        let covariance = self.second / self.area - mean * mean.transpose();
        let mut spread = covariance.symmetric_eigenvalues();
        spread.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
        // A bar of length a spreads by a²/12.
        let edges = spread.map(|s| (12.0 * s.max(0.0)).sqrt());
        Some(Signature {
            area: self.area,
            edges: [edges[0], edges[1], edges[2]],
            thickness,
        })
    }
}

/// The moments of every part of a model with shells, by its id. O(shells).
///
/// `factor` is what the coordinates are multiplied by.
pub fn moments_of_parts(
    model: &Model,
    factor: f64,
    monitor: &Monitor,
) -> Result<BTreeMap<u64, Moments>, Cancelled> {
    let mut moments = vec![Moments::default(); model.parts.len()];
    let positions = model.nodes.positions();
    // About a node of the model, so that far coordinates take no digits from small parts.
    let origin = positions.first().copied().unwrap_or_default();
    for_chunks(model.shells.len(), monitor, |range| {
        for shell in &model.shells[range] {
            let Some(sum) = moments.get_mut(shell.part as usize) else {
                continue;
            };
            let at = |n: u32| Point3::from((positions[n as usize] - origin) * factor);
            let [a, b, c, d] = shell.nodes.map(at);
            sum.add_triangle([a, b, c]);
            if !shell.is_triangle() {
                sum.add_triangle([a, c, d]);
            }
        }
    })?;
    let with_area = model
        .parts
        .iter()
        .zip(moments)
        .filter(|(_, m)| m.area > 0.0);
    Ok(with_area.map(|(part, m)| (part.id, m)).collect())
}

/// Less alike parts are not taken for each other.
const ALIKE: f64 = 0.5;
/// Parts about as alike as the most alike one may be meant as well: copies of it, and the other side of the car.
pub(super) const AS_ALIKE: f64 = 0.97;

/// The signatures of `joined` parts, each group taken as one part whose thickness is the mean over the area.
pub fn joined_signatures(
    joined: &BTreeSet<Vec<u64>>,
    moments: &BTreeMap<u64, Moments>,
    thickness: impl Fn(u64) -> Option<f64>,
) -> Vec<(Vec<u64>, Signature)> {
    let signature = |ids: &Vec<u64>| {
        let (mut all, mut sum, mut area) = (Moments::default(), 0.0, 0.0);
        for id in ids {
            let own = moments.get(id)?;
            all = all.and(own);
            if let Some(thickness) = thickness(*id) {
                sum += thickness * own.area;
                area += own.area;
            }
        }
        let mean = (area > 0.0).then(|| sum / area);
        Some((ids.clone(), all.signature(mean)?))
    };
    joined.iter().filter_map(signature).collect()
}

/// Of the likenesses of several choices of parts to another part, the most alike choice and those that are about as
/// alike, in their order, if each is more like it than all parts `together` are.
pub fn more_alike<C: Ord>(of_choices: impl IntoIterator<Item = (C, f64)>, together: f64) -> Vec<C> {
    let least = ALIKE.max(together);
    let of_choices = of_choices.into_iter();
    let mut found: Vec<(C, f64)> = of_choices.filter(|(_, own)| *own > least).collect();
    let best = found.iter().fold(0.0, |best, (_, own)| own.max(best));
    found.retain(|(_, own)| *own >= AS_ALIKE * best);
    let mut choices: Vec<C> = found.into_iter().map(|(choice, _)| choice).collect();
    choices.sort_unstable();
    choices
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signature {
    /// Area, in squares of the crash model's unit.
    pub area: f64,
    /// Edges of the box of equal spread, longest first.
    pub edges: [f64; 3],
    /// Mean thickness, if known.
    pub thickness: Option<f64>,
}

/// Shares of the whole in the comparison. The thin direction says little: springback and flanges
/// change it most.
const AREA: f64 = 1.0;
const EDGES: [f64; 3] = [1.0, 1.0, 0.3];
const THICKNESS: f64 = 0.5;

impl Signature {
    /// That of the same part with its lengths multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            area: self.area * factor * factor,
            edges: self.edges.map(|edge| edge * factor),
            thickness: self.thickness.map(|thickness| thickness * factor),
        }
    }

    /// 1 for equal parts, towards 0 the more they differ; the order of the two does not matter.
    pub fn likeness(&self, other: &Self) -> f64 {
        // Below this share of the longest edge a part is flat, whatever the figures say.
        let least = 0.02 * self.edges[0].max(other.edges[0]);
        let off = |a: f64, b: f64| {
            (a.max(f64::MIN_POSITIVE) / b.max(f64::MIN_POSITIVE))
                .ln()
                .abs()
        };
        let mut sum = AREA * off(self.area, other.area);
        let mut weight = AREA;
        for ((a, b), share) in self.edges.iter().zip(other.edges).zip(EDGES) {
            sum += share * off(a.max(least), b.max(least));
            weight += share;
        }
        if let (Some(a), Some(b)) = (self.thickness, other.thickness) {
            sum += THICKNESS * off(a, b);
            weight += THICKNESS;
        }
        (-2.0 * sum / weight).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Rotation, TriMesh};

    fn plate(length: f64, width: f64) -> Model {
        let corner = |x, y| Point3::new(x, y, 0.0);
        let corners = vec![
            corner(0.0, 0.0),
            corner(length, 0.0),
            corner(length, width),
            corner(0.0, width),
        ];
        let mesh = TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        Model::from_mesh(&mesh, "plate")
    }

    fn signature(model: &Model, factor: f64) -> Signature {
        let moments = moments_of_parts(model, factor, &Monitor::silent()).unwrap();
        let all = moments
            .values()
            .fold(Moments::default(), |sum, m| sum.and(m));
        all.signature(None).unwrap()
    }

    #[test]
    fn a_plate_has_its_own_edges() {
        let found = signature(&plate(300.0, 100.0), 1.0);
        assert!((found.area - 30_000.0).abs() < 1e-6);
        assert!((found.edges[0] - 300.0).abs() < 1e-6, "{found:?}");
        assert!((found.edges[1] - 100.0).abs() < 1e-6);
        assert!(found.edges[2] < 1e-3);
    }

    #[test]
    fn motion_and_unit_do_not_matter() {
        let mut moved = plate(0.3, 0.1);
        let turn = Rotation::from_euler_angles(0.4, -1.1, 2.0);
        for point in moved.nodes.positions_mut() {
            *point = turn * *point + Vector3::new(5.0, -3.0, 1.0);
        }
        let (a, b) = (
            signature(&plate(300.0, 100.0), 1.0),
            signature(&moved, 1000.0),
        );
        assert!(a.likeness(&b) > 0.999_999, "{a:?} {b:?}");
    }

    #[test]
    fn parts_that_are_as_alike_are_named_together() {
        let of = |likenesses: &[(u64, f64)], together| more_alike(likenesses.to_vec(), together);
        let all = [(42, 0.999), (41, 1.0), (26, 0.6), (40, 0.999)];
        assert_eq!(of(&all, 0.4), [40, 41, 42]);
        assert_eq!(of(&all[2..3], 0.4), [26]);
        assert!(of(&all[2..3], 0.7).is_empty());
        assert!(of(&[(26, 0.4)], 0.0).is_empty(), "it is hardly alike");
    }

    #[test]
    fn the_more_they_differ_the_less_alike() {
        let given = signature(&plate(300.0, 100.0), 1.0);
        let likeness = |length, width| given.likeness(&signature(&plate(length, width), 1.0));
        let trimmed = likeness(290.0, 95.0);
        let other = likeness(300.0, 50.0);
        let tiny = likeness(30.0, 10.0);
        assert!(trimmed > 0.85 && trimmed < 1.0, "{trimmed}");
        assert!(trimmed > other && other > tiny, "{trimmed} {other} {tiny}");
        let thick = Signature {
            thickness: Some(1.2),
            ..given
        };
        let thin = Signature {
            thickness: Some(0.8),
            ..given
        };
        assert!(thick.likeness(&thick) > thick.likeness(&thin));
        assert_eq!(thick.likeness(&thin), thin.likeness(&thick));
    }
}
