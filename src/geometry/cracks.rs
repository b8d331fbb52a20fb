//! Cracks of no width: where a mesh was refined in some places, nodes of the small elements hang on the edges
//! of the large ones, and neither side shares its edges with the other.

use super::chunks::map_chunks;
use super::{Point3, Topology, TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Hanging nodes lie at most this share of the long edge beside it: in the middle of an arc of 90° a node of
/// the small elements lies a fifth of the chord above it, and noise adds to that. A slot has other nodes at its ends,
/// and more than one edge along its sides.
const BESIDE: f64 = 0.3;
/// In the plane of the triangle on the long edge they lie much closer to it: what curves the sheet takes them out
/// of the plane, while the corner of a hole that a reduction left three edges lies within it.
const WITHIN_PLANE: f64 = 0.15;
/// Short edges beside a long one: elements are halved once or twice, rarely four times.
const MOST_SHORT: usize = 16;
/// Edges with one triangle around a node, of which more belong to no sheet that was refined.
const MOST_AROUND: usize = 16;
/// Across a crack the triangles lie on different sides of it. Cosine of 60°: the sheet may be folded there, and
/// two sheets that lie on each other stay two.
const SAME_SIDE: f64 = 0.5;

/// Those of `single`, the edges of a mesh with one triangle in rising order, that are no side of a crack.
/// O(edges with one triangle · log of them).
pub(crate) fn without_cracks(
    mesh: &TriMesh,
    topology: &Topology,
    mut single: Vec<u32>,
    monitor: &Monitor,
) -> Result<Vec<u32>, Cancelled> {
    let sides = SingleEdges::of(mesh, topology, &single);
    let cracks = map_chunks(single.len(), monitor, |i| sides.crack_at(single[i]))?;
    let mut closed: Vec<u32> = cracks.into_iter().flatten().collect();
    closed.sort_unstable();
    single.retain(|edge| closed.binary_search(edge).is_err());
    Ok(single)
}

/// The edges with one triangle and how to walk along them.
struct SingleEdges<'a> {
    mesh: &'a TriMesh,
    topology: &'a Topology,
    /// Each edge at both of its ends, as (end, edge), sorted.
    at_ends: Vec<(u32, u32)>,
}

/// An edge that shorter ones may lie along.
struct LongEdge {
    start: Point3,
    along: Vector3,
    triangle: u32,
    /// Unit direction from the edge into its triangle.
    inwards: Vector3,
}

impl<'a> SingleEdges<'a> {
    fn of(mesh: &'a TriMesh, topology: &'a Topology, single: &[u32]) -> Self {
        let ends = |&edge: &u32| topology.edges[edge as usize].map(|end| (end, edge));
        let mut at_ends: Vec<(u32, u32)> = single.iter().flat_map(ends).collect();
        at_ends.sort_unstable();
        Self {
            mesh,
            topology,
            at_ends,
        }
    }

    /// The edge with the shorter ones that lie along it from end to end; nothing where there are none.
    fn crack_at(&self, edge: u32) -> Vec<u32> {
        let [u, v] = self.topology.edges[edge as usize];
        // From one end the walk may turn into another crack.
        self.chain(edge, [u, v])
            .or_else(|| self.chain(edge, [v, u]))
            .unwrap_or_default()
    }

    fn chain(&self, edge: u32, [from, to]: [u32; 2]) -> Option<Vec<u32>> {
        let [start, end] = [from, to].map(|vertex| self.mesh.positions()[vertex as usize]);
        let triangle = self.triangle_of(edge);
        let along = end - start;
        let long = LongEdge {
            start,
            along,
            triangle,
            inwards: self.inwards(triangle, start, along)?,
        };
        let mut chain = vec![edge];
        let (mut at, mut reached) = (from, 0.0);
        while at != to {
            if chain.len() > MOST_SHORT {
                return None;
            }
            let (next, vertex, place) = self.next(&long, edge, (at, reached), to)?;
            chain.push(next);
            (at, reached) = (vertex, place);
        }
        Some(chain)
    }

