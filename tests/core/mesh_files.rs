//! STL, OBJ and PLY: every kind reads back what was written, and broken files are no panic.

use std::path::Path;

use proptest::prelude::*;
use shapematch::formats::{
    DiagnosticKind, Format, FormatError, Memory, Model, ReadOptions, Selection, obj, ply,
    read_from, stl,
};
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;

/// ASCII STL with coordinates that read back bit-equal.
pub fn ascii_stl(mesh: &TriMesh, name: &str) -> Vec<u8> {
    let mut text = format!("solid {name}\n");
    for t in 0..mesh.n_triangles() {
        let n = mesh.normal(t);
        text += &format!("facet normal {:?} {:?} {:?}\n outer loop\n", n.x, n.y, n.z);
        for p in mesh.corners(t) {
            text += &format!("  vertex {:?} {:?} {:?}\n", p.x, p.y, p.z);
        }
        text += " endloop\nendfacet\n";
    }
    text += &format!("endsolid {name}\n");
    text.into_bytes()
}

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
    let model = check("a.stl", ascii_stl(&strip(), "my part"), 0.0);
    assert_eq!(model.parts[0].title, "my part");
    let model = check("a.obj", obj::write(&strip(), "left door"), 0.0);
    assert_eq!(model.parts[0].title, "left door");
    check("a.ply", ply::write(&strip(), "x"), 0.0);
}

