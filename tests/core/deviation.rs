//! Signed distances between parts: against brute force, on offset sheets, on trimmed samples.

use shapematch::assess::deviation::*;
use shapematch::geometry::{Point3, Similarity, TriMesh, Vector3};
use shapematch::monitor::{Cancelled, Monitor};
use shapematch::registration::Surface;
use shapematch::samples::{SamplePart, SampleSettings, SampleVariant, generate};
use shapematch::search::{BruteForce, ClosestPoint, Feature};

use super::drawn_pan::{everywhere, pan, placement};

fn surface(mesh: &TriMesh) -> Surface {
    Surface::new(mesh, "source").unwrap()
}

/// An n × n grid over the unit square, mapped by `place`.
fn sheet(n: u32, place: impl Fn(f64, f64) -> Point3) -> TriMesh {
    let at = |i: u32| f64::from(i) / f64::from(n);
    let mut positions = Vec::new();
    for j in 0..=n {
        positions.extend((0..=n).map(|i| place(at(i), at(j))));
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
        }
    }
    TriMesh::new(positions, triangles).unwrap()
}

/// Part of a cylinder about the y axis, its normals pointing away from the axis.
fn arc(n: u32, radius: f64) -> TriMesh {
    sheet(n, |u, v| {
        let angle = 1.5 * u - 0.75;
        Point3::new(radius * angle.sin(), 80.0 * v, radius * angle.cos())
    })
}

fn compared(source: &TriMesh, target: &TriMesh, settings: &DeviationSettings) -> Deviation {
    let (source, target) = (surface(source), surface(target));
    let pose = Similarity::identity();
    compare(&source, &target, &pose, settings, &Monitor::silent()).unwrap()
}

fn default_comparison(source: &TriMesh, target: &TriMesh) -> Deviation {
    compared(source, target, &DeviationSettings::default())
}

#[test]
fn distances_are_those_of_a_plain_loop() {
    let target = pan(14.0, 0.35, everywhere);
    let moved = pan(11.0, 0.0, everywhere).transformed(&placement(5));
    let pose = placement(5).inverse();
    let (source, onto) = (surface(&moved), surface(&target));
    let settings = DeviationSettings::default();
    let monitor = Monitor::silent();
    let field = source_on_target(&source, &onto, &pose, &settings, &monitor).unwrap();
    let back = target_on_source(&source, &onto, &pose, &settings, &monitor).unwrap();
    let both = both_ways(&source, &onto, &pose, &settings, &monitor).unwrap();
    assert!(both == [field.clone(), back]);
    let brute = BruteForce::new(onto.mesh().clone());
    let mut n_inside = 0;
    for (vertex, position) in moved.positions().iter().enumerate() {
        let query = pose.apply(position);
        let hit = brute.closest(&query, f64::INFINITY, None, None).unwrap();
        let away = query - hit.point;
        if hit.feature == Feature::Face {
            let normal = onto.mesh().normal(hit.triangle as usize);
            assert!((field.signed[vertex] - away.dot(&normal)).abs() < 1e-9);
            n_inside += 1;
        } else if !onto.is_on_border(&hit) {
            assert!((field.signed[vertex].abs() - away.norm()).abs() < 1e-9);
        }
    }
    assert!(n_inside > moved.n_vertices() / 2);
    let total: f64 = field.area.iter().sum();
    assert!((total - moved.area()).abs() < 1e-6 * total);
}

#[test]
fn both_directions_have_the_sign_of_the_crash_normal() {
    let (inner, outer) = (arc(40, 100.0), arc(31, 100.6));
    let check = |source: &TriMesh, target: &TriMesh, wanted: f64| {
        let found = default_comparison(source, target);
        assert!(found.is_signed);
        for way in [&found.source_on_target, &found.target_on_source] {
            let stats = &way.stats;
            assert!((stats.mean - wanted).abs() < 0.05, "{stats:?}");
            assert_eq!(stats.class_shares[2], 0.0, "nothing is alone");
        }
    };
    check(&outer, &inner, 0.6);
    check(&outer, &inner.clone().flipped(), -0.6);
    check(&outer.clone().flipped(), &inner, 0.6);
    check(&inner, &outer, -0.6);
}

