//! Parts of which each has a piece that the other lacks.

use shapematch::assess::*;
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;
use shapematch::registration::*;
use shapematch::settling::settle;

use super::assess::matched;
use super::drawn_pan::{placement, worst_node};

/// Of an arched panel, 700 mm long, what lies between two shares of its length.
fn arch([from, to]: [f64; 2], [n, m]: [u32; 2]) -> TriMesh {
    let points = (0..(n + 1) * (m + 1)).map(|k| {
        let along = from + (to - from) * f64::from(k % (n + 1)) / f64::from(n);
        let across = f64::from(k / (n + 1)) / f64::from(m);
        let (u, v) = (2.0 * along - 1.0, 2.0 * across - 1.0);
        let vault = 179.1 * (1.057 * v).cos() * (1.0 - 0.2 * u * u - 0.013 * u);
        let bump = 9.0 * (-((u - 0.11).powi(2) + (v - 0.145).powi(2)) / 0.04).exp();
        let bead = 7.0 * (-((u + 0.08) / 0.12).powi(2)).exp() * v;
        let height = vault + 4.9 * u * v + bump + bead;
        Point3::new(350.0 * u, 250.0 * v, height)
    });
    let cells = (0..n * m).map(|k| k / n * (n + 1) + k % n);
    let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    TriMesh::new(points.collect(), triangles.collect()).unwrap()
}

#[test]
fn parts_that_share_a_piece_lie_on_each_other_there() {
    let truth = placement(14);
    let crash = arch([0.3, 1.0], [60, 52]);
    let stamped = arch([0.0, 0.7], [70, 60]).transformed(&truth.inverse());
    let [source, target] = [&stamped, &crash].map(|mesh| Surface::new(mesh, "part").unwrap());
    let (settings, check) = (MatchSettings::default(), AssessSettings::default());
    let silent = Monitor::silent();
    let mut outcome = matched(&source, &target);
    settle(&mut outcome, [&source, &target], &settings, &check, &silent).unwrap();
    let assessed = assess(&source, &target, &outcome, &check, &silent).unwrap();
    let error = worst_node(&stamped, &truth, &outcome.target_from_source);
    let stated = assessed.uncertainty().unwrap().largest;
    // All of the part together lies closest where it is turned end for end, 860 mm off.
    assert!(error < 20.0 && error < 3.0 * stated, "{error} {stated}");
    assert_eq!(assessed.verdict, Verdict::Check, "{:?}", assessed.reasons);
}
