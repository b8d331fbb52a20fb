//! More checks of the mapping against what is known: holes and borders, ridges, curved sheets, means, and
//! what a small error of the pose does.

use shapematch::geometry::{Point3, Similarity, Vector3};
use shapematch::mapping::*;
use shapematch::monitor::Monitor;

use super::mapping::{Blank, cylinder, exact_mean, flat, full, map_one, source, target};

/// The elements of a mesh whose centroid a condition keeps.
fn kept(mesh: &ShellMesh, keep: impl Fn(&Point3) -> bool) -> ShellMesh {
    let pairs = mesh.corners().iter().zip(mesh.centroids());
    let corners: Vec<[u32; 4]> = pairs.filter(|(_, c)| keep(c)).map(|(c, _)| *c).collect();
    let parts = vec![0; corners.len()];
    ShellMesh::new(mesh.positions().to_vec(), corners, parts).unwrap()
}

fn plastic(value: f64) -> [f64; 7] {
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, value]
}

fn plastic_of(mapped: &Mapped, element: usize) -> f64 {
    mapped.states.as_ref().unwrap().of(element)[0][6]
}

#[test]
fn a_hole_stays_empty_and_its_border_keeps_its_values() {
    let centre = Point3::new(50.0, 30.0, 0.0);
    let blank = Blank {
        jitter: 0.0,
        ..Blank::new(2.5)
    };
    let holed = kept(&blank.mesh(flat), |c| (c - centre).norm() > 12.0);
    let part = source(holed, 2, |e, _, mesh| {
        plastic(0.1 + 1e-3 * mesh.centroids()[e].x)
    });
    let onto = target(
        Blank {
            jitter: 0.0,
            ..Blank::new(5.0)
        }
        .mesh(flat),
        2,
    );
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    for (element, report) in mapped.elements.iter().enumerate() {
        let c = onto.mesh.centroids()[element];
        let from_centre = (c - centre).norm();
        if from_centre < 6.0 {
            assert_eq!(report.status, Status::Outside, "in the hole at {c}");
        } else if from_centre > 18.0 {
            assert_eq!(report.status, Status::Mapped, "on the sheet at {c}");
        }
        if report.status.has_values() {
            let value = plastic_of(&mapped, element);
            assert!(
                (value - (0.1 + 1e-3 * c.x)).abs() < 2.6e-3,
                "{value} at {c}"
            );
        }
    }
}

#[test]
fn a_ridge_keeps_its_peak_and_its_integral() {
    let ridge = |p: &Point3| 0.1 + 0.3 * (-((p.x - 50.0) / 4.0).powi(2)).exp();
    for (from, to, peak) in [(2.5, 5.0, 0.05), (5.0, 5.0, 0.1), (2.5, 2.5, 0.05)] {
        let part = source(Blank::new(from).mesh(flat), 2, |e, _, mesh| {
            plastic(exact_mean(mesh, e, ridge))
        });
        let onto = target(Blank::new(to).mesh(flat), 2);
        let mapped = map_one(&part, Similarity::identity(), &onto, &full());
        let areas = onto.mesh.areas();
        let truth: Vec<f64> = (0..onto.mesh.len())
            .map(|e| exact_mean(&onto.mesh, e, ridge))
            .collect();
        let found: Vec<f64> = (0..onto.mesh.len())
            .map(|e| plastic_of(&mapped, e))
            .collect();
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let ratio = largest(&found) / largest(&truth);
        assert!(
            (0.9..=1.0 + peak).contains(&ratio),
            "{from} → {to}: peak × {ratio}"
        );
        let integral =
            |values: &[f64]| -> f64 { values.iter().zip(areas).map(|(v, a)| v * a).sum() };
        let off = integral(&found) / integral(&truth) - 1.0;
        assert!(off.abs() < 0.005, "{from} → {to}: integral {off}");
    }
}

