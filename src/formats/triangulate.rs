//! Cutting a polygon of mesh files into triangles: a fan where it is convex, ears where it is not.
//!
//! Ears: Meisters, *Polygons Have Ears* (1975); each step cuts off a corner whose triangle holds
//! no other corner. O(n²) for concave polygons.

use crate::geometry::{Point3, Vector3};

/// A concave polygon of more corners is left out: cutting it would take too long.
const MAX_CONCAVE: usize = 2_000;

/// True if all corners turn the same way about the polygon's mean normal. Straight ones count as
/// either.
pub(super) fn is_convex(corners: &[Point3]) -> bool {
    let flat = flattened(corners);
    let (n, least) = (flat.len(), -tolerance(&flat));
    (0..n).all(|i| cross(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= least)
}

/// Triangles between the corners, by their indices, in the polygon's sense of rotation. `None`
/// for a concave polygon of more than [`MAX_CONCAVE`] corners.
pub(super) fn triangulated(corners: &[Point3]) -> Option<Vec<[usize; 3]>> {
    if is_convex(corners) {
        return Some((1..corners.len() - 1).map(|i| [0, i, i + 1]).collect());
    }
    (corners.len() <= MAX_CONCAVE).then(|| ears(&flattened(corners)))
}

fn ears(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len() - 2);
    let mut at = 0;
    while rest.len() > 3 {
        let n = rest.len();
        let corner = |i: usize| [rest[(i + n - 1) % n], rest[i % n], rest[(i + 1) % n]];
        // A polygon that crosses itself may have no ear; any corner then ends the search.
        let ear = (at..at + n).find(|&i| is_ear(points, &rest, corner(i)));
        let ear = ear.unwrap_or(at) % n;
        triangles.push(corner(ear));
        rest.remove(ear);
        // Going on beside the last ear keeps the triangles from all meeting in one corner.
        at = (ear + 1) % rest.len();
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    triangles
}

fn is_ear(points: &[[f64; 2]], rest: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [p, q, r] = [points[a], points[b], points[c]];
    let holds = |x: [f64; 2]| {
        x != p
            && x != q
            && x != r
            && cross(p, q, x) >= 0.0
            && cross(q, r, x) >= 0.0
            && cross(r, p, x) >= 0.0
    };
    cross(p, q, r) > 0.0 && !rest.iter().any(|&i| holds(points[i]))
}

/// Twice the area of a triangle, positive if it turns to the left.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// What counts as straight: rounding of coordinates of the polygon's size.
fn tolerance(flat: &[[f64; 2]]) -> f64 {
    let largest = flat.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    1e-12 * largest * largest
}

/// The corners in the plane across the polygon's mean normal (Newell), about the first corner, so
/// that they turn to the left.
fn flattened(corners: &[Point3]) -> Vec<[f64; 2]> {
    let origin = corners[0];
    let after = corners.iter().cycle().skip(1);
    let normal: Vector3 = corners
        .iter()
        .zip(after)
        .map(|(a, b)| (a - origin).cross(&(b - origin)))
        .sum();
    let [x, y, z] = [normal.x, normal.y, normal.z].map(f64::abs);
    let (axis, is_flipped) = if x >= y && x >= z {
        ([1, 2], normal.x < 0.0)
    } else if y >= z {
        ([2, 0], normal.y < 0.0)
    } else {
        ([0, 1], normal.z < 0.0)
    };
    let place = |p: &Point3| {
        let d = p - origin;
        if is_flipped {
            [d[axis[1]], d[axis[0]]]
        } else {
            [d[axis[0]], d[axis[1]]]
        }
    };
    corners.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn area(corners: &[Point3], triangles: &[[usize; 3]]) -> f64 {
        let of = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| corners[i]);
            (b - a).cross(&(c - a)).norm() / 2.0
        };
        triangles.iter().map(of).sum()
    }

    #[test]
    fn an_arrow_is_cut_along_its_inner_diagonal() {
        let corners = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]];
        let corners = corners.map(|[x, y]| Point3::new(7.0, x, y));
        assert!(!is_convex(&corners));
        let triangles = triangulated(&corners).unwrap();
        assert_eq!(triangles.len(), 2);
        assert!((area(&corners, &triangles) - 1.5).abs() < 1e-12);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]];
        let square = square.map(|[x, y]| Point3::new(x, y, 0.0));
        assert!(is_convex(&square));
    }

    proptest! {
        /// A star about the origin: its area is that of the triangles with the origin.
        #[test]
        fn stars_keep_their_area_and_their_sense(
            radii in proptest::collection::vec(0.1f64..3.0, 4..40),
            tilt in proptest::array::uniform3(-3.0f64..3.0),
            is_reversed: bool,
        ) {
            let n = radii.len();
            let turn = nalgebra::Rotation3::new(Vector3::from(tilt));
            let at = |(i, r): (usize, &f64)| {
                let angle = i as f64 / n as f64 * std::f64::consts::TAU;
                turn * Point3::new(r * angle.cos(), r * angle.sin(), 0.0)
            };
            let mut corners: Vec<Point3> = radii.iter().enumerate().map(at).collect();
            if is_reversed {
                corners.reverse();
            }
            let of_sector = |i: usize| corners[i].coords.cross(&corners[(i + 1) % n].coords) / 2.0;
            let expected: Vector3 = (0..n).map(of_sector).sum();
            let triangles = triangulated(&corners).unwrap();
            prop_assert_eq!(triangles.len(), n - 2);
            prop_assert!((area(&corners, &triangles) - expected.norm()).abs() < 1e-9);
            for t in triangles {
                let [a, b, c] = t.map(|i| corners[i]);
                prop_assert!((b - a).cross(&(c - a)).dot(&expected) >= -1e-9);
            }
        }
    }
}
