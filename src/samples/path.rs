//! Planar curves of straight lines and circular arcs: spines, sections and trim curves of the parts.

use nalgebra::{Point2, Vector2};

/// A position in a plane: (x, z) of a spine, (y, z) of a section, (u, v) of a trim curve.
pub(super) type Flat = Point2<f64>;

#[derive(Debug, Clone, Copy)]
enum Shape {
    Line {
        from: Flat,
        direction: Vector2<f64>,
    },
    Arc {
        center: Flat,
        radius: f64,
        start_angle: f64,
        /// +1 counter-clockwise, −1 clockwise.
        sense: f64,
    },
}

#[derive(Debug, Clone, Copy)]
struct Piece {
    shape: Shape,
    start: f64,
    length: f64,
}

impl Piece {
    /// Distance of a point; something not below `enough` if it is not below that.
    fn distance(&self, p: &Flat, enough: f64) -> f64 {
        match self.shape {
            Shape::Line { from, direction } => {
                let along = (p - from).dot(&direction).clamp(0.0, self.length);
                (p - (from + direction * along)).norm()
            }
            Shape::Arc {
                center,
                radius,
                start_angle,
                sense,
            } => {
                let arm = p - center;
                let to_circle = (arm.norm() - radius).abs();
                if to_circle >= enough {
                    return to_circle;
                }
                let turned = sense * (arm.y.atan2(arm.x) - start_angle);
                if turned.rem_euclid(std::f64::consts::TAU) * radius <= self.length {
                    return to_circle;
                }
                let end = |angle: f64| {
                    let (sin, cos) = angle.sin_cos();
                    (arm - Vector2::new(cos, sin) * radius).norm()
                };
                end(start_angle).min(end(start_angle + sense * self.length / radius))
            }
        }
    }
}

/// A corner of a polyline or polygon: (x, y, radius).
pub(super) type Corner = (f64, f64, f64);

/// What a curve was made from.
#[derive(Debug, Clone)]
enum Recipe {
    Corners(Vec<Corner>),
    Circle(Corner),
}

/// A curve of lines and arcs, parametrised by its arc length.
#[derive(Debug, Clone)]
pub(super) struct Path {
    recipe: Recipe,
    pieces: Vec<Piece>,
    /// Arc lengths of the sharp corners, where a mesh must have a node.
    corners: Vec<f64>,
    length: f64,
    closed: bool,
}

impl Path {
    /// A polyline `(x, y, corner radius)` with its inner corners rounded; the ends' radii are unused.
    pub(super) fn open(vertices: &[Corner]) -> Self {
        Self::rounded(vertices, false)
    }

    /// A polygon `(x, y, corner radius)` with rounded corners. Radius 0 keeps a corner sharp.
    pub(super) fn closed(vertices: &[Corner]) -> Self {
        Self::rounded(vertices, true)
    }

    /// A full circle, counter-clockwise.
    pub(super) fn circle(x: f64, y: f64, radius: f64) -> Self {
        let shape = Shape::Arc {
            center: Flat::new(x, y),
            radius,
            start_angle: 0.0,
            sense: 1.0,
        };
        let mut path = Self::empty(Recipe::Circle((x, y, radius)), true);
        path.push(shape, std::f64::consts::TAU * radius);
        path
    }

    /// A rectangle `2·half_x × 2·half_y` with rounded corners; equal radius and half size: a slot.
    pub(super) fn rectangle(x: f64, y: f64, half_x: f64, half_y: f64, radius: f64) -> Self {
        Self::closed(&[
            (x - half_x, y - half_y, radius),
            (x + half_x, y - half_y, radius),
            (x + half_x, y + half_y, radius),
            (x - half_x, y + half_y, radius),
        ])
    }

    /// The same kind of curve through other corners; a circle's centre counts as a corner.
    pub(super) fn remade(&self, corner: impl Fn(&Corner) -> Corner) -> Self {
        match &self.recipe {
            Recipe::Corners(corners) => {
                let corners: Vec<Corner> = corners.iter().map(corner).collect();
                Self::rounded(&corners, self.closed)
            }
            Recipe::Circle(circle) => {
                let (x, y, radius) = corner(circle);
                Self::circle(x, y, radius)
            }
        }
    }

    /// Mean of the corners.
    pub(super) fn middle(&self) -> Flat {
        let corners = match &self.recipe {
            Recipe::Corners(corners) => corners.as_slice(),
            Recipe::Circle(circle) => std::slice::from_ref(circle),
        };
        let sum: Vector2<f64> = corners.iter().map(|c| Vector2::new(c.0, c.1)).sum();
        Flat::from(sum / corners.len().max(1) as f64)
    }

    fn empty(recipe: Recipe, closed: bool) -> Self {
        Self {
            recipe,
            pieces: Vec::new(),
            corners: Vec::new(),
            length: 0.0,
            closed,
        }
    }

    fn push(&mut self, shape: Shape, length: f64) {
        if length > 1e-9 {
            let start = self.length;
            self.pieces.push(Piece {
                shape,
                start,
                length,
            });
            self.length += length;
        }
    }

