//! Which collapses keep the mesh a mesh.

use nalgebra::Vector3;

use super::fans::Fans;

/// Why a collapse may not be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// It would pinch the surface, double a triangle or close a border loop.
    Link,
    /// A triangle that stays would turn over or lose its area.
    Flip,
}

/// Where a vertex lies with respect to features: borders, seams between parts, and edges with
/// three or more triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Inside the surface.
    Free,
    /// On exactly two feature edges: slides along them.
    Line,
    /// On another number of feature edges: stays where it is.
    Corner,
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
    fans: &Fans,
    marks: &mut Marks,
    a: u32,
    b: u32,
    may_close: bool,
) -> bool {
    let mark = marks.begin();
    let mut n_sides = 0;
    for (_, opposite) in fans.sides(a, b) {
        n_sides += 1;
        marks.ends.push(opposite);
        if fans.around(opposite).len() == 1 {
            // It would be left without a triangle.
            return false;
        }
    }
    if n_sides == 0 || fans.around(a).len() + fans.around(b).len() <= 2 * n_sides {
        // Nothing of the component would be left.
        return false;
    }
    for &t in fans.around(a) {
        for v in fans.triangles[t as usize] {
            marks.of_vertex[v as usize] = mark;
        }
    }
    let mut n_common = 0;
    let mut outsider = None;
    for &t in fans.around(b) {
        for v in fans.triangles[t as usize] {
            if v != a && v != b && marks.of_vertex[v as usize] == mark {
                marks.of_vertex[v as usize] = mark + 1;
                n_common += 1;
                if !marks.ends.contains(&v) {
                    outsider = Some(v);
                }
            }
        }
    }
    let closes =
        |x: u32| n_sides == 1 && fans.sides(a, x).count() == 1 && fans.sides(b, x).count() == 1;
    let joined_rightly = match outsider {
        None => n_common == n_sides,
        Some(x) => may_close && n_common == n_sides + 1 && closes(x),
    };
    joined_rightly && !doubles_a_triangle(fans, marks, a, b)
}

/// True if a triangle (a, c, d) and a triangle (b, c, d) would become one. That needs c and d to
/// be joined to both ends, so both are opposite to the edge.
fn doubles_a_triangle(fans: &Fans, marks: &Marks, a: u32, b: u32) -> bool {
    let both_opposite = |vertex: u32| {
        fans.around(vertex).iter().filter_map(move |&t| {
            let mut others = fans.triangles[t as usize]
                .into_iter()
                .filter(move |&v| v != vertex);
            let pair = [others.next()?, others.next()?];
            pair.iter()
                .all(|v| marks.ends.contains(v))
                .then(|| [pair[0].min(pair[1]), pair[0].max(pair[1])])
        })
    };
    both_opposite(a).any(|pair| both_opposite(b).any(|other| other == pair))
}

/// True if no triangle that stays turns by more than the angle with cosine `min_cosine`, or loses
/// its area, when `a` and `b` both move to `position`. Triangles without area may do as they like.
pub(super) fn keeps_orientation(
    fans: &Fans,
    a: u32,
    b: u32,
    position: &Vector3<f64>,
    min_cosine: f64,
) -> bool {
    let keeps = |moving: u32, other: u32| {
        fans.around(moving).iter().all(|&t| {
            let corners = fans.triangles[t as usize];
            if corners.contains(&other) {
                return true;
            }
            let i = usize::from(corners[1] == moving) + 2 * usize::from(corners[2] == moving);
            let at = |k: usize| fans.positions[corners[k] as usize];
            let (old, p, q) = (at(i), at((i + 1) % 3), at((i + 2) % 3));
            let side = q - p;
            let before = (old - p).cross(&side);
            let after = (position - p).cross(&side);
            let product = before.norm_squared() * after.norm_squared();
            let dot = before.dot(&after);
            (dot > 0.0 && dot * dot >= min_cosine * min_cosine * product)
                || before.norm_squared() <= 1e-24 * side.norm_squared().powi(2)
        })
    };
    keeps(a, b) && keeps(b, a)
}
