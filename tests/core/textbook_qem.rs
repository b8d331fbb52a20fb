//! Garland and Heckbert's algorithm written down as plainly as it goes: summed 4 × 4 quadrics, all
//! edges looked at for every collapse. Slow, and independent of the program's own.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix4, Vector4};
use shapematch::geometry::{Point3, TriMesh};

type Edges = BTreeMap<[u32; 2], BTreeSet<u32>>;

fn plane(normal: &nalgebra::Vector3<f64>, through: &Point3, weight: f64) -> Matrix4<f64> {
    let p = Vector4::new(normal.x, normal.y, normal.z, -normal.dot(&through.coords));
    p * p.transpose() * weight
}

/// Every edge with the vertices opposite to it.
fn edges_of(triangles: &[[u32; 3]]) -> Edges {
    let mut edges = Edges::new();
    for &[a, b, c] in triangles {
        for (u, v, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            edges
                .entry([u.min(v), u.max(v)])
                .or_default()
                .insert(opposite);
        }
    }
    edges
}

fn start_quadrics(mesh: &TriMesh) -> Vec<Matrix4<f64>> {
    let mut quadrics = vec![Matrix4::zeros(); mesh.n_vertices()];
    let edges = edges_of(mesh.triangles());
    for (t, corners) in mesh.triangles().iter().enumerate() {
        let points = mesh.corners(t);
        let face = plane(&mesh.normal(t), &points[0], mesh.triangle_area(t));
        for i in 0..3 {
            quadrics[corners[i] as usize] += face;
            let (u, v) = (corners[i], corners[(i + 1) % 3]);
            if edges[&[u.min(v), u.max(v)]].len() == 1 {
                let along = points[(i + 1) % 3] - points[i];
                let out = along.cross(&mesh.normal(t)).normalize();
                let wall = plane(&out, &points[i], 1000.0 * along.norm_squared());
                quadrics[u as usize] += wall;
                quadrics[v as usize] += wall;
            }
        }
    }
    quadrics
}

fn price(q: &Matrix4<f64>, u: &Point3, v: &Point3) -> (f64, Point3) {
    let cost = |p: &Point3| (p.to_homogeneous().transpose() * q * p.to_homogeneous())[0];
    let a = q.fixed_view::<3, 3>(0, 0).into_owned();
    let b = q.fixed_view::<3, 1>(0, 3).into_owned();
    let least = a.svd(true, true).solve(&-b, 1e-9 * a.norm());
    let middle = nalgebra::center(u, v);
    let mut candidates = vec![*u, *v, middle];
    // A singular system is solved nearest to the middle of the edge.
    if let (Ok(_), Ok(step)) = (
        least,
        a.svd(true, true)
            .solve(&(-b - a * middle.coords), 1e-9 * a.norm()),
    ) {
        candidates.push(middle + step);
    }
    candidates
        .into_iter()
        .map(|p| (cost(&p), p))
        .min_by(|x, y| x.0.total_cmp(&y.0))
        .unwrap()
}

fn legal(
    triangles: &[[u32; 3]],
    edges: &Edges,
    positions: &[Point3],
    e: [u32; 2],
    to: Point3,
) -> bool {
    let ring = |x: u32| -> BTreeSet<u32> {
        let around = triangles.iter().filter(|c| c.contains(&x));
        around.flatten().copied().filter(|&v| v != x).collect()
    };
    let on_border = |x: u32| {
        edges
            .iter()
            .any(|(f, sides)| f.contains(&x) && sides.len() == 1)
    };
    let [u, v] = e;
    let common: BTreeSet<u32> = ring(u).intersection(&ring(v)).copied().collect();
    if common != edges[&e] || (edges[&e].len() == 2 && on_border(u) && on_border(v)) {
        return false;
    }
    let moved = |x: u32| {
        if e.contains(&x) {
            to
        } else {
            positions[x as usize]
        }
    };
    triangles
        .iter()
        .filter(|c| c.contains(&u) != c.contains(&v))
        .all(|&corners| {
            let [a, b, c] = corners.map(|x| positions[x as usize]);
            let [p, q, r] = corners.map(moved);
            let (before, after) = ((b - a).cross(&(c - a)), (q - p).cross(&(r - p)));
            before.dot(&after) > 0.25 * before.norm() * after.norm()
        })
}

/// Reduces a manifold mesh to at most `max_triangles`. O(edges²).
pub fn reduce(mesh: &TriMesh, max_triangles: usize) -> TriMesh {
    let mut positions = mesh.positions().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    let mut quadrics = start_quadrics(mesh);
    while triangles.len() > max_triangles {
        let edges = edges_of(&triangles);
        let mut prices: Vec<([u32; 2], (f64, Point3))> = edges
            .keys()
            .map(|&[u, v]| {
                let (u, v) = (u as usize, v as usize);
                let sum = quadrics[u] + quadrics[v];
                (
                    [u as u32, v as u32],
                    price(&sum, &positions[u], &positions[v]),
                )
            })
            .collect();
        prices.sort_by(|x, y| x.1.0.total_cmp(&y.1.0));
        let cheapest = prices
            .into_iter()
            .find(|(e, (_, to))| legal(&triangles, &edges, &positions, *e, *to));
        let Some(([u, v], (_, to))) = cheapest else {
            break;
        };
        positions[u as usize] = to;
        quadrics[u as usize] = quadrics[u as usize] + quadrics[v as usize];
        for corners in &mut triangles {
            *corners = corners.map(|x| if x == v { u } else { x });
        }
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    }
    TriMesh::new(positions, triangles).unwrap()
}
