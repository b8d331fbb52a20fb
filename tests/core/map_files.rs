//! `shapematch map` as it is typed: from decks with results to decks with mapped results.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use shapematch::formats::{Model, ReadOptions, read};
use shapematch::monitor::Monitor;

fn shapematch(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .args(args)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

fn model(path: &str) -> Model {
    read(Path::new(path), &ReadOptions::default(), &Monitor::silent()).unwrap()
}

/// A generated bracket with its pose, and names of files beside it.
struct Bracket {
    folder: tempfile::TempDir,
}

impl Bracket {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_str().unwrap();
        let made = shapematch(&["sample", place, "--part", "bracket"]);
        assert!(made.status.success(), "{}", text(&made.stderr));
        let truth = std::fs::read_to_string(folder.path().join("truth.json")).unwrap();
        let truth: Value = serde_json::from_str(&truth).unwrap();
        let rows = truth["crash_from_stamped"].as_array().unwrap();
        let numbers = rows.iter().flat_map(|row| row.as_array().unwrap());
        let pose: Vec<String> = numbers.map(Value::to_string).collect();
        std::fs::write(folder.path().join("pose.txt"), pose.join(" ")).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn map(&self, options: &[&str]) -> Output {
        let (crash, stamped) = (self.path("crash.k"), self.path("stamped.dynain"));
        let pose = self.path("pose.txt");
        let known = ["map", &crash, &stamped, "--pose", &pose];
        shapematch(&[&known, options].concat())
    }
}

#[test]
fn an_include_holds_states_and_a_second_file_the_elements() {
    let bracket = Bracket::new();
    let (out, json) = (bracket.path("mapped.k"), bracket.path("map.json"));
    let csv = bracket.path("elements.csv");
    let output = bracket.map(&[
        "--out",
        &out,
        "--json",
        &json,
        "--csv",
        &csv,
        "--quantities",
        "full",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let crash = model(&bracket.path("crash.k"));
    let states = model(&out);
    // The nodes stand in the crash deck, so the elements are counted by their lines.
    let elements = std::fs::read_to_string(bracket.path("mapped_elements.k")).unwrap();
    let cards = elements
        .lines()
        .filter(|line| !line.starts_with(['$', '*']));
    let n_elements = cards.count() as u64 / 2;
    let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let n_mapped: u64 = record["statuses"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|row| ["mapped", "partly"].contains(&row["status"].as_str().unwrap()))
        .map(|row| row["n_elements"].as_u64().unwrap())
        .sum();
    assert_eq!(states.forming.n_stress() as u64, n_mapped);
    assert_eq!(states.forming.n_strain() as u64, n_mapped);
    assert_eq!(n_elements, n_mapped);
    assert!(record["mapped_area"].as_f64().unwrap() > 0.95, "{record}");
    assert!(record["read_back_error"].as_f64().unwrap() < 1e-8);
    let means = &record["thickness"];
    let [stamped, mapped] = ["stamped", "crash"].map(|side| means[side]["mean"].as_f64().unwrap());
    assert!((mapped / stamped - 1.0).abs() < 0.005, "{means}");
    let plastic = &record["plastic_strain"];
    let [stamped, mapped] =
        ["stamped", "crash"].map(|side| plastic[side]["mean"].as_f64().unwrap());
    assert!((mapped / stamped - 1.0).abs() < 0.01, "{plastic}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().count(), crash.shells.len() + 1);
    assert!(table.starts_with("element,part,status,"));
    assert!(text(&output.stdout).contains("read back within"));
}

#[test]
fn a_deck_copy_differs_in_the_elements_and_states_alone() {
    let bracket = Bracket::new();
    let out = bracket.path("crash_mapped.k");
    let output = bracket.map(&["--out", &out, "--write", "deck"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let old = std::fs::read_to_string(bracket.path("crash.k")).unwrap();
    let new = std::fs::read_to_string(&out).unwrap();
    let mut lines = new.lines();
    for line in old
        .lines()
        .filter(|line| !line.starts_with("*ELEMENT_SHELL"))
    {
        assert!(
            lines.any(|new| new == line),
            "{line:?} is missing or out of order"
        );
    }
    let (before, after) = (model(&bracket.path("crash.k")), model(&out));
    assert_eq!(before.shells, after.shells);
    assert_eq!(before.nodes, after.nodes);
    assert!(after.shell_extras.len() as f64 > 0.9 * before.shells.len() as f64);
    assert_eq!(after.forming.n_stress(), after.shell_extras.len());
    let thickness = |model: &Model| {
        model
            .shell_extras
            .iter()
            .map(|e| e.thickness[0])
            .sum::<f64>()
    };
    let mean = thickness(&after) / after.shell_extras.len() as f64;
    assert!((0.5..3.0).contains(&mean), "{mean}");
}

#[test]
fn a_part_file_holds_every_element_once() {
    let bracket = Bracket::new();
    let out = bracket.path("part.k");
    let output = bracket.map(&["--out", &out, "--write", "part", "--large", "no"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let crash = model(&bracket.path("crash.k"));
    let text = std::fs::read_to_string(&out).unwrap();
    // The nodes stand in the crash deck, so the elements are counted by their lines.
    for shell in &crash.shells {
        let id = format!(
            "\n{:>8}{:>8}",
            shell.id, crash.parts[shell.part as usize].id
        );
        assert_eq!(text.matches(&id).count(), 1, "element {}", shell.id);
    }
    assert!(text.contains("*INITIAL_STRESS_SHELL"));
}

#[test]
fn gates_and_wrong_usage_are_told() {
    let bracket = Bracket::new();
    let gate = bracket.map(&["--max-distance", "1e-6", "--require", "95"]);
    assert_eq!(gate.status.code(), Some(1));
    assert!(
        text(&gate.stderr).contains("95 % are required"),
        "{}",
        text(&gate.stderr)
    );
    let quantity = bracket.map(&["--quantities", "thickness,colour"]);
    assert_eq!(quantity.status.code(), Some(2));
    assert!(text(&quantity.stderr).contains("none of thickness, plastic"));
    let alone = shapematch(&["map", &bracket.path("crash.k")]);
    assert_eq!(alone.status.code(), Some(2));
}

#[test]
fn the_nearest_method_is_worse_by_the_way_back() {
    let bracket = Bracket::new();
    let error = |method: &str| {
        let json = bracket.path(&format!("{method}.json"));
        let output = bracket.map(&["--method", method, "--json", &json]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        let back = &record["map_back"];
        back["plastic_rms"].as_f64().unwrap() / back["plastic_range"].as_f64().unwrap()
    };
    let (area, nearest) = (error("area"), error("nearest"));
    assert!(area < 0.75 * nearest, "{area} against {nearest}");
}
