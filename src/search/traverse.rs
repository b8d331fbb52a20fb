//! The walk through a tree: nearest boxes first, everything farther than the best so far left out.
//!
//! The walk is in `f32` and its distances are off by at most [`slack`]. It therefore keeps every
//! item whose distance comes within twice that of the smallest, and the caller's `exact` distance
//! in `f64` picks among them. So the answer is the same as if every item had been asked in `f64`,
//! whatever the shape of the tree.

use glam::{BVec4A, Vec4};

use super::nearby::Leaves;
use super::wide::{Link, Node, Pack, Query, WIDTH, WideTree};
use crate::geometry::Vector3;

/// Queries farther out than this, in half extents of the items, ask every item: `f32` could not
/// tell the items apart from there.
pub(super) const OUT_OF_SIGHT: f64 = 1e6;

/// Larger than any squared distance of a query within sight, smaller than that of unused places.
const UNLIMITED: f32 = 1e30;

/// Walks with a deeper stack than this take it from the heap.
const USUAL_STACK: usize = 64;

/// Candidates that are kept before they are decided in `f64`.
const MAX_CANDIDATES: usize = 16;

/// How far an `f32` distance from `local` can be off: the rounding of the query, of the items and
/// of the thirty-odd operations between them, each relative to the lengths that occur.
fn slack(local: &Vector3) -> f32 {
    16.0 * f32::EPSILON * (2.0 + local.amax() as f32)
}

/// A distance in local units from `local`, with all that `f32` may have lost to both sides.
pub(super) fn reach_of(local: &Vector3, distance: f32) -> f32 {
    (distance + 2.0 * slack(local)) * (1.0 + 4.0 * f32::EPSILON)
}

/// The winner of a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest<T> {
    pub(super) distance_sq: f64,
    pub(super) id: u32,
    pub(super) found: T,
}

impl<T> Nearest<T> {
    /// Closer, or as close with a lower index.
    pub(super) fn beats(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| (self.distance_sq, self.id) < (other.distance_sq, other.id))
    }
}

/// Which items of a tree count.
pub(super) trait Admit<P> {
    /// Of the marked places of a pack, those whose items may win.
    fn items(&self, pack: &P, marked: u32) -> u32;

    /// The children of a node below which an item may win.
    fn children(&self, node: &Node) -> BVec4A;
}

/// All items count.
pub(super) struct All;

impl<P> Admit<P> for All {
    #[inline]
    fn items(&self, _: &P, marked: u32) -> u32 {
        marked
    }

    #[inline]
    fn children(&self, _: &Node) -> BVec4A {
        BVec4A::splat(true)
    }
}

/// One query on its way through a tree.
pub(super) struct Walk<'a, P, T, A, E> {
    tree: &'a WideTree<P>,
    query: Query,
    slack: f32,
    /// Items and boxes with a larger squared distance cannot win.
    bound_sq: f32,
    candidates: [(f32, u32); MAX_CANDIDATES],
    n_candidates: usize,
    best: Option<Nearest<T>>,
    admit: A,
    /// True once a leaf within reach held nothing that counts. Until then, what lies near is most likely what
    /// counts, and the look at cones would cost more than it saves.
    is_turned_away: bool,
    /// What an item really is to the query, or `None` if it is out of the question.
    exact: E,
}

