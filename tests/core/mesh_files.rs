//! STL, OBJ and PLY: every kind reads back what was written, and broken files are no panic.

use std::path::Path;

use proptest::prelude::*;
use shapematch::formats::{
    DiagnosticKind, Format, FormatError, Memory, Model, ReadOptions, Selection, obj, ply,
    read_from, stl,
};
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;

fn read(name: &str, bytes: impl Into<Vec<u8>>) -> Result<Model, FormatError> {
    let source = Memory::new().with(name, bytes);
    let options = ReadOptions::default();
    read_from(&source, Path::new(name), &options, &Monitor::silent())
}

/// A bent strip whose coordinates need all their digits.
fn strip() -> TriMesh {
    let point = |i: u32, j: u32| {
        let (x, y) = (f64::from(i) / 3.0, f64::from(j) * 0.7);
        Point3::new(1234.5 + x, y, (x * 1.3).sin())
    };
    let positions = (0..8).flat_map(|i| [point(i, 0), point(i, 1)]).collect();
    let triangles = (0..7).flat_map(|i| {
        let a = 2 * i;
        [[a, a + 2, a + 1], [a + 1, a + 2, a + 3]]
    });
    TriMesh::new(positions, triangles.collect()).unwrap()
}

/// Corner points of all triangles, for comparing meshes whose points are numbered otherwise.
fn corners(mesh: &TriMesh) -> Vec<[Point3; 3]> {
    (0..mesh.n_triangles()).map(|t| mesh.corners(t)).collect()
}

#[track_caller]
fn check(name: &str, bytes: Vec<u8>, tolerance: f64) -> Model {
    let model = read(name, bytes).unwrap();
    assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    let mesh = model.surface(&Selection::All).unwrap().mesh;
    let (found, expected) = (corners(&mesh), corners(&strip()));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((found - expected).norm() <= tolerance, "{found} {expected}");
    }
    model
}

#[test]
fn every_kind_reads_back() {
    check("a.stl", stl::write_binary(&strip()), 1e-4);
    let model = check("a.stl", stl::write_ascii(&strip(), "my part"), 0.0);
    assert_eq!(model.parts[0].title, "my part");
    let model = check("a.obj", obj::write(&strip(), "left door"), 0.0);
    assert_eq!(model.parts[0].title, "left door");
    check("a.ply", ply::write(&strip(), "x"), 0.0);
}

#[test]
fn content_tells_the_format_where_the_name_does_not() {
    let cases = [
        ("x", &b"ply\nformat"[..], Format::Ply),
        ("x.K", b"", Format::Keyword),
        ("dynain", b"*KEYWORD", Format::Keyword),
        ("part.STL.gz", b"", Format::Stl),
        ("x", b"solid a\n", Format::Stl),
        ("x.Obj", b"", Format::Obj),
        ("floor.dynain", b"$ results", Format::Keyword),
        ("floor.DYNAIN.gz", b"", Format::Keyword),
        ("dynain_ini", b"*INITIAL_STRESS_SHELL\n", Format::Keyword),
        ("floor.dyn", b"", Format::Keyword),
        ("no_extension", b"", Format::Keyword),
    ];
    for (name, bytes, format) in cases {
        assert_eq!(Format::of(Path::new(name), bytes), format, "{name}");
    }
}

#[test]
fn a_binary_stl_may_begin_like_a_text() {
    let mut bytes = stl::write_binary(&strip());
    bytes[..11].copy_from_slice(b"solid blah\n");
    check("a.stl", bytes, 1e-4);
}

#[test]
fn all_solids_of_an_ascii_stl_become_parts() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let text = format!("SOLID one\r\n{facet}endsolid\n\nsolid two\n{facet}{facet}endsolid two\n");
    let model = read("a.stl", text).unwrap();
    let parts: Vec<_> = model.part_summaries();
    assert_eq!((parts[0].title.as_str(), parts[0].n_shells), ("one", 1));
    assert_eq!((parts[1].title.as_str(), parts[1].n_shells), ("two", 2));
}

#[test]
fn quads_stay_quads_and_polygons_become_fans() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\n";
    let text = format!(
        "# text\n{points}g first\nf 1 2 3 4\ng second\nf 1/1 2/2 3/3 4/4 5/5\nf -5 -4 -3\n"
    );
    let model = read("a.obj", text).unwrap();
    let per_part: Vec<_> = model.part_summaries().iter().map(|p| p.n_shells).collect();
    assert_eq!(per_part, [1, 4]);
    assert!(!model.shells[0].is_triangle());
    let ply = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_index\n\
        element edge 1\nproperty int a\nend_header\n0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n7\n";
    let model = read("a.ply", ply).unwrap();
    assert_eq!(model.shells.len(), 1);
    assert!(!model.shells[0].is_triangle());
}

#[test]
fn both_byte_orders_of_ply() {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\n\
        property float y\nproperty short z\nelement face 1\nproperty list uchar ushort vertex_indices\n\
        end_header\n"
        .to_vec();
    for i in 0..3u8 {
        bytes.extend(f64::from(i).to_be_bytes());
        bytes.extend(f32::from(i * i).to_be_bytes());
        bytes.extend(i16::from(i).to_be_bytes());
    }
    bytes.push(3);
    bytes.extend([0u16, 1, 2].iter().flat_map(|v| v.to_be_bytes()));
    let model = read("a.ply", bytes).unwrap();
    assert_eq!(model.nodes.positions()[2], Point3::new(2.0, 4.0, 2.0));
}