    /// The edge that leads on from a vertex beside a long edge, with its other end and how far along that
    /// lies, as a share: of several the one that stays closest.
    fn next(
        &self,
        long: &LongEdge,
        itself: u32,
        (at, reached): (u32, f64),
        to: u32,
    ) -> Option<(u32, u32, f64)> {
        let first = self.at_ends.partition_point(|&(end, _)| end < at);
        let around = self.at_ends[first..].iter();
        let around: Vec<u32> = around
            .take_while(|&&(end, _)| end == at)
            .take(MOST_AROUND + 1)
            .map(|&(_, edge)| edge)
            .filter(|&edge| edge != itself)
            .collect();
        if around.len() > MOST_AROUND {
            return None;
        }
        let length_sq = long.along.norm_squared();
        let candidates = around.into_iter().filter_map(|edge| {
            let [u, v] = self.topology.edges[edge as usize];
            let vertex = if u == at { v } else { u };
            let arm = self.mesh.positions()[vertex as usize] - long.start;
            let place = if vertex == to {
                1.0
            } else {
                arm.dot(&long.along) / length_sq
            };
            let off = arm - long.along * place;
            let beside_sq = off.norm_squared();
            let leads_on = place > reached && (place < 1.0 || vertex == to);
            let is_beside = leads_on
                && beside_sq <= BESIDE * BESIDE * length_sq
                && off.dot(&long.inwards).powi(2) <= WITHIN_PLANE * WITHIN_PLANE * length_sq;
            (is_beside && self.is_across(long, edge)).then_some((edge, vertex, place, beside_sq))
        });
        candidates
            .min_by(|a, b| a.3.total_cmp(&b.3))
            .map(|(edge, vertex, place, _)| (edge, vertex, place))
    }

    /// Whether the triangle of a short edge lies on the other side of the long one.
    fn is_across(&self, long: &LongEdge, edge: u32) -> bool {
        let triangle = self.triangle_of(edge);
        let start = self.mesh.positions()[self.topology.edges[edge as usize][0] as usize];
        triangle != long.triangle
            && self
                .inwards(triangle, start, long.along)
                .is_some_and(|inwards| inwards.dot(&long.inwards) < SAME_SIDE)
    }

    fn triangle_of(&self, edge: u32) -> u32 {
        self.topology.triangles_of(edge as usize)[0]
    }

