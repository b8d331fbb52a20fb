//! `shapematch map-car`, and `map` onto a whole model: which crash parts stamped parts belong to is found.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;
use shapematch::formats::{Model, ReadOptions, Selection, read};
use shapematch::monitor::{Monitor, Observer};
use shapematch::pipeline::load::{LoadSettings, load};
use shapematch::pipeline::map::{DefaultThickness, MapRecipe};
use shapematch::pipeline::map_car::{CarReason, CarRecipe, StampedFile, map_car};
use shapematch::pipeline::match_parts::MatchRecipe;

/// A car of five parts, with the stamped parts of two of them, one that belongs to no part, and a file that is
/// none.
struct Car {
    folder: tempfile::TempDir,
}

impl Car {
    fn new() -> Self {
        let car = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let samples = [
            ("bracket", "whole-model"),
            ("rail", "plain"),
            ("cup", "plain"),
        ];
        for (part, variant) in samples {
            let made = car.run(&["sample", part, "--part", part, "--variant", variant]);
            assert!(made.status.success(), "{}", errors(&made));
        }
        std::fs::write(car.path("broken.dynain"), "this is no deck\n").unwrap();
        car
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
        command.current_dir(self.folder.path()).args(args);
        command.output().unwrap()
    }
}

fn errors(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

fn model(path: &Path) -> Model {
    read(path, &ReadOptions::default(), &Monitor::silent()).unwrap()
}

const CRASH: &str = "bracket/crash.k";
const STAMPED: [&str; 4] = [
    "rail/stamped.dynain",
    "bracket/stamped.dynain",
    "cup/stamped.dynain",
    "broken.dynain",
];

#[test]
fn stamped_parts_find_their_crash_parts() {
    let car = Car::new();
    let options = ["--out", "mapped", "--report", "--json", "car.json"];
    let done = car.run(&[&["map-car", CRASH], &STAMPED[..], &options].concat());
    assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
    let text = std::fs::read_to_string(car.path("car.json")).unwrap();
    let record: Value = serde_json::from_str(&text).unwrap();
    let rows = record["rows"].as_array().unwrap();
    let states: Vec<&str> = rows
        .iter()
        .map(|row| row["state"].as_str().unwrap())
        .collect();
    assert_eq!(states, ["sure", "sure", "none", "none"], "{text}");
    let ids: Vec<&Value> = rows.iter().map(|row| &row["crash_parts"][0]).collect();
    assert_eq!(ids[..2], [2_000_019, 2_000_040]);
    assert_eq!(rows[2]["reasons"][0], "no-part");
    // The pose is the one that the pair was made with.
    let truth = std::fs::read_to_string(car.path("bracket/truth.json")).unwrap();
    let truth: Value = serde_json::from_str(&truth).unwrap();
    for (i, row) in truth["crash_from_stamped"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        for (j, expected) in row.as_array().unwrap().iter().enumerate() {
            let found = rows[1]["crash_from_stamped"][i][j].as_f64().unwrap();
            let expected = expected.as_f64().unwrap();
            assert!((found - expected).abs() < 0.2, "{found} {expected}");
        }
    }

    // The crash deck without the elements of both parts, and the deck of all results in their place.
    let path = car.path(CRASH);
    let crash = model(&path);
    let (mut rest, mut is_shell) = (String::new(), false);
    for line in std::fs::read_to_string(&path).unwrap().lines() {
        if line.starts_with('*') {
            is_shell = line.starts_with("*ELEMENT_SHELL");
        }
        let part = line.get(8..16).map(str::trim);
        if line == "*END" {
            rest += "*INCLUDE\n../mapped/mapped.k\n";
        } else if !is_shell || !["2000019", "2000040"].contains(&part.unwrap_or_default()) {
            rest += &format!("{line}\n");
        }
    }
    std::fs::write(car.path("bracket/rest.k"), rest).unwrap();
    let mapped = model(&car.path("bracket/rest.k"));
    let n_of = |model: &Model, id: u64| {
        let shells = model.shells.iter();
        let own = shells.filter(|shell| model.parts[shell.part as usize].id == id);
        own.count()
    };
    for id in [2_000_012, 2_000_019, 2_000_040] {
        assert_eq!(n_of(&mapped, id), n_of(&crash, id), "{id}");
    }
    let n_mapped = n_of(&crash, 2_000_019) + n_of(&crash, 2_000_040);
    assert_eq!(mapped.shell_extras.len(), n_mapped);
    for page in ["report.html", "stamped.html", "stamped_2.html"] {
        assert!(car.path("mapped").join(page).exists(), "{page}");
    }
    let page = std::fs::read_to_string(car.path("mapped/report.html")).unwrap();
    assert!(page.contains("SEAT BRACKET") && page.contains("href=\"stamped_2.html\""));
    assert!(page.contains("no part of the crash model fits"));
}

#[test]
fn stresses_have_the_factors_of_their_files_and_take_the_place_of_old_ones() {
    let car = Car::new();
    let path = car.path(CRASH);
    let crash = model(&path);
    let of = |part: u64| {
        let mut shells = crash.shells.iter();
        let own = shells.find(|shell| crash.parts[shell.part as usize].id == part);
        own.unwrap().id
    };
    let [rail, bracket, other] = [2_000_019, 2_000_040, 2_000_012].map(of);
    let plain = std::fs::read_to_string(&path).unwrap();
    let old = |ids: &[u64]| {
        let card = |id: &u64| format!("{id:>10}\n       0.0      10.0\n");
        let cards: String = ids.iter().map(card).collect();
        plain.replace("*END\n", &format!("*INITIAL_STRESS_SHELL\n{cards}*END\n"))
    };
    std::fs::write(&path, old(&[rail, other, bracket])).unwrap();
    let map = |folder: &str, options: &[&str]| {
        let files = ["map-car", CRASH, STAMPED[0], STAMPED[1], "--json", "-"];
        let out = ["--quantities", "stress", "--out", folder];
        let done = car.run(&[&files[..], &out, options].concat());
        assert!(done.status.success(), "{}", errors(&done));
        serde_json::from_slice::<Value>(&done.stdout).unwrap()
    };
    let record = map(
        "mapped",
        &["--stress-factor", "2", "--stress-factor", "0.5"],
    );
    let told = serde_json::json!({ "old-states": 1 });
    for row in record["rows"].as_array().unwrap() {
        assert!(row["reasons"].as_array().unwrap().contains(&told), "{row}");
    }
    assert_eq!(record["copies"], serde_json::json!([]));
    let record = map(
        "plain",
        &["--stress-factor", "1", "--replace-states", "yes"],
    );
    for row in record["rows"].as_array().unwrap() {
        assert_eq!(row["state"], "sure", "{row}");
    }
    assert_eq!(record["copies"][0]["file"], "mapped_crash.k");
    let copy = std::fs::read_to_string(car.path("plain/mapped_crash.k")).unwrap();
    assert!(copy == old(&[other]));
    let master = std::fs::read_to_string(car.path("plain/mapped.k")).unwrap();
    assert!(
        master.contains("$ mapped_crash.k takes the place of "),
        "{master}"
    );
    // The first file is the rail's, the second the bracket's.
    for (name, factor) in [("stamped.k", 2.0), ("stamped_2.k", 0.5)] {
        let [own, plain] = ["mapped", "plain"].map(|folder| model(&car.path(folder).join(name)));
        assert!(own.forming.n_stress() > 100, "{name}");
        let both = own.forming.stresses().zip(plain.forming.stresses());
        for (own, plain) in both {
            assert_eq!(own.element_id, plain.element_id);
            for (own, plain) in own.points.iter().zip(plain.points) {
                for (a, b) in own.stress.iter().zip(plain.stress) {
                    assert!((a - factor * b).abs() <= 1e-6 * b.abs().max(1.0), "{a} {b}");
                }
            }
        }
    }
    // One factor for three files is one for all, two are too few.
    let files = ["map-car", CRASH, STAMPED[0], STAMPED[1], STAMPED[2]];
    let few = [
        "--out",
        "few",
        "--stress-factor",
        "2",
        "--stress-factor",
        "1",
    ];
    let refused = car.run(&[&files[..], &few].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        errors(&refused).contains("2 stress factors for 3 stamped files"),
        "{}",
        errors(&refused)
    );
}

#[test]
fn a_stamped_file_in_metres_is_told_with_its_factor() {
    let car = Car::new();
    let text = std::fs::read_to_string(car.path(STAMPED[1])).unwrap();
    let (mut metres, mut keyword) = (String::new(), String::new());
    let mut is_thickness = false;
    for line in text.lines() {
        if line.starts_with('*') {
            keyword = line.to_owned();
        }
        let shorter = |line: &str, from: usize, n: usize| {
            let numbers = (0..n).map(|i| &line[from + 16 * i..from + 16 * (i + 1)]);
            let scaled = numbers.map(|text| text.trim().parse::<f64>().unwrap() / 1000.0);
            let scaled: String = scaled.map(|value| format!("{value:>16.9}")).collect();
            line[..from].to_owned() + &scaled + &line[from + 16 * n..]
        };
        let is_card = !line.starts_with(['*', '$']);
        metres += &match keyword.as_str() {
            "*NODE" if is_card => shorter(line, 8, 3),
            "*ELEMENT_SHELL_THICKNESS" if is_card && is_thickness => shorter(line, 0, 4),
            _ => line.to_owned(),
        };
        metres += "\n";
        is_thickness = is_card && keyword.contains("THICKNESS") && !is_thickness;
    }
    std::fs::write(car.path("metres.dynain"), metres).unwrap();
    let told = "in metres and the crash part in millimetres (--stamped-length-factor 1000)";
    let options = ["map-car", CRASH, "metres.dynain", "--out", "mapped"];
    let done = car.run(&options);
    assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
    let table = String::from_utf8(done.stdout).unwrap();
    assert!(table.contains(told), "{table}");
    for command in ["map", "match"] {
        let done = car.run(&[command, CRASH, "metres.dynain"]);
        assert!(errors(&done).contains(told), "{}", errors(&done));
    }
    let with_factor = [&options[..], &["--stamped-length-factor", "1000"]].concat();
    let done = car.run(&with_factor);
    assert!(done.status.success(), "{}", errors(&done));
    // A part that is not of this car is none in another unit either.
    let cup = car.run(&["map-car", CRASH, STAMPED[2], "--out", "mapped"]);
    let table = String::from_utf8(cup.stdout).unwrap();
    assert!(!table.contains("--stamped-length-factor"), "{table}");
}

#[test]
fn a_whole_model_is_mapped_where_the_stamped_part_belongs() {
    let car = Car::new();
    let options = ["map", CRASH, STAMPED[1], "--json", "-"];
    let done = car.run(&options);
    assert!(done.status.success(), "{}", errors(&done));
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(record["crash_parts"], serde_json::json!([2_000_040]));
    assert_eq!(record["mapped_area"], 1.0);
}

#[test]
fn two_stamped_parts_in_one_place_are_told() {
    let car = Car::new();
    std::fs::copy(car.path(STAMPED[1]), car.path("again.dynain")).unwrap();
    let options = ["--out", "mapped", "--json", "-"];
    let done = car.run(
        &[
            &["map-car", CRASH, STAMPED[1], "again.dynain"],
            &options[..],
        ]
        .concat(),
    );
    assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    let rows = record["rows"].as_array().unwrap();
    for row in rows {
        let share = row["reasons"][0]["conflict"].as_f64().unwrap();
        assert!(share > 0.95, "{row}");
    }
    // Of equal ones the first gives all values.
    assert_eq!([&rows[0]["state"], &rows[1]["state"]], ["check", "none"]);
    assert_eq!(rows[0]["files"][0], "stamped.k");
    assert_eq!(rows[1]["reasons"][1], "gives-nothing", "{}", rows[1]);
    // Nothing that is read is written over, and no folder is made below one that is not there.
    let refused = car.run(&["map-car", CRASH, STAMPED[1], "--out", "no/folder"]);
    assert_eq!(refused.status.code(), Some(1));
    std::fs::copy(car.path(CRASH), car.path("mapped/stamped.k")).unwrap();
    let refused = car.run(&["map-car", "mapped/stamped.k", STAMPED[1], "--out", "mapped"]);
    assert_eq!(refused.status.code(), Some(2), "{}", errors(&refused));
}

/// Changes a file as soon as it was read for the first time.
struct ChangesFile {
    deck: PathBuf,
    is_changed: AtomicBool,
}

impl Observer for ChangesFile {
    fn shape(&self, _points: Vec<[f64; 3]>) {
        if self.is_changed.swap(true, Ordering::Relaxed) {
            return;
        }
        let text = std::fs::read_to_string(&self.deck).unwrap();
        std::fs::write(&self.deck, format!("$ another one\n{text}")).unwrap();
    }
}

#[test]
fn a_file_that_changes_before_it_is_mapped_is_not_mapped_with_the_pose_of_what_it_was() {
    let car = Car::new();
    let observer = ChangesFile {
        deck: car.path("bracket/stamped.dynain"),
        is_changed: AtomicBool::new(false),
    };
    let monitor = Monitor::silent();
    let crash = load(&car.path(CRASH), &LoadSettings::default(), &monitor).unwrap();
    let stamped = StampedFile {
        path: observer.deck.clone(),
        settings: LoadSettings {
            selection: Selection::Sheet,
            ..LoadSettings::default()
        },
        stress_factor: None,
    };
    let recipe = CarRecipe {
        matching: MatchRecipe::default(),
        map: MapRecipe::default(),
        is_large: false,
        default_thickness: DefaultThickness::default(),
        folder: car.folder.path().to_path_buf(),
        has_pages: false,
    };
    let monitor = Monitor::with_observer(Arc::new(observer));
    let record = map_car(&crash, &[stamped], &recipe, &monitor).unwrap();
    let failed = |reason: &CarReason| match reason {
        CarReason::Failed(why) => why.contains("has changed since it was read"),
        _ => false,
    };
    assert!(record.rows[0].reasons.iter().any(failed), "{record:?}");
    assert!(record.rows[0].files.is_empty());
}

#[test]
fn a_doubtful_match_gives_way_to_a_good_one() {
    let car = Car::new();
    // Another version of the part: 5 % longer, more than its thickness at either end.
    let (mut longer, mut is_node) = (String::new(), false);
    for line in std::fs::read_to_string(car.path(STAMPED[1]))
        .unwrap()
        .lines()
    {
        if line.starts_with('*') {
            is_node = line.starts_with("*NODE");
        }
        match line.get(24..40).map(|y| y.trim().parse::<f64>()) {
            Some(Ok(y)) if is_node => {
                longer += &format!("{}{:>16.6}{}\n", &line[..24], 1.05 * y, &line[40..]);
            }
            _ => longer += &format!("{line}\n"),
        }
    }
    std::fs::write(car.path("longer.dynain"), longer).unwrap();
    let options = ["--out", "mapped", "--json", "-"];
    let files = ["map-car", CRASH, "longer.dynain", STAMPED[1]];
    let done = car.run(&[&files, &options[..]].concat());
    assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    let [longer, own] = [0, 1].map(|row| &record["rows"][row]);
    assert_eq!(longer["verdict"], "check");
    let reasons = &longer["reasons"];
    assert_eq!([&reasons[0], &reasons[2]], ["pose", "displaced"]);
    assert!(reasons[1]["match"].is_string(), "{reasons}");
    assert_eq!(longer["state"], "none");
    assert_eq!(own["state"], "sure");
    // The values are those that the good one has alone.
    let alone = car.run(&["map-car", CRASH, STAMPED[1], "--out", "alone"]);
    assert!(alone.status.success(), "{}", errors(&alone));
    let deck = |folder: &str| std::fs::read(car.path(folder).join("stamped.k")).unwrap();
    assert!(deck("mapped") == deck("alone"));
}

/// A sheet of `n` elements of a size whose shape is that of the others but for a bump; the hole has no elements.
/// Nodes and elements count from `1000 · part + 1`; one with a thickness is a stamped one.
fn bumped(bump: [f64; 2], n: [u32; 2], size: f64, part: u32, thickness: Option<f64>) -> String {
    let is_bumped = |x: f64, y: f64, [bx, by]: [f64; 2], width: f64| {
        (-((x - bx).powi(2) + (y - by).powi(2)) / (width * width)).exp()
    };
    let height = |x: f64, y: f64| {
        let common = 0.2 * (x - 140.0).abs() + 30.0 * is_bumped(x, y, [100.0, 70.0], 40.0);
        common + 14.0 * is_bumped(x, y, bump, 30.0)
    };
    let [nx, ny] = n;
    let id = |i: u32, j: u32| 1000 * part + j * (nx + 1) + i + 1;
    let (mut nodes, mut shells) = ("*NODE\n".to_owned(), "*ELEMENT_SHELL".to_owned());
    shells += match thickness {
        Some(_) => "_THICKNESS\n",
        None => "\n",
    };
    for j in 0..=ny {
        for i in 0..=nx {
            let (x, y) = (size * f64::from(i), size * f64::from(j));
            nodes += &format!("{:>8}{x:>16.6}{y:>16.6}{:>16.6}\n", id(i, j), height(x, y));
            let along = |i: u32, n: u32, hole: f64| (f64::from(i) + 0.5) / f64::from(n) - hole;
            let off = along(i, nx, 0.3).powi(2) + along(j, ny, 0.4).powi(2);
            if i < nx && j < ny && off >= 0.008 {
                let corners = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
                let fields = [id(i, j), part].into_iter().chain(corners);
                shells += &fields.map(|id| format!("{id:>8}")).collect::<String>();
                shells += "\n";
                shells += &thickness.map_or(String::new(), |t| format!("{t:>16}").repeat(4) + "\n");
            }
        }
    }
    let head = match thickness {
        Some(_) => "*KEYWORD\n".to_owned(),
        None => format!(
            "*PART\nsheet\n{part:>10}{part:>10}\n*SECTION_SHELL\n{part:>10}{:>10}{:>20}\n{:>10}\n",
            2, 2, 1.0
        ),
    };
    head + &nodes + &shells + if thickness.is_some() { "*END\n" } else { "" }
}

/// Maps onto crash parts, each with the place of its bump and its elements, `files` with the same and their size.
fn map_bumped(
    parts: &[([f64; 2], [u32; 2])],
    files: &[(&str, [f64; 2], [u32; 2], f64)],
) -> (Option<i32>, Vec<Value>) {
    let folder = tempfile::tempdir().unwrap();
    let parts = (1..).zip(parts);
    let parts: String = parts
        .map(|(id, (bump, n))| bumped(*bump, *n, 10.0, id, None))
        .collect();
    std::fs::write(
        folder.path().join("car.k"),
        format!("*KEYWORD\n{parts}*END\n"),
    )
    .unwrap();
    for (number, (name, bump, n, size)) in files.iter().enumerate() {
        let thickness = 0.9 - 0.05 * number as f64;
        let deck = bumped(*bump, *n, *size, 1, Some(thickness));
        std::fs::write(folder.path().join(name), deck).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
    command
        .current_dir(folder.path())
        .args(["map-car", "car.k"]);
    let names = files.iter().map(|file| file.0);
    let done = command
        .args(names)
        .args(["--out", "mapped", "--json", "-"])
        .output()
        .unwrap();
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    (
        done.status.code(),
        record["rows"].as_array().unwrap().clone(),
    )
}

#[test]
fn of_doubtful_matches_the_one_that_fits_clearly_better_is_mapped_and_gives_its_name() {
    let own = [240.0, 140.0];
    let files = [
        ("other.dynain", [60.0, 150.0], [38, 26], 8.0),
        ("own.dynain", own, [43, 29], 7.0),
    ];
    let (code, rows) = map_bumped(&[(own, [30, 20])], &files);
    assert_eq!(code, Some(1));
    let [other, own] = [&rows[0], &rows[1]];
    for row in [other, own] {
        assert_eq!(row["verdict"], "check", "{row}");
        assert_eq!(row["crash_parts"][0], 1);
    }
    assert_eq!(other["state"], "none", "{other}");
    let reasons = other["reasons"].as_array().unwrap();
    assert!(reasons.contains(&"displaced".into()), "{other}");
    assert!(other["mapped_area"].is_null() && other["thickness"].is_null());
    assert_eq!(own["mapped_area"], 1.0);
    assert!(
        (own["thickness"].as_f64().unwrap() - 0.85).abs() < 1e-9,
        "{own}"
    );
    assert_eq!(own["files"][0], "own.k");
}

/// The deck with the elements alone whose first corner is kept.
fn cut(deck: &str, is_kept: impl Fn(f64) -> bool) -> String {
    let field = |line: &str, at: usize| line[8 * at..8 * at + 8].trim().parse::<u32>().unwrap();
    let (mut kept, mut section, mut x_of) = (String::new(), "", BTreeMap::new());
    let mut lines = deck.lines();
    while let Some(line) = lines.next() {
        if line.starts_with('*') {
            section = line;
        } else if section == "*NODE" {
            x_of.insert(field(line, 0), line[8..24].trim().parse::<f64>().unwrap());
        } else if section.starts_with("*ELEMENT") {
            let thickness = lines.next().unwrap();
            if is_kept(x_of[&field(line, 2)]) {
                kept += &format!("{line}\n{thickness}\n");
            }
            continue;
        }
        kept += &format!("{line}\n");
    }
    kept
}

/// Two halves of a sheet that overlap a little are both mapped, whatever their verdicts.
#[test]
fn halves_that_overlap_do_not_give_way_to_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let own = [240.0, 140.0];
    let crash = bumped(own, [30, 20], 10.0, 1, None);
    let whole = bumped(own, [43, 29], 7.0, 1, Some(0.9));
    for (name, deck) in [
        ("car.k", format!("*KEYWORD\n{crash}*END\n")),
        ("left.dynain", cut(&whole, |x| x <= 190.0)),
        ("right.dynain", cut(&whole, |x| x >= 160.0)),
    ] {
        std::fs::write(folder.path().join(name), deck).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
    let files = ["map-car", "car.k", "left.dynain", "right.dynain"];
    let done = (command.current_dir(folder.path()).args(files))
        .args(["--out", "mapped", "--json", "-"])
        .output()
        .unwrap();
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    for row in record["rows"].as_array().unwrap() {
        assert_ne!(row["state"], "none", "{row}");
        assert!(row["mapped_area"].as_f64().unwrap() > 0.4, "{row}");
    }
}

/// The crash model among the stamped files, as where all decks of a folder are given.
#[test]
fn the_crash_model_is_no_stamped_part_of_itself() {
    let car = Car::new();
    let options = ["--out", "mapped", "--json", "-"];
    let files = ["map-car", CRASH, CRASH, STAMPED[1]];
    let done = car.run(&[&files, &options[..]].concat());
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    let [itself, own] = [0, 1].map(|row| &record["rows"][row]);
    assert_eq!(itself["state"], "none");
    assert_eq!(itself["reasons"][0], "same-file", "{itself}");
    assert_eq!(own["state"], "sure", "{own}");
}

#[test]
fn a_part_that_is_not_in_the_car_is_mapped_onto_none_of_several_shapes() {
    let alien = [("alien.dynain", [60.0, 150.0], [38, 26], 8.0)];
    let parts = [
        ([240.0, 140.0], [30, 20]),
        ([235.0, 100.0], [28, 20]),
        ([245.0, 50.0], [30, 18]),
    ];
    let (code, rows) = map_bumped(&parts, &alien);
    assert_eq!(code, Some(1), "{}", rows[0]);
    assert_eq!(rows[0]["state"], "none");
    let absent = rows[0]["reasons"][0]["absent"].as_array().unwrap();
    assert_eq!(absent.len(), 3, "{}", rows[0]);
    // Copies of one part are no sign of that: another version of it may have been stamped.
    let (code, rows) = map_bumped(&[parts[0]; 3], &alien);
    assert_eq!(code, Some(0), "{}", rows[0]);
    assert_eq!(rows[0]["state"], "check");
    let mut reasons = rows[0]["reasons"].as_array().unwrap().iter();
    assert!(
        reasons.any(|reason| reason["doubtful"].as_f64() > Some(2.0)),
        "{}",
        rows[0]
    );
}

#[test]
#[cfg(target_os = "linux")]
fn the_table_is_printed_though_the_json_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
        let command = command.current_dir(folder.path()).args(args);
        command.output().unwrap()
    };
    let made = run(&["sample", ".", "--part", "rail", "--variant", "plain"]);
    assert!(made.status.success(), "{}", errors(&made));
    let map = ["map-car", "crash.k", "stamped.dynain", "--out", "mapped"];
    let whole = run(&map);
    assert!(whole.status.success(), "{}", errors(&whole));
    let done = run(&[&map[..], &["--json", "/dev/full"]].concat());
    assert_eq!(done.status.code(), Some(1), "{}", errors(&done));
    assert!(
        errors(&done).contains("/dev/full is not written"),
        "{}",
        errors(&done)
    );
    let table = |output: &Output| String::from_utf8(output.stdout.clone()).unwrap();
    assert!(
        table(&whole).contains("stamped.dynain"),
        "{}",
        table(&whole)
    );
    assert_eq!(table(&done), table(&whole));
}

