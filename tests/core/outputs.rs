//! Files the command line writes: nothing that is read is overwritten, nothing is left half written,
//! and what cannot be written is said before the work.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use shapematch::formats::{self, Model, ReadOptions};
use shapematch::monitor::Monitor;

fn shapematch(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_shapematch"))
        .current_dir(folder)
        .args(args)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The bracket, whose crash deck includes its mesh.
fn pair() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sample = ["sample", ".", "--part", "bracket"];
    assert!(shapematch(folder.path(), &sample).status.success());
    let at = |name: &str| folder.path().join(name);
    fs::rename(at("crash.k"), at("mesh.k")).unwrap();
    fs::write(at("crash.k"), "*KEYWORD\n*INCLUDE\nmesh.k\n*END\n").unwrap();
    folder
}

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    let mut files: Vec<(String, Vec<u8>)> = entries
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).unwrap_or_default())
        })
        .collect();
    files.sort();
    files
}

#[test]
fn nothing_that_is_read_is_overwritten() {
    let folder = pair();
    #[cfg(unix)]
    std::os::unix::fs::symlink("stamped.dynain", folder.path().join("link.k")).unwrap();
    fs::hard_link(folder.path().join("crash.k"), folder.path().join("twin.k")).unwrap();
    let before = contents(folder.path());
    let cases: &[&[&str]] = &[
        &["reduce", "mesh.k", "-n", "20", "--out", "mesh.k"],
        &["reduce", "mesh.k", "-n", "20", "--out", "./mesh.k"],
        &["reduce", "crash.k", "-n", "20", "--out", "mesh.k"],
        &["match", "crash.k", "stamped.dynain", "--moved", "twin.k"],
        &[
            "match",
            "crash.k",
            "stamped.dynain",
            "--moved",
            "stamped.dynain",
        ],
        &["match", "crash.k", "stamped.dynain", "--cards", "crash.k"],
        &["match", "crash.k", "stamped.dynain", "--cards", "mesh.k"],
        &["match", "crash.k", "stamped.dynain", "--json", "mesh.k"],
        #[cfg(unix)]
        &["match", "crash.k", "stamped.dynain", "--report", "link.k"],
        &["info", "crash.k", "--json", "mesh.k"],
        &[
            "bench",
            "crash.k",
            "stamped.dynain",
            "--json",
            "stamped.dynain",
        ],
    ];
    for args in cases {
        let output = shapematch(folder.path(), args);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {told}");
        assert!(told.contains("would overwrite"), "{args:?}: {told}");
        assert!(output.stdout.is_empty(), "{args:?} began to work");
        assert_eq!(contents(folder.path()), before, "{args:?}");
    }
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work() {
    let folder = pair();
    let before = contents(folder.path());
    let cases: &[(&[&str], &str)] = &[
        (&["--json", "r.json", "--matrix", "./r.json"], "same file"),
        (&["--json", "-", "--matrix", "-"], "standard output"),
        (&["--moved", "a.xyz"], "ends in .k"),
        (&["--moved", "$a.k"], "begins with $"),
        (&["--report", "nowhere/r.html"], "folder does not exist"),
        (&["--report", "."], "is a folder"),
    ];
    for (options, words) in cases {
        let args = [&["match", "crash.k", "stamped.dynain"], *options].concat();
        let output = shapematch(folder.path(), &args);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(2), "{options:?}: {told}");
        assert!(told.contains(words) && told.contains(options[0]), "{told}");
        assert!(output.stdout.is_empty(), "{options:?} began to work");
    }
    assert_eq!(contents(folder.path()), before);
}

#[test]
#[cfg(unix)]
fn a_name_that_no_deck_can_include_is_refused_before_the_match() {
    let folder = pair();
    for name in ["$a.k", "*a.k", "a\nb.k", "a +", " a.k"] {
        fs::copy(
            folder.path().join("stamped.dynain"),
            folder.path().join(name),
        )
        .unwrap();
        let args = ["match", "crash.k", name, "--cards", "c.k"];
        let output = shapematch(folder.path(), &args);
        assert_eq!(output.status.code(), Some(2), "{name:?}: {}", said(&output));
        assert!(output.stdout.is_empty());
        assert!(!folder.path().join("c.k").exists());
    }
}

