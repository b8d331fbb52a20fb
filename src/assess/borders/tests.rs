//! Borders of parts whose difference is known.

use super::*;
use crate::geometry::{Matrix3, TriMesh};

/// A sheet of `n` by 20 cells of one millimetre without the cells in rows and columns 4 to 7.
fn sheet(n: usize, hole_at: usize) -> Surface {
    noisy_sheet(n, hole_at, 0.0)
}

/// The same, every node up to `noise` above or below.
fn noisy_sheet(n: usize, hole_at: usize, noise: f64) -> Surface {
    holed_sheet(n, [hole_at..hole_at + 4, 4..8], noise)
}

/// A sheet without the cells in these columns and rows.
fn holed_sheet(n: usize, [columns, rows]: [std::ops::Range<usize>; 2], noise: f64) -> Surface {
    let points = (0..=20 * (n + 1) + n).map(|i| {
        let (x, y) = (i % (n + 1), i / (n + 1));
        // Digits of a sine that have nothing to do with each other.
        let height = 2.0 * (43_758.545 * (12.99 * i as f64).sin()).rem_euclid(1.0) - 1.0;
        Point3::new(x as f64, y as f64, noise * height)
    });
    let cells = (0..n * 20).map(|i| (i % n, i / n));
    let is_hole = |(x, y): &(usize, usize)| columns.contains(x) && rows.contains(y);
    let triangles = cells.filter(|cell| !is_hole(cell)).flat_map(|(x, y)| {
        let a = (y * (n + 1) + x) as u32;
        let up = a + n as u32 + 1;
        [[a, a + 1, up + 1], [a, up + 1, up]]
    });
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

/// The borders of parts that lie where they are.
fn compared(source: &Surface, target: &Surface) -> Borders {
    BorderComparison::new([source, target], 1.0, 3.0).at(&Similarity::identity())
}

#[test]
fn a_longer_part_misses_its_borders_and_a_shifted_hole_is_found() {
    let (plain, longer, moved) = (sheet(30, 5), sheet(32, 5), sheet(30, 6));
    let least = |borders: &Borders| borders.pairs.iter().map(|p| p.gap).fold(0.0, f64::min);
    let same = compared(&plain, &plain);
    assert!(same.pairs.len() > 500 && same.pairs.iter().all(|p| p.gap == 0.0));
    assert_eq!(same.holes.len(), 1);
    let other = compared(&plain, &longer);
    assert!((least(&other) + 2.0).abs() < 1e-9);
    let hole = compared(&plain, &moved);
    assert_eq!(hole.holes.len(), 1);
    assert!((hole.holes[0].off + Vector3::x()).norm() < 1e-9);
}

#[test]
fn noise_that_bends_every_edge_hides_no_border_and_widens_no_hole() {
    let (plain, noisy) = (sheet(30, 5), noisy_sheet(30, 5, 0.8));
    for pair in [[&plain, &noisy], [&noisy, &plain]] {
        let borders = compared(pair[0], pair[1]);
        assert!(borders.share() > 0.95, "{}", borders.share());
        assert!(borders.pairs.iter().all(|p| p.gap.abs() < 0.6));
        assert_eq!(borders.holes.len(), 1);
        assert!(borders.holes[0].wider < 0.15, "{}", borders.holes[0].wider);
    }
}

#[test]
fn a_slot_that_is_turned_is_another_hole() {
    let slot = |columns, rows| holed_sheet(30, [columns, rows], 0.0);
    let (along, across) = (slot(5..13, 6..10), slot(7..11, 4..12));
    let borders = compared(&along, &across);
    assert_eq!(borders.holes.len(), 1);
    let turned = &borders.holes[0];
    assert!(turned.off.norm() < 1e-9 && turned.wider > 2.0, "{turned:?}");
    // One whose end is cut off by an element is the same.
    let shorter = compared(&along, &slot(5..12, 6..10));
    assert!(shorter.holes[0].wider < 0.5, "{:?}", shorter.holes[0]);
}

#[test]
fn a_hole_is_missed_by_no_shift() {
    let plain = sheet(30, 5);
    for shift in 1..=12 {
        let borders = compared(&plain, &sheet(30, 5 + shift));
        let off = borders.all_holes().map(|pair| pair.off.norm()).next();
        let n_alone = borders.missing.each_ref().map(Vec::len);
        match off {
            Some(off) => assert!((off - shift as f64).abs() < 1e-9 && n_alone == [0, 0]),
            None => assert_eq!(n_alone, [1, 1], "{shift}"),
        }
    }
}

#[test]
fn a_hole_keeps_the_one_that_it_lies_on_whichever_comes_first() {
    let at = |x: f64| Hole {
        center: Point3::new(x, 0.0, 0.0),
        radius: 5.0,
        circle: None,
        length: 31.0,
        moment: Matrix3::zeros(),
        normal: Vector3::z(),
    };
    // The first hole of the source lies beside the hole on which the second one lies.
    assert_eq!(
        partners(&[at(-2.0), at(0.0)], &[at(0.0)], 3.0),
        [None, Some(0)]
    );
    let (source, target) = ([at(-2.0), at(0.0), at(2.0)], [at(2.0), at(-0.1)]);
    assert_eq!(partners(&source, &target, 3.0), [None, Some(1), Some(0)]);
    // The one that is left takes what is near enough, of two the first.
    assert_eq!(partners(&[at(0.0)], &[at(2.0), at(-2.0)], 3.0), [Some(0)]);
    assert_eq!(partners(&[at(0.0)], &[at(6.0)], 3.0), [None]);
}

#[test]
fn holes_that_overlap_are_moved_or_resized_but_no_pilot_hole_is() {
    let hole = |x: f64, radius: f64| Hole {
        center: Point3::new(x, 0.0, 0.0),
        radius,
        circle: None,
        length: 0.0,
        moment: Matrix3::zeros(),
        normal: Vector3::z(),
    };
    for (off, [a, b], expected) in [
        (0.0, [6.0, 11.0], true),
        (0.0, [22.0, 10.0], true),
        (12.0, [12.0, 12.0], true),
        (25.0, [12.0, 12.0], false),
        // A pilot hole in the middle of an opening, and one somewhere within it.
        (0.0, [5.0, 60.0], false),
        (30.0, [20.0, 60.0], false),
    ] {
        for [a, b] in [[a, b], [b, a]] {
            assert_eq!(
                overlaps(&hole(0.0, a), &hole(off, b)),
                expected,
                "{off} {a} {b}"
            );
        }
    }
    let steep = Hole {
        normal: Vector3::x(),
        ..hole(1.0, 6.0)
    };
    assert!(!overlaps(&hole(0.0, 6.0), &steep));
}

#[test]
fn holes_on_different_sides_are_missing_both_ways() {
    let (left, right) = (sheet(30, 3), sheet(30, 22));
    let borders = compared(&left, &right);
    assert!(borders.holes.is_empty());
    assert_eq!(borders.missing.each_ref().map(Vec::len), [1, 1]);
}

#[test]
fn a_hole_behind_another_layer_is_not_missing() {
    let (source, behind) = (sheet(30, 3), sheet(30, 22));
    // The second layer has its hole elsewhere, and the first is solid there.
    let shift = Vector3::new(0.0, 0.0, -1.0);
    let mut positions = source.mesh().positions().to_vec();
    let first = positions.len() as u32;
    positions.extend(behind.mesh().positions().iter().map(|p| p + shift));
    let mut triangles = source.mesh().triangles().to_vec();
    triangles.extend(
        behind
            .mesh()
            .triangles()
            .iter()
            .map(|t| t.map(|v| first + v)),
    );
    let target = Surface::new(&TriMesh::new(positions, triangles).unwrap(), "target").unwrap();
    let borders = compared(&source, &target);
    assert_eq!(borders.holes.len(), 1);
    assert_eq!(borders.missing.each_ref().map(Vec::len), [0, 0]);
    // On the second layer it is, while the first has the other hole still.
    let down = Similarity {
        translation: shift,
        ..Similarity::identity()
    };
    let borders = BorderComparison::new([&source, &target], 1.0, 3.0).at(&down);
    assert_eq!(borders.missing.each_ref().map(Vec::len), [0, 1]);
}

#[test]
fn the_share_of_borders_that_lie_together_leaves_out_those_aside() {
    let (plain, longer) = (sheet(30, 5), sheet(32, 5));
    let borders = compared(&plain, &longer);
    let left: Vec<f64> = borders.pairs.iter().map(|p| p.gap).collect();
    // One of the short ends, 20 of 116 mm, lies two millimetres aside.
    let together = borders.share_within(&left, 0.5);
    assert!((together - 96.0 / 116.0).abs() < 0.03, "{together}");
    assert!((borders.share_within(&left, 3.0) - borders.share()).abs() < 1e-9);
    assert_eq!(Borders::default().share_within(&[], 1.0), 0.0);
}

/// A plate with a round hole of radius 5 whose vertices lie at these angles.
fn plate(angles: &[f64]) -> Surface {
    let n = angles.len() as u32;
    let ring = |radius: f64| {
        let at = move |angle: &f64| Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        angles.iter().map(at)
    };
    let cell = |k: u32| {
        let next = (k + 1) % n;
        [[k, n + k, n + next], [k, n + next, next]]
    };
    let mesh = TriMesh::new(
        ring(5.0).chain(ring(20.0)).collect(),
        (0..n).flat_map(cell).collect(),
    );
    Surface::new(&mesh.unwrap(), "plate").unwrap()
}

#[test]
fn a_round_hole_is_the_same_however_its_vertices_are_spread() {
    let even: Vec<f64> = (0..24)
        .map(|k| f64::from(k) * 15.0_f64.to_radians())
        .collect();
    let (fine, coarse) = (plate(&even), plate(&[0.0, 0.8, 1.9, 4.0]));
    let known = compared(&fine, &fine).holes[0].out_of_round;
    assert!(known.is_some_and(|by| by < 1e-9), "{known:?}");
    for pair in [[&fine, &coarse], [&coarse, &fine]] {
        let borders = compared(pair[0], pair[1]);
        let [hole] = &borders.holes[..] else {
            panic!("{} holes", borders.holes.len());
        };
        assert!(hole.off.norm() < 1e-9 && hole.wider < 1e-9, "{hole:?}");
        // Four nodes always lie close to some circle.
        assert_eq!(hole.out_of_round, None);
    }
}

/// A rectangle of 30 by 20 mm in elements of this size.
fn without_hole(element: f64) -> Surface {
    let (n, m) = ((30.0 / element) as u32, (20.0 / element) as u32);
    let points = (0..(n + 1) * (m + 1)).map(|k| {
        let [x, y] = [k % (n + 1), k / (n + 1)].map(|k| element * f64::from(k));
        Point3::new(x, y, 0.0)
    });
    let cells = (0..n * m).map(|k| k / n * (n + 1) + k % n);
    let triangles = cells.flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "solid").unwrap()
}

#[test]
fn a_hole_that_the_elements_of_the_other_part_cannot_show_is_not_missing() {
    // Its radius is 2.3 mm.
    let pierced = sheet(30, 5);
    for (element, n_missing) in [(1.0, 1), (2.0, 1), (5.0, 0)] {
        let solid = without_hole(element);
        assert_eq!(compared(&pierced, &solid).missing[0].len(), n_missing);
        assert_eq!(compared(&solid, &pierced).missing[1].len(), n_missing);
    }
    // A part that has a hole as small as that could have shown it.
    let coarse = without_hole(5.0);
    let curves = curves_of(&pierced);
    let curve = curves.iter().find(|border| border.is_hole).unwrap();
    let still = Similarity::identity();
    let hole = hole(curve, &still);
    let at = |smallest: f64| {
        solid_at(
            vec![hole],
            (&pierced, &still),
            (&coarse, &still),
            3.0,
            smallest,
        )
    };
    assert_eq!(at(f64::INFINITY).0.len(), 0);
    assert_eq!(at(hole.radius).0.len(), 1);
}