    /// Unit direction across `along` from a point of an edge to the middle of its triangle; `None` without area.
    fn inwards(&self, triangle: u32, point: Point3, along: Vector3) -> Option<Vector3> {
        let [a, b, c] = self.mesh.corners(triangle as usize);
        let arm = Point3::from((a.coords + b.coords + c.coords) / 3.0) - point;
        let along = along.try_normalize(0.0)?;
        (arm - along * arm.dot(&along)).try_normalize(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Border, BorderEdges};
    use super::*;

    /// A plate of `n` by `n` cells of two millimetres whose height is `height(x)`. Cells chosen by `is_fine` are
    /// cut into four, those by `is_hole` left out.
    fn plate(
        n: u32,
        height: impl Fn(f64) -> f64,
        is_fine: impl Fn(u32, u32) -> bool,
        is_hole: impl Fn(u32, u32) -> bool,
    ) -> TriMesh {
        let row = 2 * n + 1;
        let points = (0..row * row).map(|i| {
            let (x, y) = (f64::from(i % row), f64::from(i / row));
            Point3::new(x, y, height(x))
        });
        let mut triangles = Vec::new();
        let mut quad = |x: u32, y: u32, size: u32| {
            let a = y * row + x;
            let up = a + size * row;
            triangles.extend([[a, a + size, up + size], [a, up + size, up]]);
        };
        for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
            if is_hole(x, y) {
                continue;
            }
            if is_fine(x, y) {
                for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    quad(2 * x + i, 2 * y + j, 1);
                }
            } else {
                quad(2 * x, 2 * y, 2);
            }
        }
        TriMesh::new(points.collect(), triangles).unwrap()
    }

    fn borders(mesh: &TriMesh) -> Vec<Border> {
        let edges = BorderEdges::of(mesh, &Topology::of(mesh));
        Border::all(mesh, &edges, &mesh.vertex_normals())
    }

    #[test]
    fn cracks_are_no_borders_and_leave_the_holes_that_they_touch_as_they_are() {
        let is_hole = |x: u32, y: u32| (4..6).contains(&x) && (4..6).contains(&y);
        // Cracks run from the border of the hole to the outline, and around an island.
        let is_fine = |x: u32, y: u32| x < 5 && y > 3 || x == 8 && y == 2;
        for bent in [0.0, 0.02] {
            // The chord over two millimetres leaves the node in its middle aside.
            let height = |x: f64| bent * (x - 10.0) * (x - 10.0);
            let whole = plate(10, height, |_, _| true, is_hole);
            let adaptive = plate(10, height, is_fine, is_hole);
            let (whole, found) = (borders(&whole), borders(&adaptive));
            assert_eq!(found.len(), 2, "{bent}");
            for (a, b) in whole.iter().zip(&found) {
                assert_eq!(a.is_hole, b.is_hole);
                assert!((a.length - b.length).abs() < 0.02 * a.length);
                assert!((a.center - b.center).norm() < 0.1);
            }
            assert!(found[1].is_hole);
        }
    }

    #[test]
    fn elements_that_were_halved_twice_leave_no_borders() {
        // Along the edge from 0 to 1 the other side has four.
        let upper = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
        let lower = (0..5).map(|i| [2.0 * f64::from(i), -2.0]);
        let hanging = (1..4).map(|i| [2.0 * f64::from(i), 0.0]);
        let points = upper.into_iter().chain(hanging).chain(lower);
        let points: Vec<Point3> = points.map(|[x, y]| Point3::new(x, y, 0.0)).collect();
        let top = [0, 4, 5, 6, 1];
        let below = |i: usize| 7 + i as u32;
        let cells = (0..4).flat_map(|i| {
            let (a, b) = (below(i), below(i + 1));
            [[a, b, top[i + 1]], [a, top[i + 1], top[i]]]
        });
        let triangles = [[0, 1, 2], [0, 2, 3]].into_iter().chain(cells).collect();
        let found = borders(&TriMesh::new(points, triangles).unwrap());
        assert_eq!(found.len(), 1);
        assert!((found[0].length - 36.0).abs() < 1e-12);
    }

    /// A sheet of three cells side by side and one millimetre of height each, cut open between them: `up` the
    /// upper edge of the slit bulges, which has a node in its middle; the lower one has none.
    fn slit(up: f64) -> TriMesh {
        let points = [
            (0.0, 0.0),
            (10.0, 0.0),
            (20.0, 0.0),
            (30.0, 0.0),
            (0.0, 8.0),
            (10.0, 8.0),
            (15.0, 8.0 + up),
            (20.0, 8.0),
            (30.0, 8.0),
            (0.0, 16.0),
            (10.0, 16.0),
            (15.0, 16.0),
            (20.0, 16.0),
            (30.0, 16.0),
        ];
        let points = points.map(|(x, y)| Point3::new(x, y, 0.0));
        let quads = [
            [0, 1, 5, 4],
            [1, 2, 7, 5],
            [2, 3, 8, 7],
            [4, 5, 10, 9],
            [5, 6, 11, 10],
            [6, 7, 12, 11],
            [7, 8, 13, 12],
        ];
        let triangles = quads
            .into_iter()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        TriMesh::new(points.to_vec(), triangles.collect()).unwrap()
    }

    #[test]
    fn a_narrow_slot_stays_open() {
        assert_eq!(borders(&slit(0.0)).len(), 1);
        assert_eq!(borders(&slit(1.4)).len(), 1);
        assert_eq!(borders(&slit(1.6)).len(), 2);
        let open = borders(&slit(3.5));
        assert_eq!(open.len(), 2);
        assert!(open[1].is_hole);
    }

    #[test]
    fn two_sheets_that_lie_on_each_other_stay_two() {
        // The second sheet shares two corners of the first and has a node between them.
        let points = [
            (0.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (1.0, 2.0, 0.0),
            (1.0, 0.0, 0.1),
            (1.0, 2.0, 0.4),
        ];
        let points = points.map(|(x, y, z)| Point3::new(x, y, z)).to_vec();
        let mesh = TriMesh::new(points, vec![[0, 1, 2], [0, 3, 4], [3, 1, 4]]).unwrap();
        let topology = Topology::of(&mesh);
        assert_eq!(topology.border_edges().count(), 7);
    }
}
