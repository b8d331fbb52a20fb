//! Quadrics: sums of weighted squared distances to planes, lines and points.

use nalgebra::{Matrix3, Vector3};

/// The function `xᵀA x + 2 bᵀx + c` of a position `x` relative to an origin that the owner knows,
/// in practice the vertex that carries the quadric (Garland and Heckbert 1997).
///
/// The local origin keeps all terms as small as the neighbourhood, so that `c` does not drown in
/// rounding, however far the part lies from the origin of its coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Quadric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
    bx: f64,
    by: f64,
    bz: f64,
    c: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane through the origin with this unit normal.
    pub(super) fn plane(normal: &Vector3<f64>, weight: f64) -> Self {
        let w = normal * weight;
        Self {
            xx: w.x * normal.x,
            xy: w.x * normal.y,
            xz: w.x * normal.z,
            yy: w.y * normal.y,
            yz: w.y * normal.z,
            zz: w.z * normal.z,
            ..Self::default()
        }
    }

    /// `weight` times the squared distance to the origin.
    pub(super) fn point(weight: f64) -> Self {
        Self {
            xx: weight,
            yy: weight,
            zz: weight,
            ..Self::default()
        }
    }

    /// `weight` times the squared distance to the line through the origin in a unit direction.
    pub(super) fn line(direction: &Vector3<f64>, weight: f64) -> Self {
        let mut quadric = Self::point(weight);
        quadric.add(&Self::plane(direction, -weight));
        quadric
    }

    /// Adds a quadric with the same origin.
    pub(super) fn add(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yy += other.yy;
        self.yz += other.yz;
        self.zz += other.zz;
        self.bx += other.bx;
        self.by += other.by;
        self.bz += other.bz;
        self.c += other.c;
    }

    /// The same function seen from the origin `origin + shift`.
    pub(super) fn moved_to(&self, shift: &Vector3<f64>) -> Self {
        let a_shift = self.a_times(shift);
        let b = Vector3::new(self.bx, self.by, self.bz);
        Self {
            bx: self.bx + a_shift.x,
            by: self.by + a_shift.y,
            bz: self.bz + a_shift.z,
            c: self.c + shift.dot(&(a_shift + 2.0 * b)),
            ..*self
        }
    }

    /// The value at `x`, never below zero.
    pub(super) fn at(&self, x: &Vector3<f64>) -> f64 {
        let b = Vector3::new(self.bx, self.by, self.bz);
        (x.dot(&(self.a_times(x) + 2.0 * b)) + self.c).max(0.0)
    }

    /// Sum of the weights of its planes, where a line counts as two planes and a point as three.
    pub(super) fn weight(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// Where the function is least, or `None` if it is flat in some direction.
    ///
    /// LDLᵀ without pivoting. A pivot counts as zero relative to the trace, so the answer does not
    /// depend on the unit of length.
    pub(super) fn minimum(&self) -> Option<Vector3<f64>> {
        let smallest = 1e-12 * self.weight();
        let d0 = self.xx;
        if d0 <= smallest {
            return None;
        }
        let (l10, l20) = (self.xy / d0, self.xz / d0);
        let d1 = self.yy - l10 * self.xy;
        let u12 = self.yz - l10 * self.xz;
        if d1 <= smallest {
            return None;
        }
        let l21 = u12 / d1;
        let d2 = self.zz - l20 * self.xz - l21 * u12;
        if d2 <= smallest {
            return None;
        }
        let y0 = -self.bx;
        let y1 = -self.by - l10 * y0;
        let y2 = -self.bz - l20 * y0 - l21 * y1;
        let z = y2 / d2;
        let y = y1 / d1 - l21 * z;
        let x = y0 / d0 - l10 * y - l20 * z;
        Some(Vector3::new(x, y, z))
    }

    fn a_times(&self, x: &Vector3<f64>) -> Vector3<f64> {
        Matrix3::new(
            self.xx, self.xy, self.xz, self.xy, self.yy, self.yz, self.xz, self.yz, self.zz,
        ) * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_their_corner() {
        let corner = Vector3::new(1.0, -2.0, 0.5);
        let mut sum = Quadric::default();
        for normal in [
            Vector3::x(),
            Vector3::new(0.6, 0.8, 0.0),
            Vector3::new(0.0, 0.6, 0.8),
        ] {
            sum.add(&Quadric::plane(&normal, 3.0).moved_to(&-corner));
        }
        assert!((sum.minimum().unwrap() - corner).norm() < 1e-12);
        assert!(sum.at(&corner) < 1e-15);
        assert!((sum.at(&(corner + Vector3::x())) - 3.0 * 1.36).abs() < 1e-12);
    }

    #[test]
    fn a_line_is_as_far_as_it_looks() {
        let direction = Vector3::new(1.0, 2.0, 2.0) / 3.0;
        let quadric = Quadric::line(&direction, 2.0);
        let x = Vector3::new(0.3, -1.0, 4.0);
        let distance2 = x.cross(&direction).norm_squared();
        assert!((quadric.at(&x) - 2.0 * distance2).abs() < 1e-12);
    }

    #[test]
    fn flatness_does_not_depend_on_the_unit() {
        let mut edge = Quadric::plane(&Vector3::x(), 1.0);
        edge.add(&Quadric::plane(&Vector3::y(), 1.0));
        for unit in [1e-9, 1.0, 1e9] {
            let mut scaled = Quadric::default();
            for normal in [Vector3::x(), Vector3::y()] {
                scaled.add(&Quadric::plane(&normal, unit));
            }
            assert_eq!(scaled.minimum(), None);
            scaled.add(&Quadric::plane(&Vector3::z(), unit));
            assert_eq!(scaled.minimum(), Some(Vector3::zeros()));
        }
        assert_eq!(edge.minimum(), None);
    }

    #[test]
    fn moving_the_origin_changes_no_value() {
        let mut quadric = Quadric::plane(&Vector3::new(0.6, 0.0, 0.8), 2.0);
        quadric.add(&Quadric::point(0.5));
        let (shift, x) = (Vector3::new(3.0, 1.0, -2.0), Vector3::new(0.1, 0.2, 0.3));
        let moved = quadric.moved_to(&shift);
        assert!((moved.at(&x) - quadric.at(&(x + shift))).abs() < 1e-12);
    }
}
