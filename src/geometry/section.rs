//! Where a plane cuts a mesh, as joined lines.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::serial::xyz;
use super::{Aabb, Point3, TriMesh, Vector3};

/// A plane in space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plane {
    /// A point of the plane.
    #[serde(with = "xyz")]
    pub point: Point3,
    /// Unit normal.
    #[serde(with = "xyz")]
    pub normal: Vector3,
}

impl Plane {
    /// A plane through a point; `normal` may have any length but zero, for which z is taken.
    pub fn new(point: Point3, normal: &Vector3) -> Self {
        let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::z);
        Self { point, normal }
    }

    /// Signed distance, positive on the side of the normal.
    pub fn distance(&self, point: &Point3) -> f64 {
        (point - self.point).dot(&self.normal)
    }

    /// True if it goes through a box or touches it.
    pub fn meets(&self, bounds: &Aabb) -> bool {
        let distances = bounds.corners().map(|corner| self.distance(&corner));
        let side = |is_wanted: fn(f64) -> bool| distances.into_iter().any(is_wanted);
        side(|distance| distance <= 0.0) && side(|distance| distance >= 0.0)
    }

    /// Unit directions to the right and up when looking against the normal: up is as near to z as
    /// it can be, or to y for a plane across z.
    pub fn axes(&self) -> [Vector3; 2] {
        let upright = if self.normal.z.abs() < 0.99 {
            Vector3::z()
        } else {
            Vector3::y()
        };
        let right = upright.cross(&self.normal).normalize();
        [right, self.normal.cross(&right)]
    }

    /// Coordinates of a point along [`Plane::axes`], measured from the origin of space, so that
    /// they stay the same while the plane moves along its normal.
    pub fn flat(&self, point: &Point3) -> [f64; 2] {
        self.axes().map(|axis| axis.dot(&point.coords))
    }

    /// The point of the plane with these coordinates along [`Plane::axes`].
    pub fn point_at(&self, [right, up]: [f64; 2]) -> Point3 {
        let [along, upward] = self.axes();
        let height = self.normal.dot(&self.point.coords);
        Point3::from(along * right + upward * up + self.normal * height)
    }

    /// Corners of the rectangle in the plane, along [`Plane::axes`], under a box.
    pub fn rectangle(&self, bounds: &Aabb) -> [Point3; 4] {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in bounds.corners() {
            for (i, value) in self.flat(&corner).into_iter().enumerate() {
                low[i] = low[i].min(value);
                high[i] = high[i].max(value);
            }
        }
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        corners.map(|corner| self.point_at(corner))
    }
}

/// How two outlines lie to each other at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// The place on the first outline.
    pub from: Point3,
    /// The nearest place on the second one.
    pub to: Point3,
    /// Distance across the first outline; positive on the side of its sheet's normal.
    pub gap: f64,
    /// Distance along the first outline, without sign: zero but where the second one ends.
    pub flush: f64,
}

/// The gap between two outlines in a plane next to `query`. `normal_of` gives the normal of a
/// triangle of the first one. `None` if one of them is empty. O(pieces).
pub fn gap_at(
    first: &[SectionLine],
    normal_of: impl Fn(u32) -> Vector3,
    second: &[SectionLine],
    plane: &Plane,
    query: &Point3,
) -> Option<Gap> {
    let from = nearest_on_lines(first, query)?;
    let to = nearest_on_lines(second, &from.point)?;
    let away = to.point - from.point;
    let across = plane.normal.cross(&from.tangent);
    let is_front = across.dot(&normal_of(from.triangle)) >= 0.0;
    let front = if is_front { across } else { -across };
    Some(Gap {
        from: from.point,
        to: to.point,
        gap: away.dot(&front),
        flush: away.dot(&from.tangent).abs(),
    })
}

/// [`gap_at`] to the one of several outlines that lies nearest there, the first of equal ones.
pub fn gap_to_nearest<'a>(
    first: &[SectionLine],
    normal_of: impl Fn(u32) -> Vector3,
    others: impl IntoIterator<Item = &'a [SectionLine]>,
    plane: &Plane,
    query: &Point3,
) -> Option<Gap> {
    let gaps = others
        .into_iter()
        .filter_map(|other| gap_at(first, &normal_of, other, plane, query));
    let length = |gap: &Gap| (gap.to - gap.from).norm();
    gaps.min_by(|a, b| length(a).total_cmp(&length(b)))
}

