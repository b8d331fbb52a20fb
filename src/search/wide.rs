//! The tree itself: obvhs builds a binary tree, which is folded to nodes of four children whose
//! boxes lie side by side, with leaves of up to four items in the same manner. One query then
//! tests four boxes or four items with the instructions of one.
//!
//! Everything here is `f32` in a frame in which the items fill the cube −1 … 1. It only rules items
//! out; what remains is decided in `f64` by the caller.

use std::time::Duration;

use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

use crate::geometry::{Aabb, Point3, Vector3};

/// Items per leaf and children per node.
pub(super) const WIDTH: usize = 4;

/// Coordinates beyond this are farther than anything a query may compare.
pub(super) const FAR_AWAY: f32 = 1e18;

/// Shift and scale that lay the items into the cube −1 … 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalFrame {
    center: Point3,
    /// Local units per unit of length.
    pub(super) scale: f64,
}

impl LocalFrame {
    pub(super) fn around(aabb: &Aabb) -> Self {
        let half_extent = aabb.extents().amax() * 0.5;
        Self {
            center: aabb.center(),
            scale: 1.0 / half_extent.max(f64::MIN_POSITIVE),
        }
    }

    pub(super) fn to_local(self, point: &Point3) -> Vector3 {
        (point - self.center) * self.scale
    }
}

/// Four items that are tested together.
pub(super) trait Pack: Send + Sync {
    /// What an item is before packing.
    type Item;
    /// Packs one to four items with their indices.
    fn new(items: &[(u32, Self::Item)]) -> Self;
    /// Squared distance of each item from `query`; unused places are [`FAR_AWAY`].
    fn distance_sq(&self, query: &Query) -> Vec4;
    /// The items' indices.
    fn ids(&self) -> &[u32; WIDTH];
}

/// A query point, each coordinate repeated for the four places.
#[derive(Debug, Clone, Copy)]
pub(super) struct Query {
    pub(super) x: Vec4,
    pub(super) y: Vec4,
    pub(super) z: Vec4,
}

impl Query {
    pub(super) fn at(local: &Vector3) -> Self {
        Self {
            x: Vec4::splat(local.x as f32),
            y: Vec4::splat(local.y as f32),
            z: Vec4::splat(local.z as f32),
        }
    }
}

/// A node or a leaf: the number of either, leaves with the top bit set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link(pub(super) u32);

impl Link {
    const LEAF: u32 = 1 << 31;

    /// The leaf's number, or the node's as the error.
    pub(super) fn leaf(self) -> Result<usize, usize> {
        if self.0 & Self::LEAF != 0 {
            Ok((self.0 & !Self::LEAF) as usize)
        } else {
            Err(self.0 as usize)
        }
    }
}

/// Four children: their boxes, coordinate by coordinate, and where they are.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) min: [Vec4; 3],
    pub(super) max: [Vec4; 3],
    pub(super) child: [Link; WIDTH],
}

impl Node {
    /// No children: boxes that nothing is near to.
    fn unused() -> Self {
        Self {
            min: [Vec4::splat(FAR_AWAY); 3],
            max: [Vec4::splat(FAR_AWAY); 3],
            child: [Link(0); WIDTH],
        }
    }

    fn set(&mut self, slot: usize, aabb: &Box32) {
        for axis in 0..3 {
            self.min[axis][slot] = aabb.min[axis];
            self.max[axis][slot] = aabb.max[axis];
        }
    }

    /// False for a place without a child.
    pub(super) fn is_used(&self, slot: usize) -> bool {
        self.min[0][slot] < FAR_AWAY
    }

    /// Squared distance of each child's box from `query`.
    #[inline]
    pub(super) fn distance_sq(&self, query: &Query) -> Vec4 {
        let gap =
            |axis: usize, q: Vec4| (self.min[axis] - q).max(q - self.max[axis]).max(Vec4::ZERO);
        let (x, y, z) = (gap(0, query.x), gap(1, query.y), gap(2, query.z));
        x * x + y * y + z * z
    }
}

/// A tree of nodes with four children over packs of four items.
#[derive(Debug, Clone)]
pub(super) struct WideTree<P> {
    pub(super) root: Option<Link>,
    pub(super) nodes: Vec<Node>,
    pub(super) packs: Vec<P>,
    /// How many entries a depth-first walk can have waiting at once.
    pub(super) stack_size: usize,
}

