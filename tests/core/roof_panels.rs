//! Smooth panels, whose surfaces hardly resist a slide along themselves.

use shapematch::assess::*;
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;
use shapematch::registration::*;
use shapematch::settling::settle;

use super::assess::matched;
use super::drawn_pan::{placement, worst_node};

/// A roof of 1,400 by 1,000 mm with an addendum all round and bends of so many millimetres.
fn roof([n, m]: [u32; 2], addendum: f64, bend: f64) -> TriMesh {
    let at = |k: u32, n: u32, length: f64| {
        (f64::from(k) / f64::from(n) - 0.5) * (length + 2.0 * addendum)
    };
    let points = (0..(n + 1) * (m + 1)).map(|k| {
        let (x, y) = (at(k % (n + 1), n, 1400.0), at(k / (n + 1), m, 1000.0));
        let (u, v) = (x / 700.0, y / 500.0);
        let channel = -10.0 * (-((v.abs() - 0.9) / 0.05).powi(2)).exp();
        let height = -50.0 * u * u - 35.0 * v * v + 10.0 * u * u * u + channel;
        Point3::new(x, y, height + bend * (u * u - v * v))
    });
    let cells = (0..n * m).map(|k| k / n * (n + 1) + k % n);
    let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    TriMesh::new(points.collect(), triangles.collect()).unwrap()
}

#[test]
fn a_roof_whose_end_lies_on_the_other_by_chance_is_not_surely_placed() {
    let crash = roof([90, 70], 0.0, 0.0);
    let truth = placement(3);
    let target = Surface::new(&crash, "target").unwrap();
    let (settings, check) = (MatchSettings::default(), AssessSettings::default());
    let silent = Monitor::silent();
    for bend in [-0.7, 0.7] {
        let stamped = roof([110, 80], 17.0, bend).transformed(&truth.inverse());
        let source = Surface::new(&stamped, "source").unwrap();
        let mut outcome = matched(&source, &target);
        settle(&mut outcome, [&source, &target], &settings, &check, &silent).unwrap();
        let assessed = assess(&source, &target, &outcome, &check, &silent).unwrap();
        let error = worst_node(&stamped, &truth, &outcome.target_from_source);
        let stated = assessed.uncertainty().unwrap().largest;
        let is_good = assessed.verdict == Verdict::Good;
        // A bend along the roof is much like a slide of it, and one end of the part lies on the other's by chance.
        assert!(error > 5.0 && error < 3.0 * stated, "{error} {stated}");
        assert!(!is_good, "{:?}", assessed.reasons);
    }
}
