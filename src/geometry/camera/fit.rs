//! Cameras that show a box whole.

use super::{Camera, Projection, ScreenSize};
use crate::geometry::{Aabb, Point3, Vector3};

/// Air around a fitted scene, on each side, as a share of the picture.
const MARGIN: f64 = 0.05;
/// What lies over a picture leaves at least this share of its width and of its height.
const LEAST_FREE: f64 = 0.4;
/// Below a legend a scene lies near the edge of the picture. It is put there if it becomes so much larger than beside
/// the legend.
const LARGER_BELOW: f64 = 1.15;

/// What lies over the edges of a picture: shares of its width and height, each 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Covered {
    /// Share of the width at the left.
    pub left: f64,
    /// Share of the width at the right.
    pub right: f64,
    /// Share of the height at the top.
    pub top: f64,
    /// Share of the height at the bottom.
    pub bottom: f64,
    /// Shares of the width and of the height of what lies in the lower left corner only. A scene that
    /// leaves the corner alone anyway is fitted as if nothing were there.
    pub corner: [f64; 2],
    /// What a legend at an edge covers is left free as a strip beside it, of which these are the shares of the width
    /// at the left and at the right, …
    pub beside: [f64; 2],
    /// … or as one above its foot, of which this is the share of the height, if that leaves the scene clearly larger.
    pub above: f64,
}

impl Covered {
    /// What either of two covers.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            left: self.left.max(other.left),
            right: self.right.max(other.right),
            top: self.top.max(other.top),
            bottom: self.bottom.max(other.bottom),
            corner: [0, 1].map(|k| self.corner[k].max(other.corner[k])),
            beside: [0, 1].map(|k| self.beside[k].max(other.beside[k])),
            above: self.above.max(other.above),
        }
    }

    /// Two ways to leave a legend free: the strip beside it, or the one above its foot. One and the same without it.
    fn beside_legend(&self) -> [Self; 2] {
        let [left, right] = self.beside;
        let none = Self {
            beside: [0.0; 2],
            above: 0.0,
            ..*self
        };
        let beside = Self {
            left: self.left.max(left),
            right: self.right.max(right),
            ..none
        };
        let above = Self {
            top: self.top.max(self.above),
            ..none
        };
        [beside, above]
    }

    /// True if so much is covered that a scene does not stay clear of all of it.
    fn is_too_much(&self) -> bool {
        let most = (self.left + self.right).max(self.top + self.bottom);
        most > 1.0 - LEAST_FREE
    }

    /// Two ways to keep out of the corner: the whole strip beside it, or the one below it.
    fn beside_corner(&self) -> [Self; 2] {
        let [width, height] = self.corner;
        let corner = [0.0; 2];
        [
            Self {
                left: self.left.max(width),
                corner,
                ..*self
            },
            Self {
                bottom: self.bottom.max(height),
                corner,
                ..*self
            },
        ]
    }

    /// The free rectangle in −1 … 1 from left to right and from bottom to top, never narrower than
    /// two fifths of the picture, and with the margin taken off.
    fn free(&self) -> Free {
        let limited = |a: f64, b: f64| {
            let (a, b) = (a.max(0.0), b.max(0.0));
            let shrink = ((1.0 - LEAST_FREE) / (a + b).max(f64::EPSILON)).min(1.0);
            let (a, b) = (a * shrink, b * shrink);
            let air = MARGIN * (1.0 - a - b);
            (2.0 * (a + air) - 1.0, 1.0 - 2.0 * (b + air))
        };
        Free {
            x: limited(self.left, self.right),
            y: limited(self.bottom, self.top),
        }
    }
}

/// The part of a picture that a scene is fitted into, each side within −1 … 1, low before high.
struct Free {
    x: (f64, f64),
    y: (f64, f64),
}

impl Free {
    fn center(&self) -> [f64; 2] {
        [self.x, self.y].map(|(low, high)| 0.5 * (low + high))
    }
}

impl Camera {
    /// Moves and zooms so that the box fills the picture with a margin of 5 %; the rotation stays.
    ///
    /// A box without size is centred and the zoom kept; for the empty box nothing changes.
    pub fn fit(&mut self, bounds: &Aabb, aspect: f64) {
        let corners = bounds.corners();
        let points = if bounds.is_empty() { &[][..] } else { &corners };
        self.fit_to_points_within(points, aspect, &Covered::default());
    }

    /// As [`Camera::fit`], tight around points: a turned sheet fills the picture better than the
    /// corners of its box would. O(points).
    pub fn fit_to_points(&mut self, points: &[Point3], aspect: f64) {
        self.fit_to_points_within(points, aspect, &Covered::default());
    }