impl<'a, P, T, A, E> Walk<'a, P, T, A, E>
where
    P: Pack,
    A: Admit<P>,
    E: Fn(u32) -> Option<Nearest<T>>,
{
    /// A walk for the query at `local` that ends at `max_distance` (local units).
    pub(super) fn new(
        tree: &'a WideTree<P>,
        local: &Vector3,
        max_distance: f64,
        admit: A,
        exact: E,
    ) -> Self {
        let mut walk = Self {
            tree,
            query: Query::at(local),
            slack: slack(local),
            bound_sq: UNLIMITED,
            candidates: [(0.0, 0); MAX_CANDIDATES],
            n_candidates: 0,
            best: None,
            admit,
            is_turned_away: false,
            exact,
        };
        walk.lower_bound(max_distance as f32);
        walk
    }

    /// Nothing farther than `distance` (local units) can win any more.
    pub(super) fn lower_bound(&mut self, distance: f32) {
        let reach = (distance + 2.0 * self.slack) * (1.0 + 4.0 * f32::EPSILON);
        self.bound_sq = self.bound_sq.min(reach * reach);
    }

    /// Starts from a known item, which need not be asked again.
    pub(super) fn start_from(&mut self, known: Nearest<T>, distance: f64) {
        self.lower_bound(distance as f32);
        self.best = Some(known);
    }

    /// Runs the walk and returns the winner.
    pub(super) fn run(&mut self) -> Option<Nearest<T>> {
        let root = self.tree.root?;
        if self.tree.stack_size <= USUAL_STACK {
            self.descend(root, &mut [0; USUAL_STACK]);
        } else {
            self.descend(root, &mut vec![0; self.tree.stack_size]);
        }
        self.decide();
        self.best.take()
    }

    /// The winner among the marked items of some leaves: first of the nearest one, then of those whose
    /// boxes are within reach.
    pub(super) fn run_over(&mut self, leaves: &[Leaves]) -> Option<Nearest<T>> {
        let mut first = (f32::INFINITY, 0, 0);
        for (at, few) in leaves.iter().enumerate() {
            let distances = few.node.distance_sq(&self.query);
            if distances.min_element() < first.0 {
                first = (distances.min_element(), at, distances.min_position());
            }
        }
        let visit = |walk: &mut Self, at: usize, slot: usize| {
            if let Ok(leaf) = leaves[at].node.child[slot].leaf() {
                walk.visit(leaf, leaves[at].marked[slot]);
            }
        };
        if !leaves.is_empty() {
            visit(self, first.1, first.2);
        }
        for (at, few) in leaves.iter().enumerate() {
            let distances = few.node.distance_sq(&self.query);
            let mut within = distances.cmple(Vec4::splat(self.bound_sq)).bitmask();
            while within != 0 {
                let slot = within.trailing_zeros() as usize;
                within &= within - 1;
                if (at, slot) != (first.1, first.2) {
                    visit(self, at, slot);
                }
            }
        }
        self.decide();
        self.best.take()
    }

    /// Depth first, the nearest child first. Stack entries are the distance's bits above the link's,
    /// so that they sort as numbers: for positive floats, order of bits is order of values.
    fn descend(&mut self, root: Link, stack: &mut [u64]) {
        let mut waiting = 0;
        let mut link = root;
        loop {
            match link.leaf() {
                Ok(leaf) => self.visit(leaf, u32::MAX),
                Err(node) => {
                    let [nearest, others @ ..] = self.children_by_distance(node);
                    if self.within_reach(nearest) {
                        for key in others.into_iter().rev() {
                            if self.within_reach(key) {
                                stack[waiting] = key;
                                waiting += 1;
                            }
                        }
                        link = Link(nearest as u32);
                        continue;
                    }
                }
            }
            loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                if self.within_reach(stack[waiting]) {
                    link = Link(stack[waiting] as u32);
                    break;
                }
            }
        }
    }

    #[inline]
    fn within_reach(&self, key: u64) -> bool {
        (key >> 32) as u32 <= self.bound_sq.to_bits()
    }

    /// Keys of a node's children, the nearest first.
    #[inline]
    fn children_by_distance(&self, node: usize) -> [u64; WIDTH] {
        let node = &self.tree.nodes[node];
        let mut distances = node.distance_sq(&self.query);
        if self.is_turned_away {
            let beyond = Vec4::splat(f32::INFINITY);
            distances = Vec4::select(self.admit.children(node), distances, beyond);
        }
        let distances = distances.to_array();
        let mut keys: [u64; WIDTH] = std::array::from_fn(|i| {
            u64::from(distances[i].to_bits()) << 32 | u64::from(node.child[i].0)
        });
        // A sorting network: five exchanges without a branch.
        for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            (keys[i], keys[j]) = (keys[i].min(keys[j]), keys[i].max(keys[j]));
        }
        keys
    }

    #[inline]
    fn visit(&mut self, leaf: usize, marked: u32) {
        let pack = &self.tree.packs[leaf];
        let distances = pack.distance_sq(&self.query);
        let within = marked & distances.cmple(Vec4::splat(self.bound_sq)).bitmask();
        if within == 0 {
            return;
        }
        let mut within = self.admit.items(pack, within);
        self.is_turned_away |= within == 0;
        let distances = distances.to_array();
        while within != 0 {
            let slot = within.trailing_zeros() as usize;
            within &= within - 1;
            self.keep(distances[slot], pack.ids()[slot]);
        }
    }

    #[inline]
    fn keep(&mut self, distance_sq: f32, id: u32) {
        if distance_sq > self.bound_sq {
            return;
        }
        if self.n_candidates == MAX_CANDIDATES {
            self.make_room();
        }
        self.candidates[self.n_candidates] = (distance_sq, id);
        self.n_candidates += 1;
        self.lower_bound(distance_sq.sqrt());
    }

    /// Drops candidates that fell out of reach; decides the rest if that does not help.
    #[cold]
    fn make_room(&mut self) {
        let mut kept = 0;
        for i in 0..self.n_candidates {
            if self.candidates[i].0 <= self.bound_sq {
                self.candidates[kept] = self.candidates[i];
                kept += 1;
            }
        }
        self.n_candidates = kept;
        if kept == MAX_CANDIDATES {
            self.decide();
        }
    }

    /// Takes the exact distance of every candidate still in reach.
    fn decide(&mut self) {
        for &(distance_sq, id) in &self.candidates[..self.n_candidates] {
            let known = self.best.as_ref().is_some_and(|best| best.id == id);
            if distance_sq <= self.bound_sq
                && !known
                && let Some(nearest) = (self.exact)(id)
                && nearest.beats(self.best.as_ref())
            {
                self.best = Some(nearest);
            }
        }
        self.n_candidates = 0;
    }
}
