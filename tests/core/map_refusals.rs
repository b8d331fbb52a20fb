//! What `shapematch map` asks about or refuses before a deck is written: other units of stress, files in the other
//! order, decks that are cut off, names that do not exist.

use shapematch::app::Action;
use shapematch::monitor::Monitor;
use shapematch::pipeline::PipelineError;
use shapematch::pipeline::map::WriteKind;
use shapematch::pipeline::outputs::{Output, OutputInput};
use shapematch::role::{PerRole, Role};
use shapematch::samples::SampleVariant;

use super::app::Window;
use super::app_mapping::{at_the_known_pose_of, real};
use super::map_decks::{Pair, crash, errors, stamped, stresses};

const STEEL: &str = "*MAT_3-PARAMETER_BARLAT\n         5    7.8E-9  210000.0       0.3\n";
const STEEL_PART: &str = "*PART\nsheet\n         1         1         5\n";
const IN_MM: &str = "*KEYWORD\n$ units ton-mm-s\n";
/// A pose beside the crash part.
const BESIDE: &str = "1 0 0 5000  0 1 0 0  0 0 1 0  0 0 0 1";

/// Two stamped elements with these numbers in place of 100 and 50 MPa.
fn stressed(numbers: &str, cards: &str) -> String {
    let stresses = stresses(1..=2).replace("     100.0      50.0", numbers);
    stamped(2, &(stresses + cards))
}

#[test]
fn stresses_are_compared_with_the_materials_even_where_units_agree() {
    let in_gpa = "       0.1      0.05";
    let material = STEEL_PART.to_owned() + STEEL;
    for (crash, stamped, whose) in [
        (
            crash(2, STEEL),
            stressed(in_gpa, &material),
            "the crash part",
        ),
        (crash(2, STEEL), stressed(in_gpa, ""), "the crash part"),
        (
            crash(2, ""),
            stressed(in_gpa, &material),
            "its own material",
        ),
    ] {
        let pair = Pair::new(&crash, &stamped);
        let asked = pair.map(&["--quantities", "stress"]);
        let told = errors(&asked);
        assert_eq!(asked.status.code(), Some(1), "{told}");
        assert!(told.contains("--stress-factor 1e3"), "{told}");
        assert!(told.contains(&format!("modulus of {whose}")), "{told}");
        let answered = pair.map(&["--quantities", "stress", "--stress-factor", "1e3"]);
        assert!(answered.status.success(), "{}", errors(&answered));
    }
    let usual = stressed("     100.0      50.0", &material);
    let usual = Pair::new(&crash(2, STEEL), &usual).map(&["--quantities", "stress"]);
    assert!(usual.status.success(), "{}", errors(&usual));
}

#[test]
fn stresses_without_any_material_are_judged_by_what_sheets_bear() {
    let crash = crash(2, "").replace("*KEYWORD\n", IN_MM);
    let map = |numbers| Pair::new(&crash, &stressed(numbers, "")).map(&["--quantities", "stress"]);
    let pascal = map("     1.0E8     5.0E7");
    assert_eq!(pascal.status.code(), Some(1));
    let told = errors(&pascal);
    assert!(told.contains("--stress-factor 1e-6"), "{told}");
    let open = map("       0.1      0.05");
    assert!(open.status.success(), "{}", errors(&open));
    assert!(errors(&open).contains("as in GPa"), "{}", errors(&open));
    let usual = map("     100.0      50.0");
    assert!(!errors(&usual).contains("GPa"), "{}", errors(&usual));
}

#[test]
fn a_mapping_of_nothing_writes_no_deck() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, ""));
    let output = pair.run(&["--pose", BESIDE, "--out", "out.k", "--json", "out.json"]);
    assert_eq!(output.status.code(), Some(1));
    let told = errors(&output);
    assert!(told.contains("nothing is mapped"), "{told}");
    assert!(told.contains("no deck is written"), "{told}");
    assert!(!String::from_utf8_lossy(&output.stdout).contains("read back"));
    assert!(!pair.path("out.k").exists() && !pair.path("out_elements.k").exists());
    // The record says why.
    assert!(pair.path("out.json").exists());
}

