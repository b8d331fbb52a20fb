//! Points of a target element: Gauss points of quads, symmetric rules on triangles.

use super::rule::{LayerRule, RuleKind};
use crate::geometry::{Point3, Vector3};

/// A point of an element with the area it stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementPoint {
    pub position: Point3,
    pub area: f64,
    /// Quadrant of a quad in the order of its corners; 0 in a triangle.
    pub quadrant: u8,
}

/// Points of the unit square or triangle with weights, made once for every order.
pub(super) struct PointRules {
    quads: Vec<Vec<([f64; 2], f64)>>,
    triangles: [Vec<([f64; 3], f64)>; 3],
}

/// Largest number of points along an edge.
pub(super) const MAX_ORDER: usize = 8;

impl PointRules {
    pub fn new() -> Self {
        let quad = |m: usize| {
            let rule = LayerRule::new(RuleKind::Gauss, m);
            let line: Vec<(f64, f64)> = rule
                .places()
                .iter()
                .copied()
                .zip(rule.weights().iter().copied())
                .collect();
            let points = line
                .iter()
                .flat_map(|&(eta, v)| line.iter().map(move |&(xi, w)| ([xi, eta], v * w / 4.0)));
            points.collect()
        };
        Self {
            quads: (1..=MAX_ORDER).map(quad).collect(),
            triangles: [
                symmetric(&[(1.0 / 3.0, 1.0 / 6.0)], &[]),
                // Dunavant 1985, degrees 4 and 6.
                symmetric(
                    &[
                        (0.223_381_589_678_011, 0.445_948_490_915_965),
                        (0.109_951_743_655_322, 0.091_576_213_509_771),
                    ],
                    &[],
                ),
                symmetric(
                    &[
                        (0.116_786_275_726_379, 0.249_286_745_170_910),
                        (0.050_844_906_370_207, 0.063_089_014_491_502),
                    ],
                    &[(
                        0.082_851_075_618_374,
                        0.053_145_049_844_817,
                        0.310_352_451_033_784,
                    )],
                ),
            ],
        }
    }

    /// The points of an element of four corners, `order` along each edge.
    pub fn quad(&self, corners: &[Point3; 4], order: usize) -> impl Iterator<Item = ElementPoint> {
        let [a, b, c, d] = corners.map(|corner| corner.coords);
        // Bilinear in ξ and η: what stands at 1, ξ, η and ξη.
        let [at_one, at_xi, at_eta, at_both] = [
            a + b + c + d,
            (b - a) + (c - d),
            (d - a) + (c - b),
            (a - b) + (c - d),
        ]
        .map(|sum: Vector3| sum * 0.25);
        let rule = &self.quads[order.clamp(1, MAX_ORDER) - 1];
        rule.iter().map(move |&([xi, eta], weight)| {
            let along_xi = at_xi + at_both * eta;
            let along_eta = at_eta + at_both * xi;
            ElementPoint {
                position: Point3::from(at_one + at_xi * xi + along_eta * eta),
                // The square has an area of 4, the weights sum to 1.
                area: 4.0 * weight * along_xi.cross(&along_eta).norm(),
                quadrant: match (xi > 0.0, eta > 0.0) {
                    (false, false) => 0,
                    (true, false) => 1,
                    (true, true) => 2,
                    (false, true) => 3,
                },
            }
        })
    }

    /// The points of an element of three corners: 3, 6 or 12 of them for orders 2, 3 and above.
    pub fn triangle(
        &self,
        corners: &[Point3; 4],
        order: usize,
    ) -> impl Iterator<Item = ElementPoint> {
        let [a, b, c, _] = *corners;
        let area = (b - a).cross(&(c - a)).norm() * 0.5;
        let rule = &self.triangles[order.clamp(2, 4) - 2];
        rule.iter().map(move |&([u, v, w], weight)| ElementPoint {
            position: Point3::from(a.coords * u + b.coords * v + c.coords * w),
            area: area * weight,
            quadrant: 0,
        })
    }
}

