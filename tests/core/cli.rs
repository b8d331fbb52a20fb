//! The program as it is typed: exit status, standard output, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use shapematch::formats::{FileHash, ReadOptions, read};
use shapematch::geometry::{Matrix4, Similarity};
use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, load};
use shapematch::pipeline::sweep::node_distance;
use shapematch::report::{cards::read_back, parse_matrix};

fn shapematch(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .args(args)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// A folder with the bundled pair and a shorthand for paths in it.
struct Pair {
    folder: tempfile::TempDir,
}

impl Pair {
    fn bundled() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let output = shapematch(&["sample", folder.path().to_str().unwrap(), "--bundled"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn run(&self, options: &[&str]) -> Output {
        let (crash, stamped) = (self.path("crash.k.gz"), self.path("stamped.dynain.gz"));
        shapematch(&[&["match", &crash, &stamped], options].concat())
    }

    fn truth(&self) -> Similarity {
        let json: Value =
            serde_json::from_slice(&std::fs::read(self.path("truth.json")).unwrap()).unwrap();
        similarity(&json["crash_from_stamped"])
    }
}

fn similarity(rows: &Value) -> Similarity {
    let matrix = Matrix4::from_fn(|row, col| rows[row][col].as_f64().unwrap());
    Similarity::from_matrix4(&matrix, 1e-6).unwrap()
}

fn mesh(path: &str) -> shapematch::geometry::TriMesh {
    let model = read(Path::new(path), &ReadOptions::default(), &Monitor::silent()).unwrap();
    model.surface(&Default::default()).unwrap().mesh
}

#[test]
fn the_bundled_pair_is_matched_and_everything_is_written() {
    let pair = Pair::bundled();
    let names = ["r.json", "m.txt", "c.k", "moved.k", "r.html", "nodes.csv"];
    let [json, matrix, cards, moved, page, nodes] = names.map(|name| pair.path(name));
    let options = [
        "--json",
        &json,
        "--matrix",
        &matrix,
        "--cards",
        &cards,
        "--moved",
        &moved,
        "--report",
        &page,
        "--deviations",
        &nodes,
    ];
    let output = pair.run(&options);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report = text(&output.stdout);
    assert!(report.starts_with("GOOD\n"), "{report}");
    assert!(report.contains("crash = c · R · stamped + t (column vectors)"));

    let record: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let found = similarity(&record["matrix"]);
    let stamped = mesh(&pair.path("stamped.dynain.gz"));
    let (_, worst) = node_distance(&stamped, &found, &pair.truth());
    assert!(
        worst < 0.1 * stamped.mean_edge_length(),
        "worst node is {worst} off"
    );

    // Text and JSON carry the same bits; the cards what ten columns can hold.
    let typed = parse_matrix(&std::fs::read_to_string(&matrix).unwrap()).unwrap();
    assert_eq!(typed.motion.to_rows(), found.to_rows());
    let on_cards = read_back(&std::fs::read_to_string(&cards).unwrap()).unwrap();
    assert!(node_distance(&stamped, &on_cards, &found).1 < 1e-3);
    // They name the file as it lies from theirs.
    let folder = pair.folder.path().join("cards");
    std::fs::create_dir(&folder).unwrap();
    let elsewhere = folder.join("c.k");
    pair.run(&["--cards", elsewhere.to_str().unwrap()]);
    let elsewhere = std::fs::read_to_string(elsewhere).unwrap();
    assert!(elsewhere.contains("\n../stamped.dynain\n"), "{elsewhere}");

    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.ends_with("</html>\n") && page.contains("GOOD"));
    let nodes = std::fs::read_to_string(&nodes).unwrap();
    assert!(
        nodes.contains(
            "\npart,node,x,y,z,distance,class,nearest_element,pose_uncertainty\nstamped,"
        )
    );

    // The moved deck lies where the matrix puts the stamped one, node by node.
    let there = mesh(&moved);
    let expected = stamped.transformed(&found);
    for (a, b) in there.positions().iter().zip(expected.positions()) {
        assert!((a - b).norm() < 1e-5);
    }
}

#[test]
fn a_text_on_standard_output_is_not_mixed_with_the_summary() {
    let pair = Pair::bundled();
    let matrix = pair.run(&["-q", "--matrix", "-"]);
    let rows = text(&matrix.stdout)
        .lines()
        .filter(|line| !line.starts_with('#'));
    assert_eq!(rows.flat_map(str::split_whitespace).count(), 16);
    let cards = pair.run(&["-q", "--cards", "-"]);
    assert!(text(&cards.stdout).starts_with(['$', '*']));
}

#[test]
fn the_record_has_its_keys() {
    let pair = Pair::bundled();
    let output = pair.run(&["--json", "-"]);
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys = [
        "schema",
        "direction",
        "convention",
        "units",
        "matrix",
        "inverse",
        "rotation",
        "rotation_axis_angle",
        "quaternion",
        "translation",
        "scale",
        "verdict",
        "reasons",
        "ambiguous",
        "alternatives",
        "metrics",
        "method",
        "parameters",
        "seed",
        "starts",
        "timings",
        "warnings",
        "files",
        "command_line",
        "build",
        "machine",
    ];
    for key in keys {
        assert!(record.get(key).is_some(), "no key {key}");
    }
    for key in [
        "read", "reduce", "align", "match", "settle", "verify", "total",
    ] {
        let time = &record["timings"][format!("{key}_ms")];
        assert!(time.is_f64(), "no time {key}");
    }
    for key in ["stamped", "crash", "limit"] {
        let overlap = &record["metrics"]["overlap"];
        assert!(overlap[key].is_f64(), "no overlap {key}");
    }
    for (side, name) in [("crash", "crash.k.gz"), ("stamped", "stamped.dynain.gz")] {
        let file = &record["files"][side];
        assert_eq!(file["name"], name);
        let bytes = std::fs::read(pair.path(name)).unwrap();
        assert_eq!(file["sha256"], FileHash::of(&bytes).to_string());
    }
    assert_eq!(record["schema"], "shapematch.match/3");
    let there = similarity(&record["matrix"]);
    let back = similarity(&record["inverse"]);
    let still = Similarity::identity().to_matrix4();
    assert!((back.after(&there).to_matrix4() - still).amax() < 1e-9);
    assert_eq!(record["verdict"], "good");
    assert_eq!(record["rotation"].as_array().unwrap().len(), 3);
    assert_eq!(record["translation"].as_array().unwrap().len(), 3);
}

/// Runs the line as a shell would, with this build in place of the installed program.
fn run_line(line: &str, more: &[&str]) -> Value {
    let program = Path::new(env!("CARGO_BIN_EXE_shapematch"));
    let path = std::env::join_paths(std::iter::once(program.parent().unwrap().to_owned()).chain(
        std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()),
    ));
    let output = Command::new("sh")
        .args(["-c", &format!("{line} {}", more.join(" "))])
        .env("PATH", path.unwrap())
        .output()
        .unwrap();
    let told = text(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{line}: {e}: {told}"))
}

#[test]
#[cfg(unix)]
fn the_line_in_a_record_does_the_match_again_bit_for_bit() {
    let pair = Pair::bundled();
    let odd = pair.path("it's here.k.gz");
    std::fs::copy(pair.path("crash.k.gz"), &odd).unwrap();
    let stamped = pair.path("stamped.dynain.gz");
    let pose = "0 -1 0 12.5  1 0 0 -3.25  0 0 1 1e2  0 0 0 1";
    let options: [&[&str]; 3] = [
        &[],
        &[
            "--crash-part",
            "title:FLOOR PAN FRONT",
            "--crash-triangles",
            "900",
            "--lambda",
            "1.7",
        ],
        &[
            "--start-pose",
            pose,
            "--method",
            "icp",
            "--stamped-length-factor",
            "1.001",
            "--normal-angle",
            "70",
        ],
    ];
    for options in options {
        let output = shapematch(&[&["match", &odd, &stamped, "--json", "-"], options].concat());
        let first: Value = serde_json::from_slice(&output.stdout).unwrap();
        let line = first["command_line"].as_str().unwrap();
        let second = run_line(line, &["--json", "-", "--threads", "1"]);
        assert_eq!(second["matrix"], first["matrix"], "{line}");
        assert_eq!(second["starts"], first["starts"], "{line}");
        assert_eq!(second["parameters"], first["parameters"], "{line}");
        assert_eq!(second["command_line"], first["command_line"]);
    }
}

#[test]
fn another_pose_of_the_match_is_written_by_its_number() {
    let pair = Pair::bundled();
    let best = record(&pair.run(&["--json", "-"]));
    let alternatives = best["alternatives"].as_array().unwrap();
    let too_large = (alternatives.len() + 2).to_string();
    let output = pair.run(&["--pose-number", &too_large]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("the match found"));
    let Some(first) = alternatives.first() else {
        return;
    };
    let second = record(&pair.run(&["--json", "-", "--pose-number", "2"]));
    assert_eq!(second["matrix"], first["matrix"]);
    let line = second["command_line"].as_str().unwrap();
    assert!(line.contains("--pose-number 2"), "{line}");
    assert_eq!(run_line(line, &["--json", "-"])["matrix"], second["matrix"]);
}

#[test]
fn a_start_pose_with_the_factor_between_units_is_no_hint_at_one_that_is_missing() {
    let pair = Pair::bundled();
    let mut truth = pair.truth();
    truth.scale *= 1000.0;
    let rows = truth
        .to_rows()
        .map(|row| row.map(|x| x.to_string()).join(" "));
    let in_metres = ["--stamped-length-factor", "0.001", "--json", "-"];
    let start = ["--start-pose", &rows.join(" ")];
    let output = pair.run(&[&in_metres[..], &start].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let found = record(&output);
    assert!((found["scale"].as_f64().unwrap() - 1000.0).abs() < 1e-6);
    assert_ne!(found["verdict"], "poor", "{}", found["reasons"]);
    let reasons = found["reasons"].to_string();
    assert!(
        !reasons.contains("scale") && !reasons.contains("larger"),
        "{reasons}"
    );
}

fn record(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_number_of_threads_does_not_change_the_matrix() {
    let pair = Pair::bundled();
    let matrix = |threads: &str| -> Value {
        let output = pair.run(&["--json", "-", "--threads", threads]);
        let record: Value = serde_json::from_slice(&output.stdout).unwrap();
        record["matrix"].clone()
    };
    assert_eq!(matrix("1"), matrix("3"));
}

#[test]
fn another_part_is_poor_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let write = |part: &str| -> PathBuf {
        let to = folder.path().join(part);
        let output = shapematch(&["sample", to.to_str().unwrap(), "--part", part]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        to
    };
    let crash = write("rail").join("crash.k");
    let stamped = write("bracket").join("stamped.dynain");
    let output = shapematch(&["match", crash.to_str().unwrap(), stamped.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stdout));
    assert!(text(&output.stdout).starts_with("POOR\n"));
}

#[test]
fn a_transformation_that_is_not_there_is_a_reason_to_check() {
    let pair = Pair::bundled();
    let main = pair.path("main.k");
    let include = "*KEYWORD\n*INCLUDE_TRANSFORM\ncrash.k.gz\n,0\n,\n1,1,1\n5\n*END\n";
    std::fs::write(&main, include).unwrap();
    let (stamped, page) = (pair.path("stamped.dynain.gz"), pair.path("r.html"));
    let told = "1 read error in the crash file";
    let matched = |options: &[&str]| {
        let output = shapematch(&[&["match", &main, &stamped], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        output
    };
    let output = matched(&["--report", &page]);
    let report = text(&output.stdout);
    assert!(report.starts_with("CHECK\n"), "{report}");
    assert!(report.contains(told), "{report}");
    assert!(std::fs::read_to_string(&page).unwrap().contains(told));
    let record = record(&matched(&["--json", "-"]));
    assert_eq!(record["verdict"], "check", "{record}");
    assert!(record.to_string().contains("read-errors"), "{record}");
    for pose in [&[][..], &["--identity"]] {
        let output = shapematch(&[&["map", &main, &stamped, "--json", "-"], pose].concat());
        let record: Value = serde_json::from_slice(&output.stdout).unwrap();
        let checks = record["checks"].as_array().unwrap();
        let check = checks.iter().find(|check| check["name"] == "Read errors");
        let check = check.unwrap_or_else(|| panic!("{record}"));
        assert_eq!(check["is_met"], false, "{check}");
    }
}

#[test]
fn a_part_of_a_whole_model_is_chosen_by_id_title_and_set() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().to_str().unwrap();
    let sample = [
        "sample",
        to,
        "--part",
        "bracket",
        "--variant",
        "whole-model",
    ];
    assert!(shapematch(&sample).status.success());
    let [crash, stamped] = ["crash.k", "stamped.dynain"]
        .map(|name| folder.path().join(name).to_str().unwrap().to_owned());
    let info = shapematch(&["info", &crash, "--json", "-"]);
    let info: Value = serde_json::from_slice(&info.stdout).unwrap();
    let parts = info["parts"].as_array().unwrap();
    assert!(parts.len() > 1);
    let id = parts[0]["id"].to_string();
    let title = parts[0]["title"].as_str().unwrap();
    for choice in [id.as_str(), title, "set:2000000"] {
        let output = shapematch(&[
            "match",
            &crash,
            &stamped,
            "--crash-part",
            choice,
            "--json",
            "-",
        ]);
        let record: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            record["files"]["crash"]["parts"][0].to_string(),
            id,
            "chosen by {choice}"
        );
        assert_ne!(record["verdict"], "poor", "chosen by {choice}");
    }
    let missing = shapematch(&["match", &crash, &stamped, "--crash-part", "77"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(text(&missing.stderr).contains("there is no part 77"));
}

#[test]
fn reduction_keeps_the_ceiling_and_its_figures() {
    let pair = Pair::bundled();
    let [out, json] = ["small.stl", "small.json"].map(|name| pair.path(name));
    let input = pair.path("stamped.dynain.gz");
    let output = shapematch(&[
        "reduce",
        &input,
        "--triangles",
        "1000",
        "--out",
        &out,
        "--json",
        &json,
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let after = record["triangles_after"].as_u64().unwrap();
    assert!(after <= 1000);
    assert_eq!(mesh(&out).n_triangles() as u64, after);
    for key in ["triangles_before", "time_ms", "rms", "max", "border_max"] {
        assert!(record[key].is_number(), "no key {key}");
    }
}

#[test]
fn a_reduced_deck_keeps_thickness_id_and_title_and_says_what_it_lacks() {
    let pair = Pair::bundled();
    let [input, out] = ["stamped.dynain.gz", "small.k"].map(|name| pair.path(name));
    let output = shapematch(&["reduce", &input, "--triangles", "1000", "--out", &out]);
    let told = text(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("left out of the deck: forming results"),
        "{told}"
    );
    let read = |path: &str| {
        let (settings, silent) = (LoadSettings::default(), Monitor::silent());
        load(Path::new(path), &settings, &silent).unwrap()
    };
    let (whole, small) = (read(&input), read(&out));
    assert_eq!(small.chosen_part_ids(), whole.chosen_part_ids());
    assert_eq!(small.model.parts[0].title, whole.model.parts[0].title);
    let [before, after] = [&whole, &small].map(|part| part.mean_thickness().unwrap());
    assert!((after - before).abs() < 1e-6 * before, "{after} {before}");
}

#[test]
fn info_counts_the_forming_results() {
    let pair = Pair::bundled();
    let output = shapematch(&["info", &pair.path("stamped.dynain.gz"), "--json", "-"]);
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "nodes",
        "shells",
        "parts",
        "bounds",
        "forming",
        "diagnostics",
    ] {
        assert!(info.get(key).is_some(), "no key {key}");
    }
    assert_eq!(info["forming"]["thickness"], info["shells"]);
    assert_eq!(info["forming"]["stress"], info["shells"]);
    let people = shapematch(&["info", &pair.path("crash.k.gz")]);
    assert!(text(&people.stdout).contains("FLOOR PAN FRONT"));
}

/// A number below 0 is answered with what the option takes, not with another way to type it.
#[test]
fn numbers_below_zero_are_taken_as_the_value_of_their_option() {
    use clap::{CommandFactory as _, Parser as _, error::ErrorKind};
    use shapematch::cli::Cli;
    let mut n_numbers = 0;
    for task in Cli::command().get_subcommands() {
        for option in task.get_opts() {
            let option = option.get_long().unwrap();
            let kind = |word: &str| {
                let words = ["shapematch", task.get_name(), &format!("--{option}"), word];
                Cli::try_parse_from(words)
                    .map_or_else(|error| error.kind(), |_| ErrorKind::DisplayHelp)
            };
            let is_refused =
                |kind| matches!(kind, ErrorKind::ValueValidation | ErrorKind::InvalidValue);
            if is_refused(kind("x")) && !is_refused(kind("4")) {
                n_numbers += 1;
                assert_ne!(kind("-5"), ErrorKind::UnknownArgument, "{option}");
            }
        }
    }
    assert!(n_numbers > 30, "{n_numbers}");
}

#[test]
#[cfg(target_os = "linux")]
fn output_that_cannot_be_written_is_named() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .args(["sample", "--list"])
        .stdout(full)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("standard output cannot be written"));
    let folder = tempfile::tempdir().unwrap();
    let piped = "shapematch sample --list | true";
    let program = Path::new(env!("CARGO_BIN_EXE_shapematch"))
        .parent()
        .unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .args(["-c", piped])
        .env("PATH", path)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn wrong_usage_and_missing_files_have_their_own_status() {
    assert_eq!(shapematch(&["match", "only-one.k"]).status.code(), Some(2));
    assert_eq!(shapematch(&["no-such-task", "--x"]).status.code(), Some(2));
    let unknown = shapematch(&["sample", "folder", "--part", "no-such-part"]);
    assert_eq!(unknown.status.code(), Some(2));
    let missing = shapematch(&["info", "no-such-file.k"]);
    assert_eq!(missing.status.code(), Some(1));
    let message = text(&missing.stderr);
    assert!(
        message.contains("no-such-file.k") && !message.contains("os error"),
        "{message}"
    );
    let unknown = shapematch(&["bench", "--mapping", "--only", "no-such-part"]);
    assert_eq!(unknown.status.code(), Some(2));
    let message = text(&unknown.stderr);
    assert!(
        message.contains("floor") && message.contains("speed"),
        "{message}"
    );
    for (words, told) in [
        (&["frobnicate"][..], "no such file or command: frobnicate"),
        (&["mapp", "a", "b"], "did you mean map?"),
        (&["--quiet", "mathc"], "did you mean match?"),
    ] {
        let unknown = shapematch(words);
        assert_eq!(unknown.status.code(), Some(2), "{words:?}");
        let message = text(&unknown.stderr);
        assert!(message.contains(told), "{message}");
    }
    let pair = Pair::bundled();
    // The name of a mesh says in which format it is written.
    let unnamed = pair.run(&["--moved", "-"]);
    assert_eq!(unnamed.status.code(), Some(2));
    assert!(text(&unnamed.stderr).contains(".stl"));
    let wide = pair.run(&["--angle-segment", "90"]);
    assert_eq!(wide.status.code(), Some(2));
    assert!(text(&wide.stderr).contains("60°"), "{}", text(&wide.stderr));
}

#[test]
fn tables_that_cannot_be_written_are_refused_before_they_are_measured() {
    for table in ["--growth", "--robustness"] {
        for (outputs, reason) in [
            (["--json", "-", "--html", "-"], "standard output"),
            (
                ["--json", "-", "--html", "no-such-folder/page.html"],
                "no-such-folder",
            ),
        ] {
            let refused = shapematch(&[&["bench", table], &outputs[..]].concat());
            assert_eq!(refused.status.code(), Some(2), "{table}");
            assert!(refused.stdout.is_empty(), "nothing was measured");
            let message = text(&refused.stderr);
            assert!(message.contains(reason), "{message}");
        }
    }
}

#[test]
fn every_command_that_reads_parts_takes_the_limit_of_reading() {
    let pair = Pair::bundled();
    let (crash, stamped) = (pair.path("crash.k.gz"), pair.path("stamped.dynain.gz"));
    let [mesh, deck, folder] = ["mesh.stl", "deck.k", "car"].map(|name| pair.path(name));
    for words in [
        &["info", &crash][..],
        &["reduce", &crash, "--triangles", "500", "--out", &mesh],
        &["match", &crash, &stamped],
        &["map", &crash, &stamped, "--out", &deck],
        &["map-car", &crash, &stamped, "--out", &folder],
    ] {
        let refused = shapematch(&[words, &["--read-limit", "0.00001"]].concat());
        assert_eq!(refused.status.code(), Some(1), "{words:?}");
        let message = text(&refused.stderr);
        assert!(message.contains("raise it with --read-limit"), "{message}");
    }
}

#[test]
fn values_that_cannot_be_say_what_they_must_be() {
    for (line, told) in [
        (
            "reduce a.k --triangles 0",
            "it must be a whole number from 1",
        ),
        (
            "info a.k --threads x",
            "it must be a whole number from 0 to 1024",
        ),
        (
            "map a.k b.k --layers 101",
            "it must be a whole number from 1 to 100",
        ),
        ("map a.k b.k --fill -1", "it must be a whole number from 0"),
        (
            "map a.k b.k --stamped-length-factor 1,5",
            "it is not a number",
        ),
        (
            "match a.k b.k --crash-length-factor 0",
            "it must be above 0",
        ),
        (
            "match a.k b.k --shape-tolerance 1e300",
            "it must be at least 0 and at most 1e9",
        ),
    ] {
        let words: Vec<&str> = line.split(' ').collect();
        let output = shapematch(&words);
        assert_eq!(output.status.code(), Some(2), "{line}");
        let message = text(&output.stderr);
        assert!(message.contains(told), "{line}: {message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let output = shapematch(&["sample", file.to_str().unwrap()]);
    let message = text(&output.stderr);
    assert!(message.contains("it is a file, not a folder"), "{message}");
}

#[test]
fn options_without_effect_and_folders_that_are_not_there_are_told() {
    let pair = Pair::bundled();
    let (crash, stamped) = (pair.path("crash.k.gz"), pair.path("stamped.dynain.gz"));
    let (page, project) = (pair.path("page.html.gz"), pair.path("a.shapematch"));
    std::fs::write(&project, "{}").unwrap();
    for (words, status, told) in [
        (
            &["info", "-"][..],
            1,
            "standard input is not read; name a file",
        ),
        (
            &["info", &crash, "--include-folder", "no-such-folder"][..],
            0,
            "--include-folder no-such-folder: no such folder",
        ),
        (
            &[
                "map",
                &crash,
                &stamped,
                "--identity",
                "--quantities",
                "thickness",
                "--rule",
                "gauss",
            ],
            1,
            "--rule has no effect: nothing that lies at layers is mapped",
        ),
        (
            &["map", &crash, &stamped, "--report", &page],
            2,
            "--report is not written packed",
        ),
        (
            &[
                "map", &crash, &stamped, "--mirror", "free", "--hand", "either",
            ],
            2,
            "omit --hand either",
        ),
        (
            &["info", &project, "--read-limit", "1"],
            2,
            "--read-limit is for decks and meshes",
        ),
        (&["sample", "folder", "--list"], 2, "cannot be used with"),
        (
            &["--example", "info", &crash],
            2,
            "--example opens the window",
        ),
    ] {
        let output = shapematch(words);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{words:?}: {message}");
        assert!(message.contains(told), "{words:?}: {message}");
    }
}
