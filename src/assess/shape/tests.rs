//! Statements about shapes whose difference is known.

mod beads;
mod flanges;
mod outlines;

use std::f64::consts::PI;

use super::super::coverage::coverage_and_near;
use super::super::statements::{Asked, Statements, statements};
use super::super::tolerance::{AssessSettings, Distances};
use super::*;
use crate::geometry::{Similarity, TriMesh};
use crate::monitor::Monitor;
use crate::registration::Surface;
use crate::text::Lengths;

/// A hat section of 400 by 120 mm whose nodes are moved by `displace`.
fn hat(n: usize, displace: impl Fn(Point3) -> Point3) -> Surface {
    let across = [-60.0, -40.0, -30.0, -10.0, 10.0, 30.0, 40.0, 60.0];
    let height = [0.0, 0.0, 40.0, 40.0, 40.0, 40.0, 0.0, 0.0];
    let m = across.len();
    let mut points = Vec::new();
    for i in 0..=n {
        for (y, z) in across.iter().zip(height) {
            let x = 400.0 * i as f64 / n as f64 - 200.0;
            points.push(displace(Point3::new(x, *y, z)));
        }
    }
    let cells = (0..n).flat_map(|i| (0..m - 1).map(move |j| (i * m + j) as u32));
    let m = m as u32;
    let triangles = cells.flat_map(|a| [[a, a + m, a + m + 1], [a, a + m + 1, a + 1]]);
    let mesh = TriMesh::new(points, triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

fn statement(source: &Surface, target: &Surface) -> ShapeStatement {
    statement_of_sheet(source, target, 1.5)
}

/// Of a sheet of this thickness.
fn statement_of_sheet(source: &Surface, target: &Surface, thickness: f64) -> ShapeStatement {
    let settings = AssessSettings {
        thickness: Some(thickness),
        ..AssessSettings::default()
    };
    let (pair, pose) = ([source, target], Similarity::identity());
    let reach = Distances::of(source, target, 1.0, &settings).reach;
    let measured = coverage_and_near(pair, &pose, reach, reach, &Monitor::silent());
    let asked = Asked {
        near: measured.unwrap().1,
        ..Asked::default()
    };
    statements(pair, &pose, asked, &settings).shape
}

/// Deflection `w` along z of up to `most`, with the shift along x that keeps lengths.
fn bent(most: f64) -> impl Fn(Point3) -> Point3 {
    move |p| {
        let x = p.x / 200.0;
        let slope = 2.0 * most * x / 200.0;
        Point3::new(p.x - (p.z - 20.0) * slope, p.y, p.z + most * (x * x - 0.3))
    }
}

#[test]
fn bending_is_springback_and_nothing_else() {
    let (plain, sprung) = (hat(40, |p| p), hat(37, bent(1.5)));
    let same = statement(&hat(37, |p| p), &plain);
    assert_eq!(same.kind, ShapeKind::Same, "{same:?}");
    let shape = statement(&sprung, &plain);
    assert_eq!(shape.kind, ShapeKind::Deformed, "{shape:?}");
    assert!(shape.remainder < 0.1, "{shape:?}");
    assert!(
        shape.springback > 0.5 && shape.springback < 1.6,
        "{shape:?}"
    );
    let much = statement(&hat(37, bent(6.0)), &plain);
    assert!(
        matches!(much.reasons[..], [ShapeReason::Bent { .. }]),
        "{much:?}"
    );
}

#[test]
fn a_longer_part_and_a_higher_part_are_other_versions() {
    let plain = hat(40, |p| p);
    let longer = hat(40, |p| Point3::new(1.02 * p.x, p.y, p.z));
    let shape = statement(&longer, &plain);
    assert_eq!(shape.kind, ShapeKind::OtherVersion, "{shape:?}");
    assert!(
        matches!(shape.reasons[0], ShapeReason::Borders { .. }),
        "{shape:?}"
    );
    let higher = hat(40, |p| Point3::new(p.x, p.y, 1.12 * p.z));
    let shape = statement(&higher, &plain);
    assert!(
        matches!(shape.reasons[0], ShapeReason::Surface { .. }),
        "{shape:?}"
    );
}

#[test]
fn an_offset_of_a_section_with_walls_is_told_apart() {
    // Every face moves by 0.7 along its normal, so the folds move along their bisectors.
    let bisector = (17_f64.sqrt() - 1.0) / 4.0;
    let skin = hat(37, |p| {
        let is_fold = (29.0..41.0).contains(&p.y.abs());
        let aside = if is_fold {
            0.7 * bisector * p.y.signum()
        } else {
            0.0
        };
        Point3::new(p.x, p.y + aside, p.z + 0.7)
    });
    let shape = statement(&skin, &hat(40, |p| p));
    let offset = shape.offset.unwrap();
    assert!(shape.is_offset_separable);
    assert!((offset - 0.7).abs() < 0.1, "{shape:?}");
    let words = shape.words(Lengths::new(None));
    assert!(words.starts_with("same surface at an offset: "), "{words}");
}

/// A sheet of 1,000 by 500 mm with shallow waves, cut off at both ends and both sides by `cut` and stretched
/// along x.
fn panel(n: usize, cut: [f64; 2], factor: f64) -> Surface {
    sheet(n, cut, factor, waves)
}

/// Height of shallow waves.
fn waves(x: f64, y: f64) -> f64 {
    30.0 * (x / 160.0 + 0.4).sin() + 15.0 * ((x + 2.0 * y) / 130.0).cos()
}

fn sheet(
    n: usize,
    [ends, sides]: [f64; 2],
    factor: f64,
    height: impl Fn(f64, f64) -> f64,
) -> Surface {
    let place = |i: usize, j: usize| {
        let x = (1000.0 - 2.0 * ends) * i as f64 / (2 * n) as f64 + ends - 500.0;
        let y = (500.0 - 2.0 * sides) * j as f64 / n as f64 + sides - 250.0;
        let z = height(x, y);
        Point3::new(factor * x, y, z)
    };
    grid([2 * n, n], place)
}

/// A sheet of so many rows and columns of cells whose corners lie where `place` says.
fn grid([rows, columns]: [usize; 2], place: impl Fn(usize, usize) -> Point3) -> Surface {
    let m = columns + 1;
    let corners = (0..=rows).flat_map(|i| (0..m).map(move |j| (i, j)));
    let points = corners.map(|(i, j)| place(i, j));
    let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i * m + j) as u32));
    let m = m as u32;
    let triangles = cells.flat_map(|a| [[a, a + m, a + m + 1], [a, a + m + 1, a + 1]]);
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

