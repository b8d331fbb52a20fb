//! Which collapses keep the mesh a mesh.

use nalgebra::Vector3;

use super::surface::Surface;

/// Why a collapse may not be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would pinch the surface, double a triangle or close a border loop.
    Link,
    /// A triangle that stays would turn over or lose its area.
    Flip,
}

/// Marks of the vertices around an edge, reused from one test to the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Marks {
    of_vertex: Vec<u32>,
    round: u32,
    ends: Vec<u32>,
}

impl Marks {
    pub(super) fn new(n_vertices: usize) -> Self {
        Self {
            of_vertex: vec![0; n_vertices],
            ..Self::default()
        }
    }

    /// Starts a test; two fresh marks, `round` and `round + 1`.
    fn begin(&mut self) -> u32 {
        if self.round >= u32::MAX - 4 {
            self.of_vertex.fill(0);
            self.round = 0;
        }
        self.round += 2;
        self.ends.clear();
        self.round
    }
}

/// The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999) for the edge `a`–`b`: the
/// vertices joined to both ends are just those opposite to the edge, and no two triangles become
/// one. With `may_close`, one more common neighbour is allowed if it closes a border loop of three.
pub(super) fn link_condition(
    surface: &Surface,
    marks: &mut Marks,
    a: u32,
    b: u32,
    may_close: bool,
) -> bool {
    let mark = marks.begin();
    for (_, face) in surface.faces_around(a) {
        let [next, last] = face.others(a);
        if next == b || last == b {
            marks.ends.push(next ^ last ^ b);
        }
        marks.of_vertex[next as usize] = mark;
        marks.of_vertex[last as usize] = mark;
    }
    let n_sides = marks.ends.len();
    if n_sides == 0 || surface.around(a).len() + surface.around(b).len() <= 2 * n_sides {
        // Nothing of the component would be left.
        return false;
    }
    if marks.ends.iter().any(|&v| surface.around(v).len() == 1) {
        // It would be left without a triangle.
        return false;
    }
    let mut n_common = 0;
    let mut outsider = None;
    let mut may_double = false;
    for (_, face) in surface.faces_around(b) {
        let others = face.others(b);
        may_double |= others
            .iter()
            .all(|&v| v != a && marks.of_vertex[v as usize] >= mark);
        for v in others {
            if v != a && marks.of_vertex[v as usize] == mark {
                marks.of_vertex[v as usize] = mark + 1;
                n_common += 1;
                if !marks.ends.contains(&v) {
                    outsider = Some(v);
                }
            }
        }
    }
    let closes = |x: u32| {
        n_sides == 1 && surface.sides(a, x).count() == 1 && surface.sides(b, x).count() == 1
    };
    let joined_rightly = match outsider {
        None => n_common == n_sides,
        Some(x) => may_close && n_common == n_sides + 1 && closes(x),
    };
    joined_rightly && !(may_double && doubles_a_triangle(surface, marks, a, b))
}

/// True if a triangle (a, c, d) and a triangle (b, c, d) would become one. That needs c and d to
/// be joined to both ends, so both are opposite to the edge.
fn doubles_a_triangle(surface: &Surface, marks: &Marks, a: u32, b: u32) -> bool {
    let both_opposite = |vertex: u32| {
        surface.faces_around(vertex).filter_map(move |(_, face)| {
            let [c, d] = face.others(vertex);
            let are_ends = marks.ends.contains(&c) && marks.ends.contains(&d);
            are_ends.then_some([c.min(d), c.max(d)])
        })
    };
    both_opposite(a).any(|pair| both_opposite(b).any(|other| other == pair))
}

/// True if no triangle that stays turns by more than the angle with cosine `min_cosine`, or loses
/// its area, when `a` and `b` both move to `position`. Triangles without area may do as they like.
/// Leaves in `turned` the triangles that stay, each with its new normal as long as twice its area;
/// not all of them if the answer is no.
pub(super) fn keeps_orientation(
    surface: &Surface,
    [a, b]: [u32; 2],
    position: &Vector3<f64>,
    min_cosine: f64,
    turned: &mut Vec<(u32, Vector3<f64>)>,
) -> bool {
    turned.clear();
    let mut keeps = |moving: u32, other: u32| {
        surface.faces_around(moving).all(|(t, face)| {
            let [next, last] = face.others(moving);
            if next == other || last == other {
                return true;
            }
            let p = surface.position(next);
            let side = surface.position(last) - p;
            let after = side.cross(&(position - p));
            turned.push((t, after));
            let before2 = face.pull.norm_squared();
            let dot = face.pull.dot(&after);
            (dot > 0.0 && dot * dot >= min_cosine * min_cosine * before2 * after.norm_squared())
                || 2.0 * before2 <= 1e-12 * side.norm_squared()
        })
    };
    keeps(a, b) && keeps(b, a)
}
