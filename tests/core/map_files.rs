//! `shapematch map` as it is typed: from decks with results to decks with mapped results.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use shapematch::formats::{Model, ReadOptions, read};
use shapematch::monitor::Monitor;
use shapematch::pipeline::bench::map::{ErrorRow, error_rows};
use shapematch::samples::{SamplePart, SampleSettings};

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
        Self::made(&["--part", "bracket"])
    }

    /// Another sample in the place of the bracket.
    fn made(choices: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_str().unwrap();
        let made = shapematch(&[&["sample", place], choices].concat());
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

#[test]
fn our_own_files_compare_as_equal_and_others_by_their_difference() {
    let bracket = Bracket::new();
    let (out, json) = (bracket.path("mapped.k"), bracket.path("map.json"));
    let elements = bracket.path("mapped_elements.k");
    let written = bracket.map(&["--out", &out, "--quantities", "full"]);
    assert!(written.status.success(), "{}", text(&written.stderr));
    let record = |options: &[&str]| -> Value {
        let output = bracket.map(&[&["--json", &json], options].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap()
    };
    let csv = bracket.path("table.csv");
    let both = [
        "--quantities",
        "full",
        "--compare",
        &out,
        "--compare",
        &elements,
    ];
    let same = record(&[&both[..], &["--csv", &csv]].concat());
    let same = &same["comparison"];
    assert_eq!(
        (&same["n_only_here"], &same["n_only_other"]),
        (&0.into(), &0.into())
    );
    for name in [
        "thickness",
        "plastic_strain",
        "von_mises",
        "major_strain",
        "minor_strain",
    ] {
        let found = &same[name];
        let max = found["max"].as_f64().unwrap();
        let ends = ["min", "max"].map(|end| found["here"][end].as_f64().unwrap().abs());
        let size = ends[0].max(ends[1]);
        // Nine digits of each component.
        assert!(max <= 1e-7 * size, "{name}: {max} of {size}");
        assert_eq!(found["n_elements"], same["n_both"]);
    }
    let table = std::fs::read_to_string(&csv).unwrap();
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .ends_with("other_thickness,other_plastic_strain")
    );
    assert_eq!(table.lines().nth(1).unwrap().split(',').count(), 14);
    // The nearest element differs, by what the table of elements says too.
    let nearest = record(&[
        "--method",
        "nearest",
        "--compare",
        &elements,
        "--compare",
        &out,
    ]);
    let found = &nearest["comparison"]["plastic_strain"];
    assert!(found["max"].as_f64().unwrap() > 1e-3, "{found}");
    assert!(found["rms"].as_f64().unwrap() <= found["max"].as_f64().unwrap());
    // A file of other elements is named.
    let other = bracket.map(&["--compare", &bracket.path("pose.txt")]);
    assert_eq!(other.status.code(), Some(1));
    let bare = bracket.map(&["--compare", &bracket.path("crash.k")]);
    assert!(
        text(&bare.stderr).contains("nothing to compare with"),
        "{}",
        text(&bare.stderr)
    );
}

/// A page without its pictures, whose letters mean nothing.
fn words_of(page: &str) -> String {
    let mut pieces = page.split("data:image/png;base64,");
    let mut words = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        words.push_str(piece.split_once('"').map_or("", |(_, rest)| rest));
    }
    words
}

