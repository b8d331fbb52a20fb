//! Files that are something else than their name says, or something that is not read at all.

use std::path::Path;

use shapematch::formats::{
    self, DiagnosticKind, Disk, FileSource as _, Foreign, FormatError, Memory, Model, ReadOptions,
    obj, stl,
};
use shapematch::geometry::{Point3, TriMesh};
use shapematch::monitor::Monitor;

use super::mesh_files::ascii_stl;

fn read(name: &str, bytes: impl Into<Vec<u8>>) -> Result<Model, FormatError> {
    let files = Memory::new().with(name, bytes);
    let options = ReadOptions::default();
    formats::read_from(&files, Path::new(name), &options, &Monitor::silent())
}

fn square() -> TriMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corners = corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

const DECK: &str = "*KEYWORD\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n\
    *PART\nsheet\n1,1\n*ELEMENT_SHELL\n1,1,1,2,3,4\n*END\n";

/// The control words of a d3plot in words of `N` bytes.
fn d3plot<const N: usize>(bytes: impl Fn(u64) -> [u8; N]) -> Vec<u8> {
    let mut file = format!("{:1$}", "crash run", 10 * N).into_bytes();
    for word in 10..64 {
        file.extend(bytes(match word {
            11 => 1,
            15 => 4,
            _ => 0,
        }));
    }
    file
}

fn iges() -> String {
    format!("{:72}S      1\n{:72}G      1\n", "a start line", "1H,,1H;")
}

/// Every kind that is not read, by an example as its program writes it.
fn examples() -> Vec<(&'static str, Vec<u8>, Foreign)> {
    let text = |name, text: &str, kind| (name, text.as_bytes().to_vec(), kind);
    vec![
        text("empty.k", "", Foreign::Empty),
        text("blank.stl", " \n\n", Foreign::Empty),
        text(
            "a.k",
            "<!DOCTYPE html>\n<html><body>log in</body>",
            Foreign::Html,
        ),
        text(
            "a.stl",
            "version https://git-lfs.github.com/spec/v1\noid sha256:12\nsize 3\n",
            Foreign::GitLfs,
        ),
        (
            "a.zip",
            b"PK\x03\x04\x14\0\0\0\x08\0".to_vec(),
            Foreign::Zip,
        ),
        ("a.k.xz", b"\xfd7zXZ\0\0\x04".to_vec(), Foreign::Packed),
        text(
            "a.cdb",
            "/COM,ANSYS RELEASE\n/PREP7\nNBLOCK,6,SOLID\n",
            Foreign::Ansys,
        ),
        text(
            "a.bdf",
            "$ nastran\nSOL 101\nCEND\nBEGIN BULK\n",
            Foreign::Nastran,
        ),
        text(
            "a.nas",
            "GRID           1       0      1.      2.      3.\n",
            Foreign::Nastran,
        ),
        text(
            "a.inp",
            "*Heading\n** by hand\n*Node\n1, 0., 0., 0.\n",
            Foreign::Abaqus,
        ),
        text(
            "a.k",
            "*NODE\n1,0.,0.,0.\n*ELEMENT, TYPE=S4R, ELSET=e\n1,1,2,3,4\n",
            Foreign::Abaqus,
        ),
        text("a_0000.rad", "#RADIOSS STARTER\n/BEGIN\n", Foreign::Radioss),
        text(
            "a.pc",
            "INPUTVERSION 2015\nNODE  /        1\n",
            Foreign::PamCrash,
        ),
        text("a.stp", "ISO-10303-21;\nHEADER;\n", Foreign::Step),
        text("a.igs", &iges(), Foreign::Iges),
        (
            "d3plot",
            d3plot(|w| (w as u32).to_le_bytes()),
            Foreign::D3plot,
        ),
        ("d3plot01", d3plot(u64::to_be_bytes), Foreign::D3plot),
        (
            "dynain",
            [8u8, 8, 8, 1, 1, 0, 0, 0].repeat(9),
            Foreign::Lsda,
        ),
        text("a.vtk", "# vtk DataFile Version 3.0\n", Foreign::OtherMesh),
        ("a.glb", b"glTF\x02\0\0\0".to_vec(), Foreign::OtherMesh),
        text(
            "a.shapematch",
            "{\"schema\": \"shapematch.project/1\"}",
            Foreign::Project,
        ),
        text(
            "a.json",
            "{\n  \"schema\": \"shapematch.match/3\",",
            Foreign::Record,
        ),
        ("a.bin", [0u8, 1, 2, 3, 200].repeat(100), Foreign::Binary),
        text("a.k", "*NODES\n1,0,0,0\n*WHAT\n", Foreign::NoKeyword),
        text("a.txt", "a letter\nto somebody\n", Foreign::Text),
    ]
}

#[test]
fn what_is_not_read_is_named_with_what_to_do() {
    for (name, bytes, expected) in examples() {
        match read(name, bytes) {
            Err(FormatError::Foreign { kind, path }) => {
                assert_eq!(kind, expected, "{name}");
                let words = FormatError::Foreign { kind, path }.to_string();
                assert!(words.contains(kind.label()) && words.contains(kind.advice()));
            }
            other => panic!("{name}: {other:?}"),
        }
    }
    let shown: Vec<Foreign> = examples().into_iter().map(|row| row.2).collect();
    assert!(Foreign::ALL.iter().all(|kind| shown.contains(kind)));
}