/// How far the points of one outline lie from another outline.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OutlineGaps {
    /// For each line and each of its points the way from the nearest place of the other outline;
    /// `None` beyond that outline's ends and further than the limit.
    pub ways: Vec<Vec<Option<Vector3>>>,
    /// The longest of these ways, the first of equal ones.
    pub worst: Option<OutlineGap>,
}

/// A way from one outline to another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineGap {
    /// On the first outline.
    pub from: Point3,
    /// On the second one.
    pub to: Point3,
}

/// A way that leans so much along the outline it begins at begins at its end, and is no gap.
const LEANING: f64 = 0.5;

/// The ways from `first` to the points of `second` that are no longer than `limit`. O(pieces · points).
pub fn outline_gaps(first: &[SectionLine], second: &[SectionLine], limit: f64) -> OutlineGaps {
    let mut found = OutlineGaps::default();
    let mut longest = 0.0;
    for line in second {
        let ways = line.points.iter().map(|to| {
            let nearest = nearest_on_lines(first, to)?;
            let way = to - nearest.point;
            let length = way.norm();
            let leans = way.dot(&nearest.tangent).abs() > LEANING * length;
            if length > limit || (leans && length > 0.0) {
                return None;
            }
            if length > longest {
                longest = length;
                found.worst = Some(OutlineGap {
                    from: nearest.point,
                    to: *to,
                });
            }
            Some(way)
        });
        let ways = ways.collect();
        found.ways.push(ways);
    }
    found
}

/// A connected piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionLine {
    /// Its points in order, in the mesh's frame, no two neighbours equal. A closed line does not
    /// repeat its first point.
    pub points: Vec<Point3>,
    /// The triangle of each piece between neighbouring points; for a closed line the last one leads
    /// back to the first point.
    pub triangles: Vec<u32>,
    /// True if it ends where it begins.
    pub is_closed: bool,
}

/// A point of a section line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePoint {
    /// Where it is.
    pub point: Point3,
    /// Unit direction of the line there.
    pub tangent: Vector3,
    /// The triangle it lies on.
    pub triangle: u32,
}

impl SectionLine {
    /// Its straight pieces with their triangles.
    pub fn pieces(&self) -> impl Iterator<Item = ([Point3; 2], u32)> + '_ {
        let n = self.points.len();
        let ends = move |i: usize| [self.points[i], self.points[(i + 1) % n]];
        let triangles = self.triangles.iter().enumerate();
        triangles.map(move |(i, &triangle)| (ends(i), triangle))
    }
}

/// The point of some lines that is closest to `query`, the first of equal ones. O(pieces).
pub fn nearest_on_lines(lines: &[SectionLine], query: &Point3) -> Option<LinePoint> {
    let mut nearest: Option<(f64, LinePoint)> = None;
    for ([a, b], triangle) in lines.iter().flat_map(SectionLine::pieces) {
        let along = b - a;
        let share = (query - a).dot(&along) / along.norm_squared();
        let point = a + along * share.clamp(0.0, 1.0);
        let distance_sq = (query - point).norm_squared();
        if nearest.is_none_or(|(least, _)| distance_sq < least) {
            let found = LinePoint {
                point,
                tangent: along.normalize(),
                triangle,
            };
            nearest = Some((distance_sq, found));
        }
    }
    nearest.map(|(_, found)| found)
}

/// Cuts a mesh with a plane. Vertices on the plane count as in front of it, which is what a plane
/// an infinitely small step behind would give: every triangle is cut along one piece or not at all,
/// lines end at borders only (or where three or more triangles meet), and an area that lies in the
/// plane appears as its outline against what is behind.
///
/// Lines begin in the order of their first triangles, so the answer depends on mesh and plane
/// alone. O(vertices + triangles).
pub fn section(mesh: &TriMesh, plane: &Plane) -> Vec<SectionLine> {
    let heights: Vec<f64> = mesh.positions().iter().map(|p| plane.distance(p)).collect();
    let mut cut = Cut::default();
    for (triangle, corners) in mesh.triangles().iter().enumerate() {
        let is_front = corners.map(|v| heights[v as usize] >= 0.0);
        if is_front[0] == is_front[1] && is_front[1] == is_front[2] {
            continue;
        }
        let mut ends = [0_u32; 2];
        let mut n_ends = 0;
        for i in 0..3 {
            let j = (i + 1) % 3;
            if is_front[i] != is_front[j] {
                ends[n_ends] = cut.crossing(mesh, &heights, corners[i], corners[j]);
                n_ends += 1;
            }
        }
        if ends[0] != ends[1] {
            cut.pieces.push((ends, triangle as u32));
        }
    }
    cut.join()
}

