//! The simplifier as its callers see it.

use proptest::prelude::*;
use shapematch::geometry::{BorderEdges, Point3, Topology, TriMesh};
use shapematch::monitor::Monitor;
use shapematch::search::{Bvh, ClosestPoint};
use shapematch::simplify::{
    CollapseSequence, Simplified, SimplifyError, SimplifySettings, Speed, StopReason, simplify,
};

use super::border_deviation::border_deviation;
use super::pan::pan;
use super::textbook_qem;

fn reduce(mesh: &TriMesh, max_triangles: usize) -> Simplified {
    let settings = SimplifySettings::to_triangles(max_triangles);
    simplify(mesh, &settings, &Monitor::silent()).unwrap()
}

fn n_loops(mesh: &TriMesh) -> usize {
    let loops = BorderEdges::of(mesh, &Topology::of(mesh)).loops();
    assert!(loops.iter().all(|l| l.closed));
    loops.len()
}

fn widest_edge(mesh: &TriMesh) -> usize {
    let topology = Topology::of(mesh);
    (0..topology.edges.len())
        .map(|e| topology.triangles_of(e).len())
        .max()
        .unwrap_or(0)
}

/// An n × n grid of unit quads in the plane, each cut in two.
fn plate(n: u32) -> TriMesh {
    let positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| Point3::new(f64::from(i), f64::from(j), 0.0)))
        .collect();
    let triangles = (0..n)
        .flat_map(|j| {
            (0..n).flat_map(move |i| {
                let a = j * (n + 1) + i;
                [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
            })
        })
        .collect();
    TriMesh::new(positions, triangles).unwrap()
}

#[test]
fn a_flat_plate_needs_two_triangles() {
    let result = reduce(&plate(12), 2);
    assert_eq!(result.mesh.n_triangles(), 2);
    assert_eq!(result.report.stop_reason, StopReason::Reached);
    assert!((result.mesh.area() - 144.0).abs() < 0.1);
    assert!(result.mesh.positions().iter().all(|p| p.z.abs() < 1e-9));
}

#[test]
fn a_pan_stays_a_manifold_with_its_loops_and_normals() {
    let mesh = pan(16.0);
    assert_eq!(n_loops(&mesh), 13);
    for n in [5_000, 1_000, 200] {
        let result = reduce(&mesh, n);
        assert_eq!(result.report.stop_reason, StopReason::Reached);
        assert!((n - 1..=n).contains(&result.mesh.n_triangles()));
        assert_eq!(widest_edge(&result.mesh), 2);
        assert_eq!(n_loops(&result.mesh), 13, "at {n} triangles");
        let (_, n_components) = Topology::of(&result.mesh).components(result.mesh.n_triangles());
        assert_eq!(n_components, 1);
        let upright = (0..result.mesh.n_triangles()).all(|t| result.mesh.normal(t).z > 0.0);
        assert!(upright, "a triangle turned over at {n} triangles");
    }
}

#[test]
fn loops_close_only_when_nothing_else_is_left() {
    let mesh = pan(40.0);
    let result = reduce(&mesh, 40);
    assert!((39..=40).contains(&result.mesh.n_triangles()));
    assert_eq!(n_loops(&result.mesh), 6);

    let settings = SimplifySettings {
        may_close_loops: false,
        ..SimplifySettings::to_triangles(1)
    };
    let kept = simplify(&mesh, &settings, &Monitor::silent()).unwrap();
    assert_eq!(n_loops(&kept.mesh), 13);
    assert!(matches!(
        kept.report.stop_reason,
        StopReason::NothingLegal { .. }
    ));
}

#[test]
fn levels_are_what_simplify_gives() {
    let mesh = pan(40.0);
    let settings = SimplifySettings::to_triangles(0);
    let sequence = CollapseSequence::record(&mesh, &settings, &Monitor::silent()).unwrap();
    assert_eq!(
        sequence.level(usize::MAX),
        sequence.level(mesh.n_triangles())
    );
    for n in [900, 50, 1_301, 300, 299, 10] {
        let direct = reduce(&mesh, n);
        let level = sequence.simplified(n, &Monitor::silent()).unwrap();
        assert_eq!(level.mesh, direct.mesh);
        assert_eq!(level.vertex_of, direct.vertex_of);
        assert!(direct.mesh.n_triangles() <= n);
    }
}

