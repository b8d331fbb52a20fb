//! The tree itself: binary trees, built by obvhs over pieces of the items, are folded to nodes of four
//! children whose boxes lie side by side, with leaves of up to four items in the same manner. One query
//! then tests four boxes or four items at once.
//!
//! Everything here is `f32` in a frame in which the items fill the cube −1 … 1. It only rules items
//! out; what remains is decided in `f64` by the caller.

use std::time::Duration;

use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;

use super::cones::Cones;
use super::pieces::{Cut, cut_to_pieces};
use crate::geometry::chunks::map_chunks;
use crate::geometry::{Aabb, Point3, Vector3};
use crate::monitor::{Cancelled, Monitor};

/// Items per leaf and children per node. Eight children were measured slower without a hint (too
/// many to sort while nothing is ruled out) and no faster with one.
pub(super) const WIDTH: usize = 4;

/// Coordinates beyond this are farther than anything a query may compare.
pub(super) const FAR_AWAY: f32 = 1e18;

/// Shift and scale that lay the items into the cube −1 … 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalFrame {
    pub(super) center: Point3,
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
    /// Packs one to four items, given by their indices.
    fn new(ids: &[u32], item: &impl Fn(u32) -> Self::Item) -> Self;
    /// Squared distance of each item from `query`; unused places are [`FAR_AWAY`].
    fn distance_sq(&self, query: &Query) -> Vec4;
    /// The items' indices.
    fn ids(&self) -> &[u32; WIDTH];

    /// The same, to be changed.
    fn ids_mut(&mut self) -> &mut [u32; WIDTH];
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

/// Four children: their boxes, coordinate by coordinate, where they are, and the cones of their normals.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Node {
    min: [Vec4; 3],
    max: [Vec4; 3],
    pub(super) child: [Link; WIDTH],
    pub(super) cones: Cones,
}

impl Node {
    /// No children: boxes that nothing is near to.
    pub(super) fn unused() -> Self {
        Self {
            min: [Vec4::splat(FAR_AWAY); 3],
            max: [Vec4::splat(FAR_AWAY); 3],
            child: [Link(0); WIDTH],
            cones: Cones::of_all_directions(),
        }
    }

    fn set(&mut self, slot: usize, aabb: &Box32) {
        for axis in 0..3 {
            self.min[axis][slot] = aabb.min[axis];
            self.max[axis][slot] = aabb.max[axis];
        }
    }

    /// Takes a child of another node over with its box; a child of none has no bounds.
    pub(super) fn adopt(&mut self, slot: usize, link: Link, parent: Option<(&Self, usize)>) {
        for axis in 0..3 {
            let bounds = parent.map_or((-FAR_AWAY, FAR_AWAY), |(parent, from)| {
                (parent.min[axis][from], parent.max[axis][from])
            });
            (self.min[axis][slot], self.max[axis][slot]) = bounds;
        }
        if let Some((parent, from)) = parent {
            self.cones.copy(slot, &parent.cones, from);
        }
        self.child[slot] = link;
    }

    /// Smallest and largest coordinates of the children's boxes on an axis. A place without a child has
    /// a box at [`FAR_AWAY`].
    pub(super) fn slabs(&self, axis: usize) -> [Vec4; 2] {
        [self.min[axis], self.max[axis]]
    }