/// The crossed edges of a mesh and the pieces between them.
#[derive(Default)]
struct Cut {
    /// Number of a crossed edge by its vertices, the smaller first. Only asked, never walked.
    number: HashMap<[u32; 2], u32>,
    /// Where each edge is crossed.
    points: Vec<Point3>,
    /// Both ends of each piece and its triangle.
    pieces: Vec<([u32; 2], u32)>,
}

impl Cut {
    fn crossing(&mut self, mesh: &TriMesh, heights: &[f64], a: u32, b: u32) -> u32 {
        // Both triangles of an edge must find the same point to the last bit.
        let [u, v] = [a.min(b), a.max(b)];
        let next = self.points.len() as u32;
        let number = *self.number.entry([u, v]).or_insert(next);
        if number == next {
            let [from, to] = [u, v].map(|v| mesh.positions()[v as usize]);
            let [low, high] = [u, v].map(|v| heights[v as usize]);
            self.points.push(if low == 0.0 {
                from
            } else if high == 0.0 {
                to
            } else {
                from + (to - from) * (low / (low - high))
            });
        }
        number
    }

    /// Chains the pieces: from every end first, then round the closed ones.
    fn join(&self) -> Vec<SectionLine> {
        let mut at: Vec<Vec<u32>> = vec![Vec::new(); self.points.len()];
        for (piece, (ends, _)) in self.pieces.iter().enumerate() {
            for &end in ends {
                at[end as usize].push(piece as u32);
            }
        }
        let mut is_used = vec![false; self.pieces.len()];
        let ends = (0..at.len() as u32).filter(|&p| at[p as usize].len() != 2);
        let begins: Vec<u32> = ends.chain(0..at.len() as u32).collect();
        let mut lines = Vec::new();
        for begin in begins {
            for &first in &at[begin as usize] {
                if !is_used[first as usize] {
                    lines.extend(self.walk(begin, first, &at, &mut is_used));
                }
            }
        }
        lines
    }

