//! Parts that an assembly or a stamping holds twice: which of the two is meant nothing tells.

use shapematch::assess::AssessSettings;
use shapematch::geometry::{Point3, Pose, Similarity, TriMesh, Vector3};
use shapematch::monitor::Monitor;
use shapematch::registration::{MatchInput, MatchSettings, Surface, match_surfaces};
use shapematch::settling::settle;

use super::drawn_pan::{everywhere, pan, panel, placement, worst_node};

/// Meshes in one.
fn together(meshes: &[TriMesh]) -> TriMesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| first + v)));
    }
    TriMesh::new(positions, triangles).unwrap()
}

/// The poses of a settled match that are about as likely as its result, that first.
fn likely_poses(source: &TriMesh, target: &TriMesh) -> Vec<Similarity> {
    let [source, target] = [source, target].map(|mesh| Surface::new(mesh, "part").unwrap());
    let input = MatchInput {
        source: &source,
        target: &target,
        reduced: None,
    };
    let (settings, silent) = (MatchSettings::default(), Monitor::silent());
    let mut outcome = match_surfaces(&input, &settings, &silent).unwrap();
    let check = AssessSettings::default();
    settle(&mut outcome, [&source, &target], &settings, &check, &silent).unwrap();
    let others = outcome.alternatives.iter();
    let likely = others.filter(|other| other.score_ratio < 1.1);
    let mut found = vec![outcome.target_from_source];
    found.extend(likely.map(|other| other.target_from_source));
    found
}

fn expect_both(truth: &[Similarity], found: &[Similarity], source: &TriMesh) {
    for pose in truth {
        let errors = found.iter().map(|found| worst_node(source, pose, found));
        let least = errors.fold(f64::INFINITY, f64::min);
        assert!(least < 1.0, "{least:.2} mm");
    }
}

#[test]
fn a_copy_elsewhere_in_an_assembly_is_as_likely() {
    let source = panel(4.0, 0.0, everywhere);
    let crash = panel(5.0, 0.35, everywhere);
    let pan = pan(9.0, 0.2, everywhere);
    for seed in 0..3 {
        let truth: Vec<Similarity> = (0..2).map(|k| placement(7 * seed + k)).collect();
        let copies = truth.iter().map(|pose| crash.transformed(pose));
        let neighbours = (2..5).map(|k| {
            let twice_as_large = Similarity {
                scale: 2.0,
                ..placement(7 * seed + k)
            };
            pan.transformed(&twice_as_large)
        });
        let target = together(&copies.chain(neighbours).collect::<Vec<_>>());
        expect_both(&truth, &likely_poses(&source, &target), &source);
    }
}

#[test]
fn of_two_parts_that_are_formed_at_once_either_may_be_meant() {
    let stamped = panel(4.0, 0.0, everywhere);
    let beside = placement(3);
    let source = together(&[stamped.clone(), stamped.transformed(&beside)]);
    let pose = placement(5);
    let target = panel(5.0, 0.35, everywhere).transformed(&pose);
    let truth = [pose, pose.after(&beside.inverse())];
    expect_both(&truth, &likely_poses(&source, &target), &source);
}

/// A curved half of a tube, the same after half a turn about the middle of its length.
fn half_tube(size: f64) -> TriMesh {
    let n = [(240.0 / size) as u32, (900.0 / size) as u32];
    let place = |i: u32, j: u32| {
        let u = f64::from(i) / f64::from(n[0]) - 0.5;
        let v = f64::from(j) / f64::from(n[1]) - 0.5;
        let bow = 30.0 * (1.0 - 4.0 * v * v);
        let across = 160.0 * u;
        let height = 40.0 * (std::f64::consts::PI * u).cos();
        Point3::new(across, 900.0 * v, height + bow)
    };
    let columns = n[0] + 1;
    let points = (0..=n[1]).flat_map(|j| (0..columns).map(move |i| place(i, j)));
    let cells = (0..n[0]).flat_map(|i| (0..n[1]).map(move |j| j * columns + i));
    let up = columns;
    let triangles = cells.flat_map(|a| [[a, a + 1, a + up + 1], [a, a + up + 1, a + up]]);
    TriMesh::new(points.collect(), triangles.collect()).unwrap()
}

#[test]
fn a_part_that_is_its_own_half_turn_has_two_poses() {
    let (source, crash) = (half_tube(6.0), half_tube(7.0));
    for seed in 0..3 {
        let truth = placement(seed);
        let turn = Similarity::from(Pose::rotation(Vector3::z() * std::f64::consts::PI));
        let both = [truth, truth.after(&turn)];
        let found = likely_poses(&source, &crash.transformed(&truth));
        expect_both(&both, &found, &source);
    }
}

#[test]
fn a_second_layer_of_the_sheet_is_no_copy() {
    let sheet = panel(5.0, 0.35, everywhere);
    let lifted = sheet.transformed(&Similarity {
        translation: Vector3::new(0.0, 0.0, 2.0),
        ..Similarity::identity()
    });
    let source = panel(4.0, 0.0, everywhere);
    let found = likely_poses(&source, &together(&[sheet, lifted]));
    assert_eq!(found.len(), 1);
}