#[test]
fn a_longer_panel_is_told_from_another_trim() {
    let plain = panel(40, [0.0, 0.0], 1.0);
    // The ends of both lie 12 mm inside those of the plain one, or outside.
    let trimmed = statement(&panel(37, [12.0, 0.0], 1.0), &plain);
    assert!(trimmed.reasons.is_empty(), "{trimmed:?}");
    for (factor, cut) in [(1.024, 0.0), (0.976, 0.0), (1.0 / 1.015, 12.0)] {
        let shape = statement(&panel(37, [cut, 0.0], factor), &plain);
        assert_eq!(shape.kind, ShapeKind::OtherVersion, "{shape:?}");
        let [ShapeReason::Stretched { by, share, axis }] = shape.reasons[..] else {
            panic!("{factor}: {shape:?}");
        };
        assert_eq!(axis, PartAxis::Length);
        assert!((share - (factor - 1.0)).abs() < 0.002, "{share} {factor}");
        let longer = 1000.0 * (factor - 1.0).abs();
        assert!((by - longer).abs() < 2.0, "{by} {longer}");
    }
}

#[test]
fn another_trim_all_round_is_no_other_version_where_the_surface_says_so() {
    let settings = AssessSettings::default();
    let still = Similarity::identity();
    let stated = |source: &Surface, target: &Surface| {
        let Statements {
            uncertainty, shape, ..
        } = statements([source, target], &still, Asked::default(), &settings);
        (uncertainty.unwrap(), shape)
    };
    // Before its last trim the part reaches 5 mm farther out all round, or on three sides.
    let plain = panel(40, [0.0, 0.0], 1.0);
    for cut in [[5.0, 5.0], [0.0, 6.0], [-4.0, -7.0]] {
        let (pose, shape) = stated(&panel(37, cut, 1.0), &plain);
        assert_eq!(shape.kind, ShapeKind::Same, "{shape:?}");
        let apart = shape.borders.other_trim.unwrap();
        let farthest = cut.map(f64::abs).into_iter().fold(0.0, f64::max);
        assert!((apart - farthest).abs() < 0.5, "{apart} {cut:?}");
        assert!(
            shape.remainder < 0.05 && pose.largest < 0.1,
            "{pose:?} {shape:?}"
        );
    }
    // A flat plate says nothing about where it ends: it may as well be a larger one.
    let flat = |cut: f64| sheet(40, [cut, cut], 1.0, |_, _| 0.0);
    let (_, shape) = stated(&flat(5.0), &flat(0.0));
    assert_eq!(shape.kind, ShapeKind::OtherVersion, "{shape:?}");
    assert_eq!(shape.borders.other_trim, None);
    // Larger in all directions is another version, whatever the outlines are like.
    let factor = 1.02;
    let larger = panel(37, [0.0, 0.0], 1.0).mesh().transformed(&Similarity {
        scale: factor,
        ..still
    });
    let (_, shape) = stated(&Surface::new(&larger, "source").unwrap(), &plain);
    assert_eq!(shape.kind, ShapeKind::OtherVersion, "{shape:?}");
}

