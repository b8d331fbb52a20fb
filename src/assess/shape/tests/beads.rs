//! Beads, dents and bent corners that only one of two parts has.

use super::*;

#[test]
fn a_bead_that_one_part_lacks_is_told_with_its_place() {
    let bead = |x: f64, y: f64| {
        let from_middle = ((x - 100.0) / 60.0).hypot((y - 50.0) / 25.0);
        4.0 * (1.0 - from_middle * from_middle).max(0.0)
    };
    let plain = sheet(80, [0.0, 0.0], 1.0, waves);
    // It covers a hundredth of the sheet, so that it does not show at 95 % of the area.
    let beaded = sheet(74, [0.0, 0.0], 1.0, |x, y| waves(x, y) + bead(x, y));
    for [source, target] in [[&beaded, &plain], [&plain, &beaded]] {
        let shape = statement(source, target);
        assert_eq!(shape.kind, ShapeKind::OtherVersion, "{shape:?}");
        assert!(shape.remainder < 0.3, "{shape:?}");
        let [ShapeReason::Local { by, at, .. }] = shape.reasons[..] else {
            panic!("{shape:?}");
        };
        assert!(by > 3.0 && by < 4.2, "{by}");
        assert!(
            (at.x - 100.0).abs() < 30.0 && (at.y - 50.0).abs() < 20.0,
            "{at}"
        );
    }
}

#[test]
fn a_bead_narrower_than_the_elements_can_show_is_told_where_both_meshes_say_so() {
    // 4 mm high, 16 mm wide and 200 mm long.
    let beaded = |x: f64, y: f64| {
        let across = ((y - 51.0) / 8.0).abs().min(1.0);
        let along = ((x - 40.0) / 100.0).abs();
        let end = ((1.2 - along) / 0.2).clamp(0.0, 1.0);
        waves(x, y) + 2.0 * (1.0 + (PI * across).cos()) * end
    };
    let mesh = |n: usize, height: &dyn Fn(f64, f64) -> f64| sheet(n, [0.0, 0.0], 1.0, height);
    let (coarse, fine) = (mesh(80, &waves), mesh(148, &waves));
    let (coarse_beaded, fine_beaded) = (mesh(77, &beaded), mesh(140, &beaded));
    for [source, target] in [
        [&fine_beaded, &coarse],
        [&coarse, &fine_beaded],
        [&coarse_beaded, &fine],
        [&coarse_beaded, &coarse],
    ] {
        let shape = statement(source, target);
        assert!(
            matches!(shape.reasons[..], [ShapeReason::Local { .. }]),
            "{shape:?}"
        );
    }
    // Elements of 6 and of 14 mm cut the bead short, and do not take it away.
    for n in [80, 34] {
        let cut_short = mesh(n, &beaded);
        for [source, target] in [[&cut_short, &fine_beaded], [&fine_beaded, &cut_short]] {
            let shape = statement(source, target);
            assert!(shape.reasons.is_empty(), "{n}: {shape:?}");
        }
    }
}

/// More nodes lie beneath it than places are looked at, in either mesh.
#[test]
fn a_small_bead_is_found_on_fine_meshes() {
    // 3 mm high, 18 mm wide and 30 mm long.
    let bead = |x: f64, y: f64| {
        let from_middle = ((x - 100.0) / 15.0).hypot((y - 50.0) / 9.0);
        3.0 * (1.0 - from_middle.powi(4)).max(0.0)
    };
    let mesh = |n: usize, by: f64, bend: f64| {
        let height = |x: f64, y: f64| waves(x, y) + by * bead(x, y) + bend * (x / 500.0).powi(2);
        sheet(n, [0.0, 0.0], 1.0, height)
    };
    let (plain, beaded) = (mesh(150, 0.0, 0.0), mesh(140, 1.0, 0.0));
    // With a bend most nodes lie farther apart than the tolerance.
    let bent = mesh(140, 1.0, 3.5);
    let pairs = [
        [&beaded, &plain],
        [&plain, &beaded],
        [&bent, &plain],
        [&plain, &bent],
    ];
    for [source, target] in pairs {
        let shape = statement(source, target);
        let [ShapeReason::Local { by, .. }] = shape.reasons[..] else {
            panic!("{shape:?}");
        };
        assert!(by > 2.5 && by < 3.1, "{by}");
    }
    let shape = statement(&mesh(140, 1.0, 0.0), &mesh(150, 1.0, 0.0));
    assert!(shape.reasons.is_empty(), "{shape:?}");
}