#[test]
fn a_constant_offset_is_named_by_the_thickness() {
    let pair = (arc(31, 100.6), arc(40, 100.0));
    let offset = |thickness| {
        let settings = DeviationSettings {
            thickness: Some(thickness),
            ..DeviationSettings::default()
        };
        let found = compared(&pair.0, &pair.1, &settings);
        found.source_on_target.stats.offset
    };
    let half = offset(1.2).unwrap();
    assert_eq!(half.kind, OffsetKind::ToolSideAgainstMidSurface);
    assert_eq!(
        half.words(|length| format!("{length:.1} mm")),
        "looks like tool side against mid-surface, 0.6 mm"
    );
    assert_eq!(offset(0.62).unwrap().kind, OffsetKind::OppositeSides);
    assert_eq!(offset(4.0), None);
    // The same sheet twice has none, and neither has one that lies half in front, half behind.
    let tilted = sheet(31, |u, v| {
        let angle = 1.5 * u - 0.75;
        let radius = 99.4 + 1.2 * v;
        Point3::new(radius * angle.sin(), 80.0 * v, radius * angle.cos())
    });
    for source in [arc(37, 100.0), tilted] {
        let settings = DeviationSettings {
            thickness: Some(1.2),
            ..DeviationSettings::default()
        };
        let found = compared(&source, &pair.1, &settings);
        assert_eq!(found.source_on_target.stats.offset, None);
    }
}

#[test]
fn an_offset_is_found_although_the_pose_hides_it() {
    // A hat section whose source is the surface a millimetre above, moved as a match would to
    // lessen the distances: 0.7 down.
    let hat = |lift: f64| {
        sheet(60, move |u, v| {
            // Web and walls at 80°, joined without rounding.
            let (x, steep) = (120.0 * (u - 0.5), 80f64.to_radians());
            let (web, along) = (30.0, x.abs() - 30.0);
            let at = if along < 0.0 {
                [x, lift]
            } else {
                let y = -along * steep.sin();
                let x = (web + along * steep.cos()) * x.signum();
                [x + lift * steep.sin() * x.signum(), y + lift * steep.cos()]
            };
            Point3::new(at[0], 200.0 * v + 8.0 * (x / 40.0).sin(), at[1])
        })
    };
    let lowered = Similarity {
        translation: Vector3::new(0.0, 0.0, -0.7),
        ..Similarity::identity()
    };
    let (source, target) = (surface(&hat(1.0)), surface(&hat(0.0)));
    let settings = DeviationSettings {
        thickness: Some(2.0),
        ..DeviationSettings::default()
    };
    let found = compare(&source, &target, &lowered, &settings, &Monitor::silent()).unwrap();
    let stats = &found.source_on_target.stats;
    assert!(stats.quantile(0.5).abs() < 0.95, "hidden by the move");
    let constant = found.source_on_target.field.constant.unwrap();
    assert!((constant.value.abs() - 1.0).abs() < 0.05, "{constant:?}");
    let offset = stats.offset.unwrap();
    assert_eq!(offset.kind, OffsetKind::ToolSideAgainstMidSurface);
    // The same hat moved has no offset at all, and on a flat plate the two are one.
    let same = surface(&hat(0.0));
    let found = compare(&same, &target, &lowered, &settings, &Monitor::silent()).unwrap();
    assert_eq!(found.source_on_target.stats.offset, None);
    let plate = |z: f64| sheet(20, move |u, v| Point3::new(90.0 * u, 90.0 * v, z));
    let found = compared(&plate(1.0), &plate(0.0), &settings);
    assert_eq!(found.source_on_target.field.constant, None);
    assert!(found.source_on_target.stats.offset.is_some());
}

