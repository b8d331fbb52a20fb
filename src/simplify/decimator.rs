//! Cheapest collapse first.

use nalgebra::Vector3;

use super::fans::Fans;
use super::intake::Intake;
use super::legality::{Kind, Marks, Refusal, keeps_orientation, link_condition};
use super::quadric::{EdgeQuadric, Quadric};
use super::queue::{Entry, Queue, key_of, later_than};
use super::settings::{Placement, SimplifySettings, Speed, StopReason};
use crate::monitor::{Cancelled, Monitor};

/// One collapse as it is remembered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Collapse {
    /// The vertex that stays, the smaller of the two.
    pub(super) kept: u32,
    /// The vertex that goes.
    pub(super) removed: u32,
    /// Triangles left afterwards.
    pub(super) n_triangles: u32,
    /// Border loops closed by this collapse, 0 or 1.
    pub(super) closes: u32,
    /// Where the kept vertex is afterwards, in unit coordinates.
    pub(super) position: Vector3<f64>,
    /// The quadrics' mean square distance here, in unit coordinates.
    pub(super) error: f64,
}

/// What moving an edge's ends together costs, and where to.
struct Price {
    cost: f64,
    position: Vector3<f64>,
    /// Sum of the weights behind the cost.
    weight: f64,
}

/// With fewer triangles than this, the edges around a collapse are priced anew at once. A price can
/// fall, and where few edges are left each of them matters.
const EAGER_BELOW: usize = 1000;

/// Counts of edges that cannot be collapsed, by reason.
#[derive(Debug, Clone, Copy, Default)]
struct Refused {
    link: usize,
    flip: usize,
    feature: usize,
}

pub(super) struct Decimator {
    placement: Placement,
    speed: Speed,
    min_cosine: f64,
    may_close_loops: bool,
    boundary_weight: f64,
    stiffness: f64,
    fans: Fans,
    part_of: Vec<u32>,
    kinds: Vec<Kind>,
    quadrics: Vec<Quadric>,
    merged_into: Vec<u32>,
    marks: Marks,
    queue: Queue,
    closing: bool,
    refused: Refused,
    collapses: Vec<Collapse>,
}

impl Decimator {
    pub(super) fn new(intake: Intake, settings: &SimplifySettings) -> Self {
        let n = intake.kinds.len();
        let mut decimator = Self {
            placement: settings.placement,
            speed: settings.speed,
            min_cosine: settings.max_turn_deg.to_radians().cos(),
            may_close_loops: settings.may_close_loops,
            boundary_weight: settings.boundary_weight,
            stiffness: settings.stiffness,
            fans: intake.fans,
            part_of: intake.part_of,
            kinds: intake.kinds,
            quadrics: intake.quadrics,
            merged_into: (0..n as u32).collect(),
            marks: Marks::new(n),
            queue: Queue::new(),
            closing: false,
            refused: Refused::default(),
            collapses: Vec::new(),
        };
        decimator.fill_queue(&intake.edges);
        decimator
    }

    /// Collapses until `max_triangles` are left, nothing legal is left, or the monitor says stop.
    pub(super) fn run(
        mut self,
        max_triangles: usize,
        monitor: &Monitor,
    ) -> Result<(Vec<Collapse>, StopReason), Cancelled> {
        let n_start = self.fans.n_triangles;
        let to_do = n_start.saturating_sub(max_triangles) as u64;
        let mut n_popped = 0_usize;
        let mut n_at_fill = self.collapses.len();
        while self.fans.n_triangles > max_triangles {
            if n_popped.is_multiple_of(1024) {
                monitor.check()?;
                if monitor.stop_requested() {
                    return Ok((self.collapses, StopReason::StopRequested));
                }
                let done = (n_start - self.fans.n_triangles) as u64;
                monitor.progress("simplify", done, Some(to_do));
            }
            n_popped += 1;
            if let Some(entry) = self.queue.pop() {
                self.treat(entry);
                continue;
            }
            // The queue has run dry. Edges refused on the way may have become legal since.
            if self.collapses.len() == n_at_fill {
                if self.closing || !self.may_close_loops {
                    let Refused {
                        link,
                        flip,
                        feature,
                    } = self.refused;
                    let reason = StopReason::NothingLegal {
                        link,
                        flip,
                        feature,
                    };
                    return Ok((self.collapses, reason));
                }
                self.closing = true;
            } else {
                self.closing = false;
            }
            n_at_fill = self.collapses.len();
            let edges = self.edges_left();
            self.fill_queue(&edges);
        }
        Ok((self.collapses, StopReason::Reached))
    }