#[test]
fn content_tells_the_format_where_the_name_does_not() {
    let stl = b"solid a\nfacet normal 0 0 1\n";
    let cases = [
        ("x", &b"ply\nformat"[..], Format::Ply),
        ("x.stl", b"ply \nformat", Format::Ply),
        ("dynain", b"*KEYWORD", Format::Keyword),
        ("x", stl, Format::Stl),
        ("deck.k", stl, Format::Stl),
        ("dynain_ini", b"*INITIAL_STRESS_SHELL\n", Format::Keyword),
        ("part.stl", b"$ by hand\n*NODE\n1,2,3,4\n", Format::Keyword),
        ("part.ply", b"a title\n\n*node\n1,2,3,4\n", Format::Keyword),
        (
            "part.k",
            b"# from a modeller\nv 0 0 0\nf 1 2 3\n",
            Format::Obj,
        ),
        ("x.Obj", b"o only a name\n", Format::Obj),
        ("part.k", b"ply of carbon\n*KEYWORD\n", Format::Keyword),
        ("part", b"v 1 2 3\n*KEYWORD\n*END\n", Format::Keyword),
        ("part.key", b"v 1 2 3\n*NODE\n", Format::Keyword),
        ("part.STL.gz", b"no word of it\n", Format::Stl),
    ];
    for (name, bytes, format) in cases {
        assert_eq!(Format::of(Path::new(name), bytes), Ok(format), "{name}");
    }
    let by_name = [
        ("floor.dynain", Some(Format::Keyword)),
        ("floor.DYNAIN.gz", Some(Format::Keyword)),
        ("floor.dyn", Some(Format::Keyword)),
        ("part.STL.gz", Some(Format::Stl)),
        ("no_extension", None),
    ];
    for (name, format) in by_name {
        assert_eq!(Format::of_name(Path::new(name)), format, "{name}");
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
fn quads_stay_quads_and_polygons_become_triangles() {
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
        facet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nwhat\nendsolid\n";
    let model = read("a.stl", text).unwrap();
    assert_eq!(model.shells.len(), 1);
    let lines: Vec<u64> = model
        .diagnostics
        .iter()
        .map(|d| d.position.as_ref().unwrap().line)
        .collect();
    assert_eq!(lines, [4, 6, 12]);
    // A facet that does not end takes nothing into the next one.
    let open = text
        .replacen("endfacet\n", "", 1)
        .replacen("vertex 1 0\n", "vertex 1 0 0\n", 1);
    let model = read("a.stl", open).unwrap();
    assert_eq!(model.shells.len(), 1);
    let first = model.diagnostics.iter().next().unwrap();
    assert!(
        first.message.contains("without endfacet"),
        "{}",
        first.message
    );
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
    for name in ["a.stl", "a.obj", "a.ply", "a.k"] {
        let error = read(name, "").unwrap_err().to_string();
        let begin = format!("{name:?} is empty");
        assert!(error.starts_with(&begin), "{error}");
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
        ("a.stl", ascii_stl(&strip(), "x")),
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
fn a_text_stl_that_is_cut_off_is_told() {
    let text = String::from_utf8(ascii_stl(&strip(), "x")).unwrap();
    let last = text.rfind("facet normal").unwrap();
    // Between two facets, behind words of the last one, and before its last word.
    for (cut, words) in [
        (last, "without endsolid"),
        (last + 5, "within a facet"),
        (text.find("outer loop").unwrap() + 10, "within a facet"),
        (text.rfind("vertex").unwrap(), "within a facet"),
        (text.rfind("endfacet").unwrap(), "within a facet"),
        (text.rfind("endsolid").unwrap(), "without endsolid"),
    ] {
        // One whole facet at least, without which there is no mesh.
        let whole = &text[..text.find("endfacet").unwrap() + 9];
        let rest = &text[text.find('\n').unwrap() + 1..cut];
        let model = read("a.stl", format!("{whole}{rest}")).unwrap();
        let told: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].contains(words), "{told:?}");
    }
}

#[test]
fn numbers_that_are_no_place_and_indices_of_no_point_are_named() {
    let stl = "solid\nfacet\nvertex 0 0 0\nvertex 1e999 0 0\nvertex 0 1 0\nendfacet\n\
        facet\nvertex 0 0 0\nvertex nan 0 0\nvertex 0 1 0\nendfacet\n\
        facet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendfacet\nendsolid\n";
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
            ("a.stl", ascii_stl(&strip(), "x")),
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

/// Positions of the corners of all shells, triangles with three.
fn polygons_of(model: &Model) -> Vec<Vec<[f64; 3]>> {
    let at = |&n: &u32| {
        let p = model.nodes.positions()[n as usize];
        [p.x, p.y, p.z]
    };
    let shells = model.shells.iter();
    shells
        .map(|shell| shell.corners().iter().map(at).collect())
        .collect()
}

fn area(model: &Model) -> f64 {
    model.surface(&Selection::All).unwrap().mesh.area()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn lines_and_points_of_an_obj_are_no_faces_and_weights_no_divisors() {
    let model = read(
        "a.obj",
        format!("{SQUARE}l 1 2 3\np 1 2 3\nf 1 2 3 4\nl 4 3 2\n"),
    )
    .unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (1, 0));
    let model = read("a.obj", "v 0 0 0 2\nv 4 0 0 2\nv 0 4 0 0.5\nf 1 2 3\n").unwrap();
    assert_eq!(area(&model), 8.0);
    let error = read("a.obj", format!("{SQUARE}l 1 2 3 4\n")).unwrap_err();
    assert!(error.to_string().contains("no face"), "{error}");
}

#[test]
fn what_exporters_write_into_an_obj_is_read() {
    let text = "\u{feff}# Rhino\nmtllib\nusemtl \n\
        V 0 0 0 # the corner\nv 1 0 0 1 0 0\nv 1 1 0 0.5 0.5 0.5 1\nv  0\t1 \\\n 0\n\
        vn 0 0 1\nvt 0 0\ng lid#2 left # a comment\nF 1/1/1 2//1 3/1 \\\n 4\n\
        f 1 2 99\nf 1 2 0\nf 1 2 x\nv 0 nan 0\nv 0 zero 0\nf 1 2 5\nf 1 3 6\nf -6 -5 -4\n";
    let model = read("a.obj", text).unwrap();
    assert_eq!(model.parts[0].title, "lid#2 left");
    assert_eq!(polygons_of(&model)[0].len(), 4);
    assert_eq!((model.shells.len(), area(&model)), (2, 1.5));
    let lines: Vec<u64> = model
        .diagnostics
        .iter()
        .map(|d| d.position.as_ref().unwrap().line)
        .collect();
    assert_eq!(
        lines,
        [17, 18, 18, 14, 15, 16, 19, 20],
        "{:?}",
        model.diagnostics
    );
}

#[test]
fn groups_of_an_obj_are_parts_also_when_they_come_back() {
    let text = format!("{SQUARE}g a\nf 1 2 3\ng b\nf 1 2 4\ng a\nf 1 3 4\ng empty\n");
    let model = read("a.obj", text).unwrap();
    let rows: Vec<_> = model
        .part_summaries()
        .iter()
        .map(|p| (p.title.clone(), p.n_shells))
        .collect();
    assert_eq!(rows, [("a".to_owned(), 2), ("b".to_owned(), 1)]);
}

#[test]
fn concave_polygons_are_cut_inside_themselves() {
    // An L of three squares, and an arrow of four corners: fans would lie outside.
    let bracket = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 2 3 4 5 6 1\n";
    let model = read("a.obj", bracket).unwrap();
    assert_eq!(model.shells.len(), 4);
    assert!((area(&model) - 3.0).abs() < 1e-12);
    let arrow = "v 0 0 0\nv 2 1 0\nv 0 2 0\nv .5 1 0\nf 1 2 3 4\n";
    let model = read("a.obj", arrow).unwrap();
    assert!((area(&model) - 1.5).abs() < 1e-12);
    assert_eq!(model.shells.len(), 2);
    let mut star = String::new();
    let mut face = "f".to_owned();
    for i in 0..3000 {
        let angle = f64::from(i) / 3000.0 * std::f64::consts::TAU;
        let r = if i % 2 == 0 { 1.0 } else { 2.0 };
        star += &format!("v {} {} 0\n", r * angle.cos(), r * angle.sin());
        face += &format!(" {}", i + 1);
    }
    let model = read("a.obj", format!("{star}{face}\nf 1 2 3\n")).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (1, 1));
}

const PLY_SQUARE: &str = "property float x\nproperty float y\nproperty float z\n";

#[test]
fn strips_of_a_ply_are_triangles() {
    let strips = "ply\nformat ascii 1.0\nelement vertex 6\n";
    let rest = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n12 0 1 2 3 -1 2 3 4 5 5 -1 0\n";
    let model = read("a.ply", format!("{strips}{PLY_SQUARE}{rest}")).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (4, 0));
    assert!((area(&model) - 2.0).abs() < 1e-12);
    // Every second triangle of a strip is turned, so that all look to the same side.
    let mesh = model.surface(&Selection::All).unwrap().mesh;
    assert!((0..4).all(|t| mesh.normal(t).z > 0.0));
}

#[test]
fn what_exporters_write_into_a_ply_is_read() {
    let text = "PLY \r\nformat ascii 1.0\r\ncomment Created by Blender3D 2.49 - b\u{fc}ro\r\n\
        obj_info something\r\nelement vertex 4\r\nproperty float32 X\r\nproperty float32 Y\r\n\
        property float32 Z\r\nproperty list uchar float extra\r\nelement face 2\r\n\
        property uchar red\r\nproperty list uchar int vertex_index\r\nend_header\r\n\
        .0 -.0 0. 0\r\n\r\n1. 0 0 1 .5\r\n1 1 0 0 spare\r\n\r\n\r\n-.0 1.e0 0 0\r\n\
        9 3 0 1\r\n 2\r\n9 3 0 2 3\r\n";
    let model = read("a.ply", text).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (2, 0));
    assert_eq!(area(&model), 1.0);
    let cut = text.trim_end().trim_end_matches(" 3");
    let model = read("a.ply", cut).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (1, 1));
}

