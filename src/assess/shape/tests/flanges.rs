//! Flanges that are bent, shifted or turned the other way.

use super::*;

/// A sheet of 1,000 by 240 mm whose last 40 mm along y are the flange, turned about its fold by an angle in degrees
/// that depends on x, and lifted.
fn flanged(rows: usize, turn: impl Fn(f64) -> f64, lift: impl Fn(f64) -> f64) -> Surface {
    grid([rows, rows], |i, j| {
        let x = 1000.0 * i as f64 / rows as f64;
        let y = 240.0 * j as f64 / rows as f64;
        let beyond = (y - 200.0).max(0.0);
        let angle = turn(x).to_radians();
        let on_flange = f64::from(y > 200.0) * lift(x);
        Point3::new(
            x,
            y.min(200.0) + beyond * angle.cos(),
            beyond * angle.sin() + on_flange + 30.0 * (x / 400.0).sin(),
        )
    })
}

fn reason(source: &Surface, target: &Surface) -> Option<(f64, bool)> {
    let shape = statement(source, target);
    shape.reasons.iter().find_map(|reason| match reason {
        ShapeReason::Local { by, is_end, .. } => Some((*by, *is_end)),
        _ => None,
    })
}

#[test]
fn a_flange_that_is_bent_the_other_way_or_not_at_all_is_told() {
    let down = flanged(120, |_| 80.0, |_| 0.0);
    for turn in [-80.0, 0.0] {
        let (by, _) = reason(&flanged(110, |_| turn, |_| 0.0), &down).unwrap();
        assert!(by > 10.0, "{turn}: {by}");
    }
    assert_eq!(reason(&flanged(110, |_| 80.0, |_| 0.0), &down), None);
    // One that ends at the fold was trimmed there.
    let trimmed = grid([100, 100], |i, j| {
        let (x, y) = (10.0 * i as f64, 2.0 * j as f64);
        Point3::new(x, y, 30.0 * (x / 400.0).sin())
    });
    assert_eq!(reason(&trimmed, &down), None);
}

#[test]
fn a_flange_that_springback_opens_is_accepted_and_stated() {
    // Of the right angle over a third of its length by as much as lifts its edge by 3.5 mm.
    let closed = flanged(120, |_| 60.0, |_| 0.0);
    let opened = |x: f64| 60.0 - 5.0 * (1.0 - ((x - 500.0) / 170.0).powi(2)).max(0.0);
    let shape = statement(&flanged(110, opened, |_| 0.0), &closed);
    assert!(shape.reasons.is_empty(), "{shape:?}");
    assert_eq!(shape.kind, ShapeKind::Deformed);
    let by = shape.bent_end.unwrap().by;
    assert!((2.0..=4.0).contains(&by), "{by}");
    let words = shape.words(Lengths::new(None));
    assert!(words.contains("an end or a flange bent by "), "{words}");
}

#[test]
fn a_flange_that_is_shifted_as_a_whole_is_a_difference() {
    // A joggle of 4 mm, 150 mm long.
    let plain = flanged(120, |_| 0.0, |_| 0.0);
    let step = |x: f64| 4.0 * f64::from((x - 500.0).abs() < 75.0);
    let (by, is_end) = reason(&flanged(110, |_| 0.0, step), &plain).unwrap();
    assert!((3.5..=4.5).contains(&by) && !is_end, "{by} {is_end}");
}

#[test]
fn a_rim_that_lies_off_all_round_is_no_flange_that_springback_opens() {
    // A pan of 300 by 240 mm and 30 mm deep, whose rim of 16 mm lies higher by so much, here more and there less.
    let pan = |rows: usize, higher: f64| {
        grid([rows, rows], move |i, j| {
            let x = 300.0 * i as f64 / rows as f64;
            let y = 240.0 * j as f64 / rows as f64;
            let from_border = x.min(300.0 - x).min(y).min(240.0 - y);
            let share = ((from_border - 16.0) / 20.0).clamp(0.0, 1.0);
            let here = 0.8 + 0.2 * (x / 40.0).sin();
            let on_rim = f64::from(from_border < 16.5) * higher * here;
            Point3::new(x, y, on_rim - 30.0 * share)
        })
    };
    let of = |higher| statement_of_sheet(&pan(110, higher), &pan(120, 0.0), 0.8);
    let shape = of(2.2);
    assert!(
        shape.kind == ShapeKind::OtherVersion && shape.bent_end.is_none(),
        "{shape:?}"
    );
    assert_eq!(of(0.0).reasons, []);
}

#[test]
fn the_lip_of_a_louvre_is_no_flange_that_springback_opens() {
    // A sheet of 400 by 240 mm with four slits of 80 mm, each beside a lip that rises by so much over 30 mm.
    let louvred = |cell: f64, rise: f64| {
        let rows = [(400.0 / cell) as usize, (240.0 / cell) as usize];
        let at = |k: usize| cell * k as f64;
        let from_slit = |x: f64| (x - 60.0).rem_euclid(90.0);
        let is_beside = |y: f64| (80.0..=160.0).contains(&y);
        let whole = grid(rows, |i, j| {
            let [x, y] = [at(i), at(j)];
            let away = (1.0 - from_slit(x - 4.0) / 30.0).max(0.0) * f64::from(x >= 60.0);
            let across = ((40.0 - (y - 120.0).abs()) / 16.0).clamp(0.0, 1.0);
            Point3::new(x, y, 20.0 * (x / 90.0).sin() + rise * away * across)
        });
        let points = whole.mesh().positions();
        let is_solid = |corners: &&[u32; 3]| {
            let middle: Vector3 = corners.iter().map(|&v| points[v as usize].coords).sum();
            let [x, y] = [middle.x / 3.0, middle.y / 3.0];
            x < 60.0 || from_slit(x) > 4.0 || !is_beside(y)
        };
        let solid = whole.mesh().triangles().iter().filter(is_solid).copied();
        let mesh = TriMesh::new(points.to_vec(), solid.collect()).unwrap();
        Surface::new(&mesh, "source").unwrap()
    };
    let target = louvred(4.0, 6.0);
    assert_eq!(reason(&louvred(2.0, 6.0), &target), None);
    let (by, is_end) = reason(&louvred(2.0, 9.0), &target).unwrap();
    assert!((2.0..=5.0).contains(&by) && !is_end, "{by} {is_end}");
}
