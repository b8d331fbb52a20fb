//! The closed borders of one part as curves, with places along them, and the size of its holes.

use crate::geometry::{Border, Circle, Matrix3, Point3, Similarity, Vector3};
use crate::registration::Surface;

/// Edges to each side that give a ragged border its direction, as far as they are an eighth of it.
const SMOOTHED: usize = 2;
/// A border is ragged if most of its edges turn from the one before by so much more than around a circle: noise of
/// a tenth of their length, which hides their direction. In degrees.
const RAGGED_TURN: f64 = 10.0;

/// A closed border in its part's own frame.
#[derive(Debug, Clone)]
pub(super) struct BorderCurve {
    points: Vec<Point3>,
    normals: Vec<Vector3>,
    /// See [`Border::center`].
    pub(super) center: Point3,
    pub(super) circle: Option<Circle>,
    pub(super) length: f64,
    pub(super) is_hole: bool,
}

/// A place along a border.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) point: Point3,
    pub(crate) tangent: Vector3,
    /// Of the sheet.
    pub(crate) normal: Vector3,
    pub(super) is_hole: bool,
}

/// About `n` places in the target's frame along those borders of a part that are wanted: of holes or of
/// trims.
pub(crate) fn places(
    (surface, target_from_surface): (&Surface, &Similarity),
    n: usize,
    is_wanted: impl Fn(bool) -> bool,
) -> Vec<Place> {
    let mut borders = curves_of(surface);
    borders.retain(|border| is_wanted(border.is_hole));
    let length: f64 = borders.iter().map(|border| border.length).sum();
    if length <= 0.0 {
        return Vec::new();
    }
    let found = along(&borders, length / n as f64).into_iter();
    found
        .map(|place| place.moved(target_from_surface))
        .collect()
}

impl Place {
    pub(crate) fn moved(self, pose: &Similarity) -> Self {
        // A mirror turns the sense in which a border is walked along.
        let sense = if pose.is_mirrored() { -1.0 } else { 1.0 };
        Self {
            point: pose.apply(&self.point),
            tangent: pose.rotate(&self.tangent) * sense,
            normal: pose.rotate(&self.normal),
            ..self
        }
    }
}

impl BorderCurve {
    /// Mean distance from its middle. Noise makes a border longer, and hardly changes this.
    pub(super) fn radius(&self) -> f64 {
        let n = self.points.len();
        let (mut sum, mut length) = (0.0, 0.0);
        for (i, a) in self.points.iter().enumerate() {
            let b = &self.points[(i + 1) % n];
            // Simpson's rule on both halves.
            let arms = [1.0, 4.0, 2.0, 4.0, 1.0].iter().enumerate();
            let arms = arms.map(|(k, weight)| {
                let at = a + (b - a) * (0.25 * k as f64);
                weight / 12.0 * (at - self.center).norm()
            });
            let edge = (b - a).norm();
            sum += edge * arms.sum::<f64>();
            length += edge;
        }
        if length > 0.0 { sum / length } else { 0.0 }
    }

    /// Mean of r rᵀ, r from its middle to a place of it: how far it reaches in which direction.
    pub(super) fn moment(&self) -> Matrix3 {
        let n = self.points.len();
        let (mut sum, mut length) = (Matrix3::zeros(), 0.0);
        for (i, a) in self.points.iter().enumerate() {
            let (arm, way) = (a - self.center, self.points[(i + 1) % n] - a);
            let mixed = arm * way.transpose();
            let along = arm * arm.transpose()
                + (mixed + mixed.transpose()) / 2.0
                + way * way.transpose() / 3.0;
            sum += along * way.norm();
            length += way.norm();
        }
        if length > 0.0 { sum / length } else { sum }
    }

    /// Normal of the sheet around it, not of unit length.
    pub(super) fn normal(&self) -> Vector3 {
        self.normals.iter().sum()
    }

    /// Edges to each side that an edge's direction is taken from.
    fn smoothed(&self) -> usize {
        let n = self.points.len();
        let edge = |i: usize| self.points[(i + 1) % n] - self.points[i % n];
        let mut turns: Vec<f64> = (0..n).map(|i| edge(i).angle(&edge(i + 1))).collect();
        let median = *turns.select_nth_unstable_by(n / 2, f64::total_cmp).1;
        let is_ragged = median.to_degrees() > 360.0 / n as f64 + RAGGED_TURN;
        if is_ragged { SMOOTHED.min(n / 8) } else { 0 }
    }

    /// Unit direction of an edge and the sheet's normal there, over `reach` edges more to each side.
    fn directions(&self, edge: usize, reach: usize) -> (Vector3, Vector3) {
        let n = self.points.len();
        let [first, last] = [edge + n - reach, edge + n + reach + 1];
        let tangent = self.points[last % n] - self.points[first % n];
        let normal = if reach == 0 {
            self.normals[edge]
        } else {
            let around = (first..=last).map(|i| self.normals[i % n]);
            around
                .sum::<Vector3>()
                .try_normalize(0.0)
                .unwrap_or(self.normals[edge])
        };
        (tangent.try_normalize(0.0).unwrap_or_default(), normal)
    }
}