#[test]
fn half_of_a_symmetric_sheet_is_told_with_its_mirror_image() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // Alike on both sides of y = 0, and on no other two sides.
    let height = |x: f64, y: f64| {
        let bump = (-((x - 60.0) / 40.0).powi(2) - ((y.abs() - 50.0) / 25.0).powi(2)).exp();
        20.0 * bump + 0.0015 * x * x
    };
    let sheet = |from: i32, keyword: &str, card: &str| {
        let (mut nodes, mut shells) = ("*NODE\n".to_owned(), format!("{keyword}\n"));
        for j in from..=20 {
            for i in 0..=40 {
                let (x, y) = (5.0 * f64::from(i), 5.0 * f64::from(j));
                let id = (j - from) * 41 + i + 1;
                nodes += &format!("{id:>8}{x:>16.6}{y:>16.6}{:>16.6}\n", height(x, y));
                if i < 40 && j < 20 {
                    let corners = [id, 1, id, id + 1, id + 42, id + 41];
                    let fields = corners.iter().map(|id| format!("{id:>8}"));
                    shells += &(fields.collect::<String>() + "\n" + card);
                }
            }
        }
        nodes + &shells
    };
    let part = "*PART\nsheet\n         1         1\n*SECTION_SHELL\n         1         2                   2\n       1.0\n";
    let car = format!("*KEYWORD\n{part}{}*END\n", sheet(-20, "*ELEMENT_SHELL", ""));
    let card = format!("{:>16}", 0.9).repeat(4) + "\n";
    let half = format!(
        "*KEYWORD\n{}*END\n",
        sheet(0, "*ELEMENT_SHELL_THICKNESS", &card)
    );
    std::fs::write(path("car.k"), car).unwrap();
    std::fs::write(path("half.dynain"), half).unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
        let done = command
            .current_dir(folder.path())
            .args(args)
            .output()
            .unwrap();
        assert!(done.status.success(), "{}", errors(&done));
        serde_json::from_slice::<Value>(&done.stdout).unwrap()
    };
    let found = run(&[
        "map-car",
        "car.k",
        "half.dynain",
        "--out",
        "mapped",
        "--json",
        "-",
    ]);
    let row = &found["rows"][0];
    assert!(
        (row["mapped_area"].as_f64().unwrap() - 0.5).abs() < 0.01,
        "{row}"
    );
    let reasons = row["reasons"].as_array().unwrap();
    let mirrored = reasons.iter().find_map(|reason| reason.get("mirror-image"));
    // What the reason advises.
    let words = |rows: &Value| {
        let rows = rows.as_array().unwrap().iter();
        let all = rows.flat_map(|row| row.as_array().unwrap());
        let all: Vec<String> = all.map(Value::to_string).collect();
        all.join(" ")
    };
    let (own, mirrored) = (words(&row["crash_from_stamped"]), words(mirrored.unwrap()));
    let twice = ["map", "car.k", "half.dynain", "half.dynain", "--json", "-"];
    let poses = ["--pose", &own, "--pose", &mirrored];
    let both = run(&[&twice[..], &poses].concat());
    assert_eq!(both["mapped_area"], 1.0);
}

