//! Cheapest collapse first.

use nalgebra::Vector3;

use super::legality::{Refusal, Ring, keeps_orientation, link_condition};
use super::quadric::{EdgeQuadric, Quadric, pull_of};
use super::queue::{Entry, N_BUCKETS, Queue, key_of, later_than};
use super::settings::{Placement, SimplifySettings, StopReason};
use super::surface::{CollapsingMesh, Kind};
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
    /// Where the kept vertex is afterwards, in unit coordinates.
    pub(super) position: Vector3<f64>,
}

/// What moving an edge's ends together costs, and where to.
struct Price {
    cost: f64,
    position: Vector3<f64>,
}

/// Edges that are priced before a cancel request is looked for.
const PRICED_AT_ONCE: u32 = 1 << 14;

/// Edges that come up between two questions to the monitor.
const POPPED_AT_ONCE: usize = 1024;

/// With fewer triangles than this, the edges around a collapse are priced anew at once. A price can
/// fall, and where few edges are left each of them matters.
const EAGER_BELOW: usize = 1000;

/// An edge whose price has risen by less than this, half an octave of keys, is collapsed all the
/// same. On the car floor sample the error is the same as with none.
const SLACK: u32 = 1 << 14;

/// Counts of edges that cannot be collapsed, by reason.
#[derive(Debug, Clone, Copy, Default)]
struct Refused {
    link: usize,
    flip: usize,
    feature: usize,
}

pub(super) struct Decimator {
    placement: Placement,
    /// The quadrics of a merged vertex's neighbours are kept up to date as well.
    is_exact: bool,
    min_cosine: f64,
    may_close_loops: bool,
    boundary_weight: f64,
    stiffness: f64,
    surface: CollapsingMesh,
    ring: Ring,
    queue: Queue,
    closing: bool,
    refused: Refused,
    collapses: Vec<Collapse>,
    dearest: Vec<u16>,
}

impl Decimator {
    pub(super) fn new(
        surface: CollapsingMesh,
        settings: &SimplifySettings,
        is_exact: bool,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut decimator = Self {
            placement: settings.placement,
            is_exact,
            min_cosine: settings.max_turn_deg.to_radians().cos(),
            may_close_loops: settings.may_close_loops,
            boundary_weight: settings.boundary_weight,
            stiffness: settings.stiffness,
            ring: Ring::new(surface.vertices.len()),
            surface,
            queue: Queue::new(),
            closing: false,
            refused: Refused::default(),
            collapses: Vec::new(),
            dearest: Vec::new(),
        };
        decimator.fill_queue(monitor)?;
        Ok(decimator)
    }

    pub(super) fn surface(&self) -> &CollapsingMesh {
        &self.surface
    }

    pub(super) fn queue(&self) -> &Queue {
        &self.queue
    }

    /// The collapses so far.
    pub(super) fn collapses(&self) -> &[Collapse] {
        &self.collapses
    }

    /// For each collapse the dearest bucket that has come up by then.
    pub(super) fn dearest(&self) -> &[u16] {
        &self.dearest
    }

    /// Collapses what comes up before the bucket `end`.
    pub(super) fn run_before(&mut self, end: usize, monitor: &Monitor) -> Result<(), Cancelled> {
        for n_popped in 0_usize.. {
            if n_popped.is_multiple_of(POPPED_AT_ONCE) {
                monitor.check()?;
                if monitor.stop_requested() {
                    break;
                }
            }
            let Some(entry) = self.queue.pop_before(end) else {
                break;
            };
            self.treat(entry);
        }
        Ok(())
    }

