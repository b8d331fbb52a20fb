//! The named views.

use nalgebra::Matrix2;

use super::Camera;
use crate::geometry::{Matrix3, Point3, Rotation, Vector3};

/// The views with a key of their own. z is up; the front view looks along +y, so that x points right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StandardView {
    /// From −y.
    Front,
    /// From +y.
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From +z, y up on the screen.
    Top,
    /// From −z, y down on the screen, as if the top view were tipped over its x axis.
    Bottom,
    /// From (+x, −y, +z), all three axes equally short.
    Isometric,
}

impl StandardView {
    /// All of them, in menu order.
    pub const ALL: [Self; 7] = [
        Self::Front,
        Self::Back,
        Self::Left,
        Self::Right,
        Self::Top,
        Self::Bottom,
        Self::Isometric,
    ];

    /// Name in menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Front => "Front",
            Self::Back => "Back",
            Self::Left => "Left",
            Self::Right => "Right",
            Self::Top => "Top",
            Self::Bottom => "Bottom",
            Self::Isometric => "Isometric",
        }
    }

    /// World direction from the scene to the viewer, and the one that points up on the screen.
    fn back_and_up(self) -> (Vector3, Vector3) {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        match self {
            Self::Front => (-y, z),
            Self::Back => (y, z),
            Self::Left => (-x, z),
            Self::Right => (x, z),
            Self::Top => (z, y),
            Self::Bottom => (-z, -y),
            Self::Isometric => (Vector3::new(1.0, -1.0, 1.0), z),
        }
    }

    /// The view from a direction, each component −1, 0 or 1, if it is one of these.
    pub fn from_direction(direction: [i8; 3]) -> Option<Self> {
        let direction = Vector3::from(direction.map(f64::from));
        let is_it = |view: &Self| view.back_and_up().0 == direction;
        Self::ALL.into_iter().find(is_it)
    }

    /// The camera rotation of this view.
    pub fn world_from_view(self) -> Rotation {
        let (back, up) = self.back_and_up();
        rotation_from(&back, &up)
    }
}

impl Camera {
    /// Turns to a standard view about the target.
    pub fn set_standard_view(&mut self, view: StandardView) {
        self.world_from_view = view.world_from_view();
    }

    /// Turns about the target to look from a direction, each component −1, 0 or 1, with z up. Three zeros
    /// change nothing.
    pub fn look_from(&mut self, direction: [i8; 3]) {
        let back = Vector3::from(direction.map(f64::from));
        if let Some(view) = StandardView::from_direction(direction) {
            self.set_standard_view(view);
        } else if back != Vector3::zeros() {
            self.world_from_view = rotation_from(&back, &Vector3::z());
        }
    }

    /// The standard view that this is, to a thousandth of a radian.
    pub fn standard_view(&self) -> Option<StandardView> {
        let is_it = |view: &StandardView| {
            let rotation = view.world_from_view();
            rotation.angle_to(&self.world_from_view) < 1e-3
        };
        StandardView::ALL.into_iter().find(is_it)
    }

    /// Looks along `direction` with the longest side of `points` horizontal. Of the two ways round,
    /// the one with the world's z axis (for vertical directions: y axis) upwards. A zero direction
    /// changes nothing; the direction may be opposite or along any axis. O(points).
    pub fn look_along(&mut self, direction: &Vector3, points: &[Point3]) {
        let Some(forward) = direction.try_normalize(0.0) else {
            return;
        };
        let back = -forward;
        let upright = upright_for(&back);
        let level = rotation_from(&back, &upright);
        let angle = long_side_angle(&level, points);
        let mut rotation = level * Rotation::from_axis_angle(&Vector3::z_axis(), angle);
        if (rotation * Vector3::y()).dot(&upright) < -1e-9 {
            let half_turn = Rotation::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
            rotation *= half_turn;
        }
        self.world_from_view = rotation;
    }
}

/// z, or y where z would point at or away from the viewer.
fn upright_for(back: &Vector3) -> Vector3 {
    if back.z.abs() > 0.99 {
        Vector3::y()
    } else {
        Vector3::z()
    }
}

/// The rotation whose view z axis is `back` and whose view y axis is as near to `up` as possible.
fn rotation_from(back: &Vector3, up: &Vector3) -> Rotation {
    let z = back.normalize();
    let x = up.cross(&z).normalize();
    let y = z.cross(&x);
    let matrix = Matrix3::from_columns(&[x, y, z]);
    Rotation::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix))
}

/// Angle of the first principal axis of the projected points against the view's x axis, within
/// ±90°; 0 if no direction is longer than another.
fn long_side_angle(world_from_view: &Rotation, points: &[Point3]) -> f64 {
    let Some(first) = points.first() else {
        return 0.0;
    };
    let n = points.len() as f64;
    let seen = |p: &Point3| world_from_view.inverse_transform_vector(&(p - first)).xy();
    let mean = points.iter().map(seen).sum::<nalgebra::Vector2<f64>>() / n;
    let mut spread = Matrix2::zeros();
    for p in points {
        let d = seen(p) - mean;
        spread += d * d.transpose();
    }
    let difference = spread[(0, 0)] - spread[(1, 1)];
    if difference.hypot(2.0 * spread[(0, 1)]) <= 1e-9 * spread.trace() {
        return 0.0;
    }
    0.5 * (2.0 * spread[(0, 1)]).atan2(difference)
}
