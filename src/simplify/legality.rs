//! Which collapses keep the mesh a mesh.

use std::hint::select_unpredictable;

use nalgebra::Vector3;

use super::surface::CollapsingMesh;

/// Why a collapse may not be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would pinch the surface, double a triangle or close a border loop.
    Link,
    /// A triangle that stays would turn over or lose its area.
    Flip,
}

/// What lies around the edge at hand, reused from one edge to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Ring {
    /// The triangles with both ends, each with the vertex opposite to the edge.
    gone: Vec<(u32, u32)>,
    /// The triangles with one end, and room for more.
    stay: Vec<Staying>,
    n_stay: usize,
    /// How many of them have the first end.
    n_at_first: usize,
    marks: Vec<u32>,
    round: u32,
}

/// A triangle that a collapse leaves.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Staying {
    pub(super) face: u32,
    /// Its corners that do not move, in its direction of travel.
    pub(super) others: [u32; 2],
    /// Its normal after the collapse, as long as twice its area.
    pub(super) twice_area: Vector3<f64>,
}

impl Ring {
    pub(super) fn new(n_vertices: usize) -> Self {
        Self {
            marks: vec![0; n_vertices],
            ..Self::default()
        }
    }

    /// The triangles with both ends of the edge, each with the vertex opposite to it.
    pub(super) fn gone(&self) -> &[(u32, u32)] {
        &self.gone
    }

    /// The triangles with one end of the edge, those with the first one first.
    pub(super) fn stay(&self) -> &[Staying] {
        &self.stay[..self.n_stay]
    }

    /// The triangles with the second end only.
    pub(super) fn stay_at_second(&self) -> &[Staying] {
        &self.stay[self.n_at_first..self.n_stay]
    }

    /// Starts a test around at most so many triangles; three fresh marks from `round` on.
    fn begin(&mut self, n_triangles: usize) -> u32 {
        if self.round >= u32::MAX - 6 {
            self.marks.fill(0);
            self.round = 0;
        }
        self.round += 3;
        self.gone.clear();
        self.n_stay = 0;
        if self.stay.len() < n_triangles {
            self.stay.resize(n_triangles, Staying::default());
        }
        self.round
    }

    /// Notes a triangle that stays if `stays`, without a branch.
    fn note(&mut self, face: u32, others: [u32; 2], stays: bool) {
        let slot = &mut self.stay[self.n_stay];
        (slot.face, slot.others) = (face, others);
        self.n_stay += usize::from(stays);
    }
}

/// The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999) for the edge `a`–`b`: the
/// vertices joined to both ends are just those opposite to the edge, and no two triangles become
/// one. With `may_close`, one more common neighbour is allowed if it closes a border loop of three.
/// Fills `ring`, all of it if the answer is yes.
pub(super) fn link_condition(
    surface: &CollapsingMesh,
    ring: &mut Ring,
    a: u32,
    b: u32,
    may_close: bool,
) -> bool {
    let n_around = surface.around(a).len() + surface.around(b).len();
    let mark = ring.begin(n_around + 1);
    for (t, face) in surface.faces_around(a) {
        let [next, last] = face.others(a);
        let is_at_edge = next == b || last == b;
        if is_at_edge {
            ring.gone.push((t, next ^ last ^ b));
        }
        ring.note(t, [next, last], !is_at_edge);
        ring.marks[next as usize] = mark;
        ring.marks[last as usize] = mark;
    }
    ring.n_at_first = ring.n_stay;
    let n_sides = ring.gone.len();
    if n_sides == 0 || n_around <= 2 * n_sides {
        // Nothing of the component would be left.
        return false;
    }
    for &(_, opposite) in &ring.gone {
        if surface.around(opposite).len() == 1 {
            // It would be left without a triangle.
            return false;
        }
        ring.marks[opposite as usize] = mark + 1;
    }
    // Common neighbours that are not opposite to the edge, and the last of them.
    let mut n_outsiders = 0;
    let mut outsider = 0;
    let mut may_double = false;
    for (t, face) in surface.faces_around(b) {
        let others = face.others(b);
        ring.note(t, others, others[0] != a && others[1] != a);
        let marks = others.map(|v| ring.marks[v as usize]);
        may_double |= marks[0] >= mark && marks[1] >= mark;
        for (v, seen) in others.into_iter().zip(marks) {
            let is_outsider = seen == mark;
            n_outsiders += u32::from(is_outsider);
            outsider = select_unpredictable(is_outsider, v, outsider);
            // Each is counted once.
            ring.marks[v as usize] = select_unpredictable(is_outsider, mark + 2, seen);
        }
    }
    let closes = |x: u32| {
        n_sides == 1 && surface.sides(a, x).count() == 1 && surface.sides(b, x).count() == 1
    };
    let joined_rightly = match n_outsiders {
        0 => true,
        1 => may_close && closes(outsider),
        _ => false,
    };
    joined_rightly && !(may_double && doubles_a_triangle(surface, ring, a, b))
}

/// True if a triangle (a, c, d) and a triangle (b, c, d) would become one. That needs c and d to
/// be joined to both ends, so both are opposite to the edge.
fn doubles_a_triangle(surface: &CollapsingMesh, ring: &Ring, a: u32, b: u32) -> bool {
    let is_opposite = |v: u32| ring.gone.iter().any(|&(_, opposite)| opposite == v);
    let both_opposite = |vertex: u32| {
        surface.faces_around(vertex).filter_map(move |(_, face)| {
            let [c, d] = face.others(vertex);
            (is_opposite(c) && is_opposite(d)).then_some([c.min(d), c.max(d)])
        })
    };
    both_opposite(a).any(|pair| both_opposite(b).any(|other| other == pair))
}

/// True if no triangle that stays turns by more than the angle with cosine `min_cosine`, or loses
/// its area, when both ends of the edge whose `ring` is filled move to `position`. Triangles without
/// area may do as they like. Leaves the new normals in the ring; not all if the answer is no.
pub(super) fn keeps_orientation(
    surface: &CollapsingMesh,
    ring: &mut Ring,
    position: &Vector3<f64>,
    min_cosine: f64,
) -> bool {
    ring.stay[..ring.n_stay].iter_mut().all(|staying| {
        let [p, q] = staying.others.map(|v| surface.position(v));
        let side = q - p;
        let after = side.cross(&(position - p));
        staying.twice_area = after;
        let pull = &surface.faces[staying.face as usize].pull;
        let before2 = pull.norm_squared();
        let dot = pull.dot(&after);
        (dot > 0.0 && dot * dot >= min_cosine * min_cosine * before2 * after.norm_squared())
            || 2.0 * before2 <= 1e-12 * side.norm_squared()
    })
}