#[test]
#[cfg(target_os = "linux")]
fn on_a_full_disk_the_old_file_survives_and_the_others_are_written() {
    let folder = pair();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("moved.k"), "the old file").unwrap();
    // No file may grow beyond 8 × 512 bytes: more than the matrix, less than the deck.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    let output = Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_shapematch")])
        .args(["match", "crash.k", "stamped.dynain"])
        .args(["--moved", "moved.k", "--matrix", "m.txt", "--cards", "c.k"])
        .output()
        .unwrap();
    let told = said(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("--moved is not written"), "{told}");
    assert_eq!(fs::read_to_string(at("moved.k")).unwrap(), "the old file");
    assert!(fs::read_to_string(at("m.txt")).unwrap().ends_with('\n'));
    assert!(at("c.k").exists());
    let left = contents(folder.path());
    assert!(
        left.iter().all(|(name, _)| !name.starts_with('.')),
        "{left:?}"
    );

    // Both files of a mapping stay as they are where one of them cannot be written.
    for name in ["mapped.k", "mapped_elements.k"] {
        fs::write(at(name), "the old file").unwrap();
    }
    let output = Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", script, env!("CARGO_BIN_EXE_shapematch")])
        .args(["map", "crash.k", "stamped.dynain", "--out", "mapped.k"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    for name in ["mapped.k", "mapped_elements.k"] {
        assert_eq!(fs::read_to_string(at(name)).unwrap(), "the old file");
    }

    let full = ["match", "crash.k", "stamped.dynain", "--json", "/dev/full"];
    let output = shapematch(folder.path(), &full);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("/dev/full"), "{}", said(&output));
}

#[test]
fn other_files_are_replaced() {
    let folder = pair();
    let old = folder.path().join("small.stl");
    fs::write(&old, "old").unwrap();
    let args = ["reduce", "crash.k", "-n", "20", "--out", "small.stl"];
    assert!(shapematch(folder.path(), &args).status.success());
    assert!(fs::metadata(&old).unwrap().len() > 84);
}

#[test]
fn settings_that_cannot_be_are_wrong_usage() {
    let folder = pair();
    let cases: &[(&[&str], &str)] = &[
        (&["--stamped-length-factor", "1e308"], "1e308"),
        (&["--lambda", "-1"], "-1"),
        (&["--angle-segment", "90"], "60°"),
        (
            &["--start-pose", "2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"],
            "rotation",
        ),
        (&["--threads", "100000"], "100000"),
        (&["--overlap", "2"], "from 0.001 to 1"),
        (&["--overlap", "0.5"], "no effect"),
        (&["--lambda", "3", "--method", "icp"], "no effect"),
        (&["--start", "given"], "--start-pose"),
        (&["--floor", "-1"], "at least 0"),
        (&["--card-form", "transform"], "--cards"),
        (&["--read-limit", "-1"], "above 0"),
    ];
    for (options, words) in cases {
        let args = [&["match", "crash.k", "stamped.dynain"], *options].concat();
        let output = shapematch(folder.path(), &args);
        let told = said(&output);
        assert_eq!(output.status.code(), Some(2), "{options:?}: {told}");
        assert!(told.contains(words), "{options:?}: {told}");
        assert!(output.stdout.is_empty(), "{options:?} began to work");
    }
    let none = ["reduce", "crash.k", "-n", "0", "--out", "a.stl"];
    assert_eq!(shapematch(folder.path(), &none).status.code(), Some(2));
}

#[test]
fn a_part_that_is_not_there_is_answered_with_those_that_are_near() {
    let folder = pair();
    for wrong in ["5", "seat brackets"] {
        let args = ["match", "crash.k", "stamped.dynain", "--crash-part", wrong];
        let told = said(&shapematch(folder.path(), &args));
        assert!(told.contains("there is no part"), "{told}");
        assert!(told.contains("2000040 \"SEAT BRACKET\""), "{told}");
    }
}