#[test]
fn nothing_is_exchanged_in_a_deck_that_has_changed_since_it_was_read() {
    let (mut window, _folder) = at_the_known_pose_of(SampleVariant::Plain);
    window.act(Action::MapOrCancel);
    let document = &window.state.document;
    let input = OutputInput {
        parts: PerRole::from_fn(|role| document.part(role).map(|part| part.loaded.to_arc())),
        mapping: Some(document.current_mapping().unwrap().run.to_arc()),
        ..OutputInput::default()
    };
    let crash = document.part(Role::Crash).unwrap().loaded.path.clone();
    let write = |kind| Output::Mapped(kind).make(&input, None, &Monitor::silent());
    let kinds = [WriteKind::Deck, WriteKind::Part, WriteKind::Include];
    let read = std::fs::read_to_string(&crash).unwrap();
    std::fs::write(&crash, read.replace("*END", "$ another\n*END")).unwrap();
    for kind in kinds {
        let refused = write(kind).map(|file| file.bytes).unwrap_err();
        let PipelineError::Changed(path) = &refused else {
            panic!("{refused}");
        };
        assert_eq!(path, &crash);
        assert!(refused.to_string().contains("reload"), "{refused}");
    }
    std::fs::write(&crash, read).unwrap();
    for kind in kinds {
        assert!(write(kind).is_ok());
    }
}

#[test]
fn filled_elements_are_no_part_of_the_means_that_are_compared() {
    // The second of two stamped elements is thicker, and the third crash element is filled from it.
    let thick = stamped(2, "");
    let (first, last) = thick.split_at(thick.rfind("\n       2 ").unwrap() + 1);
    let thick = first.to_owned() + &last.replace("0.9", "1.1");
    assert!(thick.contains("1.1"), "{thick}");
    let pair = Pair::new(&crash(4, ""), &thick);
    let mean = |options: &[&str]| {
        let output = pair.map(&[&["--json", "-"], options].concat());
        let record: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        record["thickness"]["crash"]["mean"].as_f64().unwrap()
    };
    assert_eq!(mean(&["--fill", "1"]), mean(&[]));
}

#[test]
fn what_the_reader_found_is_told_with_the_error_that_follows_from_it() {
    let section = "         7         2     0.833         3";
    let unknown = crash(2, "")
        .replace(section, "         7         2     0.833      &nip")
        .replace(&"       1.0".repeat(4), &"      &thk".repeat(4));
    let output = Pair::new(&unknown, &stamped(2, &stresses(1..=2))).map(&[]);
    let told = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("crash.k:") && told.contains("&thk"), "{told}");
}