    /// Follows pieces from `begin` until an end, a branch or the begin again.
    fn walk(
        &self,
        begin: u32,
        first: u32,
        at: &[Vec<u32>],
        is_used: &mut [bool],
    ) -> Option<SectionLine> {
        let mut points = vec![self.points[begin as usize]];
        let mut triangles = Vec::new();
        let (mut end, mut piece) = (begin, first);
        loop {
            is_used[piece as usize] = true;
            let (ends, triangle) = self.pieces[piece as usize];
            end = if ends[0] == end { ends[1] } else { ends[0] };
            // Edges that meet at a vertex on the plane are crossed at the same place.
            let point = self.points[end as usize];
            if points.last() != Some(&point) {
                points.push(point);
                triangles.push(triangle);
            }
            let next = at[end as usize].iter().find(|p| !is_used[**p as usize]);
            match next {
                Some(&next) if end != begin && at[end as usize].len() == 2 => piece = next,
                _ => break,
            }
        }
        let is_closed = end == begin && points.len() > 2;
        if is_closed && points.first() == points.last() {
            points.pop();
        }
        (!triangles.is_empty()).then_some(SectionLine {
            points,
            triangles,
            is_closed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn length(line: &SectionLine) -> f64 {
        line.pieces().map(|([a, b], _)| (b - a).norm()).sum()
    }

    /// A tube about z, open at both ends, `n` sides, `rings` rings of unit height.
    fn tube(n: u32, rings: u32) -> TriMesh {
        let mut positions = Vec::new();
        for ring in 0..=rings {
            for i in 0..n {
                let angle = TAU * f64::from(i) / f64::from(n);
                positions.push(Point3::new(angle.cos(), angle.sin(), f64::from(ring)));
            }
        }
        let mut triangles = Vec::new();
        for ring in 0..rings {
            for i in 0..n {
                let [a, b] = [ring * n + i, ring * n + (i + 1) % n];
                triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
            }
        }
        TriMesh::new(positions, triangles).unwrap()
    }

    fn at(point: [f64; 3], normal: [f64; 3]) -> Plane {
        Plane::new(Point3::from(point), &Vector3::from(normal))
    }

    #[test]
    fn gaps_between_outlines_end_where_an_outline_ends() {
        let line = |points: &[[f64; 2]]| SectionLine {
            points: points
                .iter()
                .map(|p| Point3::new(p[0], p[1], 0.0))
                .collect(),
            triangles: vec![0; points.len() - 1],
            is_closed: false,
        };
        let first = [line(&[[0.0, 0.0], [10.0, 0.0]])];
        let second = [line(&[
            [2.0, 0.5],
            [4.0, -1.5],
            [9.0, 0.25],
            [14.0, 0.25],
            [5.0, 7.0],
        ])];
        let found = outline_gaps(&first, &second, 3.0);
        let ways: Vec<_> = found.ways[0]
            .iter()
            .map(|way| way.map(|way| way.y))
            .collect();
        assert_eq!(ways, [Some(0.5), Some(-1.5), Some(0.25), None, None]);
        let worst = found.worst.unwrap();
        assert_eq!(
            (worst.from, worst.to),
            (Point3::new(4.0, 0.0, 0.0), Point3::new(4.0, -1.5, 0.0))
        );
        assert_eq!(outline_gaps(&[], &second, 3.0).worst, None);
    }

    #[test]
    fn a_tube_gives_one_closed_circle_between_and_through_its_nodes() {
        let tube = tube(64, 4);
        for height in [0.5, 1.0, 2.0, 3.999] {
            let lines = section(&tube, &at([0.0, 0.0, height], [0.0, 0.0, 1.0]));
            assert_eq!(lines.len(), 1, "{height}");
            let circle = &lines[0];
            assert!(circle.is_closed);
            let chord_sum = 128.0 * (PI / 64.0).sin();
            assert!((length(circle) - chord_sum).abs() < 1e-3, "{height}");
            let radius = |p: &Point3| p.x.hypot(p.y);
            assert!(circle.points.iter().all(|p| (p.z - height).abs() < 1e-12));
            assert!(circle.points.iter().all(|p| radius(p) <= 1.0 + 1e-12));
            assert_eq!(circle.points.len(), circle.triangles.len());
        }
    }

    #[test]
    fn along_its_axis_a_tube_gives_two_open_lines() {
        let tube = tube(64, 4);
        // Through two rows of nodes, and between nodes.
        for normal in [[0.0, 1.0, 0.0], [0.03, 1.0, 0.0]] {
            let lines = section(&tube, &at([0.0; 3], normal));
            assert_eq!(lines.len(), 2, "{normal:?}");
            for line in &lines {
                assert!(!line.is_closed);
                assert!((length(line) - 4.0).abs() < 1e-9);
                assert_eq!(line.points.len(), line.triangles.len() + 1);
            }
        }
    }

    #[test]
    fn an_oblique_cut_is_an_ellipse() {
        let tube = tube(720, 6);
        let slope: f64 = 1.0;
        let lines = section(&tube, &at([0.0, 0.0, 3.0], [-slope, 0.0, 1.0]));
        assert_eq!(lines.len(), 1);
        // Ramanujan's circumference of an ellipse with half axes √2 and 1.
        let (a, b) = (2f64.sqrt(), 1.0);
        let circumference = PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt());
        assert!((length(&lines[0]) - circumference).abs() < 1e-3);
    }

    #[test]
    fn planes_that_touch_or_miss_cut_nothing_or_an_outline() {
        let tube = tube(12, 1);
        let up = [0.0, 0.0, 1.0];
        assert!(section(&tube, &at([0.0, 0.0, -1.0], up)).is_empty());
        assert!(section(&tube, &at([0.0, 0.0, 0.0], up)).is_empty());
        let rim = section(&tube, &at([0.0, 0.0, 1.0], up));
        assert_eq!(
            (rim.len(), rim[0].is_closed, rim[0].points.len()),
            (1, true, 12)
        );
        assert!(section(&TriMesh::default(), &at([0.0; 3], up)).is_empty());
    }

    #[test]
    fn branches_end_lines_and_every_piece_is_there_once() {
        // Three half planes that meet in the z axis.
        let mut positions = vec![Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, 1.0)];
        let mut triangles = Vec::new();
        for i in 0..3 {
            let angle = TAU * f64::from(i) / 3.0;
            let foot = positions.len() as u32;
            positions.push(Point3::new(angle.cos(), angle.sin(), 0.0));
            positions.push(Point3::new(angle.cos(), angle.sin(), 1.0));
            triangles.extend([[0, foot, foot + 1], [0, foot + 1, 1]]);
        }
        let star = TriMesh::new(positions, triangles).unwrap();
        let lines = section(&star, &at([0.0, 0.0, 0.3], [0.0, 0.0, 1.0]));
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert!((length(line) - 1.0).abs() < 1e-12 && line.triangles.len() == 2);
        }
    }