/// All permutations of (1 − 2a, a, a) for each (weight, a) and of (a, b, 1 − a − b) for each
/// (weight, a, b).
fn symmetric(threes: &[(f64, f64)], sixes: &[(f64, f64, f64)]) -> Vec<([f64; 3], f64)> {
    let mut points = Vec::new();
    for &(weight, a) in threes {
        let b = 1.0 - 2.0 * a;
        for place in [[b, a, a], [a, b, a], [a, a, b]] {
            points.push((place, weight));
        }
    }
    for &(weight, a, b) in sixes {
        let c = 1.0 - a - b;
        for place in [
            [a, b, c],
            [a, c, b],
            [b, a, c],
            [b, c, a],
            [c, a, b],
            [c, b, a],
        ] {
            points.push((place, weight));
        }
    }
    let sum: f64 = points.iter().map(|(_, weight)| weight).sum();
    for (_, weight) in &mut points {
        *weight /= sum;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners() -> [Point3; 4] {
        let at = |x, y| Point3::new(x, y, 0.0);
        [at(0.0, 0.0), at(3.0, 0.4), at(2.6, 2.0), at(-0.2, 1.7)]
    }

    /// ∫ x² y over the quad by a fine midpoint rule.
    fn reference() -> f64 {
        let n = 400;
        let rules = PointRules::new();
        let mut sum = 0.0;
        let c = corners();
        let bilinear = |u: f64, v: f64| {
            c[0].coords * (1.0 - u) * (1.0 - v)
                + c[1].coords * u * (1.0 - v)
                + c[2].coords * u * v
                + c[3].coords * (1.0 - u) * v
        };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let h = 1.0 / f64::from(n);
            let (u, v) = (f64::from(i) * h, f64::from(j) * h);
            let cell = [
                bilinear(u, v),
                bilinear(u + h, v),
                bilinear(u + h, v + h),
                bilinear(u, v + h),
            ];
            for point in rules.quad(&cell.map(Point3::from), 1) {
                sum += point.area * point.position.x.powi(2) * point.position.y;
            }
        }
        sum
    }

    #[test]
    fn quads_integrate_polynomials() {
        let expected = reference();
        for order in 3..=MAX_ORDER {
            let rules = PointRules::new();
            let points: Vec<ElementPoint> = rules.quad(&corners(), order).collect();
            let sum: f64 = points
                .iter()
                .map(|p| p.area * p.position.x.powi(2) * p.position.y)
                .sum();
            assert!(
                (sum - expected).abs() < 1e-4 * expected.abs(),
                "{order}: {sum} {expected}"
            );
        }
    }

    #[test]
    fn triangles_integrate_polynomials() {
        let [a, b, c, _] = corners();
        let rules = PointRules::new();
        let integral = |order: usize, f: &dyn Fn(&Point3) -> f64| -> f64 {
            let corners = [a, b, c, c];
            let points = rules.triangle(&corners, order);
            points.map(|p| p.area * f(&p.position)).sum()
        };
        let area = (b - a).cross(&(c - a)).norm() * 0.5;
        let mean = |f: &dyn Fn(&Point3) -> f64| area * (f(&a) + f(&b) + f(&c)) / 3.0;
        for order in 2..=4 {
            let linear = |p: &Point3| 1.0 + 2.0 * p.x - p.y;
            assert!((integral(order, &linear) - mean(&linear)).abs() < 1e-12);
        }
        let quartic = |p: &Point3| p.x.powi(2) * p.y.powi(2);
        assert!((integral(3, &quartic) - integral(4, &quartic)).abs() < 1e-10);
    }

    #[test]
    fn quadrants_follow_the_corners() {
        let rules = PointRules::new();
        for point in rules.quad(&corners(), 2) {
            let near = corners()[point.quadrant as usize];
            let others = corners().into_iter().filter(|c| *c != near);
            let distance = (point.position - near).norm();
            assert!(
                others
                    .into_iter()
                    .all(|c| (point.position - c).norm() > distance)
            );
        }
    }
}