#[test]
fn a_linear_field_on_a_bent_sheet_errs_by_the_square_of_the_size() {
    // Linear in space on a radius of 20.
    let field = |p: &Point3| 0.3 + 0.004 * p.x + 0.006 * p.y;
    let error = |size: f64| {
        let blank = |size| Blank {
            length: 40.0,
            width: 24.0,
            size,
            jitter: 0.0,
        };
        let part = source(blank(size).mesh(cylinder), 2, |e, _, mesh| {
            plastic(field(&mesh.centroids()[e]))
        });
        let onto = blank(1.6 * size).mesh(|u, v| cylinder(0.8 * u + 4.0, 0.8 * v + 2.4));
        let onto = target(onto, 2);
        let mapped = map_one(&part, Similarity::identity(), &onto, &full());
        let mut largest = 0.0_f64;
        for element in 0..onto.mesh.len() {
            let expected = field(&onto.mesh.centroids()[element]);
            largest = largest.max((plastic_of(&mapped, element) - expected).abs());
        }
        largest
    };
    let (coarse, fine) = (error(2.0), error(1.0));
    let gradient = 0.004_f64.hypot(0.006);
    assert!(coarse < (4.0 + 10.24) / 20.0 * gradient, "{coarse:e}");
    assert!(fine < coarse / 2.5, "{coarse:e} → {fine:e}");
}

#[test]
fn a_small_error_of_the_pose_costs_no_more_than_the_slope() {
    let wave = |p: &Point3| 1.0 + 0.05 * (p.x / 9.0).sin() * (p.y / 7.0).cos();
    let mut part = source(Blank::new(2.5).mesh(flat), 2, |_, _, _| plastic(0.1));
    let means: Vec<f64> = (0..part.mesh.len())
        .map(|e| exact_mean(&part.mesh, e, wave))
        .collect();
    part.thickness = means.iter().map(|t| [*t; 4]).collect();
    let inner = Blank {
        length: 60.0,
        width: 30.0,
        size: 5.0,
        jitter: 0.2,
    };
    let onto = target(inner.mesh(|u, v| Point3::new(u + 20.0, v + 15.0, 0.0)), 2);
    let run = |pose| map_one(&part, pose, &onto, &full()).thickness;
    let (still, moved) = (
        run(Similarity::identity()),
        run(Similarity {
            translation: Vector3::new(0.4, -0.3, 0.0),
            ..Similarity::identity()
        }),
    );
    let squares: f64 = still.iter().zip(&moved).map(|(a, b)| (a - b).powi(2)).sum();
    let rms = (squares / still.len() as f64).sqrt();
    let steepest = 0.05 / 7.0;
    assert!(rms <= 0.5 * steepest, "{rms:e}");
}

#[test]
fn history_goes_to_the_nearest_layer_and_is_never_mixed() {
    let mesh = Blank::new(5.0).mesh(flat);
    let mut part = source(mesh.clone(), 3, |_, _, _| plastic(0.1));
    part.history = SourceHistory::new(mesh.len());
    for element in 0..mesh.len() {
        let kept = [-1.0, 0.0, 1.0].map(|side| ([element as f64, side], [[side; 6]]));
        let places = [-0.774_596_669_2, 0.0, 0.774_596_669_2];
        let layers = places
            .iter()
            .zip(&kept)
            .map(|(&t, (values, tensors))| (t, LayerHistory { values, tensors }));
        part.history.set(element, layers);
    }
    part.laws.insert(0, "36".to_owned());
    let mut onto = target(Blank::new(4.0).mesh(flat), 5);
    let without = map_one(&part, Similarity::identity(), &onto, &full())
        .history
        .unwrap();
    assert_eq!(without.n_present(), 0);
    assert_eq!(without.left_out[0].n_elements, onto.mesh.len());
    onto.laws.insert(0, "36".to_owned());
    let mapped = map_one(&part, Similarity::identity(), &onto, &full());
    let history = mapped.history.as_ref().unwrap();
    assert_eq!(history.n_present(), onto.mesh.len());
    for (element, report) in mapped.elements.iter().enumerate() {
        let own = f64::from(report.partner.unwrap().element);
        let found = history.of(element);
        // Gauss places of five layers beside −.77, 0, .77: the outer two lie nearer to the outer one.
        let sides = [-1.0, -1.0, 0.0, 1.0, 1.0];
        for ((values, tensor), side) in found.values.chunks(2).zip(found.tensors).zip(sides) {
            assert_eq!(values, [own, side]);
            assert_eq!(tensor, &[side; 6]);
        }
    }
    let placed = PlacedSource {
        part: &part,
        target_from_source: Similarity::identity(),
    };
    assert!(
        map(&[placed], &onto, &MapOptions::default(), &Monitor::silent())
            .unwrap()
            .history
            .is_none()
    );
}