#[test]
fn a_second_property_named_like_the_corners_is_none() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
        property int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 7\n";
    let model = read("a.ply", text).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (1, 0));
    // A polygon that names no point is told by its number in the file.
    let second = text.replace("element face 1", "element face 2") + "3 0 1 9 7\n";
    let model = read("a.ply", second).unwrap();
    let told: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(model.shells.len(), 1);
    assert!(told[0].contains("polygon 2 names a point"), "{told:?}");
}

#[test]
fn elements_without_properties_promise_no_more_than_the_file_holds() {
    let head = "ply\nformat ascii 1.0\n".to_owned();
    let text = head + &"element nothing 900\n".repeat(50) + "end_header\n";
    assert!(matches!(
        read("a.ply", text),
        Err(FormatError::Broken { .. })
    ));
}

#[test]
fn what_exporters_write_into_an_stl_is_read() {
    let one_line = "solid a part facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 \
        vertex 0 1 0 endloop endfacet endsolid a part solid b facet normal nan nan nan outer loop \
        vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet endsolid b";
    let model = read("a.stl", one_line).unwrap();
    assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    let rows: Vec<_> = model
        .part_summaries()
        .iter()
        .map(|p| (p.title.clone(), p.n_triangles))
        .collect();
    assert_eq!(rows, [("a part".to_owned(), 1), ("b".to_owned(), 2)]);
    // "solid" in the header of a binary file whose end is cut, longer, or whose count is missing.
    let mut bytes = stl::write_binary(&strip());
    bytes[..11].copy_from_slice(b"solid blah\n");
    let n = strip().n_triangles();
    let cut = bytes[..bytes.len() - 60].to_vec();
    let longer = [&bytes[..], b"trailing"].concat();
    let mut uncounted = bytes.clone();
    uncounted[80..84].fill(0);
    for (bytes, n) in [(cut, n - 2), (longer, n), (uncounted, n)] {
        let model = read("a.stl", bytes).unwrap();
        assert_eq!((model.shells.len(), model.diagnostics.total()), (n, 1));
    }
}

