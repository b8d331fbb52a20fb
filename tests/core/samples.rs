//! The generated pairs: counts, borders, shapes, poses, decks.

use std::io::{Read, Write};
use std::path::Path;

use shapematch::formats::{self, Memory, Model, Severity};
use shapematch::geometry::{BorderEdges, Topology, TriMesh, orient_consistently};
use shapematch::monitor::Monitor;
use shapematch::samples::{
    SampleMesh, SamplePart, SampleSettings, SampleVariant, bundled, bundled_settings, files,
    generate, write_crash_deck, write_stamped_deck,
};
use shapematch::search::{Bvh, ClosestPoint};

fn settings(part: SamplePart, variant: SampleVariant) -> SampleSettings {
    SampleSettings {
        part,
        variant,
        ..SampleSettings::default()
    }
}

#[test]
fn the_floor_is_the_paper_s() {
    let pair = generate(&SampleSettings::default());
    let stamped = pair.stamped.to_trimesh();
    assert_eq!(stamped.n_triangles(), 34_808);
    let diagonal = stamped.aabb().diagonal();
    assert!((diagonal - 1632.0).abs() < 2.0, "{diagonal}");
    for mesh in [&stamped, &pair.crash.to_trimesh()] {
        let loops = BorderEdges::of(mesh, &Topology::of(mesh)).loops();
        assert_eq!(loops.len(), 13);
        assert!(loops.iter().all(|border| border.closed));
    }
}

/// Quadrilaterals and triangles must have area, no corner below two degrees, and no fold.
fn assert_well_shaped(mesh: &SampleMesh, what: &str) {
    let mut n_sharp = 0;
    for element in &mesh.elements {
        let n = if element[2] == element[3] { 3 } else { 4 };
        let p = |k: usize| mesh.positions[element[k % n] as usize];
        let normal = |k: usize| (p(k + 1) - p(k)).cross(&(p(k + n - 1) - p(k)));
        let least = (0..n)
            .map(|k| (p(k + 1) - p(k)).angle(&(p(k + n - 1) - p(k))).to_degrees())
            .fold(f64::INFINITY, f64::min);
        assert!(least > 2.0, "{what}: {least}° in {element:?}");
        n_sharp += usize::from(least < 20.0);
        assert!((1..n).all(|k| normal(k).dot(&normal(0)) > 0.0), "{what}");
    }
    assert!(n_sharp * 100 < mesh.elements.len(), "{what}: {n_sharp}");
}

#[test]
fn elements_of_every_part_are_well_shaped_and_agree_on_their_side() {
    for part in SamplePart::ALL {
        for variant in [SampleVariant::Plain, SampleVariant::AddendumAndCut] {
            if part == SamplePart::Floor && variant != SampleVariant::Plain {
                continue;
            }
            let pair = generate(&settings(part, variant));
            for mesh in [&pair.crash, &pair.stamped] {
                let what = format!("{part:?} {variant:?} {}", mesh.title);
                assert_well_shaped(mesh, &what);
                let triangles = mesh.to_trimesh();
                let topology = Topology::of(&triangles);
                assert_eq!(topology.components(triangles.n_triangles()).1, 1, "{what}");
                let monitor = Monitor::silent();
                let oriented = orient_consistently(triangles, &topology, &monitor);
                let (_, n_turned) = oriented.unwrap();
                assert_eq!(n_turned, 0, "{what}");
            }
        }
    }
}

/// Largest distance of the vertices of `from` to the surface of `to`.
fn one_sided(from: &TriMesh, to: &TriMesh) -> f64 {
    let tree = Bvh::build(to.clone());
    from.positions()
        .iter()
        .map(|p| {
            tree.closest(p, f64::INFINITY, None, None)
                .unwrap()
                .distance_sq
                .sqrt()
        })
        .fold(0.0, f64::max)
}

