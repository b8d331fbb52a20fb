//! The camera of a 3D window: where it looks, how it moves, and where a point lands on the screen.
//!
//! Spaces: `world`; `view`, about the camera's target with x to the right, y up and z towards the
//! viewer; `clip`, with depth 1 near and 0 far (reverse z, which spreads the digits of a float depth
//! evenly); the screen in pixels from the top left corner. Everything is `f64`, and view coordinates
//! are small near the target, so pictures stay sharp far from the origin.

mod animation;
mod fit;
mod motion;
mod scale_bar;
mod standard;

pub use animation::CameraFlight;
pub use fit::Covered;
pub use motion::OrbitStyle;
pub use scale_bar::{ScaleBar, scale_bar};
pub use standard::StandardView;

use super::{Aabb, Matrix4, Point3, Rotation, Vector3};

/// How depth becomes size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Parallel rays: equal lengths look equal wherever they are.
    Orthographic,
    /// Rays through one eye.
    Perspective {
        /// Angle between the lowest and the highest ray, radians.
        fov_y: f64,
    },
}

impl Projection {
    /// A perspective that keeps sheet parts free of visible distortion: 30°.
    pub fn perspective() -> Self {
        Self::Perspective {
            fov_y: std::f64::consts::PI / 6.0,
        }
    }
}

/// Size of the picture in pixels. Both sides are taken as at least 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenSize {
    /// Pixels from left to right.
    pub width: f64,
    /// Pixels from top to bottom.
    pub height: f64,
}

impl ScreenSize {
    /// A size in whole pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width: f64::from(width),
            height: f64::from(height),
        }
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        self.width.max(1.0) / self.height.max(1.0)
    }

    /// −1 … 1 from left to right and from bottom to top.
    fn normalized(&self, pixel: [f64; 2]) -> [f64; 2] {
        [
            2.0 * pixel[0] / self.width.max(1.0) - 1.0,
            1.0 - 2.0 * pixel[1] / self.height.max(1.0),
        ]
    }
}

/// The ray of all points that land on one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewRay {
    /// A point in front of everything visible (orthographic) or the eye (perspective).
    pub origin: Point3,
    /// Unit vector away from the viewer.
    pub direction: Vector3,
}

/// Where a world point lands on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenPoint {
    /// Pixels from the left.
    pub x: f64,
    /// Pixels from the top.
    pub y: f64,
    /// Distance in front of the picture plane through the target; larger is nearer.
    pub depth: f64,
}

/// Position, direction, zoom and projection of a 3D window.
///
/// Switching the projection keeps the size of what lies at the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The point in the middle of the picture.
    pub target: Point3,
    /// Turns view directions into world directions.
    pub world_from_view: Rotation,
    /// World length from the bottom to the top of the picture, at the target. Positive.
    pub height: f64,
    /// Orthographic or perspective.
    pub projection: Projection,
}

impl Default for Camera {
    /// Isometric, orthographic, one unit high, at the origin.
    fn default() -> Self {
        Self {
            target: Point3::origin(),
            world_from_view: StandardView::Isometric.world_from_view(),
            height: 1.0,
            projection: Projection::Orthographic,
        }
    }
}

impl Camera {
    /// World direction that points right on the screen.
    pub fn right(&self) -> Vector3 {
        self.world_from_view * Vector3::x()
    }

    /// World direction that points up on the screen.
    pub fn up(&self) -> Vector3 {
        self.world_from_view * Vector3::y()
    }

    /// World direction away from the viewer, along the middle ray.
    pub fn forward(&self) -> Vector3 {
        self.world_from_view * -Vector3::z()
    }

    /// Distance from eye to target; `None` without an eye (orthographic).
    pub fn eye_distance(&self) -> Option<f64> {
        match self.projection {
            Projection::Orthographic => None,
            Projection::Perspective { fov_y } => Some(self.height / (2.0 * (fov_y / 2.0).tan())),
        }
    }

    /// View coordinates of a world point.
    pub fn view_point(&self, point: &Point3) -> Vector3 {
        self.view_direction(&(point - self.target))
    }

    /// View coordinates of a world direction.
    pub fn view_direction(&self, direction: &Vector3) -> Vector3 {
        self.world_from_view.inverse_transform_vector(direction)
    }

    /// How much smaller than at the target things look at view depth `z`: 1 for orthographic,
    /// zero or negative behind the eye.
    fn shrink(&self, z: f64) -> f64 {
        self.eye_distance()
            .map_or(1.0, |distance| (distance - z) / distance)
    }

    /// World length of one pixel at the depth of `point`; positive even behind the eye.
    pub fn pixel_size(&self, screen: ScreenSize, point: &Point3) -> f64 {
        let shrink = self.shrink(self.view_point(point).z).max(f64::EPSILON);
        self.height * shrink / screen.height.max(1.0)
    }