#[test]
fn facets_do_not_make_an_extruded_piece_longer() {
    // Waves of a fiftieth of a millimetre, which a stretch of 3 % explains and the facets do as well.
    let wavy = |length: f64, p: Point3| Point3::new(p.x, p.y, p.z + 0.02 * (p.x / length).sin());
    let plain = hat(400, |p| wavy(8.0, p));
    let piece = hat(380, |p| wavy(8.0 * 1.03, Point3::new(0.9 * p.x, p.y, p.z)));
    let shape = statement(&piece, &plain);
    assert!(shape.reasons.is_empty(), "{shape:?}");
}

#[test]
fn borders_that_lie_on_each_other_refute_a_longer_part() {
    // Waves that a stretch of 0.9 % explains, while both parts end at the same places.
    let wavy = |length: f64, p: Point3| Point3::new(p.x, p.y, p.z + 0.3 * (p.x / length).sin());
    let plain = hat(400, |p| wavy(8.0, p));
    let shape = statement(&hat(380, |p| wavy(8.0 * 1.009, p)), &plain);
    let is_stretched = |reason: &ShapeReason| matches!(reason, ShapeReason::Stretched { .. });
    assert!(!shape.reasons.iter().any(is_stretched), "{shape:?}");
}

/// Half a tube of 60 mm diameter and length, whose middle is sprung by up to `most` against its edges.
fn half_tube(n: usize, most: f64) -> Surface {
    let place = |i: usize, j: usize| {
        let (along, angle) = (i as f64 / n as f64, PI * j as f64 / n as f64);
        let (x, y) = (2.0 * along - 1.0, angle.cos());
        let sprung = most * (y * y + 0.3 * x * y);
        Point3::new(30.0 * x, 30.0 * y, 30.0 * angle.sin() + sprung)
    };
    grid([n, n], place)
}

#[test]
fn edges_hold_half_a_tube_where_its_surface_does_not() {
    let plain = half_tube(160, 0.0);
    for most in [-1.2, -0.9, -0.6, -0.3, 0.3, 0.6, 0.9, 1.2] {
        let shape = statement(&half_tube(140, most), &plain);
        assert!(shape.reasons.is_empty(), "{most}: {shape:?}");
    }
}

#[test]
fn one_end_that_was_cut_elsewhere_is_told_with_its_place() {
    let plain = panel(80, [0.0, 0.0], 1.0);
    assert_eq!(
        statement(&panel(37, [0.0, 0.0], 1.0), &plain).borders.apart,
        None
    );
    // 6.25 mm are cut off half of one end, a twelfth of the outline.
    let mesh = plain.mesh();
    let points = mesh.positions();
    let is_left = |corners: &&[u32; 3]| {
        let sum: Vector3 = corners.iter().map(|&v| points[v as usize].coords).sum();
        sum.x < 3.0 * 493.75 || sum.y > 0.0
    };
    let triangles = mesh.triangles().iter().filter(is_left).copied().collect();
    let cut = TriMesh::new(points.to_vec(), triangles).unwrap();
    let shape = statement(&Surface::new(&cut, "source").unwrap(), &plain);
    assert!(shape.reasons.is_empty(), "{shape:?}");
    let apart = shape.borders.apart.unwrap();
    assert!((apart.by - 6.25).abs() < 0.5, "{apart:?}");
    assert!(
        apart.at.x > 480.0 && (-250.0..0.0).contains(&apart.at.y),
        "{apart:?}"
    );
    let words = shape.words(Lengths::default());
    assert!(
        words.contains("trimmed differently at one place"),
        "{words}"
    );
    // Each value has its limit beside it.
    let limits = [shape.tolerance.springback, shape.tolerance.remainder];
    for limit in limits.map(|limit| format!(" of {}", Lengths::default().of(limit))) {
        assert!(words.contains(&limit), "{words}");
    }
}

