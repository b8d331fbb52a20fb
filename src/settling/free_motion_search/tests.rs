//! Plates whose holes say where they lie.

use std::f64::consts::TAU;

use super::*;
use crate::assess::AssessSettings;
use crate::geometry::TriMesh;
use crate::monitor::Monitor;

/// A flat sheet of 60 by 40 cells of 2 mm with three holes, of which the columns from `first` on are
/// there.
fn plate(first: usize) -> Surface {
    let (columns, rows) = (60, 40);
    let point = |i: usize| {
        let (x, y) = (i % (columns + 1), i / (columns + 1));
        Point3::new(2.0 * x as f64, 2.0 * y as f64, 0.0)
    };
    let holes = [(40, 6, 4), (50, 28, 6), (12, 20, 5)];
    let is_solid = |(x, y): (usize, usize)| {
        let within = |&(left, low, size): &(usize, usize, usize)| {
            (left..left + size).contains(&x) && (low..low + size).contains(&y)
        };
        x >= first && !holes.iter().any(within)
    };
    let cells = (0..columns * rows).map(|i| (i % columns, i / columns));
    let triangles = cells.filter(|&cell| is_solid(cell)).flat_map(|(x, y)| {
        let a = (y * (columns + 1) + x) as u32;
        let up = a + columns as u32 + 1;
        [[a, a + 1, up + 1], [a, up + 1, up]]
    });
    let points = (0..(columns + 1) * (rows + 1)).map(point);
    let mesh = TriMesh::new(points.collect(), triangles.collect()).unwrap();
    Surface::new(&mesh, "source").unwrap()
}

#[test]
fn a_piece_of_a_plate_is_found_by_its_holes_whichever_side_it_is_on() {
    let (whole, piece) = (plate(0), plate(35));
    let free = FreeMotion {
        kind: FreeMotionKind::Flat,
        direction: Vector3::z(),
        point: Point3::origin(),
    };
    let off = |surface: &Surface, pose: &Similarity| {
        let points = surface.mesh().positions().iter();
        let moved = points.map(|p| (pose.apply(p) - p).norm());
        moved.fold(0.0, f64::max)
    };
    let (settings, monitor) = (AssessSettings::default(), Monitor::silent());
    for k in 0..20 {
        let share = |step: f64| (f64::from(k) * step).fract() - 0.5;
        let turn = Generator::Turn(Vector3::z(), Point3::new(90.0, 40.0, 0.0));
        let turn = turn.motion(2.0 + TAU * share(0.618));
        let shift = Generator::Shift(Vector3::new(80.0 * share(0.37), 60.0 * share(0.71), 0.0));
        let start = shift.motion(1.0).after(&turn);
        assert!(off(&piece, &start) > 5.0);
        for (source, target) in [(&piece, &whole), (&whole, &piece)] {
            let context = PairContext::new([source, target], &settings, &monitor);
            let found = poses_along(&context, &start, &free, 4).unwrap();
            let off = off(source, &found[0]);
            assert!(off < 0.5, "{off} from start {k}");
        }
    }
}

/// The loss place by place: what four at once are compared with.
fn plain_loss(search: &FamilySearch<'_>, motion: &Similarity, cut: f64) -> f64 {
    let motion = search.in_grid(motion);
    let cut = cut * search.borders.grid.scale();
    let away = |place: &Local| {
        let point = motion.rotation * place.point + motion.translation;
        let border = search.beside(&point, &(motion.rotation * place.tangent));
        border.map_or(1.0, |border| {
            let off = point - border.point;
            let across = off.dot(&border.across) / cut;
            let past = (off.norm() / cut - 1.0).max(0.0);
            (across * across + past * past).min(1.0)
        })
    };
    let sum: f64 = search.data.iter().map(|p| p.weight * away(p)).sum();
    sum / search.data.iter().map(|p| p.weight).sum::<f64>()
}

#[test]
fn four_places_at_once_lose_what_each_of_them_does() {
    let borders = FamilyBorders::of(&plate(35), &plate(0)).unwrap();
    let search = borders.under(&Similarity::identity());
    assert!(search.loss(&search.fours, &Similarity::identity(), borders.cut) < 0.4);
    let mut largest = 0.0_f64;
    for k in 0..500 {
        let share = |step: f64| (f64::from(k) * step).fract() - 0.5;
        let turn = Generator::Turn(Vector3::z(), Point3::new(90.0, 40.0, 0.0));
        let shift = Vector3::new(30.0 * share(0.37), 30.0 * share(0.71), 0.0);
        let motion = turn.motion(TAU * share(0.618));
        let motion = Generator::Shift(shift).motion(1.0).after(&motion);
        let loss = search.loss(&search.fours, &motion, borders.cut);
        let plain = plain_loss(&search, &motion, borders.cut);
        largest = largest.max((loss - plain).abs());
    }
    assert!(largest < 1e-4, "{largest}");
}
