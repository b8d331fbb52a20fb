//! Outlines that differ at one place.

use super::*;

/// Cells of two millimetres of a sheet of 300 by 100 mm that is gently curved along, without those that are not wanted;
/// a strip of 20 mm along one side is there for lugs.
fn sheet(is_wanted: impl Fn(f64, f64) -> bool) -> Surface {
    let (n, m) = (150, 60);
    let points = (0..=m).flat_map(|j| {
        (0..=n).map(move |i| {
            let (x, y) = (2.0 * f64::from(i), 2.0 * f64::from(j));
            Point3::new(x, y, 30.0 * (x / 150.0 - 1.0).powi(2))
        })
    });
    let cells = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
    let wanted = cells.filter(|&(i, j)| {
        let (x, y) = (2.0 * f64::from(i) + 1.0, 2.0 * f64::from(j) + 1.0);
        is_wanted(x, y)
    });
    let triangles = wanted.flat_map(|(i, j)| {
        let a = (j * (n + 1) + i) as u32;
        let up = a + n as u32 + 1;
        [[a, a + 1, up + 1], [a, up + 1, up]]
    });
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

/// The sheet with a lug of 20 by 12 mm that begins at this place along it.
fn with_lug(at: f64) -> Surface {
    sheet(|x, y| y < 100.0 || y < 112.0 && (at..at + 20.0).contains(&x))
}

fn plain() -> Surface {
    sheet(|_, y| y < 100.0)
}

/// How many pieces only the source and only the target have.
fn counts(shape: &ShapeStatement) -> [usize; 2] {
    let pieces = shape.borders.pieces;
    pieces.map_or([0, 0], |p| [p.only_source, p.only_target])
}

#[test]
fn a_lug_or_a_notch_that_lies_elsewhere_makes_another_version() {
    let notched = |at: f64| sheet(move |x, y| y < 100.0 && !(y < 14.0 && (x - at).abs() < 10.0));
    for (source, target, by) in [
        (with_lug(60.0), with_lug(110.0), 12.0),
        (with_lug(60.0), with_lug(66.0), 6.0),
        (notched(60.0), notched(200.0), 10.0),
    ] {
        let shape = statement(&source, &target);
        let [ShapeReason::Outlines { pieces }] = shape.reasons[..] else {
            panic!("{shape:?}");
        };
        assert_eq!(counts(&shape), [1, 1]);
        assert!((pieces.by - by).abs() < 0.5, "{pieces:?}");
        assert_eq!(shape.kind, ShapeKind::OtherVersion);
        let words = shape.reasons[0].words(Lengths::default());
        assert!(
            words.contains("1 piece of sheet in the stamped part only"),
            "{words}"
        );
    }
}

#[test]
fn what_only_one_part_has_is_said_and_no_difference() {
    let corner = sheet(|x, y| y < 100.0 && x + y > 40.0);
    for (source, target, expected) in [
        (with_lug(60.0), plain(), [1, 0]),
        (plain(), with_lug(60.0), [0, 1]),
        (corner, plain(), [0, 1]),
    ] {
        let shape = statement(&source, &target);
        assert_eq!(shape.reasons, []);
        assert_eq!(counts(&shape), expected);
        let role = if expected[0] > 0 { "stamped" } else { "crash" };
        let said = format!("1 piece of sheet at the outline in the {role} part only");
        let words = shape.words(Lengths::default());
        assert!(words.contains(&said), "{words}");
    }
}

#[test]
fn sides_and_ends_that_were_trimmed_elsewhere_are_no_pieces() {
    let ends = |from: f64, to: f64| sheet(move |x, y| y < 100.0 && (from..to).contains(&x));
    let wide = sheet(|_, y| (8.0..108.0).contains(&y));
    for (source, target) in [
        (ends(0.0, 280.0), ends(20.0, 300.0)),
        (plain(), wide),
        (plain(), plain()),
    ] {
        let shape = statement(&source, &target);
        assert_eq!(counts(&shape), [0, 0], "{shape:?}");
    }
}

/// A half shell of 600 mm, nearly round, about an axis that bends sideways, whose border on one side lies `longer` rows
/// of 2.5 mm farther around, with five holes.
fn half_shell(longer: u32) -> Surface {
    let (n, m) = (75, 60 + longer);
    let smooth = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let point = |i: u32, j: u32| {
        let (u, angle) = (8.0 * f64::from(i), PI * f64::from(j) / 60.0);
        let radius = 46.0 + 6.0 * smooth((u - 200.0) / 150.0);
        let aside = 80.0 * smooth((u - 100.0) / 400.0);
        Point3::new(
            u,
            radius * angle.cos() + aside,
            (radius - 6.0) * angle.sin() + 30.0 * (u / 180.0).sin(),
        )
    };
    let is_hole = |i: u32, j: u32| {
        let holes = [(8, 28), (22, 24), (37, 34), (52, 30), (66, 20)];
        let is_in = |(u, v): (u32, u32)| (u..u + 2).contains(&i) && (v..v + 6).contains(&j);
        holes.into_iter().any(is_in)
    };
    let points = (0..=m).flat_map(|j| (0..=n).map(move |i| point(i, j)));
    let cells = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = cells.filter(|&(i, j)| !is_hole(i, j)).flat_map(|(i, j)| {
        let a = j * (n + 1) + i;
        let up = a + n + 1;
        [[a, a + 1, up + 1], [a, up + 1, up]]
    });
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

#[test]
fn a_border_that_was_trimmed_elsewhere_turns_no_shell_off_its_holes() {
    let shape = statement(&half_shell(0), &half_shell(2));
    let borders = &shape.borders;
    assert!(borders.worst_hole < 0.3, "{shape:?}");
    let apart = borders.other_trim.unwrap();
    assert!((apart - 5.0).abs() < 1.0, "{shape:?}");
    assert_eq!(shape.reasons, []);
}
