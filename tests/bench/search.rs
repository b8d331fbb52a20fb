//! Building the search trees and asking them, on a floor-like sheet of 34,848 triangles:
//! `cargo bench --no-default-features --bench search`. One thread except for the build.
//!
//! Queries lie around the surface at ±0.1 %, ±1 % and ±5 % of the diagonal, in the order of the
//! mesh, as registration asks them. "hinted" asks again after a motion of a tenth of that, with the
//! last answers as hints. Times are for [`N_QUERIES`] queries.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shapematch::geometry::{Point3, TriMesh, Vector3};
use shapematch::search::{Bvh, ClosestPoint, NormalFilter, PointTree};

const N_QUERIES: usize = 10_000;

/// A 1400 × 1000 mm sheet with a tunnel, beads and a raised rim.
fn floor(n: u32) -> TriMesh {
    let height = |x: f64, y: f64| {
        let tunnel = 120.0 * (-(y / 110.0).powi(4)).exp();
        let beads = 6.0 * (x / 35.0).sin().powi(8);
        let rim = 40.0 * ((x / 700.0).powi(16) + (y / 500.0).powi(16));
        tunnel + beads + rim
    };
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let (x, y) = (1400.0 * (u - 0.5), 1000.0 * (v - 0.5));
            positions.push(Point3::new(x, y, height(x, y)));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            triangles.push([a, a + 1, a + n + 2]);
            triangles.push([a, a + n + 2, a + n + 1]);
        }
    }
    TriMesh::new(positions, triangles).expect("a grid is a mesh")
}

/// A number in −1 … 1 that depends on `i` alone (splitmix64).
fn noise(i: u64) -> f64 {
    let mut z = i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
}

fn queries(mesh: &TriMesh, reach: f64) -> Vec<Point3> {
    (0..N_QUERIES)
        .map(|i| {
            let [a, b, c] = mesh.corners(i * mesh.n_triangles() / N_QUERIES);
            let n = 3 * i as u64;
            let offset = Vector3::new(noise(n), noise(n + 1), noise(n + 2)) * reach;
            Point3::from((a.coords + b.coords + c.coords) / 3.0) + offset
        })
        .collect()
}

fn ask(tree: &impl ClosestPoint, queries: &[Point3], hints: &[Option<u32>]) -> f64 {
    let filter: Option<&NormalFilter> = None;
    let answers = queries
        .iter()
        .zip(hints)
        .filter_map(|(query, &hint)| tree.closest(query, f64::INFINITY, hint, filter));
    answers.map(|hit| hit.distance_sq).sum()
}

fn search(criterion: &mut Criterion) {
    let mesh = Arc::new(floor(132));
    let diagonal = mesh.aabb().diagonal();
    let mut group = criterion.benchmark_group("search");
    group.sample_size(20);
    group.bench_function("build", |b| b.iter(|| Bvh::build(black_box(&mesh).clone())));
    group.throughput(Throughput::Elements(N_QUERIES as u64));
    let tree = Bvh::build(mesh.clone());
    let points = PointTree::build(mesh.positions().to_vec());
    for percent in [0.1, 1.0, 5.0] {
        let reach = diagonal * percent / 100.0;
        let queries = queries(&mesh, reach);
        let none = vec![None; N_QUERIES];
        group.bench_function(format!("closest {percent} %"), |b| {
            b.iter(|| ask(&tree, black_box(&queries), &none));
        });
        let hints: Vec<Option<u32>> = queries
            .iter()
            .map(|query| tree.closest(query, f64::INFINITY, None, None))
            .map(|hit| hit.map(|hit| hit.triangle))
            .collect();
        let moved: Vec<Point3> = queries
            .iter()
            .map(|query| query + Vector3::new(0.1, -0.05, 0.03) * reach)
            .collect();
        group.bench_function(format!("hinted {percent} %"), |b| {
            b.iter(|| ask(&tree, black_box(&moved), &hints));
        });
        group.bench_function(format!("nearest vertex {percent} %"), |b| {
            b.iter(|| {
                let answers = black_box(&queries)
                    .iter()
                    .filter_map(|query| points.nearest(query, f64::INFINITY, None));
                answers.map(|near| near.distance_sq).sum::<f64>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, search);
criterion_main!(benches);