#[test]
fn a_deck_that_is_cut_off_among_its_elements_is_told_by_all_commands() {
    let whole = crash(3, "");
    let cut = whole.trim_end_matches("*END\n");
    let pair = Pair::new(cut, &stamped(2, &stresses(1..=2)));
    let told = "the file ends inside *ELEMENT_SHELL without *END";
    let line = format!("crash.k:{}", cut.lines().count());
    let mapped = pair.map(&[]);
    let mapped = errors(&mapped);
    assert!(mapped.contains(told) && mapped.contains(&line), "{mapped}");
    for command in [
        &["info", "crash.k"][..],
        &["match", "crash.k", "stamped.dynain"],
    ] {
        let output = pair.shapematch(command);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(text.contains(told), "{command:?}: {text}");
    }
    // A line that is cut off is no end; behind a whole one the deck may be complete.
    for (deck, words) in [
        (cut, "*END is optional"),
        (cut.trim_end(), "probably missing"),
    ] {
        std::fs::write(pair.path("crash.k"), deck).unwrap();
        let output = pair.shapematch(&["info", "crash.k"]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(
            text.contains(&format!("{told}; ")) && text.contains(words),
            "{text}"
        );
    }
    // Loose cards have no end.
    std::fs::write(pair.path("crash.k"), cut.replace("*KEYWORD\n", "")).unwrap();
    let loose = pair.shapematch(&["info", "crash.k"]);
    let loose = String::from_utf8_lossy(&loose.stdout).into_owned();
    assert!(!loose.contains("without *END"), "{loose}");
}

#[test]
fn files_in_the_other_order_are_told() {
    let pair = Pair::new(&stamped(2, &stresses(1..=2)), &crash(2, ""));
    let refused = pair.map(&[]);
    assert_eq!(refused.status.code(), Some(2));
    let told = errors(&refused);
    let order = "the forming results are in crash.k, named first";
    assert!(told.contains(order), "{told}");
    assert!(told.contains("none in stamped.dynain"), "{told}");
    let matched = pair.shapematch(&["match", "crash.k", "stamped.dynain"]);
    let order = "crash.k carries forming results and is named first, as the crash part, while \
                 stamped.dynain carries none";
    assert!(errors(&matched).contains(order), "{}", errors(&matched));
}

#[test]
fn files_in_the_other_order_are_told_where_only_a_thickness_says_so() {
    // A crash deck may have that too, so nothing is refused.
    let pair = Pair::new(&stamped(2, ""), &crash(2, ""));
    let words =
        "crash.k carries a thickness for each element and is named first, as the crash part, while";
    for told in [
        pair.map(&[]),
        pair.shapematch(&["match", "crash.k", "stamped.dynain"]),
    ] {
        let told = errors(&told);
        assert!(told.contains(words), "{told}");
    }
    let pair = Pair::new(&crash(2, ""), &stamped(2, ""));
    assert!(!errors(&pair.map(&[])).contains("named first"));
}

#[test]
fn a_material_law_that_does_not_exist_is_named() {
    let pair = Pair::new(&crash(2, STEEL), &stamped(2, &stresses(1..=2)));
    let full = ["--quantities", "full", "--stamped-material"];
    let told = |law| errors(&pair.map(&[&full[..], &[law]].concat())).to_owned();
    assert!(
        told("foo").contains("--stamped-material FOO"),
        "{}",
        told("foo")
    );
    for known in ["36", "24", "PIECEWISE_LINEAR_PLASTICITY"] {
        assert!(!told(known).contains("--stamped-material"), "{known}");
    }
}

#[test]
fn a_project_that_is_none_is_told_what_it_is() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, ""));
    let refused = pair.run(&["--project", "crash.k"]);
    let told = errors(&refused);
    assert!(
        told.contains("is no project but an LS-DYNA keyword deck"),
        "{told}"
    );
    assert!(told.contains(".shapematch"), "{told}");
}

#[test]
fn no_output_takes_the_place_of_a_pose_file() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, ""));
    let pose = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    std::fs::write(pair.path("a.pose"), pose).unwrap();
    for option in ["--out", "--csv", "--json", "--report"] {
        let output = pair.run(&["--pose", "a.pose", option, "a.pose"]);
        assert_eq!(output.status.code(), Some(2), "{option}");
        assert!(errors(&output).contains("a.pose"), "{}", errors(&output));
        assert_eq!(std::fs::read_to_string(pair.path("a.pose")).unwrap(), pose);
    }
}

#[test]
fn a_sheet_beyond_the_largest_distance_is_told_with_the_option() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, ""));
    let above = "1 0 0 0  0 1 0 0  0 0 1 3  0 0 0 1";
    let output = pair.run(&["--pose", above, "--max-distance", "2"]);
    let told = errors(&output);
    assert!(
        told.contains("2 elements farther than the largest distance; --max-distance sets it"),
        "{told}"
    );
    // However small it is: outside is what lies beyond the border.
    let moved = "1 0 0 10  0 1 0 0  0 0 1 0.1  0 0 0 1";
    let output = pair.run(&[
        "--pose",
        moved,
        "--max-distance",
        "1e-6",
        "--csv",
        "table.csv",
    ]);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    let table = std::fs::read_to_string(pair.path("table.csv")).unwrap();
    let statuses = table.lines().skip(1);
    let statuses: Vec<&str> = statuses.map(|row| row.split(',').nth(2).unwrap()).collect();
    assert_eq!(statuses, ["outside", "far"]);
}