#[test]
fn escape_sequences_of_a_title_do_not_reach_the_terminal() {
    let folder = pair();
    let deck = folder.path().join("mesh.k");
    let text = fs::read_to_string(&deck).unwrap();
    let at = text.find("*PART\n").unwrap() + 6;
    let (head, tail) = text.split_at(at);
    let tail = tail.trim_start_matches('$');
    fs::write(&deck, format!("{head}\u{1b}[31mred\n{}", after_title(tail))).unwrap();
    let output = shapematch(folder.path(), &["info", "mesh.k"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("[31mred"), "{text}");
    assert!(!text.contains('\u{1b}'), "{text}");
}

/// What follows the title of a part: comments and the title are left out.
fn after_title(text: &str) -> String {
    let mut lines = text.lines().skip_while(|line| line.starts_with('$'));
    lines.next();
    let rest: Vec<&str> = lines.collect();
    rest.join("\n")
}

/// A deck in which all keywords but the first have the suffix of the standard format.
fn with_suffixes(deck: &str, keyword: &str) -> String {
    let mut text = format!("{keyword}\n");
    for line in deck.lines().filter(|line| !line.starts_with("*KEYWORD")) {
        let suffix = if line.starts_with('*') && line != "*END" {
            "-"
        } else {
            ""
        };
        text += &format!("{line}{suffix}\n");
    }
    text
}

fn read(path: &Path) -> Model {
    formats::read(path, &ReadOptions::default(), &Monitor::silent()).unwrap()
}

#[test]
fn cards_have_the_format_of_the_deck_that_takes_them() {
    let folder = pair();
    let at = |name: &str| folder.path().join(name);
    let mesh = fs::read_to_string(at("mesh.k")).unwrap();
    let n_nodes = read(&at("stamped.dynain")).nodes.len();
    for keyword in ["*KEYWORD LONG=Y", "*KEYWORD I10=Y"] {
        fs::write(at("wide.k"), with_suffixes(&mesh, keyword)).unwrap();
        let taken = format!("{keyword}\n*INCLUDE\ncards.k\n*END\n");
        fs::write(at("with_cards.k"), taken).unwrap();
        for form in ["transform", "stamped", "stamped-inverse"] {
            let line = [
                "match",
                "wide.k",
                "stamped.dynain",
                "--cards",
                "cards.k",
                "--card-form",
                form,
            ];
            let output = shapematch(folder.path(), &line);
            assert!(
                output.status.success(),
                "{keyword} {form}: {}",
                said(&output)
            );
            let model = read(&at("with_cards.k"));
            if form == "transform" {
                let found: Vec<String> =
                    model.diagnostics.iter().map(ToString::to_string).collect();
                assert!(
                    !found.iter().any(|told| told.contains(": error: ")),
                    "{found:?}"
                );
                assert_eq!(model.nodes.len(), n_nodes, "{found:?}");
                assert!(!model.shells.is_empty(), "{found:?}");
            } else {
                let onto: Vec<u64> = model
                    .stamped_includes
                    .iter()
                    .map(|include| include.onto)
                    .collect();
                assert_eq!(onto, [read(&at("wide.k")).parts[0].id], "{keyword} {form}");
            }
        }
    }
}

#[test]
fn ids_that_both_files_have_are_offset_on_the_cards() {
    let folder = pair();
    let at = |name: &str| folder.path().join(name);
    fs::copy(at("mesh.k"), at("same.k")).unwrap();
    // The transformation on the cards gets an id that none of these has.
    for (name, id) in [("mesh.k", 1), ("same.k", 2)] {
        let moves = format!("*DEFINE_TRANSFORMATION\n{id:>10}\n    TRANSL      77.0\n*END");
        let deck = fs::read_to_string(at(name)).unwrap();
        fs::write(at(name), deck.replace("*END", &moves)).unwrap();
    }
    let line = [
        "match",
        "mesh.k",
        "same.k",
        "--cards",
        "cards.k",
        "--card-form",
        "transform",
    ];
    let output = shapematch(folder.path(), &line);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("and same.k share ids ("), "{told}");
    fs::write(
        at("both.k"),
        "*KEYWORD\n*INCLUDE\nmesh.k\n*INCLUDE\ncards.k\n*END\n",
    )
    .unwrap();
    let (one, both) = (read(&at("mesh.k")), read(&at("both.k")));
    assert_eq!(both.nodes.len(), 2 * one.nodes.len());
    assert_eq!(both.shells.len(), 2 * one.shells.len());
    assert_eq!(both.parts.len(), 2 * one.parts.len());
    assert_eq!(both.transformations.len(), 3, "{:?}", both.transformations);
    let found: Vec<String> = both.diagnostics.iter().map(ToString::to_string).collect();
    assert!(
        !found.iter().any(|told| told.contains("defined again")),
        "{found:?}"
    );
}