#[test]
fn included_files_are_named_in_the_same_way() {
    for (_, bytes, kind) in examples() {
        let main = DECK.replace("*END", "*INCLUDE\npart\n*END");
        let files = Memory::new().with("main.k", main).with("part", bytes);
        let options = ReadOptions::default();
        let read = formats::read_from(&files, Path::new("main.k"), &options, &Monitor::silent());
        let model = read.unwrap();
        assert_eq!(model.shells.len(), 1);
        let found: Vec<String> = model.diagnostics.iter().map(ToString::to_string).collect();
        // An empty include holds nothing and misses nothing.
        let is_named = found.len() == 1 && found[0].contains(kind.label());
        assert_eq!(is_named, kind != Foreign::Empty, "{kind}: {found:?}");
    }
}

#[test]
fn content_counts_and_the_name_is_told() {
    let ascii = ascii_stl(&square(), "x");
    let cases = [
        ("deck.stl", DECK.as_bytes().to_vec(), 1),
        ("shape.k", ascii.clone(), 2),
        ("shape.ply", stl::write_binary(&square()), 2),
        ("shape.stl", obj::write(&square(), "x"), 2),
    ];
    for (name, bytes, n_shells) in cases {
        let model = read(name, bytes).unwrap();
        assert_eq!(model.shells.len(), n_shells, "{name}");
        let found: Vec<_> = model.diagnostics.iter().map(|d| d.kind).collect();
        assert_eq!(found, [DiagnosticKind::MisleadingName], "{name}");
    }
    let with_mark = [b"\xef\xbb\xbf", &ascii[..]].concat();
    let model = read("shape.stl", with_mark).unwrap();
    assert_eq!((model.shells.len(), model.diagnostics.total()), (2, 0));
}

#[test]
fn decks_of_other_systems_are_read() {
    let titled = DECK.replace("sheet", "Tür vorn");
    let expected = read("a.k", titled.as_str()).unwrap();
    assert_eq!(expected.parts[0].title, "Tür vorn");
    let little: Vec<u8> = titled.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = titled.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let of_windows = [&b"\xff\xfe"[..], &little].concat();
    let of_mac = titled.replace('\n', "\r").into_bytes();
    let one_line_feed = [of_mac.clone(), b"\n".to_vec()].concat();
    for bytes in [of_windows, big, of_mac, one_line_feed] {
        let model = read("a.k", bytes).unwrap();
        assert_eq!(model.parts, expected.parts);
        assert_eq!(model.shells, expected.shells);
        assert_eq!(model.nodes, expected.nodes);
        assert!(model.diagnostics.is_empty(), "{:?}", model.diagnostics);
    }
}

#[test]
fn a_deck_without_elements_says_so() {
    let only_nodes = "*KEYWORD\n*NODE\n1,0,0,0\n*MAT_ELASTIC\n1,7.8e-9\n*END\n";
    let model = read("a.k", only_nodes).unwrap();
    assert_eq!(model.diagnostics.count(DiagnosticKind::NoElements), 1);
    let typo = DECK.replace("*NODE", "*NODES");
    let model = read("a.k", typo).unwrap();
    let finding = model.diagnostics.iter().next().unwrap();
    assert_eq!(finding.kind, DiagnosticKind::UnknownKeyword);
    assert!(
        finding.message.contains("*NODE was probably meant"),
        "{finding}"
    );
    assert_eq!(finding.position.as_ref().unwrap().line, 2);
}

#[test]
fn a_limit_on_what_is_read_is_named_with_how_to_raise_it() {
    let options = ReadOptions {
        max_bytes: 80,
        ..ReadOptions::default()
    };
    let files = Memory::new()
        .with("long.k", DECK)
        .with("main.k", "*KEYWORD\n*INCLUDE\nlong.k\n*END\n");
    let read =
        |name: &str| formats::read_from(&files, Path::new(name), &options, &Monitor::silent());
    let error = read("long.k").unwrap_err().to_string();
    assert!(error.contains("--read-limit"), "{error}");
    let model = read("main.k").unwrap();
    let finding = model.diagnostics.iter().next().unwrap();
    assert_eq!(finding.kind, DiagnosticKind::LimitReached, "{finding}");
    assert!(finding.message.contains("--read-limit"), "{finding}");
    let wider = ReadOptions::default().with_limit(8.0);
    assert_eq!((wider.max_bytes, wider.max_files), (8 << 30, 10_000));
}

#[test]
fn a_file_included_many_times_stops_at_the_limit() {
    let main = format!("*KEYWORD\n*INCLUDE\n{}", "part.k\n".repeat(50));
    let files = Memory::new().with("main.k", main).with("part.k", DECK);
    let options = ReadOptions {
        max_files: 10,
        ..ReadOptions::default()
    };
    let read = formats::read_from(&files, Path::new("main.k"), &options, &Monitor::silent());
    let model = read.unwrap();
    assert_eq!(model.files.len(), 10);
    assert_eq!(model.diagnostics.count(DiagnosticKind::LimitReached), 41);
}

#[test]
fn a_file_that_is_cut_while_it_is_read_is_a_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deck.k");
    // The writer and the reader take turns as they come; whatever the reader meets, it returns.
    let (short, long) = (
        DECK.to_owned(),
        format!("{DECK}{}", "$ more\n".repeat(300_000)),
    );
    std::fs::write(&path, &long).unwrap();
    std::thread::scope(|scope| {
        let writer = scope.spawn(|| {
            for turn in 0..200 {
                let text = if turn % 2 == 0 { &short } else { &long };
                std::fs::write(&path, text).unwrap();
            }
        });
        while !writer.is_finished() {
            match Disk.open(&path, u64::MAX, &Monitor::silent()) {
                Ok(bytes) => assert!(bytes.is_empty() || bytes.starts_with(b"*KEYWORD")),
                Err(error) => assert!(error.to_string().contains("changed"), "{error}"),
            }
        }
    });
}
