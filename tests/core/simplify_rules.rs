//! One small mesh for each rule that a collapse must obey.

use shapematch::geometry::{BorderEdges, Point3, Topology, TriMesh};
use shapematch::monitor::Monitor;
use shapematch::simplify::{
    CollapseSequence, Simplified, SimplifySettings, Speed, StopReason, simplify,
};

use super::pan::pan;

#[path = "../bench/reduction.rs"]
mod reduction;

fn mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> TriMesh {
    let positions = positions.iter().map(|&p| Point3::from(p)).collect();
    TriMesh::new(positions, triangles.to_vec()).unwrap()
}

/// As few triangles as the rules allow.
fn fewest(mesh: &TriMesh, may_close_loops: bool) -> Simplified {
    let settings = SimplifySettings {
        may_close_loops,
        ..SimplifySettings::to_triangles(0)
    };
    simplify(mesh, &settings, &Monitor::silent()).unwrap()
}

fn n_loops(mesh: &TriMesh) -> usize {
    BorderEdges::of(mesh, &Topology::of(mesh)).loops().len()
}

fn widest_edge(mesh: &TriMesh) -> usize {
    let topology = Topology::of(mesh);
    let widths = (0..topology.edges.len()).map(|e| topology.triangles_of(e).len());
    widths.max().unwrap_or(0)
}

/// Rings of three vertices, joined to a tube from one to the next.
fn tube(n_rings: u32) -> TriMesh {
    let corners = [[1.0, 0.0], [-0.5, 0.8], [-0.5, -0.8]];
    let positions: Vec<[f64; 3]> = (0..n_rings)
        .flat_map(|k| corners.map(|[x, y]| [x, y, f64::from(k)]))
        .collect();
    let triangles: Vec<[u32; 3]> = (0..n_rings - 1)
        .flat_map(|k| {
            (0..3).flat_map(move |i| {
                let (a, b) = (3 * k + i, 3 * k + (i + 1) % 3);
                [[a, b, b + 3], [a, b + 3, a + 3]]
            })
        })
        .collect();
    mesh(&positions, &triangles)
}

/// A triangle with a triangular hole.
fn ring() -> TriMesh {
    let positions = [
        [0.0, 3.0, 0.0],
        [-3.0, -2.0, 0.0],
        [3.0, -2.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, -0.7, 0.0],
        [1.0, -0.7, 0.0],
    ];
    let triangles = [
        [0, 1, 4],
        [0, 4, 3],
        [1, 2, 5],
        [1, 5, 4],
        [2, 0, 3],
        [2, 3, 5],
    ];
    mesh(&positions, &triangles)
}

/// An n × n plate of unit squares, its inner vertices pushed about in the plane.
fn crooked_plate(n: u32) -> TriMesh {
    let positions: Vec<[f64; 3]> = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| [i, j]))
        .map(|[i, j]| {
            let inner = i > 0 && j > 0 && i < n && j < n;
            let push = |k: u32| f64::from(inner) * 0.3 * (f64::from(k * (3 * i + 7 * j))).sin();
            [f64::from(i) + push(1), f64::from(j) + push(2), 0.0]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..n)
        .flat_map(|j| {
            (0..n).flat_map(move |i| {
                let a = j * (n + 1) + i;
                [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
            })
        })
        .collect();
    mesh(&positions, &triangles)
}

#[test]
fn a_tube_of_three_sides_is_not_pinched() {
    let result = fewest(&tube(5), false);
    assert_eq!(result.mesh.n_triangles(), 6);
    assert_eq!(n_loops(&result.mesh), 2);
    assert_eq!(widest_edge(&result.mesh), 2);
}

#[test]
fn a_tetrahedron_is_not_folded_into_a_doubled_triangle() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    let solid = mesh(&positions, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
    let result = fewest(&solid, true);
    assert_eq!(result.mesh.n_triangles(), 4);
    assert!((result.mesh.area() - solid.area()).abs() < 1e-12);
    let StopReason::NothingLegal { link, flip, .. } = result.report.stop_reason else {
        panic!("{:?}", result.report.stop_reason);
    };
    assert!(link + flip >= 6);
}

#[test]
fn a_loop_of_three_closes_only_if_it_may() {
    let kept = fewest(&ring(), false);
    assert_eq!(n_loops(&kept.mesh), 2);
    let closed = fewest(&ring(), true);
    assert_eq!(n_loops(&closed.mesh), 1);
    assert_eq!(widest_edge(&closed.mesh), closed.mesh.n_triangles().min(2));
}

#[test]
fn a_component_of_one_triangle_stays() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [5.0, 0.0, 0.0],
        [6.0, 0.0, 0.0],
        [5.0, 1.0, 0.0],
    ];
    let two = mesh(&positions, &[[0, 1, 2], [3, 4, 5]]);
    assert_eq!(fewest(&two, true).mesh, two);
}

#[test]
fn no_triangle_of_a_flat_plate_turns_over_at_any_level() {
    let plate = crooked_plate(7);
    for speed in [Speed::Exact, Speed::Fast] {
        for n in 2..plate.n_triangles() {
            let level = reduction::reduce(&plate, speed, n);
            assert!((0..level.n_triangles()).all(|t| level.normal(t).z > 0.99));
        }
    }
}

#[test]
fn the_parts_on_both_sides_of_a_seam_keep_their_area() {
    let mesh = crooked_plate(4);
    let part_of: Vec<u32> = (0..32).map(|t| u32::from(t % 8 >= 4)).collect();
    let area_of = |mesh: &TriMesh, triangle_of: &dyn Fn(usize) -> usize| {
        let in_part = |&t: &usize| part_of[triangle_of(t)] == 1;
        let triangles = (0..mesh.n_triangles()).filter(in_part);
        triangles.map(|t| mesh.triangle_area(t)).sum::<f64>()
    };
    let before = area_of(&mesh, &|t| t);
    let settings = SimplifySettings::to_triangles(0);
    let sequence =
        CollapseSequence::record_parts(&mesh, &part_of, &settings, &Monitor::silent()).unwrap();
    for n in [24, 18] {
        let result = sequence.simplified(n, &Monitor::silent()).unwrap();
        let after = area_of(&result.mesh, &|t| result.triangle_of[t] as usize);
        assert!(
            (after - before).abs() < 0.15 * before,
            "{after} of {before}"
        );
    }
}

#[test]
fn two_sheets_a_hair_apart_are_never_joined() {
    let lower = crooked_plate(3);
    let (mut positions, mut triangles) = lower.into_parts();
    let n = positions.len();
    for i in 0..n {
        positions.push(positions[i] + nalgebra::Vector3::z() * 1e-9);
    }
    for i in 0..triangles.len() {
        triangles.push(triangles[i].map(|v| v + n as u32));
    }
    let result = fewest(&TriMesh::new(positions, triangles).unwrap(), true);
    assert_eq!(result.mesh.n_triangles(), 2);
    assert_eq!(result.mesh.n_vertices(), 6);
}

#[test]
fn what_the_benchmark_times_does_what_it_says() {
    let mesh = pan(70.0);
    for n in [250, 120] {
        let exact = reduction::reduce(&mesh, Speed::Exact, n);
        assert_eq!(exact, reduction::record(&mesh, 100).level(n));
        assert!((n - 1..=n).contains(&exact.n_triangles()));
    }
}