#[test]
fn the_true_pose_lays_the_meshes_on_each_other() {
    for part in SamplePart::ALL {
        let pair = generate(&settings(part, SampleVariant::Plain));
        let crash = pair.crash.to_trimesh();
        let moved = pair
            .stamped
            .to_trimesh()
            .transformed(&pair.crash_from_stamped);
        // The sagitta of the longest edge over the tightest radius, 6 … 30 mm, and some more on
        // the crash side, whose elements may span a whole bend.
        let limit = 0.25 * crash.mean_edge_length();
        assert!(one_sided(&moved, &crash) < limit, "{part:?}");
        assert!(one_sided(&crash, &moved) < limit, "{part:?}");
    }
}

#[test]
fn pairs_repeat_and_only_the_pose_follows_the_seed() {
    let first = settings(SamplePart::Bracket, SampleVariant::Plain);
    let other = SampleSettings { seed: 9, ..first };
    assert_eq!(generate(&first), generate(&first));
    let (a, b) = (generate(&first), generate(&other));
    assert_eq!(a.stamped, b.stamped);
    assert_ne!(a.crash.positions, b.crash.positions);
    let back = |pair: &shapematch::samples::SamplePair| {
        pair.crash_from_stamped
            .inverse()
            .apply(&pair.crash.positions[100])
    };
    assert!((back(&a) - back(&b)).norm() < 1e-9);
}

#[test]
fn variants_do_what_they_say() {
    for part in SamplePart::ALL {
        let coarse = |variant| {
            let size = Some(match part {
                SamplePart::Floor => 30.0,
                SamplePart::Bracket => 6.0,
                _ => 12.0,
            });
            generate(&SampleSettings {
                crash_size: size,
                stamped_size: size,
                ..settings(part, variant)
            })
        };
        let plain = coarse(SampleVariant::Plain);
        let area = |mesh: &SampleMesh| mesh.to_trimesh().area();
        let (crash_area, stamped_area) = (area(&plain.crash), area(&plain.stamped));
        for variant in SampleVariant::ALL {
            // What does not change the outline does the same to every part.
            let is_trim = matches!(
                variant,
                SampleVariant::Addendum
                    | SampleVariant::MissingFlanges
                    | SampleVariant::Cut
                    | SampleVariant::AddendumAndCut
            );
            if !is_trim && part != SamplePart::Bracket {
                continue;
            }
            let pair = coarse(variant);
            let crash = area(&pair.crash) / crash_area;
            let scale = pair.crash_from_stamped.scale;
            let stamped = area(&pair.stamped) * scale * scale / stamped_area;
            let what = format!("{part:?} {variant:?}: {crash} {stamped}");
            let (has_cut, has_addendum) = match variant {
                SampleVariant::Cut => (true, false),
                SampleVariant::Addendum => (false, true),
                SampleVariant::AddendumAndCut => (true, true),
                _ => (false, false),
            };
            let is_unflanged = variant == SampleVariant::MissingFlanges;
            assert_eq!(crash < 0.8, has_cut, "{what}");
            assert_eq!(stamped > 1.2, has_addendum, "{what}");
            assert_eq!(stamped < 0.96, is_unflanged, "{what}");
            let mirrored = variant == SampleVariant::OppositeHand;
            assert_eq!(pair.crash_from_stamped.is_mirrored(), mirrored);
            let unit = match variant {
                SampleVariant::Metres => 1000.0,
                SampleVariant::Inches => 25.4,
                _ => 1.0,
            };
            assert!((scale - unit).abs() < 1e-9 * unit, "{what}");
            let up = pair.stamped.to_trimesh().mean_normal().z;
            let flipped = variant == SampleVariant::FlippedNormals;
            assert_eq!(up < 0.0, flipped, "{what}");
            let n_neighbours = if variant == SampleVariant::WholeModel {
                4
            } else {
                0
            };
            assert_eq!(pair.neighbours.len(), n_neighbours);
        }
    }
}

fn read(bytes: &[u8]) -> Model {
    let source = Memory::new().with("deck.k", bytes);
    formats::read_from(
        &source,
        Path::new("deck.k"),
        &Default::default(),
        &Monitor::default(),
    )
    .unwrap()
}

