//! The triangles near a place, for many questions that lie close together.

use super::bvh::Bvh;
use super::cones::ConeFilter;
use super::traverse::{All, OUT_OF_SIGHT, Walk, reach_of};
use super::wide::{Link, Node, Query, WIDTH};
use super::{NormalFilter, SurfaceHit};
use crate::geometry::Point3;

/// Triangles near a place that a filter lets through. Its room is used again.
#[derive(Debug, Clone, Default)]
pub struct Nearby {
    /// The leaves that hold them, four side by side.
    leaves: Vec<Leaves>,
    waiting: Vec<Link>,
}

/// Leaves of the tree with triangles near a place.
#[derive(Debug, Clone)]
pub(super) struct Leaves {
    /// Their boxes and numbers.
    pub(super) node: Node,
    /// Of each leaf a bit per triangle that counts.
    pub(super) marked: [u32; WIDTH],
}

impl Nearby {
    /// Adds a leaf, whose box is that of a child of `parent`.
    fn push(
        &mut self,
        number: &mut usize,
        parent: Option<(&Node, usize)>,
        (link, marked): (Link, u32),
    ) {
        let slot = *number % WIDTH;
        if slot == 0 {
            self.leaves.push(Leaves {
                node: Node::unused(),
                marked: [0; WIDTH],
            });
        }
        *number += 1;
        if let Some(leaves) = self.leaves.last_mut() {
            leaves.node.adopt(slot, link, parent);
            leaves.marked[slot] = marked;
        }
    }
}

impl Bvh {
    /// Collects the triangles within `radius` of `center` that `filter` lets through. False if the
    /// place is too far away for the tree, so that nothing can be told from `nearby`.
    pub fn collect(
        &self,
        center: &Point3,
        radius: f64,
        filter: &NormalFilter,
        nearby: &mut Nearby,
    ) -> bool {
        nearby.leaves.clear();
        nearby.waiting.clear();
        let local = self.frame.to_local(center);
        // NaN counts as out of sight.
        if !(local.amax() <= OUT_OF_SIGHT && radius.is_finite()) {
            return false;
        }
        let reach = reach_of(&local, (radius * self.frame.scale) as f32);
        let limit = glam::Vec4::splat(reach * reach);
        let query = Query::at(&local);
        let cones = ConeFilter::of(filter);
        let mut n_leaves = 0;
        let mut visit = |nearby: &mut Nearby, link: Link, parent: Option<(&Node, usize)>| {
            let leaf = match link.leaf() {
                Ok(leaf) => leaf,
                Err(_) => return nearby.waiting.push(link),
            };
            let pack = &self.tree.packs[leaf];
            // Those out of reach are passed over by their boxes later; asking for their distance costs more.
            let marked = self.admitted(filter, pack, pack.used());
            if marked != 0 {
                nearby.push(&mut n_leaves, parent, (link, marked));
            }
        };
        if let Some(root) = self.tree.root {
            visit(nearby, root, None);
        }
        while let Some(link) = nearby.waiting.pop() {
            let Err(node) = link.leaf() else { continue };
            let node = &self.tree.nodes[node];
            let near = node.distance_sq(&query).cmple(limit);
            let mut within = (near & node.cones.may_pass(&cones)).bitmask();
            while within != 0 {
                let slot = within.trailing_zeros() as usize;
                within &= within - 1;
                visit(nearby, node.child[slot], Some((node, slot)));
            }
        }
        true
    }

    /// The answer of [`super::ClosestPoint::closest`] with the filter of `nearby`, as long as the closest
    /// triangle was collected. A small `max_distance` makes it fast.
    pub fn closest_of(
        &self,
        nearby: &Nearby,
        query: &Point3,
        max_distance: f64,
    ) -> Option<SurfaceHit> {
        let local = self.frame.to_local(query);
        let exact = |triangle| self.exact(query, max_distance, triangle);
        let limit = max_distance * self.frame.scale;
        let mut walk = Walk::new(&self.tree, &local, limit, All, exact);
        let nearest = walk.run_over(&nearby.leaves);
        nearest.map(|nearest| SurfaceHit::on_triangle(nearest.id, nearest.found))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BruteForce, ClosestPoint};
    use super::*;
    use crate::geometry::{TriMesh, Vector3};

    /// A wavy sheet far from the origin with every fourth triangle turned over.
    fn sheet() -> TriMesh {
        let n = 40_u32;
        let node = |i: u32, j: u32| i * (n + 1) + j;
        let at = |i: u32, j: u32| {
            let (x, y) = (f64::from(i), f64::from(j));
            Point3::new(
                5000.0 + x,
                y - 300.0,
                3.0 * (0.4 * x).sin() * (0.3 * y).cos(),
            )
        };
        let nodes = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        let positions = nodes.map(|(i, j)| at(i, j)).collect();
        let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let mut triangles = Vec::new();
        for (i, j) in cells {
            let [a, b, c, d] = [
                node(i, j),
                node(i + 1, j),
                node(i + 1, j + 1),
                node(i, j + 1),
            ];
            triangles.push([a, b, c]);
            triangles.push(if (i + j) % 2 == 0 {
                [a, c, d]
            } else {
                [a, d, c]
            });
        }
        TriMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn answers_are_those_of_the_plain_loop() {
        let mesh = sheet();
        let tree = Bvh::build(mesh.clone());
        let plain = BruteForce::new(mesh);
        let mut nearby = Nearby::default();
        let mut n_found = 0;
        for k in 0..200 {
            let k = f64::from(k);
            let center = Point3::new(
                5020.0 + 24.0 * (1.3 * k).sin(),
                -280.0 + 24.0 * (2.1 * k).cos(),
                2.5 * (0.7 * k).sin(),
            );
            let filter = NormalFilter {
                direction: Vector3::new(0.3 * k.sin(), 0.2, 1.0).normalize(),
                min_cos: 0.6,
            };
            let Some(of_center) = plain.closest(&center, 6.0, None, Some(&filter)) else {
                continue;
            };
            let distance = of_center.distance_sq.sqrt();
            assert!(tree.collect(&center, distance + 2.0 * 1.5, &filter, &mut nearby));
            for i in 0..9 {
                let turn = f64::from(i);
                let query = center + Vector3::new(turn.cos(), turn.sin(), 0.2) * (turn / 6.0);
                let limit = (distance + (query - center).norm()) * (1.0 + 1e-12);
                let expected = plain.closest(&query, limit, None, Some(&filter));
                assert_eq!(tree.closest_of(&nearby, &query, limit), expected);
                n_found += usize::from(expected.is_some());
            }
        }
        assert!(n_found > 900, "{n_found}");
        let far = Point3::new(1e12, 0.0, 0.0);
        let filter = NormalFilter {
            direction: Vector3::z(),
            min_cos: 0.5,
        };
        assert!(!tree.collect(&far, 1.0, &filter, &mut nearby));
    }
}