/// Of a mesh that is large enough to be reduced in regions, whatever the number of threads.
#[test]
fn levels_of_a_large_mesh_are_what_simplify_gives() {
    let mesh = pan(13.0);
    assert!(mesh.n_triangles() > 12_000);
    let settings = SimplifySettings::to_triangles(0);
    let sequence = CollapseSequence::record(&mesh, &settings, &Monitor::silent()).unwrap();
    for (n, n_threads) in [(10_000, 1), (4_000, 5), (3_000, 2), (700, 3)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let direct = pool.build().unwrap().install(|| reduce(&mesh, n));
        let level = sequence.simplified(n, &Monitor::silent()).unwrap();
        assert_eq!(level.mesh, direct.mesh);
        assert_eq!(level.vertex_of, direct.vertex_of);
        assert!((n - 1..=n).contains(&direct.mesh.n_triangles()));
        assert_eq!(n_loops(&direct.mesh), 13);
        assert_eq!(widest_edge(&direct.mesh), 2);
        let rms = rms(&mesh, &direct.mesh);
        assert!(rms < 0.5, "{n}: {rms}");
    }
}

#[test]
fn no_row_of_small_triangles_is_left_where_a_large_mesh_was_cut() {
    assert_eq!(reduce(&plate(60), 2).mesh.n_triangles(), 2);
}

#[test]
fn sheets_one_thickness_apart_stay_apart() {
    let lower = plate(10);
    let (mut positions, mut triangles) = lower.into_parts();
    let n = positions.len() as u32;
    positions.extend(
        positions
            .clone()
            .iter()
            .map(|p| Point3::new(p.x, p.y, 0.01)),
    );
    triangles.extend(
        triangles
            .clone()
            .iter()
            .map(|corners| corners.map(|v| v + n)),
    );
    let result = reduce(&TriMesh::new(positions, triangles).unwrap(), 4);
    assert_eq!(result.mesh.n_triangles(), 4);
    let (_, n_components) = Topology::of(&result.mesh).components(4);
    assert_eq!(n_components, 2);
    assert!((result.mesh.area() - 200.0).abs() < 0.1);
}

#[test]
fn the_unit_and_the_place_do_not_matter() {
    let mesh = pan(40.0);
    let small = reduce(&mesh, 300);
    let (positions, triangles) = mesh.into_parts();
    let moved = positions
        .iter()
        .map(|p| Point3::new(1000.0 * p.x + 3e5, 1000.0 * p.y, 1000.0 * p.z - 1e6))
        .collect();
    let large = reduce(&TriMesh::new(moved, triangles).unwrap(), 300);
    assert_eq!(large.mesh.triangles(), small.mesh.triangles());
    for (l, s) in large.mesh.positions().iter().zip(small.mesh.positions()) {
        let back = Point3::new((l.x - 3e5) / 1000.0, l.y / 1000.0, (l.z + 1e6) / 1000.0);
        assert!((back - s).norm() < 1e-6);
    }
}

#[test]
fn parts_keep_their_seam() {
    for (n, max_triangles) in [(12, 8), (60, 100), (60, 4_500)] {
        let mesh = plate(n);
        // The seam runs along the middle.
        let middle = f64::from(n / 2);
        let part_of: Vec<u32> = (0..mesh.n_triangles())
            .map(|t| u32::from(mesh.corners(t).iter().all(|p| p.x >= middle)))
            .collect();
        let settings = SimplifySettings::to_triangles(max_triangles);
        let monitor = Monitor::silent();
        let sequence = CollapseSequence::record_parts(&mesh, &part_of, &settings, &monitor);
        let result = sequence.unwrap().simplified(max_triangles, &monitor);
        let result = result.unwrap();
        assert!(result.mesh.n_triangles() <= max_triangles);
        for (t, &original) in result.triangle_of.iter().enumerate() {
            let right = part_of[original as usize] == 1;
            for p in result.mesh.corners(t) {
                assert!(if right {
                    p.x > middle - 0.1
                } else {
                    p.x < middle + 0.1
                });
            }
        }
    }
    let (mesh, monitor) = (plate(2), Monitor::silent());
    let settings = SimplifySettings::to_triangles(8);
    let error = CollapseSequence::record_parts(&mesh, &[0], &settings, &monitor).unwrap_err();
    assert!(matches!(error, SimplifyError::LabelCount { .. }));
}

#[test]
fn odd_input_is_taken_as_it_comes() {
    let p = Point3::new;
    let positions = vec![
        p(0.0, 0.0, 0.0),
        p(1.0, 0.0, 0.0),
        p(0.0, 1.0, 0.0),
        p(0.0, 0.0, 1.0),
        p(0.0, -1.0, 0.0),
        p(9.0, 9.0, 9.0),
        p(2.0, 0.0, 0.0),
    ];
    // Three triangles on edge 0–1, one twice, one degenerate, one without area.
    let triangles = vec![
        [0, 1, 2],
        [0, 1, 3],
        [1, 0, 4],
        [2, 0, 1],
        [3, 3, 1],
        [0, 1, 6],
    ];
    let mesh = TriMesh::new(positions, triangles).unwrap();
    let result = reduce(&mesh, 100);
    assert_eq!(result.mesh.n_triangles(), 4);
    assert_eq!(result.vertex_of[5], u32::MAX);
    assert!(reduce(&mesh, 0).mesh.n_triangles() > 0);
    assert!(reduce(&TriMesh::default(), 0).mesh.is_empty());
}