    /// As [`Camera::fit_to_points`], into the rectangle of the picture over which nothing lies. O(points).
    pub fn fit_to_points_within(&mut self, points: &[Point3], aspect: f64, covered: &Covered) {
        let ways = covered.beside_legend();
        let fitted = ways.map(|covered| {
            let mut camera = *self;
            camera.fit_beside_corner(points, aspect, &covered);
            camera
        });
        let [beside, above] = ways.map(|covered| covered.is_too_much());
        let is_larger = LARGER_BELOW * fitted[1].height < fitted[0].height;
        let is_above = if beside == above { is_larger } else { beside };
        *self = fitted[usize::from(is_above)];
    }

    /// Shows points in a picture of another height, in world lengths at its target, with the middle of what is seen
    /// of them where it is. O(points).
    pub fn zoom_out_about(&mut self, points: &[Point3], height: f64) {
        let seen: Vec<Point3> = points.iter().map(|p| self.view_point(p).into()).collect();
        if !seen.is_empty() {
            let middle = Aabb::of_points(&seen).center().coords;
            let anchor = self.target + self.world_from_view * middle;
            self.zoom(height / self.height, &anchor, &Aabb::empty());
            // To the last digit, so that two cameras have one.
            self.height = height;
        }
    }

    fn fit_beside_corner(&mut self, points: &[Point3], aspect: f64, covered: &Covered) {
        self.fit_beside_edges(points, aspect, covered);
        if !self.shows_any_in_corner(points, aspect, covered.corner) {
            return;
        }
        let beside = covered.beside_corner().map(|covered| {
            let mut camera = *self;
            camera.fit_beside_edges(points, aspect, &covered);
            camera
        });
        let [left, below] = beside;
        *self = if left.height <= below.height {
            left
        } else {
            below
        };
    }

    /// True if a point is seen in the lower left corner of these shares of the picture.
    fn shows_any_in_corner(&self, points: &[Point3], aspect: f64, corner: [f64; 2]) -> bool {
        let [width, height] = corner;
        let screen = ScreenSize {
            width: aspect,
            height: 1.0,
        };
        let is_in_corner = |point: &Point3| {
            self.project(point, screen)
                .is_some_and(|at| at.x < width * aspect && at.y > 1.0 - height)
        };
        width > 0.0 && height > 0.0 && points.iter().any(is_in_corner)
    }

    fn fit_beside_edges(&mut self, points: &[Point3], aspect: f64, covered: &Covered) {
        let Some(first) = points.first() else {
            return;
        };
        let aspect = aspect.max(1e-6);
        let free = covered.free();
        let in_view = |p: &Point3| Point3::from(self.world_from_view.inverse() * (p - first));
        let seen: Vec<Point3> = points.iter().map(in_view).collect();
        let extent = Aabb::of_points(&seen);
        let center = extent.center().coords;
        let half = fitted_half_height(&seen, &center, self.projection, (&free, aspect));
        let far_digits = 1e-9 * first.coords.norm();
        if extent.diagonal() > far_digits && half > 0.0 {
            self.height = 2.0 * half;
        }
        // The middle of what is seen comes to the middle of what is free.
        let [x, y] = free.center();
        let half = 0.5 * self.height;
        let shift = Vector3::new(x * half * aspect, y * half, 0.0);
        self.target = first + self.world_from_view * (center - shift);
    }
}

/// Half the height of the smallest picture that shows all points (view directions) in its free
/// rectangle, with `center` in the middle of that.
fn fitted_half_height(
    points: &[Point3],
    center: &Vector3,
    projection: Projection,
    (free, aspect): (&Free, f64),
) -> f64 {
    // The eye stands so far back that the ray to each point stays inside the cone.
    let slope = match projection {
        Projection::Orthographic => 0.0,
        Projection::Perspective { fov_y } => (fov_y / 2.0).tan(),
    };
    let [x, y] = free.center();
    let half_height = |p: &Point3| {
        let d = p.coords - center;
        // How much narrower the cone is here than at the middle.
        let narrower = d.z * slope;
        let along = |d: f64, (low, high): (f64, f64), middle: f64| {
            let up = (d + high * narrower) / (high - middle);
            let down = (d + low * narrower) / (low - middle);
            up.max(down)
        };
        along(d.y, free.y, y).max(along(d.x / aspect, free.x, x))
    };
    points.iter().map(half_height).fold(0.0, f64::max)
}
