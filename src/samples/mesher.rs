//! Meshes a trimmed sheet: constrained Delaunay triangles over scattered nodes, paired to
//! quadrilaterals where that makes good ones, then smoothed.

use spade::{ConstrainedDelaunayTriangulation, Point2 as SpadePoint, Triangulation};

use super::path::Flat;
use super::scatter::{Layout, Scatter, Trim, scatter};
use super::sheet::Sheet;

/// Elements over nodes in (u, v). A triangle repeats its last node.
#[derive(Debug, Clone)]
pub(super) struct FlatMesh {
    pub(super) nodes: Vec<Flat>,
    pub(super) elements: Vec<[u32; 4]>,
}

/// Quadrilaterals whose corners leave 90° by more than this, radians, stay two triangles.
const MAX_CORNER_ERROR: f64 = 0.75;
/// Rounds of smoothing.
const SMOOTHING_ROUNDS: usize = 4;

/// A mesh with the layout's size.
pub(super) fn mesh(sheet: &Sheet, trim: &Trim, layout: &Layout) -> FlatMesh {
    mesh_nodes(sheet, scatter(sheet, trim, layout, 0))
}

/// A mesh near the layout's size with exactly `n_triangles` once its quadrilaterals are split.
///
/// The size is scaled until the nodes make slightly too many triangles, then single free nodes
/// are left out: each takes two triangles with it.
pub(super) fn mesh_exactly(
    sheet: &Sheet,
    trim: &Trim,
    layout: &Layout,
    n_triangles: usize,
) -> FlatMesh {
    let mut layout = *layout;
    let mut best: Option<(usize, Layout)> = None;
    let mut aim = 1.002;
    for _ in 0..10 {
        let count = scatter(sheet, trim, &layout, 0).n_triangles();
        if count >= n_triangles && best.is_none_or(|(least, _)| count < least) {
            best = Some((count, layout));
        }
        if count >= n_triangles && count < n_triangles + n_triangles / 200 {
            break;
        }
        if count < n_triangles {
            aim += 0.001;
        }
        layout.size *= (count as f64 / (aim * n_triangles as f64)).sqrt();
    }
    let Some((count, layout)) = best else {
        return mesh_nodes(sheet, scatter(sheet, trim, &layout, 0));
    };
    let mut nodes = scatter(sheet, trim, &layout, (count - n_triangles) % 2);
    let surplus = nodes.n_triangles().saturating_sub(n_triangles) / 2;
    let n_border = nodes.n_border();
    let n_free = nodes.points.len() - n_border;
    // Evenly spread over the list, so over the sheet.
    for k in (0..surplus).rev() {
        nodes
            .points
            .remove(n_border + (2 * k + 1) * n_free / (2 * surplus));
    }
    mesh_nodes(sheet, nodes)
}

fn mesh_nodes(sheet: &Sheet, nodes: Scatter) -> FlatMesh {
    let triangles = triangulate(&nodes);
    let n_border = nodes.n_border();
    let elements = pair(sheet, &nodes.points, &triangles);
    let mut mesh = FlatMesh {
        nodes: nodes.points,
        elements,
    };
    smooth(&mut mesh, n_border);
    mesh
}

/// Constrained Delaunay triangles inside the border loops, counter-clockwise.
fn triangulate(nodes: &Scatter) -> Vec<[u32; 3]> {
    let mut constraints = Vec::with_capacity(nodes.n_border());
    let mut start = 0;
    for &n in &nodes.loops {
        constraints.extend((0..n).map(|i| [start + i, start + (i + 1) % n]));
        start += n;
    }
    let points = nodes
        .points
        .iter()
        .map(|p| SpadePoint::new(p.x, p.y))
        .collect();
    let triangulation: ConstrainedDelaunayTriangulation<SpadePoint<f64>> =
        ConstrainedDelaunayTriangulation::bulk_load_cdt(points, constraints)
            .expect("trim curves of the parts are finite and do not cross");
    let n_border = nodes.n_border();
    let inside = |corners: &[usize; 3]| {
        // Constraints separate inside from outside, so a free node decides.
        corners.iter().any(|&c| c >= n_border) || {
            let [a, b, c] = corners.map(|c| nodes.points[c]);
            // Straight borders are straight up to rounding only, and the hull fills the rest.
            let flat = (b - a).perp(&(c - a)) < 1e-9 * (b - a).norm() * (c - a).norm();
            !flat && nodes.contains(&Flat::from((a.coords + b.coords + c.coords) / 3.0))
        }
    };
    let mut triangles: Vec<[u32; 3]> = triangulation
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index()))
        .filter(inside)
        .map(|corners| canonical(corners.map(|c| c as u32)))
        .collect();
    triangles.sort_unstable();
    triangles
}