impl<P: Pack> WideTree<P> {
    /// Builds the tree over items given by their local boxes; `item` makes what is packed.
    pub(super) fn build(boxes: &[Box32], item: impl Fn(u32) -> P::Item) -> Self {
        let mut tree = Self {
            root: None,
            nodes: Vec::new(),
            packs: Vec::new(),
            stack_size: 0,
        };
        if boxes.is_empty() {
            return tree;
        }
        let params = BvhBuildParams {
            max_prims_per_leaf: 1,
            ..BvhBuildParams::medium_build()
        };
        let binary = build_bvh2(boxes, params, &mut Duration::default());
        let sizes = subtree_sizes(&binary);
        tree.fold(&binary, &sizes, item);
        tree
    }

    /// Folds the binary tree from the root down, depth first, so that what is visited together
    /// lies together.
    fn fold(&mut self, binary: &Bvh2, sizes: &[u32], item: impl Fn(u32) -> P::Item) {
        struct Waiting {
            binary_node: usize,
            parent: Option<(usize, usize)>,
            depth: usize,
        }
        let mut waiting = vec![Waiting {
            binary_node: 0,
            parent: None,
            depth: 1,
        }];
        while let Some(next) = waiting.pop() {
            let is_leaf = sizes[next.binary_node] as usize <= WIDTH;
            let link = if is_leaf {
                let items: Vec<_> = items_below(binary, next.binary_node)
                    .into_iter()
                    .map(|id| (id, item(id)))
                    .collect();
                self.packs.push(P::new(&items));
                Link((self.packs.len() - 1) as u32 | Link::LEAF)
            } else {
                let number = self.nodes.len();
                let mut node = Node::unused();
                let children = children_to_adopt(binary, sizes, next.binary_node);
                for (slot, &child) in children.iter().enumerate().rev() {
                    node.set(slot, binary.nodes[child].aabb());
                    waiting.push(Waiting {
                        binary_node: child,
                        parent: Some((number, slot)),
                        depth: next.depth + 1,
                    });
                }
                self.nodes.push(node);
                Link(number as u32)
            };
            match next.parent {
                Some((parent, slot)) => self.nodes[parent].child[slot] = link,
                None => self.root = Some(link),
            }
            self.stack_size = self.stack_size.max(next.depth * (WIDTH - 1) + 1);
        }
    }
}

/// Number of items below every node of the binary tree.
fn subtree_sizes(binary: &Bvh2) -> Vec<u32> {
    let mut order = vec![0usize];
    let mut at = 0;
    while at < order.len() {
        let node = &binary.nodes[order[at]];
        if !node.is_leaf() {
            let first = node.first_index as usize;
            order.extend([first, first + 1]);
        }
        at += 1;
    }
    let mut sizes = vec![0; binary.nodes.len()];
    for &index in order.iter().rev() {
        let node = &binary.nodes[index];
        let first = node.first_index as usize;
        sizes[index] = if node.is_leaf() {
            node.prim_count
        } else {
            sizes[first] + sizes[first + 1]
        };
    }
    sizes
}

/// Up to four nodes that together hold what `node` holds: its children, the largest of them opened
/// again and again.
fn children_to_adopt(binary: &Bvh2, sizes: &[u32], node: usize) -> Vec<usize> {
    let first = binary.nodes[node].first_index as usize;
    let mut children = vec![first, first + 1];
    while children.len() < WIDTH {
        let area = |&slot: &usize| binary.nodes[children[slot]].aabb().half_area();
        let largest = (0..children.len())
            .filter(|&slot| sizes[children[slot]] as usize > WIDTH)
            .max_by(|a, b| area(a).total_cmp(&area(b)));
        let Some(slot) = largest else { break };
        let first = binary.nodes[children[slot]].first_index as usize;
        children[slot] = first;
        children.insert(slot + 1, first + 1);
    }
    children
}

/// Indices of the items below a node, sorted.
fn items_below(binary: &Bvh2, node: usize) -> Vec<u32> {
    let mut found = Vec::with_capacity(WIDTH);
    let mut waiting = vec![node];
    while let Some(index) = waiting.pop() {
        let node = &binary.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            let range = first..first + node.prim_count as usize;
            found.extend_from_slice(&binary.primitive_indices[range]);
        } else {
            waiting.extend([first, first + 1]);
        }
    }
    found.sort_unstable();
    found
}

/// The smallest `f32` box around local points, widened to the next number, so that rounding cuts
/// nothing off.
pub(super) fn box_around(points: &[Vector3]) -> Box32 {
    let mut min = Vec3A::INFINITY;
    let mut max = Vec3A::NEG_INFINITY;
    for point in points {
        let rounded = Vec3A::new(point.x as f32, point.y as f32, point.z as f32);
        min = min.min(rounded);
        max = max.max(rounded);
    }
    let below = |x: f32| x.next_down();
    let above = |x: f32| x.next_up();
    Box32::new(
        Vec3A::new(below(min.x), below(min.y), below(min.z)),
        Vec3A::new(above(max.x), above(max.y), above(max.z)),
    )
}
