//! Options of `shapematch map` that decide what is written of elements without values, and where a mirrored
//! part goes; and the examples written.

use std::path::PathBuf;
use std::process::Output;

use shapematch::monitor::Monitor;
use shapematch::pipeline::load::{LoadSettings, PartSource};
use shapematch::pipeline::map::{
    DefaultThickness, MapOutput, MapRecipe, PlacedPart, PoseOrigin, WriteKind, map_parts,
    write_mapping,
};
use shapematch::report::parse_matrix;
use shapematch::role::Role;
use shapematch::samples;

use super::map_decks::{Pair, SECTION, model};

/// Nodes and elements of a strip of `n` squares along x.
fn squares(n: usize, first_id: usize, part: usize, thickness: Option<f64>) -> String {
    let mut deck = "*NODE\n".to_owned();
    for column in 0..=n {
        for row in 0..2 {
            let (id, x, y) = (2 * column + row + 1, 10 * column, 10 * row);
            deck += &format!("{id:>8}{x:>16}{y:>16}{:>16}\n", 0);
        }
    }
    deck += match thickness {
        Some(_) => "*ELEMENT_SHELL_THICKNESS\n",
        None => "*ELEMENT_SHELL\n",
    };
    for i in 0..n {
        let (id, node) = (first_id + i, 2 * i + 1);
        let corners = [node, node + 2, node + 3, node + 1];
        let corners: String = corners.iter().map(|n| format!("{n:>8}")).collect();
        deck += &format!("{id:>8}{part:>8}{corners}\n");
        if let Some(thickness) = thickness {
            deck += &format!("{thickness:>16}").repeat(4);
            deck += "\n";
        }
    }
    deck
}

/// Four squares of 10 on the crash side (ids from 101), the first two of them stamped (ids from 1).
struct Strip(Pair);

impl Strip {
    fn new() -> Self {
        let section = "*PART\nsheet\n         7         7\n*SECTION_SHELL\n         7         2     0.833         2\n       1.0\n";
        // The first stamped element alone has stresses, with a shear.
        let mut results = "*INITIAL_STRESS_SHELL\n         1         1         2\n".to_owned();
        for t in ["-.5773503", ".57735027"] {
            results += &format!(
                "{t:>10}     100.0      50.0       0.0      20.0       0.0       0.0       0.1\n"
            );
        }
        let crash = squares(4, 101, 7, None);
        let stamped = squares(2, 1, 1, Some(0.9));
        Self(Pair::new(
            &format!("*KEYWORD\n{section}{crash}*END\n"),
            &format!("*KEYWORD\n{stamped}{results}*END\n"),
        ))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }

    fn map(&self, options: &[&str]) -> Output {
        self.0.run(&[&["--out", "out.k"], options].concat())
    }

    /// Id and first corner thickness of the elements that were written.
    fn thicknesses(&self) -> Vec<(u64, f64)> {
        let text = std::fs::read_to_string(self.path("out_elements.k")).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with(['$', '*']));
        let lines: Vec<&str> = lines.collect();
        let element = |lines: &[&str]| {
            let id = lines[0][..8].trim().parse().unwrap();
            (id, lines[1][..16].trim().parse().unwrap())
        };
        lines.chunks(2).map(element).collect()
    }
}