    /// Where a world point lands; `None` at or behind the eye.
    pub fn project(&self, point: &Point3, screen: ScreenSize) -> Option<ScreenPoint> {
        let view = self.view_point(point);
        let shrink = self.shrink(view.z);
        if shrink <= 0.0 {
            return None;
        }
        let per_length = screen.height.max(1.0) / (self.height * shrink);
        Some(ScreenPoint {
            x: screen.width.max(1.0) / 2.0 + view.x * per_length,
            y: screen.height.max(1.0) / 2.0 - view.y * per_length,
            depth: view.z,
        })
    }

    /// The ray through a pixel. Orthographic rays start `20 · height` in front of the target, or
    /// further if `bounds` (what is drawn) needs it.
    pub fn ray(&self, pixel: [f64; 2], screen: ScreenSize, bounds: &Aabb) -> ViewRay {
        let [x, y] = screen.normalized(pixel);
        let half = self.height / 2.0;
        let at_target = Vector3::new(x * half * screen.aspect(), y * half, 0.0);
        let eye = match self.eye_distance() {
            Some(distance) => Vector3::new(0.0, 0.0, distance),
            None => {
                let (_, nearest) = self.view_depths(bounds);
                at_target + Vector3::z() * nearest.max(20.0 * self.height)
            }
        };
        ViewRay {
            origin: self.target + self.world_from_view * eye,
            direction: self.world_from_view * (at_target - eye).normalize(),
        }
    }

    /// The point under a pixel at the depth of `anchor`.
    pub fn unproject(&self, pixel: [f64; 2], screen: ScreenSize, anchor: &Point3) -> Point3 {
        let [x, y] = screen.normalized(pixel);
        let z = self.view_point(anchor).z;
        let half = self.height / 2.0 * self.shrink(z);
        let view = Vector3::new(x * half * screen.aspect(), y * half, z);
        self.target + self.world_from_view * view
    }

    /// Smallest and largest view depth of a box; (0, 0) for the empty box.
    fn view_depths(&self, bounds: &Aabb) -> (f64, f64) {
        if bounds.is_empty() {
            return (0.0, 0.0);
        }
        let depths = bounds.corners().map(|corner| self.view_point(&corner).z);
        depths
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &z| {
                (low.min(z), high.max(z))
            })
    }

    /// The depth range (far, near) in view z that holds `bounds` with some air, fitted for every
    /// frame so that the depth buffer's digits go where the parts are.
    pub fn depth_range(&self, bounds: &Aabb) -> (f64, f64) {
        let (low, high) = self.view_depths(bounds);
        // Air for lines pulled a few pixels towards the viewer, in thumbnails too; it also keeps flat
        // scenes from a range of zero.
        let air = 0.01 * (high - low) + 0.1 * self.height;
        let (far, near) = (low - air, high + air);
        match self.eye_distance() {
            None => (far, near),
            Some(distance) => {
                let far = far.min(distance * 0.5);
                // The eye may stand inside the part: the near plane stays in front of it.
                let nearest = distance - (distance - far).abs() * 1e-4;
                (far, near.min(nearest))
            }
        }
    }

    /// The matrix from view to clip space for everything within `bounds`.
    pub fn clip_from_view(&self, aspect: f64, bounds: &Aabb) -> Matrix4 {
        let (far, near) = self.depth_range(bounds);
        let half = self.height / 2.0;
        let mut m = Matrix4::zeros();
        match self.eye_distance() {
            None => {
                m[(0, 0)] = 1.0 / (half * aspect);
                m[(1, 1)] = 1.0 / half;
                m[(2, 2)] = 1.0 / (near - far);
                m[(2, 3)] = -far / (near - far);
                m[(3, 3)] = 1.0;
            }
            Some(distance) => {
                // w is the distance from the eye over the distance of the target.
                m[(0, 0)] = 1.0 / (half * aspect);
                m[(1, 1)] = 1.0 / half;
                let (n, f) = (distance - near, distance - far);
                // depth · w = a·e + b, with e the distance from the eye: 1 at n, 0 at f.
                let scale = 1.0 / distance;
                let b = scale * n * f / (f - n);
                let a = -b / f;
                m[(2, 2)] = -a;
                m[(2, 3)] = a * distance + b;
                m[(3, 2)] = -scale;
                m[(3, 3)] = 1.0;
            }
        }
        m
    }

    /// Directions of the world axes on the screen (x right, y up, z towards the viewer), for a triad.
    pub fn axes_in_view(&self) -> [Vector3; 3] {
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| self.view_direction(&axis))
    }
}

#[cfg(test)]
mod tests;
