//! Holes of two meshes that must coincide: what distinguishes a pose from its twin when all else is equal.

use crate::geometry::{Point3, Similarity};
use crate::registration::surface::Surface;
use crate::search::PointTree;

/// Points on the borders of holes that poses are compared with.
const N_POINTS: usize = 600;
/// The border of a hole counts as there within this share of the mean edge length: two meshes of one
/// hole cut its corners differently.
const TOLERANCE: f64 = 0.5;
/// Points that the other mesh's borders are asked at lie this share of the tolerance apart.
const SPACING: f64 = 0.5;

/// The borders of a mesh's holes as points in its own frame.
pub(crate) struct HoleBorders {
    /// Evenly spread over the length.
    samples: Vec<Point3>,
    /// The same borders more densely, to be asked.
    dense: PointTree,
}

impl HoleBorders {
    /// Holes of `surface`; `edge_length` is that of the pair. O(border edges).
    pub(crate) fn new(surface: &Surface, edge_length: f64) -> Self {
        // The trim need not be shared by two meshes of one sheet.
        let holes = surface.borders().iter().filter(|border| border.is_hole);
        let segments: Vec<[Point3; 2]> = holes
            .flat_map(|hole| hole.segments(surface.mesh()))
            .collect();
        let length: f64 = segments.iter().map(|[a, b]| (b - a).norm()).sum();
        let spacing = SPACING * TOLERANCE * edge_length;
        // Borders that are far longer than the mesh is fine would only cost memory.
        let spacing = spacing.max(length / 200_000.0);
        Self {
            samples: along(&segments, length / N_POINTS as f64),
            dense: PointTree::build(along(&segments, spacing)),
        }
    }

    /// Share of the length of these borders that has a border of `other` beside it under a pose, 0 … 1;
    /// `None` without holes.
    pub(crate) fn share_on(
        &self,
        other: &Self,
        other_from_self: &Similarity,
        edge_length: f64,
    ) -> Option<f64> {
        let reach = TOLERANCE * edge_length;
        let is_there = |point: &&Point3| {
            let moved = other_from_self.apply(point);
            other.dense.nearest(&moved, reach, None).is_some()
        };
        let n = self.samples.len();
        (n > 0).then(|| self.samples.iter().filter(is_there).count() as f64 / n as f64)
    }
}

/// Points every `spacing` along the segments, in their order.
fn along(segments: &[[Point3; 2]], spacing: f64) -> Vec<Point3> {
    let mut points = Vec::new();
    if spacing.is_nan() || spacing <= 0.0 {
        return points;
    }
    let mut until_next = 0.5 * spacing;
    for [a, b] in segments {
        let length = (b - a).norm();
        let mut at = until_next;
        while at < length {
            points.push(a + (b - a) * (at / length));
            at += spacing;
        }
        until_next = at - length;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{TriMesh, Vector3};

    /// A sheet of 10 × 10 squares without the square in column `hole`, row 2.
    fn sheet(hole: usize) -> Surface {
        let points = (0..121).map(|i| Point3::new((i % 11) as f64, (i / 11) as f64, 0.0));
        let cells = (0..100).map(|i| (i % 10, i / 10));
        let kept = cells.filter(|&cell| cell != (hole, 2));
        let triangles = kept.flat_map(|(x, y)| {
            let a = (y * 11 + x) as u32;
            [[a, a + 1, a + 12], [a, a + 12, a + 11]]
        });
        let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    }

    #[test]
    fn a_hole_elsewhere_is_not_there_and_the_trim_does_not_count() {
        let (left, right) = (sheet(2), sheet(7));
        let (a, b) = (HoleBorders::new(&left, 1.0), HoleBorders::new(&right, 1.0));
        let still = Similarity::identity();
        assert_eq!(a.share_on(&a, &still, 1.0), Some(1.0));
        assert_eq!(a.share_on(&b, &still, 1.0), Some(0.0));
        let mut shifted = still;
        shifted.translation = Vector3::new(5.0, 0.0, 0.0);
        assert_eq!(a.share_on(&b, &shifted, 1.0), Some(1.0));
        let whole = HoleBorders::new(&sheet(99), 1.0);
        assert_eq!(whole.share_on(&a, &still, 1.0), None);
        assert_eq!(a.share_on(&whole, &still, 1.0), Some(0.0));
    }
}