#[test]
fn springback_does_not_shrink_with_the_part() {
    let plain = hat(40, |p| p);
    let tolerance = ShapeTolerance::new(None, Some(1.5), plain.measures().diagonal, 1.0);
    let shape = statement(&hat(37, bent(4.5)), &plain);
    assert_eq!(shape.kind, ShapeKind::Deformed, "{shape:?}");
    assert!(shape.reasons.is_empty(), "{shape:?}");
    assert!(shape.springback > tolerance.springback, "{shape:?}");
}

#[test]
fn what_lies_beyond_the_borders_overhangs_and_what_lies_elsewhere_does_not() {
    let piece = |from: f64, lifted: f64| {
        grid([60, 40], |i, j| {
            let (x, y) = (from + 12.5 * i as f64, 12.5 * j as f64 - 250.0);
            Point3::new(x, y, waves(x, y) + if x < 0.0 { lifted } else { 0.0 })
        })
    };
    let [left, right] = [-500.0, -250.0].map(|from| piece(from, 0.0));
    let shape = statement(&left, &right);
    assert!((shape.met - 2.0 / 3.0).abs() < 0.03, "{shape:?}");
    let beyond = shape.overhang.unwrap();
    assert!((shape.met + beyond - 1.0).abs() < 0.01, "{shape:?}");
    // A third of the other one lies far above the sheet and is no piece that this lacks.
    let shape = statement(&piece(-250.0, 100.0), &right);
    assert!((shape.met - 2.0 / 3.0).abs() < 0.05, "{shape:?}");
    assert!(shape.overhang.unwrap() < 0.02, "{shape:?}");
    assert_eq!(statement(&left, &left).overhang, None);
}

/// A wavy strip of 600 by 150 mm with holes of 24 mm whose borders are those of irregular elements, the holes and the
/// ends moved along it by so many elements of 4 mm. Of each `seed` the nodes lie elsewhere.
fn pierced(seed: f64, holes_by: f64, ends_by: f64) -> Surface {
    let counts = [150, 38];
    let at = |i: f64, j: f64| [4.0 * (i + ends_by) - 300.0, 4.0 * j - 76.0];
    let is_hole = |[x, y]: [f64; 2]| {
        let from_middle = |x: f64, pitch: f64| x - pitch * (x / pitch).round().clamp(-2.0, 2.0);
        let along = from_middle(x - 4.0 * holes_by, 110.0);
        along.hypot(from_middle(y, 30.0)) < 12.0 && y.abs() < 45.0
    };
    let (m, mut triangles) = (counts[1] + 1, Vec::new());
    for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
        let a = (i * m + j) as u32;
        let up = a + m as u32;
        if !is_hole(at(i as f64 + 0.5, j as f64 + 0.5)) {
            triangles.extend([[a, up, up + 1], [a, up + 1, a + 1]]);
        }
    }
    let corners = (0..=counts[0]).flat_map(|i| (0..m).map(move |j| [i as f64, j as f64]));
    let points = corners.map(|[i, j]| {
        let random = |axis: f64| {
            let mixed = (i * 12.9898 + j * 78.233 + axis + seed).sin() * 43_758.547;
            0.7 * (mixed - mixed.floor() - 0.5)
        };
        let [x, y] = at(i + random(0.0), j + random(1.0));
        Point3::new(x, y, 15.0 * (y / 25.0).cos())
    });
    let mesh = TriMesh::new(points.collect(), triangles).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

#[test]
fn holes_that_all_lie_aside_one_way_are_told_however_ragged_their_borders_are() {
    let plain = pierced(0.0, 0.0, 0.0);
    let same = statement(&pierced(7.0, 0.0, 0.0), &plain);
    assert!(same.reasons.is_empty(), "{same:?}");
    let shape = statement(&pierced(7.0, 1.0, 0.0), &plain);
    // Each of them by itself may lie as far aside.
    let [
        ShapeReason::Hole {
            by,
            limit,
            is_mean: true,
            ..
        },
    ] = shape.reasons[..]
    else {
        panic!("{shape:?}");
    };
    assert!(by > 2.0 && by < 5.0 && limit < 2.0, "{shape:?}");
}

