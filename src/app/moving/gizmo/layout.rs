//! Where the handles lie in the window, and which of them is under the pointer.

use std::f64::consts::{PI, TAU};

use super::Handle;
use crate::app::{Axis, AxisFrame, MoveFrame};
use crate::geometry::camera::{Camera, ScreenSize};
use crate::geometry::{Aabb, Point3, Vector3};

/// Radius of the outermost ring in pixels, whatever the zoom.
pub const RADIUS: f64 = 110.0;
/// How far beside a handle the pointer may be, in pixels.
pub const HIT_SLOP: f64 = 8.0;
/// Length of the arrows.
pub(super) const ARROW: f64 = 96.0;
/// The arrows begin here, clear of the dot.
pub(super) const ARROW_FOOT: f64 = 14.0;
/// Radius of the three rings.
const RING: f64 = 80.0;
/// Where the squares begin and end along both their axes.
const SQUARE: [f64; 2] = [28.0, 46.0];
/// Radius of the dot.
pub const DOT: f64 = 6.0;
/// Straight pieces of a ring.
const N_PIECES: usize = 64;
/// An arrow that points nearly at the viewer (cosine above this) can neither be seen nor dragged.
const END_ON: f64 = 0.985;
/// A square or ring seen nearly from its edge (cosine below this).
const EDGE_ON: f64 = 0.1;

/// What the gizmo is seen with.
#[derive(Debug, Clone, Copy)]
pub struct GizmoView<'a> {
    /// The camera of this frame.
    pub camera: &'a Camera,
    /// Size of the view in points.
    pub screen: ScreenSize,
    /// Pivot and axes now.
    pub frame: &'a MoveFrame,
    /// Whose axes the handles follow.
    pub axes: AxisFrame,
}

impl GizmoView<'_> {
    fn ray(&self, at: [f64; 2]) -> (Point3, Vector3) {
        let ray = self.camera.ray(at, self.screen, &Aabb::empty());
        (ray.origin, ray.direction)
    }

    /// Unit vector from a point towards the viewer.
    pub(super) fn towards_viewer(&self, point: &Point3) -> Vector3 {
        let pixel = self.camera.project(point, self.screen);
        match pixel {
            Some(pixel) => -self.ray([pixel.x, pixel.y]).1,
            None => -self.camera.forward(),
        }
    }

    /// Distance along a line (from `origin`, unit direction) to where it comes closest to the
    /// pointer's ray; `None` if the two are parallel.
    pub(super) fn along_line(
        &self,
        origin: &Point3,
        direction: &Vector3,
        at: [f64; 2],
    ) -> Option<f64> {
        let (eye, ray) = self.ray(at);
        let cosine = direction.dot(&ray);
        let sine_sq = 1.0 - cosine * cosine;
        if sine_sq < 1e-9 {
            return None;
        }
        let between = eye - origin;
        Some((direction.dot(&between) - cosine * ray.dot(&between)) / sine_sq)
    }

    /// Where the pointer's ray meets a plane; `None` if it runs along it.
    pub(super) fn on_plane(
        &self,
        origin: &Point3,
        normal: &Vector3,
        at: [f64; 2],
    ) -> Option<Point3> {
        let (eye, ray) = self.ray(at);
        let slope = ray.dot(normal);
        if slope.abs() < 1e-6 {
            return None;
        }
        Some(eye + ray * ((origin - eye).dot(normal) / slope))
    }

    /// The angle about an axis that the pointer swept from one pixel to another, radians. A ring
    /// seen from its edge is rolled like a wheel under the pointer.
    pub(super) fn swept(
        &self,
        pivot: &Point3,
        axis: &Vector3,
        from: [f64; 2],
        to: [f64; 2],
    ) -> f64 {
        let towards_viewer = self.towards_viewer(pivot);
        if axis.dot(&towards_viewer).abs() < 2.0 * EDGE_ON {
            return self.rolled(pivot, &axis.cross(&towards_viewer), from, to);
        }
        let arm = |at| self.on_plane(pivot, axis, at).map(|point| point - pivot);
        let (Some(before), Some(there)) = (arm(from), arm(to)) else {
            return 0.0;
        };
        axis.dot(&before.cross(&there)).atan2(before.dot(&there))
    }

    /// `rim` is the way the near side of the wheel goes when it turns forward.
    fn rolled(&self, pivot: &Point3, rim: &Vector3, from: [f64; 2], to: [f64; 2]) -> f64 {
        let there = self.camera.unproject(to, self.screen, pivot);
        let before = self.camera.unproject(from, self.screen, pivot);
        let radius = RING * self.camera.pixel_size(self.screen, pivot);
        rim.normalize().dot(&(there - before)) / radius
    }

    /// The smallest power of ten that is at least `pixels` long at a point.
    pub(super) fn round_step(&self, point: &Point3, pixels: f64) -> f64 {
        let length = pixels * self.camera.pixel_size(self.screen, point);
        10f64.powf(length.log10().ceil())
    }
}

/// A handle as lines on the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Which handle it is.
    pub handle: Handle,
    /// The pieces that face the viewer. A square is a closed outline.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// All handles as they lie on the screen in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Where the pivot is seen.
    pub center: [f64; 2],
    /// Those that can be seen, and so be grabbed.
    pub shapes: Vec<Shape>,
}

impl Layout {
    /// `None` if the pivot is behind the viewer.
    pub fn new(view: &GizmoView<'_>) -> Option<Self> {
        let pivot = view.frame.pivot;
        let center = view.camera.project(&pivot, view.screen)?;
        let mut layout = Self {
            center: [center.x, center.y],
            shapes: Vec::new(),
        };
        for axis in Axis::ALL {
            layout.shapes.extend(arrow(view, axis));
            layout.shapes.extend(square(view, axis));
            layout.shapes.push(ring(view, axis));
        }
        layout.shapes.push(view_ring(layout.center));
        Some(layout)
    }