    /// Prices an entry that came up, and collapses it, puts it back, or sets it aside.
    ///
    /// An entry carries the price of the time it was made. Pricing it anew here rather than after
    /// every collapse nearby takes a third of the work for almost the same order: a price that has
    /// risen sends the entry back, one that has fallen is only seen late.
    fn treat(&mut self, entry: Entry) {
        let (a, b) = (self.root(entry.a), self.root(entry.b));
        if a == b {
            return;
        }
        let (a, b) = (a.min(b), a.max(b));
        let Some(price) = self.price(a, b) else {
            self.refused.feature += 1;
            return;
        };
        let now = Entry {
            key: key_of(price.cost),
            a,
            b,
        };
        if now > entry && self.queue.peek().is_some_and(|next| next < now) {
            self.queue.push(now);
            return;
        }
        match self.refusal(a, b, &price.position) {
            None => self.collapse(a, b, &price),
            Some(refusal) => {
                match refusal {
                    Refusal::Link => self.refused.link += 1,
                    Refusal::Flip => self.refused.flip += 1,
                }
                // The surroundings may change: it comes up again at a higher price.
                let key = later_than(entry.key.max(now.key));
                if key < key_of(1.0) {
                    self.queue.push(Entry { key, ..now });
                }
            }
        }
    }

    fn refusal(&mut self, a: u32, b: u32, position: &Vector3<f64>) -> Option<Refusal> {
        if !link_condition(&self.fans, &mut self.marks, a, b, self.closing) {
            return Some(Refusal::Link);
        }
        if !keeps_orientation(&self.fans, a, b, position, self.min_cosine) {
            return Some(Refusal::Flip);
        }
        None
    }

    fn collapse(&mut self, kept: u32, removed: u32, price: &Price) {
        let (k, r) = (kept as usize, removed as usize);
        let third = self.third_of_loop(kept, removed);
        if self.speed == Speed::Exact {
            self.take_old_quadrics(kept, removed);
        }
        self.fans.collapse(kept, removed, price.position);
        self.kinds[k] = self.kinds[k].max(self.kinds[r]);
        self.merged_into[r] = kept;
        self.collapses.push(Collapse {
            kept,
            removed,
            n_triangles: self.fans.n_triangles as u32,
            closes: u32::from(third.is_some()),
            position: price.position,
            error: if price.weight > 0.0 {
                price.cost / price.weight
            } else {
                0.0
            },
        });
        if let Some(third) = third {
            self.kinds[k] = self.kind_by_count(kept);
            self.kinds[third as usize] = self.kind_by_count(third);
        }
        match self.speed {
            Speed::Exact => self.add_new_quadrics(kept),
            Speed::Fast => self.quadrics[k] = self.quadric_of(kept),
        }
        if self.fans.n_triangles < EAGER_BELOW {
            self.requeue_around(kept);
        }
    }

    /// Takes the triangles around an edge out of the quadrics of their other vertices.
    fn take_old_quadrics(&mut self, a: u32, b: u32) {
        for end in [a, b] {
            for &t in self.fans.around(end) {
                let corners = self.fans.triangles[t as usize];
                if end == b && corners.contains(&a) {
                    continue;
                }
                let quadric = Quadric::triangle(&self.fans.corners(t), self.stiffness);
                for v in corners {
                    self.quadrics[v as usize].subtract(&quadric);
                }
            }
        }
    }

    /// Adds the triangles around a merged vertex to the quadrics of all their vertices.
    fn add_new_quadrics(&mut self, vertex: u32) {
        self.quadrics[vertex as usize] = Quadric::default();
        for &t in self.fans.around(vertex) {
            let quadric = Quadric::triangle(&self.fans.corners(t), self.stiffness);
            for v in self.fans.triangles[t as usize] {
                self.quadrics[v as usize].add(&quadric);
            }
        }
        if self.kinds[vertex as usize] == Kind::Free {
            return;
        }
        // Feature edges have changed here and with them the lines of the neighbours on features.
        self.quadrics[vertex as usize] = self.quadric_of(vertex);
        for i in 0..self.fans.around(vertex).len() {
            let t = self.fans.around(vertex)[i];
            for v in self.fans.triangles[t as usize] {
                if v != vertex && self.kinds[v as usize] != Kind::Free {
                    self.quadrics[v as usize] = self.quadric_of(v);
                }
            }
        }
    }

    /// The quadric of a vertex from its triangles and its feature edges.
    fn quadric_of(&self, vertex: u32) -> Quadric {
        let mut quadric = Quadric::default();
        for &t in self.fans.around(vertex) {
            quadric.add(&Quadric::triangle(&self.fans.corners(t), self.stiffness));
            for v in self.fans.triangles[t as usize] {
                let on_feature = v != vertex && self.kinds[v as usize] != Kind::Free;
                if on_feature && self.is_feature(vertex, v) {
                    // Seen once from each triangle at the edge, and to count once in all.
                    let n_sides = self.fans.sides(vertex, v).count() as f64;
                    let edge = self.positions(v) - self.positions(vertex);
                    quadric.add(&Quadric::line(&edge, self.boundary_weight / n_sides));
                }
            }
        }
        quadric
    }