/// The readers of public crates give the same meshes where they give any.
mod twins {
    use super::*;

    fn tables(bytes: &[u8]) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
        let options = tobj::LoadOptions::default();
        let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
        let (objects, _) = tobj::load_obj_buf(&mut &bytes[..], &options, no_materials).unwrap();
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for object in objects {
            let first = points.len() as u32;
            let mesh = object.mesh;
            points.extend(mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
            let mut rest = &mesh.indices[..];
            let mut sizes = mesh.face_arities.iter();
            while !rest.is_empty() {
                let n = sizes.next().map_or(3, |&n| n as usize);
                faces.push(rest[..n].iter().map(|i| i + first).collect());
                rest = &rest[n..];
            }
        }
        (points, faces)
    }

    /// A point, its three axes, and quads between neighbours of a grid.
    fn grid() -> impl Strategy<Value = Vec<[f64; 3]>> {
        proptest::collection::vec(proptest::array::uniform3(-1e3f64..1e3), 12)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn of_obj(points in grid(), faces in proptest::collection::vec(proptest::sample::subsequence((1..=12).collect::<Vec<i32>>(), 3), 1..9), negative: bool) {
            let mut text = "o first\n".to_owned();
            for [x, y, z] in &points {
                text += &format!("v {x} {y} {z}\n");
            }
            for face in &faces {
                text += "f";
                for corner in face {
                    let corner = if negative { corner - 13 } else { *corner };
                    text += &format!(" {corner}//1");
                }
                text += "\n";
            }
            let model = read("a.obj", text.clone()).unwrap();
            let (points, faces) = tables(text.replace("//1", "").as_bytes());
            let expected: Vec<Vec<[f64; 3]>> = faces
                .iter()
                .map(|face| face.iter().map(|&i| points[i as usize]).collect())
                .collect();
            prop_assert_eq!(polygons_of(&model), expected);
        }

        #[test]
        fn of_stl(points in grid()) {
            let points: Vec<Point3> = points.into_iter().map(Point3::from).collect();
            let triangles = (0..10).map(|i| [i, i + 1, i + 2]).collect();
            let mesh = TriMesh::new(points, triangles).unwrap();
            let bytes = stl::write_binary(&mesh);
            let mut cursor = std::io::Cursor::new(bytes.clone());
            let twin = stl_io::create_stl_reader(&mut cursor).unwrap();
            let expected: Vec<Vec<[f64; 3]>> = twin
                .map(|t| t.unwrap().vertices.map(|v| v.0.map(f64::from)).to_vec())
                .collect();
            prop_assert_eq!(polygons_of(&read("a.stl", bytes).unwrap()), expected);
        }

        #[test]
        fn of_ply(points in grid(), is_ascii: bool) {
            use ply_rs_bw::ply::{DefaultElement, Property};
            let mesh_points: Vec<Point3> = points.iter().copied().map(Point3::from).collect();
            let triangles = (0..10).map(|i| [i, i + 1, i + 2]).collect();
            let mesh = TriMesh::new(mesh_points, triangles).unwrap();
            let mut bytes = ply::write(&mesh, "x");
            if is_ascii {
                let mut text = String::from_utf8_lossy(&bytes).split("end_header").next().unwrap()
                    .replace("binary_little_endian", "ascii") + "end_header\n";
                for [x, y, z] in &points {
                    text += &format!("{x} {y} {z}\n");
                }
                for [a, b, c] in mesh.triangles() {
                    text += &format!("3 {a} {b} {c}\n");
                }
                bytes = text.into_bytes();
            }
            let parser = ply_rs_bw::parser::Parser::<DefaultElement>::new();
            let twin = parser.read_ply(&mut &bytes[..]).unwrap();
            let number = |element: &DefaultElement, name: &str| match element[name] {
                Property::Double(value) => value,
                ref other => panic!("{other:?}"),
            };
            let vertices: Vec<[f64; 3]> = twin.payload["vertex"]
                .iter()
                .map(|v| [number(v, "x"), number(v, "y"), number(v, "z")])
                .collect();
            let expected: Vec<Vec<[f64; 3]>> = twin.payload["face"]
                .iter()
                .map(|face| match face["vertex_indices"] {
                    Property::ListUInt(ref list) => list.iter().map(|&i| vertices[i as usize]).collect(),
                    ref other => panic!("{other:?}"),
                })
                .collect();
            prop_assert_eq!(polygons_of(&read("a.ply", bytes).unwrap()), expected);
        }
    }
}