#[test]
fn the_report_holds_pictures_tables_and_the_comparison() {
    let bracket = Bracket::new();
    let (out, page) = (bracket.path("mapped.k"), bracket.path("map.html"));
    let first = bracket.map(&["--out", &out]);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let output = bracket.map(&["--report", &page, "--compare", &out]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(&page).unwrap();
    // Before, after and difference of two quantities, the statuses, and plastic strain here, there and
    // their difference.
    assert_eq!(page.matches("data:image/png;base64,").count(), 10);
    for words in [
        "Thickness, mm",
        "Effective plastic strain",
        "mapped less the stamped element",
        "What became of the elements",
        "Beside another result",
        "this mapping less the other result.",
        "What was found beside what is asked for",
        "the matrix by rows",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!words_of(&page).contains("NaN"));
}

#[test]
fn plastic_strains_that_are_all_zero_are_unchanged() {
    let bracket = Bracket::new();
    let stamped = bracket.path("stamped.dynain");
    let deck = std::fs::read_to_string(&stamped).unwrap();
    let (before, states) = deck.split_once("*INITIAL_STRESS_SHELL").unwrap();
    let (states, after) = states.split_once("*INITIAL_STRAIN_SHELL").unwrap();
    // The plastic strain is the last of the eight fields of a layer.
    let without = |line: &str| match line.len() {
        80 => format!("{}{:>10}", &line[..70], 0),
        _ => line.to_owned(),
    };
    let states: Vec<String> = states.lines().map(without).collect();
    let states = states.join("\n");
    let deck = format!("{before}*INITIAL_STRESS_SHELL{states}\n*INITIAL_STRAIN_SHELL{after}");
    std::fs::write(&stamped, deck).unwrap();
    let (json, page) = (bracket.path("map.json"), bracket.path("map.html"));
    let output = bracket.map(&["--json", &json, "--report", &page]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!(record["plastic_strain"]["stamped"]["max"], 0.0);
    for name in ["Mean plastic strain", "Largest plastic strain"] {
        let mut checks = record["checks"].as_array().unwrap().iter();
        let check = checks.find(|check| check["name"] == name).unwrap();
        assert_eq!(check["is_met"], true, "{check}");
    }
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(!words_of(&page).contains("NaN"));
}

#[test]
fn a_peak_narrower_than_an_element_is_explained_wherever_checks_are_told() {
    let bracket = Bracket::new();
    let (json, page) = (bracket.path("map.json"), bracket.path("map.html"));
    let output = bracket.map(&["--json", &json, "--report", &page]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let words = "The stamped peak is narrower than a crash element";
    let told = text(&output.stdout);
    let peak = told
        .lines()
        .position(|line| line.contains("Largest plastic strain"));
    let after = peak.and_then(|at| told.lines().nth(at + 1));
    assert!(after.is_some_and(|line| line.contains(words)), "{told}");
    let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let checks = record["checks"].as_array().unwrap();
    let (mut n_met, mut n_judged) = (0, 0);
    for check in checks {
        let is_peak = check["name"] == "Largest plastic strain";
        let is_told = is_peak || check["name"] == "Pose";
        assert_eq!(check["reason"].is_object(), is_told, "{check}");
        if is_peak {
            assert_eq!(check["reason"]["name"], "peak-narrower-than-element");
            assert!(check["reason"]["text"].as_str().unwrap().starts_with(words));
        }
        n_met += usize::from(check["is_met"] == true);
        n_judged += usize::from(check["is_met"].is_boolean());
    }
    let counted = format!("Checks   {n_met} of {n_judged} met");
    assert!(told.contains(&counted), "{counted}: {told}");
    let page = std::fs::read_to_string(&page).unwrap();
    assert_eq!(page.matches(words).count(), 1);
    assert_eq!(page.matches("✔ met").count(), n_met);
    assert_eq!(page.matches("✖ not met").count(), n_judged - n_met);
}

/// The window, which knows the match, has one judged check more.
#[test]
fn why_a_given_pose_is_not_judged_stands_wherever_checks_are_told() {
    let bracket = Bracket::new();
    let (json, page) = (bracket.path("map.json"), bracket.path("map.html"));
    let output = bracket.map(&["--json", &json, "--report", &page]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let pose = &record["checks"][0];
    assert_eq!(pose["name"], "Pose");
    assert!(pose["is_met"].is_null());
    assert_eq!(pose["reason"]["name"], "given-pose");
    let told = text(&output.stdout);
    assert!(
        told.contains("Pose: given, asked for a match that is GOOD, not judged"),
        "{told}"
    );
    let words = "Only the match that found a pose says whether it is right";
    assert!(told.contains(words), "{told}");
    let page = std::fs::read_to_string(&page).unwrap();
    assert_eq!(page.matches(words).count(), 1);
}

#[test]
fn volume_and_thickness_over_the_section_are_those_of_the_decks() {
    let bracket = Bracket::new();
    let (json, csv) = (bracket.path("map.json"), bracket.path("elements.csv"));
    let output = bracket.map(&["--json", &json, "--csv", &csv]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let check = |name: &str| {
        let mut checks = record["checks"].as_array().unwrap().iter();
        checks.find(|check| check["name"] == name).unwrap().clone()
    };
    let areas = |model: &Model| -> Vec<f64> {
        let shells = model.shells.iter();
        let area = |nodes: [u32; 4]| {
            let [a, b, c, d] = nodes.map(|node| model.nodes.positions()[node as usize]);
            (c - a).cross(&(d - b)).norm() / 2.0
        };
        shells.map(|shell| area(shell.nodes)).collect()
    };
    let crash = model(&bracket.path("crash.k"));
    let table = std::fs::read_to_string(&csv).unwrap();
    let thickness = table.lines().skip(1).map(|line| -> f64 {
        let cell = line.split(',').nth(10).unwrap();
        cell.parse().unwrap()
    });
    let thickness: Vec<f64> = thickness.collect();
    let on_crash = thickness.iter().zip(areas(&crash));
    let on_crash: f64 = on_crash.map(|(t, area)| t * area).sum();
    let formed = model(&bracket.path("stamped.dynain"));
    let of_stamped = areas(&formed);
    let extras = formed.shell_extras.iter();
    let on_stamped: f64 = extras
        .map(|extra| extra.thickness[0] * of_stamped[extra.shell as usize])
        .sum();
    let volume = check("Volume of the sheet");
    let found = volume["found"].as_str().unwrap().replace('−', "-");
    let found: f64 = found.trim_end_matches(" %").parse().unwrap();
    let expected = 100.0 * (on_crash / on_stamped - 1.0);
    assert!((found - expected).abs() < 0.3, "{found} {expected}");
    assert!(volume["is_met"].is_null());

    // The section of the sample is 2.
    let least = thickness.iter().copied().fold(f64::INFINITY, f64::min) / 2.0;
    let ratio = check("Thickness / section");
    let found = ratio["found"].as_str().unwrap();
    let low: f64 = found.split('–').next().unwrap().parse().unwrap();
    assert!((low - least).abs() < 0.0051, "{found} {least}");
    assert_eq!(ratio["is_met"], true);
}

#[test]
fn stresses_have_pictures_in_the_report_too() {
    let bracket = Bracket::new();
    let page = bracket.path("map.html");
    let output = bracket.map(&["--report", &page, "--quantities", "full"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let page = std::fs::read_to_string(&page).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 10);
    assert!(page.contains("Von Mises stress in the middle of the sheet"));
    assert!(!words_of(&page).contains("NaN"));
}

#[test]
fn the_hand_decides_how_the_parts_are_matched_first() {
    let pillar = Bracket::made(&["--part", "pillar", "--variant", "opposite-hand"]);
    let (crash, stamped) = (pillar.path("crash.k"), pillar.path("stamped.dynain"));
    let truth = std::fs::read_to_string(pillar.path("pose.txt")).unwrap();
    let truth: Vec<f64> = truth.split(' ').map(|x| x.parse().unwrap()).collect();
    let run = |hand: [&str; 2]| {
        let output = shapematch(&["map", &crash, &stamped, hand[0], hand[1], "--json", "-"]);
        let record: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rows = record["stamped"][0]["crash_from_stamped"]
            .as_array()
            .unwrap();
        let numbers = rows.iter().flat_map(|row| row.as_array().unwrap());
        let pose: Vec<f64> = numbers.map(|x| x.as_f64().unwrap()).collect();
        (record, pose)
    };
    let mirrors = |pose: &[f64]| {
        let row = |i: usize| nalgebra::Vector3::new(pose[4 * i], pose[4 * i + 1], pose[4 * i + 2]);
        row(0).dot(&row(1).cross(&row(2))) < 0.0
    };
    assert!(mirrors(&truth));
    let mirrored = [
        ["--hand", "opposite"],
        ["--hand", "either"],
        ["--mirror", "free"],
    ];
    for hand in mirrored {
        let (record, pose) = run(hand);
        for i in [0, 1, 2, 4, 5, 6, 8, 9, 10] {
            assert!(
                (pose[i] - truth[i]).abs() < 1e-3,
                "{hand:?}: {pose:?} {truth:?}"
            );
        }
        assert!(record["mapped_area"].as_f64().unwrap() > 0.99, "{hand:?}");
        let pair = &record["plastic_strain"];
        let [from, to] = ["stamped", "crash"].map(|side| pair[side]["mean"].as_f64().unwrap());
        assert!((to / from - 1.0).abs() < 0.01, "{hand:?}: {pair}");
    }
    // The same hand never mirrors, and then cannot lie on the part.
    let (_, pose) = run(["--hand", "same"]);
    assert!(!mirrors(&pose));
}

#[test]
fn unmapped_elements_come_as_sets_by_reason() {
    let bracket = Bracket::new();
    let sets = bracket.path("unmapped.k");
    let output = bracket.map(&["--unmapped", &sets, "--max-distance", "1e-6", "--json", "-"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let read = model(&sets);
    let rows = record["statuses"].as_array().unwrap().iter();
    let rows: Vec<&Value> = rows.filter(|row| row["status"] != "mapped").collect();
    assert!(!rows.is_empty());
    assert_eq!(read.sets.shells.len(), rows.len());
    for (set, row) in read.sets.shells.values().zip(rows) {
        assert_eq!(
            set.ids.len() as u64,
            row["n_elements"].as_u64().unwrap(),
            "{}",
            set.title
        );
        let has_values = ["partly", "filled", "two-layers", "conflict"];
        let has_values = has_values.contains(&row["status"].as_str().unwrap());
        let values = if has_values {
            ": with values"
        } else {
            ": no values"
        };
        assert!(set.title.ends_with(values), "{}", set.title);
    }
}

#[test]
fn corners_get_their_own_thickness_where_asked() {
    let bracket = Bracket::new();
    let out = bracket.path("crash_mapped.k");
    let options = [
        "--out",
        &out,
        "--write",
        "deck",
        "--corner-thickness",
        "yes",
    ];
    let output = bracket.map(&options);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let corners = model(&out);
    let output = bracket.map(&["--out", &out, "--write", "deck"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let means = model(&out);
    assert_eq!(corners.shell_extras.len(), means.shell_extras.len());
    let mut n_uneven = 0;
    for (own, mean) in corners.shell_extras.iter().zip(&means.shell_extras) {
        let n = corners.shells[own.shell as usize].corners().len();
        let sum: f64 = own.thickness[..n].iter().sum();
        assert!((sum / n as f64 - mean.thickness[0]).abs() < 1e-8);
        n_uneven += usize::from((own.thickness[0] - own.thickness[2]).abs() > 1e-6);
    }
    assert!(n_uneven > corners.shell_extras.len() / 2, "{n_uneven}");
}

/// What is asked for against the means of the exact field over each crash element: means of thickness
/// and plastic strain, peak.
fn assert_exact(rows: &[ErrorRow], thickness_mean: f64, rms: f64) {
    let of = |method: &str| rows.iter().find(|row| row.method == method).unwrap();
    let (area, exact, nearest) = (of("area"), of("exact"), of("nearest"));
    assert!(area.mapped_area > 0.999, "{area:?}");
    assert!(area.thickness_mean.abs() < thickness_mean, "{area:?}");
    assert!(area.plastic_mean.abs() < 0.005, "{area:?}");
    assert!((area.plastic_peak - 1.0).abs() < 0.03, "{area:?}");
    assert!(
        area.plastic_rms < rms && area.thickness_rms < rms && area.stress_rms < rms,
        "{area:?}"
    );
    // The way back loses no more than what the crash elements cannot hold, by 3 % of the range.
    assert!(area.back_p95 < exact.back_p95 + 0.03, "{area:?} {exact:?}");
    assert!(
        exact.plastic_rms < 2e-3 && exact.stress_rms < 1e-6,
        "{exact:?}"
    );
    for (ours, other) in [
        (area.thickness_rms, nearest.thickness_rms),
        (area.plastic_rms, nearest.plastic_rms),
        (area.stress_rms, nearest.stress_rms),
    ] {
        assert!(ours < 0.5 * other, "{ours} {other}");
    }
}

fn rows_of(part: SamplePart, sizes: [f64; 2]) -> Vec<ErrorRow> {
    let settings = SampleSettings {
        part,
        stamped_size: Some(sizes[0]),
        crash_size: Some(sizes[1]),
        ..SampleSettings::default()
    };
    error_rows(&settings, sizes, &Monitor::silent()).unwrap()
}

#[test]
fn fields_of_the_samples_come_through_within_the_known_error() {
    // Onto elements twice as large, on radii about as small as they are.
    assert_exact(&rows_of(SamplePart::Bracket, [2.5, 5.0]), 0.005, 0.011);
    // Onto elements of the same size.
    assert_exact(&rows_of(SamplePart::Bracket, [5.0, 5.0]), 0.002, 0.016);
}