#[test]
fn an_outline_that_lies_aside_of_the_holes_is_told() {
    let plain = pierced(0.0, 0.0, 0.0);
    // Both ends, and the sides as they are.
    let shape = statement(&pierced(7.0, 0.0, 2.0), &plain);
    let is_of_borders = |reason: &ShapeReason| matches!(reason, ShapeReason::Borders { .. });
    assert!(shape.reasons.iter().any(is_of_borders), "{shape:?}");
    assert_eq!(shape.borders.other_trim, None);
    // One end that was cut farther in is another trim.
    let trimmed = pierced(7.0, 0.0, 0.0);
    let mesh = trimmed.mesh();
    let points = mesh.positions();
    let is_left = |corners: &&[u32; 3]| corners.iter().all(|&v| points[v as usize].x > -288.0);
    let triangles = mesh.triangles().iter().filter(is_left).copied().collect();
    let trimmed = TriMesh::new(points.to_vec(), triangles).unwrap();
    let shape = statement(&Surface::new(&trimmed, "source").unwrap(), &plain);
    assert!(shape.reasons.is_empty(), "{shape:?}");
}

#[test]
fn an_outline_aside_of_the_holes_does_not_move_them() {
    // An arch of 600 by 200 mm with three holes, with waves across it of this height; both of its sides lie aside by as
    // much.
    let waved = |by: f64, height: f64| {
        let whole = grid([60, 20], |i, j| {
            let aside = if j % 20 == 0 { by } else { 0.0 };
            let [x, y] = [i, j].map(|k| 10.0 * k as f64);
            let y = y + aside;
            let wave = height * (y / 100.0 * std::f64::consts::TAU).sin();
            Point3::new(x, y, 40.0 * ((x - 300.0) / 300.0).powi(2) + wave)
        });
        let mesh = whole.mesh();
        let is_in_hole = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| mesh.positions()[v as usize]);
            let middle = (a.coords + b.coords + c.coords) / 3.0;
            let holes = [[100.0, 50.0], [300.0, 120.0], [440.0, 60.0]];
            let is_within = |at: f64, low: f64| (low..low + 40.0).contains(&at);
            holes
                .iter()
                .any(|[x, y]| is_within(middle.x, *x) && is_within(middle.y, *y))
        };
        let solid = mesh.triangles().iter().filter(|of| !is_in_hole(of));
        let pierced = TriMesh::new(mesh.positions().to_vec(), solid.copied().collect());
        Surface::new(&pierced.unwrap(), "source").unwrap()
    };
    let shape = statement(&waved(6.0, 0.0), &waved(0.0, 0.0));
    assert!(
        matches!(shape.reasons[..], [ShapeReason::Borders { .. }]),
        "{shape:?}"
    );
    assert!(shape.borders.worst_hole < 0.1, "{shape:?}");
    // Where the surfaces agree with the holes, both sides were trimmed elsewhere.
    let shape = statement(&waved(6.0, 8.0), &waved(0.0, 8.0));
    assert!(shape.reasons.is_empty(), "{shape:?}");
    assert!(shape.borders.other_trim.is_some(), "{shape:?}");
}

#[test]
fn the_camber_of_a_slender_part_is_springback() {
    // Deflection within the plane, under which sections stay plane.
    let cambered = |p: Point3| {
        let x = p.x / 200.0;
        let turn = 4.0 * x / 200.0;
        Point3::new(p.x - p.y * turn, p.y + 2.0 * (x * x - 0.3), p.z)
    };
    let plain = hat(40, |p| p);
    let shape = statement(&hat(37, cambered), &plain);
    assert_eq!(shape.kind, ShapeKind::Deformed, "{shape:?}");
    assert!(shape.remainder < 0.1, "{shape:?}");
}

#[test]
fn a_flange_too_far_from_its_counterpart_to_meet_it_is_told() {
    // A step of 80 mm length with a flange of 20 mm at this height.
    let step = |n: usize, height: f64| {
        let profile = |along: f64| match along {
            x if x < 60.0 => (x, 0.0),
            x if x < 80.0 => (60.0, (x - 60.0) / 20.0 * height),
            x => (x - 20.0, height),
        };
        grid([n, n], |i, j| {
            let (x, z) = profile(100.0 * j as f64 / n as f64);
            Point3::new(x, 80.0 * i as f64 / n as f64, z)
        })
    };
    let plain = step(40, 20.0);
    let same = statement(&step(50, 20.0), &plain);
    assert!(same.reasons.is_empty(), "{same:?}");
    for height in [12.0, 28.0] {
        let shape = statement(&step(50, height), &plain);
        let is_told =
            |reason: &ShapeReason| matches!(reason, ShapeReason::Local { by, .. } if *by > 7.0);
        assert!(shape.reasons.iter().any(is_told), "{height}: {shape:?}");
    }
}