#[test]
fn a_sheet_that_is_two_crash_parts_is_mapped_onto_both() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_shapematch"));
        command
            .current_dir(folder.path())
            .args(args)
            .output()
            .unwrap()
    };
    assert!(run(&["sample", ".", "--part", "pillar"]).status.success());
    let path = folder.path().join("crash.k");
    let deck = std::fs::read_to_string(&path).unwrap();
    let crash = model(&path);
    // Elements above the middle become a part of their own, and far off lies one that has nothing to do with
    // it.
    let height = |shell: &shapematch::formats::model::Shell| {
        let nodes = shell
            .nodes
            .map(|node| crash.nodes.positions()[node as usize]);
        nodes.iter().map(|p| p.z).sum::<f64>()
    };
    let mut heights: Vec<f64> = crash.shells.iter().map(height).collect();
    heights.sort_by(f64::total_cmp);
    let middle = heights[heights.len() / 3];
    let upper: std::collections::HashSet<u64> = crash
        .shells
        .iter()
        .filter(|shell| height(shell) > middle)
        .map(|shell| shell.id)
        .collect();
    let own = crash.parts[0].id;
    let (mut split, mut is_shell) = (String::new(), false);
    for line in deck.lines().filter(|line| !line.starts_with("*END")) {
        if line.starts_with('*') {
            is_shell = line.starts_with("*ELEMENT_SHELL");
        }
        let id = line.get(..8).and_then(|id| id.trim().parse::<u64>().ok());
        let is_upper = is_shell && id.is_some_and(|id| upper.contains(&id));
        if is_upper && line[8..16].trim() == own.to_string() {
            split += &format!("{}{:>8}{}\n", &line[..8], own + 1, &line[16..]);
        } else {
            split += &format!("{line}\n");
        }
    }
    let part = deck.split("*PART").nth(1).unwrap();
    let part = part.split('*').next().unwrap();
    split += &format!(
        "*PART{}",
        part.replacen(&own.to_string(), &(own + 1).to_string(), 1)
            .replacen("B-PILLAR", "C-PILLAR", 1)
    );
    split += &format!(
        "*NODE\n{}{}{}{}*PART\nFAR PLATE\n{:>10}\n*ELEMENT_SHELL\n{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n*END\n",
        node(90_000_001, 9e3, 0.0),
        node(90_000_002, 9.4e3, 0.0),
        node(90_000_003, 9.4e3, 90.0),
        node(90_000_004, 9e3, 90.0),
        own + 2,
        90_000_001,
        own + 2,
        90_000_001,
        90_000_002,
        90_000_003,
        90_000_004
    );
    std::fs::write(&path, split).unwrap();
    let done = run(&["map", "crash.k", "stamped.dynain", "--json", "-"]);
    assert!(done.status.success(), "{}", errors(&done));
    let record: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(
        record["crash_parts"],
        serde_json::json!([own, own + 1]),
        "{record}"
    );
    assert!(record["mapped_area"].as_f64().unwrap() > 0.99);
    let car = ["map-car", "crash.k", "stamped.dynain", "--out", "mapped"];
    let done = run(&[&car[..], &["--json", "-"]].concat());
    let rows: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(
        rows["rows"][0]["title"],
        "B-PILLAR REINFORCEMENT LH, C-PILLAR REINFORCEMENT LH"
    );
}

fn node(id: u64, x: f64, y: f64) -> String {
    format!("{id:>8}{x:>16.4}{y:>16.4}{:>16.4}\n", 0.0)
}

#[test]
fn where_nothing_is_mapped_no_deck_is_written_and_a_file_named_twice_counts_once() {
    let car = Car::new();
    let broken = "broken.dynain";
    let output = car.run(&[
        "map-car", CRASH, broken, broken, "--out", "mapped", "--json", "out.json",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let told = errors(&output);
    assert!(told.contains("is named twice and mapped once"), "{told}");
    assert!(
        told.contains("nothing is mapped; no deck is written"),
        "{told}"
    );
    assert!(!car.path("mapped/mapped.k").exists());
    let record: Value =
        serde_json::from_slice(&std::fs::read(car.path("out.json")).unwrap()).unwrap();
    assert_eq!(record["rows"].as_array().unwrap().len(), 1);
}
