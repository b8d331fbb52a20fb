//! What the tree over a mesh is built of: mostly its triangles as they are. Where many of them are long and lie aslant,
//! as the pages of a book or the rays of a fan, the box around each holds much that is not of it, and a question would
//! enter nearly all: such triangles are in the tree in pieces, each with its own box. Where many lie exactly on each
//! other, none of which a box could tell from the next, the first of them stands for all, as it does in every answer.

use std::collections::HashSet;

use obvhs::aabb::Aabb as Box32;

use super::wide::{LocalFrame, box_around};
use crate::geometry::chunks::for_chunks;
use crate::geometry::{TriMesh, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Smaller meshes are asked quickly whatever their triangles are like.
const LEAST: usize = 256;
/// Triangles that are looked at to tell what the mesh is like.
const N_LOOKED_AT: usize = 1024;
/// A triangle lies aslant in its box if half the box's surface is so many times its area. Of one with equal sides it
/// is at most five times.
const ASLANT: f64 = 64.0;
/// A mesh has many such triangles if they are at least one of so many that are looked at.
const MANY: usize = 16;
/// Then triangles are cut into pieces, of whose boxes all together the same is about so many times …
const FITTING: f64 = 8.0;
/// … but into no more than so many each, and in all no more than so many beyond the triangles.
const MOST_PIECES: usize = 16;
const MOST_BEYOND: usize = 1 << 20;

/// The items of a tree that are not simply the triangles of its mesh.
pub(super) struct TreeItems {
    /// The triangle that each item is, or is a piece of.
    pub(super) triangle_of: Vec<u32>,
    boxes: Vec<Box32>,
}

impl TreeItems {
    /// `None` where each triangle is an item, as in most meshes. O(triangles).
    pub(super) fn of(
        mesh: &TriMesh,
        frame: &LocalFrame,
        monitor: &Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let n = mesh.n_triangles();
        if n < LEAST {
            return Ok(None);
        }
        let corners = |t: usize| mesh.corners(t).map(|p| frame.to_local(&p));
        let looked_at = (0..n).step_by(n.div_ceil(N_LOOKED_AT));
        let n_looked_at = looked_at.len();
        let shares = looked_at.clone().map(|t| share_of_box(&corners(t)));
        let n_aslant = shares.filter(|share| *share > ASLANT).count();
        let places: HashSet<[u64; 9]> = looked_at.map(|t| place(mesh, t)).collect();
        let is_repeated = places.len() < n_looked_at;
        let are_many_aslant = n_aslant * MANY >= n_looked_at;
        if !(is_repeated || are_many_aslant) {
            return Ok(None);
        }
        let mut kept = Vec::with_capacity(n);
        let mut places = HashSet::new();
        let n_fitting = |t: u32| (share_of_box(&corners(t as usize)) / FITTING).ceil() as usize;
        let mut n_cut = 0;
        for_chunks(n, monitor, |range| {
            let is_first = |&t: &usize| !is_repeated || places.insert(place(mesh, t));
            for triangle in range.filter(is_first) {
                let triangle = triangle as u32;
                n_cut += usize::from(are_many_aslant && n_fitting(triangle) > 1);
                kept.push(triangle);
            }
        })?;
        let most_pieces = match n_cut {
            0 => 1,
            _ => MOST_PIECES.min(1 + MOST_BEYOND / n_cut),
        };
        let mut items = Self {
            triangle_of: Vec::with_capacity(kept.len() + n_cut),
            boxes: Vec::with_capacity(kept.len() + n_cut),
        };
        for_chunks(kept.len(), monitor, |range| {
            for &triangle in &kept[range] {
                let corners = corners(triangle as usize);
                match n_fitting(triangle).min(most_pieces) {
                    0 | 1 => items.boxes.push(box_around(&corners)),
                    n_pieces => items.boxes.extend(boxes_along(&corners, n_pieces)),
                }
                items.triangle_of.resize(items.boxes.len(), triangle);
            }
        })?;
        Ok(Some(items))
    }

    pub(super) fn len(&self) -> usize {
        self.triangle_of.len()
    }

    /// The box of an item in the frame of the tree.
    pub(super) fn box_of(&self, item: u32) -> Box32 {
        self.boxes[item as usize]
    }
}

/// Where a triangle lies, to the last bit, and which way round it goes.
fn place(mesh: &TriMesh, triangle: usize) -> [u64; 9] {
    let corners = mesh.corners(triangle);
    std::array::from_fn(|i| corners[i / 3][i % 3].to_bits())
}

/// Half the surface of the box around a triangle, in areas of the triangle; 0 of one without area.
fn share_of_box([a, b, c]: &[Vector3; 3]) -> f64 {
    let area = 0.5 * (b - a).cross(&(c - a)).norm();
    let sides = a.sup(b).sup(c) - a.inf(b).inf(c);
    let around = sides.x * sides.y + sides.y * sides.z + sides.z * sides.x;
    if area > 0.0 { around / area } else { 0.0 }
}

/// The boxes around so many pieces of a triangle that has an area, cut across its longest edge.
fn boxes_along(corners: &[Vector3; 3], n_pieces: usize) -> impl Iterator<Item = Box32> {
    let length_sq = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm_squared();
    let longer = |best: usize, i: usize| {
        if length_sq(i) > length_sq(best) {
            i
        } else {
            best
        }
    };
    let from = (1..3).fold(0, longer);
    let [a, b, c] = [0, 1, 2].map(|i| corners[(from + i) % 3]);
    let along = b - a;
    let at_c = ((c - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    // Across the longest edge from the point at a share of it: the point on the other two.
    let opposite = move |share: f64| {
        if share < at_c {
            a + (c - a) * (share / at_c)
        } else if share > at_c {
            c + (b - c) * ((share - at_c) / (1.0 - at_c))
        } else {
            c
        }
    };
    (0..n_pieces).map(move |piece| {
        let [begin, end] = [piece, piece + 1].map(|i| i as f64 / n_pieces as f64);
        let tip = opposite(at_c.clamp(begin, end));
        box_around(&[
            a + along * begin,
            a + along * end,
            opposite(begin),
            opposite(end),
            tip,
        ])
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::{BruteForce, Bvh, ClosestPoint, NormalFilter};
    use super::*;
    use crate::geometry::Point3;

    /// Pages that share the edge from 0 to 10 on the z axis, all around it.
    fn book(n: u32) -> TriMesh {
        let mut positions = vec![Point3::origin(), Point3::new(0.0, 0.0, 10.0)];
        positions.extend((0..n).map(|i| {
            let angle = TAU * f64::from(i) / f64::from(n);
            Point3::new(1000.0 * angle.cos(), 1000.0 * angle.sin(), 5.0)
        }));
        let triangles = (0..n).map(|i| [0, 1, 2 + i]).collect();
        TriMesh::new(positions, triangles).unwrap()
    }

    /// The same triangle again and again, each with its own corners; every third goes the other way round.
    fn pile(n: u32) -> TriMesh {
        let of_one = [[0.0, 0.0, 1.0], [10.0, 0.0, 2.0], [0.0, 10.0, 3.0]];
        let positions = (0..n).flat_map(|_| of_one.map(Point3::from)).collect();
        let triangles = (0..n).map(|i| match i % 3 {
            0 => [3 * i, 3 * i + 2, 3 * i + 1],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        });
        TriMesh::new(positions, triangles.collect()).unwrap()
    }

    fn items_of(mesh: &TriMesh) -> Option<TreeItems> {
        let frame = LocalFrame::around(&mesh.aabb());
        TreeItems::of(mesh, &frame, &Monitor::silent()).unwrap()
    }

    #[test]
    fn answers_do_not_depend_on_what_the_tree_is_built_of() {
        for mesh in [book(600), pile(600)] {
            let tree = Bvh::build(mesh.clone());
            let plain = BruteForce::new(mesh);
            for k in 0..300 {
                let k = f64::from(k);
                let reach = 3.0 + 2.0 * k;
                let query = Point3::new(reach * (1.3 * k).sin(), reach * (1.3 * k).cos(), 0.03 * k);
                let direction = Vector3::new(k.sin(), k.cos(), 0.3).normalize();
                let filter = NormalFilter {
                    direction,
                    min_cos: 0.2,
                };
                for filter in [None, Some(&filter)] {
                    for hint in [None, Some(599)] {
                        assert_eq!(
                            tree.closest(&query, 700.0, hint, filter),
                            plain.closest(&query, 700.0, None, filter)
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn boxes_of_pages_hold_little_else_and_a_pile_is_one_triangle_of_each_side() {
        let mesh = book(2000);
        let whole: f64 = (0..2000).map(|t| box_around_triangle(&mesh, t)).sum();
        let items = items_of(&mesh).unwrap();
        assert!(items.len() <= MOST_PIECES * 2000);
        let own: f64 = (0..items.len() as u32)
            .map(|item| f64::from(items.box_of(item).half_area()))
            .sum();
        assert!(own < 0.25 * whole, "{own} of {whole}");
        let pile = items_of(&pile(2000)).unwrap();
        assert_eq!(pile.triangle_of, [0, 1]);
    }

    fn box_around_triangle(mesh: &TriMesh, triangle: usize) -> f64 {
        let frame = LocalFrame::around(&mesh.aabb());
        let corners = mesh.corners(triangle).map(|p| frame.to_local(&p));
        f64::from(box_around(&corners).half_area())
    }

    #[test]
    fn triangles_of_usual_shape_are_the_items_themselves() {
        let at = |i: u32| Point3::new(f64::from(i % 21), f64::from(i / 21), f64::from(i % 7));
        let positions = (0..21 * 21).map(at).collect();
        let cells = (0..400_u32).map(|cell| cell / 20 * 21 + cell % 20);
        let triangles = cells.flat_map(|a| [[a, a + 1, a + 22], [a, a + 22, a + 21]]);
        let mesh = TriMesh::new(positions, triangles.collect()).unwrap();
        assert!(items_of(&mesh).is_none());
    }
}