#[test]
fn what_the_other_part_lacks_is_only_here() {
    for (variant, is_crash_cut) in [
        (SampleVariant::Cut, true),
        (SampleVariant::MissingFlanges, false),
    ] {
        let settings = SampleSettings {
            part: SamplePart::Bracket,
            variant,
            ..SampleSettings::default()
        };
        let pair = generate(&settings);
        let (crash, stamped) = (pair.crash.to_trimesh(), pair.stamped.to_trimesh());
        let (source, target) = (surface(&stamped), surface(&crash));
        let settings = DeviationSettings::default();
        let pose = &pair.crash_from_stamped;
        let found = compare(&source, &target, pose, &settings, &Monitor::silent()).unwrap();
        let [long, short] = if is_crash_cut {
            [&found.source_on_target, &found.target_on_source]
        } else {
            [&found.target_on_source, &found.source_on_target]
        };
        let areas = [crash.area(), stamped.area()];
        let missing = 1.0 - areas[0].min(areas[1]) / areas[0].max(areas[1]);
        assert!(missing > 0.05, "the sample is trimmed");
        let [matched, off, alone] = long.stats.class_shares;
        assert!(
            (alone - missing).abs() < 0.04,
            "{variant:?}: {alone} for {missing}"
        );
        assert!(off < 0.01 && (matched + off + alone - 1.0).abs() < 1e-9);
        assert!(short.stats.class_shares[0] > 0.98, "{variant:?}");
    }
}

#[test]
fn a_flange_below_the_other_parts_end_is_not_over_it() {
    let plate = sheet(20, |u, v| Point3::new(100.0 * u, 100.0 * v, 0.0));
    // The same plate, with the last fifth bent straight down.
    let bent = sheet(25, |u, v| {
        let x = 125.0 * u;
        Point3::new(x.min(100.0), 100.0 * v, -(x - 100.0).max(0.0))
    });
    let found = default_comparison(&bent, &plate);
    let [matched, off, alone] = found.source_on_target.stats.class_shares;
    assert!(off < 0.01, "{off}");
    assert!(
        (alone - 0.2).abs() < 0.03 && (matched - 0.8).abs() < 0.03,
        "{alone} {matched}"
    );
    // A dent faces the plate and is off by more than the limit.
    let dented = sheet(25, |u, v| {
        let r = (u - 0.5).hypot(v - 0.5);
        Point3::new(100.0 * u, 100.0 * v, -5.0 * (-(r / 0.15).powi(2)).exp())
    });
    let found = default_comparison(&dented, &plate);
    let [_, off, alone] = found.source_on_target.stats.class_shares;
    assert!(off > 0.01 && alone == 0.0, "{off} {alone}");
    assert!(found.source_on_target.stats.min < -4.5);
}

#[test]
fn a_trim_line_a_little_farther_out_is_no_deviation() {
    let plate = |size: f64| sheet(20, move |u, v| Point3::new(size * u, size * v, 0.0));
    let found = default_comparison(&plate(101.0), &plate(100.0));
    let stats = &found.source_on_target.stats;
    assert!(stats.max.abs() < 1e-9 && stats.min.abs() < 1e-9);
    assert_eq!(stats.class_shares, [1.0, 0.0, 0.0]);
}

#[test]
fn a_strip_with_one_side_has_distances_without_sign() {
    let strip = |radius: f64| {
        // The last row is the first one turned over.
        let n = 60;
        let mut positions = Vec::new();
        for i in 0..n {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            for side in [-10.0, 10.0] {
                let (sin, cos) = (angle / 2.0).sin_cos();
                let r = radius + side * cos;
                positions.push(Point3::new(r * angle.cos(), r * angle.sin(), side * sin));
            }
        }
        let mut triangles = Vec::new();
        for i in 0..n {
            let (a, b) = (2 * i, 2 * i + 1);
            let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
            triangles.extend([[a, b, c], [b, d, c]]);
        }
        TriMesh::new(positions, triangles).unwrap()
    };
    let found = default_comparison(&strip(60.0), &strip(60.0));
    assert!(!found.is_signed);
    let signed = &found.source_on_target.field.signed;
    assert!(signed.iter().all(|value| *value >= 0.0));
}