#[test]
fn a_folder_is_named_and_goes_again_where_nothing_is_mapped() {
    let folder = pair();
    let dash = shapematch(
        folder.path(),
        &["map-car", "crash.k", "stamped.dynain", "-o", "-"],
    );
    assert_eq!(dash.status.code(), Some(2), "{}", said(&dash));
    assert!(
        said(&dash).contains("--out takes a folder"),
        "{}",
        said(&dash)
    );
    assert!(!folder.path().join("-").exists());
    fs::write(folder.path().join("none.dynain"), "this is no deck\n").unwrap();
    let line = ["map-car", "crash.k", "none.dynain", "-o", "mapped"];
    assert_eq!(shapematch(folder.path(), &line).status.code(), Some(1));
    assert!(!folder.path().join("mapped").exists());
    fs::create_dir(folder.path().join("mapped")).unwrap();
    assert_eq!(shapematch(folder.path(), &line).status.code(), Some(1));
    assert!(folder.path().join("mapped").exists(), "it was there before");
}

/// A title in another encoding goes to standard output as it stands in the deck.
#[test]
fn standard_output_takes_the_bytes_of_a_deck() {
    let folder = pair();
    let at = |name: &str| folder.path().join(name);
    let mut deck = fs::read(at("crash.k")).unwrap();
    deck.splice(0..0, *b"$ Gr\xf6\xdfe\n");
    fs::write(at("crash.k"), &deck).unwrap();
    let line = [
        "map",
        "crash.k",
        "stamped.dynain",
        "--write",
        "deck",
        "--out",
    ];
    let mapped = |out: &str| shapematch(folder.path(), &[&line[..], &[out]].concat());
    let printed = mapped("-");
    assert!(printed.status.success(), "{}", said(&printed));
    assert!(mapped("out.k").status.success());
    assert_eq!(printed.stdout, fs::read(at("out.k")).unwrap());
}

#[cfg(target_os = "linux")]
#[test]
fn an_include_of_two_files_is_not_written_to_a_device() {
    let folder = pair();
    let line = ["map", "crash.k", "stamped.dynain", "--out", "/dev/null"];
    let output = shapematch(folder.path(), &line);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(
        said(&output).contains("has room for one"),
        "{}",
        said(&output)
    );
}

/// The keys that docs/json.md lists below the heading of a schema.
fn keys_of(page: &str, schema: &str) -> Vec<String> {
    let heading = format!("## `{schema}`");
    let (_, rest) = page
        .split_once(&heading)
        .unwrap_or_else(|| panic!("{heading} is missing"));
    let section = rest.split("\n## ").next().unwrap_or_default();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| "));
    let cells = rows.filter_map(|row| row.split('|').next());
    let words = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    words.map(str::to_owned).collect()
}

#[test]
fn the_page_of_the_records_names_every_key() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/json.md");
    let page = fs::read_to_string(page).unwrap().replace("\r\n", "\n");
    let folder = pair();
    let lines: &[&[&str]] = &[
        &["info", "crash.k"],
        &["match", "crash.k", "stamped.dynain"],
        &["map", "crash.k", "stamped.dynain", "--out", "mapped.k"],
        &["map-car", "crash.k", "stamped.dynain", "--out", "mapped"],
        &["reduce", "mesh.k", "-n", "20", "--out", "small.stl"],
    ];
    for line in lines {
        let output = shapematch(folder.path(), &[line, &["--json", "-"][..]].concat());
        let record: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let record = record.as_object().unwrap();
        let told = keys_of(&page, record["schema"].as_str().unwrap());
        for key in record.keys() {
            assert!(
                told.contains(key),
                "{line:?}: docs/json.md does not name {key}"
            );
        }
        // Some are there only where there is something to tell.
        for key in told
            .iter()
            .filter(|key| !["thinning", "probes"].contains(&key.as_str()))
        {
            assert!(
                record.contains_key(key),
                "{line:?}: docs/json.md names {key}, which is not there"
            );
        }
    }
}