#[test]
fn corner_thickness_follows_a_slope_and_keeps_the_mean() {
    let slope = |p: &Point3| 1.0 + 0.002 * p.x;
    let mut part = source(Blank::new(2.5).mesh(flat), 2, |_, _, _| plastic(0.1));
    part.thickness = part
        .mesh
        .centroids()
        .iter()
        .map(|c| [slope(c); 4])
        .collect();
    let onto = target(
        Blank {
            length: 60.0,
            width: 30.0,
            size: 5.0,
            jitter: 0.0,
        }
        .mesh(|u, v| Point3::new(u + 20.0, v + 15.0, 0.0)),
        2,
    );
    let options = MapOptions {
        corner_thickness: true,
        ..full()
    };
    let mapped = map_one(&part, Similarity::identity(), &onto, &options);
    assert_eq!(mapped.corners.len(), onto.mesh.len());
    for element in 0..onto.mesh.len() {
        let mean = mapped.corners[element].iter().sum::<f64>() / 4.0;
        assert!((mean - mapped.thickness[element]).abs() < 1e-12);
        let c = onto.mesh.centroids()[element];
        let is_inner = c.x > 26.0 && c.x < 74.0;
        for (corner, point) in mapped.corners[element]
            .iter()
            .zip(onto.mesh.corner_points(element))
        {
            if is_inner {
                assert!((corner - slope(&point)).abs() < 1e-9, "{corner} at {point}");
            }
        }
    }
}

#[test]
fn points_on_edges_take_the_same_element_whichever_way_its_corners_go() {
    let inside = Blank::new(2.5).mesh(cylinder);
    // Outside of the sheet many points have an edge of it as closest point.
    let around = |u, v| {
        let at = cylinder(u, v);
        Point3::new(at.x, 1.01 * at.y, 1.01 * at.z)
    };
    let mut onto = target(Blank::new(4.1).mesh(around), 3);
    onto.n_plane.fill(4);
    let run = |is_reversed: &dyn Fn(usize) -> bool| {
        let corners = inside.corners().iter().enumerate();
        let corners = corners.map(|(e, &[a, b, c, d])| match is_reversed(e) {
            true => [b, a, d, c],
            false => [a, b, c, d],
        });
        let parts = inside.parts().to_vec();
        let positions = inside.positions().to_vec();
        let mesh = ShellMesh::new(positions, corners.collect(), parts).unwrap();
        let part = source(mesh, 3, |e, t, _| {
            let t = if is_reversed(e) { -t } else { t };
            let x = (e as f64 * 1.7).sin() + t;
            [10.0 * x, 5.0 * x, 3.0, x, 2.0, 1.0, 0.2 + 0.05 * x]
        });
        map_one(&part, Similarity::identity(), &onto, &full())
    };
    let plain = run(&|_| false);
    for reversed in [run(&|_| true), run(&|e| e * 7919 % 5 < 2)] {
        for element in 0..onto.mesh.len() {
            let [states, others] =
                [&plain, &reversed].map(|of| of.states.as_ref().unwrap().of(element));
            for (a, b) in states.iter().flatten().zip(others.iter().flatten()) {
                assert!((a - b).abs() < 1e-9, "{element}: {a} and {b}");
            }
        }
    }
}