#[test]
fn worst_spots_are_the_tops_of_separate_bumps() {
    let bumps = [(30.0, 40.0, 3.0), (70.0, 60.0, -2.0), (20.0, 80.0, 1.0)];
    let bumpy = sheet(50, |u, v| {
        let (x, y) = (100.0 * u, 100.0 * v);
        let height = |&(cx, cy, h): &(f64, f64, f64)| {
            h * (-((x - cx).powi(2) + (y - cy).powi(2)) / 40.0).exp()
        };
        Point3::new(x, y, bumps.iter().map(height).sum())
    });
    let plate = sheet(20, |u, v| Point3::new(100.0 * u, 100.0 * v, 0.0));
    let found = default_comparison(&bumpy, &plate);
    let spots = &found.source_on_target.spots;
    for (spot, (x, y, height)) in spots.iter().zip(bumps) {
        assert!((spot.value - height).abs() < 0.05, "{spot:?}");
        assert!(
            (spot.position - Point3::new(x, y, height)).norm() < 2.5,
            "{spot:?}"
        );
        assert_eq!(spot.position, bumpy.positions()[spot.vertex as usize]);
    }
    assert!(spots.len() >= 3);
    assert!(
        spots
            .windows(2)
            .all(|pair| pair[0].value.abs() >= pair[1].value.abs())
    );
}

#[test]
fn numbers_are_those_of_a_plain_sum() {
    let tilted = sheet(30, |u, v| Point3::new(100.0 * u, 100.0 * v, 2.0 * u - 0.5));
    let plate = sheet(20, |u, v| Point3::new(100.0 * u, 100.0 * v, 0.0));
    let stats = default_comparison(&tilted, &plate).source_on_target.stats;
    // Heights are even from -0.5 to 1.5.
    assert!((stats.mean - 0.5).abs() < 0.01 && (stats.std - 0.5774).abs() < 0.02);
    assert!((stats.rms - stats.mean.hypot(stats.std)).abs() < 1e-12);
    assert!((stats.share_inside(0.5) - 0.5).abs() < 0.05);
    assert_eq!(stats.share_inside(1e9), 1.0);
    assert!((stats.p95 - 1.4).abs() < 0.05);
    assert!((stats.quantile(0.5) - 0.5).abs() < 0.05);
    let bins = stats.histogram(8, [-0.5, 0.5]);
    let sum: f64 = bins.shares.iter().sum();
    assert!((sum + bins.below + bins.above - 1.0).abs() < 1e-9);
    assert!((bins.above - 0.5).abs() < 0.05 && bins.below < 1e-6);
    assert_eq!(stats.round_limit(), 2.0);
    // What rounding leaves is nothing to see.
    let same = sheet(30, |u, v| Point3::new(100.0 * u, 100.0 * v, 1e-11 * u));
    let stats = default_comparison(&same, &plate).source_on_target.stats;
    assert_eq!(stats.round_limit(), 1.0);
}

#[test]
fn the_answer_does_not_depend_on_the_threads_and_can_be_cancelled() {
    let (source, target) = (arc(31, 100.6), arc(40, 100.0));
    let on = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        let found = pool
            .unwrap()
            .install(|| default_comparison(&source, &target));
        (found.source_on_target.field, found.target_on_source.stats)
    };
    assert_eq!(on(1), on(4));
    let monitor = Monitor::silent();
    monitor.request_cancel();
    let (source, target) = (surface(&source), surface(&target));
    let pose = Similarity::identity();
    let found = compare(
        &source,
        &target,
        &pose,
        &DeviationSettings::default(),
        &monitor,
    );
    assert_eq!(found.err(), Some(Cancelled));
}

#[test]
fn a_pose_with_a_scale_measures_in_target_lengths() {
    let (outer, inner) = (arc(31, 100.6), arc(40, 100.0));
    let metres = outer.transformed(&Similarity::from_scale(1e-3));
    let pose = Similarity::from_scale(1e3);
    let (source, target) = (surface(&metres), surface(&inner));
    let settings = DeviationSettings::default();
    let found = compare(&source, &target, &pose, &settings, &Monitor::silent()).unwrap();
    for way in [&found.source_on_target, &found.target_on_source] {
        assert!((way.stats.mean - 0.6).abs() < 0.05, "{:?}", way.stats);
    }
    let area: f64 = found.source_on_target.field.area.iter().sum();
    assert!((area - outer.area()).abs() < 1e-6 * area);
    let up = Vector3::new(0.0, 0.0, 1.0);
    assert!(
        inner.mean_normal().dot(&up) > 0.5,
        "the arc's normals point away from its axis"
    );
}