/// The same triangle, smallest node first.
fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// Joins triangles to quadrilaterals, the best-shaped first.
fn pair(sheet: &Sheet, nodes: &[Flat], triangles: &[[u32; 3]]) -> Vec<[u32; 4]> {
    let mut sides: Vec<([u32; 2], usize, u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        for [u, v, opposite] in [[a, b, c], [b, c, a], [c, a, b]] {
            sides.push(([u.min(v), u.max(v)], t, opposite));
        }
    }
    sides.sort_unstable();
    let points: Vec<_> = nodes.iter().map(|p| sheet.point(p)).collect();
    let mut pairs: Vec<(u64, usize, usize, [u32; 4])> = Vec::new();
    for couple in sides.windows(2) {
        let ([u, v], first, apex) = couple[0];
        if couple[1].0 != [u, v] {
            continue;
        }
        let corners = triangles[first];
        let forward = (0..3).any(|i| corners[i] == u && corners[(i + 1) % 3] == v);
        let quad = if forward {
            [u, couple[1].2, v, apex]
        } else {
            [u, apex, v, couple[1].2]
        };
        let worst = (0..4)
            .map(|i| {
                let [before, here, after] =
                    [quad[(i + 3) % 4], quad[i], quad[(i + 1) % 4]].map(|n| points[n as usize]);
                let flat =
                    [quad[(i + 3) % 4], quad[i], quad[(i + 1) % 4]].map(|n| nodes[n as usize]);
                let convex = (flat[2] - flat[1]).perp(&(flat[0] - flat[1])) > 0.0;
                let corner = (before - here).angle(&(after - here));
                if convex {
                    (corner - std::f64::consts::FRAC_PI_2).abs()
                } else {
                    f64::INFINITY
                }
            })
            .fold(0.0, f64::max);
        if worst < MAX_CORNER_ERROR {
            // Rounded, so that equal lattice cells are joined in their order.
            pairs.push(((worst * 1e6) as u64, first, couple[1].1, quad));
        }
    }
    pairs.sort_unstable();
    let mut used = vec![false; triangles.len()];
    let mut elements = Vec::with_capacity(triangles.len());
    for (_, first, second, quad) in pairs {
        if !used[first] && !used[second] {
            used[first] = true;
            used[second] = true;
            elements.push((first, quad));
        }
    }
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        if !used[t] {
            elements.push((t, [a, b, c, c]));
        }
    }
    elements.sort_unstable();
    elements.into_iter().map(|(_, element)| element).collect()
}

/// Moves each free node to the mean of its neighbours where the worst corner around it improves
/// (smart Laplacian smoothing, Freitag 1997). The lattice stays as it is.
fn smooth(mesh: &mut FlatMesh, n_border: usize) {
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); mesh.nodes.len()];
    for (e, corners) in mesh.elements.iter().enumerate() {
        for (i, &corner) in corners.iter().enumerate() {
            if i < 3 || corner != corners[2] {
                around[corner as usize].push(e as u32);
            }
        }
    }
    for _ in 0..SMOOTHING_ROUNDS {
        for (node, around) in around.iter().enumerate().skip(n_border) {
            let old = mesh.nodes[node];
            let before = worst_corner(mesh, around);
            let mut sum = nalgebra::Vector2::zeros();
            let mut n = 0.0;
            for &e in around {
                let corners = mesh.elements[e as usize];
                let count = if corners[2] == corners[3] { 3 } else { 4 };
                let at = (0..count)
                    .find(|&i| corners[i] as usize == node)
                    .unwrap_or(0);
                for other in [(at + 1) % count, (at + count - 1) % count] {
                    sum += mesh.nodes[corners[other] as usize].coords;
                    n += 1.0;
                }
            }
            mesh.nodes[node] = Flat::from(sum / n);
            if worst_corner(mesh, around) <= before + 1e-9 {
                mesh.nodes[node] = old;
            }
        }
    }
}

/// Smallest quality of the elements' corners: the sine of a quadrilateral's corner, for a triangle
/// scaled so that 60° counts as 1. Negative where an element is inverted.
fn worst_corner(mesh: &FlatMesh, elements: &[u32]) -> f64 {
    let mut worst = f64::INFINITY;
    for &e in elements {
        let corners = mesh.elements[e as usize];
        let (count, best) = if corners[2] == corners[3] {
            (3, 0.75_f64.sqrt())
        } else {
            (4, 1.0)
        };
        for i in 0..count {
            let [before, here, after] = [(i + count - 1) % count, i, (i + 1) % count]
                .map(|k| mesh.nodes[corners[k] as usize]);
            let (next, previous) = (after - here, before - here);
            let sine = next.perp(&previous) / (next.norm() * previous.norm());
            worst = worst.min(sine / best);
        }
    }
    worst
}