    /// Bit per place that has a child.
    pub(super) fn used(&self) -> u32 {
        self.min[0].cmplt(Vec4::splat(FAR_AWAY)).bitmask()
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
    /// Builds the tree over items `0..n`: `box_of` gives their local boxes, `item` what is packed.
    /// Asks `monitor` once per piece of the items.
    pub(super) fn build(
        n: usize,
        box_of: impl Fn(u32) -> Box32 + Sync,
        item: impl Fn(u32) -> P::Item + Sync,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut tree = Self {
            root: None,
            nodes: Vec::new(),
            packs: Vec::new(),
            stack_size: 0,
        };
        if n == 0 {
            return Ok(tree);
        }
        let cut = cut_to_pieces(n, &box_of, monitor)?;
        let mut pieces = Vec::new();
        cut.pieces(&mut pieces);
        let folded: Vec<Folded> = pieces
            .into_par_iter()
            .map(|ids| {
                monitor.check()?;
                Ok(Folded::of(ids, &box_of))
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut leaves = Vec::new();
        let mut joined = folded.into_iter();
        let root = tree.join(&cut, &mut joined, &mut leaves, (1, monitor))?;
        tree.root = Some(root.link);
        tree.packs = map_chunks(leaves.len(), monitor, |leaf| {
            P::new(leaves[leaf].as_slice(), &item)
        })?;
        Ok(tree)
    }

    /// Lays the nodes of all pieces one after another, with the nodes that tell the pieces apart
    /// before them.
    fn join(
        &mut self,
        cut: &Cut,
        folded: &mut impl Iterator<Item = Folded>,
        leaves: &mut Vec<Few>,
        (depth, monitor): (usize, &Monitor),
    ) -> Result<Joined, Cancelled> {
        monitor.check()?;
        let parts = match cut {
            Cut::Piece(_) => {
                let piece = folded.next().expect("each piece was folded");
                return Ok(self.append(piece, leaves, depth));
            }
            Cut::Parts(parts) => parts,
        };
        let number = self.nodes.len();
        self.nodes.push(Node::unused());
        let mut bounds = Box32::empty();
        for (slot, part) in parts.iter().enumerate() {
            let below = self.join(part, folded, leaves, (depth + 1, monitor))?;
            self.nodes[number].set(slot, &below.bounds);
            self.nodes[number].child[slot] = below.link;
            bounds = bounds.union(&below.bounds);
        }
        Ok(Joined {
            link: Link(number as u32),
            bounds,
        })
    }

    fn append(&mut self, piece: Folded, leaves: &mut Vec<Few>, depth: usize) -> Joined {
        let (nodes_before, leaves_before) = (self.nodes.len() as u32, leaves.len() as u32);
        let moved = |link: Link| match link.leaf() {
            Ok(leaf) => Link((leaf as u32 + leaves_before) | Link::LEAF),
            Err(node) => Link(node as u32 + nodes_before),
        };
        self.nodes.extend(piece.nodes.into_iter().map(|mut node| {
            node.child = node.child.map(moved);
            node
        }));
        leaves.extend(piece.leaves);
        let depth = depth + piece.depth;
        self.stack_size = self.stack_size.max(depth * (WIDTH - 1) + WIDTH);
        Joined {
            link: moved(piece.root),
            bounds: piece.bounds,
        }
    }
}

/// A part of the tree that stands at its final place.
struct Joined {
    link: Link,
    bounds: Box32,
}

/// The tree over one piece of the items; links count from its own first node and leaf.
struct Folded {
    root: Link,
    nodes: Vec<Node>,
    leaves: Vec<Few>,
    depth: usize,
    bounds: Box32,
}

impl Folded {
    /// Builds a binary tree over the items and folds it.
    fn of(ids: &[u32], box_of: impl Fn(u32) -> Box32) -> Self {
        // One item per leaf. Reinsertion of nodes takes a third of the build and gains questions nothing, because
        // the nodes are folded to four children and the leaves to four items.
        let params = BvhBuildParams::fastest_build();
        let boxes: Vec<Box32> = ids.iter().map(|&id| box_of(id)).collect();
        let binary = build_bvh2(&boxes, params, &mut Duration::default());
        let mut folded = Self {
            root: Link(0),
            nodes: Vec::new(),
            leaves: Vec::with_capacity(binary.nodes.len() / WIDTH),
            depth: 0,
            bounds: *binary.nodes[0].aabb(),
        };
        folded.fold(&binary);
        for number in folded.leaves.iter_mut().flat_map(Few::as_mut_slice) {
            *number = ids[*number as usize];
        }
        folded
    }

    /// Folds the binary tree from the root down, depth first, so that what is visited together
    /// lies together.
    fn fold(&mut self, binary: &Bvh2) {
        let sizes = subtree_sizes(binary);
        let mut waiting = vec![Waiting {
            binary_node: 0,
            parent: None,
            depth: 1,
        }];
        while let Some(next) = waiting.pop() {
            let is_leaf = sizes[next.binary_node as usize] as usize <= WIDTH;
            let link = if is_leaf {
                let mut leaf = Few::default();
                gather_items(binary, next.binary_node, &mut leaf);
                self.leaves.push(leaf);
                Link((self.leaves.len() - 1) as u32 | Link::LEAF)
            } else {
                let number = self.nodes.len();
                let mut node = Node::unused();
                let children = children_to_adopt(binary, &sizes, next.binary_node);
                for (slot, &child) in children.as_slice().iter().enumerate().rev() {
                    node.set(slot, binary.nodes[child as usize].aabb());
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
                None => self.root = link,
            }
            self.depth = self.depth.max(next.depth);
        }
    }
}

/// A part of the binary tree that has yet to be folded.
struct Waiting {
    binary_node: u32,
    /// Node and place that it will be linked from.
    parent: Option<(usize, usize)>,
    depth: usize,
}

/// Up to [`WIDTH`] numbers of items or nodes.
#[derive(Debug, Clone, Copy, Default)]
struct Few {
    numbers: [u32; WIDTH],
    len: usize,
}

impl Few {
    fn push(&mut self, number: u32) {
        self.numbers[self.len] = number;
        self.len += 1;
    }

    fn as_slice(&self) -> &[u32] {
        &self.numbers[..self.len]
    }

    fn as_mut_slice(&mut self) -> &mut [u32] {
        &mut self.numbers[..self.len]
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
fn children_to_adopt(binary: &Bvh2, sizes: &[u32], node: u32) -> Few {
    let first = binary.nodes[node as usize].first_index;
    let mut children = Few::default();
    children.push(first);
    children.push(first + 1);
    while children.len < WIDTH {
        let area = |&slot: &usize| {
            let child = children.numbers[slot] as usize;
            binary.nodes[child].aabb().half_area()
        };
        let largest = (0..children.len)
            .filter(|&slot| sizes[children.numbers[slot] as usize] as usize > WIDTH)
            .max_by(|a, b| area(a).total_cmp(&area(b)));
        let Some(slot) = largest else { break };
        let first = binary.nodes[children.numbers[slot] as usize].first_index;
        children.numbers[slot] = first;
        children.push(first + 1);
    }
    children
}

/// Adds the items below a node that has no more of them than fit.
fn gather_items(binary: &Bvh2, node: u32, items: &mut Few) {
    let node = &binary.nodes[node as usize];
    if node.is_leaf() {
        for i in 0..node.prim_count {
            items.push(binary.primitive_indices[(node.first_index + i) as usize]);
        }
    } else {
        gather_items(binary, node.first_index, items);
        gather_items(binary, node.first_index + 1, items);
    }
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
