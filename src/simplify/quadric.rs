//! Quadrics: sums of weighted squared distances to planes, lines and points.

use nalgebra::Vector3;

/// The function `xᵀA x` of a position `x` relative to the vertex that carries the quadric: the
/// weighted squared distance to planes, lines and points through that vertex.
///
/// Quadrics are made from the current mesh and carry no memory of earlier collapses (Lindstrom and
/// Turk 1998; Hoppe 1999), so all their planes pass through the vertex and no constant or linear
/// term is left to drown in rounding, however far the part lies from the origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Quadric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane with the normal direction `vector`, for
    /// `weight` = `factor · |vector|²`.
    fn outer(vector: &Vector3<f64>, factor: f64) -> Self {
        let w = vector * factor;
        Self {
            xx: w.x * vector.x,
            xy: w.x * vector.y,
            xz: w.x * vector.z,
            yy: w.y * vector.y,
            yz: w.y * vector.z,
            zz: w.z * vector.z,
        }
    }

    /// Squared distance to the plane of a triangle times its area, and `stiffness` times as much to
    /// the vertex itself. `pull` is the triangle's, see [`pull_of`].
    pub(super) fn triangle(pull: &Vector3<f64>, stiffness: f64) -> Self {
        let mut quadric = Self::outer(pull, 1.0);
        let weight = stiffness * quadric.weight();
        quadric.xx += weight;
        quadric.yy += weight;
        quadric.zz += weight;
        quadric
    }

    /// `weight` times the squared distance to the vertex.
    fn point(weight: f64) -> Self {
        Self {
            xx: weight,
            yy: weight,
            zz: weight,
            ..Self::default()
        }
    }

    /// Squared distance to the line along `edge`, times the edge's squared length and `weight`.
    pub(super) fn line(edge: &Vector3<f64>, weight: f64) -> Self {
        let mut quadric = Self::point(weight * edge.norm_squared());
        quadric.subtract(&Self::outer(edge, weight));
        quadric
    }

    /// Adds a quadric of the same vertex.
    pub(super) fn add(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yy += other.yy;
        self.yz += other.yz;
        self.zz += other.zz;
    }

    /// Takes away a quadric that was added before.
    pub(super) fn subtract(&mut self, other: &Self) {
        self.xx -= other.xx;
        self.xy -= other.xy;
        self.xz -= other.xz;
        self.yy -= other.yy;
        self.yz -= other.yz;
        self.zz -= other.zz;
    }

    /// Sum of the weights of its planes, where a line counts as two planes and a point as three.
    pub(super) fn weight(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// `A x`.
    fn times(&self, x: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.xx * x.x + self.xy * x.y + self.xz * x.z,
            self.xy * x.x + self.yy * x.y + self.yz * x.z,
            self.xz * x.x + self.yz * x.y + self.zz * x.z,
        )
    }

    /// The `x` with `A x = right`, or `None` if there is not exactly one.
    ///
    /// One elimination, then determinants, so that no division waits for another. A pivot counts as
    /// zero relative to the weight, so the answer does not depend on the unit of length.
    fn solve(&self, right: &Vector3<f64>) -> Option<Vector3<f64>> {
        let smallest = 1e-12 * self.weight();
        // What is left of the other two equations times `xx`.
        let yy = self.xx * self.yy - self.xy * self.xy;
        let yz = self.xx * self.yz - self.xy * self.xz;
        let zz = self.xx * self.zz - self.xz * self.xz;
        let right_y = self.xx * right.y - self.xy * right.x;
        let right_z = self.xx * right.z - self.xz * right.x;
        let determinant = yy * zz - yz * yz;
        let is_flat = self.xx <= smallest
            || yy <= smallest * self.xx
            || determinant <= smallest * self.xx * yy;
        if is_flat {
            return None;
        }
        let inverse = 1.0 / determinant;
        let y = (zz * right_y - yz * right_z) * inverse;
        let z = (yy * right_z - yz * right_y) * inverse;
        let x = (right.x - self.xy * y - self.xz * z) * (1.0 / self.xx);
        Some(Vector3::new(x, y, z))
    }
}