    #[test]
    fn the_nearest_point_of_lines_has_the_line_s_direction() {
        let tube = tube(64, 4);
        let lines = section(&tube, &at([0.0, 0.0, 1.5], [0.0, 0.0, 1.0]));
        let near = nearest_on_lines(&lines, &Point3::new(3.0, 0.1, 1.5)).unwrap();
        assert!((near.point - Point3::new(1.0, 0.0, 1.5)).norm() < 0.06);
        assert!(near.tangent.y.abs() > 0.99);
        assert!(nearest_on_lines(&[], &Point3::origin()).is_none());
    }

    #[test]
    fn gaps_have_the_side_of_the_first_sheet() {
        let strip = |from: f64, to: f64, z: f64| {
            let corner = |x, y| Point3::new(x, y, z);
            let positions = vec![
                corner(from, 0.0),
                corner(to, 0.0),
                corner(to, 4.0),
                corner(from, 4.0),
            ];
            TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
        };
        let plane = at([0.0, 2.0, 0.0], [0.0, 1.0, 0.0]);
        let (lower, upper) = (strip(0.0, 10.0, 0.0), strip(0.0, 7.0, 0.5));
        let [first, second] = [&lower, &upper].map(|mesh| section(mesh, &plane));
        let gap = |x: f64, normal: f64| {
            let query = Point3::new(x, 2.0, 0.1);
            gap_at(&first, |_| Vector3::z() * normal, &second, &plane, &query).unwrap()
        };
        let inside = gap(3.0, 1.0);
        assert!((inside.gap - 0.5).abs() < 1e-12 && inside.flush < 1e-12);
        assert!((gap(3.0, -1.0).gap + 0.5).abs() < 1e-12);
        let beyond = gap(9.0, 1.0);
        assert!((beyond.flush - 2.0).abs() < 1e-12 && (beyond.gap - 0.5).abs() < 1e-12);
        assert!(gap_at(&first, |_| Vector3::z(), &[], &plane, &Point3::origin()).is_none());
        // Of several outlines the nearest one counts, whichever is named first.
        let mut far = second.clone();
        for point in far.iter_mut().flat_map(|line| &mut line.points) {
            point.z += 1.0;
        }
        for others in [[&far[..], &second], [&second, &far]] {
            let query = Point3::new(3.0, 0.0, 0.0);
            let found = gap_to_nearest(&first, |_| Vector3::z(), others, &plane, &query).unwrap();
            assert!((found.gap - 0.5).abs() < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn flat_coordinates_lead_back_to_the_point() {
        let plane = at([1.0, 2.0, 3.0], [0.3, -0.5, 0.8]);
        let on_plane = plane.point_at([4.0, -5.0]);
        assert!(plane.distance(&on_plane).abs() < 1e-12);
        let [right, up] = plane.flat(&on_plane);
        assert!((right - 4.0).abs() < 1e-12 && (up + 5.0).abs() < 1e-12);
        let bounds = Aabb::of_points(&[Point3::origin(), Point3::new(2.0, 3.0, 4.0)]);
        let corners = at([9.0, 0.0, 0.0], [1.0, 0.0, 0.0]).rectangle(&bounds);
        assert_eq!(corners[0], Point3::new(9.0, 0.0, 0.0));
        assert_eq!(corners[2], Point3::new(9.0, 3.0, 4.0));
    }

    #[test]
    fn axes_look_against_the_normal_with_z_up() {
        let [right, up] = at([0.0; 3], [1.0, 0.0, 0.0]).axes();
        assert_eq!((right, up), (Vector3::y(), Vector3::z()));
        let [right, up] = at([0.0; 3], [0.0, 0.0, 1.0]).axes();
        assert_eq!((right, up), (Vector3::x(), Vector3::y()));
    }
}