    /// Collapses until `max_triangles` are left, nothing legal is left, or the monitor says stop.
    pub(super) fn run(
        &mut self,
        max_triangles: usize,
        monitor: &Monitor,
        report: impl Fn(usize),
    ) -> Result<StopReason, Cancelled> {
        let mut n_popped = 0_usize;
        let mut n_at_fill = self.collapses.len();
        while self.surface.n_triangles > max_triangles {
            if n_popped.is_multiple_of(POPPED_AT_ONCE) {
                monitor.check()?;
                if monitor.stop_requested() {
                    return Ok(StopReason::StopRequested);
                }
                report(self.surface.n_triangles);
            }
            n_popped += 1;
            if let Some(entry) = self.queue.pop_before(N_BUCKETS) {
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
                    return Ok(StopReason::NothingLegal {
                        link,
                        flip,
                        feature,
                    });
                }
                self.closing = true;
            } else {
                self.closing = false;
            }
            n_at_fill = self.collapses.len();
            self.fill_queue(monitor)?;
        }
        Ok(StopReason::Reached)
    }

    /// Prices an entry that came up, and collapses it, puts it back, or sets it aside.
    ///
    /// An entry carries the price of the time it was made. Pricing it anew here rather than after
    /// every collapse nearby takes a third of the work for almost the same order: a price that has
    /// risen sends the entry back, one that has fallen is only seen late.
    fn treat(&mut self, entry: Entry) {
        let edge = entry.edge();
        if self.surface.edges[edge as usize].key != entry.key() {
            // It was priced anew since.
            return;
        }
        let [a, b] = self.surface.ends_now(edge);
        if a == b {
            return;
        }
        let Some(price) = self.price(edge, [a, b]) else {
            self.refused.feature += 1;
            return;
        };
        let now = Entry::new(key_of(price.cost), edge);
        if now.key() > entry.key() + SLACK {
            self.push(now);
            return;
        }
        match self.refusal([a, b], &price.position) {
            None => self.collapse(a, b, &price),
            Some(refusal) => {
                match refusal {
                    Refusal::Link => self.refused.link += 1,
                    Refusal::Flip => self.refused.flip += 1,
                }
                // The surroundings may change: it comes up again at a higher price.
                let key = later_than(entry.key().max(now.key()));
                if key < key_of(1.0) {
                    self.push(Entry::new(key, edge));
                }
            }
        }
    }

    /// Puts an edge into the queue; an entry it may have there no longer counts.
    fn push(&mut self, entry: Entry) {
        self.surface.edges[entry.edge() as usize].key = entry.key();
        self.queue.push(entry);
    }

    fn refusal(&mut self, [a, b]: [u32; 2], position: &Vector3<f64>) -> Option<Refusal> {
        if !link_condition(&self.surface, &mut self.ring, a, b, self.closing) {
            return Some(Refusal::Link);
        }
        if !keeps_orientation(&self.surface, &mut self.ring, position, self.min_cosine) {
            return Some(Refusal::Flip);
        }
        None
    }

    fn collapse(&mut self, kept: u32, removed: u32, price: &Price) {
        let third = self.third_of_loop(kept, removed);
        let kind = self.surface.kind(kept).max(self.surface.kind(removed));
        self.renew_quadrics(kept);
        self.surface
            .collapse(&self.ring, [kept, removed], price.position);
        self.surface.vertices[kept as usize].kind = kind;
        let dearest_before = self.dearest.last().copied().unwrap_or(0);
        self.dearest
            .push(dearest_before.max(self.queue.first() as u16));
        self.collapses.push(Collapse {
            kept,
            removed,
            n_triangles: self.surface.n_triangles as u32,
            position: price.position,
        });
        if let Some(third) = third {
            self.close_loop(kept, third);
        }
        if kind != Kind::Free {
            self.renew_features(kept);
        }
        if self.surface.n_triangles < EAGER_BELOW {
            self.requeue_around(kept);
        }
    }

    /// Gives the triangles that stay around a collapsed edge their new pulls, and the vertices they
    /// belong to their new quadrics: the merged vertex, and if it is to be exact all its neighbours.
    fn renew_quadrics(&mut self, kept: u32) {
        let CollapsingMesh {
            vertices, faces, ..
        } = &mut self.surface;
        let stiffness = self.stiffness;
        if self.is_exact {
            for &(face, opposite) in self.ring.gone() {
                let quadric = Quadric::triangle(&faces[face as usize].pull, stiffness);
                vertices[opposite as usize].quadric.subtract(&quadric);
            }
        }
        let mut sum = Quadric::default();
        for staying in self.ring.stay() {
            let face = &mut faces[staying.face as usize];
            let before = std::mem::replace(&mut face.pull, pull_of(&staying.twice_area));
            let quadric = Quadric::triangle(&face.pull, stiffness);
            sum.add(&quadric);
            if self.is_exact {
                let mut change = quadric;
                change.subtract(&Quadric::triangle(&before, stiffness));
                for v in staying.others {
                    vertices[v as usize].quadric.add(&change);
                }
            }
        }
        vertices[kept as usize].quadric = sum;
    }

    /// Where features have changed, so have the lines of the vertices on them.
    fn renew_features(&mut self, vertex: u32) {
        self.surface.vertices[vertex as usize].quadric = self.quadric_of(vertex);
        if !self.is_exact {
            return;
        }
        for i in 0..self.surface.around(vertex).len() {
            let face = self.surface.faces[self.surface.around(vertex)[i] as usize];
            let at = face.index_of(vertex);
            for (v, edge) in [(at + 1, at + 2), (at + 2, at + 1)] {
                let (v, edge) = (face.corners[v % 3], face.edges[edge % 3]);
                if self.surface.edges[edge as usize].is_feature {
                    self.surface.vertices[v as usize].quadric = self.quadric_of(v);
                }
            }
        }
    }

    /// The quadric of a vertex from its triangles and its feature edges.
    fn quadric_of(&self, vertex: u32) -> Quadric {
        let mut quadric = Quadric::default();
        for (_, face) in self.surface.faces_around(vertex) {
            quadric.add(&Quadric::triangle(&face.pull, self.stiffness));
        }
        for (edge, far) in self.surface.spokes(vertex) {
            if self.surface.edges[edge as usize].is_feature {
                // Seen once from each triangle at the edge, and to count once in all.
                let n_sides = self.surface.sides(vertex, far).count() as f64;
                let along = self.surface.position(far) - self.surface.position(vertex);
                quadric.add(&Quadric::line(&along, self.boundary_weight / n_sides));
            }
        }
        quadric
    }

    /// Prices the edges of `vertex` at once rather than when they come up.
    fn requeue_around(&mut self, vertex: u32) {
        for (edge, far) in self.distinct_spokes(vertex) {
            if let Some(price) = self.price(edge, [vertex.min(far), vertex.max(far)]) {
                self.push(Entry::new(key_of(price.cost), edge));
            }
        }
    }

    /// Cost and place of a collapse; `None` if features forbid it.
    fn price(&self, edge: u32, [a, b]: [u32; 2]) -> Option<Price> {
        let vertices = &self.surface.vertices;
        let (first, second) = (&vertices[a as usize], &vertices[b as usize]);
        let both_on_features = first.kind != Kind::Free && second.kind != Kind::Free;
        let both_fixed = first.kind == Kind::Corner && second.kind == Kind::Corner;
        let is_frozen = first.kind == Kind::Frozen || second.kind == Kind::Frozen;
        if is_frozen
            || both_fixed
            || (both_on_features && !self.surface.edges[edge as usize].is_feature)
        {
            return None;
        }
        let across = second.position - first.position;
        let quadric = EdgeQuadric::new(&first.quadric, &second.quadric, across);
        let (shift, cost) = if first.kind == Kind::Corner {
            (Vector3::zeros(), quadric.at(&Vector3::zeros()))
        } else if second.kind == Kind::Corner {
            (across, quadric.at(&across))
        } else {
            place(&quadric, &across, self.placement)
        };
        Some(Price {
            cost,
            position: first.position + shift,
        })
    }

    /// The third vertex of the border loop of three that collapsing this edge would close.
    fn third_of_loop(&self, a: u32, b: u32) -> Option<u32> {
        if !self.closing || self.surface.sides(a, b).count() != 1 {
            return None;
        }
        let opposite = self.surface.sides(a, b).next()?.1;
        let is_border = |u: u32, v: u32| self.surface.sides(u, v).count() == 1;
        let mut neighbours = self.surface.spokes(a).map(|(_, far)| far);
        neighbours.find(|&x| x != b && x != opposite && is_border(a, x) && is_border(b, x))
    }

    /// After a collapse closed a border loop: its last two edges have become one inside the surface.
    fn close_loop(&mut self, kept: u32, third: u32) {
        let spokes = self.distinct_spokes(kept);
        let mut twins = spokes.iter().filter(|&&(_, far)| far == third);
        if let (Some(&(stays, _)), Some(&(goes, _))) = (twins.next(), twins.next()) {
            self.surface.merge_edges(stays, goes, [kept, third]);
        }
        for vertex in [kept, third] {
            let spokes = self.distinct_spokes(vertex);
            let on_feature =
                |&&(edge, _): &&(u32, u32)| self.surface.edges[edge as usize].is_feature;
            let n_features = spokes.iter().filter(on_feature).count();
            self.surface.vertices[vertex as usize].kind = Kind::on(n_features);
            self.surface.vertices[vertex as usize].quadric = self.quadric_of(vertex);
        }
    }

    /// The edges of a vertex with their far ends, in the order of the edges.
    fn distinct_spokes(&self, vertex: u32) -> Vec<(u32, u32)> {
        let mut spokes: Vec<(u32, u32)> = self.surface.spokes(vertex).collect();
        spokes.sort_unstable();
        spokes.dedup();
        spokes
    }

    /// Fills the queue with all edges that are left.
    fn fill_queue(&mut self, monitor: &Monitor) -> Result<(), Cancelled> {
        self.refused = Refused::default();
        self.queue = Queue::new();
        for edge in 0..self.surface.edges.len() as u32 {
            if edge.is_multiple_of(PRICED_AT_ONCE) {
                monitor.check()?;
            }
            let [a, b] = self.surface.ends_now(edge);
            if a == b {
                continue;
            }
            match self.price(edge, [a, b]) {
                Some(price) => self.push(Entry::new(key_of(price.cost), edge)),
                None => self.refused.feature += 1,
            }
        }
        Ok(())
    }
}

/// The shift from the first end to where the merged vertex goes, and what it costs there.
fn place(
    quadric: &EdgeQuadric,
    across: &Vector3<f64>,
    placement: Placement,
) -> (Vector3<f64>, f64) {
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
    let priced = candidates[..n].iter().map(|x| (*x, quadric.at(x)));
    let cheaper = |best: (Vector3<f64>, f64), next: (Vector3<f64>, f64)| {
        if next.1 < best.1 { next } else { best }
    };
    priced
        .reduce(cheaper)
        .expect("there are two candidates or three")
}
