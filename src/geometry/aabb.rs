//! Boxes along the axes.

use super::{Point3, Vector3};

/// An axis-aligned box. The empty box has `min > max` in every axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Point3,
    /// Largest coordinates.
    pub max: Point3,
}

impl Aabb {
    /// The box that holds nothing.
    pub fn empty() -> Self {
        Self {
            min: Point3::from([f64::INFINITY; 3]),
            max: Point3::from([f64::NEG_INFINITY; 3]),
        }
    }

    /// The smallest box around `points`; empty for no points.
    pub fn of_points<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Self {
        let mut aabb = Self::empty();
        for point in points {
            aabb.insert(point);
        }
        aabb
    }

    /// Grows the box to hold `point`.
    pub fn insert(&mut self, point: &Point3) {
        self.min = self.min.inf(point);
        self.max = self.max.sup(point);
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.inf(&other.min),
            max: self.max.sup(&other.max),
        }
    }

    /// What both have in common; empty where they do not meet.
    pub fn intersection(&self, other: &Self) -> Self {
        let (min, max) = (self.min.sup(&other.min), self.max.inf(&other.max));
        if (0..3).all(|axis| min[axis] <= max[axis]) {
            Self { min, max }
        } else {
            Self::empty()
        }
    }

    /// True if the box holds nothing.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Edge lengths; zero for the empty box.
    pub fn extents(&self) -> Vector3 {
        if self.is_empty() {
            Vector3::zeros()
        } else {
            self.max - self.min
        }
    }

    /// Length of the space diagonal; zero for the empty box.
    pub fn diagonal(&self) -> f64 {
        self.extents().norm()
    }

    /// Centre of the box; the origin for the empty box.
    pub fn center(&self) -> Point3 {
        if self.is_empty() {
            Point3::origin()
        } else {
            nalgebra::center(&self.min, &self.max)
        }
    }

    /// The eight corners, x fastest.
    pub fn corners(&self) -> [Point3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    self.min[axis]
                } else {
                    self.max[axis]
                }
            };
            Point3::new(pick(0), pick(1), pick(2))
        })
    }
}