    /// Prices the edges of `vertex` at once rather than when they come up.
    fn requeue_around(&mut self, vertex: u32) {
        for i in 0..self.fans.around(vertex).len() {
            let t = self.fans.around(vertex)[i];
            for w in self.fans.triangles[t as usize] {
                let (a, b) = (vertex.min(w), vertex.max(w));
                if a != b
                    && let Some(price) = self.price(a, b)
                {
                    let key = key_of(price.cost);
                    self.queue.push(Entry { key, a, b });
                }
            }
        }
    }

    /// Cost and place of a collapse; `None` if features forbid it.
    fn price(&self, a: u32, b: u32) -> Option<Price> {
        let (kind_a, kind_b) = (self.kinds[a as usize], self.kinds[b as usize]);
        let both_on_features = kind_a != Kind::Free && kind_b != Kind::Free;
        let both_fixed = kind_a == Kind::Corner && kind_b == Kind::Corner;
        if both_fixed || (both_on_features && !self.is_feature(a, b)) {
            return None;
        }
        let origin = self.positions(a);
        let across = self.positions(b) - origin;
        let (quadric_a, quadric_b) = (&self.quadrics[a as usize], &self.quadrics[b as usize]);
        let quadric = EdgeQuadric::new(quadric_a, quadric_b, across);
        let shift = if kind_a == Kind::Corner {
            Vector3::zeros()
        } else if kind_b == Kind::Corner {
            across
        } else {
            place(&quadric, &across, self.placement)
        };
        Some(Price {
            cost: quadric.at(&shift),
            position: origin + shift,
            weight: quadric.weight(),
        })
    }

    fn positions(&self, vertex: u32) -> Vector3<f64> {
        self.fans.positions[vertex as usize]
    }

    /// True for a border edge, a seam, or an edge with three or more triangles.
    fn is_feature(&self, a: u32, b: u32) -> bool {
        let mut sides = self.fans.sides(a, b);
        let (Some((s, _)), Some((t, _)), None) = (sides.next(), sides.next(), sides.next()) else {
            return true;
        };
        let part = |t: u32| self.part_of.get(t as usize);
        let forward = |t: u32| {
            let corners = self.fans.triangles[t as usize];
            (0..3).any(|i| corners[i] == a && corners[(i + 1) % 3] == b)
        };
        part(s) != part(t) || forward(s) == forward(t)
    }

    fn kind_by_count(&self, vertex: u32) -> Kind {
        let mut ring: Vec<u32> = self
            .fans
            .around(vertex)
            .iter()
            .flat_map(|&t| self.fans.triangles[t as usize])
            .filter(|&v| v != vertex)
            .collect();
        ring.sort_unstable();
        ring.dedup();
        match ring.iter().filter(|&&v| self.is_feature(vertex, v)).count() {
            0 => Kind::Free,
            2 => Kind::Line,
            _ => Kind::Corner,
        }
    }

    /// The third vertex of the border loop of three that collapsing this edge would close.
    fn third_of_loop(&self, a: u32, b: u32) -> Option<u32> {
        if !self.closing || self.fans.sides(a, b).count() != 1 {
            return None;
        }
        let opposite = self.fans.sides(a, b).next()?.1;
        let is_border = |u: u32, v: u32| self.fans.sides(u, v).count() == 1;
        self.fans
            .around(a)
            .iter()
            .flat_map(|&t| self.fans.triangles[t as usize])
            .find(|&x| x != a && x != b && x != opposite && is_border(a, x) && is_border(b, x))
    }

    fn root(&mut self, mut vertex: u32) -> u32 {
        while self.merged_into[vertex as usize] != vertex {
            let above = self.merged_into[self.merged_into[vertex as usize] as usize];
            self.merged_into[vertex as usize] = above;
            vertex = above;
        }
        vertex
    }

    fn fill_queue(&mut self, edges: &[[u32; 2]]) {
        self.refused = Refused::default();
        self.queue.clear();
        for &[a, b] in edges {
            match self.price(a, b) {
                Some(price) => self.queue.push(Entry {
                    key: key_of(price.cost),
                    a,
                    b,
                }),
                None => self.refused.feature += 1,
            }
        }
    }

    fn edges_left(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = self
            .fans
            .triangles
            .iter()
            .filter(|corners| corners[0] != super::fans::GONE)
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[u, v]| [u.min(v), u.max(v)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// The shift from the first end to where the merged vertex goes.
fn place(quadric: &EdgeQuadric, across: &Vector3<f64>, placement: Placement) -> Vector3<f64> {
    if placement == Placement::Optimal
        && let Some(least) = quadric.minimum()
    {
        return least;
    }
    let candidates = [Vector3::zeros(), *across, across * 0.5];
    let n = if placement == Placement::Endpoint {
        2
    } else {
        3
    };
    let mut best = candidates[0];
    for candidate in &candidates[1..n] {
        if quadric.at(candidate) < quadric.at(&best) {
            best = *candidate;
        }
    }
    best
}