#[test]
fn oddities_are_named_with_their_place() {
    let text = "solid a\nfacet normal 0 0 1\nvertex 0 0 0\nvertex 1 0\nvertex 0 1 0\nendfacet\n\
        facet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nwhat\n";
    let model = read("a.stl", text).unwrap();
    assert_eq!(model.shells.len(), 1);
    let lines: Vec<u64> = model
        .diagnostics
        .iter()
        .map(|d| d.position.as_ref().unwrap().line)
        .collect();
    assert_eq!(lines, [4, 6, 12]);
    let mut short = stl::write_binary(&strip());
    short.truncate(84 + 50 * 3 + 20);
    let model = read("a.stl", short).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (3, 1));
    let error = read("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n").unwrap_err();
    assert!(error.to_string().contains("line 3"), "{error}");
    let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n";
    let error = read("a.ply", format!("{header}1\nx\n")).unwrap_err();
    assert!(error.to_string().contains("ine 7"), "{error}");
    let lie = "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n";
    assert!(matches!(
        read("a.ply", lie),
        Err(FormatError::Broken { .. })
    ));
    for name in ["a.stl", "a.obj", "a.ply"] {
        assert!(
            matches!(read(name, ""), Err(FormatError::Broken { .. })),
            "{name}"
        );
    }
}

#[test]
fn points_that_are_not_finite_spoil_only_their_faces() {
    let mut bytes = ply::write(&strip(), "x");
    let first = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    bytes[first..first + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let model = read("a.ply", bytes).unwrap();
    assert_eq!(model.diagnostics.count(DiagnosticKind::NotFinite), 1);
    assert_eq!(model.shells.len(), strip().n_triangles() - 1);
    assert!(model.surface(&Selection::All).is_ok());
}

#[test]
fn a_file_cut_anywhere_is_no_panic() {
    let files = [
        ("a.stl", stl::write_binary(&strip())),
        ("a.stl", stl::write_ascii(&strip(), "x")),
        ("a.obj", obj::write(&strip(), "x")),
        ("a.ply", ply::write(&strip(), "x")),
    ];
    for (name, bytes) in files {
        for end in (0..bytes.len()).step_by(3) {
            if let Ok(model) = read(name, &bytes[..end]) {
                assert!(model.shells.len() <= strip().n_triangles());
            }
        }
    }
}

#[test]
fn numbers_that_are_no_place_and_indices_of_no_point_are_named() {
    let stl = "solid\nfacet\nvertex 0 0 0\nvertex 1e999 0 0\nvertex 0 1 0\nendfacet\n\
        facet\nvertex 0 0 0\nvertex nan 0 0\nvertex 0 1 0\nendfacet\n\
        facet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\n";
    let obj = "v 0 0 0\nv inf 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 4 3\n";
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 4\nproperty list uchar int vertex_index\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n";
    let ply = format!("{header}3 0 1 2\n3 0 1 7\n3 0 1 -1\n2 0 1\n");
    for (name, text, n_found) in [("a.stl", stl, 4), ("a.obj", obj, 2), ("a.ply", &ply, 3)] {
        let model = read(name, text).unwrap();
        assert_eq!(model.shells.len(), 1, "{name}");
        let found: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(found.len(), n_found, "{name}: {found:?}");
        let mesh = model.surface(&Selection::All).unwrap().mesh;
        assert!(
            mesh.positions()
                .iter()
                .all(|p| p.iter().all(|x| x.is_finite()))
        );
    }
}

#[test]
fn a_count_beyond_the_file_takes_no_memory() {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n\
        element face 1\nproperty list uint uint vertex_indices\nend_header\n"
        .to_vec();
    bytes.extend([0; 4]);
    bytes.extend(u32::MAX.to_le_bytes());
    assert!(matches!(
        read("a.ply", bytes),
        Err(FormatError::Broken { .. })
    ));
    let mut bytes = vec![b' '; 80];
    bytes.extend(u32::MAX.to_le_bytes());
    assert!(matches!(
        read("a.stl", bytes),
        Err(FormatError::Broken { .. })
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_bytes_are_no_panic(
        name in prop::sample::select(vec!["a.stl", "a.obj", "a.ply", "a.dynain", "a"]),
        head in prop::sample::select(vec![
            "", "solid x\nfacet\n", "v 0 0 0\nf ", "*NODE\n", "*ELEMENT_SHELL\n",
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n",
            "ply\nformat binary_little_endian 1.0\nelement face 3\n\
             property list char int vertex_index\nend_header\n",
        ]),
        tail in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        if let Ok(model) = read(name, [head.as_bytes(), &tail].concat()) {
            let _ = model.surface(&Selection::All);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn damaged_files_are_no_panic(
        which in 0..4usize,
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (name, mut bytes) = vec![
            ("a.stl", stl::write_binary(&strip())),
            ("a.stl", stl::write_ascii(&strip(), "x")),
            ("a.obj", obj::write(&strip(), "x")),
            ("a.ply", ply::write(&strip(), "x")),
        ].swap_remove(which);
        for (at, byte) in damage {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Ok(model) = read(name, bytes) {
            let _ = model.surface(&Selection::All);
        }
    }
}
