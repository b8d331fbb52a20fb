//! Unit tests of decks that are written.

use std::path::Path;

use super::*;
use crate::formats::model::{ShellExtra, StressPoint};
use crate::formats::{Memory, ReadOptions, read_from};
use crate::geometry::{Point3, TriMesh};

fn sheet() -> Model {
    let corners = [
        [0.1, 1_234.567_891_234_567_8, -1e-7],
        [1.0, 0.0, 5.0],
        [0.0, 1.0, 1.0 / 3.0],
    ];
    let mesh = TriMesh::new(
        corners.map(Point3::from).to_vec(),
        vec![[0, 1, 2], [2, 1, 0]],
    );
    let mut model = Model::from_mesh(&mesh.unwrap(), "a sheet");
    model.parts[0].thickness = Some([1.25; 4]);
    model.parts[0].section_id = 9;
    model
}

fn text(model: &Model) -> String {
    let bytes = write(model, &WriteOptions::default(), &Monitor::silent()).unwrap();
    String::from_utf8(bytes).unwrap()
}

#[test]
fn nodes_shells_and_parts_read_back_bit_equal() {
    let model = sheet();
    let source = Memory::new().with("out.k", text(&model));
    let options = ReadOptions::default();
    let back = read_from(&source, Path::new("out.k"), &options, &Monitor::silent()).unwrap();
    assert!(back.diagnostics.is_empty(), "{:?}", back.diagnostics);
    assert_eq!(back.nodes.ids(), model.nodes.ids());
    assert_eq!(back.shells, model.shells);
    assert_eq!(back.parts[0].title, "a sheet");
    for (a, b) in back.nodes.positions().iter().zip(model.nodes.positions()) {
        assert!((a - b).norm() <= 1e-11, "{a} {b}");
    }
    assert_eq!(back.nodes.positions()[1], model.nodes.positions()[1]);
}

#[test]
fn widths_follow_the_largest_id() {
    let mut model = sheet();
    model.shells[0].id = 123_456_789;
    let deck = text(&model);
    assert!(deck.starts_with("*KEYWORD I10=Y\n"));
    let line = deck.lines().find(|l| l.starts_with(" 123456789")).unwrap();
    assert_eq!(line.len(), 60);
    model.shells[0].id = 12_345_678_901;
    assert!(text(&model).starts_with("*KEYWORD LONG=Y\n"));
    assert!(text(&model).lines().any(|l| l.len() == 120));
}

#[test]
fn thickness_and_forming_results_have_their_cards() {
    let mut model = sheet();
    model.shell_extras.push(ShellExtra {
        shell: 1,
        thickness: [1.5, 1.6, 1.7, 0.0],
        beta: 30.0,
        plies: None,
    });
    let point = StressPoint {
        t: -1.0,
        stress: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        plastic_strain: 0.5,
    };
    model
        .forming
        .add_state(2, 1, &[point], &[7.0, 8.0], &[])
        .unwrap();
    let deck = text(&model);
    let cards = "\
*ELEMENT_SHELL
       1       1       1       2       3       3
*ELEMENT_SHELL_BETA
       2       1       3       2       1       1
             1.5             1.6             1.7              0.             30.
*INITIAL_STRESS_SHELL
         2         1         1         2         0         1
             -1.              1.              2.              3.              4.
              5.              6.              .5
              7.              8.
*END
";
    assert!(deck.ends_with(cards), "{deck}");
    assert!(
        deck.contains(
            "*PART\na sheet\n         1         9\n*SECTION_SHELL\n         9         2\n"
        )
    );
    let without = WriteOptions {
        with_forming: false,
        comments: vec!["two\nlines".into()],
    };
    let bytes = write(&model, &without, &Monitor::silent()).unwrap();
    let deck = String::from_utf8(bytes).unwrap();
    assert!(!deck.contains("INITIAL_STRESS") && deck.contains("\n$ two\n$ lines\n"));
}

#[test]
fn a_cancelled_writing_ends() {
    let monitor = Monitor::silent();
    monitor.request_cancel();
    assert_eq!(
        write(&sheet(), &WriteOptions::default(), &monitor),
        Err(Cancelled)
    );
}
