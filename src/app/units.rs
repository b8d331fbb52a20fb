use crate::geometry::Aabb;

/// Factors between length units people use: cm, inch, foot and metre against millimetre.
const FACTORS: [f64; 4] = [10.0, 25.4, 304.8, 1000.0];
/// How far the sizes of the two parts may be from an exact factor: trimmed flanges change a size.
const TOLERANCE: f64 = 1.4;

/// The sizes of the two parts differ by about a known factor between units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitHint {
    /// What the stamped part's lengths would have to be multiplied by, in addition to its factor.
    pub factor: f64,
}

impl UnitHint {
    /// Compares the diagonals of the two boxes; `None` if they are alike or differ otherwise.
    pub fn of(crash: &Aabb, stamped: &Aabb) -> Option<Self> {
        let ratio = crash.diagonal() / stamped.diagonal();
        if !(ratio.is_finite() && ratio > 0.0) {
            return None;
        }
        let both_ways = FACTORS.iter().flat_map(|&f| [f, 1.0 / f]);
        let off = |factor: f64| (ratio / factor).ln().abs();
        let nearest = both_ways.min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
        (off(nearest) < TOLERANCE.ln()).then_some(Self { factor: nearest })
    }

    /// The hint in words: "Stamped looks 1000 × smaller than crash".
    pub fn text(&self) -> String {
        if self.factor >= 1.0 {
            format!("Stamped looks {} × smaller than crash", self.factor)
        } else {
            format!("Stamped looks {} × larger than crash", 1.0 / self.factor)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn cube(size: f64) -> Aabb {
        Aabb::of_points(&[Point3::origin(), Point3::new(size, size, size)])
    }

    #[test]
    fn sees_metres_inches_and_nothing_where_nothing_is() {
        let hint = UnitHint::of(&cube(900.0), &cube(1.0)).unwrap();
        assert_eq!(hint.factor, 1000.0);
        assert_eq!(hint.text(), "Stamped looks 1000 × smaller than crash");
        assert_eq!(
            UnitHint::of(&cube(1.0), &cube(26.0)).unwrap().factor,
            1.0 / 25.4
        );
        assert_eq!(UnitHint::of(&cube(1.0), &cube(1.3)), None);
        assert_eq!(UnitHint::of(&cube(1.0), &cube(3.0)), None);
        assert_eq!(UnitHint::of(&cube(1.0), &cube(0.0)), None);
        assert_eq!(UnitHint::of(&Aabb::empty(), &cube(1.0)), None);
    }
}