    /// The handle at a pixel: the dot, then a square that holds it, then the nearest line.
    pub fn hit(&self, at: [f64; 2]) -> Option<Handle> {
        if distance(at, self.center) <= DOT + HIT_SLOP / 2.0 {
            return Some(Handle::Dot);
        }
        let holds = |shape: &&Shape| {
            let is_square = matches!(shape.handle, Handle::Square(_));
            is_square && shape.lines.iter().any(|outline| is_inside(outline, at))
        };
        if let Some(shape) = self.shapes.iter().find(holds) {
            return Some(shape.handle);
        }
        let measured = self.shapes.iter().map(|shape| (shape.distance(at), shape));
        let near = measured.filter(|(distance, _)| *distance <= HIT_SLOP);
        let nearest = near.min_by(|(a, _), (b, _)| a.total_cmp(b));
        nearest.map(|(_, shape)| shape.handle)
    }
}

impl Shape {
    fn distance(&self, at: [f64; 2]) -> f64 {
        let pieces = self.lines.iter().flat_map(|line| line.windows(2));
        pieces
            .map(|piece| distance_to_segment(at, piece[0], piece[1]))
            .fold(f64::INFINITY, f64::min)
    }
}

fn project(view: &GizmoView<'_>, offset: Vector3) -> Option<[f64; 2]> {
    let pixel = view.camera.pixel_size(view.screen, &view.frame.pivot);
    let point = view.frame.pivot + offset * pixel;
    let at = view.camera.project(&point, view.screen)?;
    Some([at.x, at.y])
}

fn facing(view: &GizmoView<'_>, direction: &Vector3) -> f64 {
    direction.dot(&view.towards_viewer(&view.frame.pivot))
}

fn arrow(view: &GizmoView<'_>, axis: Axis) -> Option<Shape> {
    let direction = view.frame.axis(axis, view.axes);
    if facing(view, &direction).abs() > END_ON {
        return None;
    }
    let foot = project(view, direction * ARROW_FOOT)?;
    let tip = project(view, direction * ARROW)?;
    Some(Shape {
        handle: Handle::Arrow(axis),
        lines: vec![vec![foot, tip]],
    })
}

fn square(view: &GizmoView<'_>, axis: Axis) -> Option<Shape> {
    let of = |axis| view.frame.axis(axis, view.axes);
    if facing(view, &of(axis)).abs() < EDGE_ON {
        return None;
    }
    let [first, second] = match axis {
        Axis::X => [of(Axis::Y), of(Axis::Z)],
        Axis::Y => [of(Axis::Z), of(Axis::X)],
        Axis::Z => [of(Axis::X), of(Axis::Y)],
    };
    let [low, high] = SQUARE;
    let corners = [
        (low, low),
        (high, low),
        (high, high),
        (low, high),
        (low, low),
    ];
    let outline = corners.map(|(a, b)| project(view, first * a + second * b));
    let outline: Option<Vec<[f64; 2]>> = outline.into_iter().collect();
    Some(Shape {
        handle: Handle::Square(axis),
        lines: vec![outline?],
    })
}

/// The half of a ring that faces the viewer.
fn ring(view: &GizmoView<'_>, axis: Axis) -> Shape {
    let normal = view.frame.axis(axis, view.axes);
    let towards_viewer = view.towards_viewer(&view.frame.pivot);
    let is_flat_on = normal.dot(&towards_viewer).abs() > END_ON;
    let (first, second) = across(&normal);
    let mut lines = vec![Vec::new()];
    for piece in 0..=N_PIECES {
        let angle = TAU * piece as f64 / N_PIECES as f64;
        let offset = (first * angle.cos() + second * angle.sin()) * RING;
        let is_near = is_flat_on || offset.dot(&towards_viewer) >= -0.02 * RING;
        match project(view, offset).filter(|_| is_near) {
            Some(at) => {
                if let Some(line) = lines.last_mut() {
                    line.push(at);
                }
            }
            None => lines.push(Vec::new()),
        }
    }
    lines.retain(|line| line.len() > 1);
    Shape {
        handle: Handle::Ring(axis),
        lines,
    }
}

fn view_ring(center: [f64; 2]) -> Shape {
    let at = |piece: usize| {
        let angle = TAU * piece as f64 / N_PIECES as f64 - PI;
        [
            center[0] + RADIUS * angle.cos(),
            center[1] + RADIUS * angle.sin(),
        ]
    };
    Shape {
        handle: Handle::ViewRing,
        lines: vec![(0..=N_PIECES).map(at).collect()],
    }
}

/// Two unit vectors across a unit vector and each other.
fn across(normal: &Vector3) -> (Vector3, Vector3) {
    let least = normal.iamin();
    let mut other = Vector3::zeros();
    other[least] = 1.0;
    let first = normal.cross(&other).normalize();
    (first, normal.cross(&first))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn distance_to_segment(at: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
    let length_sq = along[0] * along[0] + along[1] * along[1];
    let share = if length_sq > 0.0 {
        ((to[0] * along[0] + to[1] * along[1]) / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(at, [a[0] + share * along[0], a[1] + share * along[1]])
}

/// True if a convex outline holds the pixel, whichever way round it runs.
fn is_inside(outline: &[[f64; 2]], at: [f64; 2]) -> bool {
    let side = |piece: &[[f64; 2]]| {
        let (a, b) = (piece[0], piece[1]);
        (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0])
    };
    let sides: Vec<f64> = outline.windows(2).map(side).collect();
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}