    fn rounded(vertices: &[Corner], closed: bool) -> Self {
        let n = vertices.len();
        let point = |i: usize| Flat::new(vertices[i % n].0, vertices[i % n].1);
        let mut path = Self::empty(Recipe::Corners(vertices.to_vec()), closed);
        let mut at = if closed {
            // Half way along the closing edge no rounding interferes.
            nalgebra::center(&point(n - 1), &point(0))
        } else {
            point(0)
        };
        let first = at;
        for (i, &(_, _, radius)) in vertices.iter().enumerate().skip(usize::from(!closed)) {
            let corner = point(i);
            let before = (corner - point(i + n - 1)).normalize();
            if !closed && i == n - 1 {
                path.line_to(&mut at, corner);
                break;
            }
            let after = (point(i + 1) - corner).normalize();
            let turn = before.perp(&after).atan2(before.dot(&after));
            if radius <= 0.0 {
                path.line_to(&mut at, corner);
                path.corners.push(path.length);
                continue;
            }
            let setback = radius * (turn.abs() / 2.0).tan();
            path.line_to(&mut at, corner - before * setback);
            let sense = turn.signum();
            let left = Vector2::new(-before.y, before.x) * sense;
            let shape = Shape::Arc {
                center: at + left * radius,
                radius,
                start_angle: (-left.y).atan2(-left.x),
                sense,
            };
            path.push(shape, radius * turn.abs());
            at = corner + after * setback;
        }
        if closed {
            path.line_to(&mut at, first);
        }
        path
    }

    fn line_to(&mut self, at: &mut Flat, to: Flat) {
        let step = to - *at;
        if let Some(direction) = step.try_normalize(1e-9) {
            let from = *at;
            self.push(Shape::Line { from, direction }, step.norm());
        }
        *at = to;
    }

    /// Arc length of the whole curve.
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Position and unit tangent at arc length `s`. An open curve goes on straight beyond its ends.
    pub(super) fn at(&self, s: f64) -> (Flat, Vector2<f64>) {
        let s = if self.closed {
            s.rem_euclid(self.length)
        } else {
            s
        };
        let after = self.pieces.partition_point(|piece| piece.start <= s);
        let piece = &self.pieces[after.saturating_sub(1)];
        let local = s - piece.start;
        let inside = local.clamp(0.0, piece.length);
        let (point, tangent) = match piece.shape {
            Shape::Line { from, direction } => (from + direction * inside, direction),
            Shape::Arc {
                center,
                radius,
                start_angle,
                sense,
            } => {
                let angle = start_angle + sense * inside / radius;
                let (sin, cos) = angle.sin_cos();
                let tangent = Vector2::new(-sin, cos) * sense;
                (center + Vector2::new(cos, sin) * radius, tangent)
            }
        };
        (point + tangent * (local - inside), tangent)
    }

    /// Distance of a point to the curve. O(pieces).
    pub(super) fn distance(&self, p: &Flat) -> f64 {
        let mut least = f64::INFINITY;
        for piece in &self.pieces {
            least = least.min(piece.distance(p, least));
        }
        least
    }

    /// Nodes of a closed curve about `spacing` apart, with one on every sharp corner.
    /// `extra` more nodes go to the longest run between corners.
    pub(super) fn nodes(&self, spacing: f64, extra: usize) -> Vec<Flat> {
        let mut breaks = self.corners.clone();
        if breaks.is_empty() {
            breaks.push(0.0);
        }
        breaks.push(breaks[0] + self.length);
        let runs: Vec<(f64, f64)> = breaks.windows(2).map(|w| (w[0], w[1] - w[0])).collect();
        let longest = (0..runs.len())
            .rev()
            .max_by(|&a, &b| runs[a].1.total_cmp(&runs[b].1));
        let mut nodes = Vec::new();
        for (i, &(start, length)) in runs.iter().enumerate() {
            let n = ((length / spacing).round() as usize).max(if runs.len() == 1 { 8 } else { 1 })
                + if Some(i) == longest { extra } else { 0 };
            nodes.extend((0..n).map(|k| self.at(start + length * k as f64 / n as f64).0));
        }
        nodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_square_has_its_length_and_lies_on_itself() {
        let path = Path::rectangle(1.0, 2.0, 10.0, 10.0, 4.0);
        let expected = 4.0 * 12.0 + std::f64::consts::TAU * 4.0;
        assert!((path.length() - expected).abs() < 1e-12);
        for node in path.nodes(1.3, 0) {
            assert!(path.distance(&node) < 1e-12);
        }
        assert!((path.distance(&Flat::new(1.0, 2.0)) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn tangents_are_derivatives_and_ends_go_on_straight() {
        let path = Path::open(&[(0.0, 0.0, 0.0), (10.0, 0.0, 3.0), (10.0, 20.0, 0.0)]);
        for i in -4..30 {
            let s = f64::from(i) + 0.05;
            let step = path.at(s + 1e-6).0 - path.at(s - 1e-6).0;
            assert!((step / 2e-6 - path.at(s).1).norm() < 1e-5, "at {s}");
        }
        assert!((path.at(-5.0).0 - Flat::new(-5.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn sharp_corners_get_nodes() {
        let path = Path::closed(&[(0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (0.0, 7.0, 2.0)]);
        let nodes = path.nodes(2.0, 3);
        for corner in [Flat::new(0.0, 0.0), Flat::new(9.0, 0.0)] {
            assert!(nodes.iter().any(|n| (n - corner).norm() < 1e-12));
        }
        assert_eq!(nodes.len(), path.nodes(2.0, 0).len() + 3);
    }
}