pub(super) fn along(borders: &[BorderCurve], spacing: f64) -> Vec<Place> {
    let mut places = Vec::new();
    let mut until_next = 0.5 * spacing;
    for border in borders {
        let n = border.points.len();
        let reach = border.smoothed();
        for i in 0..n {
            let (a, b) = (border.points[i], border.points[(i + 1) % n]);
            let length = (b - a).norm();
            let (tangent, normal) = border.directions(i, reach);
            let mut at = until_next;
            while at < length {
                let t = at / length;
                places.push(Place {
                    point: a + (b - a) * t,
                    tangent,
                    normal,
                    is_hole: border.is_hole,
                });
                at += spacing;
            }
            until_next = at - length;
        }
    }
    places
}

/// The closed borders. A chain that ends where two sheets touch is none that the parts must share.
pub(super) fn curves_of(surface: &Surface) -> Vec<BorderCurve> {
    let closed = surface.borders().iter();
    let closed = closed.filter(|border| border.closed && border.vertices.len() > 2);
    let border = |border: &Border| {
        let vertices = border.vertices.iter().map(|&v| v as usize);
        BorderCurve {
            points: vertices
                .clone()
                .map(|v| surface.mesh().positions()[v])
                .collect(),
            normals: vertices.map(|v| surface.vertex_normals()[v]).collect(),
            center: border.center,
            circle: border.circle,
            length: border.length,
            is_hole: border.is_hole,
        }
    };
    closed.map(border).collect()
}

/// Median distance, within the sheet, of an outline's node from the middle between its neighbours; next to nothing
/// along straight and smoothly curved outlines, whatever folds and corners they have. Holes count only where there is
/// no outline: a small one of a few nodes steps aside though it is cut clean.
pub(super) fn ragged(borders: &[BorderCurve], unit: f64) -> f64 {
    let mut steps = Vec::new();
    let has_outline = borders.iter().any(|border| !border.is_hole);
    for border in borders
        .iter()
        .filter(|border| !(has_outline && border.is_hole))
    {
        let count = border.points.len();
        for (i, p) in border.points.iter().enumerate() {
            let [before, after] = [(i + count - 1) % count, (i + 1) % count];
            let middle = nalgebra::center(&border.points[before], &border.points[after]);
            let aside = p - middle;
            // Out of the sheet a corrugated one waves, and a noisy one steps.
            let normal = border.normals[i];
            steps.push(unit * (aside - normal * aside.dot(&normal)).norm());
        }
    }
    steps.sort_unstable_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hole in a plane, its nodes so far from the middle.
    fn hole(points: Vec<Point3>) -> BorderCurve {
        BorderCurve {
            normals: vec![Vector3::z(); points.len()],
            points,
            center: Point3::origin(),
            circle: None,
            length: 0.0,
            is_hole: true,
        }
    }

    #[test]
    fn the_radius_is_the_same_however_a_hole_is_meshed() {
        let square = |n: usize| {
            let corner = |k: usize| {
                let angle = (k as f64 + 0.5) * std::f64::consts::FRAC_PI_2;
                Point3::new(angle.cos(), angle.sin(), 0.0)
            };
            let side = |k: usize| {
                let (a, b) = (corner(k), corner(k + 1));
                (0..n).map(move |i| a + (b - a) * (i as f64 / n as f64))
            };
            hole((0..4).flat_map(side).collect()).radius()
        };
        assert!((square(1) / square(12) - 1.0).abs() < 2e-3);
        let circle = |noise: f64| {
            let node = |k: u32| {
                let angle = f64::from(k) / 60.0 * std::f64::consts::TAU;
                let up = if k.is_multiple_of(2) { noise } else { -noise };
                Point3::new(10.0 * angle.cos(), 10.0 * angle.sin(), up)
            };
            hole((0..60).map(node).collect())
        };
        assert!((circle(0.4).radius() / circle(0.0).radius() - 1.0).abs() < 1e-3);
        assert_eq!(
            [circle(0.0).smoothed(), circle(0.4).smoothed()],
            [0, SMOOTHED]
        );
        let (direction, normal) = circle(0.4).directions(0, SMOOTHED);
        assert!(direction.y > 0.98 && normal == Vector3::z());
    }

    #[test]
    fn waves_out_of_the_sheet_make_no_outline_ragged() {
        let outline = |aside: fn(f64) -> Vector3| {
            let way = |k: u32| if k.is_multiple_of(2) { 3.0 } else { -3.0 };
            let node = |k: u32| Point3::new(5.0 * f64::from(k), 0.0, 0.0) + aside(way(k));
            let points = (0..40).map(node).collect();
            let curve = hole(points);
            ragged(
                &[BorderCurve {
                    is_hole: false,
                    ..curve
                }],
                1.0,
            )
        };
        let waved = outline(|way| Vector3::new(0.0, 0.0, way));
        assert!(waved < 1e-9, "{waved}");
        let stepped = outline(|way| Vector3::new(0.0, way, 0.0));
        assert!((stepped - 6.0).abs() < 1e-9, "{stepped}");
    }
}
