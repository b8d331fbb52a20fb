//! The elements of a source that a chunk of the target takes its values from, with the neighbours and
//! the weights that make gradients of their values. A neighbour whose normal is on the other side of the sheet is
//! seen from there.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use super::links::Neighbours;
use super::shells::ShellMesh;
use crate::geometry::Vector3;

/// Neighbours whose normals differ by more than 40° are beyond an edge of the sheet: cosine of that angle.
pub(super) const LEAST_BEND_COS: f64 = 0.766_044_443_118_978;
/// A jump in thickness by more than this fraction is a weld line between two gauges, …
const WELD_LINE_JUMP: f64 = 0.05;
/// … if it is more than so many times the change to the next element on either side: beside a weld line the thickness
/// hardly changes, while thinning grows and falls from element to element.
const JUMP_OVER_SLOPE: f64 = 3.0;
/// The next element lies ahead within this angle (37°), given as its cosine.
const AHEAD_COS: f64 = 0.8;

/// A neighbour in the fit of an element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// Its slot in the patch.
    pub slot: u32,
    /// What its difference adds to the two derivatives.
    pub weight: [f64; 2],
    /// How its frame, laid into the tangent plane by the smallest rotation, is turned there.
    pub spin: Spin,
}

/// A turn within a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spin {
    pub cos: f64,
    pub sin: f64,
    /// Of twice the angle.
    pub cos2: f64,
    pub sin2: f64,
}

/// An element as one side of the sheet sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Seen {
    pub element: u32,
    /// Not the side that its normal points to: its layers come in the opposite order.
    pub from_below: bool,
}

impl Seen {
    /// From the side that its normal points to.
    pub fn from_above(element: u32) -> Self {
        Self {
            element,
            from_below: false,
        }
    }

    /// A tree names two triangles of each element with 32 bits, so the topmost bit of an element's number is free.
    fn key(self) -> u32 {
        self.element << 1 | u32::from(self.from_below)
    }
}

/// Elements numbered by slots: first those around which fields are fitted, then their neighbours.
#[derive(Default)]
pub(super) struct Patch {
    slots: HashMap<u32, u32, BuildHasherDefault<Scatter>>,
    seen: Vec<Seen>,
    starts: Vec<u32>,
    links: Vec<Link>,
    /// Of every slot: two directions that span the tangent plane, and the normal on the side that sees it.
    frames: Vec<[Vector3; 3]>,
    corners: Vec<[[f64; 2]; 4]>,
}

impl Patch {
    /// Begins anew, with fields around `elements`; each counts once. The gradient of any quantity is a
    /// least squares fit to the neighbours, weighted by the inverse squared distance, in the tangent
    /// plane of the element. Neighbours across another part, an edge of the sheet or a weld line are
    /// left out; with fewer than three, or all in one line, the gradient is zero. `thickness` may be
    /// empty.
    pub fn load(
        &mut self,
        elements: impl Iterator<Item = u32>,
        mesh: &ShellMesh,
        neighbours: &Neighbours,
        thickness: &[f64],
    ) {
        self.slots.clear();
        self.seen.clear();
        self.frames.clear();
        for element in elements {
            self.slot_or_new(Seen::from_above(element), mesh);
        }
        self.starts.clear();
        self.starts.push(0);
        self.links.clear();
        self.corners.clear();
        for slot in 0..self.seen.len() {
            let element = self.seen[slot].element as usize;
            let centre = mesh.centroids()[element];
            let corners = mesh.corner_points(element);
            let in_plane = |corner| self.in_plane(slot, &(corner - centre));
            let corners = corners.map(in_plane);
            self.corners.push(corners);
            self.add_links(element, slot, (mesh, neighbours, thickness));
            self.starts.push(self.links.len() as u32);
        }
    }

    fn slot_or_new(&mut self, seen: Seen, mesh: &ShellMesh) -> u32 {
        let next = self.seen.len() as u32;
        let slot = *self.slots.entry(seen.key()).or_insert(next);
        if slot == next {
            self.seen.push(seen);
            self.frames.push(frame(mesh, seen));
        }
        slot
    }

    fn add_links(
        &mut self,
        element: usize,
        own: usize,
        (mesh, neighbours, thickness): (&ShellMesh, &Neighbours, &[f64]),
    ) {
        let first = self.links.len();
        let centre = mesh.centroids()[element];
        let [mut xx, mut xy, mut yy] = [0.0; 3];
        for &other in neighbours.of(element) {
            let n = other as usize;
            if cos_between(mesh, neighbours, element, n) < LEAST_BEND_COS
                || is_weld_line((mesh, neighbours, thickness), element, n)
            {
                continue;
            }
            let away = mesh.centroids()[n] - centre;
            let [x, y] = self.in_plane(own, &away);
            // Unfolded into the tangent plane: the distance along a bent sheet is kept.
            let flat_sq = x * x + y * y;
            let length_sq = away.norm_squared();
            let weight = 1.0 / length_sq;
            if !(flat_sq > 0.0 && weight.is_finite()) {
                self.links.truncate(first);
                return;
            }
            let stretch = (length_sq / flat_sq).sqrt();
            let [x, y] = [x * stretch, y * stretch];
            xx += weight * x * x;
            xy += weight * x * y;
            yy += weight * y * y;
            let seen = Seen {
                element: other,
                from_below: neighbours.are_opposed(element, n),
            };
            let slot = self.slot_or_new(seen, mesh);
            self.links.push(Link {
                slot,
                weight: [weight * x, weight * y],
                spin: {
                    let [along, _, normal] = &self.frames[slot as usize];
                    spin([along, normal], &self.frames[own])
                },
            });
        }
        let determinant = xx * yy - xy * xy;
        let n_links = self.links.len() - first;
        if n_links < 3 || determinant <= 1e-6 * (xx + yy) * (xx + yy) {
            self.links.truncate(first);
            return;
        }
        for link in &mut self.links[first..] {
            let [x, y] = link.weight;
            link.weight = [
                (yy * x - xy * y) / determinant,
                (xx * y - xy * x) / determinant,
            ];
        }
    }