#[test]
fn a_narrow_bead_is_found_however_deep_it_is() {
    // A bracket of 120 by 60 mm with a bead 16 mm wide.
    let bracket = |n: usize, depth: f64| {
        grid([2 * n, n], move |i, j| {
            let [x, y] = [i, j].map(|k| 60.0 * k as f64 / n as f64 - 30.0);
            let across = ((y - 2.0) / 8.0).abs().min(1.0);
            let end = ((30.0 - (x - 30.0).abs()) / 5.0).clamp(0.0, 1.0);
            let bead = depth / 2.0 * (1.0 + (PI * across).cos()) * end;
            Point3::new(x, y, 5.0 * (x / 20.0).sin() + 3.0 * (y / 12.0).cos() + bead)
        })
    };
    let plain = bracket(45, 0.0);
    // The nodes of the deep ones lie farther from the plain sheet than from each other.
    for depth in [3.0, 5.0, 7.0] {
        let shape = statement(&plain, &bracket(15, depth));
        assert!(
            matches!(shape.reasons[..], [ShapeReason::Local { .. }]),
            "{depth}: {shape:?}"
        );
    }
}

#[test]
fn beads_that_run_out_at_an_outline_and_bent_flanges_are_told() {
    let plain = sheet(80, [0.0, 0.0], 1.0, waves);
    let told = |lift: &dyn Fn(f64, f64) -> f64| {
        let source = sheet(74, [0.0, 0.0], 1.0, |x, y| waves(x, y) + lift(x, y));
        let shape = statement(&source, &plain);
        assert_ne!(shape.kind, ShapeKind::Different, "{shape:?}");
        shape.reasons.first().copied()
    };
    // 4 mm high and 40 mm wide, over the last 200 mm.
    let bead = |x: f64, y: f64| {
        let across = ((y - 30.0) / 20.0).abs().min(1.0);
        let along = ((x - 300.0) / 40.0).clamp(0.0, 1.0);
        2.0 * (1.0 + (PI * across).cos()) * along
    };
    // The last 30 mm over half the length, turned about their root.
    let flange = |most: f64| {
        move |x: f64, y: f64| most * ((y - 220.0) / 30.0).max(0.0) * f64::from(x.abs() < 250.0)
    };
    assert!(
        matches!(told(&bead), Some(ShapeReason::Local { is_end: false, .. })),
        "{:?}",
        told(&bead)
    );
    let bent = told(&flange(9.0));
    assert!(
        matches!(bent, Some(ShapeReason::Local { is_end: true, by, limit, .. }) if by > 7.0 && limit == 5.0),
        "{bent:?}"
    );
    assert_eq!(told(&flange(4.0)), None);
    // A fifth of the part, turned by much, is another version of it.
    let wide = |_: f64, y: f64| 0.25 * (y - 160.0).max(0.0);
    let turned = told(&wide);
    assert!(
        matches!(turned, Some(ShapeReason::Surface { mostly: false, by, limit, .. }) if by > 6.0 * limit),
        "{turned:?}"
    );
}

#[test]
fn noise_and_a_bent_corner_are_no_beads() {
    let plain = sheet(80, [0.0, 0.0], 1.0, waves);
    // Fewer places than one in twenty, which 95 % of the area leave out, lie 1.6 to 2 mm off, each by itself.
    let rough = |x: f64, y: f64| {
        let mixed = (x * 12.9898 + y * 78.233).sin() * 43_758.547;
        let random = mixed - mixed.floor();
        if random < 0.045 {
            2.0 - 8.0 * random
        } else {
            0.0
        }
    };
    let noisy = sheet(74, [0.0, 0.0], 1.0, |x, y| waves(x, y) + rough(x, y));
    assert!(statement(&noisy, &plain).reasons.is_empty());
    // The last 60 mm at a corner are bent up by 3 mm, more sharply than any springback of the whole.
    let corner =
        |x: f64, y: f64| 3.0 * (((x - 440.0) / 60.0).max(0.0) * ((y - 190.0) / 60.0).max(0.0));
    let bent = sheet(74, [0.0, 0.0], 1.0, |x, y| waves(x, y) + corner(x, y));
    assert!(statement(&bent, &plain).reasons.is_empty());
}
