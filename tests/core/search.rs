//! The trees against plain loops over everything, on shapes made to be awkward.

use std::sync::Arc;

use proptest::prelude::*;
use shapematch::geometry::{Point3, TriMesh, Vector3};
use shapematch::monitor::Monitor;
use shapematch::search::{BruteForce, Bvh, ClosestPoint, NormalFilter, PointTree, closest_many};

/// A number in −1 … 1 that depends on seed and index alone (splitmix64).
fn noise(seed: u64, i: u64) -> f64 {
    let mut z = (seed << 32 ^ i).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
}

fn vector(seed: u64, i: u64) -> Vector3 {
    Vector3::new(
        noise(seed, 3 * i),
        noise(seed, 3 * i + 1),
        noise(seed, 3 * i + 2),
    )
}

fn mesh(positions: Vec<Point3>, triangles: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, triangles).unwrap()
}

/// A curved sheet of 2 n² triangles, 100 units wide, with a flange folded back under it.
fn sheet(n: u32) -> TriMesh {
    let mut positions = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let angle = (u - 0.7).max(0.0) * 10.0;
            let x = 100.0 * u.min(0.7) + 10.0 * angle.sin();
            let z = 8.0 * (5.0 * v).sin() - 10.0 * (1.0 - angle.cos());
            positions.push(Point3::new(x, 100.0 * v, z));
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
    mesh(positions, triangles)
}

