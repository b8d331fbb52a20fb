//! A wheel of like sectors with one small hole that only one sector has: of the poses in which the surfaces lie on
//! each other the one is found under which that hole meets its counterpart.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use shapematch::assess::Clarity;
use shapematch::formats::Model;
use shapematch::geometry::{Point3, Rotation, Similarity, TriMesh, Vector3};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, LoadedPart, prepare};
use shapematch::pipeline::match_parts::{MatchRecipe, MatchRun, match_parts};
use shapematch::role::PerRole;

const N_SECTORS: u32 = 13;
/// Cells of the coarsest mesh around a sector and from the inner border to the outer one.
const AROUND: u32 = 10;
const OUTWARDS: u32 = 12;

/// A dish of radius 170 with waves, each cell of the coarsest mesh cut into `finer` squared. Where `twist` is not
/// zero, its outer border is turned against itself by so many millimetres of height.
fn wheel(finer: u32, twist: f64) -> TriMesh {
    let (n, rings) = (N_SECTORS * AROUND * finer, OUTWARDS * finer);
    let points = (0..n * (rings + 1)).map(|i| {
        let angle = TAU * f64::from(i % n) / f64::from(n);
        let radius = 20.0 + 150.0 * f64::from(i / n) / f64::from(rings);
        let share = ((radius - 40.0) / 100.0).clamp(0.0, 1.0);
        let waves = 8.0 * share * share * (3.0 - 2.0 * share);
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        let bent = twist * x * y / (170.0 * 170.0);
        let z = waves * (f64::from(N_SECTORS) * angle).cos() - radius * radius / 900.0 + bent;
        Point3::new(x, y, z)
    });
    let is_hole = |i: u32, j: u32| {
        let (i, j) = (i / finer, j / finer);
        let of_each = i % AROUND == 2 && (j == 7 || j == 8);
        of_each || i == 6 && j == 10
    };
    let cells = (0..n * rings).map(|k| (k % n, k / n));
    let triangles = cells.filter(|&(i, j)| !is_hole(i, j)).flat_map(|(i, j)| {
        let next = (i + 1) % n;
        let [a, b, c, d] = [(i, j), (i, j + 1), (next, j + 1), (next, j)].map(|(i, j)| j * n + i);
        [[a, b, c], [a, c, d]]
    });
    TriMesh::new(points.collect(), triangles.collect()).unwrap()
}

fn loaded(mesh: &TriMesh, name: &str) -> LoadedPart {
    let model = Arc::new(Model::from_mesh(mesh, name));
    let settings = LoadSettings::default();
    prepare(Path::new(name), model, &settings, &Monitor::silent()).unwrap()
}

/// The pose found for the stamped part laid elsewhere, and how far it moves a node from where it belongs.
fn found(crash: &TriMesh, stamped: &TriMesh, angles: [f64; 3]) -> (MatchRun, f64) {
    let [roll, pitch, yaw] = angles;
    let rotation = Rotation::from_euler_angles(roll, pitch, yaw);
    let truth = Similarity {
        rotation: *rotation.to_rotation_matrix().matrix(),
        translation: Vector3::new(300.0, -200.0, 900.0),
        scale: 1.0,
    };
    let stamped = stamped.transformed(&truth.inverse());
    let parts = PerRole::new(loaded(crash, "crash"), loaded(&stamped, "stamped"));
    let still = Similarity::identity();
    let recipe = MatchRecipe::default();
    let run = match_parts(parts.as_ref(), None, &recipe, &still, &Monitor::silent()).unwrap();
    let off = run
        .crash_from_stamped
        .max_displacement(&truth, stamped.positions());
    (run, off)
}

#[test]
fn the_hole_of_one_sector_tells_which_it_is() {
    let (crash, stamped) = (wheel(2, 0.0), wheel(3, 0.0));
    for angles in [[0.3, 1.1, 2.0], [2.5, -0.4, 0.9], [-1.2, 0.7, -2.8]] {
        let (run, off) = found(&crash, &stamped, angles);
        assert!(off < 0.5, "{angles:?}: {off}");
        assert!(
            run.assessment.shape.as_ref().unwrap().reasons.is_empty(),
            "{angles:?}"
        );
    }
}

#[test]
fn springback_does_not_hide_the_sector() {
    let (crash, stamped) = (wheel(2, 0.0), wheel(3, 3.0));
    let (run, off) = found(&crash, &stamped, [0.3, 1.1, 2.0]);
    assert!(off < 4.0, "{off}");
    // All other sectors score alike, and the hole alone tells them apart.
    let other = &run.outcome.alternatives[0];
    assert!(other.score_ratio >= 1.5, "{other:?}");
    assert_eq!(run.assessment.ambiguity.clarity, Clarity::Clear);
}