fn errors(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

#[test]
fn elements_without_values_get_the_default_thickness_that_was_chosen() {
    let strip = Strip::new();
    let written = |options: &[&str]| {
        let output = strip.map(&[&["--identity"], options].concat());
        assert!(output.status.success(), "{}", errors(&output));
        strip.thicknesses()
    };
    let mapped = [(101, 0.9), (102, 0.9)];
    assert_eq!(written(&[]), mapped);
    assert_eq!(written(&["--default-thickness", "section"]), mapped);
    let fixed = written(&["--default-thickness", "0.7"]);
    assert_eq!(fixed, [(101, 0.9), (102, 0.9), (103, 0.7), (104, 0.7)]);
    let head = std::fs::read_to_string(strip.path("out_elements.k")).unwrap();
    assert!(head.contains("$ 2 of them carry no values and have the default thickness"));
    let nearest = written(&["--default-thickness", "nearest"]);
    assert_eq!(nearest, [(101, 0.9), (102, 0.9), (103, 0.9), (104, 0.9)]);
    for wrong in ["0", "-1", "thick", "NaN"] {
        let option = format!("--default-thickness={wrong}");
        let refused = strip.map(&["--identity", &option]);
        assert_eq!(refused.status.code(), Some(2), "{wrong}");
    }
}

/// The figures are those of the thickness that is written, on both sides.
#[test]
fn a_thickness_factor_counts_in_every_figure() {
    let strip = Strip::new();
    let options = ["--identity", "--thickness-scale", "2", "--json", "m.json"];
    let output = strip.map(&[&options[..], &["--report", "m.html"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    assert_eq!(strip.thicknesses(), [(101, 1.8), (102, 1.8)]);
    let record = std::fs::read_to_string(strip.path("m.json")).unwrap();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap();
    for side in ["crash", "stamped"] {
        let mean = record["thickness"][side]["mean"].as_f64().unwrap();
        assert!((mean - 1.8).abs() < 1e-12, "{side}: {mean}");
    }
    assert_eq!(record["thickness"]["stamped_factor"], 2.0);
    assert!(record["plastic_strain"]["stamped_factor"].is_null());
    let summary = String::from_utf8_lossy(&output.stdout);
    assert!(summary.contains("(stamped × 2: 1.80)"), "{summary}");
    // Only the elements that have it are compared with their section.
    let warned = errors(&output);
    let told = "the mapped thickness is 1.80 times that of the crash elements";
    assert!(warned.contains(told), "{warned}");
    let page = std::fs::read_to_string(strip.path("m.html")).unwrap();
    assert!(page.contains("1.80") && !page.contains("0.900"));
    assert!(page.contains("▲ stamped × 2, covered"));
}

#[test]
fn the_nearest_thickness_is_that_along_the_mesh() {
    // Four columns of three squares, of which the stamped part has two, with a thickness for each row.
    let grid = |n_columns: usize, part: u64, card: &dyn Fn(usize) -> String| {
        let mut nodes = "*NODE\n".to_owned();
        for (row, column) in (0..4).flat_map(|row| (0..5).map(move |column| (row, column))) {
            let (id, x, y) = (5 * row + column + 1, 10 * column, 10 * row);
            nodes += &format!(
                "{id:>8}{:>16}{:>16}{:>16}\n",
                format!("{x}.0"),
                format!("{y}.0"),
                "0.0"
            );
        }
        let mut shells = String::new();
        for (row, column) in (0..3).flat_map(|row| (0..n_columns).map(move |column| (row, column)))
        {
            let first = 5 * row + column + 1;
            let corners = [first, first + 1, first + 6, first + 5];
            let corners: String = corners.iter().map(|id| format!("{id:>8}")).collect();
            shells += &format!(
                "{:>8}{part:>8}{corners}\n{}",
                10 * row + column + 1,
                card(row)
            );
        }
        (nodes, shells)
    };
    let (nodes, shells) = grid(4, 7, &|_| String::new());
    let crash = format!("*KEYWORD\n{SECTION}{nodes}*ELEMENT_SHELL\n{shells}*END\n");
    let thickness = |row: usize| 0.7 + 0.1 * row as f64;
    let card = |row: usize| format!("{:>16.1}", thickness(row)).repeat(4) + "\n";
    let (nodes, shells) = grid(2, 1, &card);
    let stamped = format!("*KEYWORD\n{nodes}*ELEMENT_SHELL_THICKNESS\n{shells}*END\n");
    let pair = Pair::new(&crash, &stamped);
    let options = [
        "--default-thickness",
        "nearest",
        "--write",
        "deck",
        "--out",
        "out.k",
    ];
    let output = pair.map(&options);
    assert!(output.status.success(), "{}", errors(&output));
    let written = model(&pair.path("out.k"));
    assert_eq!(written.shell_extras.len(), 12);
    for extra in &written.shell_extras {
        let row = (written.shells[extra.shell as usize].id / 10) as usize;
        let off = extra.thickness[0] - thickness(row);
        assert!(off.abs() < 1e-8, "{extra:?}");
    }
}

#[test]
fn the_examples_that_come_with_the_program_are_mapped_and_written() {
    let silent = Monitor::silent();
    for (source, files) in [
        (PartSource::Example, samples::bundled()),
        (PartSource::RealisticExample, samples::realistic()),
    ] {
        let load = |role| {
            source
                .load(role, &LoadSettings::default(), &silent)
                .unwrap()
        };
        let (crash, stamped) = (load(Role::Crash), load(Role::Stamped));
        let truth = files
            .iter()
            .find(|file| file.name.ends_with("json"))
            .unwrap();
        let truth = String::from_utf8_lossy(&truth.bytes).replace("crash_from_stamped", "matrix");
        let placed = PlacedPart {
            part: &stamped,
            crash_from_stamped: parse_matrix(&truth).unwrap().motion,
            origin: PoseOrigin::Given,
        };
        let run = map_parts(&crash, &[placed], &MapRecipe::default(), &silent).unwrap();
        for kind in WriteKind::ALL {
            let output = MapOutput {
                kind,
                path: "out.k".into(),
                is_large: true,
                default_thickness: DefaultThickness::Section,
                has_copies: true,
            };
            let files = write_mapping(&run, &crash, &output, &[], &silent).unwrap();
            assert!(files.n_thickness > 1000, "{source:?} {kind:?}");
        }
    }
}

#[test]
fn strict_withholds_the_deck_where_too_little_is_mapped() {
    let strip = Strip::new();
    let gate = ["--identity", "--require", "95"];
    let short = strip.map(&gate);
    assert_eq!(short.status.code(), Some(1));
    assert!(strip.path("out.k").exists());
    std::fs::remove_file(strip.path("out.k")).unwrap();
    std::fs::remove_file(strip.path("out_elements.k")).unwrap();
    let strict = strip.map(&[&gate[..], &["--strict", "--csv", "table.csv"]].concat());
    assert_eq!(strict.status.code(), Some(1));
    assert!(errors(&strict).contains("no deck is written"));
    // The table that says why is written all the same.
    assert!(strip.path("table.csv").exists());
    assert!(!strip.path("out.k").exists() && !strip.path("out_elements.k").exists());
    // Of the half that is mapped, half has no stresses.
    let without = strip.map(&["--identity", "--require", "40", "--strict"]);
    let told = errors(&without);
    assert!(
        told.contains("25.0 % of the area has all that was asked for, 40 % are required"),
        "{told}"
    );
    let thickness = ["--identity", "--quantities", "thickness"];
    let met = strip.map(&[&thickness[..], &["--require", "40", "--strict"]].concat());
    assert!(met.status.success() && strip.path("out.k").exists());
    assert_eq!(
        strip.map(&["--identity", "--strict"]).status.code(),
        Some(2)
    );
}

#[test]
fn a_given_pose_is_mirrored_at_a_plane_of_the_crash_model() {
    let strip = Strip::new();
    // Moved by −20 along x, the stamped part lies beside the crash part, and its mirror image on it.
    let pose = ["--pose", "1 0 0 -20 0 1 0 0 0 0 1 0 0 0 0 1"];
    let beside = strip.map(&pose);
    assert!(
        !strip.path("out_elements.k").exists(),
        "{}",
        errors(&beside)
    );
    let options = ["--mirror", "yz", "--quantities", "thickness,plastic,stress"];
    let output = strip.map(&[&pose[..], &options].concat());
    assert!(output.status.success(), "{}", errors(&output));
    assert_eq!(strip.thicknesses(), [(101, 0.9), (102, 0.9)]);
    // The stamped element at the end comes to lie at the other one, its shear with the other sign.
    let written = std::fs::read_to_string(strip.path("out.k")).unwrap();
    let cards = written.lines().filter(|line| !line.starts_with(['$', '*']));
    let cards: Vec<&str> = cards.collect();
    assert_eq!(cards.len(), 5, "{written}");
    assert_eq!(cards[0][..10].trim(), "102");
    for layer in [1, 3] {
        let rest = "  1.00000000E+02  5.00000000E+01  0.00000000E+00 -2.00000000E+01";
        assert_eq!(&cards[layer][16..], rest);
    }
    // A free plane is found by a match and cannot be laid on a given pose.
    let free = strip.map(&[&pose[..], &["--mirror", "free"]].concat());
    assert_eq!(free.status.code(), Some(2));
    assert!(errors(&free).contains("yz, zx or xy"), "{}", errors(&free));
    // Where the parts are matched first there is no pose to mirror.
    let refused = strip.map(&["--mirror", "yz"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        errors(&refused).contains("--hand opposite"),
        "{}",
        errors(&refused)
    );
}

#[test]
fn values_that_cannot_be_are_wrong_usage() {
    let strip = Strip::new();
    let cases: &[(&[&str], &str)] = &[
        (&["--thickness-scale", "0"], "from 0.001 to 1000"),
        (&["--thickness-scale", "1e30"], "from 0.001 to 1000"),
        (&["--max-distance", "1e30"], "above 0 and at most 1e9"),
        (&["--max-distance", "0"], "above 0"),
        (&["--max-distance", "-1"], "above 0"),
        (&["--max-angle", "0"], "from 1° to 90°"),
        (&["--require", "101"], "from 0 to 100"),
        (&["--require", "-5"], "from 0 to 100"),
        (&["--stress-factor", "-5"], "above 0"),
        (
            &["--stress-factor=1", "--stress-factor=2"],
            "2 stress factors for 1 stamped file",
        ),
        (&["--layers", "101"], "from 1 to 100"),
        (&["--n-plane", "2"], "1 or 4"),
        (&["--quantities", "full,nothing"], "\"nothing\" is none of"),
        (&["--pose", "1 2 3"], "--pose"),
    ];
    for (options, words) in cases {
        let refused = strip.0.run(options);
        let told = errors(&refused);
        assert_eq!(refused.status.code(), Some(2), "{options:?}: {told}");
        assert!(told.contains(words), "{options:?}: {told}");
    }
    for without_out in ["--write=deck", "--large=no", "--default-thickness=2"] {
        let refused = strip.0.run(&["--identity", without_out]);
        assert_eq!(refused.status.code(), Some(2), "{without_out}");
        assert!(
            errors(&refused).contains("--out <FILE|->"),
            "{}",
            errors(&refused)
        );
    }
}

#[test]
fn presets_may_stand_among_quantities() {
    let strip = Strip::new();
    let written = |quantities: &str| {
        let output = strip.map(&["--identity", "--quantities", quantities]);
        assert!(output.status.success(), "{}", errors(&output));
        std::fs::read(strip.path("out.k")).unwrap()
    };
    assert_eq!(written("usual,stress"), written("thickness,plastic,stress"));
    assert_eq!(written("thickness,full"), written("full"));
}

#[test]
fn the_area_that_is_asked_for_is_the_one_that_is_told() {
    let strip = Strip::new();
    let told = |required: &str| {
        let thickness = ["--identity", "--quantities", "thickness"];
        let output = strip.map(&[&thickness[..], &["--require", required]].concat());
        let summary = String::from_utf8(output.stdout.clone()).unwrap();
        (summary, errors(&output).to_owned())
    };
    let (summary, warned) = told("90");
    assert!(summary.contains("asked for at least 90"), "{summary}");
    assert!(warned.contains("90 % are required"), "{warned}");
    let (summary, warned) = told("50");
    assert!(
        !summary.contains("asked for at least") && !warned.contains('%'),
        "{summary}{warned}"
    );
}

#[test]
fn each_stamped_file_may_have_a_stress_factor() {
    let strip = Strip::new();
    std::fs::copy(strip.path("stamped.dynain"), strip.path("second.dynain")).unwrap();
    let stress = |factors: &[&str]| {
        let beside = "1 0 0 20 0 1 0 0 0 0 1 0 0 0 0 1";
        let on = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
        let options = [
            "second.dynain",
            "--pose",
            on,
            "--pose",
            beside,
            "--quantities",
            "stress",
        ];
        let output = strip.map(&[&options[..], factors].concat());
        assert!(output.status.success(), "{}", errors(&output));
        let model = super::map_decks::model(&strip.path("out.k"));
        let cards = model.forming.stresses();
        cards
            .map(|card| (card.element_id, card.points[0].stress[0]))
            .collect::<Vec<_>>()
    };
    assert_eq!(stress(&["--stress-factor=2"]), [(101, 200.0), (103, 200.0)]);
    let each = ["--stress-factor=2", "--stress-factor=0.5"];
    assert_eq!(stress(&each), [(101, 200.0), (103, 50.0)]);
}

#[test]
fn parts_of_the_stamped_file_without_results_are_told() {
    let section = "*PART\nsheet\n         7         7\n*SECTION_SHELL\n         7         2     0.833         2\n       1.0\n";
    let silent = "*PART\npatch\n         2         7\n";
    let crash = squares(4, 101, 7, None);
    let results = "*INITIAL_STRAIN_SHELL\n         1         1         2\n       0.1       0.0      -0.1       0.0       0.0       0.0      -1.0\n       0.1       0.0      -0.1       0.0       0.0       0.0       1.0\n";
    let of_two = squares(2, 1, 1, None);
    let (first, second) = of_two.split_at(of_two.len() - 65);
    let second = second.replacen("       1", "       2", 1);
    let of_first = section.replace("sheet\n         7", "sheet\n         1");
    let pair = Pair::new(
        &format!("*KEYWORD\n{section}{crash}*END\n"),
        &format!("*KEYWORD\n{of_first}{silent}{first}{second}{results}*END\n"),
    );
    let output = pair.map(&["--stamped-part", "all", "--quantities", "thickness"]);
    let told = errors(&output);
    assert!(
        told.contains("stamped.dynain: no forming results in part 2"),
        "{told}"
    );
    assert!(!told.contains("part 1"), "{told}");
}

#[test]
fn a_section_with_more_layers_than_a_mapping_carries_is_refused() {
    let strip = Strip::new();
    let path = strip.path("crash.k");
    let deck = std::fs::read_to_string(&path).unwrap();
    let two = "0.833         2\n";
    assert!(deck.contains(two));
    std::fs::write(&path, deck.replace(two, "0.833      1000\n")).unwrap();
    let asked = ["--identity", "--quantities", "stress"];
    let refused = strip.map(&asked);
    let told = errors(&refused);
    assert_eq!(refused.status.code(), Some(1), "{told}");
    assert!(
        told.contains("1000 layers") && told.contains("--layers"),
        "{told}"
    );
    assert!(!strip.path("out.k").exists());
    let fewer = strip.map(&[&asked[..], &["--layers", "5"]].concat());
    assert!(fewer.status.success(), "{}", errors(&fewer));
}

#[test]
fn the_largest_distance_is_a_length_or_the_element_size() {
    let strip = Strip::new();
    let written = |distance: &str| {
        let output = strip.map(&["--identity", "--max-distance", distance]);
        (
            output.status.code(),
            std::fs::read(strip.path("out.k")).ok(),
        )
    };
    let auto = written("auto");
    assert_eq!(auto, written("10"));
    assert_eq!(auto.0, Some(0));
    assert_eq!(written("far").0, Some(2));
}

#[test]
fn a_mapping_of_nothing_is_no_success() {
    let strip = Strip::new();
    let far = "1 0 0 0  0 1 0 0  0 0 1 5000  0 0 0 1";
    let output = strip.map(&["--pose", far]);
    assert_eq!(output.status.code(), Some(1));
    let told = errors(&output);
    assert!(told.contains("nothing is mapped"), "{told}");
}

/// A pose with a scale is told, because it changes no thickness, and so is a reference surface off the middle.
#[test]
fn scales_of_poses_and_nodes_off_the_mid_surface_are_told() {
    let strip = Strip::new();
    let told = |strip: &Strip, pose: &str| {
        let output = strip.map(&["--pose", pose]);
        errors(&output).to_owned()
    };
    let scaled = told(&strip, "1.001 0 0 0  0 1.001 0 0  0 0 1.001 0  0 0 0 1");
    assert!(
        scaled.contains("the pose scales the part by 1.001, and no thickness"),
        "{scaled}"
    );
    let rigid = "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1";
    assert!(!told(&strip, rigid).contains("scales"));
    assert!(!told(&strip, rigid).contains("mid-surface"));
    let deck = std::fs::read_to_string(strip.path("crash.k")).unwrap();
    let off = deck.replace("       1.0\n", &("       1.0".repeat(5) + "\n"));
    assert_ne!(off, deck);
    std::fs::write(strip.path("crash.k"), off).unwrap();
    let told = told(&strip, rigid);
    assert!(told.contains("nodes lie off the mid-surface"), "{told}");
}

/// What is asked for and not there stands among the checks; what many files lack is judged only where it was named.
#[test]
fn quantities_that_no_stamped_file_holds_are_among_the_checks() {
    let strip = Strip::new();
    let bare = Pair::new(
        &std::fs::read_to_string(strip.path("crash.k")).unwrap(),
        &format!("*KEYWORD\n{}*END\n", squares(2, 1, 1, Some(0.9))),
    );
    let check = |pair: &Pair, quantities: &str| {
        let options = ["--quantities", quantities, "--json", "m.json"];
        let output = pair.map(&options);
        assert!(output.status.success(), "{}", errors(&output));
        let record = std::fs::read_to_string(pair.path("m.json")).unwrap();
        let record: serde_json::Value = serde_json::from_str(&record).unwrap();
        let checks = record["checks"].as_array().unwrap();
        let found = checks.iter().find(|check| check["name"] == "Quantities");
        let told = String::from_utf8(output.stdout).unwrap();
        found.map(|check| {
            let found = check["found"].as_str().unwrap();
            assert!(told.contains(found), "{told}");
            (found.to_owned(), check["is_met"].as_bool())
        })
    };
    let no = |names: &str, is_met| Some((format!("no {names} in the stamped files"), is_met));
    assert_eq!(check(&strip.0, "usual"), None);
    let further = "strains, no history variables";
    assert_eq!(check(&strip.0, "full"), no(further, None));
    assert_eq!(
        check(&strip.0, "thickness,strain"),
        no("strains", Some(false))
    );
    assert_eq!(check(&bare, "thickness"), None);
    assert_eq!(check(&bare, "usual"), no("plastic strains", Some(false)));
    let all = format!("stresses, no plastic strains, no {further}");
    assert_eq!(check(&bare, "full"), no(&all, Some(false)));
}

/// A file that is named twice is mapped twice only where it lies at two poses.
#[test]
fn a_stamped_file_that_is_named_twice_is_mapped_once_at_each_pose() {
    let strip = Strip::new();
    let at = |x: u32| format!("1 0 0 {x} 0 1 0 0 0 0 1 0 0 0 0 1");
    let run = |poses: [u32; 2]| {
        let [first, second] = poses.map(at);
        let output = strip.0.run(&[
            "stamped.dynain",
            "--pose",
            &first,
            "--pose",
            &second,
            "--json",
            "m.json",
        ]);
        assert!(output.status.success(), "{}", errors(&output));
        let record = std::fs::read_to_string(strip.path("m.json")).unwrap();
        let record: serde_json::Value = serde_json::from_str(&record).unwrap();
        let n_files = record["stamped"].as_array().unwrap().len();
        (n_files, errors(&output).to_owned())
    };
    let (n_files, told) = run([0, 0]);
    assert_eq!(n_files, 1);
    assert!(told.contains("is named twice and mapped once"), "{told}");
    let (n_files, told) = run([0, 20]);
    assert_eq!(n_files, 2);
    assert!(told.contains("mapped twice, with other options"), "{told}");
}