/// A triangle's unit normal times the square root of its area, from the normal as long as twice its
/// area. Its outer product with itself is the triangle's quadric. Zero for a triangle without area.
pub(super) fn pull_of(twice_area: &Vector3<f64>) -> Vector3<f64> {
    let length = twice_area.norm();
    if length <= f64::MIN_POSITIVE {
        return Vector3::zeros();
    }
    twice_area * (0.5 / length).sqrt()
}

/// The sum of the quadrics of an edge's two ends, as a function of the place relative to the first.
pub(super) struct EdgeQuadric {
    sum: Quadric,
    across: Vector3<f64>,
    second_times_across: Vector3<f64>,
}

impl EdgeQuadric {
    /// For quadrics `a` and `b` of two vertices, the second one lying at `across` from the first.
    pub(super) fn new(a: &Quadric, b: &Quadric, across: Vector3<f64>) -> Self {
        let mut sum = *a;
        sum.add(b);
        Self {
            sum,
            across,
            second_times_across: b.times(&across),
        }
    }

    /// The value at `x`, never below zero.
    pub(super) fn at(&self, x: &Vector3<f64>) -> f64 {
        let from_first = x.dot(&(self.sum.times(x) - 2.0 * self.second_times_across));
        (from_first + self.across.dot(&self.second_times_across)).max(0.0)
    }

    /// Where the value is least and what it is there, or `None` if it is flat in some direction.
    pub(super) fn minimum(&self) -> Option<(Vector3<f64>, f64)> {
        let least = self.sum.solve(&self.second_times_across)?;
        let value = (self.across - least).dot(&self.second_times_across);
        Some((least, value.max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(normal: Vector3<f64>) -> Quadric {
        Quadric::outer(&normal, 1.0)
    }

    #[test]
    fn three_planes_meet_in_their_corner() {
        // Two planes through the origin, one through (3, 1, 2).
        let mut a = plane(Vector3::x());
        a.add(&plane(Vector3::new(0.6, 0.8, 0.0)));
        let b = plane(Vector3::new(0.0, 0.6, 0.8));
        let across = Vector3::new(3.0, 1.0, 2.0);
        let edge = EdgeQuadric::new(&a, &b, across);
        let corner = Vector3::new(0.0, 0.0, 2.2 / 0.8);
        let (least, value) = edge.minimum().unwrap();
        assert!((least - corner).norm() < 1e-12 && value < 1e-12);
        assert!(edge.at(&corner) < 1e-12);
        assert!((edge.at(&across) - (9.0 + 2.6 * 2.6)).abs() < 1e-12);
        assert!((edge.at(&Vector3::zeros()) - 2.2 * 2.2).abs() < 1e-12);
    }

    #[test]
    fn a_line_is_as_far_as_it_looks() {
        let edge = Vector3::new(1.0, 2.0, 2.0);
        let quadric = Quadric::line(&edge, 2.0);
        let x = Vector3::new(0.3, -1.0, 4.0);
        let distance2 = x.cross(&edge).norm_squared() / 9.0;
        assert!((x.dot(&quadric.times(&x)) - 2.0 * 9.0 * distance2).abs() < 1e-10);
    }

    #[test]
    fn a_triangle_pulls_with_its_area() {
        let twice_area = Vector3::new(2.0, 0.0, 0.0).cross(&Vector3::new(0.0, 3.0, 0.0));
        let pull = pull_of(&twice_area);
        let quadric = Quadric::triangle(&pull, 0.0);
        let x = Vector3::new(7.0, 8.0, 2.0);
        assert!((x.dot(&quadric.times(&x)) - 3.0 * 4.0).abs() < 1e-12);
        assert!((Quadric::triangle(&pull, 0.5).weight() - 3.0 * 2.5).abs() < 1e-12);
        assert_eq!(pull_of(&Vector3::zeros()), Vector3::zeros());
    }

    #[test]
    fn flatness_does_not_depend_on_the_unit() {
        for unit in [1e-9, 1.0, 1e9] {
            let mut groove = Quadric::outer(&Vector3::x(), unit);
            groove.add(&Quadric::outer(&Vector3::y(), unit));
            assert_eq!(groove.solve(&Vector3::zeros()), None);
            groove.add(&Quadric::outer(&Vector3::z(), unit));
            assert_eq!(groove.solve(&Vector3::zeros()), Some(Vector3::zeros()));
        }
    }
}
