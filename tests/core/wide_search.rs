//! The wide search against known poses: the right one comes out first, wherever the part lay.

use shapematch::geometry::{Point3, Similarity, TriMesh};
use shapematch::monitor::{Cancelled, Monitor};
use shapematch::registration::{
    MatchInput, MatchSettings, Stage, StartRecord, Surface, WideFind, WideSearch, match_surfaces,
};

use super::drawn_pan::{everywhere, pan, panel, placement, worst_node};

fn search(data: &TriMesh, model: &TriMesh, mirrored: bool) -> Vec<WideFind> {
    let surface = |mesh: &TriMesh| Surface::new(mesh, "source").unwrap();
    let (data, model) = (surface(data), surface(model));
    let search = WideSearch::new(&data, &model).unwrap();
    let silent = Monitor::silent();
    let found = if mirrored {
        search.run_mirrored(&silent)
    } else {
        search.run(&silent)
    };
    found.unwrap()
}

/// Searches `data`, moved away by a placement of its own for each seed, and expects it back.
fn check(data: &TriMesh, model: &TriMesh, seeds: std::ops::Range<u64>) -> Vec<WideFind> {
    let mut found = Vec::new();
    for seed in seeds {
        let truth = placement(seed);
        let moved = data.transformed(&truth.inverse());
        found = search(&moved, model, false);
        let error = worst_node(&moved, &truth, &found[0].model_from_data);
        let limit = 0.03 * data.aabb().diagonal();
        assert!(error < limit, "seed {seed}: {error:.2} mm of {limit:.2}");
        assert!(found.windows(2).all(|pair| pair[0].loss <= pair[1].loss));
    }
    found
}

#[test]
fn a_whole_part_is_found_from_any_placement() {
    check(
        &pan(6.0, 0.0, everywhere),
        &pan(9.0, 0.35, everywhere),
        0..6,
    );
}

#[test]
fn reversed_elements_are_told() {
    let part = panel(6.0, 0.0, everywhere);
    let found = check(&part.clone().flipped(), &part, 0..1);
    assert!(found[0].flipped);
}

#[test]
fn a_fifth_of_a_part_is_found_on_the_whole() {
    let piece = panel(4.0, 0.0, |x, y| x + 0.2 * y < -60.0);
    let whole = panel(5.0, 0.35, everywhere);
    assert!(piece.area() < 0.22 * whole.area());
    check(&piece, &whole, 0..3);
}