/// The deck holds the mesh: same elements, same positions to the rounding of 16 columns.
fn assert_holds(model: &Model, mesh: &SampleMesh, first_node: usize, tolerance: f64) {
    let part = model.part_index(mesh.part_id).unwrap();
    let shells: Vec<[usize; 4]> = model
        .shells
        .iter()
        .filter(|shell| shell.part == part)
        .map(|shell| shell.nodes.map(|node| node as usize - first_node))
        .collect();
    let expected: Vec<[usize; 4]> = mesh
        .elements
        .iter()
        .map(|e| e.map(|n| n as usize))
        .collect();
    assert_eq!(shells, expected);
    let positions = &model.nodes.positions()[first_node..];
    for (read, written) in positions.iter().zip(&mesh.positions) {
        assert!((read - written).norm() < tolerance);
    }
}

#[test]
fn decks_read_back() {
    let pair = generate(&settings(SamplePart::Bracket, SampleVariant::WholeModel));
    let crash = read(write_crash_deck(&pair).as_bytes());
    assert!(crash.diagnostics.is_empty());
    assert_eq!(crash.parts.len(), 5);
    let mut first = 0;
    for part in std::iter::once(&pair.crash).chain(&pair.neighbours) {
        assert_holds(&crash, part, first, 1e-9);
        first += part.positions.len();
    }
    let stamped = read(write_stamped_deck(&pair).as_bytes());
    // A dynain defines no part, which is worth a remark and nothing more.
    let errors = stamped
        .diagnostics
        .iter()
        .filter(|d| d.severity() == Severity::Error);
    assert_eq!(errors.count(), 0);
    assert_holds(&stamped, &pair.stamped, 0, 1e-9);
    assert_eq!(stamped.forming.n_stress(), pair.stamped.elements.len());
    assert_eq!(stamped.forming.n_strain(), pair.stamped.elements.len());
    assert_eq!(stamped.shell_extras.len(), pair.stamped.elements.len());
}

fn unpacked(bytes: &[u8]) -> Vec<u8> {
    let mut text = Vec::new();
    flate2::read::GzDecoder::new(bytes)
        .read_to_end(&mut text)
        .unwrap();
    text
}

/// With `SHAPEMATCH_BLESS` set it writes the bundled files anew.
#[test]
fn the_bundled_pair_is_what_the_generator_makes() {
    let pair = generate(&bundled_settings());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    if std::env::var_os("SHAPEMATCH_BLESS").is_some() {
        for file in files(&pair) {
            if file.name == "truth.json" {
                std::fs::write(folder.join(file.name), file.bytes).unwrap();
                continue;
            }
            let best = flate2::Compression::best();
            let mut packer = flate2::write::GzEncoder::new(Vec::new(), best);
            packer.write_all(&file.bytes).unwrap();
            let name = format!("{}.gz", file.name);
            std::fs::write(folder.join(name), packer.finish().unwrap()).unwrap();
        }
        return;
    }
    let bundled = bundled();
    // Another machine's sines may differ in the last digit, so numbers are compared, not bytes.
    assert_holds(&read(&bundled[0].bytes), &pair.crash, 0, 1e-6);
    let packed_deck = unpacked(&bundled[1].bytes);
    let deck = write_stamped_deck(&pair);
    assert_eq!(packed_deck.len(), deck.len());
    let n_equal = packed_deck
        .iter()
        .zip(deck.as_bytes())
        .filter(|(a, b)| a == b);
    assert!(n_equal.count() * 1000 >= deck.len() * 999);
    let truth: serde_json::Value = serde_json::from_slice(&bundled[2].bytes).unwrap();
    let rows: [[f64; 4]; 4] = serde_json::from_value(truth["crash_from_stamped"].clone()).unwrap();
    let difference = nalgebra::SMatrix::<f64, 4, 4>::from_fn(|i, j| {
        rows[i][j] - pair.crash_from_stamped.to_rows()[i][j]
    });
    assert!(difference.amax() < 1e-9);
}