    /// Elements by slot.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// Number of slots around which fields are fitted.
    pub fn n_fitted(&self) -> usize {
        self.corners.len()
    }

    /// The slot of an element that fields are fitted around.
    pub fn slot(&self, element: u32) -> Option<usize> {
        let slot = *self.slots.get(&Seen::from_above(element).key())? as usize;
        (slot < self.n_fitted()).then_some(slot)
    }

    /// What makes the gradient of a slot; empty where it is zero.
    pub fn links(&self, slot: usize) -> &[Link] {
        &self.links[self.starts[slot] as usize..self.starts[slot + 1] as usize]
    }

    /// Places of the corners in the tangent plane, from the centroid.
    pub fn corners(&self, slot: usize) -> &[[f64; 2]; 4] {
        &self.corners[slot]
    }

    /// Coordinates of a displacement in the tangent plane of a slot.
    pub fn in_plane(&self, slot: usize, displacement: &Vector3) -> [f64; 2] {
        let [x, y, _] = &self.frames[slot];
        [x.dot(displacement), y.dot(displacement)]
    }

    /// Two directions that span the tangent plane of a slot, and its normal.
    pub fn frame(&self, slot: usize) -> &[Vector3; 3] {
        &self.frames[slot]
    }
}

/// Spreads element numbers over a hash table; nobody chooses them to collide.
#[derive(Default)]
pub(super) struct Scatter(u64);

impl Hasher for Scatter {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(u32::from(byte));
        }
    }

    fn write_u32(&mut self, number: u32) {
        // Fibonacci hashing: both ends of the word are well mixed.
        let mixed = (self.0 ^ u64::from(number)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 32);
    }
}

/// Two unit directions that span the tangent plane, and the normal on the side that sees it.
pub(super) fn frame(mesh: &ShellMesh, seen: Seen) -> [Vector3; 3] {
    let normal = mesh.normals()[seen.element as usize];
    let normal = if seen.from_below { -normal } else { normal };
    let x = mesh.corner_points(seen.element as usize);
    let along = x[2] - x[0];
    let along = (along - normal * along.dot(&normal))
        .try_normalize(0.0)
        .unwrap_or_default();
    [along, normal.cross(&along), normal]
}

/// Where the direction u across the normal n₁ lies in the plane of `to` after the smallest rotation that takes
/// normal to normal: u − (n₂ · u) / (1 + n₁ · n₂) · (n₁ + n₂).
pub(super) fn spin([u, n1]: [&Vector3; 2], [x, y, n2]: &[Vector3; 3]) -> Spin {
    let fold = n2.dot(u) / (1.0 + n1.dot(n2));
    let (cos, sin) = (x.dot(u) - fold * x.dot(n1), y.dot(u) - fold * y.dot(n1));
    Spin {
        cos,
        sin,
        cos2: cos * cos - sin * sin,
        sin2: 2.0 * cos * sin,
    }
}

/// Cosine of the angle by which the sheet is bent between two neighbours, whichever side their normals are on.
pub(super) fn cos_between(mesh: &ShellMesh, neighbours: &Neighbours, a: usize, b: usize) -> f64 {
    neighbours.seen_cos(a, b, mesh.normals()[a].dot(&mesh.normals()[b]))
}

/// True if the gauge of the sheet changes between two neighbours, or the part. `thickness` may be empty.
pub(super) fn is_weld_line(
    (mesh, neighbours, thickness): (&ShellMesh, &Neighbours, &[f64]),
    a: usize,
    b: usize,
) -> bool {
    if mesh.parts()[a] != mesh.parts()[b] {
        return true;
    }
    let (Some(own), Some(other)) = (thickness.get(a), thickness.get(b)) else {
        return false;
    };
    let jump = (own - other).abs();
    if jump <= WELD_LINE_JUMP * own.min(*other) {
        return false;
    }
    // The largest change from an element to one that lies on, away from the jump.
    let change = |from: usize, away: usize| {
        let centre = mesh.centroids()[from];
        let ahead = centre - mesh.centroids()[away];
        let lies_ahead = |&next: &usize| {
            let to_next = mesh.centroids()[next] - centre;
            to_next.dot(&ahead) > AHEAD_COS * to_next.norm() * ahead.norm()
                && mesh.parts()[next] == mesh.parts()[from]
        };
        let next = neighbours.of(from).iter().map(|&next| next as usize);
        let changes = next
            .filter(lies_ahead)
            .map(|next| (thickness[next] - thickness[from]).abs());
        changes.fold(0.0, f64::max)
    };
    jump > JUMP_OVER_SLOPE * change(a, b).max(change(b, a))
}