#[test]
fn cancel_and_bad_settings_are_errors() {
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let settings = SimplifySettings::to_triangles(10);
    let cancelled = simplify(&plate(4), &settings, &monitor).unwrap_err();
    assert!(matches!(cancelled, SimplifyError::Cancelled(_)));

    let settings = SimplifySettings {
        boundary_weight: f64::NAN,
        ..SimplifySettings::default()
    };
    let refused = simplify(&plate(4), &settings, &Monitor::silent()).unwrap_err();
    assert!(refused.to_string().contains("boundary_weight"));
}

#[test]
fn stop_keeps_what_there_is() {
    let monitor = Monitor::silent();
    monitor.request_stop();
    let settings = SimplifySettings::to_triangles(10);
    let result = simplify(&plate(4), &settings, &monitor).unwrap();
    assert_eq!(result.report.stop_reason, StopReason::StopRequested);
    assert_eq!(result.mesh.n_triangles(), 32);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any soup is taken: indices stay valid, the ceiling holds or a reason is given, and no edge
    /// gets more triangles than the soup's worst.
    #[test]
    fn soups_are_survived(
        points in prop::collection::vec(prop::array::uniform3(0_u8..5), 3..30),
        corners in prop::collection::vec(prop::array::uniform3(0_u32..30), 1..60),
        max_triangles in 0_usize..20,
    ) {
        let n = points.len() as u32;
        let positions = points.iter().map(|p| Point3::from(p.map(f64::from))).collect();
        let triangles = corners.iter().map(|c| c.map(|v| v % n)).collect();
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let result = reduce(&mesh, max_triangles);
        let legal_end = matches!(result.report.stop_reason, StopReason::NothingLegal { .. });
        prop_assert!(result.mesh.n_triangles() <= max_triangles || legal_end);
        prop_assert!(widest_edge(&result.mesh) <= widest_edge(&mesh).max(2));
        prop_assert_eq!(&reduce(&mesh, max_triangles), &result);
    }
}

/// Two-sided rms distance over triangle centres and corners, by brute force.
fn rms(a: &TriMesh, b: &TriMesh) -> f64 {
    let one_way = |from: &TriMesh, to: &TriMesh| {
        let tree = Bvh::build(to.clone());
        let mut sum = 0.0;
        for t in 0..from.n_triangles() {
            let [p, q, r] = from.corners(t);
            for (u, v) in [(0.33, 0.33), (0.6, 0.2), (0.2, 0.6), (0.2, 0.2)] {
                let point = p + (q - p) * u + (r - p) * v;
                let hit = tree.closest(&point, f64::INFINITY, None, None).unwrap();
                sum += hit.distance_sq * from.triangle_area(t) / 4.0;
            }
        }
        sum / from.area()
    };
    ((one_way(a, b) + one_way(b, a)) / 2.0).sqrt()
}

#[test]
fn no_worse_than_the_textbook() {
    let mesh = shapematch::geometry::weld(pan(70.0), &Monitor::silent())
        .unwrap()
        .mesh;
    for (n, speed, factor) in [
        (250, Speed::Exact, 1.05),
        (120, Speed::Exact, 1.05),
        (120, Speed::Fast, 1.2),
    ] {
        let settings = SimplifySettings {
            speed,
            ..SimplifySettings::to_triangles(n)
        };
        let ours = simplify(&mesh, &settings, &Monitor::silent()).unwrap().mesh;
        let plain = textbook_qem::reduce(&mesh, n);
        assert!((n - 1..=n).contains(&plain.n_triangles()));
        let (ours, plain) = (rms(&mesh, &ours), rms(&mesh, &plain));
        assert!(
            ours <= factor * plain,
            "{n} {speed:?}: {ours} against {plain}"
        );
    }
}

#[test]
fn borders_of_a_pan_hardly_move() {
    let mesh = pan(16.0);
    let deviation = border_deviation(&mesh, &reduce(&mesh, 1000).mesh);
    assert_eq!((deviation.loops_before, deviation.loops_after), (13, 13));
    assert!(deviation.max < 4.0 && deviation.rms < 1.0, "{deviation:?}");
    // With so few triangles most holes have three edges, and are holes all the same.
    let few = border_deviation(&mesh, &reduce(&mesh, 100).mesh);
    assert_eq!(few.loops_after, 13);
}
