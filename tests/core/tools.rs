//! Forming decks that hold die, punch and binder beside the sheet.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use serde_json::Value;
use shapematch::app::{Action, FileCommand, PartCommand};
use shapematch::role::Role;
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::bracket::write_bracket;
use super::find_parts::really;

/// Part id of the sheet in the generated stamped file.
const SHEET: u64 = 1;

/// The bracket pair, and `forming.k` with two rigid copies of the sheet above and below it.
fn write_forming_deck(folder: &Path) {
    let pair = write_bracket(folder, SampleVariant::Plain);
    let sheet = &pair.stamped;
    assert_eq!(sheet.part_id, SHEET);
    let mut deck = "*KEYWORD\n*INCLUDE\nstamped.dynain\n*MAT_RIGID\n9,7.8e-9,2.1e5,.3\n".to_owned();
    for (tool, z) in [(2, -1.0), (3, 1.0)] {
        let first = tool * 1_000_000;
        write!(deck, "*PART\nTOOL {tool}\n{tool},0,9\n*NODE\n").unwrap();
        for (id, p) in (first..).zip(&sheet.positions) {
            writeln!(deck, "{id},{:.6},{:.6},{:.6}", p.x, p.y, p.z + z).unwrap();
        }
        deck += "*ELEMENT_SHELL\n";
        for (id, corners) in (first..).zip(&sheet.elements) {
            let [a, b, c, d] = corners.map(|corner| first + u64::from(corner));
            writeln!(deck, "{id},{tool},{a},{b},{c},{d}").unwrap();
        }
    }
    deck += "*END\n";
    std::fs::write(folder.join("forming.k"), deck).unwrap();
}

#[test]
fn tools_of_a_forming_deck_are_left_out_and_told() {
    let folder = tempfile::tempdir().unwrap();
    write_forming_deck(folder.path());
    let run = |options: &[&str]| {
        let done = Command::new(env!("CARGO_BIN_EXE_shapematch"))
            .current_dir(folder.path())
            .args(["match", "crash.k", "forming.k", "--json", "-"])
            .args(options)
            .output()
            .unwrap();
        let record: Value = serde_json::from_slice(&done.stdout).unwrap();
        let parts = record["files"]["stamped"]["parts"].clone();
        (parts, String::from_utf8(done.stderr).unwrap())
    };
    let (parts, told) = run(&[]);
    assert_eq!(parts, serde_json::json!([SHEET]));
    assert!(
        told.contains("forming.k: parts 2, 3 left out as tools"),
        "{told}"
    );
    let (parts, told) = run(&["--stamped-part", "all"]);
    assert_eq!(parts.as_array().unwrap().len(), 3);
    assert!(!told.contains("tools"), "{told}");
}

#[test]
fn a_car_is_mapped_from_the_sheet_of_a_forming_deck() {
    let folder = tempfile::tempdir().unwrap();
    write_forming_deck(folder.path());
    let done = Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .current_dir(folder.path())
        .args(["map-car", "crash.k", "forming.k", "--out", "mapped"])
        .args(["--json", "-"])
        .output()
        .unwrap();
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    let row = &record["rows"][0];
    assert_eq!(row["tools_left_out"], serde_json::json!([2, 3]));
    assert_eq!(row["state"], "sure", "{row}");
    let told = String::from_utf8(done.stderr).unwrap();
    assert!(
        told.contains("forming.k: parts 2, 3 left out as tools"),
        "{told}"
    );
}

#[test]
fn the_window_matches_the_sheet_and_takes_the_tools_on_request() {
    let folder = tempfile::tempdir().unwrap();
    write_forming_deck(folder.path());
    let mut window = Window::new();
    window.runner = Some(really);
    for (name, role) in [("crash.k", Role::Crash), ("forming.k", Role::Stamped)] {
        window.open(folder.path().join(name).to_str().unwrap(), role);
    }
    let used = |window: &Window, role| window.part(role).facts.used.clone();
    assert_eq!(used(&window, Role::Stamped), BTreeSet::from([SHEET]));
    let rows = window.state.log.rows();
    assert!(
        rows.iter()
            .any(|row| row.text.contains("left out as tools"))
    );
    let line = window.state.document.command_line().unwrap();
    assert!(!line.contains("--stamped-part"), "{line}");

    // What the user asks for stays, also when the file is read again.
    window.apply(PartCommand::UseAll(Role::Stamped));
    assert_eq!(used(&window, Role::Stamped).len(), 3);
    let line = window.state.document.command_line().unwrap();
    assert!(line.contains("--stamped-part all"), "{line}");
    window.apply(FileCommand::Reload(Role::Stamped));
    assert_eq!(used(&window, Role::Stamped).len(), 3);
    window.act(Action::Undo);
    window.act(Action::Undo);
    assert_eq!(used(&window, Role::Stamped), BTreeSet::from([SHEET]));

    // As the crash model a file has no tools.
    window.act(Action::Swap);
    assert_eq!(used(&window, Role::Crash).len(), 3);
    window.act(Action::Swap);
    assert_eq!(used(&window, Role::Stamped), BTreeSet::from([SHEET]));
}