/// A channel 60 mm wide from `first` to `last` along itself, bent along in two directions, in cells of `pitch`, with
/// square holes of 12 mm.
fn strip(pitch: f64, [first, last]: [f64; 2]) -> TriMesh {
    const HOLES: [[f64; 2]; 6] = [
        [-444.0, 18.0],
        [-288.0, 0.0],
        [-120.0, 18.0],
        [72.0, 18.0],
        [228.0, 0.0],
        [420.0, -18.0],
    ];
    let step = |t: f64| {
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let (columns, rows) = (((last - first) / pitch) as u32, (60.0 / pitch) as u32);
    let points = (0..(columns + 1) * (rows + 1)).map(|i| {
        let x = first + pitch * f64::from(i % (columns + 1));
        let across = pitch * f64::from(i / (columns + 1)) - 30.0;
        let t = (x + 540.0) / 1080.0;
        let walls = 9.0 * step((-across - 6.0) / 12.0) + 16.0 * step((across - 6.0) / 14.0);
        let (y, z) = (60.0 * t * t, -45.0 * (1.5 * (t - 0.6)).powi(2));
        Point3::new(x, 0.8 * across + y, walls + z)
    });
    let is_solid = |&(i, j): &(u32, u32)| {
        let x = first + pitch * (f64::from(i) + 0.5);
        let y = pitch * (f64::from(j) + 0.5) - 30.0;
        let is_in = |hole: &[f64; 2]| (x - hole[0]).abs() < 6.0 && (y - hole[1]).abs() < 6.0;
        !HOLES.iter().any(is_in)
    };
    sheet(points.collect(), [columns, rows], is_solid)
}

/// A mesh of rows of points, so many cells each, without the cells that are not solid.
fn sheet(
    points: Vec<Point3>,
    [columns, rows]: [u32; 2],
    is_solid: impl Fn(&(u32, u32)) -> bool,
) -> TriMesh {
    let cells = (0..columns * rows).map(|k| (k % columns, k / columns));
    let triangles = cells.filter(is_solid).flat_map(|(i, j)| {
        let a = j * (columns + 1) + i;
        let up = a + columns + 1;
        [[a, a + 1, up + 1], [a, up + 1, up]]
    });
    TriMesh::new(points, triangles.collect()).unwrap()
}

#[test]
fn holes_say_where_a_piece_of_a_strip_lies_along_it() {
    let whole = strip(6.0, [-540.0, 540.0]);
    // Pieces with two holes, with three, and with one.
    let pieces = [[-216.0, 198.0], [-18.0, 540.0], [-90.0, 204.0]];
    for (seed, piece) in (0..).zip(pieces) {
        let piece = strip(3.0, piece);
        let truth = placement(seed);
        let moved = piece.transformed(&truth.inverse());
        let [data, model] = [&moved, &whole].map(|mesh| Surface::new(mesh, "source").unwrap());
        let search = WideSearch::new(&data, &model).unwrap();
        let found = search.on_holes(&Monitor::silent()).unwrap().into_iter();
        let off = found.map(|pose| worst_node(&moved, &truth, &pose));
        let least = off.fold(f64::INFINITY, f64::min);
        assert!(least < 2.0, "seed {seed}: {least:.2} mm");
    }
}

/// A panel with beads and holes on a lattice of 100 mm, in cells of 4 mm, over a range of x and y of the same length;
/// one more hole, smaller than the others, tells the places of the lattice apart.
fn lattice([x0, y0]: [f64; 2], length: f64) -> TriMesh {
    const PITCH: f64 = 4.0;
    let wave = |t: f64| (std::f64::consts::TAU * t / 100.0).sin();
    let n = (length / PITCH) as u32;
    let points = (0..(n + 1) * (n + 1)).map(|i| {
        let steps = [(x0, i % (n + 1)), (y0, i / (n + 1))];
        let [x, y] = steps.map(|(first, k)| first + PITCH * f64::from(k));
        Point3::new(x, y, 6.0 * wave(x) * wave(y))
    });
    let is_solid = |&(i, j): &(u32, u32)| {
        let [x, y] = [(x0, i), (y0, j)].map(|(first, k)| first + PITCH * (f64::from(k) + 0.5));
        let of_lattice = [x, y].map(|t| (t + 50.0).rem_euclid(100.0) - 50.0);
        let is_hole = of_lattice.iter().all(|t| t.abs() < 12.0);
        let is_extra = (x - 150.0).abs() < 6.0 && (y - 250.0).abs() < 6.0;
        !(is_hole || is_extra)
    };
    sheet(points.collect(), [n, n], is_solid)
}

#[test]
fn the_one_small_hole_among_like_ones_tells_places_of_a_lattice_apart() {
    // A window with 25 holes of the lattice and the small one.
    let (window, whole) = (
        lattice([-48.0, -48.0], 496.0),
        lattice([-248.0, -248.0], 896.0),
    );
    for seed in 0..3 {
        let truth = placement(seed);
        let moved = window.transformed(&truth.inverse());
        let [data, model] = [&moved, &whole].map(|mesh| Surface::new(mesh, "source").unwrap());
        let search = WideSearch::new(&data, &model).unwrap();
        // The window may be turned over about the diagonal through the small hole, too.
        let found = search.on_holes(&Monitor::silent()).unwrap().into_iter();
        let off = found.map(|pose| worst_node(&moved, &truth, &pose));
        let least = off.fold(f64::INFINITY, f64::min);
        assert!(least < 5.0, "seed {seed}: {least:.2} mm");
    }
}

#[test]
fn parts_that_overhang_each_other_are_found() {
    let left = panel(5.0, 0.0, |x, _| x < 60.0);
    let right = panel(6.0, 0.35, |x, _| x > -70.0);
    check(&left, &right, 0..3);
}

#[test]
fn the_opposite_hand_is_found_as_a_mirroring_pose() {
    let part = panel(6.0, 0.0, everywhere);
    let truth = placement(3).after(&Similarity::mirror_x());
    let moved = part.transformed(&truth.inverse());
    let found = search(&moved, &part, true);
    let pose = found[0].model_from_data;
    assert!(pose.is_mirrored());
    let error = worst_node(&moved, &truth, &pose);
    assert!(error < 0.03 * part.aabb().diagonal(), "{error:.2} mm");
    // Its own hand does not lie nearly as well.
    assert!(search(&moved, &part, false)[0].loss > 3.0 * found[0].loss);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let (data, model) = (panel(6.0, 0.0, |x, _| x < 0.0), panel(9.0, 0.3, everywhere));
    let run = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let search = || search(&data, &model, false);
        pool.build().unwrap().install(search)
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn a_cancel_ends_it_and_a_stop_keeps_what_was_reached() {
    let part = Surface::new(&panel(9.0, 0.0, everywhere), "source").unwrap();
    let search = WideSearch::new(&part, &part).unwrap();
    let stopped = Monitor::silent();
    stopped.request_stop();
    assert!(!search.run(&stopped).unwrap().is_empty());
    let cancelled = Monitor::silent();
    cancelled.request_cancel();
    assert_eq!(search.run(&cancelled), Err(Cancelled));
}

/// How many iterations refined each start of a match.
fn refinements(source: &TriMesh, target: &TriMesh) -> Vec<usize> {
    let surface = |mesh: &TriMesh, name| Surface::new(mesh, name).unwrap();
    let (source, target) = (surface(source, "source"), surface(target, "target"));
    let input = MatchInput {
        source: &source,
        target: &target,
        reduced: None,
    };
    let monitor = Monitor::silent();
    let outcome = match_surfaces(&input, &MatchSettings::default(), &monitor).unwrap();
    let of_start = |start: &StartRecord| {
        let iterations = start.iterations.iter();
        iterations.filter(|i| i.stage == Stage::Refine).count()
    };
    outcome.starts.iter().map(of_start).collect()
}

#[test]
fn different_parts_are_refined_only_until_they_are_known_to_be_different() {
    let bent = panel(5.0, 0.2, everywhere);
    let pan = pan(5.0, 0.0, |x, y| x.abs() < 100.0 && y.abs() < 65.0);
    let most = refinements(&bent, &pan).into_iter().max();
    assert!(most.is_some_and(|n| (1..=20).contains(&n)), "{most:?}");
}