#[test]
fn a_crash_part_of_solids_takes_no_results_which_is_said_before_the_match() {
    let mut solid = "*KEYWORD\n*NODE\n".to_owned();
    for z in [0, 1] {
        for (n, (x, y)) in [(0, 0), (20, 0), (20, 10), (0, 10)].into_iter().enumerate() {
            solid += &format!("{},{x},{y},{z}\n", 4 * z + n + 1);
        }
    }
    solid += "*PART\nblock\n7,7,5\n*ELEMENT_SOLID\n101,7\n1,2,3,4,5,6,7,8\n*END\n";
    let pair = Pair::new(&solid, &stamped(2, &stresses(1..=2)));
    let output = pair.run(&[]);
    let told = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("no shells to map onto; solids"), "{told}");
    assert!(!told.contains("pose"), "{told}");
    let mut window = Window::new();
    window.runner = Some(real);
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        window.open(pair.path(name).to_str().unwrap(), role);
    }
    for action in [Action::MapOrCancel, Action::MapAsLoaded] {
        let reason = action.enabled(&window.state).unwrap_err();
        assert_eq!(reason.0, "The crash part has no shells to map onto.");
    }
}

#[test]
fn one_file_as_both_parts_is_told_once() {
    let both = stamped(2, &stresses(1..=2));
    let pair = Pair::new(&both, &both);
    let told = "is the crash part and the stamped part";
    let matched = pair.shapematch(&["match", "crash.k", "stamped.dynain"]);
    let text = String::from_utf8_lossy(&matched.stdout).into_owned() + errors(&matched);
    assert_eq!(text.matches(told).count(), 1, "{text}");
    let mapped = pair.map(&["--layers", "3"]);
    assert_eq!(errors(&mapped).matches(told).count(), 1);
    let mut window = Window::new();
    window.runner = Some(real);
    for (name, role) in [("crash.k", Role::Crash), ("stamped.dynain", Role::Stamped)] {
        let rows = window.state.log.rows();
        assert!(!rows.iter().any(|row| row.text.contains(told)));
        window.open(pair.path(name).to_str().unwrap(), role);
    }
    let rows = window.state.log.rows();
    let n_told = rows.iter().filter(|row| row.text.contains(told)).count();
    assert_eq!(n_told, 1);
}

#[test]
#[cfg(target_os = "linux")]
fn of_two_files_none_is_written_or_counted_where_one_cannot_be() {
    let pair = Pair::new(&crash(2, ""), &stamped(2, &stresses(1..=2)));
    std::os::unix::fs::symlink("/dev/full", pair.path("out_elements.k")).unwrap();
    let output = pair.map(&["--out", "out.k"]);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(!text.contains("Wrote"), "{text}");
    assert!(!text.contains("thicknesses"), "{text}");
    assert!(!pair.path("out.k").exists());
}

#[test]
fn results_of_one_sheet_in_two_files_are_told_and_one_deck_holds_both() {
    let thickness = stamped(2, "");
    let card = "             0.9".repeat(4) + "\n";
    let states = stamped(2, &stresses(1..=2));
    let states = states
        .replace("SHELL_THICKNESS", "SHELL")
        .replace(&card, "");
    let pair = Pair::new(&crash(2, ""), &thickness);
    let both = "*KEYWORD\n*INCLUDE\nstates.k\n*INCLUDE\nstamped.dynain\n*END\n";
    for (name, deck) in [("states.k", &*states), ("both.k", both)] {
        std::fs::write(pair.path(name), deck).unwrap();
    }
    let map = |stamped: &[&str]| {
        let options = ["--identity", "--quantities", "thickness,stress"];
        let options = [&options[..], &["--out", "out.k", "--write", "part"]].concat();
        pair.shapematch(&[&["map", "crash.k"], stamped, &options].concat())
    };
    let told = "hold the same elements with different results";
    let two = map(&["stamped.dynain", "states.k"]);
    assert!(errors(&two).contains(told), "{}", errors(&two));
    let one = map(&["both.k"]);
    assert!(one.status.success(), "{}", errors(&one));
    assert!(!errors(&one).contains(told), "{}", errors(&one));
    let deck = std::fs::read_to_string(pair.path("out.k")).unwrap();
    assert!(deck.contains("INITIAL_STRESS_SHELL"), "{deck}");
    assert!(deck.contains("9.00000000E-01"), "{deck}");
}
