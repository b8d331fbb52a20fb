//! The closest point of one triangle.

use super::Feature;
use crate::geometry::{Point3, Vector3};

/// The point of one triangle that is closest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglePoint {
    /// The closest point.
    pub point: Point3,
    /// Weights of the three corners; they sum to 1 and none is negative.
    pub barycentric: [f64; 3],
    /// Face, edge or corner.
    pub feature: Feature,
    /// Squared distance from the query.
    pub distance_sq: f64,
}

/// The point of triangle `corners` that is closest to `query`, by region of the triangle (Ericson,
/// Real-Time Collision Detection, 2005, section 5.1.5).
///
/// Inside or outside is told by cross products instead of Ericson's products of dot products,
/// which holds for needles of any aspect up to 1e15 instead of 1e8. A triangle without area is the
/// segment or the point it has shrunk to.
pub fn closest_point_on_triangle(query: &Point3, corners: &[Point3; 3]) -> TrianglePoint {
    let edges: [Vector3; 3] = std::array::from_fn(|i| corners[(i + 1) % 3] - corners[i]);
    let to_query: [Vector3; 3] = corners.map(|corner| query - corner);
    inside(query, corners[0], &edges, &to_query)
        .unwrap_or_else(|| on_border(query, corners, &edges, &to_query))
}

/// The foot of the perpendicular if it lies strictly inside the triangle.
#[inline]
fn inside(
    query: &Point3,
    a: Point3,
    edges: &[Vector3; 3],
    to_query: &[Vector3; 3],
) -> Option<TrianglePoint> {
    let normal = edges[0].cross(&-edges[2]);
    // The weight of a corner is the area of the triangle between the foot and the opposite edge.
    let weight = |edge: usize| normal.dot(&edges[edge].cross(&to_query[edge]));
    let weights = [weight(1), weight(2), weight(0)];
    if !weights.iter().all(|&w| w > 0.0) {
        return None;
    }
    let scale = 1.0 / (weights[0] + weights[1] + weights[2]);
    let (v, w) = (weights[1] * scale, weights[2] * scale);
    if !(v.is_finite() && w.is_finite()) {
        return None;
    }
    let offset = edges[0] * v - edges[2] * w;
    let point = a + offset;
    Some(TrianglePoint {
        point,
        barycentric: [weights[0] * scale, v, w],
        feature: Feature::Face,
        // From corner to query and corner to foot, both short: no digits are lost far from the
        // origin. (query − point would round the point first.)
        distance_sq: (to_query[0] - offset).norm_squared(),
    })
    .filter(|_| query.iter().all(|x| x.is_finite()))
}

/// The closest point of the three edges.
#[inline]
fn on_border(
    query: &Point3,
    corners: &[Point3; 3],
    edges: &[Vector3; 3],
    to_query: &[Vector3; 3],
) -> TrianglePoint {
    let mut best = TrianglePoint {
        point: corners[0],
        barycentric: [1.0, 0.0, 0.0],
        feature: Feature::Vertex(0),
        distance_sq: (query - corners[0]).norm_squared(),
    };
    for i in 0..3 {
        let length_sq = edges[i].norm_squared();
        if length_sq <= 0.0 {
            continue;
        }
        let t = (to_query[i].dot(&edges[i]) / length_sq).clamp(0.0, 1.0);
        let next = (i + 1) % 3;
        let (point, feature, distance_sq) = if t <= 0.0 {
            let feature = Feature::Vertex(i as u8);
            (corners[i], feature, to_query[i].norm_squared())
        } else if t >= 1.0 {
            let feature = Feature::Vertex(next as u8);
            (corners[next], feature, to_query[next].norm_squared())
        } else {
            let offset = edges[i] * t;
            let distance_sq = (to_query[i] - offset).norm_squared();
            (corners[i] + offset, Feature::Edge(i as u8), distance_sq)
        };
        if distance_sq < best.distance_sq {
            let mut barycentric = [0.0; 3];
            barycentric[i] = 1.0 - t;
            barycentric[next] = t;
            best = TrianglePoint {
                point,
                barycentric,
                feature,
                distance_sq,
            };
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn closest(query: [f64; 3]) -> TrianglePoint {
        let corners = [
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(4.0, 0.0, 0.0),
            Point3::new(0.0, 4.0, 0.0),
        ];
        closest_point_on_triangle(&Point3::from(query), &corners)
    }

    #[test]
    fn every_region_is_named() {
        let cases = [
            ([1.0, 1.0, 2.0], Feature::Face, [1.0, 1.0, 0.0]),
            ([1.0, -1.0, 2.0], Feature::Edge(0), [1.0, 0.0, 0.0]),
            ([3.0, 3.0, 2.0], Feature::Edge(1), [2.0, 2.0, 0.0]),
            ([-1.0, 1.0, 2.0], Feature::Edge(2), [0.0, 1.0, 0.0]),
            ([-1.0, -1.0, 2.0], Feature::Vertex(0), [0.0, 0.0, 0.0]),
            ([6.0, 0.0, 2.0], Feature::Vertex(1), [4.0, 0.0, 0.0]),
            ([0.0, 6.0, 2.0], Feature::Vertex(2), [0.0, 4.0, 0.0]),
        ];
        for (query, feature, point) in cases {
            let found = closest(query);
            assert_eq!((found.feature, found.point), (feature, Point3::from(point)));
            let expected = (Point3::from(query) - found.point).norm_squared();
            assert!((found.distance_sq - expected).abs() < 1e-12);
            assert!((found.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn no_area_means_segment_or_point() {
        let p = |x: f64| Point3::new(x, 0.0, 0.0);
        let query = Point3::new(1.5, 2.0, 0.0);
        for corners in [
            [p(0.0), p(1.0), p(3.0)],
            [p(3.0), p(0.0), p(1.0)],
            [p(0.0), p(3.0), p(3.0)],
            [p(0.0), p(0.0), p(3.0)],
        ] {
            let found = closest_point_on_triangle(&query, &corners);
            assert_eq!((found.point, found.distance_sq), (p(1.5), 4.0));
        }
        let found = closest_point_on_triangle(&query, &[p(0.5); 3]);
        assert_eq!(found.distance_sq, 5.0);
        assert_eq!(found.feature, Feature::Vertex(0));
    }

    #[test]
    fn needles_keep_their_inside() {
        let height = 1e-10;
        let corners = [
            Point3::new(0.0, 0.0, 0.0),
            Point3::new(10.0, 0.0, 0.0),
            Point3::new(5.0, height, 0.0),
        ];
        let query = Point3::new(5.0, 0.25 * height, 1.0);
        let found = closest_point_on_triangle(&query, &corners);
        assert_eq!(found.feature, Feature::Face);
        assert!((found.barycentric[2] - 0.25).abs() < 1e-3);
        assert!((found.distance_sq - 1.0).abs() < 1e-15);
    }
}