/// Triangles strewn about, a third of them needles, a few without any area.
fn soup(seed: u64, n: u32) -> TriMesh {
    let mut positions = Vec::new();
    for t in 0..u64::from(n) {
        let a = Point3::from(vector(seed, 3 * t) * 50.0);
        let long = vector(seed, 3 * t + 1) * 20.0;
        let thin = [1.0, 1e-3, 1e-9, 1e-14, 0.0][(t % 15).min(4) as usize];
        positions.extend([
            a,
            a + long,
            a + long * 0.3 + vector(seed, 3 * t + 2) * 10.0 * thin,
        ]);
    }
    positions.push(Point3::from(vector(seed, 1 << 20) * 50.0));
    let last = positions.len() as u32 - 1;
    let mut triangles: Vec<_> = (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    triangles.push([last, last, last]);
    triangles.push([last, last, 0]);
    mesh(positions, triangles)
}

fn shifted(of: &TriMesh, by: f64) -> TriMesh {
    let positions = of.positions().iter().map(|p| p + Vector3::new(by, -by, by));
    mesh(positions.collect(), of.triangles().to_vec())
}

/// Points on, near and far from the mesh.
fn queries(around: &TriMesh, seed: u64, n: u64) -> Vec<Point3> {
    let size = around.aabb().diagonal().max(1.0);
    (0..n)
        .map(|i| {
            let t = ((noise(seed, 7 * i) + 1.0) / 2.0 * around.n_triangles() as f64) as usize;
            let [a, b, c] = around.corners(t.min(around.n_triangles() - 1));
            let reach = [0.0, 1e-9, 1e-3, 0.05, 1.0, 30.0][(i % 6) as usize];
            let on = match i % 4 {
                0 => a,
                1 => a + (b - a) * 0.25,
                _ => a + (b - a) * 0.2 + (c - a) * 0.3,
            };
            on + vector(seed + 1, i) * reach * size
        })
        .collect()
}

/// Every answer of the tree equals the plain loop's to the last bit, whatever the hint.
fn check(shape: TriMesh, seed: u64, n_queries: u64) {
    let shape = Arc::new(shape);
    let (tree, brute) = (Bvh::build(shape.clone()), BruteForce::new(shape.clone()));
    let size = shape.aabb().diagonal();
    for (i, query) in queries(&shape, seed, n_queries).iter().enumerate() {
        let hints = [
            None,
            Some(i as u32 % shape.n_triangles() as u32),
            Some(u32::MAX),
        ];
        let direction = vector(seed + 2, i as u64).normalize();
        let filter = NormalFilter {
            direction,
            min_cos: 0.5,
        };
        for limit in [f64::INFINITY, 0.01 * size, 0.0] {
            for filter in [None, Some(&filter)] {
                let expected = brute.closest(query, limit, None, filter);
                for hint in hints {
                    assert_eq!(
                        tree.closest(query, limit, hint, filter),
                        expected,
                        "query {i} {query:?}, limit {limit}, hint {hint:?}, filter {filter:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn sheets_near_and_far_from_the_origin() {
    check(sheet(20), 1, 300);
    check(shifted(&sheet(20), 5e3), 2, 300);
    check(shifted(&sheet(20), 1e6), 3, 300);
}

#[test]
fn soups_with_needles_and_no_area() {
    for seed in 0..6 {
        check(soup(10 + seed, 400), seed, 200);
    }
    check(shifted(&soup(20, 400), 1e6), 20, 200);
}

#[test]
fn one_flat_and_repeated_triangles() {
    let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
    let corners = vec![p(0.0, 0.0), p(4.0, 0.0), p(0.0, 3.0), p(4.0, 3.0)];
    check(mesh(corners.clone(), vec![[0, 1, 2]]), 1, 100);
    check(mesh(corners.clone(), vec![[0, 1, 2], [1, 3, 2]]), 2, 100);
    check(mesh(corners.clone(), vec![[0, 1, 2]; 100]), 3, 100);
    check(mesh(corners, vec![[2, 2, 2]; 9]), 4, 60);
    // An edge there and back, in a direction whose rounding leaves a trace of height.
    let slanted = vec![Point3::new(3.0, 2.0, 2.0), Point3::origin()];
    check(mesh(slanted, vec![[0, 1, 1], [0, 0, 1], [1, 0, 1]]), 5, 100);
}

#[test]
fn sizes_from_tiny_to_huge() {
    for scale in [1e-30, 1e-6, 1e9, 1e30] {
        let of = soup(30, 200);
        let positions = of.positions().iter().map(|p| p * scale).collect();
        let of = mesh(positions, of.triangles().to_vec());
        let (tree, brute) = (Bvh::build(of.clone()), BruteForce::new(of.clone()));
        for i in 0..100 {
            let query = of.corners(i)[1] + vector(31, i as u64) * scale;
            let expected = brute.closest(&query, f64::INFINITY, None, None);
            assert_eq!(tree.closest(&query, f64::INFINITY, None, None), expected);
        }
    }
}

#[test]
fn nothing_to_find() {
    let empty = Bvh::build(TriMesh::default());
    let anywhere = Point3::new(1.0, 2.0, 3.0);
    assert_eq!(empty.closest(&anywhere, f64::INFINITY, Some(0), None), None);
    assert_eq!(empty.first_hit(&anywhere, &Vector3::x()), None);
    let tree = Bvh::build(sheet(3));
    for bad in [f64::NAN, f64::INFINITY] {
        let query = Point3::new(bad, 0.0, 0.0);
        assert_eq!(tree.closest(&query, f64::INFINITY, None, None), None);
    }
    assert_eq!(tree.closest(&anywhere, f64::NAN, None, None), None);
    assert_eq!(tree.closest(&anywhere, -1.0, None, None), None);
    assert_eq!(PointTree::build(vec![]).nearest(&anywhere, 1.0, None), None);
}

#[test]
fn the_filter_finds_the_closest_that_passes() {
    // Two plates, one unit apart, facing away from each other.
    let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    let corners = [p(0.0, 0.0, 0.0), p(9.0, 0.0, 0.0), p(0.0, 9.0, 0.0)];
    let upper = corners.map(|c| c + Vector3::z());
    let both = mesh([corners, upper].concat(), vec![[0, 2, 1], [3, 4, 5]]);
    let tree = Bvh::build(both);
    let up = NormalFilter {
        direction: Vector3::z(),
        min_cos: 0.5,
    };
    let query = p(1.0, 1.0, 0.1);
    let hit = tree
        .closest(&query, f64::INFINITY, Some(0), Some(&up))
        .unwrap();
    assert_eq!((hit.triangle, hit.point), (1, p(1.0, 1.0, 1.0)));
    assert_eq!(tree.closest(&query, 0.5, None, Some(&up)), None);
}

#[test]
fn nearest_points_agree_with_a_plain_loop() {
    for (seed, shift) in [(1, 0.0), (2, 5e3), (3, 1e6)] {
        let mut points: Vec<Point3> = shifted(&soup(seed, 300), shift).positions().to_vec();
        points.extend_from_within(..40);
        points[7].x = f64::NAN;
        let tree = PointTree::build(points.clone());
        for (i, query) in queries(&shifted(&soup(seed, 300), shift), seed, 300)
            .iter()
            .enumerate()
        {
            for limit in [f64::INFINITY, 5.0] {
                let mut best: Option<(f64, u32)> = None;
                for (index, point) in points.iter().enumerate() {
                    let near = ((query - point).norm_squared(), index as u32);
                    if near.0.sqrt() <= limit && best.is_none_or(|best| near < best) {
                        best = Some(near);
                    }
                }
                for hint in [None, Some(i as u32), Some(7)] {
                    let found = tree.nearest(query, limit, hint);
                    assert_eq!(found.map(|n| (n.distance_sq, n.index)), best);
                }
            }
        }
    }
}

#[test]
fn rays_meet_what_a_plain_loop_meets() {
    for (shape, seed) in [(sheet(16), 1), (shifted(&soup(40, 300), 5e3), 2)] {
        let shape = Arc::new(shape);
        let tree = Bvh::build(shape.clone());
        // One tree per triangle leaves the tree no choice.
        let single: Vec<Bvh> = (0..shape.n_triangles())
            .map(|t| Bvh::build(mesh(shape.corners(t).to_vec(), vec![[0, 1, 2]])))
            .collect();
        let mut n_hits = 0;
        for (i, origin) in queries(&shape, seed, 60).iter().enumerate() {
            let direction = match i % 5 {
                0 => Vector3::z(),
                1 => -Vector3::x(),
                _ => vector(seed + 5, i as u64),
            };
            let expected = single
                .iter()
                .enumerate()
                .filter_map(|(t, one)| {
                    Some((one.first_hit(origin, &direction)?.distance, t as u32))
                })
                .min_by(|a, b| a.partial_cmp(b).unwrap());
            let found = tree.first_hit(origin, &direction);
            assert_eq!(
                found.map(|hit| (hit.distance, hit.triangle)),
                expected,
                "ray {i}"
            );
            n_hits += usize::from(found.is_some());
        }
        assert!(n_hits > 5, "only {n_hits} rays hit anything");
    }
}

#[test]
fn many_at_once_are_the_same_as_one_by_one() {
    let shape = sheet(16);
    let points = queries(&shape, 8, 3000);
    let tree = Bvh::build(shape);
    let silent = Monitor::silent();
    let found = closest_many(&tree, &points, 20.0, &silent).unwrap();
    assert_eq!(found.len(), points.len());
    for (point, found) in points.iter().zip(&found) {
        assert_eq!(&tree.closest(point, 20.0, None, None), found);
    }
    silent.request_cancel();
    assert!(closest_many(&tree, &points, 20.0, &silent).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any handful of triangles with small integer corners: flat, degenerate, repeated, touching.
    #[test]
    fn any_small_mesh_agrees(
        corners in prop::collection::vec(prop::array::uniform3(-3_i32..=3), 1..40),
        picks in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..60),
        asked in prop::collection::vec(prop::array::uniform3(-8_i32..=8), 1..20),
    ) {
        let positions: Vec<Point3> = corners
            .iter()
            .map(|&[x, y, z]| Point3::new(x.into(), y.into(), z.into()))
            .collect();
        let triangles: Vec<[u32; 3]> = picks
            .iter()
            .map(|pick| pick.map(|index| index.index(positions.len()) as u32))
            .collect();
        let shape = Arc::new(mesh(positions, triangles));
        let (tree, brute) = (Bvh::build(shape.clone()), BruteForce::new(shape));
        for [x, y, z] in asked {
            let query = Point3::new(x.into(), y.into(), z.into()) * 0.5;
            let expected = brute.closest(&query, f64::INFINITY, None, None);
            prop_assert_eq!(tree.closest(&query, f64::INFINITY, None, None), expected);
            prop_assert_eq!(tree.closest(&query, f64::INFINITY, Some(0), None), expected);
        }
    }
}
